//! A solution as a scene of unlit polygons with colours at the vertices.

use std::collections::HashMap;

use senca_math::LinearRgb;
use senca_math::glam::{DVec3, Vec2, Vec3, Vec4};
use senca_scene::{
    Faces, Geometry, Material, MaterialId, Mesh, MetallicRoughness, Node, Phong, Reflection, Scene, Shape,
    Surface, TextureRef, Transform,
};

use super::surface_light::matt_reflectance;
use super::{Interpolation, LightField};
use crate::mesh::Corner;
use crate::{ElementMesh, NONE, RadiantSurface};

/// Where the colours of the vertices are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShownColors {
    /// In Senca: textures multiply the reflected light alone, and what surfaces give off is added to it,
    /// picture and all.
    #[default]
    Exact,
    /// In other programs, which show an unlit colour and nothing else: what emitters give off is in the
    /// colours, and in place of their textures counts the average.
    Portable,
}

/// The light of `field` as a scene: all leaves of the mesh as one mesh in the world, with materials that
/// are shown as they are, and the cameras of `scene`.
///
/// Elements are cut so that neighbours have all corners on a common edge in common: nothing cracks.
/// Textures stay, multiplied by the light. Lines, points and what takes no part in the exchange of light
/// are left out.
#[must_use]
pub fn shown_scene(scene: &Scene, field: &LightField<'_>, colors: ShownColors) -> Scene {
    let mut shown = Scene {
        name: scene.name.clone(),
        textures: scene.textures.clone(),
        images: scene.images.clone(),
        background: scene.background,
        fog: scene.fog,
        ..Scene::default()
    };
    let default = Material { double_sided: true, ..Material::default() };
    let materials: Vec<&Material> = scene.materials.iter().chain([&default]).collect();
    shown.materials = materials.iter().map(|material| shown_material(material, colors)).collect();
    let mesh = Builder::new(scene, field, &materials, colors).mesh();
    let shape = Shape::Mesh(mesh);
    let geometry = shown.add_geometry(Geometry { name: "light".into(), shape, material: None });
    let root = shown.add_node(Node { name: "light".into(), geometry: Some(geometry), ..Node::default() });
    shown.roots.push(root);
    add_cameras(scene, &mut shown);
    shown
}

/// The cameras of a scene at their places in the world.
pub(crate) fn add_cameras(scene: &Scene, shown: &mut Scene) {
    shown.cameras.clone_from(&scene.cameras);
    for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
        if let (Some(_), Some(matrix)) = (node.camera, world_from_node) {
            let transform = Transform::Matrix(matrix);
            let camera = Node { name: node.name.clone(), transform, camera: node.camera, ..Node::default() };
            let camera = shown.add_node(camera);
            shown.roots.push(camera);
        }
    }
}

/// The texture that multiplies reflected light.
fn base_texture(material: &Material) -> Option<TextureRef> {
    match &material.reflection {
        Reflection::Phong(phong) => phong.texture,
        Reflection::MetallicRoughness(rough) => rough.base_color_texture,
    }
}

fn is_emitter(material: &Material) -> bool {
    material.emission != LinearRgb::BLACK
}

/// Whether light on this material is shown without its textures.
fn averages(material: &Material, colors: ShownColors) -> bool {
    colors == ShownColors::Portable && is_emitter(material)
}

/// A material that shows the colours of vertices times its texture.
fn shown_material(material: &Material, colors: ShownColors) -> Material {
    let texture = base_texture(material).filter(|_| !averages(material, colors));
    let (alpha, reflection) = match &material.reflection {
        Reflection::Phong(phong) => (phong.alpha, None),
        Reflection::MetallicRoughness(rough) => (rough.alpha, Some(rough)),
    };
    let white = LinearRgb::WHITE;
    let reflection = match reflection {
        None => {
            Reflection::Phong(Phong { ambient: white, diffuse: white, alpha, texture, ..Phong::default() })
        }
        Some(_) => Reflection::MetallicRoughness(MetallicRoughness {
            base_color: white,
            alpha,
            metallic: 0.0,
            base_color_texture: texture,
            ..MetallicRoughness::default()
        }),
    };
    let exact = colors == ShownColors::Exact;
    Material {
        name: material.name.clone(),
        reflection,
        emission: if exact { material.emission } else { LinearRgb::BLACK },
        emission_texture: material.emission_texture.filter(|_| exact),
        alpha_mode: material.alpha_mode,
        transmission: if exact { material.transmission } else { LinearRgb::BLACK },
        ior: material.ior,
        unlit: true,
        ..Material::default()
    }
}

/// Puts the mesh together.
struct Builder<'a> {
    field: &'a LightField<'a>,
    materials: &'a [&'a Material],
    colors: ShownColors,
    /// Sets of texture coordinates that any material uses.
    texcoord_sets: usize,
    mesh: Mesh,
    /// Surface of the mesh by material.
    surfaces: HashMap<u32, u32>,
    /// Vertex by the field's vertex and the polygon's surface, where colours are shared.
    vertices: HashMap<(u32, u32), u32>,
    points: HashMap<[u32; 3], u32>,
}

