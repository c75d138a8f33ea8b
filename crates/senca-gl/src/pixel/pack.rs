//! Rows of pixels into client memory.

use rayon::prelude::*;

use super::convert::{self, unit};
use super::unpack::{BATCH, ByteOrder};
use super::{ImageSpan, PixelFormat, PixelLayout, PixelStore, PixelType};

/// Bytes of an image from which on its rows are written on all threads.
const PARALLEL_BYTES: usize = 1 << 19;

/// Bytes that a thread writes at a time.
const BAND_BYTES: usize = 1 << 17;

/// An image in client memory, to be written row by row. Bytes between its rows stay as they are.
#[derive(Debug)]
pub struct PixelSink<'a> {
    bytes: &'a mut [u8],
    layout: PixelLayout,
    span: ImageSpan,
    swap: bool,
    lsb_first: bool,
    size: [u32; 3],
}

/// A row of a [`PixelSink`]. What is put is numbers as they shall stand there, after the pixel transfer; colours
/// and depths are clamped to [0, 1].
#[derive(Debug)]
pub struct RowSink<'a> {
    /// From the first byte of the row on, at least to its last.
    bytes: &'a mut [u8],
    layout: PixelLayout,
    first_bit: usize,
    swap: bool,
    lsb_first: bool,
}

impl<'a> PixelSink<'a> {
    /// Image of `size` (width, height, depth) that is to lie in `bytes` as `store` says; `volume` as for
    /// [`PixelStore::span`]. `None` if the bytes do not suffice.
    #[must_use]
    pub fn new(
        bytes: &'a mut [u8],
        store: &PixelStore,
        layout: PixelLayout,
        size: [u32; 3],
        volume: bool,
    ) -> Option<Self> {
        let span = store.span(layout, size, volume)?;
        if span.bytes > bytes.len() {
            return None;
        }
        Some(Self { bytes, layout, span, swap: store.swap_bytes, lsb_first: store.lsb_first, size })
    }

    /// Width, height and depth.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Format and type.
    #[must_use]
    pub fn layout(&self) -> PixelLayout {
        self.layout
    }

    /// A row to write to.
    #[must_use]
    pub fn row(&mut self, z: usize, y: usize) -> RowSink<'_> {
        let begin = self.span.row_offset(z, y);
        RowSink {
            bytes: &mut self.bytes[begin..begin + self.span.row_bytes],
            layout: self.layout,
            first_bit: self.span.first_bit,
            swap: self.swap,
            lsb_first: self.lsb_first,
        }
    }

    /// Calls `write` with each of the rows `rows` of image `z`, on all threads if there is enough to do.
    pub fn each_row(
        &mut self,
        z: usize,
        rows: std::ops::Range<usize>,
        write: impl Fn(usize, RowSink<'_>) + Sync,
    ) {
        let stride = self.span.row_stride;
        let apart = stride >= self.span.row_bytes && stride > 0;
        if !apart || rows.len() * self.span.row_bytes < PARALLEL_BYTES {
            for y in rows {
                write(y, self.row(z, y));
            }
            return;
        }
        let begin = self.span.row_offset(z, rows.start);
        let end = self.span.row_offset(z, rows.end - 1) + self.span.row_bytes;
        let (layout, first_bit) = (self.layout, self.span.first_bit);
        let (swap, lsb_first, row_bytes) = (self.swap, self.lsb_first, self.span.row_bytes);
        let band_rows = (BAND_BYTES / stride).max(1);
        self.bytes[begin..end].par_chunks_mut(band_rows * stride).enumerate().for_each(|(band, bytes)| {
            for (i, bytes) in bytes.chunks_mut(stride).enumerate() {
                let bytes = &mut bytes[..row_bytes];
                let row = RowSink { bytes, layout, first_bit, swap, lsb_first };
                write(rows.start + band * band_rows + i, row);
            }
        });
    }
}

