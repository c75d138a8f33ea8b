//! Lines of the projective plane.
//!
//! A line is the set of homogeneous points `(x, y, w)` with `a x + b y + c w = 0`; `(a, b, c)` and any
//! multiple are the same line. Source: course text, section 1.4, example 1.4.

use glam::{DMat3, DVec3};

/// A line in the plane by its coefficients `(a, b, c)`, not all zero, in any scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line2 {
    /// The coefficients of x, y and w.
    pub coefficients: DVec3,
}

impl Line2 {
    /// The line through two homogeneous points, by the cross product; `None` when they are the same
    /// point.
    #[must_use]
    pub fn through(a: DVec3, b: DVec3) -> Option<Self> {
        Self::of(a.cross(b))
    }

    /// The same by the two incidence equations and the linear condition `a + b + c = 1`, or
    /// `a + b + c = 0` where that has no solution. The latter leaves the scale open, so the first
    /// coefficient that is not zero is then made 1; `None` when the points are the same.
    #[must_use]
    pub fn through_by_equations(a: DVec3, b: DVec3) -> Option<Self> {
        // Rows: incidence of A, incidence of B, sum of coefficients.
        let equations = DMat3::from_cols(a, b, DVec3::ONE).transpose();
        let scale = a.length() * b.length();
        if equations.determinant().abs() > 1e-12 * scale {
            return Self::of(equations.inverse() * DVec3::Z);
        }
        let free = Self::through(a, b)?.coefficients;
        let tiny = 1e-12 * free.length();
        let first = free.to_array().into_iter().find(|v| v.abs() > tiny)?;
        Self::of(free / first)
    }

    /// The same line with `a^2 + b^2 + c^2 = 1`.
    #[must_use]
    pub fn normalized(self) -> Self {
        Self { coefficients: self.coefficients.normalize_or_zero() }
    }

    /// Where two lines meet, as a homogeneous point (at infinity, `w = 0`, for parallels); `None` when
    /// they are the same line.
    #[must_use]
    pub fn intersection(self, other: Self) -> Option<DVec3> {
        Self::of(self.coefficients.cross(other.coefficients)).map(|line| line.coefficients)
    }

    /// Value of `a x + b y + c w`: zero on the line, for `w > 0` of opposite signs on its sides.
    #[must_use]
    pub fn incidence(self, point: DVec3) -> f64 {
        self.coefficients.dot(point)
    }

    fn of(coefficients: DVec3) -> Option<Self> {
        (coefficients.is_finite() && coefficients != DVec3::ZERO).then_some(Self { coefficients })
    }
}

/// A point of the line through A and B, `(1 - t) A + t B`, in homogeneous coordinates of any scale.
#[must_use]
pub fn point_between(a: DVec3, b: DVec3, t: f64) -> DVec3 {
    (1.0 - t) * a + t * b
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::test_support::vec3;

    fn parallel(a: DVec3, b: DVec3) -> bool {
        a.cross(b).length() < 1e-9 * a.length() * b.length()
    }

    #[test]
    fn both_constructions_give_the_worked_lines() {
        let cases = [
            (vec3(1, 0, 1), vec3(0, 1, 1), vec3(1, 1, -1)),
            (vec3(0, 0, 1), vec3(1, 1, 1), vec3(1, -1, 0)),
            (vec3(0, 0, 1), vec3(1, 0, 1), vec3(0, 1, 0)),
        ];
        for (a, b, expected) in cases {
            assert!(parallel(Line2::through(a, b).unwrap().coefficients, expected));
            let by_equations = Line2::through_by_equations(a, b).unwrap().coefficients;
            assert!((by_equations - expected).length() < 1e-12, "{by_equations}");
        }
    }

    #[test]
    fn parallels_meet_at_infinity_and_a_point_gives_no_line() {
        let a = Line2 { coefficients: vec3(1, 2, 3) };
        let b = Line2 { coefficients: vec3(1, 2, 7) };
        let at = a.intersection(b).unwrap();
        assert!(at.z == 0.0 && parallel(at, vec3(2, -1, 0)));
        assert!(a.intersection(a).is_none());
        assert!(Line2::through(vec3(1, 2, 1), vec3(2, 4, 2)).is_none());
        assert!(Line2::through_by_equations(vec3(1, 2, 1), vec3(2, 4, 2)).is_none());
        assert!((a.normalized().coefficients.length() - 1.0).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn a_line_holds_the_points_between(
            a in prop::array::uniform3(-5.0..5.0f64),
            b in prop::array::uniform3(-5.0..5.0f64),
            t in -3.0..3.0f64,
        ) {
            let (a, b) = (DVec3::from(a), DVec3::from(b));
            prop_assume!(a.cross(b).length() > 1e-3);
            let by_cross = Line2::through(a, b).unwrap();
            let by_equations = Line2::through_by_equations(a, b).unwrap();
            prop_assert!(by_cross.incidence(point_between(a, b, t)).abs() < 1e-10);
            prop_assert!(parallel(by_cross.coefficients, by_equations.coefficients));
        }
    }
}
