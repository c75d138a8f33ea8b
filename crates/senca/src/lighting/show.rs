//! A picture of computed light.

use std::borrow::Cow;
use std::time::Instant;

use senca_math::glam::DVec3;
use senca_math::{Control, Image, LinearRgb, View, ViewKind};
use senca_pipeline::{Culling, Shading};
use senca_radiosity::display::{
    Interpolation, LightField, Look, MeshLines, SeenPlaces, ShownColors, ShownLight, shown_scene,
};
use senca_radiosity::false_color::{FalseColors, with_scale};
use senca_radiosity::{
    DirectLight, Gather, GatherSettings, Occluders, RadiosityError, Solution, regather_reflected,
};
use senca_scene::{Background, Scene};
use senca_trace::antialias::Antialiasing;
use senca_trace::recursive::{RecursiveSettings, SurfaceLight, Tracer};
use senca_trace::{Film, FilmReport, FilmSettings, PrimaryRays, Watch, World};

use super::measure::finder_of;
use super::solve::light_of_lamps;
use super::{Display, Show};
use crate::lamps::{bounds_of_lamps, copy_lamps, show_lamps};
use crate::prepare::{Prepared, prepare};
use crate::traced::{area, background, on_threads, recursive_settings};
use crate::{Error, Report, Settings};

/// Share of the area that may be brighter than the scale of false colours.
const BEYOND_SCALE: f64 = 0.01;

/// Draws `scene` in the light of `solution`, which was computed for it, by [`Settings::radiosity`]: from
/// any camera, without computing anything again.
///
/// # Errors
/// See [`Error`].
pub fn show_light(
    scene: Cow<'_, Scene>,
    solution: &Solution,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<(Image, Report), Error> {
    let start = Instant::now();
    let mut prepared = prepare(scene, settings)?;
    if !bounds_of_lamps(&prepared.scene).is_empty() {
        show_lamps(prepared.scene.to_mut(), &prepared.view);
    }
    let factor = settings.radiosity.exposure_factor();
    if factor != 1.0 {
        let scene = prepared.scene.to_mut();
        scene.ambient *= factor;
        scene.lights.iter_mut().for_each(|light| light.color *= factor);
        scene.materials.iter_mut().for_each(|material| material.emission *= factor);
    }
    let mut report = Report { radiosity: Some(solution.report), ..Report::default() };
    report.prepare_seconds = start.elapsed().as_secs_f64();
    let exposed = solution.exposed(factor);
    let shot = Shot { prepared: &prepared, solution: &exposed, settings, control, factor };
    let image = on_threads(settings.drawing.threads, || {
        match (settings.radiosity.display, settings.radiosity.show) {
            (Display::Flat | Display::Gouraud, Show::Light) => shot.by_pipeline(&mut report),
            _ => shot.by_rays(&mut report),
        }
    })??;
    Ok((image, report))
}

/// Rays by which each element looks at reflected light once more before it is gathered from there.
const REGATHERING: u32 = 16;

/// All that a picture is made of.
struct Shot<'a> {
    prepared: &'a Prepared<'a>,
    solution: &'a Solution,
    settings: &'a Settings,
    control: &'a Control<'a>,
    /// Of exposure.
    factor: f32,
}

