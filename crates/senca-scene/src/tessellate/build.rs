//! Appends points, vertices and faces to a mesh that grows.

use senca_math::glam::{DVec2, DVec3};

use crate::{Mesh, Surface};

/// A mesh that grows, with normals and texture coordinates at every vertex.
pub(super) struct Builder {
    /// What there is so far.
    pub mesh: Mesh,
    /// Whether flat quadrilaterals and polygons stay whole.
    pub polygons: bool,
}

impl Builder {
    pub(super) fn new(polygons: bool) -> Self {
        Self { mesh: Mesh::default(), polygons }
    }

    /// A new surface; returns its number.
    pub(super) fn surface(&mut self, name: &str) -> u32 {
        self.mesh.surfaces.push(Surface { name: name.to_owned(), ..Surface::default() });
        self.mesh.surfaces.len() as u32 - 1
    }

    /// A new point; returns its index.
    pub(super) fn point(&mut self, p: DVec3) -> u32 {
        self.mesh.points.push(p.as_vec3());
        self.mesh.points.len() as u32 - 1
    }

    /// A new vertex at `point`; returns its index.
    pub(super) fn vertex(&mut self, point: u32, normal: DVec3, texcoord: DVec2) -> u32 {
        let vertices = &mut self.mesh.vertices;
        vertices.point.push(point);
        vertices.normal.push(normal.as_vec3());
        vertices.texcoord0.push(texcoord.as_vec2());
        vertices.point.len() as u32 - 1
    }

    /// A triangle of vertices; nothing when two corners are at the same point.
    pub(super) fn triangle(&mut self, corners: [u32; 3], surface: u32) {
        let [a, b, c] = corners.map(|v| self.mesh.vertices.point[v as usize]);
        if a != b && b != c && c != a {
            self.mesh.faces.push(&corners, surface);
        }
    }

    /// A quadrilateral of vertices in order around it. Kept whole where polygons are wanted and it is
    /// flat, otherwise split (see [`crate::split_quad`]).
    pub(super) fn quad(&mut self, corners: [u32; 4], surface: u32) {
        let points = corners.map(|v| self.mesh.vertices.point[v as usize]);
        if let Some(i) = (0..4).find(|&i| points[i] == points[(i + 1) % 4]) {
            // One side has shrunk to a point: the other three corners are left.
            return self
                .triangle([corners[(i + 1) % 4], corners[(i + 2) % 4], corners[(i + 3) % 4]], surface);
        }
        let places = points.map(|p| self.mesh.points[p as usize]);
        if self.polygons && crate::is_flat_quad(places) {
            return self.mesh.faces.push(&corners, surface);
        }
        for triangle in crate::split_quad(places) {
            self.triangle(triangle.map(|i| corners[i]), surface);
        }
    }
}
