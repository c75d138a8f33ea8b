//! Normals that a file should have given.

use senca_scene::Mesh;
use senca_scene::math::glam::{DVec3, Vec3};
use senca_scene::math::newell_normal_of;

/// The direction of `v`, even where its length squared overflows or vanishes in `f32`.
pub(crate) fn unit(v: Vec3) -> Option<Vec3> {
    v.as_dvec3().try_normalize().map(|v| v.as_vec3())
}

/// Gives vertices whose normal is NaN the mean normal of their faces, weighted by area. Where no
/// vertex has a normal, the attribute is dropped.
pub(crate) fn fill_missing_normals(mesh: &mut Mesh) {
    let missing = mesh.vertices.normal.iter().filter(|n| n.is_nan()).count();
    if missing == 0 {
        return;
    }
    if missing == mesh.vertices.normal.len() {
        mesh.vertices.normal.clear();
        return;
    }
    let mut sums = vec![DVec3::ZERO; mesh.vertices.normal.len()];
    for face in mesh.faces.iter() {
        let area = newell_normal_of(face.iter().map(|&v| mesh.position(v).as_dvec3()));
        face.iter().for_each(|&vertex| sums[vertex as usize] += area);
    }
    for (normal, sum) in mesh.vertices.normal.iter_mut().zip(sums) {
        if normal.is_nan() {
            *normal = sum.try_normalize().map_or(Vec3::Z, |n| n.as_vec3());
        }
    }
}

/// Makes points at one place one when the file gives no normals. Modellers repeat points along the seams of
/// what they put together; normals made from the faces would show each seam as an edge. Where it is one,
/// the faces meet too sharply to share a normal anyway.
pub(crate) fn join_doubled_points(mesh: &mut Mesh) {
    if mesh.vertices.normal.is_empty() && !mesh.faces.is_empty() {
        mesh.weld(0.0);
    }
}
