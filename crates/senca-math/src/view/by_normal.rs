//! Viewing operation A, and parallel projection by a point and a normal.
//!
//! Both orient the image plane by its normal alone: the picture's x axis is at right angles to the
//! normal and to the world's z axis. Source: course text, sections 1.5 and 1.7 (example 1.11).

use glam::{DMat3, DMat4, DVec3};

use super::error::check_finite;
use super::{ViewError, ViewParameters, ViewStep, ViewSteps, ViewWindow};
use crate::frame::axes_from_z_and_up;
use crate::transform::central_projection_to_xy;

/// How far the length of a given normal may be from 1; it is then made exactly 1. Wide enough for
/// components typed with four digits.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Viewing operation A: central projection from a centre, an image plane normal and a distance.
///
/// The book leaves the normal along z undefined; here the y axis then takes the place of the z axis
/// in choosing the picture's x axis, so that `n = (0, 0, 1)` turns nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralByNormal {
    /// P, the centre of projection, in world coordinates.
    pub center: DVec3,
    /// n, the unit normal of the image plane, pointing from the plane to the centre's side.
    pub normal: DVec3,
    /// f, the distance from the centre to the image plane, not zero.
    pub focal: f64,
}

/// Parallel projection along the normal of an image plane. The product takes a point to picture
/// coordinates and its signed distance from the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelByNormal {
    /// P, a point of the image plane and the origin of the picture, in world coordinates.
    pub point: DVec3,
    /// n, the unit normal of the image plane, pointing to the viewer.
    pub normal: DVec3,
}

impl CentralByNormal {
    /// T1 (centre to the origin), T2 (turn), T3 (origin into the image plane), T4 (projection).
    ///
    /// # Errors
    /// A quantity that is not finite, a normal that is not unit, a zero distance.
    pub fn steps(&self) -> Result<ViewSteps, ViewError> {
        check_finite(&[("P", &self.center.to_array()), ("f", &[self.focal])])?;
        if self.focal == 0.0 {
            return Err(ViewError::ZeroFocal);
        }
        let into_plane = DVec3::new(0.0, 0.0, self.focal);
        let mut steps = orientation(self.center, self.normal)?.to_vec();
        steps.push(ViewStep {
            name: "T3",
            meaning: "moves the origin into the image plane",
            forward: DMat4::from_translation(into_plane),
            inverse: DMat4::from_translation(-into_plane),
        });
        steps.push(ViewStep {
            name: "T4",
            meaning: "projects from the centre and keeps depth",
            forward: central_projection_to_xy(self.focal),
            inverse: central_projection_to_xy(-self.focal),
        });
        ViewSteps::new(steps)
    }

    /// The same projection bounded by a window in the image plane and by front and back planes, for
    /// viewing operation B.
    ///
    /// # Errors
    /// Those of [`Self::steps`].
    pub fn parameters(&self, window: ViewWindow, front: f64, back: f64) -> Result<ViewParameters, ViewError> {
        self.steps()?;
        let normal = checked_normal(self.normal)?;
        Ok(ViewParameters {
            vrp: self.center - self.focal * normal,
            vpn: normal,
            vup: helper_axis(normal),
            prp: DVec3::new(0.0, 0.0, self.focal),
            window,
            front,
            back,
        })
    }
}

impl ParallelByNormal {
    /// T1 (point to the origin) and T2 (turn).
    ///
    /// # Errors
    /// A quantity that is not finite, a normal that is not unit.
    pub fn steps(&self) -> Result<ViewSteps, ViewError> {
        check_finite(&[("P", &self.point.to_array())])?;
        ViewSteps::new(orientation(self.point, self.normal)?.to_vec())
    }

    /// The same projection bounded by a window in the image plane and by front and back planes, for
    /// viewing operation C.
    ///
    /// # Errors
    /// Those of [`Self::steps`], and those of [`ViewWindow::check`].
    pub fn parameters(&self, window: ViewWindow, front: f64, back: f64) -> Result<ViewParameters, ViewError> {
        self.steps()?;
        window.check()?;
        let normal = checked_normal(self.normal)?;
        let distance = 1.0 + front.max(back).max(0.0);
        Ok(ViewParameters {
            vrp: self.point,
            vpn: normal,
            vup: helper_axis(normal),
            prp: window.center().extend(distance),
            window,
            front,
            back,
        })
    }
}

fn orientation(origin: DVec3, normal: DVec3) -> Result<[ViewStep; 2], ViewError> {
    let axes = axes_of(normal)?;
    Ok([move_to_origin("T1", origin), turn_to_axes("T2", axes)])
}

/// The step that brings `point` to the origin.
pub(super) fn move_to_origin(name: &'static str, point: DVec3) -> ViewStep {
    ViewStep {
        name,
        meaning: "moves the point of reference to the origin",
        forward: DMat4::from_translation(-point),
        inverse: DMat4::from_translation(point),
    }
}

/// The step that turns orthonormal axes onto the coordinate axes.
pub(super) fn turn_to_axes(name: &'static str, axes: DMat3) -> ViewStep {
    ViewStep {
        name,
        meaning: "turns the axes of the view onto the coordinate axes",
        forward: DMat4::from_mat3(axes.transpose()),
        inverse: DMat4::from_mat3(axes),
    }
}

fn checked_normal(normal: DVec3) -> Result<DVec3, ViewError> {
    check_finite(&[("n", &normal.to_array())])?;
    let length = normal.length();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        return Err(ViewError::NormalNotUnit { length });
    }
    Ok(normal / length)
}

fn axes_of(normal: DVec3) -> Result<DMat3, ViewError> {
    let normal = checked_normal(normal)?;
    axes_from_z_and_up(normal, helper_axis(normal)).ok_or(ViewError::DegenerateFrame)
}

/// The world's z axis, or its y axis for a normal along z.
fn helper_axis(unit_normal: DVec3) -> DVec3 {
    if unit_normal.truncate().length() < 1e-9 { DVec3::Y } else { DVec3::Z }
}
