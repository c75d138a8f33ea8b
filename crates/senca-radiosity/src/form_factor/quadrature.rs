//! Sums that stand for integrals.

use std::sync::LazyLock;

use std::f64::consts::PI;

/// Largest number of places of a rule.
pub(crate) const MAX_PLACES: usize = 24;

/// The rules of Gauss and Legendre on [0, 1], by number of places.
static RULES: LazyLock<Vec<Vec<[f64; 2]>>> = LazyLock::new(|| (0..=MAX_PLACES).map(gauss_legendre).collect());

/// Places in (0, 1) and weights with sum 1, exact for polynomials of degree `2 n - 1`. `n` is brought
/// into 1 to [`MAX_PLACES`].
pub(crate) fn rule(n: usize) -> &'static [[f64; 2]] {
    &RULES[n.clamp(1, MAX_PLACES)]
}

/// Roots of Legendre's polynomial of degree `n` by Newton's method.
fn gauss_legendre(n: usize) -> Vec<[f64; 2]> {
    let place = |k: usize| {
        let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..20 {
            let (value, slope) = legendre(n, x);
            x -= value / slope;
        }
        let (_, slope) = legendre(n, x);
        [0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(place).collect()
}

/// Legendre's polynomial and its derivative, |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
    }
    (value, n as f64 * (before - x * value) / (1.0 - x * x))
}

/// Integral of `f` from `a` to `b`: intervals are halved until both halves agree with the whole to
/// `tolerance`, at most 48 times, which grades them towards a singular end.
pub(crate) fn adaptive(f: &impl Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> f64 {
    refine(f, a, b, gauss(f, a, b), tolerance, 48)
}

fn refine(f: &impl Fn(f64) -> f64, a: f64, b: f64, whole: f64, tolerance: f64, levels: u32) -> f64 {
    let middle = 0.5 * (a + b);
    let halves = [gauss(f, a, middle), gauss(f, middle, b)];
    let sum = halves[0] + halves[1];
    // What is not a number ends it too.
    if levels > 0 && (sum - whole).abs() > tolerance {
        return refine(f, a, middle, halves[0], tolerance, levels - 1)
            + refine(f, middle, b, halves[1], tolerance, levels - 1);
    }
    sum
}

fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    (b - a) * rule(10).iter().map(|&[x, weight]| weight * f(a + (b - a) * x)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_for_polynomials() {
        for n in 1..=MAX_PLACES {
            let degree = 2 * n as i32 - 1;
            let sum: f64 = rule(n).iter().map(|[x, w]| w * x.powi(degree)).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15, "{n}: {sum}");
        }
    }

    #[test]
    fn a_singular_end_is_met_by_grading() {
        let integral = adaptive(&|x: f64| x.ln(), 0.0, 1.0, 1e-15);
        assert!((integral + 1.0).abs() < 1e-13, "{integral}");
        assert!(adaptive(&|_| f64::NAN, 0.0, 1.0, 1e-15).is_nan());
    }
}
