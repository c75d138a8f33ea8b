//! A line and a piece of a profile.

use senca_math::Aabb;
use senca_math::glam::DVec2;
use senca_math::roots::bernstein_roots;
use smallvec::SmallVec;

use super::profile::Piece;
use crate::Ray;

/// Rise over run below which pieces are cut before their equation is set up.
const NEARLY_LEVEL: f64 = 1e-3;

/// Square of the run over the rise below which a line counts as parallel to the axis. Over the height of
/// the surface it then strays by less than 10^-10 of it.
const UPRIGHT: f64 = 1e-20;

/// Bernstein coefficients of the degree-6 product of two cubics: weights of the products of their
/// coefficients, C(3, i) C(3, j) / C(6, i + j).
const PRODUCT: [[f64; 4]; 4] =
    [[1.0, 0.5, 0.2, 0.05], [0.5, 0.6, 0.45, 0.2], [0.2, 0.45, 0.6, 0.5], [0.05, 0.2, 0.5, 1.0]];

/// A line as the axis sees it.
pub(super) struct AxialRay {
    /// Origin and direction across the axis, `(x, z)`, and along it.
    across: [DVec2; 2],
    along: [f64; 2],
    /// Square of the direction's part across the axis.
    run_squared: f64,
    /// Square of the distance from the axis.
    distance_squared: f64,
    /// Height at the point nearest to the axis, and the ray's parameter there.
    height: f64,
    middle: f64,
    /// Run over rise: infinite for level lines, 0 for upright ones.
    flatness: f64,
}

impl AxialRay {
    pub(super) fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let across = |v: senca_math::glam::DVec3| DVec2::new(v.x, v.z);
        let (o, d) = (across(ray.origin), across(ray.direction));
        let rise = ray.direction.y;
        let run_squared = d.length_squared();
        let mut axial = Self {
            across: [o, d],
            along: [ray.origin.y, rise],
            run_squared,
            distance_squared: 0.0,
            height: 0.0,
            middle: 0.0,
            flatness: 0.0,
        };
        if run_squared <= UPRIGHT * rise * rise {
            axial.middle = (bounds.center().y - ray.origin.y) / rise;
            axial.height = bounds.center().y;
            axial.distance_squared = (o + axial.middle * d).length_squared();
        } else {
            let cross = o.perp_dot(d);
            axial.distance_squared = cross * cross / run_squared;
            axial.middle = -o.dot(d) / run_squared;
            axial.height = ray.origin.y + axial.middle * rise;
            axial.flatness = run_squared.sqrt() / rise.abs();
        }
        axial
    }

    /// Calls `meet` with the ray's parameter and the piece's at every crossing.
    pub(super) fn each_crossing(&self, piece: &Piece, meet: &mut impl FnMut(f64, f64)) {
        // Nothing where the line passes the piece too far out, above or below.
        let reach_squared = piece.reach * piece.reach - self.distance_squared;
        if reach_squared <= 0.0 || reach_squared.is_nan() {
            return;
        }
        if self.along[1] == 0.0 {
            return self.level_crossings(piece, meet);
        }
        if self.flatness == 0.0 {
            return self.roots_within(piece, 0.0, 1.0, meet);
        }
        // Padded, so that the equation is surely negative where heights are out of reach.
        let rounding =
            4.0 * f64::EPSILON * (piece.heights[0].abs() + piece.heights[1].abs() + self.height.abs());
        let band = reach_squared.sqrt() / self.flatness * (1.0 + 1e-9) + rounding;
        let [low, high] = [self.height - band, self.height + band];
        if piece.heights[1] < low || piece.heights[0] > high {
            return;
        }
        if self.flatness * NEARLY_LEVEL < 1.0 {
            return self.roots_within(piece, 0.0, 1.0, meet);
        }
        for [start, end] in stretches_within(piece, low, high) {
            self.roots_within(piece, start, end, meet);
        }
    }

    /// Roots of the equation on a stretch of the piece.
    fn roots_within(&self, piece: &Piece, start: f64, end: f64, meet: &mut impl FnMut(f64, f64)) {
        let points = cut(piece, start, end);
        let radii = points.map(|p| p.x);
        let rises = points.map(|p| (p.y - self.height) * self.flatness);
        let mut found = |s: f64| self.refined(piece, start + s * (end - start), meet);
        if piece.straight {
            let product = |f: [f64; 4]| [f[0] * f[0], f[0] * f[3], f[3] * f[3]];
            let (radii, rises) = (product(radii), product(rises));
            let h: [f64; 3] = std::array::from_fn(|i| radii[i] - self.distance_squared - rises[i]);
            bernstein_roots(&without_zeros_on_axis(h, &points), &mut found);
        } else {
            let (radii, rises) = (square(radii), square(rises));
            let h: [f64; 7] = std::array::from_fn(|i| radii[i] - self.distance_squared - rises[i]);
            bernstein_roots(&without_zeros_on_axis(h, &points), &mut found);
        }
    }

    /// A level line meets a piece where it has the line's height, twice.
    fn level_crossings(&self, piece: &Piece, meet: &mut impl FnMut(f64, f64)) {
        let offset = |p: DVec2| p.y - self.along[0];
        let mut found = |s: f64| {
            let radius = piece.at(s).x;
            let half_squared = (radius * radius - self.distance_squared) / self.run_squared;
            if half_squared > 0.0 {
                let half = half_squared.sqrt();
                meet(self.middle - half, s);
                meet(self.middle + half, s);
            }
        };
        roots_of_height(piece, offset, &mut found);
    }

    /// The ray's parameter at the root s, after steps of Newton's method on both equations
    /// `y(s) = oy + t dy` and `r(s)^2 = |o + t d|^2`.
    fn refined(&self, piece: &Piece, s: f64, meet: &mut impl FnMut(f64, f64)) {
        let ([o, d], [oy, dy]) = (self.across, self.along);
        let place = piece.at(s);
        let mut t = if dy * dy >= self.run_squared {
            (place.y - oy) / dy
        } else {
            let half = ((place.x * place.x - self.distance_squared).max(0.0) / self.run_squared).sqrt();
            if (place.y - self.height) * dy < 0.0 { self.middle - half } else { self.middle + half }
        };
        let mut s = s;
        for _ in 0..2 {
            let (place, slope) = (piece.at(s), piece.slope(s));
            let across = o + t * d;
            let off = [place.y - (oy + t * dy), place.x * place.x - across.length_squared()];
            // Columns: derivatives along s and along t.
            let (a, b) = ([slope.y, 2.0 * place.x * slope.x], [-dy, -2.0 * across.dot(d)]);
            let determinant = a[0] * b[1] - a[1] * b[0];
            let step_s = (off[0] * b[1] - off[1] * b[0]) / determinant;
            let step_t = (a[0] * off[1] - a[1] * off[0]) / determinant;
            // Near a touch the two equations hardly differ; there the root stays as it is.
            let small = step_s.abs() < 1e-4 && (0.0..=1.0).contains(&(s - step_s));
            if !small || !step_t.is_finite() {
                break;
            }
            (s, t) = (s - step_s, t - step_t);
        }
        meet(t, s);
    }
}

