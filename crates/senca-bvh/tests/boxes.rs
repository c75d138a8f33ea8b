//! The hierarchy over boxes offers whatever could matter.

use proptest::prelude::*;
use senca_bvh::{Aabb32, BoxBvh, BuildSettings, Ray32};
use senca_math::glam::{DVec3, Vec3};

fn part() -> impl Strategy<Value = f32> {
    prop_oneof![(-4i8..=4).prop_map(|x| f32::from(x) * 0.25), -1f32..1.0]
}

fn vector() -> impl Strategy<Value = Vec3> {
    [part(), part(), part()].prop_map(Vec3::from_array)
}

fn any_box() -> impl Strategy<Value = Aabb32> {
    prop_oneof![
        8 => (vector(), vector()).prop_map(|(a, b)| Aabb32 { min: a.min(b), max: a.max(b) }),
        1 => vector().prop_map(|a| Aabb32 { min: a, max: a }),
        1 => vector().prop_map(|a| Aabb32 { min: Vec3::new(f32::NEG_INFINITY, a.y, a.z), max: a.with_x(f32::INFINITY) }),
        1 => Just(Aabb32 { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }),
    ]
}

/// Where the ray is in the box, in double precision.
fn interval(ray: &Ray32, bounds: &Aabb32) -> (f64, f64) {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (mut enter, mut leave) = (f64::from(ray.t_min), f64::from(ray.t_max));
    for axis in 0..3 {
        let plane = |x: f32| f64::from(x) - DVec3::to_array(&origin)[axis];
        let (low, high) = (plane(bounds.min[axis]), plane(bounds.max[axis]));
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return (f64::INFINITY, f64::NEG_INFINITY);
            }
        } else {
            let (a, b) = (low / direction[axis], high / direction[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    (enter, leave)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn everything_met_is_offered_and_the_nearest_is_found(
        boxes in prop::collection::vec(any_box(), 0..80),
        origin in vector(),
        direction in vector(),
        t_min in prop_oneof![Just(0f32), 0f32..1.0, -2f32..0.0],
    ) {
        let ray = Ray32 { origin, t_min, direction, t_max: 8.0 };
        let bvh = BoxBvh::build(&boxes, &BuildSettings::default()).unwrap();
        let mut offered = vec![false; boxes.len()];
        bvh.any(&ray, |item| {
            offered[item as usize] = true;
            false
        });
        let intervals: Vec<_> = boxes.iter().map(|bounds| interval(&ray, bounds)).collect();
        if ray.is_valid() {
            for (offered, (enter, leave)) in offered.iter().zip(&intervals) {
                prop_assert!(*offered || enter > leave || *enter >= 8.0 || *leave <= f64::from(t_min));
            }
        }
        // Items are the boxes themselves.
        let met = |item: u32| {
            let (enter, leave) = intervals[item as usize];
            (enter <= leave && enter < 8.0 && enter > f64::from(t_min)).then_some(enter as f32)
        };
        let expected = (0..boxes.len() as u32).filter_map(met).reduce(f32::min).filter(|_| ray.is_valid());
        let mut found: Option<f32> = None;
        bvh.closest(&ray, |item, t_max| {
            let t = met(item).filter(|t| *t <= t_max)?;
            found = Some(found.map_or(t, |f| f.min(t)));
            Some(t)
        });
        prop_assert_eq!(found, expected);
    }
}

#[test]
fn empty_and_broken_boxes_are_never_offered() {
    let boxes = [
        Aabb32::EMPTY,
        Aabb32 { min: Vec3::NAN, max: Vec3::ONE },
        Aabb32 { min: Vec3::ONE, max: Vec3::ZERO },
    ];
    let bvh = BoxBvh::build(&boxes, &BuildSettings::default()).unwrap();
    assert!(bvh.bounds().is_empty());
    assert!(!bvh.any(&Ray32::new(Vec3::ZERO, Vec3::ONE), |_| true));
    let none = BoxBvh::build(&[], &BuildSettings::default()).unwrap();
    assert!(!none.any(&Ray32::new(Vec3::ZERO, Vec3::ONE), |_| true));
}

#[test]
fn many_boxes_in_one_place_are_all_offered() {
    let boxes = vec![Aabb32 { min: Vec3::ZERO, max: Vec3::ONE }; 5000];
    let bvh = BoxBvh::build(&boxes, &BuildSettings::default()).unwrap();
    let mut offered = vec![0; boxes.len()];
    bvh.any(&Ray32::new(Vec3::splat(-1.0), Vec3::ONE), |item| {
        offered[item as usize] += 1;
        false
    });
    assert!(offered.iter().all(|&times| times == 1));
}
