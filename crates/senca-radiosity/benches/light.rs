//! Light of a room by each solver, what arrives at places of it, and its file.

use divan::{Bencher, black_box};
use senca_math::glam::DVec3;
use senca_math::{Control, LinearRgb};
use senca_radiosity::book::{BookSettings, Relaxation, ShootingRule, solve_mesh};
use senca_radiosity::{
    DirectLight, ElementMesh, Gather, GatherSettings, HierarchySettings, NodeTransfer, Occluders, Solution,
    solve_hierarchy,
};

fn main() {
    divan::main();
}

/// A box, seen from inside where `inside` says so.
fn walls(low: DVec3, size: DVec3, inside: bool) -> [[DVec3; 4]; 6] {
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let all = [(low, y, z), (low + x, z, y), (low, z, x), (low + y, x, z), (low, x, y), (low + z, y, x)];
    all.map(|(o, u, v)| if inside { [o, o + u, o + u + v, o + v] } else { [o, o + v, o + u + v, o + u] })
}

/// A room of 4 x 3 x 5 with a lamp below its ceiling and so many blocks on its floor.
fn room(blocks: u32) -> ElementMesh {
    let (grey, black) = (LinearRgb::splat(0.7), LinearRgb::BLACK);
    let mut polygons: Vec<([DVec3; 4], LinearRgb, LinearRgb)> = Vec::new();
    polygons.extend(walls(DVec3::ZERO, DVec3::new(4.0, 3.0, 5.0), true).map(|wall| (wall, grey, black)));
    let lamp = [[1.6, 2.0], [2.4, 2.0], [2.4, 3.0], [1.6, 3.0]].map(|[x, z]| DVec3::new(x, 2.98, z));
    polygons.push((lamp, black, LinearRgb::splat(12.0)));
    for block in 0..blocks {
        let at = |k: f64, size: f64| (f64::from(block + 1) * k).fract() * size;
        let low = DVec3::new(at(0.618_033_988, 3.4) + 0.1, 0.0, at(0.754_877_666, 4.4) + 0.1);
        let size = DVec3::new(0.3, 0.3 + at(0.324_717_957, 1.0), 0.3);
        polygons.extend(walls(low, size, false).map(|wall| (wall, grey, black)));
    }
    let polygons: Vec<_> = polygons.iter().map(|(c, r, e)| (&c[..], *r, *e)).collect();
    ElementMesh::of_polygons(&polygons)
}

fn by_hierarchy(mesh: ElementMesh, settings: &HierarchySettings) -> Solution {
    solve_hierarchy(mesh, &DirectLight::default(), settings, &Control::default(), &mut |_| {})
        .expect("a solution")
}

#[divan::bench(args = [0, 10, 100], sample_count = 5, sample_size = 1)]
fn hierarchical(bencher: Bencher, blocks: u32) {
    let mesh = room(blocks);
    bencher.bench(|| by_hierarchy(mesh.clone(), &HierarchySettings::default()));
}

/// Plain bounces, and steps that learn from those before.
#[divan::bench(args = [0, 4], sample_count = 5, sample_size = 1)]
fn hierarchical_remembering(bencher: Bencher, remembered: usize) {
    let mesh = room(10);
    let settings = HierarchySettings { remembered, ..HierarchySettings::default() };
    bencher.bench(|| by_hierarchy(mesh.clone(), &settings));
}

#[divan::bench(args = ["gauss-seidel", "shooting"], sample_count = 3, sample_size = 1)]
fn book(bencher: Bencher, solver: &str) {
    let mut mesh = room(4);
    mesh.divide_to_size(0.5, 1 << 14).expect("few");
    let relaxation = match solver {
        "shooting" => Relaxation::Shooting(ShootingRule::default()),
        _ => Relaxation::GaussSeidel,
    };
    let settings = BookSettings { relaxation, rounds: 1, ..BookSettings::default() };
    bencher
        .bench(|| solve_mesh(mesh.clone(), &DirectLight::default(), &settings, &Control::default(), |_| {}));
}

#[divan::bench]
fn gather_at_a_place(bencher: Bencher) {
    let solution = by_hierarchy(room(10), &HierarchySettings { threshold: 1e-3, ..Default::default() });
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let gather = Gather::new(&solution, &DirectLight::default(), &occluders, &GatherSettings::default())
        .expect("good settings");
    let mut key = 0;
    bencher.bench_local(|| {
        key += 1;
        let at = |k: f64, size: f64| (key as f64 * k).fract() * size;
        gather.at(DVec3::new(at(0.618_033_988, 4.0), 0.0, at(0.754_877_666, 5.0)), DVec3::Y, key)
    });
}

#[divan::bench]
fn nodes(bencher: Bencher) {
    let solution = by_hierarchy(room(10), &HierarchySettings::default());
    bencher.bench(|| NodeTransfer::new(black_box(&solution.mesh)));
}

#[divan::bench]
fn save_and_load(bencher: Bencher) {
    let solution = by_hierarchy(room(10), &HierarchySettings::default());
    bencher.bench(|| Solution::load(&solution.save(1), Some(1)));
}
