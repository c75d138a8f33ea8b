//! The form factors of all pairs.

use rayon::prelude::*;

use super::Rgb64;
use crate::form_factor::FormFactors;

/// Form factors by row: row i holds F_i->j, the share of light from patch i that lands on patch j.
/// Pairs that do not see each other are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FactorMatrix {
    /// Row i is `starts[i]..starts[i + 1]` of the others; columns ascend.
    starts: Vec<usize>,
    columns: Vec<u32>,
    factors: Vec<f64>,
}

impl FactorMatrix {
    /// From rows of column and factor; zeros are dropped, entries of a column that comes twice are
    /// added.
    ///
    /// # Panics
    /// When a column is not that of a row.
    #[must_use]
    pub fn from_rows(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut matrix = Self { starts: vec![0], columns: Vec::new(), factors: Vec::new() };
        for mut row in rows {
            row.sort_by_key(|&(column, _)| column);
            let first = matrix.columns.len();
            for (column, factor) in row {
                if factor == 0.0 {
                    continue;
                }
                if matrix.columns.len() > first && matrix.columns.last() == Some(&column) {
                    *matrix.factors.last_mut().unwrap_or(&mut 0.0) += factor;
                    continue;
                }
                matrix.columns.push(column);
                matrix.factors.push(factor);
            }
            matrix.starts.push(matrix.columns.len());
        }
        let n = matrix.len() as u32;
        assert!(matrix.columns.iter().all(|&column| column < n), "a column beyond the last row");
        matrix
    }

    /// From rows written out.
    ///
    /// # Panics
    /// When a row is longer than there are rows.
    #[must_use]
    pub fn from_dense<R: AsRef<[f64]>>(rows: &[R]) -> Self {
        Self::from_rows(rows.iter().map(|row| (0..).zip(row.as_ref().iter().copied()).collect()))
    }

    /// From a matrix that was computed by one of the methods.
    #[must_use]
    pub fn from_form_factors(factors: &FormFactors) -> Self {
        let rows: Vec<&[f64]> = (0..factors.size()).map(|i| factors.row(i)).collect();
        Self::from_dense(&rows)
    }

    /// Number of rows, which is that of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there is no patch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Pairs that exchange light.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.factors.len()
    }

    /// Columns and factors of a row, in ascending order of columns.
    #[inline]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[i]..self.starts[i + 1];
        let columns = self.columns[range.clone()].iter().map(|&column| column as usize);
        columns.zip(self.factors[range].iter().copied())
    }

    /// F_i->j.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let range = self.starts[i]..self.starts[i + 1];
        let found = self.columns[range.clone()].binary_search(&(j as u32));
        found.map_or(0.0, |at| self.factors[range.start + at])
    }

    /// F_i->i; 0 for flat patches.
    #[must_use]
    pub fn own(&self, i: usize) -> f64 {
        self.get(i, i)
    }

    /// Share of light from a patch that lands on any patch: 1 in closed scenes, less in open ones.
    #[must_use]
    pub fn row_sum(&self, i: usize) -> f64 {
        self.factors[self.starts[i]..self.starts[i + 1]].iter().sum()
    }

    /// The largest of the row sums; more than 1 shows errors of the factors.
    #[must_use]
    pub fn largest_row_sum(&self) -> f64 {
        (0..self.len()).map(|i| self.row_sum(i)).fold(0.0, f64::max)
    }

    /// The largest of |A_i F_i->j - A_j F_j->i| as a share of the smaller area: 0 where factors are
    /// exact (equation 4.2).
    #[must_use]
    pub fn reciprocity_error(&self, areas: &[f64]) -> f64 {
        let mut worst = 0.0f64;
        for i in 0..self.len() {
            for (j, factor) in self.row(i) {
                let there = areas[i] * factor;
                let back = areas[j] * self.get(j, i);
                worst = worst.max((there - back).abs() / areas[i].min(areas[j]));
            }
        }
        worst
    }

    /// Scales rows that sum to more than `limit` down to it. Tells how many there were.
    pub fn limit_row_sums(&mut self, limit: f64) -> usize {
        let mut scaled = 0;
        for i in 0..self.len() {
            let sum = self.row_sum(i);
            if sum > limit {
                scaled += 1;
                for factor in &mut self.factors[self.starts[i]..self.starts[i + 1]] {
                    *factor *= limit / sum;
                }
            }
        }
        scaled
    }

    /// Sum over j of F_i->j times the values of j.
    #[inline]
    #[must_use]
    pub fn gather(&self, i: usize, values: &[Rgb64]) -> Rgb64 {
        let mut sum = [0.0; 3];
        for (j, factor) in self.row(i) {
            let value = &values[j];
            for c in 0..3 {
                sum[c] += factor * value[c];
            }
        }
        sum
    }

    /// [`FactorMatrix::gather`] for every row, by all threads of the current rayon pool.
    #[must_use]
    pub fn gather_all(&self, values: &[Rgb64]) -> Vec<Rgb64> {
        (0..self.len()).into_par_iter().with_min_len(16).map(|i| self.gather(i, values)).collect()
    }

    /// Bytes of memory that this holds on to.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.starts) + size_of_val(&*self.columns) + size_of_val(&*self.factors)
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.factors
    }
}
