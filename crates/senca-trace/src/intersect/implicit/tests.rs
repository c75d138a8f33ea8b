use proptest::prelude::*;

use super::super::{Sphere, Torus};
use super::*;
use crate::{Counters, Crossings, Intersect};

const METHODS: [RootMethod; 4] =
    [RootMethod::ClosedForm, RootMethod::Descartes, RootMethod::Sturm, RootMethod::Interval];

fn surface(formula: &str, reach: f64, method: RootMethod) -> Implicit {
    let bounds = Aabb { min: DVec3::splat(-reach), max: DVec3::splat(reach) };
    Implicit::new(formula.parse().unwrap(), bounds, true).unwrap().with_method(method)
}

fn crossings(surface: &impl Intersect, ray: &Ray) -> Crossings {
    let mut found = Crossings::new();
    surface.crossings(ray, &mut Counters::default(), &mut found);
    found
}

fn parameters(surface: &impl Intersect, ray: &Ray) -> Vec<f64> {
    crossings(surface, ray).iter().map(|c| c.t).collect()
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(found.len() == expected.len() && near, "{found:?} instead of {expected:?}");
}

#[test]
fn a_cubic_with_three_crossings() {
    for method in METHODS {
        let cubic = surface("x^3 - 6*x^2 + 11*x - 6 + y^2 + z^2", 10.0, method);
        assert_eq!(cubic.method(), method);
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        let found = crossings(&cubic, &ray);
        assert_near(&found.iter().map(|c| c.t).collect::<Vec<_>>(), &[1.0, 2.0, 3.0], 1e-12);
        let nearest = cubic.closest(&ray, &mut Counters::default()).unwrap();
        assert!((nearest.t - 1.0).abs() < 1e-12);
        // The gradient there is (2, 0, 0).
        let met = Intersect::surface_point(&cubic, &ray, &nearest);
        assert!((met.normal - DVec3::X).length() < 1e-9 && (met.point - DVec3::X).length() < 1e-12);
        let gradient = cubic.expression.value_and_gradient(DVec3::X).1;
        assert_eq!(gradient, DVec3::new(2.0, 0.0, 0.0));
    }
}

#[test]
fn methods_fall_back_where_they_cannot_be_used() {
    let of = |formula, method| surface(formula, 1.0, method).method();
    assert_eq!(of("x^4 + y^2 - z", RootMethod::Automatic), RootMethod::Descartes);
    assert_eq!(of("x^5 + y^2 - z", RootMethod::ClosedForm), RootMethod::Descartes);
    assert_eq!(of("x^20 + y^2 - z", RootMethod::Automatic), RootMethod::Interval);
    assert_eq!(of("x^20 + y^2 - z", RootMethod::Sturm), RootMethod::Sturm);
    assert_eq!(of("sin(x) + y^2 - z", RootMethod::Descartes), RootMethod::Interval);
}

#[test]
fn capped_and_open_boxes() {
    let bounds = Aabb { min: DVec3::new(-1.0, -2.0, -1.0), max: DVec3::new(1.0, 2.0, 1.0) };
    let cylinder = |capped| Implicit::new("x^2 + z^2 - 0.25".parse().unwrap(), bounds, capped).unwrap();
    let along = Ray::new(DVec3::new(0.1, -5.0, 0.0), DVec3::Y);
    assert_eq!(parameters(&cylinder(true), &along), [3.0, 7.0]);
    assert!(parameters(&cylinder(false), &along).is_empty());
    let found = crossings(&cylinder(true), &along);
    let met = Intersect::surface_point(&cylinder(true), &along, &found[0]);
    assert_eq!((met.normal, met.point), (DVec3::NEG_Y, DVec3::new(0.1, -2.0, 0.0)));
    // From inside, the limits of the ray are no caps.
    let inside = Ray::new(DVec3::ZERO, DVec3::Y);
    assert_eq!(parameters(&cylinder(true), &inside), [2.0]);
    let slanted = Ray::new(DVec3::new(-5.0, 1.9, 0.0), DVec3::new(1.0, 0.02, 0.0));
    assert_near(&parameters(&cylinder(true), &slanted), &[4.5, 5.0], 1e-9);
    assert_near(&parameters(&cylinder(false), &slanted), &[4.5], 1e-9);
}

#[test]
fn boxes_must_be_finite_and_not_empty() {
    let with = |min: f64, max: f64| {
        let bounds = Aabb { min: DVec3::splat(min), max: DVec3::splat(max) };
        Implicit::new("x".parse().unwrap(), bounds, true).is_ok()
    };
    assert!(with(-1.0, 1.0) && !with(1.0, 1.0) && !with(1.0, -1.0));
    assert!(!with(f64::NEG_INFINITY, 1.0) && !with(f64::NAN, 1.0));
}

#[test]
fn tips_have_a_normal() {
    let cone = surface("x^2 + z^2 - y^2", 1.0, RootMethod::Automatic);
    let ray = Ray::new(DVec3::new(0.0, 0.0, -0.5), DVec3::Z);
    let met = cone.on_surface(DVec3::ZERO, &ray);
    assert!((met.1.length() - 1.0).abs() < 1e-12);
}

