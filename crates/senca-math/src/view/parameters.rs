//! Viewing operations B and C: the general central and parallel view.
//!
//! Source: course text, sections 1.6, 1.7 and 1.9; the names of the parameters are those of PHIGS.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

use super::by_normal::{move_to_origin, turn_to_axes};
use super::error::check_finite;
use super::{View, ViewError, ViewKind, ViewStep, ViewSteps, clip_from_canonical};
use crate::frame::{axes_from_z_and_up, unit};
use crate::transform::shear_xy;

/// The part of the view plane that is shown, in view reference coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewWindow {
    /// Left limit.
    pub umin: f64,
    /// Right limit, > `umin`.
    pub umax: f64,
    /// Lower limit.
    pub vmin: f64,
    /// Upper limit, > `vmin`.
    pub vmax: f64,
}

impl ViewWindow {
    /// A window from its limits in the order of the course text.
    #[must_use]
    pub const fn new(umin: f64, umax: f64, vmin: f64, vmax: f64) -> Self {
        Self { umin, umax, vmin, vmax }
    }

    /// A window of this size about the origin.
    #[must_use]
    pub fn centered(width: f64, height: f64) -> Self {
        Self::new(-0.5 * width, 0.5 * width, -0.5 * height, 0.5 * height)
    }

    /// CW, the centre.
    #[must_use]
    pub fn center(&self) -> DVec2 {
        0.5 * DVec2::new(self.umin, self.vmin) + 0.5 * DVec2::new(self.umax, self.vmax)
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        DVec2::new(self.umax - self.umin, self.vmax - self.vmin)
    }

    /// Tests that the limits are finite and in order.
    ///
    /// # Errors
    /// [`ViewError::NotFinite`] or [`ViewError::EmptyWindow`].
    pub fn check(&self) -> Result<(), ViewError> {
        let Self { umin, umax, vmin, vmax } = *self;
        check_finite(&[("window", &[umin, umax, vmin, vmax])])?;
        if umin < umax && vmin < vmax {
            Ok(())
        } else {
            Err(ViewError::EmptyWindow { umin, umax, vmin, vmax })
        }
    }
}

/// The parameters of the general view. View reference coordinates (VRC) have their origin in VRP,
/// z along VPN, and y as upright as VUP allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewParameters {
    /// View reference point: a point of the view plane, in world coordinates.
    pub vrp: DVec3,
    /// View plane normal, towards the viewer, of any length but 0, in world coordinates.
    pub vpn: DVec3,
    /// View up vector, of any length but 0, not parallel to VPN, in world coordinates.
    pub vup: DVec3,
    /// Projection reference point in VRC: the eye of a central view; in a parallel view the direction
    /// of projection runs from it to the centre of the window. Its z must not be 0.
    pub prp: DVec3,
    /// The window on the view plane.
    pub window: ViewWindow,
    /// F, signed distance of the front plane from the view plane along VPN.
    pub front: f64,
    /// B, signed distance of the back plane from the view plane along VPN, < F.
    pub back: f64,
}

/// Quantities that both operations derive from the parameters.
pub(super) struct Derived {
    /// Axes of VRC in the world, as columns.
    pub(super) axes: DMat3,
    /// Direction of projection in VRC, from PRP to the centre of the window.
    pub(super) dop: DVec3,
}

impl ViewParameters {
    /// The partial matrices T1 to T6 of the central view, operation B. Their product takes the
    /// truncated pyramid to the canonical volume: x and y in [-1, 1], z from 0 in front to -1.
    ///
    /// # Errors
    /// Everything that gives no such volume; see [`ViewError`].
    pub fn central_steps(&self) -> Result<ViewSteps, ViewError> {
        let d = self.derived()?;
        self.check_planes()?;
        self.check_before_eye()?;
        let z_back = d.dop.z + self.back;
        let scale_z = -1.0 / z_back;
        let scale_xy = 2.0 * d.dop.z / (self.window.size() * z_back);
        let z_front = scale_z * (d.dop.z + self.front);
        let mut steps = self.steps_to_upright(&d);
        steps.push(scale_step(scale_xy.extend(scale_z)));
        steps.push(ViewStep {
            name: "T6",
            meaning: "deforms the pyramid to a box",
            forward: box_from_frustum(z_front),
            inverse: frustum_from_box(z_front),
        });
        ViewSteps::new(steps)
    }

    /// The partial matrices T1 to T6 of the parallel view, operation C. T6 is the one that the text's
    /// own check demands: it moves the front face to z = 0 and leaves the back face at z = -1.
    ///
    /// # Errors
    /// Everything that gives no such volume; see [`ViewError`].
    pub fn parallel_steps(&self) -> Result<ViewSteps, ViewError> {
        let d = self.derived()?;
        self.check_planes()?;
        let z_back = d.dop.z + self.back;
        if z_back == 0.0 {
            return Err(ViewError::BackThroughPrp(self.back));
        }
        let scale_z = -1.0 / z_back;
        let z_front = scale_z * (d.dop.z + self.front);
        let mut steps = self.steps_to_upright(&d);
        steps.push(scale_step((2.0 / self.window.size()).extend(scale_z)));
        steps.push(ViewStep {
            name: "T6",
            meaning: "moves the front face to depth 0",
            forward: depth_map(1.0 / (1.0 + z_front), -z_front / (1.0 + z_front)),
            inverse: depth_map(1.0 + z_front, z_front),
        });
        ViewSteps::new(steps)
    }

