//! Colours once per pixel where squares of 2 x 2 pixels of the target are the samples of one.
//!
//! A block of 8 x 8 samples is 4 x 4 pixels: sixteen, one per lane, row by row. The samples stay row by row, as they
//! are in the target, so that a vector of them holds all samples of four pixels: those of pixel `c` of the four are in
//! lanes `2c`, `2c + 1`, `2c + 8` and `2c + 9`. (Stages are given samples in another order; see
//! [`crate::multisample`].)

use crate::api::{Blend, LANES};
use crate::blend::{Rgba, pack, sum_of_bytes};
use crate::cover::{Place, TileDraw, edge_at};
use crate::textured::Waiting;
use crate::tile::{BLOCKS, ColorFormat};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};

/// Vectors of a block.
const PAIRS: usize = 4;

/// Column and row of each lane's first sample in its block.
pub(crate) const LANE_FX: [f32; LANES] = [0., 2., 4., 6., 0., 2., 4., 6., 0., 2., 4., 6., 0., 2., 4., 6.];
pub(crate) const LANE_FY: [f32; LANES] = [0., 0., 0., 0., 2., 2., 2., 2., 4., 4., 4., 4., 6., 6., 6., 6.];

/// The samples of those of four pixels whose bits are set.
const SAMPLES_OF: [u16; 16] = {
    let mut samples = [0; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut column = 0;
        while column < 4 {
            samples[bits] |= ((bits as u16 >> column) & 1) * (0x0303 << (2 * column));
            column += 1;
        }
        bits += 1;
    }
    samples
};

/// The four pixels that have some of these samples.
#[inline(always)]
fn pixels_of(samples: u16) -> u16 {
    let columns = samples | samples >> 8;
    let even = (columns | columns >> 1) & 0x55;
    (even | even >> 1) & 3 | ((even | even >> 1) >> 2) & 12
}

