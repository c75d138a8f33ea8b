//! Several samples per pixel: a target of twice as many rows and columns, whose squares of 2 x 2 are the
//! samples of one pixel. Coverage and depth are found for every sample as for pixels of their own;
//! a stage gives colours once per pixel.
//!
//! A block of 8 x 8 samples is 4 x 4 pixels. While a tile is drawn, vector `s` of a block holds sample
//! `s` of its sixteen pixels, row by row: sample 0 upper left, 1 upper right, 2 and 3 below.

use crate::api::{Fragments, LANES, MAX_VARYINGS};
use crate::cover::{Place, TileDraw, varying};
use crate::stage::{PixelColors, Pixels, Samples};
use crate::tile::{BLOCKS, Block, ColorFormat};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};

/// Samples of a pixel.
pub const SAMPLES: usize = 4;

/// Column and row of each lane's first sample in its block.
const LANE_X: [i32; LANES] = [0, 2, 4, 6, 0, 2, 4, 6, 0, 2, 4, 6, 0, 2, 4, 6];
const LANE_Y: [i32; LANES] = [0, 0, 0, 0, 2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6];

/// Sample and lane of column `x`, row `y` of a block.
pub(crate) fn sample_of(x: usize, y: usize) -> (usize, usize) {
    ((y & 1) * 2 + (x & 1), (y % 8 / 2) * 4 + x % 8 / 2)
}

/// Column and row in its block of a lane's sample.
pub(crate) fn place_of(sample: usize, lane: usize) -> (usize, usize) {
    (lane % 4 * 2 + (sample & 1), lane / 4 * 2 + (sample >> 1))
}

/// A block stored row by row, sample by sample.
pub(crate) fn to_samples<T: Copy>(block: &mut Block<T>) {
    let rows = *block;
    for (s, vector) in block.iter_mut().enumerate() {
        for (lane, to) in vector.iter_mut().enumerate() {
            let (x, y) = place_of(s, lane);
            *to = rows[y / 2][y % 2 * 8 + x];
        }
    }
}

