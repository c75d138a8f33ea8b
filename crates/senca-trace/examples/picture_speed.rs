//! What a whole picture costs: `picture_speed SCENE.toml [WIDTH HEIGHT RUNS SAMPLES_A_SIDE OUT.pfm] [ACCEL]`.
//!
//! Best and median milliseconds of tracing on the threads of `RAYON_NUM_THREADS`, and rays by kind.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::error::Error;
use std::path::Path;

use senca_scene::Background;
use senca_trace::antialias::Antialiasing;
use senca_trace::recursive::Tracer;
use senca_trace::{
    Accel, Area, Control, Film, FilmReport, FilmSettings, RecursiveSettings, Watch, World, WorldSettings,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let file = arguments.first().ok_or("picture_speed SCENE [WIDTH HEIGHT RUNS SAMPLES OUT.pfm] [ACCEL]")?;
    let number = |i: usize, default: u32| arguments.get(i).map_or(Ok(default), |text| text.parse::<u32>());
    let (width, height, runs, side) = (number(1, 640)?, number(2, 480)?, number(3, 9)?, number(4, 1)?);
    let kind: Accel = arguments.get(6).map_or(Ok(Accel::Bvh), |name| name.parse())?;

    let scene = senca_io::load(Path::new(file))?;
    let aspect = f64::from(width) / f64::from(height);
    let placed = scene.placed_cameras();
    let placed = placed.first().ok_or("a scene with a camera")?;
    let camera = &scene.cameras[placed.camera.index()];
    let view = camera.view(&placed.world_from_camera, aspect, &scene.bounds())?;
    let world =
        World::with_settings(&scene, &WorldSettings { accel: kind.into(), ..WorldSettings::default() })?;
    let background = if scene.background == Background::None {
        Background::Color(senca_math::LinearRgb::splat(0.1))
    } else {
        scene.background
    };
    let tracer = Tracer::new(&world, &view, [width, height], background, &RecursiveSettings::default())
        .with_lens(camera.lens);
    let settings = FilmSettings {
        size: [width, height],
        area: Area { x: 0, y: 0, width, height },
        antialiasing: if side > 1 { Antialiasing::Regular { per_side: side } } else { Antialiasing::None },
        seed: 0,
    };
    let mut reports: Vec<FilmReport> = Vec::new();
    let mut film = Film::new(&settings)?;
    let mut least_cpu = f64::INFINITY;
    for _ in 0..runs {
        film = Film::new(&settings)?;
        let before = cpu_seconds();
        reports.push(film.expose(&tracer, &mut Watch::default(), &Control::default())?);
        least_cpu = least_cpu.min(cpu_seconds() - before);
    }
    reports.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let (best, median) = (reports[0].seconds, reports[reports.len() / 2].seconds);
    let rays = reports[0].counts.rays;
    println!(
        "{:.2} ms of all threads' time, {:.2} ms best, {:.2} ms median, {:.1} ns a ray; {rays:?}, {:?}",
        1e3 * least_cpu,
        1e3 * best,
        1e3 * median,
        1e9 * least_cpu.min(best) / rays.total() as f64,
        reports[0].counts.work
    );
    if let Some(out) = arguments.get(5).filter(|out| *out != "-") {
        let image = film.develop(false);
        let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
        for row in image.pixels().chunks(width as usize).rev() {
            bytes.extend(row.iter().flat_map(|p| p[..3].iter().flat_map(|v| v.to_le_bytes())));
        }
        std::fs::write(out, bytes)?;
    }
    Ok(())
}

/// Time that the threads of this program have run, where the system tells; on a busy machine it says more
/// than the clock.
fn cpu_seconds() -> f64 {
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let of_thread = |entry: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(entry.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    };
    threads.filter_map(of_thread).sum::<f64>() * 1e-9
}
