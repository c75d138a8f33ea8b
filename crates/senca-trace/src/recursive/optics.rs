//! Shares of reflected and transmitted rays.

use crate::fresnel::dielectric;

/// Share of unpolarised light that a smooth surface between two clear media reflects, in [0, 1].
/// `cos1` in [0, 1] is the cosine of the angle of incidence, `eta` the index of refraction of the medium it
/// comes from over that of the medium it enters.
/// Source: Fresnel's equations (Born and Wolf, Principles of Optics, section 1.5.2).
#[must_use]
pub fn fresnel_share(cos1: f64, eta: f64) -> f64 {
    dielectric(cos1.clamp(0.0, 1.0), eta.recip()).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_four_percent_straight_on_and_all_at_grazing() {
        assert!((fresnel_share(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel_share(1.0, 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel_share(0.0, 1.0 / 1.5) - 1.0).abs() < 1e-12);
        assert!(fresnel_share(0.3, 1.0) < 1e-30, "equal media do not reflect");
        assert_eq!(fresnel_share(45f64.to_radians().cos(), 1.5), 1.0, "beyond the critical angle");
        // At Brewster's angle only the light across is reflected: ((n^2 - 1) / (n^2 + 1))^2 / 2.
        let brewster = 1.5f64.atan().cos();
        assert!((fresnel_share(brewster, 1.0 / 1.5) - 0.5 * (1.25f64 / 3.25).powi(2)).abs() < 1e-12);
    }
}
