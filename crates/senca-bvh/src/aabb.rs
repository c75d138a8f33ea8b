//! Boxes in single precision that never lose anything.

use senca_math::Aabb;
use senca_math::glam::{DVec3, Vec3};

/// An axis-aligned box in single precision, closed on all sides. Empty when `min > max` in any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb32 {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb32 {
    /// The box that holds nothing; the neutral element of [`Aabb32::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    #[must_use]
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds nothing. So does one with a NaN.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The same box in double precision.
    #[must_use]
    pub fn as_aabb(&self) -> Aabb {
        Aabb { min: self.min.as_dvec3(), max: self.max.as_dvec3() }
    }
}

impl From<Aabb> for Aabb32 {
    /// The smallest box in single precision that holds all of `source`: corners are rounded outward.
    fn from(source: Aabb) -> Self {
        Self { min: rounded_down(source.min), max: -rounded_down(-source.max) }
    }
}

/// The largest vector in single precision that is nowhere above `v`.
fn rounded_down(v: DVec3) -> Vec3 {
    let down = |x: f64| {
        let nearest = x as f32;
        if f64::from(nearest) > x { nearest.next_down() } else { nearest }
    };
    Vec3::new(down(v.x), down(v.y), down(v.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rounding_goes_outward_by_less_than_one_step(x in -1e30f64..1e30, y in prop::num::f64::NORMAL) {
            let source = Aabb { min: DVec3::new(x, y, x).min(DVec3::ZERO), max: DVec3::new(x, y, x).max(DVec3::ZERO) };
            let rounded = Aabb32::from(source);
            for axis in 0..3 {
                prop_assert!(f64::from(rounded.min[axis]) <= source.min[axis]);
                prop_assert!(f64::from(rounded.max[axis]) >= source.max[axis]);
                prop_assert!(f64::from(rounded.min[axis].next_up()) > source.min[axis]);
                prop_assert!(f64::from(rounded.max[axis].next_down()) < source.max[axis]);
            }
        }
    }

    #[test]
    fn a_box_with_nan_is_empty() {
        assert!(Aabb32 { min: Vec3::NAN, max: Vec3::ONE }.is_empty());
        assert!(Aabb32::EMPTY.is_empty());
        assert!(!Aabb32 { min: Vec3::ONE, max: Vec3::ONE }.is_empty());
        assert!(Aabb32::from(Aabb::EMPTY).is_empty());
    }
}
