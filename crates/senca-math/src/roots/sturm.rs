//! Real roots of polynomials of any degree by Sturm's sequence.
//!
//! The sequence is p, p', and then each the negative remainder of the two before. The number of
//! changes of sign along the sequence at a, less the number at b, is the number of different roots
//! between a and b. Halving intervals until each holds one root, and then bisecting by sign, finds
//! them all. Source: Sturm 1829; van Wijk 1984 for rays.
//!
//! Remainders lose digits with every step, so from about degree ten on, and for clustered roots,
//! [`bernstein`](super::bernstein) is the better choice; this is its plain twin.

/// Share of the largest coefficient below which a remainder counts as zero.
const NEGLIGIBLE: f64 = 1e-13;

/// Intervals are halved at most this often.
const MAX_DEPTH: u32 = 64;

/// Different roots between `low` and `high`, ascending, of the polynomial with the given coefficients,
/// lowest power first. A root at which the sign does not change is passed over.
#[must_use]
pub fn sturm_roots(power: &[f64], low: f64, high: f64) -> Vec<f64> {
    let mut roots = Vec::new();
    let sequence = sturm_sequence(power);
    if sequence.first().is_some_and(|p| p.len() > 1) && low < high {
        let counts = [sign_changes(&sequence, low), sign_changes(&sequence, high)];
        isolate(&sequence, [low, high], counts, 0, &mut roots);
    }
    roots
}

/// Sturm's sequence; each polynomial lowest power first, scaled by positive numbers. Empty for the zero
/// polynomial and for coefficients that are not finite.
#[must_use]
pub fn sturm_sequence(power: &[f64]) -> Vec<Vec<f64>> {
    let Some(p) = trimmed(power.to_vec(), 0.0) else { return Vec::new() };
    let derivative: Vec<f64> = p.iter().enumerate().skip(1).map(|(i, a)| i as f64 * a).collect();
    let mut sequence = vec![p];
    let mut next = trimmed(derivative, 0.0);
    while let Some(polynomial) = next {
        let last = sequence.len() - 1;
        next = trimmed(negative_remainder(&sequence[last], &polynomial), NEGLIGIBLE);
        sequence.push(polynomial);
    }
    sequence
}

/// Scaled so that the largest coefficient is 1, without leading coefficients up to `negligible`;
/// `None` when nothing is left.
fn trimmed(mut p: Vec<f64>, negligible: f64) -> Option<Vec<f64>> {
    let largest = p.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    if !(largest > negligible && p.iter().all(|a| a.is_finite())) {
        return None;
    }
    p.iter_mut().for_each(|a| *a /= largest);
    while p.last().is_some_and(|a| a.abs() <= negligible) {
        p.pop();
    }
    Some(p)
}

fn negative_remainder(dividend: &[f64], divisor: &[f64]) -> Vec<f64> {
    let mut rest = dividend.to_vec();
    let Some(leading) = divisor.last() else { return Vec::new() };
    while rest.len() >= divisor.len() {
        let factor = rest[rest.len() - 1] / leading;
        let offset = rest.len() - divisor.len();
        for (a, d) in rest[offset..].iter_mut().zip(divisor) {
            *a -= factor * d;
        }
        rest.pop();
    }
    rest.iter().map(|a| -a).collect()
}

fn value(p: &[f64], x: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, a| sum * x + a)
}

/// Changes of sign along the sequence at `x`; zeros are passed over.
fn sign_changes(sequence: &[Vec<f64>], x: f64) -> usize {
    let mut before = 0.0f64;
    let mut changes = 0;
    for p in sequence {
        let v = value(p, x);
        if v == 0.0 {
            continue;
        }
        changes += usize::from(before * v.signum() < 0.0);
        before = v.signum();
    }
    changes
}

fn isolate(
    sequence: &[Vec<f64>],
    [low, high]: [f64; 2],
    counts: [usize; 2],
    depth: u32,
    roots: &mut Vec<f64>,
) {
    let inside = counts[0].saturating_sub(counts[1]);
    let middle = 0.5 * (low + high);
    if inside == 0 {
        return;
    }
    if inside == 1 || depth == MAX_DEPTH || middle <= low || middle >= high {
        return roots.extend(bisect(&sequence[0], low, high));
    }
    let at_middle = sign_changes(sequence, middle);
    isolate(sequence, [low, middle], [counts[0], at_middle], depth + 1, roots);
    isolate(sequence, [middle, high], [at_middle, counts[1]], depth + 1, roots);
}

/// The place where the sign changes, by bisection; `None` where it does not.
fn bisect(p: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let negative_low = value(p, low) < 0.0;
    if negative_low == (value(p, high) < 0.0) {
        return None;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(high);
        }
        if (value(p, middle) < 0.0) == negative_low {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_counts_the_roots() {
        // x^3 - 6 x^2 + 11 x - 6 = (x - 1)(x - 2)(x - 3)
        let sequence = sturm_sequence(&[-6.0, 11.0, -6.0, 1.0]);
        assert_eq!(sequence.len(), 4);
        let between = |a: f64, b: f64| sign_changes(&sequence, a) - sign_changes(&sequence, b);
        assert_eq!((between(0.0, 4.0), between(1.5, 4.0), between(2.5, 2.9)), (3, 2, 0));
    }

    #[test]
    fn roots_are_found_once_each() {
        let roots = sturm_roots(&[-6.0, 11.0, -6.0, 1.0], 0.0, 10.0);
        assert_eq!(roots.len(), 3);
        assert!(roots.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-14));
        assert!(sturm_roots(&[1.0, 0.0, 1.0], -5.0, 5.0).is_empty());
        assert!(sturm_roots(&[1.0, -2.0, 1.0], -5.0, 5.0).is_empty(), "a touch");
        // A triple root changes the sign once.
        let triple = sturm_roots(&[-1.0, 3.0, -3.0, 1.0], -5.0, 5.0);
        assert!(triple.len() == 1 && (triple[0] - 1.0).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_polynomial_has_no_roots() {
        assert!(sturm_roots(&[], 0.0, 1.0).is_empty());
        assert!(sturm_roots(&[0.0, 0.0], 0.0, 1.0).is_empty());
        assert!(sturm_roots(&[3.0], 0.0, 1.0).is_empty());
        assert!(sturm_roots(&[1.0, f64::NAN], 0.0, 1.0).is_empty());
        assert!(sturm_roots(&[0.0, 1.0], 1.0, -1.0).is_empty());
    }
}
