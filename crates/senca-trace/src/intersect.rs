//! Where a ray meets a surface.
//!
//! Two steps, as the text's first practical rule has it (course text, section 3.2): for every ray
//! only the parameter t and what is needed to find the rest ([`Crossing`]), and only for the nearest
//! one the point, the normals and the texture coordinates ([`SurfacePoint`]).

mod analytic;
mod build;
mod csg;
mod cuboid;
mod flat;
mod frustum;
mod implicit;
mod patches;
mod prism;
mod region;
mod revolution;
mod sphere;
#[cfg(test)]
mod tests;
mod torus;
mod triangle;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3, Vec4};
use smallvec::SmallVec;

use crate::{Counters, Ray};

pub use build::{Elsewhere, surface_of};
pub use csg::{CsgBody, CsgBuilder, CsgError, Operation};
pub use cuboid::Cuboid;
pub use flat::{Disc, PlaneSurface, Polygon};
pub use frustum::Frustum;
pub use implicit::{Implicit, RootMethod};
pub use patches::PatchSurface;
pub(crate) use patches::{BLOCK, RayBlock};
pub use prism::Prism;
pub use revolution::Revolution;
pub use sphere::{Ellipsoid, Sphere};
pub use torus::Torus;
pub use triangle::{Triangle, ray_triangle};

/// A ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Parameter of the ray.
    pub t: f64,
    /// Which part of the surface: triangle, patch, side or cap. Its meaning is the surface's own.
    pub part: u32,
    /// Place within the part, where the surface needs it: barycentric weights of the second and third
    /// corner, or the parameters (u, v) of a patch.
    pub uv: DVec2,
}

/// Crossings in ascending order of t. A few are kept without an allocation.
pub type Crossings = SmallVec<[Crossing; 8]>;

/// What there is to know of a surface at a crossing, in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The place.
    pub point: DVec3,
    /// Unit normal of the surface itself, on its outside; the gradient of an implicit surface, the
    /// product of the derivatives of a parametric one.
    pub normal: DVec3,
    /// Unit normal to shade with: interpolated on meshes that are meant to look smooth.
    pub shading_normal: DVec3,
    /// Texture coordinates of sets 0 and 1; (0, 0) is the top left corner of the picture.
    pub texcoords: [DVec2; 2],
    /// Derivative of the place along u of set 0, for normal maps; zero where there is none.
    pub tangent: DVec3,
    /// Sign of the bitangent: `bitangent = handedness * (shading_normal x tangent)`.
    pub handedness: f64,
    /// Colour at the place that multiplies the material's; white where there is none.
    pub color: Vec4,
    /// Surface of the shape, which decides the material.
    pub surface: u32,
}

/// What a surface is, in object space, where it is simple enough for many rays to meet it at once.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// [`Sphere`].
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// [`PlaneSurface`].
    Plane {
        /// Length of its edges, where it has some.
        size: Option<f64>,
    },
    /// [`Disc`].
    Disc {
        /// Its radius.
        radius: f64,
        /// That of the hole.
        inner: f64,
    },
    /// One flat piece with four corners, as the triangle at the first of them and its neighbours.
    Parallelogram(FlatTriangle),
    /// A few flat triangles, by part.
    Triangles(Vec<FlatTriangle>),
    /// Anything else.
    Other,
}

/// A triangle with nothing but a picture on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatTriangle {
    /// Counter-clockwise seen from its front.
    pub corners: [DVec3; 3],
    /// Texture coordinates of set 0 at the corners.
    pub texcoords: [DVec2; 3],
    /// Surface number.
    pub surface: u32,
}

/// A surface in its own object space that rays can meet.
///
/// Rays that are not valid ([`Ray::is_valid`]) meet nothing.
pub trait Intersect: Send + Sync + std::fmt::Debug {
    /// The smallest box around the surface that is cheap to find. Infinite for endless planes.
    fn bounds(&self) -> Aabb;

    /// The crossing with the smallest t that the ray admits.
    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing>;

    /// Whether the ray admits any crossing.
    fn occludes(&self, ray: &Ray, counters: &mut Counters) -> bool {
        self.closest(ray, counters).is_some()
    }

    /// All crossings that the ray admits, appended in ascending order of t. A closed body's crossings
    /// of a whole line alternate between entering and leaving.
    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings);

    /// The rest of what there is to know at a crossing of this ray.
    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint;

    /// Whether the surface bounds a body, so that it has an inside.
    fn is_closed(&self) -> bool;

    /// Number of parts that can be met one by one, for accelerators that sort single triangles or
    /// patches: `part` of a crossing is below it. 1 where the surface is one thing.
    fn part_count(&self) -> u32 {
        1
    }

    /// Box around one part.
    fn part_bounds(&self, part: u32) -> Aabb {
        let _ = part;
        self.bounds()
    }

    /// The crossing with the smallest t in one part.
    fn closest_in_part(&self, part: u32, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let _ = part;
        self.closest(ray, counters)
    }

    /// What the surface is, for those who meet it with many rays at once.
    fn form(&self) -> Form {
        Form::Other
    }

    /// The surface as patches, where it is made of them, for those who meet it with many rays at once.
    fn patches(&self) -> Option<&PatchSurface> {
        None
    }

    /// How far computed places may be from where rays meet the surface, as a share of the largest
    /// coordinate in object space. For surfaces computed in double precision about 1e-10.
    fn precision(&self) -> f64 {
        1e-10
    }

    /// Bytes of memory that the surface holds on to beside what it borrows from the scene.
    fn memory_bytes(&self) -> usize {
        0
    }
}
