//! The mesh of patches over a scene, and the elements they are divided into.
//!
//! Each plane polygon of the scene is the root of a tree. An element is a node of such a tree: a whole
//! polygon or a part of one, with 2 or 4 parts of its own or none. All division is at the middle of
//! edges, so that elements that share an edge share the vertices on it, whichever is divided deeper.
//!
//! A vertex is a place seen from one smooth face: where faces meet at an edge that is to stay visible
//! each has its own vertices (course text, section 4.1, figure 4.4).

mod attributes;
mod build;
mod divide;
mod inside;
mod paint;
mod places;
mod restore;
#[cfg(test)]
mod scene_tests;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use senca_math::glam::DVec3;
use senca_math::{Aabb, LinearRgb};
use senca_scene::Warning;

use crate::PatchPolygon;

pub use attributes::CornerAttributes;
pub use build::{MeshSettings, Sides};
pub(crate) use divide::MAX_LEVEL;
pub(crate) use places::{Corner, Outline, Places};
pub(crate) use restore::MeshSeed;

/// Stands for "none" among indices.
pub const NONE: u32 = u32::MAX;

/// A plane polygon of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polygon {
    /// Index into [`ElementMesh::surfaces`].
    pub surface: u32,
    /// Unit normal of the front.
    pub normal: DVec3,
}

/// What polygons are made of: one material of one object, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiantSurface {
    /// Number of the object among the scene's instances.
    pub instance: u32,
    /// Index of the material; the scene's count stands for the default material.
    pub material: u32,
    /// Whether this is the back of a surface with two sides.
    pub back: bool,
    /// Reflectance of matt reflection, per channel in [0, 1]; pictures on the surface count by their
    /// average.
    pub reflectance: LinearRgb,
    /// Light of its own, as shown.
    pub emission: LinearRgb,
    /// Share of light that passes through the surface unbent, per channel in [0, 1]; black where it is
    /// opaque.
    pub transmittance: LinearRgb,
}

/// A polygon, or a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Vertices, counter-clockwise from the front; the last is [`NONE`] in a triangle.
    pub vertices: [u32; 4],
    /// The polygon it is part of, which is also the number of the polygon's root element.
    pub polygon: u32,
    /// The element it is part of, or [`NONE`].
    pub parent: u32,
    /// The first of its parts, which follow each other, or [`NONE`].
    pub first_part: u32,
    /// Number of parts: 0, 2 or 4.
    pub parts: u8,
    /// Divisions between the polygon and this.
    pub level: u8,
    /// In square world units.
    pub area: f64,
    /// Centroid.
    pub center: DVec3,
    /// Share of the area that light can reach, in [0, 1]: less than 1 where a body stands on it, or it
    /// goes on in one. Light that is said to arrive at an element arrives at its open part.
    pub open: f32,
}

/// Polygons and elements over a scene, in world space. Elements `0..polygons().len()` are the roots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementMesh {
    positions: Vec<DVec3>,
    vertex_normals: Vec<DVec3>,
    surfaces: Vec<RadiantSurface>,
    polygons: Vec<Polygon>,
    elements: Vec<Element>,
    /// The vertex in the middle of an edge, by the edge's vertices in ascending order.
    midpoints: HashMap<[u32; 2], u32>,
    /// Per polygon, in the order of its vertices; empty where the scene has neither texture coordinates
    /// nor colours of vertices.
    attributes: Vec<[CornerAttributes; 4]>,
}

impl Element {
    /// The vertices, 3 or 4.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        if self.vertices[3] == NONE { &self.vertices[..3] } else { &self.vertices }
    }

    /// Whether it is not divided.
    #[must_use]
    pub const fn is_leaf(&self) -> bool {
        self.parts == 0
    }

    /// Area of the open part, in square world units.
    #[must_use]
    pub fn open_area(&self) -> f64 {
        self.area * f64::from(self.open)
    }

    /// Numbers of its parts; none for a leaf.
    #[must_use]
    pub const fn part_numbers(&self) -> std::ops::Range<u32> {
        match self.parts {
            0 => 0..0,
            n => self.first_part..self.first_part + n as u32,
        }
    }
}

impl ElementMesh {
    /// All elements; the first are the polygons' roots.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The polygons of the scene.
    #[must_use]
    pub fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// The surfaces of the polygons.
    #[must_use]
    pub fn surfaces(&self) -> &[RadiantSurface] {
        &self.surfaces
    }

    /// Places of the vertices, in world space.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Unit normals to show the vertices with, on the front.
    #[must_use]
    pub fn vertex_normals(&self) -> &[DVec3] {
        &self.vertex_normals
    }

    /// Numbers of the elements that are not divided, in ascending order.
    pub fn leaves(&self) -> impl Iterator<Item = u32> + '_ {
        (0..).zip(&self.elements).filter(|(_, element)| element.is_leaf()).map(|(number, _)| number)
    }

    /// The shape of an element.
    #[must_use]
    pub fn shape(&self, element: u32) -> PatchPolygon {
        let at = |vertex: u32| self.positions[vertex as usize];
        match self.elements[element as usize].vertices {
            [a, b, c, NONE] => PatchPolygon::triangle([a, b, c].map(at)),
            quad => PatchPolygon::quad(quad.map(at)),
        }
    }

    /// Unit normal of the front of an element.
    #[must_use]
    pub fn normal(&self, element: u32) -> DVec3 {
        self.polygons[self.elements[element as usize].polygon as usize].normal
    }

    /// What an element is made of.
    #[must_use]
    pub fn surface(&self, element: u32) -> &RadiantSurface {
        let polygon = self.elements[element as usize].polygon;
        &self.surfaces[self.polygons[polygon as usize].surface as usize]
    }

    /// Sets the share of an element that light can reach, in [0, 1].
    pub fn set_open(&mut self, element: u32, share: f32) {
        self.elements[element as usize].open = share;
    }

    /// Lets a share of light pass through a surface, per channel in [0, 1].
    pub fn set_transmittance(&mut self, surface: u32, share: LinearRgb) {
        self.surfaces[surface as usize].transmittance = share;
    }

    /// Holds reflectances to `limit` per channel, and takes negative ones and those that are not a
    /// number as 0. Tells how many surfaces were changed.
    pub fn limit_reflectance(&mut self, limit: f32) -> usize {
        let held = |r: f32| if r > 0.0 { r.min(limit) } else { 0.0 };
        let change = |surface: &mut RadiantSurface| {
            let new = surface.reflectance.map(held);
            std::mem::replace(&mut surface.reflectance, new) != new
        };
        self.surfaces.iter_mut().map(change).filter(|changed| *changed).count()
    }

    /// [`ElementMesh::limit_reflectance`], and what to tell of it.
    pub fn hold_reflectance(&mut self, limit: f32) -> Option<Warning> {
        let held = self.limit_reflectance(limit);
        let what = if held == 1 { "surface reflects" } else { "surfaces reflect" };
        (held > 0).then(|| Warning(format!("{held} {what} more than {limit} of the light: taken as {limit}")))
    }

    /// Box around the polygons.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.positions.iter().copied())
    }

    /// Sum of the areas of all polygons, in square world units.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.elements[..self.polygons.len()].iter().map(|element| element.area).sum()
    }

    /// Bytes of memory that the mesh holds on to.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.vertex_normals)
            + size_of_val(&*self.surfaces)
            + size_of_val(&*self.polygons)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.attributes)
            + self.midpoints.capacity() * (size_of::<([u32; 2], u32)>() + 1)
    }
}
