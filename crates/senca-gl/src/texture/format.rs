//! Internal formats: what an image keeps.

use crate::gl;

/// Which components an image has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum BaseFormat {
    /// Alpha.
    Alpha,
    /// Luminance.
    Luminance,
    /// Luminance and alpha.
    LuminanceAlpha,
    /// Intensity.
    Intensity,
    /// Red, green and blue.
    Rgb,
    /// Red, green, blue and alpha.
    Rgba,
    /// Depth.
    Depth,
    /// Depth and stencil.
    DepthStencil,
    /// Stencil: renderbuffers only.
    Stencil,
}

impl BaseFormat {
    /// Token of a format of colours.
    fn color_token(self) -> u32 {
        match self {
            Self::Alpha => gl::ALPHA,
            Self::Luminance => gl::LUMINANCE,
            Self::LuminanceAlpha => gl::LUMINANCE_ALPHA,
            Self::Intensity => gl::INTENSITY,
            Self::Rgb => gl::RGB,
            _ => gl::RGBA,
        }
    }

    /// Whether texels are colours.
    pub(crate) fn is_color(self) -> bool {
        !self.has_depth() && self != Self::Stencil
    }

    /// Whether texels have a depth.
    pub(crate) fn has_depth(self) -> bool {
        matches!(self, Self::Depth | Self::DepthStencil)
    }

    /// Whether texels have a stencil value.
    pub(crate) fn has_stencil(self) -> bool {
        matches!(self, Self::Stencil | Self::DepthStencil)
    }

    /// Whether texels have an alpha of their own.
    pub(crate) fn has_alpha(self) -> bool {
        matches!(self, Self::Rgba | Self::Alpha | Self::LuminanceAlpha | Self::Intensity)
    }

    /// A colour as texels of this format are stored and sampled; `one` is full intensity.
    ///
    /// Source: OpenGL 1.5, tables 3.15 and 3.20.
    #[inline]
    pub(crate) fn stored<T: Copy + Default>(self, [r, g, b, a]: [T; 4], one: T) -> [T; 4] {
        let zero = T::default();
        match self {
            Self::Alpha => [zero, zero, zero, a],
            Self::Luminance => [r, r, r, one],
            Self::LuminanceAlpha => [r, r, r, a],
            Self::Intensity => [r; 4],
            Self::Rgb => [r, g, b, one],
            _ => [r, g, b, a],
        }
    }

    /// A stored texel as it is given back: luminance and intensity as red alone.
    ///
    /// Source: OpenGL 1.5, table 6.1.
    #[inline]
    pub(crate) fn returned<T: Copy + Default>(self, [r, g, b, a]: [T; 4], one: T) -> [T; 4] {
        let zero = T::default();
        match self {
            Self::Luminance | Self::Intensity => [r, zero, zero, one],
            Self::LuminanceAlpha => [r, zero, zero, a],
            _ => [r, g, b, a],
        }
    }
}

/// What texels are kept in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum StorageKind {
    /// Four bytes.
    Rgba8,
    /// Four floats in [0, 1]: for components of more than 8 bits.
    Rgba32F,
    /// A float in [0, 1].
    Depth,
    /// A byte.
    Stencil,
    /// A float and a byte.
    DepthStencil,
}

impl StorageKind {
    /// Bytes of a texel.
    pub(crate) fn texel_bytes(self) -> usize {
        match self {
            Self::Rgba8 | Self::Depth => 4,
            Self::Rgba32F => 16,
            Self::Stencil => 1,
            Self::DepthStencil => 5,
        }
    }
}

/// An internal format as it was asked for, and what it comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InternalFormat {
    token: u32,
    base: BaseFormat,
    storage: StorageKind,
    is_srgb: bool,
    /// Bits of depth that queries tell; 0 without depth.
    depth_bits: u8,
}

