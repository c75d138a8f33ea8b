use proptest::prelude::*;
use senca_math::glam::{DVec2, DVec3};
use senca_math::polygon::contains;

use super::*;

fn vec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn from_origin(direction: DVec3) -> Ray {
    Ray::new(DVec3::ZERO, direction)
}

#[track_caller]
fn assert_near(got: DVec3, expected: DVec3) {
    assert!((got - expected).length() < 1e-9, "{got} instead of {expected}");
}

#[test]
fn spheres_before_around_and_behind_the_origin() {
    let ahead = ray_sphere(&from_origin(DVec3::Z), vec(0.0, 0.0, 5.0), 2.0);
    assert_eq!((ahead.a, ahead.b, ahead.c, ahead.d), (1.0, -10.0, 21.0, 16.0));
    assert_eq!((ahead.t, ahead.nearest()), (Some([3.0, 7.0]), Some(3.0)));

    let touched = ray_sphere(&from_origin(DVec3::Z), vec(0.0, 2.0, 5.0), 2.0);
    assert_eq!((touched.b, touched.c, touched.d, touched.t), (-10.0, 25.0, 0.0, None));
    let missed = ray_sphere(&from_origin(DVec3::Z), vec(0.0, 3.0, 5.0), 2.0);
    assert_eq!((missed.d, missed.t), (-20.0, None));

    let inside = ray_sphere(&Ray::new(vec(0.0, 0.0, 5.0), DVec3::Z), vec(0.0, 0.0, 5.0), 2.0);
    assert_eq!((inside.t, inside.nearest()), (Some([-2.0, 2.0]), Some(2.0)));
    let behind = ray_sphere(&Ray::new(vec(0.0, 0.0, 10.0), DVec3::Z), vec(0.0, 0.0, 5.0), 2.0);
    assert_eq!((behind.t, behind.nearest()), (Some([-7.0, -3.0]), None));
}

#[test]
fn a_sphere_off_the_axes() {
    let test = ray_sphere(&from_origin(vec(1.0, 2.0, 2.0) / 3.0), vec(3.0, 5.0, 7.0), 2.0);
    assert!((test.b + 18.0).abs() < 1e-12 && (test.c - 79.0).abs() < 1e-12 && (test.d - 8.0).abs() < 1e-12);
    let [near, far] = test.t.unwrap();
    assert!((near - 7.585_786_437_6).abs() < 1e-9 && (far - 10.414_213_562_4).abs() < 1e-9);
}

#[test]
fn planes() {
    let (normal, d) = (vec(1.0, 2.0, 2.0), -9.0);
    assert_eq!(ray_plane(&from_origin(DVec3::Z), normal, d), Some(4.5));
    assert!((ray_plane(&from_origin(normal / 3.0), normal, d).unwrap() - 3.0).abs() < 1e-12);
    assert_eq!(ray_plane(&from_origin(vec(2.0, -1.0, 0.0) / 5f64.sqrt()), normal, d), None);
    assert_eq!(ray_plane(&Ray::new(vec(0.0, 0.0, 10.0), DVec3::Z), normal, d), Some(-5.5));
}

#[test]
fn the_largest_component_of_the_normal_is_dropped() {
    assert_eq!(dropped_coordinate(vec(-3.0, 2.0, 1.0)), 0);
    assert_eq!(dropped_coordinate(vec(0.0, -2.0, 1.0)), 1);
    assert_eq!(dropped_coordinate(vec(0.5, 0.5, 1.0)), 2);
    assert_eq!(reduced(vec(1.0, 2.0, 3.0), 0), DVec2::new(2.0, 3.0));
    assert_eq!(reduced(vec(1.0, 2.0, 3.0), 1), DVec2::new(3.0, 1.0));
    assert_eq!(reduced(vec(1.0, 2.0, 3.0), 2), DVec2::new(1.0, 2.0));
}

fn notched() -> Vec<DVec2> {
    [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.5), (0.0, 4.0)].map(|(x, y)| DVec2::new(x, y)).to_vec()
}

