//! Components of pixels to numbers and back.

use super::PixelType;

/// Clamps to [0, 1]; not-a-number becomes 0.
#[inline]
#[expect(clippy::manual_clamp, reason = "NaN becomes 0")]
pub(super) fn unit(value: f32) -> f32 {
    value.max(0.0).min(1.0)
}

/// The 8-bit form of a value, clamped to [0, 1] and rounded to the nearest of 256 steps.
#[inline]
#[must_use]
pub fn unorm8_from_f32(value: f32) -> u8 {
    (unit(value) * 255.0 + 0.5) as u8
}

/// The nearest half float, ties to even; what is too large becomes infinite.
///
/// Source: IEEE 754-2008, binary16.
#[must_use]
pub fn f16_from_f32(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16) as u16 & 0x8000;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude > 0x7f80_0000 {
        return sign | 0x7e00; // not a number
    }
    if magnitude >= 0x477f_f000 {
        return sign | 0x7c00; // rounds to 65536 or more
    }
    if magnitude < 0x3880_0000 {
        // Below the smallest normal half: adding 1/2 leaves multiples of 2^-24 in the lower bits, rounded.
        let shifted = f32::from_bits(magnitude) + 0.5;
        return sign | (shifted.to_bits() - 0.5_f32.to_bits()) as u16;
    }
    let odd = (magnitude >> 13) & 1;
    let rounded = magnitude + 0xfff + odd - ((127 - 15) << 23);
    sign | (rounded >> 13) as u16
}

/// The value of a half float, exactly.
#[must_use]
pub fn f32_from_f16(half: u16) -> f32 {
    let sign = u32::from(half & 0x8000) << 16;
    let magnitude = u32::from(half & 0x7fff);
    let value = match magnitude >> 10 {
        0 => magnitude as f32 * 2.0_f32.powi(-24),
        31 => f32::from_bits(0x7f80_0000 | (magnitude << 13)),
        _ => f32::from_bits((magnitude << 13) + ((127 - 15) << 23)),
    };
    f32::from_bits(value.to_bits() | sign)
}

/// Words of `N` bytes in the order of the machine, turned round if `swap`.
fn words<const N: usize>(bytes: &[u8], swap: bool) -> impl Iterator<Item = [u8; N]> + '_ {
    bytes.as_chunks::<N>().0.iter().map(move |word| {
        let mut word = *word;
        if swap {
            word.reverse();
        }
        word
    })
}

fn fill<I: Iterator<Item = f32>>(out: &mut [f32], values: I) {
    for (out, value) in out.iter_mut().zip(values) {
        *out = value;
    }
}

/// Elements of an unpacked type as the values they stand for: unsigned integers c as c / (2^b - 1), signed ones
/// as (2c + 1) / (2^b - 1), floats as they are.
///
/// Source: OpenGL 1.5, section 2.14, table 2.9.
pub(super) fn values(ty: PixelType, bytes: &[u8], swap: bool, out: &mut [f32]) {
    const U32_STEP: f64 = 1.0 / u32::MAX as f64;
    let u16s = || words::<2>(bytes, swap).map(u16::from_ne_bytes);
    let u32s = || words::<4>(bytes, swap).map(u32::from_ne_bytes);
    match ty {
        PixelType::U8 => fill(out, bytes.iter().map(|&c| f32::from(c) / 255.0)),
        PixelType::I8 => fill(out, bytes.iter().map(|&c| (2.0 * f32::from(c.cast_signed()) + 1.0) / 255.0)),
        PixelType::U16 => fill(out, u16s().map(|c| f32::from(c) / 65535.0)),
        PixelType::I16 => fill(out, u16s().map(|c| (2.0 * f32::from(c.cast_signed()) + 1.0) / 65535.0)),
        PixelType::U32 => fill(out, u32s().map(|c| (f64::from(c) * U32_STEP) as f32)),
        PixelType::I32 => {
            fill(out, u32s().map(|c| ((2.0 * f64::from(c.cast_signed()) + 1.0) * U32_STEP) as f32));
        }
        PixelType::F32 => fill(out, u32s().map(f32::from_bits)),
        PixelType::F16 => fill(out, u16s().map(f32_from_f16)),
        _ => fill(out, words_of(ty, bytes, swap).map(|c| c as f32)),
    }
}

