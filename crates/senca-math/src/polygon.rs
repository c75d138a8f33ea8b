//! Polygons: normal, area, containment, convexity, and triangles.
//!
//! A polygon is the loop of its corners, the last joined to the first. Nothing here panics on loops
//! that are short, collinear, self-touching or self-crossing.

mod ear_clip;

use glam::{DVec2, DVec3};

pub use ear_clip::{triangulate, triangulate_with_holes};

/// The normal of a polygon, of any number of corners and not necessarily planar, with the polygon's
/// area as its length: the sum over the edges, after Newell. It points to the side from which the
/// corners run counter-clockwise. Zero for fewer than three corners and for degenerate loops.
///
/// Unlike the cross product of the first three corners it survives corners that coincide, lie on one
/// line or turn inwards.
#[must_use]
pub fn newell_normal(corners: &[DVec3]) -> DVec3 {
    newell_normal_of(corners.iter().copied())
}

/// [`newell_normal`] of corners that come one by one.
#[must_use]
pub fn newell_normal_of(corners: impl IntoIterator<Item = DVec3>) -> DVec3 {
    let mut corners = corners.into_iter();
    let Some(origin) = corners.next() else { return DVec3::ZERO };
    // Taken from a corner, so that a polygon far from the origin loses no digits.
    let (mut doubled, mut before) = (DVec3::ZERO, DVec3::ZERO);
    for corner in corners {
        let arm = corner - origin;
        doubled += before.cross(arm);
        before = arm;
    }
    0.5 * doubled
}

/// Area of a plane polygon: positive when its corners run counter-clockwise.
#[must_use]
pub fn signed_area(corners: &[DVec2]) -> f64 {
    let Some(&origin) = corners.first() else { return 0.0 };
    0.5 * corners.windows(2).map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin)).sum::<f64>()
}

/// How often a polygon runs round a point, counter-clockwise positive. Points on the lower and left
/// border count as inside, on the upper and right border as outside, so that of polygons that share
/// borders exactly one holds a point.
#[must_use]
pub fn winding_number(corners: &[DVec2], point: DVec2) -> i32 {
    let mut turns = 0;
    for (a, b) in edges(corners) {
        let left_of_edge = (b - a).perp_dot(point - a);
        if a.y <= point.y && b.y > point.y && left_of_edge > 0.0 {
            turns += 1;
        } else if a.y > point.y && b.y <= point.y && left_of_edge < 0.0 {
            turns -= 1;
        }
    }
    turns
}

/// Whether a point lies in a polygon, concave and self-overlapping ones included: it runs round the
/// point at least once.
#[must_use]
pub fn contains(corners: &[DVec2], point: DVec2) -> bool {
    winding_number(corners, point) != 0
}

/// Whether a polygon is convex: it turns one way only and once round. Collinear corners are fine;
/// loops without area are not convex.
#[must_use]
pub fn is_convex(corners: &[DVec2]) -> bool {
    let directions: Vec<DVec2> = edges(corners).map(|(a, b)| b - a).filter(|d| *d != DVec2::ZERO).collect();
    let mut turned = 0.0;
    let (mut left, mut right) = (false, false);
    for (i, d) in directions.iter().enumerate() {
        let next = directions[(i + 1) % directions.len()];
        let turn = d.perp_dot(next);
        left |= turn > 0.0;
        right |= turn < 0.0;
        turned += turn.atan2(d.dot(next));
    }
    left != right && turned.abs() < 3.0 * std::f64::consts::PI
}

/// Triangles of a polygon in space, as indices into its corners, with the polygon's orientation.
/// The polygon is flattened along the largest component of its normal; see [`triangulate`].
#[must_use]
pub fn triangulate_in_space(corners: &[DVec3]) -> Vec<[u32; 3]> {
    triangulate(&flattened(corners, newell_normal(corners)))
}

/// The corners without the coordinate in which `normal` is largest, oriented so that a polygon with
/// this normal runs counter-clockwise.
#[must_use]
pub fn flattened(corners: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let flip = normal[axis] < 0.0;
    corners.iter().map(|p| if flip { DVec2::new(p[v], p[u]) } else { DVec2::new(p[u], p[v]) }).collect()
}

fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    corners.iter().enumerate().map(|(i, &a)| (a, corners[(i + 1) % corners.len()]))
}

#[cfg(test)]
mod tests;
