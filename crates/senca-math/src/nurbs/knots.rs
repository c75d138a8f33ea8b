//! Knot vectors and the B-spline basis.

use super::{BezierPiece, blossom};
use crate::bezier::ControlPoint;

/// Why numbers are no B-spline curve or surface. All are mistakes in the data.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NurbsError {
    /// A degree of 0 or above [`KnotVector::MAX_DEGREE`].
    #[error("the degree must lie between 1 and 32, but is {0}")]
    Degree(usize),
    /// Too few knots for one piece.
    #[error("a degree of {degree} needs at least {needed} knots, but there are {found}")]
    TooFewKnots {
        /// The degree.
        degree: usize,
        /// 2 (degree + 1).
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A knot that is NaN or infinite.
    #[error("knot {index} is not a finite number")]
    NotFiniteKnot {
        /// Its index from 0.
        index: usize,
    },
    /// A knot below the one before it.
    #[error("the knots must not decrease, but knot {index} is below the one before it")]
    Decreasing {
        /// Its index from 0.
        index: usize,
    },
    /// A knot inside that is repeated so often that the curve would break there.
    #[error(
        "the knot {knot} is there {count} times; a degree of {degree} allows {degree} inside, one more at the ends"
    )]
    Multiplicity {
        /// The knot.
        knot: f64,
        /// How often it is there.
        count: usize,
        /// The degree.
        degree: usize,
    },
    /// The domain has no length.
    #[error("the domain is empty: its first and last knot are both {0}")]
    EmptyDomain(f64),
    /// A number of control points that does not fit the knots.
    #[error("these knots and degree need {expected} control points, but there are {found}")]
    PointCount {
        /// Knots - degree - 1, multiplied over both directions for a surface.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number of weights that does not fit the points.
    #[error("{expected} control points need as many weights, but there are {found}")]
    WeightCount {
        /// Number of points.
        expected: usize,
        /// Number of weights.
        found: usize,
    },
    /// A weight that is not positive and finite.
    #[error("weight {index} must be positive and finite, but is {weight}")]
    Weight {
        /// Its index from 0.
        index: usize,
        /// Its value.
        weight: f64,
    },
    /// A control point that is not finite.
    #[error("control point {index} is not finite")]
    NotFinitePoint {
        /// Its index from 0.
        index: usize,
    },
}

/// The knots and the degree of a B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
}

/// The basis functions that are not zero at a parameter.
pub(super) struct Basis {
    /// Index of the first of the degree + 1 functions.
    pub(super) first: usize,
    count: usize,
    // Room for the highest degree, so that evaluation allocates nothing.
    values: [f64; KnotVector::MAX_DEGREE + 1],
    derivatives: [f64; KnotVector::MAX_DEGREE + 1],
}

impl Basis {
    pub(super) fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }

    pub(super) fn derivatives(&self) -> &[f64] {
        &self.derivatives[..self.count]
    }
}

impl KnotVector {
    /// Highest degree, which [`NurbsError::Degree`] names too. Above it rounding spoils the basis, and no modeller writes it.
    pub const MAX_DEGREE: usize = 32;

