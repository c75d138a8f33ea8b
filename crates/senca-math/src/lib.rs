//! Mathematics of Senca: transforms, viewing operations, curves, roots, colour and pictures.
//!
//! Construction runs in `f64`; types that hot loops read are `f32`. Vectors and matrices are
//! [`glam`]'s, which multiplies column vectors from the left: a matrix that takes world points to
//! view points is called `view_from_world`, and `clip_from_view * view_from_world` checks itself.
//! Where a book prints row vectors, the printing routine transposes on the way out.
//!
//! | subject | modules |
//! |---|---|
//! | maps and frames | [`transform`], [`frame`], [`projective`], [`row_matrix`] |
//! | what cameras see | [`view`], [`view_file`], [`device`] |
//! | flat things | [`mod@line`], [`plane`], [`polygon`], [`ray`], [`aabb`] |
//! | curved things | [`bezier`], [`nurbs`], [`roots`] |
//! | formulas | [`mod@expression`], [`mod@interval`] |
//! | pictures | [`mod@color`], [`hls`], [`mod@image`] |
//!
//! From the scene to a pixel, and back:
//!
//! ```
//! use senca_math::glam::DVec3;
//! use senca_math::{DeviceMap, View, pixel_center};
//!
//! let device = DeviceMap::to_pixels(640, 480)?;
//! let camera = View::look_at(DVec3::new(3.0, 2.0, 5.0), DVec3::ZERO, DVec3::Y)?;
//! let view = View::perspective(&camera, 0.8, device.aspect(), 0.1, None)?;
//!
//! let seen = view.device_from_world(&device, DVec3::ZERO).ok_or("behind the eye")?;
//! assert!((seen.truncate() - DVec3::new(320.0, 240.0, 0.0).truncate()).length() < 1e-9);
//! let ray = view.ray_through(&device, pixel_center(320, 240)).ok_or("too large")?;
//! assert!(ray.direction.dot(DVec3::new(-3.0, -2.0, -5.0).normalize()) > 0.999);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod aabb;
pub mod bezier;
pub mod color;
mod control;
pub mod conventions;
pub mod device;
pub mod expression;
pub mod frame;
pub mod hls;
pub mod image;
pub mod interval;
pub mod line;
pub mod nurbs;
pub mod plane;
pub mod polygon;
pub mod projective;
pub mod ray;
pub mod roots;
pub mod row_matrix;
pub mod srgb_table;
pub mod transform;
pub mod view;
pub mod view_file;

#[cfg(test)]
mod test_support;

pub use aabb::Aabb;
pub use bezier::{BicubicPatch, Continuity, CubicCurve, PatchEdge, Seam, SurfacePoint};
pub use color::{LinearRgb, Srgb8};
pub use control::{Cancelled, Control};
pub use device::{DeviceError, DeviceMap, Rect, pixel_center};
pub use expression::{Expression, ExpressionError, Polynomial3, RayPolynomial};
pub use frame::{Orthonormality, axes_from_z_and_up, orthonormality};
pub use glam;
pub use hls::Hls;
pub use image::Image;
pub use interval::Interval;
pub use line::Line2;
pub use nurbs::{BezierPiece, KnotVector, NurbsCurve, NurbsError, NurbsSurface, RationalPatch};
pub use plane::{CANONICAL_VOLUME, CLIP_VOLUME, Plane};
pub use polygon::{
    newell_normal, newell_normal_of, triangulate, triangulate_in_space, triangulate_with_holes,
};
pub use projective::{HomogeneousPoint, is_collineation, normalized, same_map};
pub use ray::Ray;
pub use roots::{
    Roots, cubic_roots, cubic_roots_closed_form, quadratic_roots, quartic_roots, quartic_roots_closed_form,
};
pub use row_matrix::{aligned_text, book_rows, from_book_rows, json_rows, named_json, named_text};
pub use srgb_table::SrgbTable;
pub use transform::{Axis, compose, normal_matrix};
pub use view::{
    CentralByNormal, Lens, LookAtCamera, Normalization1991, ParallelByNormal, View, View1991, ViewError,
    ViewKind, ViewParameters, ViewStep, ViewSteps, ViewWindow, ViewingOperation, clip_from_canonical,
    clip_from_gks, clip_from_opengl, world_from_look_at,
};
pub use view_file::{ViewFile, ViewFileError, ViewFileErrorKind};
