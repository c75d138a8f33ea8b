//! All accelerators against the list, hit for hit.

use proptest::prelude::*;
use senca_math::glam::{DMat4, DQuat, DVec3, EulerRot, Vec3};
use senca_math::{Aabb, LinearRgb};
use senca_scene::{
    Faces, Geometry, Material, Mesh, Node, Scene, Shape, Surface, TessellationSettings, Tolerance, Transform,
    Vertices,
};

use super::*;
use crate::{World, WorldSettings};

/// A mesh over `points`, three for each triangle.
pub(crate) fn triangles(points: Vec<Vec3>) -> Shape {
    let count = points.len() as u32;
    let vertices = Vertices { point: (0..count).collect(), ..Vertices::default() };
    let faces = Faces { corners: (0..count).collect(), ..Faces::default() };
    Shape::Mesh(Mesh { points, vertices, faces, surfaces: vec![Surface::default()], ..Mesh::default() })
}

/// Shapes of all sorts, the last ones degenerate or endless.
fn shapes() -> Vec<Shape> {
    let p = Vec3::new;
    vec![
        Shape::Sphere { radius: 1.0 },
        Shape::Box { size: DVec3::new(1.0, 2.0, 0.5) },
        triangles(vec![
            p(0.0, 0.0, 0.0),
            p(1.0, 0.2, 0.0),
            p(0.1, 1.0, 0.3),
            p(-1.0, 0.0, 0.4),
            p(1.0, 0.0, -0.7),
            p(0.0, 1.0, 0.0),
        ]),
        Shape::Torus { major_radius: 1.0, minor_radius: 0.3 },
        Shape::Disc { radius: 1.0, inner_radius: 0.4 },
        // Twice the same triangle, one of no area, one that is a point.
        triangles(
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
                .repeat(2)
                .into_iter()
                .map(|[x, y]| p(x, y, 0.0))
                .chain([
                    p(0.0, 0.0, 0.0),
                    p(1.0, 1.0, 1.0),
                    p(2.0, 2.0, 2.0),
                    p(0.3, 0.3, 0.3),
                    p(0.3, 0.3, 0.3),
                    p(0.3, 0.3, 0.3),
                ])
                .collect(),
        ),
        Shape::Plane { size: Some(3.0) },
        Shape::Plane { size: None },
    ]
}

/// What a random scene is made of: shape, place, turn, scale, whether it is made of glass.
type Placed = (usize, [f64; 3], [f64; 3], [f64; 3], bool);

fn any_placed() -> impl Strategy<Value = Placed> {
    let triple = |range: std::ops::Range<f64>| prop::array::uniform3(range);
    // Every second one stands on a lattice, so that surfaces coincide.
    let place = prop_oneof![triple(-3.0..3.0), prop::array::uniform3((-2i32..3).prop_map(f64::from))];
    let turn = prop_oneof![triple(-3.0..3.0), Just([0.0; 3])];
    let scale = prop_oneof![triple(-1.5..1.5), Just([1.0; 3]), Just([-0.5, 0.5, 0.5]), Just([1.0, 0.0, 1.0])];
    (0..shapes().len(), place, turn, scale, any::<bool>())
}

pub(crate) fn scene_of(placed: &[Placed]) -> Scene {
    let mut scene = Scene::default();
    let glass = scene.add_material(Material { transmission: LinearRgb::WHITE, ..Material::default() });
    for shape in shapes() {
        scene.add_geometry(Geometry { name: String::new(), shape, material: None });
    }
    for &(shape, place, turn, scale, is_glass) in placed {
        let rotation = DQuat::from_euler(EulerRot::XYZ, turn[0], turn[1], turn[2]);
        let matrix = DMat4::from_scale_rotation_translation(scale.into(), rotation, place.into());
        let node = scene.add_node(Node {
            transform: Transform::Matrix(matrix),
            geometry: Some(senca_scene::GeometryId(shape as u32)),
            material: is_glass.then_some(glass),
            ..Node::default()
        });
        // Chains of nodes give the user's hierarchy some depth.
        match node.index() {
            i if i % 3 == 2 => {
                let group = scene.add_node(Node { children: vec![node], ..Node::default() });
                scene.roots.push(group);
            }
            _ => scene.roots.push(node),
        }
    }
    scene
}

