//! Loading and saving whatever the format.

use std::io::Read;
use std::path::Path;

use senca_scene::math::glam::DMat4;
use senca_scene::{BezierPatch, Scene, Shape, TessellationSettings, Warning};

use crate::files::read_limited;
use crate::ply::PlyEncoding;
use crate::stl::StlEncoding;
use crate::toml_scene::{self, SceneFile};
use crate::{
    Directory, Files, Format, Limits, Location, ReadError, WriteError, classic, detect, flatten, gltf, obj,
    ply, stl, write_file,
};

/// What [`load`] reads, for messages.
const READABLE: &str =
    "scene files (TOML), glTF, GLB, OBJ, STL, PLY, and the 1991 object, patch and scene files";

/// Reads the scene in the file `path`, whatever its format; `-` is standard input. Files that it names
/// are looked for beside it.
///
/// # Errors
/// When the file or one that it names cannot be read, breaks its format, or is of no known one.
pub fn load(path: &Path) -> Result<Scene, ReadError> {
    load_with_hints(path).map(|file| file.scene)
}

/// Like [`load`], with what a scene file says on how it is meant to be drawn; other formats say
/// nothing.
///
/// # Errors
/// As [`load`].
pub fn load_with_hints(path: &Path) -> Result<SceneFile, ReadError> {
    if path == Path::new("-") {
        let bytes = standard_input(Limits::default())?;
        return load_bytes_with_hints("-", &bytes, &Directory::new("."));
    }
    let bytes = read_limited(path, Limits::default())?;
    load_bytes_with_hints(&path.display().to_string(), &bytes, &Directory::beside(path))
}

fn standard_input(limits: Limits) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let io = |source| ReadError::Io { path: "-".into(), source };
    std::io::stdin().lock().take(limits.file_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > limits.file_bytes {
        let message = format!("standard input is larger than the limit of {} bytes", limits.file_bytes);
        return Err(ReadError::limit(Location::file("-"), message));
    }
    Ok(bytes)
}

/// Reads the scene in `bytes`, whatever its format. `name` is used in messages and, where the content
/// does not tell the format, for its extension; `files` gives the files that the scene names.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    load_bytes_with_hints(name, bytes, files).map(|file| file.scene)
}

/// Like [`load_bytes`], with what a scene file says on how it is meant to be drawn.
///
/// # Errors
/// As [`load`].
pub fn load_bytes_with_hints(name: &str, bytes: &[u8], files: &dyn Files) -> Result<SceneFile, ReadError> {
    if format_of(name, bytes) == Some(Format::SceneFile) {
        return toml_scene::read(name, bytes, files, &load_model);
    }
    Ok(SceneFile { scene: load_model(name, bytes, files)?, ..SceneFile::default() })
}

fn format_of(name: &str, bytes: &[u8]) -> Option<Format> {
    detect(bytes, Path::new(name).extension().and_then(|extension| extension.to_str()))
}

/// Reads anything but a scene file.
fn load_model(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    let not_read = |what: &str| {
        Err(ReadError::unsupported(Location::file(name), format!("{what}; readable are {READABLE}")))
    };
    match format_of(name, bytes) {
        Some(Format::Gltf) => gltf::read(name, bytes, files),
        Some(Format::Obj) => obj::read(name, bytes, files),
        Some(Format::Stl) => stl::read(name, bytes, files),
        Some(Format::Ply) => ply::read(name, bytes, files),
        Some(Format::ClassicObject) => classic::read_object(name, bytes, files),
        Some(Format::ClassicPatches) => classic::read_patches(name, bytes, files),
        Some(Format::ClassicScene) => classic::read_scene(name, bytes, files),
        Some(Format::Picture) => not_read("is a picture, not a scene"),
        Some(Format::SceneFile) => not_read("is a scene file where a model is wanted"),
        None if bytes.trim_ascii().is_empty() => not_read("is empty"),
        None => not_read("is of no known format"),
    }
}

/// Writes `scene` to the file `path` in the format that its extension names: `glb`, `gltf`, `obj`
/// (with a material library and pictures beside it), `stl`, `ply`, `dat` (1991 object file) or `bez`
/// (1991 patch file). Gives what the format could not hold.
///
/// # Errors
/// When the format is unknown or cannot hold the scene, or the system refuses a file.
pub fn save(scene: &Scene, path: &Path) -> Result<Vec<Warning>, WriteError> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let settings = TessellationSettings::default();
    let mut warnings = Vec::new();
    let bytes = match extension.as_deref() {
        Some("glb") => gltf::write_glb(scene, &gltf::WriteSettings::default(), &mut warnings)?,
        Some("gltf") => gltf::write_gltf(scene, &gltf::WriteSettings::default(), &mut warnings)?,
        Some("obj") => return save_obj(scene, path, &settings),
        Some("stl") => stl::write(scene, StlEncoding::default(), &settings)?,
        Some("ply") => ply::write(scene, PlyEncoding::default(), &settings)?,
        Some("dat") => classic::write_object(&flatten::combined(scene, &settings)?)?,
        Some("bez") => classic::write_patches(&combined_patches(scene)?)?,
        other => {
            let what = other.map_or("no extension".to_owned(), |other| format!("the extension \"{other}\""));
            let message = format!(
                "{} has {what}; scenes are written as glb, gltf, obj, stl, ply, dat or bez",
                path.display()
            );
            return Err(WriteError::Unsupported { message });
        }
    };
    write_file(path, &bytes)?;
    Ok(warnings)
}

