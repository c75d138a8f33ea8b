//! From a scene to objects.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use senca_bvh::BuildError;
use senca_math::glam::{DMat3, DMat4};
use senca_scene::{
    AlphaMode, Geometry, GeometryId, Instance, Material, MaterialId, Mesh, Scene, Shape, ShapeError,
    TessellationSettings, Warning, tessellate,
};

use super::{Object, WorldSettings};
use crate::accel::Accel;
use crate::mesh_surface::MeshSurface;
use crate::{Intersect, TraceError};

/// A placement whose volume is below this share of the cube of its longest side counts as flat.
const FLAT: f64 = 1e-24;

/// The objects of a scene, and what had to be left out.
pub(super) fn objects<'s>(
    scene: &'s Scene,
    settings: &WorldSettings,
) -> Result<(Vec<Object<'s>>, Vec<Warning>), TraceError> {
    let ready = HashMap::new();
    let mut builder = Builder { scene, settings, ready, objects: Vec::new(), warnings: Vec::new() };
    for instance in scene.instances() {
        builder.place(&instance)?;
    }
    Ok((builder.objects, builder.warnings))
}

/// Bytes that the surfaces of `objects` hold on to; surfaces shown several times count once.
pub(super) fn surface_bytes(objects: &[Object<'_>]) -> usize {
    let mut seen = HashSet::new();
    let first = |object: &&Object<'_>| seen.insert(Arc::as_ptr(&object.surface).cast::<()>());
    objects.iter().filter(first).map(|object| object.surface.memory_bytes()).sum()
}

/// Makes the objects of a scene.
struct Builder<'s, 'a> {
    scene: &'s Scene,
    settings: &'a WorldSettings,
    /// Surfaces that are ready, for other nodes that show the same geometry.
    ready: HashMap<GeometryId, Arc<dyn Intersect + 's>>,
    objects: Vec<Object<'s>>,
    warnings: Vec<Warning>,
}

impl<'s> Builder<'s, '_> {
    fn place(&mut self, instance: &Instance) -> Result<(), TraceError> {
        let world_from_object = instance.world_from_object;
        if !world_from_object.is_finite() {
            self.leave_out(instance, "its place is not finite");
            return Ok(());
        }
        if is_flat(&world_from_object) {
            return self.place_flattened(instance);
        }
        let surface = self.surface(instance.geometry)?;
        self.add(instance, surface, world_from_object);
        Ok(())
    }

    /// A placement that flattens has no inverse that could take rays along: its mesh is moved instead.
    fn place_flattened(&mut self, instance: &Instance) -> Result<(), TraceError> {
        let geometry = &self.scene.geometries[instance.geometry.index()];
        let mesh = tessellate(&geometry.shape, &self.settings.tessellation)
            .map_err(|source| shape_error(geometry, instance.geometry, source))?;
        let Some(mesh) = moved(&mesh, &instance.world_from_object) else {
            self.leave_out(instance, "it is too large for single precision");
            return Ok(());
        };
        let surface = self.mesh_surface(Cow::Owned(mesh));
        let surface = surface.map_err(|source| shape_error(geometry, instance.geometry, source))?;
        self.add(instance, Arc::new(surface), DMat4::IDENTITY);
        Ok(())
    }

    fn leave_out(&mut self, instance: &Instance, why: &str) {
        let name = &self.scene.nodes[instance.node.index()].name;
        let node = instance.node.index();
        self.warnings.push(Warning(format!("node {node} ({name:?}) is left out: {why}")));
    }

    fn has_hierarchies(&self) -> bool {
        self.settings.accel.kind == Accel::Bvh
    }

    /// The surface of a geometry, made once.
    fn surface(&mut self, id: GeometryId) -> Result<Arc<dyn Intersect + 's>, TraceError> {
        if let Some(surface) = self.ready.get(&id) {
            return Ok(Arc::clone(surface));
        }
        let geometry = &self.scene.geometries[id.index()];
        let surface = self.surface_of(&geometry.shape).map_err(|source| shape_error(geometry, id, source))?;
        self.ready.insert(id, Arc::clone(&surface));
        Ok(surface)
    }

    /// The surface of a shape, exact where that is possible.
    fn surface_of(&self, shape: &'s Shape) -> Result<Arc<dyn Intersect + 's>, ShapeError> {
        let as_mesh = |shape| tessellate(shape, &self.settings.tessellation);
        if let Shape::Mesh(_) = shape {
            return Ok(Arc::new(self.mesh_surface(as_mesh(shape)?)?));
        }
        let mut tessellated = |shape: &Shape| -> Result<Box<dyn Intersect>, ShapeError> {
            let mesh = tessellate(shape, &self.settings.tessellation)?.into_owned();
            Ok(Box::new(self.mesh_surface(Cow::Owned(mesh))?))
        };
        Ok(crate::intersect::surface_of(shape, &mut tessellated)?.into())
    }

    fn mesh_surface<'m>(&self, mesh: Cow<'m, Mesh>) -> Result<MeshSurface<'m>, ShapeError> {
        let malformed =
            |error: BuildError| ShapeError::Malformed { shape: "mesh", reason: error.to_string() };
        MeshSurface::of_mesh(mesh, self.has_hierarchies()).map_err(malformed)
    }

    fn add(&mut self, instance: &Instance, surface: Arc<dyn Intersect + 's>, world_from_object: DMat4) {
        let materials = self.materials(instance);
        let known = |&m: &usize| self.scene.materials.get(m).is_none_or(is_opaque);
        let casts_shadow = self.scene.nodes[instance.node.index()].light.is_none();
        // What throws no shadow is asked for.
        let opaque = casts_shadow && materials.iter().all(known);
        let mut object =
            Object::new(surface, world_from_object, materials, opaque, instance.node, instance.geometry);
        object.casts_shadow = casts_shadow;
        self.objects.push(object);
    }

    /// Material of each surface number; the scene's count stands for the default material.
    fn materials(&self, instance: &Instance) -> Vec<usize> {
        let geometry = &self.scene.geometries[instance.geometry.index()];
        let node = self.scene.nodes[instance.node.index()].material;
        let count = self.scene.materials.len();
        let material_of = |own: Option<MaterialId>| {
            own.or(node).or(geometry.material).map_or(count, |m| m.index().min(count))
        };
        match &geometry.shape {
            Shape::Mesh(Mesh { surfaces, .. }) if !surfaces.is_empty() => {
                surfaces.iter().map(|surface| material_of(surface.material)).collect()
            }
            Shape::Csg(csg) => csg.leaves().iter().map(|leaf| material_of(leaf.material)).collect(),
            _ => vec![material_of(None)],
        }
    }
}

