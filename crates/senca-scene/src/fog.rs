//! Fog and depth cueing.

use senca_math::LinearRgb;

/// Mixes a far colour in with growing distance from the eye (course text, section 2.5, eq. 2.10-11):
/// the picture is `mu * shaded + (1 - mu) * color`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Colour of the far, I_DC.
    pub color: LinearRgb,
    /// How mu falls.
    pub falloff: FogFalloff,
}

/// How the share mu of the surface's own colour falls with the distance z from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FogFalloff {
    /// 1 up to `start`, linear down to `min_share` at `end` and beyond.
    Linear {
        /// z_f, >= 0.
        start: f64,
        /// z_b, > `start`.
        end: f64,
        /// mu_b in [0, 1]; 0 makes far things vanish.
        min_share: f64,
    },
    /// `exp(-density z)`.
    Exponential {
        /// Density, >= 0, per world unit.
        density: f64,
    },
    /// `exp(-(density z)^2)`.
    ExponentialSquared {
        /// Density, >= 0, per world unit.
        density: f64,
    },
}
