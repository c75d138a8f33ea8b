use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use glam::{DVec2, DVec4};
use proptest::prelude::*;

use super::*;
use crate::projective::normalized;
use crate::test_support::{assert_close3, assert_matrix, vec3};

const UP: DVec3 = DVec3::Y;

fn parameters(
    vrp: DVec3,
    vpn: DVec3,
    vup: DVec3,
    prp: DVec3,
    window: [f64; 4],
    fb: [f64; 2],
) -> ViewParameters {
    let [umin, umax, vmin, vmax] = window;
    ViewParameters {
        vrp,
        vpn,
        vup,
        prp,
        window: ViewWindow::new(umin, umax, vmin, vmax),
        front: fb[0],
        back: fb[1],
    }
}

fn simple() -> ViewParameters {
    parameters(DVec3::ZERO, DVec3::Z, UP, vec3(0, 0, 5), [-1.0, 1.0, -1.0, 1.0], [1.0, -5.0])
}

fn off_axis() -> ViewParameters {
    let prp = DVec3::new(0.5, -0.5, 4.0);
    parameters(vec3(1, 2, 3), vec3(1, 2, 2), DVec3::Z, prp, [-1.0, 2.0, -1.5, 1.5], [1.0, -4.0])
}

#[track_caller]
fn assert_maps(m: &DMat4, from: [f64; 3], to: [f64; 3], tolerance: f64) {
    let point = normalized(*m * DVec3::from(from).extend(1.0)).finite().expect("a finite point");
    assert_close3(point, DVec3::from(to), tolerance);
}

#[track_caller]
fn assert_inverse(steps: &ViewSteps) {
    for step in steps.steps() {
        assert!((step.inverse * step.forward).abs_diff_eq(DMat4::IDENTITY, 1e-12), "{}", step.name);
    }
    assert!((steps.inverse() * steps.product()).abs_diff_eq(DMat4::IDENTITY, 1e-11));
    let numeric = steps.product().inverse();
    let scale = numeric.to_cols_array().into_iter().fold(1.0, |a: f64, b| a.max(b.abs()));
    assert!(steps.inverse().abs_diff_eq(numeric, 1e-10 * scale));
}

#[test]
fn operation_a_gives_the_worked_matrix_and_points() {
    let (p, n) = (vec3(1, 2, 3), vec3(2, 1, 2) / 3.0);
    let steps = CentralByNormal { center: p, normal: n, focal: 2.0 }.steps().unwrap();
    let rows = [
        [-0.447214, -0.596285, 0.666667, -0.333333],
        [0.894427, -0.298142, 0.333333, -0.166667],
        [0.0, 0.745356, 0.666667, -0.333333],
        [-1.341641, -1.043498, -1.333333, 1.666667],
    ];
    let t = steps.product();
    assert_matrix(&t, rows, 1e-6);
    assert_maps(&t, [0.0, 0.0, 0.0], [-0.804984, -0.626099, -0.8], 1e-6);
    assert_maps(&t, [-1.0, 1.0, 1.0], [0.0, 0.0, -2.0 / 3.0], 1e-12);
    assert!((t * p.extend(1.0)).w.abs() < 1e-15);
    assert_maps(&t, (p - 2.0 * n).to_array(), [0.0; 3], 1e-12);
    let names: Vec<_> = steps.steps().iter().map(|s| s.name).collect();
    assert_eq!(names, ["T1", "T2", "T3", "T4"]);
    assert_inverse(&steps);
}

#[test]
fn operation_a_agrees_with_the_intersection_of_ray_and_plane() {
    let view = CentralByNormal { center: vec3(1, 2, 3), normal: vec3(2, 1, 2) / 3.0, focal: 2.0 };
    let origin = view.center - view.focal * view.normal;
    let axes = axes_from(view.normal);
    for point in [vec3(0, 0, 0), vec3(-5, 1, 2), vec3(3, -4, 0)] {
        let ray = point - view.center;
        let hit = view.center + ray * (-view.focal / ray.dot(view.normal));
        let expected = axes.transpose() * (hit - origin);
        let got = view.steps().unwrap().product().project_point3(point);
        assert_close3(got.truncate().extend(0.0), expected, 1e-12);
    }
}

fn axes_from(n: DVec3) -> DMat3 {
    let root = n.truncate().length();
    let x = DVec3::new(-n.y, n.x, 0.0) / root;
    let y = DVec3::new(-n.x * n.z, -n.y * n.z, root * root) / root;
    DMat3::from_cols(x, y, n)
}

