//! NURBS surfaces.
//!
//! Every span between two different knots is divided evenly, in as many steps as its bend asks for.
//! Borders that coincide share their points, borders that shrink to a point become one.

use senca_math::glam::{DVec2, DVec3, DVec4};

use super::build::Builder;
use super::solids::{chord_steps, within_budget};
use super::{ShapeError, TessellationSettings, Tolerance};
use crate::NurbsSurface;

/// Highest degree that is accepted.
const MAX_DEGREE: usize = 24;

/// Most steps in one span.
const MAX_SPAN_STEPS: u32 = 256;

/// Appends the mesh of a NURBS surface.
pub(super) fn nurbs(
    s: &NurbsSurface,
    settings: &TessellationSettings,
    b: &mut Builder,
) -> Result<(), ShapeError> {
    check(s).map_err(|reason| ShapeError::Malformed { shape: "NURBS surface", reason })?;
    let tolerance = settings.tolerance.over(&s.points);
    let steps = match settings.tolerance {
        Tolerance::Steps(u, v) => [u, v].map(|n| n.clamp(1, MAX_SPAN_STEPS)),
        _ => [0, 1].map(|axis| span_steps(s, axis, tolerance.unwrap_or(f64::INFINITY))),
    };
    let spans = [0, 1].map(|axis| spans(s, axis));
    let all = [0, 1].map(|axis| steps[axis].saturating_mul(spans[axis].len() as u32));
    let kept = within_budget(all[0], all[1], (spans[0].len() as u32, spans[1].len() as u32));
    let per_span = |kept: u32, axis: usize| (kept / spans[axis].len() as u32).max(1);
    let us = parameters(&spans[0], per_span(kept.0, 0));
    let vs = parameters(&spans[1], per_span(kept.1, 1));
    add_grid(s, &us, &vs, b);
    Ok(())
}

/// What keeps the numbers from being a surface.
fn check(s: &NurbsSurface) -> Result<(), String> {
    for (axis, name) in ["u", "v"].into_iter().enumerate() {
        let (degree, count, knots) = (s.degree[axis], s.counts[axis], &s.knots[axis]);
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(format!("degree {degree} in {name} is not in 1 to {MAX_DEGREE}"));
        }
        if count <= degree || count > u32::MAX as usize / 2 {
            return Err(format!(
                "{count} control points in {name} are too few for degree {degree} or too many"
            ));
        }
        if knots.len() != count + degree + 1 {
            return Err(format!(
                "{} knots in {name}, but {count} control points of degree {degree} need {}",
                knots.len(),
                count + degree + 1
            ));
        }
        if !knots.iter().all(|k| k.is_finite()) || knots.windows(2).any(|k| k[0] > k[1]) {
            return Err(format!("knots in {name} must be finite and must not decrease"));
        }
        if knots[degree] >= knots[count] {
            return Err(format!("knots in {name} leave no interval to draw"));
        }
    }
    let wanted = s.counts[0].checked_mul(s.counts[1]);
    if wanted != Some(s.points.len()) {
        return Err(format!(
            "{} control points, but {} by {} are announced",
            s.points.len(),
            s.counts[0],
            s.counts[1]
        ));
    }
    if !s.weights.is_empty() && s.weights.len() != s.points.len() {
        return Err(format!("{} weights for {} control points", s.weights.len(), s.points.len()));
    }
    if !s.weights.iter().all(|w| *w > 0.0 && w.is_finite()) || !s.points.iter().all(|p| p.is_finite()) {
        return Err("control points must be finite and weights above 0".to_owned());
    }
    Ok(())
}

/// Intervals between different knots where the surface is defined.
fn spans(s: &NurbsSurface, axis: usize) -> Vec<[f64; 2]> {
    let knots = &s.knots[axis][s.degree[axis]..=s.counts[axis]];
    knots.windows(2).filter(|k| k[0] < k[1]).map(|k| [k[0], k[1]]).collect()
}

