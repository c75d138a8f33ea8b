//! Interval arithmetic: bounds that hold whatever the rounding.
//!
//! An [`Interval`] is a set of real numbers between two bounds. Each operation gives an interval that
//! holds every result for arguments from the given intervals: bounds of the four operations and the
//! square root are rounded outwards by one step of `f64`, those of other functions by a few steps,
//! which covers the errors of the system's mathematics (Moore 1966).
//!
//! Where a function is not defined on a part of its argument, that part is left out; where it is
//! defined nowhere, the result is [`Interval::EMPTY`].

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A closed interval of real numbers; a bound may be infinite. Empty when `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub min: f64,
    /// Upper bound.
    pub max: f64,
}

/// Arguments beyond which periodic functions are not looked at closely.
const LARGE_ANGLE: f64 = 1e8;

/// `x` and what rounding may have taken from it, downwards.
fn lower(x: f64) -> f64 {
    x - (4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE)
}

/// `x` and what rounding may have taken from it, upwards.
fn upper(x: f64) -> f64 {
    x + (4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE)
}

/// A product in which zero wins over infinity: an infinite bound stands for arbitrarily large numbers.
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Interval {
    /// No number at all.
    pub const EMPTY: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };

    /// All numbers.
    pub const ENTIRE: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// From `min` to `max`. A bound that is no number is taken for infinite.
    #[must_use]
    pub fn new(min: f64, max: f64) -> Self {
        let min = if min.is_nan() { f64::NEG_INFINITY } else { min };
        let max = if max.is_nan() { f64::INFINITY } else { max };
        Self { min, max }
    }

    /// The one number `x`; everything when `x` is no number.
    #[must_use]
    pub fn point(x: f64) -> Self {
        Self::new(x, x)
    }

    /// Whether there is no number in it.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.min > self.max
    }

    /// Whether `x` is in it.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.min <= x && x <= self.max
    }

    /// Whether it has a zero.
    #[must_use]
    pub fn contains_zero(self) -> bool {
        self.contains(0.0)
    }

    /// Length; 0 for the empty interval.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.max - self.min }
    }

    /// A number about in the middle, always finite; 0 for the entire and the empty interval.
    #[must_use]
    pub fn middle(self) -> f64 {
        if self.is_empty() || self == Self::ENTIRE {
            return 0.0;
        }
        (0.5 * self.min + 0.5 * self.max).clamp(f64::MIN, f64::MAX)
    }

    /// Largest absolute value; 0 for the empty interval.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.min.abs().max(self.max.abs()) }
    }

    /// The numbers in both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        let both = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        if both.is_empty() { Self::EMPTY } else { both }
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Bounds rounded outwards by one step.
    fn outward(min: f64, max: f64) -> Self {
        Self::new(min, max).widened()
    }

    fn widened(self) -> Self {
        Self { min: self.min.next_down(), max: self.max.next_up() }
    }

    /// `f` of an interval on which it rises, rounded outwards by a few steps.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() { Self::EMPTY } else { Self::new(lower(f(self.min)), upper(f(self.max))) }
    }

    /// `x^n` for a whole `n`; 1 for `n = 0`.
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        if self.is_empty() {
            return self;
        }
        if n < 0 {
            return Self::point(1.0) / self.power(n.unsigned_abs());
        }
        self.power(n as u32)
    }

    fn power(self, n: u32) -> Self {
        let end = |x: f64| signed_power(Self::point(x.abs()), x, n);
        let (a, b) = (end(self.min), end(self.max));
        let hull = a.hull(b);
        if n.is_multiple_of(2) && n > 0 && self.contains_zero() {
            Self { min: 0.0, max: hull.max }
        } else {
            hull
        }
    }

    /// `x^b` for x >= 0, by the logarithm.
    #[must_use]
    pub fn powf(self, exponent: Self) -> Self {
        (exponent * self.log()).exp()
    }

    /// Square root of the part that is not negative.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let x = self.intersection(Self { min: 0.0, max: f64::INFINITY });
        if x.is_empty() {
            return x;
        }
        let root = Self { min: x.min.sqrt(), max: x.max.sqrt() }.widened();
        Self { min: root.min.max(0.0), max: root.max }
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.is_empty() || self.min >= 0.0 {
            self
        } else if self.max <= 0.0 {
            -self
        } else {
            Self { min: 0.0, max: self.magnitude() }
        }
    }

    /// e to the power of x.
    #[must_use]
    pub fn exp(self) -> Self {
        let e = self.rising(f64::exp);
        Self { min: e.min.max(0.0), max: e.max }
    }

    /// Natural logarithm of the part that is not negative; minus infinity at 0.
    #[must_use]
    pub fn log(self) -> Self {
        self.intersection(Self { min: 0.0, max: f64::INFINITY }).rising(f64::ln)
    }

    /// Sine.
    #[must_use]
    pub fn sin(self) -> Self {
        (self - Self { min: FRAC_PI_2, max: FRAC_PI_2.next_up() }).cos()
    }

    /// Cosine.
    #[must_use]
    pub fn cos(self) -> Self {
        if self.is_empty() {
            return self;
        }
        if self.magnitude() > LARGE_ANGLE || self.width() >= TAU {
            return Self { min: -1.0, max: 1.0 };
        }
        let (a, b) = (self.min.cos(), self.max.cos());
        let min = if self.meets(PI, TAU) { -1.0 } else { lower(a.min(b)).max(-1.0) };
        let max = if self.meets(0.0, TAU) { 1.0 } else { upper(a.max(b)).min(1.0) };
        Self { min, max }
    }

    /// Tangent; everything where a pole is inside.
    #[must_use]
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return self;
        }
        let large = self.magnitude() > LARGE_ANGLE || self.width() >= PI;
        if large || self.meets(FRAC_PI_2, PI) { Self::ENTIRE } else { self.rising(f64::tan) }
    }

    /// Whether `start + k period` for some whole k is in the interval, or so near that rounding could
    /// hide it.
    fn meets(self, start: f64, period: f64) -> bool {
        let slack = 1e-7_f64.min(1e-14 * (1.0 + self.magnitude()));
        let next = start + period * ((self.min - slack - start) / period).ceil();
        next <= self.max + slack
    }

    /// Arc sine of the part in -1 to 1.
    #[must_use]
    pub fn asin(self) -> Self {
        self.intersection(Self { min: -1.0, max: 1.0 }).rising(f64::asin)
    }

    /// Arc cosine of the part in -1 to 1.
    #[must_use]
    pub fn acos(self) -> Self {
        let x = self.intersection(Self { min: -1.0, max: 1.0 });
        if x.is_empty() {
            return x;
        }
        Self { min: lower(x.max.acos()), max: upper(x.min.acos()) }
    }

    /// Arc tangent.
    #[must_use]
    pub fn atan(self) -> Self {
        self.rising(f64::atan)
    }

    /// Angle of the point (`x`, `self`) seen from the x axis, in -pi to pi.
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        let crosses_cut = self.contains_zero() && x.min <= 0.0;
        if crosses_cut {
            return Self { min: lower(-PI), max: upper(PI) };
        }
        let corners = [(self.min, x.min), (self.min, x.max), (self.max, x.min), (self.max, x.max)];
        corners.iter().fold(Self::EMPTY, |hull, (y, x)| {
            let angle = y.atan2(*x);
            hull.hull(Self { min: lower(angle), max: upper(angle) })
        })
    }

    /// Hyperbolic sine.
    #[must_use]
    pub fn sinh(self) -> Self {
        self.rising(f64::sinh)
    }

    /// Hyperbolic cosine.
    #[must_use]
    pub fn cosh(self) -> Self {
        let cosh = self.abs().rising(f64::cosh);
        Self { min: cosh.min.max(1.0), max: cosh.max }
    }

    /// Hyperbolic tangent.
    #[must_use]
    pub fn tanh(self) -> Self {
        self.rising(f64::tanh).intersection(Self { min: -1.0, max: 1.0 })
    }

    /// The smaller of two numbers.
    #[must_use]
    pub fn minimum(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self { min: self.min.min(other.min), max: self.max.min(other.max) }
    }

    /// The larger of two numbers.
    #[must_use]
    pub fn maximum(self, other: Self) -> Self {
        -(-self).minimum(-other)
    }
}

/// `|x|^n` by squaring, with the sign that `x` gives it.
fn signed_power(magnitude: Interval, x: f64, n: u32) -> Interval {
    let (mut square, mut result, mut left) = (magnitude, Interval::point(1.0), n);
    while left > 0 {
        if left % 2 == 1 {
            result = if result == Interval::point(1.0) { square } else { result * square };
        }
        left /= 2;
        if left > 0 {
            square = square * square;
        }
    }
    if x < 0.0 && n % 2 == 1 { -result } else { result }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { min: -self.max, max: -self.min }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::outward(self.min + other.min, self.max + other.max)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        let corners = [
            product(self.min, other.min),
            product(self.min, other.max),
            product(self.max, other.min),
            product(self.max, other.max),
        ];
        let [a, b, c, d] = corners;
        let wide = Self { min: a.min(b).min(c.min(d)), max: a.max(b).max(c.max(d)) }.widened();
        // Rounding outwards must not lose that a product of like signs is not negative.
        let alike = self.min >= 0.0 && other.min >= 0.0 || self.max <= 0.0 && other.max <= 0.0;
        Self { min: if alike { wide.min.max(0.0) } else { wide.min }, max: wide.max }
    }
}

impl Div for Interval {
    type Output = Self;
    /// Everything when the divisor has zero inside; nothing when it is zero alone.
    fn div(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() || (other.min == 0.0 && other.max == 0.0) {
            return Self::EMPTY;
        }
        self * other.reciprocal()
    }
}

impl Interval {
    /// 1 / x.
    fn reciprocal(self) -> Self {
        let inverse = |x: f64, at_zero: f64| if x == 0.0 { at_zero } else { 1.0 / x };
        if self.min < 0.0 && self.max > 0.0 {
            return Self::ENTIRE;
        }
        let inverse = Self::outward(inverse(self.max, f64::NEG_INFINITY), inverse(self.min, f64::INFINITY));
        if self.min >= 0.0 {
            Self { min: inverse.min.max(0.0), max: inverse.max }
        } else {
            Self { min: inverse.min, max: inverse.max.min(0.0) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An interval with a number in it.
    fn with_number() -> impl Strategy<Value = (Interval, f64)> {
        (-20.0f64..20.0, 0.0f64..1.0, 0.0f64..1.0, -6i32..2).prop_map(|(x, below, above, scale)| {
            let scale = 10f64.powi(scale);
            let x = if scale > 1.0 { x.round() } else { x };
            (Interval::new(x - below * scale, x + above * scale), x)
        })
    }

    fn holds(interval: Interval, value: f64) -> bool {
        !value.is_finite() || interval.contains(value)
    }

    proptest! {
        #[test]
        fn functions_hold_their_values((i, x) in with_number(), (j, y) in with_number(), n in -6i32..7) {
            prop_assert!(holds(i + j, x + y) && holds(i - j, x - y) && holds(i * j, x * y));
            prop_assert!(holds(i / j, x / y), "{i:?} / {j:?}: {:?}", i / j);
            prop_assert!(holds(i.sin(), x.sin()) && holds(i.cos(), x.cos()) && holds(i.tan(), x.tan()));
            prop_assert!(holds(i.asin(), x.asin()) && holds(i.acos(), x.acos()) && holds(i.atan(), x.atan()));
            prop_assert!(holds(i.exp(), x.exp()) && holds(i.log(), x.ln()) && holds(i.sqrt(), x.sqrt()));
            prop_assert!(holds(i.sinh(), x.sinh()) && holds(i.cosh(), x.cosh()) && holds(i.tanh(), x.tanh()));
            prop_assert!(holds(i.abs(), x.abs()) && holds(i.minimum(j), x.min(y)) && holds(i.maximum(j), x.max(y)));
            prop_assert!(holds(i.atan2(j), x.atan2(y)), "{i:?} {j:?}");
            prop_assert!(holds(i.powi(n), x.powi(n)) || (x.powi(n) - i.powi(n).middle()).abs() < 1e-12 * x.powi(n).abs());
            prop_assert!(holds(i.abs().powf(j), x.abs().powf(y)));
        }
    }

    #[test]
    fn periodic_functions_find_their_extremes() {
        assert_eq!(Interval::new(-0.1, 0.1).cos().max, 1.0);
        assert_eq!(Interval::new(3.0, 3.3).cos().min, -1.0);
        assert_eq!(Interval::new(1.0, 2.0).sin().max, 1.0);
        assert!(Interval::new(0.1, 0.2).sin().max < 0.2);
        assert_eq!(Interval::new(1.0, 2.0).tan(), Interval::ENTIRE);
        assert_eq!(Interval::new(1e12, 1e12 + 0.1).sin(), Interval::new(-1.0, 1.0));
    }

    #[test]
    fn even_powers_and_like_signs_are_not_negative() {
        assert_eq!(Interval::new(-2.0, 1.0).powi(2).min, 0.0);
        assert_eq!((Interval::new(0.0, 1.0) * Interval::new(0.0, 2.0)).min, 0.0);
        assert!((Interval::new(-2.0, 1.0).powi(2).max - 4.0).abs() < 1e-14);
        assert_eq!(Interval::new(-2.0, 1.0).powi(0), Interval::point(1.0));
        assert_eq!(Interval::new(-1.0, 2.0).powi(-1), Interval::ENTIRE);
    }

    #[test]
    fn what_is_undefined_is_left_out() {
        assert!(Interval::new(-2.0, -1.0).sqrt().is_empty());
        assert!(Interval::new(2.0, 3.0).asin().is_empty() && Interval::new(2.0, 3.0).acos().is_empty());
        assert!((Interval::point(1.0) / Interval::point(0.0)).is_empty());
        assert!((Interval::EMPTY + Interval::point(1.0)).is_empty());
        assert_eq!(Interval::new(-1.0, 4.0).sqrt().min, 0.0);
        assert_eq!(Interval::point(f64::NAN), Interval::ENTIRE);
        assert!((Interval::point(1.0) / Interval::new(0.0, 2.0)).max == f64::INFINITY);
    }

    #[test]
    fn middles_are_finite() {
        assert_eq!(Interval::new(1.0, 3.0).middle(), 2.0);
        assert_eq!(Interval::new(0.0, f64::INFINITY).middle(), f64::MAX);
        assert_eq!((Interval::ENTIRE.middle(), Interval::EMPTY.middle()), (0.0, 0.0));
        assert!(Interval::new(f64::MAX, f64::MAX).middle() == f64::MAX);
    }
}
