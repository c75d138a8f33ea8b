//! Light from beyond the scene.
//!
//! A background of one colour or a gradient lights evenly enough to be left to the directions that
//! surfaces choose. A picture of the surroundings is a light of its own: directions are chosen by how
//! bright its cells are, each the solid angle of one texel.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_scene::{Background, Environment, Scene};

/// What is around the scene.
#[derive(Debug)]
pub(super) struct Sky<'s> {
    background: Background,
    environment: Option<Environment<'s>>,
}

impl<'s> Sky<'s> {
    pub(super) fn new(scene: &'s Scene) -> Self {
        let background = scene.background;
        Self { background, environment: Environment::of_background(scene, background) }
    }

    /// Light from a direction (unit): a gradient runs from straight down to straight up.
    pub(super) fn towards(&self, direction: DVec3) -> LinearRgb {
        match self.background {
            Background::None => LinearRgb::BLACK,
            Background::Color(color) => color,
            Background::Gradient { bottom, top } => bottom.lerp(top, 0.5 + 0.5 * direction.y as f32),
            Background::Environment { .. } => {
                self.environment.as_ref().map_or(LinearRgb::BLACK, |e| e.color(direction.as_vec3()))
            }
        }
    }

    /// Whether directions can be chosen by brightness.
    pub(super) fn can_be_sampled(&self) -> bool {
        false
    }

    /// Mean luminance.
    pub(super) fn brightness(&self) -> f64 {
        0.0
    }

    /// A bright direction and its density per steradian.
    pub(super) fn sample(&self, _: [f64; 2]) -> Option<(DVec3, f64)> {
        None
    }

    /// Density of [`Sky::sample`].
    pub(super) fn pdf(&self, _: DVec3) -> f64 {
        0.0
    }
}