fn any_ray() -> impl Strategy<Value = Ray> {
    let origin = prop_oneof![
        prop::array::uniform3(-6.0..6.0f64),
        prop::array::uniform3((-3i32..4).prop_map(f64::from)),
        prop::array::uniform3(-1e5..1e5f64),
    ];
    let towards = prop::array::uniform3(-2.5..2.5f64);
    let axis =
        (0usize..3, any::<bool>()).prop_map(|(i, back)| DVec3::AXES[i] * if back { -1.0 } else { 1.0 });
    let direction = prop_oneof![towards.prop_map(|t| (DVec3::from(t), true)), axis.prop_map(|a| (a, false))];
    let limits = prop_oneof![Just((0.0, f64::INFINITY)), (0.0..1.0, 0.5..2.0f64)];
    (origin, direction, limits).prop_map(|(origin, (direction, is_target), (t_min, t_max))| {
        let origin = DVec3::from(origin);
        let direction = if is_target { direction - origin } else { direction };
        Ray { t_min, t_max, ..Ray::new(origin, direction) }
    })
}

pub(crate) fn settings(kind: Accel) -> WorldSettings {
    let tessellation = TessellationSettings { tolerance: Tolerance::Steps(8, 6), ..Default::default() };
    WorldSettings { accel: kind.into(), tessellation, ..WorldSettings::default() }
}

/// All crossings that are offered when nothing blocks.
fn offered(world: &World<'_>, ray: &Ray) -> Vec<(u32, u32, u64)> {
    let seen = std::cell::RefCell::new(Vec::new());
    let _ = world.occluded(ray, &mut Counters::default(), &|hit| {
        seen.borrow_mut().push((hit.object, hit.crossing.part, hit.crossing.t.to_bits()));
        false
    });
    let mut seen = seen.into_inner();
    seen.sort_unstable();
    seen
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_agree_hit_for_hit(
        placed in prop::collection::vec(any_placed(), 0..14),
        rays in prop::collection::vec(any_ray(), 24),
    ) {
        let scene = scene_of(&placed);
        let world = |kind| World::with_settings(&scene, &settings(kind)).expect("shapes are in range");
        let list = world(Accel::None);
        for kind in Accel::ALL {
            let other = world(kind);
            for ray in &rays {
                let expected = list.closest(ray, &mut Counters::default());
                let found = other.closest(ray, &mut Counters::default());
                prop_assert_eq!(found, expected, "{} on {:?}", kind, ray);
                let any = |w: &World<'_>| w.occluded(ray, &mut Counters::default(), &|_| true);
                prop_assert_eq!(any(&other), any(&list), "{} on {:?}", kind, ray);
                let opaque_only = |w: &World<'_>| w.occluded(ray, &mut Counters::default(), &|_| false);
                prop_assert_eq!(opaque_only(&other), opaque_only(&list), "{} on {:?}", kind, ray);
                if !opaque_only(&list) {
                    prop_assert_eq!(offered(&other, ray), offered(&list, ray), "{} on {:?}", kind, ray);
                }
            }
        }
    }

    #[test]
    fn bounds_hold_what_they_bound(placed in any_placed()) {
        let scene = scene_of(&[placed]);
        let world = World::with_settings(&scene, &settings(Accel::None)).expect("shapes are in range");
        for object in world.objects().iter().filter(|o| !o.is_endless()) {
            let mut parts = Aabb::EMPTY;
            for part in 0..object.surface.part_count() {
                let bounds = object.part_bounds_world(part);
                parts = parts.union(bounds);
            }
            let holds = parts.is_empty() || (object.bounds_world.union(parts) == object.bounds_world);
            prop_assert!(holds, "{:?} in {:?}", parts, object.bounds_world);
        }
    }
}

#[test]
fn coincident_surfaces_give_the_lowest_object_and_part() {
    let at = |shape| (shape, [0.0; 3], [0.0; 3], [1.0; 3], false);
    // Number 5 has the same triangle twice.
    let scene = scene_of(&[at(6), at(5), at(5), at(6)]);
    for kind in Accel::ALL {
        let world = World::with_settings(&scene, &settings(kind)).expect("a world");
        let down_z = Ray::new(DVec3::new(0.2, 0.3, 4.0), -DVec3::Z);
        let hit = world.closest(&down_z, &mut Counters::default()).expect("a hit");
        assert_eq!((hit.object, hit.crossing.part, hit.crossing.t), (1, 0, 4.0), "{kind}");
        let down_y = Ray::new(DVec3::new(0.2, 3.0, 0.3), -DVec3::Y);
        let hit = world.closest(&down_y, &mut Counters::default()).expect("a hit");
        assert_eq!((hit.object, hit.crossing.t), (0, 3.0), "{kind}");
    }
}

