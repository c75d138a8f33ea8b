//! What a caller chooses of the path tracer.

use senca_scene::Filter;

use crate::TraceError;

/// How paths are followed. Small, to be copied and changed field by field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSettings {
    /// Surfaces that send a path on, at most. 0 shows what shines, 1 direct light, 2 the first light
    /// between surfaces. Default 128, of which most paths need few.
    pub max_bounces: u32,
    /// Bounces before chance may end a path. Default 4. Sooner is faster and noisier.
    pub roulette_after: u32,
    /// Largest component that light from one path's bounces after the first may add to a sample;
    /// more is cut. Removes bright single pixels together with the light they stand for. Default `None`:
    /// nothing is cut, and means are right.
    pub clamp: Option<f32>,
    /// Whether rays from the eye go through surfaces that show their back, where the material is not
    /// double-sided. Default true.
    pub hide_backs: bool,
    /// Filter of all textures in place of their own. Default `None`.
    pub texture_filter: Option<Filter>,
}

impl Default for PathSettings {
    fn default() -> Self {
        Self { max_bounces: 128, roulette_after: 4, clamp: None, hide_backs: true, texture_filter: None }
    }
}

impl PathSettings {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`TraceError::Setting`].
    pub fn check(&self) -> Result<(), TraceError> {
        match self.clamp {
            Some(value) if value.is_nan() || value <= 0.0 => {
                Err(TraceError::Setting { name: "clamp", value: value.into(), expected: "above 0" })
            }
            _ => Ok(()),
        }
    }
}
