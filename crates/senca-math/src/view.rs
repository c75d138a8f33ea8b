//! Viewing operations, and the resolved view that all renderers use.
//!
//! | operation | given by | type |
//! |---|---|---|
//! | A, central | centre P, normal n, distance f | [`CentralByNormal`] |
//! | parallel by (P, n) | point P, normal n | [`ParallelByNormal`] |
//! | B, central | VRP, VPN, VUP, PRP, window, F, B | [`ViewParameters::central_steps`] |
//! | C, parallel | the same | [`ViewParameters::parallel_steps`] |
//! | the forms of 1991 | the same | [`View1991`] |
//! | look-at camera | eye, target, up, lens | [`LookAtCamera`] |
//!
//! Each gives its named partial matrices ([`ViewSteps`]), their product, and the inverse from the
//! reversed motions. Where the operation bounds a volume it also gives a [`View`].
//!
//! Source: course text, chapter 1; 1991 thesis, section 2.

mod by_normal;
mod camera;
mod error;
mod operation;
mod parameters;
mod steps;
mod view_1991;

use glam::{DMat3, DMat4, DVec3, DVec4};

pub use by_normal::{CentralByNormal, ParallelByNormal};
pub use camera::{Lens, LookAtCamera, world_from_look_at};
pub use error::ViewError;
pub use operation::ViewingOperation;
pub use parameters::{ViewParameters, ViewWindow};
pub use steps::{ViewStep, ViewSteps};
pub use view_1991::{Normalization1991, View1991};

use camera::{check_aspect, check_far, check_near, checked_height, tan_of_half};

/// How a view sees, for culling and for the direction to the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewKind {
    /// All projectors meet in the eye.
    Central {
        /// The eye, in world coordinates.
        eye_world: DVec3,
    },
    /// All projectors are parallel.
    Parallel {
        /// Unit vector along which the view looks into the scene, in world coordinates.
        direction_world: DVec3,
    },
}

impl ViewKind {
    /// Unit vector from a point towards the viewer; zero at the eye itself.
    #[must_use]
    pub fn towards_viewer(&self, point_world: DVec3) -> DVec3 {
        match *self {
            Self::Central { eye_world } => (eye_world - point_world).normalize_or_zero(),
            Self::Parallel { direction_world } => -direction_world,
        }
    }

    /// Whether a face with this outward normal through this point turns its back to the viewer.
    /// A face seen edge-on does not. Source: course text, section 2.4, equation 2.1.
    #[must_use]
    pub fn sees_back_of(&self, point_world: DVec3, normal_world: DVec3) -> bool {
        match *self {
            Self::Central { eye_world } => normal_world.dot(point_world - eye_world) > 0.0,
            Self::Parallel { direction_world } => normal_world.dot(direction_world) > 0.0,
        }
    }
}

/// A resolved view: from world through view to clip coordinates, and back.
///
/// View coordinates are a rigid motion of the world: the eye (in a parallel view, PRP) in the origin,
/// looking along -z. Clip coordinates are homogeneous: what is seen has x and y in [-w, w] and z in
/// [0, w], with z/w = 0 on the near and 1 on the far plane, and w > 0 before the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to view coordinates, a rigid motion.
    pub view_from_world: DMat4,
    /// View to clip coordinates.
    pub clip_from_view: DMat4,
    /// World to clip coordinates.
    pub clip_from_world: DMat4,
    /// Clip to world coordinates, made of the reversed motions; its result must be divided by w.
    pub world_from_clip: DMat4,
    /// Central or parallel.
    pub kind: ViewKind,
}

impl View {
    /// A central view with a symmetric window, from a camera that looks along its -z with +y up.
    ///
    /// `yfov` is the full vertical angle of view in radians, `aspect` width over height, `near` > 0.
    /// Without `far` the view reaches to infinity. Scale, shear and mirroring in `world_from_camera`
    /// are dropped, as glTF asks.
    ///
    /// # Errors
    /// A degenerate frame, an angle outside (0, pi), an aspect or near distance that is not positive,
    /// a far plane that is not beyond the near plane.
    pub fn perspective(
        world_from_camera: &DMat4,
        yfov: f64,
        aspect: f64,
        near: f64,
        far: Option<f64>,
    ) -> Result<Self, ViewError> {
        check_aspect(aspect)?;
        check_near(near)?;
        check_far(near, far)?;
        let tan = tan_of_half(yfov)?;
        // Depth is (a + b / -z) with 0 at the near and 1 at the far plane.
        let a = far.map_or(1.0, |far| far / (far - near));
        let b = -near * a;
        let clip_from_view = DMat4::from_cols(
            DVec4::X / (aspect * tan),
            DVec4::Y / tan,
            DVec4::new(0.0, 0.0, -a, -1.0),
            DVec4::new(0.0, 0.0, b, 0.0),
        );
        let view_from_clip = DMat4::from_cols(
            DVec4::X * (aspect * tan),
            DVec4::Y * tan,
            DVec4::new(0.0, 0.0, 0.0, 1.0 / b),
            DVec4::new(0.0, 0.0, -1.0, -a / b),
        );
        let (world_from_view, eye_world) = rigid_frame(world_from_camera)?;
        let kind = ViewKind::Central { eye_world };
        Self::assemble(world_from_view, clip_from_view, view_from_clip, kind)
    }

