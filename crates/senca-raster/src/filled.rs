//! Whole blocks of colour: where nothing else is drawn and nothing is tested, no vector needs to be looked at by itself.
//!
//! The colour of a block is a plane in each channel; see [`crate::cover::varying`], whose bits it has.

use crate::api::{Blend, LANES};
use crate::blend::{Rgba, pack, pack_tame, unpack};
use crate::cover::{ColorPath, LANE_FX, LANE_FY, Pass, TileDraw};
use crate::tile::{BLOCKS, ColorFormat};
use fearless_simd::{Simd, f32x16, prelude::*, u32x16};

/// Numbers this far outside 0 to 1, and products of two, are rounded to the same bytes whether they are clamped or
/// not.
const SLACK: f32 = 0.0005;

/// A colour over a block row: per channel value at the reference, change in x, change in y.
type ColorPlanes = [[f32; 3]; 4];

/// Whether [`TileDraw::color_blocks`] draws what `pass` draws, in blocks that are covered wholly.
pub(crate) fn is_color_only(pass: &Pass<'_>) -> bool {
    let colored = matches!(pass.color, ColorPath::Constant(_) | ColorPath::Varying { .. });
    let blended = pass.state.blend.is_none_or(|blend| blend == Blend::OVER);
    colored
        && blended
        && pass.format == ColorFormat::Rgba8
        && !pass.waits
        && pass.stage.is_none()
        && pass.stencil.is_none()
        && !pass.touches.reads_depth
        && !pass.has_ids
}

/// Whether a plane keeps within 0 to 1, but for [`SLACK`], at the pixels from `x[0]` to `x[1]` and `y[0]` to `y[1]`.
/// Rounding keeps order, so what is true of the corners is true of all.
fn is_tame([c, dx, dy]: [f32; 3], x: [f32; 2], y: [f32; 2]) -> bool {
    let within = |v: f32| (-SLACK..=1.0 + SLACK).contains(&v);
    y.iter().all(|y| x.iter().all(|x| within((c + dy * y) + dx * x)))
}

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Colours the blocks of row `by` whose bits are set, all of their pixels. Returns whether it could: the triangle
    /// must be affine or of one colour. The pass is one of [`is_color_only`].
    #[inline(always)]
    pub(crate) fn color_blocks<S: Simd>(&mut self, simd: S, lane: usize, by: i32, blocks: u32) -> bool {
        let Some(planes) = self.color_planes(lane) else { return false };
        let b = &self.batch.offset;
        let origin = [b[0][lane % LANES], b[1][lane % LANES] + 8 * by];
        let over = !FAST && self.pass.state.blend.is_some();
        let (first, last) = (blocks.trailing_zeros() as i32, 31 - blocks.leading_zeros() as i32);
        let x = [origin[0] + 8 * first, origin[0] + 8 * last + 7].map(|x| x as f32);
        let y = [origin[1], origin[1] + 7].map(|y| y as f32);
        let tame = planes.iter().all(|plane| is_tame(*plane, x, y));
        simd.vectorize(
            #[inline(always)]
            || match (over, tame) {
                (false, true) => self.fill_blocks::<S, false, true>(simd, &planes, origin, by, blocks),
                (false, false) => self.fill_blocks::<S, false, false>(simd, &planes, origin, by, blocks),
                (true, true) => self.fill_blocks::<S, true, true>(simd, &planes, origin, by, blocks),
                (true, false) => self.fill_blocks::<S, true, false>(simd, &planes, origin, by, blocks),
            },
        );
        let count = 64 * u64::from(blocks.count_ones());
        self.counts.tested += count;
        self.counts.passed += count;
        self.counts.shaded += count;
        self.buffer.written |= u64::from(blocks) << ((8 * by) as u32 & 63);
        true
    }

    #[inline(always)]
    fn color_planes(&self, lane: usize) -> Option<ColorPlanes> {
        let b = &*self.batch;
        let plane = |slot: usize| b.varyings[slot].map(|term| term[lane % LANES]);
        match self.pass.color {
            ColorPath::Constant(rgba) => Some(rgba.map(|v| [v, 0.0, 0.0])),
            ColorPath::Varying { alpha } if (b.affine | b.flat) >> lane & 1 == 1 => {
                let last = if alpha { plane(3) } else { [1.0, 0.0, 0.0] };
                Some([plane(0), plane(1), plane(2), last])
            }
            _ => None,
        }
    }

    /// `origin` is the first pixel of the row of blocks, from the reference of the planes. All colours are within
    /// 0 to 1, but for [`SLACK`], if `TAME`; they are blended with what is there if `OVER`.
    #[inline(always)]
    fn fill_blocks<S: Simd, const OVER: bool, const TAME: bool>(
        &mut self,
        simd: S,
        planes: &ColorPlanes,
        origin: [i32; 2],
        by: i32,
        blocks: u32,
    ) {
        let splat = [planes[0][0], planes[1][0], planes[2][0], planes[3][0]];
        let mut rows = [[f32x16::splat(simd, 0.0); 4]; 4];
        for (pair, row) in rows.iter_mut().enumerate() {
            let y = (origin[1] + 2 * pair as i32) as f32;
            let fy = f32x16::load_array(simd, LANE_FY) + f32x16::splat(simd, y);
            for k in 0..4 {
                row[k] = f32x16::splat(simd, splat[k]) + f32x16::splat(simd, planes[k][2]) * fy;
            }
        }
        let mut left = blocks & 255;
        while left != 0 {
            let bx = left.trailing_zeros() as i32;
            left &= left - 1;
            let x = (origin[0] + 8 * bx) as f32;
            let fx = f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, x);
            let across = [
                f32x16::splat(simd, planes[0][1]) * fx,
                f32x16::splat(simd, planes[1][1]) * fx,
                f32x16::splat(simd, planes[2][1]) * fx,
                f32x16::splat(simd, planes[3][1]) * fx,
            ];
            let block = &mut self.buffer.rgba8[(8 * by + bx) as usize % (BLOCKS * BLOCKS)];
            for (row, pixels) in rows.iter().zip(block) {
                let mut rgba =
                    [row[0] + across[0], row[1] + across[1], row[2] + across[2], row[3] + across[3]];
                if OVER {
                    rgba = over(simd, rgba, unpack(simd, u32x16::load_array_ref(simd, pixels)));
                }
                let packed = if TAME { pack_tame(simd, rgba) } else { pack(simd, rgba) };
                packed.store_array(pixels);
            }
        }
    }
}

/// [`Blend::OVER`], to the bits of [`crate::blend::blended`].
#[inline(always)]
fn over<S: Simd>(simd: S, new: Rgba<S>, old: Rgba<S>) -> Rgba<S> {
    let (share, rest) = (new[3], f32x16::splat(simd, 1.0) - new[3]);
    [
        new[0] * share + old[0] * rest,
        new[1] * share + old[1] * rest,
        new[2] * share + old[2] * rest,
        new[3] * share + old[3] * rest,
    ]
}
