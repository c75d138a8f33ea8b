//! What holds for every surface, checked on all of them.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use senca_math::glam::{DMat4, DQuat};
use senca_scene::{Mesh, Shape, TessellationSettings, Tolerance, tessellate};

use super::*;

fn points2(list: &[(f64, f64)]) -> Vec<DVec2> {
    list.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
}

/// A star with `n` tips.
fn star(n: u32) -> Vec<DVec2> {
    let corner = |i: u32| {
        let radius = if i.is_multiple_of(2) { 1.5 } else { 0.6 };
        radius * DVec2::from_angle(0.1 + PI * f64::from(i) / f64::from(n))
    };
    (0..2 * n).map(corner).collect()
}

/// The profile of a ball of radius 1 around (0, 1), as cubic pieces.
fn ball_profile() -> Vec<DVec2> {
    let k = 4.0 / 3.0 * (2f64.sqrt() - 1.0);
    points2(&[(0.0, 0.0), (k, 0.0), (1.0, 1.0 - k), (1.0, 1.0), (1.0, 1.0 + k), (k, 2.0), (0.0, 2.0)])
}

/// A vase whose profile goes in and out, closed at the bottom, open at the top.
fn vase_profile() -> Vec<DVec2> {
    points2(&[
        (0.0, 0.0),
        (0.5, 0.0),
        (1.4, -0.1),
        (1.3, 0.6),
        (1.2, 1.3),
        (0.1, 1.2),
        (0.4, 1.8),
        (0.5, 2.0),
        (0.7, 2.1),
        (0.9, 2.0),
    ])
}

fn polygon() -> Shape {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.8);
    let flat = |p: &DVec2| turn * DVec3::new(p.x, p.y, 0.3);
    let hole = points2(&[(0.2, 0.2), (-0.3, 0.1), (0.0, -0.35)]);
    Shape::Polygon {
        outline: star(7).iter().map(flat).collect(),
        holes: vec![hole.iter().map(flat).collect()],
    }
}

/// Implicit surfaces: a ball and a rounded cube within their box, and a ball whose cap the box cuts off.
/// Their roots may differ in the last digits with the ray's limits.
fn implicit_shapes() -> Vec<Shape> {
    let within = |formula: &str, top: f64| {
        let bounds = Aabb { min: DVec3::splat(-1.3), max: DVec3::new(1.3, top, 1.3) };
        let surface = senca_scene::ImplicitSurface::new(formula.parse().unwrap());
        Shape::Implicit(senca_scene::ImplicitSurface { bounds, ..surface })
    };
    vec![
        within("x^2 + y^2 + z^2 - 1", 1.3),
        within("x^4 + y^4 + z^4 - 1 + 0.2*x*y*z", 1.3),
        within("x^2 + y^2 + z^2 - 1", 0.6),
    ]
}

fn revolution(profile: Vec<DVec2>, bezier: bool, angle: f64) -> Shape {
    Shape::Revolution { profile, bezier, angle, capped: true }
}

