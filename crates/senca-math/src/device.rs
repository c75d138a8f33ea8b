//! The last step: from the normalised volume to the device, and all the way back.
//!
//! The step is separate from the projection because it is cheap and often repeated: for several
//! devices, for a cut-out, to fit everything into the picture. z passes through unchanged.
//!
//! Pixel convention: pixel `(x, y)` covers `[x, x + 1) x [y, y + 1)` with its centre in the middle,
//! row 0 on top; [`DeviceMap::to_pixels`] makes the map for a whole picture. The course text instead
//! lays the volume's sides onto the centres of the outermost pixels; that is the viewport
//! `(0, 0, width - 1, height - 1)`.
//!
//! Source: course text, sections 1.8 and 1.9; 1991 thesis, section 2.4.4.4.

use glam::{DMat4, DVec2, DVec3};

use crate::conventions::PIXEL_CENTER;
use crate::frame::unit;
use crate::projective::normalized;
use crate::ray::Ray;
use crate::view::View;

/// A rectangle by two opposite corners. As a viewport it may run backwards, for a device whose y
/// points down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left and lower limit.
    pub min: DVec2,
    /// Right and upper limit.
    pub max: DVec2,
}

/// Why a rectangle is no window or viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A limit is NaN or infinite.
    #[error("a limit of the {0} is not a finite number")]
    NotFinite(&'static str),
    /// The window has no width or no height, or its limits are exchanged.
    #[error("the window is empty: each minimum must be below its maximum")]
    EmptyWindow,
    /// The viewport has no width or no height.
    #[error("the viewport has no area: a picture needs at least one pixel each way")]
    EmptyViewport,
}

impl Rect {
    /// The whole of the normalised volume: -1 to 1 both ways.
    pub const NORMALIZED: Self = Self { min: DVec2::NEG_ONE, max: DVec2::ONE };

    /// From limits in the order of the text: xmin, ymin, xmax, ymax.
    #[must_use]
    pub const fn new(xmin: f64, ymin: f64, xmax: f64, ymax: f64) -> Self {
        Self { min: DVec2::new(xmin, ymin), max: DVec2::new(xmax, ymax) }
    }

    /// The smallest rectangle around the x and y of all points, to be used as the window that fits
    /// all. Points that are not finite are passed over; `None` when no point is left.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        let finite = points.into_iter().map(DVec3::truncate).filter(|p| p.is_finite());
        let (min, max) =
            finite.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        (min.x <= max.x).then_some(Self { min, max })
    }

    /// Width and height; negative where the rectangle runs backwards.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    /// Centre.
    #[must_use]
    pub fn center(&self) -> DVec2 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The rectangle scaled about its centre; with a factor above 1 it leaves a margin.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.with_size(self.size() * factor)
    }

    /// The smallest rectangle about the same centre that holds this one and whose width is `aspect`
    /// times its height, so that a picture of that shape is not distorted. A rectangle of no area
    /// grows to one as wide as `1e-6`.
    #[must_use]
    pub fn grown_to_aspect(&self, aspect: f64) -> Self {
        let size = self.size().abs();
        let width = size.x.max(size.y * aspect).max(1e-6);
        self.with_size(DVec2::new(width, width / aspect))
    }

    /// Upper and lower limit exchanged: the map to a device whose rows run down.
    #[must_use]
    pub fn flipped_y(&self) -> Self {
        Self::new(self.min.x, self.max.y, self.max.x, self.min.y)
    }

    fn with_size(&self, size: DVec2) -> Self {
        Self { min: self.center() - 0.5 * size, max: self.center() + 0.5 * size }
    }

    fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }
}

/// The map from a window in the normalised volume to a viewport on the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceMap {
    window: Rect,
    viewport: Rect,
}

