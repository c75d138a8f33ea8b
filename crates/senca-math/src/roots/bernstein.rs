//! Real roots of polynomials of any degree in Bernstein form, by Descartes' rule of signs.
//!
//! 1. A polynomial on [0, 1] has at most as many roots as its Bernstein coefficients have changes of
//!    sign, and as many but for an even number.
//! 2. No change: no root. One change: one root, which a bracketed Newton iteration finds. More: the
//!    interval is halved, by de Casteljau's averages, which lose no digits.
//! 3. A zero counts as positive everywhere. So a root at a place where two pieces meet is found in
//!    exactly one of them, and the number of roots found is even exactly when both ends have the same
//!    sign: what a ray needs to know whether it is inside.
//! 4. Two roots nearer than 2^-52 of the interval are passed over. Where the polynomial touches zero
//!    without a change of sign, rounding decides between no root and two that nearly coincide: in any
//!    case an even number.
//!
//! Source: Lane and Riesenfeld 1981; Collins and Akritas 1976.

/// Halvings after which an interval is not looked into any further.
const MAX_DEPTH: u32 = 52;

/// Calls `found` with the roots in [0, 1] of the polynomial with the given Bernstein coefficients,
/// ascending.
pub fn bernstein_roots<const N: usize>(coefficients: &[f64; N], found: &mut impl FnMut(f64)) {
    descend(coefficients, 0.0, 0, found);
}

/// Bernstein coefficients on [0, 1] of the polynomial with the given power coefficients, lowest
/// power first. Zeros at the end raise the degree of the form without harm.
#[must_use]
pub fn bernstein_from_power<const N: usize>(mut power: [f64; N]) -> [f64; N] {
    let mut binomial = 1.0;
    for (i, a) in power.iter_mut().enumerate() {
        *a /= binomial;
        binomial *= (N - 1 - i) as f64 / (i + 1) as f64;
    }
    for level in 1..N {
        for i in (level..N).rev() {
            power[i] += power[i - 1];
        }
    }
    power
}

/// Power coefficients, lowest first, of `p(low + (high - low) s)` as a polynomial in s.
#[must_use]
pub fn restricted_to<const N: usize>(mut power: [f64; N], low: f64, high: f64) -> [f64; N] {
    for level in 0..N {
        for i in (level..N - 1).rev() {
            power[i] += low * power[i + 1];
        }
    }
    let mut scale = 1.0;
    for a in &mut power {
        *a *= scale;
        scale *= high - low;
    }
    power
}

/// Roots between `low` and `high`, both finite, of a polynomial of any degree; coefficients lowest
/// power first. Ascending. Where the polynomial only touches zero there are none, or two nearly the same.
#[must_use]
pub fn polynomial_roots_between(power: &[f64], low: f64, high: f64) -> Vec<f64> {
    match power.len() {
        0..=5 => roots_of_size::<5>(power, low, high),
        6..=9 => roots_of_size::<9>(power, low, high),
        10..=17 => roots_of_size::<17>(power, low, high),
        18..=33 => roots_of_size::<33>(power, low, high),
        _ => super::sturm::sturm_roots(power, low, high),
    }
}

fn roots_of_size<const N: usize>(power: &[f64], low: f64, high: f64) -> Vec<f64> {
    let mut padded = [0.0; N];
    padded[..power.len()].copy_from_slice(power);
    let mut roots = Vec::new();
    let form = bernstein_from_power(restricted_to(padded, low, high));
    bernstein_roots(&form, &mut |s| roots.push(low + s * (high - low)));
    roots
}

fn negative(x: f64) -> bool {
    x < 0.0
}

fn sign_changes<const N: usize>(b: &[f64; N]) -> usize {
    b.windows(2).filter(|pair| negative(pair[0]) != negative(pair[1])).count()
}

/// Roots of a piece that begins at `low` and is `2^-depth` long.
fn descend<const N: usize>(b: &[f64; N], low: f64, depth: u32, found: &mut impl FnMut(f64)) {
    let changes = sign_changes(b);
    if changes == 0 {
        return;
    }
    let length = f64::from_bits((1023 - u64::from(depth)) << 52);
    if changes == 1 {
        return found(low + length * single_root(b));
    }
    if depth == MAX_DEPTH {
        if negative(b[0]) != negative(b[N - 1]) {
            found(low);
        }
        return;
    }
    let (left, right) = halves(b);
    descend(&left, low, depth + 1, found);
    descend(&right, low + 0.5 * length, depth + 1, found);
}

/// Bernstein coefficients over the two halves.
fn halves<const N: usize>(b: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut left, mut right) = (*b, *b);
    for (level, first) in left.iter_mut().enumerate().skip(1) {
        for i in 0..N - level {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        *first = right[0];
    }
    (left, right)
}

/// Value and derivative at s.
fn value_and_slope<const N: usize>(b: &[f64; N], s: f64) -> (f64, f64) {
    let mut row = *b;
    for level in 1..N - 1 {
        for i in 0..N - level {
            row[i] += s * (row[i + 1] - row[i]);
        }
    }
    let step = row[1] - row[0];
    (row[0] + s * step, (N - 1) as f64 * step)
}

