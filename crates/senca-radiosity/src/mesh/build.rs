//! From a scene to polygons.

use std::collections::HashMap;

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_math::polygon::triangulate_in_space;
use senca_math::{Aabb, LinearRgb};
use senca_scene::{
    AlphaMode, Instance, Material, Mesh, Reflection, Scene, Shape, TessellationSettings, Tolerance,
    is_flat_quad, split_quad, tessellate,
};
use smallvec::SmallVec;

use super::{Element, ElementMesh, NONE, Polygon, RadiantSurface};
use crate::RadiosityError;

/// Normals of corners at one place that differ by less than this belong to one vertex; its cosine.
const SMOOTH_COS: f64 = 0.999;

/// Share of the light that a dielectric sends back at its surface, which a matt base does not see.
const DIELECTRIC_MIRROR: f32 = 0.04;

/// Which sides of surfaces take part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The front, and the back of materials that show it.
    #[default]
    ByMaterial,
    /// The front alone.
    Front,
    /// Both.
    Both,
}

/// How a scene is covered with polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSettings {
    /// Longest edge of a patch, in world units, > 0. Default `None`: polygons are left whole.
    pub patch_size: Option<f64>,
    /// How far the polygons of curved shapes may be from the shape, in world units, > 0. Default
    /// `None`: a thousandth of the diagonal of the scene.
    pub tolerance: Option<f64>,
    /// Which sides of surfaces take part. Default by material.
    pub sides: Sides,
    /// Elements at most. Default 2^24.
    pub max_elements: usize,
}

impl Default for MeshSettings {
    fn default() -> Self {
        Self { patch_size: None, tolerance: None, sides: Sides::ByMaterial, max_elements: 1 << 24 }
    }
}

impl ElementMesh {
    /// The polygons of `scene`, which is in its pose (see `Scene::at_time`) and valid, divided to the
    /// size that the settings ask for. Polygons without area are left out.
    ///
    /// # Errors
    /// [`RadiosityError::Shape`], [`RadiosityError::Setting`], [`RadiosityError::TooManyElements`].
    pub fn of_scene(scene: &Scene, settings: &MeshSettings) -> Result<Self, RadiosityError> {
        positive("patch size", settings.patch_size)?;
        positive("tolerance", settings.tolerance)?;
        let mut builder = Builder::new(scene, settings);
        for (number, instance) in (0..).zip(scene.instances()) {
            builder.add_instance(number, &instance)?;
        }
        let mut mesh = builder.mesh;
        if let Some(size) = settings.patch_size {
            mesh.divide_to_size(size, settings.max_elements)?;
        }
        Ok(mesh)
    }

    /// A mesh of single polygons, each a surface of its own with this reflectance and emission: for
    /// examples and tests.
    #[must_use]
    pub fn of_polygons(polygons: &[(&[DVec3], LinearRgb, LinearRgb)]) -> Self {
        let mut mesh = Self::default();
        for (number, &(corners, reflectance, emission)) in (0..).zip(polygons) {
            mesh.surfaces.push(RadiantSurface {
                instance: number,
                material: number,
                back: false,
                reflectance,
                emission,
                transmittance: LinearRgb::BLACK,
            });
            let normal = senca_math::newell_normal(corners).normalize_or_zero();
            let vertices: Vec<u32> = corners.iter().map(|&p| mesh.push_vertex(p, normal)).collect();
            mesh.push_polygon(&vertices, number);
        }
        mesh
    }

    pub(super) fn push_vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position);
        self.vertex_normals.push(normal);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle or quadrilateral as a root, unless it has no area. Only before any division.
    pub(super) fn push_polygon(&mut self, vertices: &[u32], surface: u32) {
        let corners: SmallVec<[DVec3; 4]> = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let normal = senca_math::newell_normal(&corners);
        if !(normal.length() > 0.0 && normal.is_finite()) {
            return;
        }
        let vertices = match *vertices {
            [a, b, c] => [a, b, c, NONE],
            [a, b, c, d] => [a, b, c, d],
            _ => return,
        };
        let number = self.polygons.len() as u32;
        self.polygons.push(Polygon { surface, normal: normal.normalize() });
        self.push_element(Element {
            vertices,
            polygon: number,
            parent: NONE,
            first_part: NONE,
            parts: 0,
            level: 0,
            area: 0.0,
            center: DVec3::ZERO,
        });
    }
}

