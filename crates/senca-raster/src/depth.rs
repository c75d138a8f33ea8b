//! Triangles that write depths and nothing else, as shadow maps and first passes do: [`crate::cover`]'s
//! rows of blocks with all that is the same for a block held in registers. The numbers are the same.

use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*};

use crate::api::Compare;
use crate::batch::Batch;
use crate::block_depths::{Covered, DepthForm};
use crate::cover::{LANE_FX, LANE_FY, TileDraw, row_of};

/// Row pairs of a block.
const PAIRS: usize = 4;

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Tests and writes depths in the `active` blocks of row `by`, of which the `full` ones are covered
    /// wholly, from the row pair `top` to `bottom`.
    #[inline(always)]
    pub(crate) fn depths<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        by: i32,
        pairs: [i32; 2],
        blocks: [u32; 2],
    ) {
        match self.pass.state.depth_test {
            Compare::Less => self.depths_by(simd, lane, lanes, by, pairs, blocks, less),
            Compare::Greater => self.depths_by(simd, lane, lanes, by, pairs, blocks, greater),
            Compare::GreaterEqual => self.depths_by(simd, lane, lanes, by, pairs, blocks, greater_equal),
            _ => self.depths_by(simd, lane, lanes, by, pairs, blocks, less_equal),
        }
    }

    #[inline(always)]
    fn depths_by<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        by: i32,
        [top, bottom]: [i32; 2],
        [active, full]: [u32; 2],
        passes: impl Fn(f32x16<S>, f32x16<S>) -> mask32x16<S>,
    ) {
        // 1. What is the same for the whole row.
        let b = &*self.batch;
        let [left, above] = [b.offset[0][lane], b.offset[1][lane] + 8 * by];
        let mut rows = [f32x16::splat(simd, 0.0); PAIRS];
        for pair in top..=bottom {
            let y = (above + 2 * pair) as f32;
            let fy = f32x16::load_array(simd, LANE_FY) + f32x16::splat(simd, y);
            rows[pair as usize % PAIRS] = row_of(simd, &b.depth, lane, fy);
        }
        let (nearest, farthest) = (f32x16::splat(simd, b.z_min[lane]), f32x16::splat(simd, b.z_max[lane]));
        let dx = f32x16::splat(simd, b.depth[1][lane]);
        let edges = RowEdges::new(simd, b, lane, lanes, 8 * by + 2 * top);
        let (mut tested, mut passed) = (0, 0);
        let mut remaining = active;
        while remaining != 0 {
            // 2. Planes, where they do.
            let bx = remaining.trailing_zeros() as i32;
            remaining &= remaining - 1;
            let block = (8 * by + bx) as usize & 63;
            let (first, more) = ([8 * bx, 8 * by + 2 * top], bottom - top);
            let mut pixels = (full >> bx & 1 == 1).then_some(u64::MAX);
            if self.buffer.formed >> block & 1 == 1 {
                if self.nearer_than_level(lane, block) {
                    let inside = pixels.unwrap_or_else(
                        #[inline(always)]
                        || self.inside_of_block(simd, &edges, first, more) << (16 * top),
                    );
                    if self.cover_some(lane, block, inside) {
                        continue;
                    }
                    pixels = Some(inside);
                }
                self.buffer.unfold(simd, block);
            }
            // 3. Values.
            let fx = f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, (left + 8 * bx) as f32);
            let across = dx * fx;
            let mut at = edges.at(simd, first[0]);
            let mut written = 0;
            for pair in top..=bottom {
                let inside = match pixels {
                    Some(pixels) => mask32x16::from_bitmask(simd, pixels >> (16 * pair) & 0xffff),
                    None => self.inside(simd, &at, [first[0], 8 * by + 2 * pair]),
                };
                let z = (rows[pair as usize % PAIRS] + across).max(nearest).min(farthest);
                let plane = &mut self.buffer.depth[block][pair as usize % PAIRS];
                let stored = f32x16::load_array_ref(simd, plane);
                let pass = inside & passes(z, stored);
                pass.select(z, stored).store_array(plane);
                tested += inside.to_bitmask().count_ones();
                written += pass.to_bitmask().count_ones();
                at = edges.next(at);
            }
            passed += written;
            self.buffer.written |= u64::from(written != 0) << block;
        }
        self.counts.tested += u64::from(tested);
        self.counts.passed += u64::from(passed);
    }

    /// Whether a triangle is nearer, wherever it is, than the one depth that a block was cleared to.
    #[inline(always)]
    fn nearer_than_level(&self, lane: usize, block: usize) -> bool {
        let b = &*self.batch;
        let farthest = if self.pass.reversed { -b.z_min[lane] } else { b.z_max[lane] };
        self.buffer.level >> block & 1 == 1 && farthest < self.buffer.farthest[block & 63]
    }

    /// Pixels inside a triangle, of `more` + 1 row pairs of a block from `first` on: sixteen of each pair.
    #[inline(always)]
    fn inside_of_block<S: Simd>(&self, simd: S, edges: &RowEdges<S>, [x, y]: [i32; 2], more: i32) -> u64 {
        let mut at = edges.at(simd, x);
        let mut pixels = 0;
        for pair in 0..=more.min(PAIRS as i32 - 1) {
            pixels |= self.inside(simd, &at, [x, y + 2 * pair]).to_bitmask() << (16 * pair);
            at = edges.next(at);
        }
        pixels
    }

    /// Gives pixels of a block, all of which pass the depth test, the plane of a triangle; whether the block can
    /// be kept that way.
    #[inline(always)]
    fn cover_some(&mut self, lane: usize, block: usize, pixels: u64) -> bool {
        if pixels == 0 {
            return true;
        }
        let Some(plane) = self.form(lane) else { return false };
        match self.buffer.forms.cover_some(block, pixels, plane) {
            Covered::TooMuch => return false,
            Covered::Some => {}
            Covered::All => self.buffer.level &= !(1 << block),
        }
        self.buffer.written |= 1 << block;
        self.counts.tested += u64::from(pixels.count_ones());
        self.counts.passed += u64::from(pixels.count_ones());
        true
    }

    /// Gives `blocks`, which are farther away and wholly covered, the plane of a triangle, if it can be kept.
    #[inline(always)]
    pub(crate) fn cover_level(&mut self, lane: usize, blocks: u64) -> bool {
        let Some(plane) = self.form(lane) else { return false };
        let mut left = blocks;
        while left != 0 {
            self.buffer.forms.cover(left.trailing_zeros() as usize, plane);
            left &= left - 1;
        }
        let pixels = 64 * u64::from(blocks.count_ones());
        (self.counts.tested, self.counts.passed) = (self.counts.tested + pixels, self.counts.passed + pixels);
        self.buffer.written |= blocks;
        self.buffer.level &= !blocks;
        self.buffer.formed |= blocks;
        true
    }

    /// The number of a triangle's plane in the forms of the tile; `None` if there are too many.
    #[inline(always)]
    fn form(&mut self, lane: usize) -> Option<u8> {
        if let Some((_, plane)) = self.form.filter(|(of, _)| *of == lane) {
            return Some(plane);
        }
        let b = &*self.batch;
        let plane = self.buffer.forms.add(DepthForm {
            plane: [b.depth[0][lane], b.depth[1][lane], b.depth[2][lane]],
            offset: [b.offset[0][lane] as f32, b.offset[1][lane] as f32],
            range: [b.z_min[lane], b.z_max[lane]],
        })?;
        self.form = Some((lane, plane));
        Some(plane)
    }

    /// The lanes where no edge is negative and that may be written.
    #[inline(always)]
    fn inside<S: Simd>(&self, simd: S, edges: &[i32x16<S>; 3], [x, y]: [i32; 2]) -> mask32x16<S> {
        let inside = (edges[0] | edges[1] | edges[2]).simd_ge(i32x16::splat(simd, 0));
        if self.partial { inside & self.within_bounds(simd, x, y) } else { inside }
    }
}

