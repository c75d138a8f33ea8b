use std::f64::consts::FRAC_PI_2;

use senca_math::glam::DVec4;
use senca_math::{CentralByNormal, ParallelByNormal, ViewParameters};

use super::*;

fn camera(projection: Projection) -> Camera {
    Camera::new("", projection)
}

fn perspective(aspect: Option<f64>, near: Option<f64>, far: Option<f64>) -> Camera {
    camera(Projection::Perspective { yfov: FRAC_PI_2, aspect, near, far })
}

fn unit_box_at(z: f64) -> Aabb {
    Aabb { min: DVec3::new(-1.0, -1.0, z - 1.0), max: DVec3::new(1.0, 1.0, z + 1.0) }
}

fn seen(view: &View, x: f64, y: f64, z: f64) -> DVec3 {
    let clip = view.clip_from_world * DVec4::new(x, y, z, 1.0);
    clip.truncate() / clip.w
}

#[test]
fn open_planes_are_put_around_the_scene() {
    let view = perspective(None, None, None).view(&DMat4::IDENTITY, 1.0, &unit_box_at(-10.0)).unwrap();
    let (front, back) = (seen(&view, 0.0, 0.0, -9.0).z, seen(&view, 0.0, 0.0, -11.0).z);
    assert!((0.0..0.02).contains(&front) && (0.98..1.0).contains(&back), "{front} {back}");
    // Inside the scene, behind it, and without one.
    for bounds in [unit_box_at(0.0), unit_box_at(50.0), Aabb::EMPTY] {
        assert!(perspective(None, None, None).view(&DMat4::IDENTITY, 1.0, &bounds).is_ok());
        assert!(perspective(None, Some(5.0), None).view(&DMat4::IDENTITY, 1.0, &bounds).is_ok());
        assert!(perspective(None, None, Some(1e-3)).view(&DMat4::IDENTITY, 1.0, &bounds).is_ok());
        let flat = Projection::Orthographic { height: 2.0, aspect: None, near: None, far: None };
        assert!(camera(flat).view(&DMat4::IDENTITY, 1.0, &bounds).is_ok());
    }
    assert!(perspective(None, Some(5.0), Some(4.0)).view(&DMat4::IDENTITY, 1.0, &Aabb::EMPTY).is_err());
}

#[test]
fn what_lies_flat_across_the_line_of_sight_is_before_the_far_plane() {
    let wall = Aabb { min: DVec3::new(-2.0, -1.0, -5.4), max: DVec3::new(2.0, 1.0, -5.4) };
    for near in [None, Some(0.1), Some(1e-3)] {
        let view = perspective(None, near, None).view(&DMat4::IDENTITY, 1.0, &wall).unwrap();
        let depth = seen(&view, 0.0, 0.0, -5.4).z as f32;
        assert!(depth < 1.0, "{near:?}: {depth}");
    }
}

#[test]
fn a_camera_with_an_aspect_keeps_its_window_in_sight() {
    let bounds = unit_box_at(-5.0);
    let corner = |picture: f64| {
        let view = perspective(Some(2.0), Some(1.0), Some(9.0)).view(&DMat4::IDENTITY, picture, &bounds);
        seen(&view.unwrap(), 2.0, 1.0, -1.0)
    };
    assert!((corner(2.0).truncate() - senca_math::glam::DVec2::ONE).length() < 1e-12);
    assert!((corner(4.0).x - 0.5).abs() < 1e-12 && (corner(4.0).y - 1.0).abs() < 1e-12);
    assert!((corner(1.0).x - 1.0).abs() < 1e-12 && (corner(1.0).y - 0.5).abs() < 1e-12);
    assert_eq!(perspective(Some(2.0), None, None).natural_aspect(), Some(2.0));
}

/// The central view of the course text's section 1.6 with round numbers.
fn operation_b() -> ViewParameters {
    ViewParameters {
        vrp: DVec3::ZERO,
        vpn: DVec3::Z,
        vup: DVec3::Y,
        prp: DVec3::Z * 5.0,
        window: ViewWindow::new(-1.0, 1.0, -1.0, 1.0),
        front: 1.0,
        back: -5.0,
    }
}

