//! Fixed-point numbers in 32 bits: what the 1995 library calculates with where there is no FPU.
//!
//! A number is an integer that counts steps of `2^-P`. The rules, all without a panic:
//!
//! 1. Adding, subtracting and changing the sign wrap around, as two's complement does by dropping the carry.
//! 2. A product has the fraction digits of both factors, so it is shifted right by `P`. The shift is arithmetic and
//!    rounds towards minus infinity.
//! 3. A quotient has none, so the dividend is shifted left by `P` first. The division truncates towards zero.
//! 4. `*` and [`Fixed::quotient`] take 64 bits in between and end at the largest number when the result has no place.
//!    The forms of plain C, [`Fixed::product_in_32_bits`] and [`Fixed::quotient_in_32_bits`], lose the upper half of
//!    what is in between.
//!
//! Source: Savchenko 1995, "fixed point math" and "multiplication of fixed point numbers".

use std::ops::{Add, Mul, Neg, Sub};

/// Fraction bits of the tables of sines and of the rotation (`T_P`).
pub const ROTATION_BITS: u32 = 10;

/// A signed fixed-point number with `P` fraction bits, 0 to 30 (`fixed`).
///
/// Its range is `-2^(31-P)` to `2^(31-P) - 2^-P`, its step `2^-P`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fixed<const P: u32 = ROTATION_BITS>(i32);

impl<const P: u32> Fixed<P> {
    const BITS_FIT: () = assert!(P <= 30, "a fixed-point number has 0 to 30 fraction bits");

    /// The number of so many steps.
    #[must_use]
    pub const fn from_steps(steps: i32) -> Self {
        () = Self::BITS_FIT;
        Self(steps)
    }

    /// How many steps it has.
    #[must_use]
    pub const fn steps(self) -> i32 {
        self.0
    }

    /// A whole number; the largest or smallest where it has no place.
    #[must_use]
    pub fn from_int(n: i32) -> Self {
        Self(saturate(i64::from(n) << P))
    }

    /// `a` by trying the halves, quarters and so on in turn (`TI_float2fixed`).
    ///
    /// For `|a| <= 1`. The magnitude is cut towards zero, and since no integer bit is ever set, 1 becomes
    /// `1 - 2^-P`, as does everything above. What is not a number becomes 0.
    #[must_use]
    pub fn from_unit(a: f64) -> Self {
        let mut rest = a.abs();
        let mut steps = 0;
        let mut weight = 0.5;
        for digit in (0..P).rev() {
            if rest >= weight {
                rest -= weight;
                steps |= 1 << digit;
            }
            weight /= 2.0;
        }
        Self(if a < 0.0 { -steps } else { steps })
    }

    /// The value.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        f64::from(self.0) / (1u64 << P) as f64
    }

    /// The product by plain C: the factors are multiplied in 32 bits, so that with 16 fraction bits the whole integer
    /// part is lost.
    #[must_use]
    pub const fn product_in_32_bits(self, other: Self) -> Self {
        Self(self.0.wrapping_mul(other.0) >> P)
    }

    /// The quotient, cut towards zero; `None` for a divisor of 0.
    #[must_use]
    pub fn quotient(self, divisor: Self) -> Option<Self> {
        (i64::from(self.0) << P).checked_div(i64::from(divisor.0)).map(|q| Self(saturate(q)))
    }

    /// The quotient by plain C: the dividend is shifted in 32 bits; `None` for a divisor of 0.
    #[must_use]
    pub const fn quotient_in_32_bits(self, divisor: Self) -> Option<Self> {
        if divisor.0 == 0 { None } else { Some(Self(self.0.wrapping_shl(P).wrapping_div(divisor.0))) }
    }

    /// This coefficient times a whole coordinate, as a whole coordinate.
    #[must_use]
    pub fn times_int(self, coordinate: i32) -> i32 {
        saturate((i64::from(self.0) * i64::from(coordinate)) >> P)
    }

    /// [`Fixed::times_int`] by plain C, in 32 bits: right while `|coefficient * coordinate|` is below `2^31`, which is
    /// coordinates to about `2^21` for a sine with 10 fraction bits.
    #[must_use]
    pub const fn times_int_in_32_bits(self, coordinate: i32) -> i32 {
        self.0.wrapping_mul(coordinate) >> P
    }
}

