//! Axis-aligned bounding boxes.

use glam::{DMat4, DVec3};

/// An axis-aligned box, closed on all sides. The empty box has `min > max` in every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around `points`. Points with a NaN or infinite coordinate are passed over.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().filter(|p| p.is_finite()).fold(Self::EMPTY, Self::including)
    }

    /// This box grown to hold `point`.
    #[must_use]
    pub fn including(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// Centre of the box; the origin for the empty box.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { 0.5 * (self.min + self.max) }
    }

    /// Edge lengths; zero for the empty box.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// Length of the diagonal; zero for the empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// The eight corners, bit 0 of the index choosing x, bit 1 y, bit 2 z.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The box around this box's corners after an affine map.
    #[must_use]
    pub fn transformed(&self, target_from_source: &DMat4) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::of_points(self.corners().map(|c| target_from_source.transform_point3(c)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_box_is_neutral_for_union() {
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(Aabb::EMPTY.is_empty() && !unit.is_empty());
        assert_eq!(Aabb::EMPTY.diagonal(), 0.0);
    }

    #[test]
    fn not_finite_points_are_passed_over() {
        let bounds = Aabb::of_points([DVec3::ONE, DVec3::splat(f64::NAN), DVec3::splat(f64::INFINITY)]);
        assert_eq!(bounds, Aabb { min: DVec3::ONE, max: DVec3::ONE });
    }

    #[test]
    fn a_rotated_box_covers_its_corners() {
        let unit = Aabb { min: -DVec3::ONE, max: DVec3::ONE };
        let turned = unit.transformed(&DMat4::from_rotation_z(std::f64::consts::FRAC_PI_4));
        assert!((turned.max.x - 2f64.sqrt()).abs() < 1e-12 && (turned.max.z - 1.0).abs() < 1e-12);
    }
}
