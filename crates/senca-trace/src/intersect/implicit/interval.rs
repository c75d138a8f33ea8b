//! Roots along a ray by interval arithmetic, for any formula.
//!
//! 1. If the bounds of f over an interval exclude 0, it has no root there.
//! 2. If the bounds of f' exclude 0, f is monotone there, and has a root exactly if its sign changes.
//! 3. Else the interval is halved, leaving out around the middle m what the bounds of f' say is too near
//!    for f to reach 0 from f(m): interval Newton with a divisor that contains 0.
//! 4. Intervals that have become too short to matter are judged by the signs at their ends.
//!
//! So no root is missed, but pairs of roots within the tolerance. Source: Moore 1966; Hansen 1978;
//! Mitchell 1990 for rays.

use senca_math::{Expression, Interval};
use smallvec::SmallVec;

use crate::Ray;

/// Share of the whole stretch below which two roots may be taken for none.
const TOLERANCE: f64 = 1e-10;

/// Most evaluations for one ray: hostile formulas must end. Intervals left over are judged by the signs
/// at their ends.
const BUDGET: u32 = 20_000;

/// The roots of a formula between two parameters of a ray, one by one, ascending.
pub(super) struct IntervalRoots<'a> {
    expression: &'a Expression,
    ray: &'a Ray,
    tolerance: f64,
    /// Intervals not yet looked into, the first on top.
    open: SmallVec<[[f64; 2]; 32]>,
    left: u32,
}

impl<'a> IntervalRoots<'a> {
    /// The roots between `start` and `end`, both finite.
    pub(super) fn new(expression: &'a Expression, ray: &'a Ray, start: f64, end: f64) -> Self {
        let least = 8.0 * f64::EPSILON * start.abs().max(end.abs());
        let tolerance = (TOLERANCE * (end - start)).max(least);
        Self { expression, ray, tolerance, open: SmallVec::from_slice(&[[start, end]]), left: BUDGET }
    }

    /// Value and derivative at one parameter.
    fn value(&self, t: f64) -> (f64, f64) {
        self.expression.value_along_ray(self.ray.origin, self.ray.direction, t)
    }

    /// Bounds of value and derivative.
    fn bounds(&self, t: Interval) -> (Interval, Interval) {
        self.expression.interval_along_ray(self.ray.origin, self.ray.direction, t)
    }

    /// Whether the formula is negative at a parameter. Where it is not defined it is not.
    pub(super) fn is_inside(&self, t: f64) -> bool {
        self.value(t).0 < 0.0
    }

    /// The root of an interval, if the signs at its ends differ.
    fn between(&self, [low, high]: [f64; 2]) -> Option<f64> {
        let inside_low = self.is_inside(low);
        (inside_low != self.is_inside(high)).then(|| self.refined(low, high, inside_low))
    }

    /// Bracketed Newton down to neighbouring numbers.
    fn refined(&self, mut low: f64, mut high: f64, inside_low: bool) -> f64 {
        let mut t = 0.5 * (low + high);
        for _ in 0..128 {
            let (value, slope) = self.value(t);
            if (value < 0.0) == inside_low {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - t).abs() <= f64::EPSILON * t.abs() || next <= low && next >= high {
                return next;
            }
            t = next;
        }
        t
    }

    /// Puts both halves back, without what is too near to the middle for a root.
    fn split(&mut self, [low, high]: [f64; 2], slope: Interval) {
        let middle = 0.5 * (low + high);
        self.left = self.left.saturating_sub(1);
        let [below, above] = gap(self.bounds(Interval::point(middle)).0, slope);
        if middle + above < high {
            self.open.push([middle + above, high]);
        }
        if low < middle - below {
            self.open.push([low, middle - below]);
        }
    }
}

/// How far from a place with values within `value` there is no root below and above it, for slopes
/// within `slope`.
fn gap(value: Interval, slope: Interval) -> [f64; 2] {
    let nearest = if value.min > 0.0 {
        value.min
    } else if value.max < 0.0 {
        -value.max
    } else {
        return [0.0, 0.0];
    };
    let (falling, rising) = ((-slope.min).max(0.0), slope.max.max(0.0));
    // From above 0 the way down is falling to the right and rising to the left.
    let (left, right) = if value.min > 0.0 { (rising, falling) } else { (falling, rising) };
    // Shortened against rounding; no slope at all leaves no root on that side.
    [left, right].map(|slope| nearest / slope * (1.0 - 1e-9))
}

impl Iterator for IntervalRoots<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        while let Some(piece) = self.open.pop() {
            let [low, high] = piece;
            let short = high - low <= self.tolerance || self.left == 0;
            self.left = self.left.saturating_sub(1);
            let (value, slope) = self.bounds(Interval { min: low, max: high });
            if !short {
                if value.is_empty() || !value.contains_zero() {
                    continue;
                }
                if slope.contains_zero() || slope.is_empty() {
                    self.split(piece, slope);
                    continue;
                }
            }
            if let Some(root) = self.between(piece) {
                return Some(root);
            }
        }
        None
    }
}
