//! Formulas that are polynomials: their degree, multiplied out, and along a ray.

use std::collections::BTreeMap;

use glam::DVec3;

use super::arithmetic::{Arithmetic, Function};
use super::{MAX_DEGREE, Op};

/// Products of single terms that multiplying out may take.
const MOST_PRODUCTS: usize = 1 << 20;

const CAPACITY: usize = MAX_DEGREE as usize + 1;

/// One term `coefficient x^i y^j z^k` of a polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The exponents i, j and k.
    pub powers: [u8; 3],
    /// The factor, not 0.
    pub coefficient: f64,
}

/// A polynomial in x, y and z, multiplied out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial3 {
    terms: Vec<Term>,
}

impl Polynomial3 {
    /// The terms, each combination of exponents once, in ascending order of the exponents.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// The highest sum of exponents; 0 for constants.
    #[must_use]
    pub fn degree(&self) -> u32 {
        self.terms.iter().map(|t| t.powers.iter().map(|&p| u32::from(p)).sum()).max().unwrap_or(0)
    }

    /// The value at `p`.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        let power = |i: usize, n: u8| p[i].powi(i32::from(n));
        self.terms
            .iter()
            .map(|t| t.coefficient * (0..3).map(|i| power(i, t.powers[i])).product::<f64>())
            .sum()
    }

    /// The polynomial in t along `origin + t direction`.
    #[must_use]
    pub fn along_ray(&self, origin: DVec3, direction: DVec3) -> RayPolynomial {
        let lines: [RayPolynomial; 3] = std::array::from_fn(|i| RayPolynomial::line(origin[i], direction[i]));
        let of_term = |t: &Term| {
            let factors = (0..3).map(|i| lines[i].powi(i32::from(t.powers[i])));
            factors.fold(RayPolynomial::number(t.coefficient), RayPolynomial::mul)
        };
        self.terms.iter().map(of_term).fold(RayPolynomial::number(0.0), RayPolynomial::add)
    }
}

/// A polynomial in one variable, the parameter along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayPolynomial {
    coefficients: [f64; CAPACITY],
    degree: usize,
}

impl RayPolynomial {
    /// `a + b t`.
    pub(super) fn line(a: f64, b: f64) -> Self {
        let mut line = Self::number(a);
        if b != 0.0 {
            line.coefficients[1] = b;
            line.degree = 1;
        }
        line
    }

    /// The coefficients of 1, t, t^2, ... up to the degree.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// The degree. The leading coefficient may be 0 where terms cancel.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The value at `t`.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        self.coefficients().iter().rev().fold(0.0, |value, c| value * t + c)
    }

    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = Self::number(0.0);
        result.degree = self.degree.max(other.degree);
        for i in 0..=result.degree {
            result.coefficients[i] = f(self.coefficients[i], other.coefficients[i]);
        }
        result
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.coefficients[..=self.degree].iter_mut().for_each(|c| *c *= factor);
        self
    }
}

impl Arithmetic for RayPolynomial {
    fn number(x: f64) -> Self {
        let mut coefficients = [0.0; CAPACITY];
        coefficients[0] = x;
        Self { coefficients, degree: 0 }
    }
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
    fn mul(self, other: Self) -> Self {
        let mut result = Self::number(0.0);
        // The degree of the formula bounds this; nothing is cut off.
        result.degree = (self.degree + other.degree).min(CAPACITY - 1);
        for (i, a) in self.coefficients().iter().enumerate() {
            for (j, b) in other.coefficients().iter().enumerate().take(CAPACITY - i) {
                result.coefficients[i + j] += a * b;
            }
        }
        result
    }
    fn div(self, other: Self) -> Self {
        let divisor = other.coefficients[0];
        let mut quotient = self;
        quotient.coefficients[..=self.degree].iter_mut().for_each(|c| *c /= divisor);
        quotient
    }
    fn powi(self, n: i32) -> Self {
        let (mut square, mut result, mut left) = (self, Self::number(1.0), n.max(0));
        while left > 0 {
            if left % 2 == 1 {
                result = if result.degree == 0 && result.coefficients[0] == 1.0 {
                    square
                } else {
                    result.mul(square)
                };
            }
            left /= 2;
            if left > 0 {
                square = square.mul(square);
            }
        }
        result
    }
    // No formula with these is a polynomial, see `degree`.
    fn powf(self, _: Self) -> Self {
        Self::number(f64::NAN)
    }
    fn call(self, _: Function) -> Self {
        Self::number(f64::NAN)
    }
    fn atan2(self, _: Self) -> Self {
        Self::number(f64::NAN)
    }
    fn minimum(self, _: Self) -> Self {
        Self::number(f64::NAN)
    }
    fn maximum(self, _: Self) -> Self {
        Self::number(f64::NAN)
    }
}

