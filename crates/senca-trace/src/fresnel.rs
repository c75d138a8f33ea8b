//! Reflection and refraction at the smooth border of two media.

use senca_math::glam::DVec3;

/// Share of unpolarised light that a border of dielectrics reflects, and the cosine of the angle of
/// refraction, which is 0 where everything is reflected.
///
/// `cos` >= 0 is the cosine of the angle of incidence, `eta` the index of refraction beyond the border
/// over that on this side. Source: Fresnel 1823; Born and Wolf, section 1.5.2.
pub(crate) fn dielectric(cos: f64, eta: f64) -> (f64, f64) {
    let cos2_beyond = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if cos2_beyond <= 0.0 {
        return (1.0, 0.0);
    }
    let beyond = cos2_beyond.sqrt();
    let across = (cos - eta * beyond) / (cos + eta * beyond);
    let along = (eta * cos - beyond) / (eta * cos + beyond);
    (0.5 * (across * across + along * along), beyond)
}

/// The mirrored direction of `w`, both leaving the surface; `normal` is of unit length.
pub(crate) fn mirrored(w: DVec3, normal: DVec3) -> DVec3 {
    2.0 * w.dot(normal) * normal - w
}

/// Direction in which light goes on beyond the border, for `w` leaving it on this side, where the
/// unit `normal` is; `cos_beyond` is from [`dielectric`].
pub(crate) fn refracted(w: DVec3, normal: DVec3, eta: f64, cos_beyond: f64) -> DVec3 {
    (w.dot(normal) / eta - cos_beyond) * normal - w / eta
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_reflectances() {
        let reflectance = |degrees: f64, eta| dielectric(degrees.to_radians().cos(), eta).0;
        assert!((reflectance(0.0, 1.5) - 0.04).abs() < 1e-12);
        assert!((reflectance(0.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        // Brewster's angle: half of what is polarised across remains.
        let brewster = 1.5f64.atan().to_degrees();
        assert!((reflectance(brewster, 1.5) - 0.5 * ((1.0f64 - 2.25) / 3.25).powi(2)).abs() < 1e-12);
        assert!((reflectance(90.0, 1.5) - 1.0).abs() < 1e-12);
        assert_eq!(reflectance(42.0, 1.0 / 1.5), 1.0, "beyond the critical angle of 41.81 degrees");
        assert!(reflectance(41.5, 1.0 / 1.5) < 1.0);
        assert!(reflectance(60.0, 1.0) < 1e-24, "no border at all");
    }

    proptest! {
        #[test]
        fn the_way_back_is_the_same(angle in 0.0f64..1.57, eta in 0.4f64..2.5) {
            let w = DVec3::new(angle.sin(), 0.0, angle.cos());
            let (there, cos) = dielectric(w.z, eta);
            prop_assume!(cos > 1e-4);
            let t = refracted(w, DVec3::Z, eta, cos);
            prop_assert!((t.length() - 1.0).abs() < 1e-9 && (t.z + cos).abs() < 1e-12);
            prop_assert!((w.x - eta * -t.x).abs() < 1e-9, "Snell");
            let (back, cos_back) = dielectric(cos, 1.0 / eta);
            prop_assert!((there - back).abs() < 1e-9 && (cos_back - w.z).abs() < 1e-6);
            prop_assert!(mirrored(w, DVec3::Z).abs_diff_eq(DVec3::new(-w.x, 0.0, w.z), 1e-12));
        }
    }
}
