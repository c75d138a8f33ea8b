//! Telling formats apart by content.

use crate::text::Cursor;
use crate::{gltf, stl, toml_scene};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A scene file of this system, in TOML.
    SceneFile,
    /// glTF 2.0, as `.gltf` or `.glb`.
    Gltf,
    /// Wavefront OBJ.
    Obj,
    /// STL, text or binary.
    Stl,
    /// PLY, text or binary.
    Ply,
    /// Polygons of the 1991 renderer.
    ClassicObject,
    /// Patches of the 1991 converter.
    ClassicPatches,
    /// A scene of the 1991 renderer.
    ClassicScene,
    /// A picture.
    Picture,
}

/// Lines of a text that are looked at.
const LINES: usize = 200;

/// The format of `bytes`. The content decides; `extension` (without dot, any case) only where the
/// content does not tell, and `None` where neither does.
#[must_use]
pub fn detect(bytes: &[u8], extension: Option<&str>) -> Option<Format> {
    if bytes.trim_ascii().is_empty() {
        return None;
    }
    if gltf::is_gltf(bytes) {
        return Some(Format::Gltf);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if is_picture(bytes) {
        return Some(Format::Picture);
    }
    if stl::is_binary(bytes) || (stl::is_text(bytes) && mentions_facets(bytes)) {
        return Some(Format::Stl);
    }
    if toml_scene::is_scene_file(bytes) {
        return Some(Format::SceneFile);
    }
    of_numbers(bytes).or_else(|| is_obj(bytes).then_some(Format::Obj)).or_else(|| of_extension(extension?))
}

fn of_extension(extension: &str) -> Option<Format> {
    Some(match extension.to_ascii_lowercase().as_str() {
        "toml" => Format::SceneFile,
        "gltf" | "glb" => Format::Gltf,
        "obj" => Format::Obj,
        "stl" => Format::Stl,
        "ply" => Format::Ply,
        "dat" => Format::ClassicObject,
        "bez" => Format::ClassicPatches,
        "png" | "jpg" | "jpeg" | "bmp" | "ppm" | "pgm" | "pbm" | "exr" | "pfm" | "tga" | "gif" | "webp"
        | "hdr" => Format::Picture,
        _ => return None,
    })
}

/// Whether the bytes begin with the mark of a picture format.
fn is_picture(bytes: &[u8]) -> bool {
    let netpbm = matches!(bytes, [b'P', b'1'..=b'7' | b'F' | b'f', b' ' | b'\n' | b'\r' | b'\t', ..]);
    netpbm || image::guess_format(bytes).is_ok_and(|format| format != image::ImageFormat::Pnm)
}

fn mentions_facets(bytes: &[u8]) -> bool {
    let start = bytes[..bytes.len().min(1024)].to_ascii_lowercase();
    let mentions = |word: &[u8]| start.windows(word.len()).any(|window| window == word);
    mentions(b"facet") || mentions(b"endsolid")
}

/// Whether the first statement that is no remark is one of OBJ.
fn is_obj(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::with_continuation("", bytes);
    for _ in 0..LINES {
        if !cursor.start_line() {
            return false;
        }
        match cursor.word() {
            b"v" | b"vt" | b"vn" | b"vp" | b"f" | b"l" | b"p" => return cursor.number_follows(),
            b"mtllib" | b"usemtl" | b"o" | b"g" | b"cstype" => return !cursor.rest_of_line().is_empty(),
            b"s" => {}
            word if word.starts_with(b"#") => {}
            _ => return false,
        }
        cursor.next_line();
    }
    false
}

/// The formats of 1991, which begin with lines of numbers.
fn of_numbers(bytes: &[u8]) -> Option<Format> {
    let mut cursor = Cursor::new("", bytes);
    cursor.start_line();
    let header = leading_integers(&mut cursor);
    match header[..] {
        [0 | 1] => {
            // The distances of view plane and eye, then three vectors.
            let counts = [1, 1, 3, 3, 3];
            let is_scene = counts.iter().all(|&count| {
                cursor.next_line();
                (0..count).all(|_| cursor.f64("").is_ok())
            });
            is_scene.then_some(Format::ClassicScene)
        }
        [points, records, _, ..] => {
            let all_patches = records_are_patches(bytes, points, records)?;
            Some(if all_patches { Format::ClassicPatches } else { Format::ClassicObject })
        }
        _ => None,
    }
}

/// Up to four whole numbers of 0 or more on this line.
fn leading_integers(cursor: &mut Cursor<'_>) -> Vec<i64> {
    let mut found = Vec::new();
    while found.len() < 4 && cursor.number_follows() {
        match cursor.integer("") {
            Ok(number) if number >= 0 => found.push(number),
            _ => break,
        }
    }
    found
}

/// Whether the records behind the points have 16 corners each; `None` if the first point is not
/// there at all.
fn records_are_patches(bytes: &[u8], points: i64, records: i64) -> Option<bool> {
    let mut cursor = Cursor::new("", bytes);
    cursor.start_line();
    cursor.next_line();
    let next = |cursor: &mut Cursor<'_>| {
        cursor.start_line();
        cursor.f64("").ok()
    };
    if points > 0 {
        let first = next(&mut cursor)?;
        if first != 0.0 {
            return None;
        }
        (0..3).try_for_each(|_| next(&mut cursor).map(drop))?;
    }
    // A stream of numbers; remarks, which only object files have behind their numbers, end it.
    let stream = (|| {
        (0..4 * (points - 1).max(0)).try_for_each(|_| next(&mut cursor).map(drop))?;
        for _ in 0..records {
            (0..2).try_for_each(|_| next(&mut cursor).map(drop))?;
            if next(&mut cursor)? != 16.0 {
                return Some(false);
            }
            (0..16).try_for_each(|_| next(&mut cursor).map(drop))?;
        }
        Some(records > 0)
    })();
    Some(stream.unwrap_or(false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides() {
        let samples: [(&[u8], Format); 14] = [
            (include_bytes!("../../../samples/classic/house.dat"), Format::ClassicObject),
            (include_bytes!("../../../samples/classic/cylinder.dat"), Format::ClassicObject),
            (include_bytes!("../../../samples/classic/teapot.dat"), Format::ClassicObject),
            (include_bytes!("../../../samples/classic/patch.bez"), Format::ClassicPatches),
            (include_bytes!("../../../samples/classic/teapot.bez"), Format::ClassicPatches),
            (include_bytes!("../../../samples/classic/scene1.dat"), Format::ClassicScene),
            (b"# made by hand\n\nv 0 0 0\n", Format::Obj),
            (b"mtllib a.mtl\no thing\n", Format::Obj),
            (b"solid x\nfacet normal 0 0 1\n", Format::Stl),
            (b"ply\nformat ascii 1.0\n", Format::Ply),
            (b"[[lights]]\nkind = \"point\"\n", Format::SceneFile),
            (b"{\"asset\": {\"version\": \"2.0\"}}", Format::Gltf),
            (b"\x89PNG\r\n\x1a\n", Format::Picture),
            (b"P6\n1 1\n255\nabc", Format::Picture),
        ];
        for (bytes, format) in samples {
            let start = String::from_utf8_lossy(&bytes[..bytes.len().min(20)]).into_owned();
            assert_eq!(detect(bytes, Some("xyz")), Some(format), "{start:?}");
        }
        let mut binary = vec![b's'; 84];
        binary[80..].fill(0);
        assert_eq!(detect(&binary, None), Some(Format::Stl));
    }

    #[test]
    fn nothing_is_of_no_format_whatever_it_is_called() {
        for extension in ["toml", "gltf", "glb", "obj", "stl", "ply", "dat", "png"] {
            assert_eq!(detect(b"", Some(extension)), None);
            assert_eq!(detect(b" \n\r\n\t", Some(extension)), None);
        }
    }

    #[test]
    fn the_extension_decides_where_content_does_not() {
        assert_eq!(detect(b"what is this", Some("STL")), Some(Format::Stl));
        assert_eq!(detect(b"what is this", Some("toml")), Some(Format::SceneFile));
        assert_eq!(detect(b"what is this", Some("txt")), None);
        assert_eq!(detect(b"what is this", None), None);
    }
}