impl DeviceMap {
    /// A map from its two rectangles. The viewport may run backwards.
    ///
    /// # Errors
    /// Limits that are not finite, a window that is empty, a viewport without area.
    pub fn new(window: Rect, viewport: Rect) -> Result<Self, DeviceError> {
        for (name, rect) in [("window", window), ("viewport", viewport)] {
            if !rect.is_finite() || !rect.size().is_finite() {
                return Err(DeviceError::NotFinite(name));
            }
        }
        if window.size().min_element() <= 0.0 {
            return Err(DeviceError::EmptyWindow);
        }
        if viewport.size().abs().min_element() == 0.0 {
            return Err(DeviceError::EmptyViewport);
        }
        Ok(Self { window, viewport })
    }

    /// The map of the whole normalised range onto a picture with row 0 on top.
    ///
    /// # Errors
    /// [`DeviceError::EmptyViewport`] when a side is 0.
    pub fn to_pixels(width: u32, height: u32) -> Result<Self, DeviceError> {
        let viewport = Rect::new(0.0, f64::from(height), f64::from(width), 0.0);
        Self::new(Rect::NORMALIZED, viewport)
    }

    /// The same device showing only this window: a zoom, a pan, a cut-out.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn cut_out(&self, window: Rect) -> Result<Self, DeviceError> {
        Self::new(window, self.viewport)
    }

    /// The same device with the y of the viewport reversed.
    #[must_use]
    pub fn flipped_y(&self) -> Self {
        Self { viewport: self.viewport.flipped_y(), ..*self }
    }

    /// The window in the normalised volume.
    #[must_use]
    pub fn window(&self) -> Rect {
        self.window
    }

    /// The viewport on the device.
    #[must_use]
    pub fn viewport(&self) -> Rect {
        self.viewport
    }

    /// Width over height of the viewport.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        let size = self.viewport.size().abs();
        size.x / size.y
    }

    /// Device coordinates of a normalised point.
    #[must_use]
    pub fn device_from_normalized(&self, normalized: DVec3) -> DVec3 {
        map(self.window, self.viewport, normalized)
    }

    /// Normalised coordinates of a device point.
    #[must_use]
    pub fn normalized_from_device(&self, device: DVec3) -> DVec3 {
        map(self.viewport, self.window, device)
    }

    /// The map as a matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat4 {
        let scale = self.viewport.size() / self.window.size();
        let offset = self.viewport.min - self.window.min * scale;
        DMat4::from_translation(offset.extend(0.0)) * DMat4::from_scale(scale.extend(1.0))
    }
}

fn map(from: Rect, to: Rect, point: DVec3) -> DVec3 {
    let xy = to.min + (point.truncate() - from.min) / from.size() * to.size();
    xy.extend(point.z)
}

/// Position of the centre of a pixel on the device.
#[must_use]
pub fn pixel_center(x: u32, y: u32) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y)) + f64::from(PIXEL_CENTER)
}

/// The device matrix of the 1991 text: the box x and y in [-1, 1], z in [0, 1] to the corners `min`
/// and `max`, by moving the box's corner to the origin first, as its program does.
#[must_use]
pub fn device_from_box_1991(min: DVec3, max: DVec3) -> DMat4 {
    let scale = (max - min) * DVec3::new(0.5, 0.5, 1.0);
    DMat4::from_translation(min)
        * DMat4::from_scale(scale)
        * DMat4::from_translation(DVec3::new(1.0, 1.0, 0.0))
}

impl View {
    /// Where a world point comes to lie on the device, with its window depth; `None` when it does not
    /// lie before the eye. Points outside the picture or its depth range are not cut off.
    #[must_use]
    pub fn device_from_world(&self, device: &DeviceMap, point_world: DVec3) -> Option<DVec3> {
        let clip = self.clip_from_world * point_world.extend(1.0);
        if clip.w.is_nan() || clip.w <= 0.0 {
            return None;
        }
        Some(device.device_from_normalized(normalized(clip).finite()?))
    }

