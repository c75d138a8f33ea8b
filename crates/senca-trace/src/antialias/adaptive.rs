//! Adaptive supersampling (course text, section 3.4; Whitted 1980).
//!
//! A pixel is a square with four rays through its corners. Where their colours differ by less than a
//! threshold, the mean counts; else the square is divided into quarters, and each goes the same way,
//! down to a last level. The pixel is the mean of all parts, each weighted by its share of the area.
//! Corners are shared: by neighbouring squares within a pixel, and by neighbouring pixels, so that a
//! picture of w x h pixels starts from (w + 1)(h + 1) rays.
//!
//! The difference of four colours is the largest, over channels, of maximum less minimum, of the
//! brightness on a display, taken as the square root of light from 0 to 1. A difference equal to the
//! threshold divides.

use super::MAX_SAMPLES;
use crate::TraceError;

/// When squares are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveSettings {
    /// Difference of corners, in display brightness from 0 to 1, from which on a square is divided.
    /// Default 0.1.
    pub threshold: f32,
    /// How many times a pixel is halved at most, 0 to 8. Default 3: cells of an eighth of a pixel.
    pub max_level: u32,
    /// How many pictures, each sampled like this, the picture is the mean of, 1 to 2^20. All have their own
    /// moments, places on lenses and places on lamps; rays go through the same places of pixels. Default 1.
    pub passes: u32,
}

/// Deepest level.
const MAX_LEVEL: u32 = 8;

impl Default for AdaptiveSettings {
    fn default() -> Self {
        Self { threshold: 0.1, max_level: 3, passes: 1 }
    }
}

impl AdaptiveSettings {
    pub(super) fn check(&self) -> Result<(), TraceError> {
        if !(self.threshold >= 0.0 && self.threshold.is_finite()) {
            let value = self.threshold.into();
            return Err(TraceError::Setting { name: "threshold", value, expected: "at least 0" });
        }
        if self.max_level > MAX_LEVEL {
            let value = self.max_level.into();
            return Err(TraceError::Setting { name: "level", value, expected: "0 to 8" });
        }
        if !(1..=MAX_SAMPLES).contains(&self.passes) {
            let value = self.passes.into();
            return Err(TraceError::Setting { name: "passes", value, expected: "1 to 1048576" });
        }
        Ok(())
    }

    /// Cells along a pixel's side at the last level.
    pub(crate) fn cells(&self) -> u32 {
        1 << self.max_level
    }
}

type Rgba = [f32; 4];

/// Colours known within one pixel, by their place on the grid of the last level.
#[derive(Clone, Debug, Default)]
pub(crate) struct SquareCache {
    /// Pixel for which each entry holds, and the entry. Twice its number where the entry is known, one
    /// less where it has been asked for.
    entries: Vec<(u64, Rgba)>,
    pixel: u64,
    side: usize,
}

impl SquareCache {
    /// Forgets all and begins a pixel of `cells` cells a side.
    pub(crate) fn begin(&mut self, cells: u32) {
        self.side = cells as usize + 1;
        self.entries.resize(self.side * self.side, (0, [0.0; 4]));
        self.pixel += 1;
    }

    pub(crate) fn set(&mut self, x: u32, y: u32, color: Rgba) {
        self.entries[y as usize * self.side + x as usize] = (2 * self.pixel, color);
    }

    /// The colour at a place; where it is not known, the place is put into `wanted` the first time.
    fn known(&mut self, x: u32, y: u32, wanted: &mut Vec<[u32; 2]>) -> Option<Rgba> {
        let (known, asked) = (2 * self.pixel, 2 * self.pixel - 1);
        let entry = &mut self.entries[y as usize * self.side + x as usize];
        if entry.0 == known {
            return Some(entry.1);
        }
        if entry.0 != asked {
            entry.0 = asked;
            wanted.push([x, y]);
        }
        None
    }

    /// The colour at a place, asked from `sample` the first time.
    #[cfg(test)]
    fn get(&mut self, x: u32, y: u32, sample: &mut impl FnMut(u32, u32) -> Rgba) -> Rgba {
        let entry = &mut self.entries[y as usize * self.side + x as usize];
        if entry.0 != 2 * self.pixel {
            *entry = (2 * self.pixel, sample(x, y));
        }
        entry.1
    }
}

