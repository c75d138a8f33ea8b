//! A surface placed in the world.

use std::sync::Arc;

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_math::{Aabb, normal_matrix};
use senca_scene::{GeometryId, NodeId};

use super::Hit;
use crate::{Counters, Crossing, Crossings, Intersect, Ray};

/// A ray that starts farther from an object than so many of its radii is moved up to it before it is
/// tested: differences of large numbers would lose the digits that count.
const FAR: f64 = 64.0;

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
    /// Box around it in the world, a little wider than needed; infinite where the surface is endless.
    pub bounds_world: Aabb,
    /// Material of each surface number, as index into the scene's materials; the scene's count
    /// stands for the default material. Never empty; the last one holds for all further surfaces.
    pub materials: Vec<usize>,
    /// Whether none of the materials lets light pass, neither by transmission nor by alpha.
    pub opaque: bool,
    /// Whether it throws shadows where rays are followed without chance: not where its node carries a
    /// light, too, of which it is then the look.
    pub casts_shadow: bool,
    /// Node that places it.
    pub node: NodeId,
    /// Geometry that it is.
    pub geometry: GeometryId,
    placement: Placement,
    /// Centre of the bounds, and square of the distance from it at which rays are moved up.
    center_world: DVec3,
    radius_world: f64,
    far_squared: f64,
    /// Largest absolute coordinate in object space; infinite where the surface is endless.
    extent: f64,
    /// Upper bound for the factor by which the placement stretches lengths.
    scale: f64,
}

/// What the placement does beyond standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    /// Nothing.
    Identity,
    /// Moves.
    Translation(DVec3),
    /// Anything affine.
    Affine,
}

/// A ray in object space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    pub(crate) ray: Ray,
    /// To be added to t.
    pub(crate) shift: f64,
}

impl LocalRay {
    /// The same line between the limits of a ray in the world. Rounding of the shift leaves the upper
    /// limit too high rather than too low; where there is a shift, nothing is met before it.
    #[inline]
    pub(crate) fn with_limits(&self, ray: &Ray) -> Self {
        let slack = 4.0 * f64::EPSILON * self.shift.abs();
        let t_min = if self.shift == 0.0 { ray.t_min } else { (ray.t_min - self.shift).max(0.0) };
        let t_max = ray.t_max - self.shift + slack;
        Self { ray: Ray { t_min, t_max, ..self.ray }, shift: self.shift }
    }

    /// A crossing of this ray with the parameter of the ray in the world.
    #[inline]
    pub(crate) fn in_world(&self, crossing: Crossing) -> Crossing {
        Crossing { t: crossing.t + self.shift, ..crossing }
    }
}

impl<'s> Object<'s> {
    /// `surface` at an invertible place.
    pub(super) fn new(
        surface: Arc<dyn Intersect + 's>,
        world_from_object: DMat4,
        materials: Vec<usize>,
        opaque: bool,
        node: NodeId,
        geometry: GeometryId,
    ) -> Self {
        let linear = DMat3::from_mat4(world_from_object);
        let scale = linear.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let bounds = surface.bounds();
        let extent = extent(&bounds);
        let mut object = Self {
            surface,
            world_from_object,
            object_from_world: world_from_object.inverse(),
            world_from_object_normals: normal_matrix(linear),
            bounds_world: Aabb::EMPTY,
            materials,
            opaque,
            casts_shadow: true,
            node,
            geometry,
            placement: placement(&world_from_object),
            center_world: DVec3::ZERO,
            radius_world: f64::INFINITY,
            far_squared: f64::INFINITY,
            extent,
            scale,
        };
        object.bounds_world = object.in_world(bounds);
        if !object.is_endless() {
            object.center_world = object.bounds_world.center();
            object.radius_world = 0.5 * object.bounds_world.diagonal();
            object.far_squared = (FAR * object.radius_world).powi(2);
        }
        object
    }

    /// Index of the material of a surface number.
    #[must_use]
    pub fn material_of(&self, surface: u32) -> usize {
        let last = self.materials.len() - 1;
        self.materials[(surface as usize).min(last)]
    }

