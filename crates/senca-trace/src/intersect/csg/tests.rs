use std::f64::consts::PI;

use proptest::prelude::*;
use senca_math::glam::DQuat;

use super::super::{Cuboid, Frustum, PlaneSurface, Sphere};
use super::*;

fn at(x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(x, y, z))
}

fn cube(size: f64) -> Box<dyn Intersect> {
    Box::new(Cuboid::new(DVec3::splat(size)))
}

fn ball(radius: f64) -> Box<dyn Intersect> {
    Box::new(Sphere::new(radius))
}

/// One operation on leaves.
fn body(operation: Operation, leaves: Vec<(Box<dyn Intersect>, DMat4)>) -> CsgBody<'static> {
    let mut builder = CsgBuilder::new();
    builder.open(operation).unwrap();
    for (surface, place) in leaves {
        builder.leaf(surface, place).unwrap();
    }
    builder.close().unwrap();
    builder.finish().unwrap()
}

fn line(origin: DVec3, direction: DVec3) -> Ray {
    Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, direction) }
}

fn crossings(body: &CsgBody<'_>, ray: &Ray) -> Crossings {
    let mut found = Crossings::new();
    body.crossings(ray, &mut Counters::default(), &mut found);
    found
}

fn parameters(body: &CsgBody<'_>, ray: &Ray) -> Vec<f64> {
    crossings(body, ray).iter().map(|c| c.t).collect()
}

fn surfaces(body: &CsgBody<'_>, ray: &Ray) -> Vec<u32> {
    crossings(body, ray).iter().map(|c| body.surface_point(ray, c).surface).collect()
}

#[test]
fn two_balls_in_the_three_ways() {
    let of =
        |operation| body(operation, vec![(ball(1.0), at(0.0, 0.0, 0.0)), (ball(1.0), at(1.0, 0.0, 0.0))]);
    let ray = line(DVec3::new(-3.0, 0.0, 0.0), DVec3::X);
    assert_eq!(parameters(&of(Operation::Union), &ray), [2.0, 5.0]);
    assert_eq!(parameters(&of(Operation::Intersection), &ray), [3.0, 4.0]);
    assert_eq!(parameters(&of(Operation::Difference), &ray), [2.0, 3.0]);
    assert_eq!(surfaces(&of(Operation::Union), &ray), [0, 1]);
    assert_eq!(surfaces(&of(Operation::Intersection), &ray), [1, 0]);
    assert_eq!(surfaces(&of(Operation::Difference), &ray), [0, 1]);
    assert_eq!(
        of(Operation::Intersection).bounds(),
        Aabb { min: DVec3::new(0.0, -1.0, -1.0), max: DVec3::new(1.0, 1.0, 1.0) }
    );
}

#[test]
fn the_hollow_of_a_difference_faces_into_itself() {
    let bowl =
        body(Operation::Difference, vec![(ball(1.0), at(0.0, 0.0, 0.0)), (ball(0.8), at(0.0, 0.0, 0.0))]);
    let ray = line(DVec3::new(0.0, 0.0, -3.0), DVec3::Z);
    let found = crossings(&bowl, &ray);
    let normals: Vec<f64> = found.iter().map(|c| bowl.surface_point(&ray, c).normal.z).collect();
    assert_eq!(normals, [-1.0, 1.0, -1.0, 1.0]);
    // The picture on the hollow is seen from its other side.
    let handed: Vec<f64> = found.iter().map(|c| bowl.surface_point(&ray, c).handedness).collect();
    assert_eq!(handed, [1.0, -1.0, -1.0, 1.0]);
}

