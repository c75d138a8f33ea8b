//! A whole scene as one mesh, for formats that hold only one.

use senca::math::glam::DMat4;
use senca::scene::{Mesh, Scene, TessellationSettings, tessellate};

/// All faces that the scene shows, in world coordinates, each surface of each instance a surface of
/// the mesh. Flat polygons stay whole.
pub(super) fn merged(scene: &Scene, settings: &TessellationSettings) -> Result<Mesh, String> {
    let settings = TessellationSettings { polygons: true, ..*settings };
    let mut all = Mesh::default();
    for instance in scene.instances() {
        let shape = &scene.geometries[instance.geometry.index()].shape;
        let mesh = tessellate(shape, &settings).map_err(|e| e.to_string())?;
        append(&mut all, &mesh, &instance.world_from_object);
    }
    Ok(all)
}

/// Adds the faces of `mesh`, placed; a mirroring turns them over, so that fronts stay outside.
fn append(all: &mut Mesh, mesh: &Mesh, world_from_object: &DMat4) {
    let (first_point, first_surface) = (all.points.len() as u32, all.surfaces.len() as u32);
    let first_vertex = all.vertices.point.len() as u32;
    all.points.extend(mesh.points.iter().map(|p| world_from_object.transform_point3(p.as_dvec3()).as_vec3()));
    all.vertices.point.extend(mesh.vertices.point.iter().map(|p| first_point + p));
    all.surfaces.extend(mesh.surfaces.iter().cloned());
    let mirrored = world_from_object.determinant() < 0.0;
    for face in 0..mesh.faces.len() {
        let mut corners: Vec<_> = mesh.faces.corners_of(face).iter().map(|v| first_vertex + v).collect();
        if mirrored {
            corners.reverse();
        }
        all.faces.push(&corners, first_surface + mesh.faces.surface_of(face));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca::math::glam::DVec3;
    use senca::scene::{Shape, Transform};

    #[test]
    fn a_mirrored_box_keeps_its_volume() {
        let mut scene = Scene::of_shape("box", Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) });
        let again = senca::scene::Node {
            transform: Transform::Matrix(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
            ..scene.nodes[0].clone()
        };
        let id = scene.add_node(again);
        scene.roots.push(id);
        let mesh = merged(&scene, &TessellationSettings::default()).expect("a mesh");
        assert_eq!((mesh.faces.len(), mesh.points.len()), (12, 16));
        assert!((mesh.signed_volume() - 12.0).abs() < 1e-6, "{}", mesh.signed_volume());
    }
}
