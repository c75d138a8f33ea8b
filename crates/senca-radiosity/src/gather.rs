//! Light at single places, for pictures that are to stand beside those of a path tracer.
//!
//! Elements are too coarse for the borders of shadows. So what arrives at a place is gathered once more
//! there ([`Gather`]), in three parts that are known in different ways:
//!
//! 1. Emitters: the share of the hemisphere that each takes up, by Lambert's formula. What is in between
//!    is cut out of it, so that half-shadows have no noise ([`visible`]); only where much is in between,
//!    or glass, rays to cells of the emitter tell how much of it is seen.
//! 2. Lamps without extent, and the sky: by rays ([`DirectLight`]).
//! 3. What surfaces reflect: by rays that end on the solution. As it changes slowly, it is found at few
//!    places, and carried along its gradients to those between ([`cache`]).
//!
//! Source: the second pass of Smits, Arvo and Greenberg 1994, section 5, called local pass or final
//! gather by others.

mod cache;
mod direct;
#[cfg(test)]
mod tests;
mod visible;

use rayon::prelude::*;
use senca_math::glam::DVec3;
use senca_math::{Cancelled, Control, LinearRgb};

use crate::direct::cosine_direction;
use crate::open_parts::has_sight;
use crate::{DirectLight, ElementMesh, Occluders, RadiosityError, Solution};
use cache::ReflectedGather;
use direct::DirectGather;

/// Directions above a place, and as many below, that tell whether it is in a body.
const LOOKS: u32 = 16;

/// How light is gathered at single places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherSettings {
    /// Where an emitter is looked at by rays, they are the square of this, 1 to 64. Default 8.
    pub cells: u32,
    /// Emitters that are looked at one by one, at most; of the others a few are, and stand for the rest.
    /// Default 16.
    pub emitters: usize,
    /// Rays for reflected light per place where it is found are three times the square of this, 2 to 64.
    /// Default 10.
    pub rings: u32,
    /// How far reflected light is carried, as a share of the distance of what is around, in (0, 1].
    /// Default 0.15. Half of it makes about four times the places.
    pub reach: f64,
    /// Reflected light is carried at least so far, in world units, > 0; about what two pixels show is
    /// right. Default `None`: 1/1000 of the diagonal of the scene.
    pub least: Option<f64>,
}

impl Default for GatherSettings {
    fn default() -> Self {
        Self { cells: 8, emitters: 16, rings: 10, reach: 0.15, least: None }
    }
}

impl GatherSettings {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn check(&self) -> Result<(), RadiosityError> {
        let refuse = |name, value, expected| Err(RadiosityError::Setting { name, value, expected });
        if !(1..=64).contains(&self.cells) {
            return refuse("cells of emitters", self.cells.into(), "from 1 to 64");
        }
        if !(2..=64).contains(&self.rings) {
            return refuse("rings of rays", self.rings.into(), "from 2 to 64");
        }
        if !(self.reach > 0.0 && self.reach <= 1.0) {
            return refuse("reach of found light", self.reach, "above 0 and at most 1");
        }
        match self.least {
            Some(least) if !(least > 0.0 && least.is_finite()) => {
                refuse("least reach of found light", least, "above 0 and finite")
            }
            _ => Ok(()),
        }
    }
}

/// Tells the light that arrives at any place. Shared by all threads.
#[derive(Clone, Debug)]
pub struct Gather<'a> {
    solution: &'a Solution,
    occluders: &'a Occluders,
    direct: DirectGather<'a>,
    reflected: ReflectedGather<'a>,
}

