//! Lines and points that meshes bring along, drawn among the faces.
//!
//! They are as opaque as their depth says, one colour across their width, and not lit: lines have no
//! normals (glTF 2.0, section 3.7.2.1, leaves them unlit too). Their identifiers follow those of the
//! triangles, lines first.

use senca_math::LinearRgb;
use senca_math::glam::{DVec2, Vec3, Vec4};
use senca_raster::{Counters, Ids, Primitives, Rasterizer, Shading, State, Target};
use senca_scene::Scene;
use senca_shading::apply_fog;

use crate::channel::Seen;
use crate::geometry::{World, material_index};
use crate::material::Model;
use crate::shade::Shader;
use crate::visibility::Window;

/// A line, or a point as a line from a vertex to itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Index into `World::placed`.
    placed: u32,
    /// Index into the materials.
    material: u32,
    /// Vertices of the mesh.
    ends: [u32; 2],
}

/// All lines and points of the world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strokes {
    /// Lines, then points.
    list: Vec<Stroke>,
    lines: usize,
}

impl Strokes {
    /// Those of the placed meshes.
    pub(crate) fn new(world: &World<'_>, scene: &Scene) -> Self {
        let mut strokes = Self::default();
        let of = |index: usize, ends: [u32; 2]| {
            let placed = &world.placed[index];
            let material = material_index(scene, placed, &world.meshes[placed.mesh], 0) as u32;
            Stroke { placed: index as u32, material, ends }
        };
        for (i, placed) in world.placed.iter().enumerate() {
            strokes.list.extend(world.meshes[placed.mesh].lines.iter().map(|&ends| of(i, ends)));
        }
        strokes.lines = strokes.list.len();
        for (i, placed) in world.placed.iter().enumerate() {
            strokes.list.extend(world.meshes[placed.mesh].dots.iter().map(|&v| of(i, [v, v])));
        }
        strokes
    }

    /// Number of lines and points.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Draws all into the depth and identifier planes of `target`.
    pub(crate) fn draw(
        &self,
        shader: &Shader<'_>,
        window: &Window,
        rasterizer: &mut dyn Rasterizer,
        target: &mut Target<'_>,
    ) -> Counters {
        let mut counters = Counters::default();
        if self.list.is_empty() {
            return counters;
        }
        let (lines, points) = self.list.split_at(self.lines);
        let first = shader.world.triangles;
        let wire = &shader.settings.wire;
        let state = State {
            viewport: Some(window.viewport()),
            line_width: wire.width,
            point_size: wire.point_size,
            ..State::default()
        };
        let padded_from_clip = window.padded_from_clip();
        let place = |stroke: &Stroke, end: usize| -> Vec4 {
            let placed = &shader.world.placed[stroke.placed as usize];
            let mesh = &shader.world.meshes[placed.mesh];
            let padded_from_object = padded_from_clip * shader.clip_from_object[stroke.placed as usize];
            (padded_from_object * mesh.position(stroke.ends[end]).as_dvec3().extend(1.0)).as_vec4()
        };
        let ends: Vec<Vec4> = lines.iter().flat_map(|s| [place(s, 0), place(s, 1)]).collect();
        let dots: Vec<Vec4> = points.iter().map(|s| place(s, 0)).collect();
        let indices: Vec<u32> = (0..ends.len().max(dots.len()) as u32).collect();
        let of = |positions, count: usize, first| Primitives {
            positions,
            varyings: &[],
            stride: 0,
            indices: &indices[..count],
            ids: Ids::From(first),
        };
        counters += rasterizer.draw_lines(target, &of(&ends, ends.len(), first), &state, &Shading::None);
        let first = first + lines.len() as u32;
        counters += rasterizer.draw_points(target, &of(&dots, dots.len(), first), &state, &Shading::None);
        counters
    }

    /// Colour of the line or point `index` at (x, y), pixels of the picture.
    pub(crate) fn shade(&self, shader: &Shader<'_>, index: usize, x: f64, y: f64) -> [f32; 4] {
        let stroke = self.list[index];
        let mesh = &shader.world.meshes[shader.world.placed[stroke.placed as usize].mesh];
        let (t, position) = stroke.nearest(shader, x, y);
        let vertex_color = |k: usize| {
            let colors = &mesh.vertices.color;
            colors.get(stroke.ends[k] as usize).copied().unwrap_or(Vec4::ONE)
        };
        let [r, g, b, _] = vertex_color(0).lerp(vertex_color(1), t).to_array();
        let material = &shader.materials[stroke.material as usize];
        let base = match &material.model {
            Model::Phong { constants, .. } => constants.diffuse,
            Model::MetallicRoughness { base_color, .. } => *base_color,
        };
        let color = base * LinearRgb::new(r, g, b) + material.emission;
        let LinearRgb { r, g, b } = match &shader.fog {
            Some(fog) => apply_fog(fog, color, shader.distance(position)),
            None => color,
        };
        [r, g, b, 1.0]
    }

    /// What is seen of the line or point `index` at (x, y).
    pub(crate) fn seen(&self, shader: &Shader<'_>, index: usize, x: f64, y: f64) -> Seen {
        let stroke = self.list[index];
        let (_, position) = stroke.nearest(shader, x, y);
        let id = shader.world.triangles + index as u32;
        Seen { placed: stroke.placed as usize, id, position, normal: Vec3::ZERO }
    }
}

impl Stroke {
    /// The place that is seen nearest to (x, y): its parameter from end to end, and where it is in the
    /// world.
    fn nearest(&self, shader: &Shader<'_>, x: f64, y: f64) -> (f32, Vec3) {
        let placed = &shader.world.placed[self.placed as usize];
        let ends = self.ends.map(|v| shader.world.meshes[placed.mesh].position(v));
        let clip_from_object = &shader.clip_from_object[self.placed as usize];
        let pixels = ends.map(|p| shader.grid.homogeneous(clip_from_object, p.as_dvec3()));
        let t = nearest_on_line(pixels.map(|p| (p.truncate(), p.z)), DVec2::new(x, y));
        (t, placed.world_from_object_f32.transform_point3(ends[0].lerp(ends[1], t)))
    }
}

/// Parameter in space of the place of a line that is seen nearest to `pixel`. Ends come as `(x w, y w)`
/// and w; a line that reaches behind the eye gives its middle.
fn nearest_on_line([(a, wa), (b, wb)]: [(DVec2, f64); 2], pixel: DVec2) -> f32 {
    if !(wa > 0.0 && wb > 0.0) {
        return 0.5;
    }
    let (a, b) = (a / wa, b / wb);
    let along = b - a;
    let t = ((pixel - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    // From the picture to space: weights are divided by w.
    let (u, v) = ((1.0 - t) / wa, t / wb);
    (v / (u + v)) as f32
}
