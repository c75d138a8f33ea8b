//! From a scene to meshes placed in the world, cut into parts of one material.

use std::borrow::Cow;
use std::collections::HashMap;

use senca_math::glam::{DMat3, DMat4, Mat3, Mat4};
use senca_math::{View, ViewKind};
use senca_scene::{
    Geometry, Instance, Mesh, PixelTolerance, Scene, Shape, TessellationSettings, Tolerance, tessellate,
};

use crate::RenderError;

/// A geometry of the scene as a mesh, placed.
pub(crate) struct Placed<'s> {
    /// Index into [`World::meshes`].
    pub(crate) mesh: usize,
    /// Object to world.
    pub(crate) world_from_object: DMat4,
    /// The same for hot loops.
    pub(crate) world_from_object_f32: Mat4,
    /// Normals of the object to normals of the world, up to length.
    pub(crate) world_from_object_normals: Mat3,
    /// Whether the placement mirrors, so that fronts show clockwise corners.
    pub(crate) mirrored: bool,
    pub(crate) instance: Instance,
    pub(crate) geometry: &'s Geometry,
}

/// Triangles of one material in one placed mesh.
pub(crate) struct Part {
    /// Identifier of the first triangle.
    pub(crate) first_id: u32,
    /// Index into [`World::placed`].
    pub(crate) placed: usize,
    /// Index into the materials; the scene's count stands for the default material.
    pub(crate) material: usize,
    /// Corners of the part's triangles where it is not the whole mesh.
    pub(crate) corners: Option<Vec<u32>>,
}

/// All that is drawn, in the world.
pub(crate) struct World<'s> {
    pub(crate) meshes: Vec<Cow<'s, Mesh>>,
    pub(crate) placed: Vec<Placed<'s>>,
    /// In rising order of identifiers.
    pub(crate) parts: Vec<Part>,
    /// Triangles of all parts.
    pub(crate) triangles: u32,
}

impl<'s> World<'s> {
    /// Tessellates what `scene` (posed: see `Scene::at_time`) shows in `view`, a picture of `size` pixels, with silhouettes at most
    /// `tolerance_px` off. With `polygons` faces stay whole and no parts are made.
    pub(crate) fn new(
        scene: &'s Scene,
        view: &View,
        size: [u32; 2],
        tolerance_px: f64,
        polygons: bool,
    ) -> Result<Self, RenderError> {
        let mut world = Self { meshes: Vec::new(), placed: Vec::new(), parts: Vec::new(), triangles: 0 };
        let mut ready = HashMap::new();
        for instance in scene.instances() {
            let geometry = &scene.geometries[instance.geometry.index()];
            if !instance.world_from_object.is_finite() {
                continue;
            }
            let settings = tessellation(view, size, tolerance_px, &instance, polygons);
            let mesh = world.mesh_of(geometry, &instance, &settings, &mut ready)?;
            world.place(geometry, instance, mesh);
        }
        if !polygons {
            world.make_parts(scene)?;
        }
        Ok(world)
    }

    /// Index of the mesh of an instance. Instances of one mesh share it; other shapes are tessellated
    /// for each instance, as finely as it needs.
    fn mesh_of(
        &mut self,
        geometry: &'s Geometry,
        instance: &Instance,
        settings: &TessellationSettings,
        ready: &mut HashMap<u32, usize>,
    ) -> Result<usize, RenderError> {
        let shared = matches!(geometry.shape, Shape::Mesh(_));
        if let Some(&mesh) = ready.get(&instance.geometry.0).filter(|_| shared) {
            return Ok(mesh);
        }
        let mesh = tessellate(&geometry.shape, settings).map_err(|source| RenderError::Shape {
            geometry: instance.geometry.0,
            name: geometry.name.clone(),
            source,
        })?;
        self.meshes.push(mesh);
        if shared {
            ready.insert(instance.geometry.0, self.meshes.len() - 1);
        }
        Ok(self.meshes.len() - 1)
    }

    fn place(&mut self, geometry: &'s Geometry, instance: Instance, mesh: usize) {
        let m = instance.world_from_object;
        self.placed.push(Placed {
            mesh,
            world_from_object: m,
            world_from_object_f32: m.as_mat4(),
            world_from_object_normals: normal_matrix(&m),
            mirrored: m.determinant() < 0.0,
            instance,
            geometry,
        });
    }

