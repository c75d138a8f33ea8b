//! Blending, and packing to 8 bits, sixteen pixels at a time. The plain twin is in [`crate::pixel`].

use crate::api::{Blend, Factor};
use fearless_simd::{Simd, f32x16, i32x16, prelude::*, u8x64, u32x16};

/// Red, green, blue, alpha of 16 pixels.
pub(crate) type Rgba<S> = [f32x16<S>; 4];

/// 8-bit colour as numbers 0 to 1.
#[inline(always)]
pub(crate) fn unpack<S: Simd>(simd: S, packed: u32x16<S>) -> Rgba<S> {
    [
        channel(simd, packed),
        channel(simd, packed >> 8),
        channel(simd, packed >> 16),
        channel(simd, packed >> 24),
    ]
}

/// The low bytes, as numbers 0 to 1.
#[inline(always)]
pub(crate) fn channel<S: Simd>(simd: S, packed: u32x16<S>) -> f32x16<S> {
    let byte = packed & u32x16::splat(simd, 255);
    let float: f32x16<S> = byte.bitcast::<i32x16<S>>().to_float();
    float * f32x16::splat(simd, 1.0 / 255.0)
}

/// Clamped to [0, 1] and rounded to 8 bits, red in the low byte; NaN becomes 0.
#[inline(always)]
pub(crate) fn pack<S: Simd>(simd: S, rgba: Rgba<S>) -> u32x16<S> {
    let [r, g, b, a] = rgba;
    byte(simd, r) | (byte(simd, g) << 8) | (byte(simd, b) << 16) | (byte(simd, a) << 24)
}

/// [`pack`] of numbers that clamping would not change, or by less than rounding does.
#[inline(always)]
pub(crate) fn pack_tame<S: Simd>(simd: S, [r, g, b, a]: Rgba<S>) -> u32x16<S> {
    rounded(simd, r) | (rounded(simd, g) << 8) | (rounded(simd, b) << 16) | (rounded(simd, a) << 24)
}

/// One channel of [`pack`], in the low byte.
#[inline(always)]
pub(crate) fn byte<S: Simd>(simd: S, v: f32x16<S>) -> u32x16<S> {
    let clamped = v.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, 1.0));
    rounded(simd, clamped)
}

/// [`Blend::ADD`] of packed colours.
#[inline(always)]
pub(crate) fn sum_of_bytes<S: Simd>(simd: S, a: u32x16<S>, b: u32x16<S>) -> u32x16<S> {
    let (a, b): (u8x64<S>, u8x64<S>) = (a.bitcast(), b.bitcast());
    simd.saturating_add_u8x64(a, b).bitcast()
}

#[inline(always)]
fn rounded<S: Simd>(simd: S, v: f32x16<S>) -> u32x16<S> {
    let int: i32x16<S> = (v * f32x16::splat(simd, 255.0) + f32x16::splat(simd, 0.5)).to_int();
    int.bitcast::<u32x16<S>>()
}

/// New and old colour, mixed.
#[inline(always)]
pub(crate) fn blended<S: Simd>(simd: S, blend: Blend, new: Rgba<S>, old: Rgba<S>) -> Rgba<S> {
    let (s, d) = (factor(simd, blend.source, new, old), factor(simd, blend.destination, new, old));
    [
        new[0] * s[0] + old[0] * d[0],
        new[1] * s[1] + old[1] * d[1],
        new[2] * s[2] + old[2] * d[2],
        new[3] * s[3] + old[3] * d[3],
    ]
}

#[inline(always)]
fn factor<S: Simd>(simd: S, factor: Factor, new: Rgba<S>, old: Rgba<S>) -> Rgba<S> {
    let one = f32x16::splat(simd, 1.0);
    match factor {
        Factor::Zero => [f32x16::splat(simd, 0.0); 4],
        Factor::One => [one; 4],
        Factor::SourceColor => new,
        Factor::OneMinusSourceColor => inverse(simd, new),
        Factor::DestinationColor => old,
        Factor::OneMinusDestinationColor => inverse(simd, old),
        Factor::SourceAlpha => [new[3]; 4],
        Factor::OneMinusSourceAlpha => [one - new[3]; 4],
        Factor::DestinationAlpha => [old[3]; 4],
        Factor::OneMinusDestinationAlpha => [one - old[3]; 4],
        Factor::SourceAlphaSaturate => {
            let least = new[3].min(one - old[3]);
            [least, least, least, one]
        }
    }
}

#[inline(always)]
fn inverse<S: Simd>(simd: S, v: Rgba<S>) -> Rgba<S> {
    let one = f32x16::splat(simd, 1.0);
    [one - v[0], one - v[1], one - v[2], one - v[3]]
}