/// The edges of a triangle along a row of blocks.
struct RowEdges<S: Simd> {
    /// At the first vector of the row.
    start: [i32x16<S>; 3],
    /// Change from one column of pixels to the next.
    dx: [i32; 3],
    /// Change from one row pair to the next.
    below: [i32x16<S>; 3],
}

impl<S: Simd> RowEdges<S> {
    /// From row `y` of the tile on.
    #[inline(always)]
    fn new(simd: S, b: &Batch, lane: usize, lanes: &[i32x16<S>; 3], y: i32) -> Self {
        let (mut start, mut below, mut steps) = (*lanes, *lanes, [0; 3]);
        for k in 0..3 {
            let dy = b.edge_dy[k][lane];
            start[k] += i32x16::splat(simd, b.edge[k][lane].wrapping_add(dy.wrapping_mul(y)));
            below[k] = i32x16::splat(simd, dy.wrapping_mul(2));
            steps[k] = b.edge_dx[k][lane];
        }
        Self { start, dx: steps, below }
    }

    /// At column `x` of the tile.
    #[inline(always)]
    fn at(&self, simd: S, x: i32) -> [i32x16<S>; 3] {
        let [a, b, c] = self.start;
        [
            a + i32x16::splat(simd, self.dx[0].wrapping_mul(x)),
            b + i32x16::splat(simd, self.dx[1].wrapping_mul(x)),
            c + i32x16::splat(simd, self.dx[2].wrapping_mul(x)),
        ]
    }

    /// One row pair on.
    #[inline(always)]
    fn next(&self, [a, b, c]: [i32x16<S>; 3]) -> [i32x16<S>; 3] {
        [a + self.below[0], b + self.below[1], c + self.below[2]]
    }
}

#[inline(always)]
fn less<S: Simd>(new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    new.simd_lt(stored)
}

#[inline(always)]
fn less_equal<S: Simd>(new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    new.simd_le(stored)
}

#[inline(always)]
fn greater<S: Simd>(new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    new.simd_gt(stored)
}

#[inline(always)]
fn greater_equal<S: Simd>(new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    new.simd_ge(stored)
}
