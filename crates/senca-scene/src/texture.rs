//! Textures: pictures and how they are laid onto surfaces.

use senca_math::glam::Mat3;

use crate::{ImageId, TextureId};

/// A picture used as texture, decoded or not.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureImage {
    /// Name or path from the file, or empty.
    pub name: String,
    /// The texels.
    pub data: ImageData,
}

/// Texels in row order, row 0 on top, four channels each.
#[derive(Clone, Debug, PartialEq)]
pub enum ImageData {
    /// 8 bits a channel; how they are encoded is for the use to say.
    Rgba8 {
        /// Width in texels, > 0.
        width: u32,
        /// Height in texels, > 0.
        height: u32,
        /// `width * height` texels.
        texels: Vec<[u8; 4]>,
    },
    /// Linear floats (EXR, PFM and colour triples written in a scene file).
    RgbaF32 {
        /// Width in texels, > 0.
        width: u32,
        /// Height in texels, > 0.
        height: u32,
        /// `width * height` texels.
        texels: Vec<[f32; 4]>,
    },
}

impl ImageData {
    /// Width and height in texels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Rgba8 { width, height, .. } | Self::RgbaF32 { width, height, .. } => (*width, *height),
        }
    }
}

/// A picture with its sampling rules.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name from the file, or empty.
    pub name: String,
    /// The picture.
    pub image: ImageId,
    /// What happens left and right of the picture.
    pub wrap_u: Wrap,
    /// What happens above and below the picture.
    pub wrap_v: Wrap,
    /// How texels are combined.
    pub filter: Filter,
}

/// How coordinates outside [0, 1] are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture is repeated.
    #[default]
    Repeat,
    /// The picture is repeated, every second time mirrored.
    Mirror,
    /// The border texel goes on for ever.
    Clamp,
}

/// How texels are combined into one colour (course text, section 2.11).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Weighted mean of the four around the place.
    Bilinear,
    /// Mean over the quadrilateral that the pixel covers in the texture.
    Footprint,
    /// Bilinear in the two fitting levels of detail, weighted.
    #[default]
    Trilinear,
}

/// Meaning of the texels of an 8-bit picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorSpace {
    /// sRGB encoded colour.
    #[default]
    Srgb,
    /// Linear data such as normals or roughness.
    Linear,
}

/// Use of a texture by a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// The texture.
    pub texture: TextureId,
    /// Which coordinates of the vertices, 0 or 1.
    pub texcoord: u32,
    /// Applied to `(u, v, 1)` before sampling. Default identity.
    pub uv_transform: Mat3,
    /// Scale of a normal map, strength of an occlusion map, factor otherwise. Default 1.
    pub strength: f32,
}

impl TextureRef {
    /// Plain use of `texture` through coordinate set 0.
    #[must_use]
    pub fn new(texture: TextureId) -> Self {
        Self { texture, texcoord: 0, uv_transform: Mat3::IDENTITY, strength: 1.0 }
    }
}
