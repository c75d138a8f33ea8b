//! Bicubic Bézier patches without cracks.
//!
//! Steps along an edge come from the second differences of the edge's control points: the chord
//! error of a cubic over n steps is at most `6 d / (8 n^2)`, d being the largest second difference.
//! Steps inside come from the bound of Filip, Magedson and Markot (1986) on the distance between a
//! surface and its triangulated grid. Where edge and inside differ, a strip of triangles joins them.

use std::collections::BTreeMap;

use senca_math::BicubicPatch;
use senca_math::glam::{DVec2, DVec3};

use super::build::Builder;
use super::solids::chord_steps;
use super::stitch::{Cubic, EdgeUse, Edges, join_rows};
use super::{MAX_FACES, ShapeError, TessellationSettings, Tolerance};
use crate::BezierPatch;

/// Most steps across one patch.
const MAX_STEPS: u32 = 1024;

/// Steps of a patch's inside and its four edges: v = 0, u = 1, v = 1, u = 0, each in the direction of
/// increasing parameter.
struct Plan {
    inside: [u32; 2],
    edges: [EdgeUse; 4],
}

/// Appends the mesh of `patches`.
pub(super) fn bezier_patches(
    patches: &[BezierPatch],
    settings: &TessellationSettings,
    b: &mut Builder,
) -> Result<(), ShapeError> {
    if let Some(bad) = patches.iter().position(|patch| !patch.points.iter().all(|p| p.is_finite())) {
        let reason = format!("patch {bad} has a control point that is not finite");
        return Err(ShapeError::Malformed { shape: "Bézier patches", reason });
    }
    let surfaces = number_surfaces(patches, b);
    let mut edges = Edges::default();
    let mut plans: Vec<Plan> =
        patches.iter().map(|patch| plan(patch, &settings.tolerance, &mut edges)).collect();
    keep_budget(&mut plans, &mut edges);
    edges.add_points(b);
    let mut seams = Vec::new();
    for (patch, plan) in patches.iter().zip(&plans) {
        add_patch(
            &BicubicPatch::from_list(patch.points),
            plan,
            surfaces[&patch.surface],
            &edges,
            &mut seams,
            b,
        );
    }
    smooth_seams(seams, b);
    Ok(())
}

/// A surface of the mesh for every surface number, ascending.
fn number_surfaces(patches: &[BezierPatch], b: &mut Builder) -> BTreeMap<u32, u32> {
    let mut surfaces: BTreeMap<u32, u32> = patches.iter().map(|patch| (patch.surface, 0)).collect();
    surfaces.iter_mut().for_each(|(number, surface)| *surface = b.surface(&number.to_string()));
    surfaces
}

/// Control curves of the four edges, in the order of [`Plan::edges`].
fn edge_curves(p: &[DVec3; 16]) -> [Cubic; 4] {
    [[0, 1, 2, 3], [3, 7, 11, 15], [12, 13, 14, 15], [0, 4, 8, 12]].map(|edge| edge.map(|i| p[i]))
}

/// Decides on all steps of a patch and enters its edges.
fn plan(patch: &BezierPatch, tolerance: &Tolerance, edges: &mut Edges) -> Plan {
    let curves = edge_curves(&patch.points);
    let inside = inside_steps(&patch.points, tolerance);
    let uses = curves.map(|curve| edges.enter(curve));
    for (side, edge_use) in uses.iter().enumerate() {
        let edge = &mut edges.list[edge_use.edge];
        let steps = match tolerance {
            Tolerance::Steps(u, v) => if side % 2 == 0 { *u } else { *v }.clamp(1, MAX_STEPS),
            // A collapsed edge costs no faces; with the inside's steps its texture does not shear.
            _ if edge.is_collapsed() => inside[side % 2],
            _ => curve_steps(&edge.curve, tolerance),
        };
        edge.steps = edge.steps.max(steps);
    }
    Plan { inside, edges: uses }
}

/// Length of the second difference of three control points.
fn bend(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (a - 2.0 * b + c).length()
}

/// Steps along an edge; at least two where it is curved, so that two edges with common ends stay apart.
fn curve_steps(c: &Cubic, tolerance: &Tolerance) -> u32 {
    let bend = bend(c[0], c[1], c[2]).max(bend(c[1], c[2], c[3]));
    let length = c.windows(2).map(|p| p[0].distance(p[1])).fold(0.0, f64::max);
    let least = if bend > 1e-9 * length { 2 } else { 1 };
    let tolerance = tolerance.over(c).unwrap_or(f64::INFINITY);
    chord_steps(12.0 * bend, tolerance, MAX_STEPS).max(least)
}

