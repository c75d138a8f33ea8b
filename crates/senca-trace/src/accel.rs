//! Which object does a ray meet first? Several ways to find out, all with the same answer.

mod list;

pub use list::List;

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

/// A way to find what a ray meets among objects.
pub trait Accelerator: Send + Sync + std::fmt::Debug {
    /// The nearest hit that the ray admits. Of hits at the same t the one with the lowest object,
    /// then the lowest part, counts.
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit>;

    /// Whether the ray meets anything that `blocks` it.
    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool;
}
