//! Tiled and scan-line rasterizers.
//!
//! [`Primitives`] in clip space, a [`State`] and a [`Shading`] go into a [`Rasterizer`], which fills a
//! [`Target`] of colour, depth, stencil and identifiers, in any combination: the same code draws pictures,
//! shadow maps, and the identifiers that picking and the hemicube of radiosity read.
//!
//! There are two rasterizers. [`ScanlineRasterizer`] is the form of the books, to be read in one
//! sitting. [`TiledRasterizer`] is the fast one: it sorts triangles into tiles of 64 x 64 pixels, sets
//! them up and draws them sixteen at a time with the machine's vector instructions, on as many
//! threads as wanted. Both decide coverage by exact integers on a raster of 1/256 pixel and do the
//! same arithmetic in the same order otherwise, so their pictures are the same to the bit, at any
//! number of threads and with any vector instructions. The one exception: textures of 8 bits a
//! channel, which the tiled one mixes with weights of 8 bits.
//!
//! ```
//! use senca_raster::{Buffers, Ids, Primitives, Rasterizer, Shading, State, TiledRasterizer};
//! use senca_math::glam::Vec4;
//!
//! let triangle = Primitives {
//!     positions: &[
//!         Vec4::new(-1.0, -1.0, 0.5, 1.0),
//!         Vec4::new(1.0, -1.0, 0.5, 1.0),
//!         Vec4::new(-1.0, 1.0, 0.5, 1.0),
//!     ],
//!     varyings: &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
//!     stride: 3,
//!     indices: &[0, 1, 2],
//!     ids: Ids::From(7),
//! };
//! let mut buffers = Buffers::with_ids(8, 8);
//! let mut rasterizer = TiledRasterizer::default();
//! let counters =
//!     rasterizer.draw(&mut buffers.target()?, &triangle, &State::default(), &Shading::vertex_rgb());
//!
//! // Pixel centres on the slanted side belong to a neighbour: 7 + 6 + ... + 1.
//! assert_eq!(counters.passed, 28);
//! assert_eq!(buffers.ids[7 * 8], 7); // the lower left pixel
//! assert!(buffers.color.pixel(0, 7)[0] > 0.8); // which is nearly the red corner
//! assert_eq!(buffers.depth[7], 1.0); // the upper right one is empty
//! # Ok::<(), senca_raster::TargetError>(())
//! ```
//!
//! Lines and points are drawn one fragment after another.

mod api;
mod assemble;
mod batch;
mod bin;
mod blend;
mod block_depths;
pub mod clip;
mod cover;
pub mod cube;
mod depth;
mod filled;
mod later;
mod lines;
mod multisample;
mod pixel;
mod pixels;
mod sample;
pub mod scanline;
mod setup;
mod shade;
mod shadow;
mod sink;
mod smooth;
mod stage;
mod target;
mod texture;
mod textured;
mod tile;
mod tiled;

pub use api::{
    AlphaTest, Blend, ColorSource, Compare, Counters, Cull, DepthBias, Factor, FixedShading, FragmentShader,
    Fragments, Ids, Interpolation, LANES, LineStipple, MAX_VARYINGS, Primitives, Rasterizer, Rect, Shaded,
    Shading, State, StencilOp, StencilTest, StippleJoins, StrokeRule, TextureUnit, Viewport,
};
pub use block_depths::BlockDepths;
pub use cube::{CubeTexture, CubeUnit};
pub use fearless_simd::{self as simd, Level as SimdLevel};
pub use multisample::SAMPLES;
pub use scanline::ScanlineRasterizer;
pub use shadow::ShadowUnit;
pub use stage::{FragmentStage, PixelColors, Pixels, Samples};
pub use target::{
    Buffers, Clear, ClearMasks, ColorPlane, MAX_TARGET_SIDE, Target, TargetError, rgba8_from_rgba,
};
pub use texture::{
    Filter, MAX_TEXTURE_SIDE, Mip, Sampler, SharedTexels, TexelGrid, Texels, Texture, TextureError,
    TextureLevel, Wrap, log2,
};
pub use tiled::{Draw, TiledRasterizer, TiledSettings};
