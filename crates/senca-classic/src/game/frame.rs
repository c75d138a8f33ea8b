//! One picture of a world: move, rotate, reject, cut at the plane, project, draw.
//!
//! Each stage can be chosen, so that what it does can be seen. The order of drawing is from far to near: first the
//! ground, then bodies by the distance of their middles; within a convex body the faces that are turned away are left
//! out, and the others hide nothing of each other.
//!
//! Source: Savchenko 1995; the order of the stages is that of its chapters.

use super::angle::{Angle, Angles, Tables};
use super::clip::{Bounds, Search, clip_line, clip_polygon};
use super::color_map::ColorMap;
use super::fill::{SpanFill, fill_flat, fill_shaded};
use super::fixed::Fixed;
use super::line::draw_line_by_address;
use super::project::{Lens, Projection};
use super::rotate::{Rotation, translate};
use super::scene::{Body, Face, LightTable, World};
use super::texture::{
    CORNER_BITS, Mapping, Texture, TextureArithmetic, TextureMapping, TexturePlane, TexturedPolygon,
    fill_lit, fill_textured,
};
use super::volume::{VolumeTest, test_volume};

/// Where the viewer is and looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Viewer {
    /// The eye, in whole units.
    pub eye: [i32; 3],
    /// To the right from along Z.
    pub heading: Angle,
    /// Up from level.
    pub pitch: Angle,
    /// Head tilted to the right.
    pub roll: Angle,
}

impl Viewer {
    /// The angles by which the world turns for this viewer.
    #[must_use]
    pub fn angles(&self) -> Angles {
        let back = Angle(self.heading.0.wrapping_neg());
        Angles { heading: back, pitch: self.pitch, roll: Angle(self.roll.0.wrapping_neg()) }
    }

    /// Where rays to the eye come from: the eye, or for parallel ones a point far behind it.
    pub(crate) fn eye_of(&self, projection: Projection) -> [i32; 3] {
        if projection == Projection::Perspective {
            return self.eye;
        }
        let [_, _, ahead] = Rotation::<f64>::new(&Tables::exact(), self.angles()).rows;
        std::array::from_fn(|k| self.eye[k].saturating_sub((ahead[k] * f64::from(1 << 24)) as i32))
    }

    /// The direction of the heading, from the tables, times `length` and cut to whole numbers, as X and Z.
    #[must_use]
    pub fn ahead(&self, length: i32) -> [i32; 2] {
        let tables = Tables::float();
        [tables.sin(self.heading), tables.cos(self.heading)].map(|share| (share * length as f32) as i32)
    }
}

/// Numbers that points are rotated with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Arithmetic {
    /// Tables in floating point; results cut to integers.
    Float,
    /// Fixed point with 10 fraction bits, as the text has it.
    #[default]
    Fixed10,
    /// Fixed point with 8.
    Fixed8,
    /// Fixed point with 14.
    Fixed14,
}

impl Arithmetic {
    /// All, the finest first.
    pub const ALL: [Self; 4] = [Self::Float, Self::Fixed14, Self::Fixed10, Self::Fixed8];

    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Fixed10 => "fixed10",
            Self::Fixed8 => "fixed8",
            Self::Fixed14 => "fixed14",
        }
    }

    /// Points as the viewer has them: moved by the eye and rotated.
    #[must_use]
    pub fn view(self, points: &[[i32; 3]], viewer: &Viewer) -> Vec<[i32; 3]> {
        ViewerRotation::new(self, viewer).view(points, viewer)
    }
}

/// The rotation for a viewer, in one of the arithmetics; looked up once for a picture.
pub(crate) enum ViewerRotation {
    Float(Rotation<f32>),
    Fixed10(Rotation<Fixed<10>>),
    Fixed8(Rotation<Fixed<8>>),
    Fixed14(Rotation<Fixed<14>>),
}

