//! Mathematics of Senca: transforms, viewing operations, curves, roots, colour and pictures.
//!
//! Construction runs in `f64`; types that hot loops read are `f32`. Vectors and matrices are
//! [`glam`]'s, which multiplies column vectors from the left: a matrix that takes world points to
//! view points is called `view_from_world`, and `clip_from_view * view_from_world` checks itself.
//! Where a book prints row vectors, the printing routine transposes on the way out.

pub mod aabb;
pub mod color;
pub mod conventions;
pub mod device;
pub mod frame;
pub mod hls;
pub mod image;
pub mod line;
pub mod plane;
pub mod polygon;
pub mod projective;
pub mod ray;
pub mod row_matrix;
pub mod transform;
pub mod view;
pub mod view_file;

#[cfg(test)]
mod test_support;

pub use aabb::Aabb;
pub use color::{LinearRgb, Srgb8};
pub use device::{DeviceError, DeviceMap, Rect, pixel_center};
pub use frame::{Orthonormality, axes_from_z_and_up, orthonormality};
pub use glam;
pub use hls::Hls;
pub use image::Image;
pub use line::Line2;
pub use plane::{CANONICAL_VOLUME, CLIP_VOLUME, Plane};
pub use projective::{HomogeneousPoint, is_collineation, normalized, same_map};
pub use ray::Ray;
pub use row_matrix::{aligned_text, book_rows, from_book_rows, json_rows};
pub use transform::{Axis, compose, normal_matrix};
pub use view::{
    CentralByNormal, Lens, LookAtCamera, Normalization1991, ParallelByNormal, View, View1991, ViewError,
    ViewKind, ViewParameters, ViewStep, ViewSteps, ViewWindow, ViewingOperation, clip_from_canonical,
    clip_from_gks, clip_from_opengl, world_from_look_at,
};
pub use view_file::{ViewFile, ViewFileError, ViewFileErrorKind};
