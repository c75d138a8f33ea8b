//! What else computed light is good for: baked scenes and numbers.

use std::borrow::Cow;

use senca_math::color::srgb_from_linear;
use senca_math::glam::Vec4;
use senca_math::{Control, Image};
use senca_radiosity::display::{ElementFinder, Interpolation, LightField};
use senca_radiosity::{
    DirectLight, Gather, GatherSettings, LuxReport, Occluders, RadiosityError, Solution,
    bake_light_picture as paint_light, bake_lightmap, bake_vertex_colors,
};
use senca_scene::{Scene, Shape};

use super::{Display, LuxPlaces};
use crate::lamps::{bake_lamps, brightest_lamp};
use crate::prepare::{posed, prepare};
use crate::traced::on_threads;
use crate::{Error, Settings};

/// How light is put into a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Baking {
    /// A picture of this many texels a side, 16 to 16 384, laid onto the polygons. Default: as many as the
    /// elements of the solution ask for, from 256 to 4096, and more where the polygons need it.
    Lightmap(Option<u32>),
    /// Colours of the vertices of the mesh of patches.
    VertexColors(ColorEncoding),
}

/// What numbers stand for colours of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorEncoding {
    /// Light, as glTF has it.
    #[default]
    Linear,
    /// sRGB, for programs that take vertex colours for that, as those built on VTK do.
    Srgb,
}

/// How far above a place one looks around for whether it is in a body, as a share of the scene's diagonal.
const LIFT: f64 = 1e-6;

/// Texels along an edge of an element, where the side of a lightmap is chosen for the solution.
const TEXELS_OF_ELEMENT: f64 = 6.0;

/// The scene with the light of `solution` in it, for other programs.
///
/// # Errors
/// See [`Error`].
pub fn bake_light(
    scene: &Scene,
    solution: &Solution,
    settings: &Settings,
    baking: Baking,
) -> Result<Scene, Error> {
    let exposed = solution.exposed(settings.radiosity.exposure_factor());
    let scene = posed(Cow::Borrowed(scene), settings.moment.as_ref())?;
    let interpolation = match settings.radiosity.display {
        Display::Flat => Interpolation::Flat,
        _ => Interpolation::Smooth,
    };
    on_threads(settings.drawing.threads, || {
        let field = LightField::new(&exposed.mesh, exposed.incident.clone(), interpolation);
        let mut baked = match baking {
            Baking::VertexColors(encoding) => {
                let mut baked = bake_vertex_colors(&scene, &field);
                if encoding == ColorEncoding::Srgb {
                    encode_colors(&mut baked);
                }
                baked
            }
            Baking::Lightmap(Some(side)) => bake_lightmap(&scene, &field, &finder_of(&exposed)?, side)?,
            Baking::Lightmap(None) => fitting_lightmap(&scene, &field, &finder_of(&exposed)?)?,
        };
        bake_lamps(&scene, settings.radiosity.exposure_factor(), &mut baked);
        Ok(baked)
    })?
}

/// The light alone, what a white matt surface would show, as a linear picture on the coordinates of a model
/// with a lightmap of this `side`, in texels.
///
/// # Errors
/// See [`Error`].
pub fn bake_light_picture(solution: &Solution, settings: &Settings, side: u32) -> Result<Image, Error> {
    let exposed = solution.exposed(settings.radiosity.exposure_factor());
    let field = LightField::new(&exposed.mesh, exposed.incident.clone(), Interpolation::Smooth);
    on_threads(settings.drawing.threads, || Ok(paint_light(&field, side)?))?
}

/// Rays for reflected light at each place that is measured.
const LUX_RAYS: u32 = 512;

/// The smallest lightmap that shows the elements well, and has room for the polygons.
fn fitting_lightmap(
    scene: &Scene,
    field: &LightField<'_>,
    finder: &ElementFinder<'_>,
) -> Result<Scene, RadiosityError> {
    let leaves = field.mesh().leaves().count() as f64;
    let mut side = ((leaves.sqrt() * TEXELS_OF_ELEMENT) as u32).clamp(256, 4096).next_power_of_two();
    loop {
        match bake_lightmap(scene, field, finder, side) {
            Err(RadiosityError::Setting { .. }) if side < 16_384 => side *= 2,
            baked => return baked,
        }
    }
}

