//! Mathematics of Senca: transforms, viewing operations, curves, roots, colour and pictures.
//!
//! Construction runs in `f64`; types that hot loops read are `f32`. Vectors and matrices are
//! [`glam`]'s, which multiplies column vectors from the left: a matrix that takes world points to
//! view points is called `view_from_world`, and `clip_from_view * view_from_world` checks itself.
//! Where a book prints row vectors, the printing routine transposes on the way out.

pub mod aabb;
pub mod color;
pub mod conventions;
pub mod image;

pub use aabb::Aabb;
pub use color::{LinearRgb, Srgb8};
pub use glam;
pub use image::Image;