    /// Whether the surface has no bounds.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.extent == f64::INFINITY
    }

    /// Box in the world around one part, a little wider than needed.
    #[must_use]
    pub fn part_bounds_world(&self, part: u32) -> Aabb {
        self.in_world(self.surface.part_bounds(part))
    }

    /// A box of object space in the world, widened by what rounding may add to what it holds.
    fn in_world(&self, bounds: Aabb) -> Aabb {
        if bounds.is_empty() {
            return Aabb::EMPTY;
        }
        if self.is_endless() {
            return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        }
        let world = match self.placement {
            Placement::Identity => bounds,
            _ => bounds.transformed(&self.world_from_object),
        };
        let rounding = 8.0 * f64::EPSILON * extent(&world);
        let margin = DVec3::splat(2.0 * self.scale * self.surface.precision() * self.extent + rounding);
        Aabb { min: world.min - margin, max: world.max + margin }
    }

    /// The ray in object space.
    #[inline]
    pub(crate) fn local(&self, ray: &Ray) -> LocalRay {
        let to_center = self.center_world - ray.origin;
        if to_center.length_squared() > self.far_squared {
            return self.moved_up(ray, to_center);
        }
        LocalRay { ray: self.to_object(ray), shift: 0.0 }
    }

    /// The ray in object space, from where it comes near the object.
    #[cold]
    fn moved_up(&self, ray: &Ray, to_center: DVec3) -> LocalRay {
        let shift = way_to_ball(-to_center, ray.direction, self.radius_world);
        let moved = Ray { origin: ray.at(shift), ..*ray };
        LocalRay { ray: self.to_object(&moved), shift }.with_limits(ray)
    }

    #[inline]
    fn to_object(&self, ray: &Ray) -> Ray {
        match self.placement {
            Placement::Identity => *ray,
            Placement::Translation(offset) => Ray { origin: ray.origin - offset, ..*ray },
            Placement::Affine => ray.transformed(&self.object_from_world),
        }
    }

    /// Centre of the bounds, and the square of the distance from it from which on rays are moved up before
    /// they are tested.
    pub(crate) fn far(&self) -> (DVec3, f64) {
        (self.center_world, self.far_squared)
    }

    /// The nearest crossing that the ray of the world admits.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let local = self.local(ray);
        let crossing = local.in_world(self.surface.closest(&local.ray, counters)?);
        ray.admits(crossing.t).then_some(crossing)
    }

    /// Whether the object, which is number `object`, blocks the ray of the world.
    #[inline]
    pub(crate) fn blocks(
        &self,
        object: u32,
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        let local = self.local(ray);
        if self.opaque {
            return self.surface.occludes(&local.ray, counters);
        }
        let mut crossings = Crossings::new();
        self.surface.crossings(&local.ray, counters, &mut crossings);
        let crossings = crossings.into_iter().map(|crossing| local.in_world(crossing));
        crossings.filter(|c| ray.admits(c.t)).any(|crossing| blocks(&Hit { object, crossing }))
    }

    /// How far, in the world, a computed point of the surface may be from where rays meet it.
    pub(crate) fn error_at(&self, point_object: DVec3) -> f64 {
        let largest = if self.is_endless() { point_object.abs().max_element() } else { self.extent };
        self.scale * self.surface.precision() * largest
    }
}

/// The t of a place on the line before all of the ball of `radius` around the origin, not far from it;
/// 0 where that is no number.
pub(crate) fn way_to_ball(origin: DVec3, direction: DVec3, radius: f64) -> f64 {
    let squared = direction.length_squared();
    let t = -origin.dot(direction) / squared - 2.0 * radius / squared.sqrt();
    if t.is_finite() { t } else { 0.0 }
}

/// Largest absolute coordinate; infinite for boxes without end, 0 for empty ones.
fn extent(bounds: &Aabb) -> f64 {
    if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() }
}

fn placement(world_from_object: &DMat4) -> Placement {
    let offset = world_from_object.w_axis.truncate();
    if *world_from_object != DMat4::from_translation(offset) {
        Placement::Affine
    } else if offset == DVec3::ZERO {
        Placement::Identity
    } else {
        Placement::Translation(offset)
    }
}
