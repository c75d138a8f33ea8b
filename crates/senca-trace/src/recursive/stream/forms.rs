//! What eight rays meet at once.
//!
//! Spheres, flat pieces and triangles lie in the world here, whatever frames their nodes have; all
//! others are boxes, in which the surface is asked ray by ray. Each has a *rank*: the ranks of an
//! object's parts follow each other, and so do those of objects, so that of hits at the same t the one
//! of the lowest rank counts.

use fearless_simd::{Simd, prelude::*};
use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::rays::Packet;
use crate::intersect::{FlatTriangle, Form};
use crate::lanes::{F, LANES, M, V, bits_of, channels, lanes_of, larger};
use crate::{Counters, Crossing, Hit, Object, Ray};

/// The surfaces of a world.
#[derive(Debug, Default)]
pub(super) struct Forms {
    /// At most 64 where packets are tested against all.
    balls: Vec<Ball>,
    /// A bit for each of them.
    opaque_balls: u64,
    sheets: Vec<Sheet>,
    others: Vec<Other>,
    /// Those made of patches, which more rays meet at once.
    pub(super) patched: Vec<Other>,
    /// By rank.
    pub(super) ranks: Vec<Rank>,
    /// Rank of each object's first part.
    first_rank: Vec<u32>,
}

/// What has a rank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rank {
    pub(super) kind: Kind,
    pub(super) object: u32,
    pub(super) part: u32,
    pub(super) material: usize,
    /// Of a ball: centre, error. Of a sheet: normal, distance, error, its growth; u and v.
    pub(super) numbers: [f64; 14],
    /// Texture coordinates of a sheet: at u = v = 0, and their growth along u and v.
    pub(super) texture: [DVec2; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Ball,
    Sheet,
    Patches,
    Other,
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: DVec3,
    radius_squared: f64,
    /// A little less than the square of the distance from the world's origin less that of the radius.
    least: f64,
    rank: f64,
}

/// Share of the squares of coordinates that their sums and products are surely exact to.
const SURE: f64 = 1e-13;

/// The balls as a place sees them, through which many rays pass: the eye, or a lamp.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight(Vec<Cone>);

/// The lines through a place that touch a ball.
#[derive(Clone, Copy, Debug)]
struct Cone {
    to_center: DVec3,
    /// A little less than `to_center . direction` of those lines, their unit directions turned to the ball.
    least: f64,
}

/// Which balls eight rays may meet: a bit for each ball, and for each of those a bit for each ray.
struct Ahead {
    balls: u64,
    rays: [u8; 64],
}

/// What is known about where rays pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum Through<'a> {
    Anywhere,
    /// They start there.
    From(&'a Sight),
    /// They end there.
    To(&'a Sight),
}

/// A flat piece.
#[derive(Clone, Copy, Debug)]
struct Sheet {
    normal: DVec3,
    distance: f64,
    outline: Outline,
    rank: f64,
    opaque: bool,
}

/// What of its plane is there.
#[derive(Clone, Copy, Debug)]
enum Outline {
    Endless,
    /// Where two coordinates of the plane, u and v, are from 0 to 1.
    Square([Coordinate; 2]),
    /// Where u^2 + v^2 is from this square up to 1.
    Ring([Coordinate; 2], f64),
    Triangle([DVec3; 3]),
}

/// An affine coordinate, `along . p + offset`.
#[derive(Clone, Copy, Debug, Default)]
struct Coordinate {
    along: DVec3,
    offset: f64,
}

/// Anything else.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    bounds: Aabb,
    pub(super) object: u32,
    pub(super) rank: f64,
    is_opaque: bool,
}

/// The nearest hits of eight rays.
pub(super) struct Nearest<S: Simd> {
    pub(super) t: F<S>,
    /// -1 where there is none.
    pub(super) rank: F<S>,
}