    /// Knots for a degree. They must not decrease; the domain runs from knot `degree` to the knot
    /// `degree` places before the last. Neither uniform nor clamped knots are asked for.
    ///
    /// # Errors
    /// [`NurbsError`] says which knot is wrong.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, NurbsError> {
        if degree == 0 || degree > Self::MAX_DEGREE {
            return Err(NurbsError::Degree(degree));
        }
        let needed = 2 * (degree + 1);
        if knots.len() < needed {
            return Err(NurbsError::TooFewKnots { degree, needed, found: knots.len() });
        }
        if let Some(index) = knots.iter().position(|knot| !knot.is_finite()) {
            return Err(NurbsError::NotFiniteKnot { index });
        }
        if let Some(index) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(NurbsError::Decreasing { index: index + 1 });
        }
        let all = Self { degree, knots };
        all.check_multiplicity()?;
        let [start, end] = all.domain();
        if start < end { Ok(all) } else { Err(NurbsError::EmptyDomain(start)) }
    }

    /// Clamped uniform knots over [0, 1] for this many control points, so that the curve begins and
    /// ends in its first and last point.
    ///
    /// # Errors
    /// A degree out of range, or fewer than degree + 1 points.
    pub fn clamped_uniform(degree: usize, point_count: usize) -> Result<Self, NurbsError> {
        if point_count <= degree {
            let (needed, found) = (2 * (degree + 1), point_count + degree + 1);
            return Err(NurbsError::TooFewKnots { degree, needed, found });
        }
        let pieces = point_count - degree;
        let inside = (1..pieces).map(|k| k as f64 / pieces as f64);
        let ends = |value: f64| std::iter::repeat_n(value, degree + 1);
        Self::new(degree, ends(0.0).chain(inside).chain(ends(1.0)).collect())
    }

    fn check_multiplicity(&self) -> Result<(), NurbsError> {
        let degree = self.degree;
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let mut start = 0;
        while start < self.knots.len() {
            let knot = self.knots[start];
            let count = self.knots[start..].iter().take_while(|k| **k == knot).count();
            let allowed = if knot == first || knot == last { degree + 1 } else { degree };
            if count > allowed {
                return Err(NurbsError::Multiplicity { knot, count, degree });
            }
            start += count;
        }
        Ok(())
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// How many control points a curve over these knots has.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.point_count()]]
    }

    /// The basis functions at a parameter, as many as there are control points. They sum to 1 over
    /// the domain, to which the parameter is clamped.
    #[must_use]
    pub fn basis_functions(&self, t: f64) -> Vec<f64> {
        let basis = self.basis(t);
        let mut all = vec![0.0; self.point_count()];
        all[basis.first..][..=self.degree].copy_from_slice(basis.values());
        all
    }

    /// Index of the piece that holds a parameter: the last knot at or below it that has a longer knot
    /// after it, within the domain.
    fn span(&self, t: f64) -> usize {
        let (low, high) = (self.degree, self.point_count());
        let above = low + self.knots[low..high].partition_point(|knot| *knot <= t);
        let mut span = above.max(low + 1) - 1;
        // A parameter at the end of the domain belongs to the last piece of any length.
        while self.knots[span] == self.knots[span + 1] && span > low {
            span -= 1;
        }
        span
    }

    fn clamped(&self, t: f64) -> f64 {
        let [start, end] = self.domain();
        if t.is_nan() { start } else { t.clamp(start, end) }
    }

    /// Values and derivatives of the functions that are not zero at `t`, by Cox and de Boor's
    /// recursion; the functions of one degree less give the derivatives on the way.
    pub(super) fn basis(&self, t: f64) -> Basis {
        let t = self.clamped(t);
        let span = self.span(t);
        let none = [0.0; Self::MAX_DEGREE + 1];
        let first = span - self.degree;
        let mut basis = Basis { first, count: self.degree + 1, values: none, derivatives: none };
        basis.values[0] = 1.0;
        for degree in 1..=self.degree {
            let (mut carry, mut slope_carry) = (0.0, 0.0);
            for i in 0..degree {
                let (start, end) = (self.knots[span + 1 + i - degree], self.knots[span + 1 + i]);
                // The length is never zero: the interval holds the piece, which has one.
                let share = basis.values[i] / (end - start);
                basis.values[i] = carry + (end - t) * share;
                carry = (t - start) * share;
                // Only those of the last round are the derivatives; they overwrite the others.
                basis.derivatives[i] = slope_carry - degree as f64 * share;
                slope_carry = degree as f64 * share;
            }
            basis.values[degree] = carry;
            basis.derivatives[degree] = slope_carry;
        }
        basis
    }

    /// A curve over these knots as Bézier pieces, which is what inserting every knot up to the
    /// degree gives; computed by blossoming. `points` must be as many as [`Self::point_count`]; fewer
    /// give no pieces.
    #[must_use]
    pub fn bezier_pieces<T: ControlPoint>(&self, points: &[T]) -> Vec<BezierPiece<T>> {
        if points.len() < self.point_count() {
            return Vec::new();
        }
        let spans = (self.degree..self.point_count()).filter(|&k| self.knots[k] < self.knots[k + 1]);
        spans.map(|span| self.bezier_piece(span, &points[span - self.degree..=span])).collect()
    }

    fn bezier_piece<T: ControlPoint>(&self, span: usize, points: &[T]) -> BezierPiece<T> {
        let interval @ [start, end] = [self.knots[span], self.knots[span + 1]];
        let control = |j: usize| {
            let arguments: Vec<f64> = (0..self.degree).map(|i| if i < j { end } else { start }).collect();
            blossom(&self.knots, span, points, &arguments)
        };
        BezierPiece { interval, points: (0..=self.degree).filter_map(control).collect() }
    }
}
