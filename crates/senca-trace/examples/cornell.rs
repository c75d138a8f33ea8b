//! Path traces the Cornell box into a PFM picture and tells how fast.
//!
//! `cornell blocks|balls OUT.pfm [SIZE] [SAMPLES] [BOUNCES] [SEED] [sobol|independent]`

#[path = "../src/path/cornell.rs"]
mod cornell;

use std::error::Error;
use std::time::Instant;

use rayon::prelude::*;
use senca_scene::Background;
use senca_trace::path::{PathTracer, PathWork};
use senca_trace::{PathSettings, Pattern, SamplePlace, Sampler, World};

#[expect(clippy::print_stdout, reason = "a program tells on standard output")]
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, out, rest @ ..] = &arguments[..] else {
        return Err("cornell blocks|balls OUT.pfm [SIZE] [SAMPLES] [BOUNCES] [SEED]".into());
    };
    let number = |i: usize, default: u32| rest.get(i).map_or(Ok(default), |text| text.parse());
    let (size, samples, bounces, seed) = (number(0, 128)?, number(1, 16)?, number(2, 7)?, number(3, 0)?);
    let plain = rest.get(4).is_some_and(|word| word == "independent");
    let pattern = if plain { Pattern::Independent } else { Pattern::Sobol };
    let scene = if kind == "balls" { cornell::with_balls() } else { cornell::with_blocks() };
    let world = World::new(&scene)?;
    let settings = PathSettings { max_bounces: bounces, ..PathSettings::default() };
    let tracer = PathTracer::new(&world, &cornell::view(), [size; 2], Background::None, &settings);

    let start = Instant::now();
    let row = |y: u32| {
        let mut work = PathWork::default();
        let pixel = |x: u32| {
            let mut sum = [0.0f64; 3];
            for sample in 0..samples {
                let mut sampler = Sampler::new(pattern, seed.into(), x, y, sample);
                let [u, v] = sampler.next_2d();
                let place = SamplePlace { x: f64::from(x) + u, y: f64::from(y) + v, row: y, sampler };
                let [r, g, b, _] = tracer.sample(&place, &mut work);
                sum = [sum[0] + f64::from(r), sum[1] + f64::from(g), sum[2] + f64::from(b)];
            }
            sum.map(|s| (s / f64::from(samples)) as f32)
        };
        let pixels: Vec<[f32; 3]> = (0..size).map(pixel).collect();
        (pixels, work)
    };
    let rows: Vec<(Vec<[f32; 3]>, PathWork)> = (0..size).into_par_iter().map(row).collect();
    let seconds = start.elapsed().as_secs_f64();

    let mut counts = senca_trace::TraceCounts::default();
    let mut bytes = format!("PF\n{size} {size}\n-1.0\n").into_bytes();
    for (pixels, work) in rows.iter().rev() {
        counts += work.counts;
        bytes.extend(pixels.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    std::fs::write(out, bytes)?;
    let paths = f64::from(size) * f64::from(size) * f64::from(samples);
    println!("{seconds:.3} s, {:.3} million paths a second, {counts:?}", paths / seconds * 1e-6);
    Ok(())
}