/// Parameters of all grid lines.
fn parameters(spans: &[[f64; 2]], steps: u32) -> Vec<f64> {
    let inside = spans
        .iter()
        .flat_map(|&[a, b]| (0..steps).map(move |i| a + (b - a) * f64::from(i) / f64::from(steps)));
    inside.chain(spans.last().map(|span| span[1])).collect()
}

/// Steps per span: the largest second difference over quarter spans, on a few lines across, tells
/// the second derivative; both directions share the tolerance.
fn span_steps(s: &NurbsSurface, axis: usize, tolerance: f64) -> u32 {
    let across = parameters(&spans(s, 1 - axis), 2);
    let thinned = across.len().div_ceil(64).max(1);
    let mut second = 0.0f64;
    for [a, b] in spans(s, axis) {
        for &c in across.iter().step_by(thinned) {
            let at = |i: u32| {
                let t = a + (b - a) * f64::from(i) / 4.0;
                let uv = if axis == 0 { DVec2::new(t, c) } else { DVec2::new(c, t) };
                Evaluation::at(s, uv).point
            };
            let p = [0, 1, 2, 3, 4].map(at);
            for i in 0..3 {
                second = second.max(16.0 * (p[i] - 2.0 * p[i + 1] + p[i + 2]).length());
            }
        }
    }
    chord_steps(3.0 * second, tolerance, MAX_SPAN_STEPS).max(if s.degree[axis] > 1 { 2 } else { 1 })
}

/// Place and derivatives at a parameter.
struct Evaluation {
    point: DVec3,
    du: DVec3,
    dv: DVec3,
}

/// Index of the span of `t` and the values and first derivatives of the basis functions there
/// (Cox 1972, de Boor 1972).
fn basis(knots: &[f64], degree: usize, count: usize, t: f64) -> (usize, [[f64; MAX_DEGREE + 1]; 2]) {
    let span = knots[..=count].partition_point(|&k| k <= t).clamp(degree + 1, count) - 1;
    let mut values = [0.0; MAX_DEGREE + 1];
    let mut slopes = [0.0; MAX_DEGREE + 1];
    values[0] = 1.0;
    for p in 1..=degree {
        let before = values;
        values = [0.0; MAX_DEGREE + 1];
        slopes = [0.0; MAX_DEGREE + 1];
        for r in 0..p {
            let (low, high) = (knots[span + 1 + r - p], knots[span + 1 + r]);
            let width = high - low;
            let share = if width > 0.0 { before[r] / width } else { 0.0 };
            values[r] += (high - t) * share;
            values[r + 1] += (t - low) * share;
            slopes[r] -= p as f64 * share;
            slopes[r + 1] += p as f64 * share;
        }
    }
    (span, [values, slopes])
}

impl Evaluation {
    fn at(s: &NurbsSurface, uv: DVec2) -> Self {
        let (span_u, [bu, su]) = basis(&s.knots[0], s.degree[0], s.counts[0], uv.x);
        let (span_v, [bv, sv]) = basis(&s.knots[1], s.degree[1], s.counts[1], uv.y);
        let (mut h, mut hu, mut hv) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
        for j in 0..=s.degree[1] {
            let row = (span_v - s.degree[1] + j) * s.counts[0] + span_u - s.degree[0];
            let (mut across, mut slope) = (DVec4::ZERO, DVec4::ZERO);
            for i in 0..=s.degree[0] {
                let w = s.weights.get(row + i).copied().unwrap_or(1.0);
                let p = (s.points[row + i] * w).extend(w);
                across += p * bu[i];
                slope += p * su[i];
            }
            h += across * bv[j];
            hu += slope * bv[j];
            hv += across * sv[j];
        }
        let point = h.truncate() / h.w;
        let derivative = |d: DVec4| (d.truncate() - point * d.w) / h.w;
        Self { point, du: derivative(hu), dv: derivative(hv) }
    }
}

