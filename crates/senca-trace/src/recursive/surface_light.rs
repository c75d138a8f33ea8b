//! Light on surfaces that was found beforehand, as radiosity finds it.

use senca_math::LinearRgb;

use crate::{Interaction, MaterialPoint};

/// Light that is known beforehand, place by place: see
/// [`Tracer::with_surface_light`](super::Tracer::with_surface_light).
pub trait SurfaceLight: Sync {
    /// What is known of the light at a place with this material.
    fn at(&self, at: &Interaction, material: &MaterialPoint) -> KnownLight;
}

/// What is known of the light at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnownLight {
    /// Light that arrives, as a white matt surface would show it. It takes the place of the ambient
    /// light; that of the lamps is added.
    /// Source: course text, task 4.9.
    Arriving(LinearRgb),
    /// All that the place sends to the viewer but for mirrored and transmitted rays. Lamps are not
    /// looked at.
    Leaving(LinearRgb),
}

/// Light that is known beforehand, held by a tracer.
#[derive(Clone, Copy, Default)]
pub(super) struct Known<'w>(pub(super) Option<&'w dyn SurfaceLight>);

impl std::fmt::Debug for Known<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() { "Known" } else { "Unknown" })
    }
}
