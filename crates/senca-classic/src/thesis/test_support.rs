//! The samples, for tests.

use senca_io::Directory;
use senca_io::classic::{ClassicObject, ClassicScene};
use senca_math::glam::DVec3;

use super::{BuildAlgorithm, Database};

/// The folder of samples.
pub(super) fn samples() -> Directory {
    Directory::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../samples/classic"))
}

/// A scene file among the samples.
pub(super) fn scene(file: &str) -> ClassicScene {
    use senca_io::Files;
    ClassicScene::parse(file, &samples().read(file).expect("a sample")).expect("a scene")
}

/// The sample scene's view of a single object where it stands.
pub(super) fn sample(object_file: &str) -> ClassicScene {
    let placement = ClassicObject {
        file: object_file.to_owned(),
        scale: DVec3::ONE,
        rotation_degrees: DVec3::ZERO,
        translation: DVec3::ZERO,
    };
    ClassicScene { objects: vec![placement], ..scene("scene1.dat") }
}

/// The database of a scene over the samples.
pub(super) fn load(scene: &ClassicScene, algorithm: BuildAlgorithm) -> Database {
    Database::load(scene, &samples(), algorithm).expect("a database").0
}
