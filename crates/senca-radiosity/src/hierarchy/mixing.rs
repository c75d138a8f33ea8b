//! Steps that learn from the steps before them.
//!
//! One exchange of light is one bounce. In a closed room of bright walls hundreds of bounces pass before
//! all light is absorbed, although after a few of them each one is hardly different from the last. What
//! the last steps changed tells where that leads: the next light is the mix of them whose exchange would
//! change it least (Anderson 1965, "Iterative procedures for nonlinear integral equations"; for equations
//! as linear as these it finds what the method of conjugate residuals would, Walker and Ni 2011). Each
//! channel is mixed by itself, and areas weigh.

use rayon::prelude::*;
use senca_math::glam::Vec4;

/// Values that one task of a thread sums: fixed, so that sums do not depend on the number of threads.
const CHUNK: usize = 4096;

/// Share of the diagonal that is added to it, so that steps that repeat each other do no harm.
const SOFTNESS: f64 = 1e-10;

/// A step: how the light before it and the change by it differ from those of the step before.
#[derive(Debug)]
struct Step {
    light: Vec<Vec4>,
    change: Vec<Vec4>,
}

/// Mixes light.
#[derive(Debug)]
pub(super) struct Mixing {
    /// Steps that are remembered at most.
    most: usize,
    steps: Vec<Step>,
    /// Light of the last step, and its change.
    last: Option<Step>,
}

impl Mixing {
    /// Remembers this many steps; with none, light is as the exchange has it.
    pub(super) fn new(most: usize) -> Self {
        Self { most, steps: Vec::new(), last: None }
    }

    /// Whether light is mixed at all.
    pub(super) fn remembers(&self) -> bool {
        self.most > 0
    }

    /// The next light, from the last one, `before`, and what its exchange made of it, `after`.
    /// Values count by their `weights`.
    pub(super) fn next(&mut self, before: &[Vec4], after: &[Vec4], weights: &[f32]) -> Vec<Vec4> {
        if self.most == 0 {
            return after.to_vec();
        }
        let change = difference(after, before);
        if let Some(last) = &self.last {
            if self.steps.len() == self.most {
                self.steps.remove(0);
            }
            let light = difference(before, &last.light);
            self.steps.push(Step { light, change: difference(&change, &last.change) });
        }
        let shares = self.shares(&change, weights);
        self.last = Some(Step { light: before.to_vec(), change });
        let mixed = |(place, &light): (usize, &Vec4)| {
            let steps = self.steps.iter().zip(&shares);
            let less = steps.map(|(step, &share)| share * (step.light[place] + step.change[place]));
            (light - less.sum::<Vec4>()).max(Vec4::ZERO)
        };
        after.par_iter().enumerate().with_min_len(CHUNK).map(mixed).collect()
    }

    /// Shares of the steps' changes that come nearest to the last change, in the sum of squares.
    fn shares(&self, change: &[Vec4], weights: &[f32]) -> Vec<Vec4> {
        let n = self.steps.len();
        let with = |step: &Step, other: &[Vec4]| product(&step.change, other, weights);
        let wanted: Vec<[f64; 3]> = self.steps.iter().map(|step| with(step, change)).collect();
        let row =
            |i: usize| self.steps[..=i].iter().map(|other| with(&self.steps[i], &other.change)).collect();
        let products: Vec<Vec<[f64; 3]>> = (0..n).map(row).collect();
        let mut shares = vec![Vec4::ZERO; n];
        for channel in 0..3 {
            let at = |i: usize, j: usize| products[i.max(j)][i.min(j)][channel];
            let of_channel = solved(n, at, |i| wanted[i][channel]);
            shares.iter_mut().zip(of_channel).for_each(|(share, value)| share[channel] = value as f32);
        }
        shares
    }
}

