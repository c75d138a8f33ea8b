//! From shapes to meshes.
//!
//! [`tessellate`] turns any [`Shape`] into a [`Mesh`] with exact normals and texture coordinates, by
//! these rules:
//!
//! 1. Points are stored once. Where two parts of a shape meet they name the same points, so a closed
//!    shape gives a closed mesh at every tolerance.
//! 2. Creases are borders between surfaces; inside a surface normals are those of the shape itself,
//!    not of its faces.
//! 3. Where patches meet, the number of steps along the common edge is found from that edge's curve
//!    alone, so both sides choose the same points and no crack opens (course text, section 2.3, asks
//!    for planar patches; cracks are what independent choices would leave).
//! 4. Places where a parameter line shrinks to a point (poles, tips) keep a normal: the limit from
//!    inside.
//! 5. The number of faces is bounded by [`MAX_FACES`] whatever the tolerance.
//!
//! Flat shapes are exact with as few faces as they have sides and are not divided further.

mod bend;
mod build;
mod contour;
mod lathe;
mod nurbs;
mod patches;
mod polygon;
mod revolution;
mod solids;
mod stitch;
mod tolerance;

use std::borrow::Cow;

use crate::{Mesh, NormalSettings, Shape};

pub use polygon::triangulated;
pub use revolution::CREASE as REVOLUTION_CREASE;
pub use tolerance::{PixelTolerance, Tolerance};

/// Upper limit for the faces of one tessellated shape; a finer tolerance is coarsened to meet it.
pub const MAX_FACES: u64 = 1 << 23;

/// How shapes become meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TessellationSettings {
    /// How close the mesh is to the shape. Default 0.01 object units.
    pub tolerance: Tolerance,
    /// Edge length of the square that stands for an endless plane, > 0. Default 10 000.
    pub plane_extent: f64,
    /// Whether flat four-sided faces and polygons are kept whole (for line drawings) instead of being
    /// split into triangles. Default false.
    pub polygons: bool,
    /// How normals are made for meshes that come without.
    pub normals: NormalSettings,
}

impl Default for TessellationSettings {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::World(0.01),
            plane_extent: 1e4,
            polygons: false,
            normals: NormalSettings::default(),
        }
    }
}

/// Why a shape has no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A length, angle or count is outside its range.
    #[error("{shape}: {parameter} is {value}, but must be {expected}")]
    Parameter {
        /// Name of the shape.
        shape: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// Points or numbers that do not make a shape.
    #[error("{shape}: {reason}")]
    Malformed {
        /// Name of the shape.
        shape: &'static str,
        /// What is wrong and what would be right.
        reason: String,
    },
}

/// The mesh of `shape`: with normals and texture coordinates, in triangles unless
/// [`TessellationSettings::polygons`] is set. A mesh that is in that form already is borrowed.
///
/// # Errors
/// [`ShapeError`] when a parameter of the shape is out of range, or a mesh names points or vertices
/// that it does not have.
pub fn tessellate<'a>(
    shape: &'a Shape,
    settings: &TessellationSettings,
) -> Result<Cow<'a, Mesh>, ShapeError> {
    if let Shape::Mesh(mesh) = shape {
        return polygon::finished_mesh(mesh, settings);
    }
    let mesh = solids::mesh_of(shape, settings)?;
    if mesh.points.iter().all(|p| p.is_finite()) {
        return Ok(Cow::Owned(mesh));
    }
    let reason = "it is too large for single precision".to_owned();
    Err(ShapeError::Malformed { shape: "shape", reason })
}

/// `Ok` when `value` is finite and above 0.
fn positive(shape: &'static str, parameter: &'static str, value: f64) -> Result<(), ShapeError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ShapeError::Parameter { shape, parameter, value, expected: "above 0 and finite" })
}

/// `Ok` when `value` is finite and not below 0.
fn not_negative(shape: &'static str, parameter: &'static str, value: f64) -> Result<(), ShapeError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ShapeError::Parameter { shape, parameter, value, expected: "0 or more and finite" })
}

#[cfg(test)]
mod tests;
