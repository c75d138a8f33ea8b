//! One cell: how the surface passes through it, and where its vertices lie.
//!
//! Edges of a cell are numbered `4 * axis + k`: bit 0 of k says whether the edge lies on the far side
//! along the next axis (cyclic), bit 1 along the one after it.

use senca_math::Aabb;
use senca_math::glam::{DMat3, DVec3, IVec3};

use super::field::{Body, Tag};

/// Says that an edge is not crossed.
pub(super) const NONE: u8 = u8::MAX;

/// Share of the largest eigenvalue below which a direction counts as not determined by the planes.
const FLATNESS: f64 = 0.05;

/// How far a vertex may lie outside of its cell, as a share of the cell's side.
const SLACK: f64 = 0.2;

/// Unit step along an axis.
pub(super) fn unit(axis: usize) -> IVec3 {
    IVec3::AXES[axis]
}

/// The corner at which an edge of a cell starts, relative to the cell.
pub(super) fn edge_start(edge: usize) -> IVec3 {
    let (axis, k) = (edge / 4, edge % 4);
    unit((axis + 1) % 3) * (k & 1) as i32 + unit((axis + 2) % 3) * (k >> 1) as i32
}

/// The edge along `axis` that starts at `start`, relative to the cell.
fn edge_at(axis: usize, start: IVec3) -> usize {
    4 * axis + (start[(axis + 1) % 3] + 2 * start[(axis + 2) % 3]) as usize
}

/// The corners of the face across `axis` on its near (0) or far (1) side, going around, and the edges
/// from each corner to the next.
pub(super) fn face(axis: usize, side: i32) -> ([IVec3; 4], [usize; 4]) {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let base = unit(axis) * side;
    let corners = [base, base + unit(b), base + unit(b) + unit(c), base + unit(c)];
    let edges =
        [edge_at(b, corners[0]), edge_at(c, corners[1]), edge_at(b, corners[3]), edge_at(c, corners[0])];
    (corners, edges)
}

/// The pairs of edges of a face between which the surface passes. Where all four are crossed, the
/// middle of the face decides which corners are cut off, for both cells of the face alike.
pub(super) fn face_pairs(
    inside: [bool; 4],
    edges: [usize; 4],
    middle_inside: impl FnOnce() -> bool,
) -> Vec<[usize; 2]> {
    let crossed: Vec<usize> = (0..4).filter(|&i| inside[i] != inside[(i + 1) % 4]).collect();
    match crossed[..] {
        [a, b] => vec![[edges[a], edges[b]]],
        [_, _, _, _] => {
            let cut_off = !middle_inside();
            let corners = (0..4).filter(|&i| inside[i] == cut_off);
            corners.map(|i| [edges[(i + 3) % 4], edges[i]]).collect()
        }
        _ => Vec::new(),
    }
}

/// Which loop of the surface each edge belongs to, [`NONE`] where it is not crossed, and how many
/// loops there are. `links` holds the pairs of all six faces.
pub(super) fn loops(links: &[[usize; 2]]) -> ([u8; 12], u8) {
    let mut loop_of = [NONE; 12];
    let mut count = 0;
    for link in links {
        if loop_of[link[0]] != NONE {
            continue;
        }
        let mut open = vec![link[0]];
        while let Some(edge) = open.pop() {
            if loop_of[edge] != NONE {
                continue;
            }
            loop_of[edge] = count;
            open.extend(links.iter().filter(|l| l.contains(&edge)).flat_map(|l| *l));
        }
        count += 1;
    }
    (loop_of, count)
}

/// Where the surface crosses an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) corner: IVec3,
    pub(super) axis: usize,
    /// Whether the edge starts inside.
    pub(super) leaves: bool,
    pub(super) place: DVec3,
    /// Unit normal, outwards.
    pub(super) normal: DVec3,
    pub(super) tag: Tag,
}

