//! The conventions of the whole system, written once.
//!
//! World and object space are right-handed, y is up unless a file says otherwise, a camera looks
//! along its own -z, and a face seen with counter-clockwise corners shows its front.

/// Window depth of the nearest visible point.
pub const DEPTH_NEAR: f32 = 0.0;

/// Window depth of the farthest visible point; depth buffers clear to it.
pub const DEPTH_FAR: f32 = 1.0;

/// Offset of a pixel's centre from its corner: pixel `(x, y)` is sampled at `(x + 0.5, y + 0.5)`.
pub const PIXEL_CENTER: f32 = 0.5;

/// Identifier of "nothing here" in identifier targets.
pub const NO_ID: u32 = u32::MAX;

/// Window depth, 0 near to 1 far, of a depth in the canonical volume of the viewing operations,
/// where 0 is the front plane and -1 the back plane.
#[must_use]
pub fn depth_from_canonical(z_canonical: f64) -> f64 {
    -z_canonical
}

/// Depth in the canonical volume (0 front, -1 back) of a window depth. Inverse of
/// [`depth_from_canonical`].
#[must_use]
pub fn canonical_from_depth(depth: f64) -> f64 {
    -depth
}

/// Window depth, 0 near to 1 far, of OpenGL's normalised device depth, -1 near to 1 far.
#[must_use]
pub fn depth_from_opengl(z_ndc: f64) -> f64 {
    0.5 * z_ndc + 0.5
}
