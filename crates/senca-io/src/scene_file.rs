//! Scenes of any format, told by their content.

use std::fmt;
use std::path::Path;

use senca_scene::Scene;

use crate::files::read_limited;
use crate::toml_scene::{self, RenderHints, SceneFile};
use crate::{Directory, Files, Limits, Location, ReadError, classic, gltf, obj, ply, stl};

/// Formats that scenes are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SceneFormat {
    /// The scene file that people write by hand.
    Toml,
    /// glTF 2.0, as JSON or GLB.
    Gltf,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, text or binary.
    Stl,
    /// Polygon file format, text or binary.
    Ply,
    /// Scene file of 1991.
    Scene1991,
    /// Object file of 1991.
    Object1991,
    /// Patch file of 1991.
    Patches1991,
}

impl fmt::Display for SceneFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Toml => "TOML scene",
            Self::Gltf => "glTF",
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Scene1991 => "scene file of 1991",
            Self::Object1991 => "object file of 1991",
            Self::Patches1991 => "patch file of 1991",
        })
    }
}

/// Bytes of a file that are looked at to tell its format.
const HEAD: usize = 1 << 16;

/// First words of statements that OBJ files begin with.
const OBJ_WORDS: [&str; 22] = [
    "v", "vn", "vt", "vp", "f", "o", "g", "s", "l", "p", "mg", "mtllib", "maplib", "usemtl", "usemap", "deg",
    "cstype", "bmat", "step", "curv", "surf", "ctech",
];

impl SceneFormat {
    /// The format of a file's content; `name` is asked only where content alone leaves it open, as in
    /// a damaged binary file. `None` when no format fits.
    #[must_use]
    pub fn detect(name: &str, bytes: &[u8]) -> Option<Self> {
        if gltf::is_gltf(bytes) {
            return Some(Self::Gltf);
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if is_binary_stl(bytes) {
            return Some(Self::Stl);
        }
        let of_text = || Self::of_text(&bytes[..bytes.len().min(HEAD)]);
        let toml = toml_scene::is_scene_file(bytes).then_some(Self::Toml);
        toml.or_else(|| of_numbers(bytes)).or_else(of_text).or_else(|| Self::of_name(name))
    }

    /// The format of a text whose beginning is `head`; `None` when it is not a text.
    fn of_text(head: &[u8]) -> Option<Self> {
        if head.contains(&0) {
            return None;
        }
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
        let first = lines.next()?;
        let mut words = first.split_ascii_whitespace();
        let word = words.next()?;
        if word.eq_ignore_ascii_case("solid") && !first.contains('=') {
            return Some(Self::Stl);
        }
        let is_statement = OBJ_WORDS.contains(&word) && !words.next().is_some_and(|w| w.starts_with('='));
        is_statement.then_some(Self::Obj)
    }

    /// The format that a file's extension names.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let extension = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "toml" => Self::Toml,
            "gltf" | "glb" => Self::Gltf,
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            "ply" => Self::Ply,
            "bez" => Self::Patches1991,
            "dat" => Self::Object1991,
            _ => return None,
        })
    }
}

/// Which of the files of 1991, that begin with numbers, this is. A scene file has one number in its
/// first line, the projection; the others a header of three or four. Of these a patch file's first
/// record behind the points has 16 corners.
fn of_numbers(bytes: &[u8]) -> Option<SceneFormat> {
    let line_end = bytes.iter().position(|&b| b == b'\n').unwrap_or(bytes.len());
    let first_line = str::from_utf8(bytes.get(..line_end.min(HEAD))?).ok()?;
    let header = first_line.split_whitespace().map_while(|w| w.parse::<u32>().ok()).collect::<Vec<_>>();
    match *header.as_slice() {
        [0 | 1] => Some(SceneFormat::Scene1991),
        [points, _, _] | [points, _, _, _] => {
            let rest = str::from_utf8(&bytes[line_end..]).ok()?;
            let mut numbers = rest.split_whitespace().map_while(|w| w.parse::<f64>().ok());
            let corners = numbers.nth((points as usize).saturating_mul(4).saturating_add(2));
            Some(if corners == Some(16.0) { SceneFormat::Patches1991 } else { SceneFormat::Object1991 })
        }
        _ => None,
    }
}

/// Whether the length is the one that a binary STL's count of facets asks for.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|c| c.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() as u64 == 84 + 50 * u64::from(count))
}

