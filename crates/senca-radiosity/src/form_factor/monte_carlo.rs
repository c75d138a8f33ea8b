//! Form factors by chance: rays from a patch as it radiates, and where they end.

use std::f64::consts::TAU;

use senca_math::glam::DVec3;
use senca_trace::{Pattern, Sampler};

use super::cells::even_place;
use super::{FirstHit, PatchScene};
use crate::PatchPolygon;

/// How rays are sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonteCarloSettings {
    /// Rays per patch, 1 or more; rounded up to a multiple of 16. Default 4096.
    pub rays: u32,
    /// How they are spread. Default [`Pattern::Sobol`]: evenly over the patch and over directions.
    pub pattern: Pattern,
    /// Changes all rays. Default 0.
    pub seed: u64,
}

impl Default for MonteCarloSettings {
    fn default() -> Self {
        Self { rays: 4096, pattern: Pattern::Sobol, seed: 0 }
    }
}

/// Form factors of one patch to all others.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarloRow {
    /// Factors, by the patch they are to.
    pub factors: Vec<f64>,
    /// Standard errors of the factors, from groups of rays that know nothing of each other.
    pub errors: Vec<f64>,
    /// Share of rays that met nothing, or the back of a patch.
    pub lost: f64,
}

/// Groups of rays that know nothing of each other.
const GROUPS: u32 = 16;

/// Factors of patch number `index` of `patches`, of which `scene` was made. Rays start evenly over the
/// patch, their directions with the density cos / pi: each stands for the same share of what the patch
/// radiates (course text, equation 4.6). All 0 for a patch without area.
#[must_use]
pub fn monte_carlo(
    index: usize,
    patches: &[PatchPolygon],
    scene: &PatchScene,
    settings: &MonteCarloSettings,
) -> MonteCarloRow {
    let from = &patches[index];
    let (normal, _) = from.normal_and_area();
    let rays = settings.rays.div_ceil(GROUPS).max(1);
    let (mut sums, mut squares) = (vec![0.0; patches.len()], vec![0.0; patches.len()]);
    let mut hits = vec![0_u32; patches.len()];
    let groups = if normal == DVec3::ZERO { 0 } else { GROUPS };
    for group in 0..groups {
        hits.fill(0);
        for ray in 0..rays {
            let sampler = Sampler::new(settings.pattern, settings.seed, index as u32, group, ray);
            let (place, direction) = radiated(from, normal, sampler);
            if let FirstHit::Front(patch) = scene.first_hit(place, direction) {
                hits[patch] += 1;
            }
        }
        for (k, &n) in hits.iter().enumerate() {
            let share = f64::from(n) / f64::from(rays);
            sums[k] += share;
            squares[k] += share * share;
        }
    }
    let count = f64::from(GROUPS);
    let factors: Vec<f64> = sums.iter().map(|sum| sum / count).collect();
    let error =
        |(mean, square): (&f64, f64)| ((square / count - mean * mean).max(0.0) / (count - 1.0)).sqrt();
    let errors = factors.iter().zip(squares).map(error).collect();
    let lost = (1.0 - factors.iter().sum::<f64>()).max(0.0);
    MonteCarloRow { factors, errors, lost }
}

/// Where a ray starts and where it goes.
fn radiated(from: &PatchPolygon, normal: DVec3, mut sampler: Sampler) -> (DVec3, DVec3) {
    let [u, v] = sampler.next_2d();
    let [s, t] = sampler.next_2d();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * t).sin_cos();
    let radius = s.sqrt();
    let direction = (tangent * cos + bitangent * sin) * radius + normal * (1.0 - s).sqrt();
    (even_place(from.corners(), u, v), direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, up: bool) -> PatchPolygon {
        let turn = if up { 1.0 } else { -1.0 };
        let at = |x: f64, y: f64| DVec3::new(x * 0.5, y * 0.5 * turn, z);
        PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }

    #[test]
    fn facing_squares_are_met_as_often_as_they_should() {
        let patches = [square(0.0, true), square(1.0, false)];
        let scene = PatchScene::new(&patches).expect("few");
        for pattern in [Pattern::Sobol, Pattern::Independent] {
            let settings = MonteCarloSettings { rays: 1 << 14, pattern, seed: 3 };
            let row = monte_carlo(0, &patches, &scene, &settings);
            let off = (row.factors[1] - 0.199_824_895_7).abs();
            assert!(off < 4.0 * row.errors[1], "{pattern:?}: {off} {}", row.errors[1]);
            // The binomial error is 0.0031.
            let limit = if pattern == Pattern::Sobol { 0.003 } else { 0.006 };
            assert!(row.errors[1] > 1e-5 && row.errors[1] < limit, "{pattern:?}: {}", row.errors[1]);
            assert_eq!(row.factors[0], 0.0);
            assert!((row.lost + row.factors[1] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn patches_without_area_send_and_take_nothing() {
        let patches = [
            square(0.0, true),
            PatchPolygon::triangle([DVec3::Z; 3]),
            PatchPolygon::triangle([DVec3::NAN; 3]),
        ];
        let scene = PatchScene::new(&patches).expect("few");
        for k in 0..3 {
            let row = monte_carlo(k, &patches, &scene, &MonteCarloSettings::default());
            assert_eq!(row.factors, [0.0; 3]);
        }
    }
}