/// A square on the grid of the last level: its upper left corner and its side.
#[derive(Clone, Copy, Debug)]
struct Square {
    x: u32,
    y: u32,
    side: u32,
}

/// Colour of a pixel, as the text has it: the plain twin of [`pixel_so_far`]. `sample` gives the colour at a place on the grid of the last level, 0 to
/// [`AdaptiveSettings::cells`] both ways; it is not asked for places that `cache` knows.
#[cfg(test)]
fn pixel(
    settings: &AdaptiveSettings,
    cache: &mut SquareCache,
    sample: &mut impl FnMut(u32, u32) -> Rgba,
) -> Rgba {
    let whole = Square { x: 0, y: 0, side: settings.cells() };
    part(settings, whole, cache, sample)
}

/// Mean colour of a square.
#[cfg(test)]
fn part(
    settings: &AdaptiveSettings,
    square: Square,
    cache: &mut SquareCache,
    sample: &mut impl FnMut(u32, u32) -> Rgba,
) -> Rgba {
    let Square { x, y, side } = square;
    let corners =
        [(x, y), (x + side, y), (x, y + side), (x + side, y + side)].map(|(x, y)| cache.get(x, y, sample));
    if side == 1 || difference(&corners) < settings.threshold {
        return mean(&corners);
    }
    let half = side / 2;
    let quarters = [(x, y), (x + half, y), (x, y + half), (x + half, y + half)]
        .map(|(x, y)| part(settings, Square { x, y, side: half }, cache, sample));
    mean(&quarters)
}

/// Colour of a pixel for one who takes samples many at a time: `None` while places on the grid of the
/// last level, 0 to [`AdaptiveSettings::cells`] both ways, are missing from `cache`. These are put into
/// `wanted`, once each.
pub(crate) fn pixel_so_far(
    settings: &AdaptiveSettings,
    cache: &mut SquareCache,
    wanted: &mut Vec<[u32; 2]>,
) -> Option<Rgba> {
    part_so_far(settings, Square { x: 0, y: 0, side: settings.cells() }, cache, wanted)
}

fn part_so_far(
    settings: &AdaptiveSettings,
    square: Square,
    cache: &mut SquareCache,
    wanted: &mut Vec<[u32; 2]>,
) -> Option<Rgba> {
    let Square { x, y, side } = square;
    let places = [(x, y), (x + side, y), (x, y + side), (x + side, y + side)];
    let corners = all_known(places.map(|(x, y)| cache.known(x, y, wanted)))?;
    if side == 1 || difference(&corners) < settings.threshold {
        return Some(mean(&corners));
    }
    let half = side / 2;
    let quarters = [(x, y), (x + half, y), (x, y + half), (x + half, y + half)]
        .map(|(x, y)| part_so_far(settings, Square { x, y, side: half }, cache, wanted));
    Some(mean(&all_known(quarters)?))
}

fn all_known([a, b, c, d]: [Option<Rgba>; 4]) -> Option<[Rgba; 4]> {
    Some([a?, b?, c?, d?])
}

fn mean(colors: &[Rgba; 4]) -> Rgba {
    std::array::from_fn(|k| 0.25 * (colors[0][k] + colors[1][k] + colors[2][k] + colors[3][k]))
}

/// Largest difference, over channels, of display brightness. The root grows with its argument, so that the
/// least and the greatest are enough.
fn difference(colors: &[Rgba; 4]) -> f32 {
    let of_channel = |k: usize| {
        let most = colors.iter().fold(0.0f32, |m, c| m.max(c[k])).clamp(0.0, 1.0);
        let least = colors.iter().fold(1.0f32, |m, c| m.min(c[k])).clamp(0.0, 1.0);
        most.sqrt() - least.sqrt()
    };
    (0..4).map(of_channel).fold(0.0, f32::max)
}

