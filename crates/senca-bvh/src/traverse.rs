//! The walk of one ray through the nodes.

use fearless_simd::{Simd, f32x8, prelude::*};

use crate::memory::prefetch;
use crate::node::{Child, Node, WIDTH};
use crate::order::{ORDERS, octant};
use crate::prepared::{PreparedRay, Products};
use crate::stack::{Places, Stack};

/// Levels of nodes a hierarchy may have; see the build.
pub(crate) const MAX_DEPTH: usize = 48;

/// Places on the stack: each level leaves at most seven siblings behind, and all eight places after them
/// are written.
const STACK: usize = (WIDTH - 1) * MAX_DEPTH + WIDTH;

/// What is done at the leaves.
pub(crate) trait Visitor {
    /// Whether the walk is likely to end at the first leaf with a hit, so that the order of leaves does not
    /// matter.
    const ANY: bool;

    /// Whether the hierarchy is so large that asking for children before they are tested pays.
    const IS_LARGE: bool = false;

    /// Tests the items of a leaf; may lower `t_max`. True ends the walk.
    fn leaf<S: Simd>(&mut self, simd: S, ray: &LaneRay<S>, leaf: Child, t_max: &mut f32) -> bool;

    /// A leaf may be tested soon.
    #[inline(always)]
    fn prefetch(&self, _: Child) {}

    /// A node is about to be tested.
    #[inline(always)]
    fn node(&mut self) {}
}

/// A ray in all lanes.
pub(crate) struct LaneRay<'a, S: Simd> {
    pub(crate) prepared: &'a PreparedRay,
    pub(crate) origin: [f32x8<S>; 3],
    pub(crate) near_reciprocal: [f32x8<S>; 3],
    pub(crate) far_reciprocal: [f32x8<S>; 3],
    pub(crate) t_min: f32x8<S>,
    products: LaneProducts<S>,
    /// Row of a node's bounds with the planes the ray meets first.
    near: [usize; 3],
}

impl<'a, S: Simd> LaneRay<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &'a PreparedRay, products: &Products) -> Self {
        Self {
            prepared: ray,
            origin: splat(simd, ray.origin),
            near_reciprocal: splat(simd, ray.near_reciprocal),
            far_reciprocal: splat(simd, ray.far_reciprocal),
            t_min: f32x8::splat(simd, ray.t_min),
            products: LaneProducts {
                near_reciprocal: splat(simd, products.near_reciprocal),
                near_offset: splat(simd, products.near_offset),
                far_reciprocal: splat(simd, products.far_reciprocal),
                far_offset: splat(simd, products.far_offset),
            },
            near: [
                usize::from(ray.downward[0]),
                2 + usize::from(ray.downward[1]),
                4 + usize::from(ray.downward[2]),
            ],
        }
    }
}

/// [`Products`] in all lanes.
struct LaneProducts<S: Simd> {
    near_reciprocal: [f32x8<S>; 3],
    near_offset: [f32x8<S>; 3],
    far_reciprocal: [f32x8<S>; 3],
    far_offset: [f32x8<S>; 3],
}

#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}

/// The larger of both; `keep` where `value` is NaN. `keep` is not.
#[inline(always)]
pub(crate) fn max_or<S: Simd>(value: f32x8<S>, keep: f32x8<S>) -> f32x8<S> {
    // On x86 the instruction itself gives its second operand when one is NaN.
    if cfg!(any(target_arch = "x86", target_arch = "x86_64")) {
        value.max(keep)
    } else {
        value.max_precise(keep)
    }
}

/// The smaller of both; `keep` where `value` is NaN. `keep` is not.
#[inline(always)]
pub(crate) fn min_or<S: Simd>(value: f32x8<S>, keep: f32x8<S>) -> f32x8<S> {
    if cfg!(any(target_arch = "x86", target_arch = "x86_64")) {
        value.min(keep)
    } else {
        value.min_precise(keep)
    }
}

