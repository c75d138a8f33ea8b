//! The rounds of a solution.

use rayon::prelude::*;
use senca_math::glam::{DVec3, Vec4};
use senca_math::{Control, LinearRgb};

use super::cluster::Clusters;
use super::exchange::{Network, Parts};
use super::facet::Facet;
use super::link::Link;
use super::lost::estimate_lost;
use super::mixing::Mixing;
use super::node::{MAX_NODES, Node};
use super::oracle::{Oracle, Verdict};
use super::refine::{Limits, apply, judge_all};
use super::settings::HierarchySettings;
use super::sight::Sight;
use super::state::{State, brightness, rgb, rgb1};
use crate::open_parts::{OpenParts, Surroundings};
use crate::{
    DirectLight, DirectSample, Element, ElementMesh, Occluders, RadiosityError, Solution, SolveReport,
};

/// Smallest edge of elements, as a share of the diagonal of the scene.
const SMALLEST_EDGE: f64 = 1.0 / 400.0;

/// Most that a sum of form factors is corrected by.
const MOST_CORRECTION: f32 = 2.0;

/// Share of the tolerance below which a change is none.
const STILL: f64 = 1e-3;

/// Where less of the light is kept or lost at each exchange, there is no end to it that could be foreseen.
const DIM: f64 = 1e-4;

/// Surfaces that keep less than the inverse of this are bright.
const BRIGHT: f64 = 5.0;

/// Elements that one task of a thread sums.
const CHUNK: usize = 4096;

/// Links that are judged between two looks at whether the caller wants to stop.
const AT_ONCE: usize = 1 << 14;

/// Exchange of light over `mesh`, whose polygons are left whole or divided by the caller as a start.
///
/// `on_round` sees the solution after each round of refinement, for early pictures. The result does
/// not depend on the number of threads. When the caller cancels, the best solution so far is returned;
/// it has not converged then.
///
/// # Errors
/// [`RadiosityError::Setting`] for settings out of range, or emission that is not finite;
/// [`RadiosityError::TooManyElements`].
pub fn solve_hierarchy(
    mesh: ElementMesh,
    light: &DirectLight,
    settings: &HierarchySettings,
    control: &Control<'_>,
    on_round: &mut dyn FnMut(&Solution),
) -> Result<Solution, RadiosityError> {
    settings.check()?;
    let mut solver = Solver::new(mesh, light, settings, control)?;
    solver.light_by_lamps();
    for round in 0..settings.rounds {
        if solver.power <= 0.0 || !solver.run_round(round) {
            break;
        }
        if round + 1 < settings.rounds {
            solver.show(on_round);
        }
        control.report((round + 1) as f32 / settings.rounds as f32);
        if !solver.settled {
            // Where light grows without end, links would be divided without end.
            break;
        }
    }
    solver.show(on_round);
    Ok(solver.finish())
}

struct Solver<'a> {
    mesh: ElementMesh,
    clusters: Clusters,
    occluders: Occluders,
    open: OpenParts,
    /// Lamps that are matt rectangles, and the rest of them.
    facets: Vec<Facet>,
    others: DirectLight,
    settings: &'a HierarchySettings,
    control: &'a Control<'a>,
    state: State,
    /// Of each element, light of the other lamps.
    point_lit: Vec<Vec4>,
    links: Vec<Link>,
    network: Network,
    /// Emitted and cast, largest channel.
    power: f64,
    smallest_area: f64,
    /// What light from surfaces was brought to its power by.
    scale: Vec4,
    /// Whether light does not change any more.
    settled: bool,
    report: SolveReport,
}

