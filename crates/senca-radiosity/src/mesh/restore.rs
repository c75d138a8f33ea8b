//! A mesh from what little decides it: its polygons, and which elements were divided in which order.

use senca_math::glam::DVec3;

use super::{CornerAttributes, ElementMesh, RadiantSurface};

/// What a mesh is made of. Everything else follows, since division has no choices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MeshSeed {
    /// Place and normal of each vertex of the polygons.
    pub(crate) vertices: Vec<[DVec3; 2]>,
    pub(crate) surfaces: Vec<RadiantSurface>,
    /// Vertices (the last is [`super::NONE`] in a triangle) and surface of each polygon.
    pub(crate) polygons: Vec<([u32; 4], u32)>,
    /// Of each polygon, or none.
    pub(crate) attributes: Vec<[CornerAttributes; 4]>,
    /// Elements that are divided, in the order of their division.
    pub(crate) divided: Vec<u32>,
    /// Elements that are not wholly open, and what share of them is.
    pub(crate) open: Vec<(u32, f32)>,
}

impl ElementMesh {
    /// What the mesh is made of.
    pub(crate) fn seed(&self) -> MeshSeed {
        let of_polygons = self.positions.len() - self.midpoints.len();
        let vertices = self.positions.iter().zip(&self.vertex_normals).take(of_polygons);
        let polygons = self.polygons.iter().zip(&self.elements);
        let mut divided: Vec<u32> = (0..self.elements.len() as u32).collect();
        divided.retain(|&element| !self.elements[element as usize].is_leaf());
        divided.sort_by_key(|&element| self.elements[element as usize].first_part);
        MeshSeed {
            vertices: vertices.map(|(&position, &normal)| [position, normal]).collect(),
            surfaces: self.surfaces.clone(),
            polygons: polygons.map(|(polygon, root)| (root.vertices, polygon.surface)).collect(),
            attributes: self.attributes.clone(),
            divided,
            open: (0..).zip(&self.elements).filter(|(_, e)| e.open < 1.0).map(|(i, e)| (i, e.open)).collect(),
        }
    }

    /// The mesh of a seed; `None` where the seed does not hold together or leads to more than
    /// `max_elements`.
    pub(crate) fn of_seed(seed: &MeshSeed, max_elements: usize) -> Option<Self> {
        let attributes = seed.attributes.clone();
        let mut mesh = Self { surfaces: seed.surfaces.clone(), attributes, ..Self::default() };
        for &[position, normal] in &seed.vertices {
            mesh.push_vertex(position, normal);
        }
        let count = seed.vertices.len();
        for (number, (vertices, surface)) in seed.polygons.iter().enumerate() {
            let corners = if vertices[3] == super::NONE { &vertices[..3] } else { &vertices[..] };
            let known = corners.iter().all(|&v| (v as usize) < count);
            if !known || *surface as usize >= mesh.surfaces.len() {
                return None;
            }
            mesh.push_polygon(corners, *surface);
            if mesh.polygons.len() != number + 1 {
                return None;
            }
        }
        if ![0, mesh.polygons.len()].contains(&mesh.attributes.len()) {
            return None;
        }
        for &element in &seed.divided {
            let there = (element as usize) < mesh.elements.len();
            if !there || !mesh.divide(element) || mesh.elements.len() > max_elements {
                return None;
            }
        }
        for &(element, share) in &seed.open {
            mesh.elements.get_mut(element as usize)?.open = share;
        }
        Some(mesh)
    }
}
