//! From a scene to polygons.

use std::borrow::Cow;
use std::collections::HashMap;

use senca_math::glam::{DMat3, DMat4, DVec3, Vec3};
use senca_math::polygon::triangulate_in_space;
use senca_math::{Aabb, LinearRgb};
use senca_scene::{
    AlphaMode, Instance, Mesh, Scene, Shape, TessellationSettings, Tolerance, Warning, is_flat_quad,
    split_quad, tessellate,
};
use smallvec::SmallVec;

use super::inside::{self, Body};
use super::paint::Paint;
use super::{CornerAttributes, Element, ElementMesh, NONE, Polygon, RadiantSurface};
use crate::RadiosityError;

/// Normals of corners at one place that differ by less than this belong to one vertex; its cosine.
const SMOOTH_COS: f64 = 0.999;

/// Which sides of surfaces take part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The front, and the back of materials that show it; but not the insides of closed bodies in which
    /// nothing shines or looks.
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
    /// size that the settings ask for.
    ///
    /// Left out are polygons without area or with corners that are not finite, those that coincide with
    /// one before and face its way, and the insides of closed bodies in which nothing shines or looks;
    /// endless planes end beyond the scene. Meshes need not be manifold.
    ///
    /// # Errors
    /// [`RadiosityError::Shape`], [`RadiosityError::Setting`], [`RadiosityError::TooManyElements`].
    pub fn of_scene(scene: &Scene, settings: &MeshSettings) -> Result<Self, RadiosityError> {
        Self::of_scene_with_warnings(scene, settings).map(|(mesh, _)| mesh)
    }

    /// [`ElementMesh::of_scene`], and what was left out because something is wrong with it.
    ///
    /// # Errors
    /// As [`ElementMesh::of_scene`].
    pub fn of_scene_with_warnings(
        scene: &Scene,
        settings: &MeshSettings,
    ) -> Result<(Self, Vec<Warning>), RadiosityError> {
        positive("patch size", settings.patch_size)?;
        positive("tolerance", settings.tolerance)?;
        let mut builder = Builder::new(scene, settings);
        let instances = scene.instances();
        let mut meshes = Vec::with_capacity(instances.len());
        for (number, instance) in (0..).zip(&instances) {
            let shape = builder.mesh_of(instance)?;
            builder.add_side(number, instance, &shape, false);
            meshes.push(shape);
        }
        let empty = builder.empty_bodies(&instances, &meshes);
        for (number, (instance, shape)) in (0..).zip(instances.iter().zip(&meshes)) {
            if empty.binary_search(&number).is_err() {
                builder.add_side(number, instance, shape, true);
            }
        }
        let warnings = builder.warnings();
        let mut mesh = builder.mesh;
        if let Some(size) = settings.patch_size {
            mesh.divide_to_size(size, settings.max_elements)?;
        }
        Ok((mesh, warnings))
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
    /// Tells whether it was added.
    pub(super) fn push_polygon(&mut self, vertices: &[u32], surface: u32) -> bool {
        let corners: SmallVec<[DVec3; 4]> = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let normal = senca_math::newell_normal(&corners);
        if !(normal.length() > 0.0 && normal.is_finite()) {
            return false;
        }
        let vertices = match *vertices {
            [a, b, c] => [a, b, c, NONE],
            [a, b, c, d] => [a, b, c, d],
            _ => return false,
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
            open: 1.0,
        });
        true
    }
}

