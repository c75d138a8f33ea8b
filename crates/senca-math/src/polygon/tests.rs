use proptest::prelude::*;

use super::*;
use crate::test_support::vec3;

fn points(list: &[[f64; 2]]) -> Vec<DVec2> {
    list.iter().copied().map(DVec2::from).collect()
}

fn triangle_area(corners: &[DVec2], t: [u32; 3]) -> f64 {
    signed_area(&t.map(|i| corners[i as usize]))
}

/// Every triangle has the polygon's orientation and together they have its area.
fn assert_covers(corners: &[DVec2], triangles: &[[u32; 3]], area: f64) {
    let areas: Vec<f64> = triangles.iter().map(|&t| triangle_area(corners, t)).collect();
    assert!(areas.iter().all(|a| *a * area > 0.0), "{areas:?}");
    let sum: f64 = areas.iter().sum();
    assert!((sum - area).abs() < 1e-9 * area.abs(), "{sum} instead of {area}");
}

const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

#[test]
fn newell_gives_area_and_side() {
    let square = [vec3(5, 5, 2), vec3(7, 5, 2), vec3(7, 8, 2), vec3(5, 8, 2)];
    assert_eq!(newell_normal(&square), vec3(0, 0, 6));
    let doubled_start = [square[0], square[0], square[1], square[2], square[3]];
    assert_eq!(newell_normal(&doubled_start), vec3(0, 0, 6));
    assert_eq!(newell_normal(&square[..2]), DVec3::ZERO);
    assert_eq!(newell_normal(&[]), DVec3::ZERO);
    assert_eq!(signed_area(&points(&L_SHAPE)), 3.0);
    assert_eq!(signed_area(&[]), 0.0);
}

#[test]
fn the_house_has_its_normals() {
    let gable = [vec3(0, 0, 54), vec3(16, 0, 54), vec3(16, 10, 54), vec3(8, 16, 54), vec3(0, 10, 54)];
    assert_eq!(newell_normal(&gable).normalize(), DVec3::Z);
    let roof = [vec3(16, 10, 54), vec3(16, 10, 30), vec3(8, 16, 30), vec3(8, 16, 54)];
    assert!((newell_normal(&roof).normalize() - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-15);
}

#[test]
fn containment_knows_concave_and_shared_borders() {
    let l = points(&L_SHAPE);
    assert!(contains(&l, DVec2::new(0.5, 1.5)) && !contains(&l, DVec2::new(1.5, 1.5)));
    let left = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let right = points(&[[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]]);
    let on_border = DVec2::new(1.0, 0.5);
    assert!(!contains(&left, on_border) && contains(&right, on_border));
    let backwards: Vec<_> = l.iter().rev().copied().collect();
    assert_eq!(winding_number(&backwards, DVec2::new(0.5, 0.5)), -1);
    assert!(!contains(&[], DVec2::ZERO));
}

#[test]
fn convexity() {
    let square = points(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    assert!(is_convex(&square));
    assert!(is_convex(&square.iter().rev().copied().collect::<Vec<_>>()));
    assert!(!is_convex(&points(&L_SHAPE)));
    // A pentagram turns left everywhere, but twice round.
    let star: Vec<_> =
        (0..5).map(|i| DVec2::from_angle(f64::from(i) * 4.0 * std::f64::consts::PI / 5.0)).collect();
    assert!(!is_convex(&star));
    assert!(!is_convex(&points(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])) && !is_convex(&[]));
}

#[test]
fn concave_polygons_are_covered_in_both_orientations() {
    let l = points(&L_SHAPE);
    assert_eq!(triangulate(&l).len(), 4);
    assert_covers(&l, &triangulate(&l), 3.0);
    let backwards: Vec<_> = l.iter().rev().copied().collect();
    assert_covers(&backwards, &triangulate(&backwards), -3.0);
}

#[test]
fn quads_are_cut_at_the_corner_that_turns_inwards() {
    let square = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    let mut dart = points(&[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]]);
    for _ in 0..4 {
        assert_covers(&dart, &triangulate(&dart), 4.0);
        dart.rotate_left(1);
    }
    dart.reverse();
    assert_covers(&dart, &triangulate(&dart), -4.0);
}

#[test]
fn a_spiral_is_covered() {
    let arm = |r: f64| {
        (0..600).map(move |k| DVec2::from_angle(f64::from(k) * 0.1) * (1.0 + f64::from(k) * 0.05 + r))
    };
    let corners: Vec<_> = arm(0.5).chain(arm(0.0).collect::<Vec<_>>().into_iter().rev()).collect();
    let triangles = triangulate(&corners);
    assert_eq!(triangles.len(), corners.len() - 2);
    assert_covers(&corners, &triangles, signed_area(&corners));
}

#[test]
fn collinear_corners_are_all_used() {
    let corners = points(&[
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 1.0],
    ]);
    let triangles = triangulate(&corners);
    assert_covers(&corners, &triangles, 4.0);
    assert_eq!(triangles.len(), corners.len() - 2);
    assert!((0..8).all(|i| triangles.iter().flatten().any(|&k| k == i)));
}

