//! From a ray to the places where it meets patches.

use fearless_simd::{Simd, dispatch};
use senca_math::glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;

use super::PatchSurface;
use super::block::comes_before;
use super::cells::{Cell, MARGIN, Meeting};
use super::grazing::{Pair, bicubic_roots};
use super::hierarchy::{SingleRay, Visitor};
use super::patch::{Patch, PatchJet};
use super::roots::{Domain, ROUNDING, Root, RootList, roots};
use crate::{Crossing, Ray};

/// A ray in normalized space. Its origin is the point nearest to the centre, so that what lies on the
/// surface is at distances of at most about 1 from it, wherever the ray came from.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    pub origin: DVec3,
    /// Of length 1.
    pub direction: DVec3,
    /// Parameter of the ray at the origin.
    start: f64,
    /// Parameter per unit of distance.
    per_distance: f64,
    pub single: SingleRay,
}

impl LocalRay {
    /// The ray where `center` is the origin and `scale` is of length 1; `None` for rays that pass at a
    /// distance, or are not valid.
    pub(super) fn new(ray: &Ray, center: DVec3, scale: f64) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let length = ray.direction.length();
        // Squares of very long and very short directions are lost.
        let (direction, per_distance) = if (1e-100..1e100).contains(&length) {
            let inverse = length.recip();
            (ray.direction * inverse, scale * inverse)
        } else {
            let largest = ray.direction.abs().max_element();
            let scaled = ray.direction / largest;
            (scaled.normalize(), scale / largest / scaled.length())
        };
        let from = (ray.origin - center) / scale;
        let middle = -from.dot(direction);
        let origin = from + middle * direction;
        let start = middle * per_distance;
        // The surface lies within the unit ball.
        let is_near = origin.length_squared() < 1.001 && start.is_finite() && per_distance > 0.0;
        if !is_near {
            return None;
        }
        let distance = |t: f64| ((t - start) / per_distance).clamp(-2.0, 2.0) as f32;
        let single = SingleRay {
            origin: origin.as_vec3(),
            direction: direction.as_vec3(),
            low: distance(ray.t_min) - SLACK,
            high: distance(ray.t_max) + SLACK,
        };
        Some(Self { origin, direction, start, per_distance, single })
    }

    /// One that is known already; `parameters` are those of [`LocalRay::parameters`].
    pub(super) fn of_parts(
        origin: DVec3,
        direction: DVec3,
        (start, per_distance): (f64, f64),
        single: SingleRay,
    ) -> Self {
        Self { origin, direction, start, per_distance, single }
    }

    /// Parameter of the ray at the origin, and its growth per distance.
    pub(super) fn parameters(&self) -> (f64, f64) {
        (self.start, self.per_distance)
    }

    /// Parameter of the ray at a distance.
    #[inline(always)]
    pub(super) fn parameter(&self, distance: f64) -> f64 {
        self.start + distance * self.per_distance
    }
}

/// Room for rounding in single precision.
pub(super) const SLACK: f32 = 1e-5;

/// A place where the ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub crossing: Crossing,
    /// Distance in normalized space.
    pub distance: f64,
    /// Sign of the product of direction and normal.
    pub sign: f64,
}

/// What is wanted of the hits.
pub(super) trait Wanted {
    /// Takes a hit that the ray admits.
    fn take(&mut self, hit: Hit);
    /// Distance up to which hits are still wanted.
    fn limit(&self) -> f32;
}

/// The hit with the smallest parameter; among equal ones see [`comes_before`].
pub(super) struct Nearest(pub Option<Hit>);

impl Wanted for Nearest {
    #[inline(always)]
    fn take(&mut self, hit: Hit) {
        if self.0.is_none_or(|best| comes_before(&hit.crossing, &best.crossing)) {
            self.0 = Some(hit);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.0.map_or(f32::INFINITY, |hit| hit.distance as f32 + SLACK)
    }
}

/// Whether there is any.
pub(super) struct Any(pub bool);

impl Wanted for Any {
    #[inline(always)]
    fn take(&mut self, _: Hit) {
        self.0 = true;
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        if self.0 { f32::NEG_INFINITY } else { f32::INFINITY }
    }
}

/// All of them, and those on common borders several times.
#[derive(Default)]
pub(super) struct All(pub SmallVec<[Hit; 8]>);

impl Wanted for All {
    fn take(&mut self, hit: Hit) {
        self.0.push(hit);
    }

