//! The database written in the formats it was read from: section 9.1 saves it so, frees everything
//! and reads it back when memory is in pieces.

use std::fmt::Write;

use senca_io::classic::{ClassicOperation, ClassicProjection, ClassicScene};

use super::database::Object;

/// An object file with all digits that its vertices have as 32-bit floats, which is what the reader
/// keeps of them.
#[must_use]
pub fn object_text(object: &Object) -> String {
    let counts = [object.vertices.len(), object.polygons.len(), object.surfaces.len()];
    let mut text = format!("{} {} {}\n", counts[0], counts[1], counts[2]);
    for (number, vertex) in object.vertices.iter().enumerate() {
        let [x, y, z] = vertex.local.as_vec3().to_array();
        let _ = writeln!(text, "{number} {x} {y} {z}");
    }
    for (number, polygon) in object.polygons.iter().enumerate() {
        let _ = write!(text, "{number} {} {}", polygon.surface, polygon.corners.len());
        for corner in &polygon.corners {
            let _ = write!(text, " {}", corner.vertex);
        }
        text.push('\n');
    }
    text
}

/// A scene file with its remarks; `files` are the names of the object files. Without a light and a
/// bitmap's name, which wireframes pass over, it gets the sample scene's.
#[must_use]
pub fn scene_text(scene: &ClassicScene, files: &[String]) -> String {
    let mut text = String::new();
    let mut line = |value: String, remark: &str| {
        let _ = writeln!(text, "{value:<18}{{{remark}}}");
    };
    let numbers = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let projection = match scene.projection {
        ClassicProjection::Parallel => 0,
        ClassicProjection::Perspective => 1,
    };
    let operation = match scene.operation {
        ClassicOperation::Wireframe => 0,
        ClassicOperation::WireframeWithNormals => 1,
        ClassicOperation::Phong => 2,
        ClassicOperation::Gouraud => 3,
    };
    line(projection.to_string(), "projection type: 0 parallel, 1 perspective");
    line(scene.view_plane_distance.to_string(), "VPD: view plane from VRP along VPN");
    line(scene.projection_distance.to_string(), "COP: centre of projection from VRP along VPN");
    line(numbers(scene.vrp.into()), "VRP");
    line(numbers(scene.vpn.into()), "VPN");
    line(numbers(scene.vup.into()), "VUP");
    line(format!("{} {}", scene.window[0], scene.window[1]), "window: width height");
    line(scene.raster_height.to_string(), "raster height in pixels");
    line(operation.to_string(), "operation: 0 wireframe, 1 with normals, 2 Phong, 3 Gouraud");
    line(numbers(scene.light.map_or([0.0, 1.0, 1.0], Into::into)), "light: direction towards it");
    line(format!("{} ", scene.output.as_deref().unwrap_or("phong.btm")), "output bitmap");
    line(scene.objects.len().to_string(), "number of objects");
    for (object, file) in scene.objects.iter().zip(files) {
        line(format!("{file} "), "object file");
        line(numbers(object.scale.into()), "scale");
        line(numbers(object.rotation_degrees.into()), "rotation about x, y, z in degrees");
        line(numbers(object.translation.into()), "translation");
    }
    text
}

#[cfg(test)]
mod tests {
    use senca_io::classic::ClassicScene;

    use super::super::test_support::{load, sample, scene};
    use super::super::{BuildAlgorithm, Database, scene_text};
    use super::*;

    #[test]
    fn what_is_saved_is_read_back() {
        let folder = std::env::temp_dir().join(format!("senca-save-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let scene = scene("scene1.dat");
        let before = load(&scene, BuildAlgorithm::AsRead);
        let files = ["a.dat".to_owned(), "b.dat".to_owned()];
        for (object, file) in before.objects.iter().zip(&files) {
            std::fs::write(folder.join(file), object_text(object)).expect("writes");
        }
        let text = scene_text(&scene, &files);
        let again = ClassicScene::parse("again.dat", text.as_bytes()).expect("reads");
        let from = senca_io::Directory::new(&folder);
        let (mut after, warnings) = Database::load(&again, &from, BuildAlgorithm::AsRead).expect("reads");
        std::fs::remove_dir_all(&folder).expect("removes");
        assert!(warnings.is_empty());
        for (object, old) in after.objects.iter_mut().zip(&before.objects) {
            object.placement.file.clone_from(&old.placement.file);
        }
        assert_eq!(after, before);
    }

    #[test]
    fn scenes_of_every_kind_are_written() {
        for (projection, operation) in [
            (ClassicProjection::Parallel, ClassicOperation::Gouraud),
            (ClassicProjection::Perspective, ClassicOperation::Phong),
        ] {
            let old = ClassicScene { projection, operation, ..sample("house.dat") };
            let text = scene_text(&old, &["house.dat".to_owned()]);
            assert_eq!(ClassicScene::parse("t", text.as_bytes()).expect("reads"), old);
        }
        let wire = ClassicScene { operation: ClassicOperation::WireframeWithNormals, ..sample("house.dat") };
        let again = ClassicScene::parse("t", scene_text(&wire, &["house.dat".to_owned()]).as_bytes());
        assert_eq!(again.expect("reads").operation, ClassicOperation::WireframeWithNormals);
    }
}
