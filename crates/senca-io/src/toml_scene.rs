//! The scene file that people write by hand, in TOML. docs/scene-format.md is its reference.
//!
//! The text is parsed into tables that know their places, then every table is asked for the keys it
//! may have; a key that nobody asked for is refused. So each message has a line and a column, and
//! can say which keys, words or names would have been right. References are resolved in the order
//! textures, materials, definitions, cameras, lights, objects, animations, whatever their order in
//! the file.

mod animations;
mod builder;
mod cameras;
mod csg;
mod include;
mod lights;
mod materials;
mod meshes;
mod names;
mod patches;
mod render_hints;
mod shapes;
mod source;
mod transforms;
mod values;

use senca_math::LinearRgb;
use senca_scene::{Attenuation, Background, Scene};

use crate::{Files, Location, ReadError};
use builder::Builder;
use source::{Source, Table};
use values::Value;

pub use render_hints::{AccelerationHint, AntialiasingHint, MethodHint, RenderHints, ShadingHint};

/// Largest text of a scene file, in bytes. A parsed number takes some sixty times its text in the
/// worst case; larger meshes have better formats, which a scene file can include.
const LARGEST_TEXT: usize = 16 << 20;

/// Reads a model file that a scene file names: its name, its bytes, and the files beside it.
pub type ModelReader<'r> = &'r dyn Fn(&str, &[u8], &dyn Files) -> Result<Scene, ReadError>;

/// What a scene file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// How its author meant it to be drawn.
    pub render: RenderHints,
}

/// Reads the scene file `bytes`; `name` is used in messages, `files` fetches textures and models, and
/// `models` reads models that are not scene files themselves.
///
/// # Errors
/// With line and column: broken TOML, unknown keys, values of the wrong kind or outside their range,
/// names that are not defined. Errors of files that the scene names carry that file's name.
pub fn read(
    name: &str,
    bytes: &[u8],
    files: &dyn Files,
    models: ModelReader<'_>,
) -> Result<SceneFile, ReadError> {
    read_nested(name, bytes, files, models, 0)
}

/// Whether the bytes look like a scene file: text whose first line that says something is a header
/// in brackets or a key with a value.
#[must_use]
pub fn is_scene_file(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let mut lines = start.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let Some(line) = lines.find(|line| !line.is_empty() && line[0] != b'#') else { return false };
    let key = line.iter().take_while(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.' | b'"'));
    let rest = line[key.count()..].trim_ascii_start();
    match line[0] {
        b'[' => line.contains(&b']'),
        _ => rest.len() < line.len() && rest.first() == Some(&b'='),
    }
}

/// Reads a scene file that is included `depth` files deep.
fn read_nested(
    name: &str,
    bytes: &[u8],
    files: &dyn Files,
    models: ModelReader<'_>,
    depth: usize,
) -> Result<SceneFile, ReadError> {
    if bytes.len() > LARGEST_TEXT {
        let message = format!(
            "has {} bytes, more than the {LARGEST_TEXT} of a scene file; put large meshes into OBJ, \
             PLY or glTF files and name them with file = \"...\"",
            bytes.len()
        );
        return Err(ReadError::limit(Location::file(name), message));
    }
    let source = Source { name, text: text_of(name, bytes)? };
    let parsed = source::parse(source)?;
    let mut root = Table::new(source, parsed.get_ref(), 0..0, "the scene");
    let mut builder = Builder::new(source, files, models, depth);
    read_root(&mut root, &mut builder)?;
    let cameras: Vec<&str> = builder.scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    let render =
        root.read_or("render", RenderHints::default(), |value| render_hints::read(value, &cameras))?;
    root.finish()?;
    Ok(SceneFile { scene: builder.scene, render })
}

fn text_of<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, ReadError> {
    str::from_utf8(bytes).map_err(|error| {
        let valid = str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or_default();
        let at = Source { name, text: valid }.location(valid.len());
        ReadError::malformed(at, "is not UTF-8 text")
    })
}

fn read_root<'a>(root: &mut Table<'a>, builder: &mut Builder<'a>) -> Result<(), ReadError> {
    builder.scene.name = root.read_or("name", "", Value::string)?.to_owned();
    builder.scene.ambient = root.read_or("ambient", LinearRgb::BLACK, Value::color)?;
    builder.scene.background =
        root.read_or("background", Background::None, |value| lights::background(value, builder))?;
    builder.scene.fog = root.read("fog", lights::fog)?;
    builder.attenuation = root.read_or("attenuation", Attenuation::None, lights::attenuation)?;
    builder.read_textures(root)?;
    builder.read_materials(root)?;
    builder.read_nodes(root)?;
    builder.read_animations(root)
}

#[cfg(test)]
mod tests;
