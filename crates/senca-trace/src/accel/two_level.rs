//! Two levels: a hierarchy over the objects, and another one inside every mesh.
//!
//! Objects that show the same mesh share its hierarchy, so a forest costs as much memory as a tree.

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::Accelerator;
use super::binary::BoxTree;
use super::search::{Blockers, Nearest};

/// A hierarchy over the boxes of objects; each object searches in itself.
#[derive(Debug)]
pub struct TwoLevel {
    /// Objects in the tree, by number of their box.
    objects: Vec<u32>,
    endless: Vec<u32>,
    tree: BoxTree,
}

impl TwoLevel {
    /// Over `objects`.
    #[must_use]
    pub fn new(objects: &[Object<'_>]) -> Self {
        let all = 0..objects.len() as u32;
        let object = |index: u32| &objects[index as usize];
        let endless = all.clone().filter(|&i| object(i).is_endless()).collect();
        let in_tree: Vec<u32> =
            all.filter(|&i| !object(i).is_endless() && !object(i).bounds_world.is_empty()).collect();
        let boxes: Vec<_> = in_tree.iter().map(|&i| object(i).bounds_world).collect();
        Self { tree: BoxTree::new(&boxes, 1), objects: in_tree, endless }
    }
}

impl Accelerator for TwoLevel {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_object(object, counters));
        let ray = nearest.ray;
        self.tree.traverse(&ray, counters, |items, counters| {
            items.iter().for_each(|&item| nearest.ask_object(self.objects[item as usize], counters));
            Some(nearest.t_max())
        });
        nearest.hit
    }

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
        let mut blocked = false;
        self.tree.traverse(ray, counters, |items, counters| {
            blocked = items.iter().any(|&item| blockers.object_blocks(self.objects[item as usize], counters));
            (!blocked).then_some(ray.t_max)
        });
        blocked
    }

    fn may_skip(&self) -> bool {
        true
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.objects) + size_of_val(&*self.endless) + self.tree.memory_bytes()
    }
}