/// The colour of a pixel whose corners differ too little to look between them.
pub(crate) fn even_pixel(settings: &AdaptiveSettings, corners: &[Rgba; 4]) -> Option<Rgba> {
    (settings.cells() == 1 || difference(corners) < settings.threshold).then(|| mean(corners))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Value and number of samples of a pixel in which `f` says what is seen at (x, y) in [0, 1].
    fn sampled(threshold: f32, max_level: u32, f: impl Fn(f64, f64) -> f32) -> (f32, u32) {
        let settings = AdaptiveSettings { threshold, max_level, passes: 1 };
        let mut cache = SquareCache::default();
        cache.begin(settings.cells());
        let mut count = 0;
        let value = pixel(&settings, &mut cache, &mut |x, y| {
            count += 1;
            let at = |i: u32| f64::from(i) / f64::from(settings.cells());
            [f(at(x), at(y)); 4]
        });
        (value[0], count)
    }

    #[test]
    fn worked_counts_of_an_edge_through_a_pixel() {
        let edge = |x: f64, y: f64| if x + y < 1.5 { 1.0 } else { 0.0 };
        for (level, value, count) in [
            (0, 0.75, 4),
            (1, 0.6875, 9),
            (2, 0.796_875, 22),
            (3, 0.839_843_75, 43),
            (4, 0.858_398_437_5, 80),
            (5, 0.866_943_359_375, 149),
            (6, 0.871_032_714_843_75, 282),
        ] {
            assert_eq!(sampled(0.5, level, edge), (value as f32, count), "level {level}");
        }
    }

    #[test]
    fn samples_taken_many_at_a_time_are_the_same() {
        for (level, slope) in [(0, 0.3), (1, 0.7), (3, 1.1), (4, 0.2)] {
            let settings = AdaptiveSettings { threshold: 0.05, max_level: level, passes: 1 };
            let cells = f64::from(settings.cells());
            let seen = |x: u32, y: u32| {
                let (x, y) = (f64::from(x) / cells, f64::from(y) / cells);
                [if y < slope * x { 1.0 } else { (0.5 * x) as f32 }; 4]
            };
            let mut cache = SquareCache::default();
            cache.begin(settings.cells());
            let mut plain_count = 0;
            let plain = pixel(&settings, &mut cache, &mut |x, y| {
                plain_count += 1;
                seen(x, y)
            });
            cache.begin(settings.cells());
            let (mut wanted, mut count) = (Vec::new(), 0);
            let found = loop {
                if let Some(color) = pixel_so_far(&settings, &mut cache, &mut wanted) {
                    break color;
                }
                count += wanted.len();
                wanted.drain(..).for_each(|[x, y]| cache.set(x, y, seen(x, y)));
            };
            assert_eq!((found, count), (plain, plain_count), "level {level}");
        }
    }

    #[test]
    fn a_constant_pixel_takes_its_corners_only() {
        assert_eq!(sampled(0.1, 6, |_, _| 0.375), (0.375, 4));
    }

    #[test]
    fn a_difference_equal_to_the_threshold_divides() {
        let step = |x: f64, _: f64| if x < 0.5 { 0.25 } else { 0.0 };
        assert_eq!(sampled(0.5, 1, step).1, 9, "the square root of 0.25 is 0.5");
        assert_eq!(sampled(0.500_1, 1, step).1, 4);
    }

    #[test]
    fn one_level_weights_corners_edges_and_centre() {
        let only = |px: f64, py: f64| {
            let f = move |x: f64, y: f64| if (x, y) == (px, py) { 1.0 } else { 0.0 };
            sampled(0.0, 1, f).0
        };
        assert_eq!((only(0.0, 1.0), only(0.5, 1.0), only(0.5, 0.5)), (1.0 / 16.0, 0.125, 0.25));
    }

    #[test]
    fn nothing_is_remembered_from_one_pixel_to_the_next() {
        let mut cache = SquareCache::default();
        let settings = AdaptiveSettings { threshold: 0.1, max_level: 0, passes: 1 };
        for value in [0.25, 0.75] {
            cache.begin(1);
            assert_eq!(pixel(&settings, &mut cache, &mut |_, _| [value; 4]), [value; 4]);
        }
        cache.begin(1);
        cache.set(0, 0, [4.0; 4]);
        assert_eq!(pixel(&settings, &mut cache, &mut |_, _| [0.0; 4]), [1.0; 4]);
    }
}