/// `n`, or what is nearest to it in 32 bits.
pub(crate) fn saturate(n: i64) -> i32 {
    n.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

impl<const P: u32> Add for Fixed<P> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl<const P: u32> Sub for Fixed<P> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl<const P: u32> Neg for Fixed<P> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

impl<const P: u32> Mul for Fixed<P> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(saturate((i64::from(self.0) * i64::from(other.0)) >> P))
    }
}

/// A way to read a pattern of bits as a number: two's complement with a binary point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedFormat {
    /// Bits of the pattern, 1 to 32.
    pub bits: u32,
    /// How many of them stand behind the binary point, at most `bits`.
    pub fraction_bits: u32,
}

impl FixedFormat {
    /// The value of a pattern: the top bit counts negatively. Bits above the format's are dropped.
    #[must_use]
    pub fn value(self, pattern: u32) -> f64 {
        let unused = 32 - self.bits.clamp(1, 32);
        let integer = (pattern << unused).cast_signed() >> unused;
        f64::from(integer) * self.step()
    }

    /// The distance between neighbouring numbers.
    #[must_use]
    pub fn step(self) -> f64 {
        (-f64::from(self.fraction_bits)).exp2()
    }

    /// The smallest and the largest number.
    #[must_use]
    pub fn range(self) -> [f64; 2] {
        let top = 1 << (self.bits.clamp(1, 32) - 1);
        [self.value(top), self.value(top - 1)]
    }
}

