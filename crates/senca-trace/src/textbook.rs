//! The intersections of the course text as it has them, to be read beside it.
//!
//! The tracer itself uses the surfaces of the modules beside, which give the same answers faster,
//! with fewer digits lost, and for every orientation. Source: course text, section 3.2 and example 3.5.

use senca_math::glam::{DVec2, DVec3};

use crate::Ray;

/// What the quadratic equation of a ray and a sphere says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereTest {
    /// Coefficient of t^2; 1 for a unit direction (equation 3.5).
    pub a: f64,
    /// Coefficient of t.
    pub b: f64,
    /// The constant.
    pub c: f64,
    /// The discriminant `B^2 - 4 A C` (equation 3.6).
    pub d: f64,
    /// Both parameters, ascending, where the discriminant is above 0 (equation 3.7). A ray that only
    /// touches the sphere, with a discriminant of 0, misses it.
    pub t: Option<[f64; 2]>,
}

impl SphereTest {
    /// The smaller parameter that is above 0: from inside the sphere the larger one.
    #[must_use]
    pub fn nearest(&self) -> Option<f64> {
        self.t?.into_iter().find(|t| *t > 0.0)
    }
}

/// Where a line meets the sphere around `center` (equations 3.4 to 3.7).
#[must_use]
pub fn ray_sphere(ray: &Ray, center: DVec3, radius: f64) -> SphereTest {
    let from_center = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * ray.direction.dot(from_center);
    let c = from_center.dot(from_center) - radius * radius;
    let d = b * b - 4.0 * a * c;
    let t = (d > 0.0).then(|| [-1.0, 1.0].map(|sign| (-b + sign * d.sqrt()) / (2.0 * a)));
    SphereTest { a, b, c, d, t }
}

/// The parameter at which a line meets the plane `A x + B y + C z + D = 0`, given as `normal` =
/// (A, B, C) and `d`; `None` when it is parallel to the plane (equations 3.8 and 3.9).
#[must_use]
pub fn ray_plane(ray: &Ray, normal: DVec3, d: f64) -> Option<f64> {
    let denominator = normal.dot(ray.direction);
    (denominator != 0.0).then(|| -(normal.dot(ray.origin) + d) / denominator)
}