    /// A parallel view at right angles to its window, from a camera that looks along its -z with +y
    /// up. `height` is the window's in world units, `aspect` width over height; `near` < `far` are
    /// distances along the line of sight and may be negative.
    ///
    /// # Errors
    /// A degenerate frame, a height or aspect that is not positive, planes in the wrong order.
    pub fn orthographic(
        world_from_camera: &DMat4,
        height: f64,
        aspect: f64,
        near: f64,
        far: f64,
    ) -> Result<Self, ViewError> {
        let height = checked_height(height)?;
        check_aspect(aspect)?;
        error::check_finite(&[("near", &[near])])?;
        check_far(near, Some(far))?;
        let scale = DVec3::new(2.0 / (aspect * height), 2.0 / height, -1.0 / (far - near));
        let offset = DVec3::new(0.0, 0.0, -near / (far - near));
        let clip_from_view = DMat4::from_translation(offset) * DMat4::from_scale(scale);
        let view_from_clip = DMat4::from_scale(scale.recip()) * DMat4::from_translation(-offset);
        let (world_from_view, _) = rigid_frame(world_from_camera)?;
        let kind = ViewKind::Parallel { direction_world: -world_from_view.z_axis.truncate() };
        Self::assemble(world_from_view, clip_from_view, view_from_clip, kind)
    }

    /// Place and orientation of a camera at `eye` that looks at `target`; see [`world_from_look_at`].
    ///
    /// # Errors
    /// Those of [`world_from_look_at`].
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<DMat4, ViewError> {
        world_from_look_at(eye, target, up)
    }

    /// A view from the steps of an operation, of which the first `rigid` are a rigid motion.
    fn from_steps(
        steps: &ViewSteps,
        rigid: usize,
        clip: (DMat4, DMat4),
        kind: ViewKind,
    ) -> Result<Self, ViewError> {
        let (clip_from_normalized, normalized_from_clip) = clip;
        let view_from_world = steps.product_of_first(rigid);
        let clip_from_view = clip_from_normalized * steps.product_after(rigid);
        Self {
            view_from_world,
            clip_from_view,
            clip_from_world: clip_from_view * view_from_world,
            world_from_clip: steps.inverse() * normalized_from_clip,
            kind,
        }
        .checked()
    }

    fn assemble(
        world_from_view: DMat4,
        clip_from_view: DMat4,
        view_from_clip: DMat4,
        kind: ViewKind,
    ) -> Result<Self, ViewError> {
        let turn = DMat3::from_mat4(world_from_view).transpose();
        let eye = world_from_view.w_axis.truncate();
        let view_from_world = DMat4::from_mat3_translation(turn, -(turn * eye));
        Self {
            view_from_world,
            clip_from_view,
            clip_from_world: clip_from_view * view_from_world,
            world_from_clip: world_from_view * view_from_clip,
            kind,
        }
        .checked()
    }

    fn checked(self) -> Result<Self, ViewError> {
        let finite = self.clip_from_world.is_finite() && self.world_from_clip.is_finite();
        if finite { Ok(self) } else { Err(ViewError::OutOfRange) }
    }
}

/// The rigid part of a camera's frame: its -z and its y as far as they are at right angles,
/// right-handed, of unit length; and its position.
fn rigid_frame(world_from_camera: &DMat4) -> Result<(DMat4, DVec3), ViewError> {
    error::check_finite(&[("the camera's transform", &world_from_camera.to_cols_array())])?;
    let (z, y) = (world_from_camera.z_axis.truncate(), world_from_camera.y_axis.truncate());
    let axes = crate::frame::axes_from_z_and_up(z, y).ok_or(ViewError::DegenerateFrame)?;
    let eye = world_from_camera.w_axis.truncate();
    Ok((DMat4::from_mat3_translation(axes, eye), eye))
}

/// Clip coordinates from the canonical volume of the viewing operations (x and y in [-w, w], z from 0
/// in front to -w at the back), and the reverse.
#[must_use]
pub fn clip_from_canonical() -> (DMat4, DMat4) {
    let flip = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
    (flip, flip)
}

/// Clip coordinates from the volume of [`Normalization1991::ParallelGks`] (x and y in [0, w], z from
/// 0 in front to -w at the back), and the reverse.
#[must_use]
pub fn clip_from_gks() -> (DMat4, DMat4) {
    let to =
        DMat4::from_translation(DVec3::new(-1.0, -1.0, 0.0)) * DMat4::from_scale(DVec3::new(2.0, 2.0, -1.0));
    let from =
        DMat4::from_scale(DVec3::new(0.5, 0.5, -1.0)) * DMat4::from_translation(DVec3::new(1.0, 1.0, 0.0));
    (to, from)
}

/// Clip coordinates from OpenGL's, where z runs from -w in front to w at the back, and the reverse.
#[must_use]
pub fn clip_from_opengl() -> (DMat4, DMat4) {
    let to = DMat4::from_translation(DVec3::Z * 0.5) * DMat4::from_scale(DVec3::new(1.0, 1.0, 0.5));
    let from = DMat4::from_scale(DVec3::new(1.0, 1.0, 2.0)) * DMat4::from_translation(DVec3::Z * -0.5);
    (to, from)
}

#[cfg(test)]
mod tests;
