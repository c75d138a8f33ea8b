//! Colours for counts. The manual says no more than "colour number k".

use std::f64::consts::PI;

use super::Counts;

/// How counts become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coloring {
    /// Whether colours go smoothly from one k to the next, by how far z was when it left.
    pub smooth: bool,
    /// Counts from a colour to its return.
    pub period: f64,
}

impl Default for Coloring {
    /// One colour for each k; the same again after 24.
    fn default() -> Self {
        Self { smooth: false, period: 24.0 }
    }
}

/// Colours that follow each other in a circle: red, green and blue from 0 to 255.
const CIRCLE: [[f64; 3]; 6] = [
    [12.0, 20.0, 90.0],
    [32.0, 107.0, 203.0],
    [237.0, 248.0, 245.0],
    [255.0, 180.0, 20.0],
    [150.0, 40.0, 20.0],
    [40.0, 6.0, 50.0],
];

/// A picture of counts, each pixel `0x00RRGGBB`; black for those with k = m.
///
/// Smooth colours need the moduli; without them there is one colour for each k.
#[must_use]
pub fn colored(counts: &Counts, coloring: &Coloring) -> Vec<u32> {
    let color = |(i, &k): (usize, &u32)| {
        if k == counts.iterations {
            return 0;
        }
        let modulus = if coloring.smooth { counts.moduli.get(i) } else { None };
        let position = modulus.map_or_else(|| f64::from(k), |&r| smooth_count(k, r, counts.bound));
        on_circle(position / coloring.period)
    };
    counts.k.iter().enumerate().map(color).collect()
}

/// A count between whole ones: k where |z| has just reached the bound, and 1 less where it has just
/// reached its square, which is where the next k begins. For bounds above 2 it has no steps.
#[must_use]
pub(super) fn smooth_count(k: u32, modulus: f64, bound: f64) -> f64 {
    let share = if bound > 1.0 && modulus > bound { (modulus.ln() / bound.ln()).log2() } else { 0.0 };
    if share.is_finite() { f64::from(k) + 1.0 - share } else { f64::from(k) }
}

/// The colour at `turns` around the circle, from one to the next by half a cosine.
fn on_circle(turns: f64) -> u32 {
    let place = turns.rem_euclid(1.0) * CIRCLE.len() as f64;
    let (i, share) = (place as usize % CIRCLE.len(), place.fract());
    let weight = 0.5 - 0.5 * (PI * share).cos();
    let (a, b) = (CIRCLE[i], CIRCLE[(i + 1) % CIRCLE.len()]);
    crate::lab::draw::rgb(std::array::from_fn(|c| a[c] + (b[c] - a[c]) * weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_counts_have_no_steps() {
        assert_eq!(smooth_count(7, 100.0, 100.0), 8.0);
        assert!((smooth_count(7, 1e4, 100.0) - 7.0).abs() < 1e-12);
        assert!((smooth_count(7, 1e4 - 1e-6, 100.0) - smooth_count(6, 100.0, 100.0)).abs() < 1e-9);
        for (r, bound) in [(f64::NAN, 100.0), (f64::INFINITY, 100.0), (0.5, 0.1), (0.5, 1.0)] {
            assert!(smooth_count(7, r, bound).is_finite());
        }
    }

    #[test]
    fn colours_come_round() {
        assert_eq!(on_circle(0.0), 0x0c145a);
        assert_eq!(on_circle(-1.0), on_circle(3.0));
        let mut before = crate::lab::draw::channels(on_circle(0.0));
        for i in 1..=1000 {
            let now = crate::lab::draw::channels(on_circle(f64::from(i) / 1000.0));
            assert!((0..3).all(|c| (now[c] - before[c]).abs() < 4.0));
            before = now;
        }
    }

    #[test]
    fn inside_is_black() {
        let counts = Counts {
            size: [3, 1],
            iterations: 9,
            bound: 100.0,
            left_at_last: 0,
            k: vec![0, 9, 5],
            moduli: vec![100.0, 0.0, 2e3],
        };
        let plain = colored(&counts, &Coloring::default());
        assert_eq!((plain[0], plain[1]), (on_circle(0.0), 0));
        let smooth = colored(&counts, &Coloring { smooth: true, ..Coloring::default() });
        assert!(smooth[1] == 0 && smooth[2] != plain[2]);
    }
}