#[test]
fn operations_b_and_c_are_cameras_that_nodes_can_move() {
    let b = camera(Projection::Operation(ViewingOperation::Central(operation_b())));
    assert_eq!(b.natural_aspect(), Some(1.0));
    let view = b.view(&DMat4::IDENTITY, 1.0, &Aabb::EMPTY).unwrap();
    assert!((seen(&view, 2.0, 0.0, -5.0) - DVec3::new(1.0, 0.0, 1.0)).length() < 1e-12);
    assert!((seen(&view, 0.8, 0.8, 1.0) - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-12);
    let moved = DMat4::from_translation(DVec3::X * 7.0) * DMat4::from_rotation_y(FRAC_PI_2);
    let view = b.view(&moved, 1.0, &Aabb::EMPTY).unwrap();
    let p = moved.transform_point3(DVec3::new(2.0, 0.0, -5.0));
    assert!((seen(&view, p.x, p.y, p.z) - DVec3::new(1.0, 0.0, 1.0)).length() < 1e-12);
    let back = view.world_from_clip * DVec4::new(1.0, 0.0, 1.0, 1.0);
    assert!((back.truncate() / back.w - p).length() < 1e-9);
    let ViewKind::Central { eye_world } = view.kind else { panic!("B is central") };
    assert!((eye_world - DVec3::new(12.0, 0.0, 0.0)).length() < 1e-12);
    let c = camera(Projection::Operation(ViewingOperation::Parallel(operation_b())));
    let view = c.view(&moved, 1.0, &Aabb::EMPTY).unwrap();
    let ViewKind::Parallel { direction_world } = view.kind else { panic!("C is parallel") };
    assert!((direction_world + DVec3::X).length() < 1e-12);
}

#[test]
fn operations_without_a_volume_fit_the_scene() {
    let bounds = unit_box_at(-4.0);
    let a = CentralByNormal { center: DVec3::new(1.0, 2.0, 3.0), normal: DVec3::Z, focal: 2.0 };
    let p = ParallelByNormal { point: DVec3::new(1.0, 2.0, 3.0), normal: DVec3::Z };
    for operation in [ViewingOperation::CentralByNormal(a), ViewingOperation::ParallelByNormal(p)] {
        let camera = camera(Projection::Operation(operation));
        for aspect in [0.5, 1.0, 2.0] {
            let view = camera.view(&DMat4::IDENTITY, aspect, &bounds).unwrap();
            let mut reach: f64 = 0.0;
            for c in bounds.corners() {
                let s = seen(&view, c.x, c.y, c.z);
                assert!(s.x.abs() < 1.0 && s.y.abs() < 1.0 && (0.0..=1.0).contains(&s.z), "{s}");
                reach = reach.max(s.x.abs()).max(s.y.abs());
            }
            assert!(reach > 0.9, "{reach}");
        }
        assert!(camera.view(&DMat4::IDENTITY, 1.0, &Aabb::EMPTY).is_ok());
        assert!(camera.view(&DMat4::IDENTITY, 1.0, &unit_box_at(80.0)).is_ok());
    }
}

#[test]
fn bad_cameras_say_so() {
    let bounds = unit_box_at(-4.0);
    let nan = DMat4::from_cols_array(&[f64::NAN; 16]);
    assert!(perspective(None, None, None).view(&nan, 1.0, &bounds).is_err());
    assert!(perspective(None, None, None).view(&DMat4::ZERO, 1.0, &bounds).is_err());
    assert!(perspective(None, None, None).view(&DMat4::IDENTITY, 0.0, &bounds).is_err());
    let b = camera(Projection::Operation(ViewingOperation::Central(operation_b())));
    assert!(b.view(&nan, 1.0, &bounds).is_err());
    let wide = Projection::Perspective { yfov: 4.0, aspect: None, near: None, far: None };
    assert!(camera(wide).view(&DMat4::IDENTITY, 1.0, &bounds).is_err());
}
