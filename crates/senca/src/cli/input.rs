//! Where scenes and texts come from: a file, or standard input.

use std::io::Read;
use std::path::Path;

use senca::Scene;
use senca::io::toml_scene::SceneFile;
use senca::io::{Limits, Location, ReadError, load_with_hints};

use super::Failure;
use super::output::is_standard;

/// The name of standard input in messages.
const STANDARD_INPUT: &str = "standard input";

/// The scene in the file at `path`; `-` is standard input.
pub(crate) fn read_scene(path: &Path) -> Result<Scene, Failure> {
    Ok(read_scene_and_hints(path)?.scene)
}

/// The scene in the file at `path` with what it says about its picture; `-` is standard input.
pub(crate) fn read_scene_and_hints(path: &Path) -> Result<SceneFile, Failure> {
    refuse_folder(path)?;
    Ok(load_with_hints(path)?)
}

/// Says of a folder what it is, which not every system does.
fn refuse_folder(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::input(format!("{}: is a folder; a file is needed", path.display())));
    }
    Ok(())
}

/// Name for messages and content of the text file at `path`; `-` is standard input.
pub(crate) fn read_text(path: &Path) -> Result<(String, String), Failure> {
    let (name, bytes) = read_bytes(path)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = Location::byte(&name, error.utf8_error().valid_up_to() as u64);
        Failure::from(ReadError::malformed(at, "is not text in UTF-8"))
    })?;
    Ok((name, text))
}

/// Name for messages and content of the file at `path`; `-` is standard input.
pub(crate) fn read_bytes(path: &Path) -> Result<(String, Vec<u8>), Failure> {
    if is_standard(path) {
        return Ok((STANDARD_INPUT.to_owned(), read_standard_input()?));
    }
    refuse_folder(path)?;
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| Failure::input(format!("{name}: {e}")))?;
    Ok((name, bytes))
}

fn read_standard_input() -> Result<Vec<u8>, Failure> {
    let limit = Limits::default().file_bytes;
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|e| Failure::input(format!("{STANDARD_INPUT}: {e}")))?;
    if bytes.len() as u64 > limit {
        return Err(Failure::input(format!("{STANDARD_INPUT}: is larger than the limit of {limit} bytes")));
    }
    Ok(bytes)
}
