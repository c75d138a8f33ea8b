//! The rays of the tracer.

use senca_math::glam::{DMat4, DVec3};

/// A piece of a straight line, `x = x0 + t dx` with t between two limits (course text, section 3.2,
/// equation 3.3).
///
/// The direction has any length but zero. World and object space share the parameter: a ray carried into the space of an
/// object is not made unit again, so hits compare across objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// x0, where t is 0.
    pub origin: DVec3,
    /// dx.
    pub direction: DVec3,
    /// Hits must have t > `t_min`: the small positive number of the text that keeps a ray from
    /// meeting the surface it starts on.
    pub t_min: f64,
    /// Hits must have t < `t_max`; infinite for a half-line.
    pub t_max: f64,
}

impl Ray {
    /// The half-line from `origin` along `direction`.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
    }

    /// The point at parameter `t`.
    #[must_use]
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Whether `t` lies strictly between the limits. Never for NaN.
    #[must_use]
    #[inline]
    pub fn admits(&self, t: f64) -> bool {
        t > self.t_min && t < self.t_max
    }

    /// Whether origin and direction are finite, the direction is not zero and the limits leave
    /// something between them. Other rays meet nothing.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != DVec3::ZERO
            && self.t_min < self.t_max
    }

    /// The ray after an affine map, with the same parameters.
    #[must_use]
    #[inline]
    pub fn transformed(&self, target_from_source: &DMat4) -> Self {
        Self {
            origin: target_from_source.transform_point3(self.origin),
            direction: target_from_source.transform_vector3(self.direction),
            ..*self
        }
    }
}
