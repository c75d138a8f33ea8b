//! The state of a search for the nearest hit, or for anything that blocks.

use crate::world::{Hit, LocalRay, Object};
use crate::{Counters, Crossing, Ray};

/// The nearest hit so far. All accelerators choose among hits here, so they choose alike.
pub(super) struct Nearest<'a, 's> {
    objects: &'a [Object<'s>],
    /// Admits what is at least as near as the nearest hit so far.
    pub(super) ray: Ray,
    pub(super) hit: Option<Hit>,
    /// The parameter of the nearest hit in its object's space, where it may have more digits.
    t_local: f64,
    local: Cached,
}

/// The ray in the space of the object that was asked last.
struct Cached {
    object: u32,
    ray: LocalRay,
}

impl Cached {
    fn new(ray: &Ray) -> Self {
        Self { object: u32::MAX, ray: LocalRay { ray: *ray, shift: 0.0 } }
    }

    #[inline]
    fn of(&mut self, objects: &[Object<'_>], object: u32, ray: &Ray) -> LocalRay {
        if self.object != object {
            *self = Self { object, ray: objects[object as usize].local(ray) };
        }
        self.ray.with_limits(ray)
    }
}

impl<'a, 's> Nearest<'a, 's> {
    pub(super) fn new(objects: &'a [Object<'s>], ray: &Ray) -> Self {
        Self { objects, ray: *ray, hit: None, t_local: f64::INFINITY, local: Cached::new(ray) }
    }

    /// Nothing farther than this t is of use.
    #[inline]
    pub(super) fn t_max(&self) -> f64 {
        self.ray.t_max
    }

    /// Asks an object as a whole.
    #[inline]
    pub(super) fn ask_object(&mut self, object: u32, counters: &mut Counters) {
        let placed = &self.objects[object as usize];
        let local = placed.local(&self.ray);
        if let Some(found) = placed.surface.closest(&local.ray, counters) {
            self.take(object, &local, found);
        }
    }

    /// Asks one part of an object.
    #[inline]
    pub(super) fn ask_part(&mut self, object: u32, part: u32, counters: &mut Counters) {
        let local = self.local.of(self.objects, object, &self.ray);
        let surface = &self.objects[object as usize].surface;
        if let Some(found) = surface.closest_in_part(part, &local.ray, counters) {
            self.take(object, &local, found);
        }
    }

    /// Asks all parts of an object, one after the other.
    pub(super) fn ask_parts(&mut self, object: u32, counters: &mut Counters) {
        for part in 0..self.objects[object as usize].surface.part_count() {
            self.ask_part(object, part, counters);
        }
    }

    /// Keeps a hit when it is nearer than the nearest, or as near and of a lower object or part.
    #[inline]
    fn take(&mut self, object: u32, local: &LocalRay, found: Crossing) {
        let crossing = local.in_world(found);
        let before = |hit: &Hit| {
            (crossing.t, object, found.t, crossing.part)
                < (hit.crossing.t, hit.object, self.t_local, hit.crossing.part)
        };
        if self.ray.admits(crossing.t) && self.hit.as_ref().is_none_or(before) {
            self.hit = Some(Hit { object, crossing });
            self.t_local = found.t;
            self.ray.t_max = crossing.t.next_up();
        }
    }
}

/// The question whether anything blocks a ray.
pub(super) struct Blockers<'a, 's> {
    objects: &'a [Object<'s>],
    pub(super) ray: Ray,
    blocks: &'a dyn Fn(&Hit) -> bool,
    local: Cached,
}

impl<'a, 's> Blockers<'a, 's> {
    pub(super) fn new(objects: &'a [Object<'s>], ray: &Ray, blocks: &'a dyn Fn(&Hit) -> bool) -> Self {
        Self { objects, ray: *ray, blocks, local: Cached::new(ray) }
    }

    /// Whether anything of the object blocks.
    #[inline]
    pub(super) fn object_blocks(&self, object: u32, counters: &mut Counters) -> bool {
        self.objects[object as usize].blocks(object, &self.ray, counters, self.blocks)
    }

    /// Whether anything of one part of an object blocks.
    #[inline]
    pub(super) fn part_blocks(&mut self, object: u32, part: u32, counters: &mut Counters) -> bool {
        let mut local = self.local.of(self.objects, object, &self.ray);
        let placed = &self.objects[object as usize];
        while let Some(found) = placed.surface.closest_in_part(part, &local.ray, counters) {
            let crossing = local.in_world(found);
            if self.ray.admits(crossing.t) && (placed.opaque || (self.blocks)(&Hit { object, crossing })) {
                return true;
            }
            local.ray.t_min = found.t;
        }
        false
    }

    /// Whether anything of an object's parts blocks, one after the other.
    pub(super) fn parts_block(&mut self, object: u32, counters: &mut Counters) -> bool {
        let count = self.objects[object as usize].surface.part_count();
        (0..count).any(|part| self.part_blocks(object, part, counters))
    }
}
