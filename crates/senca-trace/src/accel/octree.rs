//! An octree: large cells where there is little, small ones where there is much.
//!
//! The course text (section 3.3) names it for scenes that are not evenly filled. A cube around the scene
//! is divided into eight, and each of those again while it lists many elements. A ray visits the leaves it
//! goes through, near ones first; in each, the three middle planes tell where it changes from one eighth
//! to the next (Revelles, Ureña and Lastra 2000). As in the grid, a hit ends the search only when it
//! lies in the leaves visited so far.

use senca_math::Aabb;
use senca_math::glam::DVec3;
use smallvec::SmallVec;

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::elements::{Element, Elements};
use super::search::{Blockers, Nearest};
use super::{Accelerator, Slabs};

/// Deepest octree that can be asked for.
pub(super) const DEEPEST: u32 = 20;
/// Nodes that can be waiting: up to four eighths of each level, of which one is taken up at once.
const STACK: usize = 3 * DEEPEST as usize + 4;
/// Entries in lists for each element, on average, beyond which nothing is divided any more.
const ENTRIES_PER_ELEMENT: usize = 32;
/// A division must not make the lists longer than so many times.
const WORTHWHILE: usize = 4;
/// Share of the cube by which elements are listed beyond their boxes: more than rounding moves a ray.
const SLACK: f64 = 1e-9;
/// Places of the mailbox, a power of two.
const MAILBOX: usize = 64;

/// A node of the octree.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// Number of the first of eight children; bit 0 of a child's place chooses the upper half in x,
    /// bit 1 in y, bit 2 in z.
    Inner(u32),
    /// Range of a leaf's list.
    Leaf(u32, u32),
}

/// A cube with what a ray has left of it.
#[derive(Clone, Copy, Debug)]
struct Visit {
    node: u32,
    center: DVec3,
    half: f64,
    enter: f64,
    leave: f64,
}

/// An octree over the elements of all objects.
#[derive(Debug)]
pub struct Octree {
    center: DVec3,
    half: f64,
    nodes: Vec<Node>,
    lists: Vec<u32>,
    elements: Vec<Element>,
    endless: Vec<u32>,
}

impl Octree {
    /// Over all parts of `objects`: cubes with more than `leaf_size` parts are divided, up to `depth`
    /// levels, from 0 to 20.
    #[must_use]
    pub fn new(objects: &[Object<'_>], depth: u32, leaf_size: u32) -> Self {
        let Elements { list, boxes, endless } = Elements::of_parts(objects);
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        let half = 0.5 * bounds.size().max_element();
        let mut builder = Builder {
            boxes: &boxes,
            leaf_size: leaf_size as usize,
            slack: SLACK * half,
            entries_left: ENTRIES_PER_ELEMENT * boxes.len() + (1 << 12),
            nodes: vec![Node::Leaf(0, 0)],
            lists: Vec::new(),
        };
        builder.build(0, bounds.center(), half, (0..boxes.len() as u32).collect(), depth.min(DEEPEST));
        let Builder { nodes, lists, .. } = builder;
        Self { center: bounds.center(), half, nodes, lists, elements: list, endless }
    }

    /// Number of leaves.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.nodes.iter().filter(|node| matches!(node, Node::Leaf(..))).count()
    }

    /// Visits the lists of the leaves along the ray, with the t at which it leaves them, until `visit`
    /// says no.
    #[inline]
    fn walk(
        &self,
        ray: &Ray,
        counters: &mut Counters,
        mut visit: impl FnMut(&[u32], f64, &mut Counters) -> bool,
    ) {
        let reach = DVec3::splat(self.half);
        let cube = Aabb { min: self.center - reach, max: self.center + reach };
        let Some((enter, leave)) = Slabs::new(ray).interval(&cube, ray.t_min, ray.t_max) else { return };
        let root = Visit { node: 0, center: self.center, half: self.half, enter, leave };
        let mut waiting: SmallVec<[Visit; STACK]> = SmallVec::new();
        waiting.push(root);
        let reciprocal = ray.direction.recip();
        while let Some(cube) = waiting.pop() {
            match self.nodes[cube.node as usize] {
                Node::Inner(first) => {
                    counters.nodes += 1;
                    let middles = middle_planes(ray, reciprocal, cube.center);
                    let start = waiting.len();
                    each_eighth(ray, &middles, &cube, |place, enter, leave| {
                        let half = 0.5 * cube.half;
                        let center = cube.center + half * towards(place);
                        waiting.push(Visit { node: first + place, center, half, enter, leave });
                    });
                    waiting[start..].reverse();
                }
                Node::Leaf(start, end) => {
                    counters.cells += 1;
                    let list = &self.lists[start as usize..end as usize];
                    if !visit(list, cube.leave, counters) {
                        return;
                    }
                }
            }
        }
    }
}

