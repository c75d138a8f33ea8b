//! Views that are moved and zoomed, and drawn by whatever their depth asks for.

use fearless_simd::Level;
use senca_math::{Cancelled, Control};

use super::deep::{DeepView, MAX_BOUND};
use super::fixed::Fixed;
use super::wide::Wide;
use super::{Counts, Family, Parameters, counts, deep_counts};
use crate::lab::LabError;

/// Distance of neighbouring pixels below which the processor's numbers no longer tell them apart well.
const SHALLOW: f64 = 1e-13;

/// Least width of a view, as a power of ten.
pub(super) const LEAST_WIDTH: f64 = -10_000.0;

/// Where a picture is, to any depth. Row 0 has the least imaginary part.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The point in the middle.
    pub center: [Fixed; 2],
    /// Width; pixels are square.
    pub width: Wide,
}

impl View {
    /// The view whose middle and width are written as numbers of any length.
    ///
    /// # Errors
    /// They are not numbers, or the width is not above 0.
    pub fn parse(re: &str, im: &str, width: &str) -> Result<Self, LabError> {
        let told = |what: &str| {
            let what = what.to_owned();
            move |e: super::FixedError| LabError::degenerate(format!("{what}: {e}"))
        };
        let limbs = Fixed::limbs_of(width).map_err(told("the width"))? + 1;
        let width = Fixed::parse(width, limbs).map_err(told("the width"))?.to_wide();
        if width.parts().0 <= 0.0 || width.log2() * std::f64::consts::LOG10_2 < LEAST_WIDTH {
            return Err(LabError::degenerate(
                "the width of the view must be greater than 0, at least 1e-10000",
            ));
        }
        let part = |text: &str, what: &str| {
            let limbs = Fixed::limbs_of(text).map_err(told(what))?.max(DeepView::limbs_for(width, 4096));
            Fixed::parse(text, limbs).map_err(told(what))
        };
        Ok(Self { center: [part(re, "the real part")?, part(im, "the imaginary part")?], width })
    }

    /// The view of an area given by its ends, fitted into pictures of `size`.
    #[must_use]
    pub fn of_area(u: [f64; 2], v: [f64; 2], size: [usize; 2]) -> Self {
        let [w, h] = size.map(|n| n.max(1) as f64);
        let width = (u[1] - u[0]).max((v[1] - v[0]) * w / h);
        let middle = |[low, high]: [f64; 2]| Fixed::from_f64((0.5 * low + 0.5 * high).clamp(-1e8, 1e8), 4);
        Self { center: [middle(u), middle(v)], width: Wide::new(width) }
    }

    /// Zooms by `factor` (above 1: closer) so that the point at a pixel stays where it is.
    #[must_use]
    pub fn zoomed(&self, pixel: [f64; 2], size: [usize; 2], factor: f64) -> Self {
        let width = self.width.times_f64(1.0 / factor);
        let limbs = DeepView::limbs_for(width, size[0]).max(self.center[0].fraction());
        let [w, h] = size.map(|n| n as f64);
        let from_middle = [(pixel[0] - 0.5 * w) / w, (pixel[1] - 0.5 * h) / w];
        let moved = |k: usize| {
            let way = self.width.times_f64(from_middle[k] * (1.0 - 1.0 / factor));
            self.center[k].clone().with_fraction(limbs).add(&Fixed::from_wide(way, limbs))
        };
        Self { center: [moved(0), moved(1)], width }
    }

    /// Digits behind the point that tell the middle apart from its neighbours.
    #[must_use]
    pub fn digits(&self) -> usize {
        (-self.width.log2() * std::f64::consts::LOG10_2).max(0.0) as usize + 6
    }
}

/// A view with all that makes a picture of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Where.
    pub view: View,
    /// The constant of a Julia set; `None` for the Mandelbrot set.
    pub julia: Option<[Fixed; 2]>,
    /// eps.
    pub bound: f64,
    /// m.
    pub iterations: u32,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

impl Picture {
    /// Whether the processor's numbers are not enough.
    #[must_use]
    pub fn is_deep(&self) -> bool {
        self.view.width.times_f64(1.0 / self.size[0] as f64).to_f64() < SHALLOW
    }