impl<'a> Builder<'a> {
    fn new(
        scene: &Scene,
        field: &'a LightField<'a>,
        materials: &'a [&'a Material],
        colors: ShownColors,
    ) -> Self {
        let textured = |material: &Material| {
            [base_texture(material), material.emission_texture].into_iter().flatten().map(|t| t.texcoord + 1)
        };
        let sets = scene.materials.iter().flat_map(textured).max().unwrap_or(0).min(2);
        Self {
            field,
            materials,
            colors,
            texcoord_sets: sets as usize,
            mesh: Mesh { faces: Faces::default(), ..Mesh::default() },
            surfaces: HashMap::new(),
            vertices: HashMap::new(),
            points: HashMap::new(),
        }
    }

    fn elements(&self) -> &'a ElementMesh {
        self.field.mesh()
    }

    fn mesh(mut self) -> Mesh {
        for leaf in self.elements().leaves() {
            self.add_leaf(leaf);
        }
        self.mesh
    }

    fn add_leaf(&mut self, leaf: u32) {
        let elements = self.elements();
        let polygon = elements.elements()[leaf as usize].polygon;
        let surface = elements.polygons()[polygon as usize].surface;
        let number = self.surface_number(elements.surface(leaf).material);
        let outline = self.field.outline(leaf);
        let vertices: Vec<u32> = outline.iter().map(|corner| self.vertex(leaf, surface, corner)).collect();
        match *vertices {
            [a, b, c] => self.mesh.faces.push(&[a, b, c], number),
            [a, b, c, d] if elements.elements()[leaf as usize].corners().len() == 4 => {
                self.mesh.faces.push(&[a, b, c], number);
                self.mesh.faces.push(&[a, c, d], number);
            }
            _ => {
                let center = elements.elements()[leaf as usize].center;
                let middle = self.new_vertex(leaf, center, self.field.middle(leaf));
                for (i, &a) in vertices.iter().enumerate() {
                    let b = vertices[(i + 1) % vertices.len()];
                    self.mesh.faces.push(&[middle, a, b], number);
                }
            }
        }
    }

    fn surface_number(&mut self, material: u32) -> u32 {
        let surfaces = &mut self.mesh.surfaces;
        *self.surfaces.entry(material).or_insert_with(|| {
            let material = Some(MaterialId(material));
            surfaces.push(Surface { material, smooth: false, ..Surface::default() });
            surfaces.len() as u32 - 1
        })
    }

    /// The vertex at a corner of a leaf: shared where neither colour nor texture can differ.
    fn vertex(&mut self, leaf: u32, surface: u32, corner: &Corner) -> u32 {
        let shared = corner.vertex != NONE
            && self.texcoord_sets == 0
            && !self.elements().has_attributes()
            && self.field.interpolation() == Interpolation::Smooth;
        if let Some(&known) = self.vertices.get(&(corner.vertex, surface)).filter(|_| shared) {
            return known;
        }
        let vertex = self.new_vertex(leaf, corner.position, self.field.at_corner(leaf, corner));
        if shared {
            self.vertices.insert((corner.vertex, surface), vertex);
        }
        vertex
    }

    fn new_vertex(&mut self, leaf: u32, position: DVec3, arriving: LinearRgb) -> u32 {
        let elements = self.elements();
        let polygon = elements.elements()[leaf as usize].polygon;
        let attributes = elements.attributes_at(polygon, position);
        let point = self.point(position.as_vec3());
        let color = self.color(elements.surface(leaf), arriving, attributes.color);
        let vertices = &mut self.mesh.vertices;
        vertices.point.push(point);
        vertices.color.push(color);
        let lists: [&mut Vec<Vec2>; 2] = [&mut vertices.texcoord0, &mut vertices.texcoord1];
        for (list, texcoord) in lists.into_iter().zip(attributes.texcoords).take(self.texcoord_sets) {
            list.push(texcoord);
        }
        vertices.point.len() as u32 - 1
    }

    fn point(&mut self, place: Vec3) -> u32 {
        let points = &mut self.mesh.points;
        *self.points.entry((place + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert_with(|| {
            points.push(place);
            points.len() as u32 - 1
        })
    }

    /// What is shown where this light arrives, the texture left aside.
    fn color(&self, surface: &RadiantSurface, arriving: LinearRgb, own: Vec4) -> Vec4 {
        let material = self.materials[(surface.material as usize).min(self.materials.len() - 1)];
        let tint = LinearRgb::new(own.x, own.y, own.z);
        let shown = if material.unlit {
            unlit_color(material) * tint
        } else if averages(material, self.colors) {
            surface.emission + surface.reflectance * arriving
        } else {
            matt_reflectance(material) * tint * arriving
        };
        Vec3::from(shown.to_array()).extend(own.w)
    }
}

fn unlit_color(material: &Material) -> LinearRgb {
    match &material.reflection {
        Reflection::Phong(phong) => phong.diffuse,
        Reflection::MetallicRoughness(rough) => rough.base_color,
    }
}
