//! Hidden lines removed, exactly: which parts of an edge no face is in front of.
//!
//! Everything happens on the picture. There a plane's nearness is linear in x and y, and so is that of
//! a line along itself, if nearness is 1/w in a central and the distance itself in a parallel view.
//! So every triangle hides an interval of an edge: the part inside the triangle's outline, cut to the
//! part where the edge is farther than the triangle's plane. What is left of the edge is visible
//! (after Appel 1967 and Roberts 1963; a grid over the picture finds the triangles near an edge).
//!
//! The faces an edge belongs to do not hide it. Others must be nearer by a millionth of the distance,
//! so that faces which touch an edge, or lie in one plane with it, do not hide it by rounding.

use rayon::prelude::*;
use senca_math::Control;
use senca_math::glam::{DVec2, DVec3, DVec4};
use senca_math::{LinearRgb, ViewKind};
use senca_scene::{Faces, Mesh, Vertices, triangulated};

use super::edges::{Edge, edges_of};
use super::projector::Projector;
use super::{Segment, SegmentKind};
use crate::RenderError;
use crate::geometry::World;
use crate::settings::Settings;

/// A face must be nearer than an edge by this part of the distance to hide it.
const NEARER: f64 = 1e-6;

/// Pieces of an edge shorter than this many pixels, left over by the rule above, are not drawn.
const SHORTEST: f64 = 0.05;

/// Edges that one task handles.
const EDGES_AT_ONCE: usize = 256;

/// A triangle on the picture.
struct Occluder {
    /// Corners in pixels, with positive doubled area.
    corners: [DVec2; 3],
    /// Nearness is `plane . (x, y, 1)`.
    plane: DVec3,
    placed: u32,
    face: u32,
}

