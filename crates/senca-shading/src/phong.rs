//! The reflection model of the books (Phong 1975; course text, section 2.5, equation 2.2; 1991
//! thesis, section 6).
//!
//! `I = Ia Oa + sum_i I_i fatt_i (Od cos(phi_i) + Os cos^n(alpha_i))`, per channel. The text does not
//! say what negative cosines mean; here they count as 0, and a light behind the surface makes no
//! highlight either. Results above 1 are kept.

use senca_math::LinearRgb;
use senca_math::glam::Vec3;
use senca_scene::Phong;

use crate::{LightRig, ShadingPoint};

/// Coefficients of the model, ready for many evaluations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongConstants {
    /// Oa, per channel.
    pub ambient: LinearRgb,
    /// Od, per channel.
    pub diffuse: LinearRgb,
    /// Os, per channel.
    pub specular: LinearRgb,
    /// n, >= 0.
    pub exponent: f32,
}

impl PhongConstants {
    /// Those of a material, textures left aside.
    #[must_use]
    pub fn new(phong: &Phong) -> Self {
        Self {
            ambient: phong.ambient,
            diffuse: phong.diffuse,
            specular: phong.specular,
            exponent: phong.exponent,
        }
    }

    /// A matt surface with Oa = Od and no highlight.
    #[must_use]
    pub fn matte(color: LinearRgb) -> Self {
        Self { ambient: color, diffuse: color, specular: LinearRgb::BLACK, exponent: 1.0 }
    }

    /// A metallic-roughness surface seen through the eyes of this model: what is not metal is matt, of
    /// the metal three tenths (so that it is not black where it has no highlight), the mirror part is a highlight of the exponent `2 / roughness^4 - 2`, which gives the
    /// Blinn-Phong lobe its GGX width (Walter et al. 2007, section 5.2), a quarter of it for the angle
    /// of the mirrored ray; at most 1000.
    #[must_use]
    pub fn of_metallic_roughness(base_color: LinearRgb, metallic: f32, roughness: f32) -> Self {
        let diffuse = base_color * (1.0 - 0.7 * metallic);
        let alpha2 = (roughness * roughness).powi(2).max(1e-4);
        let exponent = (0.25 * (2.0 / alpha2 - 2.0)).clamp(1.0, 1000.0);
        let mirror = LinearRgb::splat(0.04).lerp(base_color, metallic);
        let strength = (1.0 - roughness).max(0.0);
        Self {
            ambient: base_color,
            diffuse,
            specular: mirror.lerp(base_color, metallic) * strength,
            exponent,
        }
    }
}

/// `max(n . l, 0)`, the cosine of the angle of incidence. Unit vectors.
#[must_use]
pub fn cos_incidence(normal: Vec3, to_light: Vec3) -> f32 {
    normal.dot(to_light).max(0.0)
}

/// The mirrored light direction `r = 2 n (n . l) - l`. Unit vectors.
/// Source: course text, section 2.5, equations 2.5 to 2.9.
#[must_use]
pub fn reflected(normal: Vec3, to_light: Vec3) -> Vec3 {
    2.0 * normal.dot(to_light) * normal - to_light
}

/// `max(v . r, 0)`, the cosine of the angle between the mirrored ray and the observer; 0 when the
/// light is behind the surface. Unit vectors.
#[must_use]
#[inline]
pub fn cos_reflection(normal: Vec3, to_light: Vec3, to_viewer: Vec3) -> f32 {
    let cos = normal.dot(to_light);
    if cos <= 0.0 {
        return 0.0;
    }
    (2.0 * cos * normal.dot(to_viewer) - to_light.dot(to_viewer)).max(0.0)
}

/// `Od cos(phi) + Os cos^n(alpha)`: the share of one light that goes to the observer. Cosines must
/// not be negative.
#[must_use]
#[inline]
pub fn phong_term(constants: &PhongConstants, cos_phi: f32, cos_alpha: f32) -> LinearRgb {
    let highlight = if cos_alpha > 0.0 { cos_alpha.powf(constants.exponent) } else { 0.0 };
    constants.diffuse * cos_phi + constants.specular * highlight
}

/// Light that leaves `point` towards the observer. `occlusion` in [0, 1] is the share of ambient
/// light that reaches the point.
#[must_use]
pub fn phong(rig: &LightRig, point: &ShadingPoint, constants: &PhongConstants, occlusion: f32) -> LinearRgb {
    let mut sum = rig.ambient.towards(point.normal) * constants.ambient * occlusion;
    let shiny = constants.specular != LinearRgb::BLACK;
    rig.for_each_incident(point.position, |incident| {
        let cos_phi = point.normal.dot(incident.to_light);
        if cos_phi <= 0.0 {
            return;
        }
        let cos_alpha =
            if shiny { cos_reflection(point.normal, incident.to_light, point.to_viewer) } else { 0.0 };
        sum += incident.intensity * phong_term(constants, cos_phi, cos_alpha);
    });
    sum
}

/// Attenuation of the thesis in practice: `1 / (r + k)` with the distance `r` of viewer and surface,
/// lights at infinity, and a constant `k` > 0. 1 where the denominator is not positive.
/// Source: 1991 thesis, section 6.
#[must_use]
pub fn thesis_linear_attenuation(r: f32, k: f32) -> f32 {
    let denominator = r + k;
    if denominator > 0.0 { 1.0 / denominator } else { 1.0 }
}

