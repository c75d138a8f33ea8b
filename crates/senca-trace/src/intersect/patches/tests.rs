use proptest::prelude::*;
use senca_math::glam::{DMat4, DVec2, DVec3};
use senca_scene::{BezierPatch, NurbsSurface, Shape};

use super::*;

/// The teapot as the 1991 thesis gives it.
pub(super) fn teapot() -> Vec<BezierPatch> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../samples/classic/teapot.bez");
    let scene = senca_io::load(std::path::Path::new(path)).unwrap();
    let patches = |shape: &Shape| match shape {
        Shape::BezierPatches { patches } => patches.clone(),
        _ => Vec::new(),
    };
    scene.geometries.iter().flat_map(|g| patches(&g.shape)).collect()
}

pub(super) fn surface(patches: &[BezierPatch]) -> PatchSurface {
    PatchSurface::from_bezier(patches).unwrap()
}

fn all(surface: &PatchSurface, ray: &Ray) -> Crossings {
    let mut out = Crossings::new();
    surface.crossings(ray, &mut Counters::default(), &mut out);
    out
}

fn all_plain(surface: &PatchSurface, ray: &Ray) -> Crossings {
    let mut out = Crossings::new();
    surface.crossings_by_division(ray, &mut out);
    out
}

fn closest(surface: &PatchSurface, ray: &Ray) -> Option<Crossing> {
    surface.closest(ray, &mut Counters::default())
}

/// Hit for hit the same, and on the ray.
fn assert_agree(surface: &PatchSurface, ray: &Ray) -> usize {
    let (fast, plain) = (all(surface, ray), all_plain(surface, ray));
    assert_eq!(fast.len(), plain.len(), "{ray:?}\n{fast:?}\n{plain:?}");
    let scale = surface.scale / ray.direction.length();
    for (a, b) in fast.iter().zip(&plain) {
        assert!((a.t - b.t).abs() <= 1e-9 * scale.max(a.t.abs()), "{ray:?}\n{fast:?}\n{plain:?}");
        let point = surface.surface_point(ray, a);
        assert!(point.point.distance(ray.at(a.t)) < 1e-9 * surface.scale, "{ray:?}");
        assert!((point.normal.length() - 1.0).abs() < 1e-12);
    }
    assert_eq!(closest(surface, ray).map(|c| c.t), fast.first().map(|c| c.t));
    assert_eq!(surface.occludes(ray, &mut Counters::default()), !fast.is_empty());
    fast.len()
}

fn point(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from_array)
}

/// Patches like those of models: a grid, bent.
fn patch() -> impl Strategy<Value = BezierPatch> {
    (prop::collection::vec(point(1.0), 16), 0.0f64..1.5).prop_map(|(noise, amount)| {
        let grid = |i: usize| DVec3::new((i % 4) as f64 - 1.5, (i / 4) as f64 - 1.5, 0.0);
        BezierPatch { points: std::array::from_fn(|i| grid(i) + amount * noise[i]), surface: 0 }
    })
}

fn ray() -> impl Strategy<Value = Ray> {
    (point(4.0), point(2.0)).prop_map(|(from, to)| Ray::new(from, to - from))
}

