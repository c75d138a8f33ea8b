//! Writing a scene as glTF 2.0.
//!
//! - Meshes are written in triangles, each surface as a primitive over the mesh's shared vertices;
//!   other shapes are tessellated. Surfaces that are flat and have no normals stay without, as the
//!   format's default is flat.
//! - Phong materials become the nearest metallic-roughness ones. Materials that come from a node
//!   give the mesh one copy per such material.
//! - What the format cannot hold (fog, background, ambient light, lights with another fall-off than
//!   inverse square) is left out with a warning.
//! - The same scene gives the same bytes.

mod animation;
mod camera;
mod material;
mod mesh;
mod node;

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine;
use serde_json::{Map, Value, json};

use senca_scene::math::LinearRgb;
use senca_scene::{Background, Scene, TessellationSettings, Warning};

use crate::WriteError;

/// How scenes are written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteSettings {
    /// How shapes other than meshes become meshes, and how normals are made where there are none.
    pub tessellation: TessellationSettings,
}

/// Writes `scene` as a GLB file. What the format cannot hold is appended to `warnings`.
///
/// # Errors
/// When a shape cannot be tessellated, a mesh or picture contradicts itself, or the file would be
/// larger than the 4 GiB that the format allows.
pub fn write_glb(
    scene: &Scene,
    settings: &WriteSettings,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<u8>, WriteError> {
    Output::of(scene, settings, warnings)?.into_glb()
}

/// Writes `scene` as one `.gltf` text file, with buffers and pictures inside as data URIs. What the
/// format cannot hold is appended to `warnings`.
///
/// # Errors
/// As [`write_glb`].
pub fn write_gltf(
    scene: &Scene,
    settings: &WriteSettings,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<u8>, WriteError> {
    Output::of(scene, settings, warnings)?.into_text()
}

/// A file in the making.
#[derive(Default)]
struct Output {
    lists: BTreeMap<&'static str, Vec<Value>>,
    lights: Vec<Value>,
    bin: Vec<u8>,
    extensions: BTreeSet<&'static str>,
    warnings: Vec<Warning>,
}

/// Types of components, by their numbers in the file.
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// What a buffer view holds.
#[derive(Clone, Copy)]
enum Target {
    Vertices,
    Indices,
    Other,
}

impl Output {
    /// The file of `scene`; what it cannot hold is appended to `warnings`.
    fn of(scene: &Scene, settings: &WriteSettings, warnings: &mut Vec<Warning>) -> Result<Self, WriteError> {
        let mut output = Self::default();
        output.warn_of_losses(scene);
        output.add_materials(scene)?;
        let meshes = output.add_meshes(scene, settings)?;
        output.add_nodes(scene, &meshes);
        output.add_animations(scene);
        warnings.append(&mut output.warnings);
        Ok(output)
    }

    fn warn_of_losses(&mut self, scene: &Scene) {
        let lost = [
            (scene.ambient != LinearRgb::BLACK, "ambient light"),
            (scene.fog.is_some(), "fog"),
            (scene.background != Background::None, "the background"),
        ];
        for (_, what) in lost.into_iter().filter(|(is_there, _)| *is_there) {
            self.warn(format!("glTF has no place for {what}; it is left out"));
        }
    }

    fn warn(&mut self, message: String) {
        let warning = Warning(message);
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Appends `value` to the list `key` and returns its number.
    fn push(&mut self, key: &'static str, value: Value) -> usize {
        let list = self.lists.entry(key).or_default();
        list.push(value);
        list.len() - 1
    }

    /// Appends bytes as a buffer view, aligned to four bytes.
    fn add_view(&mut self, bytes: &[u8], target: Target) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        match target {
            Target::Vertices => view["target"] = json!(34962),
            Target::Indices => view["target"] = json!(34963),
            Target::Other => {}
        }
        self.push("bufferViews", view)
    }

    /// Appends an accessor of floats, `N` a piece; `bounds` adds the least and largest values.
    fn add_floats<const N: usize>(&mut self, values: &[[f32; N]], target: Target, bounds: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let kind = match N {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        let mut accessor = json!({"componentType": F32, "type": kind, "count": values.len()});
        if bounds {
            let fold = |start: f32, pick: fn(f32, f32) -> f32| {
                values.iter().fold([start; N], |best, v| std::array::from_fn(|i| pick(best[i], v[i])))
            };
            accessor["min"] = numbers(&fold(f32::INFINITY, f32::min));
            accessor["max"] = numbers(&fold(f32::NEG_INFINITY, f32::max));
        }
        accessor["bufferView"] = json!(self.add_view(&bytes, target));
        self.push("accessors", accessor)
    }

    /// Appends an accessor of indices below `count`.
    fn add_indices(&mut self, indices: &[u32], count: usize) -> usize {
        let (component, bytes): (u32, Vec<u8>) = if count <= usize::from(u16::MAX) {
            (U16, indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect())
        } else {
            (U32, indices.iter().flat_map(|i| i.to_le_bytes()).collect())
        };
        let view = self.add_view(&bytes, Target::Indices);
        let accessor =
            json!({"bufferView": view, "componentType": component, "type": "SCALAR", "count": indices.len()});
        self.push("accessors", accessor)
    }

    /// The JSON; `uri` is where the buffer is when it is not the binary chunk.
    fn root(&mut self, uri: Option<String>) -> Value {
        let generator = concat!("Senca ", env!("CARGO_PKG_VERSION"));
        let mut root = json!({"asset": {"version": "2.0", "generator": generator}});
        if !self.bin.is_empty() {
            self.bin.resize(self.bin.len().next_multiple_of(4), 0);
            let mut buffer = json!({"byteLength": self.bin.len()});
            if let Some(uri) = uri {
                buffer["uri"] = Value::String(uri);
            }
            root["buffers"] = json!([buffer]);
        }
        for (key, list) in std::mem::take(&mut self.lists) {
            root[key] = Value::Array(list);
        }
        root["scene"] = json!(0);
        if !self.lights.is_empty() {
            root["extensions"] = json!({"KHR_lights_punctual": {"lights": std::mem::take(&mut self.lights)}});
            self.extensions.insert("KHR_lights_punctual");
        }
        if !self.extensions.is_empty() {
            root["extensionsUsed"] = json!(self.extensions);
        }
        root
    }

    fn into_glb(mut self) -> Result<Vec<u8>, WriteError> {
        let mut json = self.root(None).to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let bin_chunk = if self.bin.is_empty() { 0 } else { 8 + self.bin.len() };
        let length = u32::try_from(20 + json.len() + bin_chunk)
            .map_err(|_| WriteError::Unsupported { message: "a GLB file holds at most 4 GiB".to_owned() })?;
        let mut glb = Vec::with_capacity(length as usize);
        glb.extend_from_slice(b"glTF");
        glb.extend([2, length, json.len() as u32].map(u32::to_le_bytes).as_flattened());
        glb.extend_from_slice(b"JSON");
        glb.extend(json);
        if !self.bin.is_empty() {
            glb.extend_from_slice(&(self.bin.len() as u32).to_le_bytes());
            glb.extend_from_slice(b"BIN\0");
            glb.extend(self.bin);
        }
        Ok(glb)
    }

    fn into_text(mut self) -> Result<Vec<u8>, WriteError> {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bin);
        let root = self.root(Some(format!("data:application/octet-stream;base64,{data}")));
        let mut text = serde_json::to_vec_pretty(&root)
            .map_err(|error| WriteError::Encode { message: format!("JSON: {error}") })?;
        text.push(b'\n');
        Ok(text)
    }
}

/// A JSON list of numbers; what is not finite, which JSON does not know, becomes 0.
fn numbers<T: Copy + Into<f64>>(values: &[T]) -> Value {
    let number = |&v: &T| {
        let v: f64 = v.into();
        json!(if v.is_finite() { v } else { 0.0 })
    };
    Value::Array(values.iter().map(number).collect())
}

/// A JSON object, with its name when it has one.
fn named(name: &str) -> Map<String, Value> {
    let mut object = Map::new();
    if !name.is_empty() {
        object.insert("name".to_owned(), json!(name));
    }
    object
}

/// Sets `key` to `value`.
fn set(object: &mut Map<String, Value>, key: &str, value: Value) {
    object.insert(key.to_owned(), value);
}