/// The root of a polynomial with one change of sign.
fn single_root<const N: usize>(b: &[f64; N]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let starts_negative = negative(b[0]);
    let mut s = b[0] / (b[0] - b[N - 1]);
    if !(s > 0.0 && s < 1.0) {
        s = 0.5;
    }
    // Bisection alone would end within 60 steps; with Newton's steps a handful do.
    for _ in 0..64 {
        let (value, slope) = value_and_slope(b, s);
        if negative(value) == starts_negative {
            low = s;
        } else {
            high = s;
        }
        let newton = s - value / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        if (next - s).abs() <= f64::EPSILON * s.abs() {
            return next;
        }
        s = next;
    }
    s
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{quartic_roots, sturm_roots};
    use super::*;

    /// Power coefficients, lowest first, of the product of `x - root`.
    fn expanded(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |p, root| {
            let mut next = vec![0.0; p.len() + 1];
            p.iter().enumerate().for_each(|(i, a)| {
                next[i] -= root * a;
                next[i + 1] += a;
            });
            next
        })
    }

    #[test]
    fn forms_agree() {
        // s^2: coefficients 0, 0, 1 of degree two, 0, 0, 1/3, 1 of degree three.
        assert_eq!(bernstein_from_power([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        assert_eq!(bernstein_from_power([0.0, 0.0, 1.0, 0.0]), [0.0, 0.0, 1.0 / 3.0, 1.0]);
        // x^2 on [1, 3]: (1 + 2 s)^2.
        assert_eq!(restricted_to([0.0, 0.0, 1.0], 1.0, 3.0), [1.0, 4.0, 4.0]);
    }

    #[test]
    fn roots_at_both_ends_and_in_the_middle() {
        // The sign after a root at the lower end decides whether the zero there, which counts as
        // positive, was left.
        assert_eq!(polynomial_roots_between(&[-1.0, 1.0], 0.0, 2.0), [1.0]);
        assert_eq!(polynomial_roots_between(&[0.0, -1.0], 0.0, 2.0), [0.0]);
        assert!(polynomial_roots_between(&[0.0, 1.0], 0.0, 2.0).is_empty());
        assert_eq!(polynomial_roots_between(&[0.0, 1.0], -2.0, 0.0), [0.0]);
        let touch = polynomial_roots_between(&[1.0, -2.0, 1.0], 0.0, 2.0);
        assert!(touch.len().is_multiple_of(2) && touch.iter().all(|r| (r - 1.0).abs() < 1e-7));
        assert!(polynomial_roots_between(&[0.0; 9], -1.0, 1.0).is_empty());
        assert!(polynomial_roots_between(&[f64::NAN; 4], -1.0, 1.0).is_empty());
    }

    #[test]
    fn twelve_roots_are_told_apart() {
        let roots: Vec<f64> = (1..=12).map(|k| f64::from(k) / 12.0 - 0.52).collect();
        let found = polynomial_roots_between(&expanded(&roots), -0.6, 0.6);
        assert_eq!(found.len(), 12);
        assert!(found.iter().zip(&roots).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    proptest! {
        #[test]
        fn well_separated_roots_come_back(gaps in prop::collection::vec(0.1..0.5f64, 1..9), scale in -5.0..5.0f64) {
            prop_assume!(scale.abs() > 0.01);
            let roots: Vec<f64> = gaps.iter().scan(-2.0, |at, gap| { *at += gap; Some(*at) }).collect();
            let power: Vec<f64> = expanded(&roots).iter().map(|a| a * scale).collect();
            let found = polynomial_roots_between(&power, -3.0, 3.0);
            prop_assert_eq!(found.len(), roots.len());
            prop_assert!(found.iter().zip(&roots).all(|(a, b)| (a - b).abs() < 1e-6), "{:?} {:?}", found, roots);
            let sturm = sturm_roots(&power, -3.0, 3.0);
            prop_assert_eq!(sturm.len(), roots.len());
            prop_assert!(sturm.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-6));
        }

        #[test]
        fn the_same_as_by_turning_points(c in prop::array::uniform5(-5.0..5.0f64)) {
            let ascending = [c[4], c[3], c[2], c[1], c[0]];
            let all = quartic_roots(c[0], c[1], c[2], c[3], c[4]);
            let inside: Vec<f64> = all.iter().copied().filter(|r| r.abs() < 2.0).collect();
            prop_assume!(all.windows(2).all(|pair| pair[1] - pair[0] > 1e-5));
            prop_assume!(all.iter().all(|r| (r.abs() - 2.0).abs() > 1e-5));
            let found = polynomial_roots_between(&ascending, -2.0, 2.0);
            prop_assert!(found.len() == inside.len() && found.iter().zip(&inside).all(|(a, b)| (a - b).abs() < 1e-9), "{:?} {:?}", found, inside);
        }

        #[test]
        fn the_count_is_even_exactly_between_equal_signs(power in prop::collection::vec(-3.0..3.0f64, 1..10), cut in -1.0..1.0f64) {
            let value = |x: f64| power.iter().rev().fold(0.0, |sum, a| sum * x + a);
            let found = polynomial_roots_between(&power, -1.0, cut);
            prop_assume!(value(-1.0).abs() > 1e-9 && value(cut).abs() > 1e-9);
            prop_assert_eq!(found.len() % 2 == 1, value(-1.0) * value(cut) < 0.0);
            prop_assert!(found.windows(2).all(|pair| pair[0] <= pair[1]));
        }
    }
}
