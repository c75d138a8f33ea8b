//! From a rendered picture to a file's bytes.

use std::io::Cursor;
use std::path::Path;

use image::codecs::bmp::BmpEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::openexr::OpenExrEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use rayon::prelude::*;
use senca_math::{Image, SrgbTable};

use super::pfm;
use crate::WriteError;

/// File formats that pictures are written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureFormat {
    /// Portable network graphics, 8 bits a channel, sRGB; with alpha unless every pixel is opaque.
    #[default]
    Png,
    /// OpenEXR: linear 32-bit floats, alpha multiplied in; with alpha unless every pixel is opaque.
    Exr,
    /// Portable float map: linear 32-bit floats, no alpha.
    Pfm,
    /// Portable pixel map, 8 bits a channel, sRGB, no alpha.
    Ppm,
    /// JPEG: lossy, sRGB, no alpha, sides up to 65535.
    Jpeg,
    /// Windows bitmap, 8 bits a channel, sRGB, no alpha.
    Bmp,
}

impl PictureFormat {
    /// Every format, in the order of the messages that list them.
    pub const ALL: [Self; 6] = [Self::Png, Self::Exr, Self::Pfm, Self::Ppm, Self::Jpeg, Self::Bmp];

    /// The format of a file name's extension, in either case, with or without its dot; `None` when
    /// it is not a picture's.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        let extension = extension.strip_prefix('.').unwrap_or(extension).to_ascii_lowercase();
        Some(match extension.as_str() {
            "png" => Self::Png,
            "exr" => Self::Exr,
            "pfm" => Self::Pfm,
            "ppm" | "pnm" => Self::Ppm,
            "jpg" | "jpeg" | "jpe" => Self::Jpeg,
            "bmp" | "dib" => Self::Bmp,
            _ => return None,
        })
    }

    /// The format of a path's extension.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::from_extension(path.extension()?.to_str()?)
    }

    /// The usual extension, without a dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Pfm => "pfm",
            Self::Ppm => "ppm",
            Self::Jpeg => "jpg",
            Self::Bmp => "bmp",
        }
    }
}

/// How hard a PNG is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PngCompression {
    /// A few milliseconds a megapixel.
    #[default]
    Fast,
    /// Several times slower, often half the size.
    Small,
}

/// Settings of [`encode`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureOptions {
    /// Quality of JPEG, 1 (small) to 100 (fine); values outside are clamped. Default 90.
    pub jpeg_quality: u8,
    /// Packing of PNG. Default [`PngCompression::Fast`].
    pub png_compression: PngCompression,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { jpeg_quality: 90, png_compression: PngCompression::Fast }
    }
}

/// `image` as a file of `format`.
///
/// A NaN component is written as 0. 8-bit formats clamp light to [0, 1] and encode it as
/// [`LinearRgb::to_srgb8`](senca_math::LinearRgb::to_srgb8) does; formats without alpha show the
/// picture over black.
///
/// # Errors
/// When the picture has no pixels or is larger than the format can say.
pub fn encode(image: &Image, format: PictureFormat, options: &PictureOptions) -> Result<Vec<u8>, WriteError> {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        let message = format!("a picture of {width} x {height} pixels cannot be written: there is no pixel");
        return Err(WriteError::Unsupported { message });
    }
    match format {
        PictureFormat::Png => png(image, options.png_compression),
        PictureFormat::Exr => exr(image),
        PictureFormat::Pfm => Ok(pfm::encode(image)),
        PictureFormat::Ppm => Ok(ppm(image)),
        PictureFormat::Jpeg => jpeg(image, options.jpeg_quality),
        PictureFormat::Bmp => bmp(image),
    }
}

/// Colour of a pixel seen in front of black, NaN as 0.
pub(super) fn over_black([r, g, b, a]: [f32; 4]) -> [f32; 3] {
    let a = without_nan(a).clamp(0.0, 1.0);
    [r, g, b].map(|v| without_nan(v) * a)
}

fn without_nan(v: f32) -> f32 {
    if v.is_nan() { 0.0 } else { v }
}

fn is_opaque(image: &Image) -> bool {
    image.pixels().par_iter().all(|&[.., a]| a >= 1.0)
}