impl ViewerRotation {
    pub(crate) fn new(arithmetic: Arithmetic, viewer: &Viewer) -> Self {
        let angles = viewer.angles();
        match arithmetic {
            Arithmetic::Float => Self::Float(Rotation::new(&Tables::float(), angles)),
            Arithmetic::Fixed10 => Self::Fixed10(Rotation::new(&Tables::fixed(), angles)),
            Arithmetic::Fixed8 => Self::Fixed8(Rotation::new(&Tables::fixed(), angles)),
            Arithmetic::Fixed14 => Self::Fixed14(Rotation::new(&Tables::fixed(), angles)),
        }
    }

    pub(crate) fn view(&self, points: &[[i32; 3]], viewer: &Viewer) -> Vec<[i32; 3]> {
        let mut seen = points.to_vec();
        translate(&mut seen, viewer.eye.map(i32::saturating_neg));
        match self {
            Self::Float(rotation) => rotation.rotate(&mut seen),
            Self::Fixed10(rotation) => rotation.rotate(&mut seen),
            Self::Fixed8(rotation) => rotation.rotate(&mut seen),
            Self::Fixed14(rotation) => rotation.rotate(&mut seen),
        }
        seen
    }
}

/// How faces are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Surface {
    /// The lines around them.
    Wire,
    /// One colour a face.
    Flat,
    /// Intensities from corner to corner, where a face has some.
    Shaded,
    /// Textures, where a face has one; otherwise shaded.
    #[default]
    Textured,
    /// Textures under light that goes from corner to corner, where a face has one; otherwise shaded.
    Lit,
}

impl Surface {
    /// Whether faces that have a texture show it.
    pub(crate) fn has_textures(self) -> bool {
        matches!(self, Self::Textured | Self::Lit)
    }
}

/// What each stage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stages {
    /// Numbers of the rotation. Default fixed point with 10 fraction bits.
    pub arithmetic: Arithmetic,
    /// How faces are drawn. Default textured.
    pub surface: Surface,
    /// How textures are laid on. Default exact every 16 pixels.
    pub mapping: Mapping,
    /// Numbers of the mapping. Default 16 fraction bits without overflow.
    pub texture_arithmetic: TextureArithmetic,
    /// How lines and polygons are cut. Default precisely.
    pub search: Search,
    /// Whether polygons outside of the volume are thrown away before they are projected. Default yes.
    pub rejects_volume: bool,
    /// Whether polygons that cross the clipping plane are cut there; otherwise they are left out. Default yes.
    pub cuts_at_plane: bool,
    /// By perspective or parallel. Default perspective.
    pub projection: Projection,
    /// Logarithm of the focus, 0 to 16. Default 8.
    pub log_focus: u32,
    /// The clipping plane, above 0 (`C_plane`). Default 8 units.
    pub clip_plane: i32,
}

impl Default for Stages {
    fn default() -> Self {
        Self {
            arithmetic: Arithmetic::default(),
            surface: Surface::default(),
            mapping: Mapping::Subdivided(16),
            texture_arithmetic: TextureArithmetic::default(),
            search: Search::default(),
            rejects_volume: true,
            cuts_at_plane: true,
            projection: Projection::default(),
            log_focus: 8,
            clip_plane: 8,
        }
    }
}

impl Stages {
    /// The lens for a screen of this size.
    #[must_use]
    pub fn lens(&self, [width, height]: [usize; 2]) -> Lens {
        Lens { log_focus: self.log_focus, projection: self.projection, ..Lens::new(width, height) }
    }

    /// The clipping plane, at least 1.
    pub(crate) fn plane(&self) -> i32 {
        self.clip_plane.max(1)
    }
}

/// What became of the faces of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Counters {
    /// Faces of the world.
    pub faces: usize,
    /// Turned away.
    pub turned_away: usize,
    /// Outside of the volume.
    pub outside: usize,
    /// Crossing the clipping plane.
    pub crossing: usize,
    /// Drawn.
    pub drawn: usize,
}

