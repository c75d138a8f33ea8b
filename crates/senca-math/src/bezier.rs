//! Bézier curves: weights, evaluation, derivatives, splitting, bounds.
//!
//! Parameters run from 0 to 1. Two forms of the same thing are kept side by side: Bernstein weights
//! and the matrix form `U B P`. Source: 1991 thesis, section 5; de Casteljau 1959.

mod patch;
mod seam;

use std::ops::{Add, Mul};

use glam::{DMat4, DVec3, DVec4};

use crate::Aabb;
use crate::frame::unit;
use crate::roots::quadratic_roots;

pub(crate) use patch::surface_normal;
pub use patch::{BicubicPatch, SurfacePoint};
pub use seam::{Continuity, PatchEdge, Seam};

/// What can be a control point: anything that can be blended.
pub trait ControlPoint: Copy + Add<Output = Self> + Mul<f64, Output = Self> {}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> ControlPoint for T {}

/// The Bézier basis matrix: `[t^3 t^2 t 1] B P` is a cubic curve. It is symmetric.
pub const BEZIER_MATRIX: DMat4 = DMat4::from_cols_array_2d(&[
    [-1.0, 3.0, -3.0, 1.0],
    [3.0, -6.0, 3.0, 0.0],
    [-3.0, 3.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
]);

/// The `degree + 1` Bernstein weights at `t`. They sum to 1, and for `t` in [0, 1] none is negative.
#[must_use]
pub fn bernstein(degree: usize, t: f64) -> Vec<f64> {
    let mut weights = vec![1.0];
    for _ in 0..degree {
        let mut raised = vec![0.0; weights.len() + 1];
        for (i, w) in weights.iter().enumerate() {
            raised[i] += w * (1.0 - t);
            raised[i + 1] += w * t;
        }
        weights = raised;
    }
    weights
}

/// The four cubic Bernstein weights at `t`.
#[must_use]
pub fn bernstein_cubic(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * t * s * s, 3.0 * t * t * s, t * t * t]
}

/// Derivatives of the four cubic Bernstein weights at `t`.
#[must_use]
pub fn bernstein_cubic_derivative(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}

/// A point of the curve with any number of control points, by repeated division; `None` without any.
#[must_use]
pub fn de_casteljau<T: ControlPoint>(points: &[T], t: f64) -> Option<T> {
    let mut work = points.to_vec();
    while work.len() > 1 {
        work = blend_neighbours(&work, t);
    }
    work.first().copied()
}

/// The two curves, of the same degree, that a curve of any degree is at `t` and below, and above.
#[must_use]
pub fn split_curve<T: ControlPoint>(points: &[T], t: f64) -> (Vec<T>, Vec<T>) {
    let (mut below, mut above) = (Vec::new(), Vec::new());
    let mut work = points.to_vec();
    while let (Some(&first), Some(&last)) = (work.first(), work.last()) {
        below.push(first);
        above.push(last);
        work = blend_neighbours(&work, t);
    }
    above.reverse();
    (below, above)
}

fn blend_neighbours<T: ControlPoint>(points: &[T], t: f64) -> Vec<T> {
    points.windows(2).map(|pair| lerp(pair[0], pair[1], t)).collect()
}

fn lerp<T: ControlPoint>(a: T, b: T, t: f64) -> T {
    a * (1.0 - t) + b * t
}

fn weighted<T: ControlPoint>(weights: [f64; 4], points: [T; 4]) -> T {
    points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2] + points[3] * weights[3]
}

/// A cubic Bézier curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicCurve {
    /// The control points; the curve begins in the first and ends in the last.
    pub points: [DVec3; 4],
}

impl CubicCurve {
    /// The point at `t`, by Bernstein weights.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        weighted(bernstein_cubic(t), self.points)
    }

    /// The point at `t`, by the matrix form. The same up to rounding.
    #[must_use]
    pub fn at_by_matrix(&self, t: f64) -> DVec3 {
        let weights = BEZIER_MATRIX * DVec4::new(t * t * t, t * t, t, 1.0);
        weighted(weights.to_array(), self.points)
    }

    /// First derivative at `t`.
    #[must_use]
    pub fn derivative(&self, t: f64) -> DVec3 {
        weighted(bernstein_cubic_derivative(t), self.points)
    }

    /// Second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> DVec3 {
        let [a, b, c, d] = self.points;
        6.0 * lerp(a - 2.0 * b + c, b - 2.0 * c + d, t)
    }

    /// Unit tangent at `t`, also at an end whose control points coincide; `None` for a curve that is
    /// a single point.
    #[must_use]
    pub fn tangent(&self, t: f64) -> Option<DVec3> {
        let size = self.points.iter().fold(0.0f64, |size, p| size.max((*p - self.points[0]).length()));
        let long_enough = |d: &DVec3| d.length() > 1e-9 * size;
        // Where the first derivative vanishes the curve goes the way of the next one; at its end,
        // where it arrives, the second one counts backwards.
        let second = if t < 0.5 { self.second_derivative(t) } else { -self.second_derivative(t) };
        let [a, .., d] = self.points;
        [self.derivative(t), second, d - a].iter().find(|d| long_enough(d)).and_then(|d| unit(*d))
    }

    /// The two halves at `t`.
    #[must_use]
    pub fn split(&self, t: f64) -> (Self, Self) {
        let [a, b, c, d] = self.points;
        let (ab, bc, cd) = (lerp(a, b, t), lerp(b, c, t), lerp(c, d, t));
        let (abc, bcd) = (lerp(ab, bc, t), lerp(bc, cd, t));
        let middle = lerp(abc, bcd, t);
        (Self { points: [a, ab, abc, middle] }, Self { points: [middle, bcd, cd, d] })
    }

    /// The smallest box around the curve.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::of_points([self.points[0], self.points[3]]);
        let [a, b, c, d] = self.points;
        for axis in 0..3 {
            // A third of the derivative, as a polynomial.
            let (p, q, r) = (b - a, c - b, d - c);
            let turning = quadratic_roots((p - 2.0 * q + r)[axis], 2.0 * (q - p)[axis], p[axis]);
            let inside = turning.iter().copied().filter(|t| (0.0..=1.0).contains(t));
            bounds = inside.fold(bounds, |bounds, t| bounds.including(self.at(t)));
        }
        bounds
    }

    /// How many equal steps of the parameter keep the chords within `tolerance`, > 0, of the curve;
    /// at least 1, at most 65,536. Source: bound of the error of interpolation by the second
    /// derivative, |C''| / 8 step^2.
    #[must_use]
    pub fn steps_for(&self, tolerance: f64) -> u32 {
        steps_for(second_differences(&self.points), tolerance)
    }
}

/// Largest second derivative that four control points allow.
fn second_differences(p: &[DVec3; 4]) -> f64 {
    6.0 * (p[0] - 2.0 * p[1] + p[2]).length().max((p[1] - 2.0 * p[2] + p[3]).length())
}

/// Steps over [0, 1] that keep the chord error of a second derivative below the tolerance.
fn steps_for(second_derivative: f64, tolerance: f64) -> u32 {
    let steps = (second_derivative / (8.0 * tolerance)).sqrt().ceil();
    if steps.is_nan() { 1 } else { steps.clamp(1.0, 65_536.0) as u32 }
}

#[cfg(test)]
mod tests;
