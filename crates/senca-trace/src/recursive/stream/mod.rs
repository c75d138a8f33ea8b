//! Many rays at once: the fast twin of the tracer that follows tree after tree.
//!
//! The rays of a batch of samples are followed level by level. Of all rays of a level, eight at a time,
//! first what they meet is found ([`forms`]), then they are sorted by what that is, and what the places
//! there send back and send on is computed ([`shade`]), the latter as the rays of the next level. Rays
//! towards lights are gathered and looked at together; surfaces of patches are met by 64 rays at a time
//! ([`patches`]). It is the same algorithm in the same precision as [`Tracer::sample`]'s, so results differ by rounding only,
//! and the same samples are taken.
//!
//! Rays that meet what is not done here, such as glass or a blended surface, are handed over to the
//! other tracer, with all that comes of them. That depends on the scene alone, and no ray's result
//! depends on the rays beside it, so neither the picture's tiles nor threads matter.
//!
//! Sources: Wald et al. 2001 on packets; Wald et al. 2007 and Áfra et al. 2016 on sorted streams.

mod forms;
mod looks;
mod patches;
mod power;
mod rays;
mod shade;
#[cfg(test)]
mod tests;

use fearless_simd::{Level, Simd, dispatch, i64x8, mask32x8, prelude::*, u32x8};
use senca_math::glam::{DVec3, DVec4};
use senca_math::{LinearRgb, ViewKind};

use super::follow::{MAX_RAYS_PER_SAMPLE, Pending, RayKind, Work};
use super::media::Media;
use super::{Blockers, Tracer};
use crate::intersect::RayBlock;
use crate::lanes::{F, LANES, V, eight, first_lanes};
use crate::{Accel, Hit, Object, SamplePlace, TraceCounts};
use forms::{Forms, Kind, NO_HIT, Rank, Sight, Through};
use looks::{Lamp, Look, Way};
use rays::{Packet, Rays};

/// Groups of rays by what they meet: nothing, a ball, a sheet, a patch, or anything else.
const GROUPS: usize = 5;
const LEAVING: usize = 0;
const BALLS: usize = 1;
const SHEETS: usize = 2;
const PATCHES: usize = 3;
const GENERAL: usize = 4;

/// Lists of rays towards lights.
const SHADOW_LISTS: usize = 8;

/// Rays towards lights that are kept before they are looked at.
const MOST_SHADOWS: usize = 1024;

/// Samples that are followed together. With fewer, groups of deep rays are seldom full; with more, rows leave the
/// near cache.
const BATCH: usize = 1024;

/// Most stretches of ranks that are compared with each rank.
const MOST_STRETCHES: usize = 8;

/// Most surfaces that packets of rays are tested against one after the other.
const MOST_FORMS: usize = 48;

/// The scene as many rays at once see it.
#[derive(Debug)]
pub(super) struct Stream {
    level: Level,
    forms: Forms,
    looks: Vec<Look>,
    /// Group of the rays that meet what has a rank, by rank + 1.
    groups: Vec<u8>,
    /// The same as stretches of ranks: the first and the last, and the group.
    stretches: Vec<(i64, i64, usize)>,
    lamps: Vec<Lamp>,
    /// The eye, where rays without a lens start.
    eye: Option<Sight>,
    /// Whether there are few enough surfaces to test packets against all.
    is_flat: bool,
    /// Whether shadow rays meet surfaces that have to be asked how much they block.
    asks: bool,
}

/// The rows of numbers of a batch. Kept from one batch to the next.
#[derive(Debug, Default)]
pub(super) struct Desk {
    rays: Rays,
    /// Rays of the next level.
    next: Rays,
    /// Rays that go on behind a surface that they do not see.
    again: Rays,
    /// Of each ray, where it meets something, the rank of that, or -1, and the hit, where it is of
    /// something that has no rank of its own.
    t: Vec<f64>,
    rank: Vec<i64>,
    hits: Vec<Hit>,
    /// Numbers of the rays by what they meet.
    lists: [Vec<u32>; GROUPS],
    lengths: [usize; GROUPS],
    /// Numbers of the rays that are handed over.
    handed: Vec<u32>,
    /// Rays towards each light, of which t_min is where they end and the weight the light that they bring.
    /// Lights beyond [`SHADOW_LISTS`] share.
    shadows: Vec<Rays>,
    /// Those that look for patches together.
    block: RayBlock,
    /// What each sample has gathered, those of the batch behind those before it.
    sums: Vec<[f32; 4]>,
    first_sum: usize,
}