    fn make_parts(&mut self, scene: &Scene) -> Result<(), RenderError> {
        let count: u64 = self.placed.iter().map(|p| self.meshes[p.mesh].faces.len() as u64).sum();
        // The last identifier is "nothing"; lines and points number on behind the triangles.
        if count >= u64::from(u32::MAX) {
            return Err(RenderError::TooManyTriangles { count });
        }
        for index in 0..self.placed.len() {
            let placed = &self.placed[index];
            let mesh = &self.meshes[placed.mesh];
            let material_of = |surface: u32| material_index(scene, placed, mesh, surface);
            for (material, corners) in split_by_material(mesh, material_of) {
                let triangles = corners.as_ref().map_or(mesh.faces.corners.len(), Vec::len) / 3;
                self.parts.push(Part { first_id: self.triangles, placed: index, material, corners });
                self.triangles += triangles as u32;
            }
        }
        Ok(())
    }

    /// Corners of the triangles of `part`, as vertex numbers of its mesh.
    pub(crate) fn corners<'a>(&'a self, part: &'a Part) -> &'a [u32] {
        part.corners.as_deref().unwrap_or(&self.mesh(part).faces.corners)
    }

    /// The mesh of `part`.
    pub(crate) fn mesh(&self, part: &Part) -> &Mesh {
        &self.meshes[self.placed[part.placed].mesh]
    }

    /// Index of the part with the triangle `id`.
    pub(crate) fn part_of(&self, id: u32) -> usize {
        self.parts.partition_point(|p| p.first_id <= id).saturating_sub(1)
    }
}

/// Inverse transpose of the linear part, up to a positive factor: of cofactors, so that it exists for
/// flattened objects too, with the sign of the determinant.
pub(crate) fn normal_matrix(m: &DMat4) -> Mat3 {
    let exact = senca_math::normal_matrix(DMat3::from_mat4(*m));
    let columns = [exact.x_axis, exact.y_axis, exact.z_axis];
    let largest = columns.iter().map(|c| c.length()).fold(f64::MIN_POSITIVE, f64::max);
    let [x, y, z] = columns.map(|c| (c / largest).as_vec3());
    Mat3::from_cols(x, y, z)
}

/// Material of a surface: its own, else the node's, else the geometry's, else the default.
pub(crate) fn material_index(scene: &Scene, placed: &Placed<'_>, mesh: &Mesh, surface: u32) -> usize {
    let own = mesh.surfaces.get(surface as usize).and_then(|s| s.material);
    let node = scene.nodes[placed.instance.node.index()].material;
    let material = own.or(node).or(placed.geometry.material).map_or(usize::MAX, |m| m.index());
    material.min(scene.materials.len())
}

/// The triangles of `mesh` by material, in the order in which materials first appear; `None` stands
/// for all of them.
fn split_by_material(mesh: &Mesh, material_of: impl Fn(u32) -> usize) -> Vec<(usize, Option<Vec<u32>>)> {
    let faces = &mesh.faces;
    if faces.is_empty() {
        return Vec::new();
    }
    let surfaces = mesh.surfaces.len().max(1);
    let materials: Vec<usize> = (0..surfaces).map(|s| material_of(s as u32)).collect();
    let first = materials[0];
    if faces.surface.is_empty() || materials.iter().all(|&m| m == first) {
        return vec![(first, None)];
    }
    let mut slot_of: HashMap<usize, usize> = HashMap::new();
    let mut split: Vec<(usize, Option<Vec<u32>>)> = Vec::new();
    for (triangle, corners) in faces.corners.as_chunks::<3>().0.iter().enumerate() {
        let material = materials[(faces.surface_of(triangle) as usize).min(surfaces - 1)];
        let slot = *slot_of.entry(material).or_insert_with(|| {
            split.push((material, Some(Vec::new())));
            split.len() - 1
        });
        if let Some(list) = &mut split[slot].1 {
            list.extend_from_slice(corners);
        }
    }
    split
}

/// How finely to tessellate an instance.
fn tessellation(
    view: &View,
    [width, height]: [u32; 2],
    tolerance_px: f64,
    instance: &Instance,
    polygons: bool,
) -> TessellationSettings {
    let clip_from_object = view.clip_from_world * instance.world_from_object;
    let (width, height) = (f64::from(width), f64::from(height));
    let pixels = PixelTolerance::new(&clip_from_object, width, height, tolerance_px, least_w(view));
    TessellationSettings { tolerance: Tolerance::Pixels(pixels), polygons, ..TessellationSettings::default() }
}

/// Clip-space w of the near plane: the smallest w of what is seen.
fn least_w(view: &View) -> f64 {
    match view.kind {
        ViewKind::Parallel { .. } => 1.0,
        ViewKind::Central { .. } => {
            let m = &view.clip_from_view;
            let z_near = -m.w_axis.z / m.z_axis.z;
            let w = m.z_axis.w * z_near + m.w_axis.w;
            if w > 0.0 && w.is_finite() { w } else { 1e-3 }
        }
    }
}
