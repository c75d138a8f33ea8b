//! Puts the scene together: objects, definitions and their uses, files in place of objects.

use std::collections::{BTreeMap, HashMap};

use senca_scene::{
    Attenuation, Geometry, ImageId, MaterialId, Node, NodeId, Scene, Shape, TextureId, Transform,
};

use super::include::{Include, IncludedFiles, absorb};
use super::names::hint;
use super::shapes::{self, Kind, ReadShape};
use super::source::{Result, Source, Table};
use super::transforms::read_transform;
use super::values::Value;
use super::{ModelReader, is_scene_file, meshes, read_nested};
use crate::{Files, Limits, ReadError};

/// How deep definitions may use each other, and files include each other.
const DEEPEST: usize = 32;

/// Most nodes that uses and included files may make, as long as the limits allow as many elements.
const MOST_NODES: u64 = 1 << 20;

/// A node with what is below it, not yet in the scene.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) node: Node,
    children: Vec<Part>,
    /// The included file whose roots stand below this node.
    include: Option<usize>,
}

impl Part {
    /// A node with nothing below it.
    pub(super) fn of(node: Node) -> Self {
        Self { node, children: Vec::new(), include: None }
    }

    /// Gives `material` to all nodes that name none.
    fn fill_material(&mut self, material: MaterialId) {
        self.node.material.get_or_insert(material);
        self.children.iter_mut().for_each(|child| child.fill_material(material));
    }
}

/// A `[define.NAME]` table.
enum Definition<'a> {
    Unread(Table<'a>),
    Reading,
    Ready { part: Part, nodes: u64 },
}

/// State of reading one file.
pub(super) struct Builder<'a> {
    pub(super) scene: Scene,
    pub(super) files: &'a dyn Files,
    pub(super) limits: Limits,
    pub(super) texture_of: BTreeMap<&'a str, TextureId>,
    pub(super) material_of: BTreeMap<&'a str, MaterialId>,
    /// Pictures read so far, by file name and whether they hold sRGB colour.
    pub(super) image_of: HashMap<(&'a str, bool), ImageId>,
    /// Attenuation of lights that name none.
    pub(super) attenuation: Attenuation,
    models: ModelReader<'a>,
    source: Source<'a>,
    depth: usize,
    using: usize,
    definitions: BTreeMap<&'a str, Definition<'a>>,
    includes: Vec<Include>,
    include_of: HashMap<&'a str, usize>,
    nodes_made: u64,
}

impl<'a> Builder<'a> {
    /// A builder for the file `source`, which is included `depth` files deep.
    pub(super) fn new(
        source: Source<'a>,
        files: &'a dyn Files,
        models: ModelReader<'a>,
        depth: usize,
    ) -> Self {
        Self {
            scene: Scene::default(),
            files,
            limits: files.limits(),
            texture_of: BTreeMap::new(),
            material_of: BTreeMap::new(),
            image_of: HashMap::new(),
            attenuation: Attenuation::None,
            models,
            source,
            depth,
            using: 0,
            definitions: BTreeMap::new(),
            includes: Vec::new(),
            include_of: HashMap::new(),
            nodes_made: 0,
        }
    }

    /// Reads everything that becomes a node.
    pub(super) fn read_nodes(&mut self, root: &mut Table<'a>) -> Result<()> {
        for (name, table) in root.named("define")? {
            self.definitions.insert(name, Definition::Unread(table));
        }
        for camera in root.tables("camera")? {
            let part = self.camera(camera)?;
            self.add_root(part);
        }
        for light in root.tables("light")? {
            let part = self.light(light)?;
            self.add_root(part);
        }
        for object in root.tables("object")? {
            let part = self.object(object, None)?;
            self.add_root(part);
        }
        self.read_unused_definitions()
    }

    /// Definitions that nothing uses are read all the same, so that their mistakes are found.
    fn read_unused_definitions(&mut self) -> Result<()> {
        let names: Vec<&'a str> = self.definitions.keys().copied().collect();
        names.into_iter().try_for_each(|name| self.read_definition(name).map(drop))
    }

    fn add_root(&mut self, part: Part) {
        let id = self.place(part);
        self.scene.roots.push(id);
    }

    /// Moves a part into the scene.
    fn place(&mut self, part: Part) -> NodeId {
        let material = part.node.material;
        let id = self.scene.add_node(part.node);
        let mut children: Vec<NodeId> = part.children.into_iter().map(|child| self.place(child)).collect();
        if let Some(include) = part.include {
            children.extend(self.includes[include].place(&mut self.scene, material));
        }
        self.scene.nodes[id.index()].children = children;
        id
    }

