//! Lines of pixels: three ways to step along them.
//!
//! Source: Savchenko 1995, "A line"; Bresenham 1965.

use super::clip::{Search, clip_line_to_screen};
use super::color_map::ColorMap;

/// The pixels of a line, both ends included, by integer additions alone.
///
/// Along the longer range each step is one pixel. Where the decision `d` is negative the step is along that range only,
/// otherwise along both; so the halfway case goes along both. Where both ranges are equal, y counts as the longer one.
/// The same line from its other end may take other pixels.
#[derive(Clone, Debug)]
pub struct Bresenham {
    at: [i32; 2],
    left: u64,
    decision: i64,
    low: Step,
    high: Step,
}

/// What one step changes.
#[derive(Clone, Copy, Debug)]
struct Step {
    by: [i32; 2],
    decision: i64,
}

impl Bresenham {
    /// From `a` to `b`.
    #[must_use]
    pub fn new(a: [i32; 2], b: [i32; 2]) -> Self {
        let delta = [0, 1].map(|k| i64::from(b[k]) - i64::from(a[k]));
        let range = delta.map(i64::abs);
        let sign = delta.map(|d| d.signum() as i32);
        let (long, short) = if range[0] > range[1] { (0, 1) } else { (1, 0) };
        let mut along = [0; 2];
        along[long] = sign[long];
        Self {
            at: a,
            left: range[long].unsigned_abs() + 1,
            decision: 2 * range[short] - range[long],
            low: Step { by: along, decision: 2 * range[short] },
            high: Step { by: sign, decision: 2 * range[short] - 2 * range[long] },
        }
    }

    fn next_step(&mut self) -> Step {
        let step = if self.decision >= 0 { self.high } else { self.low };
        self.decision += step.decision;
        step
    }
}

impl Iterator for Bresenham {
    type Item = [i32; 2];

    fn next(&mut self) -> Option<[i32; 2]> {
        self.left = self.left.checked_sub(1)?;
        let pixel = self.at;
        if self.left > 0 {
            let step = self.next_step();
            self.at = [self.at[0] + step.by[0], self.at[1] + step.by[1]];
        }
        Some(pixel)
    }
}

/// A pixel for each column by `y = x * dy / dx`: has gaps where the range of y is larger.
pub fn pixels_by_columns(a: [i32; 2], b: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    proportional(a, b, 0)
}

/// A pixel for each step of the longer range by proportion: no gaps, and a division a pixel.
pub fn pixels_by_longer_range(a: [i32; 2], b: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    let range = [0, 1].map(|k| a[k].abs_diff(b[k]));
    proportional(a, b, usize::from(range[1] > range[0]))
}

fn proportional(a: [i32; 2], b: [i32; 2], along: usize) -> impl Iterator<Item = [i32; 2]> {
    let delta = [0, 1].map(|k| i64::from(b[k]) - i64::from(a[k]));
    let sign = delta[along].signum();
    (0..=delta[along].abs()).map(move |i| {
        let at = |k: usize| i64::from(a[k]) + delta[k] * i * sign / delta[along].abs().max(1) * sign;
        [0, 1].map(|k| if k == along { i64::from(a[k]) + sign * i } else { at(k) } as i32)
    })
}

/// Draws a line dot by dot (`G_line`), clipped on the screen.
pub fn draw_line(map: &mut ColorMap, line: [[i32; 2]; 2], color: u8, search: Search) {
    if let Some([a, b]) = clip_line_to_screen(line, map.size(), search) {
        Bresenham::new(a, b).for_each(|[x, y]| map.dot(x, y, color));
    }
}

