//! Cubics and quartics by the closed formulas of the textbooks.
//!
//! They are the plain twins of [`cubic_roots`](super::cubic_roots) and
//! [`quartic_roots`](super::quartic_roots): easy to follow with pencil and paper, but near multiple
//! roots they lose up to half of the digits, or take two near roots for none.

use super::{Roots, linear_roots, quadratic_roots, scaled};

/// Real roots of `a x^3 + b x^2 + c x + d` by Cardano's formulas; where all three are real, which
/// the formulas reach only through complex numbers, by the angle's third (Viète).
///
/// 1. `x = y - b / (3 a)` removes the square: `y^3 + p y + q`.
/// 2. `D = (q / 2)^2 + (p / 3)^3` above 0: one root, the sum of two cube roots, the smaller of which
///    follows from the larger, so that nothing cancels.
/// 3. `D` below 0: three roots `2 r cos((phi + 2 pi k) / 3)` with `r^2 = -p / 3`.
///
/// Source: Cardano 1545; Viète 1615.
#[must_use]
pub fn cubic_roots_closed_form(a: f64, b: f64, c: f64, d: f64) -> Roots {
    let Some([a, b, c, d]) = scaled([a, b, c, d]) else { return Roots::default() };
    if a == 0.0 {
        return quadratic_roots(b, c, d);
    }
    let shift = b / (3.0 * a);
    let p = c / a - 3.0 * shift * shift;
    let q = d / a - shift * (c / a) + 2.0 * shift * shift * shift;
    sorted(depressed_cubic(p, q).iter().map(|y| y - shift))
}

/// Real roots of `y^3 + p y + q`.
fn depressed_cubic(p: f64, q: f64) -> Roots {
    let (half_q, third_p) = (0.5 * q, p / 3.0);
    let discriminant = half_q * half_q + third_p * third_p * third_p;
    if discriminant < 0.0 {
        let r = (-third_p).sqrt();
        let phi = (-half_q / (r * r * r)).clamp(-1.0, 1.0).acos();
        let root = |k: f64| 2.0 * r * ((phi + std::f64::consts::TAU * k) / 3.0).cos();
        return sorted([root(0.0), root(1.0), root(2.0)]);
    }
    let larger = -half_q.signum() * (half_q.abs() + discriminant.sqrt()).cbrt();
    if larger == 0.0 {
        return Roots::from_sorted([0.0]);
    }
    let smaller = -third_p / larger;
    if discriminant > 0.0 {
        return Roots::from_sorted([larger + smaller]);
    }
    sorted([2.0 * larger, -larger])
}

/// Real roots of `a x^4 + b x^3 + c x^2 + d x + e` by Ferrari's method.
///
/// 1. `x = y - b / (4 a)` removes the cube: `y^4 + p y^2 + q y + r`.
/// 2. With a root m > 0 of the resolvent cubic `8 m^3 + 8 p m^2 + (2 p^2 - 8 r) m - q^2` the quartic
///    is a difference of squares, `(y^2 + p / 2 + m)^2 - 2 m (y - q / (4 m))^2`.
/// 3. Its two factors are quadratics.
///
/// Source: Ferrari, in Cardano 1545.
#[must_use]
pub fn quartic_roots_closed_form(a: f64, b: f64, c: f64, d: f64, e: f64) -> Roots {
    let Some([a, b, c, d, e]) = scaled([a, b, c, d, e]) else { return Roots::default() };
    if a == 0.0 {
        return cubic_roots_closed_form(b, c, d, e);
    }
    let (b, c, d, e) = (b / a, c / a, d / a, e / a);
    let shift = 0.25 * b;
    let s2 = shift * shift;
    let p = c - 6.0 * s2;
    let q = d - 2.0 * c * shift + 8.0 * s2 * shift;
    let r = e - d * shift + c * s2 - 3.0 * s2 * s2;
    sorted(depressed_quartic(p, q, r).iter().map(|y| y - shift))
}

/// Real roots of `y^4 + p y^2 + q y + r`, in any order.
fn depressed_quartic(p: f64, q: f64, r: f64) -> Roots {
    let resolvent = cubic_roots_closed_form(8.0, 8.0 * p, 2.0 * p * p - 8.0 * r, -q * q);
    let m = resolvent.last().copied().unwrap_or(0.0);
    if q == 0.0 || m <= 0.0 {
        return biquadratic(p, r);
    }
    let s = (2.0 * m).sqrt();
    let halves = [s, -s].map(|s| quadratic_roots(1.0, -s, 0.5 * p + m + 0.5 * q / s));
    sorted(halves.iter().flat_map(|half| half.iter().copied()))
}

/// Real roots of `y^4 + p y^2 + r`.
fn biquadratic(p: f64, r: f64) -> Roots {
    let squares = quadratic_roots(1.0, p, r);
    let roots = squares.iter().filter(|square| **square >= 0.0).map(|square| square.sqrt());
    sorted(roots.flat_map(|root| if root == 0.0 { [root, f64::NAN] } else { [-root, root] }))
}

/// Those values that are finite, ascending.
fn sorted(values: impl IntoIterator<Item = f64>) -> Roots {
    let mut roots = Roots::default();
    values.into_iter().for_each(|value| roots.push(value));
    let count = roots.count;
    roots.values[..count].sort_by(f64::total_cmp);
    roots
}