#[test]
fn from_inside() {
    let bowl = body(Operation::Difference, vec![(cube(4.0), DMat4::IDENTITY), (ball(1.0), DMat4::IDENTITY)]);
    let inside_material = Ray::new(DVec3::new(1.5, 0.0, 0.0), DVec3::X);
    assert_eq!(parameters(&bowl, &inside_material), [0.5]);
    let in_the_hollow = Ray::new(DVec3::ZERO, DVec3::X);
    assert_eq!(parameters(&bowl, &in_the_hollow), [1.0, 2.0]);
    let nearest = bowl.closest(&in_the_hollow, &mut Counters::default()).unwrap();
    assert_eq!((nearest.t, bowl.surface_point(&in_the_hollow, &nearest).normal), (1.0, DVec3::NEG_X));
    assert!(bowl.occludes(&in_the_hollow, &mut Counters::default()));
    assert!(!bowl.occludes(&Ray { t_max: 0.9, ..in_the_hollow }, &mut Counters::default()));
}

#[test]
fn coincident_faces_leave_no_skin() {
    let turn = DMat4::from_quat(DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7));
    // Each time the two bodies are placed differently, so that their faces coincide but for rounding.
    let placed = |x: f64| turn * at(0.3, 0.0, 0.0) * turn.inverse() * turn * at(x - 0.3, 0.0, 0.0);
    let ray = line(turn.transform_point3(DVec3::new(-5.0, 0.1, 0.2)), turn.transform_vector3(DVec3::X));
    let pair = |operation, x: f64| body(operation, vec![(cube(1.0), turn), (cube(1.0), placed(x))]);
    assert!(parameters(&pair(Operation::Difference, 0.0), &ray).is_empty());
    assert_eq!(parameters(&pair(Operation::Union, 0.0), &ray).len(), 2);
    assert_eq!(surfaces(&pair(Operation::Intersection, 0.0), &ray).len(), 2);
    // Side by side: one body without a wall inside; nothing in common; nothing taken away.
    let union = parameters(&pair(Operation::Union, 1.0), &ray);
    assert!(union.len() == 2 && (union[1] - union[0] - 2.0).abs() < 1e-12);
    assert!(parameters(&pair(Operation::Intersection, 1.0), &ray).is_empty());
    assert_eq!(surfaces(&pair(Operation::Difference, 1.0), &ray), [0, 0]);
}

#[test]
fn a_hole_drilled_from_face_to_face_is_open() {
    let drill = Box::new(Frustum::new(0.3, 0.3, 2.0, true));
    let drilled =
        body(Operation::Difference, vec![(cube(2.0), DMat4::IDENTITY), (drill, at(0.0, -1.0, 0.0))]);
    assert!(parameters(&drilled, &line(DVec3::new(0.1, 5.0, 0.1), DVec3::NEG_Y)).is_empty());
    let across = line(DVec3::new(-5.0, 0.2, 0.0), DVec3::X);
    assert_eq!(parameters(&drilled, &across).len(), 4);
}

#[test]
fn half_spaces_cut() {
    let mut builder = CsgBuilder::new();
    builder.open(Operation::Intersection).unwrap();
    builder.leaf(ball(1.0), DMat4::IDENTITY).unwrap();
    builder.half_space(Box::new(PlaneSurface::new(None)), at(0.0, 0.5, 0.0)).unwrap();
    builder.close().unwrap();
    let cut = builder.finish().unwrap();
    assert_eq!(cut.bounds().max.y, 0.5);
    assert_eq!(parameters(&cut, &line(DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y)), [2.5, 4.0]);
    assert_eq!(parameters(&cut, &line(DVec3::new(0.0, -3.0, 0.0), DVec3::Y)), [2.0, 3.5]);
    assert_eq!(parameters(&cut, &line(DVec3::new(-3.0, 0.0, 0.0), DVec3::X)), [2.0, 4.0]);
    assert!(parameters(&cut, &line(DVec3::new(-3.0, 0.7, 0.0), DVec3::X)).is_empty());
}