/// Draws a line by the address of its pixels (the faster `G_line`): one multiplication, for the first pixel.
///
/// The same pixels as [`draw_line`].
pub fn draw_line_by_address(map: &mut ColorMap, line: [[i32; 2]; 2], color: u8, search: Search) {
    let Some([a, b]) = clip_line_to_screen(line, map.size(), search) else { return };
    let Some(mut address) = map.address(a[0], a[1]) else { return };
    let row = map.width() as isize;
    let mut steps = Bresenham::new(a, b);
    let bytes = |step: Step| step.by[0] as isize + step.by[1] as isize * row;
    let pixels = map.pixels_mut();
    pixels[address] = color;
    for _ in 1..steps.left {
        address = address.wrapping_add_signed(bytes(steps.next_step()));
        pixels[address] = color;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pixels(a: [i32; 2], b: [i32; 2]) -> Vec<[i32; 2]> {
        Bresenham::new(a, b).collect()
    }

    fn columns(mut pixels: Vec<[i32; 2]>) -> Vec<i32> {
        pixels.sort_by_key(|p| p[1]);
        pixels.iter().map(|p| p[0]).collect()
    }

    #[test]
    fn the_line_of_the_figures() {
        // Ranges 4 and 8, from the bottom left to the top right.
        assert_eq!(columns(pixels([0, 8], [4, 0])), [4, 4, 3, 3, 2, 2, 1, 1, 0]);
        assert_eq!(columns(pixels([4, 0], [0, 8])), [4, 3, 3, 2, 2, 1, 1, 0, 0]);
        let gaps: Vec<_> = pixels_by_columns([0, 8], [4, 0]).collect();
        assert_eq!(gaps, [[0, 8], [1, 6], [2, 4], [3, 2], [4, 0]]);
        assert_eq!(pixels_by_longer_range([0, 8], [4, 0]).count(), 9);
    }

    #[test]
    fn direction_matters() {
        let rows = |mut pixels: Vec<[i32; 2]>| {
            pixels.sort();
            pixels.iter().map(|p| p[1]).collect::<Vec<_>>()
        };
        assert_eq!(rows(pixels([0, 0], [10, 5])), [0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
        assert_eq!(rows(pixels([10, 5], [0, 0])), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5]);
        assert_eq!(rows(pixels([0, 0], [7, 1])), [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(rows(pixels([7, 1], [0, 0])), [0, 0, 0, 0, 1, 1, 1, 1]);
    }

    #[test]
    fn ends_are_drawn() {
        assert_eq!(pixels([3, 3], [3, 3]), [[3, 3]]);
        assert_eq!(pixels([0, 0], [2, 2]), [[0, 0], [1, 1], [2, 2]]);
        assert_eq!(Bresenham::new([i32::MIN; 2], [i32::MAX, 0]).take(3).count(), 3);
        assert_eq!(pixels_by_columns([i32::MAX, 0], [i32::MIN, i32::MIN]).take(2).count(), 2);
    }

    proptest! {
        #[test]
        fn a_line_has_no_gaps(a in prop::array::uniform2(-50i32..50), b in prop::array::uniform2(-50i32..50)) {
            let line = pixels(a, b);
            let longer = a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1])) as usize;
            prop_assert_eq!((line.len(), line[0], line[longer]), (longer + 1, a, b));
            prop_assert!(line.windows(2).all(|w| w[0][0].abs_diff(w[1][0]).max(w[0][1].abs_diff(w[1][1])) == 1));
            // No pixel is farther than half of one from the line, along the shorter range.
            let exact: Vec<_> = pixels_by_longer_range(a, b).collect();
            prop_assert!(line.iter().zip(exact).all(|(p, q)| p[0].abs_diff(q[0]).max(p[1].abs_diff(q[1])) <= 1));
        }

        #[test]
        fn addresses_and_dots_draw_the_same(a: [i32; 2], b: [i32; 2], near: bool) {
            let place = |p: [i32; 2]| if near { p.map(|v| v % 70) } else { p };
            let line = [place(a), place(b)];
            for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
                let (mut dots, mut addresses) = (ColorMap::new(40, 30), ColorMap::new(40, 30));
                draw_line(&mut dots, line, 5, search);
                draw_line_by_address(&mut addresses, line, 5, search);
                prop_assert_eq!(&dots, &addresses);
            }
        }
    }
}