    /// An object with everything below it. `inherited` is the material of the object above.
    fn object(&mut self, mut table: Table<'a>, inherited: Option<MaterialId>) -> Result<Part> {
        let name = table.read_or("name", "", Value::string)?.to_owned();
        if !name.is_empty() {
            table.set_what(format!("object \"{name}\""));
        }
        let material = table.read("material", |value| self.material(value))?.or(inherited);
        let transform = read_transform(&mut table)?;
        let mut node = Node { name, transform: transform.unwrap_or_default(), material, ..Node::default() };
        node.morph_weights = table.read_or("morph_weights", Vec::new(), |value| {
            value.list("a list of weights", |weight| Ok(weight.number()? as f32))
        })?;
        let content = self.content(&mut table, material)?;
        let mut children = Vec::new();
        for child in table.tables("child")? {
            children.push(self.object(child, material)?);
        }
        for light in table.tables("light")? {
            children.push(self.light(light)?);
        }
        for camera in table.tables("camera")? {
            children.push(self.camera(camera)?);
        }
        table.finish()?;
        Ok(assemble(node, content, children, transform.is_some()))
    }

    /// What the object itself shows: a shape, a use of a definition, a file, or nothing.
    fn content(&mut self, table: &mut Table<'a>, material: Option<MaterialId>) -> Result<Content> {
        let [shape, used, file] = ["shape", "use", "file"].map(|key| table.get(key));
        if let Some(second) = [shape, used, file].into_iter().flatten().nth(1) {
            return Err(second.error("an object has one of \"shape\", \"use\" and \"file\"; put the others into a [[object.child]]"));
        }
        if let Some(value) = shape {
            return self.shape(table, value);
        }
        if let Some(value) = used {
            let mut part = self.use_definition(value)?;
            if let Some(material) = material {
                part.fill_material(material);
            }
            return Ok(Content::Part(part));
        }
        match file {
            Some(value) => self.include(value).map(Content::Include),
            None => Ok(Content::Nothing),
        }
    }

    fn shape(&mut self, table: &mut Table<'a>, value: Value<'a>) -> Result<Content> {
        let kind = shapes::kind(value)?;
        if table.what() == "the object" || table.what() == "the child" {
            table.set_what(format!("the {}", value.string()?));
        }
        let ReadShape { shape, place } = match kind {
            Kind::Mesh => meshes::read(table, &mut |value| self.material(value))?.into(),
            Kind::Csg => self.csg(table)?.into(),
            other => shapes::read(table, other)?,
        };
        self.check_morph(table, &shape)?;
        let name = table.read_or("name", "", Value::string)?.to_owned();
        let geometry = self.scene.add_geometry(Geometry { name, shape, material: None });
        Ok(Content::Geometry { geometry, place })
    }

    fn check_morph(&self, table: &mut Table<'a>, shape: &Shape) -> Result<()> {
        let targets = match shape {
            Shape::Mesh(mesh) => mesh.morph_targets.len(),
            _ => 0,
        };
        match table.get("morph_weights") {
            Some(value) if value.items("a list of weights")?.len() > targets => {
                Err(value
                    .refuse(format_args!("has more weights than the shape has morph targets, {targets}")))
            }
            _ => Ok(()),
        }
    }

    /// A copy of the definition that a value names.
    fn use_definition(&mut self, value: Value<'a>) -> Result<Part> {
        let name = value.string()?;
        let Some((&name, definition)) = self.definitions.get_key_value(name) else {
            let defined: Vec<&str> = self.definitions.keys().copied().collect();
            return Err(value.error(format!("definition \"{name}\" is not there{}", hint(name, &defined))));
        };
        if matches!(definition, Definition::Reading) {
            return Err(value.error(format!("definition \"{name}\" uses itself")));
        }
        if self.using >= DEEPEST {
            return Err(value
                .source
                .limit(&value.span(), format!("definitions use each other more than {DEEPEST} deep")));
        }
        self.using += 1;
        let nodes = self.read_definition(name)?;
        self.using -= 1;
        self.count_nodes(nodes, &value)?;
        match &self.definitions[name] {
            Definition::Ready { part, .. } => Ok(part.clone()),
            _ => Err(value.error(format!("definition \"{name}\" uses itself"))),
        }
    }