fn shape_error(geometry: &Geometry, id: GeometryId, source: ShapeError) -> TraceError {
    TraceError::Shape { geometry: id.0, name: geometry.name.clone(), source }
}

/// Whether no light passes anywhere.
fn is_opaque(material: &Material) -> bool {
    material.alpha_mode == AlphaMode::Opaque && material.transmission == senca_math::LinearRgb::BLACK
}

/// Whether a map flattens space, or nearly so.
fn is_flat(world_from_object: &DMat4) -> bool {
    let linear = DMat3::from_mat4(*world_from_object);
    let longest = linear.x_axis.length().max(linear.y_axis.length()).max(linear.z_axis.length());
    let keeps_volume = linear.determinant().abs() > FLAT * longest.powi(3);
    !keeps_volume || !world_from_object.inverse().is_finite()
}

/// The mesh in the world. Normals are dropped, since those of its faces are the right ones now.
fn moved(mesh: &Mesh, world_from_object: &DMat4) -> Option<Mesh> {
    let mut mesh = mesh.clone();
    for point in &mut mesh.points {
        *point = world_from_object.transform_point3(point.as_dvec3()).as_vec3();
    }
    mesh.vertices.normal.clear();
    mesh.vertices.tangent.clear();
    mesh.points.iter().all(|p| p.is_finite()).then_some(mesh)
}

/// How shapes without an exact form become meshes: fine enough for most pictures.
pub(super) fn default_tessellation() -> TessellationSettings {
    TessellationSettings::default()
}
