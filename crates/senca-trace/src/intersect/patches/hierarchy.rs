//! Boxes around cells, eight at a time.

use fearless_simd::{Simd, f32x8, i64x8, prelude::*};
use senca_math::glam::Vec3;
use smallvec::SmallVec;

use super::divide::{BinaryNode, BinaryTree, NodeKind};
use crate::lanes::{M, bits_of, channels};

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

impl WideNode {
    #[inline(always)]
    fn sides_of(&self, slot: usize) -> [[f32; 2]; 3] {
        channels!(axis => [self.sides[axis][0][slot], self.sides[axis][1][slot]])
    }
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

/// Bounds on a bundle of rays: every box that one of them meets is met by the beam, by the same products
/// and differences, which round the same way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// Least and greatest coordinate of the origins.
    pub origin: [[f32; 3]; 2],
    /// Of the inverse directions.
    pub inverse: [[f32; 3]; 2],
    /// Of the directions.
    pub direction: [[f32; 3]; 2],
    /// Least and greatest distance along the rays.
    pub near: f32,
    pub far: f32,
}

/// Rays that go through the boxes together, and what to do with the cells whose boxes they meet.
pub(super) trait Bundle<S: Simd> {
    /// Whether the nearest box is to come first.
    const SORTED: bool;

    /// Bounds on all of them.
    fn beam(&self, simd: S) -> Beam;

    /// Which of the rays in `among` meet a box.
    fn meet_box(&self, simd: S, among: u64, sides: &[[f32; 2]; 3]) -> u64;

    /// One of them: origin, inverse direction, first and last distance.
    fn one(&self, ray: usize) -> ([f32; 3], [f32; 3], [f32; 2]);

    /// Those that are still of interest.
    fn open(&self) -> u64;

    /// How far along these boxes are of interest.
    fn limit(&self) -> f32;

    /// Looks at a cell that some of the rays may meet.
    fn cell(&mut self, simd: S, cell: u32, rays: u64, sides: &[[f32; 2]; 3]);
}

/// Up to so many rays ask eight boxes each, more ask box after box.
const FEW: u32 = 6;

/// What some rays still have to look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errand {
    link: Link,
    /// Not after the place where one of them meets the box first.
    near: f32,
    rays: u64,
    /// Where the box is: node and slot.
    node: u32,
    slot: u32,
}

impl Hierarchy {
    /// Looks at the cells below `root` whose boxes some of the rays meet. Returns how many nodes were looked at.
    ///
    /// Of a node that many rays are at, bounds on all rays leave out most boxes, and sixteen rays at a time
    /// are asked about the others. So rays that go all ways are soon on their own, where each asks for
    /// itself. `stack` is room that is kept from one walk to the next.
    #[inline(always)]
    pub(super) fn walk<S: Simd, B: Bundle<S>>(
        &self,
        simd: S,
        root: Link,
        bundle: &mut B,
        stack: &mut Vec<Errand>,
    ) -> u64 {
        stack.clear();
        if let Some(cell) = root.as_cell().filter(|_| root != Link::NONE) {
            let sides = [[f32::NEG_INFINITY, f32::INFINITY]; 3];
            bundle.cell(simd, cell, bundle.open(), &sides);
        } else if root != Link::NONE {
            let near = f32::NEG_INFINITY;
            stack.push(Errand { link: root, near, rays: bundle.open(), node: 0, slot: 0 });
        }
        let slabs = BeamSlabs::new(simd, &bundle.beam(simd));
        let mut visited = 0;
        while let Some(errand) = stack.pop() {
            let rays = errand.rays & bundle.open();
            if rays == 0 || errand.near > bundle.limit() {
                continue;
            }
            if let Some(cell) = errand.link.as_cell() {
                let sides = self.nodes[errand.node as usize].sides_of(errand.slot as usize % WIDTH);
                bundle.cell(simd, cell, rays, &sides);
                continue;
            }
            visited += 1;
            let bottom = stack.len();
            let number = errand.link.0;
            let node = &self.nodes[number as usize];
            let mut go_on = |slot: usize, rays: u64, near: f32| {
                let errand =
                    Errand { link: node.children[slot], near, rays, node: number, slot: slot as u32 };
                push_errand(stack, if B::SORTED { bottom } else { usize::MAX }, errand);
            };
            if rays.count_ones() <= FEW {
                let (met, of_boxes, nears) = few_at(simd, node, rays, bundle);
                for slot in bits_of(met) {
                    let slot = slot % WIDTH;
                    go_on(slot, of_boxes[slot], nears[slot]);
                }
                continue;
            }
            let (met, nears) = slabs.meet(node, bundle.limit());
            for slot in bits_of(met) {
                let slot = slot % WIDTH;
                let rays = bundle.meet_box(simd, rays, &node.sides_of(slot));
                if rays != 0 {
                    go_on(slot, rays, nears[slot]);
                }
            }
        }
        visited
    }
}

