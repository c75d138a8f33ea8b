//! Textures read for sixteen fragments at once: the vector twin of [`Sampler::sample`].
//!
//! Texels of 8 bits are mixed with weights of 8 bits in integers, so the position between texels is
//! resolved to 1/256; the sums keep all their 16 bits. Floating-point textures are mixed in floating
//! point, to the bits of the plain form. [`crate::textured`] does the usual filters of 8-bit texels
//! for many vectors at a time.
//!
//! The level of detail comes from the exact derivatives at each fragment, not from differences.

use crate::api::{LANES, MAX_VARYINGS, TextureUnit};
use crate::batch::{Batch, PlaneLanes};
use crate::blend::Rgba;
use crate::cover::{At, varying};
use crate::texture::{
    FARTHEST_TEXEL, Filter, LOG2, Mip, Sampler, TexelGrid, Texels, Texture, TextureLevel, Wrap, light_of,
};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};
use senca_math::SrgbTable;

type F<S> = f32x16<S>;
type I<S> = i32x16<S>;

/// Texture colour at the lanes of `mask`; other lanes hold anything. `slot` has u, the next one v.
///
/// A function of its own in the compiled kernel, not part of its caller, as is [`read`]: inlined, they
/// make code of many megabytes.
#[inline(always)]
pub(crate) fn sample<S: Simd>(
    simd: S,
    unit: &TextureUnit<'_>,
    batch: &Batch,
    lane: usize,
    slot: usize,
    at: &At<S>,
    mask: mask32x16<S>,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || sample_inline(simd, unit, batch, lane, slot, at, mask),
    )
}

#[inline(always)]
fn sample_inline<S: Simd>(
    simd: S,
    unit: &TextureUnit<'_>,
    batch: &Batch,
    lane: usize,
    slot: usize,
    at: &At<S>,
    mask: mask32x16<S>,
) -> Rgba<S> {
    let (tu, tv) = (&batch.varyings[slot % MAX_VARYINGS], &batch.varyings[(slot + 1) % MAX_VARYINGS]);
    let uv = [varying(simd, tu, lane, at), varying(simd, tv, lane, at)];
    let (sampler, texture) = (&unit.sampler, unit.texture);
    let mips = sampler.mip != Mip::None && texture.levels.len() > 1;
    if !mips && sampler.magnify == sampler.minify {
        return read(simd, sampler, &texture.levels[0], uv, sampler.minify);
    }
    let lod = lod_of(simd, sampler, footprint(simd, texture, batch, lane, slot, at, uv));
    let zero = F::splat(simd, 0.0);
    let minified = lod.simd_gt(zero) & mask;
    let mut out = [zero; 4];
    if (!minified & mask).any_true() {
        out = read(simd, sampler, &texture.levels[0], uv, sampler.magnify);
    }
    if !minified.any_true() {
        return out;
    }
    let lod = lod.min(F::splat(simd, (texture.levels.len() - 1) as f32));
    let level: F<S> = match sampler.mip {
        Mip::None => zero,
        Mip::Nearest => (lod + F::splat(simd, 0.5)).floor(),
        Mip::Linear => lod.floor(),
    };
    // Level by level: a vector seldom meets more than two.
    let numbers: [i32; LANES] = level.to_int::<I<S>>().to_array();
    let mut left = minified.to_bitmask() as u32 & 0xffff;
    while left != 0 {
        let number = numbers[left.trailing_zeros() as usize % LANES];
        let here = minified & level.simd_eq(F::splat(simd, number as f32));
        let color = one_level(simd, sampler, texture, number as usize, uv, lod - level);
        out = select4(here, color, out);
        left &= !(here.to_bitmask() as u32);
    }
    out
}

/// Colour where level `number` is the finer one.
#[inline(always)]
fn one_level<S: Simd>(
    simd: S,
    sampler: &Sampler,
    texture: &Texture,
    number: usize,
    uv: [F<S>; 2],
    t: F<S>,
) -> Rgba<S> {
    let last = texture.levels.len() - 1;
    let (fine, coarse) = (&texture.levels[number.min(last)], &texture.levels[(number + 1).min(last)]);
    if sampler.mip != Mip::Linear {
        return read(simd, sampler, fine, uv, sampler.minify);
    }
    let fine = read(simd, sampler, fine, uv, sampler.minify);
    let coarse = read(simd, sampler, coarse, uv, sampler.minify);
    lerp(fine, coarse, t)
}

