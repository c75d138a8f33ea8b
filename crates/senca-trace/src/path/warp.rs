//! Even points of the unit square, carried to where light goes: hemispheres, cones, triangles,
//! facets. Each map keeps evenness as well as it can and says which density its points have.

use senca_math::glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Even over the disc of radius 1, squares to rings (Shirley and Chiu 1997). Density 1/pi.
pub(super) fn disc([u, v]: [f64; 2]) -> DVec2 {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (radius, angle) = if x.abs() > y.abs() {
        (x, FRAC_PI_4 * (y / x))
    } else if y != 0.0 {
        (y, FRAC_PI_2 - FRAC_PI_4 * (x / y))
    } else {
        return DVec2::ZERO;
    };
    radius * DVec2::new(angle.cos(), angle.sin())
}

/// Unit vectors around +z with density `z / pi`.
pub(super) fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let d = disc(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Unit vectors within the cone around +z that reaches down to `cos_limit`, even over its solid
/// angle: density `1 / (2 pi (1 - cos_limit))`.
///
/// `versine` is `1 - cos_limit`, which narrow cones know better than their cosine.
pub(super) fn cone([u, v]: [f64; 2], versine: f64) -> DVec3 {
    let down = u * versine;
    let z = 1.0 - down;
    let across = (down * (1.0 + z)).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    DVec3::new(across * cos, across * sin, z)
}

/// Unit vectors around +z with density `(n + 1) / (2 pi) z^n`.
pub(super) fn power_lobe([u, v]: [f64; 2], n: f64) -> DVec3 {
    let z = (1.0 - u).powf(1.0 / (n + 1.0));
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    DVec3::new(across * cos, across * sin, z)
}

/// Weights of the second and third corner of a triangle, even over its area (Heitz 2019).
pub(super) fn triangle([u, v]: [f64; 2]) -> DVec2 {
    if v > u {
        let b = 0.5 * u;
        DVec2::new(b, v - b)
    } else {
        let c = 0.5 * v;
        DVec2::new(u - c, c)
    }
}

/// Normals of those facets of a GGX surface that a viewer at `view` (z > 0) sees, as often as it sees
/// them: density `G1(view) D(h) (view . h) / view.z` (Heitz 2018, by the caps of Dupuy and Benyoub
/// 2023).
pub(super) fn visible_facet([u, v]: [f64; 2], view: DVec3, alpha: f64) -> DVec3 {
    // Stretch the surface until its facets are those of a hemisphere.
    let stretched = DVec3::new(alpha * view.x, alpha * view.y, view.z).normalize_or(DVec3::Z);
    // Mirrored directions fill the cap from -stretched.z upwards evenly.
    let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u).sin_cos();
    let half = DVec3::new(across * cos, across * sin, z) + stretched;
    DVec3::new(alpha * half.x, alpha * half.y, half.z.max(1e-12)).normalize_or(DVec3::Z)
}

/// Cosine over pi: the density of [`cosine_hemisphere`].
pub(super) fn cosine_hemisphere_pdf(cos: f64) -> f64 {
    cos.max(0.0) / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points of a fine even grid.
    fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
        let place = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(move |i| [place(i % n), place(i / n)])
    }

    fn mean(n: u32, of: impl Fn([f64; 2]) -> f64) -> f64 {
        grid(n).map(of).sum::<f64>() / f64::from(n * n)
    }

    #[test]
    fn moments_of_the_maps_are_those_of_their_densities() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-3, "{a} is not {b}");
        close(mean(64, |u| disc(u).length_squared()), 0.5);
        close(mean(64, |u| disc(u).x.powi(2)), 0.25);
        close(mean(64, |u| cosine_hemisphere(u).z), 2.0 / 3.0);
        close(mean(64, |u| cone(u, 0.4).z), 0.8);
        close(mean(64, |u| cone(u, 0.4).x.powi(2) * 3.0), 1.5 * (1.0 - (1.0 + 0.6 + 0.36) / 3.0));
        close(mean(256, |u| power_lobe(u, 9.0).z), 10.0 / 11.0);
        close(mean(64, |u| triangle(u).x), 1.0 / 3.0);
        close(mean(64, |u| triangle(u).x * triangle(u).y), 1.0 / 12.0);
    }

    #[test]
    fn everything_is_of_unit_length_and_in_its_place() {
        for u in grid(16).chain([[0.0, 0.0], [0.0, 1.0 - 1e-16], [1.0 - 1e-16, 0.5], [0.5, 0.5]]) {
            let view = DVec3::new(0.8, 0.0, 0.6);
            for w in [cosine_hemisphere(u), cone(u, 1e-12), power_lobe(u, 0.0), visible_facet(u, view, 0.3)] {
                assert!((w.length() - 1.0).abs() < 1e-12 && w.z >= 0.0, "{u:?}: {w}");
            }
            let w = triangle(u);
            assert!(w.x >= 0.0 && w.y >= 0.0 && w.x + w.y <= 1.0);
        }
    }
}