/// Sums of the products of the channels, times the weights.
fn product(a: &[Vec4], b: &[Vec4], weights: &[f32]) -> [f64; 3] {
    let of_chunk = |(a, (b, weights)): (&[Vec4], (&[Vec4], &[f32]))| {
        let mut sum = [0.0; 3];
        for ((a, b), &weight) in a.iter().zip(b).zip(weights) {
            let product = (*a * *b * weight).to_array();
            (0..3).for_each(|c| sum[c] += f64::from(product[c]));
        }
        sum
    };
    let chunks = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK).zip(weights.par_chunks(CHUNK)));
    let sums: Vec<[f64; 3]> = chunks.map(of_chunk).collect();
    sums.iter().fold([0.0; 3], |all, sum| std::array::from_fn(|c| all[c] + sum[c]))
}

/// The solution of `n` symmetric equations by Cholesky's method; zero for those that depend on others.
fn solved(n: usize, at: impl Fn(usize, usize) -> f64, wanted: impl Fn(usize) -> f64) -> Vec<f64> {
    let softness = SOFTNESS * (0..n).map(|i| at(i, i)).sum::<f64>();
    let mut lower = vec![vec![0.0; n]; n];
    let mut values = vec![0.0; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = at(i, j) - known;
            lower[i][j] = match (i == j, lower[j][j] > 0.0) {
                (true, _) => (rest + softness).max(0.0).sqrt(),
                (false, true) => rest / lower[j][j],
                (false, false) => 0.0,
            };
        }
        let known: f64 = (0..i).map(|k| lower[i][k] * values[k]).sum();
        values[i] = if lower[i][i] > 0.0 { (wanted(i) - known) / lower[i][i] } else { 0.0 };
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| lower[k][i] * values[k]).sum();
        values[i] = if lower[i][i] > 0.0 { (values[i] - known) / lower[i][i] } else { 0.0 };
    }
    values
}

fn difference(a: &[Vec4], b: &[Vec4]) -> Vec<Vec4> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(&a, &b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved() {
        let table = [[4.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 2.0]];
        let values = solved(3, |i, j| table[i][j], |i| [6.0, 10.0, 8.0][i]);
        for (value, expected) in values.iter().zip([1.0, 2.0, 3.0]) {
            assert!((value - expected).abs() < 1e-8, "{values:?}");
        }
        // Twice the same equation.
        let same = solved(2, |_, _| 1.0, |_| 1.0);
        assert!((same[0] + same[1] - 1.0).abs() < 1e-6, "{same:?}");
        assert_eq!(solved(2, |_, _| 0.0, |_| 0.0), [0.0, 0.0]);
    }

    /// Light on places that see each other evenly, of which each has lost a different share.
    #[test]
    fn few_steps_find_what_bounces_take_thousands_for() {
        let n = 50;
        let keeps = |i: usize| 0.995 + 0.0001 * (i % 7) as f32;
        let exchange = |light: &[Vec4]| -> Vec<Vec4> {
            let mean = light.iter().sum::<Vec4>() / n as f32;
            let near = |i: usize| 0.3 * light[(i + 1) % n] + 0.7 * mean;
            (0..n).map(|i| Vec4::splat(if i == 0 { 1.0 } else { 0.0 }) + keeps(i) * near(i)).collect()
        };
        let weights = vec![1.0; n];
        let mut steps = [0, 0];
        for (most, steps) in [0, 4].into_iter().zip(&mut steps) {
            let (mut mixing, mut light) = (Mixing::new(most), vec![Vec4::ZERO; n]);
            loop {
                let after = exchange(&light);
                let change = after
                    .iter()
                    .zip(&light)
                    .map(|(a, b)| (*a - *b).abs().truncate().max_element())
                    .fold(0.0, f32::max);
                if change < 1e-4 || *steps > 5000 {
                    break;
                }
                light = mixing.next(&light, &after, &weights);
                *steps += 1;
            }
        }
        assert!(steps[0] > 500 && steps[1] < 25, "{steps:?}");
    }
}
