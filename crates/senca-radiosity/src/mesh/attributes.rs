//! What corners of polygons carry beside their place.

use senca_math::glam::{DVec3, Vec2, Vec4};
use senca_scene::Mesh;

use super::ElementMesh;

/// Texture coordinates and colour at a corner of a polygon, or within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerAttributes {
    /// Texture coordinates of sets 0 and 1; (0, 0) is the top left corner of the picture.
    pub texcoords: [Vec2; 2],
    /// Colour that multiplies the material's.
    pub color: Vec4,
}

impl Default for CornerAttributes {
    fn default() -> Self {
        Self { texcoords: [Vec2::ZERO; 2], color: Vec4::ONE }
    }
}

impl CornerAttributes {
    /// Of a vertex of a mesh.
    pub(super) fn of_vertex(mesh: &Mesh, vertex: u32) -> Self {
        let (vertices, i) = (&mesh.vertices, vertex as usize);
        let texcoord = |list: &[Vec2]| list.get(i).copied().unwrap_or_default();
        Self {
            texcoords: [texcoord(&vertices.texcoord0), texcoord(&vertices.texcoord1)],
            color: vertices.color.get(i).copied().unwrap_or(Vec4::ONE),
        }
    }

    fn add(&mut self, other: &Self, weight: f32) {
        for set in 0..2 {
            self.texcoords[set] += other.texcoords[set] * weight;
        }
        self.color += other.color * weight;
    }
}

impl ElementMesh {
    /// Whether any polygon has texture coordinates or colours of its own.
    pub(crate) fn has_attributes(&self) -> bool {
        !self.attributes.is_empty()
    }

    /// Multiplies what surfaces give off.
    pub(crate) fn scale_emission(&mut self, factor: f32) {
        self.surfaces.iter_mut().for_each(|surface| surface.emission *= factor);
    }

    /// Texture coordinates and colour at a place of a polygon.
    #[must_use]
    pub fn attributes_at(&self, polygon: u32, place: DVec3) -> CornerAttributes {
        let Some(corners) = self.attributes.get(polygon as usize) else { return CornerAttributes::default() };
        let weights = self.shape(polygon).weights_at(place);
        let mut sum = CornerAttributes { texcoords: [Vec2::ZERO; 2], color: Vec4::ZERO };
        corners.iter().zip(weights).for_each(|(corner, weight)| sum.add(corner, weight as f32));
        sum
    }
}
