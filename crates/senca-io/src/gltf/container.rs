//! From bytes to the parsed JSON and the binary chunk (glTF 2.0, section 4.4).

use super::json::{Asset, Root};
use crate::{Location, ReadError};

/// "glTF" in little-endian order.
const MAGIC: u32 = 0x4654_6C67;
/// "JSON" in little-endian order.
const JSON_CHUNK: u32 = 0x4E4F_534A;
/// "BIN" and a zero, in little-endian order.
const BIN_CHUNK: u32 = 0x004E_4942;

/// A file split into its parts.
pub(super) struct Container<'a> {
    pub(super) root: Root,
    /// Content of the binary chunk, when there is one.
    pub(super) bin: Option<&'a [u8]>,
    pub(super) warnings: Vec<String>,
}

/// Splits `bytes`, a `.gltf` or a `.glb`, and parses its JSON.
pub(super) fn open<'a>(name: &str, bytes: &'a [u8]) -> Result<Container<'a>, ReadError> {
    if word(bytes, 0) == Some(MAGIC) {
        return open_glb(name, bytes);
    }
    let skipped = if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
    let root = parse(name, &bytes[skipped..], None)?;
    Ok(Container { root, bin: None, warnings: Vec::new() })
}

/// Whether `bytes` begin as a GLB does.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    word(bytes, 0) == Some(MAGIC)
}

/// The little-endian word at byte `at`.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

fn open_glb<'a>(name: &str, bytes: &'a [u8]) -> Result<Container<'a>, ReadError> {
    let broken = |at: usize, message: String| ReadError::malformed(Location::byte(name, at as u64), message);
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(broken(bytes.len(), "the file ends inside the GLB header of 12 bytes".into()));
    };
    if version != 2 {
        let message = format!("is GLB version {version}; version 2 is read");
        return Err(ReadError::unsupported(Location::byte(name, 4), message));
    }
    let mut warnings = Vec::new();
    let length = length as usize;
    if length > bytes.len() {
        let message = format!("the header says {length} bytes, but the file ends after {}", bytes.len());
        return Err(broken(8, message));
    }
    if length < bytes.len() {
        warnings.push(format!("{} bytes after the end of the GLB are ignored", bytes.len() - length));
    }
    let (json_at, json) = chunk(name, &bytes[..length], 12, JSON_CHUNK)?
        .ok_or_else(|| broken(12, "the first chunk of a GLB must be JSON".into()))?;
    let root = parse(name, json, Some(json_at as u64))?;
    let next = json_at + json.len().next_multiple_of(4);
    let bin = chunk(name, &bytes[..length], next, BIN_CHUNK)?.map(|(_, bin)| bin);
    Ok(Container { root, bin, warnings })
}

/// The chunk whose header is at byte `at`, with where its content begins; `None` when the file ends
/// there or the chunk is of another type.
fn chunk<'a>(
    name: &str,
    bytes: &'a [u8],
    at: usize,
    chunk_type: u32,
) -> Result<Option<(usize, &'a [u8])>, ReadError> {
    if at >= bytes.len() {
        return Ok(None);
    }
    let broken = |at: usize, message: String| ReadError::malformed(Location::byte(name, at as u64), message);
    let (Some(length), Some(found)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Err(broken(at, "the file ends inside a chunk's header of 8 bytes".into()));
    };
    let content = at + 8;
    let rest = bytes.len() - content;
    if length as usize > rest {
        return Err(broken(at, format!("the chunk says {length} bytes, but only {rest} are left")));
    }
    Ok((found == chunk_type).then(|| (content, &bytes[content..content + length as usize])))
}

/// Parses the JSON; `offset` is where it begins in a GLB.
fn parse(name: &str, json: &[u8], offset: Option<u64>) -> Result<Root, ReadError> {
    let root: Root = match serde_json::from_slice(json) {
        Ok(root) => root,
        Err(error) => {
            return Err(old_version(name, json).unwrap_or_else(|| syntax(name, json, offset, &error)));
        }
    };
    let Some(asset) = &root.asset else {
        return Err(ReadError::malformed(Location::file(name), "asset: is missing; is this a glTF file?"));
    };
    unknown_version(name, asset).map_or(Ok(root), Err)
}

/// Files of glTF 1.0 are built differently, so that they fail before their version is seen.
fn old_version(name: &str, json: &[u8]) -> Option<ReadError> {
    #[derive(serde::Deserialize)]
    struct OnlyAsset {
        asset: Asset,
    }
    let only: OnlyAsset = serde_json::from_slice(json).ok()?;
    unknown_version(name, &only.asset)
}

fn unknown_version(name: &str, asset: &Asset) -> Option<ReadError> {
    let at = || Location::file(name);
    let needed = asset.min_version.as_deref().filter(|v| !matches!(*v, "2.0" | "2"));
    if let Some(needed) = needed {
        return Some(ReadError::unsupported(at(), format!("asset.minVersion: {needed:?} is above 2.0")));
    }
    let major = asset.version.split('.').next().unwrap_or_default();
    match major {
        "2" => None,
        "" => Some(ReadError::malformed(at(), "asset.version: is missing")),
        _ => Some(ReadError::unsupported(at(), format!("asset.version: {:?}; 2.0 is read", asset.version))),
    }
}

/// What the parser says, with line and column in text and the byte in a GLB.
fn syntax(name: &str, json: &[u8], offset: Option<u64>, error: &serde_json::Error) -> ReadError {
    let full = error.to_string();
    let message = full.split(" at line ").next().unwrap_or(&full).to_owned();
    let line_start = line_start(json, error.line());
    let column = error.column().saturating_sub(1);
    if let Some(offset) = offset {
        let byte = offset + (line_start + column) as u64;
        return ReadError::malformed(Location::byte(name, byte), format!("in the JSON chunk: {message}"));
    }
    let line = &json[line_start.min(json.len())..];
    let characters = String::from_utf8_lossy(&line[..column.min(line.len())]).chars().count();
    let at = Location::text(name, error.line().max(1) as u32, characters as u32 + 1);
    ReadError::malformed(at, message)
}

/// Where line `line`, counted from 1, begins.
fn line_start(text: &[u8], line: usize) -> usize {
    let before = line.saturating_sub(1);
    if before == 0 {
        return 0;
    }
    memchr::memchr_iter(b'\n', text).nth(before - 1).map_or(text.len(), |at| at + 1)
}
