//! Tiled and scan-line rasterizers.
//!
//! [`Primitives`] in clip space, a [`State`] and a [`Shading`] go into a [`Rasterizer`], which fills a
//! [`Target`] of colour, depth and identifiers.

mod api;
mod target;
mod texture;

pub use api::{
    Blend, ColorSource, Compare, Counters, Cull, DepthBias, Factor, FragmentShader, Fragments, Ids,
    Interpolation, LANES, MAX_VARYINGS, Primitives, Rasterizer, Rect, Shaded, Shading, State, TextureUnit,
    Viewport,
};
pub use target::{Buffers, Clear, ColorPlane, MAX_TARGET_SIDE, Target, TargetError, rgba8_from_rgba};
pub use texture::{
    Filter, MAX_TEXTURE_SIDE, Mip, Sampler, TexelGrid, Texels, Texture, TextureError, TextureLevel, Wrap,
};
