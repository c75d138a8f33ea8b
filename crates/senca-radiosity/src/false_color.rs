//! Numbers as colours, with a scale that tells which.

mod digits;

use senca_math::{Image, LinearRgb, Srgb8};

pub use digits::{GLYPH_HEIGHT, draw_text, text_width};

/// Colours of the scale from its lower to its upper end, sRGB: dark blue, blue, cyan, green, yellow, orange, red.
/// Lightness rises up to yellow, so that the scale can be read in grey, too, below it.
const STOPS: [[u8; 3]; 7] = [
    [20, 18, 70],
    [38, 66, 190],
    [24, 158, 206],
    [52, 178, 92],
    [232, 220, 60],
    [238, 138, 32],
    [196, 24, 28],
];

/// What a picture of false colours shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseColors {
    /// Value that a shown 1 stands for, in the unit of the scale. Default π: lux, where a shown 1 is
    /// 1 cd/m².
    pub unit: f64,
    /// Value at the upper end of the scale, > 0.
    pub most: f64,
    /// Whether equal steps of colour are equal factors; the lower end then is a thousandth of the
    /// upper one.
    pub logarithmic: bool,
}

/// Share of the upper end at which a logarithmic scale begins.
const LOG_FLOOR: f64 = 1e-3;

impl FalseColors {
    /// Lux on a linear scale up to a round number at or above `brightest`, which is in pictures' units.
    #[must_use]
    pub fn lux(brightest: f64, luminance_of_one: f64) -> Self {
        let unit = std::f64::consts::PI * luminance_of_one;
        Self { unit, most: round_up(brightest * unit), logarithmic: false }
    }

    /// Colour of light, by its luminance.
    #[must_use]
    pub fn of(&self, light: LinearRgb) -> LinearRgb {
        self.of_value(f64::from(light.luminance()) * self.unit)
    }

    /// Colour of a value in the unit of the scale.
    #[must_use]
    pub fn of_value(&self, value: f64) -> LinearRgb {
        color_at(self.share(value))
    }

    /// Where on the scale a value is, 0 to 1.
    fn share(&self, value: f64) -> f64 {
        let share = value / self.most;
        let share = if self.logarithmic { 1.0 - share.max(LOG_FLOOR).ln() / LOG_FLOOR.ln() } else { share };
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }

    /// The value at a place of the scale.
    fn value(&self, share: f64) -> f64 {
        if self.logarithmic { self.most * LOG_FLOOR.powf(1.0 - share) } else { self.most * share }
    }
}

/// Colour of a place of the scale, 0 to 1.
fn color_at(share: f64) -> LinearRgb {
    let along = share * (STOPS.len() - 1) as f64;
    let stop = (along as usize).min(STOPS.len() - 2);
    let t = along - stop as f64;
    let channel = |k: usize| {
        let [a, b] = [STOPS[stop][k], STOPS[stop + 1][k]].map(f64::from);
        (a + t * (b - a)).round() as u8
    };
    Srgb8 { r: channel(0), g: channel(1), b: channel(2) }.to_linear()
}

/// The smallest of 1, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten that is not below `value`; 1 for what
/// is not a positive number.
#[must_use]
pub fn round_up(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let power = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    let enough = |step: &&f64| **step * power >= value * (1.0 - 1e-12);
    steps.iter().find(enough).unwrap_or(&10.0) * power
}

/// Width of the strip that [`with_scale`] adds, in pixels, for glyphs of `zoom` pixels a dot.
fn strip_width(zoom: u32) -> u32 {
    zoom * 46
}

