//! Hue, lightness and saturation.
//!
//! The double cone of Ostwald and Tektronix: hue is the angle about the axis of greys, with red at 0,
//! green at 120 and blue at 240 degrees; lightness runs from black, 0, through the pure hues, 0.5, to
//! white, 1; saturation is the distance from the axis. It describes shades of one colour more easily
//! than red, green and blue do. The conversion is between display values, not between lights.
//! Source: 1991 thesis, section 8.2.

/// A colour by hue, lightness and saturation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hls {
    /// Hue in degrees; [`Self::from_rgb`] gives [0, 360), and 0 for a grey, which has no hue.
    pub hue: f64,
    /// Lightness, 0 to 1.
    pub lightness: f64,
    /// Saturation, 0 to 1.
    pub saturation: f64,
}

impl Hls {
    /// A colour from hue in degrees (any number; it is wrapped), lightness and saturation.
    #[must_use]
    pub const fn new(hue: f64, lightness: f64, saturation: f64) -> Self {
        Self { hue, lightness, saturation }
    }

    /// From red, green and blue in [0, 1].
    #[must_use]
    pub fn from_rgb([r, g, b]: [f64; 3]) -> Self {
        let (max, min) = (r.max(g).max(b), r.min(g).min(b));
        let (sum, range) = (max + min, max - min);
        let lightness = 0.5 * sum;
        if range == 0.0 {
            return Self::new(0.0, lightness, 0.0);
        }
        let saturation = if lightness <= 0.5 { range / sum } else { range / (2.0 - sum) };
        let sextant = if r == max {
            (g - b) / range
        } else if g == max {
            2.0 + (b - r) / range
        } else {
            4.0 + (r - g) / range
        };
        // A tiny negative angle rounds to 360 itself, which is 0.
        Self::new((60.0 * sextant).rem_euclid(360.0) % 360.0, lightness, saturation)
    }

    /// To red, green and blue in [0, 1]. A hue of 360 degrees is that of 0; a hue that is not finite
    /// counts as 0.
    #[must_use]
    pub fn to_rgb(self) -> [f64; 3] {
        let Self { hue, lightness: l, saturation: s } = self;
        let sixths = if hue.is_finite() { (hue / 60.0).rem_euclid(6.0) } else { 0.0 };
        let max = if l <= 0.5 { l * (1.0 + s) } else { l + s - l * s };
        let min = 2.0 * l - max;
        let rising = min + sixths.fract() * (max - min);
        let falling = max - sixths.fract() * (max - min);
        match sixths as u32 {
            1 => [falling, max, min],
            2 => [min, max, rising],
            3 => [min, falling, max],
            4 => [rising, min, max],
            5 => [max, min, falling],
            // rem_euclid may round up to 6, which is 0.
            _ => [max, rising, min],
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8)
    }

    #[test]
    fn the_table_of_colours_converts_both_ways() {
        let table = [
            ([1.0, 0.0, 0.0], [0.0, 0.5, 1.0]),
            ([1.0, 1.0, 0.0], [60.0, 0.5, 1.0]),
            ([0.0, 1.0, 0.0], [120.0, 0.5, 1.0]),
            ([0.0, 1.0, 1.0], [180.0, 0.5, 1.0]),
            ([0.0, 0.0, 1.0], [240.0, 0.5, 1.0]),
            ([1.0, 0.0, 1.0], [300.0, 0.5, 1.0]),
            ([0.5, 0.5, 0.5], [0.0, 0.5, 0.0]),
            ([0.2, 0.4, 0.6], [210.0, 0.4, 0.5]),
            ([0.75, 0.25, 0.5], [330.0, 0.5, 0.5]),
            ([0.8, 0.6, 0.1], [300.0 / 7.0, 0.45, 7.0 / 9.0]),
            ([1.0, 0.5, 0.5], [0.0, 0.75, 1.0]),
            ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
            ([1.0, 1.0, 1.0], [0.0, 1.0, 0.0]),
        ];
        for (rgb, hls) in table {
            let got = Hls::from_rgb(rgb);
            assert!(close(&[got.hue, got.lightness, got.saturation], &hls), "{rgb:?} gave {got:?}");
            assert!(close(&Hls::new(hls[0], hls[1], hls[2]).to_rgb(), &rgb), "{hls:?}");
        }
    }

    #[test]
    fn hue_wraps() {
        let red = [1.0, 0.0, 0.0];
        for hue in [360.0, 720.0, -360.0, -1e-300, f64::NAN, f64::INFINITY] {
            assert_eq!(Hls::new(hue, 0.5, 1.0).to_rgb(), red, "{hue}");
        }
    }

    proptest! {
        #[test]
        fn conversions_undo_each_other(rgb in prop::array::uniform3(0.0..=1.0f64)) {
            let hls = Hls::from_rgb(rgb);
            prop_assert!((0.0..360.0).contains(&hls.hue));
            let back = hls.to_rgb();
            prop_assert!(rgb.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }
}