    fn limit(&self) -> f32 {
        f32::INFINITY
    }
}

/// The search of one ray.
pub(super) struct Search<'a, W> {
    pub surface: &'a PatchSurface,
    pub ray: &'a Ray,
    pub local: LocalRay,
    pub wanted: W,
    /// Cells looked at.
    pub tests: u64,
}

impl<S: Simd, W: Wanted> Visitor<S> for Search<'_, W> {
    #[inline(always)]
    fn cell(&mut self, simd: S, index: u32) {
        self.tests += 1;
        let surface = self.surface;
        self.alone(simd, &surface.cells[index as usize]);
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.wanted.limit().min(self.local.single.high)
    }
}

impl<W: Wanted> Search<'_, W> {
    /// Offers a hit, if the ray admits it.
    #[inline(always)]
    fn take(&mut self, part: u32, root: Root, distance: f64) {
        let t = self.local.parameter(distance);
        if self.ray.admits(t) {
            let crossing = Crossing { t, part, uv: root.uv };
            self.wanted.take(Hit { crossing, distance, sign: root.sign });
        }
    }

    /// The hits in a cell that is looked at for this ray alone, from near which Newton's method may start.
    #[inline(always)]
    pub(super) fn alone<S: Simd>(&mut self, simd: S, cell: &Cell) {
        let near = match cell.meets(self.local.single.origin, self.local.single.direction) {
            Meeting::Never => return,
            Meeting::Unknown => return self.divide(cell),
            Meeting::Once(near) => near.as_dvec2(),
        };
        let patch = &self.surface.patches[cell.patch as usize];
        match newton(simd, patch, cell, near, &self.local) {
            Newton::Outside => {}
            Newton::Lost => self.divide(cell),
            Newton::Inside { root, distance } => self.take(cell.patch, root, distance),
        }
    }

    /// The roots in a cell of which nothing is certain.
    #[cold]
    #[inline(never)]
    pub(super) fn divide(&mut self, cell: &Cell) {
        let surface = self.surface;
        let points: Option<&[DVec4; 16]> = surface.patches[cell.patch as usize].bicubic();
        let Some(points) = points else {
            let planes = self.planes(cell.normal().as_dvec3());
            return self.divide_plainly(cell.patch, cell.domain(), planes);
        };
        dispatch!(surface.level, simd => self.divide_bicubic(simd, cell, points));
    }

    /// The roots in a part of a patch, by dividing it.
    pub(super) fn by_division(&mut self, part: u32, domain: Domain) {
        let planes = self.planes(DVec3::ZERO);
        self.divide_plainly(part, domain, planes);
    }

    /// Normals of two planes in which the ray lies. One of them is the one that is most square to the
    /// normal of a cell: a ray that runs over a bent piece without touching it has all of it on one side.
    fn planes(&self, normal: DVec3) -> [DVec3; 2] {
        let d = self.local.direction;
        let across = normal - normal.dot(d) * d;
        // What is left of the normal has to be large, so that it is square to the ray to all digits.
        let is_along_surface = across.length_squared() > 0.25 * normal.length_squared();
        if is_along_surface {
            let y = across.normalize();
            return [y.cross(d), y];
        }
        let (x, y) = d.any_orthonormal_pair();
        [x, y]
    }

    fn divide_plainly(&mut self, part: u32, domain: Domain, [x, y]: [DVec3; 2]) {
        let patch = &self.surface.patches[part as usize];
        let o = self.local.origin;
        let pair = patch.net.map(|p| {
            let offset = p.truncate() - o * p.w;
            DVec2::new(x.dot(offset), y.dot(offset))
        });
        let pair = pair.restricted(super::net::Axis::U, domain.u).restricted(super::net::Axis::V, domain.v);
        let mut found = RootList::new();
        roots(pair, domain, &|uv| patch.is_regular(uv), &mut found);
        for root in found {
            let jet = super::patch::quotient(&patch.net.at(root.uv.x, root.uv.y));
            self.take_root(part, root, &jet);
        }
    }

    #[inline(always)]
    fn divide_bicubic<S: Simd>(&mut self, simd: S, cell: &Cell, points: &[DVec4; 16]) {
        let planes = self.planes(cell.normal().as_dvec3());
        let o = self.local.origin;
        if cell.is_beside(simd, o, planes) {
            return;
        }
        let patch = &self.surface.patches[cell.patch as usize];
        let domain = cell.domain();
        let pair = Pair::new(simd, points, o, planes).restricted(&domain);
        let mut found = RootList::new();
        bicubic_roots(pair, domain, &|uv| patch.is_regular(uv), &mut found);
        for root in found {
            let jet = patch.at(simd, root.uv);
            self.take_root(cell.patch, root, &jet);
        }
    }

    fn take_root(&mut self, part: u32, mut root: Root, jet: &PatchJet) {
        let (o, d) = (self.local.origin, self.local.direction);
        if root.sign == 0.0 {
            root.sign = self.surface.unit_normal(part, root.uv, jet).dot(d).signum();
        }
        self.take(part, root, (jet.value - o).dot(d));
    }
}

