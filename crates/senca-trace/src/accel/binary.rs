//! A binary hierarchy of boxes, built by the surface area heuristic.
//!
//! A miss of a node's box skips all below it (course text, section 3.3). Where the course text leaves
//! the finding of a good hierarchy open, this divides the boxes of a node in two where the sum over
//! both halves of surface area times count is smallest: the chance that a line which meets a convex
//! body also meets one inside it is the ratio of their areas (Goldsmith and Salmon 1987). Centres are
//! sorted into 16 bins along each axis, and only the borders between bins are tried (Wald 2007).

use senca_math::Aabb;
use senca_math::glam::DVec3;

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::elements::{Element, Elements};
use super::search::{Blockers, Nearest};
use super::{Accelerator, Slabs};

const BINS: usize = 16;
/// From this depth on nodes are halved by count, so that depth stays below [`STACK`].
const HALVED_FROM: u32 = 48;
/// Nodes that can be waiting: one for every level, 48 and then at most 32 halvings of a 32-bit count.
const STACK: usize = 96;
/// Cost of a step down relative to that of testing one element.
const STEP_COST: f64 = 0.5;

/// A node. The first child of an inner node follows it.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Second child of an inner node, first item of a leaf.
    next: u32,
    /// Items of a leaf; 0 for an inner node.
    count: u32,
}

/// The tree over numbered boxes, whatever they hold.
#[derive(Debug, Default)]
struct BoxTree {
    nodes: Vec<Node>,
    /// Numbers of the boxes, leaf after leaf.
    items: Vec<u32>,
}

impl BoxTree {
    /// A tree over `boxes`, none of them empty or endless, with leaves of up to `leaf_size`.
    fn new(boxes: &[Aabb], leaf_size: u32) -> Self {
        let mut tree = Self { nodes: Vec::new(), items: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            let count = boxes.len();
            let mut items = std::mem::take(&mut tree.items);
            Builder { boxes, leaf_size: leaf_size as usize, nodes: &mut tree.nodes }.build(&mut items, 0, 0);
            tree.items = items;
            debug_assert_eq!(tree.items.len(), count);
        }
        tree
    }

    /// Visits leaves that the ray meets, near ones first, and calls `visit` with the items of each;
    /// it returns the t beyond which nothing is of use, or `None` to stop.
    #[inline]
    fn traverse(
        &self,
        ray: &Ray,
        counters: &mut Counters,
        mut visit: impl FnMut(&[u32], &mut Counters) -> Option<f64>,
    ) {
        let slabs = Slabs::new(ray);
        let mut t_max = ray.t_max;
        let mut waiting = [(0u32, 0.0f64); STACK];
        let mut count = 0;
        let enter = |index: u32, t_max: f64, counters: &mut Counters| {
            counters.nodes += 1;
            let node = self.nodes.get(index as usize)?;
            slabs.interval(&node.bounds, ray.t_min, t_max).map(|(enter, _)| (index, enter))
        };
        let mut current = enter(0, t_max, counters);
        while let Some((index, _)) = current {
            let node = &self.nodes[index as usize];
            current = None;
            if node.count > 0 {
                let first = node.next as usize;
                match visit(&self.items[first..first + node.count as usize], counters) {
                    Some(t) => t_max = t,
                    None => return,
                }
            } else {
                let children = [enter(index + 1, t_max, counters), enter(node.next, t_max, counters)];
                current = match children {
                    [Some(a), Some(b)] => {
                        let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                        waiting[count] = far;
                        count += 1;
                        Some(near)
                    }
                    [a, b] => a.or(b),
                };
            }
            while current.is_none() && count > 0 {
                count -= 1;
                current = Some(waiting[count]).filter(|(_, enter)| *enter <= t_max);
            }
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.items)
    }
}

/// Half the surface of a box.
fn half_area(bounds: &Aabb) -> f64 {
    let d = bounds.size();
    d.x * d.y + d.y * d.z + d.z * d.x
}

struct Builder<'a> {
    boxes: &'a [Aabb],
    leaf_size: usize,
    nodes: &'a mut Vec<Node>,
}

