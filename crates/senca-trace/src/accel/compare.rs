//! One scene, the same rays, one accelerator after the other.

use std::time::Instant;

use senca_scene::Scene;

use crate::{Accel, Counters, Ray, TraceError, World, WorldSettings};

/// What an accelerator cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The accelerator.
    pub accel: Accel,
    /// Seconds to make the world from the scene, the structure included.
    pub build_seconds: f64,
    /// Seconds for all rays, on one thread.
    pub seconds: f64,
    /// How many rays there were.
    pub rays: usize,
    /// Tests, nodes and cells of all rays together.
    pub counters: Counters,
    /// The nearest object and its part, for every ray. The same for all accelerators.
    pub nearest: Vec<Option<(u32, u32)>>,
    /// Bytes that the world holds on to beside the scene.
    pub memory_bytes: usize,
}

impl Comparison {
    /// A count as average over the rays.
    #[must_use]
    pub fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.rays.max(1) as f64
    }
}

/// Builds the world of `scene` by `settings` and searches the nearest hit of every ray.
///
/// # Errors
/// As [`World::with_settings`].
pub fn compare(scene: &Scene, settings: &WorldSettings, rays: &[Ray]) -> Result<Comparison, TraceError> {
    let start = Instant::now();
    let world = World::with_settings(scene, settings)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let mut counters = Counters::default();
    let start = Instant::now();
    let nearest: Vec<_> = rays
        .iter()
        .map(|ray| world.closest(ray, &mut counters).map(|hit| (hit.object, hit.crossing.part)))
        .collect();
    Ok(Comparison {
        accel: settings.accel.kind,
        build_seconds,
        seconds: start.elapsed().as_secs_f64(),
        rays: rays.len(),
        counters,
        nearest,
        memory_bytes: world.memory_bytes(),
    })
}
