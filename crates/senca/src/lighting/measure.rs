//! What else computed light is good for: baked scenes and numbers.

use std::borrow::Cow;

use senca_math::Control;
use senca_radiosity::display::{ElementFinder, Interpolation, LightField};
use senca_radiosity::{
    DirectLight, Gather, GatherSettings, LuxGrid, LuxReport, Occluders, RadiosityError, Solution,
    bake_lightmap, bake_vertex_colors,
};
use senca_scene::Scene;

use super::Display;
use crate::prepare::{posed, prepare};
use crate::traced::on_threads;
use crate::{Error, Settings};

/// The scene with the light of `solution` in it, for other programs: as colours of vertices, or as a
/// picture of `lightmap` times `lightmap` texels.
///
/// # Errors
/// See [`Error`].
pub fn bake_light(
    scene: &Scene,
    solution: &Solution,
    settings: &Settings,
    lightmap: Option<u32>,
) -> Result<Scene, Error> {
    let exposed = solution.exposed(settings.radiosity.exposure_factor());
    let scene = posed(Cow::Borrowed(scene), settings.moment.as_ref())?;
    let interpolation = match settings.radiosity.display {
        Display::Flat => Interpolation::Flat,
        _ => Interpolation::Smooth,
    };
    on_threads(settings.drawing.threads, || {
        let field = LightField::new(&exposed.mesh, exposed.incident.clone(), interpolation);
        let Some(side) = lightmap else { return Ok(bake_vertex_colors(&scene, &field)) };
        let finder = finder_of(&exposed)?;
        Ok(bake_lightmap(&scene, &field, &finder, side)?)
    })?
}

/// Rays for reflected light at each place that is measured.
const LUX_RAYS: u32 = 512;

/// Illuminance on a grid in the light of `solution`; a shown 1 stands for `luminance_of_one` cd/m².
///
/// # Errors
/// See [`Error`].
pub fn measure_lux(
    scene: &Scene,
    solution: &Solution,
    settings: &Settings,
    grid: &LuxGrid,
    luminance_of_one: f64,
    control: &Control<'_>,
) -> Result<LuxReport, Error> {
    let prepared = prepare(Cow::Borrowed(scene), settings)?;
    on_threads(settings.drawing.threads, || {
        let occluders = Occluders::new(&solution.mesh)?;
        let direct = DirectLight::of_scene(&prepared.scene, &settings.radiosity.direct)?;
        let gather = Gather::new(solution, &direct, &occluders, &GatherSettings::default())?;
        let light = |place, normal| gather.afresh(place, normal, LUX_RAYS, 0);
        let report = LuxReport::measure(grid, luminance_of_one, control, light);
        Ok(report.map_err(RadiosityError::from)?)
    })?
}

pub(super) fn finder_of(solution: &Solution) -> Result<ElementFinder<'_>, RadiosityError> {
    let limit = solution.mesh.polygons().len();
    ElementFinder::new(&solution.mesh).map_err(|_| RadiosityError::TooManyElements { limit })
}