/// Steps inside a patch in u and v: with D the bounds on second derivatives, the error is at most
/// `(Duu/nu^2 + 2 Duv/(nu nv) + Dvv/nv^2) / 8`; each direction takes half of it.
fn inside_steps(p: &[DVec3; 16], tolerance: &Tolerance) -> [u32; 2] {
    if let Tolerance::Steps(u, v) = *tolerance {
        return [u.clamp(1, MAX_STEPS), v.clamp(1, MAX_STEPS)];
    }
    let (mut uu, mut vv, mut uv) = (0.0f64, 0.0f64, 0.0f64);
    for i in 0..4 {
        for j in 0..2 {
            uu = uu.max(6.0 * bend(p[4 * i + j], p[4 * i + j + 1], p[4 * i + j + 2]));
            vv = vv.max(6.0 * bend(p[4 * j + i], p[4 * (j + 1) + i], p[4 * (j + 2) + i]));
        }
    }
    for k in (0..11).filter(|k| k % 4 != 3) {
        uv = uv.max(9.0 * ((p[k] - p[k + 1]) - (p[k + 4] - p[k + 5])).length());
    }
    let tolerance = tolerance.over(p).unwrap_or(f64::INFINITY);
    [uu, vv].map(|second| chord_steps(2.0 * (second + uv), tolerance, MAX_STEPS))
}

/// Scales all steps down by one factor when there would be more than [`MAX_FACES`] faces.
fn keep_budget(plans: &mut [Plan], edges: &mut Edges) {
    let inside = |p: &Plan| 2 * u64::from(p.inside[0]) * u64::from(p.inside[1]);
    let faces = plans.iter().map(inside).sum::<u64>()
        + edges.list.iter().map(|edge| 2 * u64::from(edge.steps)).sum::<u64>();
    if faces <= MAX_FACES {
        return;
    }
    let shrink = (MAX_FACES as f64 / faces as f64).sqrt();
    let shrunk = |n: u32| ((f64::from(n) * shrink) as u32).max(1);
    plans.iter_mut().for_each(|plan| plan.inside = plan.inside.map(shrunk));
    edges.list.iter_mut().for_each(|edge| edge.steps = shrunk(edge.steps));
}

/// A vertex on a patch's border, to be smoothed with its neighbours.
struct Seam {
    surface: u32,
    point: u32,
    vertex: u32,
}

/// Appends one patch.
fn add_patch(
    patch: &BicubicPatch,
    plan: &Plan,
    surface: u32,
    edges: &Edges,
    seams: &mut Vec<Seam>,
    b: &mut Builder,
) {
    let rows = border_rows(patch, plan, surface, edges, seams, b);
    let [bottom, right, top, left] = &rows;
    let [nu, nv] = plan.inside;
    let same = |a: &[(f64, u32)], b: &[(f64, u32)]| a.len() == b.len();
    if same(bottom, top)
        && same(left, right)
        && bottom.len() == nu as usize + 1
        && left.len() == nv as usize + 1
    {
        return add_grid(patch, plan.inside, surface, &rows, b);
    }
    let (nu, nv) = (nu.max(2), nv.max(2));
    let inside = inside_rows(patch, nu, nv, b);
    for pair in inside.windows(2) {
        for i in 0..pair[0].len() - 1 {
            b.quad([pair[0][i].1, pair[0][i + 1].1, pair[1][i + 1].1, pair[1][i].1], surface);
        }
    }
    let column = |i: usize| -> Vec<(f64, u32)> {
        inside.iter().enumerate().map(|(j, row)| ((j + 1) as f64 / f64::from(nv), row[i].1)).collect()
    };
    let turned =
        |row: &[(f64, u32)]| -> Vec<(f64, u32)> { row.iter().rev().map(|&(t, v)| (1.0 - t, v)).collect() };
    join_rows(bottom, &inside[0], surface, b);
    join_rows(right, &column(nu as usize - 2), surface, b);
    join_rows(&turned(top), &turned(&inside[nv as usize - 2]), surface, b);
    join_rows(&turned(left), &turned(&column(0)), surface, b);
}

