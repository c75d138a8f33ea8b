//! What a caller chooses of the recursive tracer.

use senca_scene::Filter;

use crate::TraceError;

/// How rays are followed. Small, to be copied and changed field by field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecursiveSettings {
    /// MaxNest of the text: how many times a ray may be reflected or transmitted. 0 shows direct light
    /// only. Default 8. Each level at most doubles the number of rays.
    pub max_depth: u32,
    /// Adaptive depth (course text, section 3.3): rays whose product of coefficients from the root on
    /// is below this are not sent. Default 1/255, the step of an 8-bit picture; 0 for a fixed depth.
    pub adaptive_depth: f32,
    /// How places reflect the light of lamps. Default [`LightModel::Material`].
    pub light_model: LightModel,
    /// Whether bodies cast shadows. Default true.
    pub shadows: bool,
    /// Shadow rays along each side of an area light, up to 64. Default 4, so 16 for each light and hit;
    /// more makes soft shadows smoother. 0 looks at the middle of the light only: shadows are sharp.
    pub soft_shadows: u32,
    /// Whether transparent bodies cast shadows, in their colour. Default false: as in the text, they
    /// cast none.
    pub transparent_shadows: bool,
    /// Which faces are left out for showing their back. Default [`Backs::ByMaterial`].
    pub backs: Backs,
    /// Filter of all textures in place of their own. Default `None`.
    pub texture_filter: Option<Filter>,
    /// Seed of random numbers. Default 0.
    pub seed: u64,
}

/// How places reflect the light of lamps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LightModel {
    /// Each material by its own model.
    #[default]
    Material,
    /// All by the model of the books; metallic-roughness materials are translated.
    Phong,
}

/// Which faces are left out for showing their back. Faces of transparent bodies are not, and left out
/// or not, all cast shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backs {
    /// Those whose material is not double-sided.
    #[default]
    ByMaterial,
    /// All.
    Hidden,
    /// None; backs are lit as if they were fronts.
    Shown,
}

/// Most shadow rays along a side of an area light.
const MAX_SOFT_SHADOWS: u32 = 64;

impl Default for RecursiveSettings {
    fn default() -> Self {
        Self {
            max_depth: 8,
            adaptive_depth: 1.0 / 255.0,
            light_model: LightModel::default(),
            shadows: true,
            soft_shadows: 4,
            transparent_shadows: false,
            backs: Backs::default(),
            texture_filter: None,
            seed: 0,
        }
    }
}

impl RecursiveSettings {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`TraceError::Setting`].
    pub fn check(&self) -> Result<(), TraceError> {
        let wrong = |name, value, expected| Err(TraceError::Setting { name, value, expected });
        if !(0.0..=1.0).contains(&self.adaptive_depth) {
            return wrong("adaptive_depth", self.adaptive_depth.into(), "0 to 1");
        }
        if !(0..=MAX_SOFT_SHADOWS).contains(&self.soft_shadows) {
            return wrong("soft_shadows", self.soft_shadows.into(), "0 to 64");
        }
        Ok(())
    }
}