impl Desk {
    fn begin(&mut self, count: usize) {
        for rays in [&mut self.rays, &mut self.next, &mut self.again] {
            rays.clear(count);
        }
        self.shadows.resize_with(SHADOW_LISTS, Rays::default);
        for list in &mut self.lists {
            list.resize(list.len().max(count + LANES), 0);
        }
        if self.t.len() < count + LANES {
            self.t.resize(count + LANES, 0.0);
            self.rank.resize(count + LANES, 0);
            self.hits.resize(count + LANES, NO_HIT);
        }
        self.first_sum = self.sums.len();
        self.sums.resize(self.first_sum + count, [0.0; 4]);
    }

    #[inline(always)]
    fn add(&mut self, slot: usize, light: LinearRgb, alpha: f32) {
        let sum = &mut self.sums[self.first_sum + slot];
        *sum = [sum[0] + light.r, sum[1] + light.g, sum[2] + light.b, sum[3] + alpha];
    }
}

/// A pass over the rays of one level.
struct Pass<'a> {
    nest: u32,
    places: &'a [SamplePlace],
    desk: &'a mut Desk,
    counts: &'a mut TraceCounts,
}

impl Stream {
    /// For the rays of `tracer`; `None` where they have to be followed one by one: with another
    /// accelerator than the default, so that it can be compared, with an epsilon of the caller's, and in
    /// a transparent body.
    pub(super) fn of(tracer: &Tracer<'_>) -> Option<Self> {
        let world = tracer.world;
        let any_body = tracer.bodies.iter().any(|body| *body);
        let starts_inside = match tracer.view.kind {
            ViewKind::Central { .. } => tracer.media_at_eye.current().is_some(),
            ViewKind::Parallel { .. } => any_body,
        };
        if world.accel() != Accel::Bvh || world.epsilon().is_some() || starts_inside {
            return None;
        }
        let forms = Forms::of(world.objects());
        let materials = tracer.materials.len();
        let looks: Vec<Look> = (0..materials).map(|material| Look::of(tracer, material)).collect();
        let group = |rank: &Rank| match (rank.kind, looks[rank.material].way) {
            (Kind::Ball, Way::Constant) => BALLS,
            (Kind::Sheet, Way::Constant | Way::Textured) => SHEETS,
            (Kind::Patches, Way::Constant) if is_of_one(&world.objects()[rank.object as usize]) => PATCHES,
            _ => GENERAL,
        };
        let groups: Vec<u8> =
            std::iter::once(LEAVING).chain(forms.ranks.iter().map(group)).map(|group| group as u8).collect();
        let lamps = (0..tracer.lights.len()).map(|light| Lamp::of(tracer, &forms, light)).collect();
        let is_flat = forms.len() <= MOST_FORMS;
        let eye = match tracer.view.kind {
            ViewKind::Central { eye_world } if is_flat => Some(forms.seen_from(eye_world)),
            _ => None,
        };
        Some(Self {
            level: Level::new(),
            is_flat,
            stretches: stretches_of(&groups),
            groups,
            forms,
            looks,
            lamps,
            eye,
            asks: tracer.blockers != Blockers::All,
        })
    }

    /// Whether rays towards lights are looked at as soon as they are made, but for those near patches.
    fn shades_at_once(&self) -> bool {
        self.is_flat && !self.asks
    }
}

