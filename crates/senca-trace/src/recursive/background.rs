//! What rays see that leave the scene.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_scene::Background;

/// What is seen where nothing is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky {
    background: Background,
    last_row: u32,
}

impl Sky {
    /// Of a picture of `height` rows.
    pub(crate) fn new(background: Background, height: u32) -> Self {
        Self { background, last_row: height.saturating_sub(1).max(1) }
    }

    /// Colour in a row of the picture; `None` where the picture is transparent.
    #[inline]
    pub(crate) fn in_row(&self, row: u32) -> Option<LinearRgb> {
        match self.background {
            Background::None => None,
            Background::Color(color) => Some(color),
            Background::Gradient { bottom, top } => Some(top.lerp(bottom, row as f32 / self.last_row as f32)),
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
        let sky = Sky::new(Background::Gradient { bottom, top }, 11);
        assert_eq!(sky.in_row(0), Some(top));
        assert_eq!(sky.in_row(10), Some(bottom));
        assert_eq!(sky.in_row(5), Some(LinearRgb::splat(0.5)));
        assert_eq!(sky.towards(DVec3::Y), top);
        assert_eq!(sky.towards(DVec3::NEG_Y), bottom);
        assert_eq!(Sky::new(Background::None, 11).in_row(3), None);
        assert_eq!(Sky::new(Background::None, 0).towards(DVec3::X), LinearRgb::BLACK);
    }
}
