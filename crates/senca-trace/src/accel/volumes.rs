//! A simple volume around every object, tested before the object itself.
//!
//! A miss of the volume skips the object, a hit leads to the full test (course text, section 3.3). The
//! volume must hold the whole of the object closely, be cheap to test, and be easy to find. Spheres are
//! the cheapest to test; boxes fit most bodies better and are found by a minimum and a maximum. Both are
//! loose around something long that lies askew.

use senca_math::Aabb;
use senca_math::glam::DVec3;

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::search::{Blockers, Nearest};
use super::{Accelerator, Slabs, meets_sphere};

/// One volume around every object, by which it is passed over or asked part by part.
#[derive(Debug)]
pub struct Volumes<V> {
    /// In the order of the objects.
    volumes: Vec<V>,
}

/// A bounding volume.
pub trait Volume: Send + Sync + std::fmt::Debug {
    /// Around an object.
    fn around(object: &Object<'_>) -> Self;

    /// Whether the ray meets the volume between its limits.
    fn is_met(&self, ray: &Ray, slabs: &Slabs) -> bool;
}

/// A sphere around an object, with an infinite radius around what is endless.
#[derive(Clone, Copy, Debug)]
pub struct BoundingSphere {
    /// Centre, in the world.
    pub center: DVec3,
    /// Radius; negative around nothing.
    pub radius: f64,
}

impl Volume for BoundingSphere {
    /// The smallest sphere around the parts' boxes that has its centre in the middle of the object's
    /// box. A body of one part has the sphere around its box, unless it knows a closer one.
    fn around(object: &Object<'_>) -> Self {
        let bounds = object.bounds_world;
        if object.is_endless() {
            return Self { center: DVec3::ZERO, radius: f64::INFINITY };
        }
        let center = bounds.center();
        let corners = |part| object.part_bounds_world(part).corners();
        let farthest = |part| corners(part).map(|c| c.distance(center)).into_iter().fold(-1.0, f64::max);
        let parts = (0..object.surface.part_count()).filter(|&p| !object.part_bounds_world(p).is_empty());
        Self { center, radius: parts.map(farthest).fold(-1.0, f64::max) }
    }

    fn is_met(&self, ray: &Ray, _: &Slabs) -> bool {
        self.radius >= 0.0 && (self.radius == f64::INFINITY || meets_sphere(ray, self.center, self.radius))
    }
}

impl Volume for Aabb {
    fn around(object: &Object<'_>) -> Self {
        object.bounds_world
    }

    fn is_met(&self, ray: &Ray, slabs: &Slabs) -> bool {
        slabs.interval(self, ray.t_min, ray.t_max).is_some()
    }
}

impl<V: Volume> Volumes<V> {
    /// Around `objects`.
    #[must_use]
    pub fn new(objects: &[Object<'_>]) -> Self {
        Self { volumes: objects.iter().map(V::around).collect() }
    }

    /// The volumes, in the order of the objects.
    #[must_use]
    pub fn volumes(&self) -> &[V] {
        &self.volumes
    }
}

impl<V: Volume> Accelerator for Volumes<V> {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let slabs = Slabs::new(ray);
        let mut nearest = Nearest::new(objects, ray);
        for (object, volume) in self.volumes.iter().enumerate() {
            counters.nodes += 1;
            if volume.is_met(&nearest.ray, &slabs) {
                nearest.ask_parts(object as u32, counters);
            }
        }
        nearest.hit
    }

    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        let slabs = Slabs::new(ray);
        let mut blockers = Blockers::new(objects, ray, blocks);
        self.volumes.iter().enumerate().any(|(object, volume)| {
            counters.nodes += 1;
            volume.is_met(ray, &slabs) && blockers.parts_block(object as u32, counters)
        })
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.volumes)
    }
}
