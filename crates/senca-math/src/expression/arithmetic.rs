//! The kinds of numbers that a formula can be worked out with.

use crate::Interval;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Sqrt,
    Abs,
}

/// Which of two numbers is smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Smaller {
    First,
    Second,
    /// It depends on where in the intervals they are.
    Either,
}

/// What a formula is worked out with: numbers, intervals, or either of these with derivatives.
pub(super) trait Arithmetic: Copy {
    fn number(x: f64) -> Self;
    fn neg(self) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn powi(self, n: i32) -> Self;
    /// `self^other` for `self >= 0`.
    fn powf(self, other: Self) -> Self;
    fn call(self, function: Function) -> Self;
    fn atan2(self, x: Self) -> Self;
    fn minimum(self, other: Self) -> Self;
    fn maximum(self, other: Self) -> Self;
}

/// Numbers that derivatives can be made of.
pub(super) trait Scalar: Arithmetic {
    fn smaller(self, other: Self) -> Smaller;
    fn hull(self, other: Self) -> Self;
    /// Derivative of the absolute value.
    fn sign(self) -> Self;
    fn is_zero(self) -> bool;
    /// Whether the angle of (x, self) may jump between -pi and pi.
    fn angle_jumps(self, x: Self) -> bool;
    /// Any number at all.
    fn anything() -> Self;
}

/// `x^n` by squaring; multiplies in the same order as [`Interval::powi`].
fn power(x: f64, n: u32) -> f64 {
    let (mut square, mut result, mut left) = (x, 1.0, n);
    while left > 0 {
        if left % 2 == 1 {
            result *= square;
        }
        left /= 2;
        if left > 0 {
            square *= square;
        }
    }
    result
}

impl Arithmetic for f64 {
    fn number(x: f64) -> Self {
        x
    }
    fn neg(self) -> Self {
        -self
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        // What goes through infinity is not defined, as with intervals.
        if other == 0.0 { f64::NAN } else { self / other }
    }
    fn powi(self, n: i32) -> Self {
        match n {
            0 if self.is_nan() => self,
            0.. => power(self, n as u32),
            _ => Arithmetic::div(1.0, power(self, n.unsigned_abs())),
        }
    }
    fn powf(self, other: Self) -> Self {
        if self >= 0.0 && !other.is_nan() { f64::powf(self, other) } else { f64::NAN }
    }
    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            Function::Tanh => self.tanh(),
            Function::Exp => self.exp(),
            Function::Log => self.ln(),
            Function::Sqrt => self.sqrt(),
            Function::Abs => self.abs(),
        }
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    fn minimum(self, other: Self) -> Self {
        // A number that is not defined stays so, unlike with f64::min.
        if self.is_nan() || self <= other { self } else { other }
    }
    fn maximum(self, other: Self) -> Self {
        Arithmetic::neg(Arithmetic::minimum(-self, -other))
    }
}

impl Scalar for f64 {
    fn smaller(self, other: Self) -> Smaller {
        if self <= other { Smaller::First } else { Smaller::Second }
    }
    fn hull(self, _: Self) -> Self {
        self
    }
    fn sign(self) -> Self {
        if self < 0.0 { -1.0 } else { 1.0 }
    }
    fn is_zero(self) -> bool {
        self == 0.0
    }
    fn angle_jumps(self, _: Self) -> bool {
        false
    }
    fn anything() -> Self {
        f64::NAN
    }
}

impl Arithmetic for Interval {
    fn number(x: f64) -> Self {
        Self::point(x)
    }
    fn neg(self) -> Self {
        -self
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn powi(self, n: i32) -> Self {
        Self::powi(self, n)
    }
    fn powf(self, other: Self) -> Self {
        Self::powf(self, other)
    }
    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            Function::Tanh => self.tanh(),
            Function::Exp => self.exp(),
            Function::Log => self.log(),
            Function::Sqrt => self.sqrt(),
            Function::Abs => self.abs(),
        }
    }
    fn atan2(self, x: Self) -> Self {
        Self::atan2(self, x)
    }
    fn minimum(self, other: Self) -> Self {
        Self::minimum(self, other)
    }
    fn maximum(self, other: Self) -> Self {
        Self::maximum(self, other)
    }
}

impl Scalar for Interval {
    fn smaller(self, other: Self) -> Smaller {
        if self.max < other.min {
            Smaller::First
        } else if other.max < self.min {
            Smaller::Second
        } else {
            Smaller::Either
        }
    }
    fn hull(self, other: Self) -> Self {
        Self::hull(self, other)
    }
    fn sign(self) -> Self {
        let min = if self.min > 0.0 { 1.0 } else { -1.0 };
        let max = if self.max < 0.0 { -1.0 } else { 1.0 };
        Self { min, max }
    }
    fn is_zero(self) -> bool {
        self.min == 0.0 && self.max == 0.0
    }
    fn angle_jumps(self, x: Self) -> bool {
        self.contains_zero() && x.min <= 0.0
    }
    fn anything() -> Self {
        Self::ENTIRE
    }
}

