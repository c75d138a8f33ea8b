//! Depth, normals and numbers as colours that can be looked at.

use senca_math::color::linear_from_srgb;
use senca_math::{Hls, Image};
use senca_pipeline::Channel;

/// Display value of the nearest and of the farthest depth.
const DEPTH_VALUES: [f32; 2] = [1.0, 0.1];

/// Turns the values of `channel` in `image` into colours for formats of 8 bits.
///
/// The bytes that are written then are, out of 255:
/// - depth: grey, linear from 255 at the nearest place of the picture to 26 at the farthest;
/// - normals: (component + 1) / 2;
/// - objects and triangles: a hue for each number, neighbouring numbers far apart;
/// - black where nothing is.
///
/// Colour stays as it is.
pub fn false_color(image: &mut Image, channel: Channel) {
    let pixels = image.pixels_mut();
    match channel {
        Channel::Color => {}
        Channel::Depth => {
            let [near, far] = range(pixels);
            pixels.iter_mut().for_each(|p| *p = shown([grey(p[0], near, far); 3]));
        }
        Channel::Normals => pixels.iter_mut().for_each(|p| *p = shown(of_normal(*p))),
        Channel::Objects | Channel::Triangles => {
            pixels.iter_mut().for_each(|p| *p = shown(of_number(p[0] as u32)));
        }
    }
}

/// Smallest and largest finite value; the first is above the second where there is none.
fn range(pixels: &[[f32; 4]]) -> [f32; 2] {
    let finite = pixels.iter().map(|p| p[0]).filter(|v| v.is_finite());
    finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

fn grey(depth: f32, near: f32, far: f32) -> f32 {
    let [first, last] = DEPTH_VALUES;
    match () {
        () if !depth.is_finite() => 0.0,
        () if far > near => first + (depth - near) / (far - near) * (last - first),
        () => first,
    }
}

fn of_normal([x, y, z, _]: [f32; 4]) -> [f32; 3] {
    if [x, y, z] == [0.0; 3] { [0.0; 3] } else { [x, y, z].map(|v| 0.5 * v + 0.5) }
}

/// Steps of the golden angle never come back to a hue.
fn of_number(number: u32) -> [f32; 3] {
    if number == 0 {
        return [0.0; 3];
    }
    let hue = f64::from(number - 1) * 137.507_764_050_037_85;
    let lightness = [0.55, 0.4, 0.7][(number as usize - 1) % 3];
    Hls::new(hue, lightness, 0.75).to_rgb().map(|v| v as f32)
}

/// A pixel whose display values these are.
fn shown(values: [f32; 3]) -> [f32; 4] {
    let [r, g, b] = values.map(linear_from_srgb);
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::LinearRgb;

    /// The bytes that are shown for pixels of these values.
    fn bytes(channel: Channel, values: &[[f32; 3]]) -> Vec<[u8; 3]> {
        let mut image = Image::new(values.len() as u32, 1, [0.0; 4]);
        for (pixel, &[a, b, c]) in image.pixels_mut().iter_mut().zip(values) {
            *pixel = [a, b, c, 1.0];
        }
        false_color(&mut image, channel);
        let shown = |&[r, g, b, _]: &[f32; 4]| {
            let c = LinearRgb::new(r, g, b).to_srgb8();
            [c.r, c.g, c.b]
        };
        image.pixels().iter().map(shown).collect()
    }

    #[test]
    fn depths_are_greys_in_equal_steps() {
        let depths = [2.0, 4.0, 3.0, f32::INFINITY].map(|d| [d; 3]);
        assert_eq!(bytes(Channel::Depth, &depths), [[255; 3], [26; 3], [140; 3], [0; 3]]);
        assert_eq!(bytes(Channel::Depth, &[[7.0; 3]]), [[255; 3]]);
        assert_eq!(bytes(Channel::Depth, &[[f32::INFINITY; 3]]), [[0; 3]]);
    }

    #[test]
    fn normals_are_halved_and_shifted() {
        let normals = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3]];
        assert_eq!(bytes(Channel::Normals, &normals), [[128, 128, 255], [0, 128, 128], [0; 3]]);
    }

    #[test]
    fn numbers_have_colours_of_their_own() {
        let numbers: Vec<_> = (0..200u16).map(|n| [f32::from(n); 3]).collect();
        let mut colors = bytes(Channel::Objects, &numbers);
        assert_eq!(colors[0], [0; 3]);
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), 200);
    }
}
