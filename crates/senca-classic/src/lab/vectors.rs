//! Exercise 1: vectors and matrices, the system of three equations, barycentric coordinates.
//!
//! Vectors are rows `[x, y, z]`; a row is multiplied by a matrix from the right.

mod barycentric;
mod system;

pub use barycentric::{Barycentric, barycentric, solve_with_row_replaced};
pub use system::{Solution, solve_system};

/// A vector or point of space, as a row.
pub type Row3 = [f64; 3];

/// A homogeneous point, as a row.
pub type Row4 = [f64; 4];

/// `a + b`.
#[must_use]
pub fn add(a: Row3, b: Row3) -> Row3 {
    std::array::from_fn(|i| a[i] + b[i])
}

/// `a - b`.
#[must_use]
pub fn subtract(a: Row3, b: Row3) -> Row3 {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `a` times `factor`.
#[must_use]
pub fn scale(a: Row3, factor: f64) -> Row3 {
    a.map(|v| v * factor)
}

/// Scalar product (1.2).
#[must_use]
pub fn dot(a: Row3, b: Row3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Euclidean length.
#[must_use]
pub fn length(a: Row3) -> f64 {
    dot(a, a).sqrt()
}

/// Cosine of the angle between two vectors (1.3); `None` when one has no length.
#[must_use]
pub fn cosine(a: Row3, b: Row3) -> Option<f64> {
    let lengths = length(a) * length(b);
    (lengths > 0.0).then(|| (dot(a, b) / lengths).clamp(-1.0, 1.0))
}

/// How long the shadow of `a` on `b` is, negative when it points away (1.4); `None` for `b` without
/// length.
#[must_use]
pub fn scalar_projection(a: Row3, b: Row3) -> Option<f64> {
    let length = length(b);
    (length > 0.0).then(|| dot(a, b) / length)
}

/// The shadow of `a` on `b` (1.5); `None` for `b` without length.
#[must_use]
pub fn vector_projection(a: Row3, b: Row3) -> Option<Row3> {
    let square = dot(b, b);
    (square > 0.0).then(|| scale(b, dot(a, b) / square))
}

/// Vector product by the rule of the right hand (1.6).
#[must_use]
pub fn cross(a: Row3, b: Row3) -> Row3 {
    [a[1] * b[2] - a[2] * b[1], -a[0] * b[2] + a[2] * b[0], a[0] * b[1] - a[1] * b[0]]
}

/// The vector of length 1 with the same direction; `None` for one without length.
#[must_use]
pub fn normalized(a: Row3) -> Option<Row3> {
    let length = length(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|v| v / length))
}

/// A square matrix of `N` rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<const N: usize>(
    /// Its rows.
    pub [[f64; N]; N],
);

impl<const N: usize> Matrix<N> {
    /// Ones on the diagonal.
    pub const IDENTITY: Self = {
        let mut rows = [[0.0; N]; N];
        let mut i = 0;
        while i < N {
            rows[i][i] = 1.0;
            i += 1;
        }
        Self(rows)
    };

    /// Sum.
    #[must_use]
    pub fn add(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }

    /// Product `self * other`; a chain reads from left to right.
    #[must_use]
    pub fn multiply(&self, other: &Self) -> Self {
        Self(self.0.map(|row| other.transform(row)))
    }

    /// A row times this matrix.
    #[must_use]
    pub fn transform(&self, row: [f64; N]) -> [f64; N] {
        std::array::from_fn(|j| (0..N).map(|i| row[i] * self.0[i][j]).sum())
    }

