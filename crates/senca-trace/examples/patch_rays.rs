//! Rays per second on the teapot, met without tessellation: a picture's primary rays, and rays from
//! points on it towards a light.
//!
//! ```sh
//! cargo run --release -p senca-trace --example patch_rays -- samples/classic/teapot.bez
//! ```

#![expect(clippy::print_stdout, reason = "the figures are what this program is for")]

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use senca_math::glam::DVec3;
use senca_scene::Shape;
use senca_trace::{Counters, Intersect, PatchSurface, Ray};

/// Rays through the pixels of a picture of 640 by 480 from a place in front of the teapot.
fn primary_rays() -> Vec<Ray> {
    let eye = DVec3::new(1.5, -8.0, 4.5);
    let forward = (DVec3::new(0.2, 0.0, 1.4) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let pixel = |i: u32| {
        let (x, y) = (f64::from(i % 640) + 0.5 - 320.0, f64::from(i / 640) + 0.5 - 240.0);
        Ray::new(eye, forward + (x * right - y * up) / 700.0)
    };
    (0..640 * 480).map(pixel).collect()
}

/// Nanoseconds per ray, the best of several runs of each thousand, and what the rays cost.
fn measure(name: &str, surface: &PatchSurface, rays: &[Ray], meet: impl Fn(&Ray, &mut Counters) -> bool) {
    let (mut met, mut counters, mut best) = (0, Counters::default(), 0.0);
    for some in rays.chunks(1000) {
        let mut least = f64::INFINITY;
        for run in 0..12 {
            let start = Instant::now();
            let mut cost = Counters::default();
            let count = some.iter().filter(|ray| meet(ray, &mut cost)).count();
            least = least.min(start.elapsed().as_secs_f64());
            if run == 0 {
                met += count;
                counters += cost;
            }
        }
        best += least;
    }
    let each = |total: u64| total as f64 / rays.len() as f64;
    println!(
        "{name:<28} {:6.1} ns a ray, {:.2} Mrays/s, {:4.1} % meet it; {:.2} nodes, {:.2} cells a ray; {} patches",
        1e9 * best / rays.len() as f64,
        1e-6 * rays.len() as f64 / best,
        100.0 * met as f64 / rays.len() as f64,
        each(counters.nodes),
        each(counters.tests),
        surface.part_count(),
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "samples/classic/teapot.bez".to_owned());
    let scene = senca_io::load(Path::new(&file))?;
    let patches = scene.geometries.iter().find_map(|geometry| match &geometry.shape {
        Shape::BezierPatches { patches } => Some(patches),
        _ => None,
    });
    let patches = patches.ok_or("no patches in this file")?;
    let mut build = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        PatchSurface::from_bezier(patches)?;
        build = build.min(start.elapsed().as_secs_f64());
    }
    let surface = PatchSurface::from_bezier(patches)?;
    println!("built in {:.2} ms, {} cells, {} bytes", 1e3 * build, surface.cell_count(), surface.memory());
    let rays = primary_rays();
    measure("primary, nearest", &surface, &rays, |ray, counters| surface.closest(ray, counters).is_some());
    let met: Vec<(Ray, f64)> = rays
        .iter()
        .filter_map(|ray| Some((*ray, surface.closest(ray, &mut Counters::default())?.t)))
        .collect();
    let only: Vec<Ray> = met.iter().map(|(ray, _)| *ray).collect();
    measure("those that meet it, nearest", &surface, &only, |ray, c| surface.closest(ray, c).is_some());
    measure("the same, any", &surface, &only, |ray, counters| surface.occludes(ray, counters));
    let light = DVec3::new(10.0, -30.0, 40.0);
    let shadow: Vec<Ray> = met
        .iter()
        .map(|(ray, t)| Ray { t_min: 1e-9, t_max: 1.0, ..Ray::new(ray.at(*t), light - ray.at(*t)) })
        .collect();
    measure("to the light, any", &surface, &shadow, |ray, counters| surface.occludes(ray, counters));
    let reflected: Vec<Ray> = met
        .iter()
        .filter_map(|(ray, _)| {
            let hit = surface.closest(ray, &mut Counters::default())?;
            let point = surface.surface_point(ray, &hit);
            let direction = ray.direction - 2.0 * ray.direction.dot(point.normal) * point.normal;
            Some(Ray { t_min: 1e-9, ..Ray::new(ray.at(hit.t), direction) })
        })
        .collect();
    measure("reflected, nearest", &surface, &reflected, |ray, counters| {
        surface.closest(ray, counters).is_some()
    });
    Ok(())
}
