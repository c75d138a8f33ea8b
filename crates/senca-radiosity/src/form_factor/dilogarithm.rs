//! The imaginary part of the dilogarithm, of which Clausen's function is the case on the unit circle.

/// B_2k / (2k + 1)! for k = 1, 2, ...: the series of the dilogarithm in the logarithm. The
/// ratio of neighbours tends to 1 / (2 pi)^2, so at |u| <= 1.25 the last is below one part in 10^16.
const BERNOULLI: [f64; 10] = [
    1.0 / 36.0,
    -1.0 / 3_600.0,
    1.0 / 211_680.0,
    -1.0 / 10_886_400.0,
    1.0 / 526_901_760.0,
    -691.0 / 16_999_766_784_000.0,
    1.0 / 1_120_863_744_000.0,
    -3_617.0 / 181_400_588_328_960_000.0,
    43_867.0 / 97_072_790_126_247_936_000.0,
    -174_611.0 / 16_860_010_916_664_115_200_000.0,
];

type Complex = (f64, f64);

fn times((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

/// Logarithm, imaginary part in (-pi, pi].
fn ln((a, b): Complex) -> Complex {
    (0.5 * (a * a + b * b).ln(), b.atan2(a))
}

/// Imaginary part of Li2(x + i y), where |x + i y| <= 1. Absolute error below 1e-15.
///
/// With u = -ln(1 - z) the series u - u^2/4 + sum B_2k u^(2k+1) / (2k+1)! converges fast on the left
/// half of the disc; the right half is mirrored by Li2(z) = pi^2/6 - ln z ln(1 - z) - Li2(1 - z).
pub(crate) fn imaginary_dilogarithm(x: f64, y: f64) -> f64 {
    if y == 0.0 {
        return 0.0;
    }
    let rest = ln((1.0 - x, -y));
    if x <= 0.5 {
        return series((-rest.0, -rest.1));
    }
    let mirrored = ln((x, y));
    -times(mirrored, rest).1 - series((-mirrored.0, -mirrored.1))
}

fn series(u: Complex) -> f64 {
    let square = times(u, u);
    let mut sum = (0.0, 0.0);
    for coefficient in BERNOULLI.iter().rev() {
        sum = times(sum, square);
        sum.0 += coefficient;
    }
    let odd = times(times(sum, square), u).1;
    u.1 - 0.25 * square.1 + odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Clausen's function Cl2 of an angle in radians.
    fn clausen(angle: f64) -> f64 {
        imaginary_dilogarithm(angle.cos(), angle.sin())
    }

    #[test]
    fn clausen_has_its_known_values() {
        const CATALAN: f64 = 0.915_965_594_177_219;
        assert!((clausen(PI / 2.0) - CATALAN).abs() < 1e-15);
        assert!((clausen(PI / 3.0) - 1.014_941_606_409_653_6).abs() < 1e-15, "the maximum");
        assert!((clausen(2.0 * PI / 3.0) - 2.0 / 3.0 * clausen(PI / 3.0)).abs() < 1e-15);
        assert_eq!(clausen(0.0), 0.0);
        assert!(clausen(PI).abs() < 1e-15);
    }

    #[test]
    fn inside_the_circle_it_is_the_sum_of_its_series() {
        for (radius, angle) in [(0.3_f64, 0.4_f64), (0.8, 2.0), (0.8, -1.1), (0.5, 3.1), (0.9, 0.1)] {
            let plain: f64 =
                (1..400).map(f64::from).map(|k| radius.powf(k) * (k * angle).sin() / (k * k)).sum();
            let fast = imaginary_dilogarithm(radius * angle.cos(), radius * angle.sin());
            assert!((plain - fast).abs() < 2e-15, "{radius} {angle}: {plain} {fast}");
        }
    }

    #[test]
    fn it_is_odd_in_the_angle() {
        for k in 1..100 {
            let (y, x) = (f64::from(k) * 0.0314).sin_cos();
            assert!((imaginary_dilogarithm(x, y) + imaginary_dilogarithm(x, -y)).abs() < 1e-15);
        }
    }
}