/// On the axis the equation is nowhere positive, and an end there never inside: a zero counts as negative.
fn without_zeros_on_axis<const N: usize>(mut h: [f64; N], points: &[DVec2; 4]) -> [f64; N] {
    for (end, point) in [(0, points[0]), (N - 1, points[3])] {
        if point.x == 0.0 && h[end] == 0.0 {
            h[end] = -f64::MIN_POSITIVE;
        }
    }
    h
}

/// Control points of the stretch of a piece between two parameters; at 0 and 1 exactly the ends.
fn cut(piece: &Piece, start: f64, end: f64) -> [DVec2; 4] {
    if start == 0.0 && end == 1.0 {
        return piece.points;
    }
    // The polar form of the cubic, with each argument either start or end.
    let [a, b, c, d] = piece.points;
    let blossom = |u: f64, v: f64, w: f64| {
        let (ab, bc, cd) = (a.lerp(b, u), b.lerp(c, u), c.lerp(d, u));
        ab.lerp(bc, v).lerp(bc.lerp(cd, v), w)
    };
    let first = if start == 0.0 { a } else { piece.at(start) };
    let last = if end == 1.0 { d } else { piece.at(end) };
    [first, blossom(start, start, end), blossom(start, end, end), last]
}

/// Stretches of a piece with heights in a band.
fn stretches_within(piece: &Piece, low: f64, high: f64) -> SmallVec<[[f64; 2]; 4]> {
    let mut cuts: SmallVec<[f64; 8]> = SmallVec::new();
    cuts.push(0.0);
    roots_of_height(piece, |p| p.y - low, &mut |s| cuts.push(s));
    roots_of_height(piece, |p| p.y - high, &mut |s| cuts.push(s));
    cuts.push(1.0);
    cuts.sort_by(f64::total_cmp);
    let pairs = cuts.windows(2).map(|pair| [pair[0], pair[1]]);
    let inside = |pair: &[f64; 2]| (low..=high).contains(&piece.at(0.5 * (pair[0] + pair[1])).y);
    pairs.filter(|pair| pair[0] < pair[1] && inside(pair)).collect()
}

/// Calls `found` where the height, offset as given, changes its sign.
fn roots_of_height(piece: &Piece, offset: impl Fn(DVec2) -> f64, found: &mut impl FnMut(f64)) {
    if piece.straight {
        bernstein_roots(&[offset(piece.points[0]), offset(piece.points[3])], found);
    } else {
        bernstein_roots(&piece.points.map(offset), found);
    }
}

/// Bernstein coefficients of the square of a cubic.
fn square(f: [f64; 4]) -> [f64; 7] {
    let mut squared = [0.0; 7];
    for (i, row) in PRODUCT.iter().enumerate() {
        for (j, weight) in row.iter().enumerate() {
            squared[i + j] += weight * f[i] * f[j];
        }
    }
    squared
}
