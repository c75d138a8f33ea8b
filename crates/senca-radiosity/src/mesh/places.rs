//! Outlines of elements with all that neighbours have put on them.
//!
//! A vertex belongs to one smooth face. Where faces meet, each has its own vertices at the same places,
//! and where one is divided deeper than the other, the outline of the other passes places it has no vertex
//! for. Drawn without them, the two would not share an edge, and pixels of what is behind would show
//! through (T-vertices).

use std::collections::HashMap;

use senca_math::glam::DVec3;
use smallvec::SmallVec;

use super::{ElementMesh, NONE};

/// Places of a mesh, each once, whatever the number of vertices there.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    of_vertex: Vec<u32>,
    /// The place in the middle of two others, where some element has a vertex, by ascending number.
    middles: HashMap<[u32; 2], u32>,
    /// A vertex at each place.
    vertex_at: Vec<u32>,
}

/// A corner of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub(crate) position: DVec3,
    /// The face's own vertex there, or [`NONE`].
    pub(crate) vertex: u32,
    /// The corners of the element that it lies between, and how far from the first, in [0, 1).
    pub(crate) between: [u32; 2],
    pub(crate) along: f64,
}

/// Corners of an element and of its neighbours on its edges, in its order.
pub(crate) type Outline = SmallVec<[Corner; 8]>;

/// An end of a part of an edge.
#[derive(Clone, Copy)]
struct End {
    place: u32,
    vertex: u32,
    along: f64,
}

impl Places {
    pub(crate) fn of(mesh: &ElementMesh) -> Self {
        let mut number: HashMap<[u64; 3], u32> = HashMap::new();
        let mut vertex_at = Vec::new();
        let mut of_vertex = Vec::with_capacity(mesh.positions.len());
        for (vertex, position) in (0..).zip(&mesh.positions) {
            // Minus zero is zero.
            let key = (*position + DVec3::ZERO).to_array().map(f64::to_bits);
            of_vertex.push(*number.entry(key).or_insert_with(|| {
                vertex_at.push(vertex);
                vertex_at.len() as u32 - 1
            }));
        }
        let place = |vertex: u32| of_vertex[vertex as usize];
        let middle = |(&[a, b], &middle): (&[u32; 2], &u32)| (ordered(place(a), place(b)), place(middle));
        let middles = mesh.midpoints.iter().map(middle).collect();
        Self { of_vertex, middles, vertex_at }
    }

    /// The outline of an element.
    pub(crate) fn outline(&self, mesh: &ElementMesh, element: u32) -> Outline {
        let mut outline = Outline::new();
        let corners = mesh.elements[element as usize].corners();
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let end = |vertex: u32, along| End { place: self.of_vertex[vertex as usize], vertex, along };
            let edge = Edge { places: self, mesh, between: [a, b] };
            edge.push(end(a, 0.0), &mut outline);
            edge.push_between(end(a, 0.0), end(b, 1.0), &mut outline);
        }
        outline
    }
}

/// An edge of an element.
struct Edge<'a> {
    places: &'a Places,
    mesh: &'a ElementMesh,
    between: [u32; 2],
}

impl Edge<'_> {
    fn push(&self, end: End, outline: &mut Outline) {
        let vertex = self.places.vertex_at[end.place as usize];
        let position = self.mesh.positions[vertex as usize];
        outline.push(Corner { position, vertex: end.vertex, between: self.between, along: end.along });
    }

    fn push_between(&self, a: End, b: End, outline: &mut Outline) {
        let Some(&place) = self.places.middles.get(&ordered(a.place, b.place)) else { return };
        // On an edge so short that its middle is an end there is nothing between.
        if place == a.place || place == b.place {
            return;
        }
        let vertex = match (a.vertex, b.vertex) {
            (NONE, _) | (_, NONE) => NONE,
            (p, q) => self.mesh.midpoints.get(&ordered(p, q)).copied().unwrap_or(NONE),
        };
        let middle = End { place, vertex, along: 0.5 * (a.along + b.along) };
        self.push_between(a, middle, outline);
        self.push(middle, outline);
        self.push_between(middle, b, outline);
    }
}

fn ordered(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::LinearRgb;

    /// Two squares at a right angle with the edge x = 1 in common, one divided twice at a corner of it.
    fn corner() -> ElementMesh {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let floor = [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 0.0)];
        let wall = [p(1.0, 0.0, 0.0), p(1.0, 0.0, 1.0), p(1.0, 1.0, 1.0), p(1.0, 1.0, 0.0)];
        let white = LinearRgb::WHITE;
        let mut mesh = ElementMesh::of_polygons(&[(&floor, white, white), (&wall, white, white)]);
        assert!(mesh.divide(1));
        let part = mesh.elements()[1].first_part;
        assert!(mesh.divide(part));
        mesh
    }

    #[test]
    fn an_outline_passes_the_vertices_of_other_faces() {
        let mesh = corner();
        let outline = Places::of(&mesh).outline(&mesh, 0);
        let on_edge: Vec<f64> =
            outline.iter().filter(|c| c.position.x == 1.0).map(|c| c.position.y).collect();
        assert_eq!(on_edge, [0.0, 0.25, 0.5, 1.0]);
        let strange: Vec<f64> = outline.iter().filter(|c| c.vertex == NONE).map(|c| c.along).collect();
        assert_eq!(strange, [0.25, 0.5]);
    }

    #[test]
    fn an_outline_knows_the_vertices_of_its_own_face() {
        let mesh = corner();
        let sibling = mesh.elements()[1].part_numbers().nth(1).expect("a part");
        let outline = Places::of(&mesh).outline(&mesh, sibling);
        assert_eq!(outline.len(), 5);
        assert!(outline.iter().all(|corner| corner.vertex != NONE));
    }
}
