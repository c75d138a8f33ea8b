//! What a solution depends on, as one number.

use std::fmt::Write;

use senca_math::glam::DMat4;
use senca_scene::{ImageData, Mesh, Scene, Shape};

use super::bytes::Hash;

/// A number that differs between scenes in which light differs: shapes in their places, materials with
/// their pictures, and lights count; names of nodes, cameras, background and fog do not. The scene is in
/// its pose (see `Scene::at_time`).
#[must_use]
pub fn light_fingerprint(scene: &Scene) -> u64 {
    let mut hash = Hash::default();
    for instance in scene.instances() {
        add_debug(&mut hash, &(instance.geometry, scene.nodes[instance.node.index()].material));
        add_matrix(&mut hash, &instance.world_from_object);
    }
    for geometry in &scene.geometries {
        add_debug(&mut hash, &geometry.material);
        match &geometry.shape {
            Shape::Mesh(mesh) => add_mesh(&mut hash, mesh),
            shape => add_debug(&mut hash, shape),
        }
    }
    add_debug(&mut hash, &(&scene.materials, &scene.textures, scene.ambient));
    scene.images.iter().for_each(|image| add_image(&mut hash, &image.data));
    for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
        if let (Some(light), Some(world_from_light)) = (node.light, world_from_node) {
            add_debug(&mut hash, &scene.lights.get(light.index()));
            add_matrix(&mut hash, &world_from_light);
        }
    }
    hash.value()
}

fn add_debug(hash: &mut Hash, value: &impl std::fmt::Debug) {
    // Writing to it cannot fail.
    let _ = write!(hash, "{value:?}");
}

fn add_matrix(hash: &mut Hash, matrix: &DMat4) {
    matrix.to_cols_array().iter().for_each(|number| hash.add(&number.to_le_bytes()));
}

/// The long lists of numbers as bytes, since as text they take long.
fn add_mesh(hash: &mut Hash, mesh: &Mesh) {
    let floats = |hash: &mut Hash, values: &[f32]| {
        hash.add(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|value| hash.add(&value.to_le_bytes()));
    };
    let numbers = |hash: &mut Hash, values: &[u32]| {
        hash.add(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|value| hash.add(&value.to_le_bytes()));
    };
    let vertices = &mesh.vertices;
    for vectors in [&mesh.points, &vertices.normal] {
        floats(hash, vectors.iter().map(|v| v.to_array()).collect::<Vec<_>>().as_flattened());
    }
    for vectors in [&vertices.texcoord0, &vertices.texcoord1] {
        floats(hash, vectors.iter().map(|v| v.to_array()).collect::<Vec<_>>().as_flattened());
    }
    floats(hash, vertices.color.iter().map(|v| v.to_array()).collect::<Vec<_>>().as_flattened());
    for list in [&vertices.point, &mesh.faces.corners, &mesh.faces.starts, &mesh.faces.surface] {
        numbers(hash, list);
    }
    add_debug(hash, &mesh.surfaces);
}

fn add_image(hash: &mut Hash, image: &ImageData) {
    add_debug(hash, &image.size());
    match image {
        ImageData::Rgba8 { texels, .. } => hash.add(texels.as_flattened()),
        ImageData::RgbaF32 { texels, .. } => {
            texels.as_flattened().iter().for_each(|value| hash.add(&value.to_le_bytes()));
        }
    }
}