/// Signs of the direction from a cube's centre to that of one of its eighths.
fn towards(place: u32) -> DVec3 {
    let sign = |bit: u32| if place & bit == 0 { -1.0 } else { 1.0 };
    DVec3::new(sign(1), sign(2), sign(4))
}

/// The t at which the ray meets the three middle planes; infinite for planes that it keeps beside.
fn middle_planes(ray: &Ray, reciprocal: DVec3, center: DVec3) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let t = (center[axis] - ray.origin[axis]) * reciprocal[axis];
        if reciprocal[axis].is_finite() { t } else { f64::INFINITY }
    })
}

/// Calls `visit` with the eighths along the ray, in order: place, and t where it is entered and left.
#[inline]
fn each_eighth(ray: &Ray, middles: &[f64; 3], cube: &Visit, mut visit: impl FnMut(u32, f64, f64)) {
    let is_upper = |axis: usize| {
        let (direction, t) = (ray.direction[axis], middles[axis]);
        if t == f64::INFINITY {
            return ray.origin[axis] >= cube.center[axis];
        }
        if direction > 0.0 { cube.enter >= t } else { cube.enter < t }
    };
    let mut place = (0..3).filter(|&axis| is_upper(axis)).fold(0, |place, axis| place | 1 << axis);
    let mut enter = cube.enter;
    loop {
        let mut next = (cube.leave, None);
        for (axis, &t) in middles.iter().enumerate() {
            let bit = 1u32 << axis;
            // Still to come: the upper half of a ray that goes down, the lower one of a ray that goes up.
            let to_come = (place & bit == 0) == (ray.direction[axis] > 0.0);
            if to_come && t < next.0 {
                next = (t, Some(bit));
            }
        }
        let leave = next.0.max(enter);
        visit(place, enter, leave);
        let Some(bit) = next.1 else { return };
        place ^= bit;
        enter = leave;
    }
}

struct Builder<'a> {
    boxes: &'a [Aabb],
    leaf_size: usize,
    slack: f64,
    entries_left: usize,
    nodes: Vec<Node>,
    lists: Vec<u32>,
}

impl Builder<'_> {
    /// Makes a node of `items` with up to `depth` levels below it.
    fn build(&mut self, node: usize, center: DVec3, half: f64, items: Vec<u32>, depth: u32) {
        let Some(eighths) = self.divided(center, half, &items, depth) else {
            let start = self.lists.len() as u32;
            self.lists.extend(items);
            self.nodes[node] = Node::Leaf(start, self.lists.len() as u32);
            return;
        };
        drop(items);
        let first = self.nodes.len();
        self.nodes[node] = Node::Inner(first as u32);
        self.nodes.extend([Node::Leaf(0, 0); 8]);
        for (place, items) in eighths.into_iter().enumerate() {
            let half = 0.5 * half;
            self.build(first + place, center + half * towards(place as u32), half, items, depth - 1);
        }
    }

    /// What reaches into each eighth; `None` when it is not worthwhile.
    fn divided(&mut self, center: DVec3, half: f64, items: &[u32], depth: u32) -> Option<[Vec<u32>; 8]> {
        if items.len() <= self.leaf_size || depth == 0 || half == 0.0 {
            return None;
        }
        let mut eighths: [Vec<u32>; 8] = Default::default();
        for &item in items {
            let bounds = &self.boxes[item as usize];
            let lower = bounds.min.cmple(center + self.slack).bitmask();
            let upper = bounds.max.cmpge(center - self.slack).bitmask();
            for (place, eighth) in (0u32..).zip(&mut eighths) {
                let reaches = (place & !upper) | (!place & 7 & !lower);
                if reaches == 0 {
                    eighth.push(item);
                }
            }
        }
        let entries: usize = eighths.iter().map(Vec::len).sum();
        let more = entries - items.len();
        if entries > WORTHWHILE * items.len() || more > self.entries_left {
            return None;
        }
        self.entries_left -= more;
        Some(eighths)
    }
}

/// Marks of the elements that a ray has been tested against. A mark may be overwritten by another one:
/// then an element is tested again, with the same answer.
struct Mailbox([u32; MAILBOX]);

impl Mailbox {
    fn new() -> Self {
        Self([u32::MAX; MAILBOX])
    }

    /// Whether the element has no mark; then it gets one.
    #[inline]
    fn is_new(&mut self, element: u32) -> bool {
        std::mem::replace(&mut self.0[element as usize % MAILBOX], element) != element
    }
}