/// Closed bodies with their volumes.
fn bodies() -> Vec<(Shape, f64)> {
    let cone = |r: f64, s: f64, h: f64| PI * h / 3.0 * (r * r + r * s + s * s);
    let ring = points2(&[(0.5, 0.2), (1.2, 0.0), (1.4, 0.9), (0.6, 1.1), (0.5, 0.2)]);
    let spool = points2(&[(0.0, 0.0), (1.0, 0.0), (0.3, 1.0), (1.2, 2.0), (0.0, 2.0)]);
    let star_area = senca_math::polygon::signed_area(&star(5));
    let ring_volume = {
        // Pappus: area times the way of the centroid, from the signed triangles with the origin.
        let doubled = ring.windows(2).map(|p| p[0].perp_dot(p[1]) * (p[0].x + p[1].x)).sum::<f64>();
        TAU * doubled / 6.0
    };
    vec![
        (Shape::Sphere { radius: 1.3 }, 4.0 / 3.0 * PI * 1.3f64.powi(3)),
        (Shape::Ellipsoid { radii: DVec3::new(0.5, 1.0, 1.7) }, 4.0 / 3.0 * PI * 0.85),
        (Shape::Box { size: DVec3::new(1.0, 2.0, 0.7) }, 1.4),
        (Shape::Cylinder { radius: 0.8, height: 1.9, capped: true }, cone(0.8, 0.8, 1.9)),
        (Shape::Cone { radius: 1.1, top_radius: 0.0, height: 1.6, capped: true }, cone(1.1, 0.0, 1.6)),
        (Shape::Cone { radius: 0.0, top_radius: 0.9, height: 1.2, capped: true }, cone(0.0, 0.9, 1.2)),
        (Shape::Cone { radius: 1.1, top_radius: 0.4, height: 1.2, capped: true }, cone(1.1, 0.4, 1.2)),
        (Shape::Torus { major_radius: 1.0, minor_radius: 0.35 }, 2.0 * PI * PI * 0.35f64.powi(2)),
        (Shape::Prism { base: star(5), height: 0.9, capped: true }, 0.9 * star_area),
        (revolution(spool, false, TAU), cone(1.0, 0.3, 1.0) + cone(0.3, 1.2, 1.0)),
        (revolution(ring.clone(), false, TAU), ring_volume),
        // The cubic pieces reach out of the ball by less than 3e-4.
        (revolution(ball_profile(), true, TAU), 4.0 / 3.0 * PI),
        (revolution(ball_profile(), true, 4.0), 8.0 / 3.0),
        (revolution(ball_profile(), true, PI), 2.0 / 3.0 * PI),
        (revolution(ring, false, 1.2), ring_volume * 1.2 / TAU),
    ]
}

/// All kinds of shapes, open ones too.
fn shapes() -> Vec<Shape> {
    let mut all: Vec<Shape> = bodies().into_iter().map(|(shape, _)| shape).collect();
    all.extend([
        Shape::Cylinder { radius: 0.8, height: 1.9, capped: false },
        Shape::Cone { radius: 1.1, top_radius: 0.4, height: 1.2, capped: false },
        Shape::Disc { radius: 1.5, inner_radius: 0.4 },
        Shape::Plane { size: Some(2.5) },
        polygon(),
        Shape::Prism { base: star(20), height: 0.9, capped: false },
        revolution(vase_profile(), true, TAU),
        revolution(vase_profile(), true, 4.0),
        revolution(points2(&[(1.0, 0.0), (1.2, 0.4), (1.1, 0.8), (0.3, 1.5)]), false, 2.0),
    ]);
    all
}

fn surface(shape: &Shape) -> Box<dyn Intersect + '_> {
    surface_of(shape, &mut |other| panic!("no surface for {other:?}")).unwrap()
}

fn all_crossings(surface: &dyn Intersect, ray: &Ray) -> Crossings {
    let mut found = Crossings::new();
    surface.crossings(ray, &mut Counters::default(), &mut found);
    found
}

fn line(from: DVec3, direction: DVec3) -> Ray {
    Ray { t_min: f64::NEG_INFINITY, ..Ray::new(from, direction) }
}

/// A ray from anywhere around through somewhere inside the unit ball, directions of any length.
fn rays() -> impl Strategy<Value = Ray> {
    let place = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
    (place(), place(), 0.1..6.0f64, -2.0..2.0f64).prop_filter_map(
        "no direction",
        |(target, from, far, length)| {
            let target = target + DVec3::Y * 0.5;
            let origin = far * from.try_normalize()? + target;
            Some(Ray::new(origin, (target - origin) * 10f64.powf(length)))
        },
    )
}

