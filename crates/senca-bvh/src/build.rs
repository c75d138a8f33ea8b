//! Building the nodes: top down, by the binned surface area heuristic.
//!
//! Ingo Wald: On fast Construction of SAH-based Bounding Volume Hierarchies, 2007. A node's eight children
//! come from splitting, again and again, the child with the largest surface. All sums and choices are the
//! same for any number of threads.

mod bins;
mod item;
mod split;

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use crate::memory::list_in_large_pages;
use crate::node::{Child, Node, WIDTH};
use crate::traverse::MAX_DEPTH;
pub(crate) use item::{Extent, Item};
use split::{Children, Set, Splitting, children_of};

/// From this level of nodes on, sets are cut in the middle, which ends within a few levels.
const BALANCED_DEPTH: usize = MAX_DEPTH - 20;

/// Sets with fewer items are built by one thread.
const PARALLEL: usize = 4096;

/// Nodes over an order of items.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    /// The root is the first, if there are any.
    pub(crate) nodes: Vec<Node>,
    /// First item and number of items of each leaf.
    pub(crate) leaves: Vec<(u32, u32)>,
    /// Indices of the caller, leaf by leaf.
    pub(crate) items: Vec<u32>,
    pub(crate) extent: Extent,
}

/// Part of a tree; indices count from its own beginning.
#[derive(Debug, Default)]
struct Arena {
    nodes: Vec<Node>,
    leaves: Vec<(u32, u32)>,
}

/// Leaves hold from 1 to `max_leaf` items.
pub(crate) fn build(mut items: Vec<Item>, max_leaf: usize, level: Level) -> Tree {
    if items.is_empty() {
        return Tree::default();
    }
    let builder = Builder { max_leaf, level };
    let mut scratch = list_in_large_pages(items.len());
    scratch.par_extend(items.par_iter().with_min_len(1 << 12));
    let set = dispatch!(level, simd => Set::of(simd, &items, 0));
    let arena = builder.grow_parallel(&mut items, &mut scratch, set, 0);
    drop(scratch);
    let items = items.par_iter().map(Item::index).collect();
    Tree { nodes: arena.nodes, leaves: arena.leaves, items, extent: set.extent }
}

struct Builder {
    max_leaf: usize,
    level: Level,
}

impl Builder {
    /// The subtree over `items`, which are those of `set`; its root is node 0.
    fn grow_parallel(&self, items: &mut [Item], scratch: &mut [Item], set: Set, depth: usize) -> Arena {
        let mut arena = Arena::default();
        if set.len() < PARALLEL {
            let nodes = set.len() / (2 * self.max_leaf);
            arena.nodes.reserve(nodes);
            self.grow(&mut arena, items, set, depth);
            return arena;
        }
        let children = self.children_of(items, scratch, set, depth);
        let (mut items, mut scratch) = (items, scratch);
        let mut parts = Vec::with_capacity(WIDTH);
        for &child in children.as_slice() {
            let (part, rest) = items.split_at_mut(child.len());
            let (part_scratch, rest_scratch) = scratch.split_at_mut(child.len());
            (items, scratch) = (rest, rest_scratch);
            parts.push((part, part_scratch, child));
        }
        let arenas: Vec<Option<Arena>> = parts
            .into_par_iter()
            .map(|(part, scratch, child)| {
                (child.len() > self.max_leaf).then(|| self.grow_parallel(part, scratch, child, depth + 1))
            })
            .collect();
        arena.nodes.push(Node::EMPTY);
        let slots = slots(&set, children.as_slice());
        for ((slot, child), part) in slots.into_iter().zip(children.as_slice()).zip(arenas) {
            let reference = match part {
                Some(part) => arena.append(part),
                None => arena.leaf(child),
            };
            arena.nodes[0].set(slot, &child.extent.as_box(), reference);
        }
        arena
    }

    /// Appends the subtree over `set`, whose items are `items`.
    fn grow(&self, arena: &mut Arena, items: &mut [Item], set: Set, depth: usize) -> Child {
        let index = arena.nodes.len();
        arena.nodes.push(Node::EMPTY);
        let children = self.children_of(items, &mut [], set, depth);
        for (slot, child) in slots(&set, children.as_slice()).into_iter().zip(children.as_slice()) {
            let reference = if child.len() <= self.max_leaf {
                arena.leaf(child)
            } else {
                let part = &mut items[child.start - set.start..child.end - set.start];
                self.grow(arena, part, *child, depth + 1)
            };
            arena.nodes[index].set(slot, &child.extent.as_box(), reference);
        }
        Child::node(index)
    }

    fn children_of(&self, items: &mut [Item], scratch: &mut [Item], set: Set, depth: usize) -> Children {
        let how = Splitting { max_leaf: self.max_leaf, balanced: depth >= BALANCED_DEPTH };
        dispatch!(self.level, simd => children_of(simd, items, scratch, set, how))
    }
}

impl Arena {
    fn leaf(&mut self, set: &Set) -> Child {
        self.leaves.push((set.start as u32, set.len() as u32));
        Child::leaf(self.leaves.len() - 1, set.len())
    }

    fn append(&mut self, mut other: Self) -> Child {
        let (nodes, leaves) = (self.nodes.len(), self.leaves.len());
        for node in &mut other.nodes {
            for child in &mut node.children {
                *child = Child(*child).shifted(nodes, leaves).0;
            }
        }
        self.nodes.append(&mut other.nodes);
        self.leaves.append(&mut other.leaves);
        Child::node(nodes)
    }
}

/// A slot for each child, so that bit by bit it says on which side of the middle of `set` the child is; see
/// [`crate::order`]. The child farthest towards a corner chooses first.
fn slots(set: &Set, children: &[Set]) -> [usize; WIDTH] {
    let mut scores = [[f32::NEG_INFINITY; WIDTH]; WIDTH];
    for (child, scores) in children.iter().zip(&mut scores) {
        let [x, y, z] = [0, 1, 2].map(|axis| child.extent.center2(axis) - set.extent.center2(axis));
        for (slot, score) in scores.iter_mut().enumerate() {
            let along = |d: f32, axis: usize| if slot >> axis & 1 == 1 { d } else { -d };
            *score = along(x, 0) + along(y, 1) + along(z, 2);
        }
    }
    let mut slots = [0; WIDTH];
    let (mut children_left, mut slots_left) = ((1u32 << children.len()) - 1, (1u32 << WIDTH) - 1);
    while children_left != 0 {
        let mut best = (children_left.trailing_zeros(), slots_left.trailing_zeros());
        let mut best_score = f32::NEG_INFINITY;
        for child in (0..WIDTH as u32).filter(|child| children_left >> child & 1 == 1) {
            for slot in (0..WIDTH as u32).filter(|slot| slots_left >> slot & 1 == 1) {
                let score = scores[child as usize][slot as usize];
                if score > best_score {
                    (best, best_score) = ((child, slot), score);
                }
            }
        }
        slots[best.0 as usize] = best.1 as usize;
        children_left &= !(1 << best.0);
        slots_left &= !(1 << best.1);
    }
    slots
}
