//! Pictures by ray tracing.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use senca_math::{Image, View};
use senca_pipeline::{Channel, Control, Culling, RenderError, Shading};
use senca_scene::{Background, Camera, Scene};
use senca_trace::path::{PathSettings, PathTracer};
use senca_trace::recursive::{Backs, LightModel, RecursiveSettings, Tracer};
use senca_trace::tree::PixelTrees;
use senca_trace::{Area, Film, FilmReport, FilmSettings, Fingerprint, TraceCounts, Watch, World};

use crate::prepare::{Prepared, default_background, prepare};
use crate::{Error, Method, Report, Settings};

/// Moments that an open shutter is divided into, at most.
const MAX_MOMENTS: u32 = 64;

/// Takes a partial picture as bytes.
pub type SavePartial<'a> = dyn FnMut(&[u8]) + Send + 'a;

/// What a caller of [`trace_with`] wants beside the picture.
#[derive(Default)]
pub struct TraceJob<'a> {
    /// A partial picture of [`TraceJob::save`] to go on with.
    pub resume: Option<&'a [u8]>,
    /// Called now and then, and at the end, with the partial picture as bytes.
    pub save: Option<&'a mut SavePartial<'a>>,
    /// Whether a map of the samples is wanted.
    pub samples_map: bool,
}

impl std::fmt::Debug for TraceJob<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TraceJob").field("samples_map", &self.samples_map).finish_non_exhaustive()
    }
}

/// A traced picture.
#[derive(Clone, Debug)]
pub struct TracedPicture {
    /// The picture.
    pub image: Image,
    /// How many samples each pixel took, white for the most.
    pub samples_map: Option<Image>,
    /// Counters and times.
    pub report: Report,
}

/// The rays of one pixel.
#[derive(Clone, Debug)]
pub struct ExplainedPixel {
    /// What happened.
    pub trees: PixelTrees,
    /// The first tree and its rays in the scene, as an SVG picture.
    pub svg: String,
}

/// Traces a picture of `scene` by [`Settings::method`], which is not [`Method::Raster`]. The same as
/// [`render_with`](crate::render_with), for one who wants to save and resume, or see where samples went.
///
/// # Errors
/// See [`Error`].
pub fn trace_with(
    scene: Cow<'_, Scene>,
    settings: &Settings,
    control: &Control<'_>,
    job: &mut TraceJob<'_>,
) -> Result<TracedPicture, Error> {
    let start = Instant::now();
    let shot = Shot::new(&scene, settings)?;
    let mut film = match job.resume {
        Some(bytes) => Film::resume(bytes, shot.fingerprint, &shot.film)?,
        None => Film::new(&shot.film)?,
    };
    let mut report = Report { prepare_seconds: start.elapsed().as_secs_f64(), ..Report::default() };
    let exposed = on_threads(settings.drawing.threads, || expose(&shot, &mut film, control, job, start));
    let (exposed, preparing) = exposed??;
    report.tracing = Some(exposed);
    report.prepare_seconds += preparing.as_secs_f64();
    Ok(TracedPicture {
        samples_map: job.samples_map.then(|| film.samples_map()),
        image: film.into_image(shot.background == Background::None),
        report,
    })
}

/// All rays of the pixel in this column and row of the picture that [`trace_with`] would make, by
/// [`Method::Trace`].
///
/// # Errors
/// See [`Error`].
pub fn explain_pixel(
    scene: Cow<'_, Scene>,
    settings: &Settings,
    pixel: [u32; 2],
) -> Result<ExplainedPixel, Error> {
    if settings.method != Method::Trace {
        return Err(Error::Combination("only the method trace explains a pixel".into()));
    }
    let shot = Shot::new(&scene, settings)?;
    let prepared = &shot.prepared;
    let world = World::with_settings(&prepared.scene, &settings.tracing.world)?;
    let tracer = Tracer::new(&world, &prepared.view, prepared.size, shot.background, &shot.recursive)
        .with_lens(prepared.camera.lens);
    let trees = PixelTrees::trace(&tracer, &shot.film, pixel)?;
    let svg = trees.to_svg(&world);
    Ok(ExplainedPixel { trees, svg })
}

/// Everything that is known before the first ray.
struct Shot<'s> {
    scene: &'s Scene,
    settings: &'s Settings,
    prepared: Prepared<'s>,
    background: Background,
    film: FilmSettings,
    recursive: RecursiveSettings,
    path: PathSettings,
    /// Of all that the picture depends on but the film's settings.
    fingerprint: u64,
}

