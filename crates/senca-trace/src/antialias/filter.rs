//! Reconstruction filters.
//!
//! A pixel is the mean of what is around its centre, weighted by a filter. Here samples are not
//! weighted but drawn by the filter: they lie dense where it is large (Ernst, Stamminger and Greiner
//! 2006). Each sample then belongs to one pixel, so pixels know nothing of each other; where a filter
//! is negative its samples count as -1.

use senca_math::glam::DVec2;

use crate::TraceError;

/// How much a place counts in a pixel, by its distance from the centre. All are products of a function
/// of x and one of y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PixelFilter {
    /// The pixel's area, evenly.
    #[default]
    Box,
    /// Linearly down to 0.
    Tent {
        /// Where it ends, in pixels, in (0, 8]. Usual: 1.
        radius: f64,
    },
    /// A bell with a standard deviation of a third of the radius.
    Gaussian {
        /// Where it is cut, in pixels, in (0, 8]. Usual: 1.5.
        radius: f64,
    },
    /// The cubic with B = C = 1/3 of Mitchell and Netravali 1988: sharp, with a slight overshoot.
    Mitchell {
        /// Where it ends, in pixels, in (0, 8]. Usual: 2.
        radius: f64,
    },
    /// The window of four cosine terms (Harris 1978): a narrow bell without a visible end.
    BlackmanHarris {
        /// Where it ends, in pixels, in (0, 8]. Usual: 1.5.
        radius: f64,
    },
}

impl PixelFilter {
    /// Distance from the centre beyond which it is 0.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box => 0.5,
            Self::Tent { radius }
            | Self::Gaussian { radius }
            | Self::Mitchell { radius }
            | Self::BlackmanHarris { radius } => radius,
        }
    }

    /// The filter of this name with its usual radius, or the one given: box, tent, gaussian, mitchell,
    /// blackman-harris. The box has no other radius.
    #[must_use]
    pub fn named(name: &str, radius: Option<f64>) -> Option<Self> {
        let or = |usual| radius.unwrap_or(usual);
        Some(match name {
            "box" => Self::Box,
            "tent" => Self::Tent { radius: or(1.0) },
            "gaussian" => Self::Gaussian { radius: or(1.5) },
            "mitchell" => Self::Mitchell { radius: or(2.0) },
            "blackman-harris" => Self::BlackmanHarris { radius: or(1.5) },
            _ => return None,
        })
    }

    pub(super) fn check(&self) -> Result<(), TraceError> {
        let value = self.radius();
        let fits = value > 0.0 && value <= 8.0;
        let wrong =
            TraceError::Setting { name: "radius of the filter", value, expected: "above 0, at most 8" };
        if fits { Ok(()) } else { Err(wrong) }
    }

    /// Its value at `x` radii from the centre, up to a factor.
    fn value(&self, x: f64) -> f64 {
        let x = x.abs();
        if x >= 1.0 {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent { .. } => 1.0 - x,
            Self::Gaussian { .. } => (-4.5 * x * x).exp(),
            Self::Mitchell { .. } => mitchell(2.0 * x),
            Self::BlackmanHarris { .. } => {
                let phase = std::f64::consts::PI * (1.0 + x);
                0.35875 - 0.48829 * phase.cos() + 0.14128 * (2.0 * phase).cos()
                    - 0.01168 * (3.0 * phase).cos()
            }
        }
    }
}

/// The cubic of B = C = 1/3, for 0 <= x < 2.
fn mitchell(x: f64) -> f64 {
    if x < 1.0 {
        (7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0) / 6.0
    } else {
        (-7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0
    }
}

/// Cells of a table.
const CELLS: usize = 512;

/// A filter ready to draw places.
#[derive(Clone, Debug)]
pub(crate) struct FilterTable {
    radius: f64,
    /// Share of the absolute filter in the cells before each, and 1 at the end.
    before: Vec<f64>,
    /// Sign of each cell.
    sign: Vec<f32>,
}

impl FilterTable {
    pub(super) fn new(filter: PixelFilter) -> Self {
        let middle = |cell: usize| (2.0 * (cell as f64 + 0.5) / CELLS as f64) - 1.0;
        let values: Vec<f64> = (0..CELLS).map(|cell| filter.value(middle(cell))).collect();
        let total: f64 = values.iter().map(|v| v.abs()).sum();
        let mut sum = 0.0;
        let mut before = vec![0.0];
        for value in &values {
            sum += value.abs() / total;
            before.push(sum);
        }
        before[CELLS] = 1.0;
        let sign = values.iter().map(|v| if *v < 0.0 { -1.0 } else { 1.0 }).collect();
        Self { radius: filter.radius(), before, sign }
    }

    /// Place, in pixels from the pixel's upper left corner, and weight, 1 or -1.
    #[inline]
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> (DVec2, f32) {
        let ((x, a), (y, b)) = (self.along(u), self.along(v));
        (DVec2::new(0.5 + x, 0.5 + y), a * b)
    }

    /// Distance along one axis, and sign.
    fn along(&self, u: f64) -> (f64, f32) {
        let cell = self.before.partition_point(|b| *b <= u).clamp(1, CELLS) - 1;
        let (from, to) = (self.before[cell], self.before[cell + 1]);
        let within = if to > from { (u - from) / (to - from) } else { 0.5 };
        (self.radius * (2.0 * (cell as f64 + within) / CELLS as f64 - 1.0), self.sign[cell])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> [PixelFilter; 5] {
        ["box", "tent", "gaussian", "mitchell", "blackman-harris"]
            .map(|name| PixelFilter::named(name, None).expect("a filter"))
    }

    #[test]
    fn drawn_places_reproduce_the_filter() {
        for filter in all() {
            let table = FilterTable::new(filter);
            let n = 100_000;
            let mut mean_of_square = 0.0;
            let mut weights = 0.0;
            for i in 0..n {
                let (x, sign) = table.along((f64::from(i) + 0.5) / f64::from(n));
                assert!(x.abs() <= filter.radius());
                mean_of_square += f64::from(sign) * x * x;
                weights += f64::from(sign);
            }
            let integral =
                |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(f64::from(i) / f64::from(n))).sum::<f64>();
            let r = filter.radius();
            let expected = integral(&|x| filter.value(x) * (r * x).powi(2)) / integral(&|x| filter.value(x));
            let found = mean_of_square / weights;
            assert!((found - expected).abs() < 1e-3 * r * r, "{filter:?}: {found} {expected}");
        }
    }

    #[test]
    fn values_at_known_places() {
        assert_eq!(PixelFilter::Tent { radius: 1.0 }.value(0.25), 0.75);
        let mitchell = PixelFilter::Mitchell { radius: 2.0 };
        assert!((mitchell.value(0.0) - 8.0 / 9.0).abs() < 1e-12);
        assert!((mitchell.value(0.5) - 1.0 / 18.0).abs() < 1e-12, "one pixel from the centre");
        assert!(mitchell.value(0.75) < 0.0);
        assert!((PixelFilter::BlackmanHarris { radius: 1.0 }.value(0.0) - 1.0).abs() < 1e-12);
        assert!(all().iter().all(|f| f.value(1.0) == 0.0));
    }

    #[test]
    fn names_and_radii() {
        assert_eq!(PixelFilter::named("tent", Some(3.0)), Some(PixelFilter::Tent { radius: 3.0 }));
        assert_eq!(PixelFilter::named("sinc", None), None);
        assert!(PixelFilter::Gaussian { radius: 9.0 }.check().is_err());
    }
}