/// The visible parts of all edges.
pub(super) fn visible_segments(
    world: &World<'_>,
    projector: &Projector,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<Vec<Segment>, RenderError> {
    let occluders = occluders(world, projector);
    control.check()?;
    let grid = Grid::new(&occluders, projector.size);
    let tolerance = Tolerance::new(projector);
    let mut segments = Vec::new();
    for (index, placed) in world.placed.iter().enumerate() {
        control.check()?;
        let edges = edges_of(&world.meshes[placed.mesh], placed, settings.wire.skip_flat_edges);
        let pieces = edges.par_chunks(EDGES_AT_ONCE).flat_map_iter(|edges| {
            let edges = if control.is_cancelled() { &[][..] } else { edges };
            let seen = |e: &Edge| visible_parts(e, index as u32, projector, (&occluders, &grid), &tolerance);
            edges.iter().flat_map(seen).collect::<Vec<_>>()
        });
        segments.par_extend(pieces);
        control.check()?;
    }
    Ok(segments)
}

/// The visible parts of one edge.
fn visible_parts(
    edge: &Edge,
    placed: u32,
    projector: &Projector,
    (occluders, grid): (&[Occluder], &Grid),
    tolerance: &Tolerance,
) -> Vec<Segment> {
    let Some(segment) = projector.segment(edge.ends, SegmentKind::Edge) else { return Vec::new() };
    let ends = segment.ends.map(DVec2::from_array);
    let nearness = [0, 1].map(|k| tolerance.nearness(segment.depths[k]));
    let mut hidden: Vec<[f64; 2]> = Vec::new();
    grid.visit(ends, |i| {
        let occluder = &occluders[i as usize];
        let own = occluder.placed == placed && edge.faces.contains(&Some(occluder.face));
        if !own {
            hidden.extend(hidden_interval(occluder, ends, nearness, tolerance));
        }
    });
    let length = ends[0].distance(ends[1]);
    let shortest = if length > SHORTEST { SHORTEST / length } else { 0.5 };
    remaining(&mut hidden).filter(|[a, b]| b - a > shortest).map(|[a, b]| part(&segment, a, b)).collect()
}

/// The part of the line between `ends` that the occluder hides.
fn hidden_interval(
    occluder: &Occluder,
    ends: [DVec2; 2],
    nearness: [f64; 2],
    tolerance: &Tolerance,
) -> Option<[f64; 2]> {
    let mut range = [0.0, 1.0];
    for k in 0..3 {
        let (a, b) = (occluder.corners[k], occluder.corners[(k + 1) % 3]);
        let side = |p: DVec2| (b - a).perp_dot(p - a);
        keep_positive(&mut range, side(ends[0]), side(ends[1]))?;
    }
    let ahead = |k: usize| {
        let own = occluder.plane.dot(ends[k].extend(1.0));
        own * tolerance.factor - tolerance.offset - nearness[k]
    };
    keep_positive(&mut range, ahead(0), ahead(1))?;
    (range[0] < range[1]).then_some(range)
}

/// Cuts `range` to where a value that runs linearly from `from` at 0 to `to` at 1 is not negative.
fn keep_positive(range: &mut [f64; 2], from: f64, to: f64) -> Option<()> {
    if from < 0.0 && to < 0.0 {
        return None;
    }
    if from < 0.0 {
        range[0] = range[0].max(from / (from - to));
    } else if to < 0.0 {
        range[1] = range[1].min(from / (from - to));
    }
    Some(())
}

/// What `hidden` leaves of 0..1. Gaps of rounding between hidden neighbours close.
fn remaining(hidden: &mut [[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    hidden.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut visible = Vec::new();
    let mut from = 0.0;
    for &[a, b] in hidden.iter() {
        if a > from + 1e-9 {
            visible.push([from, a]);
        }
        from = f64::max(from, b);
    }
    if from < 1.0 - 1e-9 {
        visible.push([from, 1.0]);
    }
    visible.into_iter()
}

fn part(segment: &Segment, a: f64, b: f64) -> Segment {
    let mix = |k: usize, t: f64| segment.ends[0][k] + t * (segment.ends[1][k] - segment.ends[0][k]);
    let depth = |t: f64| segment.depths[0] + t * (segment.depths[1] - segment.depths[0]);
    let color = |t: f64| -> LinearRgb { segment.colors[0].lerp(segment.colors[1], t as f32) };
    Segment {
        ends: [a, b].map(|t| [mix(0, t), mix(1, t)]),
        depths: [a, b].map(depth),
        colors: [a, b].map(color),
        kind: segment.kind,
    }
}

/// How nearness is measured and compared.
struct Tolerance {
    /// A face's nearness counts as this times it, less the offset.
    factor: f64,
    offset: f64,
    /// Central view: 1/w is `scale * depth + shift` on the picture. Parallel: the depth turned round.
    scale: f64,
    shift: f64,
}

impl Tolerance {
    fn new(projector: &Projector) -> Self {
        let m = &projector.view.clip_from_view;
        match projector.view.kind {
            // z = a zv + b and w = c zv + d, so z/w is linear in 1/w and 1/w in z/w.
            ViewKind::Central { .. } => {
                let (a, b, c, d) = (m.z_axis.z, m.w_axis.z, m.z_axis.w, m.w_axis.w);
                let determinant = b * c - a * d;
                Self { factor: 1.0 - NEARER, offset: 0.0, scale: c / determinant, shift: -a / determinant }
            }
            ViewKind::Parallel { .. } => Self { factor: 1.0, offset: NEARER, scale: -1.0, shift: 1.0 },
        }
    }

    /// Nearness of a place of the picture from its depth.
    fn nearness(&self, depth: f64) -> f64 {
        self.scale * depth + self.shift
    }
}

/// The triangles of all faces, cut by the near plane, on the picture.
fn occluders(world: &World<'_>, projector: &Projector) -> Vec<Occluder> {
    let tolerance = Tolerance::new(projector);
    let mut occluders = Vec::new();
    for (index, placed) in world.placed.iter().enumerate() {
        let mesh = &world.meshes[placed.mesh];
        let clip_from_object = projector.view.clip_from_world * placed.world_from_object;
        let clip = |c: u32| clip_from_object * mesh.position(c).as_dvec3().extend(1.0);
        let triangles = triangles_of_faces(mesh);
        for (i, corners) in triangles.corners.as_chunks::<3>().0.iter().enumerate() {
            let polygon = cut_near(corners.map(clip));
            let pixels: Vec<DVec3> = polygon.iter().map(|&p| projector.pixel(p)).collect();
            for k in 2..pixels.len() {
                let corners = [pixels[0], pixels[k - 1], pixels[k]];
                occluders.extend(occluder(corners, &tolerance, index as u32, triangles.surface_of(i)));
            }
        }
    }
    occluders
}

/// The faces of `mesh` in triangles, each with the number of its face as its surface.
fn triangles_of_faces(mesh: &Mesh) -> Faces {
    let numbered = Faces { surface: (0..mesh.faces.len() as u32).collect(), ..mesh.faces.clone() };
    if mesh.faces.starts.is_empty() {
        return numbered;
    }
    let point = mesh.vertices.point.clone();
    let vertices = Vertices { point, ..Vertices::default() };
    triangulated(&Mesh { points: mesh.points.clone(), vertices, faces: numbered, ..Mesh::default() })
}

fn occluder(corners: [DVec3; 3], tolerance: &Tolerance, placed: u32, face: u32) -> Option<Occluder> {
    let [mut a, mut b, c] = corners;
    let flat = |p: DVec3| p.truncate();
    let mut area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
    if !area.is_finite() || area == 0.0 {
        return None;
    }
    if area < 0.0 {
        (a, b) = (b, a);
        area = -area;
    }
    let near = |p: DVec3| tolerance.nearness(p.z);
    // Barycentric coordinates give the plane of nearness.
    let (ab, ac) = (flat(b) - flat(a), flat(c) - flat(a));
    let (db, dc) = (near(b) - near(a), near(c) - near(a));
    let slope = DVec2::new(db * ac.y - dc * ab.y, dc * ab.x - db * ac.x) / area;
    let plane = slope.extend(near(a) - slope.dot(flat(a)));
    plane.is_finite().then_some(Occluder { corners: [flat(a), flat(b), flat(c)], plane, placed, face })
}

/// The part of a triangle beyond the near plane, z >= 0.
fn cut_near(triangle: [DVec4; 3]) -> Vec<DVec4> {
    if triangle.iter().all(|p| p.z >= 0.0 && p.w > 0.0) {
        return triangle.to_vec();
    }
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
        if p.z >= 0.0 {
            polygon.push(p);
        }
        if (p.z >= 0.0) != (q.z >= 0.0) {
            polygon.push(p.lerp(q, p.z / (p.z - q.z)));
        }
    }
    polygon.retain(|p| p.w > 0.0);
    polygon
}

/// Which triangles lie where on the picture.
struct Grid {
    /// Side of a cell in pixels.
    cell: f64,
    counts: [usize; 2],
    /// Triangles of cell `i` are `items[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Triangles too large for cells.
    large: Vec<u32>,
}

/// Triangles over more cells than this are kept apart.
const LARGE_CELLS: usize = 1024;

/// Most cells along a side.
const MOST_CELLS: f64 = 512.0;

impl Grid {
    fn new(occluders: &[Occluder], size: [f64; 2]) -> Self {
        let longest = size[0].max(size[1]);
        let cell =
            (size[0] * size[1] / occluders.len().max(1) as f64).sqrt().max(longest / MOST_CELLS).max(1.0);
        let counts = size.map(|s| (s / cell).ceil().max(1.0) as usize);
        let mut grid = Self { cell, counts, starts: Vec::new(), items: Vec::new(), large: Vec::new() };
        grid.fill(occluders);
        grid
    }

    /// Counts, then places, every triangle in the cells of its bounding box.
    fn fill(&mut self, occluders: &[Occluder]) {
        let mut fill = vec![0u32; self.counts[0] * self.counts[1] + 1];
        let mut boxes = Vec::with_capacity(occluders.len());
        for (i, occluder) in occluders.iter().enumerate() {
            let cells = self.cells_of(&occluder.corners);
            let count = cells.map_or(0, |[a, b]| (b[0] - a[0] + 1) * (b[1] - a[1] + 1));
            let cells = cells.filter(|_| count <= LARGE_CELLS);
            if count > LARGE_CELLS {
                self.large.push(i as u32);
            }
            self.each_cell(cells, |c| fill[c + 1] += 1);
            boxes.push(cells);
        }
        for c in 1..fill.len() {
            fill[c] += fill[c - 1];
        }
        self.items = vec![0; fill.last().map_or(0, |&n| n as usize)];
        self.starts = fill.clone();
        for (i, cells) in boxes.into_iter().enumerate() {
            let items = &mut self.items;
            let counts = self.counts;
            for_each_cell(counts, cells, |c| {
                items[fill[c] as usize] = i as u32;
                fill[c] += 1;
            });
        }
    }

    fn each_cell(&self, cells: Option<[[usize; 2]; 2]>, visit: impl FnMut(usize)) {
        for_each_cell(self.counts, cells, visit);
    }

    /// Cells of the bounding box of `points`, none when it is off the picture.
    fn cells_of(&self, points: &[DVec2]) -> Option<[[usize; 2]; 2]> {
        let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let margin = 65.0;
        let most = DVec2::new(self.counts[0] as f64, self.counts[1] as f64) * self.cell + margin;
        if high.x < -margin || high.y < -margin || low.x > most.x || low.y > most.y {
            return None;
        }
        let cell = |v: f64, k: usize| ((v / self.cell).max(0.0) as usize).min(self.counts[k] - 1);
        Some([[cell(low.x, 0), cell(low.y, 1)], [cell(high.x, 0), cell(high.y, 1)]])
    }

    /// Calls `visit` with the triangles near a line, some more than once.
    fn visit(&self, ends: [DVec2; 2], mut visit: impl FnMut(u32)) {
        self.large.iter().for_each(|&i| visit(i));
        let Some([low, high]) = self.cells_of(&ends) else { return };
        let direction = ends[1] - ends[0];
        for row in low[1]..=high[1] {
            // Part of the line within the row; the outermost rows go on for ever.
            let top = if row == 0 { f64::NEG_INFINITY } else { row as f64 * self.cell };
            let bottom = if row + 1 == self.counts[1] { f64::INFINITY } else { (row + 1) as f64 * self.cell };
            let at = |y: f64| if direction.y == 0.0 { f64::NAN } else { (y - ends[0].y) / direction.y };
            let (t0, t1) = (at(top), at(bottom));
            let (first, last) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
            let x = |t: f64| ends[0].x + t.clamp(0.0, 1.0) * direction.x;
            let span = [DVec2::new(x(first), ends[0].y), DVec2::new(x(last), ends[0].y)];
            let Some([a, b]) = self.cells_of(&span) else { continue };
            for column in a[0]..=b[0] {
                let c = row * self.counts[0] + column;
                let range = self.starts[c] as usize..self.starts[c + 1] as usize;
                self.items[range].iter().for_each(|&i| visit(i));
            }
        }
    }
}

fn for_each_cell(counts: [usize; 2], cells: Option<[[usize; 2]; 2]>, mut visit: impl FnMut(usize)) {
    let Some([low, high]) = cells else { return };
    for row in low[1]..=high[1] {
        for column in low[0]..=high[0] {
            visit(row * counts[0] + column);
        }
    }
}
