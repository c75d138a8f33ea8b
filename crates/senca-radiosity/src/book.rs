//! The method of the book, from a scene to light on its elements (course text, chapter 4).
//!
//! | step | what is done | section |
//! |---|---|---|
//! | 1 | the scene's shapes are covered with patches | 4.1 |
//! | 2 | what lamps and the sky send straight to each element | |
//! | 3 | form factors from each element to each patch; patches that are too big for some other are divided | 4.2, 4.3 |
//! | 4 | the system of equations of the patches is solved for each channel | 4.1 |
//! | 5 | elements of a patch get their own values from the patches' (two levels, no more equations) | 4.3 |
//! | 6 | elements that differ too much from their neighbours are divided; again from 3, with the same equations | 4.3 |
//!
//! The values are then moved to the nodes ([`crate::Solution::node_values`]) and shown from anywhere.
//!
//! # Where the text leaves a choice
//!
//! - A patch is too big for another one, and divided with equations of its own, where a factor to it
//!   exceeds [`BookSettings::largest_factor`] (half by default).
//! - Elements differ too much where the light they show by reflection does by more than
//!   [`BookSettings::largest_step`] of its mean here or over the whole scene, whichever is larger.
//!   Elements on a shadow's border are known before their neighbours are: by what lamps send to
//!   different places of them.
//! - Dividing ends after [`BookSettings::rounds`] rounds, [`BookSettings::depth`] divisions of a patch,
//!   or at edges of [`BookSettings::smallest`]; neighbours differ by one division at most along an edge.
//! - Factors obey reciprocity (4.2): both directions of a pair are computed and the mean is taken. Where
//!   a patch is surrounded on all sides by others its row sums to 1 (4.2), and rows above 1 are
//!   lowered to it; the scale is the same for both directions, so that reciprocity stays.

mod factors;
mod refine;
mod rows;
mod settings;
mod shoot;

#[cfg(test)]
mod cornell_tests;
#[cfg(test)]
mod tests;

use senca_math::{Control, LinearRgb};
use senca_scene::{Scene, Warning};

use crate::system::{FactorMatrix, GaussSeidel, Outcome, Rgb64, System};
use crate::{DirectLight, ElementMesh, NONE, Occluders, RadiosityError, Solution, SolveReport};

pub use settings::{BookSettings, FactorMethod, Relaxation, ShootingRule};

use factors::Factors;
use rows::Rows;

/// What was computed, and what to know of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// The light.
    pub solution: Solution,
    /// Form factors, equations and power.
    pub report: BookReport,
    /// What was mended or left out.
    pub warnings: Vec<Warning>,
}

/// Counts of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BookReport {
    /// Equations, which is the number of patches.
    pub equations: u64,
    /// Form factors between patches that are not 0.
    pub factors: u64,
    /// Form factors from elements that these are the means of.
    pub partial_factors: u64,
    /// Rounds of dividing elements.
    pub rounds: u32,
    /// The largest row sum before rows were adjusted.
    pub largest_row_sum: f64,
    /// By how much the matrix is dominant ([`System::dominance`]).
    pub dominance: f64,
    /// Share of the power that leaves the scene.
    pub lost: f64,
}

/// Computes the light of `scene`, which is in its pose and valid. `watch` sees the solution after every
/// round, and of shooting after 1, 2, 4, 8 and so on steps.
///
/// Cancelling ends with an error only before there is any light; later the best so far is returned,
/// with [`SolveReport::converged`] false and a warning.
///
/// # Errors
/// Those of [`ElementMesh::of_scene`], [`RadiosityError::Setting`], [`RadiosityError::TooManyFactors`],
/// [`RadiosityError::Cancelled`].
pub fn solve(
    scene: &Scene,
    settings: &BookSettings,
    control: &Control<'_>,
    watch: impl FnMut(&Solution),
) -> Result<Solved, RadiosityError> {
    settings.check()?;
    let mut mesh_settings = settings.mesh;
    if mesh_settings.patch_size.is_none() {
        mesh_settings.patch_size = Some(settings::default_patch_size(scene));
    }
    let (mesh, mut warnings) = ElementMesh::of_scene_with_warnings(scene, &mesh_settings)?;
    let light = DirectLight::of_scene(scene, &settings.direct)?;
    let mut solved = solve_mesh(mesh, &light, settings, control, watch)?;
    warnings.append(&mut solved.warnings);
    Ok(Solved { warnings, ..solved })
}

