//! Transforms as matrices: rows on the left, the translation in the bottom row.
//!
//! A product of several matrices is calculated once and applied to every point; three rotations of one point by three
//! matrices cost 27 multiplications, the nine coefficients worked out by hand 16 and then 9 a point.
//!
//! Source: Savchenko 1995, "Representing transformations in matrix form".

use std::ops::Mul;

use super::angle::{Angles, Tables};
use super::rotate::Rotation;

/// A matrix of `R` rows and `C` columns; a row vector is a matrix of one row, a column vector one of one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<const R: usize, const C: usize>(pub [[f64; C]; R]);

impl<const R: usize, const N: usize, const C: usize> Mul<Matrix<N, C>> for Matrix<R, N> {
    type Output = Matrix<R, C>;

    fn mul(self, right: Matrix<N, C>) -> Matrix<R, C> {
        let element = |r: usize, c: usize| (0..N).map(|k| self.0[r][k] * right.0[k][c]).sum();
        Matrix(std::array::from_fn(|r| std::array::from_fn(|c| element(r, c))))
    }
}

impl Matrix<4, 4> {
    /// Moves by `by`: the identity with the translation in the bottom row.
    #[must_use]
    pub fn translation([x, y, z]: [f64; 3]) -> Self {
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [x, y, z, 1.0]])
    }

    /// Scales each axis by its factor.
    #[must_use]
    pub fn scaling([x, y, z]: [f64; 3]) -> Self {
        Self([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, 1.0]])
    }
}

impl Matrix<3, 3> {
    /// The rotation about all three axes.
    #[must_use]
    pub fn rotation(tables: &Tables<f64>, angles: Angles) -> Self {
        let rows = Rotation::new(tables, angles).rows;
        Self(std::array::from_fn(|r| std::array::from_fn(|c| rows[c][r])))
    }

    /// The same as a matrix that takes points with a fourth coordinate 1.
    #[must_use]
    pub fn homogeneous(self) -> Matrix<4, 4> {
        let element = |r: usize, c: usize| {
            if r < 3 && c < 3 { self.0[r][c] } else { f64::from(u8::from(r == c)) }
        };
        Matrix(std::array::from_fn(|r| std::array::from_fn(|c| element(r, c))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rows_columns_and_products() {
        let row = Matrix([[1.0, 2.0, 3.0]]);
        let column = Matrix([[4.0], [5.0], [6.0]]);
        assert_eq!((row * column).0, [[32.0]]);
        assert_eq!((column * row).0[2], [6.0, 12.0, 18.0]);
        // (x y z) times a b c / d e f / g h i
        let m = Matrix([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]);
        assert_eq!((row * m).0, [[30.0, 36.0, 42.0]]);
    }

    #[test]
    fn points_have_a_fourth_coordinate() {
        let point = Matrix([[1.0, 2.0, 3.0, 1.0]]);
        assert_eq!((point * Matrix::translation([10.0, 20.0, 30.0])).0, [[11.0, 22.0, 33.0, 1.0]]);
        assert_eq!((point * Matrix::scaling([2.0, 3.0, 4.0])).0, [[2.0, 6.0, 12.0, 1.0]]);
        let quarter = Matrix::rotation(&Tables::exact(), Angles::alp_bet_gam(0, 0, 64));
        assert_eq!((point * quarter.homogeneous()).0, [[3.0, 2.0, -1.0, 1.0]]);
        // To move things there is to move the frame back.
        let back = Matrix::translation([1.0, 2.0, 3.0]) * Matrix::translation([-1.0, -2.0, -3.0]);
        assert_eq!(back, Matrix::scaling([1.0; 3]));
    }

    proptest! {
        #[test]
        fn three_rotations_are_one(alp: u8, bet: u8, gam: u8, p in prop::array::uniform3(-100f64..100.0)) {
            let one = |a, b, g| Matrix::rotation(&Tables::exact(), Angles::alp_bet_gam(a, b, g));
            let (roll, pitch, heading) = (one(alp, 0, 0), one(0, bet, 0), one(0, 0, gam));
            let all = one(alp, bet, gam);
            let product = heading * pitch * roll;
            let (one_by_one, at_once) = (((Matrix([p]) * heading) * pitch) * roll, Matrix([p]) * all);
            for k in 0..3 {
                prop_assert!((0..3).all(|j| (product.0[k][j] - all.0[k][j]).abs() < 1e-12));
                prop_assert!((one_by_one.0[0][k] - at_once.0[0][k]).abs() < 1e-9);
            }
        }
    }
}