/// Encodes the colours of all vertices.
fn encode_colors(scene: &mut Scene) {
    for geometry in &mut scene.geometries {
        let Shape::Mesh(mesh) = &mut geometry.shape else { continue };
        for color in &mut mesh.vertices.color {
            let [r, g, b] = [color.x, color.y, color.z].map(srgb_from_linear);
            *color = Vec4::new(r, g, b, color.w);
        }
    }
}

/// What of a model is brighter than white, and cut off there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeyondWhite {
    /// Share of the area that is, emitters left aside, in [0, 1].
    pub share: f64,
    /// How many stops darker it would have to be for a thousandth of that area to be.
    pub stops: f64,
    /// What the brightest emitter or area light shows, in whites; 0 without any.
    pub emitters: f64,
}

/// What is brighter than white in a model of `scene` with the light of `solution`, brightened by `exposure`.
#[must_use]
pub fn beyond_white(scene: &Scene, solution: &Solution, exposure: f32) -> BeyondWhite {
    let shown = solution.mesh.surfaces().iter().map(|surface| surface.emission.max_component());
    let emitters = exposure * shown.fold(brightest_lamp(scene), f32::max);
    let (share, stops) = reflected_beyond_white(solution, exposure);
    BeyondWhite { share, stops, emitters: emitters.into() }
}

fn reflected_beyond_white(solution: &Solution, exposure: f32) -> (f64, f64) {
    let mesh = &solution.mesh;
    let of = |leaf: u32| {
        let reflected = mesh.surface(leaf).reflectance * solution.incident[leaf as usize] * exposure;
        (f64::from(reflected.max_component()), mesh.elements()[leaf as usize].open_area())
    };
    let mut leaves: Vec<(f64, f64)> = mesh.leaves().map(of).collect();
    leaves.sort_by(|a, b| b.0.total_cmp(&a.0));
    let all: f64 = leaves.iter().map(|leaf| leaf.1).sum();
    let bright: f64 = leaves.iter().filter(|leaf| leaf.0 > 1.0).map(|leaf| leaf.1).sum();
    let mut left = 0.001 * all;
    let edge = leaves.iter().find(|leaf| {
        left -= leaf.1;
        left < 0.0
    });
    let stops = edge.map_or(0.0, |leaf| leaf.0.max(1.0).log2());
    (if all > 0.0 { bright / all } else { 0.0 }, stops)
}

/// Illuminance on a grid in the light of `solution`; a shown 1 stands for `luminance_of_one` cd/m². Places
/// in bodies do not count, nor those beside the polygons that were asked for.
///
/// # Errors
/// See [`Error`].
pub fn measure_lux(
    scene: &Scene,
    solution: &Solution,
    settings: &Settings,
    places: &LuxPlaces,
    luminance_of_one: f64,
    control: &Control<'_>,
) -> Result<LuxReport, Error> {
    let grid = &places.grid;
    // On a surface, what is above it counts.
    let lift = grid.normal * (LIFT * solution.mesh.bounds().diagonal());
    let prepared = prepare(Cow::Borrowed(scene), settings)?;
    on_threads(settings.drawing.threads, || {
        let occluders = Occluders::new(&solution.mesh)?;
        let direct = DirectLight::of_scene(&prepared.scene, &settings.radiosity.direct)?;
        let gather = Gather::new(solution, &direct, &occluders, &GatherSettings::default())?;
        let light = |place, normal| {
            let light = gather.afresh(place, normal, LUX_RAYS, 0);
            let counts = places.counts(&solution.mesh, place) && !gather.is_inside(place + lift, light);
            counts.then_some(light)
        };
        let report = LuxReport::measure(grid, luminance_of_one, control, light);
        Ok(report.map_err(RadiosityError::from)?)
    })?
}

pub(super) fn finder_of(solution: &Solution) -> Result<ElementFinder<'_>, RadiosityError> {
    let limit = solution.mesh.polygons().len();
    ElementFinder::new(&solution.mesh).map_err(|_| RadiosityError::TooManyElements { limit })
}