/// Rays that run along axes, through the axis, and other special ways.
fn special_rays() -> impl Strategy<Value = Ray> {
    let coordinate = || prop::sample::select(vec![-2.0, -1.0, -0.5, 0.0, 0.0, 0.25, 0.5, 1.0, 1.5, 3.0]);
    let place = (coordinate(), coordinate(), coordinate());
    let step = || prop::sample::select(vec![-1.0, 0.0, 0.0, 1.0, 1e-9, -1e-5]);
    (place, (step(), step(), step())).prop_filter_map("no direction", |((x, y, z), (a, b, c))| {
        let direction = DVec3::new(a, b, c);
        (direction != DVec3::ZERO).then(|| line(DVec3::new(x, y, z), direction))
    })
}

fn check_laws(shape: &Shape, ray: &Ray) -> Result<(), TestCaseError> {
    let surface = surface(shape);
    let (found, mut counters) = (all_crossings(&*surface, ray), Counters::default());
    prop_assert!(found.windows(2).all(|pair| pair[0].t <= pair[1].t), "{shape:?} {found:?}");
    prop_assert!(found.iter().all(|c| ray.admits(c.t)));
    let nearest = surface.closest(ray, &mut counters);
    prop_assert_eq!(nearest.map(|c| c.t), found.first().map(|c| c.t));
    prop_assert_eq!(surface.occludes(ray, &mut counters), !found.is_empty());
    prop_assert_eq!(counters.tests, 2);

    let whole = line(ray.origin, ray.direction);
    let found = all_crossings(&*surface, &whole);
    prop_assert!(!surface.is_closed() || found.len().is_multiple_of(2), "{shape:?} {ray:?} {found:?}");
    let bounds = surface.bounds();
    for (i, crossing) in found.iter().enumerate() {
        let met = surface.surface_point(&whole, crossing);
        let scale = 1.0 + whole.origin.length();
        let off = met.point.distance(whole.at(crossing.t));
        prop_assert!(off < 1e-9 * scale, "{shape:?} {ray:?} {crossing:?} off by {off}");
        prop_assert!((met.normal.length() - 1.0).abs() < 1e-12);
        prop_assert!((met.shading_normal.length() - 1.0).abs() < 1e-12);
        let outside = (bounds.min - met.point).max(met.point - bounds.max).max_element();
        prop_assert!(outside < 1e-12, "{shape:?} {outside}");
        // Closed bodies are entered against the normal and left along it, but for rays through edges.
        let against = met.normal.dot(whole.direction.normalize());
        let apart = |k: usize| (found[k].t - crossing.t).abs() * whole.direction.length() > 1e-6;
        let alone = (i == 0 || apart(i - 1)) && (i + 1 == found.len() || apart(i + 1));
        let sense = if i % 2 == 0 { -against } else { against };
        prop_assert!(
            !surface.is_closed() || !alone || sense > -1e-6,
            "{shape:?} {ray:?} {i} {found:?} {met:?}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn laws_hold_for_any_ray(ray in rays(), index in 0..64usize) {
        let shapes = shapes();
        check_laws(&shapes[index % shapes.len()], &ray)?;
    }

    #[test]
    fn laws_hold_for_special_rays(ray in special_rays(), index in 0..64usize) {
        let shapes = shapes();
        check_laws(&shapes[index % shapes.len()], &ray)?;
    }

    #[test]
    fn parameters_are_those_of_the_ray(ray in rays(), index in 0..64usize, factor in -8.0..8.0f64) {
        let shapes = shapes();
        let surface = surface(&shapes[index % shapes.len()]);
        let factor = 10f64.powf(factor);
        let scaled = Ray { direction: ray.direction * factor, ..ray };
        let (found, other) = (all_crossings(&*surface, &ray), all_crossings(&*surface, &scaled));
        prop_assert_eq!(found.len(), other.len());
        for (a, b) in found.iter().zip(&other) {
            prop_assert!((a.t - b.t * factor).abs() <= 1e-7 * a.t.abs());
        }
    }

    #[test]
    fn limits_cut_off_crossings(ray in rays(), index in 0..64usize, low in 0.0..1.0f64, high in 0.0..1.5f64) {
        let shapes = shapes();
        let surface = surface(&shapes[index % shapes.len()]);
        let limited = Ray { t_min: low, t_max: high, ..ray };
        let expected: Vec<f64> =
            all_crossings(&*surface, &ray).iter().map(|c| c.t).filter(|t| limited.admits(*t)).collect();
        let found: Vec<f64> = all_crossings(&*surface, &limited).iter().map(|c| c.t).collect();
        prop_assert_eq!(&found, &expected);
        prop_assert_eq!(surface.closest(&limited, &mut Counters::default()).map(|c| c.t), expected.first().copied());
    }
}

/// Lines that once had an odd number of crossings: through a pole, almost level through a rim, and
/// along the equator of a torus.
#[test]
fn crossings_stay_even_in_special_places() {
    let (spool, ring) = (&bodies()[9].0, &bodies()[10].0);
    let torus = Shape::Torus { major_radius: 1.0, minor_radius: 0.35 };
    let cases = [
        (spool, DVec3::ZERO, DVec3::new(-1.0, 1.0, -1.0)),
        (ring, DVec3::new(-1.0, 0.0, -0.5), DVec3::new(-1.0, 1e-9, -1.0)),
        (&torus, DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1e-9, 0.0, 1.0)),
    ];
    for (shape, origin, direction) in cases {
        let found = all_crossings(&*surface(shape), &line(origin, direction));
        assert!(!found.is_empty() && found.len().is_multiple_of(2), "{shape:?} {found:?}");
    }
}

