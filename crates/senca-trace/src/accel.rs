//! Which object does a ray meet first? Several ways to find out, all with the same answer.
//!
//! | name | what it asks (course text, section 3.3) |
//! |---|---|
//! | `none` | every element of every object |
//! | `spheres`, `bounds` | the elements of objects whose bounding sphere or box the ray meets |
//! | `hierarchy` | the same along the scene's node tree, a box around every branch |
//! | `grid` | the elements in the cells of a uniform grid, cell after cell along the ray |
//! | `octree` | the elements in the leaves of an octree, leaf after leaf along the ray |
//! | `sah` | a binary hierarchy of boxes built by the surface area heuristic, the plain twin of `bvh` |
//! | `bvh` | wide hierarchies, one over the objects and one inside every mesh |
//!
//! An *element* is a part of an object: a triangle, a patch, or the whole of a shape that is one
//! thing. Rules that hold for all of them:
//!
//! 1. Of hits at the same t the one with the lowest object counts, then the one with the lowest part.
//! 2. Objects without bounds, such as endless planes, lie beside the structure and are always asked.
//! 3. Boxes are wider than what they hold by more than the rounding of the tests inside them, so no
//!    structure loses a hit that another one finds.

mod binary;
mod compare;
mod elements;
mod grid;
mod hierarchy;
mod list;
mod octree;
mod search;
mod settings;
mod slabs;
#[cfg(test)]
mod tests;
mod two_level;
mod volumes;

pub use binary::BinaryBvh;
pub use compare::{Comparison, compare};
pub use grid::Grid;
pub use hierarchy::Hierarchy;
pub use list::List;
pub use octree::Octree;
pub use settings::{Accel, AccelSettings, UnknownAccel};
pub use slabs::{Slabs, meets_sphere};
pub use two_level::TwoLevel;
pub use volumes::{BoundingSphere, Volume, Volumes};

use senca_math::Aabb;
use senca_scene::Scene;

use crate::world::{Hit, Object};
use crate::{Counters, Ray, TraceError};

/// A way to find what a ray meets among objects. It is asked with the objects it was built for.
pub trait Accelerator: Send + Sync + std::fmt::Debug {
    /// The nearest hit that the ray admits. Of hits at the same t the one with the lowest object,
    /// then the lowest part, counts.
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit>;

    /// Whether the ray meets anything that `blocks` it. Opaque objects ([`Object::opaque`]) block
    /// without being asked for. Hits of others come in no particular order, each at most once, and
    /// when nothing blocks each exactly once.
    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool;

    /// Bytes of memory that the structure holds on to.
    fn memory_bytes(&self) -> usize;

    /// Whether the structure may be passed by where there is but one object.
    fn may_skip(&self) -> bool {
        false
    }
}

/// Builds the accelerator that `settings` ask for over the objects of `scene`.
///
/// # Errors
/// [`TraceError::Setting`] when a setting is out of its range.
pub fn build(
    scene: &Scene,
    objects: &[Object<'_>],
    settings: &AccelSettings,
) -> Result<Box<dyn Accelerator>, TraceError> {
    settings.check()?;
    Ok(match settings.kind {
        Accel::None => Box::new(List),
        Accel::Spheres => Box::new(Volumes::<BoundingSphere>::new(objects)),
        Accel::Bounds => Box::new(Volumes::<Aabb>::new(objects)),
        Accel::Hierarchy => Box::new(Hierarchy::new(scene, objects)),
        Accel::Grid => Box::new(Grid::new(objects, settings.grid_cells)),
        Accel::Octree => Box::new(Octree::new(objects, settings.octree_depth, settings.leaf_size)),
        Accel::Sah => Box::new(BinaryBvh::new(objects, settings.leaf_size)),
        Accel::Bvh => Box::new(TwoLevel::new(objects)?),
    })
}
