//! Rays that look for patches together, and what they found so far.

use fearless_simd::{Simd, f32x16, prelude::*};
use senca_math::glam::{DVec2, DVec3};

use super::hierarchy::SingleRay;
use super::search::{Hit, LocalRay, SLACK};
use super::together::Met;
use crate::lanes::{F, LANES, M, V, bits_of, eight, lanes_of};
use crate::{Crossing, Ray};

/// Rays of a block.
pub(crate) const BLOCK: usize = 64;

/// Rays that are tested against boxes and cells at once.
pub(super) const WIDE: usize = 16;

/// Up to [`BLOCK`] rays in object space, in eights, and their nearest hits.
#[derive(Clone, Debug)]
pub(crate) struct RayBlock {
    /// Origin, direction, and the limits of t.
    rays: [[f64; BLOCK]; 8],
    /// A bit for each ray that there is.
    live: u64,
    /// The same lines in normalized space: see [`LocalRay`]; origin, direction, start, t per distance.
    lines: [[f64; BLOCK]; 8],
    /// [`SingleRay`] of each, and the inverse of its direction.
    pub(super) single: [[f32; BLOCK]; ROWS],
    /// Nearest hits so far: t, u, v.
    found: [[f64; BLOCK]; 3],
    parts: [u32; BLOCK],
    hits: u64,
    /// Room for rays that wait for Newton's method.
    pub(super) met: Option<Box<Met>>,
}

/// Rows of single precision: origin, inverse direction, first distance, last distance, direction.
pub(super) const ROWS: usize = 11;
pub(super) const INVERSE: usize = 3;
pub(super) const NEAR: usize = 6;
pub(super) const FAR: usize = 7;
pub(super) const DIRECTION: usize = 8;

impl Default for RayBlock {
    fn default() -> Self {
        Self {
            rays: [[0.0; BLOCK]; 8],
            live: 0,
            lines: [[0.0; BLOCK]; 8],
            single: [[0.0; BLOCK]; ROWS],
            found: [[0.0; BLOCK]; 3],
            parts: [0; BLOCK],
            hits: 0,
            met: None,
        }
    }
}

impl RayBlock {
    /// Without rays.
    pub(crate) fn clear(&mut self) {
        (self.live, self.hits) = (0, 0);
    }