/// Real root of a polynomial of degree up to four, highest power first, by the closed formula of its
/// degree; `None` for more than five coefficients.
#[must_use]
pub fn roots_closed_form(coefficients: &[f64]) -> Option<Roots> {
    Some(match *coefficients {
        [] | [_] => Roots::default(),
        [a, b] => linear_roots(a, b),
        [a, b, c] => quadratic_roots(a, b, c),
        [a, b, c, d] => cubic_roots_closed_form(a, b, c, d),
        [a, b, c, d, e] => quartic_roots_closed_form(a, b, c, d, e),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{cubic_roots, quartic_roots};
    use super::*;

    fn close(found: &[f64], expected: &[f64], tolerance: f64) -> bool {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance * (1.0 + b.abs()))
    }

    #[test]
    fn cardano_with_three_real_roots() {
        assert!(close(&cubic_roots_closed_form(1.0, -6.0, 11.0, -6.0), &[1.0, 2.0, 3.0], 1e-13));
        // The classical case whose one root 4 Cardano reached through the root of -121 (Bombelli 1572).
        let third = 3f64.sqrt();
        let bombelli = cubic_roots_closed_form(1.0, 0.0, -15.0, -4.0);
        assert!(close(&bombelli, &[-2.0 - third, -2.0 + third, 4.0], 1e-14));
    }

    #[test]
    fn cardano_with_one_and_with_double_roots() {
        assert!(close(&cubic_roots_closed_form(1.0, 0.0, 6.0, -20.0), &[2.0], 1e-15));
        assert!(close(&cubic_roots_closed_form(2.0, 0.0, 0.0, -16.0), &[2.0], 1e-15));
        assert!(close(&cubic_roots_closed_form(1.0, 0.0, -3.0, 2.0), &[-2.0, 1.0], 1e-15));
        assert_eq!(cubic_roots_closed_form(1.0, 0.0, 0.0, 0.0).as_slice(), [0.0]);
        assert!(close(&cubic_roots_closed_form(0.0, 1.0, -3.0, 2.0), &[1.0, 2.0], 1e-15));
        assert!(cubic_roots_closed_form(f64::NAN, 1.0, -3.0, 2.0).is_empty());
    }

    #[test]
    fn ferrari_of_known_roots() {
        let four = quartic_roots_closed_form(1.0, -10.0, 35.0, -50.0, 24.0);
        assert!(close(&four, &[1.0, 2.0, 3.0, 4.0], 1e-12));
        // Ferrari's own: x^4 + 6 x^2 - 60 x + 36, whose real roots lie near 0.6444 and 3.0999.
        let ferrari = quartic_roots_closed_form(1.0, 0.0, 6.0, -60.0, 36.0);
        assert!(close(&ferrari, &quartic_roots(1.0, 0.0, 6.0, -60.0, 36.0), 1e-12));
        assert!((ferrari[1] - 3.0999).abs() < 1e-4 && ferrari.len() == 2);
        assert!(quartic_roots_closed_form(1.0, 0.0, 0.0, 0.0, 1.0).is_empty());
        let even = quartic_roots_closed_form(1.0, 0.0, -5.0, 0.0, 4.0);
        assert!(close(&even, &[-2.0, -1.0, 1.0, 2.0], 1e-15));
    }

    #[test]
    fn the_degree_follows_the_coefficients() {
        assert_eq!(roots_closed_form(&[2.0, -4.0]).as_deref(), Some(&[2.0][..]));
        assert_eq!(roots_closed_form(&[1.0, -3.0, 2.0]).as_deref(), Some(&[1.0, 2.0][..]));
        assert_eq!(roots_closed_form(&[7.0]).as_deref(), Some(&[][..]));
        assert!(roots_closed_form(&[1.0; 6]).is_none());
    }

    proptest! {
        #[test]
        fn the_same_as_by_turning_points(
            gaps in prop::collection::vec(0.2..3.0f64, 3),
            first in -6.0..3.0f64,
            pair in (-3.0..3.0f64, 0.3..3.0f64),
        ) {
            let roots: Vec<f64> =
                gaps.iter().scan(first, |at, gap| { *at += gap; Some(*at) }).chain([first]).collect();
            // (x - r0)(x - r1)(x - r2), then times (x - r3) or times a factor without real roots.
            let times = |p: &[f64], q: &[f64]| {
                let mut product = vec![0.0; p.len() + q.len() - 1];
                p.iter().enumerate().for_each(|(i, a)| q.iter().enumerate().for_each(|(k, b)| product[i + k] += a * b));
                product
            };
            let factor = |r: f64| [1.0, -r];
            let cubic = times(&times(&factor(roots[0]), &factor(roots[1])), &factor(roots[2]));
            let c = &cubic;
            prop_assert!(close(&cubic_roots_closed_form(c[0], c[1], c[2], c[3]), &cubic_roots(c[0], c[1], c[2], c[3]), 1e-8));
            let q = times(&cubic, &factor(roots[3]));
            prop_assert!(close(&quartic_roots_closed_form(q[0], q[1], q[2], q[3], q[4]), &quartic_roots(q[0], q[1], q[2], q[3], q[4]), 1e-6));
            let complex = [1.0, -2.0 * pair.0, pair.0 * pair.0 + pair.1 * pair.1];
            let q = times(&times(&factor(roots[0]), &factor(roots[2])), &complex);
            prop_assert!(close(&quartic_roots_closed_form(q[0], q[1], q[2], q[3], q[4]), &quartic_roots(q[0], q[1], q[2], q[3], q[4]), 1e-6));
        }

        #[test]
        fn wild_coefficients_end(c in prop::array::uniform5(any::<f64>())) {
            let roots = quartic_roots_closed_form(c[0], c[1], c[2], c[3], c[4]);
            prop_assert!(roots.iter().all(|r| r.is_finite()));
            prop_assert!(roots.windows(2).all(|pair| pair[0] <= pair[1]));
        }
    }
}