/// Reads a scene of any format. `name` is used in messages; `files` gives the files that the scene
/// names.
///
/// # Errors
/// When no format fits, or the format's own reader says so.
pub fn read_scene(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    Ok(read_scene_and_hints(name, bytes, files)?.scene)
}

/// As [`read_scene`], with what a scene file written by hand says about its picture.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_and_hints(name: &str, bytes: &[u8], files: &dyn Files) -> Result<SceneFile, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::malformed(Location::file(name), "is empty; a scene or a model is needed"));
    }
    let scene = match SceneFormat::detect(name, bytes) {
        Some(SceneFormat::Toml) => return toml_scene::read(name, bytes, files, &read_scene),
        Some(SceneFormat::Gltf) => gltf::read(name, bytes, files)?,
        Some(SceneFormat::Obj) => obj::read(name, bytes, files)?,
        Some(SceneFormat::Stl) => stl::read(name, bytes, files)?,
        Some(SceneFormat::Ply) => ply::read(name, bytes, files)?,
        Some(SceneFormat::Scene1991) => classic::read_scene(name, bytes, files)?,
        Some(SceneFormat::Object1991) => classic::read_object(name, bytes, files)?,
        Some(SceneFormat::Patches1991) => classic::read_patches(name, bytes, files)?,
        None => {
            let message = "is no scene or model of a known format (TOML scene, glTF, OBJ, STL, PLY, \
                           1991 files)";
            return Err(ReadError::unsupported(Location::file(name), message));
        }
    };
    Ok(SceneFile { scene, render: RenderHints::default() })
}

/// Reads the scene in the file at `path`; files that it names are looked for beside it.
///
/// # Errors
/// When the system refuses, and as [`read_scene`].
pub fn read_scene_file(path: &Path) -> Result<Scene, ReadError> {
    Ok(read_scene_file_and_hints(path)?.scene)
}

/// As [`read_scene_file`], with what a scene file written by hand says about its picture.
///
/// # Errors
/// As [`read_scene_file`].
pub fn read_scene_file_and_hints(path: &Path) -> Result<SceneFile, ReadError> {
    let name = path.display().to_string();
    if path.is_dir() {
        return Err(ReadError::malformed(Location::file(&name), "is a folder; a file is needed"));
    }
    let bytes = read_limited(path, Limits::default())?;
    read_scene_and_hints(&name, &bytes, &Directory::beside(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoFiles;

    #[test]
    fn content_tells_the_format_whatever_the_name() {
        let binary_stl = [&[0; 80][..], &1u32.to_le_bytes(), &[0; 50]].concat();
        for (bytes, format) in [
            (&b"glTF\x02\0\0\0"[..], SceneFormat::Gltf),
            (b" {\"asset\": {\"version\": \"2.0\"}}", SceneFormat::Gltf),
            (b"ply\nformat ascii 1.0\n", SceneFormat::Ply),
            (b"solid a\nfacet normal 0 0 1\n", SceneFormat::Stl),
            (b"# a remark\n\nv 0 0 0\n", SceneFormat::Obj),
            (b"mtllib a.mtl\r\n", SceneFormat::Obj),
            (b"1 {perspective}\n60.0\n", SceneFormat::Scene1991),
            (b"1 1 1\n0 0 0 0\n0 0 16 0 0", SceneFormat::Patches1991),
            (b"3 1 1 1\n0 0 0 0\n1 1 0 0\n2 0 1 0\n0 0 3 0 1 2\n", SceneFormat::Object1991),
            (b"# a scene\n[camera]\n", SceneFormat::Toml),
            (b"name = \"house\"\n", SceneFormat::Toml),
            (&binary_stl, SceneFormat::Stl),
        ] {
            assert_eq!(SceneFormat::detect("a.png", bytes), Some(format));
        }
    }

    #[test]
    fn the_name_helps_only_where_content_does_not_tell() {
        assert_eq!(SceneFormat::detect("a.STL", &[0; 100]), Some(SceneFormat::Stl));
        assert_eq!(SceneFormat::detect("a", &[0; 100]), None);
    }

    #[test]
    fn what_is_no_scene_is_refused_by_name() {
        for (bytes, part) in [(&b""[..], "is empty"), (b"hello", "no scene"), (&[0, 1, 2], "no scene")] {
            let message = read_scene("x", bytes, &NoFiles).expect_err("no scene").to_string();
            assert!(message.starts_with("x: ") && message.contains(part), "{message}");
        }
        assert!(read_scene_file(Path::new(".")).is_err_and(|e| e.to_string().contains("folder")));
    }
}
