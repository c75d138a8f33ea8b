//! Primary rays: from the eye through places of the picture.

use senca_math::glam::{DMat4, DVec3, DVec4};
use senca_math::{View, ViewKind};
use senca_scene::Lens;

use crate::{Ray, SamplePlace};

/// Dimension of the sampler from which a place on the lens is taken.
const LENS_DIMENSION: u32 = 1;

/// Makes the rays through the places of one picture.
///
/// Rays of a central view start in the eye; near and far planes do not cut the scene. Rays of a
/// parallel view start on the near plane. Directions have unit length.
#[derive(Clone, Copy, Debug)]
pub struct PrimaryRays {
    /// Place of the picture in pixels, y down, to homogeneous world coordinates on the near plane.
    world_from_pixel: DMat4,
    kind: ViewKind,
    lens: Option<OpenLens>,
}

/// A lens in the world.
#[derive(Clone, Copy, Debug)]
struct OpenLens {
    /// Half its opening, to the right and up.
    right: DVec3,
    up: DVec3,
    /// Unit vector along the line of sight.
    forward: DVec3,
    focus_distance: f64,
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
        Self { world_from_pixel: view.world_from_clip * clip_from_pixel, kind: view.kind, lens: None }
    }

    /// The same through a lens, for [`PrimaryRays::sample`]: what is at its focus distance is sharp. A
    /// parallel view has no eye to put a lens to and stays as it is.
    #[must_use]
    pub fn with_lens(mut self, view: &View, lens: Option<Lens>) -> Self {
        let world_from_view = view.view_from_world.inverse();
        let axis = |v: DVec3| world_from_view.transform_vector3(v).normalize_or_zero();
        self.lens = lens.filter(|_| matches!(self.kind, ViewKind::Central { .. })).map(|lens| OpenLens {
            right: lens.radius * axis(DVec3::X),
            up: lens.radius * axis(DVec3::Y),
            forward: axis(DVec3::NEG_Z),
            focus_distance: lens.focus_distance,
        });
        self
    }

    /// Whether rays go through a lens that is open.
    pub(crate) fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// From places of the picture in pixels to homogeneous places of the world on the near plane.
    pub(crate) fn world_from_pixel(&self) -> &DMat4 {
        &self.world_from_pixel
    }

    /// The ray of a sample: with a lens, from a random place on it.
    #[must_use]
    #[inline]
    pub fn sample(&self, place: &SamplePlace) -> Ray {
        let ray = self.through(place.x, place.y);
        match &self.lens {
            Some(lens) => lens.bent(&ray, place),
            None => ray,
        }
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

impl OpenLens {
    /// From a place on the lens to where the ray through its middle meets the sharp plane.
    fn bent(&self, ray: &Ray, place: &SamplePlace) -> Ray {
        let mut sampler = place.sampler;
        sampler.set_dimension(LENS_DIMENSION);
        let [u, v] = sampler.next_2d();
        let (radius, angle) = (u.sqrt(), std::f64::consts::TAU * v);
        let origin = ray.origin + radius * (angle.cos() * self.right + angle.sin() * self.up);
        let sharp = ray.at(self.focus_distance / ray.direction.dot(self.forward));
        Ray::new(origin, towards(origin, sharp))
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
    fn rays_through_a_lens_meet_in_the_sharp_plane() {
        let frame = senca_math::world_from_look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y).expect("a frame");
        let view = View::perspective(&frame, 0.7, 1.5, 0.1, None).expect("a view");
        let lens = Lens { radius: 0.5, focus_distance: 4.0 };
        let rays = PrimaryRays::new(&view, 30, 20).with_lens(&view, Some(lens));
        let sharp = |ray: &Ray| ray.at((1.0 - ray.origin.z) / ray.direction.z);
        let place = |i| SamplePlace {
            x: 7.5,
            y: 3.0,
            row: 3,
            sampler: crate::Sampler::new(crate::Pattern::Sobol, 0, 7, 3, i),
        };
        let middle = sharp(&rays.through(7.5, 3.0));
        for i in 0..64 {
            let ray = rays.sample(&place(i));
            assert!((sharp(&ray) - middle).length() < 1e-12);
            assert!(ray.origin.distance(DVec3::Z * 5.0) <= 0.5);
        }
        let mean = (0..64).map(|i| rays.sample(&place(i)).origin).sum::<DVec3>() / 64.0;
        assert!(mean.distance(DVec3::Z * 5.0) < 0.05, "all of the lens is used: {mean}");
    }

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
