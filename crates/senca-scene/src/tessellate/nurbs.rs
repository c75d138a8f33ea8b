//! NURBS surfaces.
//!
//! Every span between two different knots is divided evenly, in as many steps as the bend of the surface
//! asks for: the bounds of its Bézier pieces ([`Bend`]) in that of Filip, Magedson and Markot (1986) on the
//! distance between a surface and its triangulated grid.
//! Borders that coincide share their points, borders that shrink to a point become one.

use senca_math::glam::{DVec2, DVec3};
use senca_math::{KnotVector, NurbsSurface as Evaluator};

use super::bend::Bend;
use super::build::Builder;
use super::solids::{chord_steps, within_budget};
use super::{MAX_FACES, ShapeError, TessellationSettings, Tolerance};
use crate::NurbsSurface;

/// Most steps in one span.
const MAX_SPAN_STEPS: u32 = 256;

/// Appends the mesh of a NURBS surface.
pub(super) fn nurbs(
    s: &NurbsSurface,
    settings: &TessellationSettings,
    b: &mut Builder,
) -> Result<(), ShapeError> {
    let e = s.evaluator()?;
    let tolerance = settings.tolerance.over(&s.points);
    let spans = [spans(e.knots_u()), spans(e.knots_v())];
    let steps = match settings.tolerance {
        Tolerance::Steps(u, v) => [u, v].map(|n| n.clamp(1, MAX_SPAN_STEPS)),
        _ => {
            let counts = [0, 1].map(|axis| spans[axis].len());
            let steps = span_steps(&e, counts, tolerance.unwrap_or(f64::INFINITY));
            // Two edges with common ends stay apart when both are curved.
            [0, 1].map(|axis| if s.degree[axis] > 1 { steps[axis].max(2) } else { steps[axis] })
        }
    };
    let all = [0, 1].map(|axis| steps[axis].saturating_mul(spans[axis].len() as u32));
    let kept = within_budget(all[0], all[1], (spans[0].len() as u32, spans[1].len() as u32));
    let per_span = |kept: u32, axis: usize| (kept / spans[axis].len() as u32).max(1);
    let us = parameters(&spans[0], per_span(kept.0, 0));
    let vs = parameters(&spans[1], per_span(kept.1, 1));
    add_grid(&e, &us, &vs, b);
    Ok(())
}

impl NurbsSurface {
    /// The surface ready to be evaluated.
    ///
    /// # Errors
    /// [`ShapeError::Malformed`] when knots, counts, points and weights do not make a surface.
    pub fn evaluator(&self) -> Result<Evaluator, ShapeError> {
        evaluator(self).map_err(|reason| ShapeError::Malformed { shape: "NURBS surface", reason })
    }
}

/// The surface ready to be evaluated, or what keeps the numbers from being one.
fn evaluator(s: &NurbsSurface) -> Result<Evaluator, String> {
    let knots = |axis: usize, name: &str| {
        let knots =
            KnotVector::new(s.degree[axis], s.knots[axis].clone()).map_err(|e| format!("in {name}: {e}"))?;
        if knots.point_count() == s.counts[axis] {
            return Ok(knots);
        }
        let (wanted, count) = (knots.point_count(), s.counts[axis]);
        Err(format!(
            "in {name}: the knots and the degree need {wanted} control points, but there are {count}"
        ))
    };
    let (u, v) = (knots(0, "u")?, knots(1, "v")?);
    if s.counts[0] as u64 * s.counts[1] as u64 > MAX_FACES {
        return Err(format!("{} by {} control points are too many", s.counts[0], s.counts[1]));
    }
    let weights = (!s.weights.is_empty()).then_some(s.weights.as_slice());
    Evaluator::new(u, v, &s.points, weights).map_err(|e| e.to_string())
}

/// Intervals between different knots where the surface is defined.
fn spans(knots: &KnotVector) -> Vec<[f64; 2]> {
    let inside = &knots.knots()[knots.degree()..=knots.point_count()];
    inside.windows(2).filter(|k| k[0] < k[1]).map(|k| [k[0], k[1]]).collect()
}

/// Parameters of all grid lines.
fn parameters(spans: &[[f64; 2]], steps: u32) -> Vec<f64> {
    let inside = spans
        .iter()
        .flat_map(|&[a, b]| (0..steps).map(move |i| a + (b - a) * f64::from(i) / f64::from(steps)));
    inside.chain(spans.last().map(|span| span[1])).collect()
}

/// Most pairs of control points, over all Bézier pieces, whose products are looked at: a few seconds.
const MAX_PAIRS: usize = 1 << 26;

/// Steps per span in u and v: the error is at most `(Suu/nu^2 + 2 Suv/(nu nv) + Svv/nv^2) / 8`, and each
/// direction takes half of it. Where there is too much to look at, as many as there can be.
fn span_steps(e: &Evaluator, spans: [usize; 2], tolerance: f64) -> [u32; 2] {
    let per_piece = (e.knots_u().degree() + 1).saturating_mul(e.knots_v().degree() + 1);
    let pairs = spans[0].saturating_mul(spans[1]).saturating_mul(per_piece).saturating_mul(per_piece);
    if pairs > MAX_PAIRS {
        return [MAX_SPAN_STEPS; 2];
    }
    let bend = e.bezier_patches().iter().map(Bend::of).fold(Bend::default(), Bend::max);
    [bend.uu, bend.vv].map(|second| chord_steps(2.0 * (second + bend.uv), tolerance, MAX_SPAN_STEPS))
}

/// Unit normal; where the derivatives vanish the evaluator's limit, which takes longer.
fn normal(e: &Evaluator, uv: DVec2) -> DVec3 {
    let p = e.evaluate(uv.x, uv.y);
    let cross = p.du.cross(p.dv);
    let size = p.du.length().max(p.dv.length());
    if cross.length() > 1e-6 * size * size {
        return cross.normalize();
    }
    e.normal(uv.x, uv.y).unwrap_or(DVec3::Y)
}

/// Appends the grid of all parameter lines.
fn add_grid(e: &Evaluator, us: &[f64], vs: &[f64], b: &mut Builder) {
    let surface = b.surface("");
    let (low, high) = (DVec2::new(us[0], vs[0]), DVec2::new(us[us.len() - 1], vs[vs.len() - 1]));
    let places: Vec<Vec<DVec3>> = vs.iter().map(|&v| us.iter().map(|&u| e.at(u, v)).collect()).collect();
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
            b.vertex(id, normal(e, uv), (uv - low) / (high - low));
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
