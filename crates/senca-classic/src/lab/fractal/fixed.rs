//! Fixed point numbers of any precision, for places of which the processor's numbers know too little.
//!
//! Orbits stay near the origin until they leave, so a fixed point serves better than a floating one:
//! what matters is how far apart two points are, not how far from 0.

use std::cmp::Ordering;

use super::wide::Wide;

/// A number with 64 bits before the point and any number of limbs of 64 bits behind it.
///
/// Both operands of an operation have the same number of limbs. Results are cut off behind their last
/// limb; what outgrows the 64 bits before the point is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fixed {
    negative: bool,
    /// Limbs of the absolute value, the least first; the last one is the whole part.
    limbs: Vec<u64>,
}

/// Why a text is no number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FixedError {
    /// It is not written as one.
    #[error("'{0}' is not a number; it is written like -1.25 or 3.5e-40")]
    Malformed(String),
    /// It is too large, or has too many digits.
    #[error("'{0}' is out of range: numbers are below 1e9, with exponents from -20000 to 9")]
    Range(String),
}

/// Least exponent of ten of a number in a text.
const LEAST_EXPONENT: i64 = -20_000;

/// A number as it is written: its digits and where the point is.
struct Decimal<'a> {
    negative: bool,
    whole: &'a str,
    fraction: &'a str,
    exponent: i64,
}

impl<'a> Decimal<'a> {
    fn parse(text: &'a str) -> Result<Self, FixedError> {
        let malformed = || FixedError::Malformed(shortened(text));
        let (negative, rest) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let (digits, exponent) = match rest.split_once(['e', 'E']) {
            Some((digits, exponent)) => (digits, exponent.parse().map_err(|_| malformed())?),
            None => (rest, 0),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let only_digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
        if whole.len() + fraction.len() == 0 || !only_digits(whole) || !only_digits(fraction) {
            return Err(malformed());
        }
        let too_long = whole.len() + fraction.len() > 50_000;
        if too_long || !(LEAST_EXPONENT..=9).contains(&exponent) {
            return Err(FixedError::Range(shortened(text)));
        }
        Ok(Self { negative, whole, fraction, exponent })
    }

    /// Digits with the place value 10^-1, 10^-2 and so on, and those before the point, by moving the
    /// point.
    fn split(&self) -> (String, String) {
        let digits = format!("{}{}", self.whole, self.fraction);
        let point = self.whole.len() as i64 + self.exponent;
        if point <= 0 {
            return (String::new(), "0".repeat(point.unsigned_abs() as usize) + &digits);
        }
        let point = point as usize;
        if point >= digits.len() {
            let zeros = "0".repeat(point - digits.len());
            return (digits + &zeros, String::new());
        }
        (digits[..point].to_owned(), digits[point..].to_owned())
    }
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= 40 {
        text.to_owned()
    } else {
        text.chars().take(37).collect::<String>() + "..."
    }
}

impl Fixed {
    /// 0 with `fraction` limbs behind the point.
    #[must_use]
    pub fn zero(fraction: usize) -> Self {
        Self { negative: false, limbs: vec![0; fraction + 1] }
    }

    /// The number that a text writes, such as `-0.75`, `1e-40`, rounded to the last limb.
    ///
    /// # Errors
    /// It is not a number, or out of range.
    pub fn parse(text: &str, fraction: usize) -> Result<Self, FixedError> {
        let decimal = Decimal::parse(text)?;
        let (whole, behind) = decimal.split();
        let whole = whole.trim_start_matches('0');
        let whole: u64 = if whole.is_empty() { 0 } else { whole.parse().unwrap_or(u64::MAX) };
        if whole >= 1_000_000_000 {
            return Err(FixedError::Range(shortened(text)));
        }
        // From the last digit to the first: (digit + what follows) / 10. A spare limb takes the rounding.
        let mut number = Self::zero(fraction + 1);
        for digit in behind.bytes().rev() {
            number.limbs[fraction + 1] = u64::from(digit - b'0');
            number.divide(10);
        }
        number.limbs[fraction + 1] = whole;
        // To the nearest.
        let mut half = Self::zero(fraction + 1);
        half.limbs[0] = 1 << 63;
        number = number.add(&half);
        number.negative = decimal.negative;
        number.resize(fraction);
        Ok(number.normal())
    }

    /// Limbs behind the point that a number's text asks for: all its digits.
    ///
    /// # Errors
    /// It is not a number.
    pub fn limbs_of(text: &str) -> Result<usize, FixedError> {
        let decimal = Decimal::parse(text)?;
        let digits = (decimal.fraction.len() as i64 - decimal.exponent).max(0);
        Ok((digits as f64 * std::f64::consts::LOG2_10 / 64.0).ceil() as usize + 1)
    }

