//! A camera as people describe it: where it stands, what it looks at, how wide it sees.

use glam::{DMat4, DVec3};

use super::error::check_finite;
use super::{View, ViewError, ViewParameters, ViewWindow, ViewingOperation};
use crate::frame::axes_from_z_and_up;

/// What a camera's lens does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Central projection.
    Perspective {
        /// Full vertical angle of view in radians, in (0, pi).
        yfov: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of the window in world units, > 0.
        height: f64,
    },
}

/// A camera that looks from a point at a point, through a window centred on its line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAtCamera {
    /// Position, in world coordinates.
    pub eye: DVec3,
    /// A point on the line of sight, in world coordinates.
    pub target: DVec3,
    /// A direction that shall look upright, not parallel to the line of sight.
    pub up: DVec3,
    /// The projection.
    pub lens: Lens,
    /// Width of the picture over its height, > 0.
    pub aspect: f64,
    /// Distance of the near plane from the eye; > 0 for a perspective lens.
    pub near: f64,
    /// Distance of the far plane from the eye, > near.
    pub far: f64,
}

impl LookAtCamera {
    /// The same view by the parameters of operations B and C, with the view plane through the target.
    ///
    /// # Errors
    /// Everything that gives no view; see [`ViewError`].
    pub fn viewing_operation(&self) -> Result<ViewingOperation, ViewError> {
        check_finite(&[("near", &[self.near]), ("far", &[self.far])])?;
        check_aspect(self.aspect)?;
        check_far(self.near, Some(self.far))?;
        world_from_look_at(self.eye, self.target, self.up)?;
        let distance = (self.eye - self.target).length();
        let height = match self.lens {
            Lens::Perspective { yfov } => {
                check_near(self.near)?;
                2.0 * distance * tan_of_half(yfov)?
            }
            Lens::Orthographic { height } => checked_height(height)?,
        };
        let parameters = ViewParameters {
            vrp: self.target,
            vpn: self.eye - self.target,
            vup: self.up,
            prp: DVec3::new(0.0, 0.0, distance),
            window: ViewWindow::centered(self.aspect * height, height),
            front: distance - self.near,
            back: distance - self.far,
        };
        Ok(match self.lens {
            Lens::Perspective { .. } => ViewingOperation::Central(parameters),
            Lens::Orthographic { .. } => ViewingOperation::Parallel(parameters),
        })
    }

    /// The view as renderers use it.
    ///
    /// # Errors
    /// Everything that gives no view; see [`ViewError`].
    pub fn view(&self) -> Result<View, ViewError> {
        let world_from_camera = world_from_look_at(self.eye, self.target, self.up)?;
        let Self { aspect, near, far, .. } = *self;
        match self.lens {
            Lens::Perspective { yfov } => {
                View::perspective(&world_from_camera, yfov, aspect, near, Some(far))
            }
            Lens::Orthographic { height } => {
                View::orthographic(&world_from_camera, height, aspect, near, far)
            }
        }
    }
}

/// Place and orientation of a camera at `eye` that looks along its -z towards `target`, with its y as
/// upright as `up` allows.
///
/// # Errors
/// A coordinate that is not finite, eye and target in one place, an up vector that is zero or
/// parallel to the line of sight.
pub fn world_from_look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<DMat4, ViewError> {
    check_finite(&[("eye", &eye.to_array()), ("target", &target.to_array()), ("up", &up.to_array())])?;
    if eye == target {
        return Err(ViewError::EyeAtTarget);
    }
    if up == DVec3::ZERO {
        return Err(ViewError::ZeroVup);
    }
    let axes = axes_from_z_and_up(eye - target, up).ok_or(ViewError::VupParallelToVpn)?;
    Ok(DMat4::from_mat3_translation(axes, eye))
}

pub(super) fn tan_of_half(yfov: f64) -> Result<f64, ViewError> {
    if yfov > 0.0 && yfov < std::f64::consts::PI {
        Ok((0.5 * yfov).tan())
    } else {
        Err(ViewError::FieldOfView(yfov))
    }
}

pub(super) fn check_aspect(aspect: f64) -> Result<(), ViewError> {
    if aspect > 0.0 && aspect.is_finite() { Ok(()) } else { Err(ViewError::Aspect(aspect)) }
}

pub(super) fn checked_height(height: f64) -> Result<f64, ViewError> {
    if height > 0.0 && height.is_finite() { Ok(height) } else { Err(ViewError::Height(height)) }
}

pub(super) fn check_near(near: f64) -> Result<(), ViewError> {
    if near > 0.0 && near.is_finite() { Ok(()) } else { Err(ViewError::Near(near)) }
}

pub(super) fn check_far(near: f64, far: Option<f64>) -> Result<(), ViewError> {
    match far {
        Some(far) if !(far > near && far.is_finite()) => Err(ViewError::FarBeforeNear { near, far }),
        _ => Ok(()),
    }
}