impl<'s> Shot<'s> {
    fn new(scene: &'s Scene, settings: &'s Settings) -> Result<Self, Error> {
        if settings.drawing.channel != Channel::Color {
            let text = "depth, normals and numbers are drawn by the method raster";
            return Err(Error::Combination(text.into()));
        }
        let prepared = prepare(Cow::Borrowed(scene), settings)?;
        let background = background(&prepared.scene, settings);
        let (drawing, tracing) = (&settings.drawing, &settings.tracing);
        let film = FilmSettings {
            size: prepared.size,
            area: area(prepared.size, settings)?,
            antialiasing: tracing.antialiasing,
            seed: tracing.recursive.seed,
        };
        let recursive = recursive_settings(&tracing.recursive, drawing)?;
        let hide_backs = drawing.cull != Culling::Never;
        let path = PathSettings { hide_backs, texture_filter: drawing.filter, ..tracing.path };
        path.check()?;
        // Only those who resume have to know; the whole scene is looked at.
        let fingerprint = if tracing.keeps_partial {
            let how = match settings.method {
                Method::Path => (None, Some(path)),
                _ => (Some(recursive), None),
            };
            Fingerprint::of(&(&*prepared.scene, prepared.view, background, how))
        } else {
            0
        };
        Ok(Self { scene, settings, prepared, background, film, recursive, path, fingerprint })
    }

    /// The moments at which the scene is looked at, with the number of passes up to which each holds;
    /// one without a shutter, or where nothing moves.
    fn moments(&self) -> Vec<(Option<f64>, u32)> {
        let passes = self.film.antialiasing.passes();
        let still = vec![(None, u32::MAX)];
        let Some([open, close]) = self.prepared.camera.shutter else { return still };
        if passes < 2 || self.scene.animations.is_empty() {
            return still;
        }
        let now = self.settings.moment.as_ref().map_or(0.0, |m| m.seconds);
        let count = passes.min(MAX_MOMENTS);
        let moment = |i: u32| {
            let share = (f64::from(i) + 0.5) / f64::from(count);
            let until = u64::from(passes) * u64::from(i + 1) / u64::from(count);
            (Some(now + open + share * (close - open)), until as u32)
        };
        (0..count).map(moment).collect()
    }

    /// The scene at a moment of its animation.
    fn at(&self, seconds: f64) -> Result<Prepared<'s>, Error> {
        let mut settings = self.settings.clone();
        settings.moment.get_or_insert_default().seconds = seconds;
        prepare(Cow::Borrowed(self.scene), &settings)
    }
}

/// Exposes the film moment by moment. Tells, too, how long it took to make the world that rays meet.
fn expose(
    shot: &Shot<'_>,
    film: &mut Film,
    control: &Control<'_>,
    job: &mut TraceJob<'_>,
    start: Instant,
) -> Result<(FilmReport, Duration), Error> {
    let (mut report, mut preparing) = (FilmReport::default(), Duration::ZERO);
    let moments = shot.moments();
    let count = moments.len();
    let limit = shot.settings.tracing.time_limit;
    for (i, (seconds, until)) in moments.into_iter().enumerate() {
        if film.samples() >= until {
            continue;
        }
        let moved = seconds.map(|seconds| shot.at(seconds)).transpose()?;
        let prepared = moved.as_ref().unwrap_or(&shot.prepared);
        let share = |done: f32| control.report((i as f32 + done) / count as f32);
        let control = Control { progress: Some(&share), cancel: control.cancel };
        let left = limit.map(|limit| limit.saturating_sub(start.elapsed()));
        let go = Go { shot, prepared, until, left, control };
        let one = go.expose(film, job, &mut preparing)?;
        report = FilmReport {
            counts: sum(report.counts, one.counts),
            samples: report.samples + one.samples,
            samples_per_pixel: one.samples_per_pixel,
            seconds: report.seconds + one.seconds,
        };
        if limit.is_some_and(|limit| start.elapsed() >= limit) {
            break;
        }
    }
    Ok((report, preparing))
}

fn sum(mut a: TraceCounts, b: TraceCounts) -> TraceCounts {
    a += b;
    a
}

/// One go of exposing a film.
struct Go<'a> {
    shot: &'a Shot<'a>,
    prepared: &'a Prepared<'a>,
    until: u32,
    left: Option<Duration>,
    control: Control<'a>,
}

