//! [`draw_frame`](super::draw_frame) by the reference: double precision from the eye to the texel.

use super::angle::Tables;
use super::color_map::ColorMap;
use super::frame::{Stages, Surface, Viewer, drawing_order};
use super::line::draw_line_by_address;
use super::project::{Lens, Projection};
use super::reference::{ExactPlane, clip_exact, for_each_pixel_within, project_corners};
use super::rotate::Rotation;
use super::scene::{Face, World};
use super::texture::{TEXEL_BITS, Texture};

/// Points as the viewer has them, exactly.
#[must_use]
pub fn view_exact(points: &[[i32; 3]], viewer: &Viewer) -> Vec<[f64; 3]> {
    ExactRotation::new(viewer).view(points)
}

/// The exact rotation for a viewer; looked up once for a picture.
pub(crate) struct ExactRotation {
    eye: [f64; 3],
    rotation: Rotation<f64>,
}

impl ExactRotation {
    pub(crate) fn new(viewer: &Viewer) -> Self {
        let rotation = Rotation::new(&Tables::exact(), viewer.angles());
        Self { eye: viewer.eye.map(f64::from), rotation }
    }

    pub(crate) fn view(&self, points: &[[i32; 3]]) -> Vec<[f64; 3]> {
        let place = |p: &[i32; 3]| std::array::from_fn(|k| f64::from(p[k]) - self.eye[k]);
        points.iter().map(|p| self.rotation.rotate_exact(place(p))).collect()
    }
}

/// Where the texture of a face lies in the exact space of the viewer; `None` for a face without one.
#[must_use]
pub(crate) fn exact_plane(face: &Face, points: &[[f64; 3]]) -> Option<ExactPlane> {
    let texture = face.texture?;
    let corner = |k: usize| face.corners.get(k).and_then(|&i| points.get(i)).copied();
    let (origin, along_u, along_v) = (corner(0)?, corner(1)?, corner(3)?);
    let from_origin = |p: [f64; 3]| std::array::from_fn(|k| p[k] - origin[k]);
    let texels = f64::from(1 << texture.log_scale.min(15));
    Some(ExactPlane { origin, anchor: [0.0; 2], u: from_origin(along_u), v: from_origin(along_v), texels })
}

/// Draws the world as the viewer sees it, exactly. Of the stages, the way faces are drawn, the projection, the focus and
/// the clipping plane matter.
pub fn draw_frame_exactly(world: &World, viewer: &Viewer, stages: &Stages, map: &mut ColorMap) {
    map.pixels_mut().fill(world.sky);
    let eye = viewer.eye_of(stages.projection);
    let rotation = ExactRotation::new(viewer);
    for body in drawing_order(world, eye) {
        let points = rotation.view(&body.points);
        for face in &body.faces {
            if face.faces(body.points[face.corners[0]], eye) {
                draw_face(world, face, &points, stages, map);
            }
        }
        for &([a, b], color) in &body.lines {
            draw_edge(&[points[a], points[b]], color, stages, map);
        }
    }
}

/// Corners of a face that are drawn: column, row, depth, and the intensity; or the light, if it is lit.
fn seen_corners(face: &Face, points: &[[f64; 3]], stages: &Stages, lens: Lens) -> Vec<[f64; 4]> {
    let intensity = |k: usize| match face.texture {
        Some(texture) if stages.surface == Surface::Lit => f64::from(texture.light[k % 4]),
        _ => f64::from(*face.intensities.get(k).unwrap_or(&face.color)),
    };
    let corner = |(k, &i): (usize, &usize)| [points[i][0], points[i][1], points[i][2], intensity(k)];
    let corners: Vec<_> = face.corners.iter().enumerate().map(corner).collect();
    project_corners(&clip_exact(&corners, f64::from(stages.plane())), lens)
}

fn draw_face(world: &World, face: &Face, points: &[[f64; 3]], stages: &Stages, map: &mut ColorMap) {
    let lens = stages.lens(map.size());
    let corners = seen_corners(face, points, stages, lens);
    let texture = face.texture.and_then(|t| world.textures.get(t.index));
    match (stages.surface, texture, exact_plane(face, points)) {
        (Surface::Wire, ..) => {
            for (i, a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                draw_line_by_address(map, [nearest(a), nearest(&b)], face.color, stages.search);
            }
        }
        (Surface::Textured | Surface::Lit, Some(texture), Some(plane)) => {
            let seen = Seen { lens, face, points, texture, plane };
            for_each_pixel_within(&corners, map.size(), |x, y, v| {
                let color = seen.color(x, y);
                let is_lit = stages.surface == Surface::Lit;
                map.dot(x, y, if is_lit { world.lights.color(color, v[3] as i64) } else { color });
            });
        }
        (Surface::Shaded | Surface::Textured | Surface::Lit, ..) if !face.intensities.is_empty() => {
            for_each_pixel_within(&corners, map.size(), |x, y, v| map.dot(x, y, v[3] as u8));
        }
        _ => for_each_pixel_within(&corners, map.size(), |x, y, _| map.dot(x, y, face.color)),
    }
}

/// A textured face as it is seen.
struct Seen<'a> {
    lens: Lens,
    face: &'a Face,
    points: &'a [[f64; 3]],
    texture: &'a Texture,
    plane: ExactPlane,
}

impl Seen<'_> {
    fn color(&self, x: i32, y: i32) -> u8 {
        let (column, row) = (f64::from(x), f64::from(y));
        let place = match self.lens.projection {
            Projection::Perspective => self.plane.at(self.lens, column, row),
            Projection::Parallel { .. } => self.place_in_parallel(column, row),
        };
        let fixed = |t: f64| (t * f64::from(1 << TEXEL_BITS)).floor() as i64;
        place.map_or(self.face.color, |place| self.texture.color(place.map(fixed)))
    }

    /// Without perspective the edges on the screen span the texture.
    fn place_in_parallel(&self, column: f64, row: f64) -> Option<[f64; 2]> {
        let corner = |k: usize| self.lens.project_exact(self.points[self.face.corners[k]]);
        let [o, u, v] = [corner(0), corner(1), corner(3)];
        let [u, v, p] = [u, v, [column, row]].map(|q| [q[0] - o[0], q[1] - o[1]]);
        let area = u[0] * v[1] - u[1] * v[0];
        let share = |a: [f64; 2], b: [f64; 2]| (a[0] * b[1] - a[1] * b[0]) / area * self.plane.texels;
        (area != 0.0).then(|| [share(p, v), share(u, p)])
    }
}

fn draw_edge(line: &[[f64; 3]; 2], color: u8, stages: &Stages, map: &mut ColorMap) {
    let lens = stages.lens(map.size());
    // A polygon of two corners: cut at the plane, it has a corner twice or three of them.
    let seen = project_corners(&clip_exact(line, f64::from(stages.plane())), lens);
    if let [a, b, ..] = &seen[..] {
        draw_line_by_address(map, [nearest(a), nearest(b)], color, stages.search);
    }
}

fn nearest<const N: usize>(corner: &[f64; N]) -> [i32; 2] {
    [corner[0].round() as i32, corner[1].round() as i32]
}
