//! The scene and its flattening into instances.

use senca_math::LinearRgb;
use senca_math::glam::DMat4;

use crate::{
    Animation, Camera, CameraId, Fog, GeometryId, ImageId, Light, LightId, Material, MaterialId, MeshError,
    Node, NodeId, Shape, Skin, Texture, TextureImage,
};

/// Everything there is to see. Entries name each other by typed index; a reader checks
/// that all indices hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Name from the file, or empty.
    pub name: String,
    /// All nodes.
    pub nodes: Vec<Node>,
    /// Nodes without a parent that are shown.
    pub roots: Vec<NodeId>,
    /// Geometries that nodes place.
    pub geometries: Vec<Geometry>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures that materials use.
    pub textures: Vec<Texture>,
    /// Pictures that textures use.
    pub images: Vec<TextureImage>,
    /// Light sources that nodes place.
    pub lights: Vec<Light>,
    /// Cameras that nodes place.
    pub cameras: Vec<Camera>,
    /// Skins.
    pub skins: Vec<Skin>,
    /// Animations.
    pub animations: Vec<Animation>,
    /// Ambient light Ia. Default black.
    pub ambient: LinearRgb,
    /// What is seen where nothing is. Default [`Background::None`].
    pub background: Background,
    /// Fog or depth cueing.
    pub fog: Option<Fog>,
    /// What a reader found odd but could live with.
    pub warnings: Vec<Warning>,
}

/// What is seen where nothing is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// Nothing was said: the renderer or the command chooses.
    #[default]
    None,
    /// One colour.
    Color(LinearRgb),
    /// From one colour at the bottom row to another at the top row.
    Gradient {
        /// Colour of the bottom row.
        bottom: LinearRgb,
        /// Colour of the top row.
        top: LinearRgb,
    },
    /// Surroundings on an endless sphere, from a latitude-longitude picture: its top row is straight
    /// up (+y), its middle column lies towards -z, columns to the right of it turn towards +x. See
    /// [`crate::Environment`].
    Environment {
        /// The picture, in linear light where it holds floats.
        image: ImageId,
        /// Factor on its colours, >= 0.
        strength: f32,
        /// Turn of the surroundings about +y, in radians, counter-clockwise seen from above.
        rotation: f32,
    },
}

/// A shape with its name and default material.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Name from the file, or empty.
    pub name: String,
    /// The form.
    pub shape: Shape,
    /// Material where the shape's surfaces name none.
    pub material: Option<MaterialId>,
}

/// Something odd that did not stop a reader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning(pub String);

/// A geometry placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Node that places it.
    pub node: NodeId,
    /// What is placed.
    pub geometry: GeometryId,
    /// Where.
    pub world_from_object: DMat4,
}

/// Why a scene does not hold together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// An index names an entry that is not there.
    #[error("{what} names {kind} {index}, but there are only {count}")]
    IndexOutOfRange {
        /// Who names it.
        what: String,
        /// What kind of entry.
        kind: &'static str,
        /// The index.
        index: u32,
        /// How many entries there are.
        count: usize,
    },
    /// A node is its own ancestor, or has two parents.
    #[error("node {node} is reached twice: nodes must form trees")]
    NotATree {
        /// The node.
        node: u32,
    },
    /// A number is outside its range.
    #[error("{what} is {value}, but must be {expected}")]
    Number {
        /// Whose number.
        what: String,
        /// What it is.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A mesh does not hold together.
    #[error("{what}: {error}")]
    Mesh {
        /// Whose mesh.
        what: String,
        /// What is wrong with it.
        error: MeshError,
    },
    /// Something else does not hold together.
    #[error("{what}: {reason}")]
    Invalid {
        /// What.
        what: String,
        /// What is wrong and what would be right.
        reason: String,
    },
}

impl Scene {
    /// Appends `node` and returns its id.
    pub fn add_node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// Appends `geometry` and returns its id.
    pub fn add_geometry(&mut self, geometry: Geometry) -> GeometryId {
        self.geometries.push(geometry);
        GeometryId(self.geometries.len() as u32 - 1)
    }

    /// Appends `material` and returns its id.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Appends `light` and returns its id.
    pub fn add_light(&mut self, light: Light) -> LightId {
        self.lights.push(light);
        LightId(self.lights.len() as u32 - 1)
    }

    /// Appends `camera` and returns its id.
    pub fn add_camera(&mut self, camera: Camera) -> CameraId {
        self.cameras.push(camera);
        CameraId(self.cameras.len() as u32 - 1)
    }

    /// A scene of one shape at the origin.
    #[must_use]
    pub fn of_shape(name: &str, shape: Shape) -> Self {
        let mut scene = Self { name: name.to_owned(), ..Self::default() };
        let geometry = scene.add_geometry(Geometry { name: name.to_owned(), shape, material: None });
        let root =
            scene.add_node(Node { name: name.to_owned(), geometry: Some(geometry), ..Node::default() });
        scene.roots.push(root);
        scene
    }

    /// `world_from_node` of every node, in the order of `nodes`; `None` for nodes that no root
    /// reaches. A node reached twice keeps its first place, so this ends on any input.
    #[must_use]
    pub fn world_from_nodes(&self) -> Vec<Option<DMat4>> {
        let mut world_from_node = vec![None; self.nodes.len()];
        let mut open: Vec<(NodeId, DMat4)> = self.roots.iter().rev().map(|&r| (r, DMat4::IDENTITY)).collect();
        while let Some((id, world_from_parent)) = open.pop() {
            let Some(node) = self.nodes.get(id.index()) else { continue };
            if world_from_node[id.index()].is_some() {
                continue;
            }
            let world_from_this = world_from_parent * node.transform.matrix();
            world_from_node[id.index()] = Some(world_from_this);
            open.extend(node.children.iter().rev().map(|&child| (child, world_from_this)));
        }
        world_from_node
    }

    /// Every geometry placed by a node that a root reaches, in the order of nodes.
    #[must_use]
    pub fn instances(&self) -> Vec<Instance> {
        let world_from_nodes = self.world_from_nodes();
        let placed = self.nodes.iter().zip(&world_from_nodes).enumerate();
        placed
            .filter_map(|(i, (node, world_from_node))| {
                Some(Instance {
                    node: NodeId(i as u32),
                    geometry: node.geometry.filter(|g| g.index() < self.geometries.len())?,
                    world_from_object: (*world_from_node)?,
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transform;
    use senca_math::glam::DVec3;

    fn moved(x: f64) -> Node {
        Node { transform: Transform::Matrix(DMat4::from_translation(DVec3::X * x)), ..Node::default() }
    }

    #[test]
    fn transforms_add_up_along_the_tree_and_cycles_end() {
        let mut scene = Scene::default();
        let parent = scene.add_node(moved(1.0));
        let child = scene.add_node(moved(2.0));
        let loose = scene.add_node(moved(4.0));
        scene.nodes[parent.index()].children = vec![child];
        scene.nodes[child.index()].children = vec![parent, NodeId(99)];
        scene.roots = vec![parent];
        let world = scene.world_from_nodes();
        assert_eq!(world[child.index()].map(|m| m.w_axis.x), Some(3.0));
        assert_eq!(world[loose.index()], None);
    }
}
