//! Cutting a set of items into eight.

use fearless_simd::Simd;
use rayon::prelude::*;

use super::bins::{Bins, Plane, Scale};
use super::item::{Centers, both, bounds};
use super::{Extent, Item};
use crate::node::WIDTH;

/// Sets with at least so many items are split by several threads.
const PARALLEL: usize = 1 << 14;

/// What one thread takes of them.
const CHUNK: usize = 1 << 12;

/// Items from `start` to `end` with the box of them and the box of their centres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Set {
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) extent: Extent,
    centers: Centers,
    half_area: f32,
}

impl Set {
    /// All of `items`, which are those from `start` on.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(simd: S, items: &[Item], start: usize) -> Self {
        let (extent, centers) = if items.len() < PARALLEL {
            bounds(simd, items)
        } else {
            let chunks = items.par_chunks(CHUNK).map(|chunk| {
                simd.vectorize(
                    #[inline(always)]
                    || bounds(simd, chunk),
                )
            });
            chunks.reduce_with(both).unwrap_or_else(|| bounds(simd, &[]))
        };
        Self { start, end: start + items.len(), extent, centers, half_area: extent.half_area() }
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.end - self.start
    }
}

/// Up to eight sets, in the order of their items.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Children {
    sets: [Set; WIDTH],
    count: usize,
}

impl Children {
    pub(crate) fn as_slice(&self) -> &[Set] {
        &self.sets[..self.count]
    }

    fn replace(&mut self, index: usize, left: Set, right: Set) {
        self.sets.copy_within(index..self.count, index + 1);
        self.sets[index] = left;
        self.sets[index + 1] = right;
        self.count += 1;
    }
}

/// How sets are split.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splitting {
    pub(crate) max_leaf: usize,
    /// In halves, the one with the most items first, instead of by surface.
    pub(crate) balanced: bool,
}

/// Splits the child with the largest surface again and again. `items` are those of `set`; `scratch` is as
/// long when they are many.
#[inline(always)]
pub(crate) fn children_of<S: Simd>(
    simd: S,
    items: &mut [Item],
    scratch: &mut [Item],
    set: Set,
    how: Splitting,
) -> Children {
    let mut children = Children { sets: [set; WIDTH], count: 1 };
    while children.count < WIDTH {
        let (mut largest, mut largest_size) = (None, -1.0);
        for (index, child) in children.as_slice().iter().enumerate() {
            let size = if how.balanced { child.len() as f32 } else { child.half_area };
            // Infinite and NaN surfaces are the largest.
            if child.len() > how.max_leaf && (largest.is_none() || size.total_cmp(&largest_size).is_gt()) {
                (largest, largest_size) = (Some(index), size);
            }
        }
        let Some(largest) = largest else { break };
        let child = children.sets[largest];
        let range = child.start - set.start..child.end - set.start;
        let part = &mut items[range.clone()];
        let middle = if how.balanced {
            part.len() / 2
        } else {
            let scratch = if part.len() < PARALLEL { &mut [] } else { &mut scratch[range] };
            partition(simd, part, scratch, &child, how.max_leaf)
        };
        let (left, right) = part.split_at(middle);
        let middle = child.start + middle;
        children.replace(largest, Set::of(simd, left, child.start), Set::of(simd, right, middle));
    }
    children
}

/// Orders the items by the best plane and answers how many are on its left, or half of them when there is
/// none.
#[inline(always)]
fn partition<S: Simd>(
    simd: S,
    items: &mut [Item],
    scratch: &mut [Item],
    set: &Set,
    max_leaf: usize,
) -> usize {
    let scale = Scale::new(&set.centers);
    let bins = if items.len() < PARALLEL {
        Bins::of(simd, items, &scale)
    } else {
        bins_parallel(simd, items, &scale)
    };
    let count = match bins.best_plane(simd, &scale, max_leaf) {
        Some(plane) if items.len() < PARALLEL => partition_by(items, &plane),
        Some(plane) => partition_parallel(items, scratch, &plane),
        None => 0,
    };
    if count == 0 || count == items.len() { items.len() / 2 } else { count }
}

fn bins_parallel<S: Simd>(simd: S, items: &[Item], scale: &Scale) -> Bins {
    let of = |chunk| {
        simd.vectorize(
            #[inline(always)]
            || Bins::of(simd, chunk, scale),
        )
    };
    let add = |mut a: Bins, b: Bins| {
        simd.vectorize(
            #[inline(always)]
            || a.add(simd, &b),
        );
        a
    };
    items.par_chunks(CHUNK).map(of).reduce_with(add).unwrap_or_else(|| of(&[]))
}

/// Without branches on the side, which cannot be foreseen.
#[inline(always)]
fn partition_by(items: &mut [Item], plane: &Plane) -> usize {
    let mut left = 0;
    for index in 0..items.len() {
        let is_left = plane.is_left(&items[index]);
        items.swap(index, left);
        left += usize::from(is_left);
    }
    left
}

/// As [`partition_by`], chunk by chunk by way of `scratch`. The order does not depend on the threads.
fn partition_parallel(items: &mut [Item], scratch: &mut [Item], plane: &Plane) -> usize {
    let counts: Vec<usize> = items.par_chunks_mut(CHUNK).map(|chunk| partition_by(chunk, plane)).collect();
    let count = counts.iter().sum();
    let (mut left, mut right) = scratch.split_at_mut(count);
    let mut moves = Vec::with_capacity(counts.len());
    for (chunk, &count) in items.chunks(CHUNK).zip(&counts) {
        let (here, after) = left.split_at_mut(count);
        let (there, beyond) = right.split_at_mut(chunk.len() - count);
        (left, right) = (after, beyond);
        moves.push((chunk, here, there));
    }
    moves.into_par_iter().for_each(|(chunk, left, right)| {
        let (from_left, from_right) = chunk.split_at(left.len());
        left.copy_from_slice(from_left);
        right.copy_from_slice(from_right);
    });
    items
        .par_chunks_mut(CHUNK)
        .zip(scratch.par_chunks(CHUNK))
        .for_each(|(to, from)| to.copy_from_slice(from));
    count
}
