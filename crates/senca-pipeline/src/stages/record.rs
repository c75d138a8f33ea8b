//! The record that all stages work on.

use senca_math::glam::{DVec3, DVec4, Vec2, Vec3};
use senca_math::{LinearRgb, View};
use senca_scene::Scene;

use crate::RenderError;
use crate::geometry::World;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertex {
    /// Homogeneous position: in the world with w = 1 at first, then in the canonical volume, then
    /// divided, then in pixels with the canonical z.
    pub position: DVec4,
    /// Unit normal of the original surface, in the world throughout.
    pub normal: Vec3,
    /// Light towards the observer, once the vertex is lit.
    pub light: LinearRgb,
    /// Alignment point in the texture.
    pub alignment: Vec2,
}

/// The triangle record (course text, section 2.3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Triangle {
    /// Corners, counter-clockwise seen from outside.
    pub vertices: [Vertex; 3],
    /// Number of the material in the scene; their count stands for the default material.
    pub material: usize,
    /// Number of the triangle in the list that the stages started from. Pieces cut from a triangle
    /// keep its number.
    pub original: u32,
}

impl Triangle {
    /// A triangle with corners in the world and nothing else.
    #[must_use]
    pub fn from_corners(corners: [DVec3; 3]) -> Self {
        let vertex = |p: DVec3| Vertex { position: p.extend(1.0), ..Vertex::default() };
        Self { vertices: corners.map(vertex), ..Self::default() }
    }

    /// The corners after division by w.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 3] {
        self.vertices.map(|v| v.position.truncate() / v.position.w)
    }

    /// `(P2 - P1) x (P3 - P1)`: the facet normal, not of unit length.
    #[must_use]
    pub fn facet_normal(&self) -> DVec3 {
        let [a, b, c] = self.corners();
        (b - a).cross(c - a)
    }
}

/// Stage 1: the scene as a list of triangles, silhouettes at most `tolerance_px` pixels off in a
/// picture of `width` by `height` pixels.
/// Source: course text, section 2.3.
///
/// # Errors
/// See [`RenderError`].
pub fn tessellate(
    scene: &Scene,
    view: &View,
    (width, height): (u32, u32),
    tolerance_px: f64,
) -> Result<Vec<Triangle>, RenderError> {
    let world = World::new(scene, view, [width, height], tolerance_px, false)?;
    let mut list = Vec::with_capacity(world.triangles as usize);
    for part in &world.parts {
        let (mesh, placed) = (world.mesh(part), &world.placed[part.placed]);
        let vertex = |c: u32| {
            let v = c as usize;
            let normal = mesh.vertices.normal.get(v).copied().unwrap_or_default();
            let place = placed.world_from_object.transform_point3(mesh.position(c).as_dvec3());
            Vertex {
                position: place.extend(1.0),
                normal: (placed.world_from_object_normals * normal).normalize_or_zero(),
                light: LinearRgb::BLACK,
                alignment: mesh.vertices.texcoord0.get(v).copied().unwrap_or_default(),
            }
        };
        for corners in world.corners(part).as_chunks::<3>().0 {
            let mut vertices = corners.map(vertex);
            if placed.mirrored {
                vertices.swap(1, 2);
            }
            list.push(Triangle { vertices, material: part.material, original: list.len() as u32 });
        }
    }
    Ok(list)
}