#[test]
fn points_in_a_concave_polygon() {
    let at = |x: f64, y: f64| in_polygon(&notched(), DVec2::new(x, y));
    // The half-line from (1, 1.5) passes through the notch's corner, that from (-1, 0) along a side.
    assert!(at(2.0, 1.0) && at(1.0, 2.0) && at(1.0, 1.5) && at(3.0, 1.5));
    assert!(!at(2.0, 3.0) && !at(5.0, 1.5) && !at(-1.0, 0.0) && !at(-1.0, 4.0));
    assert!(!in_polygon(&[], DVec2::ZERO) && !in_polygon(&[DVec2::ZERO], DVec2::ZERO));
}

#[test]
fn points_in_a_triangle() {
    let triangle = [DVec2::new(1.0, 1.0), DVec2::new(5.0, 2.0), DVec2::new(2.0, 4.0)];
    let cases = [
        ((2.0, 2.0), (2.0, 3.0), true),
        ((4.0, 3.0), (7.0, 5.0), false),
        ((1.0, 1.0), (0.0, 0.0), true),
        ((3.0, 1.5), (5.5, 0.0), true),
        ((5.0, 5.0), (8.0, 12.0), false),
        ((0.0, 0.0), (-2.0, -3.0), false),
    ];
    for ((x, y), (alpha, beta), inside) in cases {
        let x = DVec2::new(x, y);
        let weights = triangle_weights(triangle, x).unwrap();
        assert!((weights[0] - alpha / 11.0).abs() < 1e-15 && (weights[1] - beta / 11.0).abs() < 1e-15, "{x}");
        assert_eq!(in_triangle(triangle, x), inside, "{x}");
    }
    assert_eq!(triangle_weights([DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)], DVec2::X), None);
}

#[test]
fn boxes_with_both_corrections() {
    let diagonal = from_origin(DVec3::ONE);
    assert_eq!(ray_box(&diagonal, vec(1.0, 2.0, 1.5), vec(4.0, 5.0, 6.0)), Some([2.0, 4.0]));
    assert_eq!(ray_box(&diagonal, vec(1.0, 5.0, 1.5), vec(4.0, 8.0, 6.0)), None);
    let (min, max) = (vec(1.0, -1.0, -1.0), vec(2.0, 1.0, 1.0));
    assert_eq!(ray_box(&from_origin(DVec3::NEG_X), min, max), None, "behind the origin");
    let inside = Ray::new(vec(1.5, 0.0, 0.0), DVec3::X);
    assert_eq!(ray_box(&inside, min, max), Some([-0.5, 0.5]));
    assert_eq!(ray_box(&Ray::new(vec(0.0, 3.0, 0.0), DVec3::X), min, max), None, "beside, along x");
}

#[test]
fn reflection() {
    assert_near(reflect(DVec3::Z, vec(0.6, 0.0, -0.8)), vec(0.6, 0.0, 0.8));
    assert_near(reflect(DVec3::Z, DVec3::NEG_Z), DVec3::Z);
}

#[test]
fn refraction() {
    let slanted = vec(0.6, 0.0, -0.8);
    assert_near(refract(DVec3::Z, slanted, 1.0, 1.5).unwrap(), vec(0.4, 0.0, -0.916_515_139_0));
    assert_near(refract(DVec3::Z, slanted, 1.5, 1.0).unwrap(), vec(0.9, 0.0, -0.435_889_894_4));
    assert_near(refract(DVec3::Z, slanted, 1.3, 1.3).unwrap(), slanted);
    assert_near(refract(DVec3::Z, DVec3::NEG_Z, 1.0, 1.5).unwrap(), DVec3::NEG_Z);
    assert_near(refract(DVec3::Z, DVec3::NEG_Z, 1.5, 1.0).unwrap(), DVec3::NEG_Z);
}

/// Direction towards the plane z = 0 at this angle, in degrees, to its normal.
fn at_angle(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    vec(sin, 0.0, -cos)
}

fn angle_of(direction: DVec3) -> f64 {
    direction.x.atan2(-direction.z).to_degrees()
}

#[test]
fn refracted_angles() {
    let entering = refract(DVec3::Z, at_angle(45.0), 1.0, 1.5).unwrap();
    assert_near(entering, vec(0.471_404_520_8, 0.0, -0.881_917_103_7));
    assert!((angle_of(entering) - 28.1255).abs() < 1e-4);
    let at_30 = refract(DVec3::Z, at_angle(30.0), 1.0, 1.5).unwrap();
    assert!((angle_of(at_30) - 19.4712).abs() < 1e-4);
}

