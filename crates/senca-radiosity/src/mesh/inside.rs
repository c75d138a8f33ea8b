//! Which insides take part.
//!
//! The inside of a closed opaque body is seen by nobody and lit by nothing, so half of the polygons of
//! a scene with materials of two sides would be there for nothing. It takes part only
//! where something may shine or look in there: a light, a camera or a polygon of another object within
//! the body's bounds, or a shine of the body itself.

use senca_math::Aabb;
use senca_math::glam::{DVec3, Vec3};
use senca_scene::{LightKind, Mesh, Scene, Topology};

use super::ElementMesh;

/// Objects within the bounds by less than this share of them stand beside the body, or touch it.
const TOUCH: f64 = 1e-5;

/// Comparisons of boxes that are spent at most; beyond that insides are left in.
const MOST_WORK: usize = 100_000_000;

/// Whether a mesh is one closed body. Of meshes with several parts one may be in another.
pub(super) fn is_closed_body(mesh: &Mesh) -> bool {
    if mesh.faces.is_empty() {
        return false;
    }
    let topology = Topology::new(mesh);
    topology.is_closed() && topology.parts(mesh) == 1
}

/// Places of what lights and looks.
pub(super) fn watchers(scene: &Scene) -> Vec<DVec3> {
    let places = scene.nodes.iter().zip(scene.world_from_nodes());
    let is_there = |light: senca_scene::LightId| {
        scene.lights.get(light.index()).is_some_and(|l| {
            !matches!(l.kind, LightKind::Ambient | LightKind::Parallel | LightKind::BoxSpot { .. })
        })
    };
    places
        .filter(|(node, _)| node.camera.is_some() || node.light.is_some_and(is_there))
        .filter_map(|(_, world_from_node)| Some(world_from_node?.transform_point3(DVec3::ZERO)))
        .collect()
}

/// A body whose inside may be left out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub(super) instance: u32,
    pub(super) bounds: Aabb,
}

/// Of the bodies, those with nothing inside. `mesh` holds the fronts of all objects.
pub(super) fn empty_bodies(mesh: &ElementMesh, bodies: &[Body], watchers: &[DVec3]) -> Vec<u32> {
    if bodies.len().saturating_mul(mesh.polygons().len()) > MOST_WORK {
        return Vec::new();
    }
    let boxes: Vec<(Aabb, u32)> = (0..mesh.polygons().len() as u32)
        .map(|p| (Aabb::of_points(mesh.shape(p).corners().iter().copied()), mesh.surface(p).instance))
        .collect();
    let is_empty = |body: &&Body| {
        let margin = TOUCH * body.bounds.diagonal();
        let inner = Aabb { min: body.bounds.min + margin, max: body.bounds.max - margin };
        let holds = |p: &DVec3| p.cmpge(inner.min).all() && p.cmple(inner.max).all();
        let enters = |(polygon, (bounds, instance)): (usize, &(Aabb, u32))| {
            *instance != body.instance
                && bounds.min.cmplt(inner.max).all()
                && bounds.max.cmpgt(inner.min).all()
                && crosses(&inner, mesh, polygon as u32)
        };
        !watchers.iter().any(holds) && !boxes.iter().enumerate().any(enters)
    };
    bodies.iter().filter(is_empty).map(|body| body.instance).collect()
}

/// Whether the polygon's plane crosses the box; its bounds do.
fn crosses(bounds: &Aabb, mesh: &ElementMesh, polygon: u32) -> bool {
    let (normal, center) = (mesh.normal(polygon), mesh.elements()[polygon as usize].center);
    let reach = 0.5 * normal.abs().dot(bounds.size());
    normal.dot(center - bounds.center()).abs() <= reach
}

/// The bounds of a mesh's points after a map.
pub(super) fn bounds_of(mesh: &Mesh, place: impl Fn(Vec3) -> DVec3) -> Aabb {
    Aabb::of_points(mesh.points.iter().map(|&p| place(p)))
}
