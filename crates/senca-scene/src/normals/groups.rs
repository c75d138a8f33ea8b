//! Points where corners need different normals: their corners are grouped, and each group gets its
//! own normal and, where needed, its own vertices.

use senca_math::glam::Vec3;

use super::{FaceInfo, NormalSettings, corner_share, safe_unit};
use crate::Mesh;

/// A face corner at a point under work.
#[derive(Clone, Copy)]
struct Corner {
    /// Position in `Faces::corners`.
    at: u32,
    face: u32,
    /// Vertex it names.
    vertex: u32,
    /// Whom it may share a normal with; see [`family`].
    family: u64,
    /// Points before and after it in the face.
    neighbors: [u32; 2],
    /// What it adds to the normal.
    share: Vec3,
    /// Group it belongs to: the smallest index, among the corners of the point, of its members.
    group: u32,
}

/// Corners of all marked points, point after point.
struct CornerLists {
    starts: Vec<u32>,
    /// `(position in corners, face)`.
    entries: Vec<(u32, u32)>,
}

/// Gives the corners at the points marked in `apart` normals by group and splits vertices.
pub(super) fn split(mesh: &mut Mesh, faces: &[FaceInfo], apart: &[bool], settings: &NormalSettings) {
    let lists = corner_lists(mesh, apart);
    let mut work = Vec::new();
    let mut claimed = vec![false; mesh.vertices.point.len()];
    let crease = settings.crease_angle.map(|angle| Crease::new(mesh, faces, &lists, angle, settings));
    for range in lists.starts.windows(2) {
        corners_at(mesh, faces, &lists, range, settings, &mut work);
        group_corners(mesh, faces, &mut work, crease.as_ref());
        assign(mesh, faces, &mut work, &mut claimed);
    }
}

/// Fills `work` with the corners of one point.
fn corners_at(
    mesh: &Mesh,
    faces: &[FaceInfo],
    lists: &CornerLists,
    range: &[u32],
    settings: &NormalSettings,
    work: &mut Vec<Corner>,
) {
    work.clear();
    let entries = &lists.entries[range[0] as usize..range[1] as usize];
    work.extend(entries.iter().map(|&(at, face)| corner(mesh, faces, at, face, settings)));
}

/// Number of those a corner may share a normal with: its smoothing group, its surface where it has
/// none, itself on a flat surface.
fn family(mesh: &Mesh, surface: u32, face: u32) -> u64 {
    match mesh.surfaces.get(surface as usize) {
        Some(s) if !s.smooth => 2 << 32 | u64::from(face),
        Some(s) if s.smoothing_group != 0 => 1 << 32 | u64::from(s.smoothing_group),
        _ => u64::from(surface),
    }
}

/// Fewest faces of a dense mesh.
const DENSE: usize = 5000;
/// Largest share of sharp edges that are taken for noise.
const FEW: f64 = 0.01;
/// Farthest that faces at an edge taken for noise reach from it, in diagonals of the mesh.
const SHORT: f32 = 0.02;

/// Which edges are creases.
struct Crease {
    /// Cosine of the angle.
    cosine: f32,
    /// Faces must reach this far from the edge.
    least_reach: f32,
}

impl Crease {
    fn new(
        mesh: &Mesh,
        faces: &[FaceInfo],
        lists: &CornerLists,
        angle: f32,
        settings: &NormalSettings,
    ) -> Self {
        let sharp = Self { cosine: angle.clamp(0.0, std::f32::consts::PI).cos(), least_reach: 0.0 };
        if !settings.smooth_scans || faces.len() < DENSE {
            return sharp;
        }
        // Every sharp edge is met at both ends: normals that differ by the angle cannot both be within
        // half of it from their mean, so that both points are among those looked at.
        let (mut work, mut ends, mut met) = (Vec::new(), Vec::new(), 0u64);
        for range in lists.starts.windows(2) {
            corners_at(mesh, faces, lists, range, settings, &mut work);
            for_each_edge(&work, &mut ends, |end, a, b| {
                met += u64::from(sharp.parts(mesh, faces, &work[a], &work[b], end));
            });
        }
        let edges = mesh.faces.corners.len() as f64 / 2.0;
        if met as f64 / 2.0 > FEW * edges {
            return sharp;
        }
        let finite = mesh.points.iter().filter(|p| p.is_finite());
        let (low, high) =
            finite.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
        Self { least_reach: SHORT * low.distance(high), ..sharp }
    }

    /// Whether the edge from the point of `a` and `b` to point `end` is a crease between them.
    fn parts(&self, mesh: &Mesh, faces: &[FaceInfo], a: &Corner, b: &Corner, end: u32) -> bool {
        let info = |c: &Corner| faces[c.face as usize];
        if info(a).normal.dot(info(b).normal) >= self.cosine {
            return false;
        }
        if self.least_reach == 0.0 {
            return true;
        }
        let edge = mesh.position(a.vertex).distance(mesh.points[end as usize]);
        // How far a parallelogram of that area reaches, or a triangle.
        let reach = |c: &Corner| {
            let triangle = mesh.faces.corners_of(c.face as usize).len() == 3;
            info(c).area * if triangle { 2.0 } else { 1.0 }
        };
        reach(a).max(reach(b)) >= self.least_reach * edge
    }
}

