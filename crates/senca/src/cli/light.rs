//! Light that is computed, or read from a file, or kept in one.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum, ValueHint};
use senca::math::LinearRgb;
use senca::pipeline::Control;
use senca::radiosity::book::FactorMethod;
use senca::radiosity::{HierarchySettings, MeshSettings, Solution, SolveReport};
use senca::scene::Warning;
use senca::{
    ComputedLight, Error, OnRound, RadiositySettings, Scene, Settings, Solver, compute_light,
    scene_light_fingerprint,
};

use super::output::{check_writable, is_standard, tell};
use super::values::{positive, share};
use super::{Failure, Interrupt};

/// How light is computed, and the files that keep it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Light (method radiosity)")]
pub(crate) struct LightArguments {
    /// How light is computed [default: hierarchical]
    #[arg(long, value_enum, value_name = "SOLVER")]
    pub(crate) solver: Option<SolverChoice>,

    /// Longest edge of a patch to begin with, in world units [default: polygons are left whole, and
    /// divided where light asks for it; for gauss-seidel and shooting 1/12 of the scene]
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub(crate) patch_size: Option<f64>,

    /// Shortest edge that patches are divided to, in world units [default: 1/400 of the scene]
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub(crate) smallest_patch: Option<f64>,

    /// Light that a link between two patches may be wrong by, as a share of all [default: 0.00003]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) link_error: Option<f64>,

    /// How gauss-seidel and shooting find form factors [default: ray-cast]
    #[arg(long, value_enum, value_name = "METHOD")]
    pub(crate) form_factors: Option<FormFactorChoice>,

    /// Steps of shooting at most; light that is still on its way then is estimated
    #[arg(long, value_name = "N")]
    pub(crate) steps: Option<u32>,

    /// Takes the light saved in this file, without computing it
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) solution: Option<PathBuf>,

    /// Saves the light in this file, for more pictures; after Ctrl-C, too, as far as it has come
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "solution")]
    pub(crate) save_solution: Option<PathBuf>,
}

/// The methods to compute light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SolverChoice {
    /// Links between patches and groups of them, of any size
    Hierarchical,
    /// The book's: form factors between all patches, and relaxation
    GaussSeidel,
    /// Progressive refinement: the patch with most unsent light sends it, and there is a picture at once
    Shooting,
}

/// The ways to find form factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormFactorChoice {
    /// The closed form, times the share of rays that pass
    RayCast,
    /// Half cubes of 50 cells
    Hemicube,
}

impl LightArguments {
    /// An option that was given, if any.
    pub(crate) fn any(&self) -> Option<&'static str> {
        let given = [
            ("--solver", self.solver.is_some()),
            ("--patch-size", self.patch_size.is_some()),
            ("--smallest-patch", self.smallest_patch.is_some()),
            ("--link-error", self.link_error.is_some()),
            ("--form-factors", self.form_factors.is_some()),
            ("--steps", self.steps.is_some()),
            ("--solution", self.solution.is_some()),
            ("--save-solution", self.save_solution.is_some()),
        ];
        given.iter().find(|(_, given)| *given).map(|(name, _)| *name)
    }

    /// Refuses options of one solver where another one is chosen.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let solver = self.solver.unwrap_or(SolverChoice::Hierarchical);
        let hierarchical = solver == SolverChoice::Hierarchical;
        match () {
            () if self.link_error.is_some() && !hierarchical => {
                Err(Failure::usage("--link-error belongs to --solver hierarchical"))
            }
            () if self.form_factors.is_some() && hierarchical => {
                Err(Failure::usage("--form-factors belongs to --solver gauss-seidel and shooting"))
            }
            () if self.steps.is_some() && solver != SolverChoice::Shooting => {
                Err(Failure::usage("--steps belongs to --solver shooting"))
            }
            () => Ok(()),
        }
    }

    /// The library's settings, as far as computing goes; `exposure` in stops.
    pub(crate) fn settings(&self, exposure: f64) -> RadiositySettings {
        let standard = HierarchySettings::default();
        RadiositySettings {
            solver: match self.solver {
                Some(SolverChoice::Hierarchical) | None => Solver::Hierarchical,
                Some(SolverChoice::GaussSeidel) => Solver::GaussSeidel,
                Some(SolverChoice::Shooting) => Solver::Shooting,
            },
            factors: match self.form_factors {
                Some(FormFactorChoice::Hemicube) => FactorMethod::HEMICUBE,
                Some(FormFactorChoice::RayCast) | None => FactorMethod::default(),
            },
            max_steps: self.steps,
            mesh: MeshSettings { patch_size: self.patch_size, ..MeshSettings::default() },
            hierarchy: HierarchySettings {
                threshold: self.link_error.unwrap_or(standard.threshold),
                smallest_edge: self.smallest_patch,
                ..standard
            },
            exposure: exposure.exp2() as f32,
            ..RadiositySettings::default()
        }
    }

    /// Where light is read from and kept.
    pub(crate) fn files(&self, time_limit: Option<Duration>) -> Result<LightFiles, Failure> {
        LightFiles::of(self.solution.as_deref(), self.save_solution.as_deref(), time_limit)
    }
}

/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(20);