/// Knots and weights of a surface of any degrees over one or two spans.
fn nurbs() -> impl Strategy<Value = NurbsSurface> {
    let knots = |degree: usize, spans: usize| {
        let ends = |t: f64| std::iter::repeat_n(t, degree + 1);
        ends(0.0).chain((1..spans).map(|i| i as f64)).chain(ends(spans as f64)).collect::<Vec<f64>>()
    };
    let sizes = (1usize..5, 1usize..5, 1usize..3, 1usize..3);
    let weights = prop::collection::vec(0.2f64..3.0, 36);
    (sizes, prop::collection::vec(point(0.6), 36), weights).prop_map(
        move |((pu, pv, su, sv), noise, weights)| {
            let counts = [pu + su, pv + sv];
            let place = |i: usize| {
                let (x, y) = ((i % counts[0]) as f64, (i / counts[0]) as f64);
                let at = |x: f64, n: usize| 3.0 * x / (n - 1) as f64 - 1.5;
                DVec3::new(at(x, counts[0]), at(y, counts[1]), 0.0) + noise[i]
            };
            NurbsSurface {
                degree: [pu, pv],
                knots: [knots(pu, su), knots(pv, sv)],
                counts,
                points: (0..counts[0] * counts[1]).map(place).collect(),
                weights: weights[..counts[0] * counts[1]].to_vec(),
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn both_ways_find_the_same_hits_of_bezier_patches(patch in patch(), rays in prop::collection::vec(ray(), 60)) {
        let surface = surface(&[patch]);
        for ray in &rays {
            assert_agree(&surface, ray);
        }
    }

    #[test]
    fn both_ways_find_the_same_hits_of_rational_patches(nurbs in nurbs(), rays in prop::collection::vec(ray(), 40)) {
        let surface = PatchSurface::from_nurbs(&nurbs).unwrap();
        for ray in &rays {
            assert_agree(&surface, ray);
        }
    }

    #[test]
    fn rays_to_a_place_of_a_patch_meet_it(patch in patch(), from in point(9.0), u in 0.0f64..=1.0, v in 0.0f64..=1.0) {
        let surface = surface(&[patch]);
        let place = surface.surface_point(&Ray::new(DVec3::ZERO, DVec3::X), &Crossing { t: 0.0, part: 0, uv: DVec2::new(u, v) });
        let ray = Ray::new(from, place.point - from);
        let along = ray.direction.normalize().dot(place.normal).abs();
        let met = all(&surface, &ray).iter().any(|c| (c.t - 1.0).abs() < 1e-9 / along);
        prop_assert!(met || along < 1e-5, "{:?}", all(&surface, &ray));
    }
}

/// Rays from all sides through places near the teapot.
pub(super) fn rays_around(count: u32) -> impl Iterator<Item = Ray> {
    // A low-discrepancy sequence in four dimensions.
    let share = |i: u32, base: f64| (f64::from(i) * base).fract();
    (1..=count).map(move |i| {
        let (z, phi) =
            (2.0 * share(i, 0.8566748838545029) - 1.0, std::f64::consts::TAU * share(i, 0.733891856627126));
        let r = (1.0 - z * z).sqrt();
        let from = DVec3::new(r * phi.cos(), r * phi.sin(), z) * 9.0;
        let to = DVec3::new(
            6.0 * share(i, 0.6287067210378087) - 3.0,
            4.0 * share(i, 0.5385972572236101) - 2.0,
            3.2 * share(i, 0.4613989363150103),
        );
        Ray::new(from, to - from)
    })
}

#[test]
fn both_ways_find_the_same_hits_of_the_teapot() {
    let teapot = surface(&teapot());
    let hits: usize = rays_around(600).map(|ray| assert_agree(&teapot, &ray)).sum();
    assert!(hits > 600, "{hits}");
}

#[test]
fn parts_together_are_the_whole() {
    let teapot = surface(&teapot());
    assert_eq!(teapot.part_count(), 32);
    for ray in rays_around(300) {
        let parts = (0..32).filter_map(|part| {
            let hit = teapot.closest_in_part(part, &ray, &mut Counters::default())?;
            let bounds = teapot.part_bounds(part);
            let p = ray.at(hit.t);
            assert!(p.cmpge(bounds.min).all() && p.cmple(bounds.max).all());
            Some(hit)
        });
        let first = parts.min_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        assert_eq!(closest(&teapot, &ray), first);
    }
}

#[test]
fn limits_of_the_ray_are_kept() {
    let teapot = surface(&teapot());
    for ray in rays_around(200) {
        let whole = all(&teapot, &ray);
        for pair in whole.windows(2) {
            let between = Ray { t_min: pair[0].t, t_max: pair[1].t, ..ray };
            assert_eq!(all(&teapot, &between).len(), 0);
            let second = Ray { t_min: 0.5 * (pair[0].t + pair[1].t), ..ray };
            assert_eq!(closest(&teapot, &second), Some(pair[1]));
        }
    }
}

/// Patches of the teapot without openings: body and bottom, seen from above, and lid.
#[test]
fn nothing_slips_through_the_seams_of_the_teapot() {
    let patches = teapot();
    let teapot = surface(&patches);
    let whole = all(&teapot, &Ray::new(DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z));
    assert_eq!(whole.len(), 2, "the tip of the lid and the middle of the bottom: {whole:?}");
    for (number, patch) in patches.iter().enumerate().filter(|(i, _)| (4..12).contains(i) || *i >= 20) {
        let bicubic = senca_math::BicubicPatch::from_list(patch.points);
        for k in 1..60 {
            let t = f64::from(k) / 60.0;
            for (u, v) in [(t, 0.0), (t, 1.0), (0.0, t), (1.0, t)] {
                let (place, Some(normal)) = (bicubic.at(u, v), bicubic.normal(u, v)) else { continue };
                for lean in [DVec3::ZERO, DVec3::new(0.9, 0.2, -0.3), DVec3::new(-0.4, 0.7, 0.5)] {
                    let from = place + 2.0 * (normal + 0.6 * lean);
                    let ray = Ray::new(from, place - from);
                    let near = |c: &Crossing| (c.t - 1.0).abs() < 1e-8;
                    let count = all(&teapot, &ray).iter().filter(|c| near(c)).count();
                    // The rim of the body and the edge of the lid are open.
                    assert!(count >= 1, "patch {number} at {u}, {v}");
                    let first = closest(&teapot, &Ray { t_min: 1.0 - 1e-7, ..ray });
                    assert!(first.is_some_and(|c| near(&c)), "patch {number} at {u}, {v}: {first:?}");
                }
            }
        }
    }
}

/// A ball as a rational surface: a half circle turned about z.
pub(super) fn ball(radius: f64) -> NurbsSurface {
    let w = 0.5f64.sqrt();
    let circle = [
        (1.0, 0.0),
        (1.0, 1.0),
        (0.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 0.0),
        (-1.0, -1.0),
        (0.0, -1.0),
        (1.0, -1.0),
        (1.0, 0.0),
    ];
    let profile = [(0.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let weight = |i: usize| if i % 2 == 1 { w } else { 1.0 };
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (j, (r, z)) in profile.into_iter().enumerate() {
        for (i, (x, y)) in circle.into_iter().enumerate() {
            points.push(radius * DVec3::new(r * x, r * y, z));
            weights.push(weight(i) * weight(j));
        }
    }
    let u = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
    NurbsSurface {
        degree: [2, 2],
        knots: [u, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]],
        counts: [9, 5],
        points,
        weights,
    }
}

#[test]
fn a_rational_ball_is_a_ball() {
    let surface = PatchSurface::from_nurbs(&ball(3.0)).unwrap();
    assert!(surface.is_closed() && surface.part_count() == 8);
    for ray in rays_around(1500) {
        // |o + t d|^2 = 9.
        let (a, b, c) = (
            ray.direction.length_squared(),
            ray.origin.dot(ray.direction),
            ray.origin.length_squared() - 9.0,
        );
        let root = b * b - a * c;
        let hits = all(&surface, &ray);
        if root > 1e-9 {
            let exact = [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a];
            assert_eq!(hits.len(), 2, "{ray:?}");
            for (hit, exact) in hits.iter().zip(exact) {
                let tolerance = 1e-13 * a / root.sqrt() + 1e-13;
                assert!((hit.t - exact).abs() < tolerance, "{} {exact}", hit.t);
                let point = surface.surface_point(&ray, hit);
                assert!(point.normal.distance(ray.at(exact) / 3.0) < 1e-9 * a / root.sqrt());
            }
        } else if root < -1e-9 {
            assert!(hits.is_empty(), "{ray:?}");
        }
    }
}

/// A cube blown up: six patches with common edges, outside out.
fn closed_body() -> Vec<BezierPatch> {
    let bulge = |p: DVec3| p * (1.0 + 0.3 * (1.0 - p.abs().min_element()) + 0.1 * (3.0 * p.x + p.y).sin());
    let turns = [
        DMat4::IDENTITY,
        DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2),
        DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2),
        DMat4::from_rotation_x(std::f64::consts::PI),
        DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DMat4::from_rotation_y(-std::f64::consts::FRAC_PI_2),
    ];
    let exact = |p: DVec3| (3.0 * p).round() / 3.0;
    let side = |turn: DMat4| {
        let place =
            |i: usize| DVec3::new((i % 4) as f64 * 2.0 / 3.0 - 1.0, (i / 4) as f64 * 2.0 / 3.0 - 1.0, 1.0);
        BezierPatch {
            points: std::array::from_fn(|i| bulge(exact(turn.transform_point3(place(i))))),
            surface: 0,
        }
    };
    turns.map(side).to_vec()
}

#[test]
fn crossings_of_a_closed_body_come_in_pairs() {
    let patches = closed_body();
    let body = surface(&patches);
    assert!(body.is_closed());
    assert!(!surface(&patches[1..]).is_closed() && !surface(&teapot()).is_closed());
    let check = |ray: Ray| {
        let hits = all(&body, &ray);
        assert_eq!(hits.len() % 2, 0, "{ray:?}: {hits:?}");
        for (i, hit) in hits.iter().enumerate() {
            let facing = body.surface_point(&ray, hit).normal.dot(ray.direction);
            assert!(if i % 2 == 0 { facing < 0.0 } else { facing > 0.0 }, "{ray:?}: {hits:?}");
        }
        hits.len()
    };
    let crossed: usize = rays_around(1000).map(check).sum();
    assert!(crossed > 500, "{crossed}");
    // Through corners and along all seams, from inside and from far away.
    for patch in &patches {
        let bicubic = senca_math::BicubicPatch::from_list(patch.points);
        for k in 0..=100 {
            let t = f64::from(k) / 100.0;
            for (u, v) in [(t, 0.0), (t, 1.0), (0.0, t), (1.0, t)] {
                let place = bicubic.at(u, v);
                let from_inside = all(
                    &body,
                    &Ray::new(0.1 * DVec3::new(1.0, -0.7, 0.4), place - 0.1 * DVec3::new(1.0, -0.7, 0.4)),
                );
                assert_eq!(from_inside.len(), 1, "{u} {v} {from_inside:?}");
                for from in [DVec3::new(7.0, 8.0, 9.0), DVec3::new(-50.0, 3.0, 20.0)] {
                    check(Ray::new(from, place - from));
                }
            }
        }
    }
}

#[test]
fn patches_without_extent_or_area_are_not_met() {
    let point = BezierPatch { points: [DVec3::ONE; 16], surface: 0 };
    let line = BezierPatch { points: std::array::from_fn(|i| DVec3::X * (i % 4) as f64), surface: 0 };
    let flat = BezierPatch {
        points: std::array::from_fn(|i| DVec3::new((i % 4) as f64, (i / 4) as f64, 0.0)),
        surface: 0,
    };
    assert!(all(&surface(&[]), &Ray::new(DVec3::Z, DVec3::X)).is_empty());
    for patch in [point, line] {
        let degenerate = surface(&[patch]);
        for ray in rays_around(50) {
            assert!(all(&degenerate, &ray).is_empty());
        }
    }
    let flat = surface(&[flat]);
    let within = Ray::new(DVec3::new(-5.0, 1.0, 0.0), DVec3::X);
    assert!(all(&flat, &within).is_empty() && all_plain(&flat, &within).is_empty());
    assert_eq!(all(&flat, &Ray::new(DVec3::new(0.5, 0.5, 7.0), DVec3::NEG_Z)).len(), 1);
}

#[test]
fn bad_rays_meet_nothing_and_bad_patches_are_named() {
    let teapot = surface(&teapot());
    let (o, d) = (DVec3::new(0.0, -9.0, 1.0), DVec3::Y);
    let bad = f64::NAN;
    let rays = [
        Ray::new(o * bad, d),
        Ray::new(o, d * bad),
        Ray::new(o, DVec3::ZERO),
        Ray::new(o, d * f64::INFINITY),
        Ray { t_min: bad, ..Ray::new(o, d) },
        Ray { t_max: -1.0, ..Ray::new(o, d) },
        Ray::new(o * 1e300, d * 1e-300),
    ];
    for ray in rays {
        assert!(all(&teapot, &ray).is_empty() && closest(&teapot, &ray).is_none());
    }
    for scale in [1e-200, 1e-30, 1e30, 1e150] {
        let scaled = closest(&teapot, &Ray::new(o, scale * d)).unwrap();
        let t = closest(&teapot, &Ray::new(o, d)).unwrap().t;
        assert!((scaled.t * scale / t - 1.0).abs() < 1e-12);
    }
    for wrong in [f64::NAN, f64::INFINITY, 1e200] {
        let mut patches = super::tests::teapot();
        patches[7].points[3].y = wrong;
        assert!(PatchSurface::from_bezier(&patches).unwrap_err().to_string().contains("patch 7"));
    }
}

#[test]
fn touching_rays_count_twice_or_not_at_all() {
    let surface = PatchSurface::from_nurbs(&ball(1.0)).unwrap();
    for k in 0..400 {
        let offset = 1.0 + (f64::from(k) - 200.0) * 1e-16 * 4f64.powi(k % 20);
        let phi = 0.1 + 0.01 * f64::from(k);
        let side = DVec3::new(phi.cos(), phi.sin(), 0.3).normalize();
        let along = side.any_orthonormal_vector();
        let hits = all(&surface, &Ray::new(offset * side - 5.0 * along, along));
        assert_eq!(hits.len() % 2, 0, "{offset}: {hits:?}");
        assert!(offset < 1.0 + 1e-12 || hits.is_empty());
        assert!(offset > 1.0 - 1e-12 || hits.len() == 2, "{offset}: {hits:?}");
    }
}

#[test]
fn poles_are_met_once() {
    let surface = PatchSurface::from_nurbs(&ball(1.0)).unwrap();
    for from in [DVec3::Z * 3.0, DVec3::new(1.0, 2.0, 4.0), DVec3::new(0.1, 0.0, -0.5)] {
        let hits = all(&surface, &Ray::new(from, DVec3::Z - from));
        let at_pole = hits.iter().filter(|c| (c.t - 1.0).abs() < 1e-9).count();
        assert_eq!(at_pole, 1, "{from}: {hits:?}");
        let normal = surface
            .surface_point(
                &Ray::new(from, DVec3::Z - from),
                hits.iter().find(|c| (c.t - 1.0).abs() < 1e-9).unwrap(),
            )
            .normal;
        assert!(normal.distance(DVec3::Z) < 1e-6, "{normal}");
    }
}

#[test]
fn more_patches_than_memory_can_bear_are_refused() {
    assert_eq!(super::at_most("patches", 1 << 20), Ok(()));
    let error = super::at_most("patches", (1 << 20) + 1).expect_err("too many");
    assert!(error.to_string().contains("too many"), "{error}");
}

/// Where, from `inside` on to `outside`, rays along `direction` begin to miss.
fn silhouette(surface: &PatchSurface, direction: DVec3, inside: DVec3, outside: DVec3) -> DVec3 {
    let met =
        |p: DVec3| surface.occludes(&Ray::new(p - 9.0 * direction, direction), &mut Counters::default());
    assert!(met(inside) && !met(outside), "{inside} {outside}");
    let (mut inside, mut outside) = (inside, outside);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        *(if met(middle) { &mut inside } else { &mut outside }) = middle;
    }
    inside
}

/// The teapot is some six units wide. Magnified a thousand times a picture is 0.006 wide; its outline there
/// is one smooth curve, whose bend is the same along all of the picture, to within a tenth of a pixel.
#[test]
fn the_silhouette_of_the_teapot_is_smooth_at_any_zoom() {
    let teapot = surface(&teapot());
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    // Along the rays, along the outline, a place within and one without: body, lid, its knob, spout, handle.
    let places = [
        (x, z, DVec3::new(0.0, 1.0, 1.1), DVec3::new(0.0, 2.5, 1.1)),
        (x, z, DVec3::new(0.0, -1.0, 1.7), DVec3::new(0.0, -2.5, 1.7)),
        (x, y, DVec3::new(0.0, 0.7, 2.0), DVec3::new(0.0, 0.7, 3.5)),
        (x, z, DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 1.0, 3.0)),
        (y, x, DVec3::new(2.4, 0.0, 1.5), DVec3::new(2.4, 0.0, 3.0)),
        (y, x, DVec3::new(-2.4, 0.0, 2.1), DVec3::new(-2.4, 0.0, 3.0)),
    ];
    const STEPS: u32 = 32;
    for (direction, along, inside, outside) in places {
        let out = (outside - inside).normalize();
        for zoom in [1.0, 10.0, 100.0] {
            let step = 0.006 / zoom / f64::from(STEPS);
            let offset = |i: u32| {
                let shift = (f64::from(i) - 0.5 * f64::from(STEPS)) * step * along;
                let edge = silhouette(&teapot, direction, inside + shift, outside + shift);
                let ray = Ray::new(edge - 9.0 * direction - 1e-9 * out, direction);
                let hit = closest(&teapot, &ray).unwrap();
                let facing = teapot.surface_point(&ray, &hit).normal.dot(direction);
                assert!(facing.abs() < 1e-3, "the surface is seen edge on: {facing} at {edge}");
                (edge - inside).dot(out)
            };
            let outline: Vec<f64> = (0..=STEPS).map(offset).collect();
            // A parabola through the ends and the middle, against all places.
            let (a, b, c) = (outline[0], outline[STEPS as usize / 2], outline[STEPS as usize]);
            let pixel = 0.006 / zoom / 640.0;
            for (i, place) in outline.iter().enumerate() {
                let t = 2.0 * i as f64 / f64::from(STEPS) - 1.0;
                let smooth = b + 0.5 * (c - a) * t + 0.5 * (a - 2.0 * b + c) * t * t;
                assert!((place - smooth).abs() < 0.1 * pixel, "{inside} {zoom} {i}: {}", place - smooth);
            }
            let bend = (a - 2.0 * b + c).abs();
            assert!(zoom > 1.0 || bend > 0.01 * pixel, "it is a curve: {bend} at {inside}");
        }
    }
}
