//! Files that stand in place of objects: fetching them, and taking their content into the scene.

use std::collections::HashMap;

use senca_scene::{
    Animation, CameraId, GeometryId, ImageId, LightId, Material, MaterialId, Node, NodeId, Reflection, Scene,
    Shape, Skin, SkinId, TextureId, TextureRef, Warning,
};

use crate::{Files, Limits, Location, ReadError};

/// The files that an included file names, relative to its own folder. Refuses the files it is
/// included from, so that no file includes itself.
pub(super) struct IncludedFiles<'f> {
    outer: &'f dyn Files,
    /// Folder of the included file with a slash behind, or empty.
    folder: String,
    /// Name of the included file, relative to the including one.
    uri: String,
    /// File name of the including file.
    includer: String,
}

impl<'f> IncludedFiles<'f> {
    /// For the file `uri` that the file `includer` names.
    pub(super) fn new(outer: &'f dyn Files, includer: &str, uri: &str) -> Self {
        let uri = normal(uri);
        let folder = uri.rfind('/').map_or("", |slash| &uri[..=slash]).to_owned();
        let includer = normal(includer);
        let includer = includer.rsplit('/').next().unwrap_or_default().to_owned();
        Self { outer, folder, uri, includer }
    }

    /// Content of the included file itself, by the name that was given for it.
    pub(super) fn read_included(&self, given: &str) -> Result<Vec<u8>, ReadError> {
        if self.uri == self.includer {
            return Err(ReadError::malformed(Location::file(&self.uri), "includes itself"));
        }
        self.outer.read(given)
    }
}

impl Files for IncludedFiles<'_> {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        // Absolute names and network addresses are for the outer files to refuse.
        if uri.starts_with(['/', '\\']) || uri.contains(':') {
            return self.outer.read(uri);
        }
        let path = normal(&format!("{}{uri}", self.folder));
        if path == self.uri || path == self.includer {
            return Err(ReadError::malformed(Location::file(&path), "includes itself"));
        }
        self.outer.read(&path)
    }

    fn limits(&self) -> Limits {
        self.outer.limits()
    }
}