/// Generic compressed formats and the formats that stand in for them: nothing is compressed.
const UNCOMPRESSED: [(u32, u32); 10] = [
    (gl::COMPRESSED_ALPHA, gl::ALPHA),
    (gl::COMPRESSED_LUMINANCE, gl::LUMINANCE),
    (gl::COMPRESSED_LUMINANCE_ALPHA, gl::LUMINANCE_ALPHA),
    (gl::COMPRESSED_INTENSITY, gl::INTENSITY),
    (gl::COMPRESSED_RGB, gl::RGB),
    (gl::COMPRESSED_RGBA, gl::RGBA),
    (gl::COMPRESSED_SRGB, gl::SRGB),
    (gl::COMPRESSED_SRGB_ALPHA, gl::SRGB_ALPHA),
    (gl::COMPRESSED_SLUMINANCE, gl::SLUMINANCE),
    (gl::COMPRESSED_SLUMINANCE_ALPHA, gl::SLUMINANCE_ALPHA),
];

impl InternalFormat {
    /// Format of a token, or of the number of components 1 to 4, as texture images take it; `None` for others.
    pub(crate) fn for_texture(asked: u32) -> Option<Self> {
        let Some((_, token)) = UNCOMPRESSED.iter().find(|pair| pair.0 == asked) else {
            return Self::color(asked).or_else(|| Self::with_depth(asked));
        };
        // Told is the base format, also where texels are sRGB.
        Self::color(*token).map(|format| Self { token: format.base.color_token(), ..format })
    }

    /// Format of a token as renderbuffers take it: colours, of which some cannot be drawn to, depths and stencil
    /// values; nothing compressed.
    pub(crate) fn for_renderbuffer(token: u32) -> Option<Self> {
        if token <= 4 || UNCOMPRESSED.iter().any(|pair| pair.0 == token) {
            return None;
        }
        let stencil = [
            gl::STENCIL_INDEX,
            gl::STENCIL_INDEX1,
            gl::STENCIL_INDEX4,
            gl::STENCIL_INDEX8,
            gl::STENCIL_INDEX16,
        ];
        if stencil.contains(&token) {
            let (base, storage) = (BaseFormat::Stencil, StorageKind::Stencil);
            return Some(Self { token, base, storage, is_srgb: false, depth_bits: 0 });
        }
        Self::for_texture(token)
    }

    fn color(token: u32) -> Option<Self> {
        use StorageKind::{Rgba8, Rgba32F};
        let (base, storage) = match token {
            gl::ALPHA | gl::ALPHA4 | gl::ALPHA8 => (BaseFormat::Alpha, Rgba8),
            gl::ALPHA12 | gl::ALPHA16 => (BaseFormat::Alpha, Rgba32F),
            1 | gl::LUMINANCE | gl::LUMINANCE4 | gl::LUMINANCE8 | gl::SLUMINANCE | gl::SLUMINANCE8 => {
                (BaseFormat::Luminance, Rgba8)
            }
            gl::LUMINANCE12 | gl::LUMINANCE16 => (BaseFormat::Luminance, Rgba32F),
            2
            | gl::LUMINANCE_ALPHA
            | gl::LUMINANCE4_ALPHA4
            | gl::LUMINANCE6_ALPHA2
            | gl::LUMINANCE8_ALPHA8
            | gl::SLUMINANCE_ALPHA
            | gl::SLUMINANCE8_ALPHA8 => (BaseFormat::LuminanceAlpha, Rgba8),
            gl::LUMINANCE12_ALPHA4 | gl::LUMINANCE12_ALPHA12 | gl::LUMINANCE16_ALPHA16 => {
                (BaseFormat::LuminanceAlpha, Rgba32F)
            }
            gl::INTENSITY | gl::INTENSITY4 | gl::INTENSITY8 => (BaseFormat::Intensity, Rgba8),
            gl::INTENSITY12 | gl::INTENSITY16 => (BaseFormat::Intensity, Rgba32F),
            3 | gl::RGB | gl::R3_G3_B2 | gl::RGB4 | gl::RGB5 | gl::RGB8 | gl::SRGB | gl::SRGB8 => {
                (BaseFormat::Rgb, Rgba8)
            }
            gl::RGB10 | gl::RGB12 | gl::RGB16 => (BaseFormat::Rgb, Rgba32F),
            4
            | gl::RGBA
            | gl::RGBA2
            | gl::RGBA4
            | gl::RGB5_A1
            | gl::RGBA8
            | gl::SRGB_ALPHA
            | gl::SRGB8_ALPHA8 => (BaseFormat::Rgba, Rgba8),
            gl::RGB10_A2 | gl::RGBA12 | gl::RGBA16 => (BaseFormat::Rgba, Rgba32F),
            _ => return None,
        };
        let is_srgb = matches!(
            token,
            gl::SRGB
                | gl::SRGB8
                | gl::SRGB_ALPHA
                | gl::SRGB8_ALPHA8
                | gl::SLUMINANCE
                | gl::SLUMINANCE8
                | gl::SLUMINANCE_ALPHA
                | gl::SLUMINANCE8_ALPHA8
        );
        Some(Self { token, base, storage, is_srgb, depth_bits: 0 })
    }

