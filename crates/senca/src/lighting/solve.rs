//! Computing the light of a scene.

use std::borrow::Cow;
use std::time::Instant;

use senca_math::{Control, LinearRgb};
use senca_pipeline::Culling;
use senca_radiosity::book::{self, BookSettings, Relaxation, ShootingRule};
use senca_radiosity::{
    DirectLight, DirectSettings, ElementMesh, MeshSettings, Occluders, Sides, Solution, light_fingerprint,
    solve_hierarchy,
};
use senca_scene::{Scene, Warning};

use super::{RadiositySettings, Solver};
use crate::prepare::prepare;
use crate::traced::on_threads;
use crate::{Error, Settings};

/// Called with the solution as far as it has come.
pub type OnRound<'a> = dyn FnMut(&Solution) + Send + 'a;

/// The light of a scene.
#[derive(Clone, Debug)]
pub struct ComputedLight {
    /// Light on the elements.
    pub solution: Solution,
    /// What was mended or left out.
    pub warnings: Vec<Warning>,
    /// Stands for the scene when the solution is saved: see [`senca_radiosity::light_fingerprint`].
    pub fingerprint: u64,
    /// Seconds it took.
    pub seconds: f64,
}

/// Computes the light of `scene` by [`Settings::radiosity`], without exposure. When the control cancels,
/// the best solution so far is returned; its report says that it has not converged.
///
/// # Errors
/// See [`Error`].
pub fn compute_light(
    scene: &Scene,
    settings: &Settings,
    control: &Control<'_>,
    on_round: &mut OnRound<'_>,
) -> Result<ComputedLight, Error> {
    let start = Instant::now();
    let prepared = prepare(Cow::Borrowed(scene), settings)?;
    let radiosity = &settings.radiosity;
    let sides = match settings.drawing.cull {
        Culling::ByMaterial => radiosity.mesh.sides,
        Culling::Always => Sides::Front,
        Culling::Never => Sides::Both,
    };
    let mesh_settings = MeshSettings { sides, ..radiosity.mesh };
    let fingerprint = scene_light_fingerprint(scene, settings)?;
    let (solution, warnings) = on_threads(settings.drawing.threads, || match radiosity.solver {
        Solver::Hierarchical => {
            let (mut mesh, mut warnings) =
                ElementMesh::of_scene_with_warnings(&prepared.scene, &mesh_settings)?;
            warnings.extend(mesh.hold_reflectance(BookSettings::default().largest_reflectance));
            let solution = hierarchical(&prepared.scene, mesh, radiosity, control, on_round)?;
            Ok::<_, Error>((solution, warnings))
        }
        Solver::GaussSeidel | Solver::Shooting => {
            let book = book_settings(radiosity, mesh_settings);
            let solved = book::solve(&prepared.scene, &book, control, |solution| on_round(solution))?;
            Ok((solved.solution, solved.warnings))
        }
    })??;
    Ok(ComputedLight { solution, warnings, fingerprint, seconds: start.elapsed().as_secs_f64() })
}

/// What stands for the scene, as it is at the moment of the settings, in a saved solution.
///
/// # Errors
/// See [`Error`].
pub fn scene_light_fingerprint(scene: &Scene, settings: &Settings) -> Result<u64, Error> {
    let posed = crate::prepare::posed(Cow::Borrowed(scene), settings.moment.as_ref())?;
    Ok(light_fingerprint(&posed))
}

fn book_settings(radiosity: &RadiositySettings, mesh: MeshSettings) -> BookSettings {
    let rule = ShootingRule { max_steps: radiosity.max_steps.unwrap_or(u32::MAX), ..ShootingRule::default() };
    let relaxation = match radiosity.solver {
        Solver::Shooting => Relaxation::Shooting(rule),
        Solver::GaussSeidel | Solver::Hierarchical => Relaxation::GaussSeidel,
    };
    let (direct, factors) = (radiosity.direct, radiosity.factors);
    BookSettings { mesh, direct, factors, relaxation, ..BookSettings::default() }
}

fn hierarchical(
    scene: &Scene,
    mesh: ElementMesh,
    settings: &RadiositySettings,
    control: &Control<'_>,
    on_round: &mut OnRound<'_>,
) -> Result<Solution, Error> {
    let direct = DirectLight::of_scene(scene, &settings.direct)?;
    Ok(solve_hierarchy(mesh, &direct, &settings.hierarchy, control, &mut |solution| on_round(solution))?)
}

/// The lights of a scene at their places, without its surroundings.
fn lights_only(scene: &Scene) -> Scene {
    Scene {
        nodes: scene.nodes.clone(),
        roots: scene.roots.clone(),
        lights: scene.lights.clone(),
        ..Scene::default()
    }
}

/// Light of the lamps alone on each element, in the elements' order: what the recursive tracer finds by
/// itself.
///
/// # Errors
/// See [`Error`].
pub(super) fn light_of_lamps(
    scene: &Scene,
    mesh: &ElementMesh,
    settings: &DirectSettings,
    control: &Control<'_>,
) -> Result<Vec<LinearRgb>, Error> {
    let direct = DirectLight::of_scene(&lights_only(scene), settings)?;
    if direct.is_empty() {
        return Ok(vec![LinearRgb::BLACK; mesh.elements().len()]);
    }
    let occluders = Occluders::new(mesh)?;
    let leaves: Vec<u32> = mesh.leaves().collect();
    let samples = direct.on_elements(&occluders, mesh, &leaves, control)?;
    let mut light = vec![LinearRgb::BLACK; mesh.elements().len()];
    for (leaf, sample) in leaves.into_iter().zip(samples) {
        light[leaf as usize] = sample.mean;
    }
    Ok(light)
}