/// The inverse of [`to_samples`].
pub(crate) fn to_rows<T: Copy>(block: &mut Block<T>) {
    let samples = *block;
    for (pair, vector) in block.iter_mut().enumerate() {
        for (lane, to) in vector.iter_mut().enumerate() {
            let (s, from) = sample_of(lane % 8, 2 * pair + lane / 8);
            *to = samples[s][from];
        }
    }
}

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Draws a triangle's samples of a block of 4 x 4 pixels.
    #[inline(always)]
    pub(crate) fn block_of_samples<S: Simd>(&mut self, simd: S, lane: usize, [bx, by]: [i32; 2], full: bool) {
        let block = (8 * by + bx) as usize & 63;
        let (mut masks, mut depths) = ([0u16; SAMPLES], [[0.0; LANES]; SAMPLES]);
        let edges = self.samples_edges(simd, lane, [8 * bx, 8 * by], full);
        for s in 0..SAMPLES {
            let corner = [8 * bx + (s as i32 & 1), 8 * by + (s as i32 >> 1)];
            let inside = self.samples_inside(simd, lane, &edges, s, corner, full);
            self.counts.tested += u64::from(inside.to_bitmask().count_ones());
            let z = self.samples_depth(simd, lane, corner.map(|c| c as f32));
            let mut pass = inside;
            if self.pass.has_depth {
                let stored = f32x16::load_array_ref(simd, &self.buffer.depth[block][s]);
                pass &= crate::cover::compare(simd, self.pass.state.depth_test, z, stored);
            }
            masks[s] = pass.to_bitmask() as u16;
            z.store_array(&mut depths[s]);
        }
        let any = masks.iter().fold(0, |any, mask| any | mask);
        if any != 0 {
            self.buffer.written |= 1 << block;
            self.shade_samples(simd, Place { lane, block, pair: 0 }, any, &masks, &depths);
        }
    }

    /// The edge functions at the first samples of a block, unless it is covered.
    #[inline(always)]
    fn samples_edges<S: Simd>(&self, simd: S, lane: usize, [x, y]: [i32; 2], full: bool) -> [i32x16<S>; 3] {
        let mut edges = [i32x16::splat(simd, 0); 3];
        if full {
            return edges;
        }
        let (column, row) = (i32x16::load_array(simd, LANE_X), i32x16::load_array(simd, LANE_Y));
        let b = &*self.batch;
        for (k, edge) in edges.iter_mut().enumerate() {
            let (dx, dy) = (b.edge_dx[k][lane], b.edge_dy[k][lane]);
            let first = b.edge[k][lane].wrapping_add(dx.wrapping_mul(x)).wrapping_add(dy.wrapping_mul(y));
            *edge =
                column * i32x16::splat(simd, dx) + row * i32x16::splat(simd, dy) + i32x16::splat(simd, first);
        }
        edges
    }

    /// Lanes whose sample `s`, that of lane 0 being at (`x`, `y`) of the tile, may be drawn.
    #[inline(always)]
    fn samples_inside<S: Simd>(
        &self,
        simd: S,
        lane: usize,
        edges: &[i32x16<S>; 3],
        s: usize,
        [x, y]: [i32; 2],
        full: bool,
    ) -> mask32x16<S> {
        let mut inside = mask32x16::splat(simd, true);
        if full {
            return inside;
        }
        let b = &*self.batch;
        let mut all = i32x16::splat(simd, 0);
        for (k, edge) in edges.iter().enumerate() {
            let step = b.edge_dx[k][lane] * (s as i32 & 1) + b.edge_dy[k][lane] * (s as i32 >> 1);
            all |= *edge + i32x16::splat(simd, step);
        }
        inside &= all.simd_ge(i32x16::splat(simd, 0));
        if self.partial {
            let b = &self.bounds;
            let (column, row) = (i32x16::load_array(simd, LANE_X), i32x16::load_array(simd, LANE_Y));
            let column = column + i32x16::splat(simd, self.tile[0] + x);
            let row = row + i32x16::splat(simd, self.tile[1] + y);
            inside &= column.simd_ge(i32x16::splat(simd, b.x0))
                & column.simd_lt(i32x16::splat(simd, b.x1))
                & row.simd_ge(i32x16::splat(simd, b.y0))
                & row.simd_lt(i32x16::splat(simd, b.y1));
        }
        inside
    }

    /// Samples from the reference of the triangle, lane 0 being at `corner` of the tile.
    #[inline(always)]
    fn samples_at<S: Simd>(&self, simd: S, lane: usize, [x, y]: [f32; 2]) -> [f32x16<S>; 2] {
        let b = &self.batch.offset;
        let (ox, oy) = (b[0][lane] as f32 + x, b[1][lane] as f32 + y);
        let lanes = |of: [i32; LANES]| i32x16::load_array(simd, of).to_float::<f32x16<S>>();
        [lanes(LANE_X) + f32x16::splat(simd, ox), lanes(LANE_Y) + f32x16::splat(simd, oy)]
    }

    #[inline(always)]
    fn samples_depth<S: Simd>(&self, simd: S, lane: usize, corner: [f32; 2]) -> f32x16<S> {
        let b = &*self.batch;
        let [fx, fy] = self.samples_at(simd, lane, corner);
        let splat = |v: f32| f32x16::splat(simd, v);
        let z = (splat(b.depth[0][lane]) + splat(b.depth[2][lane]) * fy) + splat(b.depth[1][lane]) * fx;
        z.max(splat(b.z_min[lane])).min(splat(b.z_max[lane]))
    }

    /// Colours the pixels of `any` and merges their samples.
    #[inline(always)]
    fn shade_samples<S: Simd>(
        &mut self,
        simd: S,
        place: Place,
        any: u16,
        masks: &[u16; SAMPLES],
        depths: &[[f32; LANES]; SAMPLES],
    ) {
        let Some(stage) = self.pass.stage else { return };
        let Place { lane, block, .. } = place;
        let (mut values, mut count) = (std::mem::take(&mut self.batch.interpolated), 0);
        let mut depth = [0.0; LANES];
        if self.pass.needs.shades {
            count = self.pass.slots.len().min(MAX_VARYINGS);
            // At the middle of the pixel, between its samples.
            let corner = [block % BLOCKS * 8, block / BLOCKS * 8].map(|c| c as f32 + 0.5);
            self.samples_depth(simd, lane, corner).store_array(&mut depth);
            let [fx, fy] = self.samples_at(simd, lane, corner);
            let at = self.at(simd, lane, fx, fy);
            values.resize(count, [0.0; LANES]);
            for (slot, value) in values.iter_mut().enumerate() {
                varying(simd, &self.batch.varyings[slot], lane, &at).store_array(value);
            }
        }
        let fragments = Fragments {
            x: (self.tile[0] as usize + block % BLOCKS * 8) as u32 / 2,
            y: (self.tile[1] as usize + block / BLOCKS * 8) as u32 / 2,
            columns: 4,
            sample: 0,
            mask: any,
            depth,
            varyings: &values[..count],
            id: self.batch.ids[lane],
            front: self.batch.swapped >> lane & 1 == 1,
            coverage: None,
        };
        self.counts.shaded += u64::from(any.count_ones());
        let samples = Samples { masks: *masks, depths };
        let passed = stage.shade_and_merge_samples(&fragments, &samples, &mut self.pixels_of_samples(block));
        for (s, passed) in passed.into_iter().enumerate() {
            let passed = passed & masks[s];
            if passed == 0 {
                continue;
            }
            self.counts.passed += u64::from(passed.count_ones());
            let keep = mask32x16::from_bitmask(simd, u64::from(passed));
            if self.pass.writes_depth {
                let plane = &mut self.buffer.depth[block][s];
                let stored = f32x16::load_array_ref(simd, plane);
                keep.select(f32x16::load_array_ref(simd, &depths[s]), stored).store_array(plane);
            }
            if !FAST && self.pass.has_ids {
                let plane = &mut self.buffer.ids[block][s];
                let stored = u32x16::load_array_ref(simd, plane);
                keep.select(u32x16::splat(simd, self.batch.ids[lane]), stored).store_array(plane);
            }
        }
        self.batch.interpolated = values;
    }

    /// The samples of a block, for the stage.
    #[inline(always)]
    fn pixels_of_samples(&mut self, block: usize) -> [Pixels<'_>; SAMPLES] {
        let (pass, buffer) = (self.pass, &mut *self.buffer);
        let has_stencil = self.band.stencil.is_some() && pass.needs.stencil;
        let [r, g, b, a] = &mut buffer.rgba;
        let [c0, c1, c2, c3] = match pass.format {
            ColorFormat::Rgba8 if pass.needs.color => buffer.rgba8[block].each_mut().map(PixelColors::Rgba8),
            ColorFormat::Rgba32F if pass.needs.color => {
                let [r0, r1, r2, r3] = r[block].each_mut();
                let [g0, g1, g2, g3] = g[block].each_mut();
                let [b0, b1, b2, b3] = b[block].each_mut();
                let [a0, a1, a2, a3] = a[block].each_mut();
                let planes = [[r0, g0, b0, a0], [r1, g1, b1, a1], [r2, g2, b2, a2], [r3, g3, b3, a3]];
                planes.map(PixelColors::Rgba32F)
            }
            _ => [PixelColors::None, PixelColors::None, PixelColors::None, PixelColors::None],
        };
        let [d0, d1, d2, d3] = buffer.depth[block].each_mut();
        let [s0, s1, s2, s3] = buffer.stencil[block].each_mut();
        let depth = |plane| Some(plane).filter(|_| pass.touches.reads_depth);
        let stencil = |plane| Some(plane).filter(|_| has_stencil);
        [
            Pixels { color: c0, depth: depth(d0), stencil: stencil(s0) },
            Pixels { color: c1, depth: depth(d1), stencil: stencil(s1) },
            Pixels { color: c2, depth: depth(d2), stencil: stencil(s2) },
            Pixels { color: c3, depth: depth(d3), stencil: stencil(s3) },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_turn_to_samples_and_back() {
        let rows: Block<usize> = std::array::from_fn(|pair| std::array::from_fn(|i| 16 * pair + i));
        let mut block = rows;
        to_samples(&mut block);
        // Sample 3 of pixel (1, 2) is in column 3, row 5.
        assert_eq!(block[3][9], 5 * 8 + 3);
        for y in 0..8 {
            for x in 0..8 {
                let (s, lane) = sample_of(x, y);
                assert_eq!((block[s][lane], place_of(s, lane)), (8 * y + x, (x, y)));
            }
        }
        to_rows(&mut block);
        assert_eq!(block, rows);
    }
}