    /// Puts eight rays in, of which those in `live` count. Rays with t between `t_min` and `t_max` only.
    #[inline(always)]
    pub(crate) fn put<S: Simd>(
        &mut self,
        eight: usize,
        [origin, direction]: [V<S>; 2],
        [t_min, t_max]: [F<S>; 2],
        live: M<S>,
    ) {
        let first = eight * LANES;
        let rows = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, t_min, t_max];
        for (row, values) in self.rays.iter_mut().zip(&rows) {
            values.store_slice(&mut row[first..][..LANES]);
        }
        self.live |= live.to_bitmask() << first;
    }

    /// The rays that there are.
    pub(crate) fn live(&self) -> u64 {
        self.live
    }

    /// The rays that meet something, once they were searched for.
    pub(crate) fn hits(&self) -> u64 {
        self.hits
    }

    /// What one of these met.
    pub(crate) fn crossing(&self, lane: usize) -> Crossing {
        let [t, u, v] = &self.found;
        Crossing { t: t[lane], part: self.parts[lane], uv: DVec2::new(u[lane], v[lane]) }
    }

    /// Makes lines of the rays. Those that pass at a distance from the unit ball are left out;
    /// see [`LocalRay::new`], of which this is the twin for directions of usual lengths.
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(&mut self, simd: S, center: DVec3, scale: f64) {
        self.hits = 0;
        let mut unusual = 0;
        for first in (0..BLOCK).step_by(WIDE) {
            if self.live >> first & 0xffff == 0 {
                continue;
            }
            let low = self.prepare_eight(simd, first, center, scale, &mut unusual);
            let high = self.prepare_eight(simd, first + LANES, center, scale, &mut unusual);
            for ((row, a), b) in self.single.iter_mut().zip(&low).zip(&high) {
                let both: f32x16<S> = a.narrow(*b);
                both.store_slice(&mut row[first..][..WIDE]);
            }
            self.invert(simd, first);
        }
        for lane in bits_of(unusual) {
            self.prepare_one(lane, center, scale);
        }
    }

    fn origin(&self, lane: usize) -> DVec3 {
        DVec3::new(self.rays[0][lane], self.rays[1][lane], self.rays[2][lane])
    }

    fn direction(&self, lane: usize) -> DVec3 {
        DVec3::new(self.rays[3][lane], self.rays[4][lane], self.rays[5][lane])
    }

    /// The ray itself.
    pub(super) fn ray(&self, lane: usize) -> Ray {
        let (t_min, t_max) = (self.rays[6][lane], self.rays[7][lane]);
        Ray { origin: self.origin(lane), direction: self.direction(lane), t_min, t_max }
    }

    #[inline(always)]
    fn prepare_eight<S: Simd>(
        &mut self,
        simd: S,
        first: usize,
        center: DVec3,
        scale: f64,
        unusual: &mut u64,
    ) -> [F<S>; ROWS] {
        let one = F::splat(simd, 1.0);
        let o = three_rows(simd, &self.rays, 0, first);
        let d = three_rows(simd, &self.rays, 3, first);
        // Squares of very long and very short directions lose digits.
        let squared = d.dot(d);
        let usual = squared.simd_gt(F::splat(simd, 1e-200)) & squared.simd_lt(F::splat(simd, 1e200));
        *unusual |= self.live & ((usual.to_bitmask() ^ 0xff) << first);
        let inverse = one / squared.sqrt();
        let direction = d.times(inverse);
        let per_distance = F::splat(simd, scale) * inverse;
        let from = o.sub(V::splat(simd, center)).times(F::splat(simd, 1.0 / scale));
        let middle = -from.dot(direction);
        let origin = from.add(direction.times(middle));
        let start = middle * per_distance;
        let t_min = F::from_slice(simd, &self.rays[6][first..][..LANES]);
        let t_max = F::from_slice(simd, &self.rays[7][first..][..LANES]);
        // The surface lies within the unit ball.
        let is_near = origin.dot(origin).simd_lt(F::splat(simd, 1.001))
            & start.abs().simd_lt(F::splat(simd, f64::INFINITY))
            & t_min.simd_lt(t_max);
        let slack = F::splat(simd, f64::from(SLACK));
        let near = within_ball(simd, (t_min - start) / per_distance) - slack;
        let far = within_ball(simd, (t_max - start) / per_distance) + slack;
        let lines =
            [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, start, per_distance];
        for (row, values) in self.lines.iter_mut().zip(&lines) {
            values.store_slice(&mut row[first..][..LANES]);
        }
        let away = (usual & !is_near).to_bitmask();
        self.live &= !(away << first);
        [origin.x, origin.y, origin.z, one, one, one, near, far, direction.x, direction.y, direction.z]
    }

    /// The inverse of the directions. Those along a side get a tiny slope, so that nothing is infinite
    /// times zero.
    #[inline(always)]
    fn invert<S: Simd>(&mut self, simd: S, first: usize) {
        let one = f32x16::splat(simd, 1.0);
        let tiny = f32x16::splat(simd, 1e-18);
        for axis in 0..3 {
            let d = f32x16::from_slice(simd, &self.single[DIRECTION + axis][first..][..WIDE]);
            let inverse = one / d.abs().simd_lt(tiny).select(tiny, d);
            inverse.store_slice(&mut self.single[INVERSE + axis][first..][..WIDE]);
        }
    }

    /// A ray with a direction so long or short that squares of it are lost.
    #[cold]
    fn prepare_one(&mut self, lane: usize, center: DVec3, scale: f64) {
        let Some(line) = LocalRay::new(&self.ray(lane), center, scale) else {
            self.live &= !(1 << lane);
            return;
        };
        let (o, d) = (line.origin, line.direction);
        let (start, per_distance) = line.parameters();
        let values = [o.x, o.y, o.z, d.x, d.y, d.z, start, per_distance];
        for (row, value) in self.lines.iter_mut().zip(values) {
            row[lane] = value;
        }
        let SingleRay { origin: o, direction: d, low, high } = line.single;
        let inverse = d.to_array().map(|d| 1.0 / if d.abs() < 1e-18 { 1e-18 } else { d });
        let [x, y, z] = inverse;
        let values = [o.x, o.y, o.z, x, y, z, low, high, d.x, d.y, d.z];
        for (row, value) in self.single.iter_mut().zip(values) {
            row[lane] = value;
        }
    }

    /// The line of one ray.
    pub(super) fn line(&self, lane: usize) -> LocalRay {
        let at = |k: usize| self.lines[k][lane];
        let single = |k: usize| self.single[k][lane];
        let vector = |k: usize| senca_math::glam::Vec3::new(single(k), single(k + 1), single(k + 2));
        LocalRay::of_parts(
            DVec3::new(at(0), at(1), at(2)),
            DVec3::new(at(3), at(4), at(5)),
            (at(6), at(7)),
            SingleRay {
                origin: vector(0),
                direction: vector(DIRECTION),
                low: single(NEAR),
                high: single(FAR),
            },
        )
    }

    /// The lines of these rays.
    #[inline(always)]
    pub(super) fn lines<S: Simd>(&self, simd: S, lanes: &[u8; LANES]) -> [V<S>; 2] {
        [
            V {
                x: gathered(simd, &self.lines[0], lanes),
                y: gathered(simd, &self.lines[1], lanes),
                z: gathered(simd, &self.lines[2], lanes),
            },
            V {
                x: gathered(simd, &self.lines[3], lanes),
                y: gathered(simd, &self.lines[4], lanes),
                z: gathered(simd, &self.lines[5], lanes),
            },
        ]
    }

    /// Takes hits of these rays where their rays admit them. With `any` it is enough to know that there
    /// is one.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        lanes: &[u8; LANES],
        inside: u64,
        part: u32,
        [u, v, distance]: [[f64; LANES]; 3],
        any: bool,
    ) {
        for k in lanes_of(inside) {
            let lane = usize::from(lanes[k]) % BLOCK;
            let t = self.lines[6][lane] + distance[k] * self.lines[7][lane];
            if !(t > self.rays[6][lane] && t < self.rays[7][lane]) {
                continue;
            }
            self.take_one(lane, Crossing { t, part, uv: DVec2::new(u[k], v[k]) }, distance[k], any);
        }
    }

    #[inline(always)]
    fn take_one(&mut self, lane: usize, crossing: Crossing, distance: f64, any: bool) {
        let is_first = self.hits >> lane & 1 == 0;
        self.hits |= 1 << lane;
        if any || !(is_first || comes_before(&crossing, &self.crossing(lane))) {
            return;
        }
        let Crossing { t, part, uv } = crossing;
        for (row, value) in self.found.iter_mut().zip([t, uv.x, uv.y]) {
            row[lane] = value;
        }
        self.parts[lane] = part;
        let far = &mut self.single[FAR][lane];
        *far = far.min(distance as f32 + SLACK);
    }

    /// Takes a hit that was found for one ray alone.
    #[cold]
    pub(super) fn take_alone(&mut self, lane: usize, hit: &Hit, any: bool) {
        self.take_one(lane, hit.crossing, hit.distance, any);
    }
}