#[test]
fn mirrored_leaves_keep_their_outside() {
    let mirrored = DMat4::from_scale(DVec3::new(-1.0, 2.0, 1.0));
    let body = body(Operation::Union, vec![(ball(1.0), mirrored)]);
    let ray = line(DVec3::new(0.3, 0.2, -5.0), DVec3::Z);
    let found = crossings(&body, &ray);
    let met = body.surface_point(&ray, &found[0]);
    assert!(met.normal.z < 0.0 && met.normal.is_normalized());
    assert_eq!(met.handedness, -1.0);
}

#[test]
fn what_makes_no_body_is_refused() {
    let mut open = CsgBuilder::new();
    assert_eq!(
        open.leaf(Box::new(PlaneSurface::new(Some(1.0))), DMat4::IDENTITY),
        Err(CsgError::Open { leaf: 0 })
    );
    assert_eq!(
        open.leaf(ball(1.0), DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))),
        Err(CsgError::Placement { leaf: 0 })
    );
    assert_eq!(open.leaf(ball(1.0), at(f64::NAN, 0.0, 0.0)), Err(CsgError::Placement { leaf: 0 }));
    assert_eq!(open.finish().unwrap_err(), CsgError::Empty);
    let mut unbalanced = CsgBuilder::new();
    unbalanced.open(Operation::Union).unwrap();
    assert_eq!(unbalanced.close(), Err(CsgError::Empty));
    let mut early = CsgBuilder::new();
    early.leaf(ball(1.0), DMat4::IDENTITY).unwrap();
    early.close().unwrap();
    assert_eq!(early.close(), Err(CsgError::Unbalanced));
    let mut unended = CsgBuilder::new();
    unended.open(Operation::Union).unwrap();
    unended.leaf(ball(1.0), DMat4::IDENTITY).unwrap();
    assert_eq!(unended.finish().unwrap_err(), CsgError::Unbalanced);
}

#[test]
fn deep_trees_take_no_stack() {
    let mut builder = CsgBuilder::new();
    for _ in 0..20_000 {
        builder.open(Operation::Union).unwrap();
    }
    builder.leaf(ball(1.0), DMat4::IDENTITY).unwrap();
    for _ in 0..20_000 {
        builder.close().unwrap();
    }
    let body = builder.finish().unwrap();
    assert_eq!(parameters(&body, &line(DVec3::new(-3.0, 0.0, 0.0), DVec3::X)), [2.0, 4.0]);
}

#[test]
fn a_lens_has_its_volume() {
    let lens =
        body(Operation::Intersection, vec![(ball(1.0), at(-0.5, 0.0, 0.0)), (ball(1.0), at(0.5, 0.0, 0.0))]);
    let n = 200;
    let step = 2.0 / f64::from(n);
    let offset = |i: i32| (f64::from(i) + 0.5) * step - 1.0;
    let sum: f64 = (0..n * n)
        .map(|i| line(DVec3::new(-4.0, offset(i % n), offset(i / n)), DVec3::X))
        .flat_map(|ray| parameters(&lens, &ray).chunks_exact(2).map(|p| p[1] - p[0]).collect::<Vec<_>>())
        .sum();
    assert!((sum * step * step / (5.0 * PI / 12.0) - 1.0).abs() < 2e-3);
}

/// A random tree, as the commands of its builder, and who is inside of it.
#[derive(Clone, Debug)]
enum Tree {
    Ball(DVec3, f64),
    Cube(DVec3, f64),
    Below(f64),
    Of(Operation, Vec<Tree>),
}

impl Tree {
    fn build(&self, builder: &mut CsgBuilder<'static>) {
        match self {
            Self::Ball(p, radius) => builder.leaf(ball(*radius), at(p.x, p.y, p.z)),
            Self::Cube(p, size) => builder.leaf(cube(*size), at(p.x, p.y, p.z)),
            Self::Below(y) => builder.half_space(Box::new(PlaneSurface::new(None)), at(0.0, *y, 0.0)),
            Self::Of(operation, bodies) => {
                builder.open(*operation).unwrap();
                bodies.iter().for_each(|body| body.build(builder));
                builder.close()
            }
        }
        .unwrap();
    }

    fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Ball(center, radius) => p.distance(*center) < *radius,
            Self::Cube(center, size) => (p - *center).abs().max_element() < 0.5 * size,
            Self::Below(y) => p.y < *y,
            Self::Of(Operation::Union, bodies) => bodies.iter().any(|b| b.contains(p)),
            Self::Of(Operation::Intersection, bodies) => bodies.iter().all(|b| b.contains(p)),
            Self::Of(Operation::Difference, bodies) => {
                bodies[0].contains(p) && !bodies[1..].iter().any(|b| b.contains(p))
            }
        }
    }
}

fn trees() -> impl Strategy<Value = Tree> {
    // Places and sizes on a coarse grid make coincident faces common.
    let grid = || (-4..=4i32).prop_map(|k| 0.25 * f64::from(k));
    let place = move || (grid(), grid(), grid()).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    let size = || (1..=4u32).prop_map(|k| 0.25 * f64::from(k));
    let leaf = prop_oneof![
        3 => (place(), size()).prop_map(|(p, s)| Tree::Ball(p, s)),
        3 => (place(), size()).prop_map(|(p, s)| Tree::Cube(p, 2.0 * s)),
        1 => grid().prop_map(Tree::Below),
    ];
    let operation =
        prop::sample::select(vec![Operation::Union, Operation::Intersection, Operation::Difference]);
    leaf.prop_recursive(4, 16, 4, move |inner| {
        (operation.clone(), prop::collection::vec(inner, 1..4))
            .prop_map(|(operation, bodies)| Tree::Of(operation, bodies))
    })
}

fn rays() -> impl Strategy<Value = Ray> {
    let place = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
    (place(), place(), any::<bool>()).prop_filter_map("no direction", |(target, from, straight)| {
        let direction =
            if straight { DVec3::AXES[(from.x.abs() * 2.9) as usize] } else { from.try_normalize()? };
        Some(line(target - 4.0 * direction, direction))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn stretches_between_crossings_are_in_or_out(tree in trees(), ray in rays()) {
        let mut builder = CsgBuilder::new();
        tree.build(&mut builder);
        let body = builder.finish().unwrap();
        let found = crossings(&body, &ray);
        prop_assert!(found.windows(2).all(|pair| pair[0].t <= pair[1].t));
        // Between two crossings everything is in or everything is out, by turns.
        let mut cuts: Vec<f64> = found.iter().map(|c| c.t).collect();
        let mut inside = tree.contains(ray.at(-1e6));
        cuts.insert(0, -30.0);
        cuts.push(30.0);
        for pair in cuts.windows(2) {
            for k in 1..16 {
                let t = pair[0] + (pair[1] - pair[0]) * (f64::from(k) + 0.317) / 17.0;
                let clear = t - pair[0] > 1e-6 && pair[1] - t > 1e-6;
                prop_assert!(!clear || tree.contains(ray.at(t)) == inside, "{:?} at {}", found, t);
            }
            inside = !inside;
        }
        let mut entering = !tree.contains(ray.at(-1e6));
        for crossing in &found {
            let met = body.surface_point(&ray, crossing);
            prop_assert!(met.point.distance(ray.at(crossing.t)) < 1e-9);
            let sense = if entering { -1.0 } else { 1.0 } * met.normal.dot(ray.direction);
            prop_assert!(sense > -1e-9, "{:?} {:?}", crossing, met);
            entering = !entering;
        }
        for limits in [(0.0, f64::INFINITY), (3.5, 4.5), (4.0, 4.2)] {
            let limited = Ray { t_min: limits.0, t_max: limits.1, ..ray };
            let expected: Vec<f64> = found.iter().map(|c| c.t).filter(|t| limited.admits(*t)).collect();
            prop_assert_eq!(parameters(&body, &limited), expected.clone());
            let nearest = body.closest(&limited, &mut Counters::default()).map(|c| c.t);
            prop_assert_eq!(nearest, expected.first().copied());
        }
    }
}