impl<'a> Gather<'a> {
    /// From light on surfaces, lamps, and what is in the way.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn new(
        solution: &'a Solution,
        light: &DirectLight,
        occluders: &'a Occluders,
        settings: &GatherSettings,
    ) -> Result<Self, RadiosityError> {
        settings.check()?;
        Ok(Self {
            solution,
            occluders,
            direct: DirectGather::new(&solution.mesh, light, occluders, settings),
            reflected: ReflectedGather::new(solution, occluders, settings),
        })
    }

    /// Finds reflected light so that it can be carried to each of `places`, which come with their unit
    /// normals: where [`Gather::at`] will be asked, or near. Without it light is found anew at each
    /// place. What is found does not depend on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn prepare(&mut self, places: &[(DVec3, DVec3)], control: &Control<'_>) -> Result<(), Cancelled> {
        let blockers = self.direct.blockers();
        let clear = |&(place, normal): &(DVec3, DVec3)| (blockers.clear_of(place, normal), normal);
        let places: Vec<(DVec3, DVec3)> = places.par_iter().with_min_len(256).map(clear).collect();
        self.reflected.prepare(&places, blockers, control)
    }

    /// Number of places where reflected light was found.
    #[must_use]
    pub fn found(&self) -> usize {
        self.reflected.len()
    }

    /// Light that arrives at a place on a surface with this unit normal: what a white matt surface would
    /// show there. Reflected light is carried there if it was prepared. `key` spreads rays; places
    /// should differ in it.
    #[must_use]
    pub fn at(&self, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let place = self.direct.blockers().clear_of(place, normal);
        self.direct.at(place, normal, key) + self.reflected.at(place, normal)
    }

    /// The same with reflected light found anew by `rays` rays.
    #[must_use]
    pub fn afresh(&self, place: DVec3, normal: DVec3, rays: u32, key: u64) -> LinearRgb {
        let place = self.direct.blockers().clear_of(place, normal);
        let reflected = gather_reflected(self.solution, self.occluders, place, normal, rays, key);
        self.direct.at(place, normal, key) + reflected
    }

    /// Whether a place is in a body: whatever direction one looks in there is a surface, and what there is
    /// to be seen of it is its back, or all is dark. `light` is what arrives there.
    #[must_use]
    pub fn is_inside(&self, place: DVec3, light: LinearRgb) -> bool {
        let (mut backs, mut all) = (0, 0);
        for i in 0..LOOKS {
            let d = cosine_direction(i, LOOKS);
            for direction in [DVec3::new(d.x, d.z, d.y), DVec3::new(d.x, -d.z, d.y)] {
                let Some(hit) = self.occluders.closest(place, direction) else { return false };
                backs += u32::from(!hit.front);
                all += 1;
            }
        }
        2 * backs >= all || light == LinearRgb::BLACK
    }
}

/// Thin panes that a ray goes through at most.
const MOST_PANES: usize = 8;

/// Light that surfaces reflect to a place, by rays spread evenly over the hemisphere as the cosine
/// weighs them: what a white matt surface with this unit normal would show of it. Emission does not
/// count. `key` turns the directions.
#[must_use]
fn gather_reflected(
    solution: &Solution,
    occluders: &Occluders,
    place: DVec3,
    normal: DVec3,
    rays: u32,
    key: u64,
) -> LinearRgb {
    let frame = Frame::of(normal);
    let shift = [unit_hash(key), unit_hash(!key)];
    let light = |ray: u32| {
        let ring = (f64::from(ray) + shift[0]) / f64::from(rays);
        let part = (f64::from(ray) * 0.618_033_988_749_895 + shift[1]).fract();
        reflected_along(solution, occluders, place, frame.cosine_weighted(ring, part))
            .map_or(LinearRgb::BLACK, |met| met.light)
    };
    let sum = (0..rays).fold(LinearRgb::BLACK, |sum, ray| sum + light(ray));
    sum * (rays.max(1) as f32).recip()
}

/// Finds the reflected light on all leaves anew, by rays that end on the solution as it is: one more
/// exchange of light, in which what is hidden in part is hidden where it is. Links share that out over
/// whole elements where little light is at stake, which shows where surfaces touch. `rays` are sent
/// from each leaf, from places all over it; 64 is enough for most.
///
/// # Errors
/// [`Cancelled`]; the solution is as before then.
pub fn regather_reflected(
    solution: &mut Solution,
    occluders: &Occluders,
    rays: u32,
    control: &Control<'_>,
) -> Result<(), Cancelled> {
    let leaves: Vec<u32> = solution.mesh.leaves().collect();
    let on_leaf = |&leaf: &u32| {
        control.check()?;
        Ok(gather_on_leaf(solution, occluders, leaf, rays))
    };
    let found: Result<Vec<Option<LinearRgb>>, Cancelled> =
        leaves.par_iter().with_min_len(16).map(on_leaf).collect();
    for (&leaf, light) in leaves.iter().zip(found?) {
        if let Some(light) = light {
            solution.incident[leaf as usize] = solution.direct[leaf as usize] + light;
        }
    }
    solution.pull();
    Ok(())
}