#[test]
fn light_beyond_the_critical_angle_is_totally_reflected() {
    assert_eq!(refract(DVec3::Z, at_angle(45.0), 1.5, 1.0), None);
    assert!(refract(DVec3::Z, at_angle(41.8103), 1.5, 1.0).is_some());
    assert!(refract(DVec3::Z, at_angle(41.8104), 1.5, 1.0).is_none());
}

#[test]
fn through_a_glass_ball() {
    let ray = Ray::new(vec(0.0, 0.5, -3.0), DVec3::Z);
    let t = ray_sphere(&ray, DVec3::ZERO, 1.0).nearest().unwrap();
    assert!((t - 2.133_974_596_2).abs() < 1e-9);
    let entry = ray.at(t);
    assert_near(entry, vec(0.0, 0.5, -0.866_025_403_8));
    let inside = Ray::new(entry, refract(entry, ray.direction, 1.0, 1.5).unwrap());
    assert_near(inside.direction, vec(0.0, -0.182_729_386_2, 0.983_163_247_6));
    let path = ray_sphere(&inside, DVec3::ZERO, 1.0).t.unwrap()[1];
    assert!((path - 1.885_618_083_2).abs() < 1e-9);
    let exit = inside.at(path);
    assert_near(exit, vec(0.0, 0.155_442_165_1, 0.987_844_994_6));
    let out = refract(-exit, inside.direction, 1.5, 1.0).unwrap();
    assert_near(out, vec(0.0, -0.359_305_633_5, 0.933_219_942_8));
    assert!((out.dot(ray.direction).acos().to_degrees() - 21.057_56).abs() < 1e-5);
    let axis = exit.z - exit.y * out.z / out.y;
    assert!((axis - 1.391_572_948_9).abs() < 1e-9);
}

proptest! {
    #[test]
    fn crossings_agree_with_windings(corners in prop::collection::vec((0..6i32, 0..6i32), 3..4), x in 0..12i32, y in 0..12i32) {
        let corners: Vec<DVec2> = corners.iter().map(|(x, y)| DVec2::new(f64::from(*x), f64::from(*y))).collect();
        let point = DVec2::new(0.5 * f64::from(x), 0.5 * f64::from(y));
        let on_border = (0..3).any(|i| (corners[(i + 1) % 3] - corners[i]).perp_dot(point - corners[i]) == 0.0);
        prop_assume!(!on_border);
        prop_assert_eq!(in_polygon(&corners, point), contains(&corners, point));
        prop_assert_eq!(in_polygon(&corners, point), in_triangle([corners[0], corners[1], corners[2]], point));
    }

    #[test]
    fn both_ways_in_a_convex_polygon(n in 3..40usize, clockwise in any::<bool>(), x in -1.2..1.2f64, y in -1.2..1.2f64) {
        let turn = if clockwise { -1.0 } else { 1.0 };
        let corners: Vec<DVec2> =
            (0..n).map(|i| DVec2::from_angle(turn * std::f64::consts::TAU * i as f64 / n as f64)).collect();
        let point = DVec2::new(x, y);
        let inside = in_polygon(&corners, point);
        prop_assert_eq!(in_convex_polygon(&corners, point), inside);
        prop_assert_eq!(in_convex_polygon_by_search(&corners, point), inside);
    }

    #[test]
    fn polygons_that_share_a_side_share_no_point(y in 0..9i32) {
        let side = [DVec2::new(2.0, 0.0), DVec2::new(3.0, 8.0)];
        let point = side[0].lerp(side[1], f64::from(y) / 8.0);
        let left = in_polygon(&[DVec2::ZERO, side[0], side[1], DVec2::new(0.0, 8.0)], point);
        let right = in_polygon(&[side[0], DVec2::new(9.0, 0.0), DVec2::new(9.0, 8.0), side[1]], point);
        prop_assert!(left != right || y == 8);
    }

    #[test]
    fn refraction_obeys_snell(angle in 0.0..89.0f64, eta in 0.4..2.5f64) {
        let incoming = at_angle(angle);
        match refract(DVec3::Z, incoming, 1.0, eta) {
            Some(out) => {
                prop_assert!((out.length() - 1.0).abs() < 1e-12);
                prop_assert!((out.x * eta - incoming.x).abs() < 1e-12 && out.z <= 0.0);
            }
            None => prop_assert!(incoming.x > eta),
        }
    }
}