#[test]
fn holes_are_left_out() {
    let mut corners = points(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
    let mut starts = Vec::new();
    for (x, y) in [(1.0, 1.0), (5.0, 1.0), (5.0, 5.0), (1.0, 6.0), (7.5, 3.5)] {
        starts.push(corners.len());
        corners.extend(points(&[[x, y], [x, y + 2.0], [x + 2.0, y + 2.0], [x + 2.0, y]]));
    }
    let triangles = triangulate_with_holes(&corners, &starts);
    assert_covers(&corners, &triangles, 80.0);
    let outside = |p: DVec2| !triangles.iter().any(|t| contains(&t.map(|i| corners[i as usize]), p));
    for &start in &starts {
        assert!(outside(corners[start] + DVec2::ONE));
    }
    corners[..4].reverse();
    assert_covers(&corners, &triangulate_with_holes(&corners, &starts), -80.0);
}

#[test]
fn degenerate_loops_give_what_they_can() {
    assert!(triangulate(&[]).is_empty());
    assert!(triangulate(&points(&[[0.0, 0.0], [1.0, 0.0]])).is_empty());
    assert!(triangulate(&points(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]])).is_empty());
    assert!(triangulate(&[DVec2::ZERO; 9]).is_empty());
    assert!(triangulate(&[DVec2::ZERO, DVec2::NAN, DVec2::ONE]).is_empty());
    let spike = points(&[[0.0, 0.0], [2.0, 0.0], [5.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    assert_covers(&spike, &triangulate(&spike), 4.0);
    let doubled = points(&[[0.0, 0.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [2.0, 2.0], [0.0, 2.0]]);
    assert_covers(&doubled, &triangulate(&doubled), 4.0);
    let bow_tie = points(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    assert!(!triangulate(&bow_tie).is_empty());
    let square = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_covers(&square, &triangulate_with_holes(&square, &[4, 9, 2]), 1.0);
}

#[test]
fn a_large_comb_is_quick() {
    let teeth = 20_000;
    let mut corners = vec![DVec2::new(f64::from(teeth), -1.0), DVec2::new(f64::from(teeth), 0.0)];
    for i in (0..teeth).rev() {
        corners.push(DVec2::new(f64::from(i) + 0.5, 5.0));
        corners.push(DVec2::new(f64::from(i), 0.0));
    }
    corners.push(DVec2::new(0.0, -1.0));
    let area = signed_area(&corners);
    let triangles = triangulate(&corners);
    assert_covers(&corners, &triangles, area);
    assert_eq!(triangles.len(), corners.len() - 2);
}

#[test]
fn polygons_in_space_keep_their_normal() {
    let frame = glam::DQuat::from_euler(glam::EulerRot::XYZ, 1.0, 2.0, 3.0);
    let corners: Vec<_> = L_SHAPE.iter().map(|p| frame * DVec3::new(p[0], p[1], 7.0)).collect();
    let normal = newell_normal(&corners);
    let triangles = triangulate_in_space(&corners);
    let sum: DVec3 = triangles.iter().map(|t| newell_normal(&t.map(|i| corners[i as usize]))).sum();
    assert!((sum - normal).length() < 1e-12 && (normal.length() - 3.0).abs() < 1e-12);
    assert!(triangles.iter().all(|t| newell_normal(&t.map(|i| corners[i as usize])).dot(normal) > 0.0));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
        let turn = glam::DQuat::from_rotation_arc(DVec3::Z, axis);
        let flat = flattened(&L_SHAPE.map(|p| turn * DVec3::new(p[0], p[1], 0.0)), axis);
        assert!((signed_area(&flat) - 3.0).abs() < 1e-12);
    }
}

proptest! {
    #[test]
    fn star_shaped_polygons_are_covered(radii in prop::collection::vec(0.1..5.0f64, 3..400)) {
        let n = radii.len() as f64;
        let corners: Vec<_> = radii
            .iter()
            .enumerate()
            .map(|(i, r)| DVec2::from_angle(std::f64::consts::TAU * i as f64 / n) * *r + DVec2::new(3.0, -7.0))
            .collect();
        let triangles = triangulate(&corners);
        prop_assert_eq!(triangles.len(), corners.len() - 2);
        assert_covers(&corners, &triangles, signed_area(&corners));
    }

    #[test]
    fn many_holes_are_left_out(
        radii in prop::collection::vec(prop::collection::vec(0.05..0.49f64, 3..12), 1..40),
        turn in 0.0..6.0f64,
        aligned in any::<bool>(),
    ) {
        let turn = DVec2::from_angle(if aligned { 0.0 } else { turn });
        let side = (radii.len() as f64).sqrt().ceil();
        let mut corners = points(&[[-0.5, -0.5], [side - 0.5, -0.5], [side - 0.5, side - 0.5], [-0.5, side - 0.5]]);
        let mut starts = Vec::new();
        let mut area = side * side;
        for (k, hole) in radii.iter().enumerate() {
            let center = DVec2::new(k as f64 % side, (k as f64 / side).floor());
            let step = std::f64::consts::TAU / hole.len() as f64;
            let star: Vec<_> =
                hole.iter().enumerate().map(|(i, r)| center + DVec2::from_angle(step * i as f64) * *r).collect();
            area -= signed_area(&star);
            starts.push(corners.len());
            corners.extend(star);
        }
        corners.iter_mut().for_each(|p| *p = turn.rotate(*p));
        let triangles = triangulate_with_holes(&corners, &starts);
        prop_assert_eq!(triangles.len(), corners.len() - 2 + 2 * starts.len());
        assert_covers(&corners, &triangles, area);
    }

    #[test]
    fn any_loop_ends_with_valid_indices(
        raw in prop::collection::vec((0..12i32, 0..12i32), 0..80),
        starts in prop::collection::vec(0..90usize, 0..4),
    ) {
        let corners: Vec<_> = raw.iter().map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect();
        for triangles in [triangulate(&corners), triangulate_with_holes(&corners, &starts)] {
            prop_assert!(triangles.iter().flatten().all(|&i| (i as usize) < corners.len()));
        }
    }
}
