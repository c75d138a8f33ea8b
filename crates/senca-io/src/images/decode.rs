//! From a file's bytes to texels.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use senca_math::color::linear_from_srgb;
use senca_math::{Image, LinearRgb, Srgb8};
use senca_scene::{ColorSpace, ImageData};

use super::pfm;
use crate::{Limits, Location, ReadError};

/// Texels of the picture file `bytes`; `name` is used in messages.
///
/// Pictures of 8 bits or fewer a channel give [`ImageData::Rgba8`] with the bytes as stored. Deeper
/// ones give [`ImageData::RgbaF32`] in linear light: 16-bit files are taken to hold sRGB encoded
/// colour, float files linear light. Alpha is not multiplied in. Use [`decode_as`] where the picture
/// holds data such as normals.
///
/// # Errors
/// When the content is broken, of an unknown kind, or larger than `limits`.
pub fn decode(name: &str, bytes: &[u8], limits: &Limits) -> Result<ImageData, ReadError> {
    decode_as(name, bytes, limits, ColorSpace::Srgb)
}

/// Like [`decode`]; with [`ColorSpace::Linear`] the numbers of 16-bit files are kept as they are,
/// scaled to [0, 1].
///
/// # Errors
/// When the content is broken, of an unknown kind, or larger than `limits`.
pub fn decode_as(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
    space: ColorSpace,
) -> Result<ImageData, ReadError> {
    if pfm::is_pfm(bytes) {
        let (width, height, texels) = pfm::decode(name, bytes, limits)?;
        return Ok(ImageData::RgbaF32 { width, height, texels });
    }
    let format = format_of(name, bytes)?;
    let picture = open(name, bytes, format, limits)?;
    Ok(texels(picture, format, space))
}

/// The picture file `bytes` as a picture in linear light; 8- and 16-bit colour is decoded from sRGB.
///
/// # Errors
/// As [`decode`], and when a side is longer than [`Image::MAX_SIDE`].
pub fn decode_picture(name: &str, bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    let data = decode(name, bytes, limits)?;
    let (width, height) = data.size();
    if width.max(height) > Image::MAX_SIDE {
        let message = format!("is {width} x {height} pixels; the longest side is {}", Image::MAX_SIDE);
        return Err(ReadError::limit(Location::file(name), message));
    }
    let pixels = match data {
        ImageData::Rgba8 { texels, .. } => linear_pixels(&texels),
        ImageData::RgbaF32 { texels, .. } => texels,
    };
    Image::from_pixels(width, height, pixels)
        .ok_or_else(|| ReadError::malformed(Location::file(name), "has too few pixels"))
}

fn linear_pixels(texels: &[[u8; 4]]) -> Vec<[f32; 4]> {
    let linear: [f32; 256] = std::array::from_fn(|v| {
        let LinearRgb { r, .. } = Srgb8 { r: v as u8, g: 0, b: 0 }.to_linear();
        r
    });
    let of = |v: u8| linear[usize::from(v)];
    texels.iter().map(|&[r, g, b, a]| [of(r), of(g), of(b), f32::from(a) / 255.0]).collect()
}

fn format_of(name: &str, bytes: &[u8]) -> Result<ImageFormat, ReadError> {
    let is_tga = || name.len() >= 4 && name.as_bytes()[name.len() - 4..].eq_ignore_ascii_case(b".tga");
    match image::guess_format(bytes) {
        Ok(format) => Ok(format),
        Err(_) if is_tga() => Ok(ImageFormat::Tga),
        Err(_) if bytes.is_empty() => Err(ReadError::malformed(Location::file(name), "is empty")),
        Err(_) => {
            let message = "is not a picture of a known kind (PNG, JPEG, BMP, PPM, TGA, GIF, WebP, \
                           OpenEXR, Radiance HDR, PFM)";
            Err(ReadError::unsupported(Location::file(name), message))
        }
    }
}

