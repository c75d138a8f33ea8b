//! A flight as an animated picture, and a sheet of one moment drawn in several ways.

use senca_window::Canvas;

use super::color_map::ColorMap;
use super::exact_frame::draw_frame_exactly;
use super::flight::{Moment, Show};
use super::frame::draw_frame;
use super::scene::World;
use super::{Mapping, SCREEN, Stages};

/// Most pictures of a film: a minute.
pub const LONGEST_FILM: usize = 1500;

/// How long a picture of a film is shown, in hundredths of a second.
pub const FILM_DELAY: u16 = 4;

/// Why there is no film.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// No pictures.
    #[error("a film needs at least one moment: the script has no tick")]
    Empty,
    /// Too many.
    #[error("the flight has {0} ticks; a film has at most {LONGEST_FILM} pictures")]
    TooLong(usize),
    /// The encoder refused.
    #[error("the film cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// The encoder refused.
    #[error("the film cannot be encoded: {0}")]
    Gif(#[from] image::ImageError),
    /// Drawing was stopped.
    #[error("stopped")]
    Stopped,
}

/// Formats of films. Both keep all colours, where the pictures are the library's or the reference's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// Animated PNG.
    Png,
    /// GIF; where differences are shown, with 256 colours a picture.
    Gif,
}

impl FilmFormat {
    /// By the extension of a file, in any case: png, apng or gif.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "png" | "apng" => Some(Self::Png),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }
}

/// Draws the moments one after the other as a film that runs round and round. `go_on` is asked before each picture.
///
/// # Errors
/// If there are no moments or too many, or `go_on` says no.
pub fn film(
    world: &World,
    moments: &[Moment],
    format: FilmFormat,
    go_on: &dyn Fn() -> bool,
) -> Result<Vec<u8>, FilmError> {
    match moments.len() {
        0 => return Err(FilmError::Empty),
        count if count > LONGEST_FILM => return Err(FilmError::TooLong(count)),
        _ => {}
    }
    match format {
        FilmFormat::Png => animated_png(world, moments, go_on),
        FilmFormat::Gif => animated_gif(world, moments, go_on),
    }
}

/// Bytes of red, green and blue.
fn rgb(colors: &[u32]) -> Vec<u8> {
    colors.iter().flat_map(|color| color.to_be_bytes().into_iter().skip(1)).collect()
}

fn animated_png(world: &World, moments: &[Moment], go_on: &dyn Fn() -> bool) -> Result<Vec<u8>, FilmError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SCREEN[0] as u32, SCREEN[1] as u32);
    // The library's colours are numbers of a palette already; differences have any colour.
    let is_indexed = moments.iter().all(|moment| moment.show != Show::Difference);
    if is_indexed {
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(rgb(&world.palette));
    } else {
        encoder.set_color(png::ColorType::Rgb);
    }
    encoder.set_animated(moments.len() as u32, 0)?;
    encoder.set_frame_delay(FILM_DELAY, 100)?;
    let mut writer = encoder.write_header()?;
    let mut map = ColorMap::new(SCREEN[0], SCREEN[1]);
    for moment in moments {
        if !go_on() {
            return Err(FilmError::Stopped);
        }
        if is_indexed {
            moment.draw(world, &mut map);
            writer.write_image_data(map.pixels())?;
        } else {
            writer.write_image_data(&rgb(&moment.picture(world, SCREEN).0))?;
        }
    }
    writer.finish()?;
    Ok(bytes)
}

fn animated_gif(world: &World, moments: &[Moment], go_on: &dyn Fn() -> bool) -> Result<Vec<u8>, FilmError> {
    use image::codecs::gif::{GifEncoder, Repeat};
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new_with_speed(&mut bytes, 10);
    encoder.set_repeat(Repeat::Infinite)?;
    let [width, height] = SCREEN.map(|side| side as u32);
    for moment in moments {
        if !go_on() {
            return Err(FilmError::Stopped);
        }
        let colors = moment.picture(world, SCREEN).0;
        let picture = image::RgbaImage::from_fn(width, height, |x, y| {
            let [_, r, g, b] = colors[(y * width + x) as usize].to_be_bytes();
            image::Rgba([r, g, b, 255])
        });
        let delay = image::Delay::from_numer_denom_ms(10 * u32::from(FILM_DELAY), 1);
        encoder.encode_frame(image::Frame::from_parts(picture, 0, 0, delay))?;
    }
    drop(encoder);
    Ok(bytes)
}