/// A number with its derivatives by `N` variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet<S, const N: usize> {
    pub(super) value: S,
    pub(super) slopes: [S; N],
}

impl<S: Scalar, const N: usize> Jet<S, N> {
    /// The variable of number `index`, or one that none of the `N` moves.
    pub(super) fn variable(value: S, index: usize) -> Self {
        let slope = |i: usize| S::number(if i == index { 1.0 } else { 0.0 });
        Self { value, slopes: std::array::from_fn(slope) }
    }

    /// By the chain rule.
    fn chain(self, value: S, derivative: S) -> Self {
        Self { value, slopes: self.slopes.map(|s| derivative.mul(s)) }
    }

    /// By the chain rule for two arguments.
    fn chain2(self, other: Self, value: S, by_self: S, by_other: S) -> Self {
        let slope = |i: usize| by_self.mul(self.slopes[i]).add(by_other.mul(other.slopes[i]));
        Self { value, slopes: std::array::from_fn(slope) }
    }

    fn is_constant(self) -> bool {
        self.slopes.iter().all(|s| s.is_zero())
    }

    /// The slopes of the smaller (or, with `other` and `self` exchanged, the larger) number.
    fn choose(self, other: Self, value: S, which: Smaller) -> Self {
        match which {
            Smaller::First => Self { value, slopes: self.slopes },
            Smaller::Second => Self { value, slopes: other.slopes },
            Smaller::Either => {
                Self { value, slopes: std::array::from_fn(|i| self.slopes[i].hull(other.slopes[i])) }
            }
        }
    }
}

impl<S: Scalar, const N: usize> Arithmetic for Jet<S, N> {
    fn number(x: f64) -> Self {
        Self { value: S::number(x), slopes: [S::number(0.0); N] }
    }
    fn neg(self) -> Self {
        Self { value: self.value.neg(), slopes: self.slopes.map(S::neg) }
    }
    fn add(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|i| self.slopes[i].add(other.slopes[i]));
        Self { value: self.value.add(other.value), slopes }
    }
    fn sub(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|i| self.slopes[i].sub(other.slopes[i]));
        Self { value: self.value.sub(other.value), slopes }
    }
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value.mul(other.value), other.value, self.value)
    }
    fn div(self, other: Self) -> Self {
        let value = self.value.div(other.value);
        let slope = |i: usize| self.slopes[i].sub(value.mul(other.slopes[i])).div(other.value);
        Self { value, slopes: std::array::from_fn(slope) }
    }
    fn powi(self, n: i32) -> Self {
        if n == 0 {
            return Self { value: self.value.powi(0), ..Self::number(1.0) };
        }
        let derivative = S::number(f64::from(n)).mul(self.value.powi(n - 1));
        self.chain(self.value.powi(n), derivative)
    }
    fn powf(self, other: Self) -> Self {
        let value = self.value.powf(other.value);
        let by_self = other.value.mul(self.value.powf(other.value.sub(S::number(1.0))));
        if other.is_constant() {
            return self.chain(value, by_self);
        }
        self.chain2(other, value, by_self, value.mul(self.value.call(Function::Log)))
    }
    fn call(self, function: Function) -> Self {
        let (x, one) = (self.value, S::number(1.0));
        let value = x.call(function);
        let derivative = match function {
            Function::Sin => x.call(Function::Cos),
            Function::Cos => x.call(Function::Sin).neg(),
            Function::Tan => one.add(value.powi(2)),
            Function::Asin => one.div(one.sub(x.powi(2)).call(Function::Sqrt)),
            Function::Acos => one.neg().div(one.sub(x.powi(2)).call(Function::Sqrt)),
            Function::Atan => one.div(one.add(x.powi(2))),
            Function::Sinh => x.call(Function::Cosh),
            Function::Cosh => x.call(Function::Sinh),
            Function::Tanh => one.sub(value.powi(2)),
            Function::Exp => value,
            Function::Log => one.div(x),
            Function::Sqrt => S::number(0.5).div(value),
            Function::Abs => x.sign(),
        };
        self.chain(value, derivative)
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value.powi(2).add(x.value.powi(2));
        let value = self.value.atan2(x.value);
        if self.value.angle_jumps(x.value) {
            return Self { value, slopes: [S::anything(); N] };
        }
        self.chain2(x, value, x.value.div(square), self.value.neg().div(square))
    }
    fn minimum(self, other: Self) -> Self {
        self.choose(other, self.value.minimum(other.value), self.value.smaller(other.value))
    }
    fn maximum(self, other: Self) -> Self {
        self.choose(other, self.value.maximum(other.value), other.value.smaller(self.value))
    }
}
