//! Formats and types of pixels, and which of them go together.

use crate::error::Error;
use crate::gl;

/// What the components of a pixel mean, and their order in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelFormat {
    /// `COLOR_INDEX`: one index into the maps of indices to colours.
    ColorIndex,
    /// `STENCIL_INDEX`: one stencil value.
    StencilIndex,
    /// `DEPTH_COMPONENT`: one depth, 0 near to 1 far.
    DepthComponent,
    /// `DEPTH_STENCIL`: a depth and a stencil value in one packed element.
    DepthStencil,
    /// `RED`.
    Red,
    /// `GREEN`.
    Green,
    /// `BLUE`.
    Blue,
    /// `ALPHA`.
    Alpha,
    /// `RGB`.
    Rgb,
    /// `BGR`.
    Bgr,
    /// `RGBA`.
    Rgba,
    /// `BGRA`.
    Bgra,
    /// `ABGR_EXT`.
    Abgr,
    /// `LUMINANCE`: read as red, green and blue alike; written as the sum of the three.
    Luminance,
    /// `LUMINANCE_ALPHA`.
    LuminanceAlpha,
}

impl PixelFormat {
    /// Format of a token, `None` if it names none.
    #[must_use]
    pub fn from_token(token: u32) -> Option<Self> {
        Some(match token {
            gl::COLOR_INDEX => Self::ColorIndex,
            gl::STENCIL_INDEX => Self::StencilIndex,
            gl::DEPTH_COMPONENT => Self::DepthComponent,
            gl::DEPTH_STENCIL => Self::DepthStencil,
            gl::RED => Self::Red,
            gl::GREEN => Self::Green,
            gl::BLUE => Self::Blue,
            gl::ALPHA => Self::Alpha,
            gl::RGB => Self::Rgb,
            gl::BGR => Self::Bgr,
            gl::RGBA => Self::Rgba,
            gl::BGRA => Self::Bgra,
            gl::ABGR_EXT => Self::Abgr,
            gl::LUMINANCE => Self::Luminance,
            gl::LUMINANCE_ALPHA => Self::LuminanceAlpha,
            _ => return None,
        })
    }

    /// Components of a pixel, 1 to 4.
    #[must_use]
    pub fn components(self) -> usize {
        match self {
            Self::Rgba | Self::Bgra | Self::Abgr => 4,
            Self::Rgb | Self::Bgr => 3,
            Self::LuminanceAlpha | Self::DepthStencil => 2,
            _ => 1,
        }
    }

    /// Whether pixels of the format are colours, not indices or depths. A colour index is not.
    #[must_use]
    pub fn is_color(self) -> bool {
        !matches!(self, Self::ColorIndex | Self::StencilIndex | Self::DepthComponent | Self::DepthStencil)
    }

    /// For a colour format, the channel (0 red to 3 alpha) of each component; luminance counts as red.
    pub(super) fn channels(self) -> &'static [usize] {
        match self {
            Self::Rgba => &[0, 1, 2, 3],
            Self::Bgra => &[2, 1, 0, 3],
            Self::Abgr => &[3, 2, 1, 0],
            Self::Rgb => &[0, 1, 2],
            Self::Bgr => &[2, 1, 0],
            Self::LuminanceAlpha => &[0, 3],
            Self::Green => &[1],
            Self::Blue => &[2],
            Self::Alpha => &[3],
            _ => &[0],
        }
    }
}

