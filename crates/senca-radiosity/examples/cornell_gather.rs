//! Shows the Cornell box by a hierarchical solution with direct light found at each place, as a PFM
//! picture, and tells how long it took.
//!
//! `cornell_gather OUT.pfm [SIZE] [THRESHOLD] [THREADS] [RINGS] [REACH] [LEAST]`

#[path = "../../senca-trace/src/path/cornell.rs"]
#[expect(dead_code, reason = "shared with others that use more of it")]
mod cornell;

use std::error::Error;
use std::time::Instant;

use rayon::prelude::*;
use senca_math::glam::DVec3;
use senca_math::{Control, LinearRgb};
use senca_radiosity::{
    DirectLight, ElementMesh, Gather, GatherSettings, HierarchySettings, MeshSettings, Occluders,
    regather_reflected, solve_hierarchy,
};
use senca_trace::PrimaryRays;

/// What is seen along a ray.
#[derive(Clone, Copy)]
struct Shown {
    color: [f32; 3],
    polygon: u32,
}

struct Picture<'a> {
    rays: PrimaryRays,
    mesh: &'a ElementMesh,
    occluders: &'a Occluders,
    gather: Gather<'a>,
    size: u32,
}

impl Picture<'_> {
    /// Polygon, place and normal.
    fn seen(&self, x: f64, y: f64) -> Option<(u32, DVec3, DVec3)> {
        let ray = self.rays.through(x, y);
        let hit = self.occluders.closest(ray.origin, ray.direction).filter(|hit| hit.front)?;
        let normal = self.mesh.normal(hit.polygon);
        // Onto the plane of the polygon, which single precision missed by a little.
        let corner = self.mesh.shape(hit.polygon).corners()[0];
        let t = normal.dot(corner - ray.origin) / normal.dot(ray.direction);
        Some((hit.polygon, ray.origin + t * ray.direction, normal))
    }

    fn at(&self, x: f64, y: f64, key: u64) -> Shown {
        let Some((polygon, place, normal)) = self.seen(x, y) else {
            return Shown { color: [0.0; 3], polygon: u32::MAX };
        };
        let surface = self.mesh.surface(polygon);
        let incident: LinearRgb = self.gather.at(place, normal, key);
        let shown = surface.emission + surface.reflectance * incident;
        Shown { color: shown.to_array(), polygon }
    }

    fn prepare(&mut self) -> Result<(), Box<dyn Error>> {
        let n = self.size as usize;
        let of = |i: usize| self.seen((i % n) as f64 + 0.5, (i / n) as f64 + 0.5);
        let seen: Vec<Option<(u32, DVec3, DVec3)>> = (0..n * n).into_par_iter().map(of).collect();
        let places: Vec<(DVec3, DVec3)> =
            seen.iter().flatten().map(|&(_, place, normal)| (place, normal)).collect();
        self.gather.prepare(&places, &Control::default()).map_err(|_| "cancelled")?;
        Ok(())
    }

    /// One sample per pixel, then more where neighbours are different.
    fn pixels(&self) -> Vec<[f32; 3]> {
        let n = self.size as usize;
        let of = |i: usize| self.at((i % n) as f64 + 0.5, (i / n) as f64 + 0.5, i as u64);
        let first: Vec<Shown> = (0..n * n).into_par_iter().map(of).collect();
        let refined = |i: usize| {
            let (x, y) = (i % n, i / n);
            let around = (-1i64..=1).flat_map(|dy| (-1i64..=1).map(move |dx| (dx, dy)));
            let mut largest = 0.0f32;
            for (dx, dy) in around {
                let (x, y) = (x as i64 + dx, y as i64 + dy);
                if x < 0 || y < 0 || x >= n as i64 || y >= n as i64 {
                    continue;
                }
                let other = &first[y as usize * n + x as usize];
                let step = (0..3).map(|c| (other.color[c] - first[i].color[c]).abs()).fold(0.0, f32::max);
                let floor = if other.polygon == first[i].polygon { 0.03 } else { 0.0 };
                largest = largest.max(if step > floor { step } else { 0.0 });
            }
            match largest {
                0.0 => first[i].color,
                step if step > 2.0 => self.mean(x, y, 512),
                step if step > 0.1 => self.mean(x, y, 16),
                _ => self.mean(x, y, 4),
            }
        };
        (0..n * n).into_par_iter().map(refined).collect()
    }

    /// The mean of samples at the points of Hammersley 1960.
    fn mean(&self, x: usize, y: usize, samples: usize) -> [f32; 3] {
        let mut sum = [0.0f64; 3];
        for i in 0..samples {
            let u = (i as f64 + 0.5) / samples as f64;
            let v = f64::from((i as u32).reverse_bits()) / 4_294_967_296.0 + 0.5 / samples as f64;
            let key = ((y * self.size as usize + x) * 1024 + i) as u64 | 1 << 40;
            let shown = self.at(x as f64 + u, y as f64 + v, key);
            (0..3).for_each(|c| sum[c] += f64::from(shown.color[c]));
        }
        sum.map(|s| (s / samples as f64) as f32)
    }
}

#[expect(clippy::print_stdout, reason = "a program tells on standard output")]
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, rest @ ..] = &arguments[..] else {
        return Err("cornell_gather OUT.pfm [SIZE] [THRESHOLD] [THREADS] [RINGS] [REACH] [LEAST]".into());
    };
    let size = rest.first().map_or(Ok(512), |text| text.parse())?;
    let mut settings = HierarchySettings::default();
    if let Some(text) = rest.get(1) {
        settings.threshold = text.parse()?;
    }
    let threads = rest.get(2).map_or(Ok(0), |text| text.parse())?;
    let mut cache = GatherSettings::default();
    if let Some(text) = rest.get(3) {
        cache.rings = text.parse()?;
    }
    if let Some(text) = rest.get(4) {
        cache.reach = text.parse()?;
    }
    if let Some(text) = rest.get(5) {
        cache.least = Some(text.parse()?);
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;

    let start = Instant::now();
    let scene = cornell::with_blocks();
    let mesh = ElementMesh::of_scene(&scene, &MeshSettings::default())?;
    let light = DirectLight::default();
    let mut solution = solve_hierarchy(mesh, &light, &settings, &Control::default(), &mut |_| {})?;
    let solved = start.elapsed().as_secs_f64();
    println!("{:?}", solution.report);
    let occluders = Occluders::new(&solution.mesh)?;
    regather_reflected(&mut solution, &occluders, 16, &Control::default()).map_err(|_| "cancelled")?;
    println!("{:.3} s to gather on leaves", start.elapsed().as_secs_f64() - solved);
    let mut picture = Picture {
        rays: PrimaryRays::new(&cornell::view(), size, size),
        mesh: &solution.mesh,
        occluders: &occluders,
        gather: Gather::new(&solution, &light, &occluders, &cache)?,
        size,
    };
    picture.prepare()?;
    println!(
        "{:.3} s to gather at {} places",
        start.elapsed().as_secs_f64() - solved,
        picture.gather.found()
    );
    let pixels = picture.pixels();
    let seconds = start.elapsed().as_secs_f64();
    println!("{solved:.3} s to solve, {seconds:.3} s in all");
    let mut bytes = format!("PF\n{size} {size}\n-1.0\n").into_bytes();
    for row in pixels.chunks(size as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    std::fs::write(out, bytes)?;
    Ok(())
}