    /// The window that fits all these world points into the picture: the rectangle around their
    /// projections in the normalised volume. Points not before the eye are passed over; `None` when
    /// no point is left. Source: course text, section 1.8.
    #[must_use]
    pub fn window_around(&self, points_world: impl IntoIterator<Item = DVec3>) -> Option<Rect> {
        let clip = points_world.into_iter().map(|p| self.clip_from_world * p.extend(1.0));
        Rect::around(clip.filter(|c| c.w > 0.0).filter_map(|c| normalized(c).finite()))
    }

    /// The world point that lies at this place of the device and at this window depth (0 near, 1
    /// far); `None` for a point at infinity. Source: course text, section 1.9.
    #[must_use]
    pub fn world_from_device(&self, device: &DeviceMap, point_device: DVec3) -> Option<DVec3> {
        let clip = device.normalized_from_device(point_device).extend(1.0);
        normalized(self.world_from_clip * clip).finite()
    }

    /// The projector through a place of the device, from the near plane on into the scene, with a
    /// unit direction. `None` only for coordinates too large to be one.
    #[must_use]
    pub fn ray_through(&self, device: &DeviceMap, place: DVec2) -> Option<Ray> {
        let xy = device.normalized_from_device(place.extend(0.0)).truncate();
        let near = self.world_from_clip * xy.extend(0.0).extend(1.0);
        let far = self.world_from_clip * xy.extend(1.0).extend(1.0);
        // The difference of the two points without dividing: the far one may lie at infinity.
        let direction = unit(far.truncate() * near.w - near.truncate() * far.w)?;
        Some(Ray { origin: normalized(near).finite()?, direction })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::test_support::{assert_close3, vec3};
    use crate::transform::compose;
    use crate::view::{ViewParameters, ViewWindow};

    fn text_screen() -> DeviceMap {
        DeviceMap::new(Rect::NORMALIZED, Rect::new(0.0, 0.0, 639.0, 479.0)).unwrap()
    }

    #[test]
    fn the_map_gives_the_worked_points() {
        let map = text_screen();
        let pairs = [
            ([-1.0, -1.0, -1.0], [0.0, 0.0, -1.0]),
            ([1.0, 1.0, 0.0], [639.0, 479.0, 0.0]),
            ([0.0, 0.0, -0.5], [319.5, 239.5, -0.5]),
            ([0.5, -0.5, -0.25], [479.25, 119.75, -0.25]),
        ];
        for (from, to) in pairs {
            assert_eq!(map.device_from_normalized(from.into()), to.into());
            assert_close3(map.normalized_from_device(to.into()), from.into(), 1e-15);
            assert_close3(map.matrix().transform_point3(from.into()), to.into(), 1e-12);
        }
        let part =
            DeviceMap::new(Rect::new(-0.5, 0.0, 0.5, 0.5), Rect::new(100.0, 50.0, 300.0, 250.0)).unwrap();
        let got = part.device_from_normalized(DVec3::new(0.0, 0.25, -0.3));
        assert_eq!(got, DVec3::new(200.0, 150.0, -0.3));
    }

    #[test]
    fn the_round_trip_through_the_books_canonical_volume_holds() {
        let p = ViewParameters {
            vrp: DVec3::ZERO,
            vpn: DVec3::Z,
            vup: DVec3::Y,
            prp: vec3(0, 0, 5),
            window: ViewWindow::new(-1.0, 1.0, -1.0, 1.0),
            front: 1.0,
            back: -5.0,
        };
        let steps = p.central_steps().unwrap();
        let h = steps.product() * DVec3::new(0.3, -0.4, -2.0).extend(1.0);
        assert!(h.abs_diff_eq(glam::DVec4::new(0.15, -0.2, -0.5, 0.7), 1e-15));
        let device = text_screen().device_from_normalized(normalized(h).finite().unwrap());
        assert_close3(device, DVec3::new(387.964286, 171.071429, -0.714286), 1e-6);
        let back = steps.inverse() * text_screen().normalized_from_device(device).extend(1.0);
        assert!(back.abs_diff_eq(glam::DVec4::new(0.428571, -0.571429, -2.857143, 1.428571), 1e-6));
        assert_close3(normalized(back).finite().unwrap(), DVec3::new(0.3, -0.4, -2.0), 1e-12);

        let view = p.central_view().unwrap();
        let seen = view.device_from_world(&text_screen(), DVec3::new(0.3, -0.4, -2.0)).unwrap();
        assert_close3(seen, DVec3::new(387.964286, 171.071429, 0.714286), 1e-6);
        assert_close3(
            view.world_from_device(&text_screen(), seen).unwrap(),
            DVec3::new(0.3, -0.4, -2.0),
            1e-12,
        );
        assert!(view.device_from_world(&text_screen(), vec3(0, 0, 6)).is_none());
    }

    #[test]
    fn the_1991_device_matrix_gives_the_worked_screen_points() {
        // The program's matrix of the sample view, which has 1 in the last place of the clip matrix.
        let program = DMat4::from_cols_array_2d(&[
            [1.75, 0.0, 0.0, -2.625],
            [0.0, 1.75, 0.0, -3.5],
            [0.0, 0.0, -1.0 / 60.0, 0.0],
            [0.0, 0.0, -0.1, 8.0],
        ])
        .transpose();
        let m = compose([program, device_from_box_1991(vec3(0, 149, -1), vec3(149, 0, 0))]);
        let close = |row: usize, expected: [f64; 4]| m.row(row).abs_diff_eq(expected.into(), 1e-9);
        assert!(close(0, [130.375, 0.0, -7.45, 400.4375]) && close(1, [0.0, -130.375, -7.45, 856.75]));
        let screen = |z: f64| m.project_point3(DVec3::new(0.0, 0.0, z)).truncate();
        assert!((screen(54.0) - DVec2::new(-0.7164, 174.7885)).length() < 1e-4);
        assert!((screen(30.0) - DVec2::new(35.3875, 126.65)).length() < 1e-9);
    }

    #[test]
    fn a_parallel_view_of_1991_gives_the_worked_pixel() {
        let p = ViewParameters {
            vrp: DVec3::new(1.5, 3.0, 0.0),
            vpn: DVec3::Z,
            vup: DVec3::Y,
            prp: vec3(0, 0, 70),
            window: ViewWindow::centered(8.0, 8.0),
            front: 10.0,
            back: -10.0,
        };
        let screen = DeviceMap::new(Rect::NORMALIZED, Rect::new(0.0, 0.0, 149.0, 149.0)).unwrap();
        let view = p.parallel_view().unwrap();
        let at = |x: f64| view.device_from_world(&screen, DVec3::new(x, 3.0, 1.6875)).unwrap();
        assert!((at(1.5).truncate() - DVec2::splat(74.5)).length() < 1e-12);
        assert!((at(2.5).x - at(1.5).x - 18.625).abs() < 1e-12);
    }

    #[test]
    fn pixels_run_down_from_the_top() {
        let map = DeviceMap::to_pixels(4, 2).unwrap();
        assert_eq!(map.device_from_normalized(DVec3::new(-1.0, 1.0, 0.5)), DVec3::new(0.0, 0.0, 0.5));
        assert_eq!(map.device_from_normalized(DVec3::new(1.0, -1.0, 0.5)), DVec3::new(4.0, 2.0, 0.5));
        assert_eq!(pixel_center(3, 1), DVec2::new(3.5, 1.5));
        assert_eq!(map.flipped_y().device_from_normalized(DVec3::ONE), DVec3::new(4.0, 2.0, 1.0));
        assert_eq!(map.aspect(), 2.0);
    }

    #[test]
    fn fitting_all_keeps_the_shape() {
        let points = [vec3(0, 0, 0), vec3(4, 1, 0), DVec3::NAN];
        let window = Rect::around(points).unwrap();
        assert_eq!(window, Rect::new(0.0, 0.0, 4.0, 1.0));
        assert_eq!(window.grown_to_aspect(2.0), Rect::new(0.0, -0.5, 4.0, 1.5));
        assert_eq!(window.scaled(2.0), Rect::new(-2.0, -0.5, 6.0, 1.5));
        assert!(Rect::around([DVec3::NAN]).is_none());
        let single = Rect::around([vec3(1, 1, 1)]).unwrap().grown_to_aspect(1.0);
        let fitted = DeviceMap::to_pixels(8, 8).unwrap().cut_out(single).unwrap();
        assert_close3(fitted.device_from_normalized(vec3(1, 1, 0)), vec3(4, 4, 0), 1e-6);
    }

    #[test]
    fn a_window_around_projected_points_fits_them_all() {
        let frame = View::look_at(vec3(0, 0, 10), DVec3::ZERO, DVec3::Y).unwrap();
        let view = View::perspective(&frame, 1.0, 1.0, 0.1, None).unwrap();
        let points = [vec3(1, 2, 0), vec3(-1, 5, 3), vec3(4, 0, -9), vec3(0, 0, 20)];
        let window = view.window_around(points).unwrap();
        let device = DeviceMap::to_pixels(100, 50).unwrap().cut_out(window).unwrap();
        let seen = Rect::around(points.iter().filter_map(|p| view.device_from_world(&device, *p))).unwrap();
        assert!((seen.min.length() + (seen.max - DVec2::new(100.0, 50.0)).length()) < 1e-12);
        assert!(view.window_around([vec3(0, 0, 20)]).is_none());
    }

    #[test]
    fn rectangles_without_area_are_refused() {
        let unit = Rect::NORMALIZED;
        let flat = Rect::new(0.0, 0.0, 1.0, 0.0);
        assert_eq!(DeviceMap::new(flat, unit), Err(DeviceError::EmptyWindow));
        assert_eq!(DeviceMap::new(unit.flipped_y(), unit), Err(DeviceError::EmptyWindow));
        assert_eq!(DeviceMap::new(unit, flat), Err(DeviceError::EmptyViewport));
        assert_eq!(DeviceMap::to_pixels(0, 5), Err(DeviceError::EmptyViewport));
        let nan = Rect::new(f64::NAN, 0.0, 1.0, 1.0);
        assert_eq!(DeviceMap::new(nan, unit), Err(DeviceError::NotFinite("window")));
    }

    proptest! {
        #[test]
        fn pixels_unproject_onto_their_ray(
            eye in prop::array::uniform3(-9.0..9.0f64),
            x in 0u32..64,
            y in 0u32..48,
            depth in 0.0..0.999f64,
            parallel in any::<bool>(),
            endless in any::<bool>(),
        ) {
            let Ok(frame) = View::look_at(eye.into(), vec3(20, 1, 2), DVec3::Y) else { return Ok(()) };
            let map = DeviceMap::to_pixels(64, 48).unwrap();
            let view = if parallel {
                View::orthographic(&frame, 5.0, map.aspect(), -2.0, 30.0).unwrap()
            } else {
                View::perspective(&frame, 0.9, map.aspect(), 0.1, (!endless).then_some(50.0)).unwrap()
            };
            let place = pixel_center(x, y);
            let ray = view.ray_through(&map, place).unwrap();
            let world = view.world_from_device(&map, place.extend(depth)).unwrap();
            let along = (world - ray.origin).dot(ray.direction);
            prop_assert!(along >= -1e-9);
            prop_assert!((ray.at(along) - world).length() < 1e-8 * (1.0 + along));
            let seen = view.device_from_world(&map, world).unwrap();
            prop_assert!((seen - place.extend(depth)).abs().max_element() < 1e-7);
            prop_assert!((view.kind.towards_viewer(world) + ray.direction).length() < 1e-9);
        }
    }
}