/// Computes the light on `mesh`, whose leaves are the patches, lit by what the mesh gives off and by
/// `light`. `watch` sees solutions as in [`solve`].
///
/// # Errors
/// As [`solve`].
pub fn solve_mesh(
    mesh: ElementMesh,
    light: &DirectLight,
    settings: &BookSettings,
    control: &Control<'_>,
    mut watch: impl FnMut(&Solution),
) -> Result<Solved, RadiosityError> {
    settings.check()?;
    let mut book = Book::new(mesh, light, settings)?;
    book.illuminate(control)?;
    let rounds = match settings.relaxation {
        Relaxation::GaussSeidel => book.rounds(control, &mut watch),
        Relaxation::Shooting(rule) => book.rounds_by_shooting(rule, control, &mut watch),
    };
    match rounds {
        Err(RadiosityError::Cancelled) => {
            book.warnings.push(Warning("interrupted: the light is the best so far".to_owned()));
            book.outcome.converged = false;
        }
        other => other?,
    }
    Ok(book.finish())
}

/// The state between the steps.
struct Book<'a> {
    settings: &'a BookSettings,
    light: &'a DirectLight,
    mesh: ElementMesh,
    occluders: Occluders,
    /// Elements that have equations.
    patches: Vec<u32>,
    /// Index among the patches, by element; [`NONE`] for what is above them.
    patch_of: Vec<u32>,
    rows: Rows,
    /// By element: light straight from lamps and sky, and how much it differs over the element.
    lamps: Vec<LinearRgb>,
    spread: Vec<f32>,
    factors: Factors,
    /// By patch.
    radiosity: Vec<Rgb64>,
    outcome: Outcome,
    balance: f64,
    /// Power that shooting has not sent, as a share of all.
    unsent: f64,
    report: BookReport,
    warnings: Vec<Warning>,
    solution: Solution,
}

impl<'a> Book<'a> {
    fn new(
        mesh: ElementMesh,
        light: &'a DirectLight,
        settings: &'a BookSettings,
    ) -> Result<Self, RadiosityError> {
        let occluders = Occluders::new(&mesh)?;
        let mut book = Self {
            settings,
            light,
            mesh,
            occluders,
            patches: Vec::new(),
            patch_of: Vec::new(),
            rows: Rows::default(),
            lamps: Vec::new(),
            spread: Vec::new(),
            factors: Factors::default(),
            radiosity: Vec::new(),
            outcome: Outcome::default(),
            balance: 0.0,
            unsent: 0.0,
            report: BookReport::default(),
            warnings: Vec::new(),
            solution: Solution::default(),
        };
        book.warnings.extend(book.mesh.hold_reflectance(settings.largest_reflectance));
        book.number_patches();
        Ok(book)
    }

    /// Leaves become patches.
    fn number_patches(&mut self) {
        self.patches = self.mesh.leaves().collect();
        self.patch_of = vec![NONE; self.mesh.elements().len()];
        for (number, &patch) in (0..).zip(&self.patches) {
            self.patch_of[patch as usize] = number;
        }
        self.rows.clear(self.mesh.elements().len());
    }

    /// Light of lamps on the leaves that do not have it yet, and a first guess of the rest: as if what
    /// is reflected came from everywhere alike.
    fn illuminate(&mut self, control: &Control<'_>) -> Result<(), RadiosityError> {
        let known = self.lamps.len() as u32;
        let new: Vec<u32> = self.mesh.leaves().filter(|&leaf| leaf >= known).collect();
        let samples = self.light.on_elements(&self.occluders, &self.mesh, &new, control)?;
        self.lamps.resize(self.mesh.elements().len(), LinearRgb::BLACK);
        self.spread.resize(self.mesh.elements().len(), 0.0);
        for (&leaf, sample) in new.iter().zip(&samples) {
            self.lamps[leaf as usize] = sample.mean;
            self.spread[leaf as usize] = sample.spread();
        }
        if known == 0 {
            self.solution = self.guess();
        }
        Ok(())
    }