/// Puts together the polygons of a scene.
struct Builder<'s> {
    scene: &'s Scene,
    settings: &'s MeshSettings,
    /// World units.
    tolerance: f64,
    plane_extent: f64,
    mesh: ElementMesh,
    /// Vertices of the current side of an instance, by the bits of their place.
    vertices: HashMap<[u64; 3], SmallVec<[u32; 2]>>,
}

impl<'s> Builder<'s> {
    fn new(scene: &'s Scene, settings: &'s MeshSettings) -> Self {
        let size = finite_size(&scene.bounds());
        Self {
            scene,
            settings,
            tolerance: settings.tolerance.unwrap_or(1e-3 * size),
            plane_extent: 2.0 * size,
            mesh: ElementMesh::default(),
            vertices: HashMap::new(),
        }
    }

    fn add_instance(&mut self, number: u32, instance: &Instance) -> Result<(), RadiosityError> {
        let geometry = &self.scene.geometries[instance.geometry.index()];
        let settings = self.tessellation(&instance.world_from_object);
        let mesh = tessellate(&geometry.shape, &settings).map_err(|source| RadiosityError::Shape {
            geometry: instance.geometry.0,
            name: geometry.name.clone(),
            source,
        })?;
        let materials = self.materials(instance, &mesh);
        for back in [false, true] {
            self.vertices.clear();
            let surfaces = self.add_surfaces(number, &materials, back);
            let placed = Placed::new(&mesh, &instance.world_from_object, back);
            for (face, corners) in mesh.faces.iter().enumerate() {
                let surface = surfaces.get(mesh.faces.surface_of(face) as usize).copied().flatten();
                if let Some(surface) = surface {
                    self.add_face(&placed, corners, surface);
                }
            }
        }
        Ok(())
    }

    /// The tolerance is meant in the world, shapes are in object space.
    fn tessellation(&self, world_from_object: &DMat4) -> TessellationSettings {
        let linear = DMat3::from_mat4(*world_from_object);
        let scale = linear.x_axis.length().max(linear.y_axis.length()).max(linear.z_axis.length());
        let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
        TessellationSettings {
            tolerance: Tolerance::World(self.tolerance / scale),
            plane_extent: self.plane_extent / scale,
            polygons: true,
            ..TessellationSettings::default()
        }
    }

    /// Material of each surface of the mesh; the scene's count stands for the default material.
    fn materials(&self, instance: &Instance, mesh: &Mesh) -> Vec<u32> {
        let geometry = &self.scene.geometries[instance.geometry.index()];
        let node = self.scene.nodes[instance.node.index()].material;
        let count = self.scene.materials.len();
        let given = mesh.surfaces.iter().map(|surface| surface.material);
        let own: Vec<_> = match &geometry.shape {
            Shape::Csg(csg) => csg.leaves().iter().map(|leaf| leaf.material).collect(),
            _ => given.collect(),
        };
        let of = |own: Option<senca_scene::MaterialId>| {
            own.or(node).or(geometry.material).map_or(count, |m| m.index().min(count)) as u32
        };
        own.into_iter().map(of).collect()
    }

    /// One side of each surface, or `None` where that side takes no part.
    fn add_surfaces(&mut self, instance: u32, materials: &[u32], back: bool) -> Vec<Option<u32>> {
        let default = Material { double_sided: true, ..Material::default() };
        let mut add = |&number: &u32| {
            let material = self.scene.materials.get(number as usize).unwrap_or(&default);
            let both = match self.settings.sides {
                Sides::ByMaterial => material.double_sided,
                Sides::Front => false,
                Sides::Both => true,
            };
            if back && !both {
                return None;
            }
            let (reflectance, emission) = (matt_reflectance(material), material.emission);
            let transmittance = transmittance(material);
            self.mesh.surfaces.push(RadiantSurface {
                instance,
                material: number,
                back,
                reflectance,
                emission,
                transmittance,
            });
            Some(self.mesh.surfaces.len() as u32 - 1)
        };
        materials.iter().map(&mut add).collect()
    }

    fn add_face(&mut self, placed: &Placed<'_>, corners: &[u32], surface: u32) {
        let places = |corners: &[u32]| -> SmallVec<[DVec3; 4]> {
            corners.iter().map(|&corner| placed.position(corner)).collect()
        };
        match *corners {
            [a, b, c] => self.add_part(placed, &[a, b, c], surface),
            [a, b, c, d] => {
                let quad = [a, b, c, d];
                let local = quad.map(|corner| placed.mesh.position(corner));
                if is_flat_quad(local) {
                    return self.add_part(placed, &quad, surface);
                }
                for half in split_quad(local) {
                    self.add_part(placed, &half.map(|i| quad[i]), surface);
                }
            }
            _ => {
                for triangle in triangulate_in_space(&places(corners)) {
                    self.add_part(placed, &triangle.map(|i| corners[i as usize]), surface);
                }
            }
        }
    }