/// A relative path with forward slashes, without `.` and with `..` resolved where it can be.
fn normal(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            "" if !parts.is_empty() => {}
            ".." if parts.last().is_some_and(|last| !["..", ""].contains(last)) => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// An included file whose geometries, materials, lights and cameras are in the scene already, and
/// whose nodes can be placed any number of times.
pub(super) struct Include {
    nodes: Vec<Node>,
    roots: Vec<NodeId>,
    skins: Vec<Skin>,
    animations: Vec<Animation>,
}

impl Include {
    /// How many nodes one placing makes.
    pub(super) fn node_count(&self) -> u64 {
        self.nodes.len() as u64
    }

    /// Copies the nodes into the scene, with their animations; gives the roots. Nodes without a
    /// material get `material`.
    pub(super) fn place(&self, scene: &mut Scene, material: Option<MaterialId>) -> Vec<NodeId> {
        let first_node = scene.nodes.len() as u32;
        let first_skin = scene.skins.len() as u32;
        let moved = |id: &NodeId| NodeId(id.0 + first_node);
        for node in &self.nodes {
            let mut node = node.clone();
            node.children = node.children.iter().map(moved).collect();
            node.skin = node.skin.map(|skin| SkinId(skin.0 + first_skin));
            node.material = node.material.or(material);
            scene.nodes.push(node);
        }
        for skin in &self.skins {
            let joints = skin.joints.iter().map(moved).collect();
            scene.skins.push(Skin { joints, ..skin.clone() });
        }
        self.place_animations(scene, first_node);
        self.roots.iter().map(moved).collect()
    }

    /// Adds the channels for the nodes that begin at `first_node`; animations of one name run
    /// together.
    fn place_animations(&self, scene: &mut Scene, first_node: u32) {
        if self.animations.is_empty() {
            return;
        }
        let known = scene.animations.iter().enumerate().rev();
        let mut index_of: HashMap<String, usize> = known.map(|(i, a)| (a.name.clone(), i)).collect();
        for animation in &self.animations {
            let mut channels = animation.channels.clone();
            channels.iter_mut().for_each(|channel| channel.target.node.0 += first_node);
            let next = scene.animations.len();
            match *index_of.entry(animation.name.clone()).or_insert(next) {
                index if index < next => scene.animations[index].channels.append(&mut channels),
                _ => scene.animations.push(Animation { name: animation.name.clone(), channels }),
            }
        }
    }
}

/// Moves everything but the nodes of `other` into `scene`. Its ambient light, background and fog are
/// left behind.
pub(super) fn absorb(scene: &mut Scene, mut other: Scene, uri: &str) -> Include {
    let shift = Shift {
        images: scene.images.len() as u32,
        textures: scene.textures.len() as u32,
        materials: scene.materials.len() as u32,
        geometries: scene.geometries.len() as u32,
        lights: scene.lights.len() as u32,
        cameras: scene.cameras.len() as u32,
    };
    other.textures.iter_mut().for_each(|texture| texture.image = ImageId(texture.image.0 + shift.images));
    other.materials.iter_mut().for_each(|material| shift.material(material));
    for geometry in &mut other.geometries {
        shift.material_id(&mut geometry.material);
        shift.shape(&mut geometry.shape);
    }
    for node in &mut other.nodes {
        shift.material_id(&mut node.material);
        node.geometry = node.geometry.map(|id| GeometryId(id.0 + shift.geometries));
        node.light = node.light.map(|id| LightId(id.0 + shift.lights));
        node.camera = node.camera.map(|id| CameraId(id.0 + shift.cameras));
    }
    scene.images.append(&mut other.images);
    scene.textures.append(&mut other.textures);
    scene.materials.append(&mut other.materials);
    scene.geometries.append(&mut other.geometries);
    scene.lights.append(&mut other.lights);
    scene.cameras.append(&mut other.cameras);
    scene.warnings.extend(other.warnings.into_iter().map(|Warning(text)| Warning(format!("{uri}: {text}"))));
    Include { nodes: other.nodes, roots: other.roots, skins: other.skins, animations: other.animations }
}

/// How far the indices of an included scene move.
struct Shift {
    images: u32,
    textures: u32,
    materials: u32,
    geometries: u32,
    lights: u32,
    cameras: u32,
}

impl Shift {
    fn material_id(&self, id: &mut Option<MaterialId>) {
        *id = id.map(|id| MaterialId(id.0 + self.materials));
    }

    /// Materials that the shape's surfaces and bodies name.
    fn shape(&self, shape: &mut Shape) {
        match shape {
            Shape::Mesh(mesh) => mesh.surfaces.iter_mut().for_each(|s| self.material_id(&mut s.material)),
            Shape::Csg(csg) => {
                for leaf in csg.leaves_mut() {
                    self.material_id(&mut leaf.material);
                    self.shape(&mut leaf.shape);
                }
            }
            _ => {}
        }
    }

    fn texture(&self, texture: &mut Option<TextureRef>) {
        if let Some(texture) = texture {
            texture.texture = TextureId(texture.texture.0 + self.textures);
        }
    }

    fn material(&self, material: &mut Material) {
        self.texture(&mut material.emission_texture);
        self.texture(&mut material.normal_texture);
        self.texture(&mut material.occlusion_texture);
        match &mut material.reflection {
            Reflection::Phong(phong) => {
                self.texture(&mut phong.texture);
                self.texture(&mut phong.specular_texture);
            }
            Reflection::MetallicRoughness(metallic) => {
                self.texture(&mut metallic.base_color_texture);
                self.texture(&mut metallic.metallic_roughness_texture);
            }
        }
    }
}