#[test]
fn formulas_that_are_not_defined_everywhere_end() {
    for formula in [
        "sqrt(x) - 0.5",
        "log(y)",
        "1/x",
        "0/0 + x",
        "tan(9*x)*z",
        "sin(1/x)",
        "abs(x)",
        "x*0",
        "sin(500*x*y*z)",
    ] {
        let surface = surface(formula, 1.0, RootMethod::Interval);
        let line = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(DVec3::new(-2.0, 0.1, 0.2), DVec3::X) };
        let found = parameters(&surface, &line);
        assert!(found.len().is_multiple_of(2) && found.iter().all(|t| t.is_finite()), "{formula} {found:?}");
    }
}

#[test]
fn waves_miss_no_crossing() {
    // 1.9 radians each way at frequency 40: crossings at multiples of pi / 40.
    let waves = surface("sin(40*x) + 0*y", 1.9, RootMethod::Interval);
    let line = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(DVec3::new(0.0, 0.3, 0.4), DVec3::X) };
    let found: Vec<f64> =
        crossings(&waves, &line).iter().filter(|c| c.part == SURFACE).map(|c| c.t).collect();
    let expected: Vec<f64> = (-24..=24).map(|k| f64::from(k) * std::f64::consts::PI / 40.0).collect();
    assert_near(&found, &expected, 1e-12);
}

fn rays() -> impl Strategy<Value = Ray> {
    let place = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
    (place(), place()).prop_filter_map("no direction", |(target, from)| {
        let origin = 4.0 * from.try_normalize()?;
        Some(Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, target - origin) })
    })
}

/// Sign changes on a fine grid of a stretch of the ray, outside of the box positive.
fn sampled(surface: &Implicit, ray: &Ray) -> Vec<f64> {
    const N: u32 = 4000;
    let t = |i: u32| 2.0 * f64::from(i) / f64::from(N);
    let within = |p: DVec3| p.cmpge(surface.bounds.min).all() && p.cmple(surface.bounds.max).all();
    let inside = |i: u32| within(ray.at(t(i))) && surface.expression.value(ray.at(t(i))) < 0.0;
    (0..N).filter(|&i| inside(i) != inside(i + 1)).map(|i| 0.5 * (t(i) + t(i + 1))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn formulas_of_known_shapes(ray in rays(), method in prop::sample::select(METHODS.to_vec())) {
        let sphere = surface("x^2 + y^2 + z^2 - 1.21", 2.0, method);
        let expected = parameters(&Sphere::new(1.1), &ray);
        let found = parameters(&sphere, &ray);
        prop_assert!(found.len() == expected.len() || expected.first().is_some_and(|t| expected[1] - t < 1e-4));
        prop_assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-7));

        let torus = surface("(x^2 + y^2 + z^2 + 0.91)^2 - 4*(x^2 + z^2)", 2.0, method);
        let expected = parameters(&Torus::new(1.0, 0.3), &ray);
        let found = parameters(&torus, &ray);
        let near_touch = expected.windows(2).any(|pair| pair[1] - pair[0] < 1e-3) || found.windows(2).any(|pair| pair[1] - pair[0] < 1e-3);
        prop_assert!(near_touch || found.len() == expected.len(), "{:?} {:?}", found, expected);
        prop_assert!(near_touch || found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn no_crossing_of_a_sampled_ray_is_missed(
        ray in rays(),
        formula in prop::sample::select(vec![
            "sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)",
            "x^6 + y^6 + z^6 - x^2*y*z - 0.3",
            "4*(1.618^2*x^2-y^2)*(1.618^2*y^2-z^2)*(1.618^2*z^2-x^2) - (1+2*1.618)*(x^2+y^2+z^2-1)^2",
            "exp(x*y) - 1.2 + z^2 - abs(x)",
            "(x^2 + 2.25*y^2 + z^2 - 1)^3 - x^2*z^3 - 0.1125*y^2*z^3",
        ]),
    ) {
        let surfaces = [RootMethod::Automatic, RootMethod::Interval].map(|m| surface(formula, 1.3, m));
        for surface in surfaces {
            let found = crossings(&surface, &ray);
            let expected = sampled(&surface, &ray);
            for t in &expected {
                prop_assert!(found.iter().any(|c| (c.t - t).abs() < 1e-3), "{} {:?} {:?}", formula, found, expected);
            }
            prop_assert!(found.len().is_multiple_of(2) && found.len() >= expected.len());
            let nearest = surface.closest(&ray, &mut Counters::default());
            prop_assert!(nearest.map(|c| c.t) == found.first().map(|c| c.t), "{:?} {:?}", nearest, found);
            for (i, crossing) in found.iter().enumerate() {
                let met = Intersect::surface_point(&surface, &ray, crossing);
                prop_assert!((met.normal.length() - 1.0).abs() < 1e-12);
                prop_assert!(met.point.distance(ray.at(crossing.t)) < 1e-6);
                let sense = met.normal.dot(ray.direction) * if i % 2 == 0 { -1.0 } else { 1.0 };
                prop_assert!(sense > -1e-3, "{} {:?} {}", formula, found, i);
            }
        }
    }
}
