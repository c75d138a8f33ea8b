//! The inner node of a hierarchy.

use crate::Aabb32;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;

/// Boxes of up to eight children, side by side, and where the children are.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Row `2 axis` is the smallest, row `2 axis + 1` the largest coordinate. Slots without a child hold
    /// boxes that no ray meets.
    pub(crate) bounds: [[f32; WIDTH]; 6],
    /// [`Child`]s.
    pub(crate) children: [u32; WIDTH],
    /// A bit per slot with a leaf.
    pub(crate) leaves: u8,
    /// A bit per slot with a leaf that few rays get through.
    pub(crate) walls: u8,
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [0; WIDTH],
        leaves: 0,
        walls: 0,
    };

    pub(crate) fn set(&mut self, slot: usize, bounds: &Aabb32, child: Child) {
        for axis in 0..3 {
            self.bounds[2 * axis][slot] = bounds.min[axis];
            self.bounds[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child.0;
        self.leaves |= u8::from(child.is_leaf()) << slot;
    }
}

impl Node {
    /// A bit per slot with a leaf of which `is` holds.
    pub(crate) fn leaf_slots(&self, is: impl Fn(Child) -> bool) -> u8 {
        let holds = |slot: usize| self.leaves >> slot & 1 == 1 && is(Child(self.children[slot]));
        (0..WIDTH).fold(0, |slots, slot| slots | u8::from(holds(slot)) << slot)
    }

    /// Makes boxes that end at `end` or beyond endless there.
    pub(crate) fn open(&mut self, end: f32) {
        for (row, bounds) in self.bounds.iter_mut().enumerate() {
            for bound in bounds {
                if row % 2 == 0 && *bound <= -end {
                    *bound = f32::NEG_INFINITY;
                } else if row % 2 == 1 && *bound >= end {
                    *bound = f32::INFINITY;
                }
            }
        }
    }
}

/// A reference to a node or a leaf. A leaf is a block of up to eight items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(pub(crate) u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Leaves that references can tell apart.
    pub(crate) const MAX_LEAVES: usize = 1 << 28;

    pub(crate) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// `count` is from 1 to 8.
    pub(crate) fn leaf(index: usize, count: usize) -> Self {
        Self(Self::LEAF | (index as u32) << 3 | (count as u32 - 1))
    }

    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub(crate) fn node_index(self) -> usize {
        self.0 as usize
    }

    #[inline(always)]
    pub(crate) fn leaf_index(self) -> usize {
        ((self.0 & !Self::LEAF) >> 3) as usize
    }

    #[inline(always)]
    pub(crate) fn leaf_count(self) -> u32 {
        (self.0 & 7) + 1
    }

    /// The same child after `nodes` nodes and `leaves` leaves were put before those it counts.
    pub(crate) fn shifted(self, nodes: usize, leaves: usize) -> Self {
        if self.is_leaf() { Self(self.0 + ((leaves as u32) << 3)) } else { Self(self.0 + nodes as u32) }
    }
}
