//! Metallic-roughness reflection (glTF 2.0, appendix B.2 and B.3).
//!
//! A dielectric is a matt base under a mirror of reflectance 0.04, weighted by Fresnel's law as
//! Schlick 1994 approximates it; a metal has the mirror only, in its own colour. The mirror is a
//! field of facets with the distribution of Trowbridge and Reitz 1975 (GGX, Walter et al. 2007) and
//! the height-correlated masking of Smith (Heitz 2014).

use senca_math::LinearRgb;
use senca_math::glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

use crate::{LightRig, ShadingPoint};

/// Coefficients of a point of a surface, ready for many lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughnessConstants {
    /// Colour of the matt part.
    pub diffuse: LinearRgb,
    /// Reflectance F0 at perpendicular incidence.
    pub mirror: LinearRgb,
    /// Width alpha of the facets' distribution, the square of the roughness, at least 1e-3.
    pub alpha: f32,
}

impl MetallicRoughnessConstants {
    /// Of base colour, metalness in [0, 1] and perceptual roughness in [0, 1]. Roughness below
    /// 0.0316 counts as that: no light has a sharper image than a pixel could show.
    #[must_use]
    pub fn new(base_color: LinearRgb, metallic: f32, roughness: f32) -> Self {
        Self {
            diffuse: base_color * (1.0 - metallic),
            mirror: LinearRgb::splat(0.04).lerp(base_color, metallic),
            alpha: (roughness * roughness).max(1e-3),
        }
    }
}

/// Density D(h) of facets whose normal has cosine `n_h` to the surface's. GGX; integrates with the
/// cosine to 1 over the hemisphere.
#[must_use]
#[inline]
pub fn ggx_distribution(n_h: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    // 1 - n_h^2 (1 - a2), written so that a narrow lobe keeps its digits.
    let d = (1.0 - n_h * n_h) + n_h * n_h * a2;
    a2 * FRAC_1_PI / (d * d)
}

/// `G / (4 n_l n_v)` of Smith's height-correlated masking. Cosines > 0.
#[must_use]
#[inline]
pub fn smith_visibility(n_l: f32, n_v: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let view = n_l * (n_v * n_v * (1.0 - a2) + a2).sqrt();
    let light = n_v * (n_l * n_l * (1.0 - a2) + a2).sqrt();
    0.5 / (view + light).max(1e-7)
}

/// Schlick's approximation of Fresnel's law: `f0 + (1 - f0) (1 - v_h)^5`.
#[must_use]
#[inline]
pub fn fresnel_schlick(f0: LinearRgb, v_h: f32) -> LinearRgb {
    let c = (1.0 - v_h).clamp(0.0, 1.0);
    let c5 = (c * c) * (c * c) * c;
    f0 * (1.0 - c5) + LinearRgb::splat(c5)
}

/// The BRDF, per steradian, for unit directions; 0 where either is behind the surface.
#[must_use]
#[inline]
pub fn metallic_roughness_brdf(
    constants: &MetallicRoughnessConstants,
    normal: Vec3,
    to_light: Vec3,
    to_viewer: Vec3,
) -> LinearRgb {
    let (n_l, n_v) = (normal.dot(to_light), normal.dot(to_viewer));
    if n_l <= 0.0 || n_v <= 0.0 {
        return LinearRgb::BLACK;
    }
    let half = (to_light + to_viewer).normalize_or(normal);
    let fresnel = fresnel_schlick(constants.mirror, half.dot(to_viewer));
    let n_h = normal.dot(half).min(1.0);
    let facets = ggx_distribution(n_h, constants.alpha) * smith_visibility(n_l, n_v, constants.alpha);
    // f0 is 0.04 for the dielectric part, whose share `diffuse` already carries.
    let dielectric = fresnel_schlick(LinearRgb::splat(0.04), half.dot(to_viewer)).r;
    constants.diffuse * ((1.0 - dielectric) * FRAC_1_PI) + fresnel * facets
}

