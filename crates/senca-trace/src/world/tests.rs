//! What the world makes of a scene, and rays that start on its surfaces.

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec3};
use senca_scene::{AlphaMode, Material, Node, Scene, Shape, Tolerance, Transform};

use super::*;

fn placed(shape: Shape, matrix: DMat4) -> Scene {
    let mut scene = Scene::of_shape("thing", shape);
    scene.nodes[0].transform = Transform::Matrix(matrix);
    scene
}

fn hit(world: &World<'_>, ray: &Ray) -> Option<Interaction> {
    let hit = world.closest(ray, &mut Counters::default())?;
    Some(world.interaction(ray, &hit))
}

#[test]
fn a_flattened_sphere_is_a_disc() {
    let scene = placed(Shape::Sphere { radius: 1.0 }, DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)));
    let world = World::new(&scene).expect("a world");
    assert!(world.warnings().is_empty());
    let at = hit(&world, &Ray::new(DVec3::new(0.3, 2.0, 0.2), -DVec3::Y)).expect("a hit");
    assert_eq!(at.point.y, 0.0);
    assert!(at.normal.y.abs() > 0.999);
    assert!(hit(&world, &Ray::new(DVec3::new(1.3, 2.0, 0.2), -DVec3::Y)).is_none());
}

#[test]
fn places_that_are_not_finite_are_left_out_and_told() {
    let mut scene = placed(Shape::Sphere { radius: 1.0 }, DMat4::from_scale(DVec3::splat(f64::NAN)));
    let geometry = scene.nodes[0].geometry;
    let good = scene.add_node(Node { geometry, ..Node::default() });
    scene.roots.push(good);
    let world = World::new(&scene).expect("a world");
    assert_eq!(world.objects().len(), 1);
    assert!(world.warnings()[0].0.contains("\"thing\""), "{:?}", world.warnings());
}

#[test]
fn only_materials_that_let_light_pass_are_asked_about() {
    let glass = Material { transmission: LinearRgb::WHITE, ..Material::default() };
    let leaf = Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() };
    let film = Material { alpha_mode: AlphaMode::Blend, ..Material::default() };
    for (material, opaque) in [(Material::default(), true), (glass, false), (leaf, false), (film, false)] {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        scene.geometries[0].material = Some(scene.add_material(material));
        let world = World::new(&scene).expect("a world");
        assert_eq!(world.objects()[0].opaque, opaque);
        let ray = Ray::new(DVec3::Z * 3.0, -DVec3::Z);
        let blocked = world.occluded(&ray, &mut Counters::default(), &|_| false);
        assert_eq!(blocked, opaque, "without being asked");
    }
}

#[test]
fn instances_share_what_they_show() {
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    let geometry = scene.nodes[0].geometry;
    let alone = World::new(&scene).expect("a world").memory_bytes();
    for i in 1..50 {
        let transform = Transform::Matrix(DMat4::from_translation(DVec3::X * 3.0 * f64::from(i)));
        let node = scene.add_node(Node { geometry, transform, ..Node::default() });
        scene.roots.push(node);
    }
    let world = World::new(&scene).expect("a world");
    let each = (world.memory_bytes() - alone) / 49;
    assert!(each < 2000, "{each} bytes for each further one");
}

#[test]
fn a_mirrored_body_has_its_outside_outside() {
    let mirrored = DMat4::from_scale(DVec3::new(-1.0, 2.0, 1.0));
    let scene = placed(Shape::Box { size: DVec3::splat(2.0) }, mirrored);
    let world = World::new(&scene).expect("a world");
    let at = hit(&world, &Ray::new(DVec3::new(5.0, 0.1, 0.2), -DVec3::X)).expect("a hit");
    assert!(at.entering);
    assert!((at.normal - DVec3::X).length() < 1e-12, "{}", at.normal);
    let inside = hit(&world, &Ray::new(DVec3::ZERO, DVec3::new(0.0, 0.7, 0.1))).expect("a hit");
    assert!(!inside.entering);
}

#[test]
fn epsilon_must_be_a_length() {
    let scene = Scene::default();
    for epsilon in [-1.0, f64::NAN, f64::INFINITY] {
        let settings = WorldSettings { epsilon: Some(epsilon), ..WorldSettings::default() };
        assert!(matches!(World::with_settings(&scene, &settings), Err(TraceError::Setting { .. })));
    }
}

fn coarse() -> WorldSettings {
    let tessellation = TessellationSettings { tolerance: Tolerance::Steps(32, 16), ..Default::default() };
    WorldSettings { tessellation, ..WorldSettings::default() }
}

/// Rays from all over a body that is seen from `eye`: outward ones must leave it, however flat.
fn outward_rays_leave(shape: Shape, place: DMat4, size: f64, eye: DVec3) {
    let scene = placed(shape, place);
    let world = World::with_settings(&scene, &coarse()).expect("a world");
    let center = place.transform_point3(DVec3::ZERO);
    let mut met = 0;
    // From 1, since 0 is a corner, where inside and outside are but a matter of rounding.
    for i in 1..2000u32 {
        let turn = |k: u32| f64::from((i * k) % 2003) / 2003.0 - 0.5;
        let target = center + size * DVec3::new(turn(7), turn(91), turn(577));
        let Some(at) = hit(&world, &Ray::new(eye, target - eye)) else { continue };
        met += 1;
        let tangent = at.normal.any_orthonormal_vector();
        for angle in [1e-7, 1e-3, 0.3, 1.5f64] {
            let direction = angle.cos() * tangent + angle.sin() * at.normal;
            let ray = world.spawn(&at, direction);
            let blocked = world.occluded(&ray, &mut Counters::default(), &|_| true);
            assert!(!blocked, "at {} under {angle}", at.point);
            let inward = world.spawn(&at, angle.cos() * tangent - angle.sin() * at.normal);
            assert!(world.closest(&inward, &mut Counters::default()).is_some(), "{}", at.point);
        }
    }
    assert!(met > 100, "{met}");
}