/// Keeps the entries from `bottom` on in descending order of distance.
#[inline(always)]
fn push_errand(stack: &mut Vec<Errand>, bottom: usize, errand: Errand) {
    let mut i = stack.len();
    stack.push(errand);
    while i > bottom && stack[i - 1].near < errand.near {
        stack[i] = stack[i - 1];
        i -= 1;
    }
    stack[i] = errand;
}

/// Which boxes of a node are met, by which rays, and where the first of them does.
#[inline(always)]
fn few_at<S: Simd>(
    simd: S,
    node: &WideNode,
    rays: u64,
    bundle: &impl Bundle<S>,
) -> (u64, [u64; WIDTH], [f32; WIDTH]) {
    let (mut any, mut of_boxes) = (0, i64x8::splat(simd, 0));
    let mut first = f32x8::splat(simd, f32::INFINITY);
    for ray in bits_of(rays) {
        let (origin, inverse, [low, high]) = bundle.one(ray);
        let (mut near, mut far) = (f32x8::splat(simd, low), f32x8::splat(simd, high));
        for axis in 0..3 {
            // By the direction, so that boxes that are not used are beyond all distances.
            let first = usize::from(inverse[axis] < 0.0);
            let front = f32x8::simd_from(simd, node.sides[axis][first]);
            let back = f32x8::simd_from(simd, node.sides[axis][1 - first]);
            let (origin, inverse) = (f32x8::splat(simd, origin[axis]), f32x8::splat(simd, inverse[axis]));
            near = near.max((front - origin) * inverse);
            far = far.min((back - origin) * inverse);
        }
        let met = near.simd_le(far);
        first = met.select(first.min(near), first);
        let met = met.to_bitmask();
        let own = of_boxes | i64x8::splat(simd, 1 << ray);
        of_boxes = M::from_bitmask(simd, met).select(own, of_boxes);
        any |= met;
    }
    (any, of_boxes.to_array().map(i64::cast_unsigned), first.into())
}

/// A beam made ready for boxes.
struct BeamSlabs<S: Simd> {
    axes: [BeamAxis<S>; 3],
    near: f32x8<S>,
    far: f32x8<S>,
}

/// What a beam does along one axis.
struct BeamAxis<S: Simd> {
    /// Index of the side that all rays meet first; 2 where some go up and some down.
    first: usize,
    /// The origin that makes the first side nearest, and the one that makes the second farthest; the least
    /// and greatest coordinate where rays go both ways.
    origin: [f32x8<S>; 2],
    inverse: [f32x8<S>; 2],
}

impl<S: Simd> BeamAxis<S> {
    #[inline(always)]
    fn new(simd: S, beam: &Beam, axis: usize) -> Self {
        let [least, greatest] = [beam.origin[0][axis], beam.origin[1][axis]];
        let [slow, fast] = [beam.inverse[0][axis], beam.inverse[1][axis]];
        let inverse = [f32x8::splat(simd, slow), f32x8::splat(simd, fast)];
        let (first, origin) = if slow > 0.0 {
            (0, [greatest, least])
        } else if fast < 0.0 {
            (1, [least, greatest])
        } else {
            // Where the rays get between their ends, a little more.
            let way = 1.0001 * beam.near.abs().max(beam.far.abs());
            let speed = beam.direction[0][axis].abs().max(beam.direction[1][axis].abs());
            (2, [least - way * speed, greatest + way * speed])
        };
        Self { first, origin: [f32x8::splat(simd, origin[0]), f32x8::splat(simd, origin[1])], inverse }
    }
}

impl<S: Simd> BeamSlabs<S> {
    #[inline(always)]
    fn new(simd: S, beam: &Beam) -> Self {
        Self {
            axes: channels!(axis => BeamAxis::new(simd, beam, axis)),
            near: f32x8::splat(simd, beam.near),
            far: f32x8::splat(simd, beam.far),
        }
    }

    /// Which boxes may be met by one of the rays, one bit each, and where at the earliest.
    #[inline(always)]
    fn meet(&self, node: &WideNode, limit: f32) -> (u64, [f32; WIDTH]) {
        let simd = self.near.token();
        let (mut near, mut far) = (self.near, self.far.min(f32x8::splat(simd, limit)));
        let mut crossed = 0xff;
        for (axis, sides) in self.axes.iter().zip(&node.sides) {
            let [low, high] = [f32x8::simd_from(simd, sides[0]), f32x8::simd_from(simd, sides[1])];
            if axis.first == 2 {
                crossed &= (low.simd_le(axis.origin[1]) & high.simd_ge(axis.origin[0])).to_bitmask();
                continue;
            }
            let (front, back) = if axis.first == 0 { (low, high) } else { (high, low) };
            let (front, back) = (front - axis.origin[0], back - axis.origin[1]);
            near = near.max((front * axis.inverse[0]).min(front * axis.inverse[1]));
            far = far.min((back * axis.inverse[0]).max(back * axis.inverse[1]));
        }
        (near.simd_le(far).to_bitmask() & crossed, near.into())
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