#[test]
fn rays_that_are_none_meet_nothing() {
    let scene = scene_of(&[(0, [0.0; 3], [0.0; 3], [1.0; 3], false); 3]);
    let nothing = Scene::default();
    for kind in Accel::ALL {
        let world = World::with_settings(&scene, &settings(kind)).expect("a world");
        let empty = World::with_settings(&nothing, &settings(kind)).expect("a world");
        let mut counters = Counters::default();
        let good = Ray::new(DVec3::Z * 3.0, -DVec3::Z);
        for ray in [
            Ray::new(DVec3::NAN, DVec3::X),
            Ray::new(DVec3::ZERO, DVec3::ZERO),
            Ray::new(DVec3::ZERO, DVec3::new(0.0, f64::INFINITY, 0.0)),
            Ray { t_min: 1.0, t_max: 1.0, ..good },
            Ray { t_min: f64::NAN, ..good },
        ] {
            assert_eq!(world.closest(&ray, &mut counters), None, "{kind} {ray:?}");
            assert!(!world.occluded(&ray, &mut counters, &|_| true), "{kind} {ray:?}");
        }
        assert!(world.closest(&good, &mut counters).is_some());
        assert_eq!(empty.closest(&good, &mut counters), None);
        assert!(!empty.occluded(&good, &mut counters, &|_| true));
    }
}

#[test]
fn volumes_save_tests_and_hold_what_they_bound() {
    let shelf: Vec<Placed> =
        (0..5).map(|i| (i, [5.0 * i as f64 - 10.0, 0.0, 0.0], [0.3, 0.2, 0.1], [1.0; 3], false)).collect();
    let scene = scene_of(&shelf);
    let tests = |kind, ray: &Ray| {
        let world = World::with_settings(&scene, &settings(kind)).expect("a world");
        let mut counters = Counters::default();
        let _ = world.closest(ray, &mut counters);
        counters.tests
    };
    let between = Ray::new(DVec3::new(-7.5, 0.0, 5.0), -DVec3::Z);
    let through = Ray::new(DVec3::new(-10.0, 0.1, 5.0), -DVec3::Z);
    for kind in [Accel::Spheres, Accel::Bounds, Accel::Hierarchy, Accel::Sah, Accel::Bvh] {
        assert_eq!(tests(kind, &between), 0, "{kind}");
        let (some, all) = (tests(kind, &through), tests(Accel::None, &through));
        assert!(some > 0 && 2 * some < all, "{kind}: {some} of {all}");
    }
    let world = World::with_settings(&scene, &settings(Accel::None)).expect("a world");
    for object in world.objects() {
        let sphere = BoundingSphere::around(object);
        for corner in (0..object.surface.part_count()).flat_map(|p| object.part_bounds_world(p).corners()) {
            assert!(corner.distance(sphere.center) <= sphere.radius);
        }
    }
}

#[test]
fn the_hierarchy_tells_which_nodes_were_tested() {
    // Two groups of two spheres, left and right.
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    scene.nodes.clear();
    scene.roots.clear();
    let geometry = Some(senca_scene::GeometryId(0));
    for side in [-10.0, 10.0] {
        let ball = |y: f64| Node {
            geometry,
            transform: Transform::Matrix(DMat4::from_translation(DVec3::new(side, y, 0.0))),
            ..Node::default()
        };
        let children = [3.0, -3.0].map(|y| scene.add_node(ball(y))).to_vec();
        let empty = scene.add_node(Node::default());
        let group = scene.add_node(Node { children: [vec![empty], children].concat(), ..Node::default() });
        scene.roots.push(group);
    }
    let world = World::with_settings(&scene, &settings(Accel::Hierarchy)).expect("a world");
    let hierarchy = Hierarchy::new(&scene, world.objects());
    let ids = |ray: &Ray| {
        let tested = hierarchy.tested(world.objects(), ray);
        tested.into_iter().map(|(node, met)| (node.index(), met)).collect::<Vec<_>>()
    };
    let right_upper = Ray::new(DVec3::new(10.0, 3.0, 5.0), -DVec3::Z);
    assert_eq!(ids(&right_upper), [(3, false), (7, true), (4, true), (5, false)]);
    let nowhere = Ray::new(DVec3::new(0.0, 0.0, 5.0), -DVec3::Z);
    assert_eq!(ids(&nowhere), [(3, false), (7, false)]);
    let mut counters = Counters::default();
    assert!(world.closest(&right_upper, &mut counters).is_some());
    assert_eq!(counters.nodes, 4);
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_followed() {
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    for _ in 0..100_000 {
        let child = *scene.roots.last().expect("a root");
        let parent = scene.add_node(Node { children: vec![child], ..Node::default() });
        scene.roots = vec![parent];
    }
    let world = World::with_settings(&scene, &settings(Accel::Hierarchy)).expect("a world");
    let ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), -DVec3::Z);
    assert!(world.closest(&ray, &mut Counters::default()).is_some());
}
