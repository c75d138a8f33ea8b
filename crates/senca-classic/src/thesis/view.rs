//! From the world to the device.
//!
//! The scene file gives a window around VRP, the centre of projection on the line through VRP along
//! VPN, and one plane. The program takes F = 0 and B = that plane, and depth is nearer the larger it
//! is, which comes out right only because the sample scene has B on the viewer's side. Here the nearer
//! plane is the front one whichever it is. As nothing is clipped at F and B unless that is wanted, the
//! two are moved apart until all vertices before the eye lie between them, so that all are sorted.
//!
//! Device x runs from 0 to the width less one, y down from 0 to the height less one, and depth over
//! all integers of the machine's width, largest in front. Source: 1991 thesis, section 2.4 and
//! program; text and listing differ in what [`DeviceView::as_printed`] says.

use senca_io::classic::{ClassicProjection, ClassicScene, IntegerWidth};
use senca_math::device::device_from_box_1991;
use senca_math::glam::{DMat4, DVec3, DVec4};
use senca_math::{Normalization1991, View1991, ViewError, ViewKind, ViewParameters, ViewWindow};

/// Vertices nearer to the eye than this share of its distance from VRP are cut off.
const NEAREST: f64 = 1e-3;

/// How much farther than the farthest vertex the back plane is put, as a share of the range.
const MARGIN: f64 = 1e-3;

/// The way from world to device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceView {
    /// World to the normalised volume: x and y in [-w, w], z from 0 in front to -w at the back.
    pub normalized_from_world: DMat4,
    /// Normalised to device coordinates.
    pub device_from_normalized: DMat4,
    /// Central or parallel, and from where.
    pub kind: ViewKind,
}

impl DeviceView {
    /// The view of a scene on a raster, with depth for integers of `width`. `extent` are the least
    /// and the greatest distance of vertices from VRP along VPN, between which the planes F and B of
    /// the file are moved; `None` leaves them.
    ///
    /// # Errors
    /// [`ViewError`] for planes behind the eye, and for numbers that give no view.
    pub fn new(
        scene: &ClassicScene,
        extent: Option<(f64, f64)>,
        width: IntegerWidth,
    ) -> Result<Self, ViewError> {
        let (front, back) = planes(scene, extent);
        let view = View1991 { parameters: parameters(scene, front, back), normalization: form(scene) };
        let (w, h) = (f64::from(scene.raster_width()), f64::from(scene.raster_height));
        let (least, greatest) = depth_range(width);
        // The box's depth runs from -1 to 0, so its z = 1 would come one range beyond the greatest.
        let (near, beyond) = (f64::from(greatest), 2.0 * f64::from(greatest) - (f64::from(least) + 1.0));
        let device = device_from_box_1991(DVec3::new(0.0, h - 1.0, near), DVec3::new(w - 1.0, 0.0, beyond));
        Ok(Self {
            normalized_from_world: view.steps()?.product(),
            device_from_normalized: device,
            kind: kind(scene),
        })
    }

    /// The view of the listing. Its clip matrix began as the identity, so its last element is one too
    /// large; the depth of the viewport overflows, which puts B at 0 and F at the least integer; and
    /// the sides of the viewport are exchanged, which only shows when they differ.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn as_printed(scene: &ClassicScene, width: IntegerWidth) -> Result<Self, ViewError> {
        let parameters = parameters(scene, 0.0, scene.view_plane_distance);
        let mut normalized = View1991 { parameters, normalization: form(scene) }.steps()?.product();
        if scene.projection == ClassicProjection::Perspective {
            normalized.w_axis.w += 1.0;
        }
        let (h, w) = (f64::from(scene.raster_width()), f64::from(scene.raster_height));
        let least = f64::from(depth_range(width).0);
        let corners = [DVec3::new(0.0, h - 1.0, least), DVec3::new(w - 1.0, 0.0, 2.0 * least)];
        Ok(Self {
            normalized_from_world: normalized,
            device_from_normalized: device_from_box_1991(corners[0], corners[1]),
            kind: kind(scene),
        })
    }

    /// Normalised homogeneous coordinates of a world point.
    #[must_use]
    pub fn normalized(&self, world: DVec3) -> DVec4 {
        self.normalized_from_world * world.extend(1.0)
    }

    /// Device coordinates of a normalised point, divided by w, which becomes 1, unless it is 0.
    #[must_use]
    pub fn screen(&self, normalized: DVec4) -> DVec4 {
        let device = self.device_from_normalized * normalized;
        if device.w == 0.0 || device.w == 1.0 { device } else { (device / device.w).with_w(1.0) }
    }
}

