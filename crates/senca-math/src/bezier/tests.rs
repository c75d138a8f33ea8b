use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::test_support::{assert_close3, vec3};

fn sample_patch() -> BicubicPatch {
    let z = |i: usize| if [5, 6, 9, 10].contains(&i) { 3.0 } else { 0.0 };
    BicubicPatch::from_list(std::array::from_fn(|i| DVec3::new((i % 4) as f64, 2.0 * (i / 4) as f64, z(i))))
}

/// Patch 20 of the 1991 teapot: a quarter of the lid's knob, its first row collapsed in the tip.
fn lid_tip() -> BicubicPatch {
    let row = |r: f64, z: f64| {
        let k = 0.5625 * r;
        [DVec3::new(r, 0.0, z), DVec3::new(r, -k, z), DVec3::new(k, -r, z), DVec3::new(0.0, -r, z)]
    };
    BicubicPatch { points: [row(0.0, 3.15), row(0.8, 3.15), row(0.0, 2.85), row(0.2, 2.7)] }
}

#[test]
fn the_sample_patch_has_its_worked_points() {
    let patch = sample_patch();
    let expected = [
        (0.5, 0.5, [1.5, 3.0, 1.6875]),
        (0.25, 0.25, [0.75, 1.5, 0.949219]),
        (0.5, 0.25, [1.5, 1.5, 1.265625]),
        (0.25, 0.5, [0.75, 3.0, 1.265625]),
        (1.0, 1.0, [3.0, 6.0, 0.0]),
        (0.75, 0.0, [2.25, 0.0, 0.0]),
    ];
    for (u, v, point) in expected {
        assert_close3(patch.at(u, v), point.into(), 5e-7);
        assert_close3(patch.at_by_matrix(u, v), point.into(), 5e-7);
    }
    assert_close3(patch.normal(0.5, 0.5).unwrap(), DVec3::Z, 1e-15);
    assert_eq!(patch.bounds(), Aabb { min: DVec3::ZERO, max: vec3(3, 6, 3) });
}

#[test]
fn weights_of_any_degree_are_binomial() {
    assert_eq!(bernstein(0, 0.3), [1.0]);
    let quintic = bernstein(5, 0.25);
    let binomials = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    for (i, w) in quintic.iter().enumerate() {
        let expected = binomials[i] * 0.25f64.powi(i as i32) * 0.75f64.powi(5 - i as i32);
        assert!((w - expected).abs() < 1e-15);
    }
    assert_eq!(bernstein(3, 0.5), bernstein_cubic(0.5));
}

