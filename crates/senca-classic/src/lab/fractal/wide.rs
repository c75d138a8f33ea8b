//! Numbers with the precision of the processor's and an exponent without bounds.

/// A number `mantissa` 2^`exponent`; the mantissa is 0, or from 1/2 to 1 without its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wide {
    mantissa: f64,
    exponent: i64,
}

impl Wide {
    /// 0.
    pub const ZERO: Self = Self { mantissa: 0.0, exponent: 0 };

    /// A finite number.
    #[must_use]
    pub fn new(value: f64) -> Self {
        Self { mantissa: value, exponent: 0 }.normal()
    }

    /// Mantissa and exponent.
    #[must_use]
    pub fn parts(self) -> (f64, i64) {
        (self.mantissa, self.exponent)
    }

    fn normal(self) -> Self {
        if self.mantissa == 0.0 {
            return Self::ZERO;
        }
        let shift = exponent_of(self.mantissa);
        Self { mantissa: scaled(self.mantissa, -shift), exponent: self.exponent + shift }
    }

    /// Times 2^`power`.
    #[must_use]
    pub fn times_power(self, power: i64) -> Self {
        Self { exponent: self.exponent + power, ..self }.normal()
    }

    /// `-self`.
    #[must_use]
    pub fn negated(self) -> Self {
        Self { mantissa: -self.mantissa, ..self }
    }

    /// Product.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self { mantissa: self.mantissa * other.mantissa, exponent: self.exponent + other.exponent }.normal()
    }

    /// Product with a number of the processor.
    #[must_use]
    pub fn times_f64(self, factor: f64) -> Self {
        self.times(Self::new(factor))
    }

    /// The number as one of the processor; 0 below its range, infinite above it.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        scaled(self.mantissa, self.exponent)
    }

    /// Logarithm to base 2 of the absolute value; minus infinity for 0.
    #[must_use]
    pub fn log2(self) -> f64 {
        self.mantissa.abs().log2() + self.exponent as f64
    }

    /// The positive number with this logarithm to base 2.
    #[must_use]
    pub fn from_log2(log2: f64) -> Self {
        let whole = log2.floor();
        Self { mantissa: (log2 - whole).exp2(), exponent: whole as i64 }.normal()
    }

    /// Written with `digits` significant digits.
    #[must_use]
    pub fn to_decimal(self, digits: usize) -> String {
        let direct = self.to_f64();
        if self.mantissa == 0.0 || (1e-290..1e290).contains(&direct.abs()) {
            return format!("{direct:.*e}", digits.saturating_sub(1));
        }
        let log10 = self.log2() * std::f64::consts::LOG10_2;
        let digits = digits.saturating_sub(1).min(12);
        let written = |exponent: f64| format!("{:.digits$}", 10.0_f64.powf(log10 - exponent));
        let exponent = log10.floor();
        // Rounding may make it ten.
        let exponent = if written(exponent).starts_with("10") { exponent + 1.0 } else { exponent };
        let sign = if self.mantissa < 0.0 { "-" } else { "" };
        format!("{sign}{}e{exponent}", written(exponent))
    }
}

/// The power of two just above the absolute value of a number that is not 0.
fn exponent_of(value: f64) -> i64 {
    let bits = |v: f64| (v.to_bits() >> 52 & 0x7ff) as i64;
    match bits(value) {
        // Below the normal range.
        0 => bits(value * 2.0_f64.powi(100)) - 1022 - 100,
        exponent => exponent - 1022,
    }
}

/// `value` 2^`power`, also where 2^`power` alone is out of range.
fn scaled(value: f64, power: i64) -> f64 {
    if (-1000..=1000).contains(&power) {
        return value * 2.0_f64.powi(power as i32);
    }
    let half = power.clamp(-4000, 4000) / 2;
    let step = |v: f64, p: i64| {
        let third = p / 3;
        let [a, b, c] = [third, third, p - 2 * third].map(|p| 2.0_f64.powi(p as i32));
        v * a * b * c
    };
    step(step(value, half), power.clamp(-4000, 4000) - half)
}

/// A complex number whose parts share an exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WideComplex {
    re: f64,
    im: f64,
    exponent: i64,
}

impl WideComplex {
    pub(super) const ZERO: Self = Self { re: 0.0, im: 0.0, exponent: 0 };