/// Mean of the reflected light over the open part of a leaf, if any is found.
fn gather_on_leaf(solution: &Solution, occluders: &Occluders, leaf: u32, rays: u32) -> Option<LinearRgb> {
    let (shape, normal) = (solution.mesh.shape(leaf), solution.mesh.normal(leaf));
    let frame = Frame::of(normal);
    let key = u64::from(leaf) << 32;
    let is_cut = solution.mesh.elements()[leaf as usize].open < 1.0;
    let light = |ray: u32| {
        let [a, b] = [mix(key | u64::from(ray)), mix(!(key | u64::from(ray)))];
        let unit = |bits: u64| f64::from(bits as u32) / 4_294_967_296.0;
        let ring = (f64::from(ray) + unit(b)) / f64::from(rays);
        let part = (f64::from(ray) * 0.618_033_988_749_895 + unit_hash(key)).fract();
        let place = shape.place(unit(a), unit(a >> 32));
        if is_cut && !has_sight(&solution.mesh, occluders, place, normal) {
            return None;
        }
        let met = reflected_along(solution, occluders, place, frame.cosine_weighted(ring, part));
        Some(met.map_or(LinearRgb::BLACK, |met| met.light))
    };
    let found = (0..rays).filter_map(light);
    let (sum, count) = found.fold((LinearRgb::BLACK, 0u32), |(sum, n), light| (sum + light, n + 1));
    (count > 0).then(|| sum * (count as f32).recip())
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    /// What its surface reflects, through what lets light pass before it; black for backs.
    light: LinearRgb,
    /// In multiples of the direction.
    distance: f64,
}

/// The first surface along a ray that lets no light pass, if any; thin panes are gone through, but not
/// for ever.
fn reflected_along(
    solution: &Solution,
    occluders: &Occluders,
    place: DVec3,
    direction: DVec3,
) -> Option<Met> {
    let (mut from, mut share, mut before) = (place, LinearRgb::WHITE, 0.0);
    for _ in 0..MOST_PANES {
        let hit = occluders.closest(from, direction)?;
        let (point, distance) = (from + hit.t * direction, before + hit.t);
        let surface = solution.mesh.surface(hit.polygon);
        if surface.transmittance == LinearRgb::BLACK {
            if !hit.front {
                return Some(Met { light: LinearRgb::BLACK, distance });
            }
            let leaf = leaf_at(&solution.mesh, hit.polygon, point);
            let light = share * surface.reflectance * solution.incident[leaf as usize];
            return Some(Met { light, distance });
        }
        share = share * surface.transmittance;
        (from, before) = (point, distance);
    }
    None
}

/// Directions around a normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    axes: [DVec3; 3],
}

impl Frame {
    /// Around a unit vector.
    pub(crate) fn of(normal: DVec3) -> Self {
        let [x, y] = [DVec3::X, DVec3::Y].map(|axis| axis.cross(normal));
        let x_axis = if x.length_squared() > y.length_squared() { x } else { y }.normalize_or_zero();
        Self { axes: [x_axis, normal.cross(x_axis), normal] }
    }

    /// The direction at right angles to the normal at this angle from the first axis.
    pub(crate) fn around(&self, angle: f64) -> DVec3 {
        angle.cos() * self.axes[0] + angle.sin() * self.axes[1]
    }

    /// The direction of a point of the unit square, by a map that makes of an even spread one that the
    /// cosine weighs (Malley's).
    pub(crate) fn cosine_weighted(&self, u: f64, v: f64) -> DVec3 {
        u.sqrt() * self.around(std::f64::consts::TAU * v) + (1.0 - u).max(0.0).sqrt() * self.axes[2]
    }
}

/// The leaf of a polygon that holds a place, or comes nearest to it.
pub(crate) fn leaf_at(mesh: &ElementMesh, polygon: u32, place: DVec3) -> u32 {
    let mut element = polygon;
    loop {
        let whole = &mesh.elements()[element as usize];
        let inside = |&part: &u32| {
            if whole.corners().len() == 4 {
                // The nearest middle is the part's own, but for a little where sides are not parallel.
                return -mesh.elements()[part as usize].center.distance_squared(place);
            }
            inside_by(mesh.shape(part).corners(), mesh.normal(part), place)
        };
        let Some(best) = whole.part_numbers().max_by(|a, b| inside(a).total_cmp(&inside(b))) else {
            return element;
        };
        element = best;
    }
}

/// Distance from the nearest edge's line, negative outside.
fn inside_by(corners: &[DVec3], normal: DVec3, place: DVec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let from_edge = |(&a, &b): (&DVec3, &DVec3)| normal.dot((b - a).cross(place - a)) / (b - a).length();
    edges.map(from_edge).fold(f64::INFINITY, f64::min)
}

/// Stirs 64 bits so that each depends on all (the finalizer of SplitMix, Steele et al. 2014).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn unit_hash(bits: u64) -> f64 {
    f64::from((mix(bits) >> 32) as u32) / 4_294_967_296.0
}