/// Unit normal; at collapsed borders the limit from inside.
fn normal(s: &NurbsSurface, uv: DVec2, low: DVec2, high: DVec2) -> DVec3 {
    for inward in [0.0, 1e-6, 1e-4, 1e-2, 0.1] {
        let at = Evaluation::at(s, uv.lerp(0.5 * (low + high), inward));
        let cross = at.du.cross(at.dv);
        let size = at.du.length().max(at.dv.length());
        if cross.length() > 1e-9 * size * size {
            return cross.normalize();
        }
    }
    DVec3::Y
}

/// Appends the grid of all parameter lines.
fn add_grid(s: &NurbsSurface, us: &[f64], vs: &[f64], b: &mut Builder) {
    let surface = b.surface("");
    let (low, high) = (DVec2::new(us[0], vs[0]), DVec2::new(us[us.len() - 1], vs[vs.len() - 1]));
    let places: Vec<Vec<DVec3>> =
        vs.iter().map(|&v| us.iter().map(|&u| Evaluation::at(s, DVec2::new(u, v)).point).collect()).collect();
    let merged = Borders::of(&places);
    let mut points: Vec<Vec<u32>> = Vec::new();
    let mut first_vertex = Vec::new();
    for (j, row) in places.iter().enumerate() {
        let mut ids: Vec<u32> = Vec::with_capacity(row.len());
        first_vertex.push(b.mesh.vertices.point.len() as u32);
        for (i, &place) in row.iter().enumerate() {
            let (i0, j0) = merged.leader(i, j);
            let id = if (i0, j0) == (i, j) {
                b.point(place)
            } else if j0 == j {
                ids[i0]
            } else {
                points[j0][i0]
            };
            ids.push(id);
            let uv = DVec2::new(us[i], vs[j]);
            b.vertex(id, normal(s, uv, low, high), (uv - low) / (high - low));
        }
        points.push(ids);
    }
    for j in 0..vs.len() - 1 {
        for i in 0..us.len() as u32 - 1 {
            let (a, c) = (first_vertex[j] + i, first_vertex[j + 1] + i);
            b.quad([a, a + 1, c + 1, c], surface);
        }
    }
}

/// Which borders of a grid coincide.
struct Borders {
    last: [usize; 2],
    /// The last column is the first; the last row is the first.
    closed: [bool; 2],
    /// First and last row, first and last column, are each one point.
    shrunk: [bool; 4],
}

impl Borders {
    fn of(places: &[Vec<DVec3>]) -> Self {
        let last = [places[0].len() - 1, places.len() - 1];
        let size = places.iter().flatten().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let same = |a: DVec3, b: DVec3| a.distance(b) <= 1e-9 * size;
        let row = |j: usize| places[j].iter().all(|&p| same(p, places[j][0]));
        let column = |i: usize| places.iter().all(|row| same(row[i], places[0][i]));
        let closed_u = places.iter().all(|row| same(row[0], row[last[0]]));
        let closed_v = places[0].iter().zip(&places[last[1]]).all(|(&a, &b)| same(a, b));
        Self {
            last,
            closed: [closed_u, closed_v],
            shrunk: [row(0), row(last[1]), column(0), column(last[0])],
        }
    }

    /// The grid point, at the latest the given one, that stands for `(i, j)`.
    fn leader(&self, mut i: usize, mut j: usize) -> (usize, usize) {
        if self.closed[0] && i == self.last[0] {
            i = 0;
        }
        if self.closed[1] && j == self.last[1] {
            j = 0;
        }
        if (self.shrunk[0] && j == 0) || (self.shrunk[1] && j == self.last[1]) {
            i = 0;
        }
        if (self.shrunk[2] && i == 0) || (self.shrunk[3] && i == self.last[0]) {
            j = 0;
        }
        (i, j)
    }
}
