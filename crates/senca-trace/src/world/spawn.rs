//! Rays that start on surfaces.
//!
//! A point computed on a surface lies a little beside it, so a ray from there may meet the surface it
//! starts on: bodies get spots of their own shadow. The course text takes only hits above a small
//! positive t (section 3.2, second practical rule). One number does not suit a scene of kilometres and
//! one of microns, and at grazing angles no number is large enough: a ray that leaves the surface at the
//! angle a is still within the error e of it at t = e / sin a. Here the ray starts beside the surface
//! instead, by twice the error along the normal, on the side where it goes.

use senca_math::glam::DVec3;

use super::{Interaction, World};
use crate::Ray;

/// How many times the error a ray starts beside the surface.
pub(crate) const MARGIN: f64 = 2.0;
/// Share of the way to a target that counts: what is at the target itself does not block.
pub(crate) const UP_TO: f64 = 1.0 - 1.0 / (1u64 << 24) as f64;

impl World<'_> {
    /// The half-line from a place on a surface along `direction`, of any length but zero, that does not
    /// meet that surface where it starts.
    #[must_use]
    pub fn spawn(&self, at: &Interaction, direction: DVec3) -> Ray {
        match self.epsilon {
            Some(epsilon) => Ray { t_min: epsilon / direction.length(), ..Ray::new(at.point, direction) },
            None => Ray::new(beside(at, direction), direction),
        }
    }

    /// The piece of a line from a place on a surface up to `target`, where t is 1; what is at the target
    /// itself does not block. For shadow rays.
    #[must_use]
    pub fn spawn_to(&self, at: &Interaction, target: DVec3) -> Ray {
        let ray = self.spawn(at, target - at.point);
        Ray { direction: target - ray.origin, t_max: UP_TO, ..ray }
    }
}

/// The place beside the surface, on the side where `direction` goes.
fn beside(at: &Interaction, direction: DVec3) -> DVec3 {
    let along = at.normal.dot(direction);
    let outside = if along == 0.0 { at.entering } else { along > 0.0 };
    let offset = MARGIN * at.error * at.normal;
    if outside { at.point + offset } else { at.point - offset }
}
