//! From light to what a display can show.

use senca_math::{Image, LinearRgb};

/// What becomes of light brighter than a display's white. Exposure goes before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMap {
    /// It is cut off when the picture is written with 8 bits a channel, and kept in a picture of floats.
    #[default]
    None,
    /// `L (1 + L / W^2) / (1 + L)` of the luminance L, where W is the brightest of the picture: everything
    /// fits, dark parts stay nearly as they are.
    /// Source: Reinhard, Stark, Shirley and Ferwerda 2002, equation 4.
    Reinhard,
    /// A curve with a foot and a shoulder, as films have it, per channel; strong light loses its colour.
    /// Source: Narkowicz 2015, a fit to the reference transform of the Academy Color Encoding System.
    Filmic,
}

impl ToneMap {
    /// Maps all pixels.
    pub fn apply(self, image: &mut Image) {
        match self {
            Self::None => {}
            Self::Reinhard => {
                let white = brightest(image);
                map(image, |light| reinhard(light, white));
            }
            Self::Filmic => map(image, |light| light.map(filmic)),
        }
    }
}

/// Luminance of the brightest pixel, at least 1.
fn brightest(image: &Image) -> f32 {
    let luminance = |p: &[f32; 4]| LinearRgb::new(p[0], p[1], p[2]).luminance();
    image.pixels().iter().map(luminance).filter(|l| l.is_finite()).fold(1.0, f32::max)
}

fn map(image: &mut Image, f: impl Fn(LinearRgb) -> LinearRgb) {
    for pixel in image.pixels_mut() {
        let LinearRgb { r, g, b } = f(LinearRgb::new(pixel[0], pixel[1], pixel[2]));
        *pixel = [r, g, b, pixel[3]];
    }
}

fn reinhard(light: LinearRgb, white: f32) -> LinearRgb {
    let luminance = light.luminance();
    if luminance.is_nan() || luminance <= 0.0 {
        return light;
    }
    light * ((1.0 + luminance / (white * white)) / (1.0 + luminance))
}

fn filmic(v: f32) -> f32 {
    let v = v.clamp(0.0, 1e6);
    ((v * (2.51 * v + 0.03)) / (v * (2.43 * v + 0.59) + 0.14)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(tone_map: ToneMap, values: &[f32]) -> Vec<f32> {
        let pixels = values.iter().map(|&v| [v, v, v, 0.5]).collect();
        let mut image = Image::from_pixels(values.len() as u32, 1, pixels).expect("a row");
        tone_map.apply(&mut image);
        assert!(image.pixels().iter().all(|p| p[3] == 0.5), "alpha stays");
        image.pixels().iter().map(|p| p[0]).collect()
    }

    #[test]
    fn all_light_fits_and_keeps_its_order() {
        let values = [0.0, 0.01, 0.1, 0.5, 1.0, 4.0, 30.0];
        assert_eq!(greys(ToneMap::None, &values), values);
        for tone_map in [ToneMap::Reinhard, ToneMap::Filmic] {
            let mapped = greys(tone_map, &values);
            assert!(mapped.windows(2).all(|w| w[0] < w[1] || w[1] == 1.0), "{tone_map:?}: {mapped:?}");
            assert!(mapped[0] == 0.0 && mapped[6] <= 1.0 + 1e-6 && mapped[6] > 0.99);
        }
        assert!((greys(ToneMap::Reinhard, &[30.0])[0] - 1.0).abs() < 1e-6, "the brightest is white");
    }

    #[test]
    fn what_is_no_number_does_not_spread() {
        let mapped = greys(ToneMap::Reinhard, &[f32::NAN, 0.5, 2.0]);
        assert!((mapped[2] - 1.0).abs() < 1e-6 && mapped[1] < 0.5);
    }
}
