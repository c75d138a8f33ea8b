//! Reflectors: lights that shine into a part of space only (course text, section 2.5).

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_scene::SpotFalloff;

/// Share of a cone light's intensity at the angle whose cosine is `cos_gamma` from its axis.
#[must_use]
pub fn spot_share(falloff: &SpotFalloff, cos_gamma: f32) -> f32 {
    match *falloff {
        SpotFalloff::Sharp { angle } => cone_sharp(angle as f32, cos_gamma),
        SpotFalloff::Cosine { exponent } => cone_cosine(exponent as f32, cos_gamma),
        SpotFalloff::Smooth { inner, outer } => cone_smooth(inner as f32, outer as f32, cos_gamma),
    }
}

/// 1 up to `limit` (radians), 0 beyond: variant (a).
#[must_use]
pub fn cone_sharp(limit: f32, cos_gamma: f32) -> f32 {
    if cos_gamma >= limit.cos() { 1.0 } else { 0.0 }
}

/// `cos^exponent`, 0 behind: variant (b). Larger exponents make narrower beams.
#[must_use]
pub fn cone_cosine(exponent: f32, cos_gamma: f32) -> f32 {
    if cos_gamma > 0.0 { cos_gamma.powf(exponent) } else { 0.0 }
}

/// 1 inside `inner`, 0 outside `outer` (radians), the square of a ramp of the cosine in between.
/// Source: KHR_lights_punctual, section "Inner and Outer Cone Angles".
#[must_use]
pub fn cone_smooth(inner: f32, outer: f32, cos_gamma: f32) -> f32 {
    let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
    let ramp = (cos_gamma - cos_outer) / (cos_inner - cos_outer).max(1e-3);
    ramp.clamp(0.0, 1.0).powi(2)
}

/// `reflector_from_world` of a box reflector at `position` whose beam runs along `direction`: the
/// beam is +z, x is `up` x `direction`, y completes the right-handed frame. `None` when `direction`
/// is zero or `up` is parallel to it.
/// Source: course text, section 2.5, equation 2.13.
#[must_use]
pub fn box_light_frame(position: DVec3, direction: DVec3, up: DVec3) -> Option<DMat4> {
    let z = direction.try_normalize()?;
    let x = up.cross(z).try_normalize()?;
    let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
    Some(DMat4::from_mat3(rotation) * DMat4::from_translation(-position))
}

/// Whether a point in the reflector's frame is in its prism of light: x and y within `min` and
/// `max`, z within 0 and `depth`, all closed.
/// Source: course text, section 2.5, equation 2.14.
#[must_use]
pub fn box_light_contains(min: [f64; 2], max: [f64; 2], depth: f64, point_reflector: DVec3) -> bool {
    let p = point_reflector;
    (min[0]..=max[0]).contains(&p.x) && (min[1]..=max[1]).contains(&p.y) && (0.0..=depth).contains(&p.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_4, FRAC_PI_6};

    #[test]
    fn cosine_cone_at_30_degrees() {
        for (n, share) in [(1.0, 0.866_025), (5.0, 0.487_139), (10.0, 0.237_305), (50.0, 0.000_753)] {
            let s = cone_cosine(n, FRAC_PI_6.cos());
            assert!((s - share).abs() < 1e-6, "exponent {n}: {s}");
        }
        assert_eq!(cone_cosine(1.0, -0.5), 0.0);
    }

    #[test]
    fn sharp_and_smooth_cones() {
        assert_eq!(cone_sharp(FRAC_PI_6, 0.9), 1.0);
        assert_eq!(cone_sharp(FRAC_PI_6, 0.8), 0.0);
        assert_eq!(cone_smooth(FRAC_PI_6, FRAC_PI_4, 0.99), 1.0);
        assert_eq!(cone_smooth(FRAC_PI_6, FRAC_PI_4, 0.7), 0.0);
        let middle = 0.5 * (FRAC_PI_6.cos() + FRAC_PI_4.cos());
        assert!((cone_smooth(FRAC_PI_6, FRAC_PI_4, middle) - 0.25).abs() < 1e-5);
    }

    #[test]
    fn box_light_points() {
        let frame = box_light_frame(DVec3::new(0.0, 5.0, 0.0), -DVec3::Y, DVec3::Z).expect("regular");
        for (world, local, lit) in [
            ([0.0, 0.0, 0.0], [0.0, 0.0, 5.0], true),
            ([0.5, 1.0, 0.25], [0.5, 0.25, 4.0], true),
            ([1.5, 1.0, 0.0], [1.5, 0.0, 4.0], false),
            ([0.0, 6.0, 0.0], [0.0, 0.0, -1.0], false),
            ([0.0, -6.0, 0.0], [0.0, 0.0, 11.0], false),
        ] {
            let p = frame.transform_point3(DVec3::from_array(world));
            assert!(p.abs_diff_eq(DVec3::from_array(local), 1e-12), "{world:?} became {p}");
            assert_eq!(box_light_contains([-1.0; 2], [1.0; 2], 10.0, p), lit, "{world:?}");
        }
        assert!(box_light_frame(DVec3::ZERO, DVec3::X, DVec3::X).is_none());
    }
}
