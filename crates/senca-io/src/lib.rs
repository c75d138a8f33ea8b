//! Readers and writers of scenes, meshes and pictures.
//!
//! Every reader takes the file's bytes and a [`Files`] that fetches the files it names, and gives a
//! [`Scene`](senca_scene::Scene) or one [`ReadError`] that says where and what; none panics, hangs or
//! takes memory out of proportion to its input. Every writer fills a buffer; [`write_file`] puts it
//! in place at once or not at all.

pub mod classic;
mod detect;
mod error;
mod files;
mod flatten;
pub mod gltf;
pub mod images;
mod load;
mod mtl;
mod normals;
pub mod obj;
mod output;
pub mod ply;
pub mod stl;
pub mod svg;
mod text;
pub mod toml_scene;
mod weld;

pub use detect::{Format, detect};
pub use error::{Location, ReadError, WriteError};
use files::stem;
pub use files::{Directory, Files, Limits, NoFiles};
pub use flatten::combined as combined_mesh;
pub use load::{combined_patches, load, load_bytes, load_bytes_with_hints, load_with_hints, save};
pub use output::{write_file, write_file_while};
