//! Where to split a set.

use super::item::Centers;
use super::{Extent, Item};
use fearless_simd::{Simd, f32x4, i32x4, prelude::*};

const BINS: usize = 16;

/// Items whose centre falls into a bin below `bin` are on the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    axis: usize,
    bin: usize,
    first: f32,
    per_unit: f32,
}

impl Plane {
    #[inline(always)]
    pub(crate) fn is_left(&self, item: &Item) -> bool {
        let bin = ((item.extent.center2(self.axis) - self.first) * self.per_unit) as i32;
        (bin as usize % BINS) < self.bin
    }
}

/// Bins of centres, for three axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    first: [f32; 4],
    per_unit: [f32; 4],
}

impl Scale {
    #[inline(always)]
    pub(crate) fn new(centers: &Centers) -> Self {
        let mut per_unit = [0.0; 4];
        for (axis, per_unit) in per_unit.iter_mut().enumerate().take(3) {
            let scale = 0.9999 * BINS as f32 / (centers.max[axis] - centers.min[axis]);
            *per_unit = if scale.is_finite() { scale } else { 0.0 };
        }
        Self { first: centers.min, per_unit }
    }
}

#[derive(Clone)]
pub(crate) struct Bins {
    extents: [Extent; 3 * BINS],
    counts: [u32; 3 * BINS],
}

impl Bins {
    #[inline(always)]
    pub(crate) fn of<S: Simd>(simd: S, items: &[Item], scale: &Scale) -> Self {
        let mut bins = Self { extents: [Extent::EMPTY; 3 * BINS], counts: [0; 3 * BINS] };
        let first = f32x4::load_array(simd, scale.first);
        let per_unit = f32x4::load_array(simd, scale.per_unit);
        for item in items {
            let bin: i32x4<S> = ((item.center2(simd) - first) * per_unit).to_int();
            let bin = bin.to_array();
            let extent = item.extent.load(simd);
            for axis in 0..3 {
                let bin = axis * BINS + bin[axis] as usize % BINS;
                bins.extents[bin] = Extent::store(bins.extents[bin].load(simd).min(extent));
                bins.counts[bin] += 1;
            }
        }
        bins
    }

    #[inline(always)]
    pub(crate) fn add<S: Simd>(&mut self, simd: S, other: &Self) {
        for bin in 0..3 * BINS {
            self.extents[bin] =
                Extent::store(self.extents[bin].load(simd).min(other.extents[bin].load(simd)));
            self.counts[bin] += other.counts[bin];
        }
    }

    /// The cheapest plane, if there is one with items on both sides and a finite cost.
    #[inline(always)]
    pub(crate) fn best_plane<S: Simd>(&self, simd: S, scale: &Scale, max_leaf: usize) -> Option<Plane> {
        let (mut best_cost, mut best) = (f32::INFINITY, None);
        for axis in 0..3 {
            let (cost, bin) = self.cheapest(simd, axis, max_leaf as u32);
            if cost < best_cost {
                best_cost = cost;
                best = Some(Plane { axis, bin, first: scale.first[axis], per_unit: scale.per_unit[axis] });
            }
        }
        best
    }

    /// The cost of the cheapest plane of one axis, and its bin.
    #[inline(always)]
    fn cheapest<S: Simd>(&self, simd: S, axis: usize, max_leaf: u32) -> (f32, usize) {
        let (extents, counts) = (&self.extents[axis * BINS..][..BINS], &self.counts[axis * BINS..][..BINS]);
        let mut right_cost = [0f32; BINS];
        let (mut extent, mut count) = (Extent::EMPTY.load(simd), 0);
        for bin in (1..BINS).rev() {
            extent = extent.min(extents[bin].load(simd));
            count += counts[bin];
            right_cost[bin] = cost(Extent::store(extent), count, max_leaf);
        }
        let (mut best_cost, mut best) = (f32::INFINITY, 0);
        let (mut extent, mut count) = (Extent::EMPTY.load(simd), 0);
        for bin in 1..BINS {
            extent = extent.min(extents[bin - 1].load(simd));
            count += counts[bin - 1];
            let cost = cost(Extent::store(extent), count, max_leaf) + right_cost[bin];
            if cost < best_cost {
                (best_cost, best) = (cost, bin);
            }
        }
        (best_cost, best)
    }
}

/// The cost of one side: its surface times the leaves it would fill. Infinite for an empty one.
#[inline(always)]
fn cost(extent: Extent, count: u32, max_leaf: u32) -> f32 {
    let leaves = count.div_ceil(max_leaf) as f32;
    if count == 0 { f32::INFINITY } else { extent.half_area() * leaves }
}