/// Ranks that follow each other and have the same group; the rank of nothing is -1.
fn stretches_of(groups: &[u8]) -> Vec<(i64, i64, usize)> {
    let mut first = -1;
    let stretch = |of: &[u8]| {
        let stretch = (first, first + of.len() as i64 - 1, usize::from(of[0]) % GROUPS);
        first += of.len() as i64;
        stretch
    };
    groups.chunk_by(|a, b| a == b).map(stretch).collect()
}

impl Tracer<'_> {
    /// [`Tracer::sample`] for many places; `out` gets one result for each, in their order.
    pub(super) fn sample_all(&self, places: &[SamplePlace], work: &mut Work, out: &mut Vec<[f32; 4]>) {
        let Some(stream) = &self.stream else {
            out.extend(places.iter().map(|place| self.sample(place, work)));
            return;
        };
        let mut desk = std::mem::take(&mut work.desk);
        std::mem::swap(&mut desk.sums, out);
        desk.sums.reserve(places.len());
        for places in places.chunks(BATCH) {
            self.batch(stream, places, work, &mut desk);
        }
        std::mem::swap(&mut desk.sums, out);
        work.desk = desk;
    }

    fn batch(&self, stream: &Stream, places: &[SamplePlace], work: &mut Work, desk: &mut Desk) {
        desk.begin(places.len());
        dispatch!(stream.level, simd => self.primaries(simd, places, desk));
        work.counts.rays.primary += places.len() as u64;
        for nest in 0..MAX_RAYS_PER_SAMPLE {
            while desk.rays.len() > 0 {
                let pass = Pass { nest, places, desk: &mut *desk, counts: &mut work.counts };
                dispatch!(stream.level, simd => self.pass(simd, stream, pass));
                self.hand_over(nest, places, desk, work);
                std::mem::swap(&mut desk.rays, &mut desk.again);
                desk.again.clear(places.len());
            }
            std::mem::swap(&mut desk.rays, &mut desk.next);
            desk.next.clear(places.len());
            if desk.rays.len() == 0 {
                return;
            }
            work.counts.rays.reflected += desk.rays.len() as u64;
        }
    }

    /// The rays through the places.
    #[inline(always)]
    fn primaries<S: Simd>(&self, simd: S, places: &[SamplePlace], desk: &mut Desk) {
        for (number, eight) in places.chunks(LANES).enumerate() {
            let place = |lane: usize| &eight[lane.min(eight.len() - 1)];
            let there = first_lanes(simd, eight.len());
            let one = F::splat(simd, 1.0);
            let slot = F::load_array(simd, eight!(lane => (number * LANES + lane) as f64));
            let rays = if self.rays.has_lens() {
                eight_rays(simd, |lane| self.rays.sample(place(lane)))
            } else {
                let x = F::load_array(simd, eight!(lane => place(lane).x));
                let y = F::load_array(simd, eight!(lane => place(lane).y));
                self.through(simd, x, y)
            };
            let [origin, direction] = rays;
            let distance = match self.view.kind {
                ViewKind::Central { .. } => F::splat(simd, 0.0),
                ViewKind::Parallel { .. } => self.depth(simd, origin),
            };
            // Rays without a direction meet nothing.
            let is_ray = direction.dot(direction).simd_gt(F::splat(simd, 0.5));
            let t_min = is_ray.select(F::splat(simd, 0.0), F::splat(simd, f64::INFINITY));
            let weight = [one; 3];
            desk.rays.push(there, &Packet { origin, direction, t_min, weight, distance, slot });
        }
    }

    /// [`crate::PrimaryRays::through`] for eight places.
    #[inline(always)]
    fn through<S: Simd>(&self, simd: S, x: F<S>, y: F<S>) -> [V<S>; 2] {
        let m = self.rays.world_from_pixel();
        let w = combined(simd, m.row(3), x, y);
        let near = V {
            x: combined(simd, m.row(0), x, y) / w,
            y: combined(simd, m.row(1), x, y) / w,
            z: combined(simd, m.row(2), x, y) / w,
        };
        match self.view.kind {
            ViewKind::Central { eye_world } => {
                let eye = V::splat(simd, eye_world);
                let way = near.sub(eye);
                [eye, way.times(F::splat(simd, 1.0) / way.dot(way).sqrt())]
            }
            ViewKind::Parallel { direction_world } => [near, V::splat(simd, direction_world)],
        }
    }

    /// Distance of places in front of the eye of a parallel view.
    #[inline(always)]
    fn depth<S: Simd>(&self, simd: S, place: V<S>) -> F<S> {
        let row = self.view.view_from_world.row(2);
        -(V::splat(simd, row.truncate()).dot(place) + F::splat(simd, row.w))
    }

    /// Everything that the rays of the desk bring by themselves, and the rays that come of them.
    #[inline(always)]
    fn pass<S: Simd>(&self, simd: S, stream: &Stream, mut pass: Pass<'_>) {
        simd.vectorize(
            #[inline(always)]
            || self.find(simd, stream, &mut pass),
        );
        simd.vectorize(
            #[inline(always)]
            || self.sort(simd, stream, &mut pass),
        );
        self.leave_stream(&mut pass);
        simd.vectorize(
            #[inline(always)]
            || self.balls(simd, stream, &mut pass),
        );
        simd.vectorize(
            #[inline(always)]
            || self.sheets(simd, stream, &mut pass),
        );
        simd.vectorize(
            #[inline(always)]
            || self.patches(simd, stream, &mut pass),
        );
        simd.vectorize(
            #[inline(always)]
            || self.general(simd, stream, &mut pass),
        );
        self.cast_shadows(simd, stream, &mut pass);
    }

    /// What the rays meet.
    #[inline(always)]
    fn find<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        if !stream.is_flat {
            return self.find_one_by_one(stream, pass);
        }
        let Desk { rays, t, rank, hits, .. } = &mut *pass.desk;
        let counters = &mut pass.counts.work;
        let through = match &stream.eye {
            Some(eye) if pass.nest == 0 && !self.rays.has_lens() => Through::From(eye),
            _ => Through::Anywhere,
        };
        for first in (0..rays.len()).step_by(LANES) {
            let (packet, live) = rays.load(simd, first);
            let hits = &mut hits[first..][..LANES];
            let found =
                stream.forms.closest(simd, self.world.objects(), through, &packet, live, hits, counters);
            found.t.store_slice(&mut t[first..][..LANES]);
            let found: i64x8<S> = found.rank.to_int();
            found.store_slice(&mut rank[first..][..LANES]);
        }
        self.find_patches(simd, stream, pass);
    }

    /// The same where there are many surfaces.
    fn find_one_by_one(&self, stream: &Stream, pass: &mut Pass<'_>) {
        let Desk { rays, t, rank, hits, .. } = &mut *pass.desk;
        for number in 0..rays.len() {
            let hit = self.world.closest(&rays.ray(number), &mut pass.counts.work);
            (t[number], rank[number]) = match hit {
                None => (f64::INFINITY, -1),
                Some(hit) => {
                    hits[number] = hit;
                    (hit.crossing.t, i64::from(stream.forms.rank_of(&hit)))
                }
            };
        }
    }

    /// Sorts rays by what they meet.
    #[inline(always)]
    fn sort<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let Desk { rays, rank, lists, .. } = &mut *pass.desk;
        let count = rays.len();
        let mut lengths = [0; GROUPS];
        if stream.stretches.len() > MOST_STRETCHES {
            for (number, rank) in rank[..count].iter().enumerate() {
                let group = usize::from(stream.groups[(*rank + 1) as usize]) % GROUPS;
                lists[group][lengths[group]] = number as u32;
                lengths[group] += 1;
            }
            pass.desk.lengths = lengths;
            return;
        }
        for first in (0..count).step_by(LANES) {
            let ranks = i64x8::from_slice(simd, &rank[first..][..LANES]);
            let live = first_lanes(simd, count - first).to_bitmask();
            let mut members = [0; GROUPS];
            for &(low, high, group) in &stream.stretches {
                let within = ranks.simd_ge(i64x8::splat(simd, low)) & ranks.simd_le(i64x8::splat(simd, high));
                members[group % GROUPS] |= within.to_bitmask() & live;
            }
            let numbers =
                u32x8::splat(simd, first as u32) + u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]);
            for group in 0..GROUPS {
                let members = members[group];
                if members != 0 {
                    let own = numbers.compress(mask32x8::from_bitmask(simd, members));
                    own.store_slice(&mut lists[group][lengths[group]..][..LANES]);
                    lengths[group] += members.count_ones() as usize;
                }
            }
        }
        pass.desk.lengths = lengths;
    }

    /// Rays that see nothing but the background.
    fn leave_stream(&self, pass: &mut Pass<'_>) {
        let list = std::mem::take(&mut pass.desk.lists[LEAVING]);
        let covered = if self.sky.is_transparent() { 0.0 } else { 1.0 };
        if let Some(color) = self.sky.even() {
            // What the eye sees at once comes with all of its light.
            let of_eye = pass.nest == 0;
            let alpha = if of_eye { 1.0 } else { 0.0 };
            for &number in &list[..pass.desk.lengths[LEAVING]] {
                let (slot, weight, _) = pass.desk.rays.leaving(number as usize);
                pass.desk.add(slot, if of_eye { color } else { weight * color }, alpha);
            }
            pass.desk.lists[LEAVING] = list;
            return;
        }
        for &number in &list[..pass.desk.lengths[LEAVING]] {
            let (slot, weight, direction) = pass.desk.rays.leaving(number as usize);
            let (seen, alpha) = match pass.nest {
                0 => (self.sky.in_row(pass.places[slot].row, direction).unwrap_or(LinearRgb::BLACK), covered),
                _ => (self.sky.towards(direction), 0.0),
            };
            pass.desk.add(slot, weight * seen, alpha);
        }
        pass.desk.lists[LEAVING] = list;
    }

    /// Has the other tracer follow what is not done here.
    fn hand_over(&self, nest: u32, places: &[SamplePlace], desk: &mut Desk, work: &mut Work) {
        let handed = std::mem::take(&mut desk.handed);
        for &number in &handed {
            let (rays, number) = (&desk.rays, number as usize);
            let (slot, weight, _) = rays.leaving(number);
            let pending = Pending {
                ray: rays.ray(number),
                kind: if nest == 0 { RayKind::Primary } else { RayKind::Reflected },
                nest,
                weight,
                open: if nest == 0 { 1.0 } else { 0.0 },
                media: Media::default(),
                distance: rays.distance(number),
                parent: u32::MAX,
            };
            // It counts the ray itself.
            let kind =
                if nest == 0 { &mut work.counts.rays.primary } else { &mut work.counts.rays.reflected };
            *kind -= 1;
            let [r, g, b, alpha] = self.subtree(pending, nest, &places[slot], work);
            desk.add(slot, LinearRgb::new(r, g, b), alpha);
        }
        desk.handed = handed;
        desk.handed.clear();
    }
}

/// Whether all of an object has the same material.
fn is_of_one(object: &Object<'_>) -> bool {
    object.materials.iter().all(|material| *material == object.materials[0])
}

/// A row of a matrix times places (x, y, 0, 1).
#[inline(always)]
fn combined<S: Simd>(simd: S, row: DVec4, x: F<S>, y: F<S>) -> F<S> {
    F::splat(simd, row.x) * x + F::splat(simd, row.y) * y + F::splat(simd, row.w)
}

/// Eight rays' origins and directions.
#[inline(always)]
fn eight_rays<S: Simd>(simd: S, ray: impl Fn(usize) -> crate::Ray) -> [V<S>; 2] {
    let rays: [crate::Ray; LANES] = eight!(lane => ray(lane));
    let lanes = |of: fn(&crate::Ray) -> DVec3| V {
        x: F::load_array(simd, eight!(lane => of(&rays[lane]).x)),
        y: F::load_array(simd, eight!(lane => of(&rays[lane]).y)),
        z: F::load_array(simd, eight!(lane => of(&rays[lane]).z)),
    };
    [lanes(|ray| ray.origin), lanes(|ray| ray.direction)]
}
