//! Rows of pixels out of client memory.

use super::convert::{self, unit};
use super::{ImageSpan, PixelFormat, PixelLayout, PixelStore, PixelType, Transfer, unorm8_from_f32};

/// Pixels converted at a time: small enough for the stack and the first cache.
pub(super) const BATCH: usize = 128;

/// An image in client memory, to be read row by row.
///
/// Rows are asked for by image of the volume, row and first pixel, each counted from the origin of the image;
/// as many pixels are read as the output has room for.
#[derive(Clone, Copy, Debug)]
pub struct PixelSource<'a> {
    bytes: &'a [u8],
    layout: PixelLayout,
    span: ImageSpan,
    swap: bool,
    lsb_first: bool,
    size: [u32; 3],
}

impl<'a> PixelSource<'a> {
    /// Image of `size` (width, height, depth) that lies in `bytes` as `store` says; `volume` as for
    /// [`PixelStore::span`]. `None` if the bytes do not suffice.
    #[must_use]
    pub fn new(
        bytes: &'a [u8],
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

    /// Bytes of `n` pixels of a row from pixel `x`; not for bitmaps.
    fn run(&self, z: usize, y: usize, x: usize, n: usize) -> &'a [u8] {
        let pixel = self.layout.pixel_bits() / 8;
        let begin = self.span.row_offset(z, y) + x * pixel;
        &self.bytes[begin..begin + n * pixel]
    }

    /// Colours of pixels after the transfer, in [0, 1].
    ///
    /// Without sense for depths and stencil values, which give black.
    pub fn colors(&self, z: usize, y: usize, x: usize, transfer: &Transfer<'_>, out: &mut [[f32; 4]]) {
        for (i, out) in out.chunks_mut(BATCH).enumerate() {
            let x = x + i * BATCH;
            if self.layout.format() == PixelFormat::ColorIndex {
                let mut indices = [0; BATCH];
                let indices = &mut indices[..out.len()];
                self.indices(z, y, x, indices);
                transfer.colors_from_indices(indices, out);
            } else {
                self.raw_colors(z, y, x, out);
                transfer.colors(out);
            }
        }
    }

    /// Colours of at most [`BATCH`] pixels as they lie in memory.
    fn raw_colors(&self, z: usize, y: usize, x: usize, out: &mut [[f32; 4]]) {
        let (format, ty) = (self.layout.format(), self.layout.ty());
        let n = format.components();
        let mut values = [0.0; 4 * BATCH];
        let values = &mut values[..n * out.len()];
        let bytes = self.run(z, y, x, out.len());
        if ty.fields().is_some() {
            convert::packed_values(ty, bytes, self.swap, values);
        } else {
            convert::values(ty, bytes, self.swap, values);
        }
        for (color, pixel) in out.iter_mut().zip(values.chunks_exact(n)) {
            *color = [0.0, 0.0, 0.0, 1.0];
            for (&channel, value) in format.channels().iter().zip(pixel) {
                color[channel] = *value;
            }
            if matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha) {
                color[1] = color[0];
                color[2] = color[0];
            }
        }
    }

    /// Colours of pixels after the transfer in 8 bits: what [`colors`](Self::colors) gives, rounded.
    pub fn colors8(&self, z: usize, y: usize, x: usize, transfer: &Transfer<'_>, out: &mut [[u8; 4]]) {
        if let Some(order) = self.layout.byte_order(self.swap).filter(|_| transfer.keeps_colors()) {
            order.read(self.run(z, y, x, out.len()), out);
        } else {
            self.colors8_plain(z, y, x, transfer, out);
        }
    }

    /// [`colors8`](Self::colors8) for any layout and transfer.
    pub(super) fn colors8_plain(
        &self,
        z: usize,
        y: usize,
        x: usize,
        transfer: &Transfer<'_>,
        out: &mut [[u8; 4]],
    ) {
        for (i, out) in out.chunks_mut(BATCH).enumerate() {
            let mut colors = [[0.0; 4]; BATCH];
            let colors = &mut colors[..out.len()];
            self.colors(z, y, x + i * BATCH, transfer, colors);
            for (out, color) in out.iter_mut().zip(colors) {
                *out = color.map(unorm8_from_f32);
            }
        }
    }

    /// Depths of pixels after the transfer, in [0, 1]. Of depths with stencil values, the depths.
    pub fn depths(&self, z: usize, y: usize, x: usize, transfer: &Transfer<'_>, out: &mut [f32]) {
        let bytes = self.run(z, y, x, out.len());
        let ty = self.layout.ty();
        if ty.is_depth_stencil() {
            convert::depth_stencils(ty, bytes, self.swap, |i, depth, _| out[i] = depth);
        } else {
            convert::values(ty, bytes, self.swap, out);
        }
        if transfer.keeps_depths() {
            out.iter_mut().for_each(|depth| *depth = unit(*depth));
        } else {
            transfer.depths(out);
        }
    }

    /// Stencil values of pixels after the transfer, their lower 8 bits.
    pub fn stencils(&self, z: usize, y: usize, x: usize, transfer: &Transfer<'_>, out: &mut [u8]) {
        for (i, out) in out.chunks_mut(BATCH).enumerate() {
            let mut stencils = [0; BATCH];
            let stencils = &mut stencils[..out.len()];
            self.indices(z, y, x + i * BATCH, stencils);
            if !transfer.keeps_stencils() {
                transfer.stencils(stencils);
            }
            for (out, stencil) in out.iter_mut().zip(stencils) {
                *out = *stencil as u8;
            }
        }
    }

    /// Indices of pixels as they lie in memory, of colours or stencil values.
    pub fn indices(&self, z: usize, y: usize, x: usize, out: &mut [u32]) {
        let ty = self.layout.ty();
        if ty == PixelType::Bitmap {
            let row = &self.bytes[self.span.row_offset(z, y)..];
            convert::bits(row, self.span.first_bit + x, self.lsb_first, out);
        } else if ty.is_depth_stencil() {
            let bytes = self.run(z, y, x, out.len());
            convert::depth_stencils(ty, bytes, self.swap, |i, _, stencil| out[i] = u32::from(stencil));
        } else {
            convert::indices(ty, self.run(z, y, x, out.len()), self.swap, out);
        }
    }

    /// The image as bytes without gaps, in the order of bytes and bits of this machine: what
    /// [`PixelStore::TIGHT`] describes. Display lists keep images so. `None` if memory does not suffice.
    #[must_use]
    pub fn to_tight(&self) -> Option<Vec<u8>> {
        let [width, height, depth] = self.size.map(|side| side as usize);
        let row_bytes = (width * self.layout.pixel_bits()).div_ceil(8);
        let total = row_bytes.checked_mul(height)?.checked_mul(depth)?;
        let mut tight = Vec::new();
        tight.try_reserve_exact(total).ok()?;
        for row in 0..height * depth {
            self.append_row(row / height, row % height, &mut tight);
        }
        Some(tight)
    }

    fn append_row(&self, z: usize, y: usize, tight: &mut Vec<u8>) {
        let width = self.size[0] as usize;
        let begin = tight.len();
        if self.layout.ty() == PixelType::Bitmap {
            tight.resize(begin + width.div_ceil(8), 0);
            for x in 0..width {
                let mut bit = [0];
                self.indices(z, y, x, &mut bit);
                convert::put_bits(&mut tight[begin..], x, false, &bit);
            }
            return;
        }
        tight.extend_from_slice(self.run(z, y, 0, width));
        if self.swap {
            let word = self.layout.ty().word_bytes();
            tight[begin..].chunks_exact_mut(word).for_each(<[u8]>::reverse);
        }
    }
}

