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

/// Most coefficients of [`bernstein_roots_of_any`]: degree 32.
pub const MAX_COEFFICIENTS: usize = 33;

/// Calls `found` with the roots in [0, 1] of the polynomial with the given Bernstein coefficients,
/// ascending. For low degrees known in advance; see [`bernstein_roots_of_any`].
pub fn bernstein_roots<const N: usize>(coefficients: &[f64; N], found: &mut impl FnMut(f64)) {
    descend(coefficients, 0.0, 0, found);
}

/// The same for any degree up to 32. Of more coefficients than [`MAX_COEFFICIENTS`] none are found.
pub fn bernstein_roots_of_any(coefficients: &[f64], found: &mut impl FnMut(f64)) {
    if coefficients.len() <= MAX_COEFFICIENTS {
        descend_any(coefficients, 0.0, 0, found);
    }
}

/// Turns power coefficients, lowest power first, into Bernstein coefficients on [0, 1]. Zeros at the
/// end raise the degree of the form without harm.
#[inline]
pub fn bernstein_from_power(power: &mut [f64]) {
    let mut binomial = 1.0;
    for i in 0..power.len() {
        power[i] /= binomial;
        binomial *= (power.len() - 1 - i) as f64 / (i + 1) as f64;
    }
    for level in 1..power.len() {
        for i in (level..power.len()).rev() {
            power[i] += power[i - 1];
        }
    }
}

/// Turns the coefficients of p, lowest power first, into those of `p(low + (high - low) s)` in s.
#[inline]
pub fn restrict_to(power: &mut [f64], low: f64, high: f64) {
    for level in 0..power.len() {
        for i in (level..power.len() - 1).rev() {
            power[i] += low * power[i + 1];
        }
    }
    let mut scale = 1.0;
    for a in power {
        *a *= scale;
        scale *= high - low;
    }
}

/// Roots between `low` and `high`, both finite, of a polynomial of any degree; coefficients lowest
/// power first. Ascending. Where the polynomial only touches zero there are none, or two nearly the same.
#[must_use]
pub fn polynomial_roots_between(power: &[f64], low: f64, high: f64) -> Vec<f64> {
    if power.len() > MAX_COEFFICIENTS {
        return super::sturm::sturm_roots(power, low, high);
    }
    let mut form = power.to_vec();
    restrict_to(&mut form, low, high);
    bernstein_from_power(&mut form);
    let mut roots = Vec::new();
    bernstein_roots_of_any(&form, &mut |s| roots.push(low + s * (high - low)));
    roots
}

fn negative(x: f64) -> bool {
    x < 0.0
}

/// What the signs of the coefficients say of a piece.
enum Signs {
    NoRoot,
    OneRoot,
    /// Too short to be looked into; whether the sign changes.
    Short(bool),
    Unknown,
}

#[inline]
fn signs(b: &[f64], depth: u32) -> Signs {
    match b.windows(2).filter(|pair| negative(pair[0]) != negative(pair[1])).count() {
        0 => Signs::NoRoot,
        1 => Signs::OneRoot,
        _ if depth == MAX_DEPTH => Signs::Short(negative(b[0]) != negative(b[b.len() - 1])),
        _ => Signs::Unknown,
    }
}

/// 2^-depth.
fn length_at(depth: u32) -> f64 {
    f64::from_bits((1023 - u64::from(depth)) << 52)
}

/// Roots of a piece that begins at `low` and is `2^-depth` long.
fn descend<const N: usize>(b: &[f64; N], low: f64, depth: u32, found: &mut impl FnMut(f64)) {
    match signs(b, depth) {
        Signs::NoRoot | Signs::Short(false) => {}
        Signs::Short(true) => found(low),
        Signs::OneRoot => found(low + length_at(depth) * single_root(b, &mut [0.0; N])),
        Signs::Unknown => {
            let (mut left, mut right) = ([0.0; N], *b);
            halve(&mut left, &mut right);
            descend(&left, low, depth + 1, found);
            descend(&right, low + length_at(depth + 1), depth + 1, found);
        }
    }
}

/// The same for a degree that is not known in advance.
fn descend_any(b: &[f64], low: f64, depth: u32, found: &mut impl FnMut(f64)) {
    match signs(b, depth) {
        Signs::NoRoot | Signs::Short(false) => {}
        Signs::Short(true) => found(low),
        Signs::OneRoot => {
            found(low + length_at(depth) * single_root(b, &mut [0.0; MAX_COEFFICIENTS][..b.len()]));
        }
        Signs::Unknown => {
            let (mut left, mut right) = ([0.0; MAX_COEFFICIENTS], [0.0; MAX_COEFFICIENTS]);
            let (left, right) = (&mut left[..b.len()], &mut right[..b.len()]);
            right.copy_from_slice(b);
            halve(left, right);
            descend_any(left, low, depth + 1, found);
            descend_any(right, low + length_at(depth + 1), depth + 1, found);
        }
    }
}

/// Takes the coefficients of a piece in `right` apart into those over its two halves.
#[inline]
fn halve(left: &mut [f64], right: &mut [f64]) {
    let count = right.len();
    for (level, first) in left.iter_mut().enumerate() {
        if level > 0 {
            for i in 0..count - level {
                right[i] = 0.5 * (right[i] + right[i + 1]);
            }
        }
        *first = right[0];
    }
}

/// Value and derivative at s; `row` is room for as many numbers.
#[inline]
fn value_and_slope(b: &[f64], row: &mut [f64], s: f64) -> (f64, f64) {
    row.copy_from_slice(b);
    let count = row.len();
    for level in 1..count - 1 {
        for i in 0..count - level {
            row[i] += s * (row[i + 1] - row[i]);
        }
    }
    let step = row[1] - row[0];
    (row[0] + s * step, (count - 1) as f64 * step)
}

/// The root of a polynomial with one change of sign.
#[inline]
fn single_root(b: &[f64], row: &mut [f64]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let starts_negative = negative(b[0]);
    let mut s = b[0] / (b[0] - b[b.len() - 1]);
    if !(s > 0.0 && s < 1.0) {
        s = 0.5;
    }
    // Bisection alone would end within 60 steps; with Newton's steps a handful do.
    for _ in 0..64 {
        let (value, slope) = value_and_slope(b, row, s);
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
        let (mut three, mut four) = ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]);
        bernstein_from_power(&mut three);
        bernstein_from_power(&mut four);
        assert_eq!((three, four), ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0 / 3.0, 1.0]));
        // x^2 on [1, 3]: (1 + 2 s)^2.
        restrict_to(&mut three, 1.0, 3.0);
        assert_eq!(three, [1.0, 4.0, 4.0]);
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
        fn known_and_unknown_degrees_give_the_same(b in prop::array::uniform7(-1.0..1.0f64)) {
            let (mut known, mut any) = (Vec::new(), Vec::new());
            bernstein_roots(&b, &mut |s| known.push(s));
            bernstein_roots_of_any(&b, &mut |s| any.push(s));
            prop_assert_eq!(known, any);
        }

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