/// The coordinate, 0 to 2, to be dropped when a plane with this normal is reduced to two dimensions:
/// that of the component of the largest magnitude, so that no polygon collapses. The first among equals.
#[must_use]
pub fn dropped_coordinate(normal: DVec3) -> usize {
    let size = normal.abs();
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

/// The other two coordinates of a point, in the order in which they follow the dropped one around
/// x, y, z, x, which keeps the orientation seen from that axis' positive end.
#[must_use]
#[inline]
pub fn reduced(point: DVec3, dropped: usize) -> DVec2 {
    match dropped {
        0 => DVec2::new(point.y, point.z),
        1 => DVec2::new(point.z, point.x),
        _ => DVec2::new(point.x, point.y),
    }
}

/// Whether a point lies in a simple polygon, concave or not: the half-line from it to the right
/// crosses the boundary an odd number of times.
///
/// A side counts as crossed when one end lies above the half-line and the other on it or below. So a
/// corner on the half-line counts with exactly one of its sides where the boundary passes through, and
/// with both or none where it turns back; sides along the half-line never count. Points on the
/// boundary belong to the left and lower side of the polygon: of polygons that share a side exactly
/// one holds them.
#[must_use]
pub fn in_polygon(corners: &[DVec2], point: DVec2) -> bool {
    let Some(&last) = corners.last() else { return false };
    let mut inside = false;
    let mut a = last;
    for &b in corners {
        if (a.y > point.y) != (b.y > point.y) && is_left_of(point, a, b) {
            inside = !inside;
        }
        a = b;
    }
    inside
}

/// Whether the side from `a` to `b`, one above and one not above the point's height, passes the point
/// on its right. The side is taken upwards, so that the answer does not depend on its direction.
#[inline]
fn is_left_of(point: DVec2, a: DVec2, b: DVec2) -> bool {
    let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
    (high - low).perp_dot(point - low) > 0.0
}

/// The weights alpha and beta of `x = p1 + alpha (p2 - p1) + beta (p3 - p1)`; `None` for a triangle
/// without area (example 3.3).
#[must_use]
pub fn triangle_weights(triangle: [DVec2; 3], x: DVec2) -> Option<[f64; 2]> {
    let [p1, p2, p3] = triangle;
    let (a, b, x) = (p2 - p1, p3 - p1, x - p1);
    let denominator = a.x * b.y - a.y * b.x;
    let alpha = (b.y * x.x - b.x * x.y) / denominator;
    let beta = (a.x * x.y - a.y * x.x) / denominator;
    (denominator != 0.0).then_some([alpha, beta])
}

/// Whether a point lies in a triangle, its boundary included (example 3.3).
#[must_use]
pub fn in_triangle(triangle: [DVec2; 3], x: DVec2) -> bool {
    triangle_weights(triangle, x)
        .is_some_and(|[alpha, beta]| alpha >= 0.0 && beta >= 0.0 && alpha + beta <= 1.0)
}

/// Whether a point lies in a convex polygon, as one of the n - 2 triangles at its first corner, its
/// boundary included (example 3.4).
#[must_use]
pub fn in_convex_polygon(corners: &[DVec2], x: DVec2) -> bool {
    let Some((&first, rest)) = corners.split_first() else { return false };
    rest.windows(2).any(|pair| in_triangle([first, pair[0], pair[1]], x))
}

/// The same in a number of steps that grows with the logarithm of the number of corners: a binary
/// search among the diagonals from the first corner for the triangle that the point could lie in.
/// Corners in either order, no three on one line.
#[must_use]
pub fn in_convex_polygon_by_search(corners: &[DVec2], x: DVec2) -> bool {
    let n = corners.len();
    if n < 3 {
        return false;
    }
    let from_first = |i: usize| corners[i] - corners[0];
    let orientation = from_first(1).perp_dot(from_first(2)).signum();
    let (mut low, mut high) = (1, n - 1);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if orientation * from_first(middle).perp_dot(x - corners[0]) >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    in_triangle([corners[0], corners[low], corners[high]], x)
}

/// The parameters between which a line runs through an axis-parallel box, after Liang and Barsky
/// (example 3.5); `None` when it misses.
///
/// Per axis, the two parallel planes are met at a smaller and a larger parameter; the largest of the
/// smaller ones must not exceed the smallest of the larger ones. Two corrections to the printed rule: a
/// direction without a component along an axis is inside or outside of that pair of planes all along,
/// and a box behind the origin (its last parameter is below 0) is missed.
#[must_use]
pub fn ray_box(ray: &Ray, min: DVec3, max: DVec3) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        if direction == 0.0 {
            if !(min[axis] <= origin && origin <= max[axis]) {
                return None;
            }
            continue;
        }
        let (t1, t2) = ((min[axis] - origin) / direction, (max[axis] - origin) / direction);
        enter = enter.max(t1.min(t2));
        leave = leave.min(t1.max(t2));
    }
    (enter <= leave && leave >= 0.0).then_some([enter, leave])
}

/// The direction of a ray after reflection: `r = 2 n cos(phi1) + a` (equation 3.10). `normal` is the
/// unit normal on the side the ray comes from, `incoming` the unit direction towards the surface.
#[must_use]
#[inline]
pub fn reflect(normal: DVec3, incoming: DVec3) -> DVec3 {
    incoming - 2.0 * normal.dot(incoming) * normal
}

/// The direction of a ray that passes from a medium of refractive index `eta1` into one of `eta2`;
/// `None` when the light is totally reflected (equations 3.11 to 3.13).
///
/// `normal` is the unit normal on the side the ray comes from, `incoming` the unit direction towards the
/// surface. `t = (eta1 / eta2) (n cos(phi1) + a) - n cos(phi2)`.
#[must_use]
#[inline]
pub fn refract(normal: DVec3, incoming: DVec3, eta1: f64, eta2: f64) -> Option<DVec3> {
    let ratio = eta1 / eta2;
    let cos1 = -normal.dot(incoming);
    let along = normal * cos1 + incoming;
    // The text's 1 - cos^2 loses digits near the normal, where the length of q + a does not.
    let sin2_squared = ratio * ratio * along.length_squared();
    (sin2_squared <= 1.0).then(|| ratio * along - normal * (1.0 - sin2_squared).sqrt())
}

#[cfg(test)]
mod tests;