impl RowSink<'_> {
    /// Bytes of `n` pixels from pixel `x`; not for bitmaps.
    fn run(&mut self, x: usize, n: usize) -> &mut [u8] {
        let pixel = self.layout.pixel_bits() / 8;
        &mut self.bytes[x * pixel..(x + n) * pixel]
    }

    /// Bytes of the row, of the pixels skipped before it only those that share a byte with it.
    #[must_use]
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        self.bytes
    }

    /// Puts colours from pixel `x` on. Luminance is the sum of red, green and blue.
    pub fn put_colors(&mut self, x: usize, colors: &[[f32; 4]]) {
        let (format, ty, swap) = (self.layout.format(), self.layout.ty(), self.swap);
        let n = format.components();
        for (i, colors) in colors.chunks(BATCH).enumerate() {
            let mut values = [0.0; 4 * BATCH];
            let values = &mut values[..n * colors.len()];
            for (pixel, color) in values.chunks_exact_mut(n).zip(colors) {
                components(format, color.map(unit), pixel);
            }
            let bytes = self.run(x + i * BATCH, colors.len());
            if ty.fields().is_some() {
                convert::put_packed_values(ty, values, swap, bytes);
            } else {
                convert::put_values(ty, values, swap, bytes);
            }
        }
    }

    /// Puts colours of 8 bits from pixel `x` on.
    pub fn put_colors8(&mut self, x: usize, colors: &[[u8; 4]]) {
        if let Some(order) = self.layout.byte_order(self.swap) {
            order.write(colors, self.run(x, colors.len()));
        } else {
            self.put_colors8_plain(x, colors);
        }
    }

    /// [`put_colors8`](Self::put_colors8) for any layout.
    pub(super) fn put_colors8_plain(&mut self, x: usize, colors: &[[u8; 4]]) {
        for (i, colors) in colors.chunks(BATCH).enumerate() {
            let mut values = [[0.0; 4]; BATCH];
            for (value, color) in values.iter_mut().zip(colors) {
                *value = color.map(|c| f32::from(c) / 255.0);
            }
            self.put_colors(x + i * BATCH, &values[..colors.len()]);
        }
    }

    /// Puts depths from pixel `x` on; a stencil value beside them becomes 0.
    pub fn put_depths(&mut self, x: usize, depths: &[f32]) {
        for (i, depths) in depths.chunks(BATCH).enumerate() {
            let mut values = [0.0; BATCH];
            let values = &mut values[..depths.len()];
            for (value, depth) in values.iter_mut().zip(depths) {
                *value = unit(*depth);
            }
            let (ty, swap) = (self.layout.ty(), self.swap);
            let bytes = self.run(x + i * BATCH, depths.len());
            if ty.is_depth_stencil() {
                convert::put_depth_stencils(ty, values, &[0; BATCH], swap, bytes);
            } else {
                convert::put_values(ty, values, swap, bytes);
            }
        }
    }

    /// Puts indices from pixel `x` on, of colours or stencil values.
    pub fn put_indices(&mut self, x: usize, indices: &[u32]) {
        let (ty, swap) = (self.layout.ty(), self.swap);
        if ty == PixelType::Bitmap {
            convert::put_bits(self.bytes, self.first_bit + x, self.lsb_first, indices);
        } else {
            convert::put_indices(ty, indices, swap, self.run(x, indices.len()));
        }
    }

    /// Puts depths with stencil values from pixel `x` on, into a layout of both.
    pub fn put_depth_stencils(&mut self, x: usize, depths: &[f32], stencils: &[u8]) {
        let (ty, swap) = (self.layout.ty(), self.swap);
        convert::put_depth_stencils(ty, depths, stencils, swap, self.run(x, depths.len()));
    }
}

/// Components of a colour in the order of a format.
fn components(format: PixelFormat, color: [f32; 4], pixel: &mut [f32]) {
    for (value, &channel) in pixel.iter_mut().zip(format.channels()) {
        *value = color[channel];
    }
    if matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha) {
        pixel[0] = unit(color[0] + color[1] + color[2]);
    }
}

/// Turns colours into pixels of `N` bytes.
fn each<const N: usize>(colors: &[[u8; 4]], bytes: &mut [u8], pixel: impl Fn([u8; 4]) -> [u8; N]) {
    for (out, &color) in bytes.as_chunks_mut::<N>().0.iter_mut().zip(colors) {
        *out = pixel(color);
    }
}

fn luminance([r, g, b, _]: [u8; 4]) -> u8 {
    r.saturating_add(g).saturating_add(b)
}

impl ByteOrder {
    fn write(self, colors: &[[u8; 4]], bytes: &mut [u8]) {
        match self {
            Self::Rgba => bytes.copy_from_slice(colors.as_flattened()),
            Self::Bgra => each(colors, bytes, |[r, g, b, a]| [b, g, r, a]),
            Self::Abgr => each(colors, bytes, |[r, g, b, a]| [a, b, g, r]),
            Self::Argb => each(colors, bytes, |[r, g, b, a]| [a, r, g, b]),
            Self::Rgb => each(colors, bytes, |[r, g, b, _]| [r, g, b]),
            Self::Bgr => each(colors, bytes, |[r, g, b, _]| [b, g, r]),
            Self::Luminance => each(colors, bytes, |color| [luminance(color)]),
            Self::LuminanceAlpha => each(colors, bytes, |color| [luminance(color), color[3]]),
            Self::Alpha => each(colors, bytes, |[_, _, _, a]| [a]),
        }
    }
}