/// Collects corners by point with a counting sort.
fn corner_lists(mesh: &Mesh, apart: &[bool]) -> CornerLists {
    let point_of = |vertex: u32| mesh.vertices.point[vertex as usize] as usize;
    let mut starts = vec![0u32; apart.len() + 1];
    for &vertex in &mesh.faces.corners {
        let point = point_of(vertex);
        starts[point + 1] += u32::from(apart[point]);
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut entries = vec![(0, 0); starts[apart.len()] as usize];
    let mut at = 0;
    for (face, corners) in mesh.faces.iter().enumerate() {
        for &vertex in corners {
            let point = point_of(vertex);
            if apart[point] {
                entries[next[point] as usize] = (at, face as u32);
                next[point] += 1;
            }
            at += 1;
        }
    }
    CornerLists { starts, entries }
}

fn corner(mesh: &Mesh, faces: &[FaceInfo], at: u32, face: u32, settings: &NormalSettings) -> Corner {
    let corners = mesh.faces.corners_of(face as usize);
    let first = if mesh.faces.starts.is_empty() { 3 * face } else { mesh.faces.starts[face as usize] };
    let (i, n) = ((at - first) as usize, corners.len());
    let neighbor = |step: usize| mesh.vertices.point[corners[(i + step) % n] as usize];
    Corner {
        at,
        face,
        vertex: corners[i],
        family: family(mesh, mesh.faces.surface_of(face as usize), face),
        neighbors: [neighbor(n - 1), neighbor(1)],
        share: corner_share(mesh, corners, i, faces[face as usize], settings.weight),
        group: 0,
    }
}

/// Sets the groups of the corners of one point.
fn group_corners(mesh: &Mesh, faces: &[FaceInfo], work: &mut [Corner], crease: Option<&Crease>) {
    if crease.is_none() {
        work.sort_by_key(|c| c.family);
    }
    for (i, corner) in work.iter_mut().enumerate() {
        corner.group = i as u32;
    }
    match crease {
        None => {
            for i in 1..work.len() {
                if work[i - 1].family == work[i].family {
                    work[i].group = work[i - 1].group;
                }
            }
        }
        Some(crease) => join_across_edges(mesh, faces, work, crease),
    }
}

/// Joins corners of one family that share an edge at the point which is no crease.
fn join_across_edges(mesh: &Mesh, faces: &[FaceInfo], work: &mut [Corner], crease: &Crease) {
    let (mut ends, mut joined) = (Vec::with_capacity(2 * work.len()), Vec::new());
    for_each_edge(work, &mut ends, |end, a, b| {
        if !crease.parts(mesh, faces, &work[a], &work[b], end) {
            joined.push((a as u32, b as u32));
        }
    });
    for (a, b) in joined {
        let (ra, rb) = (root(work, a), root(work, b));
        work[ra.max(rb) as usize].group = ra.min(rb);
    }
    for i in 0..work.len() as u32 {
        work[i as usize].group = root(work, i);
    }
}

/// Calls `visit` for the corners of one family on both sides of an edge at the point, with the point
/// at its other end.
fn for_each_edge(work: &[Corner], ends: &mut Vec<(u64, u32, u32)>, mut visit: impl FnMut(u32, usize, usize)) {
    ends.clear();
    for (i, c) in work.iter().enumerate() {
        ends.extend(c.neighbors.map(|neighbor| (c.family, neighbor, i as u32)));
    }
    ends.sort_unstable();
    for pair in ends.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if (a.0, a.1) == (b.0, b.1) {
            visit(a.1, a.2 as usize, b.2 as usize);
        }
    }
}

/// Representative of a corner's group, shortening the way for the next call.
fn root(work: &mut [Corner], mut i: u32) -> u32 {
    while work[i as usize].group != i {
        let up = work[work[i as usize].group as usize].group;
        work[i as usize].group = up;
        i = up;
    }
    i
}

/// Gives every group its normal. The first group that uses a vertex keeps it, others get copies.
fn assign(mesh: &mut Mesh, faces: &[FaceInfo], work: &mut [Corner], claimed: &mut Vec<bool>) {
    work.sort_unstable_by_key(|c| (c.group, c.vertex, c.at));
    for group in work.chunk_by(|a, b| a.group == b.group) {
        let sum = safe_unit(group.iter().map(|c| c.share).sum());
        let any = || group.iter().map(|c| faces[c.face as usize].normal).find(|&n| n != Vec3::ZERO);
        let normal = if sum == Vec3::ZERO { any().unwrap_or(Vec3::Z) } else { sum };
        for same_vertex in group.chunk_by(|a, b| a.vertex == b.vertex) {
            let old = same_vertex[0].vertex;
            let vertex = if claimed[old as usize] { mesh.copy_vertex(old) } else { old };
            claimed.resize(mesh.vertices.point.len(), true);
            claimed[vertex as usize] = true;
            mesh.vertices.normal[vertex as usize] = normal;
            same_vertex.iter().for_each(|c| mesh.faces.corners[c.at as usize] = vertex);
        }
    }
}
