//! From patches to the nodes between them.
//!
//! The solution is constant over an element; for display it is moved to the vertices and interpolated
//! between them (course text, section 4.1). A vertex belongs to one smooth face, so real edges have as
//! many values as faces meet there, and stay visible.
//!
//! 1. A vertex inside its face gets the mean of the elements that adjoin it (figure 4.4). An element
//!    on whose side the vertex lies, as one of its finer neighbour's, adjoins it too.
//! 2. A vertex on the border of its face lies outside of the middles of its elements, so their mean
//!    would be a value from further inside. It is extrapolated: where rectangles b and d meet the
//!    border at Y, and X is the node at the other end of their common side, `Y = B_b + B_d - X`; at a
//!    corner, `Z = 2 B - X` with the one element that has the corner (exercise 4.2; the text prints
//!    another element there by mistake, its expansion is this one).
//! 3. On other meshes the same straight line is drawn, from the mean X of the inner vertices that most
//!    of the adjoining elements share, through the mean of the elements in the mean of their middles,
//!    to the vertex. Faces without inner vertices have nothing to draw it from and keep the mean.
//! 4. Elements that lie wholly in the dark of a body ([`crate::Element::open`]) do not count.
//! 5. Extrapolated values below 0 are set to 0 ([`Extrapolation::Clamped`]).

use std::collections::HashMap;

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use crate::{ElementMesh, Solution};

/// The line is not followed further than this many times the way to the middles of the elements. On
/// rectangles it is 2.
const FARTHEST: f64 = 3.0;

/// What vertices on the border of a face get.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extrapolation {
    /// The mean of the adjoining elements, as inside.
    Mean,
    /// The straight line on, which may end below 0.
    Linear,
    /// The straight line on, but not below 0.
    #[default]
    Clamped,
}

/// Which elements adjoin which vertices. One may serve for any number of values on the same mesh.
#[derive(Clone, Debug)]
pub struct NodeTransfer {
    /// Leaves by vertex: those of vertex v are `leaves[starts[v]..starts[v + 1]]`, ascending.
    starts: Vec<u32>,
    leaves: Vec<u32>,
    /// How vertices on borders are reached.
    lines: Vec<Option<Line>>,
    border: Vec<bool>,
    /// By element: whether none of it is open.
    hidden: Vec<bool>,
}

/// The line to a vertex on a border: from the mean of inner vertices through the mean of the elements.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    inner: Vec<u32>,
    /// Where the vertex is on it: 0 at the inner vertices, 1 at the elements.
    at: f32,
}

/// Values at the vertices of a mesh, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeValues {
    /// Light that arrives.
    pub incident: Vec<LinearRgb>,
    /// The part of `incident` that comes straight from lamps, the sky and emitters.
    pub direct: Vec<LinearRgb>,
}

impl NodeTransfer {
    /// The transfer on the leaves of `mesh`.
    #[must_use]
    pub fn new(mesh: &ElementMesh) -> Self {
        let adjoining = Adjoining::new(mesh);
        let mut transfer = Self {
            starts: adjoining.starts,
            leaves: adjoining.leaves,
            lines: Vec::new(),
            border: adjoining.border,
            hidden: mesh.elements().iter().map(|element| element.open <= 0.0).collect(),
        };
        transfer.lines = (0..mesh.positions().len() as u32).map(|v| transfer.line_to(mesh, v)).collect();
        transfer
    }

    /// Leaves that adjoin a vertex, in ascending order.
    #[must_use]
    pub fn adjoining(&self, vertex: u32) -> &[u32] {
        let [from, to] = [0, 1].map(|i| self.starts[vertex as usize + i] as usize);
        &self.leaves[from..to]
    }

    /// Whether a vertex is on the border of its face.
    #[must_use]
    pub fn is_on_border(&self, vertex: u32) -> bool {
        self.border[vertex as usize]
    }

    /// Values at the vertices from `values` of the elements; black at vertices that no leaf adjoins.
    ///
    /// # Panics
    /// When `values` has fewer entries than the mesh has elements.
    #[must_use]
    pub fn apply(&self, values: &[LinearRgb], extrapolation: Extrapolation) -> Vec<LinearRgb> {
        let vertices = 0..self.border.len() as u32;
        let means: Vec<LinearRgb> = vertices.map(|v| self.mean(v, values)).collect();
        if extrapolation == Extrapolation::Mean {
            return means;
        }
        let value = |(line, &mean): (&Option<Line>, &LinearRgb)| {
            let Some(line) = line else { return mean };
            let value = line.value(mean, &means);
            if extrapolation == Extrapolation::Clamped { value.map(|c| c.max(0.0)) } else { value }
        };
        self.lines.iter().zip(&means).map(value).collect()
    }

