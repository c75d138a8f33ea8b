//! Textures: what their images hold, how images get in and out, and what texture objects know about them.
//!
//! 1. [`InternalFormat`] says what an image keeps of what is given to it; [`Texels`] is the memory behind it.
//! 2. [`TexImage`] is one level of one face. Texels are stored as they are sampled: luminance L as L, L, L, 1,
//!    alpha A as 0, 0, 0, A, intensity I as I, I, I, I.
//! 3. [`Texture`] is an object: parameters and the levels of its faces, and whether they are complete.
//! 4. [`Names`] hands out object names and finds objects; contexts that share objects share it.
//!
//! Source: "The OpenGL Graphics System", version 1.5, sections 3.8 and 6.1; ARB_texture_non_power_of_two,
//! ARB_framebuffer_object, ARB_depth_buffer_float, EXT_texture_sRGB.

mod format;
mod image;
mod mipmap;
mod names;
mod object;
mod texels;

#[cfg(test)]
mod tests;

pub use format::{BaseFormat, InternalFormat, StorageKind};
pub use image::{TexImage, Upload};
pub use mipmap::next_level;
pub use names::Names;
pub use object::{MAX_3D_TEXTURE_SIZE, MAX_TEXTURE_SIZE, TexParams, Texture, TextureTarget, levels_of};
pub use texels::{MAX_IMAGE_BYTES, Texels};
pub(crate) use {image::each_row, texels::filled};

use crate::Context;
use crate::state::TexTarget;

/// All texture objects.
#[derive(Debug, Default)]
pub(crate) struct Textures {}

/// What is bound to each unit.
#[derive(Debug, Default)]
pub(crate) struct Bindings {}

/// What `push_attrib(TEXTURE_BIT)` saves of bindings and of the parameters of bound textures.
#[derive(Debug)]
pub(crate) struct SavedBindings {}

pub(crate) use crate::fragment::View;

impl Context {
    /// The texture that a unit draws with: of the most dimensions that is on and complete.
    pub(crate) fn texture_view(&self, _unit: usize) -> Option<(TexTarget, View)> {
        None
    }

    pub(crate) fn save_bindings(&self) -> SavedBindings {
        SavedBindings {}
    }

    pub(crate) fn restore_bindings(&mut self, _saved: SavedBindings) {}
}