#[test]
fn rays_that_are_not_valid_meet_nothing() {
    let good = Ray::new(DVec3::new(0.1, 0.3, -5.0), DVec3::Z);
    let bad = [
        Ray { origin: DVec3::NAN, ..good },
        Ray { origin: DVec3::new(f64::INFINITY, 0.0, 0.0), ..good },
        Ray { direction: DVec3::ZERO, ..good },
        Ray { direction: DVec3::NAN, ..good },
        Ray { direction: DVec3::new(0.0, f64::INFINITY, 0.0), ..good },
        Ray { t_min: f64::NAN, ..good },
        Ray { t_max: f64::NAN, ..good },
        Ray { t_max: -1.0, ..good },
    ];
    for shape in shapes() {
        let surface = surface(&shape);
        for ray in &bad {
            assert!(all_crossings(&*surface, ray).is_empty(), "{shape:?} {ray:?}");
            assert!(surface.closest(ray, &mut Counters::default()).is_none(), "{shape:?} {ray:?}");
            assert!(!surface.occludes(ray, &mut Counters::default()), "{shape:?} {ray:?}");
        }
    }
}

/// Length of all stretches inside, per cross-section of parallel rays: the volume.
fn volume(surface: &dyn Intersect, turn: DQuat) -> f64 {
    const N: u32 = 150;
    let bounds = surface.bounds();
    let (center, radius) = (bounds.center(), 0.5 * bounds.diagonal());
    let step = 2.0 * radius / f64::from(N);
    let mut sum = 0.0;
    for i in 0..N * N {
        let offset = |k: u32| (f64::from(k) + 0.5) * step - radius;
        let ray = line(center + turn * DVec3::new(offset(i % N), offset(i / N), 0.0), turn * DVec3::Z);
        sum += all_crossings(surface, &ray).chunks_exact(2).map(|pair| pair[1].t - pair[0].t).sum::<f64>();
    }
    sum * step * step
}

#[test]
fn volumes_are_those_of_the_closed_forms() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    for (shape, expected) in bodies() {
        let found = volume(&*surface(&shape), turn);
        assert!((found / expected - 1.0).abs() < 2e-3, "{shape:?}: {found} instead of {expected}");
    }
}

