//! Where to split a set.

use super::{Extent, Item};
use rayon::prelude::*;

const BINS: usize = 16;

/// Sets with more items are binned by several threads.
const PARALLEL: usize = 1 << 15;

/// Items whose centre falls into a bin below `bin` are on the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    axis: usize,
    bin: usize,
    scale: Scale,
}

impl Plane {
    #[inline(always)]
    pub(crate) fn is_left(&self, item: &Item) -> bool {
        self.scale.bin(item.extent.center2()[self.axis], self.axis) < self.bin
    }
}

/// Bins of centres.
#[derive(Clone, Copy, Debug)]
struct Scale {
    first: [f32; 3],
    per_unit: [f32; 3],
}

impl Scale {
    fn new(centers: &Extent) -> Self {
        let first = [0, 1, 2].map(|axis| centers.min(axis));
        let per_unit = [0, 1, 2].map(|axis| {
            let scale = 0.9999 * BINS as f32 / (centers.max(axis) - centers.min(axis));
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self { first, per_unit }
    }

    #[inline(always)]
    fn bin(&self, center2: f32, axis: usize) -> usize {
        (((center2 - self.first[axis]) * self.per_unit[axis]) as i32 as usize).min(BINS - 1)
    }
}

#[derive(Clone)]
struct Bins {
    extents: [[Extent; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { extents: [[Extent::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    fn of(items: &[Item], scale: &Scale) -> Self {
        let mut bins = Self::EMPTY;
        for item in items {
            let center2 = item.extent.center2();
            for (axis, center2) in center2.into_iter().enumerate() {
                let bin = scale.bin(center2, axis);
                bins.extents[axis][bin] = bins.extents[axis][bin].union(item.extent);
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }

    fn and(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.extents[axis][bin] = self.extents[axis][bin].union(other.extents[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The cheapest plane of one axis with something on both sides, and its cost.
    fn cheapest(&self, axis: usize) -> Option<(f32, usize)> {
        let mut right_cost = [0f32; BINS];
        let (mut extent, mut count) = (Extent::EMPTY, 0);
        for bin in (1..BINS).rev() {
            extent = extent.union(self.extents[axis][bin]);
            count += self.counts[axis][bin];
            right_cost[bin] = if count == 0 { f32::INFINITY } else { extent.half_area() * blocks(count) };
        }
        let mut best: Option<(f32, usize)> = None;
        let (mut extent, mut count) = (Extent::EMPTY, 0);
        for (bin, right_cost) in right_cost.into_iter().enumerate().skip(1) {
            extent = extent.union(self.extents[axis][bin - 1]);
            count += self.counts[axis][bin - 1];
            let cost = extent.half_area() * blocks(count) + right_cost;
            if count > 0 && cost < best.map_or(f32::INFINITY, |b| b.0) {
                best = Some((cost, bin));
            }
        }
        best
    }
}

/// The cost of testing so many items: leaves are tested eight at a time.
fn blocks(count: u32) -> f32 {
    count.div_ceil(8) as f32
}

/// The cheapest plane, if there is one with items on both sides and a finite cost.
pub(crate) fn best_plane(items: &[Item], centers: &Extent) -> Option<Plane> {
    let scale = Scale::new(centers);
    let bins = if items.len() > PARALLEL {
        items
            .par_chunks(PARALLEL / 4)
            .map(|chunk| Bins::of(chunk, &scale))
            .reduce(|| Bins::EMPTY, |a, b| a.and(&b))
    } else {
        Bins::of(items, &scale)
    };
    let mut best: Option<(f32, Plane)> = None;
    for axis in 0..3 {
        if let Some((cost, bin)) = bins.cheapest(axis)
            && cost < best.map_or(f32::INFINITY, |b| b.0)
        {
            best = Some((cost, Plane { axis, bin, scale }));
        }
    }
    best.map(|b| b.1)
}
