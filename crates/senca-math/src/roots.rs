//! Real roots of polynomials.
//!
//! Up to degree four here; of any degree on an interval in [`bernstein`] and, as its plain twin,
//! [`sturm`]. The textbook's formulas of Cardano and Ferrari are in [`closed_form`].
//!
//! The functions here give the real roots in ascending order, in a list of fixed capacity. A double root
//! is given once or twice, depending on rounding; what is certain is that each root given makes the
//! polynomial zero up to rounding, and that a root at which the sign changes is not missed. A zero
//! leading coefficient lowers the degree; the zero polynomial has no roots to give.
//!
//! Method: the quadratic by the formula that never subtracts like numbers; cubic and quartic by the
//! turning points, which are the roots of the derivative. Between two neighbouring turning points a
//! polynomial is monotone, so a bracketed Newton iteration finds its one root there to the last digit.
//! Closed formulas after Cardano and Ferrari lose up to half of the digits near multiple roots.

pub mod bernstein;
pub mod closed_form;
pub mod sturm;

pub use bernstein::{
    bernstein_from_power, bernstein_roots, bernstein_roots_of_any, polynomial_roots_between, restrict_to,
};
pub use closed_form::{cubic_roots_closed_form, quartic_roots_closed_form, roots_closed_form};
pub use sturm::sturm_roots;

/// Up to four roots, ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Roots {
    values: [f64; 4],
    count: usize,
}

impl Roots {
    /// The roots, ascending.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }

    fn push(&mut self, root: f64) {
        if root.is_finite() && self.count < 4 {
            self.values[self.count] = root;
            self.count += 1;
        }
    }

    fn from_sorted(roots: impl IntoIterator<Item = f64>) -> Self {
        let mut all = Self::default();
        roots.into_iter().for_each(|root| all.push(root));
        all
    }
}

impl std::ops::Deref for Roots {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        self.as_slice()
    }
}

/// Real roots of `a x + b`.
#[must_use]
pub fn linear_roots(a: f64, b: f64) -> Roots {
    if a == 0.0 { Roots::default() } else { Roots::from_sorted([-b / a]) }
}

/// Real roots of `a x^2 + b x + c`.
#[must_use]
pub fn quadratic_roots(a: f64, b: f64, c: f64) -> Roots {
    // Scaled, so that the discriminant neither overflows nor vanishes.
    let Some([a, b, c]) = scaled([a, b, c]) else { return Roots::default() };
    if a == 0.0 {
        return linear_roots(b, c);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Roots::default();
    }
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    let (first, second) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    Roots::from_sorted([first.min(second), first.max(second)])
}

/// Real roots of `a x^3 + b x^2 + c x + d`.
#[must_use]
pub fn cubic_roots(a: f64, b: f64, c: f64, d: f64) -> Roots {
    let Some([a, b, c, d]) = scaled([a, b, c, d]) else { return Roots::default() };
    if a == 0.0 {
        return quadratic_roots(b, c, d);
    }
    between_turning_points(&[a, b, c, d], &quadratic_roots(3.0 * a, 2.0 * b, c))
}

/// Real roots of `a x^4 + b x^3 + c x^2 + d x + e`.
#[must_use]
pub fn quartic_roots(a: f64, b: f64, c: f64, d: f64, e: f64) -> Roots {
    let Some([a, b, c, d, e]) = scaled([a, b, c, d, e]) else { return Roots::default() };
    if a == 0.0 {
        return cubic_roots(b, c, d, e);
    }
    between_turning_points(&[a, b, c, d, e], &cubic_roots(4.0 * a, 3.0 * b, 2.0 * c, d))
}

/// Coefficients with their largest between 1 and 2, scaled without rounding; `None` for the zero
/// polynomial and for what is not finite.
fn scaled<const N: usize>(coefficients: [f64; N]) -> Option<[f64; N]> {
    let largest = coefficients.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let usable = largest > 0.0 && coefficients.iter().all(|c| c.is_finite());
    // The power of two in the largest: its exponent bits alone.
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits()).max(f64::MIN_POSITIVE);
    usable.then(|| coefficients.map(|c| c / power))
}

/// Value and derivative, highest power first.
fn value_and_slope(p: &[f64], x: f64) -> (f64, f64) {
    p.iter().fold((0.0, 0.0), |(value, slope), &c| (value * x + c, slope * x + value))
}