impl Forms {
    pub(super) fn of(objects: &[Object<'_>]) -> Self {
        let mut forms = Self::default();
        for (number, object) in objects.iter().enumerate() {
            forms.first_rank.push(forms.ranks.len() as u32);
            forms.add(number as u32, object);
        }
        forms
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.ranks.len()
    }

    /// Rank of what was hit.
    pub(super) fn rank_of(&self, hit: &Hit) -> u32 {
        let first = self.first_rank[hit.object as usize];
        let last = self.first_rank.get(hit.object as usize + 1).map_or(self.ranks.len() as u32, |&next| next);
        // A parallelogram is one thing of two triangles, and others have one rank whatever their parts.
        (first..last).rev().find(|&rank| self.ranks[rank as usize].part <= hit.crossing.part).unwrap_or(first)
    }

    fn add(&mut self, number: u32, object: &Object<'_>) {
        match object.surface.form() {
            Form::Sphere { radius } => self.add_ball(number, object, radius),
            Form::Plane { size } => self.add_plane(number, object, size),
            Form::Disc { radius, inner } => self.add_disc(number, object, radius, inner),
            Form::Triangles(triangles) if !triangles.is_empty() => {
                self.add_triangles(number, object, &triangles);
            }
            Form::Parallelogram(square) => self.add_triangle(number, object, 0, &square, true),
            _ => self.add_other(number, object),
        }
    }

    fn rank(&mut self, rank: Rank) -> f64 {
        self.ranks.push(rank);
        (self.ranks.len() - 1) as f64
    }

    fn add_other(&mut self, number: u32, object: &Object<'_>) {
        let is_patched = object.surface.patches().is_some();
        let rank = Rank {
            kind: if is_patched { Kind::Patches } else { Kind::Other },
            object: number,
            part: 0,
            material: object.material_of(0),
            numbers: [0.0; 14],
            texture: [DVec2::ZERO; 3],
        };
        let rank = self.rank(rank);
        let is_opaque = object.opaque;
        let other = Other { bounds: object.bounds_world, object: number, rank, is_opaque };
        if is_patched { self.patched.push(other) } else { self.others.push(other) }
    }

    fn add_ball(&mut self, number: u32, object: &Object<'_>, radius: f64) {
        let Some(scale) = uniform_scale(object) else { return self.add_other(number, object) };
        let center = object.world_from_object.transform_point3(DVec3::ZERO);
        let radius = radius * scale;
        let error = object.error_at(DVec3::ZERO);
        let mut numbers = [0.0; 14];
        numbers[..5].copy_from_slice(&[center.x, center.y, center.z, radius, error]);
        let rank = self.rank(Rank {
            kind: Kind::Ball,
            object: number,
            part: 0,
            material: object.material_of(0),
            numbers,
            texture: [DVec2::ZERO; 3],
        });
        self.opaque_balls |= u64::from(object.opaque) << (self.balls.len() % 64);
        let (squared, radius_squared) = (center.length_squared(), radius * radius);
        let least = squared - radius_squared - SURE * (squared + radius_squared);
        self.balls.push(Ball { center, radius_squared, least, rank });
    }

    /// The coordinates of an object, to be combined to those of a sheet.
    fn object_coordinate(object: &Object<'_>, axis: usize, factor: f64, offset: f64) -> Coordinate {
        let row = object.object_from_world.row(axis) * factor;
        Coordinate { along: row.truncate(), offset: row.w + offset }
    }

    fn add_plane(&mut self, number: u32, object: &Object<'_>, size: Option<f64>) {
        let edge = size.unwrap_or(1.0);
        let middle = if size.is_some() { 0.5 } else { 0.0 };
        let coordinates = [0, 2].map(|axis| Self::object_coordinate(object, axis, 1.0 / edge, middle));
        let outline = if size.is_some() { Outline::Square(coordinates) } else { Outline::Endless };
        let texture = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let sheet = (DVec3::ZERO, DVec3::Y);
        self.add_sheet(number, object, 0, 0, sheet, outline, coordinates, texture);
    }

    fn add_disc(&mut self, number: u32, object: &Object<'_>, radius: f64, inner: f64) {
        let coordinates = [0, 2].map(|axis| Self::object_coordinate(object, axis, 1.0 / radius, 0.0));
        let outline = Outline::Ring(coordinates, (inner / radius).powi(2));
        let texture = [DVec2::splat(0.5), DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5)];
        self.add_sheet(number, object, 0, 0, (DVec3::ZERO, DVec3::Y), outline, coordinates, texture);
    }

