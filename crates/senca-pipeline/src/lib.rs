//! The standard rendering pipeline over a scene.

mod error;
mod geometry;
mod gouraud;
mod lines;
mod material;
mod render;
mod report;
mod settings;
mod shade;
mod single_pass;
pub mod stages;
mod strokes;
mod surface;
#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;
mod transformed;
mod visibility;

pub use error::RenderError;
pub use lines::{Segment, SegmentKind, hidden_line_segments, wire_segments};
pub use render::{render, render_with};
pub use report::{Control, Report, StageSeconds};
pub use settings::{
    ColorInterpolation, Crop, Culling, Raster, Settings, Shading, TextureMethod, WireSettings,
};
