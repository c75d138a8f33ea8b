//! What rays see that leave the scene.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_scene::{Background, Environment, Scene};

/// What is seen where nothing is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky<'s> {
    background: Background,
    environment: Option<Environment<'s>>,
    last_row: u32,
}

impl<'s> Sky<'s> {
    /// Of a picture of `height` rows of `scene`.
    pub(crate) fn new(scene: &'s Scene, background: Background, height: u32) -> Self {
        let environment = Environment::of_background(scene, background);
        Self { background, environment, last_row: height.saturating_sub(1).max(1) }
    }

    /// Colour in a row of the picture, seen along `direction`; `None` where the picture is
    /// transparent.
    #[inline]
    pub(crate) fn in_row(&self, row: u32, direction: DVec3) -> Option<LinearRgb> {
        match self.background {
            Background::None => None,
            Background::Color(color) => Some(color),
            Background::Gradient { bottom, top } => Some(top.lerp(bottom, row as f32 / self.last_row as f32)),
            Background::Environment { .. } => Some(self.towards(direction)),
        }
    }

    /// Colour in a direction (unit): a gradient runs from straight down to straight up. Black where
    /// nothing was said.
    #[inline]
    pub(crate) fn towards(&self, direction: DVec3) -> LinearRgb {
        match self.background {
            Background::None => LinearRgb::BLACK,
            Background::Color(color) => color,
            Background::Gradient { bottom, top } => bottom.lerp(top, 0.5 + 0.5 * direction.y as f32),
            Background::Environment { .. } => {
                let seen = self.environment.as_ref().map(|e| e.color(direction.as_vec3()));
                seen.unwrap_or(LinearRgb::BLACK)
            }
        }
    }

    /// The colour where it is the same everywhere.
    pub(crate) fn even(&self) -> Option<LinearRgb> {
        match self.background {
            Background::Color(color) => Some(color),
            _ => None,
        }
    }

    /// Whether pixels without anything are transparent.
    pub(crate) fn is_transparent(&self) -> bool {
        self.background == Background::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_run_by_row_and_by_direction() {
        let (bottom, top) = (LinearRgb::BLACK, LinearRgb::WHITE);
        let scene = Scene::default();
        let sky = Sky::new(&scene, Background::Gradient { bottom, top }, 11);
        assert_eq!(sky.in_row(0, DVec3::X), Some(top));
        assert_eq!(sky.in_row(10, DVec3::X), Some(bottom));
        assert_eq!(sky.in_row(5, DVec3::X), Some(LinearRgb::splat(0.5)));
        assert_eq!(sky.towards(DVec3::Y), top);
        assert_eq!(sky.towards(DVec3::NEG_Y), bottom);
        assert_eq!(Sky::new(&scene, Background::None, 11).in_row(3, DVec3::X), None);
        assert_eq!(Sky::new(&scene, Background::None, 0).towards(DVec3::X), LinearRgb::BLACK);
    }
}