    /// The central view as renderers use it.
    ///
    /// # Errors
    /// Those of [`Self::central_steps`].
    pub fn central_view(&self) -> Result<View, ViewError> {
        let kind = ViewKind::Central { eye_world: self.eye_world()? };
        View::from_steps(&self.central_steps()?, 3, clip_from_canonical(), kind)
    }

    /// The parallel view as renderers use it.
    ///
    /// # Errors
    /// Those of [`Self::parallel_steps`].
    pub fn parallel_view(&self) -> Result<View, ViewError> {
        let kind = ViewKind::Parallel { direction_world: self.direction_world()? };
        View::from_steps(&self.parallel_steps()?, 3, clip_from_canonical(), kind)
    }

    /// PRP in world coordinates. Source: course text, section 2.4.
    ///
    /// # Errors
    /// [`ViewError`] when the parameters give no VRC.
    pub fn eye_world(&self) -> Result<DVec3, ViewError> {
        Ok(self.vrp + self.derived()?.axes * self.prp)
    }

    /// Unit vector in the world along which a parallel view looks into the scene.
    ///
    /// # Errors
    /// [`ViewError`] when the parameters give no VRC.
    pub fn direction_world(&self) -> Result<DVec3, ViewError> {
        let d = self.derived()?;
        let inwards = if d.dop.z < 0.0 { d.dop } else { -d.dop };
        unit(d.axes * inwards).ok_or(ViewError::OutOfRange)
    }

    pub(super) fn derived(&self) -> Result<Derived, ViewError> {
        self.check_finite()?;
        self.window.check()?;
        if self.vpn == DVec3::ZERO {
            return Err(ViewError::ZeroVpn);
        }
        if self.vup == DVec3::ZERO {
            return Err(ViewError::ZeroVup);
        }
        let axes = axes_from_z_and_up(self.vpn, self.vup).ok_or(ViewError::VupParallelToVpn)?;
        let dop = self.window.center().extend(0.0) - self.prp;
        // Relative to its length, so that the answer does not depend on the unit of length.
        if dop.z.abs() <= 1e-12 * dop.length() {
            return Err(ViewError::PrpInViewPlane);
        }
        Ok(Derived { axes, dop })
    }

    fn check_finite(&self) -> Result<(), ViewError> {
        check_finite(&[
            ("VRP", &self.vrp.to_array()),
            ("VPN", &self.vpn.to_array()),
            ("VUP", &self.vup.to_array()),
            ("PRP", &self.prp.to_array()),
            ("F", &[self.front]),
            ("B", &[self.back]),
        ])
    }

    fn check_planes(&self) -> Result<(), ViewError> {
        let Self { front, back, .. } = *self;
        match back.total_cmp(&front) {
            _ if back == front => Err(ViewError::FrontEqualsBack(front)),
            std::cmp::Ordering::Less => Ok(()),
            _ => Err(ViewError::BackBeforeFront { front, back }),
        }
    }

    pub(super) fn check_before_eye(&self) -> Result<(), ViewError> {
        let eye = self.prp.z;
        for (plane, distance) in [("front", self.front), ("back", self.back)] {
            if distance >= eye {
                return Err(ViewError::PlaneBehindEye { plane, distance, eye });
            }
        }
        Ok(())
    }

    /// T1 to T4: afterwards PRP is the origin and the window's centre lies on the z axis.
    fn steps_to_upright(&self, d: &Derived) -> Vec<ViewStep> {
        vec![
            move_to_origin("T1", self.vrp),
            turn_to_axes("T2", d.axes),
            ViewStep { meaning: "moves PRP to the origin", ..move_to_origin("T3", self.prp) },
            shear_step("T4", d.dop),
        ]
    }
}

/// The shear that makes the direction of projection upright.
pub(super) fn shear_step(name: &'static str, dop: DVec3) -> ViewStep {
    let slopes = -dop.truncate() / dop.z;
    ViewStep {
        name,
        meaning: "shears the direction of projection upright",
        forward: shear_xy(slopes),
        inverse: shear_xy(-slopes),
    }
}

fn scale_step(factors: DVec3) -> ViewStep {
    ViewStep {
        name: "T5",
        meaning: "scales to unit size",
        forward: DMat4::from_scale(factors),
        inverse: DMat4::from_scale(factors.recip()),
    }
}

/// Takes the upright pyramid with its base of side 2 in z = -1 and its front at `z_front` in (-1, 0)
/// to the canonical box. Source: course text, section 1.6; 1991 thesis, section 2.4.4.3 (as M).
pub(super) fn box_from_frustum(z_front: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::X,
        DVec4::Y,
        DVec4::new(0.0, 0.0, 1.0 / (1.0 + z_front), -1.0),
        DVec4::new(0.0, 0.0, -z_front / (1.0 + z_front), 0.0),
    )
}

/// Undoes [`box_from_frustum`]. Source: course text, section 1.9.
pub(super) fn frustum_from_box(z_front: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::X,
        DVec4::Y,
        DVec4::new(0.0, 0.0, 0.0, -(1.0 + z_front) / z_front),
        DVec4::new(0.0, 0.0, -1.0, -1.0 / z_front),
    )
}

fn depth_map(factor: f64, offset: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(0.0, 0.0, offset)) * DMat4::from_scale(DVec3::new(1.0, 1.0, factor))
}
