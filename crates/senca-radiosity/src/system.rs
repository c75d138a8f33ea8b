//! The system of equations: `B_i - reflectance_i * sum over j of F_i->j B_j = E_i` (course text,
//! section 4.1, equations 4.1 to 4.5), and ways to solve it.
//!
//! The matrix is `m_ii = 1 - rho_i F_i->i`, `m_ij = -rho_i F_i->j`. The three channels have the same
//! factors and are solved side by side, in double precision.
//!
//! | solver | one step |
//! |---|---|
//! | [`GaussSeidel`] | every patch gathers, from the newest values (exercise 4.4) |
//! | [`Jacobi`] | every patch gathers, from the values of the step before; one more bounce of light each |
//! | [`Shooting`] | the patch with most light not yet sent sends it to all others (Southwell; Cohen et al. 1988) |
//!
//! The first two start from E. Gathering converges when each row's diagonal exceeds the sum of the
//! others ([`System::dominance`], exercise 4.6), which holds for reflectances below 1 and rows of
//! factors that sum to at most 1. [`System::new`] refuses reflectances of 1 or more;
//! [`FactorMatrix::limit_row_sums`] mends rows that came out too large.

mod matrix;
mod shooting;
mod solvers;
mod two_level;

#[cfg(test)]
mod tests;

use crate::RadiosityError;

pub use matrix::FactorMatrix;
pub use shooting::Shooting;
pub use solvers::{GaussSeidel, Jacobi, Outcome, StopRule};
pub use two_level::{condensed, parts};

/// A value per channel: red, green, blue.
pub type Rgb64 = [f64; 3];

/// The system (4.5) for all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    factors: FactorMatrix,
    areas: Vec<f64>,
    reflectance: Vec<Rgb64>,
    emission: Vec<Rgb64>,
}

/// How power is spent, per channel, in area times light as shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PowerBalance {
    /// Given off: the sum of A E.
    pub emitted: Rgb64,
    /// Kept by surfaces: the sum of A (1 - reflectance) H.
    pub absorbed: Rgb64,
    /// Sent where no patch is, as rows of factors that sum to less than 1 say.
    pub lost: Rgb64,
}

impl System {
    /// The system of patches with these factors, areas (> 0), reflectances in [0, 1) and emissions
    /// (>= 0).
    ///
    /// # Errors
    /// [`RadiosityError::Setting`] names the first number that is out of its range.
    ///
    /// # Panics
    /// When the lengths differ.
    pub fn new(
        factors: FactorMatrix,
        areas: Vec<f64>,
        reflectance: Vec<Rgb64>,
        emission: Vec<Rgb64>,
    ) -> Result<Self, RadiosityError> {
        let n = factors.len();
        assert_eq!([areas.len(), reflectance.len(), emission.len()], [n; 3], "lengths differ");
        let all = |values: &[Rgb64]| values.iter().flatten().copied().collect::<Vec<f64>>();
        check("area", &areas, "above 0 and finite", |a| a > 0.0 && a.is_finite())?;
        check("reflectance", &all(&reflectance), "0 or more and below 1", |r| (0.0..1.0).contains(&r))?;
        check("emission", &all(&emission), "0 or more and finite", |e| e >= 0.0 && e.is_finite())?;
        check("form factor", factors.values(), "0 or more and finite", |f| f >= 0.0 && f.is_finite())?;
        Ok(Self { factors, areas, reflectance, emission })
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there is no patch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }

    /// The form factors.
    #[must_use]
    pub const fn factors(&self) -> &FactorMatrix {
        &self.factors
    }

    /// Own light of the patches, E.
    #[must_use]
    pub fn emission(&self) -> &[Rgb64] {
        &self.emission
    }

    /// Areas of the patches.
    #[must_use]
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Reflectances of the patches.
    #[must_use]
    pub fn reflectance(&self) -> &[Rgb64] {
        &self.reflectance
    }

    /// A row of the matrix of the system for a channel, written out: for looking at small systems.
    #[must_use]
    pub fn matrix_row(&self, i: usize, channel: usize) -> Vec<f64> {
        let mut row = vec![0.0; self.len()];
        row[i] = 1.0;
        for (j, factor) in self.factors.row(i) {
            row[j] -= self.reflectance[i][channel] * factor;
        }
        row
    }

    /// By how much the diagonal exceeds the sum of the other entries in the row and channel where it
    /// does so least. Above 0 the matrix is strictly dominant, and gathering converges.
    #[must_use]
    pub fn dominance(&self) -> f64 {
        let margin = |i: usize| {
            let own = self.factors.own(i);
            let others = self.factors.row_sum(i) - own;
            let of = |rho: f64| (1.0 - rho * own).abs() - rho * others;
            self.reflectance[i].map(of).into_iter().fold(f64::INFINITY, f64::min)
        };
        (0..self.len()).map(margin).fold(f64::INFINITY, f64::min)
    }

    /// What arrives at each patch, H = sum over j of F_i->j B_j.
    ///
    /// # Panics
    /// When `radiosity` has not one value per patch.
    #[must_use]
    pub fn incident(&self, radiosity: &[Rgb64]) -> Vec<Rgb64> {
        assert_eq!(radiosity.len(), self.len(), "one value per patch");
        self.factors.gather_all(radiosity)
    }

    /// The largest of |E - M B|, as a share of the largest radiosity.
    #[must_use]
    pub fn residual(&self, radiosity: &[Rgb64]) -> f64 {
        let incident = self.incident(radiosity);
        let most = largest(radiosity);
        let mut worst = 0.0f64;
        for (i, h) in incident.iter().enumerate() {
            for c in 0..3 {
                let found = self.emission[i][c] + self.reflectance[i][c] * h[c];
                worst = worst.max((found - radiosity[i][c]).abs());
            }
        }
        if most > 0.0 { worst / most } else { worst }
    }

    /// Where the power goes with these radiosities.
    #[must_use]
    pub fn balance(&self, radiosity: &[Rgb64]) -> PowerBalance {
        let mut balance = PowerBalance::default();
        for (i, h) in self.incident(radiosity).iter().enumerate() {
            let (area, open) = (self.areas[i], 1.0 - self.factors.row_sum(i));
            for c in 0..3 {
                balance.emitted[c] += area * self.emission[i][c];
                balance.absorbed[c] += area * (1.0 - self.reflectance[i][c]) * h[c];
                balance.lost[c] += area * open * radiosity[i][c];
            }
        }
        balance
    }
}

impl PowerBalance {
    /// Power that is not accounted for, as a share of what is emitted; the worst channel's.
    #[must_use]
    pub fn error(&self) -> f64 {
        let most = self.emitted.into_iter().fold(0.0, f64::max);
        let missing = |c: usize| (self.emitted[c] - self.absorbed[c] - self.lost[c]).abs();
        let worst = (0..3).map(missing).fold(0.0, f64::max);
        if most > 0.0 { worst / most } else { worst }
    }
}

/// The largest value of any channel.
pub(crate) fn largest(values: &[Rgb64]) -> f64 {
    values.iter().flatten().fold(0.0, |most, &v| most.max(v.abs()))
}

fn check(
    name: &'static str,
    values: &[f64],
    expected: &'static str,
    fits: impl Fn(f64) -> bool,
) -> Result<(), RadiosityError> {
    match values.iter().find(|&&value| !fits(value)) {
        Some(&value) => Err(RadiosityError::Setting { name, value, expected }),
        None => Ok(()),
    }
}