/// Three rows, from number `first` on.
#[inline(always)]
fn three_rows<S: Simd>(simd: S, rows: &[[f64; BLOCK]; 8], k: usize, first: usize) -> V<S> {
    V {
        x: F::from_slice(simd, &rows[k][first..][..LANES]),
        y: F::from_slice(simd, &rows[k + 1][first..][..LANES]),
        z: F::from_slice(simd, &rows[k + 2][first..][..LANES]),
    }
}

#[inline(always)]
fn gathered<S: Simd>(simd: S, row: &[f64; BLOCK], lanes: &[u8; LANES]) -> F<S> {
    F::load_array(simd, eight!(k => row[usize::from(lanes[k]) % BLOCK]))
}

/// Distances, those beyond 2 as 2.
#[inline(always)]
fn within_ball<S: Simd>(simd: S, distance: F<S>) -> F<S> {
    let two = F::splat(simd, 2.0);
    let distance = distance.simd_gt(two).select(two, distance);
    distance.simd_lt(-two).select(-two, distance)
}

/// Whether a crossing counts and not another one: the smaller t, then the first patch; the place decides
/// between two cells.
pub(super) fn comes_before(a: &Crossing, b: &Crossing) -> bool {
    let order = |c: &Crossing| (c.t, c.part, c.uv.x, c.uv.y);
    order(a) < order(b)
}
