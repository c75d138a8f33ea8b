//! Directions and shares of reflected and transmitted rays (course text, section 3.2).

use senca_math::glam::DVec3;

/// Direction of the mirrored ray, `r = 2 n cos(phi1) + a`, of a ray that comes along the unit vector
/// `a` onto a surface with unit normal `n`.
/// Source: course text, section 3.2, equation 3.10.
#[must_use]
#[inline]
pub fn reflected_direction(a: DVec3, n: DVec3) -> DVec3 {
    a - 2.0 * n.dot(a) * n
}

/// Direction of the ray that goes on through the surface, `t = (eta1 / eta2) (n cos(phi1) + a) - n
/// cos(phi2)`, of a ray that comes along the unit vector `a` onto a surface with unit normal `n` on its
/// side. `eta` is `eta1 / eta2`: index of refraction of the medium it comes from over that of the
/// medium it enters. `None` when all light is reflected, which the text passes over.
/// Source: course text, section 3.2, equations 3.11 to 3.13.
#[must_use]
#[inline]
pub fn transmitted_direction(a: DVec3, n: DVec3, eta: f64) -> Option<DVec3> {
    let cos1 = -n.dot(a);
    let radicand = 1.0 - eta * eta * (1.0 - cos1 * cos1);
    (radicand >= 0.0).then(|| (eta * (n * cos1 + a) - n * radicand.sqrt()).normalize_or(a))
}

/// Share of unpolarised light that a smooth surface between two clear media reflects, in [0, 1].
/// `cos1` in [0, 1] is the cosine of the angle of incidence, `eta` as in [`transmitted_direction`].
/// Source: Fresnel's equations (Born and Wolf, Principles of Optics, section 1.5.2).
#[must_use]
pub fn fresnel_share(cos1: f64, eta: f64) -> f64 {
    let cos1 = cos1.clamp(0.0, 1.0);
    let radicand = 1.0 - eta * eta * (1.0 - cos1 * cos1);
    if radicand <= 0.0 {
        return 1.0;
    }
    let cos2 = radicand.sqrt();
    let across = (eta * cos1 - cos2) / (eta * cos1 + cos2);
    let along = (cos1 - eta * cos2) / (cos1 + eta * cos2);
    0.5 * (across * across + along * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: DVec3 = DVec3::Z;

    fn close(a: DVec3, b: [f64; 3]) {
        assert!((a - DVec3::from_array(b)).length() < 1e-9, "{a} is not {b:?}");
    }

    #[test]
    fn mirrored_directions() {
        close(reflected_direction(DVec3::new(0.6, 0.0, -0.8), N), [0.6, 0.0, 0.8]);
        close(reflected_direction(DVec3::NEG_Z, N), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn transmitted_directions() {
        let a = DVec3::new(0.6, 0.0, -0.8);
        let through = |a, eta| transmitted_direction(a, N, eta).expect("goes through");
        close(through(a, 1.0 / 1.5), [0.4, 0.0, -0.916_515_139_0]);
        close(through(a, 1.5), [0.9, 0.0, -0.435_889_894_4]);
        close(through(a, 1.0), [0.6, 0.0, -0.8]);
        for eta in [0.5, 1.0, 2.0] {
            close(through(DVec3::NEG_Z, eta), [0.0, 0.0, -1.0]);
        }
        let at = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            DVec3::new(sin, 0.0, -cos)
        };
        close(through(at(45.0), 1.0 / 1.5), [0.471_404_520_8, 0.0, -0.881_917_103_7]);
        let angle = |t: DVec3| t.x.atan2(-t.z).to_degrees();
        assert!((angle(through(at(45.0), 1.0 / 1.5)) - 28.125_5).abs() < 1e-4);
        assert!((angle(through(at(30.0), 1.0 / 1.5)) - 19.471_2).abs() < 1e-4);
    }

    #[test]
    fn beyond_the_critical_angle_all_is_reflected() {
        let at = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            DVec3::new(sin, 0.0, -cos)
        };
        assert_eq!(transmitted_direction(at(45.0), N, 1.5), None);
        assert!(transmitted_direction(at(41.810_2), N, 1.5).is_some());
        assert_eq!(transmitted_direction(at(41.810_4), N, 1.5), None);
        assert_eq!(fresnel_share(at(45.0).z.abs(), 1.5), 1.0);
    }

    #[test]
    fn glass_reflects_four_percent_straight_on_and_all_at_grazing() {
        assert!((fresnel_share(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel_share(1.0, 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel_share(0.0, 1.0 / 1.5) - 1.0).abs() < 1e-12);
        assert!(fresnel_share(0.3, 1.0) < 1e-30, "equal media do not reflect");
        // At Brewster's angle only the light across is reflected: ((n^2 - 1) / (n^2 + 1))^2 / 2.
        let brewster = 1.5f64.atan().cos();
        assert!((fresnel_share(brewster, 1.0 / 1.5) - 0.5 * (1.25f64 / 3.25).powi(2)).abs() < 1e-12);
    }
}