    /// Rows as columns.
    #[must_use]
    pub fn transpose(&self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[j][i])))
    }

    /// Determinant, by expansion along the first row.
    #[must_use]
    pub fn determinant(&self) -> f64 {
        let all: [usize; N] = std::array::from_fn(|i| i);
        self.minor(&all, &all)
    }

    /// Determinant of what is left of these rows and columns.
    fn minor(&self, rows: &[usize], columns: &[usize]) -> f64 {
        let Some((&first, rows)) = rows.split_first() else { return 1.0 };
        let mut sum = 0.0;
        for (k, &column) in columns.iter().enumerate() {
            let others: Vec<_> = columns.iter().copied().filter(|&c| c != column).collect();
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sum += sign * self.0[first][column] * self.minor(rows, &others);
        }
        sum
    }

    /// Inverse by cofactors; `None` for a singular matrix.
    ///
    /// A determinant counts as 0 when it is not larger than what rounding makes of it: 1e-13 of the
    /// product of the rows' lengths, which no determinant exceeds.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let determinant = self.determinant();
        let lengths: f64 = self.0.iter().map(|row| row.iter().map(|v| v * v).sum::<f64>().sqrt()).product();
        if determinant.is_nan() || determinant.abs() <= 1e-13 * lengths {
            return None;
        }
        let without = |k: usize| (0..N).filter(|&i| i != k).collect::<Vec<_>>();
        let cofactor = |i: usize, j: usize| {
            let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * self.minor(&without(i), &without(j))
        };
        Some(Self(std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))))
    }
}

/// What the first task of the exercise computes from its constants.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstTask {
    /// (2, 3, -4) + (-1, 4, -1).
    pub v1: Row3,
    /// v1 . (-1, 4, -1).
    pub s: f64,
    /// v1 x (2, 2, 4).
    pub v2: Row3,
    /// Length of v2.
    pub v2_length: f64,
    /// v2 with length 1. The manual prints the bars of a length, but says unit vector.
    pub v3: Row3,
    /// -v2.
    pub v4: Row3,
    /// A + B.
    pub m1: Matrix<3>,
    /// A B^T.
    pub m2: Matrix<3>,
    /// A B^-1.
    pub m3: Matrix<3>,
    /// A homogeneous point, scaled and moved.
    pub v: Row4,
}

impl FirstTask {
    /// The matrix A of the task.
    pub const A: Matrix<3> = Matrix([[1.0, 2.0, 3.0], [2.0, 1.0, 3.0], [4.0, 5.0, 1.0]]);
    /// The matrix B of the task.
    pub const B: Matrix<3> = Matrix([[-1.0, 2.0, -3.0], [5.0, -2.0, 7.0], [-4.0, -1.0, 3.0]]);
    /// The matrix that the homogeneous point is multiplied by.
    pub const MOVE: Matrix<4> =
        Matrix([[1.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [2.0, 3.0, 3.0, 1.0]]);

    /// The vectors whose sum is v1.
    pub const SUMMANDS: [Row3; 2] = [[2.0, 3.0, -4.0], Self::OTHER];
    /// The vector of the scalar product with v1.
    pub const OTHER: Row3 = [-1.0, 4.0, -1.0];
    /// The vector of the vector product with v1.
    pub const FACTOR: Row3 = [2.0, 2.0, 4.0];
    /// The homogeneous point.
    pub const POINT: Row4 = [1.0, 2.0, 3.0, 1.0];

    /// Computes all of it.
    #[must_use]
    pub fn compute() -> Self {
        let v1 = add(Self::SUMMANDS[0], Self::SUMMANDS[1]);
        let v2 = cross(v1, Self::FACTOR);
        let inverse = Self::B.inverse().unwrap_or(Matrix::IDENTITY);
        Self {
            v1,
            s: dot(v1, Self::OTHER),
            v2,
            v2_length: length(v2),
            v3: scale(v2, 1.0 / length(v2)),
            v4: scale(v2, -1.0),
            m1: Self::A.add(&Self::B),
            m2: Self::A.multiply(&Self::B.transpose()),
            m3: Self::A.multiply(&inverse),
            v: Self::MOVE.transform(Self::POINT),
        }
    }
}

#[cfg(test)]
mod tests;