/// How a component, or a whole packed pixel, is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelType {
    /// `BITMAP`: one bit per pixel, indices only.
    Bitmap,
    /// `UNSIGNED_BYTE`.
    U8,
    /// `BYTE`.
    I8,
    /// `UNSIGNED_SHORT`.
    U16,
    /// `SHORT`.
    I16,
    /// `UNSIGNED_INT`.
    U32,
    /// `INT`.
    I32,
    /// `FLOAT`.
    F32,
    /// `HALF_FLOAT`.
    F16,
    /// `UNSIGNED_BYTE_3_3_2`.
    U8x332,
    /// `UNSIGNED_BYTE_2_3_3_REV`.
    U8x233Rev,
    /// `UNSIGNED_SHORT_5_6_5`.
    U16x565,
    /// `UNSIGNED_SHORT_5_6_5_REV`.
    U16x565Rev,
    /// `UNSIGNED_SHORT_4_4_4_4`.
    U16x4444,
    /// `UNSIGNED_SHORT_4_4_4_4_REV`.
    U16x4444Rev,
    /// `UNSIGNED_SHORT_5_5_5_1`.
    U16x5551,
    /// `UNSIGNED_SHORT_1_5_5_5_REV`.
    U16x1555Rev,
    /// `UNSIGNED_INT_8_8_8_8`.
    U32x8888,
    /// `UNSIGNED_INT_8_8_8_8_REV`.
    U32x8888Rev,
    /// `UNSIGNED_INT_10_10_10_2`.
    U32x1010102,
    /// `UNSIGNED_INT_2_10_10_10_REV`.
    U32x2101010Rev,
    /// `UNSIGNED_INT_24_8`: depth in the upper 24 bits, stencil in the lower 8.
    U32x248,
    /// `FLOAT_32_UNSIGNED_INT_24_8_REV`: a float depth, then a word whose lower 8 bits are the stencil.
    F32U248Rev,
}

/// The fields of a packed type, first component first: lowest bit and number of bits.
type Fields = &'static [(u32, u32)];

impl PixelType {
    /// Type of a token, `None` if it names none.
    #[must_use]
    pub fn from_token(token: u32) -> Option<Self> {
        Some(match token {
            gl::BITMAP => Self::Bitmap,
            gl::UNSIGNED_BYTE => Self::U8,
            gl::BYTE => Self::I8,
            gl::UNSIGNED_SHORT => Self::U16,
            gl::SHORT => Self::I16,
            gl::UNSIGNED_INT => Self::U32,
            gl::INT => Self::I32,
            gl::FLOAT => Self::F32,
            gl::HALF_FLOAT => Self::F16,
            gl::UNSIGNED_BYTE_3_3_2 => Self::U8x332,
            gl::UNSIGNED_BYTE_2_3_3_REV => Self::U8x233Rev,
            gl::UNSIGNED_SHORT_5_6_5 => Self::U16x565,
            gl::UNSIGNED_SHORT_5_6_5_REV => Self::U16x565Rev,
            gl::UNSIGNED_SHORT_4_4_4_4 => Self::U16x4444,
            gl::UNSIGNED_SHORT_4_4_4_4_REV => Self::U16x4444Rev,
            gl::UNSIGNED_SHORT_5_5_5_1 => Self::U16x5551,
            gl::UNSIGNED_SHORT_1_5_5_5_REV => Self::U16x1555Rev,
            gl::UNSIGNED_INT_8_8_8_8 => Self::U32x8888,
            gl::UNSIGNED_INT_8_8_8_8_REV => Self::U32x8888Rev,
            gl::UNSIGNED_INT_10_10_10_2 => Self::U32x1010102,
            gl::UNSIGNED_INT_2_10_10_10_REV => Self::U32x2101010Rev,
            gl::UNSIGNED_INT_24_8 => Self::U32x248,
            gl::FLOAT_32_UNSIGNED_INT_24_8_REV => Self::F32U248Rev,
            _ => return None,
        })
    }

    /// Bytes of an element: a component, or a whole pixel of a packed type. A bitmap counts as 1.
    #[must_use]
    pub fn element_bytes(self) -> usize {
        match self {
            Self::Bitmap | Self::U8 | Self::I8 | Self::U8x332 | Self::U8x233Rev => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U16x565 | Self::U16x565Rev | Self::U16x4444 => 2,
            Self::U16x4444Rev | Self::U16x5551 | Self::U16x1555Rev => 2,
            Self::F32U248Rev => 8,
            _ => 4,
        }
    }

    /// Bytes that are turned round when bytes are swapped: those of a machine word.
    pub(super) fn word_bytes(self) -> usize {
        self.element_bytes().min(4)
    }

