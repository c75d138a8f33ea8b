//! Cameras.

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
}
