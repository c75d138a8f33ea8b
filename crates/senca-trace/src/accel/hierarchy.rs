//! The scene's own tree of nodes as a hierarchy of boxes.
//!
//! Whoever builds a scene groups what belongs together, and thus gives a hierarchy: a miss of a group's
//! box skips all that is below it (course text, section 3.3). How good it is depends on the grouping.

use senca_math::Aabb;
use senca_scene::{NodeId, Scene};

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::search::{Blockers, Nearest};
use super::{Accelerator, Slabs};

/// A node of the scene with the box around it and all below it.
#[derive(Clone, Copy, Debug)]
struct Branch {
    bounds: Aabb,
    node: NodeId,
    /// Where to go on when the box is missed: behind everything below it.
    skip: u32,
    /// The object that the node itself places.
    object: Option<u32>,
}

/// The boxes of the scene's nodes, every node before those below it.
#[derive(Debug)]
pub struct Hierarchy {
    branches: Vec<Branch>,
    endless: Vec<u32>,
}

impl Hierarchy {
    /// The tree of `scene`, whose objects are `objects`. Nodes with nothing to meet below them are left
    /// out.
    #[must_use]
    pub fn new(scene: &Scene, objects: &[Object<'_>]) -> Self {
        let mut object_of = vec![None; scene.nodes.len()];
        let mut endless = Vec::new();
        for (index, object) in objects.iter().enumerate() {
            if object.is_endless() {
                endless.push(index as u32);
            } else if !object.bounds_world.is_empty() {
                object_of[object.node.index()] = Some(index as u32);
            }
        }
        let branches = close(open(scene, &object_of), objects);
        Self { branches, endless }
    }

    /// The nodes whose boxes a search for the nearest hit tests, in order, each with whether the ray
    /// met it.
    #[must_use]
    pub fn tested(&self, objects: &[Object<'_>], ray: &Ray) -> Vec<(NodeId, bool)> {
        let mut tested = Vec::new();
        let _ = self.search(objects, ray, &mut Counters::default(), |node, met| tested.push((node, met)));
        tested
    }

    fn search(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        mut report: impl FnMut(NodeId, bool),
    ) -> Option<Hit> {
        let slabs = Slabs::new(ray);
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_parts(object, counters));
        let mut index = 0;
        while let Some(branch) = self.branches.get(index) {
            counters.nodes += 1;
            let met = slabs.interval(&branch.bounds, ray.t_min, nearest.t_max()).is_some();
            report(branch.node, met);
            if let (true, Some(object)) = (met, branch.object) {
                nearest.ask_parts(object, counters);
            }
            index = if met { index + 1 } else { branch.skip as usize };
        }
        nearest.hit
    }
}

/// All nodes that roots reach, every one before those below it, each with its depth. Boxes are empty.
fn open(scene: &Scene, object_of: &[Option<u32>]) -> Vec<(Branch, u32)> {
    let mut reached = vec![false; scene.nodes.len()];
    let mut waiting: Vec<(NodeId, u32)> = scene.roots.iter().rev().map(|&root| (root, 0)).collect();
    let mut branches = Vec::new();
    while let Some((id, depth)) = waiting.pop() {
        let Some(node) = scene.nodes.get(id.index()).filter(|_| !reached[id.index()]) else { continue };
        reached[id.index()] = true;
        let object = object_of[id.index()];
        branches.push((Branch { bounds: Aabb::EMPTY, node: id, skip: 0, object }, depth));
        waiting.extend(node.children.iter().rev().map(|&child| (child, depth + 1)));
    }
    branches
}

/// Finds the boxes from the last node to the first, and leaves out nodes with nothing in them.
fn close(mut open: Vec<(Branch, u32)>, objects: &[Object<'_>]) -> Vec<Branch> {
    // Boxes of finished branches by depth, which wait for their parent.
    let mut below = vec![Aabb::EMPTY; open.iter().map(|(_, depth)| *depth as usize + 2).max().unwrap_or(0)];
    for (branch, depth) in open.iter_mut().rev() {
        let depth = *depth as usize;
        let own = branch.object.map_or(Aabb::EMPTY, |object| objects[object as usize].bounds_world);
        branch.bounds = own.union(std::mem::take(&mut below[depth + 1]));
        below[depth] = below[depth].union(branch.bounds);
    }
    open.retain(|(branch, _)| !branch.bounds.is_empty());

    // Where the next node that is not deeper begins.
    let mut ends: Vec<(u32, u32)> = Vec::new();
    let count = open.len() as u32;
    for (index, (branch, depth)) in open.iter_mut().enumerate().rev() {
        while ends.last().is_some_and(|(_, other)| *other > *depth) {
            ends.pop();
        }
        branch.skip = ends.last().map_or(count, |(start, _)| *start);
        ends.push((index as u32, *depth));
    }
    open.into_iter().map(|(branch, _)| branch).collect()
}

impl Accelerator for Hierarchy {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        self.search(objects, ray, counters, |_, _| ())
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
        if self.endless.iter().any(|&object| blockers.parts_block(object, counters)) {
            return true;
        }
        let mut index = 0;
        while let Some(branch) = self.branches.get(index) {
            counters.nodes += 1;
            let met = slabs.interval(&branch.bounds, ray.t_min, ray.t_max).is_some();
            if met && branch.object.is_some_and(|object| blockers.parts_block(object, counters)) {
                return true;
            }
            index = if met { index + 1 } else { branch.skip as usize };
        }
        false
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.branches) + size_of_val(&*self.endless)
    }
}