/// Puts together the polygons of a scene.
struct Builder<'s> {
    scene: &'s Scene,
    settings: &'s MeshSettings,
    /// World units.
    tolerance: f64,
    /// Of the scene.
    size: f64,
    middle: DVec3,
    paint: Paint<'s>,
    mesh: ElementMesh,
    /// Where polygons are, by the bits of their corners in ascending order, with their normals.
    taken: HashMap<SmallVec<[[u64; 3]; 4]>, SmallVec<[DVec3; 2]>>,
    /// Polygons that were left out: without area, and where one was already.
    flat: usize,
    doubled: usize,
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
            size,
            middle: scene.bounds().center(),
            paint: Paint::new(scene),
            mesh: ElementMesh::default(),
            taken: HashMap::new(),
            flat: 0,
            doubled: 0,
            vertices: HashMap::new(),
        }
    }

    /// The mesh of what an instance places.
    fn mesh_of(&self, instance: &Instance) -> Result<Cow<'s, Mesh>, RadiosityError> {
        let geometry = &self.scene.geometries[instance.geometry.index()];
        let settings = self.tessellation(&instance.world_from_object);
        tessellate(&geometry.shape, &settings).map_err(|source| RadiosityError::Shape {
            geometry: instance.geometry.0,
            name: geometry.name.clone(),
            source,
        })
    }

    fn add_side(&mut self, number: u32, instance: &Instance, mesh: &Mesh, back: bool) {
        self.vertices.clear();
        let materials = self.materials(instance, mesh);
        let surfaces = self.add_surfaces(number, &materials, back, mesh);
        let placed = Placed::new(mesh, &instance.world_from_object, back);
        for (face, corners) in mesh.faces.iter().enumerate() {
            let surface = surfaces.get(mesh.faces.surface_of(face) as usize).copied().flatten();
            if let Some(surface) = surface {
                self.add_face(&placed, corners, surface);
            }
        }
    }

    /// Numbers of instances whose inside nobody sees, ascending.
    fn empty_bodies(&self, instances: &[Instance], meshes: &[Cow<'_, Mesh>]) -> Vec<u32> {
        if self.settings.sides != Sides::ByMaterial {
            return Vec::new();
        }
        let mut bodies = Vec::new();
        for (number, (instance, mesh)) in (0..).zip(instances.iter().zip(meshes)) {
            let materials = self.materials(instance, mesh);
            let hides = |&material: &u32| {
                let plain = self.paint.material(material);
                let opaque = plain.alpha_mode == AlphaMode::Opaque && !plain.is_transmissive();
                opaque && !plain.unlit && plain.emission == LinearRgb::BLACK
            };
            let has_back = materials.iter().any(|&material| self.has_back(material));
            if has_back && materials.iter().all(hides) && inside::is_closed_body(mesh) {
                let world = |p: Vec3| instance.world_from_object.transform_point3(p.as_dvec3());
                bodies.push(Body { instance: number, bounds: inside::bounds_of(mesh, world) });
            }
        }
        inside::empty_bodies(&self.mesh, &bodies, &inside::watchers(self.scene))
    }

    fn warnings(&self) -> Vec<Warning> {
        let text = |count: usize, what: &str| {
            (count > 0).then(|| Warning(format!("{count} polygons {what} are left out of the mesh")))
        };
        let flat = text(self.flat, "without area, or with corners that are not finite,");
        let doubled = text(self.doubled, "that coincide with others");
        flat.into_iter().chain(doubled).collect()
    }

    /// The tolerance is meant in the world, shapes are in object space.
    fn tessellation(&self, world_from_object: &DMat4) -> TessellationSettings {
        let linear = DMat3::from_mat4(*world_from_object);
        let scale = linear.x_axis.length().max(linear.y_axis.length()).max(linear.z_axis.length());
        let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
        TessellationSettings {
            tolerance: Tolerance::World(self.tolerance / scale),
            plane_extent: self.plane_extent(world_from_object) / scale,
            polygons: true,
            ..TessellationSettings::default()
        }
    }

    /// Edge of an endless plane, which has its middle at the origin of its frame: as far beyond the
    /// scene as the scene is large.
    fn plane_extent(&self, world_from_object: &DMat4) -> f64 {
        let origin = world_from_object.transform_point3(DVec3::ZERO);
        let away = origin.distance(self.middle);
        2.0 * (self.size + if away.is_finite() { away } else { 0.0 })
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

    fn has_back(&self, material: u32) -> bool {
        match self.settings.sides {
            Sides::ByMaterial => self.paint.material(material).double_sided,
            Sides::Front => false,
            Sides::Both => true,
        }
    }

    /// One side of each surface, or `None` where that side takes no part.
    fn add_surfaces(
        &mut self,
        instance: u32,
        materials: &[u32],
        back: bool,
        mesh: &Mesh,
    ) -> Vec<Option<SideOf>> {
        let mut add = |&material: &u32| {
            if back && !self.has_back(material) {
                return None;
            }
            let blank = RadiantSurface {
                instance,
                material,
                back,
                reflectance: LinearRgb::BLACK,
                emission: LinearRgb::BLACK,
                transmittance: LinearRgb::BLACK,
            };
            if self.paint.varies(material, mesh) {
                return Some(SideOf::Varying(blank));
            }
            self.mesh.surfaces.push(self.paint.plain(blank));
            Some(SideOf::Plain(self.mesh.surfaces.len() as u32 - 1))
        };
        materials.iter().map(&mut add).collect()
    }

    fn add_face(&mut self, placed: &Placed<'_>, corners: &[u32], surface: SideOf) {
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

    fn add_part(&mut self, placed: &Placed<'_>, corners: &[u32], side: SideOf) {
        if self.is_doubled(placed, corners) {
            self.doubled += 1;
            return;
        }
        let surface = match side {
            SideOf::Plain(surface) => surface,
            SideOf::Varying(blank) => self.mean_surface(placed, corners, blank),
        };
        let mut vertices: SmallVec<[u32; 4]> =
            corners.iter().map(|&corner| self.vertex(placed, corner)).collect();
        let mut attributes = [CornerAttributes::default(); 4];
        for (slot, &corner) in attributes.iter_mut().zip(corners) {
            *slot = CornerAttributes::of_vertex(placed.mesh, corner);
        }
        if placed.reversed {
            vertices.reverse();
            attributes[..corners.len().min(4)].reverse();
        }
        if self.mesh.push_polygon(&vertices, surface) {
            self.add_attributes(attributes);
        } else {
            self.flat += 1;
        }
    }

    /// The surface of a polygon of its own, or the last one where that is the same.
    fn mean_surface(&mut self, placed: &Placed<'_>, corners: &[u32], blank: RadiantSurface) -> u32 {
        let mean = self.paint.mean(blank, placed.mesh, corners);
        let surfaces = &mut self.mesh.surfaces;
        if surfaces.last() != Some(&mean) {
            surfaces.push(mean);
        }
        surfaces.len() as u32 - 1
    }

    /// Whether there is a polygon with the same corners and the same front.
    fn is_doubled(&mut self, placed: &Placed<'_>, corners: &[u32]) -> bool {
        let places: SmallVec<[DVec3; 4]> = corners.iter().map(|&corner| placed.position(corner)).collect();
        let turn = if placed.reversed { -1.0 } else { 1.0 };
        let normal = senca_math::newell_normal(&places) * turn;
        if normal == DVec3::ZERO || !normal.is_finite() {
            return false;
        }
        let mut key: SmallVec<[[u64; 3]; 4]> =
            places.iter().map(|&p| (p + DVec3::ZERO).to_array().map(f64::to_bits)).collect();
        key.sort_unstable();
        let here = self.taken.entry(key).or_default();
        let doubled = here.iter().any(|other| other.dot(normal) > 0.0);
        if !doubled {
            here.push(normal);
        }
        doubled
    }

    /// Keeps the attributes of the last polygon once there has been one that has any.
    fn add_attributes(&mut self, attributes: [CornerAttributes; 4]) {
        let plain = [CornerAttributes::default(); 4];
        let (count, known) = (self.mesh.polygons.len(), self.mesh.attributes.len());
        if known == count || (known == 0 && attributes == plain) {
            return;
        }
        self.mesh.attributes.resize(count - 1, plain);
        self.mesh.attributes.push(attributes);
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

/// One side of a surface.
#[derive(Clone, Copy)]
enum SideOf {
    /// The same everywhere: its number.
    Plain(u32),
    /// Different from polygon to polygon; without its light.
    Varying(RadiantSurface),
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
