use std::f64::consts::FRAC_PI_2;

use proptest::prelude::*;

use super::*;
use crate::projective::{HomogeneousPoint, normalized, same_map};
use crate::test_support::{assert_close3, assert_close4, assert_matrix, vec3};

fn at(m: &DMat4, x: f64, y: f64, z: f64) -> (DVec4, HomogeneousPoint) {
    let h = *m * DVec4::new(x, y, z, 1.0);
    (h, normalized(h))
}

fn assert_maps(m: &DMat4, point: [f64; 3], homogeneous: [f64; 4], affine: [f64; 3]) {
    let (h, p) = at(m, point[0], point[1], point[2]);
    assert_close4(h, DVec4::from(homogeneous), 1e-12);
    assert_close3(p.finite().expect("a finite point"), DVec3::from(affine), 1e-6);
}

#[test]
fn central_projection_to_xy_gives_the_worked_points() {
    let m = central_projection_to_xy(2.0);
    assert_maps(&m, [1.0, 1.0, -2.0], [1.0, 1.0, -2.0, 2.0], [0.5, 0.5, -1.0]);
    assert_maps(&m, [3.0, 4.0, 0.0], [3.0, 4.0, 0.0, 1.0], [3.0, 4.0, 0.0]);
    assert_maps(&m, [3.0, 4.0, 1.0], [3.0, 4.0, 1.0, 0.5], [6.0, 8.0, 2.0]);
    assert_maps(&m, [3.0, 4.0, -6.0], [3.0, 4.0, -6.0, 4.0], [0.75, 1.0, -1.5]);
    assert_eq!(at(&m, 3.0, 4.0, 2.0).1, HomogeneousPoint::AtInfinity(DVec3::new(3.0, 4.0, 2.0)));
    assert_eq!(normalized(m * DVec4::Z), HomogeneousPoint::Finite(DVec3::new(0.0, 0.0, -2.0)));
    assert_eq!(m.determinant(), 1.0);
}

#[test]
fn other_projections_give_the_worked_points() {
    let parallel = parallel_projection_to_xy(DVec3::new(1.0, 2.0, -4.0)).unwrap();
    assert_maps(&parallel, [3.0, 4.0, 8.0], [5.0, 8.0, 8.0, 1.0], [5.0, 8.0, 8.0]);
    assert_maps(&parallel, [0.0, 0.0, 4.0], [1.0, 2.0, 4.0, 1.0], [1.0, 2.0, 4.0]);
    assert!(parallel_projection_to_xy(DVec3::X).is_none());
    let origin = central_projection_from_origin(2.0);
    assert_maps(&origin, [3.0, 4.0, 6.0], [3.0, 4.0, 6.0, 3.0], [1.0, 4.0 / 3.0, 2.0]);
    assert!(at(&origin, 1.0, 1.0, 0.0).1.finite().is_none());
    assert_eq!(origin.determinant(), 0.0);
    let onto_yz = central_projection_to_yz(2.0);
    assert_maps(&onto_yz, [-2.0, 1.0, 3.0], [-2.0, 1.0, 3.0, 2.0], [-1.0, 0.5, 1.5]);
}

#[test]
fn shear_and_uniform_scale_give_the_worked_points() {
    let sheared = shear(Axis::Y, Axis::X, 2.0);
    assert_maps(&sheared, [3.0, 4.0, 5.0], [3.0, 10.0, 5.0, 1.0], [3.0, 10.0, 5.0]);
    let doubled = uniform_scale_by_w(2.0);
    assert_maps(&doubled, [3.0, 4.0, 5.0], [3.0, 4.0, 5.0, 0.5], [6.0, 8.0, 10.0]);
    assert_maps(&doubled, [1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 0.5], [2.0, 4.0, 6.0]);
    assert_eq!(
        shear_xy(DVec2::new(2.0, 3.0)) * DVec4::new(1.0, 1.0, 4.0, 1.0),
        DVec4::new(9.0, 13.0, 4.0, 1.0)
    );
    assert_eq!(scale_along(Axis::X, 3.0), scale(DVec3::new(3.0, 1.0, 1.0)));
}

#[test]
fn every_shear_moves_one_coordinate_by_another() {
    let p = DVec3::new(3.0, 5.0, 7.0);
    for moved in Axis::ALL {
        for by in Axis::ALL.into_iter().filter(|by| *by != moved) {
            let mut expected = p;
            expected[moved.index()] += 2.0 * p[by.index()];
            assert_eq!(shear(moved, by, 2.0).transform_point3(p), expected);
        }
    }
}

