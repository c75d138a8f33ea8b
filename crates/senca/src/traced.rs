//! Pictures by ray tracing.

use senca_math::Image;
use senca_pipeline::{Control, Culling, RenderError, Shading};
use senca_scene::Background;
use senca_trace::recursive::{Backs, LightModel, RecursiveSettings, Tracer};
use senca_trace::{Area, Film, FilmReport, FilmSettings, Watch, World};

use crate::prepare::Prepared;
use crate::{Error, Tracing};

/// A traced picture.
pub(crate) struct Traced {
    pub(crate) image: Image,
    pub(crate) report: FilmReport,
}

/// Draws what was prepared. `drawing` names the crop and the background, too.
pub(crate) fn draw(
    prepared: &Prepared<'_>,
    drawing: &senca_pipeline::Settings,
    tracing: &Tracing,
    control: &Control<'_>,
) -> Result<Traced, Error> {
    let settings = FilmSettings {
        size: prepared.size,
        area: area(prepared.size, drawing)?,
        antialiasing: tracing.antialiasing,
        seed: tracing.recursive.seed,
    };
    let recursive = recursive_settings(&tracing.recursive, drawing)?;
    let mut film = Film::new(&settings)?;
    on_threads(drawing.threads, || {
        let world = World::new(&prepared.scene)?;
        let background = background(prepared, drawing);
        let tracer = Tracer::new(&world, &prepared.view, prepared.size, background, &recursive);
        let mut watch = Watch { time_limit: tracing.time_limit, save: None };
        let report = film.expose(&tracer, &mut watch, control)?;
        Ok(Traced { image: film.develop(tracer.is_transparent()), report })
    })?
}

/// The tracer's own settings with what it shares with the pipeline.
fn recursive_settings(
    wish: &RecursiveSettings,
    drawing: &senca_pipeline::Settings,
) -> Result<RecursiveSettings, Error> {
    let light_model = match drawing.shading {
        Shading::Material => LightModel::Material,
        Shading::Phong => LightModel::Phong,
        other => {
            let name = format!("{other:?}").to_lowercase();
            let text = format!("rays are shaded by phong or material; {name} is for the raster method");
            return Err(Error::Combination(text));
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

/// What is seen where nothing is: the scene's, or what [`crate::render`] chose.
fn background(prepared: &Prepared<'_>, drawing: &senca_pipeline::Settings) -> Background {
    match prepared.scene.background {
        Background::None => drawing.background.unwrap_or_default(),
        background => background,
    }
}

/// The part of the picture that is drawn.
fn area(size: [u32; 2], drawing: &senca_pipeline::Settings) -> Result<Area, Error> {
    let [width, height] = size;
    if width == 0 || height == 0 {
        return Err(RenderError::EmptyImage { width, height }.into());
    }
    let most = Image::MAX_SIDE;
    if width.max(height) > most {
        return Err(RenderError::ImageTooLarge { width, height, most }.into());
    }
    let Some(crop) = drawing.crop else { return Ok(Area { x: 0, y: 0, width, height }) };
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
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, Error> {
    if threads == 0 {
        return Ok(work());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| RenderError::Threads { count: threads, reason: e.to_string() })?;
    Ok(pool.install(work))
}