impl Builder<'_> {
    /// Appends the tree over `items`, which start at `first` in the list of all.
    fn build(&mut self, items: &mut [u32], first: usize, depth: u32) {
        let bounds = self.around(items);
        let index = self.nodes.len();
        self.nodes.push(Node { bounds, next: first as u32, count: items.len() as u32 });
        let Some(middle) = self.divide(items, &bounds, depth) else { return };
        let (left, right) = items.split_at_mut(middle);
        self.build(left, first, depth + 1);
        self.nodes[index].next = self.nodes.len() as u32;
        self.nodes[index].count = 0;
        self.build(right, first + middle, depth + 1);
    }

    fn around(&self, items: &[u32]) -> Aabb {
        items.iter().fold(Aabb::EMPTY, |all, &i| all.union(self.boxes[i as usize]))
    }

    /// Sorts items to two sides and returns how many are on the first; `None` makes a leaf.
    fn divide(&self, items: &mut [u32], bounds: &Aabb, depth: u32) -> Option<usize> {
        if items.len() <= 1 {
            return None;
        }
        let boxes = self.boxes;
        let center = |item: u32| boxes[item as usize].center();
        let centers = Aabb::of_points(items.iter().map(|&i| center(i)));
        if depth < HALVED_FROM
            && let Some(plane) = self.best_plane(items, &centers)
        {
            let leaf_cost = items.len() as f64 * half_area(bounds);
            if items.len() <= self.leaf_size && plane.cost + STEP_COST * half_area(bounds) >= leaf_cost {
                return None;
            }
            let mut middle = 0;
            for i in 0..items.len() {
                if bin_of(center(items[i]), &centers, plane.axis) < plane.bin {
                    items.swap(i, middle);
                    middle += 1;
                }
            }
            return Some(middle);
        }
        // All centres in one place, or too deep: halves by count.
        let axis = longest_axis(&centers);
        let key = |&item: &u32| (center(item)[axis], item);
        items.sort_unstable_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        (items.len() > self.leaf_size).then_some(items.len() / 2)
    }

    /// The cheapest border between bins that has items on both sides.
    fn best_plane(&self, items: &[u32], centers: &Aabb) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        for axis in (0..3).filter(|&axis| centers.size()[axis] > 0.0) {
            let mut bins = [(Aabb::EMPTY, 0usize); BINS];
            for &item in items {
                let bounds = self.boxes[item as usize];
                let bin = &mut bins[bin_of(bounds.center(), centers, axis)];
                *bin = (bin.0.union(bounds), bin.1 + 1);
            }
            let cost = |part: (Aabb, usize)| part.1 as f64 * half_area(&part.0);
            let join = |a: (Aabb, usize), b: (Aabb, usize)| (a.0.union(b.0), a.1 + b.1);
            let mut right = [(Aabb::EMPTY, 0); BINS + 1];
            for bin in (0..BINS).rev() {
                right[bin] = join(bins[bin], right[bin + 1]);
            }
            let mut left = (Aabb::EMPTY, 0);
            for bin in 1..BINS {
                left = join(left, bins[bin - 1]);
                let cost = cost(left) + cost(right[bin]);
                let useful = left.1 > 0 && right[bin].1 > 0;
                if useful && best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Plane { axis, bin, cost });
                }
            }
        }
        best
    }
}

/// A border between bins: items in bins below `bin` are on the first side.
struct Plane {
    axis: usize,
    bin: usize,
    cost: f64,
}

fn bin_of(center: DVec3, centers: &Aabb, axis: usize) -> usize {
    let part = (center[axis] - centers.min[axis]) / (centers.max[axis] - centers.min[axis]);
    ((part * BINS as f64) as usize).min(BINS - 1)
}

fn longest_axis(bounds: &Aabb) -> usize {
    let size = bounds.size();
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

/// One binary hierarchy over the elements of all objects.
#[derive(Debug)]
pub struct BinaryBvh {
    elements: Vec<Element>,
    endless: Vec<u32>,
    tree: BoxTree,
}

impl BinaryBvh {
    /// Over all parts of `objects`, with leaves of up to `leaf_size` of them.
    #[must_use]
    pub fn new(objects: &[Object<'_>], leaf_size: u32) -> Self {
        let Elements { list, boxes, endless } = Elements::of_parts(objects);
        Self { tree: BoxTree::new(&boxes, leaf_size), elements: list, endless }
    }
}

impl Accelerator for BinaryBvh {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_parts(object, counters));
        let ray = nearest.ray;
        self.tree.traverse(&ray, counters, |items, counters| {
            for &item in items {
                let Element { object, part } = self.elements[item as usize];
                nearest.ask_part(object, part, counters);
            }
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
        let mut blockers = Blockers::new(objects, ray, blocks);
        if self.endless.iter().any(|&object| blockers.parts_block(object, counters)) {
            return true;
        }
        let mut blocked = false;
        self.tree.traverse(ray, counters, |items, counters| {
            blocked = items.iter().any(|&item| {
                let Element { object, part } = self.elements[item as usize];
                blockers.part_blocks(object, part, counters)
            });
            (!blocked).then_some(ray.t_max)
        });
        blocked
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.elements) + size_of_val(&*self.endless) + self.tree.memory_bytes()
    }
}