#[inline(always)]
fn select4<S: Simd>(mask: mask32x16<S>, a: Rgba<S>, b: Rgba<S>) -> Rgba<S> {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2]), mask.select(a[3], b[3])]
}

#[inline(always)]
pub(crate) fn lerp<S: Simd>(a: Rgba<S>, b: Rgba<S>, t: F<S>) -> Rgba<S> {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t]
}

/// Level of detail, from the square of the longer side of a pixel; see [`Sampler::lod`].
#[inline(always)]
pub(crate) fn lod_of<S: Simd>(simd: S, sampler: &Sampler, footprint: F<S>) -> F<S> {
    F::splat(simd, 0.5) * log2(simd, footprint) + F::splat(simd, sampler.lod_bias)
}

/// Square of the longer side of a pixel, in texels of level 0. Derivatives as in
/// [`crate::shade::derivatives`].
#[inline(always)]
pub(crate) fn footprint<S: Simd>(
    simd: S,
    texture: &Texture,
    batch: &Batch,
    lane: usize,
    slot: usize,
    at: &At<S>,
    [u, v]: [F<S>; 2],
) -> F<S> {
    let (tu, tv) = (&batch.varyings[slot % MAX_VARYINGS], &batch.varyings[(slot + 1) % MAX_VARYINGS]);
    let (w, h) = (F::splat(simd, texture.width() as f32), F::splat(simd, texture.height() as f32));
    let (x, y) = (
        square(change(simd, batch, lane, at, tu, u, 1) * w, change(simd, batch, lane, at, tv, v, 1) * h),
        square(change(simd, batch, lane, at, tu, u, 2) * w, change(simd, batch, lane, at, tv, v, 2) * h),
    );
    x.simd_gt(y).select(x, y)
}

/// Change of a varying per pixel in x (`axis` 1) or y (2).
#[inline(always)]
pub(crate) fn change<S: Simd>(
    simd: S,
    batch: &Batch,
    lane: usize,
    at: &At<S>,
    terms: &PlaneLanes,
    value: F<S>,
    axis: usize,
) -> F<S> {
    let lane = lane % LANES;
    if at.affine {
        return F::splat(simd, terms[axis][lane]);
    }
    let whole = batch.b1[axis][lane] * terms[1][lane] + batch.b2[axis][lane] * terms[2][lane];
    let part = (value - F::splat(simd, terms[0][lane])) * F::splat(simd, batch.inv_w[axis][lane]);
    (F::splat(simd, whole) - part) * at.weights[2]
}

#[inline(always)]
fn square<S: Simd>(a: F<S>, b: F<S>) -> F<S> {
    a * a + b * b
}

/// See [`crate::texture::log2`].
#[inline(always)]
fn log2<S: Simd>(simd: S, v: F<S>) -> F<S> {
    let bits: u32x16<S> = v.bitcast();
    let exponent: I<S> = (bits >> 23).bitcast::<I<S>>() - I::splat(simd, 127);
    let one = u32x16::splat(simd, 0x3f80_0000);
    let m = ((bits & u32x16::splat(simd, 0x007f_ffff)) | one).bitcast::<F<S>>() - F::splat(simd, 1.0);
    let p = F::splat(simd, LOG2[4]);
    let p = p * m + F::splat(simd, LOG2[3]);
    let p = p * m + F::splat(simd, LOG2[2]);
    let p = p * m + F::splat(simd, LOG2[1]);
    let p = p * m + F::splat(simd, LOG2[0]);
    exponent.to_float::<F<S>>() + p * m
}

/// Colour of one level; see [`Sampler::read`].
#[inline(always)]
fn read<S: Simd>(simd: S, sampler: &Sampler, level: &TextureLevel, uv: [F<S>; 2], filter: Filter) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || read_inline(simd, sampler, level, uv, filter),
    )
}

#[inline(always)]
fn read_inline<S: Simd>(
    simd: S,
    sampler: &Sampler,
    level: &TextureLevel,
    uv: [F<S>; 2],
    filter: Filter,
) -> Rgba<S> {
    match filter {
        Filter::Nearest => nearest(simd, sampler, level, uv),
        Filter::Linear => bilinear(simd, level, &taps::<S, false>(simd, sampler, level, uv)),
    }
}

/// Coordinates within this of 0 are within [`FARTHEST_TEXEL`] in texels of any texture.
pub(crate) const FARTHEST_TAME: f32 = 30_000.0;