/// Rounding error that a value at `x` may carry.
fn noise(p: &[f64], x: f64) -> f64 {
    4.0 * f64::EPSILON * p.iter().fold(0.0, |sum, c| sum * x.abs() + c.abs())
}

/// One root in every monotone stretch where the sign changes, and a turning point that touches zero.
fn between_turning_points(p: &[f64], turning: &[f64]) -> Roots {
    // All roots lie within this radius (Cauchy 1829).
    let radius = 1.0 + p[1..].iter().fold(0.0f64, |m, c| m.max((c / p[0]).abs()));
    let radius = radius.min(f64::MAX.powf(1.0 / p.len() as f64));
    let mut roots = Roots::default();
    let mut low = -radius;
    let ends = turning.iter().copied().filter(|t| t.abs() < radius).chain([radius]);
    for high in ends {
        let (at_low, at_high) = (value_and_slope(p, low).0, value_and_slope(p, high).0);
        let touches = high < radius && at_high.abs() <= noise(p, high);
        let found_at_low = roots.last().is_some_and(|&root| root == low);
        if touches {
            if !found_at_low || high != low {
                roots.push(high);
            }
        } else if !found_at_low && (at_low < 0.0) != (at_high < 0.0) && at_low != 0.0 {
            roots.push(bracketed_newton(p, low, high, at_low < 0.0));
        }
        low = high;
    }
    roots
}