#[test]
fn turning_about_x_then_y_gives_the_printed_product() {
    let (a, b) = (0.4f64, 1.1f64);
    let both = compose([rotation(Axis::X, a), rotation(Axis::Y, b)]);
    let (ca, sa, cb, sb) = (a.cos(), a.sin(), b.cos(), b.sin());
    let printed = [
        [cb, 0.0, -sb, 0.0],
        [sa * sb, ca, sa * cb, 0.0],
        [ca * sb, -sa, ca * cb, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    assert_matrix(&both, printed, 1e-15);
    let quarter = compose([rotation(Axis::X, FRAC_PI_2), rotation(Axis::Y, FRAC_PI_2)]);
    assert_close3(quarter.transform_vector3(DVec3::X), -DVec3::Z, 1e-15);
    assert_close3(quarter.transform_vector3(DVec3::Y), DVec3::X, 1e-15);
    assert_close3(quarter.transform_vector3(DVec3::Z), -DVec3::Y, 1e-15);
}

#[test]
fn the_1991_self_test_and_product_hold() {
    assert_eq!(translation(DVec3::new(2.0, 3.0, 4.0)).transform_point3(vec3(5, 6, 7)), vec3(7, 9, 11));
    let m = compose([
        rotation(Axis::X, FRAC_PI_2),
        scale(DVec3::new(2.0, 3.0, 4.0)),
        translation(DVec3::new(1.0, 2.0, 3.0)),
    ]);
    let columns_as_rows =
        [[2.0, 0.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0], [0.0, -3.0, 0.0, 0.0], [1.0, 2.0, 3.0, 1.0]];
    assert_matrix(&m, columns_as_rows, 1e-14);
    assert_close3(m.transform_point3(DVec3::ONE), vec3(3, -1, 7), 1e-14);
}

#[test]
fn the_1991_sample_object_is_placed_as_computed() {
    let turns = DVec3::new(-60.0, 2.0, 0.0).map(f64::to_radians);
    let m = world_from_object_1991(DVec3::new(1.6, 1.0, 1.0), turns, DVec3::ZERO);
    let rows_of_the_program = [
        [1.599025, 0.0, -0.034899, 0.0],
        [-0.048358, 0.5, -0.865498, 0.0],
        [0.02792, 0.866025, 0.499695, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    assert_matrix(&m, rows_of_the_program, 5e-7);
    assert_close3(m.transform_point3(DVec3::X), DVec3::new(1.599025, 0.0, -0.034899), 5e-7);
    assert_close3(m.transform_point3(DVec3::Z), DVec3::new(0.02792, 0.866025, 0.499695), 5e-7);
}

#[test]
fn simple_1991_projections() {
    let (_, p) = at(&simple_perspective(10.0), 4.0, 5.0, 10.0);
    assert_close3(p.finite().unwrap(), DVec3::new(2.0, 2.5, 5.0), 1e-15);
    assert_eq!(flatten_to_plane_z(7.0).transform_point3(vec3(1, 2, 3)), vec3(1, 2, 7));
}

#[test]
fn affine_maps_are_projective_maps_and_back() {
    let linear = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.5, 7.0, 8.0, 9.0]);
    let m = projective_from_affine(linear, vec3(1, 2, 3));
    assert_eq!(affine_from_projective(&m), Some((linear, vec3(1, 2, 3))));
    assert_eq!(affine_from_projective(&(m * 2.0)), Some((linear, vec3(1, 2, 3))));
    assert!(affine_from_projective(&central_projection_to_xy(2.0)).is_none());
    assert!(same_map(&m, &(m * -3.0), 1e-15));
}

#[test]
fn normals_survive_flattening_and_mirroring() {
    let flat = normal_matrix(DMat3::from_diagonal(DVec3::new(2.0, 3.0, 0.0)));
    assert_eq!((flat * DVec3::Z).normalize(), DVec3::Z);
    let mirror = normal_matrix(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)));
    assert_eq!(mirror * DVec3::Y, DVec3::Y);
    assert_eq!(normal_matrix(DMat3::ZERO), DMat3::ZERO);
}

proptest! {
    #[test]
    fn normals_stay_at_right_angles(
        m in prop::array::uniform9(-3.0..3.0f64),
        a in prop::array::uniform3(-1.0..1.0f64),
        b in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let m = DMat3::from_cols_array(&m);
        let (a, b) = (DVec3::from(a), DVec3::from(b));
        let n = normal_matrix(m) * a.cross(b);
        prop_assert!(n.dot(m * a).abs() < 1e-9 && n.dot(m * b).abs() < 1e-9);
        let outward = (m * a).cross(m * b).dot(n) * m.determinant();
        prop_assert!(outward >= -1e-9);
    }

    #[test]
    fn affine_maps_keep_parallels_and_act_on_differences_linearly(
        m in prop::array::uniform9(-3.0..3.0f64),
        p in prop::array::uniform3(-9.0..9.0f64),
        q in prop::array::uniform3(-9.0..9.0f64),
        v in prop::array::uniform3(-9.0..9.0f64),
    ) {
        let map = projective_from_affine(DMat3::from_cols_array(&m), DVec3::new(1.0, -2.0, 5.0));
        let (p, q, v) = (DVec3::from(p), DVec3::from(q), DVec3::from(v));
        let f = |x| map.transform_point3(x);
        prop_assert!(((f(p + v) - f(p)) - (f(q + v) - f(q))).length() < 1e-10);
    }

    #[test]
    fn projective_maps_keep_lines_and_ignore_the_factor(
        p in prop::array::uniform3(-9.0..9.0f64),
        q in prop::array::uniform3(-9.0..9.0f64),
        t in 0.0..1.0f64,
        k in 0.1..9.0f64,
    ) {
        let m = central_projection_to_xy(20.0);
        let (p, q) = (DVec3::from(p), DVec3::from(q));
        let f = |x: DVec3| normalized(m * x.extend(1.0) * k).finite().unwrap();
        let (a, b, c) = (f(p), f(q), f(p.lerp(q, t)));
        prop_assert!((b - a).cross(c - a).length() < 1e-8);
        prop_assert!((a - m.project_point3(p)).length() < 1e-10);
    }
}
