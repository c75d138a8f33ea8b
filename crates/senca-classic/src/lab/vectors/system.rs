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
#[must_use]
pub fn solve_system(equations: &[[f64; 4]; 3]) -> Solution {
    let coefficients = Matrix(equations.map(|[x, y, z, _]| [x, y, z]));
    let right = equations.map(|e| e[3]);
    match coefficients.inverse() {
        // A [x y z]^T = b, so [x y z]^T = A^-1 b; as rows, [x y z] = b (A^-1)^T.
        Some(inverse) => Solution::One(inverse.transpose().transform(right)),
        None => singular(equations),
    }
}

/// What a singular system has, by the ranks of its matrix without and with the right side.
fn singular(equations: &[[f64; 4]; 3]) -> Solution {
    let without = rank(equations.map(|[x, y, z, _]| [x, y, z, 0.0]));
    let with = rank(*equations);
    match without {
        _ if with > without => Solution::None,
        0 => Solution::Space,
        1 => Solution::Plane,
        _ => Solution::Line,
    }
}

/// How many rows are independent, by elimination; what is below 1e-12 of its row's largest number is 0.
fn rank(mut rows: [[f64; 4]; 3]) -> usize {
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
    rank
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
}
