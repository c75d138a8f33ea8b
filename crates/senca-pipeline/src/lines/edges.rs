//! The edges of a mesh, each once.

use rayon::prelude::*;
use senca_math::glam::{DVec3, Vec3};
use senca_scene::{Mesh, newell_vector};

use crate::geometry::Placed;

/// Faces count as lying in one plane when the cosine of the angle between their normals is above
/// this: about a twentieth of a degree.
const FLAT_COSINE: f32 = 0.999_999_6;

/// An edge in the world with the faces on its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    pub(crate) ends: [DVec3; 2],
    /// Up to two faces; edges with more neighbours name the first two.
    pub(crate) faces: [Option<u32>; 2],
}

/// The edges of all faces of `mesh`, and its lines. With `skip_flat` those between two faces in one
/// plane are left out.
pub(crate) fn edges_of(mesh: &Mesh, placed: &Placed<'_>, skip_flat: bool) -> Vec<Edge> {
    let mut sides = sides(mesh);
    sides.par_sort_unstable();
    let at = |point: u32| placed.world_from_object.transform_point3(mesh.points[point as usize].as_dvec3());
    let faces = sides.chunk_by(|a, b| a[..2] == b[..2]).filter_map(|group| {
        let [a, b, face] = group[0];
        let other = group.get(1).map(|s| s[2]);
        let flat =
            skip_flat && group.len() == 2 && other.is_some_and(|other| in_one_plane(mesh, face, other));
        (!flat).then(|| Edge { ends: [at(a), at(b)], faces: [Some(face), other] })
    });
    let lines = mesh.lines.iter().map(|line| {
        let ends = line.map(|v| at(mesh.vertices.point[v as usize]));
        Edge { ends, faces: [None; 2] }
    });
    faces.chain(lines).collect()
}

/// Smaller point, larger point and face of every side of every face. Sides without length are left
/// out.
fn sides(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut sides = Vec::with_capacity(mesh.faces.corners.len());
    for (face, corners) in mesh.faces.iter().enumerate() {
        let points = corners.iter().map(|&c| mesh.vertices.point[c as usize]);
        for (a, b) in points.clone().zip(points.cycle().skip(1)) {
            if a != b {
                sides.push([a.min(b), a.max(b), face as u32]);
            }
        }
    }
    sides
}

fn in_one_plane(mesh: &Mesh, one: u32, other: u32) -> bool {
    let normal = |face: u32| -> Vec3 {
        let corners = mesh.faces.corners_of(face as usize);
        newell_vector(corners.iter().map(|&c| mesh.position(c))).normalize_or_zero()
    };
    normal(one).dot(normal(other)) > FLAT_COSINE
}
