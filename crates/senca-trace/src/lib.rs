//! Recursive ray tracing (course text, chapter 3), and path tracing as ground truth.

mod counters;
mod intersect;
mod ray;

pub use counters::Counters;
pub use intersect::{Crossing, Crossings, Intersect, SurfacePoint};
pub use ray::Ray;