/// Pixels of bytes: the byte each channel is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    /// Red, green, blue, alpha.
    Rgba,
    /// Blue, green, red, alpha.
    Bgra,
    /// Alpha, blue, green, red.
    Abgr,
    /// Alpha, red, green, blue.
    Argb,
    /// Red, green, blue.
    Rgb,
    /// Blue, green, red.
    Bgr,
    /// Luminance.
    Luminance,
    /// Luminance, alpha.
    LuminanceAlpha,
    /// Alpha.
    Alpha,
}

impl PixelLayout {
    /// Order of the bytes of a colour layout of one byte per component; `None` for other layouts.
    pub(super) fn byte_order(self, swap: bool) -> Option<ByteOrder> {
        let turned = match self.ty() {
            PixelType::U8 => false,
            PixelType::U32x8888 => cfg!(target_endian = "little") != swap,
            PixelType::U32x8888Rev => cfg!(target_endian = "big") != swap,
            _ => return None,
        };
        Some(match (self.format(), turned) {
            (PixelFormat::Rgba, false) | (PixelFormat::Abgr, true) => ByteOrder::Rgba,
            (PixelFormat::Bgra, false) => ByteOrder::Bgra,
            (PixelFormat::Rgba, true) | (PixelFormat::Abgr, false) => ByteOrder::Abgr,
            (PixelFormat::Bgra, true) => ByteOrder::Argb,
            (PixelFormat::Rgb, _) => ByteOrder::Rgb,
            (PixelFormat::Bgr, _) => ByteOrder::Bgr,
            (PixelFormat::Luminance, _) => ByteOrder::Luminance,
            (PixelFormat::LuminanceAlpha, _) => ByteOrder::LuminanceAlpha,
            (PixelFormat::Alpha, _) => ByteOrder::Alpha,
            _ => return None,
        })
    }
}

/// Turns pixels of `N` bytes into colours.
fn each<const N: usize>(bytes: &[u8], out: &mut [[u8; 4]], color: impl Fn([u8; N]) -> [u8; 4]) {
    for (out, &pixel) in out.iter_mut().zip(bytes.as_chunks::<N>().0) {
        *out = color(pixel);
    }
}

impl ByteOrder {
    fn read(self, bytes: &[u8], out: &mut [[u8; 4]]) {
        match self {
            Self::Rgba => out.as_flattened_mut().copy_from_slice(bytes),
            Self::Bgra => each(bytes, out, |[b, g, r, a]| [r, g, b, a]),
            Self::Abgr => each(bytes, out, |[a, b, g, r]| [r, g, b, a]),
            Self::Argb => each(bytes, out, |[a, r, g, b]| [r, g, b, a]),
            Self::Rgb => each(bytes, out, |[r, g, b]| [r, g, b, 255]),
            Self::Bgr => each(bytes, out, |[b, g, r]| [r, g, b, 255]),
            Self::Luminance => each(bytes, out, |[l]| [l, l, l, 255]),
            Self::LuminanceAlpha => each(bytes, out, |[l, a]| [l, l, l, a]),
            Self::Alpha => each(bytes, out, |[a]| [0, 0, 0, a]),
        }
    }
}
