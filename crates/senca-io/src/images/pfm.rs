//! Portable float maps: `PF` (colour) or `Pf` (grey), width, height, a scale whose sign tells the
//! byte order, then rows of 32-bit floats from the bottom up.

use senca_math::Image;

use crate::{Limits, Location, ReadError};

/// Whether the bytes begin like a portable float map.
pub(super) fn is_pfm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace())
}

/// The header's four words and where the floats begin.
struct Header {
    channels: usize,
    width: u32,
    height: u32,
    little_endian: bool,
    data_start: usize,
}

/// Width, height and linear texels of a portable float map. The size of the scale is passed over, as
/// it is by other readers; grey fills all three channels.
///
/// # Errors
/// When the header is broken, the picture is larger than `limits`, or the data too short.
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(u32, u32, Vec<[f32; 4]>), ReadError> {
    let header = header(name, bytes)?;
    super::decode::check_size(name, header.width, header.height, limits)?;
    let row_bytes = header.width as usize * header.channels * 4;
    let needed = row_bytes * header.height as usize;
    let data = &bytes[header.data_start..];
    if data.len() < needed {
        let message = format!(
            "{} x {} pixels take {needed} bytes, but only {} follow the header",
            header.width,
            header.height,
            data.len()
        );
        return Err(ReadError::malformed(Location::byte(name, bytes.len() as u64), message));
    }
    let rows = data[..needed].chunks_exact(row_bytes).rev();
    let texels =
        rows.flat_map(|row| row.chunks_exact(header.channels * 4)).map(|pixel| texel(pixel, &header));
    Ok((header.width, header.height, texels.collect()))
}

fn texel(pixel: &[u8], header: &Header) -> [f32; 4] {
    let component = |i: usize| {
        let bytes = [pixel[4 * i], pixel[4 * i + 1], pixel[4 * i + 2], pixel[4 * i + 3]];
        if header.little_endian { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) }
    };
    match header.channels {
        1 => [component(0), component(0), component(0), 1.0],
        _ => [component(0), component(1), component(2), 1.0],
    }
}

fn header(name: &str, bytes: &[u8]) -> Result<Header, ReadError> {
    let mut at = 2;
    let channels = if bytes[1] == b'F' { 3 } else { 1 };
    let width = word(name, bytes, &mut at, "width")?;
    let height = word(name, bytes, &mut at, "height")?;
    let scale: f64 = word(name, bytes, &mut at, "scale")?;
    if scale == 0.0 || !scale.is_finite() {
        let message = "the scale must be a number other than 0; its sign tells the byte order";
        return Err(ReadError::malformed(Location::byte(name, at as u64), message));
    }
    // Exactly one white-space byte ends the header; a carriage return may come before it.
    at += usize::from(bytes.get(at) == Some(&b'\r') && bytes.get(at + 1) == Some(&b'\n'));
    Ok(Header { channels, width, height, little_endian: scale < 0.0, data_start: (at + 1).min(bytes.len()) })
}

/// The next word of the header as a number; `at` is moved behind it.
fn word<T: std::str::FromStr>(name: &str, bytes: &[u8], at: &mut usize, what: &str) -> Result<T, ReadError> {
    let rest = &bytes[*at..];
    let begin = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
    let length = rest[begin..].iter().take(64).position(u8::is_ascii_whitespace).unwrap_or(0);
    let text = str::from_utf8(&rest[begin..begin + length]).ok().and_then(|text| text.parse().ok());
    let place = Location::byte(name, (*at + begin) as u64);
    *at += begin + length;
    text.ok_or_else(|| ReadError::malformed(place, format!("the header's {what} should be here")))
}

/// `image` over black as a little-endian colour map.
pub(super) fn encode(image: &Image) -> Vec<u8> {
    let header = format!("PF\n{} {}\n-1.0\n", image.width(), image.height());
    let mut bytes = Vec::with_capacity(header.len() + image.pixels().len() * 12);
    bytes.extend_from_slice(header.as_bytes());
    for y in (0..image.height()).rev() {
        for &pixel in image.row(y) {
            let [r, g, b] = super::encode::over_black(pixel);
            bytes.extend([r, g, b].into_iter().flat_map(f32::to_le_bytes));
        }
    }
    bytes
}
