use std::f64::consts::FRAC_1_SQRT_2;

use proptest::prelude::*;

use super::*;
use crate::bezier::de_casteljau;
use crate::test_support::{assert_close3, vec3};

/// A full circle of nine points in the plane xy.
fn circle() -> (KnotVector, Vec<DVec3>, Vec<f64>) {
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
    let ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let points = ring.iter().map(|&(x, y)| vec3(x, y, 0)).collect();
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 }).collect();
    (KnotVector::new(2, knots).unwrap(), points, weights)
}

#[test]
fn a_rational_quadratic_is_a_true_circle() {
    let (knots, points, weights) = circle();
    let curve = NurbsCurve::new(knots, &points, Some(&weights)).unwrap();
    for k in 0..=64 {
        let (p, d) = curve.at_with_derivative(f64::from(k) / 16.0);
        assert!((p.length() - 1.0).abs() < 1e-15 && p.dot(d).abs() < 1e-14);
        assert!(p.cross(d).z > 0.0);
    }
    assert_close3(curve.at(0.5), DVec3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0), 1e-15);
    assert_eq!(curve.at(-7.0), curve.at(0.0));
    assert_eq!(curve.at(f64::NAN), curve.at(0.0));
    let pieces = curve.bezier_pieces();
    assert_eq!(pieces.len(), 4);
    assert_eq!(pieces[2].interval, [2.0, 3.0]);
    assert!((pieces[2].points[0] - curve.points()[4]).length() < 1e-15);
}

#[test]
fn a_surface_of_revolution_is_a_true_cylinder_and_sphere() {
    let (knots, ring, weights) = circle();
    let line = KnotVector::clamped_uniform(1, 2).unwrap();
    let both: Vec<_> = [0.0, 3.0].iter().flat_map(|z| ring.iter().map(move |p| *p + DVec3::Z * *z)).collect();
    let cylinder = NurbsSurface::new(knots.clone(), line, &both, Some(&weights.repeat(2))).unwrap();
    assert_close3(cylinder.normal(0.5, 0.3).unwrap(), vec3(1, 1, 0).normalize(), 1e-14);
    assert_eq!(cylinder.bezier_patches().len(), 4);

    // A half circle from pole to pole, turned: rows collapse in the poles.
    let half = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)];
    let half_knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
    let mut points = Vec::new();
    let mut all_weights = Vec::new();
    for (j, (r, z)) in half.into_iter().enumerate() {
        for (p, w) in ring.iter().zip(&weights) {
            points.push(DVec3::new(p.x * f64::from(r), p.y * f64::from(r), f64::from(z)));
            all_weights.push(w * if j % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 });
        }
    }
    let sphere = NurbsSurface::new(knots, half_knots, &points, Some(&all_weights)).unwrap();
    for (u, v) in [(0.1, 0.7), (2.0, 1.0), (3.9, 1.9), (0.3, 0.0), (1.0, 2.0), (4.0, 0.0)] {
        let p = sphere.at(u, v);
        assert!((p.length() - 1.0).abs() < 1e-14);
        assert_close3(sphere.normal(u, v).unwrap(), p, 1e-9);
    }
    let patches = sphere.bezier_patches();
    assert_eq!(patches.len(), 8);
    assert!(patches.iter().all(|patch| (patch.at(0.3, 0.6).length() - 1.0).abs() < 1e-14));
    assert!(patches[0].to_bicubic().is_none());
    assert!(sphere.bounds().including(DVec3::ONE) == sphere.bounds());
}

#[test]
fn a_bezier_patch_is_a_nurbs_surface_and_back() {
    let points: Vec<_> =
        (0..16).map(|i| DVec3::new((i % 4) as f64, (i / 4) as f64, (i * i % 7) as f64)).collect();
    let knots = || KnotVector::clamped_uniform(3, 4).unwrap();
    let surface = NurbsSurface::new(knots(), knots(), &points, None).unwrap();
    let patches = surface.bezier_patches();
    assert_eq!(patches.len(), 1);
    let bicubic = patches[0].to_bicubic().unwrap();
    assert_eq!(bicubic.points.as_flattened(), points);
    assert_close3(bicubic.at(0.3, 0.8), surface.at(0.3, 0.8), 1e-14);
    assert_close3(bicubic.normal(0.3, 0.8).unwrap(), surface.normal(0.3, 0.8).unwrap(), 1e-13);
    let (a, b) = (bicubic.evaluate(0.3, 0.8), surface.evaluate(0.3, 0.8));
    assert_close3(a.du, b.du, 1e-13);
    assert_close3(a.duv, b.duv, 1e-12);
}

#[test]
fn low_degrees_are_raised_without_change() {
    let points: Vec<_> =
        (0..6).map(|i| DVec3::new((i % 2) as f64, (i / 2) as f64, (i * i % 5) as f64)).collect();
    let (u, v) = (KnotVector::clamped_uniform(1, 2).unwrap(), KnotVector::clamped_uniform(2, 3).unwrap());
    let surface = NurbsSurface::new(u, v, &points, None).unwrap();
    let patch = surface.bezier_patches()[0].to_bicubic().unwrap();
    for (u, v) in [(0.0, 0.0), (0.2, 0.9), (1.0, 0.4)] {
        assert_close3(patch.at(u, v), surface.at(u, v), 1e-14);
    }
}

