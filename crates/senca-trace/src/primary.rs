//! Primary rays: from the eye through places of the picture.

use senca_math::glam::{DMat4, DVec3, DVec4};
use senca_math::{View, ViewKind};

use crate::Ray;

/// Makes the rays through the places of one picture.
///
/// Rays of a central view start in the eye; near and far planes do not cut the scene. Rays of a
/// parallel view start on the near plane. Directions have unit length.
#[derive(Clone, Copy, Debug)]
pub struct PrimaryRays {
    /// Place of the picture in pixels, y down, to homogeneous world coordinates on the near plane.
    world_from_pixel: DMat4,
    kind: ViewKind,
}

impl PrimaryRays {
    /// Rays of `view` in a picture of `width` x `height` pixels.
    #[must_use]
    pub fn new(view: &View, width: u32, height: u32) -> Self {
        let (w, h) = (f64::from(width.max(1)), f64::from(height.max(1)));
        let clip_from_pixel = DMat4::from_cols(
            DVec4::X * (2.0 / w),
            DVec4::Y * (-2.0 / h),
            DVec4::Z,
            DVec4::new(-1.0, 1.0, 0.0, 1.0),
        );
        Self { world_from_pixel: view.world_from_clip * clip_from_pixel, kind: view.kind }
    }

    /// The ray through (x, y), in pixels from the upper left corner of the picture; pixel centres
    /// are at +0.5. Places outside the picture are fine.
    #[must_use]
    pub fn through(&self, x: f64, y: f64) -> Ray {
        let p = self.world_from_pixel * DVec4::new(x, y, 0.0, 1.0);
        let near = p.truncate() / p.w;
        match self.kind {
            ViewKind::Central { eye_world } => Ray::new(eye_world, towards(eye_world, near)),
            ViewKind::Parallel { direction_world } => Ray::new(near, direction_world),
        }
    }
}

/// Unit vector from one point towards another.
fn towards(from: DVec3, to: DVec3) -> DVec3 {
    (to - from).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::{DeviceMap, pixel_center};

    #[test]
    fn rays_go_where_pixels_come_from() {
        let world_from_camera =
            senca_math::world_from_look_at(DVec3::new(3.0, 2.0, 5.0), DVec3::ZERO, DVec3::Y)
                .expect("a frame");
        let view = View::perspective(&world_from_camera, 0.7, 1.5, 0.1, Some(100.0)).expect("a view");
        let device = DeviceMap::to_pixels(30, 20).expect("a picture");
        let rays = PrimaryRays::new(&view, 30, 20);
        for (x, y) in [(0, 0), (29, 19), (7, 11)] {
            let place = pixel_center(x, y);
            let ray = rays.through(place.x, place.y);
            assert!((ray.direction.length() - 1.0).abs() < 1e-14);
            let seen = view.device_from_world(&device, ray.at(6.0)).expect("in front of the eye");
            assert!((seen.truncate() - place).length() < 1e-9, "{seen}");
        }
    }
}