/// A crossing with a mesh: parameter, triangle, weights.
fn meet_mesh(mesh: &Mesh, ray: &Ray) -> Option<(f64, usize, DVec2)> {
    let mut nearest: Option<(f64, usize, DVec2)> = None;
    for (i, corners) in mesh.faces.iter().enumerate() {
        let corners = [0, 1, 2].map(|k| mesh.position(corners[k]).as_dvec3());
        if let Some((t, uv)) = ray_triangle(ray, corners)
            && ray.admits(t)
            && nearest.is_none_or(|n| t < n.0)
        {
            nearest = Some((t, i, uv));
        }
    }
    nearest
}

/// Whether neighbouring rays agree that the surface is met, or not, at about the same parameter and
/// on the same side of edges: away from silhouettes and borders.
fn is_clear(surface: &dyn Intersect, ray: &Ray, margin: f64) -> bool {
    let at = |offset: DVec3| {
        let ray = Ray { origin: ray.origin + margin * offset, ..*ray };
        let met = surface.closest(&ray, &mut Counters::default())?;
        Some((met.t * ray.direction.length(), surface.surface_point(&ray, &met)))
    };
    let middle = at(DVec3::ZERO);
    let agrees = |offset: DVec3| match (&middle, at(offset)) {
        (None, None) => true,
        (Some((t, met)), Some((t2, met2))) => {
            (t - t2).abs() < 8.0 * margin && met.normal.dot(met2.normal) > 0.9 && met.surface == met2.surface
        }
        _ => false,
    };
    [DVec3::X, DVec3::Y, DVec3::Z].iter().all(|&axis| agrees(axis) && agrees(-axis))
}

fn check_mesh(shape: &Shape, mesh: &Mesh, ray: &Ray) {
    let surface = surface(shape);
    if !is_clear(&*surface, ray, 0.02) {
        return;
    }
    let (exact, drawn) = (surface.closest(ray, &mut Counters::default()), meet_mesh(mesh, ray));
    assert_eq!(exact.is_some(), drawn.is_some(), "{shape:?} {ray:?} {exact:?} {drawn:?}");
    let (Some(exact), Some((t, face, weights))) = (exact, drawn) else { return };
    assert!((exact.t - t).abs() * ray.direction.length() < 0.02, "{shape:?} {ray:?} {exact:?} {t}");
    let met = surface.surface_point(ray, &exact);
    // The sides of an implicit surface's box are surfaces of its mesh, for their creases only.
    if !matches!(shape, Shape::Implicit(_)) {
        assert_eq!(met.surface, mesh.faces.surface_of(face), "{shape:?} {ray:?}");
    }

    let corners = mesh.faces.corners_of(face);
    let weights = [1.0 - weights.x - weights.y, weights.x, weights.y];
    let blend = |value: &dyn Fn(usize) -> DVec3| -> DVec3 {
        corners.iter().zip(weights).map(|(&c, w)| value(c as usize) * w).sum()
    };
    let normal = blend(&|c| mesh.vertices.normal[c].as_dvec3()).normalize();
    assert!(met.shading_normal.dot(normal) > 0.99, "{shape:?} {ray:?} {met:?} {normal}");
    // Where a picture's row shrinks to a point, u of the mesh is that of the step's middle.
    if met.tangent.length() > 1.0 {
        let uv = blend(&|c| mesh.vertices.texcoord0[c].as_dvec2().extend(0.0)).truncate();
        let off = (met.texcoords[0] - uv).abs();
        assert!(off.x.min((1.0 - off.x).abs()) < 0.02 && off.y < 0.02, "{shape:?} {ray:?} {met:?} {uv}");
    }
}

#[test]
fn rays_meet_what_rasterizers_draw() {
    let settings =
        TessellationSettings { tolerance: Tolerance::Steps(72, 36), ..TessellationSettings::default() };
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for shape in shapes().into_iter().chain(implicit_shapes()) {
        let mesh = tessellate(&shape, &settings).unwrap();
        for _ in 0..40 {
            let ray = rays().new_tree(&mut runner).unwrap().current();
            check_mesh(&shape, &mesh, &ray);
        }
    }
}