/// Pictures and library first, so that the OBJ file never names what is not there.
fn save_obj(scene: &Scene, path: &Path, settings: &TessellationSettings) -> Result<Vec<Warning>, WriteError> {
    let stem =
        path.file_stem().map_or_else(|| "scene".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let output = obj::write(scene, &stem, settings)?;
    for (name, bytes) in &output.pictures {
        write_file(&path.with_file_name(name), bytes)?;
    }
    if let Some(mtl) = &output.mtl {
        write_file(&path.with_file_name(format!("{stem}.mtl")), mtl)?;
    }
    write_file(path, &output.obj)?;
    Ok(output.warnings)
}

/// The Bézier patches that `scene` shows, in world coordinates, surfaces numbered anew from 0.
///
/// # Errors
/// [`WriteError::Unsupported`] when it shows any other shape.
pub fn combined_patches(scene: &Scene) -> Result<Vec<BezierPatch>, WriteError> {
    let mut all = Vec::new();
    for instance in scene.instances() {
        let Shape::BezierPatches { patches } = &scene.geometries[instance.geometry.index()].shape else {
            let message =
                "a patch file holds Bézier patches only; dat, obj, ply and stl hold other shapes".to_owned();
            return Err(WriteError::Unsupported { message });
        };
        append(&mut all, patches, &instance.world_from_object);
    }
    Ok(all)
}

fn append(all: &mut Vec<BezierPatch>, patches: &[BezierPatch], world_from_object: &DMat4) {
    let mut sorted: Vec<&BezierPatch> = patches.iter().collect();
    sorted.sort_by_key(|patch| patch.surface);
    let mut before = None;
    for patch in sorted {
        let last = all.last().map(|patch| patch.surface);
        let surface = match (last, before) {
            (None, _) => 0,
            (Some(last), Some(before)) if before == patch.surface => last,
            (Some(last), _) => last + 1,
        };
        before = Some(patch.surface);
        let points = patch.points.map(|point| world_from_object.transform_point3(point));
        all.push(BezierPatch { points, surface });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoFiles;

    fn sample(name: &str) -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/classic").join(name)
    }

    #[test]
    fn scenes_are_saved_and_loaded_by_extension() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        for name in ["house.dat", "teapot.bez", "scene1.dat"] {
            let scene = load(&sample(name)).expect(name);
            for extension in ["glb", "gltf", "obj", "stl", "ply", "dat"] {
                let path = dir.path().join(format!("out.{extension}"));
                save(&scene, &path).expect(extension);
                let back = load(&path).expect(extension);
                assert!(!back.geometries.is_empty(), "{name} {extension}");
            }
        }
        let teapot = load(&sample("teapot.bez")).expect("teapot");
        let path = dir.path().join("teapot.bez");
        save(&teapot, &path).expect("bez");
        assert_eq!(load(&path).expect("teapot").geometries, teapot.geometries);
        let error = save(&load(&sample("house.dat")).expect("house"), &path).expect_err("no patches");
        assert!(error.to_string().contains("patches only"), "{error}");
    }

    #[test]
    fn a_whole_house_comes_back_from_its_own_format() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let house = load(&sample("house.dat")).expect("house");
        let path = dir.path().join("house.dat");
        save(&house, &path).expect("writes");
        assert_eq!(load(&path).expect("reads").geometries, house.geometries);
    }

    #[test]
    fn what_is_no_scene_is_refused() {
        let error = load_bytes("a.png", b"\x89PNG\r\n\x1a\n", &NoFiles).expect_err("a picture");
        assert!(error.to_string().starts_with("a.png: is a picture, not a scene; readable are "), "{error}");
        let error = load_bytes("a", b"hello", &NoFiles).expect_err("a text");
        assert!(error.to_string().starts_with("a: is of no known format"), "{error}");
        assert!(load_bytes("a", b"", &NoFiles).is_err());
        assert!(matches!(load(Path::new("/no/such/file.obj")), Err(ReadError::Io { .. })));
        assert!(save(&Scene::default(), Path::new("a.xyz")).is_err());
        assert!(save(&Scene::default(), Path::new("a")).is_err());
    }
}
