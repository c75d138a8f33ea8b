//! Two levels: a hierarchy over the objects, and another one inside every mesh.
//!
//! Objects that show the same mesh share its hierarchy, so a forest costs as much memory as a tree.

use senca_bvh::{Aabb32, BoxBvh, BuildSettings, Ray32, TraversalCounts};
use senca_math::Aabb;
use senca_math::glam::DVec3;

use crate::mesh_surface::rounded_up;
use crate::world::{Hit, Object, way_to_ball};
use crate::{Counters, Ray, TraceError};

use super::Accelerator;
use super::search::{Blockers, Nearest};

/// Share of the scene's radius by which boxes are widened: single precision moves a ray by less over
/// the ways that [`FAR`] allows.
const WIDENING: f64 = 1.0 / (1 << 19) as f64;
/// A ray that starts farther away than so many radii of the scene is moved up to it.
const FAR: f64 = 8.0;

/// A hierarchy over the boxes of objects; each object searches in itself.
///
/// Boxes are tested in single precision, around the middle of the scene; objects in double precision.
#[derive(Debug)]
pub struct TwoLevel {
    /// Objects in the hierarchy, by number of their box.
    objects: Vec<u32>,
    endless: Vec<u32>,
    hierarchy: BoxBvh,
    center: DVec3,
    radius: f64,
    far_squared: f64,
}

/// A ray as the boxes see it.
struct BoxRay {
    ray: Ray32,
    /// To be added to its t.
    shift: f64,
}

impl TwoLevel {
    /// Over `objects`.
    ///
    /// # Errors
    /// [`TraceError::Setting`] for more than 2^28 objects.
    pub fn new(objects: &[Object<'_>]) -> Result<Self, TraceError> {
        let all = 0..objects.len() as u32;
        let object = |index: u32| &objects[index as usize];
        let endless = all.clone().filter(|&i| object(i).is_endless()).collect();
        let bounded = |&i: &u32| !object(i).is_endless() && !object(i).bounds_world.is_empty();
        let bounded: Vec<u32> = all.filter(bounded).collect();
        let bounds = bounded.iter().fold(Aabb::EMPTY, |all, &i| all.union(object(i).bounds_world));
        let (center, radius) = (bounds.center(), 0.5 * bounds.diagonal());
        let around_center = |&i: &u32| {
            let b = object(i).bounds_world;
            let margin = DVec3::splat(WIDENING * radius);
            Aabb32::from(Aabb { min: b.min - center - margin, max: b.max - center + margin })
        };
        let boxes: Vec<Aabb32> = bounded.iter().map(around_center).collect();
        let too_many = |_| TraceError::Setting {
            name: "number of objects",
            value: boxes.len() as f64,
            expected: "at most 2^28",
        };
        let hierarchy = BoxBvh::build(&boxes, &BuildSettings::default()).map_err(too_many)?;
        Ok(Self { objects: bounded, endless, hierarchy, center, radius, far_squared: (FAR * radius).powi(2) })
    }

    #[inline]
    fn box_ray(&self, ray: &Ray) -> BoxRay {
        let from_center = ray.origin - self.center;
        if from_center.length_squared() > self.far_squared {
            return self.moved_up(ray, from_center);
        }
        BoxRay { ray: single(from_center, ray.direction, ray.t_min, ray.t_max), shift: 0.0 }
    }

    /// The ray from where it comes near the scene.
    #[cold]
    fn moved_up(&self, ray: &Ray, from_center: DVec3) -> BoxRay {
        let shift = way_to_ball(from_center, ray.direction, self.radius);
        let origin = from_center + shift * ray.direction;
        let t_min = (ray.t_min - shift).max(0.0);
        BoxRay { ray: single(origin, ray.direction, t_min, ray.t_max - shift), shift }
    }
}

/// The ray in single precision, its limits rounded outwards.
#[inline]
fn single(origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Ray32 {
    Ray32 {
        origin: origin.as_vec3(),
        t_min: -rounded_up(-t_min),
        direction: direction.as_vec3(),
        t_max: rounded_up(t_max),
    }
}

impl Accelerator for TwoLevel {
    #[inline]
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_object(object, counters));
        let boxes = self.box_ray(&nearest.ray);
        let mut counts = TraversalCounts::default();
        self.hierarchy.closest_counted(&boxes.ray, &mut counts, |item, _| {
            nearest.ask_object(self.objects[item as usize], counters);
            Some(rounded_up(nearest.t_max() - boxes.shift))
        });
        counters.nodes += counts.nodes;
        nearest.hit
    }

    #[inline]
    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        let blockers = Blockers::new(objects, ray, blocks);
        if self.endless.iter().any(|&object| blockers.object_blocks(object, counters)) {
            return true;
        }
        let boxes = self.box_ray(ray);
        let mut counts = TraversalCounts::default();
        let blocked = self.hierarchy.any_counted(&boxes.ray, &mut counts, |item| {
            blockers.object_blocks(self.objects[item as usize], counters)
        });
        counters.nodes += counts.nodes;
        blocked
    }

    fn may_skip(&self) -> bool {
        true
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.objects) + size_of_val(&*self.endless) + self.hierarchy.memory_bytes()
    }
}
