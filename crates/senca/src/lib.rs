//! A 3-D rendering system that needs no GPU.
//!
//! This crate is the front door: it names the rooms of the house and joins them. The rooms are
//! crates of their own, reachable as modules here: [`math`], [`scene`], [`io`], [`shading`],
//! [`raster`], [`pipeline`], [`mod@trace`], [`radiosity`] and [`classic`].
//!
//! [`render`] draws a scene in one call; [`io::load`] reads one from a file of any format:
//!
//! ```no_run
//! use senca::io::images::{PictureFormat, PictureOptions, encode};
//! use senca::{Settings, io, render};
//!
//! let scene = io::load("teapot.toml".as_ref())?;
//! let (image, _) = render(&scene, &Settings::default())?;
//! let png = encode(&image, PictureFormat::Png, &PictureOptions::default())?;
//! io::write_file("teapot.png".as_ref(), &png)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod false_color;
mod lamps;
mod lighting;
mod line_drawing;
mod prepare;
mod render;
mod settings;
mod tone_map;
mod traced;

pub use error::Error;
pub use false_color::false_color;
pub use lighting::{
    Baking, BeyondWhite, ColorEncoding, ComputedLight, Display, LuxPlaces, OnRound, RadiositySettings, Show,
    Solver, bake_light, bake_light_picture, beyond_white, compute_light, measure_lux,
    scene_light_fingerprint, show_light,
};
pub use line_drawing::render_svg;
pub use prepare::{Prepared, prepare};
pub use render::{Report, render, render_with};
pub use settings::{LookAt, Method, Moment, Settings, Tracing, Viewpoint};
pub use tone_map::ToneMap;
pub use traced::{
    CameraOptics, ExplainedPixel, SavePartial, TraceJob, TracedPicture, explain_pixel, trace_with,
};

pub use senca_classic as classic;
pub use senca_io as io;
pub use senca_math as math;
pub use senca_math::Image;
pub use senca_pipeline as pipeline;
pub use senca_radiosity as radiosity;
pub use senca_raster as raster;
pub use senca_scene as scene;
pub use senca_scene::Scene;
pub use senca_shading as shading;
pub use senca_trace as trace;
