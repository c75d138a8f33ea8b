//! Recursive ray tracing (course text, chapter 3), and path tracing as ground truth.

pub mod accel;
mod counters;
mod error;
mod intersect;
mod material;
mod mesh_surface;
mod primary;
mod ray;
mod sampler;
pub mod textbook;
mod texture;
mod world;

pub use accel::{Accel, AccelSettings};
pub use counters::Counters;
pub use error::TraceError;
pub use intersect::{
    Crossing, Crossings, Cuboid, Disc, Ellipsoid, Elsewhere, Frustum, Intersect, PlaneSurface, Polygon,
    Prism, Revolution, Sphere, SurfacePoint, Torus, Triangle, ray_triangle, surface_of,
};
pub use material::{MaterialPoint, MaterialTable, ReflectionPoint};
pub use primary::PrimaryRays;

pub use ray::Ray;
pub use sampler::{Pattern, Sampler};
pub use senca_math::Control;
pub use world::{Hit, Interaction, Object, World, WorldSettings};
