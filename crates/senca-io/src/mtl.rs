//! Wavefront material libraries (Alias|Wavefront, Advanced Visualizer manual, MTL material format).
//!
//! 1. `Ka Kd Ks Ke Tf` are linear light, as Blender writes them; pictures of colours are sRGB.
//! 2. A material is a [`Phong`](senca_scene::Phong) one, unless it uses the statements `Pr`, `Pm` or
//!    their maps, which make it metallic-roughness.
//! 3. `illum` 0 is unlit; 1 has no highlight; 3, 4, 5, 6, 7 and 9 mirror by `Ks`; 4, 6, 7 and 9 let
//!    through `Tf`, or what `d` leaves where that is missing.
//! 4. `map_d` goes into the alpha of the diffuse picture. `bump` pictures that are no normal maps
//!    are heights and are turned into normals.
//! 5. A picture that cannot be read gives a warning; malformed numbers are errors.

mod material;
mod pictures;
#[cfg(test)]
mod tests;
mod write;

pub(crate) use write::{unique_names, write};

use std::collections::HashMap;

use senca_scene::math::LinearRgb;
use senca_scene::{MaterialId, Scene, Warning};

use crate::text::Cursor;
use crate::{Files, ReadError};
use pictures::Pictures;

/// Most warnings of one library.
const WARNINGS: usize = 20;

/// Reads `libraries` into `scene`; `ids` gets the materials by name. Returns whether a library could
/// not be read.
pub(crate) fn read_libraries(
    libraries: &[String],
    files: &dyn Files,
    scene: &mut Scene,
    ids: &mut HashMap<String, MaterialId>,
) -> Result<bool, ReadError> {
    let mut missing = false;
    let mut pictures = Pictures::new(files);
    let mut seen = Vec::new();
    for library in libraries {
        for (name, content) in open(library, files) {
            if seen.contains(&name) {
                continue;
            }
            match content {
                Ok(bytes) => {
                    for entry in parse(&name, &bytes, &mut scene.warnings)? {
                        let id = material::add(&entry, scene, &mut pictures);
                        ids.insert(entry.name, id);
                    }
                }
                Err(error) => {
                    missing = true;
                    scene.warnings.push(Warning(format!("material library left out: {error}")));
                }
            }
            seen.push(name);
        }
    }
    Ok(missing)
}

/// The libraries that a statement names: one whose name has blanks, or several.
fn open(names: &str, files: &dyn Files) -> Vec<(String, Result<Vec<u8>, ReadError>)> {
    let whole = files.read(names);
    if whole.is_ok() || names.split_whitespace().count() < 2 {
        return vec![(names.to_owned(), whole)];
    }
    names.split_whitespace().map(|name| (name.to_owned(), files.read(name))).collect()
}

/// A material as it stands in the file.
#[derive(Clone, Debug, Default)]
struct Entry {
    name: String,
    ka: Option<LinearRgb>,
    kd: Option<LinearRgb>,
    ks: Option<LinearRgb>,
    ke: Option<LinearRgb>,
    tf: Option<LinearRgb>,
    ns: Option<f32>,
    d: Option<f32>,
    tr: Option<f32>,
    ni: Option<f32>,
    illum: Option<i64>,
    pr: Option<f32>,
    pm: Option<f32>,
    maps: HashMap<Slot, Map>,
}

/// What a picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Slot {
    Diffuse,
    Specular,
    Emission,
    Alpha,
    Bump,
    Normal,
    Roughness,
    Metallic,
    Occlusion,
}

/// A picture with its options.
#[derive(Clone, Debug, PartialEq)]
struct Map {
    file: String,
    /// Added to the texture coordinates after scaling; v counts from the bottom.
    offset: [f32; 2],
    scale: [f32; 2],
    clamp: bool,
    /// `-bm`.
    strength: f32,
}

/// Reads the materials of one library.
fn parse(name: &str, bytes: &[u8], warnings: &mut Vec<Warning>) -> Result<Vec<Entry>, ReadError> {
    let mut cursor = Cursor::with_continuation(name, bytes);
    let mut entries: Vec<Entry> = Vec::new();
    let mut odd: Vec<String> = Vec::new();
    while cursor.start_line() {
        let start = cursor.pos;
        let word = String::from_utf8_lossy(cursor.word()).into_owned();
        if word.starts_with('#') {
            cursor.next_line();
            continue;
        }
        if word == "newmtl" {
            entries.push(Entry { name: cursor.rest_of_line(), ..Entry::default() });
            cursor.next_line();
            continue;
        }
        let Some(entry) = entries.last_mut() else {
            return Err(cursor.malformed(start, "a material begins with \"newmtl\""));
        };
        if !statement(entry, &word, &mut cursor)? && !odd.contains(&word) && odd.len() < WARNINGS {
            let place = cursor.location(start);
            let shown: String = word.chars().take(30).collect();
            warnings.push(Warning(format!("{place}: \"{}\" is passed over", shown.escape_debug())));
            odd.push(word);
        }
        cursor.next_line();
    }
    Ok(entries)
}