/// The vertex of a loop: where the planes at its crossings meet best (Ju et al. 2002), moved onto the
/// surfaces that pass, and kept in the cell.
pub(super) fn vertex(body: &Body, crossings: &[Crossing], cell: &Aabb) -> DVec3 {
    let mean = crossings.iter().map(|c| c.place).sum::<DVec3>() / crossings.len().max(1) as f64;
    let planes = crossings.iter().map(|c| (c.normal, c.normal.dot(c.place - mean)));
    let meeting = mean + least_squares(planes, FLATNESS);
    let start = if meeting.is_finite() { meeting.clamp(cell.min, cell.max) } else { mean };
    on_surface(body, crossings, start, cell)
}

/// Newton's steps onto all the surfaces that the crossings lie on; they may leave the cell a little,
/// as far as a surface bends.
fn on_surface(body: &Body, crossings: &[Crossing], start: DVec3, cell: &Aabb) -> DVec3 {
    let mut tags: Vec<Tag> = crossings.iter().map(|c| c.tag).collect();
    tags.sort_unstable();
    tags.dedup();
    let slack = SLACK * cell.size();
    let mut p = start;
    for _ in 0..4 {
        let distances: Option<Vec<(f64, DVec3)>> =
            tags.iter().map(|tag| body.leaves[tag.leaf as usize].distance(tag.part, p)).collect();
        let Some(distances) = distances else { return p };
        let step = least_squares(distances.iter().map(|(d, n)| (*n, -d)), 1e-4);
        if !step.is_finite() {
            return p;
        }
        p = (p + step).clamp(cell.min - slack, cell.max + slack);
    }
    p
}

/// The shortest step whose dot product with each normal comes nearest to the number beside it;
/// directions with eigenvalues below `flatness` times the largest are left alone.
fn least_squares(planes: impl Iterator<Item = (DVec3, f64)>, flatness: f64) -> DVec3 {
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (n, d) in planes {
        matrix += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        right += n * d;
    }
    let (values, vectors) = eigen(matrix);
    let largest = values.max_element();
    let along = |i: usize| {
        let used = values[i] > flatness * largest;
        if used { vectors.col(i) * (vectors.col(i).dot(right) / values[i]) } else { DVec3::ZERO }
    };
    along(0) + along(1) + along(2)
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix, by Jacobi's rotations.
fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let (mut a, mut vectors) = (matrix, DMat3::IDENTITY);
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(q)[p];
            if off.abs() <= 1e-30 {
                continue;
            }
            let theta = 0.5 * (a.col(q)[q] - a.col(p)[p]) / off;
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let mut rotation = DMat3::IDENTITY;
            rotation.col_mut(p)[p] = cos;
            rotation.col_mut(q)[q] = cos;
            rotation.col_mut(q)[p] = t * cos;
            rotation.col_mut(p)[q] = -t * cos;
            a = rotation.transpose() * a * rotation;
            vectors *= rotation;
        }
    }
    (DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let m = DMat3::from_cols_array(&[4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 1.0]);
        let (values, vectors) = eigen(m);
        let back = vectors * DMat3::from_diagonal(values) * vectors.transpose();
        assert!((back - m).abs_diff_eq(DMat3::ZERO, 1e-12));
    }

    #[test]
    fn three_planes_meet_in_a_point_and_one_in_its_nearest() {
        let planes = [(DVec3::X, 1.0), (DVec3::Y, 2.0), (DVec3::new(0.6, 0.0, 0.8), 3.0)];
        let p = least_squares(planes.into_iter(), 1e-3);
        assert!((p - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!((least_squares([(DVec3::Y, 2.0)].into_iter(), 0.1) - DVec3::Y * 2.0).length() < 1e-12);
    }

    #[test]
    fn faces_pair_their_edges() {
        let (corners, edges) = face(2, 1);
        for i in 0..4 {
            let (start, axis) = (edge_start(edges[i]), edges[i] / 4);
            let ends = [start, start + unit(axis)];
            assert!(ends.contains(&corners[i]) && ends.contains(&corners[(i + 1) % 4]));
        }
        let inside = [true, false, true, false];
        assert_eq!(face_pairs(inside, [0, 1, 2, 3], || false), [[3, 0], [1, 2]]);
        assert_eq!(face_pairs(inside, [0, 1, 2, 3], || true), [[0, 1], [2, 3]]);
        assert_eq!(face_pairs([true, false, false, false], [0, 1, 2, 3], || false), [[0, 3]]);
    }
}