/// Packed elements, as whole numbers.
fn words_of<'a>(ty: PixelType, bytes: &'a [u8], swap: bool) -> Box<dyn Iterator<Item = u32> + 'a> {
    match ty.element_bytes() {
        1 => Box::new(bytes.iter().map(|&c| u32::from(c))),
        2 => Box::new(words::<2>(bytes, swap).map(|w| u32::from(u16::from_ne_bytes(w)))),
        _ => Box::new(words::<4>(bytes, swap).map(u32::from_ne_bytes)),
    }
}

/// Pixels of a packed colour type as values, component after component.
pub(super) fn packed_values(ty: PixelType, bytes: &[u8], swap: bool, out: &mut [f32]) {
    let Some(fields) = ty.fields() else { return };
    for (pixel, word) in out.chunks_exact_mut(fields.len()).zip(words_of(ty, bytes, swap)) {
        for (value, &(shift, bits)) in pixel.iter_mut().zip(fields) {
            let most = (1_u32 << bits) - 1;
            *value = ((word >> shift) & most) as f32 / most as f32;
        }
    }
}

/// Elements of an unpacked type as indices: integers as they are, floats cut off to integers.
pub(super) fn indices(ty: PixelType, bytes: &[u8], swap: bool, out: &mut [u32]) {
    let u16s = || words::<2>(bytes, swap).map(u16::from_ne_bytes);
    let cut = |value: f32| (value as i64) as u32;
    let mut fill = |values: &mut dyn Iterator<Item = u32>| {
        for (out, value) in out.iter_mut().zip(values) {
            *out = value;
        }
    };
    match ty {
        PixelType::I8 => fill(&mut bytes.iter().map(|&c| i32::from(c.cast_signed()).cast_unsigned())),
        PixelType::I16 => fill(&mut u16s().map(|c| i32::from(c.cast_signed()).cast_unsigned())),
        PixelType::F32 => fill(&mut words::<4>(bytes, swap).map(|w| cut(f32::from_ne_bytes(w)))),
        PixelType::F16 => fill(&mut u16s().map(|c| cut(f32_from_f16(c)))),
        _ => fill(&mut *words_of(ty, bytes, swap)),
    }
}

/// Bits of a bitmap as indices 0 and 1, beginning at pixel `first` of `bytes`.
pub(super) fn bits(bytes: &[u8], first: usize, lsb_first: bool, out: &mut [u32]) {
    for (i, out) in (first..).zip(out) {
        let place = if lsb_first { i % 8 } else { 7 - i % 8 };
        *out = u32::from(bytes[i / 8] >> place & 1);
    }
}

/// Sets bits of a bitmap to the lowest bits of indices; its other bits stay.
pub(super) fn put_bits(bytes: &mut [u8], first: usize, lsb_first: bool, indices: &[u32]) {
    for (i, index) in (first..).zip(indices) {
        let place = if lsb_first { i % 8 } else { 7 - i % 8 };
        bytes[i / 8] = bytes[i / 8] & !(1 << place) | ((index & 1) as u8) << place;
    }
}

fn put_words<const N: usize>(bytes: &mut [u8], swap: bool, words: impl Iterator<Item = [u8; N]>) {
    for (out, mut word) in bytes.as_chunks_mut::<N>().0.iter_mut().zip(words) {
        if swap {
            word.reverse();
        }
        *out = word;
    }
}

