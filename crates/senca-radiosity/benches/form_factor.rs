//! Form factors of one pair by each method, and matrices of a room.

use divan::{Bencher, black_box};
use senca_math::Control;
use senca_math::glam::DVec3;
use senca_radiosity::PatchPolygon;
use senca_radiosity::form_factor::{
    FormFactors, Method, MethodSettings, group_factor, point_to_polygon, polygon_to_polygon,
    polygon_to_polygon_by_contours,
};

fn main() {
    divan::main();
}

type Square = [DVec3; 4];

const FLOOR: Square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];

/// Squares opposite each other, sharing an edge, skew, and far apart.
fn pair(name: &str) -> Square {
    let ceiling = [FLOOR[3], FLOOR[2], FLOOR[1], FLOOR[0]];
    let skew = |p: DVec3| DVec3::new(p.x + 0.3 * p.y, p.y - 0.2 * p.x, 0.8 + 0.4 * p.x + 0.1 * p.y);
    match name {
        "parallel" => ceiling.map(|p| p + DVec3::Z),
        "perpendicular" => [DVec3::ZERO, DVec3::Y, DVec3::new(0.0, 1.0, 1.0), DVec3::Z],
        "skew" => ceiling.map(skew),
        _ => ceiling.map(|p| p + DVec3::Z * 20.0),
    }
}

const PAIRS: [&str; 4] = ["parallel", "perpendicular", "skew", "far"];

#[divan::bench(args = PAIRS)]
fn exact(bencher: Bencher, name: &str) {
    let to = pair(name);
    bencher.bench(|| polygon_to_polygon(black_box(&FLOOR), black_box(&to)));
}

#[divan::bench(args = PAIRS)]
fn contour(bencher: Bencher, name: &str) {
    let to = pair(name);
    bencher.bench(|| polygon_to_polygon_by_contours(black_box(&FLOOR), black_box(&to)));
}

#[divan::bench]
fn point(bencher: Bencher) {
    let to = pair("parallel");
    let from = DVec3::new(0.3, 0.4, 0.0);
    bencher.bench(|| point_to_polygon(black_box(from), DVec3::Z, black_box(&to)));
}

#[divan::bench(args = [Method::DoubleArea, Method::Nusselt, Method::Hemicube, Method::RayCast, Method::MonteCarlo])]
fn parallel_pair(bencher: Bencher, method: Method) {
    let (from, to) = (PatchPolygon::quad(FLOOR), PatchPolygon::quad(pair("parallel")));
    bencher.bench(|| group_factor(&[from], &[to], method, &MethodSettings::default()));
}

/// The inside of a cube, each face in n x n patches.
fn room(n: usize) -> Vec<PatchPolygon> {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let patch = |normal: DVec3, i: usize, j: usize| {
        let (u, v) = normal.any_orthonormal_pair();
        let at = |a: usize, b: usize| normal + u * side(a, n) - v * side(b, n);
        PatchPolygon::quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
    };
    let cells = |normal: DVec3| (0..n * n).map(move |k| patch(normal, k % n, k / n));
    axes.into_iter().flat_map(cells).collect()
}

fn side(k: usize, n: usize) -> f64 {
    2.0 * k as f64 / n as f64 - 1.0
}

#[divan::bench(args = [Method::Exact, Method::RayCast, Method::Hemicube, Method::MonteCarlo], sample_count = 3, sample_size = 1)]
fn matrix_of_600(bencher: Bencher, method: Method) {
    let patches = room(10);
    let settings = MethodSettings { parts: 1, ..MethodSettings::default() };
    bencher.bench(|| FormFactors::compute(&patches, method, &settings, &Control::default()));
}
