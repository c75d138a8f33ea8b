//! Boxes around cells, eight at a time.

use fearless_simd::{Simd, f32x8, prelude::*};
use senca_math::glam::Vec3;
use smallvec::SmallVec;

use super::divide::{BinaryNode, BinaryTree, NodeKind};

/// Boxes of one node.
const WIDTH: usize = 8;

/// Eight boxes; those that are not used cannot be met.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
struct WideNode {
    /// Per axis the low and the high sides.
    sides: [[[f32; WIDTH]; 2]; 3],
    children: [Link; WIDTH],
}

/// A node, or a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link(u32);

impl Link {
    const CELL: u32 = 1 << 31;

    /// Leads nowhere.
    pub(super) const NONE: Self = Self(u32::MAX);

    pub(super) fn cell(index: u32) -> Self {
        Self(index | Self::CELL)
    }

    fn as_cell(self) -> Option<u32> {
        (self.0 & Self::CELL != 0).then_some(self.0 & !Self::CELL)
    }
}

/// Boxes in boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<WideNode>,
}

/// A ray in single precision within the unit ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct SingleRay {
    pub origin: Vec3,
    /// Of length 1.
    pub direction: Vec3,
    /// Distances between which it counts, with room for rounding.
    pub low: f32,
    pub high: f32,
}

/// What to do with the cells whose boxes a ray meets, nearest box first.
pub(super) trait Visitor<S: Simd> {
    /// Looks at a cell.
    fn cell(&mut self, simd: S, cell: u32);

    /// How far along the ray boxes are still of interest; negative infinity ends the search.
    fn limit(&self) -> f32;
}

impl Hierarchy {
    /// Bytes taken.
    pub(super) fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Takes over a binary tree; `leaf` tells where its leaves lead. The result leads to the root.
    pub(super) fn add(&mut self, tree: &BinaryTree, leaf: &dyn Fn(u32) -> Link) -> Link {
        match tree.nodes.first().map(|root| root.kind) {
            None => Link::NONE,
            Some(NodeKind::Leaf(number)) => leaf(number),
            Some(NodeKind::Inner(_)) => self.add_node(tree, leaf),
        }
    }

    /// Wide nodes for an inner root, breadth first.
    fn add_node(&mut self, tree: &BinaryTree, leaf: &dyn Fn(u32) -> Link) -> Link {
        let first = self.nodes.len();
        let mut roots = vec![0];
        let mut done = 0;
        while done < roots.len() {
            let children = gathered(tree, roots[done]);
            done += 1;
            let mut node = WideNode {
                sides: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
                children: [Link::NONE; WIDTH],
            };
            for (slot, &child) in children.iter().enumerate() {
                let BinaryNode { low, high, kind } = &tree.nodes[child as usize];
                for axis in 0..3 {
                    node.sides[axis][0][slot] = low[axis];
                    node.sides[axis][1][slot] = high[axis];
                }
                node.children[slot] = match kind {
                    NodeKind::Leaf(number) => leaf(*number),
                    NodeKind::Inner(_) => {
                        roots.push(child);
                        Link((first + roots.len() - 1) as u32)
                    }
                };
            }
            self.nodes.push(node);
        }
        Link(first as u32)
    }

    /// Visits all cells below `root` whose boxes the ray meets; returns how many nodes were looked at.
    #[inline(always)]
    pub(super) fn visit<S: Simd>(
        &self,
        simd: S,
        root: Link,
        ray: &SingleRay,
        visitor: &mut impl Visitor<S>,
    ) -> u64 {
        let slabs = Slabs::new(simd, ray);
        let mut stack: SmallVec<[(Link, f32); 64]> = SmallVec::new();
        if root != Link::NONE {
            stack.push((root, f32::NEG_INFINITY));
        }
        let mut visited = 0;
        while let Some((link, near)) = stack.pop() {
            let limit = visitor.limit();
            if near > limit {
                continue;
            }
            if let Some(cell) = link.as_cell() {
                visitor.cell(simd, cell);
                continue;
            }
            visited += 1;
            let node = &self.nodes[link.0 as usize];
            let (mut met, nears) = slabs.meet(node, limit);
            let bottom = stack.len();
            while met != 0 {
                let slot = met.trailing_zeros() as usize;
                met &= met - 1;
                push_sorted(&mut stack, bottom, (node.children[slot], nears[slot]));
            }
        }
        visited
    }
}

/// Keeps the entries from `bottom` on in descending order of distance.
#[inline(always)]
fn push_sorted(stack: &mut SmallVec<[(Link, f32); 64]>, bottom: usize, entry: (Link, f32)) {
    let mut i = stack.len();
    stack.push(entry);
    while i > bottom && stack[i - 1].1 < entry.1 {
        stack[i] = stack[i - 1];
        i -= 1;
    }
    stack[i] = entry;
}

/// Up to eight nodes below `root`, the largest opened first.
fn gathered(tree: &BinaryTree, root: u32) -> SmallVec<[u32; WIDTH]> {
    let mut nodes: SmallVec<[u32; WIDTH]> = SmallVec::from_slice(&[root]);
    while nodes.len() < WIDTH {
        let inner = |&i: &usize| matches!(tree.nodes[nodes[i] as usize].kind, NodeKind::Inner(_));
        let area = |i: usize| tree.nodes[nodes[i] as usize].area();
        let Some(largest) =
            (0..nodes.len()).filter(inner).max_by(|&a, &b| area(a).total_cmp(&area(b)).then(b.cmp(&a)))
        else {
            break;
        };
        let NodeKind::Inner([a, b]) = tree.nodes[nodes[largest] as usize].kind else { break };
        nodes[largest] = a;
        nodes.push(b);
    }
    nodes
}

#[inline(always)]
fn splats<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}

/// A ray made ready for boxes.
struct Slabs<S: Simd> {
    origin: [f32x8<S>; 3],
    inverse: [f32x8<S>; 3],
    /// Index of the side that is met first, per axis.
    first: [usize; 3],
    low: f32x8<S>,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, ray: &SingleRay) -> Self {
        // Directions along a side get a tiny slope, so that nothing is infinite times zero.
        let slope = ray.direction.to_array().map(|d| if d.abs() < 1e-18 { 1e-18f32.copysign(d) } else { d });
        Self {
            origin: splats(simd, ray.origin.to_array()),
            inverse: splats(simd, slope.map(|d| 1.0 / d)),
            first: slope.map(|d| usize::from(d < 0.0)),
            low: f32x8::splat(simd, ray.low),
        }
    }

    /// Which boxes are met before `limit`, one bit each, and where.
    ///
    /// Products may round by 2e-7 of coordinates up to 2; the boxes are larger by more than that.
    #[inline(always)]
    fn meet(&self, node: &WideNode, limit: f32) -> (u64, [f32; WIDTH]) {
        let simd = self.low.token();
        let mut near = self.low;
        let mut far = f32x8::splat(simd, limit);
        for axis in 0..3 {
            let first = self.first[axis];
            let front = f32x8::simd_from(simd, node.sides[axis][first & 1]);
            let back = f32x8::simd_from(simd, node.sides[axis][first & 1 ^ 1]);
            near = near.max((front - self.origin[axis]) * self.inverse[axis]);
            far = far.min((back - self.origin[axis]) * self.inverse[axis]);
        }
        (near.simd_le(far).to_bitmask(), near.into())
    }
}