/// A face in front of the clipping plane, in the integers of the library.
#[derive(Clone, Debug)]
pub(crate) struct SeenFace {
    /// x, y, z, the place in the texture, or the intensity and 0, and the light.
    pub(crate) corners: Vec<[i32; 6]>,
    /// The vectors of the texture.
    pub(crate) edges: [[i32; 3]; 2],
}

impl SeenFace {
    /// The texture's plane, at the farthest corner: there a unit of rounding weighs least.
    pub(crate) fn plane(&self, log_scale: u32) -> Option<TexturePlane> {
        let &[x, y, z, u, v, _] = self.corners.iter().max_by_key(|c| c[2])?;
        Some(TexturePlane {
            origin: [x, y, z],
            anchor: [u, v],
            u: self.edges[0],
            v: self.edges[1],
            log_scale,
        })
    }

    /// The corners on the screen with what they carry.
    pub(crate) fn on_screen(&self, lens: Lens) -> Vec<[i32; 4]> {
        let project = |&[x, y, z, a, b, _]: &[i32; 6]| lens.project([x, y, z]).map(|[x, y]| [x, y, a, b]);
        self.corners.iter().filter_map(project).collect()
    }

    /// The light at the corners that are on the screen.
    fn lights(&self, lens: Lens) -> Vec<i32> {
        let is_seen = |&&[x, y, z, ..]: &&[i32; 6]| lens.project([x, y, z]).is_some();
        self.corners.iter().filter(is_seen).map(|corner| corner[5]).collect()
    }
}

/// Bodies from the farthest to the nearest, the ground before all.
pub(crate) fn drawing_order(world: &World, eye: [i32; 3]) -> Vec<&Body> {
    let mut bodies: Vec<_> = world.bodies.iter().collect();
    let square = |a: i32, b: i32| i128::from(i64::from(a) - i64::from(b)).pow(2);
    let distance = |body: &Body| (0..3).map(|k| square(body.center[k], eye[k])).sum::<i128>();
    bodies.sort_by_cached_key(|body| (!body.is_ground, -distance(body)));
    bodies
}

/// The part of a face that is drawn, if any.
pub(crate) fn seen_face(
    face: &Face,
    points: &[[i32; 3]],
    stages: &Stages,
    counters: &mut Counters,
) -> Option<SeenFace> {
    let places: Vec<_> = face.corners.iter().map(|&i| points[i]).collect();
    let test = match test_volume(&places, stages.plane()) {
        // The pyramid is that of a perspective.
        VolumeTest::Outside if !stages.rejects_volume || stages.projection != Projection::Perspective => {
            VolumeTest::CrossesPlane
        }
        test => test,
    };
    let extra = |k: usize| match (face.texture, face.intensities.get(k)) {
        (Some(texture), _) if stages.surface.has_textures() => texture.corner(k).map(|t| t << CORNER_BITS),
        (_, Some(&intensity)) => [i32::from(intensity), 0],
        (_, None) => [i32::from(face.color), 0],
    };
    let whole = places.iter().enumerate().map(|(k, &[x, y, z])| {
        let [a, b] = extra(k);
        let light =
            face.texture.and_then(|texture| texture.light.get(k).copied()).unwrap_or(LightTable::FULL);
        [x, y, z, a, b, i32::from(light)]
    });
    let whole: Vec<_> = whole.collect();
    let corners = match test {
        VolumeTest::Outside => {
            counters.outside += 1;
            return None;
        }
        VolumeTest::Inside => whole,
        VolumeTest::CrossesPlane => {
            counters.crossing += 1;
            let bounds = Bounds::beyond(stages.plane());
            if stages.cuts_at_plane { clip_polygon(&whole, bounds, stages.search) } else { return None }
        }
    };
    let edge = |to: usize| match (places.first(), places.get(to)) {
        (Some(from), Some(to)) => std::array::from_fn(|k| to[k].saturating_sub(from[k])),
        _ => [0; 3],
    };
    (!corners.is_empty()).then(|| SeenFace { corners, edges: [edge(1), edge(3)] })
}

