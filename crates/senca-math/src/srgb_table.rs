//! sRGB of 8 bits to light and back by one table look-up.
//!
//! The codes 0 to 255 divide the floats in [0, 1] into 256 ranges. Cut by the top bits of its
//! exponent and mantissa, the same interval falls into buckets narrow enough that none holds more
//! than one border; so the code of the bucket's start, plus one when the value has reached the
//! border in it, is the code. The borders come from [`LinearRgb::to_srgb8`] itself, so the two agree
//! by construction; the tests check the floats around every border.

use std::sync::LazyLock;

use crate::LinearRgb;
use crate::color::linear_from_srgb;

/// Mantissa bits that choose a bucket. Near 1 neighbouring borders are 0.9 % apart and buckets
/// 0.4 % wide; with 6 bits some buckets would hold two borders.
const MANTISSA_BITS: u32 = 7;

/// Bits dropped from a float to get its bucket.
const SHIFT: u32 = 23 - MANTISSA_BITS;

/// Smallest value with a bucket of its own; everything below has code 0, as code 1 begins at
/// 1.5e-4.
const SMALLEST: f32 = 1.0 / 8192.0;

const FIRST_BUCKET: u32 = SMALLEST.to_bits() >> SHIFT;
const BUCKETS: usize = ((1.0f32.to_bits() >> SHIFT) - FIRST_BUCKET) as usize + 1;

/// One bucket: the code at its start, and the value from which on the code is one more.
#[derive(Clone, Copy, Default)]
struct Bucket {
    border: f32,
    code: u8,
}

/// The table, of both directions.
pub struct SrgbTable {
    buckets: [Bucket; BUCKETS],
    light: [f32; 256],
}

static TABLE: LazyLock<SrgbTable> = LazyLock::new(SrgbTable::new);

impl SrgbTable {
    /// The table, made on first use.
    #[must_use]
    pub fn get() -> &'static Self {
        &TABLE
    }

    fn new() -> Self {
        let borders: Vec<f32> = (1..=255).map(first_with_code).collect();
        let buckets = std::array::from_fn(|i| {
            let start = f32::from_bits((FIRST_BUCKET + i as u32) << SHIFT);
            let code = code_of(start);
            Bucket { border: borders.get(usize::from(code)).copied().unwrap_or(f32::INFINITY), code }
        });
        let light = std::array::from_fn(|code| linear_from_srgb(code as f32 / 255.0));
        Self { buckets, light }
    }

    /// The light of a code, as [`Srgb8::to_linear`](crate::Srgb8::to_linear) says.
    #[must_use]
    #[inline]
    pub fn decode(&self, code: u8) -> f32 {
        self.light[usize::from(code)]
    }

    /// The 8-bit code of linear `v`, as [`LinearRgb::to_srgb8`] says: clamped to [0, 1], NaN as 0.
    #[must_use]
    #[inline]
    pub fn encode(&self, v: f32) -> u8 {
        // Written so that NaN takes the first branch's value.
        let v = if v > SMALLEST { v } else { SMALLEST };
        let v = if v < 1.0 { v } else { 1.0 };
        let bucket = self.buckets[((v.to_bits() >> SHIFT) - FIRST_BUCKET) as usize];
        bucket.code + u8::from(v >= bucket.border)
    }
}

fn code_of(v: f32) -> u8 {
    LinearRgb::splat(v).to_srgb8().r
}

/// The smallest float whose code is `code` or more, by bisection over the bits.
fn first_with_code(code: u8) -> f32 {
    let (mut below, mut at) = (0.0f32.to_bits(), 1.0f32.to_bits());
    while at - below > 1 {
        let middle = below + (at - below) / 2;
        if code_of(f32::from_bits(middle)) >= code {
            at = middle;
        } else {
            below = middle;
        }
    }
    f32::from_bits(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_agrees_with_the_formula_around_every_border() {
        let table = SrgbTable::get();
        for code in 1..=255 {
            let border = first_with_code(code).to_bits();
            for bits in border - 300..=border + 300 {
                let v = f32::from_bits(bits);
                assert_eq!(table.encode(v), code_of(v), "{v:e} near the border of {code}");
            }
        }
    }

    #[test]
    fn decoding_agrees_with_the_formula() {
        for code in 0..=255u8 {
            let light = SrgbTable::get().decode(code);
            assert_eq!(light, crate::Srgb8 { r: code, g: 0, b: 0 }.to_linear().r);
            assert_eq!(SrgbTable::get().encode(light), code);
        }
    }

    #[test]
    fn no_bucket_holds_two_borders() {
        let buckets: Vec<u32> = (1..=255).map(|code| first_with_code(code).to_bits() >> SHIFT).collect();
        assert!(buckets.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(first_with_code(1) > SMALLEST);
    }

    #[test]
    fn the_table_agrees_with_the_formula_across_the_range_and_outside() {
        let table = SrgbTable::get();
        for bits in (0..f32::INFINITY.to_bits()).step_by(9973) {
            let v = f32::from_bits(bits);
            assert_eq!(table.encode(v), code_of(v), "{v:e}");
            assert_eq!(table.encode(-v), 0);
        }
        assert_eq!(table.encode(f32::NAN), 0);
        assert_eq!(table.encode(f32::INFINITY), 255);
        assert_eq!(table.encode(f32::NEG_INFINITY), 0);
    }
}