/// `image` with a strip to its right that says which colour is which value, and `unit` above it.
#[must_use]
pub fn with_scale(image: &Image, colors: &FalseColors, unit: &str) -> Image {
    let (width, height) = (image.width(), image.height());
    let zoom = (height / 200).clamp(1, 6);
    let strip = strip_width(zoom);
    let mut out = Image::new(width + strip, height, [1.0; 4]);
    for y in 0..height {
        for x in 0..width {
            out.set_pixel(x, y, image.pixel(x, y));
        }
    }
    let line = (GLYPH_HEIGHT + 3) * zoom;
    let (left, bar) = (width + 3 * zoom, 8 * zoom);
    draw_text(&mut out, [left, zoom], unit, zoom, LinearRgb::BLACK);
    let (top, bottom) = (line + GLYPH_HEIGHT * zoom / 2, height.saturating_sub(line));
    if bottom <= top {
        return out;
    }
    for y in top..=bottom {
        let share = f64::from(bottom - y) / f64::from(bottom - top);
        let LinearRgb { r, g, b } = color_at(share);
        (left..left + bar).for_each(|x| out.set_pixel(x, y, [r, g, b, 1.0]));
    }
    let marks = ((bottom - top) / (2 * line)).clamp(1, 10);
    for mark in 0..=marks {
        let share = f64::from(mark) / f64::from(marks);
        let y = bottom - (f64::from(bottom - top) * share).round() as u32;
        (left + bar..left + bar + 2 * zoom).for_each(|x| out.set_pixel(x, y, [0.0, 0.0, 0.0, 1.0]));
        let at = [left + bar + 4 * zoom, y.saturating_sub(GLYPH_HEIGHT * zoom / 2)];
        draw_text(&mut out, at, &short_number(colors.value(share)), zoom, LinearRgb::BLACK);
    }
    out
}

/// A number in three digits or so, as one reads it on a scale.
#[must_use]
pub fn short_number(value: f64) -> String {
    let size = value.abs();
    match size {
        0.0 => "0".to_owned(),
        s if !(0.001..1e6).contains(&s) => format!("{value:.1e}"),
        s if s >= 99.95 => format!("{value:.0}"),
        s if s >= 9.995 => trimmed(format!("{value:.1}")),
        s if s >= 0.9995 => trimmed(format!("{value:.2}")),
        _ => trimmed(format!("{value:.3}")),
    }
}

/// Without zeros at the end of its fraction.
fn trimmed(number: String) -> String {
    let short = number.trim_end_matches('0').trim_end_matches('.');
    short.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_at_round_numbers() {
        for (value, end) in
            [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (410.0, 500.0), (0.021, 0.025), (8.1, 10.0), (700.0, 800.0)]
        {
            assert!((round_up(value) / end - 1.0).abs() < 1e-12, "{value} gives {}", round_up(value));
        }
        assert_eq!([round_up(0.0), round_up(f64::NAN), round_up(-4.0)], [1.0; 3]);
    }

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (500.0, "500"),
            (2.5, "2.5"),
            (62.5, "62.5"),
            (0.125, "0.125"),
            (1250.0, "1250"),
            (99.96, "100"),
            (1e-9, "1.0e-9"),
            (3.0, "3"),
        ];
        for (value, text) in cases {
            assert_eq!(short_number(value), text);
        }
    }

    #[test]
    fn colours_run_from_blue_to_red() {
        let colors = FalseColors { unit: 1.0, most: 100.0, logarithmic: false };
        let [low, high] = [0.0, 100.0].map(|v| colors.of_value(v));
        assert!(low.b > low.r && high.r > high.b);
        assert_eq!(colors.of_value(1e9), high);
        assert_eq!(colors.of_value(f64::NAN), low);
        let logarithmic = FalseColors { logarithmic: true, ..colors };
        assert_eq!(logarithmic.of_value(100.0), high);
        assert!((logarithmic.share(10.0) - 2.0 / 3.0).abs() < 1e-12);
        assert!((logarithmic.value(logarithmic.share(3.0)) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_scale_shows_its_colours_and_leaves_the_picture_alone() {
        let image = Image::new(60, 240, [0.25, 0.5, 0.75, 1.0]);
        let colors = FalseColors::lux(1.0, 1.0);
        assert_eq!(colors.most, 4.0);
        let out = with_scale(&image, &colors, "lux");
        assert_eq!((out.height(), out.pixel(59, 239)), (240, [0.25, 0.5, 0.75, 1.0]));
        let reds = out.pixels().iter().filter(|p| LinearRgb::new(p[0], p[1], p[2]) == color_at(1.0)).count();
        assert!(reds >= 8, "{reds} pixels of the upper end");
        let tiny = with_scale(&Image::new(4, 3, [0.0; 4]), &colors, "lux");
        assert_eq!(tiny.height(), 3);
    }
}
