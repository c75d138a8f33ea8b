//! Whether patches close up to the surface of a body.

use std::collections::HashMap;

use senca_math::glam::{DVec3, DVec4};
use senca_scene::BezierPatch;

use super::net::Net;

/// Bits of an edge's control points, with -0 taken as 0.
type Key = [[u64; 3]; 4];

fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

/// Control points of the four edges, counter-clockwise.
const EDGES: [[usize; 4]; 4] = [[0, 1, 2, 3], [3, 7, 11, 15], [15, 14, 13, 12], [12, 8, 4, 0]];

/// Whether every edge is a point, or run through once in each direction by its two patches, with the same
/// control points.
pub(super) fn is_closed(patches: &[BezierPatch]) -> bool {
    // Per edge the number of patches that run along it forwards and backwards.
    let mut uses: HashMap<Key, [u32; 2]> = HashMap::new();
    for patch in patches {
        for edge in EDGES {
            let forward = edge.map(|i| bits(patch.points[i]));
            let mut backward = forward;
            backward.reverse();
            if forward.iter().any(|p| *p != forward[0]) {
                let key = forward.min(backward);
                uses.entry(key).or_default()[usize::from(key != forward)] += 1;
            }
        }
    }
    !patches.is_empty() && uses.values().all(|use_| *use_ == [1, 1])
}

/// Whether a grid of rational patches, `columns` in each row, closes up: opposite borders are the same, or
/// each a point.
pub(super) fn is_closed_grid(nets: &[Net<DVec4>], columns: usize) -> bool {
    if columns == 0 || nets.is_empty() {
        return false;
    }
    let rows = nets.len() / columns;
    let row = |j: usize, last: bool| -> Vec<DVec4> {
        let border = |net: &Net<DVec4>| {
            let [width, height] = net.size();
            let first = if last { (height - 1) * width } else { 0 };
            net.points()[first..first + width].to_vec()
        };
        (0..columns).flat_map(|i| border(&nets[j * columns + i])).collect()
    };
    let column = |i: usize, last: bool| -> Vec<DVec4> {
        let border = |net: &Net<DVec4>| {
            let width = net.size()[0];
            let first = if last { width - 1 } else { 0 };
            net.points().iter().skip(first).step_by(width).copied().collect::<Vec<_>>()
        };
        (0..rows).flat_map(|j| border(&nets[j * columns + i])).collect()
    };
    let close = |a: Vec<DVec4>, b: Vec<DVec4>| is_same(&a, &b) || (is_point(&a) && is_point(&b));
    close(row(0, false), row(rows - 1, true)) && close(column(0, false), column(columns - 1, true))
}

fn place(p: DVec4) -> DVec3 {
    p.truncate() / p.w
}

/// Largest coordinate, to measure differences by.
fn size(points: &[DVec4]) -> f64 {
    points.iter().map(|p| place(*p).abs().max_element()).fold(0.0, f64::max)
}

fn is_same(a: &[DVec4], b: &[DVec4]) -> bool {
    let tolerance = 1e-12 * size(a);
    a.iter()
        .zip(b)
        .all(|(a, b)| place(*a).distance(place(*b)) <= tolerance && (a.w - b.w).abs() <= 1e-12 * a.w)
}

fn is_point(points: &[DVec4]) -> bool {
    let tolerance = 1e-12 * size(points);
    points.iter().all(|p| place(*p).distance(place(points[0])) <= tolerance)
}
