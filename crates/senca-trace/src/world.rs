//! The scene as the tracer sees it: surfaces placed in the world, with their materials.

use std::collections::HashMap;
use std::sync::Arc;

use senca_math::glam::{DMat3, DMat4, DVec2, DVec3, Vec4};
use senca_math::{Aabb, normal_matrix};
use senca_scene::{Geometry, GeometryId, Instance, NodeId, Scene, Shape, Surface, TessellationSettings};

use crate::accel::{Accelerator, List};
use crate::mesh_surface::MeshSurface;
use crate::{Counters, Crossing, Intersect, Ray, TraceError};

/// A surface placed in the world.
#[derive(Clone, Debug)]
pub struct Object<'s> {
    /// The surface in its own space.
    pub surface: Arc<dyn Intersect + 's>,
    /// Object to world.
    pub world_from_object: DMat4,
    /// World to object.
    pub object_from_world: DMat4,
    /// Normals of the object to normals of the world, up to length.
    pub world_from_object_normals: DMat3,
    /// Box around it in the world.
    pub bounds_world: Aabb,
    /// Material of each surface number, as index into the scene's materials; the scene's count
    /// stands for the default material. Never empty; the last one holds for all further surfaces.
    pub materials: Vec<usize>,
    /// Node that places it.
    pub node: NodeId,
    /// Geometry that it is.
    pub geometry: GeometryId,
}

impl Object<'_> {
    /// Index of the material of a surface number.
    #[must_use]
    pub fn material_of(&self, surface: u32) -> usize {
        let last = self.materials.len() - 1;
        self.materials[(surface as usize).min(last)]
    }
}

/// A ray meets an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index into [`World::objects`].
    pub object: u32,
    /// Where the ray meets it.
    pub crossing: Crossing,
}

/// What there is to know where a ray meets an object, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// The place.
    pub point: DVec3,
    /// Unit normal of the surface itself, on its outside.
    pub normal: DVec3,
    /// Unit normal to shade with, on the same side as `normal`.
    pub shading_normal: DVec3,
    /// Unit direction towards the origin of the ray.
    pub to_viewer: DVec3,
    /// Whether the ray comes from the outside.
    pub entering: bool,
    /// Texture coordinates of sets 0 and 1.
    pub texcoords: [DVec2; 2],
    /// Derivative of the place along u of set 0; zero where there is none.
    pub tangent: DVec3,
    /// Sign of the bitangent.
    pub handedness: f64,
    /// Colour that multiplies the material's.
    pub color: Vec4,
    /// Index of the material; the scene's count stands for the default material.
    pub material: usize,
    /// Index into [`World::objects`].
    pub object: u32,
}

/// All that rays can meet.
#[derive(Debug)]
pub struct World<'s> {
    scene: &'s Scene,
    objects: Vec<Object<'s>>,
    accelerator: Box<dyn Accelerator>,
}

impl<'s> World<'s> {
    /// The objects of `scene`, which is in its pose (see `Scene::at_time`) and valid.
    ///
    /// # Errors
    /// [`TraceError::Shape`].
    pub fn new(scene: &'s Scene) -> Result<Self, TraceError> {
        let mut ready = HashMap::new();
        let mut objects = Vec::new();
        for instance in scene.instances() {
            let geometry = &scene.geometries[instance.geometry.index()];
            let surface = match ready.get(&instance.geometry) {
                Some(surface) => Arc::clone(surface),
                None => {
                    let surface = surface_of(geometry, instance.geometry)?;
                    ready.insert(instance.geometry, Arc::clone(&surface));
                    surface
                }
            };
            objects.extend(place(scene, geometry, &instance, surface));
        }
        Ok(Self { scene, objects, accelerator: Box::new(List) })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The objects, in the order of the scene's nodes.
    #[must_use]
    pub fn objects(&self) -> &[Object<'s>] {
        &self.objects
    }

    /// The nearest hit that the ray admits.
    #[must_use]
    pub fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        self.accelerator.closest(&self.objects, ray, counters)
    }

    /// Whether the ray meets anything that `blocks` it.
    #[must_use]
    pub fn occluded(&self, ray: &Ray, counters: &mut Counters, blocks: &dyn Fn(&Hit) -> bool) -> bool {
        self.accelerator.occluded(&self.objects, ray, counters, blocks)
    }

    /// What there is to know at a hit of this ray.
    #[must_use]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        let object = &self.objects[hit.object as usize];
        let ray_object = ray.transformed(&object.object_from_world);
        let p = object.surface.surface_point(&ray_object, &hit.crossing);
        let to_world = |n: DVec3| (object.world_from_object_normals * n).normalize_or_zero();
        let normal = to_world(p.normal);
        let shading_normal = to_world(p.shading_normal);
        Interaction {
            point: object.world_from_object.transform_point3(p.point),
            normal,
            shading_normal: if shading_normal.dot(normal) < 0.0 { -shading_normal } else { shading_normal },
            to_viewer: -ray.direction.normalize_or_zero(),
            entering: normal.dot(ray.direction) < 0.0,
            texcoords: p.texcoords,
            tangent: object.world_from_object.transform_vector3(p.tangent),
            handedness: p.handedness,
            color: p.color,
            material: object.material_of(p.surface),
            object: hit.object,
        }
    }
}

/// The surface of a geometry in its own space.
fn surface_of(geometry: &Geometry, id: GeometryId) -> Result<Arc<dyn Intersect + '_>, TraceError> {
    let failed = |source| TraceError::Shape { geometry: id.0, name: geometry.name.clone(), source };
    let settings = TessellationSettings::default();
    Ok(Arc::new(MeshSurface::new(&geometry.shape, &settings).map_err(failed)?))
}

/// The surface where its instance puts it. Nothing where the placement is not finite or flattens it.
fn place<'s>(
    scene: &Scene,
    geometry: &Geometry,
    instance: &Instance,
    surface: Arc<dyn Intersect + 's>,
) -> Option<Object<'s>> {
    let world_from_object = instance.world_from_object;
    let object_from_world = world_from_object.inverse();
    if !world_from_object.is_finite() || !object_from_world.is_finite() {
        return None;
    }
    let bounds_world = surface.bounds().transformed(&world_from_object);
    let count = scene.materials.len();
    let node = scene.nodes[instance.node.index()].material;
    let material_of = |own: Option<senca_scene::MaterialId>| {
        own.or(node).or(geometry.material).map_or(count, |m| m.index().min(count))
    };
    let surfaces: &[Surface] = match &geometry.shape {
        Shape::Mesh(mesh) => &mesh.surfaces,
        _ => &[],
    };
    let materials = match surfaces {
        [] => vec![material_of(None)],
        some => some.iter().map(|s| material_of(s.material)).collect(),
    };
    Some(Object {
        surface,
        world_from_object,
        object_from_world,
        world_from_object_normals: normal_matrix(DMat3::from_mat4(world_from_object)),
        bounds_world,
        materials,
        node: instance.node,
        geometry: instance.geometry,
    })
}
