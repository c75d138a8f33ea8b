//! How build time, memory and the cost of a ray grow with the number of triangles of a bumpy sphere. Each 256
//! rays count with the best of nine passes over all of them.
//!
//! ```sh
//! cargo run --release -p senca-bvh --example curve [MOST_TRIANGLES]
//! ```
#![expect(clippy::print_stdout, reason = "a program")]

use std::time::Instant;

use senca_bvh::{BuildSettings, Ray32, TraversalCounts, TriangleBvh};
use senca_math::glam::Vec3;

/// Rays that are timed together.
const BLOCK: usize = 256;

/// About `2 rows^2` triangles.
fn sphere(rows: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let point = |index: u32| {
        let (theta, phi) = ((index / rows) as f32 / rows as f32, (index % rows) as f32 / rows as f32);
        let (theta, phi) = (theta * std::f32::consts::PI, phi * std::f32::consts::TAU);
        let radius = 1.0 + 0.1 * (11.0 * theta).sin() * (7.0 * phi).cos();
        radius * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let at = |row: u32, column: u32| row * rows + column % rows;
    let squares = (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column)));
    let triangles = squares.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, c, d], [a, d, b]]
    });
    ((0..rows * (rows + 1)).map(point).collect(), triangles.collect())
}

/// From points around the sphere to points within, in no order.
fn rays(count: u32) -> Vec<Ray32> {
    let part = |i: u32| {
        let hash = (i ^ 0x9e37_79b9).wrapping_mul(0x7feb_352d);
        ((hash ^ hash >> 15).wrapping_mul(0x846c_a68b) >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let vector = |i: u32| Vec3::new(part(i), part(i + 1), part(i + 2));
    let ray = |i| {
        let origin = 2.0 * vector(6 * i).normalize_or(Vec3::X);
        Ray32::new(origin, vector(6 * i + 3) - origin)
    };
    (0..count).map(ray).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let most: usize = std::env::args().nth(1).map_or(Ok(10_000_000), |most| most.parse())?;
    let rays = rays(1 << 16);
    println!("triangles  build ms  bytes/triangle  nodes/ray  triangles/ray  ns/ray");
    for rows in [22, 71, 224, 707, 2236] {
        let (points, triangles) = sphere(rows);
        if triangles.len() > most {
            break;
        }
        let start = Instant::now();
        let bvh = TriangleBvh::build(&points, &triangles, &BuildSettings::default())?;
        let build = start.elapsed().as_secs_f64();
        let mut counts = TraversalCounts::default();
        for ray in &rays {
            bvh.closest_counted(ray, &mut counts);
        }
        let mut best = vec![f64::INFINITY; rays.len().div_ceil(BLOCK)];
        for _ in 0..9 {
            for (best, rays) in best.iter_mut().zip(rays.chunks(BLOCK)) {
                let start = Instant::now();
                std::hint::black_box(rays.iter().filter(|ray| bvh.closest(ray).is_some()).count());
                *best = best.min(start.elapsed().as_secs_f64());
            }
        }
        let seconds: f64 = best.iter().sum();
        let per_ray = |count: u64| count as f64 / rays.len() as f64;
        println!(
            "{:9}  {:8.1}  {:14.1}  {:9.2}  {:13.2}  {:6.1}",
            triangles.len(),
            1e3 * build,
            bvh.memory_bytes() as f64 / triangles.len() as f64,
            per_ray(counts.nodes),
            per_ray(counts.triangles),
            1e9 * seconds / rays.len() as f64
        );
    }
    Ok(())
}