#[test]
fn a_normal_along_z_takes_the_y_axis_as_helper() {
    let view = CentralByNormal { center: vec3(0, 0, 5), normal: DVec3::Z, focal: 5.0 };
    assert_eq!(view.steps().unwrap().steps()[1].forward, DMat4::IDENTITY);
    let below = CentralByNormal { normal: -DVec3::Z, ..view };
    assert_inverse(&below.steps().unwrap());
}

#[test]
fn operation_a_refuses_what_the_text_forbids() {
    let view = CentralByNormal { center: DVec3::ZERO, normal: vec3(0, 3, 4), focal: 1.0 };
    assert_eq!(view.steps().unwrap_err(), ViewError::NormalNotUnit { length: 5.0 });
    assert_eq!(
        CentralByNormal { normal: DVec3::Y, focal: 0.0, ..view }.steps().unwrap_err(),
        ViewError::ZeroFocal
    );
    let nan = CentralByNormal { center: DVec3::NAN, ..view };
    assert_eq!(nan.steps().unwrap_err(), ViewError::NotFinite { name: "P" });
}

#[test]
fn the_operations_by_normal_continue_as_b_and_c() {
    let window = ViewWindow::new(-1.0, 1.0, -1.0, 1.0);
    let a = CentralByNormal { center: vec3(1, 2, 3), normal: vec3(2, 1, 2) / 3.0, focal: 2.0 };
    let b = a.parameters(window, 1.0, -4.0).unwrap().central_steps().unwrap().product();
    let p = ParallelByNormal { point: a.center, normal: a.normal };
    let c = p.parameters(window, 9.0, -4.0).unwrap().parallel_steps().unwrap().product();
    for point in [vec3(0, 0, 0), vec3(-5, 1, 2), vec3(3, -4, 0)] {
        let (by_a, by_b) = (a.steps().unwrap().product().project_point3(point), b.project_point3(point));
        assert!((by_a.truncate() - by_b.truncate()).length() < 1e-12);
        let (by_p, by_c) = (p.steps().unwrap().product().project_point3(point), c.project_point3(point));
        assert!((by_p.truncate() - by_c.truncate()).length() < 1e-12);
    }
    assert_eq!(ViewingOperation::CentralByNormal(a).view().unwrap_err(), ViewError::NoVolume);
}

#[test]
fn parallel_by_point_and_normal_gives_the_worked_point() {
    let view = ParallelByNormal { point: vec3(1, 2, 3), normal: vec3(2, 1, 2) / 3.0 };
    let steps = view.steps().unwrap();
    assert_maps(&steps.product(), [0.0; 3], [-1.341641, -1.043498, -3.333333], 1e-6);
    assert_inverse(&steps);
}

#[test]
fn operation_b_gives_the_simple_worked_view() {
    let steps = simple().central_steps().unwrap();
    let sixth = 1.0 / 6.0;
    let t = steps.product();
    assert_matrix(
        &t,
        [[0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, sixth, -0.1], [0.0, 0.0, -sixth, 0.5]],
        1e-15,
    );
    assert_matrix(
        &steps.inverse(),
        [[2.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 7.5, 1.5], [0.0, 0.0, 2.5, 2.5]],
        1e-14,
    );
    assert_matrix(
        &steps.steps()[5].forward,
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0 / 0.6, -1.0], [0.0, 0.0, 0.4 / 0.6, 0.0]],
        1e-15,
    );
    assert_maps(&t, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0 / 3.0], 1e-15);
    assert_maps(&t, [1.0, 1.0, 0.0], [1.0, 1.0, -1.0 / 3.0], 1e-15);
    assert_maps(&t, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 1e-15);
    assert_maps(&t, [2.0, 0.0, -5.0], [1.0, 0.0, -1.0], 1e-15);
    assert_maps(&t, [0.8, 0.8, 1.0], [1.0, 1.0, 0.0], 1e-15);
    assert!((t * DVec4::new(0.0, 0.0, 5.0, 1.0)).w.abs() < 1e-15);
    assert!(((t * DVec4::new(0.0, 0.0, 6.0, 1.0)).w + 0.1).abs() < 1e-15);
    assert_inverse(&steps);
}