    /// Fields of a packed colour type, `None` for one element per component.
    pub(super) fn fields(self) -> Option<Fields> {
        Some(match self {
            Self::U8x332 => &[(5, 3), (2, 3), (0, 2)],
            Self::U8x233Rev => &[(0, 3), (3, 3), (6, 2)],
            Self::U16x565 => &[(11, 5), (5, 6), (0, 5)],
            Self::U16x565Rev => &[(0, 5), (5, 6), (11, 5)],
            Self::U16x4444 => &[(12, 4), (8, 4), (4, 4), (0, 4)],
            Self::U16x4444Rev => &[(0, 4), (4, 4), (8, 4), (12, 4)],
            Self::U16x5551 => &[(11, 5), (6, 5), (1, 5), (0, 1)],
            Self::U16x1555Rev => &[(0, 5), (5, 5), (10, 5), (15, 1)],
            Self::U32x8888 => &[(24, 8), (16, 8), (8, 8), (0, 8)],
            Self::U32x8888Rev => &[(0, 8), (8, 8), (16, 8), (24, 8)],
            Self::U32x1010102 => &[(22, 10), (12, 10), (2, 10), (0, 2)],
            Self::U32x2101010Rev => &[(0, 10), (10, 10), (20, 10), (30, 2)],
            _ => return None,
        })
    }

    /// Whether one element holds a depth and a stencil value.
    pub(super) fn is_depth_stencil(self) -> bool {
        matches!(self, Self::U32x248 | Self::F32U248Rev)
    }

    /// Whether elements are floating-point numbers.
    #[must_use]
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F16)
    }
}

/// A format with a type that goes with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PixelLayout {
    format: PixelFormat,
    ty: PixelType,
}

impl PixelLayout {
    /// Layout of the bits of `Bitmap` and `PolygonStipple`.
    pub const BITMAP: Self = Self { format: PixelFormat::ColorIndex, ty: PixelType::Bitmap };

    /// Format and type of two tokens, as `DrawPixels`, `ReadPixels`, `TexImage*` and `GetTexImage` take them.
    ///
    /// # Errors
    /// [`Error::InvalidEnum`] for a token that is no format or no type, for bits of anything but indices, and for
    /// a depth with stencil in a type for something else; [`Error::InvalidOperation`] for a packed type with a
    /// format of other components.
    pub fn new(format: u32, ty: u32) -> Result<Self, Error> {
        let format = PixelFormat::from_token(format).ok_or(Error::InvalidEnum)?;
        let ty = PixelType::from_token(ty).ok_or(Error::InvalidEnum)?;
        let is_index = matches!(format, PixelFormat::ColorIndex | PixelFormat::StencilIndex);
        if ty == PixelType::Bitmap && !is_index {
            return Err(Error::InvalidEnum);
        }
        if format == PixelFormat::DepthStencil && !ty.is_depth_stencil() {
            return Err(Error::InvalidEnum);
        }
        let fits = match ty.fields() {
            Some(fields) if fields.len() == 3 => format == PixelFormat::Rgb,
            Some(_) => format.components() == 4,
            None => !ty.is_depth_stencil() || format == PixelFormat::DepthStencil,
        };
        if fits { Ok(Self { format, ty }) } else { Err(Error::InvalidOperation) }
    }

    /// What the components mean.
    #[must_use]
    pub fn format(self) -> PixelFormat {
        self.format
    }

    /// How they are stored.
    #[must_use]
    pub fn ty(self) -> PixelType {
        self.ty
    }

    /// Bits of a pixel: 1 for bitmaps, else a multiple of 8.
    #[must_use]
    pub fn pixel_bits(self) -> usize {
        if self.ty == PixelType::Bitmap {
            return 1;
        }
        let packed = self.ty.fields().is_some() || self.ty.is_depth_stencil();
        let elements = if packed { 1 } else { self.format.components() };
        8 * elements * self.ty.element_bytes()
    }
}
