//! One level of one face of a texture, and how pixels get in and out.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::{BaseFormat, InternalFormat, Texels};
use crate::error::Error;
use crate::pixel::{PixelFormat, PixelLayout, PixelSink, PixelSource, Transfer, unorm8_from_f32};

/// Texels from which on rows are converted on all threads.
const PARALLEL_TEXELS: usize = 1 << 17;

/// Texels that a thread converts at a time.
const BAND_TEXELS: usize = 1 << 15;

/// Texels converted at a time on the stack.
const BATCH: usize = 128;

/// An image of a texture. A missing image has no texels and sizes of 0.
#[derive(Clone, Debug)]
pub(crate) struct TexImage {
    /// Texels in x, with both borders.
    pub(crate) width: u32,
    /// Texels in y, with both borders; 1 for one dimension.
    pub(crate) height: u32,
    /// Texels in z, with both borders; 1 for one and two dimensions.
    pub(crate) depth: u32,
    /// Width of the border, 0 or 1 texel.
    pub(crate) border: u32,
    /// What the image keeps.
    pub(crate) format: InternalFormat,
    /// The texels, `width * height * depth` of them. Draws that wait hold on to the same memory; writing then
    /// makes a copy first.
    pub(crate) texels: Arc<Texels>,
}

/// Pixels on their way into a texture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Upload<'a> {
    /// The pixels in client memory.
    pub(crate) source: PixelSource<'a>,
    /// What happens to them.
    pub(crate) transfer: Transfer<'a>,
}

