//! Pictures of few colours, as most interactive programs draw them: PNG with a palette, a fraction of the size
//! of one with red, green and blue for each pixel.

use std::collections::HashMap;

use senca_window::Canvas;

/// Most colours of a palette.
const MOST_COLORS: usize = 256;

/// The picture as a PNG with a palette, in order of first use; `None` where it has more than 256 colours.
pub(super) fn indexed_png(canvas: &Canvas) -> Option<Result<Vec<u8>, png::EncodingError>> {
    let mut numbers = HashMap::new();
    let mut palette = Vec::new();
    let mut indices = Vec::with_capacity(canvas.pixels().len());
    let mut last = (u32::MAX, 0);
    for &color in canvas.pixels() {
        let color = color & 0xff_ff_ff;
        if color != last.0 {
            let number = *numbers.entry(color).or_insert_with(|| {
                palette.push(color);
                palette.len() - 1
            });
            last = (color, number);
        }
        let number = last.1;
        if number >= MOST_COLORS {
            return None;
        }
        indices.push(number as u8);
    }
    Some(write(canvas, &palette, &indices))
}

fn write(canvas: &Canvas, palette: &[u32], indices: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let (depth, bits) = match palette.len() {
        ..=2 => (png::BitDepth::One, 1),
        3..=4 => (png::BitDepth::Two, 2),
        5..=16 => (png::BitDepth::Four, 4),
        _ => (png::BitDepth::Eight, 8),
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, canvas.width() as u32, canvas.height() as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(depth);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Balanced);
    // Neighbouring numbers say nothing about each other.
    encoder.set_filter(png::Filter::NoFilter);
    encoder
        .set_palette(palette.iter().flat_map(|c| c.to_be_bytes().into_iter().skip(1)).collect::<Vec<u8>>());
    let mut writer = encoder.write_header()?;
    let rows = indices.chunks_exact(canvas.width());
    writer.write_image_data(&rows.flat_map(|row| packed(row, bits)).collect::<Vec<u8>>())?;
    writer.finish()?;
    Ok(bytes)
}

/// A row of numbers of so many bits, the first in the highest bits of the first byte.
fn packed(row: &[u8], bits: usize) -> impl Iterator<Item = u8> + '_ {
    let together = move |numbers: &[u8]| {
        numbers.iter().enumerate().fold(0, |byte, (i, number)| byte | number << (8 - bits * (i + 1)))
    };
    row.chunks(8 / bits).map(together)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::interactive::image_of;

    #[test]
    fn any_number_of_colours_is_kept() {
        for colors in [1, 2, 3, 4, 5, 16, 17, 256] {
            let mut canvas = Canvas::new(37, 11);
            let paint = |(i, pixel): (usize, &mut u32)| *pixel = (i * 7 % colors) as u32 * 0x01_03_05;
            canvas.pixels_mut().iter_mut().enumerate().for_each(paint);
            let bytes = indexed_png(&canvas).expect("few colours").expect("encodes");
            let limits = senca::io::Limits::default();
            let read = senca::io::images::decode_picture("p", &bytes, &limits).expect("a picture");
            assert!(read.pixels() == image_of(&canvas).pixels(), "{colors}");
        }
        let mut canvas = Canvas::new(257, 1);
        canvas.pixels_mut().iter_mut().enumerate().for_each(|(i, pixel)| *pixel = i as u32);
        assert!(indexed_png(&canvas).is_none());
    }
}