#[test]
fn operation_b_passes_the_checks_of_the_text() {
    let steps = off_axis().central_steps().unwrap();
    let z_front = -0.375;
    let t6 = steps.steps()[5].forward;
    assert_maps(&t6, [z_front, z_front, z_front], [-1.0, -1.0, 0.0], 1e-14);
    assert_maps(&t6, [1.0, 1.0, -1.0], [1.0, 1.0, -1.0], 1e-14);
    for (i, step) in steps.steps().iter().enumerate() {
        let kept = crate::frame::orthonormality(&DMat3::from_mat4(step.forward), 1e-12).is_orthonormal();
        assert_eq!(kept, i < 3, "{}", step.name);
    }
    let dop = DVec4::new(0.0, 0.5, -4.0, 1.0);
    assert_eq!(steps.steps()[3].forward * dop, DVec4::new(0.0, 0.0, -4.0, 1.0));
}

#[test]
fn operation_b_gives_the_off_axis_worked_view() {
    let view = off_axis();
    let steps = view.central_steps().unwrap();
    let rows = [
        [-0.298142, -0.085492, 0.066667, -0.041667],
        [0.149071, -0.170984, 0.133333, -0.083333],
        [0.0, 0.276230, 0.133333, -0.083333],
        [-0.166667, -0.401230, -0.933333, 0.958333],
    ];
    let t = steps.product();
    assert_matrix(&t, rows, 1e-6);
    assert_close3(view.eye_world().unwrap(), DVec3::new(2.035191, 5.188416, 5.293989), 1e-6);
    assert_maps(&t, [1.0, 2.0, 3.0], [-1.0 / 3.0, 0.0, -0.4], 1e-12);
    assert_maps(&t, [0.0, 0.0, 0.0], [-0.173913, -0.418675, -0.973913], 1e-6);
    assert_maps(&t, [1.0, 1.0, 1.0], [-0.420984, -0.508634, -0.8], 1e-6);
    assert_inverse(&steps);
    let axes = DMat3::from_mat4(steps.steps()[1].inverse);
    for corner in 0..8u32 {
        let (u, v) = ([-1.0, 2.0][(corner & 1) as usize], [-1.5, 1.5][(corner >> 1 & 1) as usize]);
        let z = [1.0, -4.0][(corner >> 2) as usize];
        let on_plane = view.prp + (DVec3::new(u, v, 0.0) - view.prp) * ((view.prp.z - z) / view.prp.z);
        let expected = DVec3::new(
            if corner & 1 == 0 { -1.0 } else { 1.0 },
            if corner & 2 == 0 { -1.0 } else { 1.0 },
            if corner & 4 == 0 { 0.0 } else { -1.0 },
        );
        assert_maps(&t, (view.vrp + axes * on_plane).to_array(), expected.to_array(), 1e-12);
    }
}

#[test]
fn operation_c_gives_the_worked_views() {
    let steps = simple().parallel_steps().unwrap();
    let t = steps.product();
    let sixth = 1.0 / 6.0;
    let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, sixth, 0.0], [0.0, 0.0, -sixth, 1.0]];
    assert_matrix(&t, rows, 1e-15);
    assert_maps(&t, [1.0, 1.0, 0.0], [1.0, 1.0, -sixth], 1e-15);
    assert_maps(&t, [1.0, 1.0, 1.0], [1.0, 1.0, 0.0], 1e-15);
    assert_maps(&t, [1.0, 1.0, -5.0], [1.0, 1.0, -1.0], 1e-15);
    assert_inverse(&steps);
    // The check that the text prints after its T6, with z_front = -0.4.
    assert_maps(&steps.steps()[5].forward, [1.0, 1.0, -0.4], [1.0, 1.0, 0.0], 1e-15);
    assert_maps(&steps.steps()[5].forward, [1.0, 1.0, -1.0], [1.0, 1.0, -1.0], 1e-15);
    assert_matrix(
        &steps.steps()[5].inverse,
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.6, 0.0], [0.0, 0.0, -0.4, 1.0]],
        1e-15,
    );
}

