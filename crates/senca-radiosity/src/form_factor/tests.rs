//! Known pairs, and what must hold of any.

use super::*;
use proptest::prelude::*;
use senca_math::glam::{DQuat, DVec3};
use senca_math::newell_normal;

fn square_at(z: f64) -> [DVec3; 4] {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z))
}

fn reversed(corners: &[DVec3]) -> Vec<DVec3> {
    corners.iter().rev().copied().collect()
}

fn wall() -> [DVec3; 4] {
    // At x = 0, facing +x, sharing the y axis with the square at z = 0.
    [DVec3::ZERO, DVec3::Y, DVec3::new(0.0, 1.0, 1.0), DVec3::Z]
}

const PARALLEL_UNIT: f64 = 0.199_824_895_698_387_07;
const PERPENDICULAR_UNIT: f64 = 0.200_043_776_075_403_24;

#[test]
fn unit_squares_have_their_known_factors() {
    let facing = polygon_to_polygon(&square_at(0.0), &reversed(&square_at(1.0)));
    assert!((facing - PARALLEL_UNIT).abs() < 1e-13, "{facing}");
    let edge = polygon_to_polygon(&square_at(0.0), &wall());
    assert!((edge - PERPENDICULAR_UNIT).abs() < 1e-13, "{edge}");
    assert!((facing + 4.0 * edge - 1.0).abs() < 1e-13);
    let plain = polygon_to_polygon_by_contours(&square_at(0.0), &wall());
    assert!((plain - PERPENDICULAR_UNIT).abs() < 1e-12, "{plain}");
}

#[test]
fn small_patches_have_the_factors_of_the_text() {
    let facing = differential(DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0, DVec3::NEG_Z, 0.01);
    assert!((facing - 0.000_795_775).abs() < 5e-10, "{facing}");
    let at = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    let slanted = differential(DVec3::ZERO, at(60.0), DVec3::Z * 3.0, -at(30.0), 0.04);
    assert!((slanted - 0.000_612_588).abs() < 5e-10, "{slanted}");
    assert_eq!(differential(DVec3::ZERO, DVec3::Z, DVec3::ZERO, DVec3::NEG_Z, 1.0), 0.0);
    assert_eq!(differential(DVec3::ZERO, DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Z, 1.0), 0.0);
    assert_eq!(differential(DVec3::NAN, DVec3::Z, DVec3::Z, DVec3::NEG_Z, 1.0), 0.0);
}

#[test]
fn polygons_that_do_not_face_each_other_have_no_factor() {
    let square = square_at(0.0);
    assert_eq!(polygon_to_polygon(&square, &square_at(1.0)), 0.0);
    assert_eq!(polygon_to_polygon(&square, &square), 0.0);
    assert_eq!(polygon_to_polygon(&square, &reversed(&square)), 0.0);
    let beside = square.map(|p| p + DVec3::X * 0.3);
    assert_eq!(polygon_to_polygon(&square, &beside), 0.0);
    assert_eq!(polygon_to_polygon(&square, &[DVec3::Z; 4]), 0.0);
    assert_eq!(polygon_to_polygon(&[], &square), 0.0);
    assert_eq!(polygon_to_polygon(&[DVec3::NAN; 3], &square), 0.0);
    assert_eq!(polygon_to_polygon(&[DVec3::splat(f64::INFINITY); 3], &square), 0.0);
    let huge = square.map(|p| p * 1e200);
    assert!(polygon_to_polygon(&huge, &wall().map(|p| p * 1e200)).is_finite());
}

#[test]
fn a_polygon_that_cuts_the_plane_counts_with_its_front_part() {
    // A wall from z = -1 to 1 against its upper half.
    let whole = [DVec3::NEG_Z, DVec3::new(0.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0), DVec3::Z];
    let cut = polygon_to_polygon(&square_at(0.0), &whole);
    assert!((cut - PERPENDICULAR_UNIT).abs() < 1e-13, "{cut}");
    // And the floor reaching behind the wall: twice the area, the same exchange.
    let floor = [DVec3::NEG_X, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 1.0, 0.0)];
    let cut = polygon_to_polygon(&floor, &whole);
    assert!((cut - PERPENDICULAR_UNIT / 2.0).abs() < 1e-13, "{cut}");
}

#[test]
fn far_polygons_keep_their_digits() {
    // Against the first terms of the expansion in the distance: 1 / (pi D^2) (1 - 1 / (3 D^2) ...).
    for distance in [1e2_f64, 1e3, 1e5, 1e8] {
        let factor = polygon_to_polygon(&square_at(0.0), &reversed(&square_at(distance)));
        let d2 = distance * distance;
        let expected = (1.0 - 2.0 / (3.0 * d2)) / (std::f64::consts::PI * d2);
        assert!((factor / expected - 1.0).abs() < 2.0 / (d2 * d2) + 1e-7, "{distance}: {factor} {expected}");
    }
}