/// The root between `low` and `high`, where the sign changes; `rising` if from minus to plus.
fn bracketed_newton(p: &[f64], mut low: f64, mut high: f64, rising: bool) -> f64 {
    let mut x = 0.5 * (low + high);
    // Bisection alone would end within 2000 steps even over the whole range of f64; with Newton's
    // steps a handful do.
    for _ in 0..2000 {
        let (value, slope) = value_and_slope(p, x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == rising {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == x || next <= low && next >= high || high - low <= f64::EPSILON * x.abs() {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn close(found: &[f64], expected: &[f64], tolerance: f64) -> bool {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance * (1.0 + b.abs()))
    }

    #[test]
    fn quadratics_keep_all_digits() {
        assert_eq!(quadratic_roots(1.0, -3.0, 2.0).as_slice(), [1.0, 2.0]);
        assert_eq!(quadratic_roots(-1.0, 3.0, -2.0).as_slice(), [1.0, 2.0]);
        assert!(quadratic_roots(1.0, 0.0, 1.0).is_empty());
        assert_eq!(quadratic_roots(0.0, 2.0, -4.0).as_slice(), [2.0]);
        assert!(quadratic_roots(0.0, 0.0, 1.0).is_empty() && quadratic_roots(0.0, 0.0, 0.0).is_empty());
        assert!(close(&quadratic_roots(1.0, -1e9, 1.0), &[1e-9, 1e9], 1e-15));
        assert!(close(&quadratic_roots(1e-300, -3e-300, 2e-300), &[1.0, 2.0], 1e-15));
        assert!(close(&quadratic_roots(1e300, -3e300, 2e300), &[1.0, 2.0], 1e-15));
        assert_eq!(quadratic_roots(1.0, 0.0, -4.0).as_slice(), [-2.0, 2.0]);
        assert!(quadratic_roots(f64::NAN, 1.0, 1.0).is_empty());
    }

    #[test]
    fn cubics_and_quartics_of_known_roots() {
        assert!(close(&cubic_roots(1.0, -6.0, 11.0, -6.0), &[1.0, 2.0, 3.0], 1e-14));
        assert!(close(&cubic_roots(1.0, 0.0, 0.0, -8.0), &[2.0], 1e-15));
        assert!(close(&cubic_roots(0.0, 1.0, -3.0, 2.0), &[1.0, 2.0], 1e-15));
        assert_eq!(cubic_roots(1.0, 0.0, 0.0, 0.0).as_slice()[0], 0.0);
        assert!(close(&quartic_roots(1.0, -10.0, 35.0, -50.0, 24.0), &[1.0, 2.0, 3.0, 4.0], 1e-13));
        assert!(quartic_roots(1.0, 0.0, 0.0, 0.0, 1.0).is_empty());
        assert!(close(&quartic_roots(1.0, 0.0, -5.0, 0.0, 4.0), &[-2.0, -1.0, 1.0, 2.0], 1e-15));
        assert!(close(&quartic_roots(0.0, 1.0, -6.0, 11.0, -6.0), &[1.0, 2.0, 3.0], 1e-14));
        assert!(quartic_roots(0.0, 0.0, 0.0, 0.0, 0.0).is_empty());
        assert!(quartic_roots(1.0, f64::INFINITY, 0.0, 0.0, 0.0).is_empty());
    }

    #[test]
    fn touching_roots_are_found() {
        // (x - 1)^2 (x + 2) and (x - 1)^2 (x - 3)^2
        let cubic = cubic_roots(1.0, 0.0, -3.0, 2.0);
        assert!((cubic[0] + 2.0).abs() < 1e-14 && (cubic[1] - 1.0).abs() < 1e-7);
        let quartic = quartic_roots(1.0, -8.0, 22.0, -24.0, 9.0);
        assert!(
            quartic.iter().any(|r| (r - 1.0).abs() < 1e-7) && quartic.iter().any(|r| (r - 3.0).abs() < 1e-7)
        );
    }

    /// Coefficients of the product of `x - root`, highest power first.
    fn expanded(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |p, root| {
            let mut raised = p.clone();
            raised.push(0.0);
            p.iter().enumerate().for_each(|(i, c)| raised[i + 1] -= root * c);
            raised
        })
    }

    proptest! {
        #[test]
        fn well_separated_roots_come_back(
            gaps in prop::collection::vec(0.1..3.0f64, 4),
            first in -6.0..3.0f64,
            scale in prop_oneof![-9.0..-0.1f64, 0.1..9.0f64],
        ) {
            let mut roots = vec![first];
            for gap in &gaps[..3] {
                roots.push(roots[roots.len() - 1] + gap);
            }
            let p: Vec<f64> = expanded(&roots).iter().map(|c| c * scale).collect();
            prop_assert!(close(&quartic_roots(p[0], p[1], p[2], p[3], p[4]), &roots, 1e-8));
            let p = expanded(&roots[..3]);
            prop_assert!(close(&cubic_roots(p[0], p[1], p[2], p[3]), &roots[..3], 1e-9));
            let p = expanded(&roots[..2]);
            prop_assert!(close(&quadratic_roots(p[0], p[1], p[2]), &roots[..2], 1e-12));
        }

        #[test]
        fn complex_pairs_give_no_roots(
            real in prop::array::uniform2(-4.0..4.0f64),
            middle in -3.0..3.0f64,
            imaginary in 0.3..3.0f64,
        ) {
            let (mut r, q) = (real, [1.0, -2.0 * middle, middle * middle + imaginary * imaginary]);
            r.sort_by(f64::total_cmp);
            prop_assume!(r[1] - r[0] > 0.05);
            let p = expanded(&r);
            let product = |k: usize| (0..3).filter(|i| k >= *i && k - i < 3).map(|i| q[i] * p[k - i]).sum::<f64>();
            let found = quartic_roots(product(0), product(1), product(2), product(3), product(4));
            prop_assert!(close(&found, &r, 1e-8), "{:?} {:?}", found, r);
        }

        #[test]
        fn any_coefficients_give_sorted_roots_that_hold(c in prop::array::uniform5(-5.0..5.0f64)) {
            let roots = quartic_roots(c[0], c[1], c[2], c[3], c[4]);
            prop_assert!(roots.windows(2).all(|pair| pair[0] <= pair[1]));
            for &x in roots.iter() {
                let size = c.iter().fold(0.0, |sum, k| sum * x.abs() + k.abs());
                prop_assert!(value_and_slope(&c, x).0.abs() <= 1e-12 * size);
            }
            // Every change of sign on a grid has a root.
            for k in -400..400 {
                let (a, b) = (f64::from(k) * 0.01, f64::from(k + 1) * 0.01);
                if value_and_slope(&c, a).0 * value_and_slope(&c, b).0 < 0.0 {
                    prop_assert!(roots.iter().any(|r| (a..=b).contains(r)));
                }
            }
        }

        #[test]
        fn wild_coefficients_end(c in prop::array::uniform5(any::<f64>())) {
            let roots = quartic_roots(c[0], c[1], c[2], c[3], c[4]);
            prop_assert!(roots.iter().all(|r| r.is_finite()));
        }
    }
}
