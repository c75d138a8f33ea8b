//! `senca render`: a scene or a model into a picture.

mod arguments;
mod explain;
mod exposure;
mod partial;
mod picture;
mod radiosity;
mod tracing;

use std::borrow::Cow;
use std::path::Path;

use senca::io::toml_scene::SceneFile;
use senca::pipeline::{Channel, Control};
use senca::{Error, Method, Report, Scene, Settings};

pub(crate) use arguments::Arguments;
use arguments::shading_of_hint;
use partial::Partial;
use picture::Target;

use crate::cli::input::read_scene_and_hints;
use crate::cli::output::{self, tell};
use crate::cli::{
    Failure, Interrupt, Progress, RadiosityStats, Seconds, Stages, Stats, Stopwatch, TracingStats, Triangles,
    peak_bytes, use_threads,
};

/// Draws the scene and writes the picture.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let running = &arguments.running;
    let explanation = arguments.tracing.explain.as_deref().zip(arguments.tracing.pixel);
    let target = match explanation {
        Some((path, _)) => explain::check(path).map(|()| Target::nowhere())?,
        None => Target::of(arguments)?,
    };
    check_crop(arguments)?;
    arguments.tracing.samples_map.as_deref().map_or(Ok(()), picture::check_pixels)?;
    running.stats.as_deref().map_or(Ok(()), output::check_writable)?;
    use_threads(running.threads)?;
    let interrupt = Interrupt::listen();
    let SceneFile { mut scene, render: hints } = read_scene_and_hints(&arguments.scene)?;
    let shading = target.shading(hints.shading.map(shading_of_hint));
    let settings = arguments.settings(&hints, shading, target.is_drawing())?;
    if settings.method != Method::Radiosity {
        exposure::expose(&mut scene, arguments.drawing.exposure);
    }
    if !running.quiet {
        tell_warnings(&arguments.scene, &scene);
    }
    if let Some((path, pixel)) = explanation {
        let failure = |error: &Error| Failure::of_scene(&arguments.scene, error);
        return explain::run(scene, &settings, pixel, path, &interrupt, failure);
    }
    let partial = Partial::of(&arguments.tracing)?;
    let light = arguments.light_files()?;
    if arguments.radiosity.preview.is_some() && output::is_standard(target.path()) {
        return Err(Failure::usage("--preview writes a file again and again; name one by -o"));
    }
    let mut seconds = Seconds { load: watch.lap(), ..Seconds::default() };

    let progress = Progress::new(running.quiet);
    let report_progress = |done| progress.report(done);
    let control = Control { progress: Some(&report_progress), cancel: Some(interrupt.flag()) };
    let mut computed = None;
    let write_early = |image, report| {
        let mut drawn = target.drawn(image, report);
        drawn.map_tones(arguments.drawing.tone_map.into());
        // What cannot be written is told at the end.
        if let Ok(bytes) = drawn.encode() {
            drop(output::write(target.path(), &bytes, &interrupt));
        }
    };
    let drawn = match settings.method {
        Method::Radiosity => {
            radiosity::draw(arguments, &light, scene, &settings, &control, &interrupt, &write_early).map(
                |(image, report, light)| {
                    computed = Some(light);
                    target.drawn(image, report)
                },
            )
        }
        _ => target.draw(Cow::Owned(scene), &settings, &control, &partial, &interrupt).map_err(|error| {
            match error {
                Error::Partial(_) => Failure::input(format!("{}: {error}", partial.name())),
                _ => Failure::of_scene(&arguments.scene, &error),
            }
        }),
    };
    progress.finish();
    partial.outcome()?;
    let mut drawn = drawn?;
    if let Some(light) = computed.filter(|_| !running.quiet) {
        light.tell_warnings(&arguments.scene);
    }
    if !running.quiet && shows_nothing(&settings, &drawn.report) {
        tell(&format!(
            "senca: {}: warning: nothing of the scene is in the picture",
            arguments.scene.display()
        ));
    }
    if !running.quiet
        && settings.drawing.channel == Channel::Color
        && let Some(stops) = drawn.image().and_then(exposure::stops_too_bright)
    {
        tell(&format!(
            "senca: {}: warning: most of the picture is brighter than white; --exposure {:.0} shows it",
            arguments.scene.display(),
            arguments.drawing.exposure - stops
        ));
    }
    drawn.map_tones(arguments.drawing.tone_map.into());
    seconds.prepare = drawn.report.prepare_seconds + drawn.report.drawing.seconds.prepare;
    seconds.render = (watch.lap() - seconds.prepare).max(0.0);

    output::write(target.path(), &drawn.encode()?, &interrupt)?;
    if let Some((path, map)) = arguments.tracing.samples_map.as_deref().zip(drawn.samples_map.as_ref()) {
        output::write(path, &picture::encoded(path, map)?, &interrupt)?;
    }
    seconds.write = watch.lap();
    seconds.total = watch.total();
    match &running.stats {
        Some(path) => write_stats(path, &stats(seconds, &drawn.report, drawn.size, &settings), &interrupt),
        None => Ok(()),
    }
}

/// Finds a cut-out that reaches beyond the picture before anything is read.
fn check_crop(arguments: &Arguments) -> Result<(), Failure> {
    match (arguments.output.crop, arguments.output.size) {
        (Some(crop), Some(size)) if !crop.is_within(size) => Err(Failure::usage(format!(
            "the cut-out reaches beyond the picture of {}x{} pixels",
            size.width, size.height
        ))),
        _ => Ok(()),
    }
}

/// Whether faces were asked for, and no pixel of the whole picture shows one.
fn shows_nothing(settings: &Settings, report: &Report) -> bool {
    let whole = settings.method == Method::Raster && settings.crop.is_none();
    whole && !settings.drawing.shading.is_lines() && report.drawing.pixels_shaded == 0
}

/// Says what the reader found odd.
fn tell_warnings(path: &Path, scene: &Scene) {
    for warning in &scene.warnings {
        tell(&format!("senca: {}: warning: {}", path.display(), warning.0));
    }
}

fn stats(seconds: Seconds, report: &Report, size: [u32; 2], settings: &senca::Settings) -> Stats {
    let drawing = &report.drawing;
    Stats {
        seconds,
        stages: Stages {
            vertices: drawing.seconds.vertices,
            raster: drawing.seconds.raster,
            shade: drawing.seconds.shade,
        },
        threads: rayon::current_num_threads(),
        size,
        triangles: Triangles {
            given: drawing.triangles_in,
            culled: drawing.triangles_culled,
            clipped: drawing.triangles_clipped,
            drawn: drawing.triangles_drawn,
        },
        samples: report.tracing.map_or(settings.drawing.samples, |t| t.samples_per_pixel),
        tracing: report.tracing.as_ref().map(TracingStats::of),
        radiosity: report.radiosity.as_ref().map(RadiosityStats::of),
        peak_bytes: peak_bytes(),
    }
}

fn write_stats(path: &Path, stats: &Stats, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(stats).map_err(Failure::input)?;
    text.push('\n');
    output::write(path, text.as_bytes(), interrupt)
}
