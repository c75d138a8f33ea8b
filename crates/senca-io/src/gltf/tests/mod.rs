//! Small files made here, with what must come out of them.

mod hostile;
mod materials;
mod meshes;
mod nodes;
mod round_trip;

use std::collections::BTreeMap;

use serde_json::{Value, json};

use senca_scene::{Mesh, Scene, Shape};

use crate::{Files, Location, NoFiles, ReadError};

/// A glTF file in the making: its JSON and one binary buffer.
pub(super) struct Builder {
    pub(super) json: Value,
    pub(super) bin: Vec<u8>,
}

impl Builder {
    pub(super) fn new() -> Self {
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{}], "bufferViews": [], "accessors": []});
        Self { json, bin: Vec::new() }
    }

    /// Appends `value` to the list `key` and returns its number.
    pub(super) fn push(&mut self, key: &str, value: Value) -> usize {
        if self.json.get(key).is_none() {
            self.json[key] = json!([]);
        }
        let list = self.json[key].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    /// An accessor over `bytes`.
    pub(super) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    pub(super) fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, values.len() / width)
    }

    pub(super) fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, "SCALAR", values.len())
    }

    /// Four corners of a unit square in z = 0: (0,0), (1,0), (1,1), (0,1).
    pub(super) fn square(&mut self) -> usize {
        self.floats("VEC3", 3, &[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.])
    }

    /// A mesh of one primitive and a node that shows it.
    pub(super) fn show(&mut self, primitive: Value) {
        let mesh = self.push("meshes", json!({"primitives": [primitive]}));
        self.push("nodes", json!({"mesh": mesh}));
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = json!(self.bin.len());
        glb_of(&json.to_string(), &self.bin)
    }

    pub(super) fn try_read(&self) -> Result<Scene, ReadError> {
        super::read("test.glb", &self.glb(), &NoFiles)
    }

    pub(super) fn read(&self) -> Scene {
        self.try_read().expect("a sound file")
    }
}

pub(super) fn glb_of(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut glb = Vec::new();
    for word in [0x4654_6C67, 2, (28 + json.len() + bin.len()) as u32, json.len() as u32, 0x4E4F_534A] {
        glb.extend_from_slice(&u32::to_le_bytes(word));
    }
    glb.extend(json);
    glb.extend_from_slice(&(bin.len() as u32).to_le_bytes());
    glb.extend_from_slice(b"BIN\0");
    glb.extend(bin);
    glb
}

/// Files held in memory.
pub(super) struct Held(pub(super) BTreeMap<&'static str, Vec<u8>>);

impl Files for Held {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let missing = || ReadError::malformed(Location::file(uri), "is not there");
        self.0.get(uri).cloned().ok_or_else(missing)
    }
}

/// The first mesh of a scene.
pub(super) fn first_mesh(scene: &Scene) -> &Mesh {
    match &scene.geometries[0].shape {
        Shape::Mesh(mesh) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

/// The warnings, joined.
pub(super) fn warnings(scene: &Scene) -> String {
    scene.warnings.iter().map(|w| w.0.as_str()).collect::<Vec<_>>().join("\n")
}
