//! Cameras, and how they become views.
//!
//! What a file leaves open is chosen here: the proportions from the picture, the near and far planes
//! from the scene's bounds.

use senca_math::glam::{DMat4, DVec3};
use senca_math::{Aabb, View, ViewError, ViewKind, ViewWindow, ViewingOperation};

/// A camera. It sits at the origin of its node and looks along the node's -z axis with +y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name from the file, or empty.
    pub name: String,
    /// What it projects.
    pub projection: Projection,
    /// The lens, for renderers with depth of field; `None` is a pinhole, with everything sharp.
    /// Default `None`.
    pub lens: Option<Lens>,
    /// When the shutter opens and closes, in seconds relative to the moment shown, for renderers with
    /// motion blur; `None` shows the moment alone. Default `None`.
    pub shutter: Option<[f64; 2]>,
}

/// A thin lens (Potmesil and Chakravarty 1981).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of its opening in world units, > 0.
    pub radius: f64,
    /// Distance from the eye, along the line of sight, of the plane that is sharp, > 0.
    pub focus_distance: f64,
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
    /// One of the viewing operations of the books, its world being the camera's node. A, and the
    /// parallel projection by point and normal, bound no volume; their window and planes are chosen
    /// so that the scene fits.
    Operation(ViewingOperation),
}

/// Nearest near plane, as a share of the far distance, that is chosen for a camera inside the scene.
/// Depth in `f32` then tells apart what differs by 1/10 000 of its distance at the far end.
const NEAR_SHARE: f64 = 1e-3;

/// Share of the depth range by which chosen planes stay clear of the scene.
const DEPTH_MARGIN: f64 = 0.01;

impl Camera {
    /// A camera with a pinhole and no shutter.
    #[must_use]
    pub fn new(name: impl Into<String>, projection: Projection) -> Self {
        Self { name: name.into(), projection, lens: None, shutter: None }
    }

    /// Width over height that the camera itself gives, for a picture whose size is still open.
    #[must_use]
    pub fn natural_aspect(&self) -> Option<f64> {
        let aspect = match &self.projection {
            Projection::Perspective { aspect, .. } | Projection::Orthographic { aspect, .. } => *aspect,
            Projection::Operation(ViewingOperation::Central(p) | ViewingOperation::Parallel(p)) => {
                Some(p.window.size()).map(|size| size.x / size.y)
            }
            Projection::Operation(_) => None,
        };
        aspect.filter(|a| a.is_finite() && *a > 0.0)
    }

    /// The view of this camera in a picture whose width over height is `picture_aspect`.
    ///
    /// A camera with an aspect of its own in a picture of other proportions keeps all of its window
    /// in sight and shows more at two sides. The window of a viewing operation is drawn over the
    /// whole picture, as the texts say; take [`Camera::natural_aspect`] for the picture's proportions
    /// to avoid stretching. Planes that the camera leaves open are put around `bounds_world`.
    ///
    /// # Errors
    /// [`ViewError`] when the camera's numbers or its frame give no view.
    pub fn view(
        &self,
        world_from_camera: &DMat4,
        picture_aspect: f64,
        bounds_world: &Aabb,
    ) -> Result<View, ViewError> {
        match self.projection {
            Projection::Perspective { yfov, aspect, near, far } => {
                let (near, far) = perspective_planes(world_from_camera, bounds_world, near, far);
                let yfov = 2.0 * ((0.5 * yfov).tan() * heightening(aspect, picture_aspect)).atan();
                View::perspective(world_from_camera, yfov, picture_aspect, near, Some(far))
            }
            Projection::Orthographic { height, aspect, near, far } => {
                let range = depth_range(world_from_camera, bounds_world).unwrap_or((0.0, 1.0));
                let margin = (DEPTH_MARGIN * (range.1 - range.0)).max(1e-6 * range.1.abs()).max(1e-9);
                let near = near.unwrap_or((range.0 - margin).min(far.map_or(f64::INFINITY, |f| f - margin)));
                let far = far.unwrap_or((range.1 + margin).max(near + margin));
                let height = height * heightening(aspect, picture_aspect);
                View::orthographic(world_from_camera, height, picture_aspect, near, far)
            }
            Projection::Operation(operation) => {
                operation_view(&operation, world_from_camera, picture_aspect, bounds_world)
            }
        }
    }
}

/// Factor on a window's height that keeps its whole width in sight in a narrower picture.
fn heightening(aspect: Option<f64>, picture_aspect: f64) -> f64 {
    aspect.filter(|a| a.is_finite() && *a > 0.0).map_or(1.0, |aspect| (aspect / picture_aspect).max(1.0))
}

/// Smallest and largest distance of the bounds' corners along the line of sight.
fn depth_range(world_from_camera: &DMat4, bounds: &Aabb) -> Option<(f64, f64)> {
    if bounds.is_empty() {
        return None;
    }
    let forward = -world_from_camera.z_axis.truncate().normalize_or(DVec3::Z);
    let eye = world_from_camera.w_axis.truncate();
    let depths = bounds.corners().map(|corner| (corner - eye).dot(forward));
    let range = depths.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &d| (l.min(d), h.max(d)));
    (range.0.is_finite() && range.1.is_finite()).then_some(range)
}

