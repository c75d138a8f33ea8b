//! Light that surfaces reflect to a place, found by rays at few places and carried to those between.
//!
//! Reflected light changes slowly but near other surfaces. So it is found where it is asked for first,
//! and a place farther off takes it over if that is near compared to the distance of the surfaces
//! around (irradiance caching: Ward, Rubinstein and Clear 1988), along its gradients (Ward and Heckbert
//! 1992). Rays end on the solution, which is exact enough for what is seen by way of one more
//! reflection; they find what is hidden in part, which links only know on the average.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use rayon::prelude::*;
use senca_math::glam::DVec3;
use senca_math::{Cancelled, Control, LinearRgb};

use super::visible::Blockers;
use super::{Frame, GatherSettings, mix, reflected_along, unit_hash};
use crate::{Occluders, Solution};

/// Reflected light at any place, from places where it was found.
#[derive(Clone, Debug)]
pub(super) struct ReflectedGather<'a> {
    solution: &'a Solution,
    occluders: &'a Occluders,
    rings: u32,
    reach: f64,
    /// Least and largest radius, in world units.
    radii: [f64; 2],
    records: Vec<Record>,
    /// Numbers of the records that may be of use in a cell of a level.
    cells: HashMap<(i32, [i64; 3]), Vec<u32>>,
    /// Levels that have records, ascending; the edge of a cell is this power of two.
    levels: Vec<i32>,
}

/// Light found at a place.
#[derive(Clone, Copy, Debug)]
struct Record {
    place: DVec3,
    normal: DVec3,
    /// How far away what is around is, on harmonic average.
    radius: f64,
    light: DVec3,
    /// How each channel changes when the place moves.
    by_place: [DVec3; 3],
    /// How each channel changes when the normal turns about an axis.
    by_turn: [DVec3; 3],
}

/// What a ray met.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    light: DVec3,
    /// One over the distance.
    nearness: f64,
}

/// The radius of a record is at most this many times the distance of what is nearest.
const NEAREST: f64 = 2.5;

/// Places that are looked at together at least.
const BATCH: usize = 64;

impl<'a> ReflectedGather<'a> {
    /// Nothing found yet. Settings have to be in range.
    pub(super) fn new(solution: &'a Solution, occluders: &'a Occluders, settings: &GatherSettings) -> Self {
        let size = solution.mesh.bounds().diagonal();
        let least = settings.least.unwrap_or(size / 1000.0);
        Self {
            solution,
            occluders,
            rings: settings.rings,
            reach: settings.reach,
            radii: [least / settings.reach, 0.5 * size.max(least / settings.reach)],
            records: Vec::new(),
            cells: HashMap::new(),
            levels: Vec::new(),
        }
    }

    /// Finds light so that it can be carried to each of `places`, which come with their unit normals.
    /// It does not depend on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) fn prepare(
        &mut self,
        places: &[(DVec3, DVec3)],
        blockers: &Blockers<'_>,
        control: &Control<'_>,
    ) -> Result<(), Cancelled> {
        // Far apart from each other first.
        let bits = places.len().next_power_of_two().trailing_zeros();
        let turned =
            (0..1usize << bits).map(|i| if bits == 0 { 0 } else { i.reverse_bits() >> (usize::BITS - bits) });
        let order: Vec<usize> = turned.filter(|&i| i < places.len()).collect();
        let mut next = 0;
        while next < order.len() {
            control.check()?;
            let end = order.len().min(next + BATCH.max(self.records.len() / 4));
            let batch = &order[next..end];
            let found: Vec<Option<Record>> = batch
                .par_iter()
                .map(|&i| {
                    let (place, normal) = places[i];
                    if self.carried(place, normal).is_some() {
                        return None;
                    }
                    Some(self.find(place, normal, blockers.nearest_above(place, normal)))
                })
                .collect();
            for record in found.into_iter().flatten() {
                if self.carried(record.place, record.normal).is_none() {
                    self.insert(record);
                }
            }
            next = end;
        }
        Ok(())
    }

    /// Light that surfaces reflect to a place on a surface with this unit normal: what a white matt
    /// surface would show of it. Found anew where none can be carried there.
    pub(super) fn at(&self, place: DVec3, normal: DVec3) -> LinearRgb {
        let light =
            self.carried(place, normal).unwrap_or_else(|| self.find(place, normal, f64::INFINITY).light);
        LinearRgb::new(light.x as f32, light.y as f32, light.z as f32)
    }

    /// Number of places where light was found.
    pub(super) fn len(&self) -> usize {
        self.records.len()
    }

    /// The mean of what records have to say about a place, by their nearness.
    fn carried(&self, place: DVec3, normal: DVec3) -> Option<DVec3> {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for &level in &self.levels {
            for &number in self.cells.get(&(level, cell(place, level))).into_iter().flatten() {
                let record = &self.records[number as usize];
                let apart = record.apart(place, normal);
                if apart < self.reach {
                    // Falls to nothing where the record ends, so that no border shows.
                    let weight = 1.0 / apart.max(1e-6) - 1.0 / self.reach;
                    sum += weight * record.carried_to(place, normal);
                    weights += weight;
                }
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    fn insert(&mut self, record: Record) {
        let reach = self.reach * record.radius;
        let level = (2.0 * reach).log2().ceil() as i32;
        let [low, high] = [-reach, reach].map(|by| cell(record.place + DVec3::splat(by), level));
        let number = self.records.len() as u32;
        self.records.push(record);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    self.cells.entry((level, [x, y, z])).or_default().push(number);
                }
            }
        }
        if let Err(place) = self.levels.binary_search(&level) {
            self.levels.insert(place, level);
        }
    }

    /// Light at a place by rays: rings of equal weight, each of equal parts. `nearest` is how far away
    /// the nearest surface is, which rays may miss.
    fn find(&self, place: DVec3, normal: DVec3, nearest: f64) -> Record {
        let frame = Frame::of(normal);
        let (rings, parts) = (self.rings as usize, 3 * self.rings as usize);
        let key = place.to_array().iter().fold(0, |key, v| mix(key ^ v.to_bits()));
        let sample = |i: usize| {
            let bits = key.wrapping_add(i as u64);
            let [ring, part] = [(i / parts, unit_hash(bits)), (i % parts, unit_hash(!bits))]
                .map(|(i, jitter)| i as f64 + jitter);
            self.look(place, frame.cosine_weighted(ring / rings as f64, part / parts as f64))
        };
        let samples: Vec<Sample> = (0..rings * parts).map(sample).collect();
        let count = samples.len() as f64;
        let light = samples.iter().map(|s| s.light).sum::<DVec3>() / count;
        let nearness = samples.iter().map(|s| s.nearness).sum::<f64>() / count;
        let seen = samples.iter().map(|s| s.nearness).fold(0.0, f64::max).recip();
        // Towards a corner light grows faster than along a straight line.
        let near = nearness.recip().min(NEAREST * nearest.min(seen));
        // What is so near that light is carried across it says nothing about a slope.
        let trust = (near / self.radii[0]).min(1.0);
        let by_place = gradient(&samples, rings, &frame).map(|slope| slope * trust);
        let mut radius = near;
        for (value, slope) in light.to_array().iter().zip(&by_place) {
            // Where light changes fast it is not carried far.
            radius = radius.min(value / slope.length());
        }
        let radius = if radius.is_finite() { radius } else { self.radii[1] };
        Record {
            place,
            normal,
            radius: radius.clamp(self.radii[0], self.radii[1]),
            light,
            by_place,
            by_turn: turning(&samples, rings, &frame),
        }
    }

    fn look(&self, place: DVec3, direction: DVec3) -> Sample {
        let Some(met) = reflected_along(self.solution, self.occluders, place, direction) else {
            return Sample::default();
        };
        let [r, g, b] = met.light.to_array().map(f64::from);
        Sample { light: DVec3::new(r, g, b), nearness: 1.0 / met.distance.max(1e-6 * self.radii[0]) }
    }
}