/// 8-bit alpha, clamped to [0, 1], NaN as 0.
fn encode_alpha(a: f32) -> u8 {
    (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Encodes every pixel to `N` bytes, rows shared among threads.
fn encode_pixels<const N: usize>(image: &Image, encode: impl Fn([f32; 4]) -> [u8; N] + Sync) -> Vec<u8> {
    let mut bytes = vec![0; image.pixels().len() * N];
    let width = image.width() as usize;
    let rows = bytes.par_chunks_exact_mut(width * N).zip(image.pixels().par_chunks_exact(width));
    rows.with_min_len(16).for_each(|(encoded, row)| {
        for (bytes, &pixel) in encoded.as_chunks_mut::<N>().0.iter_mut().zip(row) {
            *bytes = encode(pixel);
        }
    });
    bytes
}

/// sRGB bytes over black.
fn rgb8(image: &Image) -> Vec<u8> {
    let table = SrgbTable::get();
    encode_pixels(image, |pixel| over_black(pixel).map(|v| table.encode(v)))
}

fn png(image: &Image, compression: PngCompression) -> Result<Vec<u8>, WriteError> {
    let table = SrgbTable::get();
    let (color, bytes) = if is_opaque(image) {
        let bytes = encode_pixels(image, |[r, g, b, _]| [r, g, b].map(|v| table.encode(v)));
        (png::ColorType::Rgb, bytes)
    } else {
        let rgba =
            |[r, g, b, a]: [f32; 4]| [table.encode(r), table.encode(g), table.encode(b), encode_alpha(a)];
        (png::ColorType::Rgba, encode_pixels(image, rgba))
    };
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, image.width(), image.height());
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    match compression {
        PngCompression::Fast => encoder.set_compression(png::Compression::Fastest),
        PngCompression::Small => encoder.set_compression(png::Compression::Balanced),
    }
    let failed = |error: png::EncodingError| WriteError::Encode { message: format!("PNG: {error}") };
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&bytes).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(out)
}

fn exr(image: &Image) -> Result<Vec<u8>, WriteError> {
    let (color, bytes) = if is_opaque(image) {
        let rgb = |pixel| bytes_of(over_black(pixel));
        (ExtendedColorType::Rgb32F, encode_pixels::<12>(image, rgb))
    } else {
        let rgba = |pixel: [f32; 4]| {
            let [r, g, b] = over_black(pixel);
            bytes_of([r, g, b, without_nan(pixel[3]).clamp(0.0, 1.0)])
        };
        (ExtendedColorType::Rgba32F, encode_pixels::<16>(image, rgba))
    };
    let mut out = Cursor::new(Vec::new());
    let encoder = OpenExrEncoder::new(&mut out);
    encoder.write_image(&bytes, image.width(), image.height(), color).map_err(|e| encode_error("EXR", &e))?;
    Ok(out.into_inner())
}

/// The floats in the machine's own byte order, as the encoder wants them.
fn bytes_of<const N: usize, const BYTES: usize>(floats: [f32; N]) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    for (four, float) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(floats) {
        *four = float.to_ne_bytes();
    }
    bytes
}

fn ppm(image: &Image) -> Vec<u8> {
    let mut bytes = format!("P6\n{} {}\n255\n", image.width(), image.height()).into_bytes();
    bytes.append(&mut rgb8(image));
    bytes
}

fn jpeg(image: &Image, quality: u8) -> Result<Vec<u8>, WriteError> {
    let (width, height) = (image.width(), image.height());
    if width.max(height) > u32::from(u16::MAX) {
        let message =
            format!("JPEG pictures are at most 65535 wide and high, not {width} x {height}; write PNG");
        return Err(WriteError::Unsupported { message });
    }
    let mut out = Vec::new();
    JpegEncoder::new_with_quality(&mut out, quality.clamp(1, 100))
        .write_image(&rgb8(image), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| encode_error("JPEG", &error))?;
    Ok(out)
}

fn bmp(image: &Image) -> Result<Vec<u8>, WriteError> {
    let mut out = Vec::new();
    BmpEncoder::new(&mut out)
        .write_image(&rgb8(image), image.width(), image.height(), ExtendedColorType::Rgb8)
        .map_err(|error| encode_error("BMP", &error))?;
    Ok(out)
}

fn encode_error(format: &str, error: &ImageError) -> WriteError {
    WriteError::Encode { message: format!("{format}: {error}") }
}
