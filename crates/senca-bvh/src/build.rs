//! Building the nodes: top down, by the binned surface area heuristic.
//!
//! Ingo Wald: On fast Construction of SAH-based Bounding Volume Hierarchies, 2007. A node's eight children
//! come from splitting, again and again, the child with the largest surface. All sums and choices are the
//! same for any number of threads.

mod bins;
mod item;

use rayon::prelude::*;

use crate::node::{Child, Node, WIDTH};
use crate::traverse::MAX_DEPTH;
pub(crate) use item::{Extent, Item};

/// From this level of nodes on, sets are cut in the middle, which ends within a few levels.
const BALANCED_DEPTH: usize = MAX_DEPTH - 24;

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
    /// Levels of nodes.
    pub(crate) depth: usize,
}

/// Items from `start` to `end` with the box of them and the box of their centres.
#[derive(Clone, Copy, Debug)]
struct Set {
    start: usize,
    end: usize,
    extent: Extent,
    centers: Extent,
}

impl Set {
    fn len(&self) -> usize {
        self.end - self.start
    }
}

/// Part of a tree; indices count from its own beginning.
#[derive(Debug, Default)]
struct Arena {
    nodes: Vec<Node>,
    leaves: Vec<(u32, u32)>,
    /// Levels of nodes, counted from the root of the whole tree.
    depth: usize,
}

/// Leaves hold from 1 to `max_leaf` items.
pub(crate) fn build(mut items: Vec<Item>, max_leaf: usize) -> Tree {
    let (extent, centers) = items
        .par_chunks(1 << 14)
        .map(|chunk| {
            chunk.iter().fold((Extent::EMPTY, Extent::EMPTY), |(extent, centers), item| {
                (extent.union(item.extent), centers.union(item.center()))
            })
        })
        .reduce(|| (Extent::EMPTY, Extent::EMPTY), |a, b| (a.0.union(b.0), a.1.union(b.1)));
    if items.is_empty() {
        return Tree::default();
    }
    let set = Set { start: 0, end: items.len(), extent, centers };
    let arena = grow_parallel(&mut items, set, max_leaf, 0);
    let items = items.par_iter().map(Item::index).collect();
    Tree { nodes: arena.nodes, leaves: arena.leaves, items, extent, depth: arena.depth }
}

/// The subtree over `items`, which are those of `set`; its root is node 0.
fn grow_parallel(items: &mut [Item], set: Set, max_leaf: usize, depth: usize) -> Arena {
    let mut arena = Arena::default();
    if set.len() < PARALLEL {
        grow(&mut arena, items, set.start, set, max_leaf, depth);
        return arena;
    }
    let children = children_of(items, set.start, set, max_leaf, depth);
    let mut rest = items;
    let mut parts = Vec::with_capacity(WIDTH);
    for &child in &children {
        let (part, after) = rest.split_at_mut(child.len());
        parts.push((part, child));
        rest = after;
    }
    let arenas: Vec<Option<Arena>> = parts
        .into_par_iter()
        .map(|(part, child)| {
            (child.len() > max_leaf).then(|| grow_parallel(part, child, max_leaf, depth + 1))
        })
        .collect();
    arena.nodes.push(Node::EMPTY);
    arena.depth = depth + 1;
    let slots = slots(&set, &children);
    for ((slot, child), part) in slots.into_iter().zip(&children).zip(arenas) {
        let reference = match part {
            Some(part) => arena.append(part),
            None => arena.leaf(*child),
        };
        arena.nodes[0].set(slot, &child.extent.as_box(), reference);
    }
    arena
}

/// Appends the subtree over `set`, whose first item is `items[set.start - offset]`.
fn grow(
    arena: &mut Arena,
    items: &mut [Item],
    offset: usize,
    set: Set,
    max_leaf: usize,
    depth: usize,
) -> Child {
    let index = arena.nodes.len();
    arena.nodes.push(Node::EMPTY);
    arena.depth = arena.depth.max(depth + 1);
    let children = children_of(items, offset, set, max_leaf, depth);
    for (slot, child) in slots(&set, &children).into_iter().zip(children) {
        let reference = if child.len() <= max_leaf {
            arena.leaf(child)
        } else {
            grow(arena, items, offset, child, max_leaf, depth + 1)
        };
        arena.nodes[index].set(slot, &child.extent.as_box(), reference);
    }
    Child::node(index)
}

