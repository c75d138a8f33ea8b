//! Textures: what their images hold, how images get in and out, and what texture objects know about them.
//!
//! 1. [`InternalFormat`] says what an image keeps of what is given to it; [`Texels`] is the memory behind it.
//! 2. [`TexImage`] is one level of one face. Texels are stored as they are sampled: luminance L as L, L, L, 1,
//!    alpha A as 0, 0, 0, A, intensity I as I, I, I, I.
//! 3. [`Texture`] is an object: parameters and the levels of its faces, and whether they are complete.
//! 4. [`Names`] hands out object names and finds objects; contexts that share objects share it.
//! 5. A [`View`] is a complete texture as it was when drawing began: what is done to the texture afterwards does not
//!    show in it.
//!
//! Source: "The OpenGL Graphics System", version 1.5, sections 3.8 and 6.1; ARB_texture_non_power_of_two,
//! ARB_framebuffer_object, ARB_depth_buffer_float, EXT_texture_sRGB.

mod bindings;
mod copy;
mod depths;
mod format;
mod image;
mod mipmap;
mod names;
mod object;
mod queries;
mod texels;
mod upload;

#[cfg(test)]
mod command_tests;
#[cfg(test)]
mod tests;

pub(crate) use crate::fragment::View;
pub(crate) use crate::state::TexTarget as TextureTarget;
pub(crate) use bindings::{Bindings, SavedBindings, TextureRef, Textures};
pub(crate) use format::{BaseFormat, InternalFormat, StorageKind};
pub(crate) use image::{TexImage, Upload, each_row};
pub(crate) use mipmap::next_level;
pub(crate) use names::Names;
pub(crate) use object::{MAX_3D_TEXTURE_SIZE, MAX_TEXTURE_SIZE, TexParams, Texture, levels_of};
pub(crate) use texels::{MAX_IMAGE_BYTES, Texels, filled};