/// Attenuation as physics has it: `1 / R^2` over the whole way `R = r + d` from the light to the
/// surface to the viewer. 1 where the way has no length.
/// Source: 1991 thesis, section 6.
#[must_use]
pub fn thesis_physical_attenuation(r: f32, d: f32) -> f32 {
    let way = r + d;
    if way > 0.0 { 1.0 / (way * way) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lamp, ShadingLight};
    use senca_scene::Attenuation;

    fn grey(od: f32, os: f32, n: f32) -> PhongConstants {
        let c = LinearRgb::splat(od);
        PhongConstants { ambient: c, diffuse: c, specular: LinearRgb::splat(os), exponent: n }
    }

    /// One parallel light of intensity 1 straight down on a surface that faces +z, seen under
    /// `alpha` from the mirrored ray.
    fn value(ia: f32, constants: &PhongConstants, alpha_degrees: f32) -> f32 {
        let rig = LightRig {
            ambient: LinearRgb::splat(ia).into(),
            lights: vec![ShadingLight {
                color: LinearRgb::WHITE,
                position: Vec3::ZERO,
                axis: -Vec3::Z,
                attenuation: Attenuation::None,
                lamp: Lamp::Parallel,
            }],
        };
        let (s, c) = alpha_degrees.to_radians().sin_cos();
        let point = ShadingPoint { position: Vec3::ZERO, normal: Vec3::Z, to_viewer: Vec3::new(s, 0.0, c) };
        phong(&rig, &point, constants, 1.0).r
    }

    fn assert_close(a: f32, b: f32) {
        assert!((a - b).abs() < 2e-6, "{a} is not {b}");
    }

    #[test]
    fn sweep_of_the_diffuse_coefficient() {
        for od in [0.4, 0.6, 0.8, 1.0] {
            assert_close(value(0.0, &grey(od, 0.0, 1.0), 0.0), od);
        }
    }

    #[test]
    fn sweep_of_the_specular_coefficient() {
        for (os, peak) in [(0.0, 0.44), (0.2, 0.64), (0.4, 0.84), (0.6, 1.04)] {
            assert_close(value(0.1, &grey(0.4, os, 5.0), 0.0), peak);
        }
    }

    #[test]
    fn sweep_of_the_exponent() {
        for (n, expected) in [
            (1.0, [1.04, 1.030_885, 0.959_615, 0.74]),
            (5.0, [1.04, 0.995_787, 0.732_284, 0.458_75]),
            (20.0, [1.04, 0.881_754, 0.473_788, 0.440_001]),
            (100.0, [1.04, 0.569_807, 0.44, 0.44]),
        ] {
            for (alpha, e) in [0.0, 10.0, 30.0, 60.0].into_iter().zip(expected) {
                assert_close(value(0.1, &grey(0.4, 0.6, n), alpha), e);
            }
        }
    }

    #[test]
    fn half_width_of_the_highlight() {
        for (n, degrees) in [(1.0, 60.0), (5.0, 29.477), (20.0, 14.998), (50.0, 9.518), (100.0, 6.738f32)] {
            let half = phong_term(&grey(0.0, 1.0, n), 1.0, degrees.to_radians().cos()).r;
            assert!((half - 0.5).abs() < 1e-3, "exponent {n}: {half}");
        }
    }

    #[test]
    fn a_whole_vertex() {
        let rig = LightRig {
            ambient: LinearRgb::splat(0.1).into(),
            lights: vec![ShadingLight {
                color: LinearRgb::new(1.0, 1.0, 0.8),
                position: Vec3::new(3.0, 0.0, 4.0),
                axis: -Vec3::Z,
                attenuation: Attenuation::Polynomial { constant: 0.0, linear: 0.25, quadratic: 0.0 },
                lamp: Lamp::Point,
            }],
        };
        let o = LinearRgb::new(0.4, 0.2, 0.1);
        let constants =
            PhongConstants { ambient: o, diffuse: o, specular: LinearRgb::splat(0.5), exponent: 2.0 };
        let point = ShadingPoint { position: Vec3::ZERO, normal: Vec3::Z, to_viewer: Vec3::Z };
        let c = phong(&rig, &point, &constants, 1.0);
        for (a, b) in c.to_array().into_iter().zip([0.552, 0.404, 0.266]) {
            assert_close(a, b);
        }
        let to_light = Vec3::new(0.6, 0.0, 0.8);
        assert!(reflected(Vec3::Z, to_light).abs_diff_eq(Vec3::new(-0.6, 0.0, 0.8), 1e-6));
        assert_close(cos_reflection(Vec3::Z, to_light, Vec3::Z), 0.8);
    }

    #[test]
    fn light_from_behind_gives_neither_diffuse_nor_highlight() {
        let l = Vec3::new(0.8, 0.0, -0.6);
        assert_eq!(cos_incidence(Vec3::Z, l), 0.0);
        assert_eq!(cos_reflection(Vec3::Z, l, reflected(Vec3::Z, l)), 0.0);
    }

    #[test]
    fn incidence_of_the_thesis() {
        let l = Vec3::new(0.0, 1.0, 1.0).normalize();
        assert_close(cos_incidence(Vec3::Z, l), std::f32::consts::FRAC_1_SQRT_2);
    }

    #[test]
    fn attenuations_of_the_thesis() {
        assert_close(thesis_linear_attenuation(3.0, 1.0), 0.25);
        assert_close(thesis_linear_attenuation(0.0, 0.0), 1.0);
        assert_close(thesis_physical_attenuation(1.0, 1.0), 0.25);
        assert_close(thesis_physical_attenuation(0.0, 0.0), 1.0);
    }
}
