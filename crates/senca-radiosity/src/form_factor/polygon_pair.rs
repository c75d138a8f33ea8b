//! Form factors of two polygons in closed form.

use std::f64::consts::{PI, TAU};

use senca_math::glam::DVec3;
use senca_math::newell_normal;

use super::clip::{Corners, part_above};
use super::edge_pair::{Edge, by_quadrature, integral};
use super::lambert::signed_share;
use super::quadrature::rule;

/// Form factor F_i->j of the plane polygon `from` to the plane polygon `to`, in [0, 1], without
/// obstacles: equation 4.9 of the course text, exact to about 1e-10 of its value. The polygons may share edges,
/// touch, or cut each other's planes, and may be concave (parts of one that hide others are not noticed).
///
/// Only fronts count, which is where corners run counter-clockwise: the part of each polygon behind
/// the other's plane is cut off first. 0 for polygons without area, in one plane, or with corners that
/// are not finite.
///
/// Near polygons are summed over pairs of edges, each in closed form; of far ones, where these sums
/// would cancel, the smaller is integrated over what Lambert's formula gives at its points.
#[must_use]
pub fn polygon_to_polygon(from: &[DVec3], to: &[DVec3]) -> f64 {
    share(exchange(from, to), from)
}

/// As [`polygon_to_polygon`], with the outer of the two integrals along edges by adaptive quadrature
/// and no other way taken: slower, and the check of it.
#[must_use]
pub fn polygon_to_polygon_by_contours(from: &[DVec3], to: &[DVec3]) -> f64 {
    let Some(pair) = Pair::new(from, to) else { return 0.0 };
    let unit = pair.size * pair.size;
    share(pair.facing().map_or(0.0, |p| contours(&p, by_quadrature)) * unit, from)
}

/// Area of `from` times [`polygon_to_polygon`], which is the same in both directions (equation 4.2 of
/// the course text): in units of area.
#[must_use]
pub fn exchange(from: &[DVec3], to: &[DVec3]) -> f64 {
    let swap = comes_before(to, from);
    let (first, second) = if swap { (to, from) } else { (from, to) };
    let Some(pair) = Pair::new(first, second) else { return 0.0 };
    let value = pair.facing().map_or(0.0, |p| p.exchange()) * pair.size * pair.size;
    if value > 0.0 { value } else { 0.0 }
}

fn share(exchange: f64, from: &[DVec3]) -> f64 {
    let share = exchange / newell_normal(from).length();
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}

/// An order of polygons, so that both directions of a pair do the same arithmetic.
fn comes_before(a: &[DVec3], b: &[DVec3]) -> bool {
    let numbers = |p: &DVec3| p.to_array();
    let order = a.iter().flat_map(numbers).zip(b.iter().flat_map(numbers));
    order.map(|(x, y)| x.total_cmp(&y)).find(|o| o.is_ne()).unwrap_or(a.len().cmp(&b.len())).is_lt()
}

/// Two polygons, moved and scaled so that all fits into a ball of radius 1.
struct Pair {
    first: Corners,
    second: Corners,
    /// Length of one unit.
    size: f64,
}

/// Heights above a plane below this are none, in units of the pair's size.
const FLAT: f64 = 1e-12;

impl Pair {
    fn new(first: &[DVec3], second: &[DVec3]) -> Option<Self> {
        let all = || first.iter().chain(second);
        if first.len() < 3 || second.len() < 3 || !all().all(|p| p.is_finite()) {
            return None;
        }
        let low = all().fold(first[0], |low, &p| low.min(p));
        let high = all().fold(first[0], |high, &p| high.max(p));
        let middle = low * 0.5 + high * 0.5;
        let size = all().map(|p| p.distance(middle)).fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let fit = |corners: &[DVec3]| corners.iter().map(|&p| (p - middle) / size).collect();
        Some(Self { first: fit(first), second: fit(second), size })
    }