/// See [`TexelGrid::position`]; held within +-[`FARTHEST_TEXEL`], 0 where it is not a number. Neither
/// is looked after when all of `u` is `TAME`: within [`FARTHEST_TAME`] of 0.
#[inline(always)]
fn position<S: Simd, const TAME: bool>(simd: S, grid: TexelGrid, u: F<S>, n: u32) -> F<S> {
    let p = match grid {
        TexelGrid::Areas => u * F::splat(simd, n as f32) - F::splat(simd, 0.5),
        TexelGrid::Points => u * F::splat(simd, (n - 1) as f32),
    };
    if TAME {
        return p;
    }
    let number = p.is_nan().select(F::splat(simd, 0.0), p);
    number.max(F::splat(simd, -FARTHEST_TEXEL)).min(F::splat(simd, FARTHEST_TEXEL))
}

/// See [`Wrap::apply`].
#[inline(always)]
fn wrapped<S: Simd>(simd: S, wrap: Wrap, i: I<S>, n: u32) -> I<S> {
    let n = n as i32;
    let last = I::splat(simd, n - 1);
    match wrap {
        Wrap::Clamp => i.max(I::splat(simd, 0)).min(last),
        Wrap::Repeat => remainder(simd, i, n),
        Wrap::Mirror => {
            let j = remainder(simd, i, 2 * n);
            j.simd_le(last).select(j, I::splat(simd, 2 * n - 1) - j)
        }
    }
}

/// `i` modulo `n`, never negative.
#[inline(always)]
fn remainder<S: Simd>(simd: S, i: I<S>, n: i32) -> I<S> {
    if n & (n - 1) == 0 {
        return i & I::splat(simd, n - 1);
    }
    // The quotient may be one off, and more for coordinates of millions; the rest is brought in.
    let quotient: I<S> = (i.to_float::<F<S>>() * F::splat(simd, 1.0 / n as f32)).floor().to_int();
    let (zero, n) = (I::splat(simd, 0), I::splat(simd, n));
    let rest = i - quotient * n;
    let rest = rest.simd_lt(zero).select(rest + n, rest);
    let rest = rest.simd_ge(n).select(rest - n, rest);
    rest.max(zero).min(n - I::splat(simd, 1))
}

/// Number of the nearest texel. All coordinates are within [`FARTHEST_TAME`] of 0 if `TAME`.
#[inline(always)]
pub(crate) fn nearest_index<S: Simd, const TAME: bool>(
    simd: S,
    sampler: &Sampler,
    level: &TextureLevel,
    uv: [F<S>; 2],
) -> I<S> {
    let x = position::<S, TAME>(simd, sampler.grid, uv[0], level.width);
    let y = position::<S, TAME>(simd, sampler.grid, uv[1], level.height);
    let half = F::splat(simd, 0.5);
    let i = wrapped(simd, sampler.wrap_u, (x + half).floor().to_int(), level.width);
    let j = wrapped(simd, sampler.wrap_v, (y + half).floor().to_int(), level.height);
    j * I::splat(simd, level.width as i32) + i
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, sampler: &Sampler, level: &TextureLevel, uv: [F<S>; 2]) -> Rgba<S> {
    let index = nearest_index::<S, false>(simd, sampler, level, uv);
    match &level.texels {
        Texels::Rgba8(texels) => crate::blend::unpack(simd, gather(simd, texels, index)),
        Texels::Shared(texels) => crate::blend::unpack(simd, gather(simd, texels.get(), index)),
        Texels::Srgb8(texels) => {
            let mut out = [[0f32; LANES]; 4];
            gather_light(texels, &index.to_array(), &mut out);
            load4(simd, &out)
        }
        Texels::Rgba32F(texels) => {
            let mut out = [[0f32; LANES]; 4];
            gather_planes(texels, &index.to_array(), &mut out);
            load4(simd, &out)
        }
    }
}

/// Where the four texels around a position are, and the position between them, 0 to 256.
pub(crate) struct Taps<S: Simd> {
    /// Column of the left ones, and of the right ones.
    pub(crate) columns: [I<S>; 2],
    /// First texel of the upper row, and of the lower.
    pub(crate) rows: [I<S>; 2],
    s: F<S>,
    t: F<S>,
    /// The right ones follow the left ones in memory.
    pub(crate) beside: mask32x16<S>,
}

