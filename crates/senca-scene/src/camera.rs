//! Cameras.

use senca_math::glam::DVec3;

/// A camera. It sits at the origin of its node and looks along the node's -z axis with +y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name from the file, or empty.
    pub name: String,
    /// What it projects.
    pub projection: Projection,
}

/// Projection of a camera.
#[derive(Clone, Debug, PartialEq)]
pub enum Projection {
    /// Central projection with a symmetric window.
    Perspective {
        /// Full vertical angle of view, in radians, in (0, pi).
        yfov: f64,
        /// Width over height; `None` takes the picture's.
        aspect: Option<f64>,
        /// Distance of the near plane, > 0; `None` is chosen from the scene's bounds.
        near: Option<f64>,
        /// Distance of the far plane, > near; `None` is chosen from the scene's bounds.
        far: Option<f64>,
    },
    /// Parallel projection along -z.
    Orthographic {
        /// Height of the window in world units, > 0.
        height: f64,
        /// Width over height; `None` takes the picture's.
        aspect: Option<f64>,
        /// Distance of the near plane; may be negative; `None` is chosen from the scene's bounds.
        near: Option<f64>,
        /// Distance of the far plane, > near; `None` is chosen from the scene's bounds.
        far: Option<f64>,
    },
    /// The general view of the viewing operations B and C (course text, sections 1.6 and 1.7). The
    /// node's frame is the view reference frame: VRP is its origin, VPN its z axis, VUP its y axis.
    ViewReference {
        /// Whether all projectors are parallel (C) instead of meeting in `prp` (B).
        parallel: bool,
        /// PRP in the node's frame; its z is not 0.
        prp: DVec3,
        /// umin, umax, vmin, vmax on the plane z = 0, each minimum below its maximum. The picture is
        /// stretched to the window's sides whatever its own.
        window: [f64; 4],
        /// F, signed distance of the front plane along z.
        front: f64,
        /// B, signed distance of the back plane along z, < `front`.
        back: f64,
    },
}
