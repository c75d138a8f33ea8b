//! Bodies put together from closed bodies: constructive solid geometry along a ray.
//!
//! 1. Every leaf's crossings with the whole line, in its own space, are moments at which the line enters or
//!    leaves it. All moments of all leaves are sorted.
//! 2. Going through them, each operation knows which of its bodies the line is in, and whether that makes
//!    it in or out. Where the whole changes between in and out, its surface is crossed.
//! 3. Moments too near to each other to be told apart, as where faces of two bodies coincide, are taken
//!    together, in the order of the leaves: what two such faces make of each other does not depend on
//!    rounding, and there are no skins without thickness.
//!
//! Source: Roth 1982; tolerance and order of coincident faces are our own.

mod build;

use senca_math::Aabb;
use senca_math::glam::{DMat3, DMat4, DVec3};
use smallvec::SmallVec;

use super::cuboid::box_ends;
use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

pub use build::{CsgBuilder, CsgError};

/// Share of the lengths in play up to which two moments cannot be told apart.
const COINCIDENT: f64 = 1e-10;

/// What an operation makes of its bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// What is in any of them.
    Union,
    /// What is in all of them.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
}

/// Where a body stands in the tree: its operation, and whether it is the first body there.
#[derive(Clone, Copy, Debug)]
struct Place {
    node: u32,
    first: bool,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    operation: Operation,
    bodies: u32,
    /// `None` for the whole.
    place: Option<Place>,
}

#[derive(Debug)]
struct Leaf<'s> {
    surface: Box<dyn Intersect + 's>,
    object_from_leaf: DMat4,
    leaf_from_object: DMat4,
    normals: DMat3,
    /// Box around it in the space of the whole; endless for half-spaces.
    bounds: Aabb,
    place: Place,
    /// Whether it is taken away an odd number of times, so that its outside is the inside of the whole.
    subtracted: bool,
    /// Whether it is everything on the far side of a plane's normal.
    half_space: bool,
    /// -1 where its placement is a reflection.
    orientation: f64,
}

/// A body made of closed bodies.
///
/// The part of a crossing tells the leaf, from left to right, and the leaf's own part; the surface
/// number is that of the leaf.
#[derive(Debug)]
pub struct CsgBody<'s> {
    leaves: Vec<Leaf<'s>>,
    nodes: Vec<Node>,
    bounds: Aabb,
    /// Bits of a part that are the leaf's own.
    part_bits: u32,
}

/// The line enters or leaves a leaf.
#[derive(Clone, Copy, Debug)]
struct Moment {
    crossing: Crossing,
    leaf: u32,
}

/// Which bodies of an operation the line is in.
#[derive(Clone, Copy, Debug, Default)]
struct Within {
    first: bool,
    others: u32,
}

impl Node {
    fn is_inside(&self, within: Within) -> bool {
        match self.operation {
            Operation::Union => within.first || within.others > 0,
            Operation::Intersection => within.first && within.others + 1 == self.bodies,
            Operation::Difference => within.first && within.others == 0,
        }
    }
}

/// What the line is in, on its way.
struct State {
    leaves: SmallVec<[bool; 16]>,
    nodes: SmallVec<[Within; 16]>,
    whole: bool,
}

impl State {
    /// In nothing at all.
    fn outside(body: &CsgBody<'_>) -> Self {
        Self {
            leaves: SmallVec::from_elem(false, body.leaves.len()),
            nodes: SmallVec::from_elem(Within::default(), body.nodes.len()),
            whole: false,
        }
    }

    /// Enters or leaves a leaf, and every operation that changes with it.
    fn toggle(&mut self, body: &CsgBody<'_>, leaf: u32) {
        let mut inside = !self.leaves[leaf as usize];
        self.leaves[leaf as usize] = inside;
        let mut place = Some(body.leaves[leaf as usize].place);
        while let Some(Place { node, first }) = place {
            let (within, node) = (&mut self.nodes[node as usize], &body.nodes[node as usize]);
            let before = node.is_inside(*within);
            if first {
                within.first = inside;
            } else if inside {
                within.others += 1;
            } else {
                within.others -= 1;
            }
            inside = node.is_inside(*within);
            if inside == before {
                return;
            }
            place = node.place;
        }
        self.whole = inside;
    }
}