#[test]
fn small_and_large_agree_however_they_are_computed() {
    let floor = square_at(0.0);
    for (size, height) in [(1e-1, 0.05), (1e-2, 0.2), (1e-3, 1e-3), (1e-4, 2e-4), (1e-5, 1e-5)] {
        let lamp = reversed(&square_at(height).map(|p| DVec3::new(p.x * size + 0.2, p.y * size + 0.7, p.z)));
        let closed = polygon_to_polygon(&lamp, &floor);
        let plain = polygon_to_polygon_by_contours(&lamp, &floor);
        assert!((closed - plain).abs() < 1e-9, "{size}: {closed} {plain}");
    }
}

fn corner() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64].prop_map(DVec3::from)
}

fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
    [corner(), corner(), corner()]
}

fn area(corners: &[DVec3]) -> f64 {
    newell_normal(corners).length()
}

proptest! {
    #[test]
    fn any_pair_is_reciprocal_and_agrees_with_quadrature(a in triangle(), b in triangle()) {
        let (there, back) = (polygon_to_polygon(&a, &b), polygon_to_polygon(&b, &a));
        prop_assert!((there * area(&a) - back * area(&b)).abs() <= 1e-12 * (there * area(&a)));
        let plain = polygon_to_polygon_by_contours(&a, &b);
        prop_assert!((there - plain).abs() < 1e-9 / area(&a).max(1e-3), "{} {}", there, plain);
    }

    #[test]
    fn a_closed_body_sees_itself_once(corners in [corner(), corner(), corner(), corner()]) {
        // A tetrahedron from inside; far from a flat one.
        let [a, b, c, d] = corners;
        let volume = (b - a).cross(c - a).dot(d - a);
        prop_assume!(volume.abs() > 1e-2);
        let (b, c) = if volume > 0.0 { (b, c) } else { (c, b) };
        let faces = [[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
        for from in &faces {
            let sum: f64 = faces.iter().map(|to| polygon_to_polygon(from, to)).sum();
            prop_assert!((sum - 1.0).abs() < 1e-10, "{}", sum);
        }
    }

    #[test]
    fn parts_add_up(a in triangle(), b in triangle(), u in 0.1..0.9_f64) {
        let middle = b[0].lerp(b[1], u);
        let parts = polygon_to_polygon(&a, &[b[0], middle, b[2]]) + polygon_to_polygon(&a, &[middle, b[1], b[2]]);
        prop_assert!((parts - polygon_to_polygon(&a, &b)).abs() < 1e-9 / area(&a).max(1e-3));
    }

    #[test]
    fn place_turn_and_size_do_not_matter(a in triangle(), b in triangle(), q in corner(), scale in 1e-3..1e3_f64) {
        let turn = DQuat::from_scaled_axis(q * 3.0);
        let moved = |t: &[DVec3; 3]| t.map(|p| turn * p * scale + DVec3::new(5.0, -3.0, 2.0) * scale);
        let (here, there) = (polygon_to_polygon(&a, &b), polygon_to_polygon(&moved(&a), &moved(&b)));
        prop_assert!((here - there).abs() < 1e-9 / area(&a).max(1e-3), "{} {}", here, there);
    }
}

#[test]
fn a_cosine_emitter_radiates_pi_times_its_normal_intensity() {
    // B cos(phi) over the hemisphere: the ring at phi has the solid angle 2 pi sin(phi) dphi.
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    let ring = |phi: f64| phi.cos() * TAU * phi.sin();
    let total = super::quadrature::adaptive(&ring, 0.0, FRAC_PI_2, 1e-14);
    assert!((total - PI).abs() < 1e-13, "{total}");
}

#[test]
fn the_factor_of_a_divided_emitter_is_the_mean_over_its_parts() {
    let (wall, floor) = (wall(), square_at(0.0));
    let part = |u: f64, v: f64, s: f64, t: f64| {
        [[u, v], [u + s, v], [u + s, v + t], [u, v + t]].map(|[x, y]| DVec3::new(x, y, 0.0))
    };
    let parts = [part(0.0, 0.0, 0.25, 1.0), part(0.25, 0.0, 0.75, 0.5), part(0.25, 0.5, 0.75, 0.5)];
    let mean: f64 = parts.iter().map(|p| area(p) * polygon_to_polygon(p, &wall)).sum();
    assert!((mean - polygon_to_polygon(&floor, &wall)).abs() < 1e-13);
}

#[test]
fn edges_that_are_parallel_but_for_rounding_lose_nothing() {
    // Faces of a turned box: edges along their common line differ by rounding only.
    for k in 0..50 {
        let turn = DQuat::from_scaled_axis(DVec3::new(1.0, 2.0, 3.0) * f64::from(k) * 0.37);
        let moved = |c: [DVec3; 4]| c.map(|p| turn * p + DVec3::new(10.0, -20.0, 30.0));
        let factor = polygon_to_polygon(&moved(square_at(0.0)), &moved(wall()));
        assert!((factor - PERPENDICULAR_UNIT).abs() < 1e-12, "{factor}");
    }
}