impl Shot<'_> {
    fn display(&self) -> Display {
        self.settings.radiosity.display
    }

    fn interpolation(&self) -> Interpolation {
        if self.display() == Display::Flat { Interpolation::Flat } else { Interpolation::Smooth }
    }

    /// Light that arrives at the elements.
    fn incident(&self) -> Vec<LinearRgb> {
        self.solution.incident.clone()
    }

    fn by_pipeline(&self, report: &mut Report) -> Result<Image, Error> {
        let field = LightField::new(&self.solution.mesh, self.incident(), self.interpolation());
        let mut shown = shown_scene(&self.prepared.scene, &field, ShownColors::Exact);
        copy_lamps(&self.prepared.scene, &mut shown);
        let wish = &self.settings.drawing;
        let background = background(&self.prepared.scene, self.settings);
        shown.background = Background::None;
        let drawing = senca_pipeline::Settings {
            shading: Shading::Gouraud,
            cull: Culling::ByMaterial,
            background: Some(background),
            crop: self.settings.crop,
            ..*wish
        };
        let (view, size) = (&self.prepared.view, self.prepared.size);
        let (image, drawn) = senca_pipeline::render_part(&shown, view, &drawing, size, self.control)?;
        report.drawing = drawn;
        Ok(image)
    }

    fn by_rays(&self, report: &mut Report) -> Result<Image, Error> {
        let (solution, scene) = (self.solution, &*self.prepared.scene);
        let world = World::with_settings(scene, &self.settings.tracing.world)?;
        let finder = finder_of(solution)?;
        let colors = self.false_colors();
        let traced = self.display() == Display::Trace && colors.is_none();
        let values = if traced { self.without_lamps()? } else { self.incident() };
        let field = LightField::new(&solution.mesh, values, self.interpolation());
        let look = match colors {
            Some(colors) => Look::FalseColors(colors),
            None if traced => Look::Ambient,
            None => Look::Matt,
        };
        let occluders;
        let regathered;
        let gather;
        let mut light = ShownLight::new(&world, &field, &finder, look);
        if self.display() == Display::Gather && colors.is_none() {
            occluders = Occluders::new(&solution.mesh)?;
            regathered = self.regathered(&occluders)?;
            gather = self.gather(&world, &light, &regathered, &occluders)?;
            light = light.gathered_by(&gather);
        }
        if let Show::Mesh | Show::FalseColors { mesh: true, .. } = self.settings.radiosity.show {
            light = light.with_lines(lines(&self.prepared.view, self.prepared.size));
        }
        let (image, film) = self.expose(&world, &light, self.settings.tracing.antialiasing, traced)?;
        report.tracing = Some(film);
        Ok(match colors {
            Some(colors) => with_scale(&image, &colors, "lux"),
            None => image,
        })
    }

    /// The solution with light on elements as fine as they are.
    fn regathered(&self, occluders: &Occluders) -> Result<Solution, Error> {
        let mut solution = self.solution.clone();
        let done = regather_reflected(&mut solution, occluders, REGATHERING, self.control);
        done.map_err(RadiosityError::from)?;
        Ok(solution)
    }

    /// Light at all places that are seen.
    fn gather<'g>(
        &self,
        world: &World<'_>,
        light: &ShownLight<'_>,
        solution: &'g Solution,
        occluders: &'g Occluders,
    ) -> Result<Gather<'g>, Error> {
        let direct = DirectLight::of_scene(&self.prepared.scene, &self.settings.radiosity.direct)?;
        let mut gather = Gather::new(solution, &direct, occluders, &GatherSettings::default())?;
        let seen = SeenPlaces::new(light);
        self.expose(world, &seen, Antialiasing::None, false)?;
        gather.prepare(&seen.into_places(), self.control).map_err(RadiosityError::from)?;
        Ok(gather)
    }

    /// Light but for that of lamps, which the tracer finds by itself.
    fn without_lamps(&self) -> Result<Vec<LinearRgb>, Error> {
        let direct = &self.settings.radiosity.direct;
        let lamps = light_of_lamps(&self.prepared.scene, &self.solution.mesh, direct, self.control)?;
        let rest = |(all, lamps): (LinearRgb, LinearRgb)| {
            LinearRgb::new(all.r - lamps.r, all.g - lamps.g, all.b - lamps.b).map(|v| v.max(0.0))
        };
        // Lamps were exposed with the scene.
        Ok(self.incident().into_iter().zip(lamps).map(rest).collect())
    }

    fn expose(
        &self,
        world: &World<'_>,
        light: &dyn SurfaceLight,
        antialiasing: Antialiasing,
        traced: bool,
    ) -> Result<(Image, FilmReport), Error> {
        let (settings, prepared) = (self.settings, self.prepared);
        let background = background(&prepared.scene, settings);
        let drawing =
            senca_pipeline::Settings { shading: shading_of(settings.drawing.shading), ..settings.drawing };
        let recursive = recursive_settings(&settings.tracing.recursive, &drawing)?;
        let depth = if traced { recursive.max_depth } else { 0 };
        let recursive = RecursiveSettings { max_depth: depth, ..recursive };
        let tracer = Tracer::new(world, &prepared.view, prepared.size, background, &recursive)
            .with_lens(prepared.camera.lens)
            .with_surface_light(light);
        let film_settings = FilmSettings {
            size: prepared.size,
            area: area(prepared.size, settings)?,
            antialiasing,
            seed: recursive.seed,
        };
        let mut film = Film::new(&film_settings)?;
        let report = film.expose_up_to(u32::MAX, &tracer, &mut Watch::default(), self.control)?;
        Ok((film.into_image(background == Background::None), report))
    }

    fn false_colors(&self) -> Option<FalseColors> {
        let Show::FalseColors { most, luminance_of_one, logarithmic, .. } = self.settings.radiosity.show
        else {
            return None;
        };
        // Exposure is for pictures, not for numbers.
        let one = luminance_of_one / f64::from(self.factor);
        let scale = FalseColors::lux(brightest(self.solution), one);
        Some(FalseColors { most: most.unwrap_or(scale.most), logarithmic, ..scale })
    }
}

/// Rays are shaded by two models only; radiosity knows none, so whatever was asked for will do.
fn shading_of(wish: Shading) -> Shading {
    if wish == Shading::Phong { Shading::Phong } else { Shading::Material }
}

/// The light that all but a small share of the area stays below, as luminance.
fn brightest(solution: &Solution) -> f64 {
    let mesh = &solution.mesh;
    let of = |leaf: u32| {
        (f64::from(solution.incident[leaf as usize].luminance()), mesh.elements()[leaf as usize].area)
    };
    let mut leaves: Vec<(f64, f64)> = mesh.leaves().map(of).collect();
    leaves.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut left = BEYOND_SCALE * mesh.area();
    let within = leaves.iter().find(|(_, area)| {
        left -= area;
        left < 0.0
    });
    within.map_or(0.0, |(light, _)| *light)
}

/// Lines of a pixel's width around elements.
fn lines(view: &View, [width, height]: [u32; 2]) -> MeshLines {
    let rays = PrimaryRays::new(view, width, height);
    let (x, y) = (0.5 * f64::from(width), 0.5 * f64::from(height));
    let [here, beside] = [x, x + 1.0].map(|x| rays.through(x, y));
    let color = LinearRgb::splat(0.0);
    match view.kind {
        ViewKind::Central { eye_world } => {
            let [a, b] = [here, beside].map(|ray| ray.direction.normalize_or(DVec3::NEG_Z));
            MeshLines { eye: Some(eye_world), pixel: a.distance(b), color }
        }
        ViewKind::Parallel { .. } => {
            MeshLines { eye: None, pixel: here.origin.distance(beside.origin), color }
        }
    }
}