    fn add_part(&mut self, placed: &Placed<'_>, corners: &[u32], surface: u32) {
        let mut vertices: SmallVec<[u32; 4]> =
            corners.iter().map(|&corner| self.vertex(placed, corner)).collect();
        if placed.reversed {
            vertices.reverse();
        }
        self.mesh.push_polygon(&vertices, surface);
    }

    /// The vertex for a corner: one that is there already at this place and has nearly this normal.
    fn vertex(&mut self, placed: &Placed<'_>, corner: u32) -> u32 {
        let (position, normal) = (placed.position(corner), placed.normal(corner));
        let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        let here = self.vertices.entry(key).or_default();
        let normals = &self.mesh.vertex_normals;
        if let Some(&known) = here.iter().find(|&&v| normals[v as usize].dot(normal) > SMOOTH_COS) {
            return known;
        }
        let vertex = self.mesh.push_vertex(position, normal);
        here.push(vertex);
        vertex
    }
}

/// One side of a mesh in its place.
struct Placed<'m> {
    mesh: &'m Mesh,
    world_from_object: &'m DMat4,
    world_from_object_normals: DMat3,
    /// Whether corners run the other way round in the world on this side.
    reversed: bool,
    /// -1 for the back.
    side: f64,
}

impl<'m> Placed<'m> {
    fn new(mesh: &'m Mesh, world_from_object: &'m DMat4, back: bool) -> Self {
        let linear = DMat3::from_mat4(*world_from_object);
        let mirrored = linear.determinant() < 0.0;
        Self {
            mesh,
            world_from_object,
            // The cofactors: the inverse transposed, times the determinant, which flat placements have too.
            world_from_object_normals: DMat3::from_cols(
                linear.y_axis.cross(linear.z_axis),
                linear.z_axis.cross(linear.x_axis),
                linear.x_axis.cross(linear.y_axis),
            ),
            reversed: mirrored != back,
            side: if mirrored != back { -1.0 } else { 1.0 },
        }
    }

    fn position(&self, corner: u32) -> DVec3 {
        self.world_from_object.transform_point3(self.mesh.position(corner).as_dvec3())
    }

    fn normal(&self, corner: u32) -> DVec3 {
        let normal = self.mesh.vertices.normal[corner as usize].as_dvec3();
        (self.world_from_object_normals * normal).normalize_or_zero() * self.side
    }
}

/// The share of light that a material scatters evenly.
fn matt_reflectance(material: &Material) -> LinearRgb {
    if material.unlit {
        return LinearRgb::BLACK;
    }
    match &material.reflection {
        Reflection::Phong(phong) => phong.diffuse,
        Reflection::MetallicRoughness(rough) => {
            rough.base_color * ((1.0 - rough.metallic) * (1.0 - DIELECTRIC_MIRROR))
        }
    }
}

/// The share of light that passes through a surface, as it is seen straight on.
fn transmittance(material: &Material) -> LinearRgb {
    if material.is_transmissive() {
        return material.transmission.map(|t| t.clamp(0.0, 1.0));
    }
    let alpha = match &material.reflection {
        Reflection::Phong(phong) => phong.alpha,
        Reflection::MetallicRoughness(rough) => rough.alpha,
    };
    match material.alpha_mode {
        AlphaMode::Opaque => LinearRgb::BLACK,
        AlphaMode::Blend => LinearRgb::splat((1.0 - alpha).clamp(0.0, 1.0)),
        AlphaMode::Mask { cutoff } => LinearRgb::splat(if alpha < cutoff { 1.0 } else { 0.0 }),
    }
}

/// The diagonal of the bounds, or 1 where there is none that is finite.
fn finite_size(bounds: &Aabb) -> f64 {
    let size = bounds.diagonal();
    if !bounds.is_empty() && size > 0.0 && size.is_finite() { size } else { 1.0 }
}

fn positive(name: &'static str, value: Option<f64>) -> Result<(), RadiosityError> {
    match value {
        Some(value) if !(value > 0.0 && value.is_finite()) => {
            Err(RadiosityError::Setting { name, value, expected: "above 0 and finite" })
        }
        _ => Ok(()),
    }
}
