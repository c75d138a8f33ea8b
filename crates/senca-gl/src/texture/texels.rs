//! The memory behind images, of textures and of framebuffers alike.

use super::depths::Depths;
use super::{BaseFormat, InternalFormat, StorageKind};

/// Most bytes of an image. What asks for more is out of memory.
pub(crate) const MAX_IMAGE_BYTES: usize = 1 << 29;

/// Texels of an image, x fastest, then y from the bottom up, then z.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Texels {
    /// Colours of 8 bits.
    Rgba8(Vec<[u8; 4]>),
    /// Colours as floats in [0, 1].
    Rgba32F(Vec<[f32; 4]>),
    /// Depths in [0, 1].
    Depth(Depths),
    /// Stencil values.
    Stencil(Vec<u8>),
    /// Depths and stencil values, of the same number.
    DepthStencil {
        /// Depths in [0, 1].
        depth: Depths,
        /// Stencil values.
        stencil: Vec<u8>,
    },
}

/// `count` copies of `value`, `None` if memory does not suffice.
///
/// The try is given back at once: a vector of zeros made afterwards takes untouched pages of the system. If it is
/// large, the try is for more than allocators keep, which would else give the same memory again, to be set to zeros.
pub(crate) fn filled<T: Clone>(value: T, count: usize) -> Option<Vec<T>> {
    const LARGE: usize = 1 << 20;
    const MORE_THAN_KEPT: usize = (1 << 26) + 1;
    let size = size_of::<T>().max(1);
    let there_is = |count| Vec::<T>::new().try_reserve_exact(count).is_ok();
    let is_large = count >= LARGE / size;
    let fits = is_large && there_is(count.max(MORE_THAN_KEPT.div_ceil(size))) || there_is(count);
    fits.then(|| vec![value; count])
}

impl Texels {
    /// No texels.
    pub(crate) const EMPTY: Self = Self::Rgba8(Vec::new());

    /// `count` texels: black, transparent if the format has an alpha of its own, depth and stencil 0. `None` if
    /// memory does not suffice.
    pub(crate) fn new(format: InternalFormat, count: usize) -> Option<Self> {
        if count.checked_mul(format.storage().texel_bytes())? > MAX_IMAGE_BYTES {
            return None;
        }
        let opaque = matches!(format.base(), BaseFormat::Rgb | BaseFormat::Luminance);
        Some(match format.storage() {
            StorageKind::Rgba8 if opaque => Self::Rgba8(filled([0, 0, 0, 255], count)?),
            StorageKind::Rgba8 => Self::Rgba8(filled([0; 4], count)?),
            StorageKind::Rgba32F if opaque => Self::Rgba32F(filled([0.0, 0.0, 0.0, 1.0], count)?),
            StorageKind::Rgba32F => Self::Rgba32F(filled([0.0; 4], count)?),
            StorageKind::Depth => Self::Depth(filled(0.0, count)?.into()),
            StorageKind::Stencil => Self::Stencil(filled(0, count)?),
            StorageKind::DepthStencil => {
                Self::DepthStencil { depth: filled(0.0, count)?.into(), stencil: filled(0, count)? }
            }
        })
    }

    /// Number of texels.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Rgba8(colors) => colors.len(),
            Self::Rgba32F(colors) => colors.len(),
            Self::Depth(depth) | Self::DepthStencil { depth, .. } => depth.len(),
            Self::Stencil(stencil) => stencil.len(),
        }
    }

    /// Colour of a texel; of depths the depth in red, green and blue.
    pub(crate) fn color(&self, index: usize) -> [f32; 4] {
        match self {
            Self::Rgba8(colors) => colors[index].map(|c| f32::from(c) / 255.0),
            Self::Rgba32F(colors) => colors[index],
            Self::Depth(depth) | Self::DepthStencil { depth, .. } => {
                let d = depth.get(index);
                [d, d, d, 1.0]
            }
            Self::Stencil(_) => [0.0; 4],
        }
    }

    /// Depths, if texels have them.
    pub(crate) fn depths(&self) -> Option<&[f32]> {
        match self {
            Self::Depth(depth) | Self::DepthStencil { depth, .. } => Some(depth),
            _ => None,
        }
    }

    /// Depths, if texels have them.
    pub(crate) fn depths_mut(&mut self) -> Option<&mut [f32]> {
        match self {
            Self::Depth(depth) | Self::DepthStencil { depth, .. } => Some(depth),
            _ => None,
        }
    }

    /// Stencil values, if texels have them.
    pub(crate) fn stencils(&self) -> Option<&[u8]> {
        match self {
            Self::Stencil(stencil) | Self::DepthStencil { stencil, .. } => Some(stencil),
            _ => None,
        }
    }

    /// Stencil values, if texels have them.
    pub(crate) fn stencils_mut(&mut self) -> Option<&mut [u8]> {
        match self {
            Self::Stencil(stencil) | Self::DepthStencil { stencil, .. } => Some(stencil),
            _ => None,
        }
    }

    /// Copies texels from `from` on of another image of the same kind over those from `to` on. Nothing happens
    /// if the kinds differ.
    pub(crate) fn copy_run(&mut self, to: usize, other: &Self, from: usize, count: usize) {
        match (self, other) {
            (Self::Rgba8(a), Self::Rgba8(b)) => a[to..to + count].copy_from_slice(&b[from..from + count]),
            (Self::Rgba32F(a), Self::Rgba32F(b)) => a[to..to + count].copy_from_slice(&b[from..from + count]),
            (a, b) => {
                if let (Some(a), Some(b)) = (a.depths_mut(), b.depths()) {
                    a[to..to + count].copy_from_slice(&b[from..from + count]);
                }
                if let (Some(a), Some(b)) = (a.stencils_mut(), b.stencils()) {
                    a[to..to + count].copy_from_slice(&b[from..from + count]);
                }
            }
        }
    }
}