/// Draws the world as the viewer sees it.
pub fn draw_frame(world: &World, viewer: &Viewer, stages: &Stages, map: &mut ColorMap) -> Counters {
    let mut counters = Counters::default();
    map.pixels_mut().fill(world.sky);
    let eye = viewer.eye_of(stages.projection);
    let rotation = ViewerRotation::new(stages.arithmetic, viewer);
    for body in drawing_order(world, eye) {
        let points = rotation.view(&body.points, viewer);
        for face in &body.faces {
            counters.faces += 1;
            if !face.faces(body.points[face.corners[0]], eye) {
                counters.turned_away += 1;
            } else if let Some(seen) = seen_face(face, &points, stages, &mut counters) {
                counters.drawn += 1;
                draw_face(world, face, &seen, stages, map);
            }
        }
        for &([a, b], color) in &body.lines {
            draw_edge([points[a], points[b]], color, stages, map);
        }
    }
    counters
}

fn draw_face(world: &World, face: &Face, seen: &SeenFace, stages: &Stages, map: &mut ColorMap) {
    let lens = stages.lens(map.size());
    let corners = seen.on_screen(lens);
    let flat = || corners.iter().map(|c| [c[0], c[1]]).collect::<Vec<_>>();
    let texture =
        face.texture.and_then(|t| world.textures.get(t.index).map(|texture| (t.log_scale, texture)));
    match (stages.surface, texture) {
        (Surface::Wire, _) => {
            let corners = flat();
            for (i, &corner) in corners.iter().enumerate() {
                let line = [corner, corners[(i + 1) % corners.len()]];
                draw_line_by_address(map, line, face.color, stages.search);
            }
        }
        (Surface::Textured | Surface::Lit, Some((log_scale, texture))) => {
            draw_textured(seen, &corners, (log_scale, texture), &world.lights, stages, map);
        }
        (Surface::Shaded | Surface::Textured | Surface::Lit, _) if !face.intensities.is_empty() => {
            let corners: Vec<_> = corners.iter().map(|c| [c[0], c[1], c[2]]).collect();
            fill_shaded(map, &corners, stages.search);
        }
        _ => fill_flat(map, &flat(), face.color, stages.search, SpanFill::Library),
    }
}

fn draw_textured(
    seen: &SeenFace,
    corners: &[[i32; 4]],
    (log_scale, texture): (u32, &Texture),
    lights: &LightTable,
    stages: &Stages,
    map: &mut ColorMap,
) {
    let Some(plane) = seen.plane(log_scale) else { return };
    let lens = stages.lens(map.size());
    let plane = TextureMapping::new(&plane, lens, stages.texture_arithmetic);
    // Without perspective linear is exact.
    let mapping = match stages.projection {
        Projection::Perspective => stages.mapping,
        Projection::Parallel { .. } => Mapping::Affine,
    };
    let polygon = TexturedPolygon { corners, plane };
    if stages.surface == Surface::Lit {
        fill_lit(map, &polygon, &seen.lights(lens), (texture, lights), mapping, stages.search);
    } else {
        fill_textured(map, &polygon, texture, mapping, stages.search);
    }
}

/// Draws a line in space: cut at the plane, projected, cut on the screen.
fn draw_edge(line: [[i32; 3]; 2], color: u8, stages: &Stages, map: &mut ColorMap) {
    let lens = stages.lens(map.size());
    let Some(line) = clip_line(line, Bounds::beyond(stages.plane()), stages.search) else { return };
    if let (Some(a), Some(b)) = (lens.project(line.start), lens.project(line.end)) {
        draw_line_by_address(map, [a, b], color, stages.search);
    }
}

#[cfg(test)]
#[path = "frame_tests.rs"]
mod tests;