/// Derivatives by differences: along u the place moves as the tangent says, and with the sign of the
/// bitangent v falls.
#[test]
fn tangents_follow_u_and_bitangents_run_up_the_picture() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut checked = 0;
    for shape in shapes().into_iter().chain(implicit_shapes()) {
        let surface = surface(&shape);
        for _ in 0..20 {
            let ray = rays().new_tree(&mut runner).unwrap().current();
            if !is_clear(&*surface, &ray, 0.01) {
                continue;
            }
            let Some(crossing) = surface.closest(&ray, &mut Counters::default()) else { continue };
            let met = surface.surface_point(&ray, &crossing);
            let (up, step) = (met.handedness * met.normal.cross(met.tangent), 1e-5);
            let moved = |by: DVec3| {
                let ray = Ray { origin: ray.origin + by, ..ray };
                let crossing = surface.closest(&ray, &mut Counters::default()).unwrap();
                surface.surface_point(&ray, &crossing).texcoords[0] - met.texcoords[0]
            };
            let along = moved(met.tangent.normalize() * step);
            assert!((along.x * met.tangent.length() / step - 1.0).abs() < 1e-2, "{shape:?} {ray:?} {along}");
            assert!(moved(up.normalize() * step).y < 0.0, "{shape:?} {ray:?}");
            checked += 1;
        }
    }
    assert!(checked > 100);
}

#[test]
fn shapes_out_of_range_are_refused() {
    let refused = [
        Shape::Sphere { radius: 0.0 },
        Shape::Ellipsoid { radii: DVec3::new(1.0, -1.0, 1.0) },
        Shape::Box { size: DVec3::new(1.0, f64::NAN, 1.0) },
        Shape::Cylinder { radius: 1.0, height: f64::INFINITY, capped: true },
        Shape::Cone { radius: 0.0, top_radius: 0.0, height: 1.0, capped: true },
        Shape::Torus { major_radius: -1.0, minor_radius: 1.0 },
        Shape::Disc { radius: 1.0, inner_radius: 1.0 },
        Shape::Plane { size: Some(0.0) },
        Shape::Polygon { outline: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], holes: vec![] },
        Shape::Prism { base: points2(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]), height: 1.0, capped: true },
        revolution(points2(&[(-1.0, 0.0), (1.0, 1.0)]), false, TAU),
        revolution(points2(&[(1.0, 0.0), (1.0, 0.0)]), false, TAU),
        revolution(points2(&[(1.0, 0.0), (1.0, 1.0)]), true, TAU),
        revolution(points2(&[(1.0, 0.0), (1.0, 1.0)]), false, 7.0),
    ];
    for shape in refused {
        let traced = surface_of(&shape, &mut |_| panic!("not a mesh")).map(|_| ()).unwrap_err();
        let drawn = tessellate(&shape, &TessellationSettings::default()).map(|_| ()).unwrap_err();
        // The same words; NaN is not equal to itself.
        assert_eq!(traced.to_string(), drawn.to_string());
    }
}

#[test]
fn transformed_rays_keep_their_parameters() {
    let object_from_world = DMat4::from_scale(DVec3::new(0.5, 2.0, 1.0)) * DMat4::from_rotation_z(0.4);
    let ray = Ray::new(DVec3::new(0.2, 0.1, -6.0), DVec3::new(0.0, 0.01, 2.0));
    let sphere = Sphere::new(1.0);
    let found = sphere.closest(&ray.transformed(&object_from_world), &mut Counters::default()).unwrap();
    let in_object = object_from_world.transform_point3(ray.at(found.t));
    assert!((in_object.length() - 1.0).abs() < 1e-12);
}
