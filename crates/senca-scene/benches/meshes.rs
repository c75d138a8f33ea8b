//! Times of the mesh work that a picture of a large model waits for, on data made here.

use divan::{Bencher, black_box};
use senca_scene::math::glam::{DMat4, DVec3};
use senca_scene::{
    BezierPatch, Mesh, NormalSettings, Scene, Shape, TessellationSettings, Tolerance, Topology,
    compute_normals, tessellate,
};

fn main() {
    divan::main();
}

/// A torus of about a million triangles, points shared, without normals.
fn million() -> Mesh {
    let torus = Shape::Torus { major_radius: 2.0, minor_radius: 1.0 };
    let tolerance = Tolerance::Steps(1000, 500);
    let settings = TessellationSettings { tolerance, ..TessellationSettings::default() };
    let mut mesh = tessellate(&torus, &settings).expect("the torus is in order").into_owned();
    mesh.vertices.normal.clear();
    mesh
}

/// A million triangles that share nothing, as STL files have them.
fn soup() -> Mesh {
    let whole = million();
    let mut mesh = whole.clone();
    mesh.points = whole.faces.corners.iter().map(|&v| whole.position(v)).collect();
    mesh.vertices =
        senca_scene::Vertices { point: (0..mesh.points.len() as u32).collect(), ..Default::default() };
    mesh.faces.corners = (0..mesh.points.len() as u32).collect();
    mesh
}

#[divan::bench(sample_count = 10)]
fn check_of_a_million_triangles(bencher: Bencher) {
    let mesh = million();
    bencher.bench_local(|| black_box(&mesh).check());
}

#[divan::bench(sample_count = 10)]
fn normals_of_a_million_triangles(bencher: Bencher) {
    let mesh = million();
    let run = |mut mesh: Mesh| {
        compute_normals(&mut mesh, &NormalSettings::default());
        mesh
    };
    bencher.with_inputs(|| mesh.clone()).bench_local_values(run);
}

#[divan::bench(sample_count = 10)]
fn topology_of_a_million_triangles(bencher: Bencher) {
    let mesh = million();
    bencher.bench_local(|| Topology::new(black_box(&mesh)));
}

#[divan::bench(sample_count = 10)]
fn welding_of_a_million_triangles(bencher: Bencher) {
    let mesh = soup();
    let run = |mut mesh: Mesh| {
        mesh.weld(0.0);
        mesh
    };
    bencher.with_inputs(|| mesh.clone()).bench_local_values(run);
}

#[divan::bench(sample_count = 10)]
fn bounds_of_a_million_triangles_turned(bencher: Bencher) {
    let mut scene = Scene::of_shape("", Shape::Mesh(million()));
    scene.nodes[0].transform = senca_scene::Transform::Matrix(DMat4::from_rotation_x(0.3));
    bencher.bench_local(|| black_box(&scene).bounds());
}

#[divan::bench(sample_count = 10)]
fn framing_of_a_million_triangles(bencher: Bencher) {
    let scene = Scene::of_shape("", Shape::Mesh(million()));
    bencher.bench_local(|| black_box(&scene).frame_all(1.5));
}

#[divan::bench(sample_count = 10)]
fn sphere_of_a_million_triangles(bencher: Bencher) {
    let settings = TessellationSettings { tolerance: Tolerance::Steps(1000, 500), ..Default::default() };
    bencher.bench_local(|| tessellate(&Shape::Sphere { radius: 1.0 }, &settings).map(|m| m.into_owned()));
}

/// 32 patches in two tolerances.
#[divan::bench(sample_count = 10, args = [1e-2, 1e-4])]
fn thirty_two_patches(bencher: Bencher, tolerance: f64) {
    let patch = |n: u32| {
        let point = |i: usize| {
            let (x, z) = ((i % 4) as f64, (i / 4) as f64);
            DVec3::new(x + 3.0 * f64::from(n % 8), (x * 1.3 + z * 2.1).sin(), z + 3.0 * f64::from(n / 8))
        };
        BezierPatch { points: std::array::from_fn(point), surface: 0 }
    };
    let shape = Shape::BezierPatches { patches: (0..32).map(patch).collect() };
    let settings = TessellationSettings { tolerance: Tolerance::World(tolerance), ..Default::default() };
    bencher.bench_local(|| tessellate(&shape, &settings).map(|m| m.into_owned()));
}