    /// Steps 3 to 6.
    fn rounds(
        &mut self,
        control: &Control<'_>,
        watch: &mut impl FnMut(&Solution),
    ) -> Result<(), RadiosityError> {
        self.patch_factors(control)?;
        loop {
            self.solve_patches(control)?;
            self.solution = self.on_elements();
            watch(&self.solution);
            let share = (1 + self.report.rounds) as f32 / (1 + self.settings.rounds) as f32;
            control.report(0.5 + 0.5 * share);
            if self.report.rounds >= self.settings.rounds || !self.divide_elements()? {
                return Ok(());
            }
            self.report.rounds += 1;
            self.illuminate(control)?;
            self.element_factors(control)?;
        }
    }

    /// Step 4: the system of the patches.
    fn solve_patches(&mut self, control: &Control<'_>) -> Result<(), RadiosityError> {
        self.factors = Factors::new(&self.mesh, &self.occluders, &self.patches, &self.patch_of, &self.rows);
        self.report.largest_row_sum = self.factors.largest_row_sum;
        let system = self.system(self.factors.matrix.clone())?;
        self.report.dominance = system.dominance();
        let started = self.radiosity.len() == system.len();
        let mut solver = if started {
            GaussSeidel::starting_at(&system, self.radiosity.clone())
        } else {
            GaussSeidel::new(&system)
        };
        let run = solver.run(&self.settings.stop, control, |_, _| ());
        self.radiosity = solver.into_radiosity();
        self.outcome = run?;
        self.balance = self.power_error(&system);
        self.report.equations = system.len() as u64;
        self.report.factors = system.factors().pairs() as u64;
        self.report.partial_factors = self.rows.count();
        Ok(())
    }

    /// The patches' equations. What lamps send joins what patches give off.
    fn system(&self, factors: FactorMatrix) -> Result<System, RadiosityError> {
        let lamps = self.patch_means(&self.lamps);
        let areas = self.patches.iter().map(|&p| self.mesh.elements()[p as usize].area).collect();
        let rgb = |c: LinearRgb| c.to_array().map(f64::from);
        let (mut reflectance, mut emission) = (Vec::new(), Vec::new());
        for (&patch, lamps) in self.patches.iter().zip(&lamps) {
            let surface = self.mesh.surface(patch);
            reflectance.push(rgb(surface.reflectance));
            emission.push(rgb(surface.emission + surface.reflectance * *lamps));
        }
        System::new(factors, areas, reflectance, emission)
    }

    /// Power not accounted for as a share of all that patches give off and lamps send.
    fn power_error(&mut self, system: &System) -> f64 {
        let balance = system.balance(&self.radiosity);
        let lamps = self.patch_means(&self.lamps);
        let mut given = [0.0f64; 3];
        for (&patch, lamps) in self.patches.iter().zip(&lamps) {
            let light = (self.mesh.surface(patch).emission + *lamps).to_array();
            let area = self.mesh.elements()[patch as usize].area;
            (0..3).for_each(|c| given[c] += area * f64::from(light[c]));
        }
        let most = given.into_iter().fold(0.0, f64::max);
        let share = |power: f64| if most > 0.0 { power / most } else { 0.0 };
        self.report.lost = share(balance.lost.into_iter().fold(0.0, f64::max));
        let missing = |c: usize| (balance.emitted[c] - balance.absorbed[c] - balance.lost[c]).abs();
        share((0..3).map(missing).fold(0.0, f64::max))
    }