/// Vertices along the four edges, in the order of [`Plan::edges`]; corners are shared.
fn border_rows(
    patch: &BicubicPatch,
    plan: &Plan,
    surface: u32,
    edges: &Edges,
    seams: &mut Vec<Seam>,
    b: &mut Builder,
) -> [Vec<(f64, u32)>; 4] {
    let place = |side: usize, t: f64| match side {
        0 => DVec2::new(t, 0.0),
        1 => DVec2::new(1.0, t),
        2 => DVec2::new(t, 1.0),
        _ => DVec2::new(0.0, t),
    };
    let mut rows: [Vec<(f64, u32)>; 4] = std::array::from_fn(|side| {
        let edge = plan.edges[side];
        let steps = edges.steps(edge);
        let row = (0..=steps).map(|i| {
            let t = f64::from(i) / f64::from(steps);
            // Sides 1 and 3 take their ends from sides 0 and 2.
            if side % 2 == 1 && (i == 0 || i == steps) {
                return (t, 0);
            }
            let uv = place(side, t);
            let point = edges.point(edge, i);
            let vertex = b.vertex(point, sample(patch, uv).1, uv);
            seams.push(Seam { surface, point, vertex });
            (t, vertex)
        });
        row.collect()
    });
    for (side, end) in [(1, true), (3, false)] {
        let corner = |row: &[(f64, u32)]| if end { row[row.len() - 1].1 } else { row[0].1 };
        let (start, last) = (corner(&rows[0]), corner(&rows[2]));
        let n = rows[side].len() - 1;
        rows[side][0].1 = start;
        rows[side][n].1 = last;
    }
    rows
}

/// Vertices strictly inside, row after row, with their u.
fn inside_rows(patch: &BicubicPatch, nu: u32, nv: u32, b: &mut Builder) -> Vec<Vec<(f64, u32)>> {
    let mut row = |j: u32| {
        let v = f64::from(j) / f64::from(nv);
        let vertex = |i: u32| {
            let uv = DVec2::new(f64::from(i) / f64::from(nu), v);
            let (place, normal) = sample(patch, uv);
            let point = b.point(place);
            (uv.x, b.vertex(point, normal, uv))
        };
        (1..nu).map(vertex).collect()
    };
    (1..nv).map(&mut row).collect()
}

/// The patch as one regular grid, when edges and inside have the same steps.
fn add_grid(
    patch: &BicubicPatch,
    [nu, nv]: [u32; 2],
    surface: u32,
    rows: &[Vec<(f64, u32)>; 4],
    b: &mut Builder,
) {
    let [bottom, right, top, left] = rows;
    let inside = inside_rows(patch, nu, nv, b);
    let (nu, nv) = (nu as usize, nv as usize);
    let vertex = |i: usize, j: usize| match (i, j) {
        (_, 0) => bottom[i].1,
        (_, _) if j == nv => top[i].1,
        (0, _) => left[j].1,
        (_, _) if i == nu => right[j].1,
        _ => inside[j - 1][i - 1].1,
    };
    for j in 0..nv {
        for i in 0..nu {
            b.quad([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)], surface);
        }
    }
}

/// Gives all vertices of one surface at one point the mean of their normals, unless they cancel.
fn smooth_seams(mut seams: Vec<Seam>, b: &mut Builder) {
    seams.sort_unstable_by_key(|seam| (seam.surface, seam.point, seam.vertex));
    let normals = &mut b.mesh.vertices.normal;
    for group in seams.chunk_by(|a, b| (a.surface, a.point) == (b.surface, b.point)) {
        let sum: DVec3 = group.iter().map(|seam| normals[seam.vertex as usize].as_dvec3()).sum();
        if sum.length() > 0.1 * group.len() as f64 {
            let mean = sum.normalize_or(DVec3::Y).as_vec3();
            group.iter().for_each(|seam| normals[seam.vertex as usize] = mean);
        }
    }
}

/// Place and unit normal at `(u, v)`; +y for a patch that is a curve or a point there.
fn sample(patch: &BicubicPatch, uv: DVec2) -> (DVec3, DVec3) {
    let at = patch.evaluate(uv.x, uv.y);
    let cross = at.du.cross(at.dv);
    // Where the derivatives are near vanishing, the limit, which takes longer to find.
    let size = at.du.length_squared().max(at.dv.length_squared());
    let clear = cross.length_squared() > 1e-12 * size * size;
    let normal = if clear { Some(cross.normalize()) } else { patch.normal(uv.x, uv.y) };
    (at.position, normal.unwrap_or(DVec3::Y))
}