#[test]
fn rays_leave_convex_bodies_of_every_size_at_every_angle() {
    for size in [1e-6, 1.0, 1e6] {
        let eye = size * DVec3::new(2.0, 3.0, 4.0);
        let scale = DMat4::from_scale(DVec3::splat(size));
        let cube = || Shape::Box { size: DVec3::ONE };
        outward_rays_leave(cube(), scale, size, eye);
        outward_rays_leave(Shape::Box { size: DVec3::splat(size) }, DMat4::IDENTITY, size, eye);
        outward_rays_leave(Shape::Sphere { radius: 0.5 * size }, DMat4::IDENTITY, size, eye);
        let far = DMat4::from_translation(DVec3::splat(1000.0 * size)) * scale;
        outward_rays_leave(cube(), far, size, eye);
    }
}

#[test]
fn touching_bodies_shade_each_other_right() {
    // A cube of edge 1 that stands on another one.
    let mut scene = placed(Shape::Box { size: DVec3::ONE }, DMat4::IDENTITY);
    let geometry = scene.nodes[0].geometry;
    let transform = Transform::Matrix(DMat4::from_translation(DVec3::Y));
    let upper = scene.add_node(Node { geometry, transform, ..Node::default() });
    scene.roots.push(upper);
    let world = World::new(&scene).expect("a world");
    let side = hit(&world, &Ray::new(DVec3::new(3.0, 0.499, 0.0), -DVec3::X)).expect("a hit");
    let up = world.spawn(&side, DVec3::new(1e-3, 1.0, 0.0));
    assert!(!world.occluded(&up, &mut Counters::default(), &|_| true));
    let across = world.spawn(&side, DVec3::new(-1e-3, 1.0, 0.0));
    assert!(world.occluded(&across, &mut Counters::default(), &|_| true));
}

#[test]
fn shadow_rays_end_before_their_target() {
    let scene = placed(Shape::Box { size: DVec3::new(10.0, 1.0, 10.0) }, DMat4::IDENTITY);
    let world = World::new(&scene).expect("a world");
    let at = hit(&world, &Ray::new(DVec3::new(0.0, 3.0, 0.0), -DVec3::Y)).expect("a hit");
    let down = world.spawn_to(&at, DVec3::new(0.0, -0.5, 0.0));
    assert!(!world.occluded(&down, &mut Counters::default(), &|_| true), "the bottom is the target");
    let further = world.spawn_to(&at, DVec3::new(0.0, -0.6, 0.0));
    assert!(world.occluded(&further, &mut Counters::default(), &|_| true));
}

#[test]
fn the_epsilon_of_the_text_can_be_asked_for() {
    let scene = placed(Shape::Box { size: DVec3::ONE }, DMat4::IDENTITY);
    let settings = WorldSettings { epsilon: Some(0.01), ..WorldSettings::default() };
    let world = World::with_settings(&scene, &settings).expect("a world");
    let at = hit(&world, &Ray::new(DVec3::new(0.1, 3.0, 0.1), -DVec3::Y)).expect("a hit");
    let ray = world.spawn(&at, 2.0 * DVec3::Y);
    assert_eq!((ray.origin, ray.t_min), (at.point, 0.005));
}

#[test]
fn leaves_of_bodies_put_together_keep_their_materials() {
    use senca_scene::{Csg, CsgNode, Geometry, MaterialId};
    let leaf = |x: f64, material| {
        let place = Transform::Matrix(DMat4::from_translation(DVec3::X * x));
        CsgNode::leaf(Shape::Sphere { radius: 1.0 }, place, material)
    };
    let root = CsgNode::Difference(vec![leaf(0.0, None), leaf(1.0, Some(MaterialId(1)))]);
    let mut scene = Scene { materials: vec![Material::default(); 2], ..Scene::default() };
    let shape = Shape::Csg(Csg { root });
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: Some(MaterialId(0)) });
    let node = scene.add_node(Node { geometry: Some(geometry), ..Node::default() });
    scene.roots.push(node);
    let world = World::new(&scene).expect("a world");
    for (x, t, material, normal) in [(-5.0, 4.0, 0, -1.0), (5.0, 5.0, 1, 1.0)] {
        let ray = Ray::new(DVec3::X * x, DVec3::X * -f64::signum(x));
        let hit = world.closest(&ray, &mut Counters::default()).expect("a hit");
        let met = world.interaction(&ray, &hit);
        assert!((hit.crossing.t - t).abs() < 1e-9, "{}", hit.crossing.t);
        assert_eq!(met.material, material);
        assert!(
            (met.normal - DVec3::X * normal).length() < 1e-9,
            "outward, also where a body was taken away"
        );
    }
}