impl CsgBody<'_> {
    /// The leaf and its own part that a crossing's part stands for.
    fn decoded(&self, part: u32) -> (&Leaf<'_>, u32, u32) {
        let (leaf, own) = (u64::from(part) >> self.part_bits, u64::from(part) & ((1 << self.part_bits) - 1));
        let leaf = (leaf as usize).min(self.leaves.len() - 1);
        (&self.leaves[leaf], leaf as u32, own as u32)
    }

    /// All moments up to the end of the ray, sorted, and the state long before them.
    fn moments(&self, ray: &Ray, counters: &mut Counters) -> (SmallVec<[Moment; 16]>, State) {
        let mut state = State::outside(self);
        let mut moments: SmallVec<[Moment; 16]> = SmallVec::new();
        let mut crossings = Crossings::new();
        for (i, leaf) in self.leaves.iter().enumerate() {
            if !leaf.half_space && !may_matter(&leaf.bounds, ray) {
                counters.nodes += 1;
                continue;
            }
            let line = Ray { t_min: f64::NEG_INFINITY, ..ray.transformed(&leaf.leaf_from_object) };
            if leaf.half_space && starts_below(&line) {
                state.toggle(self, i as u32);
            }
            crossings.clear();
            leaf.surface.crossings(&line, counters, &mut crossings);
            moments.extend(crossings.iter().map(|&crossing| Moment { crossing, leaf: i as u32 }));
        }
        moments.sort_by(|a, b| a.crossing.t.total_cmp(&b.crossing.t));
        (moments, state)
    }

    /// Calls `meet` with the crossings of the whole's surface that the ray admits, ascending, until it
    /// returns true.
    fn each_crossing(&self, ray: &Ray, counters: &mut Counters, mut meet: impl FnMut(Crossing) -> bool) {
        if !ray.is_valid() {
            return;
        }
        let (mut moments, mut state) = self.moments(ray, counters);
        let reach = ray.origin.length() / ray.direction.length();
        let mut rest = &mut moments[..];
        while let Some(first) = rest.first() {
            let last = first.crossing.t + COINCIDENT * (first.crossing.t.abs() + reach);
            let count = rest.iter().take_while(|moment| moment.crossing.t <= last).count().max(1);
            let (together, later) = rest.split_at_mut(count);
            together.sort_by_key(|moment| moment.leaf);
            if let Some(crossing) = self.passed(together, &mut state)
                && ray.admits(crossing.t)
                && meet(crossing)
            {
                return;
            }
            rest = later;
        }
    }

    /// Goes through moments that count as one. If the whole is different after them, the first that made
    /// it so stands for all.
    fn passed(&self, together: &[Moment], state: &mut State) -> Option<Crossing> {
        let before = state.whole;
        let mut chosen = None;
        for moment in together {
            let was = state.whole;
            state.toggle(self, moment.leaf);
            if state.whole != was && state.whole != before && chosen.is_none() {
                chosen = Some(*moment);
            }
        }
        let Moment { crossing, leaf } = chosen.filter(|_| state.whole != before)?;
        let part = (u64::from(leaf) << self.part_bits | u64::from(crossing.part)) as u32;
        Some(Crossing { part, ..crossing })
    }
}

/// Whether the line is in a half-space y < 0 in the beginning.
fn starts_below(line: &Ray) -> bool {
    if line.direction.y == 0.0 { line.origin.y < 0.0 } else { line.direction.y > 0.0 }
}

/// Whether a body within `bounds` can change what the ray is in between its limits. One that lies wholly
/// before or after them is left as often as it is entered.
fn may_matter(bounds: &Aabb, ray: &Ray) -> bool {
    // A hair wider, so that faces in the plane of a side are not taken for missed.
    let slack = DVec3::splat(1e-9 * bounds.diagonal());
    let ends = box_ends(bounds.min - slack, bounds.max + slack, ray);
    ends.is_some_and(|[enter, leave]| enter.0 < ray.t_max && leave.0 > ray.t_min)
}

impl Intersect for CsgBody<'_> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let mut nearest = None;
        self.each_crossing(ray, counters, |crossing| {
            nearest = Some(crossing);
            true
        });
        nearest
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        self.each_crossing(ray, counters, |crossing| {
            out.push(crossing);
            false
        });
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let (leaf, number, part) = self.decoded(crossing.part);
        let line = ray.transformed(&leaf.leaf_from_object);
        let met = leaf.surface.surface_point(&line, &Crossing { part, ..*crossing });
        // Where a body is taken away its inside is the outside of the whole.
        let side = if leaf.subtracted { -1.0 } else { 1.0 };
        let turned = |normal: DVec3| side * (leaf.normals * normal).normalize_or(DVec3::Y);
        SurfacePoint {
            point: leaf.object_from_leaf.transform_point3(met.point),
            normal: turned(met.normal),
            shading_normal: turned(met.shading_normal),
            tangent: leaf.object_from_leaf.transform_vector3(met.tangent),
            handedness: side * leaf.orientation * met.handedness,
            surface: number,
            ..met
        }
    }

    fn precision(&self) -> f64 {
        self.leaves.iter().map(|leaf| leaf.surface.precision()).fold(1e-10, f64::max)
    }

    fn memory_bytes(&self) -> usize {
        let leaves: usize = self.leaves.iter().map(|leaf| leaf.surface.memory_bytes()).sum();
        leaves + size_of_val(&*self.leaves) + size_of_val(&*self.nodes)
    }

    fn is_closed(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests;
