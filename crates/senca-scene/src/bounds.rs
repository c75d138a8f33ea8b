//! Bounds of shapes and scenes.
//!
//! Round shapes answer exactly in every direction through their support function (the farthest reach
//! along a direction), so boxes around turned spheres, cones and tori are tight. Bézier and NURBS
//! surfaces answer with their control points, which enclose them.

use senca_math::Aabb;
use senca_math::glam::{DMat4, DVec3};

use crate::{GeometryId, Mesh, Scene, Shape};

/// Points of meshes that are looked at one by one for tight bounds of a whole scene; beyond, the
/// boxes of turned boxes are taken.
const EXACT_POINTS: usize = 1 << 24;

/// The corners that stand for a mesh's or patch set's points in a support query.
fn farthest(points: impl Iterator<Item = DVec3>, direction: DVec3) -> f64 {
    points.filter(|p| p.is_finite()).map(|p| p.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
}

impl Shape {
    /// Largest `p . direction` over the points p of the shape, in object space; minus infinity for
    /// shapes without points, and for the endless plane, which has no bounds to contribute. Shapes
    /// with numbers out of range give some answer.
    #[must_use]
    pub fn support(&self, direction: DVec3) -> f64 {
        let d = direction;
        let radial = d.x.hypot(d.z);
        let disc = |y: f64, radius: f64| y * d.y + radius * radial;
        match self {
            Self::Mesh(mesh) => farthest(mesh.points.iter().map(|p| p.as_dvec3()), d),
            Self::Sphere { radius } => radius * d.length(),
            Self::Ellipsoid { radii } => (*radii * d).length(),
            Self::Box { size } => 0.5 * size.dot(d.abs()),
            Self::Cylinder { radius, height, .. } => disc(0.0, *radius).max(disc(*height, *radius)),
            Self::Cone { radius, top_radius, height, .. } => {
                disc(0.0, *radius).max(disc(*height, *top_radius))
            }
            Self::Torus { major_radius, minor_radius } => major_radius * radial + minor_radius * d.length(),
            Self::Disc { radius, .. } => disc(0.0, *radius),
            Self::Plane { size: Some(size) } => 0.5 * size * (d.x.abs() + d.z.abs()),
            Self::Plane { size: None } => f64::NEG_INFINITY,
            Self::Polygon { outline, .. } => farthest(outline.iter().copied(), d),
            Self::Prism { base, height, .. } => {
                let at = |y: f64| farthest(base.iter().map(|p| DVec3::new(p.x, y, p.y)), d);
                at(0.0).max(at(*height))
            }
            Self::Revolution { profile, .. } => {
                profile.iter().map(|p| disc(p.y, p.x)).fold(f64::NEG_INFINITY, f64::max)
            }
            Self::BezierPatches { patches } => {
                farthest(patches.iter().flat_map(|patch| patch.points).collect::<Vec<_>>().into_iter(), d)
            }
            Self::Nurbs(surface) => farthest(surface.points.iter().copied(), d),
            Self::Implicit(surface) => farthest(surface.bounds.corners().into_iter(), d),
            Self::Csg(csg) => farthest(csg.bounds_in(&DMat4::IDENTITY).corners().into_iter(), d),
        }
    }

    /// Box around the shape in object space; empty for the endless plane.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds_in(&DMat4::IDENTITY)
    }

    /// Box around the shape after the affine map `world_from_object`; empty for the endless plane.
    #[must_use]
    pub fn bounds_in(&self, world_from_object: &DMat4) -> Aabb {
        if let Self::Mesh(mesh) = self {
            return mesh_bounds(mesh, world_from_object);
        }
        if let Self::Csg(csg) = self {
            let bounds = csg.bounds_in(world_from_object);
            let finite = bounds.min.is_finite() && bounds.max.is_finite();
            return if finite { bounds } else { Aabb::EMPTY };
        }
        let offset = world_from_object.w_axis.truncate();
        let reach = |axis: usize, sign: f64| {
            let row = world_from_object.row(axis).truncate();
            sign * self.support(sign * row) + offset[axis]
        };
        let side = |sign: f64| DVec3::new(reach(0, sign), reach(1, sign), reach(2, sign));
        let bounds = Aabb { min: side(-1.0), max: side(1.0) };
        if bounds.min.is_finite() && bounds.max.is_finite() { bounds } else { Aabb::EMPTY }
    }
}