impl Accelerator for Octree {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_parts(object, counters));
        let ray = nearest.ray;
        let mut mailbox = Mailbox::new();
        self.walk(&ray, counters, |list, leave, counters| {
            for &element in list {
                if mailbox.is_new(element) {
                    let Element { object, part } = self.elements[element as usize];
                    nearest.ask_part(object, part, counters);
                }
            }
            nearest.t_max() > leave
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
        let mut mailbox = Mailbox::new();
        // Hits that the caller is asked about are to be offered once, so these are marked for good.
        let mut offered: SmallVec<[u32; 32]> = SmallVec::new();
        let mut blocked = false;
        self.walk(ray, counters, |list, _, counters| {
            blocked = list.iter().any(|&element| {
                let Element { object, part } = self.elements[element as usize];
                if !mailbox.is_new(element) || offered.contains(&element) {
                    return false;
                }
                if !objects[object as usize].opaque {
                    offered.push(element);
                }
                blockers.part_blocks(object, part, counters)
            });
            !blocked
        });
        blocked
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.nodes)
            + size_of_val(&*self.lists)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.endless)
    }
}

#[cfg(test)]
mod tests {
    use senca_math::glam::DMat4;
    use senca_scene::{GeometryId, Node as SceneNode, Scene, Shape, Transform};

    use super::*;
    use crate::{Accel, AccelSettings, World, WorldSettings};

    /// Many small balls in a corner, and one far away.
    fn uneven() -> Scene {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 0.004 });
        scene.roots.clear();
        for i in 0..513u32 {
            let near = DVec3::new(f64::from(i % 8), f64::from(i / 8 % 8), f64::from(i / 64)) * 0.01;
            let place = if i == 512 { DVec3::splat(10.0) } else { near };
            let transform = Transform::Matrix(DMat4::from_translation(place));
            let geometry = Some(GeometryId(0));
            let node = scene.add_node(SceneNode { geometry, transform, ..SceneNode::default() });
            scene.roots.push(node);
        }
        scene
    }

    fn tests(scene: &Scene, kind: Accel, ray: &Ray) -> u64 {
        let accel = AccelSettings { grid_cells: Some(10), ..kind.into() };
        let world = World::with_settings(scene, &WorldSettings { accel, ..WorldSettings::default() });
        let mut counters = Counters::default();
        let _ = world.expect("a world").closest(ray, &mut counters);
        counters.tests
    }

    #[test]
    fn it_divides_where_there_is_much() {
        let scene = uneven();
        let past_all = Ray::new(DVec3::new(-1.0, 0.035, 0.045), DVec3::X);
        assert_eq!(tests(&scene, Accel::Grid, &past_all), 512, "all lie in one cell of the grid");
        let few = tests(&scene, Accel::Octree, &past_all);
        assert!((1..=64).contains(&few), "{few}");
    }

    #[test]
    fn depth_and_leaf_size_are_kept() {
        let scene = uneven();
        let world = World::new(&scene).expect("a world");
        assert_eq!(Octree::new(world.objects(), 0, 4).leaf_count(), 1);
        assert_eq!(Octree::new(world.objects(), 1, 4).leaf_count(), 8);
        assert_eq!(Octree::new(world.objects(), 12, 513).leaf_count(), 1);
        let octree = Octree::new(world.objects(), 12, 8);
        for node in &octree.nodes {
            assert!(!matches!(node, Node::Leaf(start, end) if end - start > 16));
        }
    }

    #[test]
    fn eighths_come_in_the_order_of_the_ray() {
        let cube = Visit { node: 0, center: DVec3::ZERO, half: 1.0, enter: 0.0, leave: 2.0 };
        let order = |origin: [f64; 3], direction: [f64; 3]| {
            let ray = Ray::new(origin.into(), direction.into());
            let middles = middle_planes(&ray, ray.direction.recip(), cube.center);
            let mut places = Vec::new();
            each_eighth(&ray, &middles, &cube, |place, enter, leave| {
                assert!(enter <= leave);
                places.push(place);
            });
            places
        };
        assert_eq!(order([-1.0, -0.5, -0.5], [1.0, 0.0, 0.0]), [0, 1]);
        assert_eq!(order([1.0, 0.5, 0.5], [-1.0, 0.0, 0.0]), [7, 6]);
        assert_eq!(order([-1.0, -0.9, -0.8], [1.0, 1.0, 1.0]), [0, 4, 6, 7]);
        assert_eq!(order([1.0, 0.9, -0.8], [-1.0, -1.0, 1.0]), [3, 7, 5, 4]);
        assert_eq!(order([0.0, -1.0, 0.5], [0.0, 1.0, 0.0]), [5, 7]);
    }
}
