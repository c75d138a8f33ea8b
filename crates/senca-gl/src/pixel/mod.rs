//! Pixels in client memory: how they lie there, how they become colours, indices and depths, and the way back.
//!
//! 1. [`PixelLayout`] is a format with a type: which components a pixel has, in which order and in how many bits.
//! 2. [`PixelStore`] says where the pixels of an image lie among the bytes: alignment, row length, what to skip.
//! 3. [`PixelSource`] reads rows out of client bytes, [`PixelSink`] writes them back.
//! 4. [`Transfer`] is what happens to pixels on the way, in both directions: scale and bias, shift and offset, maps.
//!
//! Each step has a plain form for any layout. Rows of bytes that need nothing but reordering take a short cut,
//! which tests compare with the plain form.
//!
//! Source: "The OpenGL Graphics System", version 1.5, sections 3.6 and 4.3; ARB_framebuffer_object for depth with
//! stencil; ARB_half_float_pixel.

mod convert;
mod format;
mod pack;
mod store;
mod transfer;
mod unpack;

#[cfg(test)]
mod tests;

pub use convert::{f16_from_f32, f32_from_f16, unorm8_from_f32};
pub use format::{PixelFormat, PixelLayout, PixelType};
pub use pack::{PixelSink, RowSink};
pub use store::{ImageSpan, PixelStore, image_bytes};
pub use transfer::{MAX_PIXEL_MAP_TABLE, PixelMap, PixelMaps, PixelTransfer, Transfer};
pub use unpack::PixelSource;