/// Least cosine between a normal and the direction to the observer.
const LEAST_COSINE: f32 = 1e-3;

/// The direction to the observer, at least grazing: interpolated normals may lean away from the
/// observer at the rim. Unit vectors.
#[must_use]
#[inline]
pub fn grazing_viewer(normal: Vec3, to_viewer: Vec3) -> Vec3 {
    let cos = normal.dot(to_viewer);
    if cos >= LEAST_COSINE {
        return to_viewer;
    }
    (to_viewer + normal * (LEAST_COSINE - cos)).normalize_or(normal)
}

/// Light that leaves `point` towards the observer: each light through the BRDF (times pi, see the
/// crate's units), and ambient light from the side that the surface faces and from that it mirrors.
/// `occlusion` in [0, 1] is the share of ambient light that reaches the point.
#[must_use]
pub fn metallic_roughness(
    rig: &LightRig,
    point: &ShadingPoint,
    constants: &MetallicRoughnessConstants,
    occlusion: f32,
) -> LinearRgb {
    let n_v = point.normal.dot(point.to_viewer).max(LEAST_COSINE);
    let to_viewer = grazing_viewer(point.normal, point.to_viewer);
    let mut sum = LinearRgb::BLACK;
    if !rig.ambient.is_none() {
        let [matt, mirror] = environment_shares(constants, n_v);
        let mirrored = 2.0 * n_v * point.normal - to_viewer;
        let arriving = [rig.ambient.towards(point.normal), rig.ambient.towards(mirrored)];
        sum += (arriving[0] * matt + arriving[1] * mirror) * occlusion;
    }
    rig.for_each_incident(point.position, |incident| {
        let n_l = point.normal.dot(incident.to_light);
        if n_l > 0.0 {
            let brdf = metallic_roughness_brdf(constants, point.normal, incident.to_light, to_viewer);
            sum += incident.intensity * brdf * (PI * n_l);
        }
    });
    sum
}

/// Share of an even environment that the surface sends to an observer at cosine `n_v` > 0.
#[must_use]
pub fn uniform_environment(constants: &MetallicRoughnessConstants, n_v: f32) -> LinearRgb {
    let [matt, mirror] = environment_shares(constants, n_v);
    matt + mirror
}

