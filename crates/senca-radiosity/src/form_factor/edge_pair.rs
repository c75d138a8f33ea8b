//! The double integral of ln r over two edges: what a form factor of polygons is summed from.
//!
//! r is the distance of a place on one edge to a place on the other. Where the lines of the edges are
//! skew, let s and t run along them from the feet of their common perpendicular, of length d, at the
//! angle w between them. Then r^2 = Q + d^2 with Q = s^2 + t^2 - 2 s t cos w, and
//!
//! 1. the field (s, t) g(Q), g = (ln(Q + d^2) - 1 + d^2 ln(1 + Q/d^2) / Q) / 4, has the divergence ln r,
//!    so the integral over the rectangle of (s, t) is one along its four sides;
//! 2. on a side, the part with ln(Q + d^2) is elementary, and with tan p = (t - s cos w) / (s sin w) and
//!    k = s sin w / d the rest is d^2 / sin w times the integral of ln(1 + k^2 / cos^2 p) dp;
//! 3. which is Im Li2(-e^(2ip)) - Im Li2(-a e^(2ip)) + 2 p arsinh k, where a = (sqrt(1 + k^2) - k)^2.
//!
//! Of parallel edges all is elementary. Nearly parallel ones have their feet far away, and digits
//! cancel: there the inner integral is taken in closed form and the outer one by quadrature. That a form
//! factor of polygons has a closed form was found by Schröder and Hanrahan 1993, in another way.

use senca_math::glam::DVec3;

use super::dilogarithm::imaginary_dilogarithm;
use super::quadrature::adaptive;

/// An edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) start: DVec3,
    /// Unit vector, zero for an edge without length.
    pub(crate) direction: DVec3,
    pub(crate) length: f64,
}

impl Edge {
    pub(crate) fn new(start: DVec3, end: DVec3) -> Self {
        let along = end - start;
        Self { start, direction: along.normalize_or_zero(), length: along.length() }
    }
}

/// Edges whose lines differ by less than this sine are parallel, but for rounding.
const PARALLEL: f64 = 1e-12;

/// Edges whose lines differ by less than this sine are nearly parallel: the feet are uncertain by the
/// rounding of directions over it.
const NEARLY_PARALLEL: f64 = 1e-3;

/// Terms of the closed form may be larger than the edges' lengths multiplied by this much, which is the
/// precision it loses: where the feet are far away, or the angle is small for the distance.
const LOSS: f64 = 1e3;

/// Integral of ln r over both edges.
pub(crate) fn integral(first: &Edge, second: &Edge) -> f64 {
    if first.length == 0.0 || second.length == 0.0 {
        return 0.0;
    }
    let normal = first.direction.cross(second.direction);
    let sine = normal.length();
    if sine < PARALLEL {
        return of_parallel(first, second);
    }
    let closed = if sine < NEARLY_PARALLEL { None } else { of_skew(first, second, normal, sine) };
    closed.unwrap_or_else(|| by_quadrature(first, second))
}

/// Integral of ln r over both edges, the outer one by quadrature: the plain twin.
pub(crate) fn by_quadrature(first: &Edge, second: &Edge) -> f64 {
    let (short, long) = if first.length <= second.length { (first, second) } else { (second, first) };
    let scale = short.length * long.length;
    if scale == 0.0 {
        return 0.0;
    }
    let inner = |s: f64| of_point(short.start + short.direction * s, long);
    // The ends of the long edge, seen along the short one, are where the integrand bends most.
    let along = |p: DVec3| (p - short.start).dot(short.direction);
    let mut stops = [0.0, along(long.start), along(long.start + long.direction * long.length), short.length];
    stops.iter_mut().for_each(|s| *s = s.clamp(0.0, short.length));
    stops.sort_by(f64::total_cmp);
    let pieces = stops.windows(2).filter(|w| w[1] > w[0]);
    pieces.map(|w| adaptive(&inner, w[0], w[1], 1e-15 * scale)).sum()
}

/// Integral of ln r along an edge, r the distance to a point.
fn of_point(point: DVec3, edge: &Edge) -> f64 {
    let to_start = edge.start - point;
    let height = to_start.cross(edge.direction).length();
    let y = to_start.dot(edge.direction);
    log_integral(y + edge.length, height) - log_integral(y, height)
}

/// Integral over y of ln sqrt(y^2 + height^2).
fn log_integral(y: f64, height: f64) -> f64 {
    let square = y * y + height * height;
    if square == 0.0 {
        return 0.0;
    }
    0.5 * y * square.ln() - y + height * y.atan2(height)
}

fn of_parallel(first: &Edge, second: &Edge) -> f64 {
    let to_start = second.start - first.start;
    let height = to_start.cross(first.direction).length();
    let y = to_start.dot(first.direction);
    let turn = first.direction.dot(second.direction).signum();
    let at = |s: f64, t: f64| twice_log_integral(y + turn * t - s, height);
    let (a, b) = (first.length, second.length);
    -turn * (at(a, b) - at(a, 0.0) - at(0.0, b) + at(0.0, 0.0))
}

