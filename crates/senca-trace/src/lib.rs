//! Recursive ray tracing (course text, chapter 3), and path tracing as ground truth.

pub mod accel;
pub mod antialias;
mod counters;
mod error;
mod film;
mod fresnel;
mod intersect;
mod lanes;
mod material;
mod mesh_surface;
pub mod path;
mod primary;
mod ray;
pub mod recursive;
mod sampler;
#[cfg(test)]
mod test_support;
pub mod textbook;
mod texture;
pub mod tree;
mod world;

pub use accel::{Accel, AccelSettings};
pub use counters::{Counters, RayCounts, TraceCounts};
pub use error::TraceError;
pub use film::{
    Area, Film, FilmReport, FilmSettings, Fingerprint, Integrator, SamplePlace, SavedFilmError, Watch,
};
pub use intersect::{
    Crossing, Crossings, CsgBody, CsgBuilder, CsgError, Cuboid, Disc, Ellipsoid, Elsewhere, FlatTriangle,
    Form, Frustum, Implicit, Intersect, Operation, PatchSurface, PlaneSurface, Polygon, Prism, Revolution,
    RootMethod, Sphere, SurfacePoint, Torus, Triangle, ray_triangle, surface_of,
};
pub use material::{MaterialPoint, MaterialTable, ReflectionPoint};
pub use path::PathSettings;
pub use primary::PrimaryRays;
pub use ray::Ray;
pub use recursive::RecursiveSettings;
pub use sampler::{Pattern, Sampler};
pub use senca_math::Control;
pub use world::{Hit, Interaction, Object, World, WorldSettings};
