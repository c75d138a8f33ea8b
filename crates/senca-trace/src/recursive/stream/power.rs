//! Powers of eight numbers at once, for highlights.

use fearless_simd::{Simd, i64x8, prelude::*};

use crate::lanes::F;

/// Exponents of two beyond count as this: what is left is far below what single precision holds.
const FARTHEST: f64 = 900.0;

/// `base^exponent` for bases of at least 0, to about 1e-9 of the result for exponents up to 1000. 0
/// where the base is 0 or the result is below 2^-900; 1 for the exponent 0 of a base above 0.
///
/// The logarithm is the series of the area tangent around 1, the exponential that of Taylor around 0.
#[inline(always)]
pub(super) fn power<S: Simd>(simd: S, base: F<S>, exponent: F<S>) -> F<S> {
    let one = F::splat(simd, 1.0);
    let positive = base.simd_gt(F::splat(simd, 1e-300));

    // 1. base = m 2^e with m from sqrt(1/2) to sqrt(2).
    let bits: i64x8<S> = base.bitcast();
    let shifted = bits - i64x8::splat(simd, SQRT_HALF_BITS);
    let e = shifted >> 52;
    let m: F<S> = (bits - (e << 52)).bitcast();
    let e: F<S> = e.to_float();

    // 2. log2(m) = 2 / ln 2 * (s + s^3 / 3 + s^5 / 5 ...), s = (m - 1) / (m + 1).
    let s = (m - one) / (m + one);
    let s2 = s * s;
    let mut series = F::splat(simd, 1.0 / 13.0);
    for odd in [11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        series = series * s2 + F::splat(simd, 1.0 / odd);
    }
    let log = e + F::splat(simd, 2.0 * std::f64::consts::LOG2_E) * s * series;

    // 3. 2^y = 2^i 2^f with f from -1/2 to 1/2.
    let y = exponent * log;
    let possible = y.simd_gt(F::splat(simd, -FARTHEST)) & y.simd_lt(F::splat(simd, FARTHEST));
    let y = possible.select(y, F::splat(simd, 0.0));
    let i = y.round_ties_even();
    let f = (y - i) * F::splat(simd, std::f64::consts::LN_2);
    let mut series = F::splat(simd, 1.0 / 9.0) * f + one;
    for n in [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        series = F::splat(simd, 1.0 / n) * f * series + one;
    }
    let i: i64x8<S> = i.to_int();
    let scale: F<S> = ((i + i64x8::splat(simd, 1023)) << 52).bitcast();
    (positive & possible).select(series * scale, F::splat(simd, 0.0))
}

/// The bits of the largest number below sqrt(1/2) or of itself.
const SQRT_HALF_BITS: i64 = std::f64::consts::FRAC_1_SQRT_2.to_bits() as i64;

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    fn of(base: f64, exponent: f64) -> f64 {
        let level = Level::new();
        dispatch!(level, simd => {
            power(simd, F::splat(simd, base), F::splat(simd, exponent)).to_array()[3]
        })
    }

    #[test]
    fn powers_are_those_of_the_library() {
        for exponent in [0.0, 0.5, 1.0, 2.0, 25.0, 100.0, 999.5] {
            for i in 1..2000 {
                let base = f64::from(i) / 1000.0;
                let (found, expected) = (of(base, exponent), base.powf(exponent));
                if exponent * base.log2() > -FARTHEST && exponent * base.log2() < FARTHEST {
                    let error = (found / expected - 1.0).abs();
                    assert!(error < 1e-9 * exponent.max(1.0), "{base}^{exponent}: {found} {expected}");
                }
            }
            assert_eq!(of(0.0, exponent), 0.0);
        }
        assert_eq!(of(1.0, 25.0), 1.0);
        assert_eq!(of(0.001, 1000.0), 0.0);
    }
}