impl Go<'_> {
    fn expose(
        &self,
        film: &mut Film,
        job: &mut TraceJob<'_>,
        preparing: &mut Duration,
    ) -> Result<FilmReport, Error> {
        let start = Instant::now();
        let (shot, prepared) = (self.shot, self.prepared);
        let settings = shot.settings;
        let world = World::with_settings(&prepared.scene, &settings.tracing.world)?;
        let (view, size, lens): (&View, _, _) = (&prepared.view, prepared.size, prepared.camera.lens);
        let mut hand_over =
            job.save.as_mut().map(|save| move |film: &Film| save(&film.save(shot.fingerprint)));
        let save = hand_over.as_mut().map(|f| f as &mut dyn FnMut(&Film));
        let mut watch = Watch { time_limit: self.left, save };
        Ok(if settings.method == Method::Path {
            let tracer =
                PathTracer::new(&world, view, size, shot.background, &shot.path).with_lens(view, lens);
            *preparing += start.elapsed();
            film.expose_up_to(self.until, &tracer, &mut watch, &self.control)?
        } else {
            let tracer = Tracer::new(&world, view, size, shot.background, &shot.recursive).with_lens(lens);
            *preparing += start.elapsed();
            film.expose_up_to(self.until, &tracer, &mut watch, &self.control)?
        })
    }
}

/// The tracer's own settings with what it shares with the pipeline.
pub(crate) fn recursive_settings(
    wish: &RecursiveSettings,
    drawing: &senca_pipeline::Settings,
) -> Result<RecursiveSettings, Error> {
    let light_model = match drawing.shading {
        Shading::Material => LightModel::Material,
        Shading::Phong => LightModel::Phong,
        _ => {
            let text = "rays are shaded by phong or material; the other shadings are for the method raster";
            return Err(Error::Combination(text.into()));
        }
    };
    let backs = match drawing.cull {
        Culling::ByMaterial => Backs::ByMaterial,
        Culling::Always => Backs::Hidden,
        Culling::Never => Backs::Shown,
    };
    let settings = RecursiveSettings { light_model, backs, texture_filter: drawing.filter, ..*wish };
    settings.check()?;
    Ok(settings)
}

/// What is seen where nothing is: the caller's wish, the scene's, or a quiet grey.
pub(crate) fn background(scene: &Scene, settings: &Settings) -> Background {
    match (settings.drawing.background, scene.background) {
        (Some(wish), _) => wish,
        (None, Background::None) => default_background(false),
        (None, of_scene) => of_scene,
    }
}

/// The part of the picture that is drawn.
pub(crate) fn area([width, height]: [u32; 2], settings: &Settings) -> Result<Area, Error> {
    if width == 0 || height == 0 {
        return Err(RenderError::EmptyImage { width, height }.into());
    }
    let most = Image::MAX_SIDE;
    if width.max(height) > most {
        return Err(RenderError::ImageTooLarge { width, height, most }.into());
    }
    let Some(crop) = settings.crop else { return Ok(Area { x: 0, y: 0, width, height }) };
    let senca_pipeline::Crop { x, y, width: w, height: h } = crop;
    let fits = |from: u32, length: u32, all: u32| {
        length > 0 && u64::from(from) + u64::from(length) <= u64::from(all)
    };
    if fits(x, w, width) && fits(y, h, height) {
        return Ok(Area { x, y, width: w, height: h });
    }
    let (image_width, image_height) = (width, height);
    Err(RenderError::Crop { x, y, width: w, height: h, image_width, image_height }.into())
}

/// Runs `work` on `threads` threads, 0 for those that are there anyway.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, Error> {
    if threads == 0 {
        return Ok(work());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| RenderError::Threads { count: threads, reason: e.to_string() })?;
    Ok(pool.install(work))
}

/// The camera's lens and shutter, which a view does not have.
pub(crate) fn optics_of(camera: &Camera) -> CameraOptics {
    CameraOptics { lens: camera.lens, shutter: camera.shutter }
}

/// What a camera has beyond its view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraOptics {
    /// The lens; `None` is a pinhole.
    pub lens: Option<senca_scene::Lens>,
    /// When the shutter opens and closes, in seconds from the moment shown.
    pub shutter: Option<[f64; 2]>,
}

#[cfg(test)]
mod tests;
