//! How much rational Bézier patches bend, at most.
//!
//! A rational patch is a quotient s = q / w of polynomials. With the polynomial `a = q_u w - q w_u` its
//! derivatives are
//!
//! - `s_u = a / w^2`,
//! - `s_uu = (a_u w - 2 a w_u) / w^3`,
//! - `s_uv = (a_v w - 2 a w_v) / w^3`,
//!
//! and those along v by exchanging u and v. Such a quotient, too, is a rational Bézier patch: numerator and
//! denominator have Bernstein coefficients of one degree, and it lies within the hull of their quotients.
//!
//! Products of the parts bounded one by one are simpler, but a ruled cylinder then seems to be twisted: the
//! terms that cancel have to meet before their lengths are taken.

use std::ops::{Add, Mul, Sub};

use senca_math::RationalPatch;
use senca_math::glam::DVec3;

/// Bounds on the lengths of the second derivatives over a patch's parameters from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bend {
    pub uu: f64,
    pub uv: f64,
    pub vv: f64,
}

impl Bend {
    /// The larger of each.
    pub(super) fn max(self, other: Self) -> Self {
        Self { uu: self.uu.max(other.uu), uv: self.uv.max(other.uv), vv: self.vv.max(other.vv) }
    }

    /// Of a patch with weights above 0.
    pub(super) fn of(patch: &RationalPatch) -> Self {
        let middle = patch.points.first().map_or(DVec3::ZERO, |p| p.truncate() / p.w);
        let width = patch.degree_u + 1;
        let weights: Vec<f64> = patch.points.iter().map(|p| p.w).collect();
        let w = Polynomial::from_bernstein(width, &weights);
        let places: Vec<DVec3> = patch.points.iter().map(|p| p.truncate() - middle * p.w).collect();
        let q = Polynomial::from_bernstein(width, &places);
        if weights.iter().all(|x| (x - weights[0]).abs() <= 1e-14 * weights[0]) {
            return Self::of_polynomial(&q, weights[0]);
        }
        let cube = w.times(&w).times(&w);
        let (uu, uv) = second_derivatives(&q, &w, &cube);
        let (vv, vu) = second_derivatives(&q.transposed(), &w.transposed(), &cube.transposed());
        Self { uu, uv: uv.min(vu), vv }
    }

    fn of_polynomial(q: &Polynomial<DVec3>, weight: f64) -> Self {
        let largest = |p: &Polynomial<DVec3>| p.largest_quotient(&p.ones()) / weight;
        let (along, across) = (q.du(), q.transposed().du());
        Self { uu: largest(&along.du()), uv: largest(&along.transposed().du()), vv: largest(&across.du()) }
    }
}

/// Bounds on `s_uu` and `s_uv` of s = q / w, with the cube of w.
fn second_derivatives(q: &Polynomial<DVec3>, w: &Polynomial<f64>, cube: &Polynomial<f64>) -> (f64, f64) {
    let a = q.du().times(w).minus(&q.times(&w.du()));
    let second = |a: &Polynomial<DVec3>, w: &Polynomial<f64>| {
        let twice = a.times(&w.du());
        a.du().times(w).minus(&twice).minus(&twice)
    };
    let uu = second(&a, w).raised_to(cube);
    let uv = second(&a.transposed(), &w.transposed()).transposed().raised_to(cube);
    (uu.largest_quotient(cube), uv.largest_quotient(cube))
}

/// A polynomial of degrees m in u and n in v: the sum of `c_ij u^i (1-u)^(m-i) v^j (1-v)^(n-j)`, that is,
/// Bernstein coefficients times their binomials; so a product is the convolution of the coefficients.
struct Polynomial<T> {
    /// m + 1.
    width: usize,
    /// u being the fast index.
    coefficients: Vec<T>,
}

impl<T> Polynomial<T>
where
    T: Copy + Default + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    fn from_bernstein(width: usize, coefficients: &[T]) -> Self {
        let (across, along) = (binomials(width), binomials(coefficients.len() / width));
        let scaled = |(k, &c): (usize, &T)| c * (across[k % width] * along[k / width]);
        Self { width, coefficients: coefficients.iter().enumerate().map(scaled).collect() }
    }

    fn height(&self) -> usize {
        self.coefficients.len() / self.width
    }

    /// The polynomial 1 of the same degrees.
    fn ones(&self) -> Polynomial<f64> {
        Polynomial::from_bernstein(self.width, &vec![1.0; self.coefficients.len()])
    }

    /// u and v exchanged.
    fn transposed(&self) -> Self {
        let (width, height) = (self.width, self.height());
        let at = |k: usize| self.coefficients[k % height * width + k / height];
        Self { width: height, coefficients: (0..width * height).map(at).collect() }
    }

    /// The derivative along u, one degree lower; of a constant, 0.
    fn du(&self) -> Self {
        if self.width == 1 {
            return Self { width: 1, coefficients: vec![T::default(); self.height()] };
        }
        let degree = self.width - 1;
        let one = |row: &[T], i: usize| row[i + 1] * (i + 1) as f64 - row[i] * (degree - i) as f64;
        let rows = self.coefficients.chunks(self.width);
        let coefficients = rows.flat_map(|row| (0..degree).map(move |i| one(row, i))).collect();
        Self { width: degree, coefficients }
    }

    fn times(&self, factor: &Polynomial<f64>) -> Self {
        let (width, height) = (self.width + factor.width - 1, self.height() + factor.height() - 1);
        let mut coefficients = vec![T::default(); width * height];
        for (k, &c) in self.coefficients.iter().enumerate() {
            let corner = k / self.width * width + k % self.width;
            for (row, factors) in factor.coefficients.chunks(factor.width).enumerate() {
                let start = corner + row * width;
                for (sum, &f) in coefficients[start..start + factor.width].iter_mut().zip(factors) {
                    *sum = *sum + c * f;
                }
            }
        }
        Self { width, coefficients }
    }

    /// Of the larger degrees of both.
    fn minus(self, other: &Self) -> Self {
        let (width, height) = (self.width.max(other.width), self.height().max(other.height()));
        let (mut a, b) = (self.raised(width, height), other.raised(width, height));
        a.coefficients.iter_mut().zip(b.coefficients).for_each(|(a, b)| *a = *a - b);
        a
    }

    fn raised_to<S>(&self, other: &Polynomial<S>) -> Self {
        self.raised(other.width, other.coefficients.len() / other.width)
    }

    /// The same polynomial with at least as many coefficients.
    fn raised(&self, width: usize, height: usize) -> Self {
        let more =
            |width: usize, height: usize| Polynomial::from_bernstein(width, &vec![1.0; width * height]);
        self.times(&more(width - self.width + 1, height - self.height() + 1))
    }
}

impl Polynomial<DVec3> {
    /// The largest length of the quotient's Bernstein coefficients; the degrees are the same.
    fn largest_quotient(&self, denominator: &Polynomial<f64>) -> f64 {
        let lengths = self.coefficients.iter().zip(&denominator.coefficients).map(|(c, d)| c.length() / d);
        lengths.fold(0.0, f64::max)
    }
}

/// A row of Pascal's triangle.
fn binomials(count: usize) -> Vec<f64> {
    let mut row = vec![1.0];
    for i in 1..count {
        row.push(row[i - 1] * (count - i) as f64 / i as f64);
    }
    row
}
