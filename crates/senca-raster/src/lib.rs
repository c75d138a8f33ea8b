//! Tiled and scan-line rasterizers.
//!
//! [`Primitives`] in clip space, a [`State`] and a [`Shading`] go into a [`Rasterizer`], which fills a
//! [`Target`] of colour, depth and identifiers.

mod api;
mod assemble;
mod batch;
mod bin;
mod blend;
pub mod clip;
mod cover;
mod lines;
mod pixel;
mod sample;
pub mod scanline;
mod setup;
mod shade;
mod target;
mod texture;
mod tile;
mod tiled;

pub use api::{
    Blend, ColorSource, Compare, Counters, Cull, DepthBias, Factor, FragmentShader, Fragments, Ids,
    Interpolation, LANES, MAX_VARYINGS, Primitives, Rasterizer, Rect, Shaded, Shading, State, TextureUnit,
    Viewport,
};
pub use fearless_simd::{self as simd, Level as SimdLevel};
pub use scanline::ScanlineRasterizer;
pub use target::{Buffers, Clear, ColorPlane, MAX_TARGET_SIDE, Target, TargetError, rgba8_from_rgba};
pub use texture::{
    Filter, MAX_TEXTURE_SIDE, Mip, Sampler, TexelGrid, Texels, Texture, TextureError, TextureLevel, Wrap,
};
pub use tiled::{TiledRasterizer, TiledSettings};
