//! What a ray costs: `cargo run --release -p senca-trace --example world_speed [ACCEL]`.
//!
//! Nanoseconds for nearest hits of primary rays, and for shadow rays from there, best of several runs on
//! one thread: on ten spheres above a plane, on a ball of triangles, and on a thousand instances of it.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::hint::black_box;
use std::time::Instant;

use senca_math::View;
use senca_math::glam::{DMat4, DVec3};
use senca_scene::{
    Geometry, GeometryId, Node, Scene, Shape, TessellationSettings, Tolerance, Transform, tessellate,
};
use senca_trace::{Accel, Counters, PrimaryRays, Ray, World, WorldSettings};

const SIDE: u32 = 400;
const RUNS: usize = 15;

fn main() {
    let kind = std::env::args().nth(1).and_then(|name| name.parse().ok()).unwrap_or_default();
    println!("{:<12} {:>9} {:>9} {:>8} {:>8} {:>8}", kind, "closest", "occluded", "tests", "nodes", "hits");
    measure("spheres", &spheres(), kind, DVec3::new(0.0, 4.0, 9.0));
    measure("ball", &ball(), kind, DVec3::new(0.0, 1.0, 3.0));
    measure("instances", &instances(), kind, DVec3::new(3.0, 9.0, 25.0));
}

fn placed(scene: &mut Scene, shape: Shape, place: DVec3) -> GeometryId {
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: None });
    place_again(scene, geometry, DMat4::from_translation(place));
    geometry
}

fn place_again(scene: &mut Scene, geometry: GeometryId, matrix: DMat4) {
    let transform = Transform::Matrix(matrix);
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

/// Ten spheres in a triangle, like skittles, above an endless plane.
fn spheres() -> Scene {
    let mut scene = Scene::default();
    for row in 0..4u32 {
        for i in 0..=row {
            let x = 2.2 * (f64::from(i) - 0.5 * f64::from(row));
            let place = DVec3::new(x, 1.0, 2.0 - 1.9 * f64::from(row));
            placed(&mut scene, Shape::Sphere { radius: 1.0 }, place);
        }
    }
    placed(&mut scene, Shape::Plane { size: None }, DVec3::ZERO);
    scene
}

fn mesh() -> Shape {
    let settings = TessellationSettings { tolerance: Tolerance::Steps(264, 132), ..Default::default() };
    let mesh = tessellate(&Shape::Sphere { radius: 1.0 }, &settings).expect("a mesh").into_owned();
    Shape::Mesh(mesh)
}

fn ball() -> Scene {
    Scene::of_shape("ball", mesh())
}

fn instances() -> Scene {
    let mut scene = ball();
    scene.roots.clear();
    for i in 0..1000u32 {
        let place = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 2.5 - 11.0;
        let turned = DMat4::from_translation(place) * DMat4::from_rotation_x(f64::from(i));
        place_again(&mut scene, GeometryId(0), turned);
    }
    scene
}

fn measure(name: &str, scene: &Scene, kind: Accel, eye: DVec3) {
    let settings = WorldSettings { accel: kind.into(), ..WorldSettings::default() };
    let world = World::with_settings(scene, &settings).expect("a world");
    let world_from_camera = View::look_at(eye, DVec3::ZERO, DVec3::Y).expect("a frame");
    let view = View::perspective(&world_from_camera, 0.8, 1.0, 0.1, None).expect("a view");
    let primary = PrimaryRays::new(&view, SIDE, SIDE);
    let pixel = |i: u32| (f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5);
    let rays: Vec<Ray> = (0..SIDE * SIDE).map(pixel).map(|(x, y)| primary.through(x, y)).collect();

    let mut counters = Counters::default();
    let light = DVec3::new(30.0, 50.0, 20.0);
    let shadow: Vec<Ray> = rays
        .iter()
        .filter_map(|ray| Some((ray, world.closest(ray, &mut counters)?)))
        .map(|(ray, hit)| world.spawn_to(&world.interaction(ray, &hit), light))
        .collect();
    let closest = best(&rays, |ray, counters| world.closest(ray, counters).is_some());
    let occluded = best(&shadow, |ray, counters| world.occluded(ray, counters, &|_| true));
    let each = |count: u64| count as f64 / rays.len() as f64;
    println!(
        "{name:<12} {closest:>6.1} ns {occluded:>6.1} ns {:>8.2} {:>8.2} {:>8.2}",
        each(counters.tests),
        each(counters.nodes),
        each(shadow.len() as u64),
    );
}

/// Nanoseconds for a ray in the best of several runs.
fn best(rays: &[Ray], ask: impl Fn(&Ray, &mut Counters) -> bool) -> f64 {
    let run = |_| {
        let mut counters = Counters::default();
        let start = Instant::now();
        let met = rays.iter().filter(|ray| ask(ray, &mut counters)).count();
        let seconds = start.elapsed().as_secs_f64();
        black_box((met, counters));
        1e9 * seconds / rays.len() as f64
    };
    (0..RUNS).map(run).fold(f64::INFINITY, f64::min)
}
