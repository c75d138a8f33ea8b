//! The system of three linear equations.

use super::{Matrix, Row3};

/// What a system of three equations with three unknowns has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solution {
    /// One solution, x, y, z: three planes that meet in a point.
    One(Row3),
    /// As many as a line has points.
    Line,
    /// As many as a plane has points.
    Plane,
    /// As many as space has points: all coefficients are 0.
    Space,
    /// None: the equations contradict each other.
    None,
}

/// Solves three equations, each its coefficients of x, y and z and its right side, by the inverse of
/// the matrix of coefficients. The manual does not say what happens to singular systems; here it is
/// told what they have.
///
/// Before that, equations and unknowns are scaled by powers of two so that their largest coefficients are
/// about 1, which changes no digit of the solution. Where the determinant is too small for the inverse but the
/// equations are independent, they are solved by elimination.
#[must_use]
pub fn solve_system(equations: &[[f64; 4]; 3]) -> Solution {
    let (scaled, units) = balanced(*equations);
    let coefficients = Matrix(scaled.map(|[x, y, z, _]| [x, y, z]));
    let right = scaled.map(|e| e[3]);
    let solution = match coefficients.inverse() {
        // A [x y z]^T = b, so [x y z]^T = A^-1 b; as rows, [x y z] = b (A^-1)^T.
        Some(inverse) => Solution::One(inverse.transpose().transform(right)),
        None => by_rank(scaled),
    };
    match solution {
        Solution::One(found) => Solution::One(std::array::from_fn(|k| found[k] * units[k])),
        other => other,
    }
}

/// The equations with their largest coefficients, in each equation and of each unknown, brought near 1 by
/// powers of two; and what the unknowns have to be multiplied by in the end.
fn balanced(mut equations: [[f64; 4]; 3]) -> ([[f64; 4]; 3], Row3) {
    for equation in &mut equations {
        let unit = unit_of(equation[..3].iter());
        *equation = equation.map(|v| v * unit);
    }
    let units = std::array::from_fn(|k| unit_of(equations.iter().map(|e| &e[k])));
    for equation in &mut equations {
        (0..3).for_each(|k| equation[k] *= units[k]);
    }
    (equations, units)
}

/// The power of two that brings the largest of some numbers near 1; 1 where all are 0.
fn unit_of<'a>(numbers: impl Iterator<Item = &'a f64>) -> f64 {
    let largest = numbers.fold(0.0_f64, |m, v| m.max(v.abs()));
    let power = if largest > 0.0 { -largest.log2().floor() } else { 0.0 };
    2.0_f64.powi(power.clamp(-1000.0, 1000.0) as i32)
}

/// What a system has whose matrix has no inverse, by the ranks of its matrix without and with the right side.
fn by_rank(equations: [[f64; 4]; 3]) -> Solution {
    let (without, _) = eliminated(equations.map(|[x, y, z, _]| [x, y, z, 0.0]));
    let (with, rows) = eliminated(equations);
    match without {
        3 => Solution::One(substituted(&rows)),
        _ if with > without => Solution::None,
        0 => Solution::Space,
        1 => Solution::Plane,
        _ => Solution::Line,
    }
}

/// How many rows are independent, and the rows after elimination; what is below 1e-12 of its row's largest
/// number is 0.
fn eliminated(mut rows: [[f64; 4]; 3]) -> (usize, [[f64; 4]; 3]) {
    for row in &mut rows {
        let largest = row.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        *row = row.map(|v| if largest > 0.0 { v / largest } else { v });
    }
    let mut rank = 0;
    for column in 0..4 {
        let pivot = (rank..3).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()));
        let Some(pivot) = pivot.filter(|&p| rows[p][column].abs() > 1e-12) else { continue };
        rows.swap(rank, pivot);
        for row in rank + 1..3 {
            let factor = rows[row][column] / rows[rank][column];
            rows[row] = std::array::from_fn(|j| rows[row][j] - factor * rows[rank][j]);
        }
        rank += 1;
    }
    (rank, rows)
}

/// The unknowns of three eliminated equations, the last one first.
fn substituted(rows: &[[f64; 4]; 3]) -> Row3 {
    let mut found = [0.0; 3];
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|j| rows[i][j] * found[j]).sum();
        found[i] = (rows[i][3] - known) / rows[i][i];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_manual() {
        let equations = [[1.0, 1.0, 1.0, 6.0], [-1.0, -2.0, 1.0, -2.0], [2.0, 1.0, 3.0, 13.0]];
        assert_eq!(solve_system(&equations), Solution::One([1.0, 2.0, 3.0]));
        let matrix = Matrix(equations.map(|[x, y, z, _]| [x, y, z]));
        assert_eq!(matrix.determinant(), 1.0);
        let inverse = Matrix([[-7.0, -2.0, 3.0], [5.0, 1.0, -2.0], [3.0, 1.0, -1.0]]);
        assert_eq!(matrix.inverse(), Some(inverse));
    }

    #[test]
    fn singular_systems_are_told_apart() {
        let of = |a, b, c| solve_system(&[a, b, c]);
        let (x, y) = ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 2.0]);
        assert_eq!(of(x, y, [1.0, 1.0, 0.0, 3.0]), Solution::Line);
        assert_eq!(of(x, y, [1.0, 1.0, 0.0, 4.0]), Solution::None);
        assert_eq!(of(x, [2.0, 0.0, 0.0, 2.0], [0.0; 4]), Solution::Plane);
        assert_eq!(of(x, [2.0, 0.0, 0.0, 3.0], y), Solution::None);
        assert_eq!(of([0.0; 4], [0.0; 4], [0.0; 4]), Solution::Space);
        assert_eq!(of([0.0; 4], [0.0, 0.0, 0.0, 1e-300], [0.0; 4]), Solution::None);
    }

    #[test]
    fn large_small_and_nearly_dependent_numbers() {
        let near = |solution: Solution, expected: Row3| match solution {
            Solution::One(found) => {
                assert!(
                    (0..3).all(|k| (found[k] / expected[k] - 1.0).abs() < 1e-6),
                    "{found:?} {expected:?}"
                );
            }
            other => panic!("{other:?}"),
        };
        let large = [[1e308, 1e308, 1e308, 1e308], [1.0, -1.0, 1.0, 3.0], [0.0, 0.0, 1.0, 7.0]];
        near(solve_system(&large), [-5.0, -1.0, 7.0]);
        let small = [[1e-300, 0.0, 0.0, 2e-300], [0.0, 1e200, 1e200, 5e200], [0.0, 1.0, -1.0, 1.0]];
        near(solve_system(&small), [2.0, 3.0, 2.0]);
        let thin =
            [[1.0, 1.0, 1.0, 6.0], [1.0, 1.0 + 1e-7, 1.0, 6.0 + 2e-7], [1.0, 1.0, 1.0 + 1e-7, 6.0 + 3e-7]];
        near(solve_system(&thin), [1.0, 2.0, 3.0]);
        assert_eq!(solve_system(&[[0.0; 4]; 3].map(|_| [f64::MIN_POSITIVE, 0.0, 0.0, 0.0])), Solution::Plane);
    }
}