    /// The parts in front of each other's planes; `None` where there are none.
    fn facing(&self) -> Option<Self> {
        let (n1, n2) =
            (newell_normal(&self.first).try_normalize()?, newell_normal(&self.second).try_normalize()?);
        let (o1, o2) = (self.first[0], self.second[0]);
        let first = part_above(&self.first, FLAT, |p| n2.dot(p - o2));
        let second = part_above(&self.second, FLAT, |p| n1.dot(p - o1));
        let there = first.len() >= 3 && second.len() >= 3;
        there.then_some(Self { first, second, size: self.size })
    }

    fn exchange(&self) -> f64 {
        let balls = [&self.first, &self.second].map(|c| ball(c));
        let (small, large, (center, radius)) = if balls[0].1 <= balls[1].1 {
            (&self.first, &self.second, balls[0])
        } else {
            (&self.second, &self.first, balls[1])
        };
        let gap = distance_to_border(center, large);
        // At 3 radii, 9 places a side give 13 digits.
        if gap > 3.0 * radius { over_points(small, large, gap / radius) } else { contours(self, integral) }
    }
}

/// Mean of the corners, and the distance of the farthest.
fn ball(corners: &[DVec3]) -> (DVec3, f64) {
    let center = corners.iter().sum::<DVec3>() / corners.len() as f64;
    (center, corners.iter().map(|p| p.distance(center)).fold(0.0, f64::max))
}

fn distance_to_border(point: DVec3, corners: &[DVec3]) -> f64 {
    let to_edge = |(a, b): (DVec3, DVec3)| {
        let along = b - a;
        let square = along.length_squared();
        let t = if square > 0.0 { ((point - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        point.distance(a + along * t)
    };
    edges(corners).map(to_edge).fold(f64::INFINITY, f64::min)
}

fn edges(corners: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    corners.iter().enumerate().map(|(k, &a)| (a, corners[(k + 1) % corners.len()]))
}

/// The double integral along both borders, by the theorem of Stokes.
fn contours(pair: &Pair, integral: impl Fn(&Edge, &Edge) -> f64) -> f64 {
    let of = |corners: &[DVec3]| edges(corners).map(|(a, b)| Edge::new(a, b)).collect::<Vec<_>>();
    let (first, second) = (of(&pair.first), of(&pair.second));
    let mut sum = 0.0;
    for a in &first {
        for b in &second {
            let cosine = a.direction.dot(b.direction);
            if cosine != 0.0 {
                sum += cosine * integral(a, b);
            }
        }
    }
    sum / TAU
}

/// The integral over the area of the small polygon of Lambert's formula for the large one. Nothing of
/// the integrand is singular within `reach` radii, so the rules converge by the square of
/// `reach + sqrt(reach^2 - 1)` with each place.
fn over_points(small: &[DVec3], large: &[DVec3], reach: f64) -> f64 {
    let gain = reach + (reach * reach - 1.0).sqrt();
    let places = rule((15.0 / gain.ln()).ceil() as usize + 1);
    let normal = newell_normal(small).normalize_or_zero();
    let origin = small[0];
    let mut sum = 0.0;
    for pair in small[1..].windows(2) {
        let (to_first, across) = (pair[0] - origin, pair[1] - pair[0]);
        let double_area = to_first.cross(across).dot(normal);
        for &[s, weight_s] in places {
            for &[t, weight_t] in places {
                let point = origin + (to_first + across * t) * s;
                sum += weight_s * weight_t * s * double_area * signed_share(point, normal, large);
            }
        }
    }
    sum
}

/// Form factor of two small patches, equation 4.7 of the course text: `from` and `to` are their
/// places, the normals are unit vectors, and `area_to` is the area of the second. 0 where one is
/// behind the other or both are at one place.
#[must_use]
pub fn differential(from: DVec3, normal_from: DVec3, to: DVec3, normal_to: DVec3, area_to: f64) -> f64 {
    let between = to - from;
    let square = between.length_squared();
    let (cos_from, cos_to) = (normal_from.dot(between), -normal_to.dot(between));
    if !(cos_from > 0.0 && cos_to > 0.0 && square > 0.0) {
        return 0.0;
    }
    // The cosines still have the distance in them.
    cos_from / square * (cos_to / square) * area_to / PI
}
