//! Cameras of a scene, and the camera for scenes that have none.
//!
//! The default camera stands in front, to the right and above (three-quarter view), looks through a
//! moderate lens and is as near as it can be with the whole scene in the picture and a small margin.
//! The fit is exact: an eye sees a body whole when the body lies inside the four side planes of the
//! window, and each plane asks the shapes for their farthest reach along its normal.

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_math::{Aabb, world_from_look_at};

use crate::{Camera, CameraId, NodeId, Projection, Scene, Shape};

/// Full vertical angle of the default camera: 30 degrees, a portrait lens.
pub const DEFAULT_YFOV: f64 = std::f64::consts::PI / 6.0;

/// Share of the picture's half that stays free on each side around a framed scene.
const MARGIN: f64 = 0.06;

/// Direction from the scene to the default camera, before normalising.
const THREE_QUARTER: DVec3 = DVec3::new(0.5, 0.4, 1.0);

/// Points up to which a mesh's own points are asked instead of its box.
const EXACT_POINTS: usize = 1 << 22;

/// A camera with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedCamera {
    /// The camera.
    pub camera: Camera,
    /// Where it stands.
    pub world_from_camera: DMat4,
}

/// A camera that a node of a scene places.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    /// Name of the camera, or of its node where the camera has none; may be empty.
    pub name: String,
    /// The camera.
    pub camera: CameraId,
    /// The node.
    pub node: NodeId,
    /// Where it stands.
    pub world_from_camera: DMat4,
}

/// What must be in the picture: its reach along a direction, in world space.
trait Body {
    fn support(&self, direction_world: DVec3) -> f64;
}

