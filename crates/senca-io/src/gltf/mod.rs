//! glTF 2.0, as text (`.gltf`) and binary (`.glb`), with its extensions.
//!
//! # Reading
//!
//! [`read`] takes either form. What becomes what:
//!
//! - A glTF mesh becomes one [`Mesh`](senca_scene::Mesh), each of its triangle primitives a
//!   [`Surface`](senca_scene::Surface). Points, lines, strips, loops and fans become dots, lines and
//!   triangles. Vertices stand one to one with points. A primitive without normals is flat.
//! - A primitive without material gets no material (the renderer's default), not the white metal that
//!   the format's text asks for, because shape is then easier to see.
//! - Nodes keep their numbers; instances (EXT_mesh_gpu_instancing) become children at the end. The
//!   default scene's nodes, or those of the first scene, are the roots.
//! - Lights: lux and candela are divided by pi, so that a white matt surface shows what other viewers of
//!   glTF show; strengths above what a display shows are kept.
//! - Accessors may be of any type, normalised, sparse or without buffer, with positions, normals,
//!   tangents and texture coordinates of any allowed type (KHR_mesh_quantization).
//! - Also read: KHR_lights_punctual, KHR_materials_emissive_strength, KHR_materials_ior,
//!   KHR_materials_pbrSpecularGlossiness (converted), KHR_materials_transmission (without its
//!   texture), KHR_materials_unlit, KHR_materials_volume (its attenuation), KHR_texture_transform.
//!
//! What is odd but can be shown (an element that names a missing vertex, a lost picture, a node with
//! two parents) is left out with a warning in [`Scene::warnings`]; what leaves nothing to trust (an
//! accessor outside of its buffer, a wrong chunk length) is one error that names the place, such as
//! `accessors[3].bufferView`. An extension in `extensionsRequired` that is not read is an error, in
//! `extensionsUsed` a warning.
//!
//! The JSON is parsed by serde into structures of our own rather than by the `gltf` crate: that one
//! refuses files that require KHR_mesh_quantization or GPU instancing, and its accessors slice and
//! unwrap without bounds checks on what its own validation does not cover.
//!
//! [`Scene::warnings`]: senca_scene::Scene::warnings

use std::collections::BTreeSet;

use senca_scene::{Scene, Warning};

use crate::{Files, Location, ReadError};

mod accessor;
mod animation;
mod container;
mod document;
mod json;
mod material;
mod mesh;
mod node;
mod specular_glossiness;
mod texture;
mod topology;
mod uri;
mod write;

#[cfg(test)]
mod tests;

use document::Document;
pub use write::{WriteSettings, write_glb, write_gltf};

/// Extensions that are read.
const KNOWN_EXTENSIONS: [&str; 10] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions that change nothing in a picture; no warning is due.
const SILENT_EXTENSIONS: [&str; 3] = ["KHR_xmp", "KHR_xmp_json_ld", "KHR_materials_variants"];

/// Whether `bytes` look like a glTF file: a GLB, or JSON whose beginning speaks of an asset.
#[must_use]
pub fn is_gltf(bytes: &[u8]) -> bool {
    if container::is_glb(bytes) {
        return true;
    }
    let text = bytes.trim_ascii_start();
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text).trim_ascii_start();
    text.starts_with(b"{") && memchr::memmem::find(text, b"\"asset\"").is_some()
}

/// Reads a `.gltf` or `.glb` file. `name` is used in messages; `files` gives the buffers and pictures
/// that the file names.
///
/// # Errors
/// When the file is broken beyond showing, needs an extension that is not read, names a buffer that
/// cannot be had, or asks for more than [`Files::limits`]. Pictures that cannot be had are warnings.
pub fn read(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    let container = container::open(name, bytes)?;
    check_extensions(name, &container.root)?;
    let document = Document::new(name, container.root, container.bin, files)?;
    container.warnings.into_iter().for_each(|warning| document.warn(warning));
    let unknown = unknown_extensions(&document.root.extensions_used);
    if !unknown.is_empty() {
        document.warn(format!("extensions that are not read: {}", unknown.join(", ")));
    }
    read_scene(&document)
}

fn read_scene(document: &Document<'_>) -> Result<Scene, ReadError> {
    let mut scene = Scene::default();
    let mut textures = texture::Textures::new(document.files.limits());
    scene.materials = material::read_all(document, &mut textures);
    (scene.textures, scene.images) = (textures.textures, textures.images);
    let mut meshes = Vec::with_capacity(document.root.meshes.len());
    for i in 0..document.root.meshes.len() {
        meshes.push(mesh::read(document, i, &scene.materials)?);
    }
    node::read_all(document, &meshes, &mut scene)?;
    scene.geometries = meshes.into_iter().map(|m| m.geometry).collect();
    animation::read_all(document, &mut scene)?;
    scene.warnings = document.take_warnings().into_iter().map(Warning).collect();
    Ok(scene)
}

fn unknown_extensions(names: &[String]) -> Vec<&str> {
    let known = |name: &&str| !KNOWN_EXTENSIONS.contains(name) && !SILENT_EXTENSIONS.contains(name);
    let unique: BTreeSet<&str> = names.iter().map(String::as_str).filter(known).collect();
    unique.into_iter().take(20).collect()
}

/// What a required extension does, for those met often.
fn purpose(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" => " (Draco compressed meshes)",
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => " (meshopt compressed buffers)",
        "KHR_texture_basisu" => " (Basis Universal compressed textures)",
        "EXT_texture_webp" => " (WebP textures)",
        "MSFT_texture_dds" => " (DDS textures)",
        _ => "",
    }
}

fn check_extensions(name: &str, root: &json::Root) -> Result<(), ReadError> {
    let unknown = unknown_extensions(&root.extensions_required);
    if unknown.is_empty() {
        return Ok(());
    }
    let named: Vec<String> = unknown.iter().map(|e| format!("{e}{}", purpose(e))).collect();
    let message = format!("extensionsRequired: {} cannot be read; export the file without", named.join(", "));
    Err(ReadError::unsupported(Location::file(name), message))
}
