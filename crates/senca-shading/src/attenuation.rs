//! How light falls off with the distance from its source.

use senca_scene::Attenuation;

/// Share of a light's intensity left at distance `d` >= 0 (world units), in [0, 1] for
/// [`Attenuation::Polynomial`] and without upper limit for [`Attenuation::InverseSquare`].
#[must_use]
pub fn distance_attenuation(attenuation: &Attenuation, d: f32) -> f32 {
    match *attenuation {
        Attenuation::None => 1.0,
        Attenuation::Polynomial { constant, linear, quadratic } => {
            polynomial_attenuation([constant as f32, linear as f32, quadratic as f32], d)
        }
        Attenuation::InverseSquare { range } => inverse_square(d, range.map(|r| r as f32)),
    }
}

/// `min(1 / (c0 + c1 d + c2 d^2), 1)`.
///
/// A denominator of 0 or below (at the source itself with c0 = 0, or from negative constants) gives
/// 1, the limit of the minimum.
/// Source: course text, section 2.5, equation 2.4.
#[must_use]
pub fn polynomial_attenuation([c0, c1, c2]: [f32; 3], d: f32) -> f32 {
    let denominator = c0 + d * (c1 + d * c2);
    if denominator > 1.0 { 1.0 / denominator } else { 1.0 }
}

/// `1 / d^2`, ended smoothly at `range` by `clamp(1 - (d / range)^4, 0, 1)`.
///
/// Nearer than 1 % of a world unit the distance counts as that, so a light inside a surface gives a
/// large finite value.
/// Source: KHR_lights_punctual, section "Range property".
#[must_use]
pub fn inverse_square(d: f32, range: Option<f32>) -> f32 {
    let falloff = 1.0 / (d * d).max(1e-4);
    match range {
        Some(range) if range > 0.0 => falloff * (1.0 - (d / range).powi(4)).clamp(0.0, 1.0),
        _ => falloff,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-6, "{a} is not {b}");
    }

    #[test]
    fn values_of_the_polynomial() {
        for (c, d, expected) in [
            ([0.0, 0.1, 0.0], 0.0, 1.0),
            ([0.0, 0.1, 0.0], 1.0, 1.0),
            ([0.0, 0.1, 0.0], 5.0, 1.0),
            ([0.0, 0.1, 0.0], 10.0, 1.0),
            ([0.0, 0.1, 0.0], 20.0, 0.5),
            ([0.0, 1.0, 0.0], 0.0, 1.0),
            ([0.0, 1.0, 0.0], 0.5, 1.0),
            ([0.0, 1.0, 0.0], 1.0, 1.0),
            ([0.0, 1.0, 0.0], 2.0, 0.5),
            ([0.0, 1.0, 0.0], 10.0, 0.1),
            ([1.0, 0.5, 0.25], 1.0, 0.571_428_6),
            ([1.0, 0.5, 0.25], 2.0, 1.0 / 3.0),
            ([1.0, 0.5, 0.25], 10.0, 0.032_258_064),
        ] {
            assert_close(polynomial_attenuation(c, d), expected);
        }
    }

    #[test]
    fn negative_constants_and_a_zero_denominator_mean_no_loss() {
        assert_eq!(polynomial_attenuation([0.0, 0.0, 0.0], 3.0), 1.0);
        assert_eq!(polynomial_attenuation([-1.0, 0.0, 0.0], 3.0), 1.0);
        assert_eq!(distance_attenuation(&Attenuation::None, 1e9), 1.0);
    }

    #[test]
    fn inverse_square_ends_at_its_range() {
        assert_close(inverse_square(2.0, None), 0.25);
        assert_close(inverse_square(2.0, Some(4.0)), 0.25 * (1.0 - 0.0625));
        assert_eq!(inverse_square(4.0, Some(4.0)), 0.0);
        assert_eq!(inverse_square(9.0, Some(4.0)), 0.0);
        assert!(inverse_square(0.0, None).is_finite());
    }
}