    /// Means of values of leaves over each patch.
    fn patch_means(&self, values: &[LinearRgb]) -> Vec<LinearRgb> {
        let mut sums = vec![[0.0f64; 3]; self.patches.len()];
        for leaf in self.mesh.leaves() {
            let sum = &mut sums[self.patch_of[leaf as usize] as usize];
            let area = self.mesh.elements()[leaf as usize].area;
            let value = values[leaf as usize].to_array();
            (0..3).for_each(|c| sum[c] += area * f64::from(value[c]));
        }
        let mean = |(sum, &patch): (&Rgb64, &u32)| {
            LinearRgb::from_array(sum.map(|s| (s / self.mesh.elements()[patch as usize].area) as f32))
        };
        sums.iter().zip(&self.patches).map(mean).collect()
    }

    /// Step 5: values of the elements from those of the patches.
    fn on_elements(&self) -> Solution {
        let matrix = &self.factors.matrix;
        self.solution_of(&matrix.gather_all(&self.radiosity), &matrix.gather_all(&self.emission()))
    }

    /// Own light of the patches.
    fn emission(&self) -> Vec<Rgb64> {
        self.patches.iter().map(|&p| self.mesh.surface(p).emission.to_array().map(f64::from)).collect()
    }

    /// Light on the elements from what arrives at the patches, and the part of it that comes straight
    /// from emitters.
    fn solution_of(&self, incident: &[Rgb64], direct: &[Rgb64]) -> Solution {
        let on_leaves = |radiosity: &[Rgb64], incident: &[Rgb64]| -> Vec<LinearRgb> {
            let values = self.factors.on_leaves(&self.mesh, &self.patch_of, &self.rows, radiosity, incident);
            values.iter().zip(&self.lamps).map(|(value, lamps)| *value + *lamps).collect()
        };
        let mut solution = Solution {
            mesh: self.mesh.clone(),
            incident: on_leaves(&self.radiosity, incident),
            direct: on_leaves(&self.emission(), direct),
            report: self.solve_report(),
        };
        solution.pull();
        solution
    }

    fn solve_report(&self) -> SolveReport {
        SolveReport {
            polygons: self.mesh.polygons().len() as u64,
            patches: self.mesh.leaves().count() as u64,
            elements: self.mesh.elements().len() as u64,
            links: self.rows.count(),
            iterations: self.outcome.sweeps,
            residual: self.outcome.change,
            energy_error: self.balance,
            converged: self.outcome.converged,
            unsent: self.unsent,
        }
    }

    /// Lamps' light, and all other light as if it came from everywhere alike.
    fn guess(&self) -> Solution {
        let (mut given, mut returned, mut area) = ([0.0f64; 3], [0.0f64; 3], 0.0);
        for leaf in self.mesh.leaves() {
            let surface = self.mesh.surface(leaf);
            let own = (surface.emission + surface.reflectance * self.lamps[leaf as usize]).to_array();
            let (size, rho) = (self.mesh.elements()[leaf as usize].area, surface.reflectance.to_array());
            (0..3).for_each(|c| given[c] += size * f64::from(own[c]));
            (0..3).for_each(|c| returned[c] += size * f64::from(rho[c]));
            area += size;
        }
        let even = |c: usize| if area > 0.0 { given[c] / (area - returned[c]) } else { 0.0 };
        let ambient = LinearRgb::from_array(std::array::from_fn(|c| even(c) as f32));
        let mut solution = Solution {
            mesh: self.mesh.clone(),
            incident: self.lamps.iter().map(|&lamps| lamps + ambient).collect(),
            direct: self.lamps.clone(),
            report: self.solve_report(),
        };
        solution.pull();
        solution
    }

    fn finish(mut self) -> Solved {
        let outcome = self.outcome;
        let gathering = self.settings.relaxation == Relaxation::GaussSeidel;
        if gathering && !outcome.converged && outcome.sweeps >= self.settings.stop.max_sweeps {
            self.warnings.push(Warning(format!(
                "not converged: the last of {} sweeps still changed the light by {:.1e} of its maximum",
                outcome.sweeps, outcome.change
            )));
        }
        self.solution.report = SolveReport { converged: outcome.converged, ..self.solution.report };
        Solved { solution: self.solution, report: self.report, warnings: self.warnings }
    }
}