/// Where light comes from, and where it is kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightFiles {
    solution: Option<(PathBuf, Vec<u8>)>,
    save: Option<PathBuf>,
    time_limit: Option<Duration>,
}

impl LightFiles {
    /// As the options say: what is to be read is read, and what is to be written can be.
    fn of(
        solution: Option<&Path>,
        save: Option<&Path>,
        time_limit: Option<Duration>,
    ) -> Result<Self, Failure> {
        if let Some(path) = save {
            if is_standard(path) {
                return Err(Failure::usage("--save-solution needs the name of a file"));
            }
            check_writable(path)?;
        }
        let read = |path: &Path| match std::fs::read(path) {
            Ok(bytes) => Ok((path.to_owned(), bytes)),
            Err(error) => Err(Failure::input(format!("{}: {error}", path.display()))),
        };
        Ok(Self { solution: solution.map(read).transpose()?, save: save.map(Path::to_owned), time_limit })
    }

    /// The light of the scene read from `name`: from the file, or computed, and then saved where that is
    /// asked for. `on_round` sees it as far as it has come.
    pub(crate) fn light(
        &self,
        name: &Path,
        scene: &Scene,
        settings: &Settings,
        control: &Control<'_>,
        interrupt: &Interrupt,
        on_round: &mut OnRound<'_>,
    ) -> Result<Light, Failure> {
        let failure = |error: Error| Failure::of_scene(name, &error);
        if let Some((path, bytes)) = &self.solution {
            let fingerprint = scene_light_fingerprint(scene, settings).map_err(failure)?;
            let refused = |error| Failure::input(format!("{}: {error}", path.display()));
            return Solution::load(bytes, Some(fingerprint)).map(|s| Light::of(s, &[])).map_err(refused);
        }
        let mut compute = || self.compute(scene, settings, control, interrupt, on_round);
        let Some(path) = &self.save else {
            let light = compute().map_err(failure)?;
            return match interrupt.is_raised() {
                true => Err(Failure::Interrupted),
                false => Ok(Light::of(light.solution, &light.warnings)),
            };
        };
        let light = interrupt.while_keeping(|| {
            let light = compute().map_err(failure)?;
            let bytes = light.solution.save(light.fingerprint);
            // Written after Ctrl-C, too: that is what it is for.
            interrupt.while_writing(|| senca::io::write_file(path, &bytes))?;
            Ok::<_, Failure>(light)
        })?;
        match interrupt.is_raised() {
            true => Err(Failure::Interrupted),
            false => Ok(Light::of(light.solution, &light.warnings)),
        }
    }

    /// Computes until it is done, the time is up, or Ctrl-C.
    fn compute(
        &self,
        scene: &Scene,
        settings: &Settings,
        control: &Control<'_>,
        interrupt: &Interrupt,
        on_round: &mut OnRound<'_>,
    ) -> Result<ComputedLight, Error> {
        let Some(limit) = self.time_limit else {
            return compute_light(scene, settings, control, on_round);
        };
        let (stop, done) = (AtomicBool::new(false), AtomicBool::new(false));
        let start = Instant::now();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) && start.elapsed() < limit && !interrupt.is_raised() {
                    std::thread::sleep(TICK.min(limit));
                }
                stop.store(true, Ordering::Relaxed);
            });
            let control = Control { progress: control.progress, cancel: Some(&stop) };
            let light = compute_light(scene, settings, &control, on_round);
            done.store(true, Ordering::Relaxed);
            light
        })
    }
}

/// Light, and what to tell of it.
pub(crate) struct Light {
    pub(crate) solution: Solution,
    warnings: Vec<String>,
}

impl Light {
    fn of(solution: Solution, warnings: &[Warning]) -> Self {
        let mut warnings: Vec<String> = warnings.iter().map(|warning| warning.0.clone()).collect();
        warnings.extend(inexact(&solution.report));
        warnings.extend(dark(&solution));
        Self { solution, warnings }
    }

    /// Says what was mended or left out, and that light is not exact where it is not.
    pub(crate) fn tell_warnings(&self, name: &Path) {
        for warning in &self.warnings {
            tell(&format!("senca: {}: warning: {warning}", name.display()));
        }
    }
}

/// Says that all is dark, where it is.
fn dark(solution: &Solution) -> Option<String> {
    let is_dark = !solution.incident.is_empty() && solution.incident.iter().all(|&l| l == LinearRgb::BLACK);
    (is_dark && solution.report.converged).then(|| {
        "no light arrives at any surface: nothing gives off any, or it shines past them all".to_owned()
    })
}

/// Says that light is not as exact as it was asked to be, where it is not.
fn inexact(report: &SolveReport) -> Option<String> {
    if report.converged {
        return None;
    }
    let SolveReport { iterations, residual, energy_error, unsent, .. } = report;
    Some(if *unsent > 0.0 {
        format!(
            "the light is not as exact as asked for: after {iterations} step{} {:.2} % of it is not sent on yet, and \
             estimated (residual {residual:.1e})",
            if *iterations == 1 { "" } else { "s" },
            100.0 * unsent
        )
    } else {
        format!(
            "the light is not as exact as asked for: after {iterations} rounds it changed by {residual:.1e} of the \
             brightest, and {energy_error:.1e} of the power is not accounted for"
        )
    })
}
