//! No acceleration: every object is asked.

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::Accelerator;

/// The list of objects, gone through from end to end (course text, section 3.1).
#[derive(Clone, Copy, Debug, Default)]
pub struct List;

impl Accelerator for List {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut ray = *ray;
        let mut nearest = None;
        for (index, object) in objects.iter().enumerate() {
            let ray_object = ray.transformed(&object.object_from_world);
            if let Some(crossing) = object.surface.closest(&ray_object, counters) {
                ray.t_max = crossing.t;
                nearest = Some(Hit { object: index as u32, crossing });
            }
        }
        nearest
    }

    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        let mut ray = *ray;
        while let Some(hit) = self.closest(objects, &ray, counters) {
            if blocks(&hit) {
                return true;
            }
            ray.t_min = hit.crossing.t;
        }
        false
    }
}