    /// k of all pixels: quickly where that will do, by perturbation where it is deep.
    ///
    /// # Errors
    /// The caller asked to stop.
    pub fn counts(&self, moduli: bool, control: &Control<'_>) -> Result<Counts, Cancelled> {
        if self.is_deep() {
            return deep_counts(&self.deep(), Level::new(), control);
        }
        counts(&self.shallow(), moduli, Level::new(), control)
    }

    /// For perturbation.
    #[must_use]
    pub fn deep(&self) -> DeepView {
        DeepView {
            center: self.view.center.clone(),
            width: self.view.width,
            julia: self.julia.clone(),
            bound: self.bound.min(MAX_BOUND),
            iterations: self.iterations,
            size: self.size,
        }
    }

    /// For the processor's numbers.
    #[must_use]
    pub fn shallow(&self) -> Parameters {
        let half = 0.5 * self.view.width.to_f64();
        let tall = half * self.size[1] as f64 / self.size[0] as f64;
        let [x, y] = [0, 1].map(|k| self.view.center[k].to_f64());
        let family = match &self.julia {
            Some([re, im]) => Family::Julia { c: [re.to_f64(), im.to_f64()] },
            None => Family::Mandelbrot,
        };
        Parameters {
            family,
            bound: self.bound,
            iterations: self.iterations,
            u: [x - half, x + half],
            v: [y - tall, y + tall],
            size: self.size,
            reach_ends: false,
        }
    }
}

/// Widths of the frames of a zoom, each the same factor closer than the one before.
#[must_use]
pub fn zoom_widths(from: Wide, to: Wide, frames: usize) -> Vec<Wide> {
    let (a, b) = (from.log2(), to.log2());
    let width = |i: usize| match i {
        0 => from,
        i if i + 1 == frames => to,
        i => Wide::from_log2(a + (b - a) * i as f64 / (frames - 1) as f64),
    };
    (0..frames).map(width).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_keeps_its_point() {
        let size = [300, 200];
        let view = View::parse("-0.75", "0.1", "3").expect("a view");
        let closer = view.zoomed([200.0, 50.0], size, 2.0);
        assert_eq!(closer.width.to_f64(), 1.5);
        let at = |view: &View, k: usize, pixel: f64, side: f64| {
            view.center[k].to_f64() + view.width.to_f64() * (pixel - 0.5 * side) / 300.0
        };
        for (k, pixel, side) in [(0, 200.0, 300.0), (1, 50.0, 200.0)] {
            assert!((at(&view, k, pixel, side) - at(&closer, k, pixel, side)).abs() < 1e-15);
        }
        let mut deep = view;
        for _ in 0..400 {
            deep = deep.zoomed([120.0, 80.0], size, 2.0);
        }
        assert!((deep.width.log2() - 3.0_f64.log2() + 400.0).abs() < 1e-9);
        assert!(deep.center[0].fraction() >= 7 && deep.digits() > 120);
    }

    #[test]
    fn views_are_checked() {
        for (re, im, width) in
            [("0", "0", "0"), ("0", "0", "-1"), ("x", "0", "1"), ("0", "1e99", "1"), ("0", "0", "1e-10001")]
        {
            assert!(View::parse(re, im, width).is_err(), "{re} {im} {width}");
        }
        assert!(View::parse("0", "0", "1e-9999").is_ok());
    }

    #[test]
    fn frames_are_evenly_closer() {
        let widths = zoom_widths(Wide::new(4.0), Wide::new(0.25), 5);
        let widths: Vec<f64> = widths.iter().map(|w| w.to_f64()).collect();
        assert_eq!(widths, [4.0, 2.0, 1.0, 0.5, 0.25]);
        assert_eq!(zoom_widths(Wide::new(4.0), Wide::new(1.0), 1), [Wide::new(4.0)]);
    }

    #[test]
    fn areas_are_fitted_in() {
        let view = View::of_area([-1.5, 0.5], [-1.0, 1.0], [400, 200]);
        assert_eq!((view.width.to_f64(), view.center[0].to_f64()), (4.0, -0.5));
    }
}
