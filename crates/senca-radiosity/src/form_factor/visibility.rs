//! Whether two places see each other.

use senca_math::glam::DVec3;

/// Whether two places see each other: H of the course text, equation 4.7. Asked from several threads.
pub trait Visibility: Sync {
    /// Whether nothing is between `from` and `to`. What the two places themselves lie on does not count.
    fn visible(&self, from: DVec3, to: DVec3) -> bool;
}

/// Nothing is in the way anywhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unoccluded;

impl Visibility for Unoccluded {
    fn visible(&self, _: DVec3, _: DVec3) -> bool {
        true
    }
}

impl<F: Fn(DVec3, DVec3) -> bool + Sync> Visibility for F {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        self(from, to)
    }
}