    fn mean(&self, vertex: u32, values: &[LinearRgb]) -> LinearRgb {
        let open = self.adjoining(vertex).iter().filter(|&&leaf| !self.hidden[leaf as usize]);
        let (sum, count) = open
            .fold((LinearRgb::BLACK, 0u32), |(sum, count), &leaf| (sum + values[leaf as usize], count + 1));
        if count == 0 { sum } else { sum * (count as f32).recip() }
    }

    /// The line to a vertex on a border, where there is one.
    fn line_to(&self, mesh: &ElementMesh, vertex: u32) -> Option<Line> {
        if !self.is_on_border(vertex) {
            return None;
        }
        let leaves = self.adjoining(vertex);
        let inner = self.inner_vertices(mesh, leaves);
        if inner.is_empty() {
            return None;
        }
        let mean = |places: &mut dyn Iterator<Item = DVec3>, n: usize| places.sum::<DVec3>() / n as f64;
        let place = |&v: &u32| mesh.positions()[v as usize];
        let center = |&leaf: &u32| mesh.elements()[leaf as usize].center;
        let start = mean(&mut inner.iter().map(place), inner.len());
        let through = mean(&mut leaves.iter().map(center), leaves.len());
        let step = through - start;
        let at = (place(&vertex) - start).dot(step) / step.length_squared();
        (at > 1.0).then(|| Line { inner, at: at.min(FARTHEST) as f32 })
    }

    /// Corners of the leaves that are inside their face: those that most of the leaves share.
    fn inner_vertices(&self, mesh: &ElementMesh, leaves: &[u32]) -> Vec<u32> {
        let mut corners: Vec<u32> = leaves
            .iter()
            .flat_map(|&leaf| mesh.elements()[leaf as usize].corners())
            .copied()
            .filter(|&corner| !self.is_on_border(corner))
            .collect();
        corners.sort_unstable();
        let shared = |chunk: &[u32]| chunk.len();
        let most = corners.chunk_by(|a, b| a == b).map(shared).max().unwrap_or(0);
        corners.chunk_by(|a, b| a == b).filter(|chunk| chunk.len() == most).map(|chunk| chunk[0]).collect()
    }
}

impl Line {
    fn value(&self, through: LinearRgb, means: &[LinearRgb]) -> LinearRgb {
        let sum = self.inner.iter().fold(LinearRgb::BLACK, |sum, &v| sum + means[v as usize]);
        let start = sum * (self.inner.len() as f32).recip();
        start + (through - start) * self.at
    }
}

/// Leaves around vertices, and the borders of faces.
struct Adjoining {
    starts: Vec<u32>,
    leaves: Vec<u32>,
    border: Vec<bool>,
}

impl Adjoining {
    fn new(mesh: &ElementMesh) -> Self {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        // Pieces of sides that no vertex divides further, with the number of leaves beside them.
        let mut pieces: HashMap<[u32; 2], u32> = HashMap::new();
        let mut side = Vec::new();
        for leaf in mesh.leaves() {
            let corners = mesh.elements()[leaf as usize].corners();
            for (i, &a) in corners.iter().enumerate() {
                side.clear();
                mesh.vertices_on_edge(a, corners[(i + 1) % corners.len()], &mut side);
                pairs.extend(side[..side.len() - 1].iter().map(|&vertex| [vertex, leaf]));
                for ends in side.windows(2) {
                    *pieces.entry([ends[0].min(ends[1]), ends[0].max(ends[1])]).or_default() += 1;
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut border = vec![false; mesh.positions().len()];
        for ([a, b], _) in pieces.into_iter().filter(|(_, leaves)| *leaves == 1) {
            (border[a as usize], border[b as usize]) = (true, true);
        }
        Self {
            starts: starts(&pairs, border.len()),
            leaves: pairs.iter().map(|pair| pair[1]).collect(),
            border,
        }
    }
}

/// Where the pairs of each of `n` vertices begin, and the end.
fn starts(pairs: &[[u32; 2]], n: usize) -> Vec<u32> {
    let mut starts = vec![0; n + 1];
    for [vertex, _] in pairs {
        starts[*vertex as usize + 1] += 1;
    }
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    starts
}

impl NodeValues {
    /// Radiosity of a vertex as a corner of an element: the element's emission, and its reflectance
    /// times what arrives at the vertex.
    #[must_use]
    pub fn radiosity(&self, mesh: &ElementMesh, element: u32, vertex: u32) -> LinearRgb {
        let surface = mesh.surface(element);
        surface.emission + surface.reflectance * self.incident[vertex as usize]
    }
}

impl Solution {
    /// Values at the vertices of the mesh.
    #[must_use]
    pub fn node_values(&self, extrapolation: Extrapolation) -> NodeValues {
        let transfer = NodeTransfer::new(&self.mesh);
        let [incident, direct] =
            [&self.incident, &self.direct].map(|values| transfer.apply(values, extrapolation));
        NodeValues { incident, direct }
    }
}

#[cfg(test)]
mod tests;
