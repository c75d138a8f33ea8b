//! OpenGL 1.x as a safe state machine.
//!
//! A [`Context`] is an OpenGL of its own, without globals: commands are its methods, state is asked for
//! with its questions, and the picture is in its window's buffers. It draws with the tiled rasterizer of
//! `senca-raster`, on all threads.
//!
//! ```
//! use senca_gl::{Config, Context, gl};
//!
//! let mut c = Context::new(Config::default());
//! assert!(c.resize(8, 8));
//! c.clear(gl::COLOR_BUFFER_BIT);
//! c.color([1.0, 0.0, 0.0]);
//! c.rect([-1, -1], [0, 1]);
//! c.finish();
//! assert_eq!(c.window_pixels()[0], [255, 0, 0, 255]);
//! assert_eq!(c.window_pixels()[7], [0, 0, 0, 0]);
//! ```
//!
//! Vertices are transformed, lit and put together as they come, and gathered until something that matters
//! for drawing changes or somebody looks. So many small objects with matrices and materials of their own
//! are drawn as one.
//!
//! Source of all rules: Segal, Akeley: The OpenGL Graphics System, version 1.5 (2003), and the
//! specifications of the extensions.

mod arrays;
mod assemble;
mod attrib;
mod commands;
mod component;
mod context;
mod debug;
mod drawpix;
mod error;
mod eval;
mod fragment;
mod framebuffer;
mod get;
#[path = "tokens.rs"]
pub mod gl;
mod image_state;
mod immediate;
mod light_lanes;
mod lighting;
mod list;
mod matrix;
mod parked;
pub mod pixel;
mod pixel_state;
mod query;
mod raster;
mod raster_pos;
mod raster_state;
mod select;
mod state;
mod texture;
mod vertex;
mod window;

/// A name of the specification, one of [`gl`]; or bits of a mask.
pub type Enum = u32;

pub use arrays::{ArraySource, ClientMemory};
pub use attrib::SavedState;
pub use component::Component;
pub use context::{Config, Context, ShareGroup};
pub use debug::{DebugCallback, DebugMessage};
pub use error::Error;
pub use eval::{MAX_ORDER as MAX_EVAL_ORDER, map_components};
pub use get::{EXTENSIONS, Values};
pub use list::list_name_bytes;
pub use window::{Colors, WindowBuffers, max_window_side};

#[cfg(test)]
mod image_fuzz;
// The example's programs, which name this crate, are drawn by the tests, too.
#[cfg(test)]
extern crate self as senca_gl;
#[cfg(test)]
mod tests;