impl<'a> Solver<'a> {
    fn new(
        mesh: ElementMesh,
        light: &DirectLight,
        settings: &'a HierarchySettings,
        control: &'a Control<'a>,
    ) -> Result<Self, RadiosityError> {
        if mesh.elements().len() >= MAX_NODES.min(settings.max_elements) {
            return Err(RadiosityError::TooManyElements { limit: MAX_NODES.min(settings.max_elements) });
        }
        let occluders = Occluders::new(&mesh)?;
        let clusters = Clusters::new(&mesh);
        let mut state = State::new(&mesh, &clusters);
        let mut others = light.clone();
        let rectangles = others.take_plain_areas();
        state.lamp_radiance = rectangles.iter().map(|&(_, shows)| rgb1(shows, 0.0)).collect();
        let facets: Vec<Facet> = rectangles.iter().map(|&(shape, _)| Facet::of_polygon(shape)).collect();
        let edge = settings.smallest_edge.unwrap_or(SMALLEST_EDGE * mesh.bounds().diagonal());
        let mut links = Vec::new();
        if clusters.len() > 0 {
            links.push(Link::new(Node::cluster(0), Node::cluster(0)));
            let from_lamps =
                (0..facets.len() as u32).map(|lamp| Link::new(Node::cluster(0), Node::lamp(lamp)));
            links.extend(from_lamps);
        }
        let mut solver = Self {
            smallest_area: edge * edge,
            power: 0.0,
            scale: Vec4::ONE,
            settled: false,
            point_lit: Vec::new(),
            network: Network::default(),
            report: SolveReport::default(),
            open: OpenParts::new(&mesh),
            mesh,
            clusters,
            occluders,
            facets,
            others,
            settings,
            control,
            state,
            links,
        };
        solver.follow_mesh();
        solver.state.gather_moments(&solver.mesh, &solver.clusters);
        solver.power = solver.given_power();
        if !solver.power.is_finite() {
            return Err(RadiosityError::Setting {
                name: "emitted power",
                value: solver.power,
                expected: "finite",
            });
        }
        Ok(solver)
    }

    /// What emitters and rectangles send; the largest channel.
    fn given_power(&self) -> f64 {
        let moments = self.state.moments.first().map_or(Vec4::ZERO, |moments| moments.power);
        let lamps = self.facets.iter().zip(&self.state.lamp_radiance);
        let all = lamps.fold(moments, |sum, (facet, &radiance)| sum + radiance * facet.area as f32);
        // Unlike the largest, the sum shows what is not a number.
        f64::from(if (all.x + all.y + all.z).is_finite() { brightness(all) } else { f32::NAN })
    }

    /// Learns of elements that are new.
    fn follow_mesh(&mut self) {
        self.state.follow_mesh(&self.mesh);
        let (occluders, others, facets) = (&self.occluders, &self.others, &self.facets);
        let sees = |place: DVec3, normal: DVec3, lamp: &Facet| {
            let is_ahead = |corner: &&DVec3| (**corner - place).dot(normal) > 0.0;
            let ahead = (place - lamp.center).dot(lamp.normal) > 0.0;
            let mut ends = lamp.shape.corners().iter().filter(is_ahead);
            ahead && ends.any(|end| occluders.visible(place, end.lerp(lamp.center, 0.1)))
        };
        let is_lit = |place: DVec3, normal: DVec3| {
            facets.iter().any(|lamp| sees(place, normal, lamp))
                || others.at(occluders, place, normal) != LinearRgb::BLACK
        };
        let around = Surroundings { clusters: &self.clusters, occluders, is_lit: &is_lit };
        self.open.follow(&mut self.mesh, &around);
    }

