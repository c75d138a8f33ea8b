//! The textbook pipeline: every stage a step over a list of triangles.
//!
//! This is the plain form of what [`crate::render`] does fast, for readers and as the oracle of its
//! tests. A [`Triangle`] list is made from a scene by [`tessellate`]; stages change it one after the
//! other; [`rasterize_gouraud`] or [`rasterize_phong`] fills a picture from what is left. A stage is
//! anything that is a [`Stage`], so each can be replaced by one's own and the results compared.
//!
//! | order | Gouraud | Phong |
//! |---|---|---|
//! | 1 | [`tessellate`] | [`tessellate`] |
//! | 2 | [`RejectBacks`] | [`RejectBacks`] |
//! | 3 | [`LightVertices`] | |
//! | 4 | [`Project`] | [`Project`] |
//! | 5 | [`ClipByVolume`] | [`ClipByVolume`] |
//! | 6 | [`Divide`] | [`Divide`] |
//! | 7 | [`ToDevice`] | [`ToDevice`] |
//! | 8 | [`rasterize_gouraud`] | [`rasterize_phong`], which lights every pixel |
//!
//! Source: course text, chapter 2. Differences: pixels are filled by the rule of
//! [`senca_raster::ScanlineRasterizer`], which counts the pixels of a common edge once.

mod rasterize;
mod record;
mod steps;
mod texture_frame;

pub use rasterize::{PixelLight, rasterize_gouraud, rasterize_phong, z_buffer};
pub use record::{Triangle, Vertex, tessellate};
pub use steps::{
    ClipByVolume, Divide, LightVertices, Project, RejectBacks, Stage, ToDevice, canonical_from_world,
    gouraud_stages, phong_stages, run,
};
pub use texture_frame::{TextureFrame, texel_position};

#[cfg(test)]
mod tests;
