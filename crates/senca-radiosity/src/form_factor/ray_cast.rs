//! Form factors with obstacles: the closed form times the share that rays find open.

use std::f64::consts::PI;

use senca_trace::{Pattern, Sampler};

use super::cells::even_place;
use super::{Visibility, differential, exchange};
use crate::PatchPolygon;

/// How lines of sight are spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCastSettings {
    /// Lines between two patches, 1 or more. Default 16.
    pub rays: u32,
    /// How their ends are spread. Default [`Pattern::Sobol`], evenly over both patches and their pairs.
    pub pattern: Pattern,
    /// Changes all ends. Default 0.
    pub seed: u64,
}

impl Default for RayCastSettings {
    fn default() -> Self {
        Self { rays: 16, pattern: Pattern::Sobol, seed: 0 }
    }
}

/// Share of the exchange between two patches that obstacles let through, in [0, 1]: lines of sight
/// between places on both, each counted by the integrand of equation 4.9 of the course text. 1 where no
/// line has any weight.
#[must_use]
pub fn visible_share(
    from: &PatchPolygon,
    to: &PatchPolygon,
    visibility: &(impl Visibility + ?Sized),
    settings: &RayCastSettings,
) -> f64 {
    visible_share_of_pair(from, to, visibility, settings, [0, 0])
}

/// The same with ends that are another choice for each `pair` of numbers.
pub(crate) fn visible_share_of_pair(
    from: &PatchPolygon,
    to: &PatchPolygon,
    visibility: &(impl Visibility + ?Sized),
    settings: &RayCastSettings,
    pair: [u32; 2],
) -> f64 {
    let [(normal_from, area_from), (normal_to, area_to)] = [from.normal_and_area(), to.normal_and_area()];
    let rays = settings.rays.max(1);
    let closest = area_from.min(area_to) / (PI * f64::from(rays));
    let (mut all, mut open) = (0.0, 0.0);
    for ray in 0..rays {
        let mut sampler = Sampler::new(settings.pattern, settings.seed, pair[0], pair[1], ray);
        let [u, v] = sampler.next_2d();
        let [s, t] = sampler.next_2d();
        let (a, b) = (even_place(from.corners(), u, v), even_place(to.corners(), s, t));
        // Nearer than a part of the smaller patch for one line, the mean over the part counts.
        let near = (a.distance_squared(b) / closest).min(1.0);
        let weight = differential(a, normal_from, b, normal_to, 1.0) * near;
        if weight > 0.0 {
            all += weight;
            open += if visibility.visible(a, b) { weight } else { 0.0 };
        }
    }
    if all > 0.0 { open / all } else { 1.0 }
}

/// Area of `from` times the form factor with obstacles, the same in both directions: the closed form
/// times [`visible_share`]. Exact where nothing or all is hidden.
#[must_use]
pub fn ray_cast_exchange(
    from: &PatchPolygon,
    to: &PatchPolygon,
    visibility: &(impl Visibility + ?Sized),
    settings: &RayCastSettings,
) -> f64 {
    let open = exchange(from.corners(), to.corners());
    if open > 0.0 { open * visible_share(from, to, visibility, settings) } else { 0.0 }
}

/// Form factor with obstacles: [`ray_cast_exchange`] by the area of `from`.
#[must_use]
pub fn ray_cast(
    from: &PatchPolygon,
    to: &PatchPolygon,
    visibility: &(impl Visibility + ?Sized),
    settings: &RayCastSettings,
) -> f64 {
    let exchange = ray_cast_exchange(from, to, visibility, settings);
    if exchange > 0.0 { (exchange / from.normal_and_area().1).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::{PatchScene, Unoccluded, double_area};
    use senca_math::glam::DVec3;

    fn square(z: f64, half: f64, up: bool) -> PatchPolygon {
        let turn = if up { 1.0 } else { -1.0 };
        let at = |x: f64, y: f64| DVec3::new(x * half, y * half * turn, z);
        PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }

    #[test]
    fn without_obstacles_it_is_exact() {
        let (low, high) = (square(0.0, 0.5, true), square(1.0, 0.5, false));
        let factor = ray_cast(&low, &high, &Unoccluded, &RayCastSettings::default());
        assert!((factor - 0.199_824_895_698).abs() < 1e-12);
        assert_eq!(ray_cast(&low, &high, &|_: DVec3, _: DVec3| false, &RayCastSettings::default()), 0.0);
        assert_eq!(ray_cast(&low, &square(1.0, 0.5, true), &Unoccluded, &RayCastSettings::default()), 0.0);
    }

    #[test]
    fn an_obstacle_half_way_lets_the_same_share_through_as_the_double_sum_says() {
        let patches = [square(0.0, 0.5, true), square(1.0, 0.5, false), square(0.5, 0.25, true)];
        let scene = PatchScene::new(&patches).expect("few");
        let exact = double_area(patches[0].corners(), patches[1].corners(), 15, &scene);
        for (pattern, rays, limit) in [(Pattern::Sobol, 4096, 0.002), (Pattern::Independent, 16_384, 0.004)] {
            let settings = RayCastSettings { rays, pattern, seed: 1 };
            let factor = ray_cast(&patches[0], &patches[1], &scene, &settings);
            assert!((factor - exact).abs() < limit, "{factor} {exact}");
        }
    }

    #[test]
    fn patches_without_area_have_none() {
        let flat = PatchPolygon::triangle([DVec3::ZERO; 3]);
        let settings = RayCastSettings { rays: 0, ..RayCastSettings::default() };
        assert_eq!(ray_cast(&flat, &square(1.0, 1.0, false), &Unoccluded, &settings), 0.0);
        assert_eq!(ray_cast(&square(1.0, 1.0, false), &flat, &Unoccluded, &settings), 0.0);
    }
}