impl Record {
    /// How far off a place is; from `reach` on too far (Ward et al. 1988, equation 3).
    fn apart(&self, place: DVec3, normal: DVec3) -> f64 {
        let way = place - self.place;
        // What lies before the record may hide what the place sees.
        if way.dot(self.normal + normal) < -0.02 * self.radius {
            return f64::INFINITY;
        }
        way.length() / self.radius + (1.0 - self.normal.dot(normal)).max(0.0).sqrt()
    }

    fn carried_to(&self, place: DVec3, normal: DVec3) -> DVec3 {
        let (way, turn) = (place - self.place, self.normal.cross(normal));
        let change = |channel: usize| self.by_place[channel].dot(way) + self.by_turn[channel].dot(turn);
        (self.light + DVec3::new(change(0), change(1), change(2))).max(DVec3::ZERO)
    }
}

/// How light changes when the place moves (Ward and Heckbert 1992, section 3), of light as shown: rings
/// move against each other along the middle of a part, parts against each other across their border.
fn gradient(samples: &[Sample], rings: usize, frame: &Frame) -> [DVec3; 3] {
    let parts = samples.len() / rings;
    let step = TAU / parts as f64;
    let mut sum = [DVec3::ZERO; 3];
    for part in 0..parts {
        let before = (part + parts - 1) % parts;
        let along = frame.around(step * (part as f64 + 0.5));
        let across = frame.around(step * part as f64 + 0.5 * PI);
        for ring in 0..rings {
            let here = samples[ring * parts + part];
            let [low, high] = [ring, ring + 1].map(|i| (i as f64 / rings as f64).sqrt());
            let beside = samples[ring * parts + before];
            let move_across = (high - low) * here.nearness.max(beside.nearness);
            add_change(&mut sum, across * move_across, here.light - beside.light);
            if ring > 0 {
                let inner = samples[(ring - 1) * parts + part];
                let move_along = step * low * (1.0 - low * low) * here.nearness.max(inner.nearness);
                add_change(&mut sum, along * move_along, here.light - inner.light);
            }
        }
    }
    sum.map(|slope| slope / PI)
}

/// How light changes when the normal turns (Ward and Heckbert 1992, section 2), of light as shown.
fn turning(samples: &[Sample], rings: usize, frame: &Frame) -> [DVec3; 3] {
    let parts = samples.len() / rings;
    let mut sum = [DVec3::ZERO; 3];
    for (i, sample) in samples.iter().enumerate() {
        let squared = ((i / parts) as f64 + 0.5) / rings as f64;
        let tangent = (squared / (1.0 - squared)).sqrt();
        let axis = frame.around(TAU * ((i % parts) as f64 + 0.5) / parts as f64 + 0.5 * PI);
        add_change(&mut sum, axis * tangent, sample.light);
    }
    sum.map(|slope| slope / samples.len() as f64)
}

fn add_change(sum: &mut [DVec3; 3], direction: DVec3, light: DVec3) {
    for (sum, value) in sum.iter_mut().zip(light.to_array()) {
        *sum += direction * value;
    }
}

/// The cell of a level that holds a place.
fn cell(place: DVec3, level: i32) -> [i64; 3] {
    let scale = 2f64.powi(-level);
    (place * scale).floor().to_array().map(|v| v as i64)
}