    /// A finite number of the processor below 1e9, cut off behind the last limb.
    #[must_use]
    pub fn from_f64(value: f64, fraction: usize) -> Self {
        Self::from_wide(Wide::new(value), fraction)
    }

    /// A wide number below 1e9, cut off behind the last limb.
    #[must_use]
    pub fn from_wide(value: Wide, fraction: usize) -> Self {
        let mut number = Self::zero(fraction);
        // mantissa 2^exponent with 53 bits before the mantissa's point.
        let (mantissa, exponent) = value.parts();
        let bits = (mantissa.abs() * 2.0_f64.powi(53)) as u64;
        let lowest = exponent - 53 + 64 * fraction as i64;
        for bit in 0..=54 {
            let place = lowest + bit;
            if bits >> bit & 1 == 1 && place >= 0 && (place as usize) < 64 * (fraction + 1) {
                number.limbs[place as usize / 64] |= 1 << (place % 64);
            }
        }
        number.negative = mantissa < 0.0;
        number.normal()
    }

    /// Limbs behind the point.
    #[must_use]
    pub fn fraction(&self) -> usize {
        self.limbs.len() - 1
    }

    /// With another number of limbs behind the point.
    #[must_use]
    pub fn with_fraction(mut self, fraction: usize) -> Self {
        self.resize(fraction);
        self.normal()
    }

    fn resize(&mut self, fraction: usize) {
        let now = self.fraction();
        if fraction < now {
            self.limbs.drain(..now - fraction);
        } else {
            self.limbs.splice(0..0, std::iter::repeat_n(0, fraction - now));
        }
    }

    /// 0 has no sign.
    fn normal(mut self) -> Self {
        self.negative &= self.limbs.iter().any(|&l| l != 0);
        self
    }

    /// `self + other`.
    #[must_use]
    pub fn add(&self, other: &Self) -> Self {
        if self.negative == other.negative {
            let mut sum = self.clone();
            let mut carry = false;
            for (limb, &o) in sum.limbs.iter_mut().zip(&other.limbs) {
                let (a, first) = limb.overflowing_add(o);
                let (b, second) = a.overflowing_add(u64::from(carry));
                (*limb, carry) = (b, first || second);
            }
            return sum;
        }
        match self.compare_absolute(other) {
            Ordering::Less => other.minus_smaller(self),
            _ => self.minus_smaller(other),
        }
    }

    /// `self - other`.
    #[must_use]
    pub fn subtract(&self, other: &Self) -> Self {
        self.add(&other.negated())
    }

    /// `-self`.
    #[must_use]
    pub fn negated(&self) -> Self {
        Self { negative: !self.negative, limbs: self.limbs.clone() }.normal()
    }

    fn compare_absolute(&self, other: &Self) -> Ordering {
        self.limbs.iter().rev().cmp(other.limbs.iter().rev())
    }

    /// Takes off the absolute value of one that is not larger; the sign stays.
    fn minus_smaller(&self, other: &Self) -> Self {
        let mut difference = self.clone();
        let mut borrow = false;
        for (limb, &o) in difference.limbs.iter_mut().zip(&other.limbs) {
            let (a, first) = limb.overflowing_sub(o);
            let (b, second) = a.overflowing_sub(u64::from(borrow));
            (*limb, borrow) = (b, first || second);
        }
        difference.normal()
    }

    /// `self * other`, cut off.
    #[must_use]
    pub fn multiply(&self, other: &Self) -> Self {
        let n = self.limbs.len();
        let mut product = vec![0_u64; 2 * n];
        for (i, &a) in self.limbs.iter().enumerate() {
            if a == 0 {
                continue;
            }
            let mut carry = 0_u128;
            for (j, &b) in other.limbs.iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(product[i + j]) + carry;
                product[i + j] = sum as u64;
                carry = sum >> 64;
            }
            product[i + n] = carry as u64;
        }
        let limbs = product[n - 1..2 * n - 1].to_vec();
        Self { negative: self.negative != other.negative, limbs }.normal()
    }

    /// Twice itself.
    #[must_use]
    pub fn doubled(&self) -> Self {
        self.add(self)
    }

    fn divide(&mut self, divisor: u64) {
        let mut rest = 0_u128;
        for limb in self.limbs.iter_mut().rev() {
            let value = rest << 64 | u128::from(*limb);
            *limb = (value / u128::from(divisor)) as u64;
            rest = value % u128::from(divisor);
        }
    }

    /// The same as a number of the processor with an exponent of its own.
    #[must_use]
    pub fn to_wide(&self) -> Wide {
        let Some(top) = self.limbs.iter().rposition(|&l| l != 0) else { return Wide::ZERO };
        let limb = |i: Option<usize>| i.map_or(0, |i| self.limbs[i]);
        // The upper 64 significant bits.
        let shift = self.limbs[top].leading_zeros();
        let pair = u128::from(self.limbs[top]) << 64 | u128::from(limb(top.checked_sub(1)));
        let bits = (pair << shift >> 64) as u64;
        let exponent = 64 * (top as i64 - self.fraction() as i64) - i64::from(shift);
        let value = Wide::new(bits as f64).times_power(exponent);
        if self.negative { value.negated() } else { value }
    }

