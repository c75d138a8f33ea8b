//! The standard rendering pipeline over a scene.
//!
//! [`render`] draws a [`senca_scene::Scene`] as a [`senca_math::View`] sees it: as lines, or with flat,
//! Gouraud, Phong or material shading ([`Shading`]). [`wire_segments`] and [`hidden_line_segments`]
//! give the lines as a list. [`stages`] is the same pipeline as the textbook has it, step by step over
//! a list of triangles, to be read, taken apart and compared with.
//!
//! The picture does not depend on the number of threads, on the rasterizer, on whether visibility is
//! found first ([`Settings::two_pass`]), or on the order of triangles, transparent ones included.
//! Shadows and reflections between objects are not drawn; that is for ray tracing and radiosity.
//!
//! ```
//! use senca_math::glam::DVec3;
//! use senca_math::{Image, View};
//! use senca_pipeline::{Culling, Settings, Shading, render};
//! use senca_scene::{Scene, Shape};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
//! let world_from_camera = View::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y)?;
//! scene.light_by_default(&world_from_camera);
//! let view = View::perspective(&world_from_camera, 0.6, 1.0, 1.0, Some(20.0))?;
//!
//! let mut image = Image::new(64, 64, [0.0; 4]);
//! let settings =
//!     Settings { shading: Shading::Phong, cull: Culling::Always, samples: 4, ..Settings::default() };
//! let report = render(&scene, &view, &settings, &mut image)?;
//!
//! assert!(report.triangles_culled > 0);
//! assert_eq!(image.pixel(0, 0)[3], 0.0, "nothing in the corner");
//! assert_eq!(image.pixel(32, 32)[3], 1.0, "the ball in the middle");
//! # Ok(())
//! # }
//! ```

mod canvas;
mod channel;
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
pub use render::{render, render_part, render_with};
pub use report::{Report, StageSeconds};
pub use senca_math::Control;
pub use settings::{
    Channel, ColorInterpolation, Crop, Culling, Raster, Settings, Shading, TextureMethod, WireSettings,
};
