//! What every target asks of a scene that was read.

use senca_scene::{Scene, Shape};

/// Panics when a mesh of `scene` does not hold together.
pub fn check(scene: &Scene) {
    for geometry in &scene.geometries {
        if let Shape::Mesh(mesh) = &geometry.shape {
            mesh.check().expect("the mesh holds together");
            mesh.check_finite().expect("the mesh is finite");
        }
    }
}
