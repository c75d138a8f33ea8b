//! Patch edges that both neighbours see alike, and the strips that join them to a patch's inside.

use std::collections::HashMap;

use senca_math::CubicCurve;
use senca_math::glam::DVec3;

use super::build::Builder;

/// A cubic curve's control points.
pub(super) type Cubic = [DVec3; 4];

/// Bits of a place, with -0 taken as 0, so that equal places have equal bits.
fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

/// An edge as all its patches see it.
pub(super) struct Edge {
    /// Control points in the canonical direction.
    pub curve: Cubic,
    /// Number of steps.
    pub steps: u32,
    /// Mesh points from start to end in the canonical direction.
    points: Vec<u32>,
}

impl Edge {
    /// Whether the edge is a single point.
    pub(super) fn is_collapsed(&self) -> bool {
        self.curve.iter().all(|&p| bits(p) == bits(self.curve[0]))
    }
}

/// One patch's use of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeUse {
    /// Index of the edge.
    pub edge: usize,
    /// Whether the patch runs along it against the canonical direction.
    reversed: bool,
}

/// All edges of a set of patches.
#[derive(Default)]
pub(super) struct Edges {
    /// The edges in the order in which they were met.
    pub list: Vec<Edge>,
    by_curve: HashMap<[[u64; 3]; 4], usize>,
    corners: HashMap<[u64; 3], u32>,
}

impl Edges {
    /// Registers `curve`; curves with the same control points, in either direction, are one edge.
    pub(super) fn enter(&mut self, curve: Cubic) -> EdgeUse {
        let forward = curve.map(bits);
        let mut backward = forward;
        backward.reverse();
        let reversed = backward < forward;
        let (key, curve) =
            if reversed { (backward, [curve[3], curve[2], curve[1], curve[0]]) } else { (forward, curve) };
        let next = self.list.len();
        let edge = *self.by_curve.entry(key).or_insert(next);
        if edge == next {
            self.list.push(Edge { curve, steps: 1, points: Vec::new() });
        }
        EdgeUse { edge, reversed }
    }

    /// Number of steps of a used edge.
    pub(super) fn steps(&self, edge_use: EdgeUse) -> u32 {
        self.list[edge_use.edge].steps
    }

    /// Mesh point number `i` along a used edge, in the patch's direction.
    pub(super) fn point(&self, edge_use: EdgeUse, i: u32) -> u32 {
        let edge = &self.list[edge_use.edge];
        let i = if edge_use.reversed { edge.steps - i } else { i };
        edge.points[i as usize]
    }

    /// Makes the points of all edges. Ends at equal places share a point.
    pub(super) fn add_points(&mut self, b: &mut Builder) {
        for edge in &mut self.list {
            let collapsed = edge.is_collapsed();
            let mut corner =
                |p: DVec3, b: &mut Builder| *self.corners.entry(bits(p)).or_insert_with(|| b.point(p));
            let [start, end] = [corner(edge.curve[0], b), corner(edge.curve[3], b)];
            edge.points.push(start);
            for i in 1..edge.steps {
                let t = f64::from(i) / f64::from(edge.steps);
                edge.points.push(if collapsed {
                    start
                } else {
                    b.point(CubicCurve { points: edge.curve }.at(t))
                });
            }
            edge.points.push(end);
        }
    }
}

/// Triangles between an outer and an inner row of vertices, the inner on the left of the outer's
/// direction. Each entry is the parameter along the row, ascending, and the vertex. The row whose
/// next step ends its half first moves on, which keeps the triangles upright.
pub(super) fn join_rows(outer: &[(f64, u32)], inner: &[(f64, u32)], surface: u32, b: &mut Builder) {
    let (mut i, mut j) = (0, 0);
    while i + 1 < outer.len() || j + 1 < inner.len() {
        let outer_moves = match (outer.get(i + 1), inner.get(j + 1)) {
            (Some(o), Some(n)) => o.0 + outer[i].0 <= n.0 + inner[j].0,
            (next, _) => next.is_some(),
        };
        if outer_moves {
            b.triangle([outer[i].1, outer[i + 1].1, inner[j].1], surface);
            i += 1;
        } else {
            b.triangle([outer[i].1, inner[j + 1].1, inner[j].1], surface);
            j += 1;
        }
    }
}