    /// Reads a definition unless that is done; gives its number of nodes.
    fn read_definition(&mut self, name: &'a str) -> Result<u64> {
        let slot = self.definitions.get_mut(name).map(|slot| std::mem::replace(slot, Definition::Reading));
        let ready = match slot {
            Some(Definition::Unread(table)) => {
                let part = self.object(table, None)?;
                let nodes = self.nodes_of(&part);
                Definition::Ready { part, nodes }
            }
            Some(done) => done,
            None => return Ok(0),
        };
        let nodes = if let Definition::Ready { nodes, .. } = &ready { *nodes } else { 0 };
        self.definitions.insert(name, ready);
        Ok(nodes)
    }

    fn nodes_of(&self, part: &Part) -> u64 {
        let below: u64 = part.children.iter().map(|child| self.nodes_of(child)).sum();
        let included = part.include.map_or(0, |include| self.includes[include].node_count());
        1 + below + included
    }

    /// Holds the nodes that are about to be made against the limit.
    fn count_nodes(&mut self, nodes: u64, value: &Value<'a>) -> Result<()> {
        self.nodes_made = self.nodes_made.saturating_add(nodes);
        let most = MOST_NODES.min(self.limits.made_elements);
        if self.nodes_made > most {
            let message = format!("uses and files make more than {most} nodes");
            return Err(value.source.limit(&value.span(), message));
        }
        Ok(())
    }

    /// The file that a value names, as part of this scene; each file is read once.
    fn include(&mut self, value: Value<'a>) -> Result<usize> {
        let uri = value.string()?;
        let include = match self.include_of.get(uri) {
            Some(&include) => include,
            None => {
                let scene = self.read_model(&value, uri)?;
                self.includes.push(absorb(&mut self.scene, scene, uri));
                self.include_of.insert(uri, self.includes.len() - 1);
                self.includes.len() - 1
            }
        };
        self.count_nodes(self.includes[include].node_count(), &value)?;
        Ok(include)
    }

    fn read_model(&self, value: &Value<'a>, uri: &str) -> Result<Scene> {
        if self.depth >= DEEPEST {
            let message = format!("files include each other more than {DEEPEST} deep");
            return Err(value.source.limit(&value.span(), message));
        }
        let files = IncludedFiles::new(self.files, self.source.name, uri);
        let bytes = files.read_included(uri).map_err(|error| located(value, error))?;
        if uri.to_ascii_lowercase().ends_with(".toml") || is_scene_file(&bytes) {
            read_nested(uri, &bytes, &files, self.models, self.depth + 1).map(|file| file.scene)
        } else {
            (self.models)(uri, &bytes, &files)
        }
    }
}

/// What an object shows itself.
enum Content {
    Nothing,
    Geometry { geometry: senca_scene::GeometryId, place: Transform },
    Part(Part),
    Include(usize),
}

/// The object's node with its content. A shape with a place of its own (`center`, `from` and `to`)
/// gets a node below, unless the object's node is free to take that place.
fn assemble(mut node: Node, content: Content, mut children: Vec<Part>, placed: bool) -> Part {
    let mut include = None;
    match content {
        Content::Nothing => {}
        Content::Geometry { geometry, place } => {
            let moved = place.matrix() != Transform::default().matrix();
            if moved && (placed || !children.is_empty()) {
                let morph_weights = std::mem::take(&mut node.morph_weights);
                let (transform, material) = (place, node.material);
                let geometry = Some(geometry);
                let inner = Node { transform, geometry, material, morph_weights, ..Node::default() };
                children.insert(0, Part::of(inner));
            } else {
                node.geometry = Some(geometry);
                if moved {
                    node.transform = place;
                }
            }
        }
        Content::Part(part) => children.insert(0, part),
        Content::Include(index) => include = Some(index),
    }
    Part { node, children, include }
}

/// An error of fetching a named file, at the place that names it.
pub(super) fn located(value: &Value<'_>, error: ReadError) -> ReadError {
    match error {
        ReadError::Io { path, source } => {
            value.error(format!("cannot read \"{}\": {source}", path.display()))
        }
        ReadError::Malformed { at, message } if at.line.is_none() => {
            value.error(format!("\"{}\" {message}", at.file))
        }
        ReadError::Unsupported { at, message } if at.line.is_none() => {
            ReadError::unsupported(value.source.location(value.span().start), message)
        }
        ReadError::Limit { at, message } if at.line.is_none() => {
            value.source.limit(&value.span(), format!("\"{}\" {message}", at.file))
        }
        other => other,
    }
}
