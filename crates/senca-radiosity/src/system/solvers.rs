//! Solvers that gather, and when to stop.

use rayon::prelude::*;
use senca_math::Control;

use super::{Rgb64, System, largest};
use crate::RadiosityError;

/// When a solver stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Largest change of a radiosity in one sweep, as a share of the largest radiosity, that counts as
    /// none; > 0. Default 1e-6.
    pub tolerance: f64,
    /// Sweeps at most. Default 1000, enough for reflectances up to 0.98 in closed rooms.
    pub max_sweeps: u32,
}

impl Default for StopRule {
    fn default() -> Self {
        Self { tolerance: 1e-6, max_sweeps: 1000 }
    }
}

/// What came of solving.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Sweeps that were made.
    pub sweeps: u32,
    /// Change in the last sweep, as a share of the largest radiosity.
    pub change: f64,
    /// Whether the change met the tolerance.
    pub converged: bool,
}

/// Relaxation by Gauss and Seidel: each sweep goes through the patches in order, and each gathers from
/// the newest values.
///
/// ```
/// use senca_radiosity::system::{FactorMatrix, GaussSeidel, System};
///
/// let factors = FactorMatrix::from_dense(&[[0.0, 1.0], [1.0, 0.0]]);
/// let system = System::new(factors, vec![1.0; 2], vec![[0.5; 3]; 2], vec![[1.0; 3], [0.0; 3]])?;
/// let mut solver = GaussSeidel::new(&system);
/// solver.sweep();
/// assert_eq!(solver.radiosity(), [[1.0; 3], [0.5; 3]]);
/// solver.sweep();
/// assert_eq!(solver.radiosity(), [[1.25; 3], [0.625; 3]]);
/// # Ok::<(), senca_radiosity::RadiosityError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GaussSeidel<'s> {
    system: &'s System,
    radiosity: Vec<Rgb64>,
    outcome: Outcome,
}

impl<'s> GaussSeidel<'s> {
    /// Before the first sweep: B = E.
    #[must_use]
    pub fn new(system: &'s System) -> Self {
        Self::starting_at(system, system.emission.clone())
    }

    /// From other values, such as the solution before the mesh was refined.
    ///
    /// # Panics
    /// When there is not one value per patch.
    #[must_use]
    pub fn starting_at(system: &'s System, radiosity: Vec<Rgb64>) -> Self {
        assert_eq!(radiosity.len(), system.len(), "one value per patch");
        Self { system, radiosity, outcome: Outcome::default() }
    }

    /// One sweep; the largest change of a radiosity.
    pub fn sweep(&mut self) -> f64 {
        let System { factors, reflectance, emission, .. } = self.system;
        let mut change = 0.0f64;
        for i in 0..self.system.len() {
            // The patch's own value leaves the sum, and the diagonal divides.
            let own = factors.own(i);
            let gathered = factors.gather(i, &self.radiosity);
            let old = self.radiosity[i];
            let new: Rgb64 = std::array::from_fn(|c| {
                let rho = reflectance[i][c];
                (emission[i][c] + rho * (gathered[c] - own * old[c])) / (1.0 - rho * own)
            });
            (0..3).for_each(|c| change = change.max((new[c] - old[c]).abs()));
            self.radiosity[i] = new;
        }
        self.note(change)
    }

    /// Radiosities after the last sweep.
    #[must_use]
    pub fn radiosity(&self) -> &[Rgb64] {
        &self.radiosity
    }

    /// Sweeps until the rule says stop. `watch` sees the radiosities and the outcome so far after each.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`]; the values of the last sweep are kept.
    pub fn run(
        &mut self,
        rule: &StopRule,
        control: &Control<'_>,
        mut watch: impl FnMut(&[Rgb64], &Outcome),
    ) -> Result<Outcome, RadiosityError> {
        while !self.outcome.converged && self.outcome.sweeps < rule.max_sweeps {
            control.check()?;
            self.sweep();
            self.outcome.converged = self.outcome.change <= rule.tolerance;
            watch(&self.radiosity, &self.outcome);
        }
        Ok(self.outcome)
    }

    /// The radiosities.
    #[must_use]
    pub fn into_radiosity(self) -> Vec<Rgb64> {
        self.radiosity
    }

    fn note(&mut self, change: f64) -> f64 {
        self.outcome.sweeps += 1;
        let most = largest(&self.radiosity);
        self.outcome.change = if most > 0.0 { change / most } else { change };
        change
    }
}

/// Iteration by Jacobi: every patch gathers from the values before the sweep, so sweeps are the bounces
/// of light and rows need not be solved in order. Slower to converge than [`GaussSeidel`], and by all
/// threads of the current rayon pool.
#[derive(Clone, Debug)]
pub struct Jacobi<'s> {
    system: &'s System,
    radiosity: Vec<Rgb64>,
}

impl<'s> Jacobi<'s> {
    /// Before the first sweep: B = E.
    #[must_use]
    pub fn new(system: &'s System) -> Self {
        Self { system, radiosity: system.emission.clone() }
    }

    /// One sweep; the largest change of a radiosity.
    pub fn sweep(&mut self) -> f64 {
        let System { factors, reflectance, emission, .. } = self.system;
        let old = &self.radiosity;
        let gather = |i: usize| -> Rgb64 {
            let own = factors.own(i);
            let gathered = factors.gather(i, old);
            std::array::from_fn(|c| {
                let rho = reflectance[i][c];
                (emission[i][c] + rho * (gathered[c] - own * old[i][c])) / (1.0 - rho * own)
            })
        };
        let new: Vec<Rgb64> = (0..self.system.len()).into_par_iter().with_min_len(16).map(gather).collect();
        let changes = new.iter().flatten().zip(old.iter().flatten()).map(|(a, b)| (a - b).abs());
        let change = changes.fold(0.0, f64::max);
        self.radiosity = new;
        change
    }

    /// Radiosities after the last sweep.
    #[must_use]
    pub fn radiosity(&self) -> &[Rgb64] {
        &self.radiosity
    }

    /// Sweeps until the rule says stop.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`]; the values of the last sweep are kept.
    pub fn run(&mut self, rule: &StopRule, control: &Control<'_>) -> Result<Outcome, RadiosityError> {
        let mut outcome = Outcome::default();
        while !outcome.converged && outcome.sweeps < rule.max_sweeps {
            control.check()?;
            let change = self.sweep();
            let most = largest(&self.radiosity);
            outcome.sweeps += 1;
            outcome.change = if most > 0.0 { change / most } else { change };
            outcome.converged = outcome.change <= rule.tolerance;
        }
        Ok(outcome)
    }
}