impl Body for Aabb {
    fn support(&self, direction_world: DVec3) -> f64 {
        self.corners().iter().map(|c| c.dot(direction_world)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Shapes, or their boxes where asking the shapes would take long, with their places.
struct PlacedShapes<'a>(Vec<(Result<&'a Shape, Aabb>, DMat4)>);

impl Body for PlacedShapes<'_> {
    fn support(&self, direction_world: DVec3) -> f64 {
        let reach = |(shape, world_from_object): &(Result<&Shape, Aabb>, DMat4)| {
            let linear = DMat3::from_mat4(*world_from_object);
            let direction = linear.transpose() * direction_world;
            let own = match shape {
                Ok(shape) => shape.support(direction),
                Err(bounds) => bounds.support(direction),
            };
            own + world_from_object.w_axis.truncate().dot(direction_world)
        };
        self.0.iter().map(reach).filter(|r| r.is_finite()).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The default camera for a body within `bounds` in a picture of width over height `aspect`.
fn framed(body: &impl Body, bounds: &Aabb, aspect: f64) -> PlacedCamera {
    let toward_eye = THREE_QUARTER.normalize();
    // A body without size, or none at all, is looked at as if it had size 1.
    let size = if bounds.diagonal() > 0.0 { bounds.diagonal() } else { 1.0 };
    let center = bounds.center();
    let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
    let frame = world_from_look_at(center + toward_eye, center, DVec3::Y).unwrap_or(DMat4::IDENTITY);
    let axes = DMat3::from_mat4(frame);
    let tan_y = (0.5 * DEFAULT_YFOV).tan() * (1.0 - MARGIN);
    let (x, z_for_x) = fit(body, axes.x_axis, axes.z_axis, tan_y * aspect, center, size);
    let (y, z_for_y) = fit(body, axes.y_axis, axes.z_axis, tan_y, center, size);
    let eye = center + axes.x_axis * x + axes.y_axis * y + axes.z_axis * z_for_x.max(z_for_y);
    PlacedCamera {
        camera: Camera::new(
            "default",
            Projection::Perspective { yfov: DEFAULT_YFOV, aspect: None, near: None, far: None },
        ),
        world_from_camera: DMat4::from_mat3_translation(axes, eye),
    }
}

/// Place of the eye along `side` and `back`, relative to `center`, from which the body just fits
/// between two planes that open by `tan` on either side. The plane with outward normal
/// `side + tan back` holds `p . n <= eye . n`, its mirror image likewise: two equations, two unknowns.
fn fit(body: &impl Body, side: DVec3, back: DVec3, tan: f64, center: DVec3, size: f64) -> (f64, f64) {
    let reach = |normal: DVec3| {
        let reach = body.support(normal) - center.dot(normal);
        if reach.is_finite() { reach } else { 0.5 * size * normal.length() }
    };
    let (right, left) = (reach(side + tan * back), reach(tan * back - side));
    (0.5 * (right - left), (0.5 * (right + left) / tan).max(1e-3 * size))
}

/// A camera that shows all of `bounds` in a picture of width over height `aspect`, from in front,
/// right and above. Empty bounds give a camera that looks at the origin.
#[must_use]
pub fn frame_bounds(bounds: &Aabb, aspect: f64) -> PlacedCamera {
    framed(bounds, bounds, aspect)
}

impl Scene {
    /// Cameras that nodes reached from the roots place, in the order of nodes.
    #[must_use]
    pub fn placed_cameras(&self) -> Vec<SceneCamera> {
        let world_from_nodes = self.world_from_nodes();
        let placed = self.nodes.iter().zip(&world_from_nodes).enumerate();
        placed
            .filter_map(|(i, (node, world_from_node))| {
                let camera = node.camera?;
                let own = &self.cameras.get(camera.index())?.name;
                let name = if own.is_empty() { &node.name } else { own };
                Some(SceneCamera {
                    name: name.clone(),
                    camera,
                    node: NodeId(i as u32),
                    world_from_camera: (*world_from_node)?,
                })
            })
            .collect()
    }

    /// A camera that shows the whole scene in a picture of width over height `aspect`, from in front,
    /// right and above, as near as its shapes allow. A scene without shapes of finite size gives a
    /// camera that looks at the origin.
    #[must_use]
    pub fn frame_all(&self, aspect: f64) -> PlacedCamera {
        let mut left = EXACT_POINTS;
        let placed = self.instances().into_iter().map(|instance| {
            let shape = &self.geometries[instance.geometry.index()].shape;
            let cost = match shape {
                Shape::Mesh(mesh) => mesh.points.len(),
                _ => 0,
            };
            let asked = if cost <= left { Ok(shape) } else { Err(shape.bounds()) };
            left = left.saturating_sub(cost);
            (asked, instance.world_from_object)
        });
        let body = PlacedShapes(placed.collect());
        framed(&body, &self.bounds(), aspect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GeometryId, Node, Transform};
    use proptest::prelude::*;

    /// Largest |x| and |y| of points in the picture, 1 being the border.
    fn reach_in_picture(placed: &PlacedCamera, points: &[DVec3], aspect: f64, bounds: &Aabb) -> (f64, f64) {
        let view = placed.camera.view(&placed.world_from_camera, aspect, bounds).unwrap();
        let seen = points.iter().map(|p| view.clip_from_world * p.extend(1.0));
        seen.fold((0.0, 0.0), |(x, y), c| {
            assert!(c.w > 0.0 && c.z >= 0.0 && c.z <= c.w, "within near and far");
            (f64::max(x, (c.x / c.w).abs()), f64::max(y, (c.y / c.w).abs()))
        })
    }

    fn sphere_points(radius: f64, center: DVec3) -> Vec<DVec3> {
        let n = 40_000;
        let golden = 2.399_963_229_728_653;
        (0..n)
            .map(|i| {
                let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                let (sin, cos) = (golden * f64::from(i)).sin_cos();
                center + radius * DVec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin)
            })
            .collect()
    }

    proptest! {
        #[test]
        fn spheres_and_boxes_fill_the_picture(aspect in 0.3f64..3.0, scale in 1e-3f64..1e3, x in -50.0f64..50.0) {
            let center = DVec3::new(x, -x, 2.0 * x);
            for (shape, points) in [
                (Shape::Sphere { radius: scale }, sphere_points(scale, center)),
                (Shape::Box { size: DVec3::splat(scale) },
                 Aabb { min: center - 0.5 * scale, max: center + 0.5 * scale }.corners().to_vec()),
            ] {
                let mut scene = Scene::of_shape("one", shape);
                scene.nodes[0].transform = Transform::Matrix(DMat4::from_translation(center));
                let (x, y) = reach_in_picture(&scene.frame_all(aspect), &points, aspect, &scene.bounds());
                prop_assert!(x <= 0.95 && y <= 0.95, "{x} {y}");
                prop_assert!(x.max(y) >= 0.93, "tight: {x} {y}");
            }
        }
    }

    #[test]
    fn empty_and_flat_scenes_are_framed_too() {
        let empty = Scene::default().frame_all(1.5);
        assert!(empty.camera.view(&empty.world_from_camera, 1.5, &Aabb::EMPTY).is_ok());
        let floor = Scene::of_shape("floor", Shape::Plane { size: None });
        let camera = floor.frame_all(1.5);
        assert!(camera.world_from_camera.w_axis.y > 0.0);
        assert!(camera.camera.view(&camera.world_from_camera, 1.5, &floor.bounds()).is_ok());
        let point = frame_bounds(&Aabb { min: DVec3::ONE, max: DVec3::ONE }, 1.0);
        assert!(
            point
                .camera
                .view(&point.world_from_camera, 1.0, &Aabb { min: DVec3::ONE, max: DVec3::ONE })
                .is_ok()
        );
    }

    #[test]
    fn cameras_are_found_where_nodes_place_them() {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let projection = Projection::Orthographic { height: 2.0, aspect: None, near: None, far: None };
        scene.cameras.push(Camera::new("", projection));
        let place = DMat4::from_translation(DVec3::Z * 5.0);
        let node = Node {
            name: "front".to_owned(),
            camera: Some(CameraId(0)),
            transform: Transform::Matrix(place),
            ..Node::default()
        };
        let id = scene.add_node(node);
        let loose = scene.add_node(Node { camera: Some(CameraId(0)), ..Node::default() });
        scene.roots.push(id);
        let cameras = scene.placed_cameras();
        assert_eq!(cameras.len(), 1, "node {loose:?} is not reached");
        assert_eq!((cameras[0].name.as_str(), cameras[0].node), ("front", id));
        assert_eq!(cameras[0].world_from_camera, place);
        assert_eq!(scene.instances()[0].geometry, GeometryId(0));
    }
}
