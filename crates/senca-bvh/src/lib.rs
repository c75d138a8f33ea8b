//! Bounding volume hierarchies: which triangle, or which box, does a ray meet first?
//!
//! [`TriangleBvh`] is over triangles and answers itself; [`BoxBvh`] is over boxes and asks the caller what
//! is inside, for instances of other hierarchies and for shapes that are not triangles. Both have nodes
//! with eight children, whose boxes a ray is tested against at once, and come from the same build.
//! [`BruteForce`] is the plain twin, with the same answers.
//!
//! ```
//! use senca_bvh::{BuildSettings, Ray32, TriangleBvh};
//! use senca_math::glam::Vec3;
//!
//! let points = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let bvh = TriangleBvh::build(&points, &[[0, 1, 2]], &BuildSettings::default())?;
//! let hit = bvh.closest(&Ray32::new(Vec3::new(0.25, 0.5, 3.0), Vec3::NEG_Z)).unwrap();
//! assert_eq!((hit.t, hit.u, hit.v, hit.triangle), (3.0, 0.25, 0.5, 0));
//! # Ok::<(), senca_bvh::BuildError>(())
//! ```
//!
//! Rays are tested in single precision. The directions of rays may have any length.

mod aabb;
mod block;
mod box_bvh;
mod brute;
mod build;
mod error;
mod memory;
mod node;
mod order;
mod prepared;
mod ray;
mod stack;
mod traverse;
mod triangle_bvh;
mod watertight;

pub use aabb::Aabb32;
pub use box_bvh::BoxBvh;
pub use brute::BruteForce;
pub use error::BuildError;
pub use fearless_simd::Level as SimdLevel;
pub use ray::{Ray32, TraversalCounts, TriangleHit};
pub use triangle_bvh::{BuildSettings, TriangleBvh};