/// Refuses pictures without pixels and those above the limit.
pub(super) fn check_size(name: &str, width: u32, height: u32, limits: &Limits) -> Result<(), ReadError> {
    let texels = u64::from(width) * u64::from(height);
    if texels == 0 {
        let message = format!("is {width} x {height} pixels: there is no pixel");
        return Err(ReadError::malformed(Location::file(name), message));
    }
    if texels > limits.image_texels {
        let message = format!(
            "is {width} x {height} pixels, more than the limit of {} pixels in all",
            limits.image_texels
        );
        return Err(ReadError::limit(Location::file(name), message));
    }
    Ok(())
}

/// Decodes after the header has been held against the limits.
fn open(name: &str, bytes: &[u8], format: ImageFormat, limits: &Limits) -> Result<DynamicImage, ReadError> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // Decoders may need a few copies of the widest texel besides the picture itself.
    let mut inner = image::Limits::default();
    inner.max_alloc = Some(limits.image_texels.saturating_mul(32).saturating_add(1 << 24));
    reader.limits(inner);
    let decoder = reader.into_decoder().map_err(|error| read_error(name, &error))?;
    let (width, height) = decoder.dimensions();
    check_size(name, width, height, limits)?;
    check_deflate_ratio(name, bytes, format, &decoder)?;
    DynamicImage::from_decoder(decoder).map_err(|error| read_error(name, &error))
}

/// Refuses a PNG that is too short for its size before its pixels are allocated: deflate packs at
/// most 1032 bytes into one, and a byte holds at most 8 texels.
fn check_deflate_ratio(
    name: &str,
    bytes: &[u8],
    format: ImageFormat,
    decoder: &impl ImageDecoder,
) -> Result<(), ReadError> {
    let (width, height) = decoder.dimensions();
    let most = bytes.len() as u64 * 1032 * 8;
    if format == ImageFormat::Png && u64::from(width) * u64::from(height) > most {
        let message = format!("is {width} x {height} pixels, but its {} bytes cannot hold them", bytes.len());
        return Err(ReadError::malformed(Location::file(name), message));
    }
    Ok(())
}

fn read_error(name: &str, error: &ImageError) -> ReadError {
    let at = Location::file(name);
    match error {
        ImageError::Limits(limit) => ReadError::limit(at, format!("takes too much memory: {limit}")),
        ImageError::Unsupported(what) => ReadError::unsupported(at, what.to_string()),
        other => ReadError::malformed(at, format!("is damaged: {other}")),
    }
}

fn texels(picture: DynamicImage, format: ImageFormat, space: ColorSpace) -> ImageData {
    let (width, height) = (picture.width(), picture.height());
    match picture.color() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            let texels = picture.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
            ImageData::Rgba8 { width, height, texels }
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let mut texels = picture.into_rgba32f().into_raw().as_chunks::<4>().0.to_vec();
            if format == ImageFormat::OpenExr {
                texels.iter_mut().for_each(divide_by_alpha);
            }
            ImageData::RgbaF32 { width, height, texels }
        }
        _ => {
            let stored = picture.into_rgba16();
            let texels = stored.as_raw().as_chunks::<4>().0.iter().map(|&t| deep_texel(t, space));
            ImageData::RgbaF32 { width, height, texels: texels.collect() }
        }
    }
}

fn deep_texel([r, g, b, a]: [u16; 4], space: ColorSpace) -> [f32; 4] {
    let scaled = |v: u16| f32::from(v) / 65535.0;
    let color = |v: u16| match space {
        ColorSpace::Srgb => linear_from_srgb(scaled(v)),
        ColorSpace::Linear => scaled(v),
    };
    [color(r), color(g), color(b), scaled(a)]
}

/// OpenEXR stores colour with alpha multiplied in. Where alpha is 0 the colour is light without
/// cover and stays.
fn divide_by_alpha(texel: &mut [f32; 4]) {
    let [r, g, b, a] = *texel;
    if a > 0.0 && a != 1.0 {
        *texel = [r / a, g / a, b / a, a];
    }
}
