//! The walk of one ray through the nodes.

use fearless_simd::{Simd, f32x8, prelude::*};

use crate::node::{Child, Node};
use crate::prepared::PreparedRay;

/// Levels of nodes a hierarchy may have; see the build.
pub(crate) const MAX_DEPTH: usize = 64;

/// Each level leaves at most seven siblings behind.
const STACK: usize = 7 * MAX_DEPTH + 8;

/// What is done at the leaves.
pub(crate) trait Visitor {
    /// Tests the items of a leaf; may lower `t_max`. True ends the walk.
    fn leaf<S: Simd>(&mut self, simd: S, ray: &LaneRay<S>, leaf: Child, t_max: &mut f32) -> bool;

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
    /// Row of a node's bounds with the planes the ray meets first.
    near: [usize; 3],
}

impl<'a, S: Simd> LaneRay<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &'a PreparedRay) -> Self {
        let splat = |values: [f32; 3]| values.map(|value| f32x8::splat(simd, value));
        Self {
            prepared: ray,
            origin: splat(ray.origin),
            near_reciprocal: splat(ray.near_reciprocal),
            far_reciprocal: splat(ray.far_reciprocal),
            t_min: f32x8::splat(simd, ray.t_min),
            near: [0, 1, 2].map(|axis| 2 * axis + usize::from(ray.downward[axis])),
        }
    }
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

/// Where the ray enters the children, and which of them it meets between its limits.
#[inline(always)]
fn meet<S: Simd>(simd: S, ray: &LaneRay<S>, node: &Node, t_max: f32) -> (f32x8<S>, u32) {
    let mut enter = ray.t_min;
    let mut leave = f32x8::splat(simd, t_max);
    for axis in 0..3 {
        let near = f32x8::load_array_ref(simd, &node.bounds[ray.near[axis]]);
        let far = f32x8::load_array_ref(simd, &node.bounds[ray.near[axis] ^ 1]);
        enter = max_or((near - ray.origin[axis]) * ray.near_reciprocal[axis], enter);
        leave = min_or((far - ray.origin[axis]) * ray.far_reciprocal[axis], leave);
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
    let lanes = LaneRay::new(simd, ray);
    let mut t_max = ray.t_max;
    let mut stack = [(0f32, Child(0)); STACK];
    let mut top = 0;
    let mut current = Child::node(0);
    loop {
        if current.is_leaf() {
            if visitor.leaf(simd, &lanes, current, &mut t_max) {
                return;
            }
        } else {
            visitor.node();
            let node = &nodes[current.node_index()];
            let (enter, mut mask) = meet(simd, &lanes, node, t_max);
            let first = top;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let entry = (enter[lane], node.children[lane]);
                let mut place = top;
                while place > first && stack[place - 1].0 < entry.0 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
                top += 1;
            }
        }
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            if stack[top].0 <= t_max {
                current = stack[top].1;
                break;
            }
        }
    }
}
