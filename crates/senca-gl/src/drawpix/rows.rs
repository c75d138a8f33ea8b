//! Images to be drawn, row by row: out of client memory, or copied from the framebuffer.

use crate::framebuffer::Plane;
use crate::pixel::{PixelSource, unorm8_from_f32};
use crate::pixel_state::PixelState;
use crate::texture::Texels;

/// An image to be drawn, with what happens to its pixels on the way.
#[derive(Debug)]
pub(super) struct Image<'a> {
    pub(super) pixels: ImagePixels<'a>,
    /// What happens to pixels, as it was when the command came.
    pub(super) state: PixelState,
}

/// Where pixels come from.
#[derive(Debug)]
pub(super) enum ImagePixels<'a> {
    Client(PixelSource<'a>),
    /// Colours, or depths, and perhaps stencil values.
    Copied {
        first: Plane,
        stencil: Option<Plane>,
    },
}

impl Image<'_> {
    pub(super) fn size(&self) -> [u32; 2] {
        match &self.pixels {
            ImagePixels::Client(source) => [source.size()[0], source.size()[1]],
            ImagePixels::Copied { first, .. } => [first.width, first.height],
        }
    }

    fn transfer(&self) -> crate::pixel::Transfer<'_> {
        self.state.transfer()
    }

    /// Colours of row `y` from column `x` on.
    pub(super) fn colors(&self, y: usize, x: usize, out: &mut [[f32; 4]]) {
        match &self.pixels {
            ImagePixels::Client(source) => source.colors(0, y, x, &self.transfer(), out),
            ImagePixels::Copied { first, .. } => {
                (first.at(x, y)..).zip(out.iter_mut()).for_each(|(at, out)| *out = first.texels.color(at));
                self.transfer().colors(out);
            }
        }
    }

    /// As [`colors`](Self::colors), in 8 bits.
    pub(super) fn colors8(&self, y: usize, x: usize, out: &mut [[u8; 4]]) {
        match &self.pixels {
            ImagePixels::Client(source) => source.colors8(0, y, x, &self.transfer(), out),
            ImagePixels::Copied { first, .. } => match &*first.texels {
                Texels::Rgba8(colors) if self.transfer().keeps_colors() => {
                    let from = first.at(x, y);
                    out.copy_from_slice(&colors[from..from + out.len()]);
                }
                _ => {
                    let mut colors = vec![[0.0; 4]; out.len()];
                    self.colors(y, x, &mut colors);
                    out.iter_mut().zip(colors).for_each(|(out, color)| *out = color.map(unorm8_from_f32));
                }
            },
        }
    }

    /// Depths of row `y`.
    pub(super) fn depths(&self, y: usize, out: &mut [f32]) {
        match &self.pixels {
            ImagePixels::Client(source) => source.depths(0, y, 0, &self.transfer(), out),
            ImagePixels::Copied { first, .. } => {
                let from = first.at(0, y);
                if let Some(depths) = first.texels.depths() {
                    out.copy_from_slice(&depths[from..from + out.len()]);
                }
                self.transfer().depths(out);
            }
        }
    }

    /// Stencil values of row `y`.
    pub(super) fn stencils(&self, y: usize, out: &mut [u8]) {
        match &self.pixels {
            ImagePixels::Client(source) => source.stencils(0, y, 0, &self.transfer(), out),
            ImagePixels::Copied { first, stencil } => {
                let plane = stencil.as_ref().unwrap_or(first);
                let from = plane.at(0, y);
                let Some(stencils) = plane.texels.stencils() else { return };
                let mut values: Vec<u32> =
                    stencils[from..from + out.len()].iter().map(|s| u32::from(*s)).collect();
                self.transfer().stencils(&mut values);
                out.iter_mut().zip(values).for_each(|(out, value)| *out = value as u8);
            }
        }
    }
}
