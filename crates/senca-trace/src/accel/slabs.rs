//! Does a ray meet a box or a sphere at all?

use senca_math::Aabb;
use senca_math::glam::DVec3;

use crate::Ray;

/// Relative widening of a slab's far side: more than the rounding of a difference, a reciprocal and
/// a product (Ize 2013).
const WIDENING: f64 = 1.0 + 4.0 * f64::EPSILON;

/// A ray, ready to be tested against many boxes.
///
/// A box is the common part of three slabs, each between two parallel planes. The ray is in a slab
/// between a smaller and a larger t; it misses the box if and only if the largest of the smaller ones
/// is above the smallest of the larger ones (course text, section 3.3, example 3.5). Besides, that
/// piece must reach into what the ray admits: a box behind the origin is missed. A ray within the
/// plane of a side meets the box.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    origin: DVec3,
    /// 1 / direction; infinite where the direction is zero.
    reciprocal: DVec3,
}

impl Slabs {
    /// For the line of `ray`.
    #[must_use]
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin, reciprocal: ray.direction.recip() }
    }

    /// Where the line is inside `bounds`: from which t to which, cut to `[t_min, t_max]`. `None` when
    /// nothing is left. An empty box is missed.
    #[must_use]
    #[inline]
    pub fn interval(&self, bounds: &Aabb, t_min: f64, t_max: f64) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = (t_min, t_max);
        for axis in 0..3 {
            let (origin, reciprocal) = (self.origin[axis], self.reciprocal[axis]);
            let low = (bounds.min[axis] - origin) * reciprocal;
            let high = (bounds.max[axis] - origin) * reciprocal;
            let (near, far) = if reciprocal.is_sign_negative() { (high, low) } else { (low, high) };
            // In the plane of a side, 0 * infinity is NaN, and that side says nothing.
            if near > enter {
                enter = near;
            }
            let far = if far > 0.0 { far * WIDENING } else { far / WIDENING };
            if far < leave {
                leave = far;
            }
        }
        (enter <= leave).then_some((enter, leave))
    }
}

/// Whether the ray comes within `radius` of `center` between its limits: first the discriminant of
/// equation 3.6 of the course text, then where along the ray.
#[must_use]
pub fn meets_sphere(ray: &Ray, center: DVec3, radius: f64) -> bool {
    let to_center = center - ray.origin;
    let squared = ray.direction.length_squared();
    // The point of the allowed piece nearest to the centre.
    let t = (to_center.dot(ray.direction) / squared).clamp(ray.t_min, ray.t_max);
    (to_center - t * ray.direction).length_squared() <= radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hits(origin: [f64; 3], direction: [f64; 3], min: [f64; 3], max: [f64; 3]) -> Option<(f64, f64)> {
        let ray = Ray::new(origin.into(), direction.into());
        Slabs::new(&ray).interval(&Aabb { min: min.into(), max: max.into() }, ray.t_min, ray.t_max)
    }

    #[test]
    fn boxes_of_example_3_5() {
        let near = |found: Option<(f64, f64)>, expected: (f64, f64)| {
            found.is_some_and(|(a, b)| (a - expected.0).abs() < 1e-12 && (b - expected.1).abs() < 1e-12)
        };
        let diagonal = [1.0, 1.0, 1.0];
        let hit = hits([0.0; 3], diagonal, [1.0, 2.0, 1.5], [4.0, 5.0, 6.0]);
        assert!(near(hit, (2.0, 4.0)), "{hit:?}");
        assert_eq!(hits([0.0; 3], diagonal, [1.0, 5.0, 1.5], [4.0, 8.0, 6.0]), None);
        let (min, max) = ([1.0, -1.0, -1.0], [2.0, 1.0, 1.0]);
        assert_eq!(hits([0.0; 3], [-1.0, 0.0, 0.0], min, max), None, "behind the origin");
        let inside = hits([1.5, 0.0, 0.0], [1.0, 0.0, 0.0], min, max);
        assert!(near(inside, (0.0, 0.5)), "{inside:?}");
    }

    #[test]
    fn planes_of_sides_flat_boxes_and_endless_ones_are_met() {
        let along_side = hits([1.0, -3.0, 0.0], [0.0, 1.0, 0.0], [1.0, -1.0, -1.0], [2.0, 1.0, 1.0]);
        assert!(along_side.is_some());
        assert!(hits([1.0, 0.0, 5.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [2.0, 0.0, 1.0]).is_some());
        let endless = hits([0.0; 3], [0.0, 1.0, 0.0], [f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        assert_eq!(endless, Some((0.0, f64::INFINITY)));
        assert_eq!(hits([0.0; 3], [0.3, 1.0, 0.0], [f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), None);
    }

    #[test]
    fn spheres_are_met_only_between_the_limits() {
        let ray = Ray::new(DVec3::ZERO, 2.0 * DVec3::X);
        assert!(meets_sphere(&ray, DVec3::new(5.0, 0.9, 0.0), 1.0));
        assert!(!meets_sphere(&ray, DVec3::new(5.0, 1.1, 0.0), 1.0));
        assert!(!meets_sphere(&ray, DVec3::new(-5.0, 0.0, 0.0), 1.0), "behind the origin");
        assert!(meets_sphere(&ray, DVec3::new(-0.5, 0.0, 0.0), 1.0), "around the origin");
        let short = Ray { t_max: 1.9, ..ray };
        assert!(!meets_sphere(&short, DVec3::new(5.0, 0.0, 0.0), 1.0));
    }
}
