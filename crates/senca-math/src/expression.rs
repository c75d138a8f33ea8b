//! Formulas in x, y and z, as implicit surfaces are written.
//!
//! ```text
//! sum      = product { ("+" | "-") product }
//! product  = sign { ("*" | "/") sign }
//! sign     = { "+" | "-" } power
//! power    = operand [ "^" sign ]                 -x^2 is -(x^2), 2^3^2 is 2^(3^2)
//! operand  = number | "x" | "y" | "z" | "pi" | "e" | function "(" sum { "," sum } ")" | "(" sum ")"
//! function = sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs (one argument)
//!            atan2 pow (two arguments), min max (two or more)
//! ```
//!
//! Angles are in radians, `log` is the natural logarithm. `a^n` with a whole constant n holds for all
//! a; with any other exponent it is defined for a >= 0. A formula is kept as a list of operations on a
//! stack of bounded depth, so working it out takes neither recursion nor memory, and it can be done
//! with numbers, with intervals, with derivatives of both, and with polynomials.
//!
//! ```
//! use senca_math::glam::DVec3;
//! use senca_math::{Expression, Interval};
//!
//! let sphere: Expression = "x^2 + y^2 + z^2 - 1".parse()?;
//! assert_eq!(sphere.value(DVec3::new(0.0, 0.0, 2.0)), 3.0);
//! assert_eq!(sphere.value_and_gradient(DVec3::Y), (0.0, DVec3::new(0.0, 2.0, 0.0)));
//! // A ray along z meets it where 15 - 8 t + t^2 = 0.
//! let along = sphere.along_ray(DVec3::new(0.0, 0.0, -4.0), DVec3::Z).ok_or("not a polynomial")?;
//! assert_eq!(along.coefficients(), [15.0, -8.0, 1.0]);
//! // There is no surface in this box.
//! assert!(!sphere.interval([Interval::new(1.0, 2.0); 3]).contains_zero());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arithmetic;
mod display;
mod parse;
mod polynomial;

use glam::DVec3;

use crate::{Aabb, Interval};
use arithmetic::{Arithmetic, Function, Jet};

pub use parse::ExpressionError;
pub use polynomial::{Polynomial3, RayPolynomial, Term};

/// Longest formula that is read, in bytes.
pub const MAX_LENGTH: usize = 1 << 14;

/// How deep parentheses, functions and exponents may nest.
pub const MAX_NESTING: usize = 64;

/// Highest total degree up to which a formula is treated as a polynomial.
pub const MAX_DEGREE: u32 = 32;

/// Most numbers that a formula may keep on its stack.
const MAX_STACK: usize = 256;

/// One operation on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Variable(usize),
    Number(f64),
    Neg,
    Add,
    Sub,
    Mul,
    Div,
    PowInteger(i32),
    Pow,
    Call(Function),
    Atan2,
    Min,
    Max,
}

/// A formula in x, y and z, ready to be worked out.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    ops: Vec<Op>,
    stack: usize,
    degree: Option<u32>,
}