impl Moment {
    /// The picture as colour numbers: the reference's where that is shown, otherwise the library's.
    pub(crate) fn draw(&self, world: &World, map: &mut ColorMap) {
        if self.show == Show::Exact {
            draw_frame_exactly(world, &self.viewer, &self.stages, map);
        } else {
            draw_frame(world, &self.viewer, &self.stages, map);
        }
    }
}

/// Six pictures of a moment. Above: linear textures; as the stages say; the reference. Below: how far the first and the
/// second are from the reference, and how far the library is from it with an exact mapping at every pixel, which shows what
/// whole numbers alone do.
#[must_use]
pub fn sheet(world: &World, moment: &Moment) -> Canvas {
    let with = |mapping, show| Moment { stages: Stages { mapping, ..moment.stages }, show, ..*moment };
    let own = moment.stages.mapping;
    let panels = [
        with(Mapping::Affine, Show::Library),
        with(own, Show::Library),
        with(own, Show::Exact),
        with(Mapping::Affine, Show::Difference),
        with(own, Show::Difference),
        with(Mapping::Subdivided(1), Show::Difference),
    ];
    let mut canvas = Canvas::new(3 * SCREEN[0], 2 * SCREEN[1]);
    for (i, panel) in panels.iter().enumerate() {
        let (picture, _) = panel.picture(world, SCREEN);
        for (y, row) in picture.chunks_exact(SCREEN[0]).enumerate() {
            let start = (i / 3 * SCREEN[1] + y) * 3 * SCREEN[0] + i % 3 * SCREEN[0];
            canvas.pixels_mut()[start..start + SCREEN[0]].copy_from_slice(row);
        }
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::game::{Flight, Surface};
    use image::AnimationDecoder;

    fn moments(show: Show) -> (Flight, Vec<Moment>) {
        let flight = Flight::new(Stages { surface: Surface::Flat, ..Stages::default() }, show);
        let moments = vec![flight.now(); 3];
        (flight, moments)
    }

    #[test]
    fn films_keep_every_colour() {
        let (flight, moments) = moments(Show::Library);
        let expected = rgb(&moments[0].picture(flight.world(), SCREEN).0);
        let film = |format| film(flight.world(), &moments, format, &|| true).expect("a film");
        let gif = film(FilmFormat::Gif);
        let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(&gif)).expect("a GIF");
        let frames = decoder.into_frames().collect_frames().expect("pictures");
        assert_eq!(frames.len(), 3);
        let rgb: Vec<u8> = frames[2].buffer().pixels().flat_map(|p| p.0.into_iter().take(3)).collect();
        assert!(rgb == expected, "the colours of the GIF differ");
        let png = film(FilmFormat::Png);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().expect("a PNG");
        let control = reader.info().animation_control().copied().expect("an animation");
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut numbers = vec![0; reader.output_buffer_size().expect("small")];
        for _ in 0..3 {
            reader.next_frame(&mut numbers).expect("a picture");
        }
        let palette = flight.world().palette;
        let colors: Vec<u32> = numbers.iter().map(|&n| palette[usize::from(n)]).collect();
        assert!(super::rgb(&colors) == expected, "the colours of the PNG differ");
    }

    #[test]
    fn films_of_differences_and_none() {
        let (flight, moments) = moments(Show::Difference);
        let film = |moments, format, go_on| super::film(flight.world(), moments, format, go_on);
        assert!(film(&moments, FilmFormat::Png, &|| true).is_ok());
        assert!(film(&moments, FilmFormat::Gif, &|| true).is_ok());
        assert!(matches!(film(&[], FilmFormat::Png, &|| true), Err(FilmError::Empty)));
        let long = vec![moments[0]; LONGEST_FILM + 1];
        assert!(matches!(film(&long, FilmFormat::Gif, &|| true), Err(FilmError::TooLong(1501))));
        for format in [FilmFormat::Png, FilmFormat::Gif] {
            assert!(matches!(film(&moments, format, &|| false), Err(FilmError::Stopped)));
        }
        assert_eq!(FilmFormat::from_extension("GIF"), Some(FilmFormat::Gif));
        assert_eq!(FilmFormat::from_extension("jpg"), None);
    }

    #[test]
    fn the_sheet_has_six_pictures() {
        let (flight, moments) = moments(Show::Library);
        let canvas = sheet(flight.world(), &moments[0]);
        assert_eq!((canvas.width(), canvas.height()), (960, 400));
        assert_eq!(canvas.get(5, 5), canvas.get(325, 5), "flat faces have no mapping");
        assert_eq!(canvas.get(160, 205), Some(0), "the sky is the same");
    }
}