    fn add_triangles(&mut self, number: u32, object: &Object<'_>, triangles: &[FlatTriangle]) {
        if let [a, b] = triangles
            && let Some(square) = parallelogram(a, b)
        {
            return self.add_triangle(number, object, 0, &square, true);
        }
        for (part, triangle) in triangles.iter().enumerate() {
            self.add_triangle(number, object, part as u32, triangle, false);
        }
    }

    fn add_triangle(
        &mut self,
        number: u32,
        object: &Object<'_>,
        part: u32,
        triangle: &FlatTriangle,
        square: bool,
    ) {
        let [a, b, c] = triangle.corners;
        let normal = (b - a).cross(c - a);
        let world = triangle.corners.map(|p| object.world_from_object.transform_point3(p));
        let (right, up) = (world[1] - world[0], world[2] - world[0]);
        let across = right.cross(up);
        let squared = across.length_squared();
        if !(squared > 0.0 && squared.is_finite()) {
            return; // Without an area it is never met.
        }
        let coordinate = |along: DVec3| {
            let along = along / squared;
            Coordinate { along, offset: -along.dot(world[0]) }
        };
        let coordinates = [coordinate(up.cross(across)), coordinate(across.cross(right))];
        let outline = if square { Outline::Square(coordinates) } else { Outline::Triangle(world) };
        let [t0, t1, t2] = triangle.texcoords;
        let texture = [t0, t1 - t0, t2 - t0];
        self.add_sheet(number, object, part, triangle.surface, (a, normal), outline, coordinates, texture);
    }

    fn add_sheet(
        &mut self,
        number: u32,
        object: &Object<'_>,
        part: u32,
        surface: u32,
        (point, normal): (DVec3, DVec3),
        outline: Outline,
        [u, v]: [Coordinate; 2],
        texture: [DVec2; 3],
    ) {
        let normal = (object.world_from_object_normals * normal).normalize_or_zero();
        let distance = normal.dot(object.world_from_object.transform_point3(point));
        // The error of an endless plane grows with the coordinates there; 1 stands for them all.
        let (error, growth) = match object.is_endless() {
            true => (0.0, object.error_at(DVec3::X)),
            false => (object.error_at(DVec3::ZERO), 0.0),
        };
        let n = normal;
        let numbers = [
            n.x, n.y, n.z, distance, error, growth, u.along.x, u.along.y, u.along.z, u.offset, v.along.x,
            v.along.y, v.along.z, v.offset,
        ];
        let material = object.material_of(surface);
        let rank = self.rank(Rank { kind: Kind::Sheet, object: number, part, material, numbers, texture });
        self.sheets.push(Sheet { normal, distance, outline, rank, opaque: object.opaque });
    }

    /// The balls as this place sees them.
    pub(super) fn seen_from(&self, place: DVec3) -> Sight {
        let rounding = SURE * place.abs().max_element();
        let cone = |ball: &Ball| {
            let to_center = ball.center - place;
            let squared = to_center.length_squared();
            let tangent = squared - ball.radius_squared - SURE * (squared + ball.radius_squared);
            let least = if tangent > 0.0 { tangent.sqrt() - rounding } else { f64::NEG_INFINITY };
            Cone { to_center, least }
        };
        Sight(self.balls.iter().map(cone).collect())
    }