    fn with_depth(token: u32) -> Option<Self> {
        use BaseFormat::{Depth, DepthStencil};
        let (base, depth_bits) = match token {
            gl::DEPTH_COMPONENT16 => (Depth, 16),
            gl::DEPTH_COMPONENT | gl::DEPTH_COMPONENT24 => (Depth, 24),
            gl::DEPTH_COMPONENT32 | gl::DEPTH_COMPONENT32F => (Depth, 32),
            gl::DEPTH_STENCIL | gl::DEPTH24_STENCIL8 => (DepthStencil, 24),
            gl::DEPTH32F_STENCIL8 => (DepthStencil, 32),
            _ => return None,
        };
        let storage = if base == Depth { StorageKind::Depth } else { StorageKind::DepthStencil };
        Some(Self { token, base, storage, is_srgb: false, depth_bits })
    }

    /// The format as queries tell it: as asked for, but for compressed formats their uncompressed ones.
    pub(crate) fn token(self) -> u32 {
        self.token
    }

    /// Components.
    pub(crate) fn base(self) -> BaseFormat {
        self.base
    }

    /// What texels are kept in.
    pub(crate) fn storage(self) -> StorageKind {
        self.storage
    }

    /// Whether red, green and blue are encoded by the curve of sRGB.
    pub(crate) fn is_srgb(self) -> bool {
        self.is_srgb
    }

    /// Whether depths are floating-point numbers by name.
    pub(crate) fn is_float(self) -> bool {
        matches!(self.token, gl::DEPTH_COMPONENT32F | gl::DEPTH32F_STENCIL8)
    }

    /// Bits of a component, as the tokens of `GetTexLevelParameter` and `GetRenderbufferParameter` ask for them
    /// (`TEXTURE_RED_SIZE`, `RENDERBUFFER_RED_SIZE` ...); `None` for another token.
    pub(crate) fn bits(self, pname: u32) -> Option<u32> {
        use BaseFormat::{Alpha, Intensity, Luminance, LuminanceAlpha, Rgb, Rgba};
        let channel = if self.storage == StorageKind::Rgba32F { 16 } else { 8 };
        let if_one_of = |bases: &[BaseFormat]| if bases.contains(&self.base) { channel } else { 0 };
        Some(match pname {
            gl::TEXTURE_RED_SIZE
            | gl::TEXTURE_GREEN_SIZE
            | gl::TEXTURE_BLUE_SIZE
            | gl::RENDERBUFFER_RED_SIZE
            | gl::RENDERBUFFER_GREEN_SIZE
            | gl::RENDERBUFFER_BLUE_SIZE => if_one_of(&[Rgb, Rgba]),
            gl::TEXTURE_ALPHA_SIZE | gl::RENDERBUFFER_ALPHA_SIZE => if_one_of(&[Rgba, Alpha, LuminanceAlpha]),
            gl::TEXTURE_LUMINANCE_SIZE => if_one_of(&[Luminance, LuminanceAlpha]),
            gl::TEXTURE_INTENSITY_SIZE => if_one_of(&[Intensity]),
            gl::TEXTURE_DEPTH_SIZE | gl::RENDERBUFFER_DEPTH_SIZE => u32::from(self.depth_bits),
            gl::TEXTURE_STENCIL_SIZE | gl::RENDERBUFFER_STENCIL_SIZE => {
                if self.base.has_stencil() {
                    8
                } else {
                    0
                }
            }
            _ => return None,
        })
    }
}