/// The shares of [`uniform_environment`] that are scattered, and that are mirrored.
///
/// The mirror part is the directional albedo `f0 a + b`, with a and b as Karis 2014 ("Physically
/// based shading on mobile") fits them for GGX.
#[must_use]
pub fn environment_shares(constants: &MetallicRoughnessConstants, n_v: f32) -> [LinearRgb; 2] {
    let roughness = constants.alpha.sqrt();
    let r =
        [1.0 - roughness, 0.0425 - 0.0275 * roughness, 1.04 - 0.572 * roughness, 0.022 * roughness - 0.04];
    let a004 = (r[0] * r[0]).min((-9.28 * n_v).exp2()) * r[0] + r[1];
    let (a, b) = (-1.04 * a004 + r[2], 1.04 * a004 + r[3]);
    let dielectric = (0.04 * a + b).clamp(0.0, 1.0);
    [constants.diffuse * (1.0 - dielectric), constants.mirror * a + LinearRgb::splat(b.max(0.0))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction(theta: f32, phi: f32) -> Vec3 {
        Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }

    /// Integral over the upper hemisphere of `f(direction) cos(theta)`, by the midpoint rule in
    /// theta and phi.
    fn hemisphere(f: impl Fn(Vec3) -> f32) -> f32 {
        let (rows, columns) = (400, 400);
        let (dt, dp) = (0.5 * PI / rows as f32, 2.0 * PI / columns as f32);
        let mut sum = 0.0f64;
        for i in 0..rows {
            let theta = (i as f32 + 0.5) * dt;
            let weight = theta.sin() * theta.cos() * dt * dp;
            let ring = (0..columns).map(|j| f(direction(theta, (j as f32 + 0.5) * dp)));
            sum += ring.map(|v| f64::from(v * weight)).sum::<f64>();
        }
        sum as f32
    }

    #[test]
    fn facets_have_the_area_of_the_surface() {
        for roughness in [0.3f32, 0.5, 1.0] {
            let alpha = roughness * roughness;
            let area = hemisphere(|h| ggx_distribution(h.z, alpha));
            assert!((area - 1.0).abs() < 0.01, "roughness {roughness}: {area}");
        }
    }

    #[test]
    fn no_more_light_leaves_than_arrives() {
        // The matt base under glTF's mirror heeds Fresnel's law at the half vector only, which gives
        // a white dielectric seen at a grazing angle up to a fifth too much.
        for (metallic, most) in [(0.0, 1.2), (1.0, 1.01)] {
            for roughness in [0.3, 0.6, 1.0] {
                for theta in [0.1, 0.8, 1.3] {
                    let c = MetallicRoughnessConstants::new(LinearRgb::WHITE, metallic, roughness);
                    let v = direction(theta, 0.4);
                    let albedo = hemisphere(|l| metallic_roughness_brdf(&c, Vec3::Z, l, v).g);
                    assert!(albedo <= most, "metal {metallic} roughness {roughness} at {theta}: {albedo}");
                    assert!(albedo > 0.3, "metal {metallic} roughness {roughness} at {theta}: {albedo}");
                }
            }
        }
    }

    #[test]
    fn even_light_agrees_with_the_integral() {
        for roughness in [0.4, 0.7, 1.0] {
            for theta in [0.2f32, 0.8, 1.2] {
                let c = MetallicRoughnessConstants::new(LinearRgb::splat(0.8), 0.3, roughness);
                let v = direction(theta, 0.0);
                let exact = hemisphere(|l| metallic_roughness_brdf(&c, Vec3::Z, l, v).g);
                let fit = uniform_environment(&c, v.z).g;
                assert!((exact - fit).abs() < 0.08, "roughness {roughness} at {theta}: {exact}, {fit}");
            }
        }
    }

    #[test]
    fn a_matt_surface_agrees_with_the_books() {
        let c = MetallicRoughnessConstants::new(LinearRgb::splat(0.5), 0.0, 1.0);
        let brdf = metallic_roughness_brdf(&c, Vec3::Z, Vec3::Z, Vec3::Z) * PI;
        // 0.96 of the base, and the wide highlight of 0.04 / (4 pi) pi.
        assert!((brdf.r - (0.96 * 0.5 + 0.01)).abs() < 1e-5, "{brdf:?}");
    }

    #[test]
    fn fresnel_at_its_ends() {
        let f0 = LinearRgb::new(0.1, 0.2, 0.3);
        assert_eq!(fresnel_schlick(f0, 1.0), f0);
        assert_eq!(fresnel_schlick(f0, 0.0), LinearRgb::WHITE);
    }

    proptest! {
        #[test]
        fn light_and_observer_may_change_places(
            t1 in 0.0f32..1.5, p1 in 0.0f32..6.2, t2 in 0.0f32..1.5, p2 in 0.0f32..6.2,
            metallic in 0.0f32..=1.0, roughness in 0.0f32..=1.0,
        ) {
            let c = MetallicRoughnessConstants::new(LinearRgb::new(0.9, 0.5, 0.1), metallic, roughness);
            let (l, v) = (direction(t1, p1), direction(t2, p2));
            let one = metallic_roughness_brdf(&c, Vec3::Z, l, v);
            let other = metallic_roughness_brdf(&c, Vec3::Z, v, l);
            for (a, b) in one.to_array().into_iter().zip(other.to_array()) {
                prop_assert!(a.is_finite() && a >= 0.0);
                prop_assert!((a - b).abs() <= 1e-3 * a.max(1e-3), "{a} {b}");
            }
        }
    }
}