    pub(super) fn new(re: Wide, im: Wide) -> Self {
        let exponent = match (re.mantissa == 0.0, im.mantissa == 0.0) {
            (true, true) => return Self::ZERO,
            (false, true) => re.exponent,
            (true, false) => im.exponent,
            _ => re.exponent.max(im.exponent),
        };
        let part = |v: Wide| scaled(v.mantissa, (v.exponent - exponent).max(-2000));
        Self { re: part(re), im: part(im), exponent }
    }

    pub(super) fn from_f64([re, im]: [f64; 2]) -> Self {
        Self { re, im, exponent: 0 }.normal()
    }

    pub(super) fn to_f64(self) -> [f64; 2] {
        [scaled(self.re, self.exponent), scaled(self.im, self.exponent)]
    }

    fn normal(self) -> Self {
        let largest = self.re.abs().max(self.im.abs());
        if largest == 0.0 {
            return Self::ZERO;
        }
        let shift = exponent_of(largest);
        Self { re: scaled(self.re, -shift), im: scaled(self.im, -shift), exponent: self.exponent + shift }
    }

    pub(super) fn add(self, other: Self) -> Self {
        if self.is_zero() {
            return other;
        }
        if other.is_zero() {
            return self;
        }
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = (small.exponent - large.exponent).max(-2000);
        let re = large.re + scaled(small.re, shift);
        Self { re, im: large.im + scaled(small.im, shift), exponent: large.exponent }.normal()
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
            exponent: self.exponent + other.exponent,
        }
        .normal()
    }

    /// Times 2^`power`.
    pub(super) fn times_power(self, power: i64) -> Self {
        if self.is_zero() { self } else { Self { exponent: self.exponent + power, ..self } }
    }

    pub(super) fn doubled(self) -> Self {
        self.times_power(1)
    }

    fn is_zero(self) -> bool {
        self.re == 0.0 && self.im == 0.0
    }

    /// Whether the absolute value is below that of `other`.
    pub(super) fn is_below(self, other: Self) -> bool {
        let square = |v: Self| v.re * v.re + v.im * v.im;
        if self.is_zero() || other.is_zero() {
            return self.is_zero() && !other.is_zero();
        }
        let shift = (2 * (self.exponent - other.exponent)).clamp(-2000, 2000);
        scaled(square(self), shift) < square(other)
    }

    /// The power of two just above the larger part; very small for 0.
    pub(super) fn exponent(self) -> i64 {
        if self.is_zero() { i64::MIN } else { self.exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_normal() {
        for v in [1.0, -0.75, 3e300, 5e-324, -2.2e-310, 1e-308] {
            let wide = Wide::new(v);
            assert!((0.5..1.0).contains(&wide.parts().0.abs()), "{v}: {wide:?}");
            assert_eq!(wide.to_f64(), v);
        }
        assert_eq!(Wide::new(0.0), Wide::ZERO);
        let tiny = Wide::new(3.0).times_power(-40_000);
        assert_eq!((tiny.to_f64(), tiny.times_power(40_000).to_f64()), (0.0, 3.0));
        assert_eq!(tiny.times(tiny).times_power(80_000).to_f64(), 9.0);
        assert_eq!(Wide::new(1.0).times_power(5_000).to_f64(), f64::INFINITY);
    }

    #[test]
    fn texts_and_logarithms() {
        assert_eq!(Wide::new(2.5e-7).to_decimal(3), "2.50e-7");
        let tiny = Wide::from_log2(-400.0 / std::f64::consts::LOG10_2);
        assert_eq!(tiny.to_decimal(4), "1.000e-400");
        assert!((tiny.log2() * std::f64::consts::LOG10_2 + 400.0).abs() < 1e-9);
    }

    #[test]
    fn complex_numbers_of_any_size() {
        let tiny = WideComplex::new(Wide::new(3.0).times_power(-3000), Wide::new(-4.0).times_power(-3000));
        let one = WideComplex::from_f64([1.0, 0.0]);
        assert_eq!(one.add(tiny), one);
        assert_eq!(tiny.add(WideComplex::ZERO), tiny);
        assert!(tiny.is_below(one) && !one.is_below(tiny) && !tiny.is_below(tiny));
        assert!(WideComplex::ZERO.is_below(tiny) && !tiny.is_below(WideComplex::ZERO));
        let square = tiny.times(tiny);
        assert_eq!(
            square,
            WideComplex::new(Wide::new(-7.0).times_power(-6000), Wide::new(-24.0).times_power(-6000))
        );
        assert_eq!(WideComplex::from_f64([3e-200, 4e-200]).doubled().to_f64(), [6e-200, 8e-200]);
    }
}