    /// The nearest hits of the `live` rays. The hits of others are put into `hits`, by lane.
    #[inline(always)]
    pub(super) fn closest<S: Simd>(
        &self,
        simd: S,
        objects: &[Object<'_>],
        through: Through<'_>,
        rays: &Packet<S>,
        live: M<S>,
        hits: &mut [Hit],
        counters: &mut Counters,
    ) -> Nearest<S> {
        let (o, d, t_min) = (rays.origin, rays.direction, rays.t_min);
        let mut best = Nearest { t: F::splat(simd, f64::INFINITY), rank: F::splat(simd, -1.0) };
        let ahead = self.balls_ahead(simd, through, o, d, live);
        for number in bits_of(ahead.balls) {
            let ball = &self.balls[number];
            let (middle, half_squared) = ball.chord(simd, o, d);
            let met = ahead.rays(simd, number) & half_squared.simd_gt(F::splat(simd, 0.0));
            let half = half_squared.sqrt();
            let (enter, leave) = (middle - half, middle + half);
            let t = enter.simd_gt(t_min).select(enter, leave);
            best.take(met & t.simd_gt(t_min), t, F::splat(simd, ball.rank));
        }
        for sheet in &self.sheets {
            let Some(t) = sheet.meet(simd, o, d, live) else { continue };
            let rank = F::splat(simd, sheet.rank);
            let near = live & t.simd_gt(t_min) & best.is_before(t, rank);
            if near.any_true() {
                best.take(near & sheet.holds(simd, o, d, t), t, rank);
            }
        }
        let count = u64::from(live.to_bitmask().count_ones());
        counters.tests += count * (self.balls.len() + self.sheets.len()) as u64;
        if !self.others.is_empty() {
            counters.nodes += count * self.others.len() as u64;
            self.closest_others(simd, objects, rays, live, &mut best, hits, counters);
        }
        best
    }

    #[inline(always)]
    fn closest_others<S: Simd>(
        &self,
        simd: S,
        objects: &[Object<'_>],
        rays: &Packet<S>,
        live: M<S>,
        best: &mut Nearest<S>,
        hits: &mut [Hit],
        counters: &mut Counters,
    ) {
        let reciprocal = reciprocal(simd, rays.direction);
        for other in &self.others {
            let met = live & other.meet(simd, rays.origin, reciprocal, rays.t_min, best.t);
            if !met.any_true() {
                continue;
            }
            let (mut t, mut rank) = (best.t.to_array(), best.rank.to_array());
            let t_min = rays.t_min.to_array();
            let (o, d) = (rays.origin.to_array(), rays.direction.to_array());
            let object = &objects[other.object as usize];
            for lane in lanes_of(met.to_bitmask()) {
                let ray =
                    Ray { origin: o[lane], direction: d[lane], t_min: t_min[lane], t_max: t[lane].next_up() };
                let Some(crossing) = object.closest(&ray, counters) else { continue };
                if crossing.t < t[lane] || (crossing.t == t[lane] && other.rank < rank[lane]) {
                    (t[lane], rank[lane]) = (crossing.t, other.rank);
                    hits[lane] = Hit { object: other.object, crossing };
                }
            }
            best.t = F::load_array(simd, t);
            best.rank = F::load_array(simd, rank);
        }
    }

    /// The balls that live rays may meet. To look at all first takes no branches, and the few that are left
    /// can be looked at closely.
    #[inline(always)]
    fn balls_ahead<S: Simd>(&self, simd: S, through: Through<'_>, o: V<S>, d: V<S>, live: M<S>) -> Ahead {
        match through {
            Through::Anywhere => self.balls_anywhere(simd, o, d, live),
            Through::From(sight) => sight.balls_along(simd, d, live),
            Through::To(sight) => sight.balls_along(simd, d.opposite(), live),
        }
    }

    /// [`Self::balls_ahead`] of any rays.
    ///
    /// The distance of the origin from the ball is expanded into products of both centres, which takes fewer
    /// steps and loses digits, so a little room is left.
    #[inline(always)]
    fn balls_anywhere<S: Simd>(&self, simd: S, o: V<S>, d: V<S>, live: M<S>) -> Ahead {
        let zero = F::splat(simd, 0.0);
        let (along, squared) = (o.dot(d), o.dot(o) * F::splat(simd, 1.0 - SURE));
        let twice = o.add(o);
        let mut ahead = Ahead::default();
        for (number, ball) in self.balls.iter().enumerate() {
            let center = V::splat(simd, ball.center);
            let middle = center.dot(d) - along;
            // Square of the tangent's length from the origin; negative within the ball.
            let tangent = squared + F::splat(simd, ball.least) - center.dot(twice);
            let met =
                live & (middle.simd_gt(zero) | tangent.simd_lt(zero)) & (middle * middle).simd_gt(tangent);
            ahead.put(number, met);
        }
        ahead
    }

    /// Which of the `live` rays meet something opaque before `t_max`.
    #[inline(always)]
    pub(super) fn occluded<S: Simd>(
        &self,
        simd: S,
        objects: &[Object<'_>],
        through: Through<'_>,
        o: V<S>,
        d: V<S>,
        t_max: F<S>,
        live: M<S>,
        counters: &mut Counters,
    ) -> M<S> {
        let zero = F::splat(simd, 0.0);
        let mut clear = live;
        let mut tests = 0;
        let ahead = self.balls_ahead(simd, through, o, d, live);
        tests += self.balls.len() as u64;
        for number in bits_of(ahead.balls & self.opaque_balls) {
            let ball = &self.balls[number];
            let (middle, half_squared) = ball.chord(simd, o, d);
            // Not where it lies behind the origin, as the ball does on which the rays start.
            let is_ahead = middle.simd_gt(zero) | half_squared.simd_gt(middle * middle);
            let met = ahead.rays(simd, number) & half_squared.simd_gt(zero) & is_ahead;
            if !met.any_true() {
                continue;
            }
            let half = half_squared.sqrt();
            let (enter, leave) = (middle - half, middle + half);
            let within =
                (enter.simd_gt(zero) & enter.simd_lt(t_max)) | (leave.simd_gt(zero) & leave.simd_lt(t_max));
            clear &= !(met & within);
            if !clear.any_true() {
                break;
            }
        }
        for sheet in self.sheets.iter().filter(|sheet| sheet.opaque) {
            tests += 1;
            let Some(t) = sheet.meet(simd, o, d, clear) else { continue };
            let near = clear & t.simd_gt(zero) & t.simd_lt(t_max);
            if near.any_true() {
                clear &= !(near & sheet.holds(simd, o, d, t));
            }
        }
        counters.tests += tests * u64::from(live.to_bitmask().count_ones());
        if !self.others.is_empty() && clear.any_true() {
            clear = self.clear_of_others(simd, objects, o, d, t_max, clear, counters);
        }
        live & !clear
    }

    #[inline(always)]
    fn clear_of_others<S: Simd>(
        &self,
        simd: S,
        objects: &[Object<'_>],
        o: V<S>,
        d: V<S>,
        t_max: F<S>,
        mut clear: M<S>,
        counters: &mut Counters,
    ) -> M<S> {
        let reciprocal = reciprocal(simd, d);
        for other in &self.others {
            let object = &objects[other.object as usize];
            if !object.opaque {
                continue;
            }
            let met = clear & other.meet(simd, o, reciprocal, F::splat(simd, 0.0), t_max);
            counters.nodes += u64::from(clear.to_bitmask().count_ones());
            if !met.any_true() {
                continue;
            }
            let (o, d, t_max) = (o.to_array(), d.to_array(), t_max.to_array());
            let mut blocked = 0u64;
            for lane in lanes_of(met.to_bitmask()) {
                let ray = Ray { origin: o[lane], direction: d[lane], t_min: 0.0, t_max: t_max[lane] };
                blocked |= u64::from(object.blocks(other.object, &ray, counters, &|_| true)) << lane;
            }
            clear &= !M::from_bitmask(simd, blocked);
        }
        clear
    }

    /// Which rays pass through the box of something opaque made of patches before `t_max`.
    #[inline(always)]
    pub(super) fn meet_patched<S: Simd>(&self, simd: S, o: V<S>, d: V<S>, t_max: F<S>) -> M<S> {
        let (zero, reciprocal) = (F::splat(simd, 0.0), reciprocal(simd, d));
        let mut met = M::splat(simd, false);
        for other in self.patched.iter().filter(|other| other.is_opaque) {
            met |= other.meet(simd, o, reciprocal, zero, t_max);
        }
        met
    }

    /// The hit of a ray with what has this rank.
    pub(super) fn hit(&self, rank: usize, t: f64, other: &Hit) -> Hit {
        let Rank { kind, object, part, .. } = self.ranks[rank];
        match kind {
            Kind::Other | Kind::Patches => *other,
            Kind::Ball | Kind::Sheet => Hit { object, crossing: Crossing { t, part, uv: DVec2::ZERO } },
        }
    }
}

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    fn is_before(&self, t: F<S>, rank: F<S>) -> M<S> {
        t.simd_lt(self.t) | (t.simd_eq(self.t) & rank.simd_lt(self.rank))
    }

    #[inline(always)]
    fn take(&mut self, met: M<S>, t: F<S>, rank: F<S>) {
        let nearer = met & self.is_before(t, rank);
        self.t = nearer.select(t, self.t);
        self.rank = nearer.select(rank, self.rank);
    }
}

impl Default for Ahead {
    #[inline(always)]
    fn default() -> Self {
        Self { balls: 0, rays: [0; 64] }
    }
}

impl Ahead {
    #[inline(always)]
    fn put<S: Simd>(&mut self, number: usize, met: M<S>) {
        let rays = met.to_bitmask();
        self.balls |= u64::from(rays != 0) << (number % 64);
        self.rays[number % 64] = rays as u8;
    }

    /// The rays that may meet this ball.
    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, number: usize) -> M<S> {
        M::from_bitmask(simd, u64::from(self.rays[number % 64]))
    }
}

impl Sight {
    /// Which balls lie along unit directions from the place.
    #[inline(always)]
    fn balls_along<S: Simd>(&self, simd: S, d: V<S>, live: M<S>) -> Ahead {
        let mut ahead = Ahead::default();
        for (number, cone) in self.0.iter().enumerate() {
            let along = V::splat(simd, cone.to_center).dot(d);
            ahead.put(number, live & along.simd_gt(F::splat(simd, cone.least)));
        }
        ahead
    }
}

impl Ball {
    /// The middle of the stretch of a line of unit direction within the ball, and the square of half
    /// its length; see [`crate::Sphere`].
    #[inline(always)]
    fn chord<S: Simd>(&self, simd: S, o: V<S>, d: V<S>) -> (F<S>, F<S>) {
        let to_center = V::splat(simd, self.center).sub(o);
        let middle = to_center.dot(d);
        let nearest = to_center.sub(d.times(middle));
        (middle, F::splat(simd, self.radius_squared) - nearest.dot(nearest))
    }
}

impl Sheet {
    /// Where the lines meet the plane, infinite or no number where they are parallel to it; `None` when
    /// all live ones meet it behind their origin, if at all.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, o: V<S>, d: V<S>, live: M<S>) -> Option<F<S>> {
        let normal = V::splat(simd, self.normal);
        let (height, fall) = (F::splat(simd, self.distance) - normal.dot(o), normal.dot(d));
        let zero = F::splat(simd, 0.0);
        let ahead = height.simd_gt(zero) & fall.simd_gt(zero) | height.simd_lt(zero) & fall.simd_lt(zero);
        (live & ahead).any_true().then_some(height / fall)
    }

    /// Whether the places at t are in the outline.
    #[inline(always)]
    fn holds<S: Simd>(&self, simd: S, o: V<S>, d: V<S>, t: F<S>) -> M<S> {
        let (zero, one) = (F::splat(simd, 0.0), F::splat(simd, 1.0));
        match &self.outline {
            Outline::Endless => t.simd_lt(F::splat(simd, f64::INFINITY)),
            Outline::Square(coordinates) => {
                let p = o.add(d.times(t));
                let (u, v) = (coordinates[0].at(simd, p), coordinates[1].at(simd, p));
                u.simd_ge(zero) & u.simd_le(one) & v.simd_ge(zero) & v.simd_le(one)
            }
            Outline::Ring(coordinates, inner) => {
                let p = o.add(d.times(t));
                let (u, v) = (coordinates[0].at(simd, p), coordinates[1].at(simd, p));
                let squared = u * u + v * v;
                squared.simd_le(one) & squared.simd_ge(F::splat(simd, *inner))
            }
            Outline::Triangle(corners) => passes_through(simd, o, d, corners),
        }
    }
}

impl Coordinate {
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, p: V<S>) -> F<S> {
        V::splat(simd, self.along).dot(p) + F::splat(simd, self.offset)
    }
}

