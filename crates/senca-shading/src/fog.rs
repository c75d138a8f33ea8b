//! Fog and depth cueing (course text, section 2.5, equations 2.10 and 2.11).

use senca_math::LinearRgb;
use senca_scene::{Fog, FogFalloff};

/// Share mu, in [0, 1], of the surface's own colour that is left at distance `z` from the observer.
#[must_use]
pub fn fog_share(falloff: &FogFalloff, z: f32) -> f32 {
    match *falloff {
        FogFalloff::Linear { start, end, min_share } => {
            linear_share(start as f32, end as f32, min_share as f32, z)
        }
        FogFalloff::Exponential { density } => (-(density as f32) * z.max(0.0)).exp(),
        FogFalloff::ExponentialSquared { density } => (-(density as f32 * z).powi(2)).exp(),
    }
}

/// 1 up to `start`, linear down to `min_share` at `end`, constant beyond; a jump where `end` is not
/// beyond `start`.
fn linear_share(start: f32, end: f32, min_share: f32, z: f32) -> f32 {
    if z <= start {
        1.0
    } else if z >= end {
        min_share
    } else {
        min_share + (z - end) / (start - end) * (1.0 - min_share)
    }
}

/// `mu color + (1 - mu) far`, mu from [`fog_share`] at distance `z`.
#[must_use]
pub fn apply_fog(fog: &Fog, color: LinearRgb, z: f32) -> LinearRgb {
    let mu = fog_share(&fog.falloff, z);
    color * mu + fog.color * (1.0 - mu)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINEAR: FogFalloff = FogFalloff::Linear { start: 10.0, end: 40.0, min_share: 0.1 };

    #[test]
    fn linear_values() {
        let values =
            [(5.0, 1.0), (10.0, 1.0), (20.0, 0.7), (25.0, 0.55), (30.0, 0.4), (40.0, 0.1), (99.0, 0.1)];
        for (z, mu) in values {
            assert!((fog_share(&LINEAR, z) - mu).abs() < 1e-6, "at {z}");
        }
    }

    #[test]
    fn mixed_colour() {
        let fog = Fog { color: LinearRgb::new(0.5, 0.5, 0.6), falloff: LINEAR };
        let c = apply_fog(&fog, LinearRgb::new(0.8, 0.4, 0.2), 25.0);
        for (a, b) in c.to_array().into_iter().zip([0.665, 0.445, 0.38]) {
            assert!((a - b).abs() < 1e-6, "{c:?}");
        }
    }

    #[test]
    fn exponential_values() {
        let e = FogFalloff::Exponential { density: 0.1 };
        assert!((fog_share(&e, 10.0) - (-1f32).exp()).abs() < 1e-6);
        assert_eq!(fog_share(&e, -5.0), 1.0);
        let e2 = FogFalloff::ExponentialSquared { density: 0.1 };
        assert!((fog_share(&e2, 20.0) - (-4f32).exp()).abs() < 1e-6);
    }
}