    /// The nearest number of the processor, but for the last bit; 0 below its range.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        self.to_wide().to_f64()
    }

    /// Written with so many digits behind the point, rounded.
    #[must_use]
    pub fn to_decimal(&self, digits: usize) -> String {
        let mut half = Self::zero(self.fraction());
        half.limbs[self.fraction()] = 5;
        (0..=digits).for_each(|_| half.divide(10));
        let mut rest = Self { negative: false, ..self.clone() }.add(&half);
        let last = self.fraction();
        let sign = if self.negative { "-" } else { "" };
        let mut text = format!("{sign}{}", rest.limbs[last]);
        if digits > 0 {
            text.push('.');
        }
        for _ in 0..digits {
            rest.limbs[last] = 0;
            let mut carry = 0_u128;
            for limb in &mut rest.limbs {
                let value = u128::from(*limb) * 10 + carry;
                *limb = value as u64;
                carry = value >> 64;
            }
            text.push(char::from(b'0' + rest.limbs[last] as u8));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::{any, prop_assert, prop_assert_eq, proptest};

    use super::*;

    fn fixed(text: &str) -> Fixed {
        Fixed::parse(text, 4).expect(text)
    }

    #[test]
    fn texts_are_read_and_written() {
        assert_eq!(fixed("-1.25").to_decimal(3), "-1.250");
        assert_eq!(fixed("+12.5e-3").to_decimal(6), "0.012500");
        assert_eq!(fixed("1e-40").to_decimal(41), "0.00000000000000000000000000000000000000010");
        assert_eq!(fixed("1.5e3").to_f64(), 1500.0);
        assert_eq!(fixed(".5").to_f64(), 0.5);
        assert_eq!(fixed("-0"), Fixed::zero(4));
        let pi = "3.14159265358979323846264338327950288419716939937510";
        assert!(Fixed::parse(pi, 4).expect("a number").to_decimal(49).starts_with(&pi[..50]));
        for wrong in ["", ".", "-", "1.2.3", "1e", "0x10", "1e5.5", "--1", "ä", "inf", "nan"] {
            assert_eq!(Fixed::parse(wrong, 2), Err(FixedError::Malformed(wrong.to_owned())), "{wrong}");
        }
        for wrong in ["1e9", "1000000000", "1e10", "1e-20001", "99999999999999999999999"] {
            assert_eq!(Fixed::parse(wrong, 2), Err(FixedError::Range(wrong.to_owned())), "{wrong}");
        }
        assert!(Fixed::limbs_of("0.5") == Ok(2) && Fixed::limbs_of("1e-40") == Ok(4));
    }

    #[test]
    fn products_are_exact_within_the_limbs() {
        let (a, b) = (fixed("-1.5"), fixed("0.0625"));
        assert_eq!(a.multiply(&b), fixed("-0.09375"));
        assert_eq!(a.multiply(&a), fixed("2.25"));
        assert_eq!(a.add(&b), fixed("-1.4375"));
        assert_eq!(b.subtract(&b), Fixed::zero(4));
        assert_eq!(a.doubled(), fixed("-3"));
        // (2^-100 + 1)^2 = 1 + 2^-99 + 2^-200
        let small = Fixed::from_wide(Wide::new(1.0).times_power(-100), 4);
        let one = fixed("1");
        let sum = one.add(&small);
        let rest = sum.multiply(&sum).subtract(&one).subtract(&small.doubled());
        assert_eq!(rest.to_wide(), Wide::new(1.0).times_power(-200));
    }

    proptest! {
        #[test]
        fn numbers_of_the_processor_go_through(v in -1e8f64..1e8, e in 0i32..180) {
            let v = v * 2.0_f64.powi(-e);
            prop_assert_eq!(Fixed::from_f64(v, 6).to_f64(), v);
        }

        #[test]
        fn arithmetic_agrees(a in -1e4f64..1e4, b in -1e4f64..1e4, cut in any::<bool>()) {
            let limbs = if cut { 2 } else { 5 };
            let (x, y) = (Fixed::from_f64(a, limbs), Fixed::from_f64(b, limbs));
            prop_assert!((x.add(&y).to_f64() - (a + b)).abs() < 1e-11);
            prop_assert!((x.subtract(&y).to_f64() - (a - b)).abs() < 1e-11);
            prop_assert!((x.multiply(&y).to_f64() - a * b).abs() < 1e-7);
            prop_assert_eq!(x.multiply(&y), y.multiply(&x));
        }
    }
}