/// Integral over y of [`log_integral`].
fn twice_log_integral(y: f64, height: f64) -> f64 {
    let square = y * y + height * height;
    if square == 0.0 {
        return 0.0;
    }
    0.25 * (y * y - height * height) * square.ln() - 0.75 * y * y + height * y * y.atan2(height)
}

/// `None` where the closed form would lose digits.
fn of_skew(first: &Edge, second: &Edge, normal: DVec3, sine: f64) -> Option<f64> {
    let between = second.start - first.start;
    let square = sine * sine;
    let foot_s = between.cross(second.direction).dot(normal) / square;
    let foot_t = between.cross(first.direction).dot(normal) / square;
    let s = [-foot_s, first.length - foot_s];
    let t = [-foot_t, second.length - foot_t];
    let far = [s[0], s[1], t[0], t[1]].iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    let distance = (between.dot(normal) / sine).abs();
    if (far * far).max(distance * distance / sine) > LOSS * first.length * second.length {
        return None;
    }
    let lines = Lines { cosine: first.direction.dot(second.direction), sine, distance };
    let side = |x: f64, [from, to]: [f64; 2]| lines.along_side(x, to) - lines.along_side(x, from);
    Some(side(s[1], t) - side(s[0], t) + side(t[1], s) - side(t[0], s))
}

/// Two skew lines: the angle between them, and their distance.
struct Lines {
    cosine: f64,
    sine: f64,
    distance: f64,
}

impl Lines {
    /// Integral of `x g(Q)` along the side of the rectangle on which one coordinate is `x`, from the
    /// place nearest to the origin to where the other is `end`.
    fn along_side(&self, x: f64, end: f64) -> f64 {
        let y = end - x * self.cosine;
        let m = x.abs() * self.sine;
        let d = self.distance;
        let reach = m.hypot(d);
        let square = y * y + reach * reach;
        if square == 0.0 {
            return 0.0;
        }
        let elementary = x * (y * square.ln() - 3.0 * y + 2.0 * reach * y.atan2(reach));
        let rest = d * d / self.sine * x.signum() * turned_logarithm(y, m, d, reach);
        0.25 * (elementary + rest)
    }
}

/// Integral of ln(1 + (m/d)^2 / cos^2 p) over p from 0 to atan(y/m); `reach` is sqrt(m^2 + d^2).
fn turned_logarithm(y: f64, m: f64, d: f64, reach: f64) -> f64 {
    if m == 0.0 || y == 0.0 || d == 0.0 {
        return 0.0;
    }
    let square = y * y + m * m;
    let (re, im) = ((m * m - y * y) / square, 2.0 * m * y / square);
    let shrink = d / (m + reach);
    let a = shrink * shrink;
    imaginary_dilogarithm(-re, -im) - imaginary_dilogarithm(-a * re, -a * im) - 2.0 * y.atan2(m) * shrink.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn edge(a: [f64; 3], b: [f64; 3]) -> Edge {
        Edge::new(DVec3::from(a), DVec3::from(b))
    }

    #[test]
    fn a_common_edge_has_the_known_integral() {
        // Of ln |s - t| over the unit square: -3/2.
        let e = edge([0.0; 3], [0.0, 1.0, 0.0]);
        assert!((integral(&e, &e) + 1.5).abs() < 1e-15);
        let back = edge([0.0, 1.0, 0.0], [0.0; 3]);
        assert!((integral(&e, &back) + 1.5).abs() < 1e-15);
        assert!((by_quadrature(&e, &e) + 1.5).abs() < 1e-13);
    }

    #[test]
    fn edges_that_meet_crossed_and_skew_agree_with_quadrature() {
        let first = edge([0.0; 3], [1.0, 0.0, 0.0]);
        let others = [
            edge([0.0; 3], [0.0, 1.0, 0.0]),
            edge([1.0, 0.0, 0.0], [2.0, 2.0, 0.0]),
            edge([0.5, -1.0, 0.0], [0.5, 1.0, 0.0]),
            edge([0.5, -1.0, 1e-9], [0.5, 1.0, 1e-9]),
            edge([0.3, -1.0, 0.5], [0.9, 1.0, 0.7]),
            edge([0.0, 0.0, 1.0], [0.0, 1.0, 1.0]),
            edge([3.0, 0.0, 0.0], [4.0, 1e-3, 0.0]),
            edge([0.0, 0.1, 0.0], [2.0, 0.1, 1e-7]),
            edge([0.0, 0.1, 0.2], [1.0, 0.1, 0.2]),
        ];
        for other in others {
            let (closed, plain) = (integral(&first, &other), by_quadrature(&first, &other));
            assert!((closed - plain).abs() < 1e-13, "{other:?}: {closed} {plain}");
        }
    }

    fn place() -> impl Strategy<Value = [f64; 3]> {
        [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64]
    }

    proptest! {
        #[test]
        fn any_two_edges_agree_with_quadrature(a in place(), b in place(), c in place(), d in place()) {
            let (first, second) = (edge(a, b), edge(c, d));
            let (closed, plain) = (integral(&first, &second), by_quadrature(&first, &second));
            prop_assert!((closed - plain).abs() < 1e-12, "{closed} {plain}");
        }
    }
}
