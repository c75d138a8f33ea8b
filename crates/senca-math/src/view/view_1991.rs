//! The viewing operations in the form of the 1991 thesis (section 2.4.4): other partial matrices than
//! the course text's, the same products.
//!
//! The text asks for F > B, yet its sample scene puts B on the viewer's side. The matrices are
//! therefore built for both orders; with B > F canonical depth runs backwards, which
//! [`View1991::view`] sets right by exchanging the two planes. What differs from the program of 1991:
//! the clip matrix has 0, not 1, in its last place, as the text derives it.

use glam::{DMat4, DVec3};

use super::by_normal::{move_to_origin, turn_to_axes};
use super::parameters::{box_from_frustum, frustum_from_box, shear_step};
use super::{View, ViewError, ViewParameters, ViewStep, ViewSteps};

/// Which of the normalising transforms of the 1991 text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normalization1991 {
    /// `M S SH T(-PRP) R T(-VRP)`: central, to x and y in [-1, 1] and z in [-1, 0].
    Perspective,
    /// `S T SH R T(-VRP)`: parallel, to x and y in [-1, 1] and z in [-1, 0].
    Parallel,
    /// The same with GKS's limits for x and y, [0, 1]; z stays in [-1, 0].
    ParallelGks,
}

/// A view normalised as in the 1991 text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View1991 {
    /// The parameters, except that B > F is allowed.
    pub parameters: ViewParameters,
    /// The transform.
    pub normalization: Normalization1991,
}

impl View1991 {
    /// The derived camera model: a central view from `eye` towards `target` with a window of this
    /// size through the target, at right angles to the direction of view.
    ///
    /// # Errors
    /// [`ViewError::EyeAtTarget`].
    pub fn camera(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        window_size: glam::DVec2,
        front: f64,
        back: f64,
    ) -> Result<Self, ViewError> {
        if eye == target {
            return Err(ViewError::EyeAtTarget);
        }
        let parameters = ViewParameters {
            vrp: target,
            vpn: eye - target,
            vup: up,
            prp: DVec3::new(0.0, 0.0, (eye - target).length()),
            window: super::ViewWindow::centered(window_size.x, window_size.y),
            front,
            back,
        };
        Ok(Self { parameters, normalization: Normalization1991::Perspective })
    }

    /// The partial matrices in the order of application.
    ///
    /// # Errors
    /// Everything that gives no normalised volume; see [`ViewError`].
    pub fn steps(&self) -> Result<ViewSteps, ViewError> {
        let p = &self.parameters;
        let d = p.derived()?;
        if p.front == p.back {
            return Err(ViewError::FrontEqualsBack(p.front));
        }
        let mut steps = vec![move_to_origin("T(-VRP)", p.vrp), turn_to_axes("R", d.axes)];
        match self.normalization {
            Normalization1991::Perspective => {
                p.check_before_eye()?;
                steps.push(move_to_origin("T(-PRP)", p.prp));
                steps.push(shear_step("SH", d.dop));
                steps.extend(perspective_steps(p, d.dop.z));
            }
            Normalization1991::Parallel => {
                steps.push(shear_step("SH", d.dop));
                steps.extend(box_steps(p, p.window.center().extend(p.front), 2.0));
            }
            Normalization1991::ParallelGks => {
                let corner = DVec3::new(p.window.umin, p.window.vmin, p.front);
                steps.push(shear_step("SH", d.dop));
                steps.extend(box_steps(p, corner, 1.0));
            }
        }
        ViewSteps::new(steps)
    }

    /// The view as renderers use it, with depth growing away from the viewer whichever of F and B is
    /// the greater.
    ///
    /// # Errors
    /// Those of [`Self::steps`].
    pub fn view(&self) -> Result<View, ViewError> {
        self.steps()?;
        let mut p = self.parameters;
        (p.front, p.back) = (p.front.max(p.back), p.front.min(p.back));
        match self.normalization {
            Normalization1991::Perspective => p.central_view(),
            Normalization1991::Parallel | Normalization1991::ParallelGks => p.parallel_view(),
        }
    }
}

/// S and M of the central view; `vrp_z` is the z of VRP after the shear.
fn perspective_steps(p: &ViewParameters, vrp_z: f64) -> [ViewStep; 2] {
    let factors = (2.0 * vrp_z / p.window.size()).extend(-1.0) / (vrp_z + p.back);
    let z_min = -(vrp_z + p.front) / (vrp_z + p.back);
    let deform = ViewStep {
        name: "M",
        meaning: "deforms the pyramid to a box",
        forward: box_from_frustum(z_min),
        inverse: frustum_from_box(z_min),
    };
    [scale_step_1991(factors), deform]
}

/// T and S of the parallel view: `origin` goes to 0, the window's sides to `side`.
fn box_steps(p: &ViewParameters, origin: DVec3, side: f64) -> [ViewStep; 2] {
    let factors = (side / p.window.size()).extend(1.0 / (p.front - p.back));
    let shift = ViewStep { meaning: "centres the front face", ..move_to_origin("T", origin) };
    [shift, scale_step_1991(factors)]
}

fn scale_step_1991(factors: DVec3) -> ViewStep {
    ViewStep {
        name: "S",
        meaning: "scales to unit size",
        forward: DMat4::from_scale(factors),
        inverse: DMat4::from_scale(factors.recip()),
    }
}