/// Of the samples in `mask`, those of the pixels in `bits`, for row `pair` of pixels.
#[inline(always)]
pub(crate) fn samples_in(mask: u16, bits: u16, pair: usize) -> u16 {
    mask & SAMPLES_OF[usize::from(bits >> (4 * pair) & 15)]
}

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Does with the blocks of row `by` that are `active`, of which those in `full` are wholly covered, what
    /// [`Self::block_of_pixels`] does.
    ///
    /// A function of its own in the compiled kernel: inlined, it makes the other ways to draw slower.
    #[inline(always)]
    pub(crate) fn row_of_pixels<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        by: i32,
        rows: [i32; 2],
        [active, full]: [u32; 2],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                for bx in (0..8).filter(|bx| active >> bx & 1 == 1) {
                    self.block_of_pixels(simd, lane, lanes, [bx, by], rows, full >> bx & 1 == 1);
                }
            },
        );
    }

    /// Tests the samples of a triangle in a block, and keeps their pixels until [`Self::shade_waiting`]. `full` if all
    /// are covered.
    #[inline(always)]
    fn block_of_pixels<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        [bx, by]: [i32; 2],
        [top, bottom]: [i32; 2],
        full: bool,
    ) {
        let block = (8 * by + bx) as usize % (BLOCKS * BLOCKS);
        let (mut samples, mut bits, mut moved) = ([0; PAIRS], 0, 0);
        for pair in top..=bottom {
            let y = 8 * by + 2 * pair;
            let mut inside = mask32x16::splat(simd, true);
            if !full {
                let at = |k: usize| lanes[k] + edge_at(simd, &*self.batch, k, lane, [8 * bx, y]);
                inside = (at(0) | at(1) | at(2)).simd_ge(i32x16::splat(simd, 0));
                if self.partial {
                    inside &= self.within_bounds(simd, 8 * bx, y);
                }
            }
            let row = self.row_at(simd, lane, y);
            let pair = pair as usize % PAIRS;
            let place = Place { lane, block, pair };
            let Some(tested) = self.test(simd, place, &row, inside, bx) else { continue };
            samples[pair] = tested.bits;
            bits |= pixels_of(tested.bits) << (4 * pair);
            if self.pass.alpha_test.is_none() {
                self.keep_depth(simd, place, tested.pass, tested.z);
                self.counts.passed += u64::from(tested.bits.count_ones());
            } else if self.pass.writes_depth {
                let stored = f32x16::load_array_ref(simd, &self.buffer.depth[block][pair]);
                let (stored, z): (i32x16<S>, i32x16<S>) = (stored.bitcast(), tested.z.bitcast());
                moved |= tested.bits & !(stored.simd_eq(z).to_bitmask() as u16);
            }
        }
        if bits != 0 {
            self.counts.shaded += u64::from(bits.count_ones());
            let waiting = self.waiting_pixels(lane, block, samples, bits);
            self.wait(simd, Waiting { moves_depths: moved != 0, ..waiting });
        }
    }

    /// Pixels of a block that wait; `bits` says which.
    #[inline(always)]
    pub(crate) fn waiting_pixels(
        &self,
        lane: usize,
        block: usize,
        samples: [u16; PAIRS],
        bits: u16,
    ) -> Waiting {
        let b = &self.batch.offset;
        let (x, y) = (b[0][lane] + (block % BLOCKS * 8) as i32, b[1][lane] + (block / BLOCKS * 8) as i32);
        // In the middle of the pixel, between its samples.
        let offset = [x as f32 + 0.5, y as f32 + 0.5];
        Waiting { place: Place { lane, block, pair: 0 }, offset, bits, samples, moves_depths: true }
    }

    /// Writes colours of sixteen pixels to those of their `samples` that belong to the pixels in `bits`.
    #[inline(always)]
    pub(crate) fn write_pixels<S: Simd>(
        &mut self,
        simd: S,
        block: usize,
        samples: &[u16; PAIRS],
        bits: u16,
        rgba: Rgba<S>,
    ) {
        let blend = if FAST { None } else { self.pass.state.blend };
        if FAST || (self.pass.format == ColorFormat::Rgba8 && blend.is_none_or(|blend| blend == Blend::ADD)) {
            return self.write_packed_pixels(simd, block, samples, bits, pack(simd, rgba));
        }
        for (pair, mask) in samples.iter().enumerate() {
            let mask = samples_in(*mask, bits, pair);
            if mask != 0 {
                let of_samples = [
                    spread(rgba[0], pair),
                    spread(rgba[1], pair),
                    spread(rgba[2], pair),
                    spread(rgba[3], pair),
                ];
                let keep = mask32x16::from_bitmask(simd, u64::from(mask));
                self.write(simd, Place { lane: 0, block, pair }, keep, of_samples);
            }
        }
    }

    /// The same of packed colours that replace what is there or, if there is blending, are added to it.
    #[inline(always)]
    pub(crate) fn write_packed_pixels<S: Simd>(
        &mut self,
        simd: S,
        block: usize,
        samples: &[u16; PAIRS],
        bits: u16,
        packed: u32x16<S>,
    ) {
        let adds = !FAST && self.pass.state.blend.is_some();
        for (pair, mask) in samples.iter().enumerate() {
            let mask = samples_in(*mask, bits, pair);
            if mask != 0 {
                let keep = mask32x16::from_bitmask(simd, u64::from(mask));
                let plane = &mut self.buffer.rgba8[block % (BLOCKS * BLOCKS)][pair];
                let stored = u32x16::load_array_ref(simd, plane);
                let packed = spread(packed.bitcast(), pair).bitcast();
                let packed = if adds { sum_of_bytes(simd, packed, stored) } else { packed };
                keep.select(packed, stored).store_array(plane);
            }
        }
    }
}

/// Values of sixteen pixels at the samples of row `pair` of them.
#[inline(always)]
fn spread<S: Simd>(v: f32x16<S>, pair: usize) -> f32x16<S> {
    let doubled = if pair < 2 { v.zip_low(v) } else { v.zip_high(v) };
    let (left, right) = doubled.split();
    let row = if pair.is_multiple_of(2) { left } else { right };
    row.combine(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_and_their_samples() {
        for lane in 0..LANES {
            assert_eq!(pixels_of(1 << lane), 1 << (lane % 8 / 2));
        }
        for bits in 0..16 {
            assert_eq!(pixels_of(samples_in(u16::MAX, bits << 8, 2)), bits);
        }
        assert_eq!(samples_in(0x00ff, 0b0110, 0), 0b0011_1100);
    }

    #[test]
    fn values_are_spread_to_samples() {
        let simd = fearless_simd::Level::baseline();
        fearless_simd::dispatch!(simd, simd => {
            let values: [f32; LANES] = std::array::from_fn(|k| k as f32);
            for pair in 0..PAIRS {
                let samples = spread(f32x16::load_array(simd, values), pair).to_array();
                for (lane, sample) in samples.into_iter().enumerate() {
                    assert_eq!(sample, (4 * pair + lane % 8 / 2) as f32);
                }
            }
        });
    }
}
