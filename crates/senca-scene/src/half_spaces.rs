//! Boxes around intersections of half-spaces.

use senca_math::Aabb;
use senca_math::glam::DVec3;

/// All p with `normal . p <= offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace {
    /// Outward normal, of unit length.
    pub(crate) normal: DVec3,
    /// Signed distance of the plane from the origin.
    pub(crate) offset: f64,
}

/// How far off, in units of the size of what is given, the sides of a box stand in for infinity.
const FAR: f64 = 1e6;

/// The box around what is left of `bounds`, whose sides may be infinite, in all of the half-spaces.
pub(crate) fn cut(bounds: Aabb, half_spaces: &[HalfSpace]) -> Aabb {
    if bounds.is_empty() || half_spaces.is_empty() {
        return bounds;
    }
    let sides = bounds.min.to_array().into_iter().chain(bounds.max.to_array()).filter(|s| s.is_finite());
    let size = half_spaces.iter().map(|h| h.offset.abs()).chain(sides.map(f64::abs)).fold(1e-6, f64::max);
    let far = FAR * size;
    let start = Aabb { min: bounds.min.max(DVec3::splat(-far)), max: bounds.max.min(DVec3::splat(far)) };
    let mut faces = box_faces(&start);
    for half_space in half_spaces {
        faces = clipped(&faces, half_space);
    }
    let rest = Aabb::of_points(faces.into_iter().flatten());
    if rest.is_empty() {
        return Aabb::EMPTY;
    }
    // Cutting rounds; what it did not move far stays as it was.
    let slack = 1e-8 * size;
    let mut result = bounds;
    for axis in 0..3 {
        if rest.min[axis] > start.min[axis] + 2.0 * slack && rest.min[axis] > -0.99 * far {
            result.min[axis] = rest.min[axis] - slack;
        }
        if rest.max[axis] < start.max[axis] - 2.0 * slack && rest.max[axis] < 0.99 * far {
            result.max[axis] = rest.max[axis] + slack;
        }
    }
    result
}

/// The corners of the six sides of a box, each going around.
fn box_faces(bounds: &Aabb) -> Vec<Vec<DVec3>> {
    let corners = bounds.corners();
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    faces.map(|face| face.map(|i| corners[i]).to_vec()).to_vec()
}

/// The faces of a convex body after a cut, the new one included.
fn clipped(faces: &[Vec<DVec3>], half_space: &HalfSpace) -> Vec<Vec<DVec3>> {
    let above = |p: DVec3| half_space.normal.dot(p) - half_space.offset;
    let mut cut = Vec::new();
    let mut rest: Vec<Vec<DVec3>> = Vec::with_capacity(faces.len() + 1);
    for face in faces {
        let mut kept = Vec::with_capacity(face.len() + 1);
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            let (da, db) = (above(a), above(b));
            if da <= 0.0 {
                kept.push(a);
            }
            if (da < 0.0) != (db < 0.0) && da != db {
                let crossing = a + (b - a) * (da / (da - db)).clamp(0.0, 1.0);
                kept.push(crossing);
                cut.push(crossing);
            }
        }
        if kept.len() >= 3 {
            rest.push(kept);
        }
    }
    if cut.len() >= 3 {
        rest.push(around(cut, half_space.normal));
    }
    rest
}

/// Corners of a convex polygon, sorted to go around its middle.
fn around(mut corners: Vec<DVec3>, normal: DVec3) -> Vec<DVec3> {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let (u, v) = normal.any_orthonormal_pair();
    let angle = |p: &DVec3| (*p - middle).dot(v).atan2((*p - middle).dot(u));
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners
}
