//! Shooting: progressive refinement (Cohen, Chen, Wallace and Greenberg 1988).

use super::{Rgb64, System};

/// Southwell's relaxation: the patch with most unsent power sends it to all others.
///
/// What patch j gets from i is `rho_j F_j->i B_i`, and by reciprocity (equation 4.2) `F_j->i` is
/// `F_i->j A_i / A_j`, so that one step needs one row of factors. After few steps all that is bright has
/// been sent, and [`Shooting::with_ambient`] stands for what has not.
#[derive(Clone, Debug)]
pub struct Shooting<'s> {
    system: &'s System,
    radiosity: Vec<Rgb64>,
    unsent: Vec<Rgb64>,
    steps: u32,
}

impl<'s> Shooting<'s> {
    /// Before the first step: B = E, all of it unsent.
    #[must_use]
    pub fn new(system: &'s System) -> Self {
        let emission = system.emission().to_vec();
        Self { system, radiosity: emission.clone(), unsent: emission, steps: 0 }
    }

    /// One step: the patch that sent. `None` when nothing is left to send.
    pub fn shoot(&mut self) -> Option<usize> {
        let System { factors, areas, reflectance, .. } = self.system;
        let sender = self.brightest()?;
        let light = std::mem::take(&mut self.unsent[sender]);
        for (j, factor) in factors.row(sender) {
            let share = factor * areas[sender] / areas[j];
            for c in 0..3 {
                let gained = reflectance[j][c] * share * light[c];
                self.radiosity[j][c] += gained;
                self.unsent[j][c] += gained;
            }
        }
        self.steps += 1;
        Some(sender)
    }

    /// Radiosities after the last step.
    #[must_use]
    pub fn radiosity(&self) -> &[Rgb64] {
        &self.radiosity
    }

    /// Radiosities with an estimate of the light that is still on its way: unsent power, spread evenly
    /// over all area and reflected as often as the mean reflectance has it.
    #[must_use]
    pub fn with_ambient(&self) -> Vec<Rgb64> {
        let ambient = self.ambient();
        let rho = self.system.reflectance().iter();
        let estimate = |(b, rho): (&Rgb64, &Rgb64)| std::array::from_fn(|c| b[c] + rho[c] * ambient[c]);
        self.radiosity.iter().zip(rho).map(estimate).collect()
    }

    /// Light that would arrive everywhere if the unsent power were spread evenly.
    #[must_use]
    pub fn ambient(&self) -> Rgb64 {
        let areas = self.system.areas();
        let area: f64 = areas.iter().sum();
        let mean =
            |values: &[Rgb64], c: usize| values.iter().zip(areas).map(|(v, a)| v[c] * a).sum::<f64>() / area;
        std::array::from_fn(|c| mean(&self.unsent, c) / (1.0 - mean(self.system.reflectance(), c)))
    }

    /// Unsent power as a share of what was emitted.
    #[must_use]
    pub fn unsent_share(&self) -> f64 {
        let power = |values: &[Rgb64]| -> f64 {
            values.iter().zip(self.system.areas()).map(|(v, a)| v.iter().sum::<f64>() * a).sum()
        };
        let emitted = power(self.system.emission());
        if emitted > 0.0 { power(&self.unsent) / emitted } else { 0.0 }
    }

    /// Steps that were made.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// The patch with most unsent power; of equal ones the first.
    fn brightest(&self) -> Option<usize> {
        let mut best = (0.0, None);
        for (i, (light, area)) in self.unsent.iter().zip(self.system.areas()).enumerate() {
            let power = light.iter().sum::<f64>() * area;
            if power > best.0 {
                best = (power, Some(i));
            }
        }
        best.1
    }
}
