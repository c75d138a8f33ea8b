//! Barycentric coordinates of a point with respect to a triangle in space.

use super::{Matrix, Row3, cross, dot, length, subtract};
use crate::lab::LabError;

/// Share of the triangle's size that a point may be off its plane or edges and still counts as on them.
const TOLERANCE: f64 = 1e-9;

/// Where a point lies with respect to a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barycentric {
    /// The coordinates t1, t2, t3: T = t1 A + t2 B + t3 C.
    pub coordinates: Row3,
    /// The row of the system, 0 to 2, that was replaced by t1 + t2 + t3 = 1, because the system as it
    /// stands is singular. `None`: none had to be.
    pub replaced_row: Option<usize>,
    /// Distance of T from the plane of the triangle, positive on the side of its normal.
    pub distance: f64,
    /// Whether T lies in the plane of the triangle.
    pub in_plane: bool,
    /// Whether T lies in the triangle, its edges and corners included.
    pub inside: bool,
}

/// Barycentric coordinates of `t` in the triangle `a`, `b`, `c`.
///
/// The system has the corners as its columns. It is singular when the plane of the triangle goes
/// through the origin, which holds the manual's cases of a corner at the origin and of a triangle in
/// a coordinate plane. The remedy is to replace a row by t1 + t2 + t3 = 1; it works for row i when
/// component i of the normal is not 0, and the row of its largest component is taken. Without the
/// remedy the sum of the coordinates is 1 only for points of the plane.
///
/// # Errors
/// The corners lie on a line.
pub fn barycentric([a, b, c]: [Row3; 3], t: Row3) -> Result<Barycentric, LabError> {
    let normal = cross(subtract(b, a), subtract(c, a));
    let size = length(subtract(b, a)).max(length(subtract(c, a))).max(length(subtract(c, b)));
    let area = length(normal);
    if area.is_nan() || area <= 1e-13 * size * size {
        return Err(LabError::degenerate("the corners A, B and C lie on a line and are no triangle"));
    }
    let matrix = Matrix([a, b, c]).transpose();
    let (coordinates, replaced_row) = match matrix.inverse() {
        Some(inverse) => (inverse.transpose().transform(t), None),
        None => {
            let row = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
            let solved = solve_with_row_replaced([a, b, c], t, row);
            let none = || LabError::degenerate("the triangle is too thin to solve for a point in it");
            (solved.ok_or_else(none)?, Some(row))
        }
    };
    let distance = dot(normal, subtract(t, a)) / area;
    let in_plane = distance.abs() <= TOLERANCE * size;
    let between = coordinates.iter().all(|v| (-TOLERANCE..=1.0 + TOLERANCE).contains(v));
    Ok(Barycentric { coordinates, replaced_row, distance, in_plane, inside: in_plane && between })
}

/// The coordinates with row `row` of the system replaced by t1 + t2 + t3 = 1; `None` when that is
/// singular, too.
#[must_use]
pub fn solve_with_row_replaced(corners: [Row3; 3], t: Row3, row: usize) -> Option<Row3> {
    let mut matrix = Matrix(corners).transpose();
    let mut right = t;
    *matrix.0.get_mut(row)? = [1.0; 3];
    right[row] = 1.0;
    Some(matrix.inverse()?.transpose().transform(right))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [Row3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const OTHER: [Row3; 3] = [[1.0, 0.0, 1.0], [5.0, 0.0, 2.0], [3.0, 3.0, 4.0]];

    fn near(a: Row3, b: Row3) -> bool {
        length(subtract(a, b)) < 1e-14
    }

    #[test]
    fn regular_cases() {
        let third = 1.0 / 3.0;
        let cases = [
            (UNIT, [third; 3], [third; 3], true, true),
            (UNIT, [0.5, 0.5, 0.0], [0.5, 0.5, 0.0], true, true),
            (UNIT, [1.0, 1.0, -1.0], [1.0, 1.0, -1.0], true, false),
            (UNIT, [1.0, 1.0, 1.0], [1.0, 1.0, 1.0], false, false),
            (OTHER, [2.5, 0.75, 2.0], [0.5, 0.25, 0.25], true, true),
            (OTHER, [3.0, 1.0, 7.0 / 3.0], [third; 3], true, true),
            (OTHER, [-3.0, 0.0, 0.0], [2.0, -1.0, 0.0], true, false),
            (OTHER, [3.0, 1.0, 3.0], [13.0 / 9.0, 1.0 / 9.0, third], false, false),
        ];
        for (corners, t, expected, in_plane, inside) in cases {
            let found = barycentric(corners, t).expect("a triangle");
            assert!(near(found.coordinates, expected), "{t:?}: {found:?}");
            assert_eq!((found.replaced_row, found.in_plane, found.inside), (None, in_plane, inside), "{t:?}");
            // The sum is n.T / n.A, so it is 1 in the plane alone.
            let sum: f64 = found.coordinates.iter().sum();
            assert_eq!((sum - 1.0).abs() < 1e-14, in_plane);
        }
        assert_eq!(Matrix(OTHER).transpose().determinant(), 9.0);
    }

    #[test]
    fn singular_cases_and_which_rows_mend_them() {
        let (q, h) = (0.25, 0.5);
        let cases: [([Row3; 3], Row3, [bool; 3]); 3] = [
            ([[0.0; 3], [4.0, 0.0, 2.0], [0.0, 3.0, 1.0]], [1.0, 1.5, 1.0], [true; 3]),
            ([[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [1.0, 4.0, 0.0]], [2.0, 2.5, 0.0], [false, false, true]),
            ([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0]], [0.75, 0.75, 1.5], [true; 3]),
        ];
        for (corners, t, mends) in cases {
            assert_eq!(Matrix(corners).transpose().inverse(), None);
            for (row, mends) in mends.into_iter().enumerate() {
                let solved = solve_with_row_replaced(corners, t, row);
                assert_eq!(solved.map(|s| near(s, [q, q, h])), mends.then_some(true), "{corners:?} {row}");
            }
            let found = barycentric(corners, t).expect("a triangle");
            assert!(found.inside && found.replaced_row.is_some_and(|row| mends[row]), "{found:?}");
            assert!(near(found.coordinates, [q, q, h]));
        }
    }

    #[test]
    fn with_a_replaced_row_the_plane_is_tested_by_itself() {
        let corners = [[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [1.0, 4.0, 0.0]];
        let above = barycentric(corners, [2.0, 2.5, 0.5]).expect("a triangle");
        assert_eq!((above.distance, above.in_plane, above.inside), (0.5, false, false));
        assert!(near(above.coordinates, [0.25, 0.25, 0.5]), "the sum is 1 by construction");
    }

    #[test]
    fn a_line_is_no_triangle() {
        let line = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [3.0, 6.0, 9.0]];
        for corners in [line, [[1.0; 3]; 3], [[f64::INFINITY; 3]; 3]] {
            assert!(barycentric(corners, [0.0; 3]).is_err());
        }
        for row in 0..3 {
            assert_eq!(solve_with_row_replaced(line, [0.0; 3], row), None);
        }
    }
}
