//! Traces the rays of a file that another tracer has written, compares the hits and measures the speed.
//!
//! ```sh
//! cargo run --release -p senca-bvh --example raybench -- FILE.rayb [--reps 9] [--threads 2] [--level baseline]
//! ```
//!
//! `--best 256` prints one line from the best time of each 256 rays, on as many threads at once as there are,
//! which other work on the machine disturbs less.
//!
//! The file holds, little-endian: "RAYB", u32 version 1, u32 points, u32 triangles, f32 points, u32 indices,
//! u32 sets, and per set a name of 16 bytes, u32 rays, and rays of f32 origin[3], direction[3], t_min,
//! t_max, t of the closest hit, u32 triangle (u32::MAX: none).
#![expect(clippy::print_stdout, reason = "a program")]

use std::collections::BTreeMap;
use std::time::Instant;

use rayon::prelude::*;
use senca_bvh::{BuildSettings, Ray32, SimdLevel, TraversalCounts, TriangleBvh};
use senca_math::glam::Vec3;

struct Expected {
    ray: Ray32,
    t: f32,
    triangle: u32,
}

struct Set {
    name: String,
    rays: Vec<Expected>,
}

struct File {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    sets: Vec<Set>,
}

type Failure = Box<dyn std::error::Error>;

/// What is left of the file.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn bytes(&mut self, count: usize) -> Result<&[u8], Failure> {
        let (bytes, rest) = self.0.split_at_checked(count).ok_or("the file ends too early")?;
        self.0 = rest;
        Ok(bytes)
    }

    fn u32(&mut self) -> Result<u32, Failure> {
        Ok(u32::from_le_bytes(self.bytes(4)?.try_into()?))
    }

    fn f32(&mut self) -> Result<f32, Failure> {
        Ok(f32::from_bits(self.u32()?))
    }

    fn vec3(&mut self) -> Result<Vec3, Failure> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    fn expected(&mut self) -> Result<Expected, Failure> {
        let (origin, direction) = (self.vec3()?, self.vec3()?);
        let ray = Ray32 { origin, direction, t_min: self.f32()?, t_max: self.f32()? };
        Ok(Expected { ray, t: self.f32()?, triangle: self.u32()? })
    }

    fn set(&mut self) -> Result<Set, Failure> {
        let name = String::from_utf8_lossy(self.bytes(16)?).trim_end_matches('\0').to_owned();
        let count = self.u32()?;
        Ok(Set { name, rays: (0..count).map(|_| self.expected()).collect::<Result<_, _>>()? })
    }

    fn file(&mut self) -> Result<File, Failure> {
        if self.bytes(4)? != b"RAYB" || self.u32()? != 1 {
            return Err("not a ray file of version 1".into());
        }
        let (points, triangles) = (self.u32()?, self.u32()?);
        Ok(File {
            points: (0..points).map(|_| self.vec3()).collect::<Result<_, _>>()?,
            triangles: (0..triangles)
                .map(|_| Ok([self.u32()?, self.u32()?, self.u32()?]))
                .collect::<Result<_, Failure>>()?,
            sets: (0..self.u32()?).map(|_| self.set()).collect::<Result<_, _>>()?,
        })
    }
}

fn main() -> Result<(), Failure> {
    let mut paths = Vec::new();
    let mut options =
        BTreeMap::from([("--reps".to_owned(), "9".to_owned()), ("--threads".to_owned(), "2".to_owned())]);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument.starts_with("--") {
            options.insert(argument, arguments.next().ok_or("an option without a value")?);
        } else {
            paths.push(argument);
        }
    }
    let reps = options["--reps"].parse::<usize>()?.max(1);
    let threads = options["--threads"].parse::<usize>()?.max(1);
    let best_of = options.get("--best").map(|rays| rays.parse::<usize>()).transpose()?;
    let level = match options.get("--level").map(String::as_str) {
        Some("baseline") => SimdLevel::baseline(),
        #[cfg(target_arch = "x86_64")]
        Some("avx2") => SimdLevel::new().as_avx2().map_or(SimdLevel::baseline(), SimdLevel::Avx2),
        _ => SimdLevel::new(),
    };
    for path in paths {
        let file = Reader(&std::fs::read(&path)?).file()?;
        measure(&path, &file, &BuildSettings { level }, reps, threads, best_of)?;
    }
    Ok(())
}

fn measure(
    path: &str,
    file: &File,
    settings: &BuildSettings,
    reps: usize,
    threads: usize,
    best_of: Option<usize>,
) -> Result<(), Failure> {
    let count = file.triangles.len();
    println!("# {path}: {count} triangles, {} points, {:?}", file.points.len(), settings.level);
    let pools = (1..=threads)
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect::<Result<Vec<_>, _>>()?;
    let build = || TriangleBvh::build(&file.points, &file.triangles, settings);
    if let Some(block) = best_of {
        return undisturbed(file, build, reps, threads, block);
    }
    for pool in &pools {
        let seconds = times(if count > 500_000 { 3 } else { 2 * reps }, || drop(pool.install(build)));
        println!(
            "build-medium threads {}: {:9.2} ms  min {:.2} max {:.2}",
            pool.current_num_threads(),
            1e3 * median(&seconds),
            1e3 * seconds[0],
            1e3 * seconds[seconds.len() - 1]
        );
    }
    let bvh = build()?;
    let bytes = bvh.memory_bytes() as f64 / count as f64;
    println!("memory {bytes:.1} bytes a triangle");
    for set in &file.sets {
        compare(&bvh, set);
        for any in [false, true] {
            for pool in &pools {
                speed(&bvh, set, any, pool, reps);
            }
        }
    }
    Ok(())
}

