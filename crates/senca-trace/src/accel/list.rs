//! No acceleration: every element is asked.

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::Accelerator;
use super::search::{Blockers, Nearest};

/// The list of objects, gone through from end to end, part by part (course text, section 3.1).
#[derive(Clone, Copy, Debug, Default)]
pub struct List;

impl Accelerator for List {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        for object in 0..objects.len() as u32 {
            nearest.ask_parts(object, counters);
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
        let mut blockers = Blockers::new(objects, ray, blocks);
        (0..objects.len() as u32).any(|object| blockers.parts_block(object, counters))
    }

    fn memory_bytes(&self) -> usize {
        0
    }
}