    fn parts(&self) -> Parts<'_> {
        Parts { mesh: &self.mesh, clusters: &self.clusters, lamps: &self.facets }
    }

    /// Light of the other lamps, with elements divided where it changes.
    fn light_by_lamps(&mut self) {
        let mut first = 0;
        let mut threshold = f64::INFINITY;
        while !self.others.is_empty() && first < self.mesh.elements().len() {
            if self.control.is_cancelled() {
                break;
            }
            let lit = self.lit_by_lamps(first);
            if first == 0 {
                let area = |element: usize| self.mesh.elements()[element].open_area() as f32;
                let roots = 0..self.mesh.polygons().len();
                let cast: Vec4 = roots.map(|root| lit[root].0 * area(root)).sum();
                self.power += f64::from(brightness(cast));
                threshold = self.settings.threshold * self.power / self.settings.direct_detail;
            }
            self.point_lit.extend(lit.iter().map(|&(mean, _)| mean));
            let end = self.mesh.elements().len();
            for (number, &(_, spread)) in (first..end).zip(&lit) {
                let element = &self.mesh.elements()[number];
                let wrong = f64::from(spread) * element.open_area() > threshold && element.is_leaf();
                if wrong && element.area > self.smallest_area && end < self.settings.max_elements {
                    self.mesh.divide(number as u32);
                }
            }
            first = end;
            self.follow_mesh();
        }
    }

    /// Light of the other lamps on elements from `first` on, and how much it varies. Once the caller
    /// wants to stop, what was not looked at stays dark.
    fn lit_by_lamps(&self, first: usize) -> Vec<(Vec4, f32)> {
        let wanted = first as u32..self.mesh.elements().len() as u32;
        let on_element = |element: u32| {
            if self.others.is_empty() || self.control.is_cancelled() {
                return DirectSample::default();
            }
            self.others.on_open_part(&self.occluders, &self.mesh, &self.open, element)
        };
        let lit: Vec<DirectSample> = wanted.into_par_iter().with_min_len(4).map(on_element).collect();
        lit.iter().map(|sample| (rgb1(sample.mean, 0.0), sample.spread())).collect()
    }

    /// Refines and exchanges. False when the caller wants to stop before there is anything new.
    fn run_round(&mut self, round: u32) -> bool {
        let finer = 2f64.powi((self.settings.rounds - 1 - round) as i32);
        let last = round + 1 == self.settings.rounds;
        if !self.refine(self.settings.threshold * self.power * finer) {
            self.state.keep_lost(&self.mesh);
            return false;
        }
        self.light_new_leaves();
        estimate_lost(&mut self.state, &self.mesh, &self.occluders, &self.open);
        let is_lamp = |source: Node| source.as_lamp().is_some();
        let lamps = Network::new(&self.links, &self.parts(), is_lamp);
        self.network = Network::new(&self.links, &self.parts(), |source| !is_lamp(source));
        let mut light = lamps.gather(&self.parts(), &self.state);
        for (light, &lit) in light.iter_mut().zip(&self.point_lit) {
            *light += lit;
        }
        self.state.lamp_light = light;
        self.state.pull(&self.mesh);
        self.report.links = (self.network.len() + lamps.len()) as u64;
        self.exchange(self.settings.tolerance * if last { 1.0 } else { 8.0 });
        true
    }

    /// Judges links until all are good enough. False when the caller wants to stop.
    fn refine(&mut self, threshold: f64) -> bool {
        let limits =
            Limits { elements: self.settings.max_elements.min(MAX_NODES), links: self.settings.max_links };
        let mut links = std::mem::take(&mut self.links);
        let mut kept = Vec::new();
        while !links.is_empty() {
            let mut next = Vec::new();
            for chunk in links.chunks_mut(AT_ONCE) {
                if self.control.is_cancelled() {
                    return false;
                }
                let verdicts = judge_all(&self.oracle(threshold), chunk);
                let judged: Vec<(Link, Verdict)> = chunk.iter().copied().zip(verdicts).collect();
                let (more, _) = apply(&mut self.mesh, &self.clusters, &judged, &mut kept, &limits);
                next.extend(more);
                self.follow_mesh();
            }
            links = next;
        }
        self.links = kept;
        true
    }

    fn oracle(&self, threshold: f64) -> Oracle<'_> {
        Oracle {
            sight: Sight {
                mesh: &self.mesh,
                clusters: &self.clusters,
                occluders: &self.occluders,
                lamps: &self.facets,
                open: &self.open,
            },
            state: &self.state,
            threshold,
            direct_threshold: threshold / self.settings.direct_detail,
            smallest_area: self.smallest_area,
        }
    }

    fn light_new_leaves(&mut self) {
        let lit = self.lit_by_lamps(self.point_lit.len());
        self.point_lit.extend(lit.into_iter().map(|(mean, _)| mean));
    }

    /// Light goes to and fro until little changes.
    fn exchange(&mut self, tolerance: f64) {
        (self.report.converged, self.settled) = (false, false);
        let kept = self.least_kept();
        let mut mixing = Mixing::new(if kept > DIM { self.settings.remembered } else { 0 });
        // Where little is kept, what still changes is a small part of what is yet to come.
        let change_tolerance = tolerance * (BRIGHT * kept).clamp(DIM, 1.0);
        let weights = self.leaf_areas();
        for _ in 0..self.settings.max_iterations {
            if self.control.is_cancelled() {
                return;
            }
            let before = self.state.radiosity.clone();
            let arriving = self.arriving();
            self.scale = self.balance(&arriving);
            let scale = self.scale;
            let after: Vec<Vec4> = arriving.into_par_iter().map(|light| light * scale).collect();
            let light = std::mem::replace(&mut self.state.incident, after);
            self.state.pull(&self.mesh);
            self.report.iterations += 1;
            self.report.residual = change(&before, &self.state.radiosity);
            if !self.report.residual.is_finite() {
                (self.state.radiosity, self.state.incident) = (before, light);
                return;
            }
            // The brightest may be far brighter than what it lights, so power has to agree too. Links that
            // are coarse yet may keep it from that however long light goes to and fro.
            if self.report.residual <= change_tolerance {
                self.report.converged = self.energy_error() <= tolerance;
                self.settled = self.report.converged || self.report.residual <= STILL * tolerance;
            }
            if self.settled {
                return;
            }
            if mixing.remembers() {
                self.state.incident = mixing.next(&light, &self.state.incident, &weights);
                self.state.pull(&self.mesh);
            }
        }
    }

    /// Share of the light that surfaces keep or lose at each exchange, on average; that of the channel
    /// where it is least.
    fn least_kept(&self) -> f64 {
        let [kept, all] = self.sum_over_leaves(|number, element| {
            let (area, lost) = (element.open_area(), self.state.lost[number]);
            let reflected = self.mesh.surface(number as u32).reflectance * (1.0 - lost);
            [area * (1.0 - doubled(rgb1(reflected, 0.0))), DVec3::splat(area)]
        });
        (kept / all).min_element()
    }

    /// Open areas of the leaves, by element; 0 for elements that are divided.
    fn leaf_areas(&self) -> Vec<f32> {
        let area = |e: &Element| if e.is_leaf() { e.open_area() as f32 } else { 0.0 };
        self.mesh.elements().iter().map(area).collect()
    }

    /// Light from surfaces at all leaves. Where nothing is lost on the way out, all directions are
    /// accounted for: there the sum of the form factors is brought to one, by light as it is on average
    /// (or as it is here, where that is darker).
    fn arriving(&mut self) -> Vec<Vec4> {
        self.state.gather_moments(&self.mesh, &self.clusters);
        let mut incident = self.network.gather(&self.parts(), &self.state);
        let mean = self.mean_radiosity();
        for (light, &lost) in incident.iter_mut().zip(&self.state.lost) {
            if lost == 0.0 && light.w > 0.0 && light.w < MOST_CORRECTION {
                *light += (1.0 - light.w) * mean.min(*light / light.w);
            }
        }
        incident
    }

    /// Mean over the area, in which nothing counts for more than twice the mean of all.
    fn mean_radiosity(&self) -> Vec4 {
        let polygons = || {
            (0..self.mesh.polygons().len())
                .map(|p| (self.state.radiosity[p], self.mesh.elements()[p].open_area() as f32))
        };
        let area: f32 = polygons().map(|(_, area)| area).sum();
        let mean: Vec4 =
            polygons().map(|(shown, part)| shown * part).sum::<Vec4>() / area.max(f32::MIN_POSITIVE);
        polygons().map(|(shown, part)| shown.min(2.0 * mean) * part).sum::<Vec4>()
            / area.max(f32::MIN_POSITIVE)
    }

    /// Per channel, what is sent and not lost over what arrives.
    fn balance(&self, incident: &[Vec4]) -> Vec4 {
        let [sent, arrives] = self.sum_over_leaves(|number, element| {
            let (area, lost) = (element.open_area(), f64::from(self.state.lost[number]));
            [doubled(self.state.radiosity[number]) * (area * (1.0 - lost)), doubled(incident[number]) * area]
        });
        let most = f64::from(MOST_CORRECTION);
        let ratio = |channel: usize| {
            let ratio = sent[channel] / arrives[channel];
            if ratio.is_finite() { ratio.clamp(1.0 / most, most) as f32 } else { 1.0 }
        };
        Vec4::new(ratio(0), ratio(1), ratio(2), 1.0)
    }

    /// Sums of two values of the leaves, by chunks of a fixed size, so that the number of threads does not
    /// matter.
    fn sum_over_leaves(&self, value: impl Fn(usize, &Element) -> [DVec3; 2] + Sync) -> [DVec3; 2] {
        let chunks = self.mesh.elements().par_chunks(CHUNK).enumerate();
        let of_chunk = |(chunk, elements): (usize, &[Element])| {
            let numbered = (chunk * CHUNK..).zip(elements).filter(|(_, element)| element.is_leaf());
            numbered.fold([DVec3::ZERO; 2], |[a, b], (number, element)| {
                let [more_a, more_b] = value(number, element);
                [a + more_a, b + more_b]
            })
        };
        let sums: Vec<[DVec3; 2]> = chunks.map(of_chunk).collect();
        sums.iter().fold([DVec3::ZERO; 2], |[a, b], &[more_a, more_b]| [a + more_a, b + more_b])
    }

    /// Shows the solution to the caller.
    fn show(&mut self, on_round: &mut dyn FnMut(&Solution)) {
        let solution = self.solution();
        on_round(&solution);
        self.mesh = solution.mesh;
    }

    /// The light so far; takes the mesh.
    fn solution(&mut self) -> Solution {
        self.follow_mesh();
        let direct = self.direct();
        let incident = self.state.incident.iter().zip(&self.state.lamp_light);
        let incident: Vec<LinearRgb> = incident.map(|(&light, &lamps)| rgb(light + lamps)).collect();
        let report = SolveReport {
            polygons: self.mesh.polygons().len() as u64,
            patches: self.mesh.leaves().count() as u64,
            elements: self.mesh.elements().len() as u64,
            energy_error: self.energy_error(),
            converged: self.report.converged || self.power <= 0.0,
            ..self.report
        };
        let mut solution = Solution { mesh: std::mem::take(&mut self.mesh), incident, direct, report };
        solution.pull();
        solution
    }

    /// Light that comes straight from emitters and lamps.
    fn direct(&mut self) -> Vec<LinearRgb> {
        if self.network.len() == 0 {
            return self.state.lamp_light.iter().map(|&light| rgb(light)).collect();
        }
        let lit = std::mem::take(&mut self.state.radiosity);
        let emission = |number: u32| rgb1(self.mesh.surface(number).emission, 1.0);
        self.state.radiosity = (0..self.mesh.elements().len() as u32).map(emission).collect();
        let direct = self.arriving();
        self.state.radiosity = lit;
        // The next round judges links by all that clusters send.
        self.state.gather_moments(&self.mesh, &self.clusters);
        let lamps = self.state.lamp_light.iter();
        direct.iter().zip(lamps).map(|(&light, &lamps)| rgb(light * self.scale + lamps)).collect()
    }

    /// Power that is neither absorbed nor lost, as a share of what is given.
    fn energy_error(&self) -> f64 {
        let color = |c: LinearRgb| DVec3::new(c.r.into(), c.g.into(), c.b.into());
        let [given, gone] = self.sum_over_leaves(|number, element| {
            let surface = self.mesh.surface(number as u32);
            let (area, lost) = (element.open_area(), f64::from(self.state.lost[number]));
            let lamps = doubled(self.state.lamp_light[number]);
            let absorbed =
                (1.0 - color(surface.reflectance)) * (doubled(self.state.incident[number]) + lamps);
            let sent = doubled(self.state.radiosity[number]);
            [area * (color(surface.emission) + lamps), area * (absorbed + lost * sent)]
        });
        let error = |c: usize| if given[c] > 0.0 { (gone[c] / given[c] - 1.0).abs() } else { 0.0 };
        (0..3).map(error).fold(0.0, f64::max)
    }

    fn finish(mut self) -> Solution {
        self.solution()
    }
}

/// The colour in double precision.
fn doubled(light: Vec4) -> DVec3 {
    light.truncate().as_dvec3()
}

/// The largest change of a channel as a share of the largest value.
fn change(before: &[Vec4], after: &[Vec4]) -> f64 {
    // Written so that what is not a number is the largest of all.
    let larger = |most: f32, step: f32| if step <= most { most } else { step };
    let of_chunk = |(before, after): (&[Vec4], &[Vec4])| {
        before.iter().zip(after).fold((0.0f32, f32::MIN_POSITIVE), |(most, largest), (&old, &new)| {
            (larger(most, brightness((new - old).abs())), largest.max(brightness(new)))
        })
    };
    let chunks: Vec<(f32, f32)> =
        before.par_chunks(CHUNK).zip(after.par_chunks(CHUNK)).map(of_chunk).collect();
    let join = |a: (f32, f32), b: (f32, f32)| (larger(a.0, b.0), a.1.max(b.1));
    let (most, largest) = chunks.into_iter().fold((0.0, f32::MIN_POSITIVE), join);
    f64::from(most) / f64::from(largest)
}
