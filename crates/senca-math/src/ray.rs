//! Rays.

use glam::{DMat4, DVec3};

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes. Unit length where this crate makes the ray.
    pub direction: DVec3,
}

impl Ray {
    /// The point at parameter `t`; at distance `t` for a unit direction.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// The ray after an affine map. The direction is not made unit again, so that parameters stay
    /// comparable between the spaces.
    #[must_use]
    pub fn transformed(&self, target_from_source: &DMat4) -> Self {
        Self {
            origin: target_from_source.transform_point3(self.origin),
            direction: target_from_source.transform_vector3(self.direction),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_survive_a_transform() {
        let ray = Ray { origin: DVec3::ONE, direction: DVec3::Z };
        let m = DMat4::from_scale(DVec3::splat(3.0)) * DMat4::from_rotation_x(1.0);
        assert!((ray.transformed(&m).at(2.5) - m.transform_point3(ray.at(2.5))).length() < 1e-14);
    }
}