/// Least and greatest integer.
pub(super) fn depth_range(width: IntegerWidth) -> (i32, i32) {
    match width {
        IntegerWidth::Bits16 => (i16::MIN.into(), i16::MAX.into()),
        IntegerWidth::Bits32 => (i32::MIN, i32::MAX),
    }
}

/// Front and back plane.
fn planes(scene: &ClassicScene, extent: Option<(f64, f64)>) -> (f64, f64) {
    let plane = scene.view_plane_distance;
    let (mut front, mut back) = (plane.max(0.0), plane.min(0.0));
    if let Some((least, greatest)) = extent {
        let margin = MARGIN * (greatest.max(front) - least.min(back));
        (front, back) = (front.max(greatest + margin), back.min(least - margin));
    }
    if scene.projection == ClassicProjection::Perspective {
        let nearest = scene.projection_distance * (1.0 - NEAREST);
        front = front.min(nearest);
    }
    if front <= back && extent.is_some() {
        back = front - scene.projection_distance.abs().max(1.0);
    }
    (front, back)
}

fn parameters(scene: &ClassicScene, front: f64, back: f64) -> ViewParameters {
    let distance = match scene.projection {
        ClassicProjection::Perspective => scene.projection_distance,
        // The direction is VPN's whatever the file says.
        ClassicProjection::Parallel => 1.0,
    };
    ViewParameters {
        vrp: scene.vrp,
        vpn: scene.vpn,
        vup: scene.vup,
        prp: DVec3::new(0.0, 0.0, distance),
        window: ViewWindow::centered(scene.window[0], scene.window[1]),
        front,
        back,
    }
}

fn form(scene: &ClassicScene) -> Normalization1991 {
    match scene.projection {
        ClassicProjection::Perspective => Normalization1991::Perspective,
        ClassicProjection::Parallel => Normalization1991::Parallel,
    }
}

