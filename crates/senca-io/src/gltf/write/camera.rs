//! Cameras.
//!
//! glTF knows cameras that look straight through the middle of their window. A viewing operation
//! whose window is of that kind is written as such a camera in a node of its own; an oblique or
//! off-centre one cannot be said and is left out with a warning.

use serde_json::{Map, Value, json};

use senca_scene::math::glam::{DMat4, DVec3};
use senca_scene::math::{Aabb, ViewKind};
use senca_scene::{Camera, Projection};

use super::{Output, named, set};

/// Share of the window's half width by which its middle may be off the line of sight.
const STRAIGHT: f64 = 1e-9;

/// Where a camera of the scene went.
pub(super) enum CameraPlace {
    /// Camera number; it sits in the node that names it.
    Here(usize),
    /// Camera number, and its `node_from_camera` in the node that names it.
    Moved(usize, DMat4),
    /// It could not be written.
    LeftOut,
}

impl Output {
    /// Writes a camera.
    pub(super) fn add_camera(&mut self, camera: &Camera) -> CameraPlace {
        if let Some((node_from_camera, projection)) = stepped_back(&camera.projection) {
            let index = self.push("cameras", camera_json(&camera.name, &projection));
            return CameraPlace::Moved(index, node_from_camera);
        }
        if !matches!(camera.projection, Projection::Operation(_)) {
            return CameraPlace::Here(self.push("cameras", camera_json(&camera.name, &camera.projection)));
        }
        match straight_camera(camera) {
            Some((node_from_camera, projection)) => {
                let index = self.push("cameras", camera_json(&camera.name, &projection));
                CameraPlace::Moved(index, node_from_camera)
            }
            None => {
                self.warn(format!(
                    "camera {:?}: glTF has no oblique or off-centre views; left out",
                    camera.name
                ));
                CameraPlace::LeftOut
            }
        }
    }
}

/// A parallel projection that begins behind its camera, which glTF does not allow, seen from there.
fn stepped_back(projection: &Projection) -> Option<(DMat4, Projection)> {
    let Projection::Orthographic { height, aspect, near: Some(near), far } = *projection else { return None };
    let back = Some(-near).filter(|back| *back > 0.0 && back.is_finite())?;
    let far = far.map(|far| far + back);
    let place = DMat4::from_translation(DVec3::new(0.0, 0.0, back));
    Some((place, Projection::Orthographic { height, aspect, near: Some(0.0), far }))
}

/// The camera through the middle of its window that sees what a viewing operation sees, and its
/// place in the operation's world.
fn straight_camera(camera: &Camera) -> Option<(DMat4, Projection)> {
    let aspect = camera.natural_aspect();
    let view = camera.view(&DMat4::IDENTITY, aspect.unwrap_or(1.0), &Aabb::EMPTY).ok()?;
    let scale = match view.kind {
        ViewKind::Central { .. } => -view.clip_from_view.z_axis.w,
        ViewKind::Parallel { .. } => view.clip_from_view.w_axis.w,
    };
    let m = view.clip_from_view * (1.0 / scale);
    let off_center = m.z_axis.x.abs().max(m.z_axis.y.abs()).max(m.w_axis.x.abs()).max(m.w_axis.y.abs());
    if !m.is_finite() || off_center > STRAIGHT {
        return None;
    }
    let aspect = Some(m.y_axis.y / m.x_axis.x);
    let projection = match view.kind {
        ViewKind::Central { .. } => {
            let near = m.w_axis.z / m.z_axis.z;
            let far = Some(near * m.z_axis.z / (m.z_axis.z + 1.0)).filter(|far| *far > near);
            Projection::Perspective { yfov: 2.0 * (1.0 / m.y_axis.y).atan(), aspect, near: Some(near), far }
        }
        ViewKind::Parallel { .. } => {
            let depth = -1.0 / m.z_axis.z;
            let near = -m.w_axis.z * depth;
            let far = Some(near + depth);
            Projection::Orthographic { height: 2.0 / m.y_axis.y, aspect, near: Some(near), far }
        }
    };
    Some((view.view_from_world.inverse(), projection))
}

fn camera_json(name: &str, projection: &Projection) -> Value {
    let mut json = named(name);
    let mut numbers = Map::new();
    let kind = match *projection {
        Projection::Orthographic { height, aspect, near, far } => {
            let half = 0.5 * height;
            set(&mut numbers, "xmag", json!(half * aspect.unwrap_or(1.0)));
            set(&mut numbers, "ymag", json!(half));
            let near = near.unwrap_or(0.0);
            set(&mut numbers, "znear", json!(near));
            set(&mut numbers, "zfar", json!(far.unwrap_or(near + 1e4)));
            "orthographic"
        }
        Projection::Perspective { yfov, aspect, near, far } => {
            set(&mut numbers, "yfov", json!(yfov));
            set(&mut numbers, "znear", json!(near.unwrap_or(0.01)));
            aspect.into_iter().for_each(|a| set(&mut numbers, "aspectRatio", json!(a)));
            far.into_iter().for_each(|f| set(&mut numbers, "zfar", json!(f)));
            "perspective"
        }
        Projection::Operation(_) => unreachable!("viewing operations are turned into straight cameras first"),
    };
    set(&mut json, "type", json!(kind));
    set(&mut json, kind, Value::Object(numbers));
    Value::Object(json)
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_scene::math::{ViewParameters, ViewWindow, ViewingOperation};

    fn operation(prp: DVec3) -> ViewParameters {
        ViewParameters {
            vrp: DVec3::new(1.0, 2.0, 3.0),
            vpn: DVec3::new(1.0, 2.0, 2.0),
            vup: DVec3::Z,
            prp,
            window: ViewWindow::centered(4.0, 2.0),
            front: 1.0,
            back: -4.0,
        }
    }

    fn camera(operation: ViewingOperation) -> Camera {
        Camera::new("c", Projection::Operation(operation))
    }

    /// The straight camera must see every point where the operation sees it.
    #[test]
    fn a_straight_operation_keeps_its_view() {
        let p = operation(DVec3::new(0.0, 0.0, 5.0));
        for operation in [ViewingOperation::Central(p), ViewingOperation::Parallel(p)] {
            let (node_from_camera, projection) = straight_camera(&camera(operation)).expect("straight");
            let straight = Camera::new("", projection);
            let straight = straight.view(&node_from_camera, 2.0, &Aabb::EMPTY).expect("a view");
            let asked = operation.view().expect("a view");
            for point in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.5, 2.5, 3.2)] {
                let [a, b] = [&asked, &straight].map(|v| v.clip_from_world.project_point3(point));
                assert!(a.abs_diff_eq(b, 1e-9), "{a} {b}");
            }
        }
    }

    #[test]
    fn an_oblique_operation_is_not_straight() {
        let p = operation(DVec3::new(0.5, 0.0, 5.0));
        assert!(straight_camera(&camera(ViewingOperation::Parallel(p))).is_none());
        assert!(straight_camera(&camera(ViewingOperation::Central(p))).is_none());
    }
}
