//! Strength of the light in a picture.
//!
//! Lights of glTF files are often given in the units of photometry, where a desk has 500 lux and the
//! street in the sun 100 000; shown as they are, everything is white.

use senca::{Image, Scene};

/// Brightness above which a picture is taken to be burnt out, as a multiple of display white.
const BURNT_OUT: f32 = 4.0;

/// Multiplies all light in `scene` (lamps, ambient, what surfaces give off) by 2 to the `stops`.
/// Background and fog are colours of the picture and stay.
pub(super) fn expose(scene: &mut Scene, stops: f64) {
    if stops == 0.0 {
        return;
    }
    let factor = stops.exp2() as f32;
    scene.ambient *= factor;
    scene.lights.iter_mut().for_each(|light| light.color *= factor);
    scene.materials.iter_mut().for_each(|material| material.emission *= factor);
}

/// By how many whole stops the middle one of the pixels is too bright, when it is by far.
pub(super) fn stops_too_bright(image: &Image) -> Option<f64> {
    let brightness = |p: &[f32; 4]| p[0].max(p[1]).max(p[2]);
    let pixels = image.pixels();
    let burnt_out = pixels.iter().filter(|p| brightness(p) > BURNT_OUT).count();
    if 2 * burnt_out <= pixels.len() {
        return None;
    }
    let mut values: Vec<f32> = pixels.iter().map(brightness).filter(|v| v.is_finite()).collect();
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f32::total_cmp);
    Some(f64::from(*median).log2().ceil().max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca::math::LinearRgb;

    #[test]
    fn a_stop_doubles_all_light() {
        let mut scene = Scene { ambient: LinearRgb::splat(0.25), ..Scene::default() };
        expose(&mut scene, 1.0);
        assert_eq!(scene.ambient, LinearRgb::splat(0.5));
        expose(&mut scene, -3.0);
        assert_eq!(scene.ambient, LinearRgb::splat(0.0625));
    }

    #[test]
    fn only_pictures_that_are_mostly_burnt_out_are_told_of() {
        let picture = |bright: usize, value: f32| {
            let pixel = |i| if i < bright { [value, 1.0, 1.0, 1.0] } else { [0.5, 0.5, 0.5, 1.0] };
            Image::from_pixels(10, 10, (0..100).map(pixel).collect()).expect("a hundred pixels")
        };
        assert_eq!(stops_too_bright(&picture(60, 1000.0)), Some(10.0));
        assert_eq!(stops_too_bright(&picture(40, 1000.0)), None);
        assert_eq!(stops_too_bright(&picture(100, 1.04)), None);
        assert_eq!(stops_too_bright(&picture(100, f32::INFINITY)), None);
    }
}