#[test]
fn operation_c_gives_the_worked_oblique_view() {
    let view = parameters(DVec3::ZERO, DVec3::Z, UP, vec3(2, 1, 4), [-1.0, 1.0, -1.0, 1.0], [1.0, -3.0]);
    let steps = view.parallel_steps().unwrap();
    let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-0.5, -0.25, 0.25, 0.0], [0.0, 0.0, -0.25, 1.0]];
    assert_matrix(&steps.product(), rows, 1e-15);
    assert_maps(&steps.product(), [0.0, 0.0, 0.0], [0.0, 0.0, -0.25], 1e-15);
    assert_maps(&steps.product(), [0.5, 0.25, 1.0], [0.0, 0.0, 0.0], 1e-15);
    assert_maps(&steps.product(), [1.5, 1.25, 1.0], [1.0, 1.0, 0.0], 1e-15);
    assert_inverse(&steps);
    let direction = view.direction_world().unwrap();
    assert_close3(direction, vec3(-2, -1, -4).normalize(), 1e-15);
}

fn sample_1991() -> View1991 {
    let vrp = DVec3::new(1.5, 2.0, 0.0);
    let p = parameters(vrp, DVec3::Z, UP, vec3(0, 0, 70), [-4.0, 4.0, -4.0, 4.0], [0.0, 60.0]);
    View1991 { parameters: p, normalization: Normalization1991::Perspective }
}

#[test]
fn the_1991_sample_view_gives_the_worked_matrix() {
    let view = sample_1991();
    let steps = view.steps().unwrap();
    let t = steps.product();
    let program_rows = [
        [1.75, 0.0, 0.0, -2.625],
        [0.0, 1.75, 0.0, -3.5],
        [0.0, 0.0, -1.0 / 60.0, 0.0],
        [0.0, 0.0, -0.1, 7.0],
    ];
    assert_eq!(steps.steps()[1].forward, DMat4::IDENTITY);
    assert!(t.abs_diff_eq(DMat4::from_cols_array_2d(&program_rows).transpose(), 1e-14));
    assert_maps(&t, [5.5, 6.0, 0.0], [1.0, 1.0, 0.0], 1e-14);
    assert_eq!((t * DVec4::new(5.5, 6.0, 0.0, 1.0)).w, 7.0);
    assert_maps(&t, [1.5, 2.0, 0.0], [0.0, 0.0, 0.0], 1e-14);
    assert_maps(&t, [0.0, 0.0, 54.0], [-1.640625, -2.1875, -0.5625], 1e-12);
    assert_maps(&t, [0.0, 0.0, 30.0], [-0.65625, -0.875, -0.125], 1e-13);
    assert_maps(&t, [1.5 + 40.0 / 70.0, 2.0, 60.0], [1.0, 0.0, -1.0], 1e-12);
    assert_inverse(&steps);
}

/// The program's own matrix began with the identity, so its last element was one too large; that is why
/// the clip matrix here is the formula's.
#[test]
fn the_1991_listing_weakens_the_perspective_by_one_element() {
    let mut t = sample_1991().steps().unwrap().product();
    t.w_axis.w += 1.0;
    assert_maps(&t, [5.5, 6.0, 0.0], [0.875, 0.875, 0.0], 1e-12);
    assert_maps(&t, [0.0, 0.0, 54.0], [-2.625 / 2.6, -3.5 / 2.6, -0.9 / 2.6], 1e-12);
    assert_maps(&t, [0.0, 0.0, 54.0], [-1.009_615, -1.346_154, -0.346_154], 1e-6);
    assert_maps(&t, [0.0, 0.0, 30.0], [-0.525, -0.7, -0.1], 1e-12);
}

#[test]
fn a_1991_view_with_the_back_plane_in_front_still_sees_the_right_way() {
    let view = sample_1991().view().unwrap();
    let depth = |z| view.clip_from_world.project_point3(DVec3::new(1.5, 2.0, z)).z;
    assert!(depth(60.0).abs() < 1e-12 && (depth(0.0) - 1.0).abs() < 1e-12 && depth(54.0) < depth(30.0));
    let edge = view.clip_from_world.project_point3(DVec3::new(5.5, 6.0, 0.0));
    assert!((edge.x - 1.0).abs() < 1e-12 && (edge.y - 1.0).abs() < 1e-12);
}