impl<S: Simd> Taps<S> {
    /// Position between the texels, in 1/256.
    #[inline(always)]
    pub(crate) fn between(&self, simd: S) -> [I<S>; 2] {
        let (scale, half) = (F::splat(simd, 256.0), F::splat(simd, 0.5));
        [(self.s * scale + half).to_int(), (self.t * scale + half).to_int()]
    }

    /// Numbers of the upper left and right texels, and of the lower ones.
    #[inline(always)]
    fn indices(&self) -> [[i32; LANES]; 4] {
        let ([i0, i1], [row0, row1]) = (self.columns, self.rows);
        [(row0 + i0).to_array(), (row0 + i1).to_array(), (row1 + i0).to_array(), (row1 + i1).to_array()]
    }
}

#[inline(always)]
pub(crate) fn taps<S: Simd, const TAME: bool>(
    simd: S,
    sampler: &Sampler,
    level: &TextureLevel,
    uv: [F<S>; 2],
) -> Taps<S> {
    let x = position::<S, TAME>(simd, sampler.grid, uv[0], level.width);
    let y = position::<S, TAME>(simd, sampler.grid, uv[1], level.height);
    let (fx, fy) = (x.floor(), y.floor());
    let (i, j): (I<S>, I<S>) = (fx.to_int(), fy.to_int());
    let one = I::splat(simd, 1);
    let i0 = wrapped(simd, sampler.wrap_u, i, level.width);
    let i1 = wrapped(simd, sampler.wrap_u, i + one, level.width);
    let width = I::splat(simd, level.width as i32);
    let row0 = wrapped(simd, sampler.wrap_v, j, level.height) * width;
    let row1 = wrapped(simd, sampler.wrap_v, j + one, level.height) * width;
    Taps { columns: [i0, i1], rows: [row0, row1], s: x - fx, t: y - fy, beside: i1.simd_eq(i0 + one) }
}

#[inline(always)]
fn bilinear<S: Simd>(simd: S, level: &TextureLevel, taps: &Taps<S>) -> Rgba<S> {
    let ([i0, i1], [row0, row1]) = (taps.columns, taps.rows);
    match &level.texels {
        Texels::Rgba8(_) | Texels::Shared(_) => {
            let texels = level.texels.rgba8().unwrap_or_default();
            let upper = [gather(simd, texels, row0 + i0), gather(simd, texels, row0 + i1)];
            let lower = [gather(simd, texels, row1 + i0), gather(simd, texels, row1 + i1)];
            mixed(simd, [upper, lower], taps.between(simd))
        }
        Texels::Srgb8(texels) => {
            let mut out = [[[0f32; LANES]; 4]; 4];
            for (out, index) in out.iter_mut().zip(&taps.indices()) {
                gather_light(texels, index, out);
            }
            mixed_light(simd, &out, taps)
        }
        Texels::Rgba32F(texels) => {
            let mut out = [[[0f32; LANES]; 4]; 4];
            for (out, index) in out.iter_mut().zip(&taps.indices()) {
                gather_planes(texels, index, out);
            }
            mixed_light(simd, &out, taps)
        }
    }
}

/// Mean of four texels in floating point: upper left and right, lower left and right.
#[inline(always)]
fn mixed_light<S: Simd>(simd: S, texels: &[[[f32; LANES]; 4]; 4], taps: &Taps<S>) -> Rgba<S> {
    let upper = lerp(load4(simd, &texels[0]), load4(simd, &texels[1]), taps.s);
    let lower = lerp(load4(simd, &texels[2]), load4(simd, &texels[3]), taps.s);
    lerp(upper, lower, taps.t)
}

/// Texels beside each other, by lane: upper rows, then lower.
pub(crate) type Quads = [[[[u32; 2]; LANES / 2]; 2]; 2];

/// Upper left and right, lower left and right.
#[inline(always)]
pub(crate) fn quads<S: Simd>(simd: S, from: &Quads) -> [[u32x16<S>; 2]; 2] {
    let a = u32x16::from_slice(simd, from[0][0].as_flattened());
    let b = u32x16::from_slice(simd, from[0][1].as_flattened());
    let c = u32x16::from_slice(simd, from[1][0].as_flattened());
    let d = u32x16::from_slice(simd, from[1][1].as_flattened());
    [[a.unzip_low(b), a.unzip_high(b)], [c.unzip_low(d), c.unzip_high(d)]]
}