fn undisturbed(
    file: &File,
    build: impl Fn() -> Result<TriangleBvh, senca_bvh::BuildError> + Send + Sync,
    reps: usize,
    threads: usize,
    block: usize,
) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let seconds = times(2 * reps, || drop(pool.install(&build)));
    let bvh = build()?;
    let bytes = bvh.memory_bytes() as f64 / file.triangles.len() as f64;
    print!("threads {threads} build {:.2} ms, {bytes:.1} bytes |", 1e3 * seconds[0]);
    for set in &file.sets {
        for any in [false, true] {
            let share = set.rays.len().div_ceil(threads);
            let rates = pool.broadcast(|thread| {
                let rays = set.rays.chunks(share).nth(thread.index()).unwrap_or(&[]);
                rays.len() as f64 / best_times(&bvh, rays, any, reps, block.max(1))
            });
            print!(
                " {} {} {:.2}",
                set.name,
                if any { "any" } else { "closest" },
                1e-6 * rates.iter().sum::<f64>()
            );
        }
        print!(" |");
    }
    println!();
    Ok(())
}

/// The seconds all rays take, each block of them at its best.
fn best_times(bvh: &TriangleBvh, rays: &[Expected], any: bool, reps: usize, block: usize) -> f64 {
    let mut best = vec![f64::INFINITY; rays.len().div_ceil(block)];
    for _ in 0..reps {
        for (best, rays) in best.iter_mut().zip(rays.chunks(block)) {
            let start = Instant::now();
            std::hint::black_box(count(bvh, rays, any));
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    best.iter().sum()
}

/// How many of the rays meet something.
fn count(bvh: &TriangleBvh, rays: &[Expected], any: bool) -> usize {
    if any {
        rays.iter().filter(|expected| bvh.occluded(&expected.ray)).count()
    } else {
        rays.iter().filter(|expected| bvh.closest(&expected.ray).is_some()).count()
    }
}

/// Hits that differ from the expected ones: by more than rounding, and in the triangle only.
fn compare(bvh: &TriangleBvh, set: &Set) {
    let (mut wrong, mut tied, mut occluded) = (0, 0, 0);
    let [mut counts, mut any_counts] = [TraversalCounts::default(); 2];
    for expected in &set.rays {
        let hit = bvh.closest_counted(&expected.ray, &mut counts);
        let (t, triangle) = hit.map_or((f32::INFINITY, u32::MAX), |hit| (hit.t, hit.triangle));
        let close = t == expected.t || (t - expected.t).abs() <= 1e-5 * expected.t.abs().max(1.0);
        wrong += usize::from(!close);
        tied += usize::from(close && triangle != expected.triangle);
        occluded += usize::from(bvh.occluded_counted(&expected.ray, &mut any_counts) != hit.is_some());
    }
    let rays = set.rays.len() as f64;
    println!(
        "{:<8} {} rays: {wrong} other distances, {tied} other triangles at the same distance, {occluded} any unlike \
         closest; {:.2} nodes, {:.2} triangles a ray, {:.2} and {:.2} for any hit",
        set.name,
        set.rays.len(),
        counts.nodes as f64 / rays,
        counts.triangles as f64 / rays,
        any_counts.nodes as f64 / rays,
        any_counts.triangles as f64 / rays
    );
}

fn speed(bvh: &TriangleBvh, set: &Set, any: bool, pool: &rayon::ThreadPool, reps: usize) {
    let mut hits = 0;
    let pass = || {
        hits = pool
            .install(|| set.rays.par_chunks(4096).with_max_len(1).map(|rays| count(bvh, rays, any)).sum());
    };
    let seconds = times(reps, pass);
    let rate = |seconds: f64| 1e-6 * set.rays.len() as f64 / seconds;
    println!(
        "{:<8} {:<15} threads {}: {:7.2} Mray/s  (min {:.2} max {:.2})  hit {:.3}",
        set.name,
        if any { "any-medium" } else { "closest-medium" },
        pool.current_num_threads(),
        rate(median(&seconds)),
        rate(seconds[seconds.len() - 1]),
        rate(seconds[0]),
        hits as f64 / set.rays.len() as f64
    );
}

/// Seconds of `reps` runs after one to warm up, in ascending order.
fn times(reps: usize, mut run: impl FnMut()) -> Vec<f64> {
    run();
    let mut seconds: Vec<f64> = (0..reps)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds
}

fn median(sorted: &[f64]) -> f64 {
    0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
}
