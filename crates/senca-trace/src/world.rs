//! The scene as the tracer sees it: surfaces placed in the world, with their materials.

mod build;
mod object;
pub(crate) mod spawn;
#[cfg(test)]
mod tests;

use senca_math::glam::{DVec2, DVec3, Vec4};
use senca_scene::{Scene, TessellationSettings, Warning};

use crate::accel::{self, Accel, AccelSettings, Accelerator};
use crate::{Counters, Crossing, Ray, TraceError};

pub use object::Object;
pub(crate) use object::{LocalRay, way_to_ball};

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
    /// How far, in world units, `point` may be from where other rays meet the surface, by rounding.
    /// [`World::spawn`] goes by it.
    pub error: f64,
}

/// How a world is made of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldSettings {
    /// Accelerator and its settings. Default [`accel::Accel::Bvh`].
    pub accel: AccelSettings,
    /// The small positive number below which a new ray takes no hit, so that it does not meet the
    /// surface it starts on, in world units, >= 0. Default `None`: new rays start beside the surface by
    /// as much as rounding asks for there, which suits scenes of any size.
    pub epsilon: Option<f64>,
    /// How shapes that rays cannot meet exactly become meshes.
    pub tessellation: TessellationSettings,
}

impl Default for WorldSettings {
    fn default() -> Self {
        Self { accel: AccelSettings::default(), epsilon: None, tessellation: build::default_tessellation() }
    }
}

/// All that rays can meet.
#[derive(Debug)]
pub struct World<'s> {
    scene: &'s Scene,
    objects: Vec<Object<'s>>,
    accelerator: Box<dyn Accelerator>,
    epsilon: Option<f64>,
    accel: Accel,
    warnings: Vec<Warning>,
}

impl<'s> World<'s> {
    /// The objects of `scene`, which is in its pose (see `Scene::at_time`) and valid.
    ///
    /// # Errors
    /// [`TraceError::Shape`].
    pub fn new(scene: &'s Scene) -> Result<Self, TraceError> {
        Self::with_settings(scene, &WorldSettings::default())
    }

    /// The same by `settings`.
    ///
    /// # Errors
    /// [`TraceError::Shape`], [`TraceError::Setting`].
    pub fn with_settings(scene: &'s Scene, settings: &WorldSettings) -> Result<Self, TraceError> {
        if let Some(value) = settings.epsilon.filter(|e| !(*e >= 0.0 && e.is_finite())) {
            return Err(TraceError::Setting { name: "epsilon", value, expected: "at least 0 and finite" });
        }
        let (objects, warnings) = build::objects(scene, settings)?;
        let accelerator = accel::build(scene, &objects, &settings.accel)?;
        let (epsilon, accel) = (settings.epsilon, settings.accel.kind);
        Ok(Self { scene, objects, accelerator, epsilon, accel, warnings })
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

    /// Which accelerator it has.
    pub(crate) fn accel(&self) -> Accel {
        self.accel
    }

    /// See [`WorldSettings::epsilon`].
    pub(crate) fn epsilon(&self) -> Option<f64> {
        self.epsilon
    }

    /// What was left out of the scene, and why.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The nearest hit that the ray admits. Of hits at the same t the one with the lowest object,
    /// then the lowest part, counts. Rays that are not valid meet nothing.
    #[must_use]
    #[inline]
    pub fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        if !ray.is_valid() {
            return None;
        }
        match &*self.objects {
            [] => None,
            [object] if self.accelerator.may_skip() => {
                let crossing = object.closest(ray, counters)?;
                Some(Hit { object: 0, crossing })
            }
            objects => self.accelerator.closest(objects, ray, counters),
        }
    }

    /// Whether the ray meets anything that `blocks` it. Objects that let no light pass
    /// ([`Object::opaque`]) block without being asked for. Hits of others come in no particular order,
    /// each at most once, and when nothing blocks each exactly once.
    #[must_use]
    #[inline]
    pub fn occluded(&self, ray: &Ray, counters: &mut Counters, blocks: &dyn Fn(&Hit) -> bool) -> bool {
        if !ray.is_valid() {
            return false;
        }
        match &*self.objects {
            [] => false,
            [object] if self.accelerator.may_skip() => object.blocks(0, ray, counters, blocks),
            objects => self.accelerator.occluded(objects, ray, counters, blocks),
        }
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
        let point = object.world_from_object.transform_point3(p.point);
        let rounding = f64::EPSILON * (ray.origin.abs() + point.abs()).max_element();
        Interaction {
            point,
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
            error: object.error_at(p.point) + 8.0 * rounding,
        }
    }

    /// Bytes of memory that the world holds on to beside the scene.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        build::surface_bytes(&self.objects) + size_of_val(&*self.objects) + self.accelerator.memory_bytes()
    }
}