/// Mean of four texels, weighted by the position between them.
#[inline(always)]
fn mixed<S: Simd>(simd: S, texels: [[u32x16<S>; 2]; 2], between: [I<S>; 2]) -> Rgba<S> {
    let [rb, ga] = sums(simd, texels, between);
    [low(simd, rb), low(simd, ga), low(simd, rb >> 16), low(simd, ga >> 16)]
}

/// 256 times the mean of four texels, weighted by the position between them: red in the lower half and
/// blue in the upper; green and alpha.
#[inline(always)]
pub(crate) fn sums<S: Simd>(
    simd: S,
    [[t00, t10], [t01, t11]]: [[u32x16<S>; 2]; 2],
    [s, t]: [I<S>; 2],
) -> [u32x16<S>; 2] {
    let w11 = (s * t + I::splat(simd, 128)) >> 8;
    let weights = [I::splat(simd, 256) - s - t + w11, s - w11, t - w11, w11];
    let texels = [t00, t10, t01, t11];
    let mask = u32x16::splat(simd, 0x00ff_00ff);
    // Two channels to a word: sums stay below 2^16 each.
    let mut rb = u32x16::splat(simd, 0);
    let mut ga = u32x16::splat(simd, 0);
    for k in 0..4 {
        let w: u32x16<S> = weights[k].bitcast();
        rb += (texels[k] & mask) * w;
        ga += ((texels[k] >> 8) & mask) * w;
    }
    [rb, ga]
}

/// The lower half of one of [`sums`], as a number 0 to 1.
#[inline(always)]
pub(crate) fn low<S: Simd>(simd: S, v: u32x16<S>) -> F<S> {
    let int: I<S> = (v & u32x16::splat(simd, 0xffff)).bitcast();
    int.to_float::<F<S>>() * F::splat(simd, 1.0 / (255.0 * 256.0))
}

#[inline(always)]
fn gather<S: Simd>(simd: S, texels: &[[u8; 4]], index: I<S>) -> u32x16<S> {
    let mut out = [0u32; LANES];
    gather_words(texels, &index.to_array(), &mut out);
    u32x16::load_array(simd, out)
}

// The loops below go through memory on purpose: inlined into vector code, every index is taken out of
// its register and every texel put into one, lane by lane, at twice the cost.

#[inline(never)]
pub(crate) fn gather_words(texels: &[[u8; 4]], index: &[i32; LANES], out: &mut [u32; LANES]) {
    for (to, &i) in out.iter_mut().zip(index) {
        *to = u32::from_le_bytes(texels.get(i as u32 as usize).copied().unwrap_or_default());
    }
}

/// Texels and those after them; 0 where there are none.
#[inline(never)]
pub(crate) fn pair_texels(texels: &[[u8; 4]], index: &[[i32; LANES]; 2], out: &mut Quads) {
    for (to, &i) in out.as_flattened_mut().as_flattened_mut().iter_mut().zip(index.as_flattened()) {
        let i = i as u32 as usize;
        if let Some(&[a, b]) = texels.get(i..i + 2) {
            *to = [u32::from_le_bytes(a), u32::from_le_bytes(b)];
        }
    }
}

#[inline(always)]
pub(crate) fn load4<S: Simd>(simd: S, planes: &[[f32; LANES]; 4]) -> Rgba<S> {
    [
        F::load_array_ref(simd, &planes[0]),
        F::load_array_ref(simd, &planes[1]),
        F::load_array_ref(simd, &planes[2]),
        F::load_array_ref(simd, &planes[3]),
    ]
}

#[inline(never)]
fn gather_planes(texels: &[[f32; 4]], index: &[i32; LANES], out: &mut [[f32; LANES]; 4]) {
    for (k, &i) in index.iter().enumerate() {
        let texel = texels.get(i as usize).copied().unwrap_or_default();
        for (plane, v) in out.iter_mut().zip(texel) {
            plane[k] = v;
        }
    }
}

#[inline(never)]
fn gather_light(texels: &[[u8; 4]], index: &[i32; LANES], out: &mut [[f32; LANES]; 4]) {
    let table = SrgbTable::get();
    for (k, &i) in index.iter().enumerate() {
        let texel = light_of(table, texels.get(i as usize).copied().unwrap_or_default());
        for (plane, v) in out.iter_mut().zip(texel) {
            plane[k] = v;
        }
    }
}
