//! Prisms over any base.

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};
use senca_math::polygon::signed_area;
use smallvec::SmallVec;

use super::analytic::{Analytic, Chart, slab};
use super::region::Region;
use crate::{Crossing, Ray, SurfacePoint};

/// Parts from here on are walls; below are the bottom and the top.
const BOTTOM: u32 = 0;
const TOP: u32 = 1;
const WALLS: u32 = 2;

/// Where a line enters or leaves the endless prism: parameter, wall, and place along the wall.
type WallCrossing = (f64, u32, f64);

/// A flat outline in the plane y = 0, drawn up to y = `height`.
#[derive(Clone, Debug)]
pub struct Prism {
    /// Corners of the base as (x, -z), counter-clockwise, as seen from above.
    base: Vec<DVec2>,
    /// Length of the outline from its first corner to each corner.
    lengths: Vec<f64>,
    around: f64,
    region: Region,
    low: DVec2,
    size: DVec2,
    height: f64,
    capped: bool,
}

impl Prism {
    /// A prism over the finite corners `(x, z)` of `base`, in either order, of `height` > 0. A base that
    /// crosses itself is solid where its outline runs round an odd number of times. `None` for a base
    /// without area.
    #[must_use]
    pub fn new(base: &[DVec2], height: f64, capped: bool) -> Option<Self> {
        let mut base: Vec<DVec2> = base.iter().map(|p| DVec2::new(p.x, -p.y)).collect();
        let area = signed_area(&base);
        if area < 0.0 {
            base.reverse();
        }
        let mut around = 0.0;
        let mut lengths = Vec::with_capacity(base.len());
        for (i, p) in base.iter().enumerate() {
            lengths.push(around);
            around += p.distance(base[(i + 1) % base.len()]);
        }
        let low = base.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let size = base.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) - low;
        let region = Region::new(std::slice::from_ref(&base));
        (area != 0.0).then_some(Self { base, lengths, around, region, low, size, height, capped })
    }

    fn next(&self, wall: usize) -> usize {
        if wall + 1 == self.base.len() { 0 } else { wall + 1 }
    }

    /// Crossings of the line, seen from above, with the outline, ascending. A corner on the line counts
    /// as on its left, so their number is always even.
    fn wall_crossings(&self, origin: DVec2, direction: DVec2) -> SmallVec<[WallCrossing; 8]> {
        let mut found = SmallVec::new();
        let length_squared = direction.length_squared();
        let side = |p: DVec2| direction.perp_dot(p - origin);
        let mut before = side(self.base[self.base.len() - 1]);
        let mut previous = self.base.len() - 1;
        for (i, &corner) in self.base.iter().enumerate() {
            let here = side(corner);
            if (before < 0.0) != (here < 0.0) {
                let share = before / (before - here);
                let place = self.base[previous].lerp(corner, share);
                found.push(((place - origin).dot(direction) / length_squared, previous as u32, share));
            }
            (before, previous) = (here, i);
        }
        found.sort_by(|a: &WallCrossing, b: &WallCrossing| a.0.total_cmp(&b.0));
        found
    }

    /// Names both ends of the stretch inside, where it reaches into the slab between bottom and top.
    fn meet_stretch(
        &self,
        [start, end]: [Option<WallCrossing>; 2],
        [low, high]: [(f64, u32); 2],
        meet: &mut impl FnMut(f64, u32, DVec2),
    ) {
        let at = |end: Option<WallCrossing>, open: f64| end.map_or(open, |wall| wall.0);
        let (first, last) = (at(start, f64::NEG_INFINITY), at(end, f64::INFINITY));
        if first.max(low.0) >= last.min(high.0) {
            return;
        }
        for (wall, cap, by_wall) in [(start, low, first > low.0), (end, high, last < high.0)] {
            match wall {
                Some((t, wall, share)) if by_wall => meet(t, WALLS + wall, DVec2::new(share, 0.0)),
                _ if self.capped => meet(cap.0, cap.1, DVec2::ZERO),
                _ => {}
            }
        }
    }

    fn cap_point(&self, near: DVec3, top: bool) -> SurfacePoint {
        let (y, normal) = if top { (self.height, DVec3::Y) } else { (0.0, DVec3::NEG_Y) };
        let share = (DVec2::new(near.x, -near.z) - self.low) / self.size;
        let chart = Chart {
            uv: DVec2::new(share.x, 1.0 - share.y),
            along_u: DVec3::X * self.size.x,
            along_v: DVec3::Z * self.size.y,
        };
        chart.at(DVec3 { y, ..near }, normal, if top { 2 } else { 1 })
    }

    fn wall_point(&self, near: DVec3, wall: usize, share: f64) -> SurfacePoint {
        let (a, b) = (self.base[wall], self.base[self.next(wall)]);
        let place = a.lerp(b, share);
        let along = b - a;
        let y = near.y.clamp(0.0, self.height);
        let length = along.length();
        let direction = DVec3::new(along.x, 0.0, -along.y) / length;
        let chart = Chart {
            uv: DVec2::new((self.lengths[wall] + share * length) / self.around, 1.0 - y / self.height),
            along_u: direction * self.around,
            along_v: DVec3::NEG_Y * self.height,
        };
        let normal = DVec3::new(along.y, 0.0, along.x).normalize_or(DVec3::X);
        chart.at(DVec3::new(place.x, y, -place.y), normal, 0)
    }
}

impl Analytic for Prism {
    fn bounds(&self) -> Aabb {
        let high = self.low + self.size;
        Aabb { min: DVec3::new(self.low.x, 0.0, -high.y), max: DVec3::new(high.x, self.height, -self.low.y) }
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let (low, high) = slab(ray.origin.y, ray.direction.y, 0.0, self.height);
        if low >= high {
            return;
        }
        let caps = if ray.direction.y > 0.0 { [BOTTOM, TOP] } else { [TOP, BOTTOM] };
        let ends = [(low, caps[0]), (high, caps[1])];
        let origin = DVec2::new(ray.origin.x, -ray.origin.z);
        let direction = DVec2::new(ray.direction.x, -ray.direction.z);
        if direction == DVec2::ZERO {
            if self.region.contains(origin) {
                self.meet_stretch([None, None], ends, meet);
            }
            return;
        }
        for pair in self.wall_crossings(origin, direction).chunks_exact(2) {
            self.meet_stretch([Some(pair[0]), Some(pair[1])], ends, meet);
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let near = ray.at(crossing.t);
        match crossing.part {
            BOTTOM => self.cap_point(near, false),
            TOP => self.cap_point(near, true),
            wall => self.wall_point(near, (wall - WALLS) as usize % self.base.len(), crossing.uv.x),
        }
    }

    fn is_closed(&self) -> bool {
        self.capped
    }
}
