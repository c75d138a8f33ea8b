use super::*;
use crate::NoFiles;

mod errors;
mod files;
mod hostile;
mod meaning;
mod samples;

/// Models are read by nobody.
pub(super) fn no_models(name: &str, _: &[u8], _: &dyn Files) -> Result<Scene, ReadError> {
    Err(ReadError::unsupported(Location::file(name), "no model is read here"))
}

pub(super) fn read_text(text: &str) -> Result<SceneFile, ReadError> {
    read("scene.toml", text.as_bytes(), &NoFiles, &no_models)
}

pub(super) fn scene(text: &str) -> Scene {
    match read_text(text) {
        Ok(file) => file.scene,
        Err(error) => panic!("{error}\n{text}"),
    }
}

pub(super) fn error(text: &str) -> String {
    match read_text(text) {
        Ok(_) => panic!("read without an error:\n{text}"),
        Err(error) => error.to_string(),
    }
}