#[test]
fn the_matrix_is_the_printed_one() {
    let rows = [[-1.0, 3.0, -3.0, 1.0], [3.0, -6.0, 3.0, 0.0], [-3.0, 3.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    assert_eq!(BEZIER_MATRIX, DMat4::from_cols_array_2d(&rows).transpose());
    assert_eq!(BEZIER_MATRIX, BEZIER_MATRIX.transpose());
}

#[test]
fn empty_and_single_curves() {
    assert_eq!(de_casteljau::<DVec3>(&[], 0.5), None);
    assert_eq!(de_casteljau(&[DVec2::ONE], 0.5), Some(DVec2::ONE));
    assert_eq!(split_curve::<f64>(&[], 0.5), (vec![], vec![]));
}

#[test]
fn curve_bounds_touch_the_curve() {
    let curve = CubicCurve { points: [vec3(0, 0, 0), vec3(0, 4, 0), vec3(3, 4, -1), vec3(3, 0, 0)] };
    let bounds = curve.bounds();
    assert!((bounds.max.y - 3.0).abs() < 1e-15 && bounds.min.y == 0.0 && bounds.max.x == 3.0);
}

#[test]
fn tangents_survive_coincident_control_points() {
    let start = vec3(1, 1, 1);
    let curve = CubicCurve { points: [start, start, vec3(3, 1, 1), vec3(4, 2, 1)] };
    assert_close3(curve.tangent(0.0).unwrap(), DVec3::X, 1e-12);
    let mirrored = CubicCurve { points: [vec3(4, 2, 1), vec3(3, 1, 1), start, start] };
    assert_close3(mirrored.tangent(1.0).unwrap(), -DVec3::X, 1e-12);
    let straight = CubicCurve { points: [start, start, vec3(3, 1, 1), vec3(3, 1, 1)] };
    assert_close3(straight.tangent(1.0).unwrap(), DVec3::X, 1e-12);
    let three = CubicCurve { points: [start, start, start, vec3(1, 5, 1)] };
    assert_close3(three.tangent(0.0).unwrap(), DVec3::Y, 1e-12);
    assert!(CubicCurve { points: [start; 4] }.tangent(0.5).is_none());
}

#[test]
fn normals_survive_a_collapsed_row() {
    let tip = lid_tip();
    for u in [0.0, 0.3, 1.0] {
        assert_eq!(tip.evaluate(u, 0.0).du, DVec3::ZERO);
        let limit = tip.normal(u, 0.0).unwrap();
        assert_close3(limit, DVec3::Z * limit.z.signum(), 1e-12);
        assert_close3(tip.normal(u, 1e-5).unwrap(), limit, 1e-3);
    }
    let mut upside_down = tip;
    upside_down.points.reverse();
    assert_close3(upside_down.normal(0.4, 1.0).unwrap(), -tip.normal(0.4, 0.0).unwrap(), 1e-12);
    let sideways = tip.transposed();
    assert_close3(sideways.normal(0.0, 0.4).unwrap(), -tip.normal(0.4, 0.0).unwrap(), 1e-12);
    assert!(BicubicPatch { points: [[DVec3::ONE; 4]; 4] }.normal(0.5, 0.5).is_none());
    let line = BicubicPatch::from_list(std::array::from_fn(|i| DVec3::X * i as f64));
    assert!(line.normal(0.5, 0.5).is_none());
    let mut cornered = sample_patch();
    cornered.points[0][1] = cornered.points[0][0];
    cornered.points[1][0] = cornered.points[0][0];
    assert!(cornered.normal(0.0, 0.0).is_some());
}

#[test]
fn halves_of_a_smooth_patch_meet_in_every_continuity() {
    let patch = sample_patch();
    let (left, right) = patch.split_u(0.5);
    let seam = Seam::between(&left, PatchEdge::UMax, &right, PatchEdge::UMin);
    assert_eq!(seam.continuity(1e-12, 1e-9), Continuity::C1);
    assert!(seam.normal_angle < 1e-9);
    let turned = BicubicPatch {
        points: right.transposed().points.map(|mut row| {
            row.reverse();
            row
        }),
    };
    let seam = Seam::between(&left, PatchEdge::UMax, &turned, PatchEdge::VMin);
    assert_eq!(seam.continuity(1e-12, 1e-9), Continuity::C1);

    let (narrow, wide) = patch.split_u(0.25);
    let seam = Seam::between(&narrow, PatchEdge::UMax, &wide, PatchEdge::UMin);
    assert_eq!(seam.continuity(1e-9, 1e-6), Continuity::G1);
    assert_eq!(
        Seam::between(&narrow, PatchEdge::UMin, &wide, PatchEdge::UMax).continuity(1e-9, 1e-6),
        Continuity::Gap
    );

    let mut creased = right;
    creased.points[1][1].z += 1.0;
    let seam = Seam::between(&left, PatchEdge::UMax, &creased, PatchEdge::UMin);
    assert_eq!(seam.continuity(1e-9, 1e-3), Continuity::C0);
    assert!(seam.normal_angle > 0.01);
    assert!(Continuity::Gap < Continuity::C0 && Continuity::G1 < Continuity::C1);
    assert_eq!(left.edge(PatchEdge::UMax), right.edge(PatchEdge::UMin));
}

#[test]
fn steps_keep_the_tolerance() {
    let curve = CubicCurve { points: [vec3(0, 0, 0), vec3(0, 4, 0), vec3(3, 4, -1), vec3(3, 0, 0)] };
    for tolerance in [0.5, 0.01, 0.0001] {
        let steps = curve.steps_for(tolerance);
        for k in 0..steps {
            let t = |k: f64| k / f64::from(steps);
            let (a, b) = (curve.at(t(f64::from(k))), curve.at(t(f64::from(k) + 1.0)));
            let middle = curve.at(t(f64::from(k) + 0.5));
            assert!((middle - 0.5 * (a + b)).length() <= tolerance);
        }
    }
    let straight = CubicCurve { points: [vec3(0, 0, 0), vec3(1, 0, 0), vec3(2, 0, 0), vec3(3, 0, 0)] };
    assert_eq!(straight.steps_for(1e-9), 1);
    assert_eq!(curve.steps_for(0.0), 65_536);
    assert_eq!(CubicCurve { points: [DVec3::NAN; 4] }.steps_for(0.1), 1);
    assert!(sample_patch().steps_for(0.01)[0] > 5);
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-5.0..5.0f64).prop_map(DVec3::from)
}

proptest! {
    #[test]
    fn all_forms_of_a_curve_agree(points in prop::array::uniform4(point()), t in 0.0..=1.0f64) {
        let curve = CubicCurve { points };
        let p = curve.at(t);
        prop_assert!((p - curve.at_by_matrix(t)).length() < 1e-12);
        prop_assert!((p - de_casteljau(&points, t).unwrap()).length() < 1e-12);
        prop_assert!(curve.bounds().including(p).diagonal() <= curve.bounds().diagonal() + 1e-9);
        let h = 1e-6;
        prop_assert!(((curve.at(t + h) - curve.at(t - h)) / (2.0 * h) - curve.derivative(t)).length() < 1e-6);
        let slope = (curve.derivative(t + h) - curve.derivative(t - h)) / (2.0 * h);
        prop_assert!((slope - curve.second_derivative(t)).length() < 1e-5);
    }

    #[test]
    fn halves_are_the_curve(points in prop::array::uniform4(point()), at in 0.0..=1.0f64, t in 0.0..=1.0f64) {
        let curve = CubicCurve { points };
        let (below, above) = curve.split(at);
        prop_assert!((below.at(t) - curve.at(t * at)).length() < 1e-12);
        prop_assert!((above.at(t) - curve.at(at + t * (1.0 - at))).length() < 1e-12);
        let (low, high) = split_curve(&points, at);
        prop_assert!(low.iter().zip(below.points).all(|(a, b)| (*a - b).length() < 1e-12));
        prop_assert!(high.iter().zip(above.points).all(|(a, b)| (*a - b).length() < 1e-12));
    }

    #[test]
    fn all_forms_of_a_patch_agree(
        points in prop::collection::vec(point(), 16),
        u in 0.0..=1.0f64,
        v in 0.0..=1.0f64,
        at in 0.0..=1.0f64,
    ) {
        let patch = BicubicPatch::from_list(points.try_into().unwrap());
        let p = patch.at(u, v);
        prop_assert!((p - patch.at_by_matrix(u, v)).length() < 1e-11);
        prop_assert!((p - patch.curve_along_u(v).at(u)).length() < 1e-12);
        prop_assert!((p - patch.curve_along_v(u).at(v)).length() < 1e-12);
        let e = patch.evaluate(u, v);
        prop_assert!((e.du - patch.curve_along_u(v).derivative(u)).length() < 1e-12);
        prop_assert!((e.dv - patch.curve_along_v(u).derivative(v)).length() < 1e-12);
        let h = 1e-5;
        let mixed = (patch.evaluate(u, v + h).du - patch.evaluate(u, v - h).du) / (2.0 * h);
        prop_assert!((mixed - e.duv).length() < 1e-5);
        let (low, high) = patch.split_v(at);
        prop_assert!((low.at(u, v) - patch.at(u, v * at)).length() < 1e-11);
        prop_assert!((high.at(u, v) - patch.at(u, at + v * (1.0 - at))).length() < 1e-11);
        prop_assert!(patch.bounds().including(p).diagonal() <= patch.bounds().diagonal() + 1e-12);
    }
}
