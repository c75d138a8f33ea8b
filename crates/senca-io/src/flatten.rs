//! A scene as placed meshes, for formats that know neither nodes nor shapes.

use std::borrow::Cow;

use senca_scene::math::glam::{DMat3, DMat4, Vec3};
use senca_scene::{MaterialId, Mesh, Scene, Shape, TessellationSettings, tessellate};

use crate::WriteError;

/// A mesh in world coordinates.
pub(crate) struct Placed<'a> {
    /// Name of the node, or of the geometry.
    pub(crate) name: &'a str,
    pub(crate) mesh: Cow<'a, Mesh>,
    /// Material of surfaces that name none.
    pub(crate) material: Option<MaterialId>,
}

/// The geometries that `scene` shows, each in world coordinates. Meshes keep their polygons; other
/// shapes are tessellated.
pub(crate) fn placed_meshes<'a>(
    scene: &'a Scene,
    settings: &TessellationSettings,
) -> Result<Vec<Placed<'a>>, WriteError> {
    let settings = TessellationSettings { polygons: true, ..*settings };
    scene
        .instances()
        .iter()
        .map(|instance| {
            let node = &scene.nodes[instance.node.index()];
            let geometry = &scene.geometries[instance.geometry.index()];
            let name = if node.name.is_empty() { &geometry.name } else { &node.name };
            let encode = |message: String| WriteError::Encode { message: format!("\"{name}\": {message}") };
            let mut mesh = match &geometry.shape {
                Shape::Mesh(mesh) => {
                    mesh.check().map_err(|error| encode(error.to_string()))?;
                    Cow::Borrowed(mesh)
                }
                shape => tessellate(shape, &settings).map_err(|error| encode(error.to_string()))?,
            };
            if instance.world_from_object != DMat4::IDENTITY {
                transform(mesh.to_mut(), &instance.world_from_object);
            }
            if mesh.points.iter().any(|point| !point.is_finite()) {
                return Err(encode("has points that are not finite".to_owned()));
            }
            Ok(Placed { name, mesh, material: geometry.material.or(node.material) })
        })
        .collect()
}

/// Moves points and normals; a mirroring turns the faces over, so that their fronts stay outside.
fn transform(mesh: &mut Mesh, world_from_object: &DMat4) {
    for point in &mut mesh.points {
        *point = world_from_object.transform_point3(point.as_dvec3()).as_vec3();
    }
    let linear = DMat3::from_mat4(*world_from_object);
    let normal_matrix = linear.inverse().transpose();
    for normal in &mut mesh.vertices.normal {
        let turned = (normal_matrix * normal.as_dvec3()).as_vec3();
        *normal = crate::normals::unit(turned).unwrap_or(Vec3::Z);
    }
    if linear.determinant() < 0.0 {
        for face in 0..mesh.faces.len() {
            let range = match mesh.faces.starts.get(face..face + 2) {
                Some(bounds) => bounds[0] as usize..bounds[1] as usize,
                None => 3 * face..3 * face + 3,
            };
            mesh.faces.corners[range].reverse();
        }
    }
}

/// All geometries that `scene` shows as one mesh of polygons, in world coordinates; each surface of
/// each instance is a surface of the mesh.
///
/// # Errors
/// When a shape has no mesh, or a mesh does not hold together or is not finite.
pub fn combined(scene: &Scene, settings: &TessellationSettings) -> Result<Mesh, WriteError> {
    let mut all = Mesh::default();
    for placed in placed_meshes(scene, settings)? {
        let mesh = &*placed.mesh;
        let (points, vertices, surfaces) =
            (all.points.len() as u32, all.vertices.point.len() as u32, all.surfaces.len() as u32);
        all.points.extend(&mesh.points);
        all.vertices.point.extend(mesh.vertices.point.iter().map(|point| points + point));
        all.surfaces.extend(mesh.surfaces.iter().cloned());
        for (face, corners) in mesh.faces.iter().enumerate() {
            let corners: Vec<u32> = corners.iter().map(|corner| vertices + corner).collect();
            all.faces.push(&corners, surfaces + mesh.faces.surface_of(face));
        }
    }
    Ok(all)
}