/// Where the ray enters the children, and which of them it meets between its limits. With PRODUCTS, by one
/// instruction a plane, and maybe a little before and after the leaves' own test would say so.
#[inline(always)]
fn meet<S: Simd, const PRODUCTS: bool>(
    simd: S,
    ray: &LaneRay<S>,
    node: &Node,
    t_max: f32,
) -> (f32x8<S>, u32) {
    let mut enter = ray.t_min;
    let mut leave = f32x8::splat(simd, t_max);
    for axis in 0..3 {
        let near = f32x8::load_array_ref(simd, &node.bounds[ray.near[axis]]);
        let far = f32x8::load_array_ref(simd, &node.bounds[ray.near[axis] ^ 1]);
        let (near, far) = if PRODUCTS {
            let products = &ray.products;
            (
                near.mul_sub(products.near_reciprocal[axis], products.near_offset[axis]),
                far.mul_sub(products.far_reciprocal[axis], products.far_offset[axis]),
            )
        } else {
            (
                (near - ray.origin[axis]) * ray.near_reciprocal[axis],
                (far - ray.origin[axis]) * ray.far_reciprocal[axis],
            )
        };
        enter = max_or(near, enter);
        leave = min_or(far, leave);
    }
    (enter, enter.simd_le(leave).to_bitmask() as u32)
}

/// Visits the leaves whose boxes the ray meets between `t_min` and `t_max`, roughly from near to far.
/// Ends when the visitor says so.
#[inline(always)]
pub(crate) fn walk<S: Simd, V: Visitor>(simd: S, nodes: &[Node], ray: &PreparedRay, visitor: &mut V) {
    if nodes.is_empty() {
        return;
    }
    if let Some(products) = ray.products() {
        let lanes = LaneRay::new(simd, ray, &products);
        descend::<S, V, true>(simd, nodes, &lanes, visitor);
    } else {
        let lanes = LaneRay::new(simd, ray, &Products::default());
        descend::<S, V, false>(simd, nodes, &lanes, visitor);
    }
}

#[inline(always)]
fn descend<S: Simd, V: Visitor, const PRODUCTS: bool>(
    simd: S,
    nodes: &[Node],
    lanes: &LaneRay<'_, S>,
    visitor: &mut V,
) {
    let mut places = Places::<STACK>::new();
    // When any hit ends the walk, t_max stays and there is no distance to compare with it.
    if V::ANY {
        let stack = Stack::<_, false>::new(&mut places);
        step_by_step::<S, V, PRODUCTS, false>(simd, nodes, lanes, visitor, stack);
    } else {
        let stack = Stack::<_, true>::new(&mut places);
        step_by_step::<S, V, PRODUCTS, true>(simd, nodes, lanes, visitor, stack);
    }
}

#[inline(always)]
fn step_by_step<S: Simd, V: Visitor, const PRODUCTS: bool, const DISTANCES: bool>(
    simd: S,
    nodes: &[Node],
    lanes: &LaneRay<'_, S>,
    visitor: &mut V,
    mut stack: Stack<'_, STACK, DISTANCES>,
) {
    let ray = lanes.prepared;
    // Any order will do for any hit, and a table that is always the same stays in the cache.
    let orders = &ORDERS[if V::ANY { 0 } else { octant(ray) }];
    let mut t_max = ray.t_max;
    let mut current = Child::node(0);
    loop {
        if current.is_leaf() {
            if visitor.leaf(simd, lanes, current, &mut t_max) {
                return;
            }
        } else {
            visitor.node();
            let node = &nodes[current.node_index()];
            let (enter, mask) = meet::<S, PRODUCTS>(simd, lanes, node, t_max);
            if mask != 0 {
                let next = if V::ANY { any_slot(node, mask) } else { orders[mask as usize % 256].nearest() };
                // The others wait, the nearest of them last.
                let others = mask & !(1 << next);
                let (entries, children) = orders[others as usize % 256].arrange(simd, enter, &node.children);
                stack.push(entries, children, others.count_ones() as usize);
                if V::IS_LARGE && others != 0 {
                    prefetch_child(nodes, visitor, Child(children[others.count_ones() as usize % WIDTH - 1]));
                }
                current = Child(node.children[next]);
                continue;
            }
        }
        match stack.pop(t_max) {
            Some(child) => current = Child(child),
            None => return,
        }
    }
}

/// Asks for the child that is next of those that wait, so that its memory is on its way meanwhile.
#[inline(always)]
fn prefetch_child<V: Visitor>(nodes: &[Node], visitor: &V, child: Child) {
    if child.is_leaf() {
        visitor.prefetch(child);
    } else {
        prefetch(nodes, child.node_index());
    }
}

/// The slot to look into first when any hit will do: a wall, else any leaf, which may end the walk, before a
/// node.
#[inline(always)]
fn any_slot(node: &Node, mask: u32) -> usize {
    let (walls, leaves) = (mask & u32::from(node.walls), mask & u32::from(node.leaves));
    let likely = if leaves != 0 { leaves } else { mask };
    if walls != 0 { walls } else { likely }.trailing_zeros() as usize % WIDTH
}