/// Whether lines pass through a triangle. On which side of an edge a line passes is computed from the
/// edge's ends and the line alone, and for both directions of the edge with the same digits, so nothing
/// slips through between neighbours.
#[inline(always)]
fn passes_through<S: Simd>(simd: S, o: V<S>, d: V<S>, corners: &[DVec3; 3]) -> M<S> {
    let zero = F::splat(simd, 0.0);
    let [a, b, c] = channels!(k => V::splat(simd, corners[k]).sub(o));
    let (u, v, w) = (d.dot(a.cross(b)), d.dot(b.cross(c)), d.dot(c.cross(a)));
    (u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero))
        | (u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero))
}

/// 1 / direction, finite where a component is 0.
#[inline(always)]
pub(super) fn reciprocal<S: Simd>(simd: S, d: V<S>) -> V<S> {
    V { x: one_over(simd, d.x), y: one_over(simd, d.y), z: one_over(simd, d.z) }
}

#[inline(always)]
fn one_over<S: Simd>(simd: S, x: F<S>) -> F<S> {
    let tiny = F::splat(simd, 1e-300);
    F::splat(simd, 1.0) / x.simd_eq(F::splat(simd, 0.0)).select(tiny, x)
}

impl Other {
    /// Whether rays pass through the box between two parameters.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&self, simd: S, o: V<S>, reciprocal: V<S>, t_min: F<S>, t_max: F<S>) -> M<S> {
        let (mut enter, mut leave) = (t_min, t_max);
        let (min, max) = (self.bounds.min, self.bounds.max);
        for (o, reciprocal, min, max) in [
            (o.x, reciprocal.x, min.x, max.x),
            (o.y, reciprocal.y, min.y, max.y),
            (o.z, reciprocal.z, min.z, max.z),
        ] {
            let t1 = (F::splat(simd, min) - o) * reciprocal;
            let t2 = (F::splat(simd, max) - o) * reciprocal;
            let upward = t1.simd_lt(t2);
            enter = larger(upward.select(t1, t2), enter);
            let far = upward.select(t2, t1);
            leave = far.simd_lt(leave).select(far, leave);
        }
        enter.simd_le(leave)
    }
}