/// Writes values as elements of an unpacked type: the way back of [`values`], rounded to the nearest step.
/// Values are expected in [0, 1]; floats are written as they are.
///
/// Source: OpenGL 1.5, section 4.3.2, table 4.9.
pub(super) fn put_values(ty: PixelType, values: &[f32], swap: bool, bytes: &mut [u8]) {
    let round = |value: f32, steps: f64| (f64::from(value) * steps + 0.5) as u32;
    let signed = |value: f32, steps: f64| ((f64::from(value) * steps - 1.0) / 2.0).round() as i32;
    let values = values.iter().copied();
    match ty {
        PixelType::U8 => {
            put_words(bytes, false, values.map(|v| [unorm8_from_f32(v)]));
        }
        PixelType::I8 => {
            put_words(bytes, false, values.map(|v| [(signed(v, 255.0) as i8).cast_unsigned()]));
        }
        PixelType::U16 => {
            put_words(bytes, swap, values.map(|v| ((v * 65535.0 + 0.5) as u16).to_ne_bytes()));
        }
        PixelType::I16 => {
            put_words(bytes, swap, values.map(|v| (signed(v, 65535.0) as i16).to_ne_bytes()));
        }
        PixelType::U32 => {
            put_words(bytes, swap, values.map(|v| round(v, f64::from(u32::MAX)).to_ne_bytes()));
        }
        PixelType::I32 => {
            put_words(bytes, swap, values.map(|v| signed(v, f64::from(u32::MAX)).to_ne_bytes()));
        }
        PixelType::F16 => put_words(bytes, swap, values.map(|v| f16_from_f32(v).to_ne_bytes())),
        _ => put_words(bytes, swap, values.map(f32::to_ne_bytes)),
    }
}

/// Writes whole numbers as packed elements.
fn put_packed(ty: PixelType, bytes: &mut [u8], swap: bool, words: impl Iterator<Item = u32>) {
    match ty.element_bytes() {
        1 => put_words(bytes, false, words.map(|w| [w as u8])),
        2 => put_words(bytes, swap, words.map(|w| (w as u16).to_ne_bytes())),
        _ => put_words(bytes, swap, words.map(u32::to_ne_bytes)),
    }
}

/// Writes values in [0, 1], component after component, as pixels of a packed colour type.
pub(super) fn put_packed_values(ty: PixelType, values: &[f32], swap: bool, bytes: &mut [u8]) {
    let Some(fields) = ty.fields() else { return };
    let word = |pixel: &[f32]| {
        pixel.iter().zip(fields).fold(0, |word, (value, &(shift, bits))| {
            let most = ((1_u32 << bits) - 1) as f32;
            word | ((value * most + 0.5) as u32) << shift
        })
    };
    put_packed(ty, bytes, swap, values.chunks_exact(fields.len()).map(word));
}

/// Writes indices as elements of an unpacked type: integers by their lower bits, floats by their value.
pub(super) fn put_indices(ty: PixelType, indices: &[u32], swap: bool, bytes: &mut [u8]) {
    let indices = indices.iter().copied();
    match ty {
        PixelType::F32 => put_words(bytes, swap, indices.map(|i| (i as f32).to_ne_bytes())),
        PixelType::F16 => put_words(bytes, swap, indices.map(|i| f16_from_f32(i as f32).to_ne_bytes())),
        _ => put_packed(ty, bytes, swap, indices),
    }
}

/// Depths, and stencil values, of elements that hold both.
pub(super) fn depth_stencils(ty: PixelType, bytes: &[u8], swap: bool, mut each: impl FnMut(usize, f32, u8)) {
    let mut words = words::<4>(bytes, swap).map(u32::from_ne_bytes);
    let mut i = 0;
    while let Some(word) = words.next() {
        if ty == PixelType::U32x248 {
            each(i, depth_from_24(word >> 8), word as u8);
        } else {
            each(i, f32::from_bits(word), words.next().unwrap_or(0) as u8);
        }
        i += 1;
    }
}

/// Writes depths in [0, 1] and stencil values as elements that hold both.
pub(super) fn put_depth_stencils(ty: PixelType, depth: &[f32], stencil: &[u8], swap: bool, bytes: &mut [u8]) {
    let pairs = depth.iter().zip(stencil);
    if ty == PixelType::U32x248 {
        let word = |(&d, &s): (&f32, &u8)| (depth_to_24(d) << 8 | u32::from(s)).to_ne_bytes();
        put_words(bytes, swap, pairs.map(word));
    } else {
        let words = pairs.flat_map(|(d, &s)| [d.to_ne_bytes(), u32::from(s).to_ne_bytes()]);
        put_words(bytes, swap, words);
    }
}

/// Steps of a depth of 24 bits.
const DEPTH_24_STEPS: f64 = 0xff_ffff as f64;

fn depth_from_24(depth: u32) -> f32 {
    (f64::from(depth) / DEPTH_24_STEPS) as f32
}

fn depth_to_24(depth: f32) -> u32 {
    (f64::from(unit(depth)) * DEPTH_24_STEPS + 0.5) as u32
}