impl Arena {
    fn leaf(&mut self, set: Set) -> Child {
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
        self.depth = self.depth.max(other.depth);
        Child::node(nodes)
    }
}

/// Up to eight sets, in the order of their items.
fn children_of(items: &mut [Item], offset: usize, set: Set, max_leaf: usize, depth: usize) -> Vec<Set> {
    let mut children = Vec::with_capacity(WIDTH);
    children.push(set);
    let balanced = depth >= BALANCED_DEPTH;
    while children.len() < WIDTH {
        let largest = (0..children.len())
            .filter(|&i| children[i].len() > max_leaf)
            .max_by(|&a, &b| size(&children[a], balanced).total_cmp(&size(&children[b], balanced)));
        let Some(largest) = largest else { break };
        let set = children.remove(largest);
        let part = &mut items[set.start - offset..set.end - offset];
        let (left, right) = if balanced { halves(part, &set) } else { split(part, &set) };
        children.insert(largest, right);
        children.insert(largest, left);
    }
    children
}

/// A slot for each child, so that bit by bit it says on which side of the middle of `set` the child is; see
/// [`crate::order`]. The child farthest towards a corner chooses first.
fn slots(set: &Set, children: &[Set]) -> [usize; WIDTH] {
    let middle = set.extent.center2();
    let mut scores = [[f32::NEG_INFINITY; WIDTH]; WIDTH];
    for (child, scores) in children.iter().zip(&mut scores) {
        let center = child.extent.center2();
        let [x, y, z] = [0, 1, 2].map(|axis| center[axis] - middle[axis]);
        for (slot, score) in scores.iter_mut().enumerate() {
            let along = |d: f32, axis: usize| if slot >> axis & 1 == 1 { d } else { -d };
            *score = along(x, 0) + along(y, 1) + along(z, 2);
        }
    }
    let mut slots = [0; WIDTH];
    let (mut children_left, mut slots_left) = ((1u32 << children.len()) - 1, (1u32 << WIDTH) - 1);
    while children_left != 0 {
        let (mut best, mut best_score) =
            ((children_left.trailing_zeros(), slots_left.trailing_zeros()), f32::NEG_INFINITY);
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

fn size(set: &Set, balanced: bool) -> f32 {
    if balanced { set.len() as f32 } else { set.extent.half_area() }
}

/// Splits where the heuristic says, or in the middle when it cannot tell.
fn split(items: &mut [Item], set: &Set) -> (Set, Set) {
    let Some(plane) = bins::best_plane(items, &set.centers) else { return halves(items, set) };
    // Items left of the plane to the front, the others to the back.
    let (mut left, mut right) = (Side::EMPTY, Side::EMPTY);
    let (mut front, mut back) = (0, items.len());
    while front < back {
        if plane.is_left(&items[front]) {
            left.add(&items[front]);
            front += 1;
        } else {
            back -= 1;
            right.add(&items[front]);
            items.swap(front, back);
        }
    }
    if front == 0 || front == items.len() {
        return halves(items, set);
    }
    (left.set(set.start, set.start + front), right.set(set.start + front, set.end))
}

/// Splits by the order of the items alone.
fn halves(items: &[Item], set: &Set) -> (Set, Set) {
    let middle = items.len() / 2;
    let side = |items: &[Item]| {
        let mut side = Side::EMPTY;
        items.iter().for_each(|item| side.add(item));
        side
    };
    let (left, right) = (side(&items[..middle]), side(&items[middle..]));
    (left.set(set.start, set.start + middle), right.set(set.start + middle, set.end))
}

#[derive(Clone, Copy)]
struct Side {
    extent: Extent,
    centers: Extent,
}

impl Side {
    const EMPTY: Self = Self { extent: Extent::EMPTY, centers: Extent::EMPTY };

    #[inline(always)]
    fn add(&mut self, item: &Item) {
        self.extent = self.extent.union(item.extent);
        self.centers = self.centers.union(item.center());
    }

    fn set(self, start: usize, end: usize) -> Set {
        Set { start, end, extent: self.extent, centers: self.centers }
    }
}