/// The value of digits by their positions, such as `"100.11"` with radix 2; `None` where a digit is none of the radix,
/// 2 to 36.
#[must_use]
pub fn positional_value(digits: &str, radix: u32) -> Option<f64> {
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    if !(2..=36).contains(&radix) || (whole.is_empty() && fraction.is_empty()) {
        return None;
    }
    let digit = |c: char| c.to_digit(radix).map(f64::from);
    let mut value = 0.0;
    for c in whole.chars() {
        value = value * f64::from(radix) + digit(c)?;
    }
    let mut part = 0.0;
    for c in fraction.chars().rev() {
        part = (part + digit(c)?) / f64::from(radix);
    }
    Some(value + part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type F = Fixed<10>;

    #[test]
    fn digits_count_by_their_positions() {
        let value = |digits, radix| positional_value(digits, radix).expect("digits");
        assert_eq!(value("102", 10), 100.0 + 0.0 + 2.0);
        assert_eq!(value("10001", 2), 17.0);
        assert_eq!(value("102.15", 10), 102.0 + 15.0 / 100.0);
        assert_eq!(value("100.11", 2), 4.75);
        assert_eq!(value("0.99", 10), 0.99);
        assert_eq!(value("0.01", 2), 0.25);
        assert_eq!(value("0.1111", 2), 15.0 / 16.0);
        assert!(["", ".", "2", "1.2", "-1"].iter().all(|d| positional_value(d, 2).is_none()));
        // Two decimals: 1.52 * 11 is 16.72, and 16 once two digits are dropped.
        assert_eq!([152 * 11, 152 * 11 / 100], [1672, 16]);
    }

    #[test]
    fn patterns_are_twos_complement() {
        let five = FixedFormat { bits: 5, fraction_bits: 0 };
        assert_eq!(five.value(0b11111), -1.0);
        assert_eq!(five.value(0b10000), -16.0);
        assert_eq!(five.range(), [-16.0, 15.0]);
        assert_eq!(five.value(0b11111 + 1), 0.0, "the carry is dropped");
        let unit = FixedFormat { bits: 5, fraction_bits: 4 };
        assert_eq!(unit.range(), [-1.0, 15.0 / 16.0]);
        assert_eq!(FixedFormat { bits: 8, fraction_bits: 2 }.step(), 0.25);
        assert_eq!(FixedFormat { bits: 16, fraction_bits: 15 }.range()[0], -1.0);
        // 16 fraction bits and the sign leave 15 integer bits.
        assert_eq!(FixedFormat { bits: 32, fraction_bits: 16 }.range()[0], -32768.0);
    }

    #[test]
    fn fractions_are_cut_bit_by_bit() {
        let cut = |a| Fixed::<10>::from_unit(a).steps();
        let expected = [
            (0.0, 0),
            (1.0, 1023),
            (-1.0, -1023),
            (0.5, 512),
            (-0.5, -512),
            (0.999, 1022),
            (std::f64::consts::FRAC_1_SQRT_2, 724),
            (1.0 / 3.0, 341),
            (0.00097, 0),
            (0.000977, 1),
            (1.5, 1023),
            (f64::INFINITY, 1023),
            (f64::NAN, 0),
        ];
        expected.iter().for_each(|&(a, steps)| assert_eq!(cut(a), steps, "{a}"));
    }

    #[test]
    fn products_round_down_and_quotients_to_zero() {
        let (one, three) = (F::from_int(1), F::from_int(3));
        assert_eq!(F::from_steps(1023) * F::from_steps(1023), F::from_steps(1022));
        assert_eq!((F::from_steps(-1) * F::from_steps(1)).steps(), -1);
        assert_eq!(one.quotient(three).map(Fixed::steps), Some(341));
        assert_eq!((-one).quotient(three).map(Fixed::steps), Some(-341));
        assert_eq!(one.quotient(F::default()), None);
        assert_eq!(one.quotient_in_32_bits(F::default()), None);
        assert_eq!(F::from_steps(724).times_int(-100), -71);
    }

    #[test]
    fn plain_c_loses_the_integer_part() {
        // With 16 fraction bits 2 * 3 is 2^33: nothing is left of it in 32 bits.
        let (two, three) = (Fixed::<16>::from_int(2), Fixed::<16>::from_int(3));
        assert_eq!(two.product_in_32_bits(three).steps(), 0);
        assert_eq!(two * three, Fixed::from_int(6));
        // A sine of 1023 / 1024 takes coordinates to about 2^21.
        let sine = F::from_steps(1023);
        let last = i32::MAX / 1023;
        assert_eq!(sine.times_int_in_32_bits(last), sine.times_int(last));
        assert_ne!(sine.times_int_in_32_bits(last + 1), sine.times_int(last + 1));
        assert!((1 << 21..1 << 22).contains(&last));
    }

    #[test]
    fn what_has_no_place_ends_at_the_largest() {
        let large = F::from_steps(i32::MAX);
        assert_eq!(large * large, large);
        assert_eq!((large * F::from_steps(i32::MIN)).steps(), i32::MIN);
        assert_eq!(F::from_int(i32::MIN).steps(), i32::MIN);
        assert_eq!(large.quotient(F::from_steps(1)), Some(large));
        let lowest = F::from_steps(i32::MIN);
        assert_eq!(lowest.quotient(F::from_steps(-1)), Some(large));
        assert_eq!(
            Fixed::<0>::from_steps(i32::MIN).quotient_in_32_bits(Fixed::from_steps(-1)).map(Fixed::steps),
            Some(i32::MIN)
        );
        assert_eq!(-lowest, lowest);
    }

    proptest! {
        #[test]
        fn arithmetic_is_that_of_reals_within_a_step(a in -1_000_000i32..1_000_000, b in -1_000_000i32..1_000_000) {
            let (x, y) = (F::from_steps(a), F::from_steps(b));
            let product = (x * y).to_f64() - x.to_f64() * y.to_f64();
            prop_assert!(product <= 0.0 && product > -1.0 / 1024.0);
            if let Some(q) = x.quotient(y) {
                let exact = x.to_f64() / y.to_f64();
                let off = exact - q.to_f64();
                prop_assert!(off.abs() < 1.0 / 1024.0 || exact.abs() > 2_097_151.0);
                prop_assert!(off * exact >= 0.0);
            }
        }
    }
}