impl TexImage {
    /// An image of `size` texels (with borders) without contents.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn new(format: InternalFormat, size: [u32; 3], border: u32) -> Result<Self, Error> {
        let [width, height, depth] = size;
        let count = size.iter().try_fold(1_usize, |n, &side| n.checked_mul(side as usize));
        let texels = count.and_then(|count| Texels::new(format, count)).ok_or(Error::OutOfMemory)?;
        Ok(Self { width, height, depth, border, format, texels: Arc::new(texels) })
    }

    /// Width, height and depth with borders.
    pub(crate) fn size(&self) -> [u32; 3] {
        [self.width, self.height, self.depth]
    }

    /// Whether there are as many texels as the size says, and at least one. While a texture is being drawn to,
    /// they are not here.
    pub(crate) fn is_present(&self) -> bool {
        let count = self.width as usize * self.height as usize * self.depth as usize;
        count > 0 && self.texels.len() == count
    }

    /// Index of a texel, counted from the corner of the border.
    pub(crate) fn index(&self, x: usize, y: usize, z: usize) -> usize {
        (z * self.height as usize + y) * self.width as usize + x
    }

    /// Whether pixels of a format can be put into, or taken out of, an image of components `base`.
    ///
    /// # Errors
    /// [`Error::InvalidEnum`] for stencil values alone; [`Error::InvalidOperation`] for colours in place of
    /// depths or the other way round.
    pub(crate) fn check_pixels(base: BaseFormat, layout: PixelLayout) -> Result<(), Error> {
        let format = layout.format();
        let pixels_have_depth = matches!(format, PixelFormat::DepthComponent | PixelFormat::DepthStencil);
        if format == PixelFormat::StencilIndex {
            Err(Error::InvalidEnum)
        } else if pixels_have_depth != base.has_depth() {
            Err(Error::InvalidOperation)
        } else {
            Ok(())
        }
    }

    /// Puts pixels over texels from `corner` on, which counts from the corner of the border. The rectangle or
    /// box must lie inside the image.
    pub(crate) fn write(&mut self, corner: [u32; 3], upload: &Upload<'_>) {
        let [x0, y0, z0] = corner.map(|c| c as usize);
        let [w, h, d] = upload.source.size().map(|c| c as usize);
        if w == 0 || h == 0 || d == 0 || !self.is_present() {
            return;
        }
        let (base, stride) = (self.format.base(), self.width as usize);
        let planes: Vec<Range<usize>> =
            (0..d).map(|z| self.index(0, y0, z0 + z)..self.index(0, y0 + h, z0 + z)).collect();
        let texels = Arc::make_mut(&mut self.texels);
        for (z, plane) in planes.into_iter().enumerate() {
            let Upload { source, transfer } = upload;
            match texels {
                Texels::Rgba8(colors) => each_row(&mut colors[plane], stride, |y, row| {
                    let row = &mut row[x0..x0 + w];
                    source.colors8(z, y, 0, transfer, row);
                    if base != BaseFormat::Rgba {
                        row.iter_mut().for_each(|color| *color = base.stored(*color, 255));
                    }
                }),
                Texels::Rgba32F(colors) => each_row(&mut colors[plane], stride, |y, row| {
                    let row = &mut row[x0..x0 + w];
                    source.colors(z, y, 0, transfer, row);
                    row.iter_mut().for_each(|color| *color = base.stored(*color, 1.0));
                }),
                Texels::Depth(depth) => each_row(&mut depth[plane], stride, |y, row| {
                    source.depths(z, y, 0, transfer, &mut row[x0..x0 + w]);
                }),
                Texels::DepthStencil { depth, stencil } => {
                    each_row(&mut depth[plane.clone()], stride, |y, row| {
                        source.depths(z, y, 0, transfer, &mut row[x0..x0 + w]);
                    });
                    if source.layout().format() == PixelFormat::DepthStencil {
                        each_row(&mut stencil[plane], stride, |y, row| {
                            source.stencils(z, y, 0, transfer, &mut row[x0..x0 + w]);
                        });
                    }
                }
                Texels::Stencil(_) => {}
            }
        }
    }

    /// Puts a row of colours, already transferred, over texels from `corner` on.
    pub(crate) fn write_colors(&mut self, corner: [u32; 3], row: &[[f32; 4]]) {
        let at = self.index(corner[0] as usize, corner[1] as usize, corner[2] as usize);
        let base = self.format.base();
        match Arc::make_mut(&mut self.texels) {
            Texels::Rgba8(colors) => {
                for (texel, color) in colors[at..at + row.len()].iter_mut().zip(row) {
                    *texel = base.stored(color.map(unorm8_from_f32), 255);
                }
            }
            Texels::Rgba32F(colors) => {
                for (texel, color) in colors[at..at + row.len()].iter_mut().zip(row) {
                    *texel = base.stored(*color, 1.0);
                }
            }
            _ => {}
        }
    }

    /// Puts a row of depths, already transferred, over texels from `corner` on.
    pub(crate) fn write_depths(&mut self, corner: [u32; 3], row: &[f32]) {
        let at = self.index(corner[0] as usize, corner[1] as usize, corner[2] as usize);
        if let Some(depths) = Arc::make_mut(&mut self.texels).depths_mut() {
            depths[at..at + row.len()].copy_from_slice(row);
        }
    }

    /// Puts a row of stencil values over texels from `corner` on.
    pub(crate) fn write_stencils(&mut self, corner: [u32; 3], row: &[u8]) {
        let at = self.index(corner[0] as usize, corner[1] as usize, corner[2] as usize);
        if let Some(stencils) = Arc::make_mut(&mut self.texels).stencils_mut() {
            stencils[at..at + row.len()].copy_from_slice(row);
        }
    }

    /// Writes the whole image, with its border, into client memory, as `GetTexImage` does. The size of `sink`
    /// must be that of the image, and its format one that [`check_pixels`](Self::check_pixels) allows.
    pub(crate) fn read(&self, sink: &mut PixelSink<'_>) {
        if !self.is_present() {
            return;
        }
        let (base, format) = (self.format.base(), sink.layout().format());
        let width = self.width as usize;
        // Unlike of pixels that are read, the luminance of a texture is its red.
        let luminance = matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha);
        let plain = matches!(base, BaseFormat::Rgba | BaseFormat::Rgb) && !luminance;
        for z in 0..self.depth as usize {
            sink.each_row(z, 0..self.height as usize, |y, mut row| {
                let run = self.index(0, y, z)..self.index(0, y, z) + width;
                match &*self.texels {
                    Texels::Rgba8(colors) if plain => {
                        row.put_colors8(0, &colors[run]);
                    }
                    Texels::Rgba8(colors) => {
                        for (i, colors) in colors[run].chunks(BATCH).enumerate() {
                            let mut batch = [[0; 4]; BATCH];
                            returned(base, luminance, colors, &mut batch, 255);
                            row.put_colors8(i * BATCH, &batch[..colors.len()]);
                        }
                    }
                    Texels::Rgba32F(colors) => {
                        for (i, colors) in colors[run].chunks(BATCH).enumerate() {
                            let mut batch = [[0.0; 4]; BATCH];
                            returned(base, luminance, colors, &mut batch, 1.0);
                            row.put_colors(i * BATCH, &batch[..colors.len()]);
                        }
                    }
                    Texels::DepthStencil { depth, stencil } if format == PixelFormat::DepthStencil => {
                        row.put_depth_stencils(0, &depth[run.clone()], &stencil[run]);
                    }
                    texels => {
                        if let Some(depth) = texels.depths() {
                            row.put_depths(0, &depth[run]);
                        }
                    }
                }
            });
        }
    }
}

/// Colours as `GetTexImage` gives them; with `red_only`, without green and blue.
fn returned<T: Copy + Default>(
    base: BaseFormat,
    red_only: bool,
    colors: &[[T; 4]],
    out: &mut [[T; 4]],
    one: T,
) {
    for (out, color) in out.iter_mut().zip(colors) {
        *out = base.returned(*color, one);
        if red_only {
            *out = [out[0], T::default(), T::default(), out[3]];
        }
    }
}

/// Calls `write` with each row of `stride` elements, on all threads if there are many.
pub(crate) fn each_row<T: Send>(plane: &mut [T], stride: usize, write: impl Fn(usize, &mut [T]) + Sync) {
    if plane.len() < PARALLEL_TEXELS {
        for (y, row) in plane.chunks_mut(stride).enumerate() {
            write(y, row);
        }
        return;
    }
    let band_rows = (BAND_TEXELS / stride).max(1);
    plane.par_chunks_mut(band_rows * stride).enumerate().for_each(|(band, rows)| {
        for (i, row) in rows.chunks_mut(stride).enumerate() {
            write(band * band_rows + i, row);
        }
    });
}
