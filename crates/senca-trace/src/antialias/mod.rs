//! Where in a pixel rays go through, and how their colours become its colour (course text, section
//! 3.4).
//!
//! - *None*: through the middle. Edges are jagged, fine regular detail turns into false patterns.
//! - *Jitter*: through a random place near the middle. The cause stays, but noise is less conspicuous
//!   than patterns.
//! - *Regular* supersampling: through the middles of n x n equal cells, and the mean. Drawing the
//!   picture n times as large both ways and reducing it by means of n x n pixels is the same.
//! - *Adaptive* supersampling: through the corners, and only where these differ into quarters; see
//!   [`AdaptiveSettings`].
//! - *Filtered*: through evenly spread places, weighted by a reconstruction filter; see
//!   [`PixelFilter`].

mod adaptive;
mod filter;

use senca_math::glam::DVec2;

use crate::{Sampler, TraceError};

pub use adaptive::AdaptiveSettings;
pub(crate) use adaptive::{SquareCache, even_pixel, pixel_so_far as adaptive_pixel_so_far};
use filter::FilterTable;
pub use filter::PixelFilter;

/// Most samples per pixel.
const MAX_SAMPLES: u32 = 1 << 20;

/// Most samples along a side of a pixel of the regular grid.
const MAX_PER_SIDE: u32 = 64;

/// How a pixel is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Antialiasing {
    /// One ray through the middle.
    #[default]
    None,
    /// One ray through a random place in a square around the middle.
    Jitter {
        /// Side of the square in pixels, in [0, 1]. 1 is the whole pixel.
        amplitude: f64,
    },
    /// Rays through the middles of equal cells.
    Regular {
        /// Cells along each side, 1 to 64. The text names 2 to 4.
        per_side: u32,
    },
    /// Rays through the corners, more where these differ.
    Adaptive(AdaptiveSettings),
    /// Rays through evenly spread places, weighted.
    Filtered {
        /// Rays per pixel, 1 to 2^20. Powers of two are spread best.
        samples: u32,
        /// How much a place counts in a pixel.
        filter: PixelFilter,
    },
}

impl Antialiasing {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`TraceError::Setting`].
    pub fn check(&self) -> Result<(), TraceError> {
        let wrong = |name, value, expected| Err(TraceError::Setting { name, value, expected });
        match *self {
            Self::Jitter { amplitude } if !(0.0..=1.0).contains(&amplitude) => {
                wrong("amplitude of the jitter", amplitude, "0 to 1")
            }
            Self::Regular { per_side } if !(1..=MAX_PER_SIDE).contains(&per_side) => {
                wrong("samples along a pixel's side", per_side.into(), "1 to 64")
            }
            Self::Filtered { samples, .. } if !(1..=MAX_SAMPLES).contains(&samples) => {
                wrong("samples", samples.into(), "1 to 1048576")
            }
            Self::Filtered { filter, .. } => filter.check(),
            Self::Adaptive(settings) => settings.check(),
            _ => Ok(()),
        }
    }

    /// Samples of every pixel; those of adaptive supersampling are not known beforehand, and 4 a
    /// pass at least.
    #[must_use]
    pub fn samples(&self) -> u32 {
        match *self {
            Self::None | Self::Jitter { .. } => 1,
            Self::Regular { per_side } => per_side * per_side,
            Self::Adaptive(settings) => 4 * settings.passes,
            Self::Filtered { samples, .. } => samples,
        }
    }

    /// Goes in which the picture can be exposed, each of which makes it better and may show another moment:
    /// the samples of every pixel, or the passes of adaptive supersampling.
    #[must_use]
    pub fn passes(&self) -> u32 {
        match *self {
            Self::Adaptive(settings) => settings.passes,
            _ => self.samples(),
        }
    }
}

/// Places within a pixel, ready to be asked for.
#[derive(Clone, Debug)]
pub(crate) enum Places {
    Middle,
    Jitter(f64),
    Grid(u32),
    Filtered(FilterTable),
}

impl Places {
    /// Those of a way of sampling that looks at each pixel by itself; `None` for the adaptive one.
    pub(crate) fn of(antialiasing: &Antialiasing) -> Option<Self> {
        Some(match *antialiasing {
            Antialiasing::None => Self::Middle,
            Antialiasing::Jitter { amplitude } => Self::Jitter(amplitude),
            Antialiasing::Regular { per_side } => Self::Grid(per_side),
            Antialiasing::Filtered { filter, .. } => Self::Filtered(FilterTable::new(filter)),
            Antialiasing::Adaptive(_) => return None,
        })
    }

    /// Place of a sample, in pixels from the pixel's upper left corner, and its weight. The first pair
    /// of numbers of `sampler` is used.
    #[inline]
    pub(crate) fn place(&self, sample: u32, sampler: &mut Sampler) -> (DVec2, f32) {
        match self {
            Self::Middle | Self::Grid(_) => (self.even(sample).unwrap_or_default(), 1.0),
            Self::Jitter(amplitude) => {
                let [u, v] = sampler.next_2d();
                (DVec2::splat(0.5) + *amplitude * (DVec2::new(u, v) - 0.5), 1.0)
            }
            Self::Filtered(table) => table.place(sampler.next_2d()),
        }
    }

    /// Place of a sample where that is the same in all pixels; its weight is 1.
    pub(crate) fn even(&self, sample: u32) -> Option<DVec2> {
        match self {
            Self::Middle => Some(DVec2::splat(0.5)),
            Self::Grid(n) => {
                let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(*n);
                Some(DVec2::new(middle(sample % n), middle(sample / n % n)))
            }
            Self::Jitter(_) | Self::Filtered(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pattern;

    #[test]
    fn the_regular_grid_has_the_middles_of_equal_cells() {
        let places = Places::of(&Antialiasing::Regular { per_side: 2 }).expect("a pattern");
        let mut sampler = Sampler::new(Pattern::Sobol, 0, 0, 0, 0);
        let all: Vec<_> = (0..4).map(|i| places.place(i, &mut sampler).0.to_array()).collect();
        assert_eq!(all, [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]]);
        assert_eq!(Antialiasing::Regular { per_side: 4 }.samples(), 16);
    }

    #[test]
    fn jitter_stays_within_its_amplitude_and_depends_on_the_seed() {
        let places = Places::of(&Antialiasing::Jitter { amplitude: 0.5 }).expect("a pattern");
        let place = |seed, x| places.place(0, &mut Sampler::new(Pattern::Sobol, seed, x, 0, 0)).0;
        for x in 0..1000 {
            assert!((place(1, x) - 0.5).abs().max_element() <= 0.25);
        }
        assert_eq!(place(1, 7), place(1, 7));
        assert_ne!(place(1, 7), place(2, 7));
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for wrong in [
            Antialiasing::Jitter { amplitude: f64::NAN },
            Antialiasing::Regular { per_side: 0 },
            Antialiasing::Filtered { samples: 0, filter: PixelFilter::Box },
            Antialiasing::Filtered { samples: 4, filter: PixelFilter::Tent { radius: -1.0 } },
            Antialiasing::Adaptive(AdaptiveSettings { threshold: -0.1, ..AdaptiveSettings::default() }),
            Antialiasing::Adaptive(AdaptiveSettings { max_level: 99, ..AdaptiveSettings::default() }),
            Antialiasing::Adaptive(AdaptiveSettings { passes: 0, ..AdaptiveSettings::default() }),
        ] {
            assert!(matches!(wrong.check(), Err(TraceError::Setting { .. })), "{wrong:?}");
        }
    }
}
