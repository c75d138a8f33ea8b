//! Building a hierarchy over a bumpy sphere, and tracing rays that scatter from it.

use divan::{Bencher, black_box, counter::ItemsCount};
use senca_bvh::{BuildSettings, Ray32, TriangleBvh};
use senca_math::glam::Vec3;

fn main() {
    divan::main();
}

struct Mesh {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// About `2 rows^2` triangles.
fn sphere(rows: u32) -> Mesh {
    let at = |row: u32, column: u32| row * rows + column % rows;
    let point = |index: u32| {
        let (theta, phi) = ((index / rows) as f32 / rows as f32, (index % rows) as f32 / rows as f32);
        let (theta, phi) = (theta * std::f32::consts::PI, phi * std::f32::consts::TAU);
        let radius = 1.0 + 0.1 * (11.0 * theta).sin() * (7.0 * phi).cos();
        radius * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let squares = (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column)));
    Mesh {
        points: (0..rows * (rows + 1)).map(point).collect(),
        triangles: squares
            .flat_map(|(row, column)| {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                [[a, c, d], [a, d, b]]
            })
            .collect(),
    }
}

fn build(mesh: &Mesh) -> TriangleBvh {
    TriangleBvh::build(&mesh.points, &mesh.triangles, &BuildSettings::default())
        .expect("indices are in range")
}

/// From points around the mesh to points within.
fn rays(count: u32) -> Vec<Ray32> {
    let part = |i: u32| {
        let hash = (i ^ 0x9e37_79b9).wrapping_mul(0x7feb_352d);
        ((hash ^ hash >> 15).wrapping_mul(0x846c_a68b) >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let vector = |i: u32| Vec3::new(part(i), part(i + 1), part(i + 2));
    (0..count)
        .map(|i| {
            let origin = 2.0 * vector(6 * i).normalize_or(Vec3::X);
            Ray32::new(origin, vector(6 * i + 3) - origin)
        })
        .collect()
}

const SIZES: [u32; 3] = [32, 187, 700];

#[divan::bench(args = SIZES)]
fn build_triangles(bencher: Bencher, rows: u32) {
    let mesh = sphere(rows);
    bencher.counter(ItemsCount::new(mesh.triangles.len())).bench(|| build(black_box(&mesh)));
}

#[divan::bench(args = SIZES)]
fn closest(bencher: Bencher, rows: u32) {
    let (bvh, rays) = (build(&sphere(rows)), rays(1 << 14));
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench(|| rays.iter().filter(|ray| bvh.closest(black_box(ray)).is_some()).count());
}

#[divan::bench(args = SIZES)]
fn occluded(bencher: Bencher, rows: u32) {
    let (bvh, rays) = (build(&sphere(rows)), rays(1 << 14));
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench(|| rays.iter().filter(|ray| bvh.occluded(black_box(ray))).count());
}