/// The degree of a formula written as a polynomial, when it is at most [`MAX_DEGREE`].
pub(super) fn degree(ops: &[Op]) -> Option<u32> {
    let mut stack: Vec<u32> = Vec::new();
    for op in ops {
        let b = if op.arguments() == 2 { stack.pop()? } else { 0 };
        let a = if op.arguments() > 0 { stack.pop()? } else { 0 };
        let degree = match op {
            Op::Number(_) => 0,
            Op::Variable(_) => 1,
            Op::Neg => a,
            Op::Add | Op::Sub => a.max(b),
            Op::Mul => a + b,
            Op::Div if b == 0 => a,
            Op::PowInteger(n) => a.checked_mul(u32::try_from(*n).ok()?)?,
            _ => return None,
        };
        if degree > MAX_DEGREE {
            return None;
        }
        stack.push(degree);
    }
    stack.pop()
}

/// Coefficients by exponents while multiplying out.
type Expansion = BTreeMap<[u8; 3], f64>;

/// Multiplies a formula out; `None` when that takes too long or gives numbers that are not finite.
pub(super) fn expand(ops: &[Op]) -> Option<Polynomial3> {
    let mut stack: Vec<Expansion> = Vec::new();
    let mut budget = MOST_PRODUCTS;
    for op in ops {
        let b = if op.arguments() == 2 { stack.pop()? } else { Expansion::new() };
        let a = if op.arguments() > 0 { stack.pop()? } else { Expansion::new() };
        let result = match *op {
            Op::Number(x) => Expansion::from([([0; 3], x)]),
            Op::Variable(i) => Expansion::from([(std::array::from_fn(|k| u8::from(k == i)), 1.0)]),
            Op::Neg => scaled(a, |c| -c),
            Op::Add => sum(a, &b, 1.0),
            Op::Sub => sum(a, &b, -1.0),
            Op::Mul => product(&a, &b, &mut budget)?,
            Op::Div => {
                let divisor = b.get(&[0; 3]).copied().unwrap_or(0.0);
                scaled(a, |c| c / divisor)
            }
            Op::PowInteger(n) => {
                let one = Expansion::from([([0; 3], 1.0)]);
                (0..n).try_fold(one, |power, _| product(&power, &a, &mut budget))?
            }
            _ => return None,
        };
        stack.push(result);
    }
    let terms = stack.pop()?.into_iter().filter(|(_, c)| *c != 0.0);
    let terms: Vec<Term> = terms.map(|(powers, coefficient)| Term { powers, coefficient }).collect();
    terms.iter().all(|t| t.coefficient.is_finite()).then_some(Polynomial3 { terms })
}

fn scaled(mut a: Expansion, f: impl Fn(f64) -> f64) -> Expansion {
    a.values_mut().for_each(|c| *c = f(*c));
    a
}

fn sum(mut a: Expansion, b: &Expansion, sign: f64) -> Expansion {
    for (powers, c) in b {
        *a.entry(*powers).or_insert(0.0) += sign * c;
    }
    a
}

fn product(a: &Expansion, b: &Expansion, budget: &mut usize) -> Option<Expansion> {
    *budget = budget.checked_sub(a.len() * b.len())?;
    let mut result = Expansion::new();
    for (p, c) in a {
        for (q, d) in b {
            *result.entry(std::array::from_fn(|i| p[i] + q[i])).or_insert(0.0) += c * d;
        }
    }
    Some(result)
}
