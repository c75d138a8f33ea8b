//! Polygon meshes with shared points.
//!
//! A mesh has two levels. *Points* are places; each is stored once and shared by all faces around
//! it. *Vertices* are points seen from one surface: they carry the normal, texture coordinates and
//! colour that a face corner uses, so a point on a crease between two surfaces has one vertex, and
//! thus one normal, per surface (1991 thesis, section 9). Face corners name vertices.

use senca_math::Aabb;
use senca_math::glam::{Vec2, Vec3, Vec4};

use crate::MaterialId;

/// A polygon mesh. See the module's text for points and vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions in object space.
    pub points: Vec<Vec3>,
    /// Corner attributes, shared between the faces of one surface.
    pub vertices: Vertices,
    /// Polygons over the vertices.
    pub faces: Faces,
    /// Surfaces that faces belong to; never empty when there are faces.
    pub surfaces: Vec<Surface>,
    /// Line segments between vertices.
    pub lines: Vec<[u32; 2]>,
    /// Single vertices drawn as dots.
    pub dots: Vec<u32>,
    /// Offsets that are blended in by the node's weights.
    pub morph_targets: Vec<MorphTarget>,
    /// Influences of a skin's joints, one entry per point, or empty.
    pub joints: Vec<JointInfluence>,
}

/// Attributes of vertices as parallel arrays. `point` gives the count; every other array is either
/// empty (attribute absent) or as long as `point`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertices {
    /// Index of the vertex's place in `Mesh::points`.
    pub point: Vec<u32>,
    /// Unit normals in object space. Absent: computed from the faces when needed.
    pub normal: Vec<Vec3>,
    /// Texture coordinates, set 0; (0, 0) is the *top left* corner of the picture.
    pub texcoord0: Vec<Vec2>,
    /// Texture coordinates, set 1.
    pub texcoord1: Vec<Vec2>,
    /// Linear colour and alpha that multiplies the material's base colour.
    pub color: Vec<Vec4>,
    /// Unit tangent along increasing u, and in `w` the sign of the bitangent `w * (n x t)`.
    pub tangent: Vec<Vec4>,
}

/// Polygons with three or more corners, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faces {
    /// Vertex index of every corner, face after face.
    pub corners: Vec<u32>,
    /// Where each face begins in `corners`, with one more entry for the end: face `f` has the
    /// corners `starts[f]..starts[f + 1]`. Empty stands for triangles throughout.
    pub starts: Vec<u32>,
    /// Index into `Mesh::surfaces` per face. Empty stands for surface 0 throughout.
    pub surface: Vec<u32>,
}

/// A group of faces that share a material and are smooth among themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name from the file, or empty.
    pub name: String,
    /// Material; `None` falls back to the geometry's, then to the default material.
    pub material: Option<MaterialId>,
    /// Whether normals that the file does not give are averaged over the surface's faces. Default
    /// true; false gives each face its own normal.
    pub smooth: bool,
    /// Smooth surfaces of the same number share normals where they meet, as the materials of one body
    /// do. 0, the default: with no other surface.
    pub smoothing_group: u32,
}

impl Default for Surface {
    fn default() -> Self {
        Self { name: String::new(), material: None, smooth: true, smoothing_group: 0 }
    }
}

/// Offsets of one morph target; each array is empty or as long as what it offsets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// Name from the file, or empty.
    pub name: String,
    /// Added to `Mesh::points`, times the weight.
    pub points: Vec<Vec3>,
    /// Added to `Vertices::normal`, times the weight.
    pub normals: Vec<Vec3>,
    /// Added to the first three components of `Vertices::tangent`, times the weight.
    pub tangents: Vec<Vec3>,
}

/// Up to four joints that pull at a point, with weights that sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointInfluence {
    /// Indices into `Skin::joints`.
    pub joints: [u16; 4],
    /// Weights, each in [0, 1].
    pub weights: [f32; 4],
}

impl Faces {
    /// Number of faces.
    #[must_use]
    pub fn len(&self) -> usize {
        if self.starts.is_empty() { self.corners.len() / 3 } else { self.starts.len() - 1 }
    }

    /// Whether there is no face.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Vertex indices of face `face`.
    ///
    /// # Panics
    /// When `face` is not below [`Faces::len`].
    #[must_use]
    pub fn corners_of(&self, face: usize) -> &[u32] {
        if self.starts.is_empty() {
            &self.corners[3 * face..][..3]
        } else {
            &self.corners[self.starts[face] as usize..self.starts[face + 1] as usize]
        }
    }

    /// Surface of face `face`.
    #[must_use]
    pub fn surface_of(&self, face: usize) -> u32 {
        self.surface.get(face).copied().unwrap_or(0)
    }

    /// The faces one after the other.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.len()).map(|face| self.corners_of(face))
    }

    /// Appends a face of `corners` on `surface`.
    pub fn push(&mut self, corners: &[u32], surface: u32) {
        let faces_before = self.len();
        if self.starts.is_empty() && (corners.len() != 3 || !self.corners.len().is_multiple_of(3)) {
            self.starts = (0..=faces_before as u32).map(|f| 3 * f).collect();
        }
        if self.surface.is_empty() && surface != 0 {
            self.surface = vec![0; faces_before];
        }
        if !self.surface.is_empty() || surface != 0 {
            self.surface.push(surface);
        }
        self.corners.extend_from_slice(corners);
        if !self.starts.is_empty() {
            self.starts.push(self.corners.len() as u32);
        }
    }

    /// Number of triangles that the faces split into: corners minus two for each face.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.iter().map(|face| face.len().saturating_sub(2)).sum()
    }
}

impl Mesh {
    /// Place of vertex `vertex`.
    ///
    /// # Panics
    /// When `vertex` is out of range.
    #[must_use]
    pub fn position(&self, vertex: u32) -> Vec3 {
        self.points[self.vertices.point[vertex as usize] as usize]
    }

    /// Bounds of the points in object space.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.points.iter().map(|p| p.as_dvec3()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_stay_triangles_until_another_polygon_comes() {
        let mut faces = Faces::default();
        faces.push(&[0, 1, 2], 0);
        assert!(faces.starts.is_empty() && faces.surface.is_empty());
        faces.push(&[0, 2, 3, 4], 1);
        assert_eq!((faces.len(), faces.triangle_count()), (2, 3));
        assert_eq!(faces.corners_of(0), [0, 1, 2]);
        assert_eq!(faces.corners_of(1), [0, 2, 3, 4]);
        assert_eq!((faces.surface_of(0), faces.surface_of(1)), (0, 1));
        faces.push(&[7, 8, 9], 0);
        assert_eq!((faces.corners_of(2), faces.surface_of(2)), (&[7, 8, 9][..], 0));
    }
}