/// Reads one statement into `entry`; false if it has no effect here.
fn statement(entry: &mut Entry, word: &str, cursor: &mut Cursor<'_>) -> Result<bool, ReadError> {
    match word {
        "Ka" => return color(&mut entry.ka, cursor),
        "Kd" => return color(&mut entry.kd, cursor),
        "Ks" => return color(&mut entry.ks, cursor),
        "Ke" => return color(&mut entry.ke, cursor),
        "Tf" => return color(&mut entry.tf, cursor),
        "Ns" => entry.ns = Some(cursor.f32("the exponent")?),
        "Ni" => entry.ni = Some(cursor.f32("the index of refraction")?),
        "Tr" => entry.tr = Some(cursor.f32("the transparency")?),
        "Pr" => entry.pr = Some(cursor.f32("the roughness")?),
        "Pm" => entry.pm = Some(cursor.f32("the metalness")?),
        "illum" => entry.illum = Some(cursor.integer("the number of an illumination model")?),
        "d" => {
            cursor.skip_blanks();
            if cursor.rest().starts_with(b"-halo") {
                cursor.word();
            }
            entry.d = Some(cursor.f32("the opacity")?);
        }
        "sharpness" | "Pc" | "Pcr" | "Ps" | "aniso" | "anisor" | "map_aat" => {}
        _ => {
            let Some(slot) = slot(word) else { return Ok(false) };
            let map = map(cursor)?;
            entry.maps.insert(slot, map);
        }
    }
    Ok(true)
}

fn slot(word: &str) -> Option<Slot> {
    Some(match word.to_ascii_lowercase().as_str() {
        "map_kd" => Slot::Diffuse,
        "map_ks" => Slot::Specular,
        "map_ke" => Slot::Emission,
        "map_d" | "map_opacity" => Slot::Alpha,
        "bump" | "map_bump" => Slot::Bump,
        "norm" | "map_norm" | "map_kn" => Slot::Normal,
        "map_pr" => Slot::Roughness,
        "map_pm" => Slot::Metallic,
        "map_ao" => Slot::Occlusion,
        _ => return None,
    })
}

/// A colour: one number or three, or three CIE XYZ values behind `xyz`. Spectral files have no effect.
fn color(target: &mut Option<LinearRgb>, cursor: &mut Cursor<'_>) -> Result<bool, ReadError> {
    cursor.skip_blanks();
    if cursor.rest().starts_with(b"spectral") {
        return Ok(false);
    }
    let xyz = cursor.rest().starts_with(b"xyz");
    if xyz {
        cursor.word();
    }
    let first = cursor.f32("a colour")?;
    let mut color = LinearRgb::splat(first);
    cursor.skip_blanks();
    if !cursor.at_line_end() && cursor.peek() != Some(b'#') {
        color.g = cursor.f32("a colour's second part")?;
        color.b = cursor.f32("a colour's third part")?;
    }
    *target = Some(if xyz { rgb_from_xyz(color) } else { color });
    Ok(true)
}

/// Linear sRGB of CIE XYZ (IEC 61966-2-1).
fn rgb_from_xyz(c: LinearRgb) -> LinearRgb {
    let (x, y, z) = (c.r, c.g, c.b);
    LinearRgb::new(
        3.240_97 * x - 1.537_383_2 * y - 0.498_610_76 * z,
        -0.969_243_65 * x + 1.875_967_5 * y + 0.041_555_06 * z,
        0.055_630_08 * x - 0.203_976_96 * y + 1.056_971_5 * z,
    )
    .map(|v| v.max(0.0))
}

/// The options and the name of a picture.
fn map(cursor: &mut Cursor<'_>) -> Result<Map, ReadError> {
    let mut map = Map { file: String::new(), offset: [0.0; 2], scale: [1.0; 2], clamp: false, strength: 1.0 };
    loop {
        cursor.skip_blanks();
        let start = cursor.pos;
        match cursor.word() {
            b"-o" => map.offset = vector(cursor, 0.0)?,
            b"-s" => map.scale = vector(cursor, 1.0)?,
            b"-t" => {
                vector(cursor, 0.0)?;
            }
            b"-bm" => map.strength = cursor.f32("the strength of the bumps")?,
            b"-clamp" => map.clamp = option_word(cursor) == b"on",
            b"-boost" | b"-texres" => {
                cursor.f32("a number")?;
            }
            b"-mm" => {
                cursor.f32("the base")?;
                cursor.f32("the gain")?;
            }
            b"-blendu" | b"-blendv" | b"-cc" | b"-imfchan" | b"-type" => {
                option_word(cursor);
            }
            _ => {
                cursor.pos = start;
                map.file = cursor.rest_of_line().trim_matches('"').to_owned();
                if map.file.is_empty() {
                    return Err(cursor.expected("the name of a picture"));
                }
                return Ok(map);
            }
        }
    }
}

fn option_word<'a>(cursor: &mut Cursor<'a>) -> &'a [u8] {
    cursor.skip_blanks();
    cursor.word()
}

/// One to three numbers; only the first two matter.
fn vector(cursor: &mut Cursor<'_>, default: f32) -> Result<[f32; 2], ReadError> {
    let mut vector = [cursor.f32("a number")?, default];
    for i in 1..3 {
        let start = cursor.pos;
        match cursor.f32("a number") {
            Ok(value) if i == 1 => vector[1] = value,
            Ok(_) => {}
            // What follows is the name of the picture, even if it begins with a digit.
            Err(_) => {
                cursor.pos = start;
                break;
            }
        }
    }
    Ok(vector)
}
