//! Texture coordinates by the transformation method, inside the fast path.

use senca_math::glam::DVec2;

use crate::material::TexturePoint;
use crate::shade::{Shader, world_of_pixel};
use crate::stages::TextureFrame;
use crate::surface::TriangleSetup;

/// Texture coordinates at a pixel: back through the view to the scene, and from there through the
/// triangle's frame into the picture. Derivatives come from the neighbours on the triangle's plane.
/// Source: course text, section 2.11, equation 2.22.
pub(crate) fn coordinates_by_transformation(
    shader: &Shader<'_>,
    triangle: &TriangleSetup<'_>,
    [x, y]: [f64; 2],
    depth: f32,
    set: u32,
) -> TexturePoint {
    let interpolated = triangle.texture_point(x, y, set);
    let Some(uvs) = triangle.corner_uvs(set) else { return interpolated };
    let to_world = &triangle.placed.world_from_object;
    let places = triangle.corners.map(|c| to_world.transform_point3(triangle.mesh.position(c).as_dvec3()));
    let Some(frame) = TextureFrame::new(places, uvs.map(|uv| uv.as_dvec2())) else { return interpolated };
    let seen = world_of_pixel(&shader.view, &shader.grid, [x, y], f64::from(depth));
    let uv: DVec2 = frame.coordinates(seen);
    TexturePoint { uv: uv.as_vec2(), ..interpolated }
}
