//! What can be wrong with the description of a view.

/// Why a description gives no view. Every variant is the giver's fault; the message says which
/// quantity is wrong and what would be right.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A NaN or infinite number was given.
    #[error("{name} is not a finite number")]
    NotFinite {
        /// The quantity.
        name: &'static str,
    },
    /// Finite numbers whose products are not.
    #[error("the numbers are too large or too small: the product of the partial matrices is not finite")]
    OutOfRange,
    /// VPN is `(0, 0, 0)`.
    #[error("VPN, the normal of the view plane, is zero; give any vector from the plane towards the eye")]
    ZeroVpn,
    /// VUP is `(0, 0, 0)`.
    #[error("VUP, the up vector, is zero; give any vector that should look upright")]
    ZeroVup,
    /// VUP does not fix the spin about VPN.
    #[error("VUP, the up vector, is parallel to VPN, the direction of view; give an up vector across it")]
    VupParallelToVpn,
    /// The normal of the image plane has another length than 1.
    #[error("n, the normal of the image plane, must have length 1, but its length is {length}")]
    NormalNotUnit {
        /// Its length.
        length: f64,
    },
    /// The distance between centre and image plane is zero.
    #[error("f, the distance from the centre to the image plane, is zero")]
    ZeroFocal,
    /// The window has no width or no height, or its limits are exchanged.
    #[error("the window is empty: umin {umin} must be below umax {umax}, and vmin {vmin} below vmax {vmax}")]
    EmptyWindow {
        /// Left limit.
        umin: f64,
        /// Right limit.
        umax: f64,
        /// Lower limit.
        vmin: f64,
        /// Upper limit.
        vmax: f64,
    },
    /// PRP has no distance from the view plane, so it neither sees the window nor gives a direction.
    #[error("PRP lies in the view plane; its third coordinate must not be 0")]
    PrpInViewPlane,
    /// The front and the back plane coincide.
    #[error("the front plane F and the back plane B are the same, {0}; F must be greater than B")]
    FrontEqualsBack(f64),
    /// The back plane is nearer than the front plane.
    #[error("the back plane B = {back} lies before the front plane F = {front}; F must be greater than B")]
    BackBeforeFront {
        /// F.
        front: f64,
        /// B.
        back: f64,
    },
    /// A plane that limits the view goes through the eye or lies behind it.
    #[error(
        "the {plane} plane at {distance} does not lie before the eye; \
         it must be smaller than the third coordinate of PRP, {eye}"
    )]
    PlaneBehindEye {
        /// `"front"` or `"back"`.
        plane: &'static str,
        /// Where the plane was put along VPN.
        distance: f64,
        /// Where the eye is along VPN.
        eye: f64,
    },
    /// In a parallel view the back plane goes through PRP, where the book's scale is infinite.
    #[error("the back plane B = {0} goes through PRP; move PRP along the direction of projection")]
    BackThroughPrp(f64),
    /// A camera whose target is its own place.
    #[error("the camera looks at its own position, so it has no direction of view")]
    EyeAtTarget,
    /// A camera frame whose axes do not span space.
    #[error("the camera's frame is degenerate: its axes do not span space")]
    DegenerateFrame,
    /// The vertical angle of view is outside its range.
    #[error("the vertical angle of view must lie between 0 and pi radians, exclusive, but is {0}")]
    FieldOfView(f64),
    /// Width over height is not positive.
    #[error("the aspect ratio, width over height, must be positive, but is {0}")]
    Aspect(f64),
    /// The window height of an orthographic camera is not positive.
    #[error("the height of an orthographic camera's window must be positive, but is {0}")]
    Height(f64),
    /// The near plane of a central projection is not before the eye.
    #[error("the near plane must lie before the eye at a positive distance, but is at {0}")]
    Near(f64),
    /// The far plane is not behind the near plane.
    #[error("the far plane at {far} must lie beyond the near plane at {near}")]
    FarBeforeNear {
        /// Distance of the near plane.
        near: f64,
        /// Distance of the far plane.
        far: f64,
    },
    /// A viewing operation that only projects was asked for a bounded view.
    #[error("this viewing operation has no window and no front and back planes, so it bounds no view")]
    NoVolume,
}

/// Fails on the first quantity that is not finite.
pub(crate) fn check_finite(quantities: &[(&'static str, &[f64])]) -> Result<(), ViewError> {
    match quantities.iter().find(|(_, values)| values.iter().any(|v| !v.is_finite())) {
        Some(&(name, _)) => Err(ViewError::NotFinite { name }),
        None => Ok(()),
    }
}
