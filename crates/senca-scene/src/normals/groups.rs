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
    surface: u32,
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
    for range in lists.starts.windows(2) {
        work.clear();
        let entries = &lists.entries[range[0] as usize..range[1] as usize];
        work.extend(entries.iter().map(|&(at, face)| corner(mesh, faces, at, face, settings)));
        group_corners(mesh, faces, &mut work, settings.crease_angle);
        assign(mesh, faces, &mut work, &mut claimed);
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
        surface: mesh.faces.surface_of(face as usize),
        neighbors: [neighbor(n - 1), neighbor(1)],
        share: corner_share(mesh, corners, i, faces[face as usize], settings.weight),
        group: 0,
    }
}

/// Sets the groups of the corners of one point.
fn group_corners(mesh: &Mesh, faces: &[FaceInfo], work: &mut [Corner], crease: Option<f32>) {
    for (i, corner) in work.iter_mut().enumerate() {
        corner.group = i as u32;
    }
    let smooth = |surface: u32| mesh.surfaces.get(surface as usize).is_none_or(|s| s.smooth);
    match crease {
        None => {
            work.sort_by_key(|c| c.surface);
            for i in 0..work.len() {
                let joins = i > 0 && work[i - 1].surface == work[i].surface && smooth(work[i].surface);
                work[i].group = if joins { work[i - 1].group } else { i as u32 };
            }
        }
        Some(angle) => join_across_edges(faces, work, angle.clamp(0.0, std::f32::consts::PI).cos(), smooth),
    }
}

/// Joins corners of one smooth surface that share an edge at the point and whose faces differ by no
/// more than the crease angle.
fn join_across_edges(faces: &[FaceInfo], work: &mut [Corner], cosine: f32, smooth: impl Fn(u32) -> bool) {
    // Ends of edges at the point, so that corners on both sides of an edge come together.
    let mut ends: Vec<(u32, u32, u32)> = Vec::with_capacity(2 * work.len());
    for (i, c) in work.iter().enumerate() {
        ends.extend(c.neighbors.map(|neighbor| (c.surface, neighbor, i as u32)));
    }
    ends.sort_unstable();
    for pair in ends.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if (a.0, a.1) != (b.0, b.1) || !smooth(a.0) {
            continue;
        }
        let normal = |i: u32| faces[work[i as usize].face as usize].normal;
        if normal(a.2).dot(normal(b.2)) >= cosine {
            let (ra, rb) = (root(work, a.2), root(work, b.2));
            work[ra.max(rb) as usize].group = ra.min(rb);
        }
    }
    for i in 0..work.len() as u32 {
        work[i as usize].group = root(work, i);
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