#[test]
fn mistakes_in_knots_are_named() {
    let error = |degree, knots: &[f64]| KnotVector::new(degree, knots.to_vec()).unwrap_err();
    assert_eq!(error(0, &[0.0; 9]), NurbsError::Degree(0));
    assert_eq!(error(33, &[0.0; 9]), NurbsError::Degree(33));
    assert_eq!(error(2, &[0.0; 5]), NurbsError::TooFewKnots { degree: 2, needed: 6, found: 5 });
    assert_eq!(error(1, &[0.0, 0.0, f64::NAN, 1.0]), NurbsError::NotFiniteKnot { index: 2 });
    assert_eq!(error(1, &[0.0, 1.0, 0.5, 1.0]), NurbsError::Decreasing { index: 2 });
    let twice = NurbsError::Multiplicity { knot: 1.0, count: 2, degree: 1 };
    assert_eq!(error(1, &[0.0, 0.0, 1.0, 1.0, 2.0, 2.0]), twice);
    assert!(matches!(error(1, &[0.0, 0.0, 0.0, 1.0, 1.0]), NurbsError::Multiplicity { count: 3, .. }));
    assert_eq!(error(2, &[0.0, 1.0, 2.0, 2.0, 3.0, 4.0]), NurbsError::EmptyDomain(2.0));
    let line = KnotVector::clamped_uniform(1, 2).unwrap();
    let curve = |points: &[DVec3], weights: Option<&[f64]>| {
        NurbsCurve::new(line.clone(), points, weights).unwrap_err()
    };
    assert_eq!(curve(&[DVec3::ZERO], None), NurbsError::PointCount { expected: 2, found: 1 });
    assert_eq!(curve(&[DVec3::ZERO; 2], Some(&[1.0])), NurbsError::WeightCount { expected: 2, found: 1 });
    assert_eq!(curve(&[DVec3::ZERO; 2], Some(&[1.0, 0.0])), NurbsError::Weight { index: 1, weight: 0.0 });
    assert_eq!(curve(&[DVec3::ZERO, DVec3::NAN], None), NurbsError::NotFinitePoint { index: 1 });
    assert!(matches!(KnotVector::clamped_uniform(3, 2), Err(NurbsError::TooFewKnots { .. })));
    assert!(line.bezier_pieces::<DVec3>(&[]).is_empty());
}

prop_compose! {
    fn any_knots()(degree in 1..6usize)(
        degree in Just(degree),
        steps in prop::collection::vec(prop_oneof![Just(0.0), 0.1..2.0f64], 2 * degree + 2..2 * degree + 9),
    ) -> Option<KnotVector> {
        let knots = steps.iter().scan(-1.0, |t, step| { *t += step; Some(*t) }).collect();
        KnotVector::new(degree, knots).ok()
    }
}

proptest! {
    #[test]
    fn the_basis_is_a_partition_of_unity(knots in any_knots(), s in 0.0..=1.0f64) {
        let Some(knots) = knots else { return Ok(()) };
        let [start, end] = knots.domain();
        let t = start + s * (end - start);
        let basis = knots.basis_functions(t);
        prop_assert!((basis.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(basis.iter().all(|b| *b >= -1e-12));
        prop_assert!(knots.basis(t).derivatives().iter().sum::<f64>().abs() < 1e-9);
    }

    #[test]
    fn bezier_pieces_are_the_curve(
        knots in any_knots(),
        seed in prop::collection::vec(prop::array::uniform4(0.2..3.0f64), 30),
        s in 0.0..=1.0f64,
    ) {
        let Some(knots) = knots else { return Ok(()) };
        let count = knots.point_count();
        let points: Vec<DVec3> = seed[..count].iter().map(|p| DVec3::new(p[0], p[1], p[2])).collect();
        let weights: Vec<f64> = seed[..count].iter().map(|p| p[3]).collect();
        let curve = NurbsCurve::new(knots, &points, Some(&weights)).unwrap();
        let pieces = curve.bezier_pieces();
        prop_assert_eq!(pieces[0].interval[0], curve.knots().domain()[0]);
        for piece in &pieces {
            let [a, b] = piece.interval;
            let h = de_casteljau(&piece.points, s).unwrap();
            prop_assert!((h.truncate() / h.w - curve.at(a + s * (b - a))).length() < 1e-9);
        }
        let [a, b] = pieces[0].interval;
        let (t, step) = (a + (0.1 + 0.8 * s) * (b - a), 1e-6 * (b - a));
        let difference = (curve.at(t + step) - curve.at(t - step)) / (2.0 * step);
        let (_, derivative) = curve.at_with_derivative(t);
        prop_assert!((difference - derivative).length() < 1e-4 * (1.0 + derivative.length()));
    }
}