#[test]
fn the_1991_asymmetric_and_parallel_views_give_the_worked_matrices() {
    let p = parameters(vec3(0, 0, 54), DVec3::Z, UP, vec3(8, 6, 30), [-1.0, 17.0, -1.0, 17.0], [1.0, -23.0]);
    let central = View1991 { parameters: p, normalization: Normalization1991::Perspective };
    let t = central.steps().unwrap().product();
    let rows = [
        [0.062893, 0.0, 0.0, 0.0],
        [0.0, 0.062893, 0.0, 0.0],
        [0.0, 0.004193, 0.041667, -0.018868],
        [-0.503145, -0.72956, -2.291667, 1.584906],
    ];
    assert_matrix(&t, rows, 1e-6);
    assert_maps(&t, [0.0, 0.0, 54.0], [-0.888889, -0.888889, -0.073611], 1e-6);
    assert_maps(&t, [16.0, 10.0, 54.0], [0.888889, 0.222222, -0.073611], 1e-6);
    assert_maps(&t, [8.0, 16.0, 54.0], [0.0, 0.888889, -0.073611], 1e-6);
    assert_maps(&t, [0.0, 0.0, 30.0], [-0.493827, -0.592593, -1.022377], 1e-6);
    assert_maps(&t, [8.0, 16.0, 30.0], [0.0, 0.395062, -1.022377], 1e-6);

    let p = ViewParameters { prp: vec3(8, 8, 100), back: -25.0, ..p };
    let parallel = View1991 { parameters: p, normalization: Normalization1991::Parallel };
    let t = parallel.steps().unwrap().product();
    let rows = [
        [0.111111, 0.0, 0.0, 0.0],
        [0.0, 0.111111, 0.0, 0.0],
        [0.0, 0.0, 0.038462, 0.0],
        [-0.888889, -0.888889, -2.115385, 1.0],
    ];
    assert_matrix(&t, rows, 1e-6);
    assert_maps(&t, [0.0, 0.0, 54.0], [-0.888889, -0.888889, -0.038462], 1e-6);
    assert_maps(&t, [16.0, 10.0, 54.0], [0.888889, 0.222222, -0.038462], 1e-6);
    assert_maps(&t, [8.0, 16.0, 30.0], [0.0, 0.888889, -0.961538], 1e-6);
    let gks = View1991 { normalization: Normalization1991::ParallelGks, ..parallel };
    assert_maps(&gks.steps().unwrap().product(), [8.0, 16.0, 30.0], [0.5, 17.0 / 18.0, -0.961538], 1e-6);
    assert_inverse(&gks.steps().unwrap());
}