impl Expression {
    /// Reads a formula; the grammar is at the head of this module. Parts without variables are worked
    /// out at once.
    ///
    /// # Errors
    /// [`ExpressionError`] with the column and what was expected there; formulas above
    /// [`MAX_LENGTH`] or nested deeper than [`MAX_NESTING`] are refused.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        let ops = parse::parse(text)?;
        let stack = stack_depth(&ops);
        if stack > MAX_STACK {
            return Err(ExpressionError::TooDeep { column: 1 });
        }
        Ok(Self { degree: polynomial::degree(&ops), ops, stack })
    }

    /// f(p). Not a number where the formula is not defined.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        self.run(p.to_array())
    }

    /// f(p) and its gradient (df/dx, df/dy, df/dz) there. At a kink of `abs`, `min` and `max` it is
    /// that of one side; it is not finite where there is none.
    #[must_use]
    pub fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let p = p.to_array();
        let jet = self.run::<Jet<f64, 3>>(std::array::from_fn(|i| Jet::variable(p[i], i)));
        (jet.value, DVec3::from_array(jet.slopes))
    }

    /// Bounds of f over a box given by its intervals along x, y and z. Rigorous: every finite value
    /// that [`Expression::value`] gives in the box is inside.
    #[must_use]
    pub fn interval(&self, bounds: [Interval; 3]) -> Interval {
        self.run(bounds)
    }

    /// [`Expression::interval`] over an axis-aligned box.
    #[must_use]
    pub fn interval_over(&self, bounds: &Aabb) -> Interval {
        self.interval(intervals_of(bounds))
    }

    /// Bounds of f and of its three partial derivatives over a box.
    #[must_use]
    pub fn interval_and_gradient(&self, bounds: [Interval; 3]) -> (Interval, [Interval; 3]) {
        let jet = self.run::<Jet<Interval, 3>>(std::array::from_fn(|i| Jet::variable(bounds[i], i)));
        (jet.value, jet.slopes)
    }

    /// Bounds of f(origin + t direction) and of its derivative by t, for t in an interval: what
    /// interval Newton and root isolation need.
    #[must_use]
    pub fn interval_along_ray(&self, origin: DVec3, direction: DVec3, t: Interval) -> (Interval, Interval) {
        let jet = self.run::<Jet<Interval, 1>>(std::array::from_fn(|i| {
            let speed = Interval::point(direction[i]);
            Jet { value: Interval::point(origin[i]) + speed * t, slopes: [speed] }
        }));
        (jet.value, jet.slopes[0])
    }

    /// f(origin + t direction) and its derivative by t at one t.
    #[must_use]
    pub fn value_along_ray(&self, origin: DVec3, direction: DVec3, t: f64) -> (f64, f64) {
        let jet = self.run::<Jet<f64, 1>>(std::array::from_fn(|i| Jet {
            value: origin[i] + t * direction[i],
            slopes: [direction[i]],
        }));
        (jet.value, jet.slopes[0])
    }

    /// The degree if this is written as a polynomial of at most [`MAX_DEGREE`]; terms that cancel
    /// count.
    #[must_use]
    pub fn degree(&self) -> Option<u32> {
        self.degree
    }

    /// The formula multiplied out, if it is a polynomial (see [`Expression::degree`]) whose expansion
    /// stays within bounds.
    #[must_use]
    pub fn as_polynomial(&self) -> Option<Polynomial3> {
        self.degree.and_then(|_| polynomial::expand(&self.ops))
    }

    /// f(origin + t direction) as a polynomial in t; `None` when it is none. It is formed from the
    /// formula as it was written, which loses fewer digits than multiplying out first.
    #[must_use]
    pub fn along_ray(&self, origin: DVec3, direction: DVec3) -> Option<RayPolynomial> {
        self.degree?;
        Some(self.run(std::array::from_fn(|i| RayPolynomial::line(origin[i], direction[i]))))
    }

    /// Works the formula out, on a stack that is as small as it may be.
    fn run<T: Arithmetic>(&self, variables: [T; 3]) -> T {
        match self.stack {
            ..=8 => self.run_on::<T, 8>(variables),
            9..=32 => self.run_on::<T, 32>(variables),
            _ => self.run_on::<T, MAX_STACK>(variables),
        }
    }

    fn run_on<T: Arithmetic, const N: usize>(&self, variables: [T; 3]) -> T {
        let mut stack = [T::number(0.0); N];
        let mut top = 0;
        for op in &self.ops {
            let arguments = op.arguments();
            top -= arguments;
            let a = stack[top];
            stack[top] = match *op {
                Op::Variable(i) => variables[i],
                Op::Number(x) => T::number(x),
                Op::Neg => a.neg(),
                Op::PowInteger(n) => a.powi(n),
                Op::Call(function) => a.call(function),
                binary => binary.of_two(a, stack[top + 1]),
            };
            top += 1;
        }
        stack[0]
    }
}

impl Op {
    /// How many numbers it takes from the stack; it leaves one.
    fn arguments(self) -> usize {
        match self {
            Self::Variable(_) | Self::Number(_) => 0,
            Self::Neg | Self::PowInteger(_) | Self::Call(_) => 1,
            Self::Add
            | Self::Sub
            | Self::Mul
            | Self::Div
            | Self::Pow
            | Self::Atan2
            | Self::Min
            | Self::Max => 2,
        }
    }

    /// The result of an operation with two arguments.
    fn of_two<T: Arithmetic>(self, a: T, b: T) -> T {
        match self {
            Self::Add => a.add(b),
            Self::Sub => a.sub(b),
            Self::Mul => a.mul(b),
            Self::Div => a.div(b),
            Self::Atan2 => a.atan2(b),
            Self::Min => a.minimum(b),
            Self::Max => a.maximum(b),
            _ => a.powf(b),
        }
    }
}

fn intervals_of(bounds: &Aabb) -> [Interval; 3] {
    std::array::from_fn(|i| Interval { min: bounds.min[i], max: bounds.max[i] })
}

/// Most numbers on the stack while `ops` run.
fn stack_depth(ops: &[Op]) -> usize {
    let (mut now, mut most) = (0usize, 0);
    for op in ops {
        now = now + 1 - op.arguments();
        most = most.max(now);
    }
    most
}

impl std::str::FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        Self::parse(text)
    }
}

#[cfg(test)]
mod tests;
