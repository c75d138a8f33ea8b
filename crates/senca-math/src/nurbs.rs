//! B-spline and NURBS curves and surfaces of any degree.
//!
//! Control points of the rational forms are homogeneous, `(w x, w y, w z, w)` with w > 0, so that one
//! and the same sum serves both forms; a polynomial curve is one whose weights are all 1.
//!
//! Source: de Boor 1972; Piegl and Tiller, The NURBS Book, chapters 2 to 4.

mod knots;
mod surface;

use glam::{DVec3, DVec4};

use crate::bezier::ControlPoint;

pub use knots::{KnotVector, NurbsError};
pub use surface::{NurbsSurface, RationalPatch};

/// A rational B-spline curve.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve {
    knots: KnotVector,
    points: Vec<DVec4>,
}

/// A stretch of a piecewise curve as a Bézier curve of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPiece<T> {
    /// Parameters of the whole curve at the piece's ends.
    pub interval: [f64; 2],
    /// Its control points, one more than the degree.
    pub points: Vec<T>,
}

impl NurbsCurve {
    /// A curve from its knots, control points and weights; without weights all are 1.
    ///
    /// # Errors
    /// A count of points or weights that does not fit the knots, a point that is not finite, a weight
    /// that is not positive.
    pub fn new(knots: KnotVector, points: &[DVec3], weights: Option<&[f64]>) -> Result<Self, NurbsError> {
        let expected = knots.point_count();
        if points.len() != expected {
            return Err(NurbsError::PointCount { expected, found: points.len() });
        }
        let points = homogeneous_points(points, weights)?;
        Ok(Self { knots, points })
    }

    /// The knots, and with them degree and domain.
    #[must_use]
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The homogeneous control points.
    #[must_use]
    pub fn points(&self) -> &[DVec4] {
        &self.points
    }

    /// The point at a parameter, which is clamped to the domain.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.at_with_derivative(t).0
    }

    /// The point and the first derivative at a parameter, which is clamped to the domain. At a knot
    /// the derivative is that of the piece to the right, at the end of the domain to the left.
    #[must_use]
    pub fn at_with_derivative(&self, t: f64) -> (DVec3, DVec3) {
        let basis = self.knots.basis(t);
        let points = &self.points[basis.first..];
        let (value, slope) = (sum(basis.values(), points), sum(basis.derivatives(), points));
        let position = value.truncate() / value.w;
        (position, (slope.truncate() - position * slope.w) / value.w)
    }

    /// The curve as Bézier pieces, in order, with homogeneous control points.
    #[must_use]
    pub fn bezier_pieces(&self) -> Vec<BezierPiece<DVec4>> {
        self.knots.bezier_pieces(&self.points)
    }
}

fn sum(weights: &[f64], points: &[DVec4]) -> DVec4 {
    weights.iter().zip(points).map(|(w, p)| *w * *p).sum()
}

/// Control points with their weights multiplied in.
fn homogeneous_points(points: &[DVec3], weights: Option<&[f64]>) -> Result<Vec<DVec4>, NurbsError> {
    if let Some(weights) = weights
        && weights.len() != points.len()
    {
        return Err(NurbsError::WeightCount { expected: points.len(), found: weights.len() });
    }
    let weight = |i: usize| weights.map_or(1.0, |weights| weights[i]);
    let point = |(i, p): (usize, &DVec3)| {
        let w = weight(i);
        if !(w > 0.0 && w.is_finite()) {
            return Err(NurbsError::Weight { index: i, weight: w });
        }
        let h = (*p * w).extend(w);
        if h.is_finite() { Ok(h) } else { Err(NurbsError::NotFinitePoint { index: i }) }
    };
    points.iter().enumerate().map(point).collect()
}

/// The value of a polynomial piece's blossom: de Boor's scheme with another parameter in each round.
/// `points` are the degree + 1 points of the piece whose knots begin at index `span`.
fn blossom<T: ControlPoint>(knots: &[f64], span: usize, points: &[T], arguments: &[f64]) -> Option<T> {
    let degree = points.len() - 1;
    let mut work = points.to_vec();
    for (round, &t) in arguments.iter().enumerate() {
        for i in 0..degree - round {
            let (low, high) = (knots[span - degree + 1 + i + round], knots[span + 1 + i]);
            let s = (t - low) / (high - low);
            work[i] = work[i] * (1.0 - s) + work[i + 1] * s;
        }
    }
    work.first().copied()
}

#[cfg(test)]
mod tests;
