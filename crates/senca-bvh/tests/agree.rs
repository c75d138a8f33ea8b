//! The hierarchy says the same as brute force, byte for byte, with any vector instructions.

use proptest::prelude::*;
use senca_bvh::{BruteForce, BuildSettings, Ray32, SimdLevel, TriangleBvh, TriangleHit};
use senca_math::glam::Vec3;

/// Coordinates that make trouble: few values, so that things coincide, and any values, of one size.
fn coordinate(scale: f32) -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => (-4i8..=4).prop_map(move |x| f32::from(x) * 0.25 * scale),
        3 => (-1f32..1.0).prop_map(move |x| x * scale),
        1 => Just(0.0),
    ]
}

fn vector(scale: f32) -> impl Strategy<Value = Vec3> {
    [coordinate(scale), coordinate(scale), coordinate(scale)].prop_map(Vec3::from_array)
}

fn direction() -> impl Strategy<Value = Vec3> {
    let part =
        || prop_oneof![2 => -1f32..1.0, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1.0), 1 => Just(-1.0)];
    let scale =
        prop_oneof![4 => Just(1f32), 1 => Just(1e-30), 1 => Just(1e-42), 1 => Just(1e30), 1 => Just(3e38)];
    ([part(), part(), part()], scale).prop_map(|(d, scale)| Vec3::from_array(d) * scale)
}

#[derive(Clone, Debug)]
struct Case {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    rays: Vec<Ray32>,
}

fn case(triangles: std::ops::Range<usize>) -> impl Strategy<Value = Case> {
    let scale =
        prop_oneof![6 => Just(1f32), 1 => Just(1e-20), 1 => Just(1e-36), 1 => Just(1e12), 1 => Just(1e30)];
    (scale, 3usize..60, triangles).prop_flat_map(|(scale, points, triangles)| {
        let limits = (
            prop_oneof![3 => Just(0f32), 1 => 0f32..1.0, 1 => -2f32..0.0, 1 => Just(f32::NEG_INFINITY)],
            prop_oneof![3 => Just(f32::INFINITY), 2 => 0f32..4.0],
        );
        // From far away, what is computed of a box from the origin's place alone has no digits left.
        let distance = prop_oneof![4 => Just(0f32), 1 => Just(1e2), 1 => Just(1e5), 1 => Just(1e7)];
        let ray = (vector(2.0 * scale), direction(), limits, distance).prop_map(
            move |(origin, direction, (t_min, t_max), distance)| {
                let along = direction / direction.abs().max_element().max(1e-38);
                let (origin, t_max) = if distance > 0.0 {
                    (origin - distance * scale * along, f32::INFINITY)
                } else {
                    (origin, t_max)
                };
                let unit = scale / direction.abs().max_element().max(1e-38);
                Ray32 { origin, t_min: t_min * unit, direction, t_max: t_max * unit }
            },
        );
        let index = 0..points as u32;
        (
            prop::collection::vec(vector(scale), points),
            prop::collection::vec([index.clone(), index.clone(), index], triangles),
            prop::collection::vec(ray, 20),
        )
            .prop_map(|(points, triangles, rays)| Case { points, triangles, rays })
    })
}

fn bytes(hit: Option<TriangleHit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}

/// The best level of this machine, those below that have been asked for by name, and the lowest.
fn levels() -> Vec<SimdLevel> {
    let best = SimdLevel::new();
    [
        Some(best),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        best.as_avx2().map(SimdLevel::Avx2),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        best.as_sse4_2().map(SimdLevel::Sse4_2),
        Some(SimdLevel::baseline()),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn check(case: &Case) -> Result<(), TestCaseError> {
    let brute = BruteForce { points: &case.points, triangles: &case.triangles };
    for level in levels() {
        let bvh = TriangleBvh::build(&case.points, &case.triangles, &BuildSettings { level }).unwrap();
        for ray in &case.rays {
            let expected = brute.closest(ray);
            prop_assert_eq!(bytes(bvh.closest(ray)), bytes(expected), "{:?} {:?}", ray, level);
            prop_assert_eq!(bvh.occluded(ray), expected.is_some());
            let mut all: Vec<_> = brute.hits(ray).map(|hit| bytes(Some(hit))).collect();
            let mut found = Vec::new();
            bvh.all_hits(ray, |hit| found.push(bytes(Some(*hit))));
            all.sort_unstable();
            found.sort_unstable();
            prop_assert_eq!(found, all);
            // Triangles with an odd index let rays pass.
            let even = |hit: &TriangleHit| hit.triangle.is_multiple_of(2);
            let expected = brute.closest_where(ray, even);
            prop_assert_eq!(bytes(bvh.closest_where(ray, even)), bytes(expected));
            prop_assert_eq!(bvh.occluded_where(ray, even), expected.is_some());
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn small_scenes_agree_with_brute_force(case in case(0..30)) {
        check(&case)?;
    }

    #[test]
    fn larger_scenes_agree_with_brute_force(case in case(30..600)) {
        check(&case)?;
    }
}