/// What Newton's method says of a cell with at most one root.
pub(super) enum Newton {
    Inside {
        root: Root,
        distance: f64,
    },
    Outside,
    /// It does not settle, or so far outside that nothing is certain.
    Lost,
}

/// Steps, in half sizes of the cell, after which Newton's method has settled: the next would be the square
/// of it.
pub(super) const SETTLED: f64 = 1e-7;

/// Newton's method for `origin + s direction = S(u, v)` from a place in the frame of a cell.
#[inline(always)]
fn newton<S: Simd>(simd: S, patch: &Patch, cell: &Cell, start: DVec2, ray: &LocalRay) -> Newton {
    let domain = cell.domain();
    let (center, half) = (domain.center(), domain.half());
    let mut uv = center + half * start;
    for _ in 0..10 {
        let jet = patch.at(simd, uv);
        let normal = jet.du.cross(jet.dv);
        let offset = ray.origin - jet.value;
        let inverse = 1.0 / ray.direction.dot(normal);
        let moment = ray.direction.cross(offset);
        let step = DVec2::new(jet.dv.dot(moment), -jet.du.dot(moment)) * inverse;
        uv += step;
        if step.abs().cmple(SETTLED * half).all() {
            let error = || DVec2::new(jet.dv.length(), jet.du.length()) * inverse.abs();
            let distance = -offset.dot(normal) * inverse;
            return settle(cell, uv, error, distance, inverse.signum());
        }
        if !((uv - center).abs().cmple(4.0 * half).all()) {
            break;
        }
    }
    Newton::Lost
}

/// Whether a root lies in the cell; `error` is that of (u, v) per error of the place.
#[inline(always)]
pub(super) fn settle(cell: &Cell, uv: DVec2, error: impl Fn() -> DVec2, distance: f64, sign: f64) -> Newton {
    let domain = cell.domain();
    if !domain.holds(uv, DVec2::splat(-WIDEST)) {
        let tolerance = (5.0 * ROUNDING * error() + 1e-13).min(DVec2::splat(WIDEST));
        if !domain.holds(uv, tolerance) {
            let is_near = domain.holds(uv, MARGIN * domain.half());
            return if is_near { Newton::Outside } else { Newton::Lost };
        }
    }
    Newton::Inside { root: Root { uv: uv.clamp(DVec2::ZERO, DVec2::ONE), sign }, distance }
}

/// Most that a root may lie outside of a cell and count as in it.
pub(super) const WIDEST: f64 = 1e-6;