/// Box around the mapped points of a mesh.
fn mesh_bounds(mesh: &Mesh, world_from_object: &DMat4) -> Aabb {
    if *world_from_object == DMat4::IDENTITY {
        return mesh.bounds();
    }
    Aabb::of_points(mesh.points.iter().map(|p| world_from_object.transform_point3(p.as_dvec3())))
}

impl Scene {
    /// Box around everything that nodes reached from the roots place, in world space. Endless planes
    /// do not count. Skins and morph targets are not applied; see [`Scene::at_time`] for poses.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let mut left = EXACT_POINTS;
        let mut boxes = vec![None; self.geometries.len()];
        let instances = self.instances();
        let of_instance = |(geometry, world_from_object): (GeometryId, &DMat4)| {
            let shape = &self.geometries[geometry.index()].shape;
            let cost = match shape {
                Shape::Mesh(mesh) => mesh.points.len(),
                _ => 0,
            };
            if cost <= left {
                left -= cost;
                return shape.bounds_in(world_from_object);
            }
            boxes[geometry.index()].get_or_insert_with(|| shape.bounds()).transformed(world_from_object)
        };
        instances
            .iter()
            .map(|i| (i.geometry, &i.world_from_object))
            .map(of_instance)
            .fold(Aabb::EMPTY, Aabb::union)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TessellationSettings, Tolerance, tessellate};
    use proptest::prelude::*;
    use senca_math::glam::{DQuat, DVec2};

    fn shapes() -> Vec<Shape> {
        let base = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        vec![
            Shape::Sphere { radius: 2.0 },
            Shape::Ellipsoid { radii: DVec3::new(1.0, 2.0, 3.0) },
            Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) },
            Shape::Cylinder { radius: 1.0, height: 2.0, capped: true },
            Shape::Cone { radius: 1.0, top_radius: 0.5, height: 3.0, capped: true },
            Shape::Torus { major_radius: 2.0, minor_radius: 0.5 },
            Shape::Disc { radius: 2.0, inner_radius: 1.0 },
            Shape::Plane { size: Some(3.0) },
            Shape::Prism { base: base.clone(), height: 1.0, capped: true },
            Shape::Revolution { profile: base, bezier: false, angle: std::f64::consts::TAU, capped: true },
        ]
    }

    proptest! {
        #[test]
        fn bounds_of_turned_shapes_are_tight(axis in prop::array::uniform3(-1.0f64..1.0), angle in 0.0f64..6.3, scale in 0.1f64..4.0) {
            let axis = DVec3::from_array(axis).normalize_or(DVec3::X);
            let rotation = DQuat::from_axis_angle(axis, angle);
            let map = DMat4::from_scale_rotation_translation(DVec3::new(scale, 1.0, 2.0), rotation, DVec3::new(3.0, -1.0, 0.5));
            let settings = TessellationSettings { tolerance: Tolerance::Steps(96, 48), ..TessellationSettings::default() };
            for shape in shapes() {
                let mesh = tessellate(&shape, &settings).unwrap().into_owned();
                let drawn = Shape::Mesh(mesh).bounds_in(&map);
                let exact = shape.bounds_in(&map);
                prop_assert!((drawn.min - exact.min).abs().max_element() < 0.02 * scale.max(2.0));
                prop_assert!((drawn.max - exact.max).abs().max_element() < 0.02 * scale.max(2.0));
                prop_assert!(drawn.min.cmpge(exact.min - 1e-5).all() && drawn.max.cmple(exact.max + 1e-5).all());
            }
        }
    }

    #[test]
    fn scenes_add_up_instances_and_leave_out_endless_planes() {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let again = crate::Node {
            geometry: Some(GeometryId(0)),
            transform: crate::Transform::Matrix(DMat4::from_translation(DVec3::X * 10.0)),
            ..crate::Node::default()
        };
        let id = scene.add_node(again);
        scene.roots.push(id);
        let floor = scene.add_geometry(crate::Geometry {
            name: String::new(),
            shape: Shape::Plane { size: None },
            material: None,
        });
        let id = scene.add_node(crate::Node { geometry: Some(floor), ..crate::Node::default() });
        scene.roots.push(id);
        let bounds = scene.bounds();
        assert_eq!((bounds.min, bounds.max), (-DVec3::ONE, DVec3::new(11.0, 1.0, 1.0)));
        assert!(Scene::default().bounds().is_empty());
    }
}