#[test]
fn the_1991_view_orientation_gives_the_worked_matrix() {
    let mut view = sample_1991();
    (view.parameters.vrp, view.parameters.vpn) = (vec3(16, 0, 54), vec3(1, 0, 1));
    let rows = [
        [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        [26.870058, 0.0, -49.497475, 1.0],
    ];
    assert_matrix(&view.steps().unwrap().product_of_first(2), rows, 1e-6);
}

#[test]
fn the_1991_camera_puts_its_window_around_the_target() {
    let size = DVec2::new(8.0, 6.0);
    let camera = View1991::camera(vec3(0, 0, 10), DVec3::ZERO, UP, size, 2.0, -5.0).unwrap();
    let t = camera.steps().unwrap().product();
    let corner = t.project_point3(vec3(4, 3, 0));
    assert!((corner.x - 1.0).abs() < 1e-14 && (corner.y - 1.0).abs() < 1e-14);
    assert_eq!(View1991::camera(UP, UP, UP, size, 1.0, 0.0).unwrap_err(), ViewError::EyeAtTarget);
}

#[test]
fn every_degenerate_parameter_has_its_own_error() {
    let p = simple();
    let central = |p: ViewParameters| p.central_steps().unwrap_err();
    assert_eq!(central(ViewParameters { vpn: DVec3::ZERO, ..p }), ViewError::ZeroVpn);
    assert_eq!(central(ViewParameters { vup: DVec3::ZERO, ..p }), ViewError::ZeroVup);
    assert_eq!(central(ViewParameters { vup: vec3(0, 0, -2), ..p }), ViewError::VupParallelToVpn);
    let empty = ViewWindow::new(1.0, 1.0, -1.0, 1.0);
    assert!(matches!(central(ViewParameters { window: empty, ..p }), ViewError::EmptyWindow { .. }));
    let exchanged = ViewWindow::new(-1.0, 1.0, 1.0, -1.0);
    assert!(matches!(central(ViewParameters { window: exchanged, ..p }), ViewError::EmptyWindow { .. }));
    assert_eq!(central(ViewParameters { prp: vec3(3, 1, 0), ..p }), ViewError::PrpInViewPlane);
    assert_eq!(central(ViewParameters { prp: DVec3::ZERO, ..p }), ViewError::PrpInViewPlane);
    assert_eq!(central(ViewParameters { back: 1.0, ..p }), ViewError::FrontEqualsBack(1.0));
    assert_eq!(
        central(ViewParameters { back: 2.0, ..p }),
        ViewError::BackBeforeFront { front: 1.0, back: 2.0 }
    );
    let behind = ViewError::PlaneBehindEye { plane: "front", distance: 5.0, eye: 5.0 };
    assert_eq!(central(ViewParameters { front: 5.0, ..p }), behind);
    assert_eq!(central(ViewParameters { vrp: DVec3::NAN, ..p }), ViewError::NotFinite { name: "VRP" });
    assert_eq!(central(ViewParameters { back: f64::NEG_INFINITY, ..p }), ViewError::NotFinite { name: "B" });
    assert_eq!(
        central(ViewParameters { window: ViewWindow::centered(1e-320, 1e300), ..p }),
        ViewError::OutOfRange
    );
    let through = ViewParameters { prp: vec3(0, 0, -5), ..p };
    assert_eq!(through.parallel_steps().unwrap_err(), ViewError::BackThroughPrp(-5.0));
}

#[test]
fn look_at_and_lens_agree_with_the_viewing_operations() {
    for lens in [Lens::Perspective { yfov: 0.8 }, Lens::Orthographic { height: 5.0 }] {
        let camera = LookAtCamera {
            eye: vec3(4, 5, 6),
            target: vec3(1, 0, -1),
            up: UP,
            lens,
            aspect: 1.5,
            near: 0.5,
            far: 40.0,
        };
        let direct = camera.view().unwrap();
        let by_parameters = camera.viewing_operation().unwrap().view().unwrap();
        assert_eq!(matches!(direct.kind, ViewKind::Central { .. }), matches!(lens, Lens::Perspective { .. }));
        for p in [vec3(0, 0, 0), vec3(1, 0, -1), vec3(-3, 2, 1)] {
            let (a, b) =
                (direct.clip_from_world.project_point3(p), by_parameters.clip_from_world.project_point3(p));
            assert_close3(a, b, 1e-12);
        }
        assert!(direct.view_from_world.abs_diff_eq(by_parameters.view_from_world, 1e-12));
    }
}

#[test]
fn perspective_spans_the_clip_volume() {
    let view = View::perspective(&DMat4::IDENTITY, FRAC_PI_2, 2.0, 1.0, Some(11.0)).unwrap();
    assert_maps(&view.clip_from_world, [2.0, 1.0, -1.0], [1.0, 1.0, 0.0], 1e-14);
    assert_maps(&view.clip_from_world, [-22.0, -11.0, -11.0], [-1.0, -1.0, 1.0], 1e-14);
    let endless = View::perspective(&DMat4::IDENTITY, FRAC_PI_2, 2.0, 1.0, None).unwrap();
    assert_maps(&endless.clip_from_world, [2.0, 1.0, -1.0], [1.0, 1.0, 0.0], 1e-14);
    assert_maps(&endless.clip_from_world, [0.0, 0.0, -1e12], [0.0, 0.0, 1.0], 1e-11);
    assert_maps(&endless.world_from_clip, [1.0, 1.0, 0.5], [4.0, 2.0, -2.0], 1e-14);
    let clip = endless.clip_from_world * DVec4::new(0.0, 0.0, -1.0, 0.0);
    assert_eq!(clip, DVec4::new(0.0, 0.0, 1.0, 1.0));
}

#[test]
fn orthographic_spans_the_clip_volume() {
    let frame = View::look_at(vec3(0, 0, 10), DVec3::ZERO, UP).unwrap();
    let view = View::orthographic(&frame, 4.0, 2.0, -1.0, 19.0).unwrap();
    assert_maps(&view.clip_from_world, [4.0, 2.0, 11.0], [1.0, 1.0, 0.0], 1e-14);
    assert_maps(&view.clip_from_world, [-4.0, -2.0, -9.0], [-1.0, -1.0, 1.0], 1e-14);
    assert_eq!(view.kind, ViewKind::Parallel { direction_world: -DVec3::Z });
}

#[test]
fn camera_settings_are_checked() {
    let i = DMat4::IDENTITY;
    assert_eq!(View::perspective(&i, PI, 1.0, 1.0, None).unwrap_err(), ViewError::FieldOfView(PI));
    assert_eq!(View::perspective(&i, 1.0, 0.0, 1.0, None).unwrap_err(), ViewError::Aspect(0.0));
    assert_eq!(View::perspective(&i, 1.0, 1.0, 0.0, None).unwrap_err(), ViewError::Near(0.0));
    let far = ViewError::FarBeforeNear { near: 2.0, far: 2.0 };
    assert_eq!(View::perspective(&i, 1.0, 1.0, 2.0, Some(2.0)).unwrap_err(), far);
    assert_eq!(View::orthographic(&i, -1.0, 1.0, 0.0, 1.0).unwrap_err(), ViewError::Height(-1.0));
    assert_eq!(View::perspective(&DMat4::ZERO, 1.0, 1.0, 1.0, None).unwrap_err(), ViewError::DegenerateFrame);
    assert_eq!(View::look_at(UP, UP, UP).unwrap_err(), ViewError::EyeAtTarget);
    assert_eq!(View::look_at(UP, DVec3::ZERO, UP).unwrap_err(), ViewError::VupParallelToVpn);
    assert!(View::perspective(&(i * f64::NAN), 1.0, 1.0, 1.0, None).is_err());
}

#[test]
fn a_scaled_or_mirrored_camera_node_sees_like_a_rigid_one() {
    let rigid = View::look_at(vec3(1, 2, 3), DVec3::ZERO, UP).unwrap();
    let scaled = rigid * DMat4::from_scale(DVec3::new(-2.0, 3.0, 0.5));
    let a = View::perspective(&rigid, 1.0, 1.0, 0.1, None).unwrap();
    let b = View::perspective(&scaled, 1.0, 1.0, 0.1, None).unwrap();
    assert!(a.clip_from_world.abs_diff_eq(b.clip_from_world, 1e-12));
}

#[test]
fn volumes_convert_both_ways() {
    for (to, from) in [clip_from_canonical(), clip_from_gks(), clip_from_opengl()] {
        assert!((to * from).abs_diff_eq(DMat4::IDENTITY, 1e-15));
    }
    assert_eq!(clip_from_canonical().0 * DVec4::new(1.0, 2.0, -0.25, 1.0), DVec4::new(1.0, 2.0, 0.25, 1.0));
    assert_eq!(clip_from_opengl().0 * DVec4::new(0.0, 0.0, -3.0, 3.0), DVec4::new(0.0, 0.0, 0.0, 3.0));
    assert_eq!(clip_from_gks().0 * DVec4::new(0.0, 2.0, -2.0, 2.0), DVec4::new(-2.0, 2.0, 2.0, 2.0));
}

#[test]
fn culling_tells_front_from_back() {
    let n = DVec3::Z;
    let central = ViewKind::Central { eye_world: vec3(0, 0, 5) };
    assert!(!central.sees_back_of(DVec3::ZERO, n) && central.sees_back_of(DVec3::ZERO, -n));
    assert!(!ViewKind::Central { eye_world: vec3(3, 3, 0) }.sees_back_of(DVec3::ZERO, n));
    let parallel = ViewKind::Parallel { direction_world: -DVec3::Z };
    assert!(!parallel.sees_back_of(DVec3::ZERO, n) && parallel.sees_back_of(DVec3::ZERO, -n));
    assert_eq!(central.towards_viewer(DVec3::ZERO), DVec3::Z);
    assert_eq!(parallel.towards_viewer(UP), DVec3::Z);
}

prop_compose! {
    fn any_view()(
        vrp in prop::array::uniform3(-10.0..10.0f64),
        vpn in prop::array::uniform3(-1.0..1.0f64),
        vup in prop::array::uniform3(-1.0..1.0f64),
        prp_xy in prop::array::uniform2(-3.0..3.0f64),
        eye in prop_oneof![-10.0..-1.0, 1.0..10.0f64],
        low in prop::array::uniform2(-4.0..1.0f64),
        size in prop::array::uniform2(0.5..5.0f64),
        gap in 0.2..9.0f64,
        depth in 0.5..20.0f64,
    ) -> ViewParameters {
        ViewParameters {
            vrp: vrp.into(),
            vpn: vpn.into(),
            vup: vup.into(),
            prp: DVec3::new(prp_xy[0], prp_xy[1], eye),
            window: ViewWindow::new(low[0], low[0] + size[0], low[1], low[1] + size[1]),
            // Before the eye, on either side of the view plane.
            front: eye - gap,
            back: eye - gap - depth,
        }
    }
}

/// Where a point of VRC must land, by intersecting its projector with the view plane.
fn by_geometry(p: &ViewParameters, point_vrc: DVec3, central: bool) -> DVec3 {
    let dop = p.window.center().extend(0.0) - p.prp;
    let uv = if central {
        p.prp + (point_vrc - p.prp) * (p.prp.z / (p.prp.z - point_vrc.z))
    } else {
        point_vrc - dop * (point_vrc.z / dop.z)
    };
    let low = DVec2::new(p.window.umin, p.window.vmin);
    let xy = 2.0 * (uv.truncate() - low) / p.window.size() - 1.0;
    let (ze, zf, zb) = (point_vrc.z - p.prp.z, p.front - p.prp.z, p.back - p.prp.z);
    let z = if central {
        zb * (zf - ze) / (ze * (zb - zf))
    } else {
        (point_vrc.z - p.front) / (p.front - p.back)
    };
    xy.extend(z)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(868))]
    #[test]
    fn random_cameras_agree_with_geometry(
        p in any_view(),
        points in prop::collection::vec(prop::array::uniform3(-12.0..12.0f64), 20),
    ) {
        let Some(axes) = crate::frame::axes_from_z_and_up(p.vpn, p.vup) else { return Ok(()) };
        for central in [true, false] {
            let steps = if central { p.central_steps().unwrap() } else { p.parallel_steps().unwrap() };
            let t = steps.product();
            for &point_vrc in &points {
                let point_vrc = DVec3::from(point_vrc);
                let behind = central && p.prp.z - point_vrc.z < 0.05;
                let h = t * (p.vrp + axes * point_vrc).extend(1.0);
                if behind {
                    prop_assert!(h.w < 0.06 / (p.prp.z - p.back));
                    continue;
                }
                let expected = by_geometry(&p, point_vrc, central);
                let error = (h.truncate() / h.w - expected).abs().max_element();
                prop_assert!(h.w > 0.0 && error < 1e-9 * (1.0 + expected.abs().max_element()), "{error}");
                let back = steps.inverse() * h;
                let world = p.vrp + axes * point_vrc;
                prop_assert!((back.truncate() / back.w - world).length() < 1e-7);
            }
        }
    }

    #[test]
    fn membership_in_the_frustum_is_the_six_inequalities(
        p in any_view(),
        point in prop::array::uniform3(-12.0..12.0f64),
    ) {
        let Some(axes) = crate::frame::axes_from_z_and_up(p.vpn, p.vup) else { return Ok(()) };
        let point = DVec3::from(point);
        let view = p.central_view().unwrap();
        let c = view.clip_from_world * (p.vrp + axes * point).extend(1.0);
        let inside_clip = -c.w < c.x && c.x < c.w && -c.w < c.y && c.y < c.w && 0.0 < c.z && c.z < c.w;
        let uv = by_geometry(&p, point, true);
        let margin = [uv.x - 1.0, uv.x + 1.0, uv.y - 1.0, uv.y + 1.0, uv.z, uv.z + 1.0];
        prop_assume!(margin.iter().all(|m| m.abs() > 1e-9));
        let inside = point.z < p.front && point.z > p.back && uv.x.abs() < 1.0 && uv.y.abs() < 1.0;
        prop_assert_eq!(inside_clip, inside);
    }

    #[test]
    fn views_invert(p in any_view(), point in prop::array::uniform3(-1.0..1.0f64)) {
        let Ok(eye) = p.eye_world() else { return Ok(()) };
        for view in [p.central_view().unwrap(), p.parallel_view().unwrap()] {
            let product = view.world_from_clip * view.clip_from_world;
            prop_assert!(product.abs_diff_eq(DMat4::IDENTITY, 1e-8));
            let rigid = crate::frame::orthonormality(&DMat3::from_mat4(view.view_from_world), 1e-12);
            prop_assert_eq!(rigid, crate::frame::Orthonormality::Rotation);
            // A point of the clip volume comes from before the viewer.
            let clip = DVec3::new(point[0], point[1], 0.5 * point[2] + 0.5);
            let world = normalized(view.world_from_clip * clip.extend(1.0)).finite().unwrap();
            match view.kind {
                ViewKind::Central { eye_world } => {
                    prop_assert!((eye_world - eye).length() < 1e-12);
                    let ahead = view.view_from_world.transform_point3(world);
                    prop_assert!(ahead.z < 0.0);
                }
                ViewKind::Parallel { direction_world } => prop_assert!(direction_world.is_normalized()),
            }
        }
    }
}