fn kind(scene: &ClassicScene) -> ViewKind {
    let towards = scene.vpn.normalize_or_zero();
    match scene.projection {
        ClassicProjection::Perspective => {
            ViewKind::Central { eye_world: scene.vrp + towards * scene.projection_distance }
        }
        ClassicProjection::Parallel => ViewKind::Parallel { direction_world: -towards },
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::sample;
    use super::*;

    fn at(view: &DeviceView, x: f64, y: f64, z: f64) -> DVec4 {
        view.screen(view.normalized(DVec3::new(x, y, z)))
    }

    #[test]
    fn the_listing_gives_its_screen_points() {
        let view = DeviceView::as_printed(&sample("house.dat"), IntegerWidth::Bits32).expect("a view");
        let m = view.device_from_normalized * view.normalized_from_world;
        assert!(m.row(0).abs_diff_eq(DVec4::new(130.375, 0.0, -7.45, 400.4375), 1e-9));
        assert!(m.row(1).abs_diff_eq(DVec4::new(0.0, -130.375, -7.45, 856.75), 1e-9));
        assert!(m.row(3).abs_diff_eq(DVec4::new(0.0, 0.0, -0.1, 8.0), 1e-12));
        let near = at(&view, 0.0, 0.0, 54.0);
        assert!((near.x + 0.7164).abs() < 1e-4 && (near.y - 174.7885).abs() < 1e-4);
        let far = at(&view, 0.0, 0.0, 30.0);
        assert!((far.x - 35.3875).abs() < 1e-9 && (far.y - 126.65).abs() < 1e-9);
        // F, at VRP, comes to the least integer; what is nearer is larger.
        assert_eq!(at(&view, 1.5, 2.0, 0.0).z, f64::from(i32::MIN));
        assert!(near.z > far.z);
    }

    #[test]
    fn the_text_puts_the_windows_edge_on_the_rasters() {
        let scene = sample("house.dat");
        for extent in [None, Some((-4.0, 58.0)), Some((0.0, 90.0))] {
            let view = DeviceView::new(&scene, extent, IntegerWidth::Bits16).expect("a view");
            let corner = at(&view, 5.5, 6.0, 0.0);
            assert!((corner.x - 149.0).abs() < 1e-9 && corner.y.abs() < 1e-9);
            let corner = at(&view, -2.5, -2.0, 0.0);
            assert!(corner.x.abs() < 1e-9 && (corner.y - 149.0).abs() < 1e-9);
            assert!(at(&view, 1.5, 2.0, 54.0).z > at(&view, 1.5, 2.0, 30.0).z);
        }
        let view = DeviceView::new(&scene, None, IntegerWidth::Bits16).expect("a view");
        assert!((at(&view, 1.5, 2.0, 60.0).z - f64::from(i16::MAX)).abs() < 1e-6);
        assert!((at(&view, 1.5, 2.0, 0.0).z - f64::from(i16::MIN + 1)).abs() < 1e-6);
    }

    #[test]
    fn depth_grows_towards_the_viewer_on_whichever_side_the_plane_is() {
        for plane in [60.0, -60.0] {
            for projection in [ClassicProjection::Parallel, ClassicProjection::Perspective] {
                let scene = ClassicScene { view_plane_distance: plane, projection, ..sample("house.dat") };
                let view = DeviceView::new(&scene, Some((-3.0, 5.0)), IntegerWidth::Bits32).expect("a view");
                assert!(at(&view, 0.0, 0.0, 5.0).z > at(&view, 0.0, 0.0, -3.0).z);
            }
        }
    }

    #[test]
    fn a_parallel_view_gives_the_worked_pixel() {
        let scene = ClassicScene {
            projection: ClassicProjection::Parallel,
            vrp: DVec3::new(1.5, 3.0, 0.0),
            ..sample("patch.dat")
        };
        let text = DeviceView::new(&scene, Some((0.0, 3.0)), IntegerWidth::Bits32).expect("a view");
        let listing = DeviceView::as_printed(&scene, IntegerWidth::Bits32).expect("a view");
        for view in [text, listing] {
            let middle = at(&view, 1.5, 3.0, 1.6875);
            assert!((middle.x - 74.5).abs() < 1e-9 && (middle.y - 74.5).abs() < 1e-9);
            assert!((at(&view, 2.5, 3.0, 1.6875).x - middle.x - 18.625).abs() < 1e-9);
        }
    }

    #[test]
    fn the_listing_exchanges_the_viewports_sides() {
        let scene = ClassicScene { window: [16.0, 8.0], ..sample("house.dat") };
        assert_eq!(scene.raster_width(), 300);
        let text = DeviceView::new(&scene, None, IntegerWidth::Bits32).expect("a view");
        assert!((at(&text, 9.5, 2.0, 0.0).x - 299.0).abs() < 1e-9);
        let listing = DeviceView::as_printed(&scene, IntegerWidth::Bits32).expect("a view");
        assert!((at(&listing, 9.5, 2.0, 0.0).x - 149.0 * 1.875 / 2.0).abs() < 1e-9);
    }

    #[test]
    fn planes_without_a_volume_are_errors_of_the_listing_only() {
        let scene = ClassicScene { view_plane_distance: 0.0, ..sample("house.dat") };
        assert!(DeviceView::as_printed(&scene, IntegerWidth::Bits32).is_err());
        assert!(DeviceView::new(&scene, Some((30.0, 58.0)), IntegerWidth::Bits32).is_ok());
        assert!(DeviceView::new(&scene, Some((0.0, 0.0)), IntegerWidth::Bits32).is_ok());
        assert!(DeviceView::new(&scene, Some((90.0, 99.0)), IntegerWidth::Bits32).is_ok());
    }
}