/// The factor by which an object is enlarged, where it is turned and enlarged alike in all directions.
fn uniform_scale(object: &Object<'_>) -> Option<f64> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| object.world_from_object.transform_vector3(axis));
    let scale = axes[0].length();
    let alike = axes.iter().all(|axis| (axis.length() / scale - 1.0).abs() < 1e-14);
    let upright = [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| {
        let skew: f64 = axes[i].dot(axes[j]);
        skew.abs() < 1e-14 * scale * scale
    });
    (alike && upright && scale > 0.0).then_some(scale)
}

/// Two triangles that make a parallelogram with one picture over it, as the one at its first corner.
fn parallelogram(a: &FlatTriangle, b: &FlatTriangle) -> Option<FlatTriangle> {
    if a.surface != b.surface {
        return None;
    }
    // The corner of `a` that `b` does not have is opposite to the diagonal.
    let first = (0..3).find(|&i| !b.corners.contains(&a.corners[i]))?;
    let [p, q, r] = [first, (first + 1) % 3, (first + 2) % 3];
    let opposite = (0..3).find(|&i| !a.corners.contains(&b.corners[i]))?;
    let shared = b.corners.contains(&a.corners[q]) && b.corners.contains(&a.corners[r]);
    let place = a.corners[q] + a.corners[r] - a.corners[p] == b.corners[opposite];
    let picture = a.texcoords[q] + a.texcoords[r] - a.texcoords[p] == b.texcoords[opposite];
    let same =
        |i: usize| b.corners.iter().zip(b.texcoords).any(|(c, t)| *c == a.corners[i] && t == a.texcoords[i]);
    (shared && place && picture && same(q) && same(r)).then(|| FlatTriangle {
        corners: [p, q, r].map(|i| a.corners[i]),
        texcoords: [p, q, r].map(|i| a.texcoords[i]),
        surface: a.surface,
    })
}

/// A hit to fill lists with.
pub(super) const NO_HIT: Hit =
    Hit { object: u32::MAX, crossing: Crossing { t: f64::INFINITY, part: 0, uv: DVec2::ZERO } };

const _: () = assert!(LANES == 8, "masks have a bit per lane");