/// Near and far distances, those given or those that fit the bounds.
fn perspective_planes(
    world_from_camera: &DMat4,
    bounds: &Aabb,
    near: Option<f64>,
    far: Option<f64>,
) -> (f64, f64) {
    let (low, high) = depth_range(world_from_camera, bounds).unwrap_or((0.1, 100.0));
    // Nothing lies before the eye: any planes do.
    let high = if high > 0.0 { high } else { 1.0 };
    // Depths crowd towards the far plane: what lies flat before it must differ from it in f32.
    let margin = (DEPTH_MARGIN * (high - low.max(0.0))).max(1e-3 * high);
    let far = far.unwrap_or_else(|| (high + margin).max(near.map_or(0.0, |near| near * (1.0 + 1e-3))));
    let chosen = (low - margin).max(NEAR_SHARE * far);
    // A given far plane may lie before the scene.
    (near.unwrap_or(if chosen < far { chosen } else { 0.5 * far }), far)
}

/// The view of a viewing operation whose world is the frame of a node.
fn operation_view(
    operation: &ViewingOperation,
    world_from_camera: &DMat4,
    picture_aspect: f64,
    bounds_world: &Aabb,
) -> Result<View, ViewError> {
    let (_, rotation, translation) = world_from_camera.to_scale_rotation_translation();
    if !(rotation.is_finite() && translation.is_finite()) {
        return Err(ViewError::DegenerateFrame);
    }
    let world_from_node = DMat4::from_rotation_translation(rotation.normalize(), translation);
    let node_from_world = DMat4::from_rotation_translation(rotation.normalize(), translation).inverse();
    let bounds = bounds_world.transformed(&node_from_world);
    let view = match operation {
        ViewingOperation::CentralByNormal(a) => {
            let (window, front, back) = fit_central(operation, a.focal, &bounds, picture_aspect)?;
            a.parameters(window, front, back)?.central_view()?
        }
        ViewingOperation::ParallelByNormal(p) => {
            let (window, front, back) = fit_parallel(operation, &bounds, picture_aspect)?;
            p.parameters(window, front, back)?.parallel_view()?
        }
        _ => operation.view()?,
    };
    let turned = |direction: DVec3| world_from_node.transform_vector3(direction);
    Ok(View {
        view_from_world: view.view_from_world * node_from_world,
        clip_from_view: view.clip_from_view,
        clip_from_world: view.clip_from_world * node_from_world,
        world_from_clip: world_from_node * view.world_from_clip,
        kind: match view.kind {
            ViewKind::Central { eye_world } => {
                ViewKind::Central { eye_world: world_from_node.transform_point3(eye_world) }
            }
            ViewKind::Parallel { direction_world } => {
                ViewKind::Parallel { direction_world: turned(direction_world) }
            }
        },
    })
}

/// Places of the bounds' corners in the frame of the view plane, x and y projected.
fn projected_corners(
    operation: &ViewingOperation,
    bounds: &Aabb,
) -> Result<Vec<senca_math::glam::DVec4>, ViewError> {
    let projected_from_world = operation.steps()?.product();
    Ok(bounds.corners().iter().map(|c| projected_from_world * c.extend(1.0)).collect())
}

/// Window that fits the corners, widened to the picture's proportions.
fn window_around(corners: impl Iterator<Item = (f64, f64)>, aspect: f64, least: f64) -> ViewWindow {
    let start = (f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    let (x0, y0, x1, y1) = corners.fold(start, |b, (x, y)| (b.0.min(x), b.1.min(y), b.2.max(x), b.3.max(y)));
    let center = if x0 <= x1 { (0.5 * (x0 + x1), 0.5 * (y0 + y1)) } else { (0.0, 0.0) };
    let size = if x0 <= x1 { (x1 - x0, y1 - y0) } else { (least, least) };
    let height = (1.05 * size.1.max(size.0 / aspect)).max(1e-6 * least);
    let (half_x, half_y) = (0.5 * height * aspect, 0.5 * height);
    ViewWindow::new(center.0 - half_x, center.0 + half_x, center.1 - half_y, center.1 + half_y)
}

/// Window and planes of operation A around what lies before the eye.
fn fit_central(
    operation: &ViewingOperation,
    focal: f64,
    bounds: &Aabb,
    aspect: f64,
) -> Result<(ViewWindow, f64, f64), ViewError> {
    let corners = if bounds.is_empty() { Vec::new() } else { projected_corners(operation, bounds)? };
    // w is the distance from the eye in units of the focal distance.
    let depths = corners.iter().map(|c| c.w * focal);
    let (low, high) = depths.fold((f64::INFINITY, 0.0f64), |(l, h), d| (l.min(d), h.max(d)));
    let far = if high > 0.0 { high * (1.0 + DEPTH_MARGIN) } else { 100.0 * focal.abs() };
    let near = (low * (1.0 - DEPTH_MARGIN)).max(NEAR_SHARE * far).min(0.5 * far);
    let all_before = !corners.is_empty() && low > 0.0;
    let seen = corners.iter().filter(|_| all_before).map(|c| (c.x / c.w, c.y / c.w));
    Ok((window_around(seen, aspect, 2.0 * focal.abs()), focal - near, focal - far))
}

/// Window and planes of the parallel projection by point and normal.
fn fit_parallel(
    operation: &ViewingOperation,
    bounds: &Aabb,
    aspect: f64,
) -> Result<(ViewWindow, f64, f64), ViewError> {
    let corners = if bounds.is_empty() { Vec::new() } else { projected_corners(operation, bounds)? };
    let z = corners.iter().map(|c| c.z);
    let (low, high) = z.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
    let (low, high) = if low <= high { (low, high) } else { (-1.0, 1.0) };
    let margin = (DEPTH_MARGIN * (high - low)).max(1e-6 * high.abs().max(low.abs())).max(1e-9);
    let window = window_around(corners.iter().map(|c| (c.x, c.y)), aspect, 1.0);
    Ok((window, high + margin, low - margin))
}

#[cfg(test)]
mod tests;
