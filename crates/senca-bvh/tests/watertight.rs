//! No ray gets through a closed mesh, and no scene is too odd.

use senca_bvh::{BruteForce, BuildError, BuildSettings, Ray32, SimdLevel, TraversalCounts, TriangleBvh};
use senca_math::glam::Vec3;

fn build(points: &[Vec3], triangles: &[[u32; 3]], level: SimdLevel) -> TriangleBvh {
    TriangleBvh::build(points, triangles, &BuildSettings { level }).unwrap()
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

/// Numbers in [0, 1).
fn random(seed: &mut u64) -> f32 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 40) as f32 / (1u64 << 24) as f32
}

/// A closed grid around the origin: columns of longitude and rows of latitude, moved and stretched.
fn sphere(columns: u32, rows: u32, center: Vec3, radii: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    use std::f32::consts::{PI, TAU};
    let mut points = vec![center + Vec3::Y * radii, center - Vec3::Y * radii];
    for row in 1..rows {
        for column in 0..columns {
            let (theta, phi) = (PI * row as f32 / rows as f32, TAU * column as f32 / columns as f32);
            let point = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            points.push(center + point * radii);
        }
    }
    let at = |row: u32, column: u32| 2 + (row - 1) * columns + column % columns;
    let mut triangles = Vec::new();
    for column in 0..columns {
        triangles.push([0, at(1, column), at(1, column + 1)]);
        triangles.push([1, at(rows - 1, column + 1), at(rows - 1, column)]);
        for row in 1..rows - 1 {
            triangles.push([at(row, column), at(row + 1, column), at(row + 1, column + 1)]);
            triangles.push([at(row, column), at(row + 1, column + 1), at(row, column + 1)]);
        }
    }
    (points, triangles)
}

#[test]
fn rays_from_inside_a_closed_mesh_never_escape() {
    let mut seed = 1;
    for (center, radii) in [
        (Vec3::ZERO, Vec3::ONE),
        (Vec3::new(100.0, -3.0, 7.0), Vec3::new(1.0, 0.01, 30.0)),
        (Vec3::new(0.25, 0.5, 0.125), Vec3::splat(1e-6)),
        (Vec3::ZERO, Vec3::splat(1e6)),
    ] {
        let (points, triangles) = sphere(37, 20, center, radii);
        for level in levels() {
            let bvh = build(&points, &triangles, level);
            let mut check = |target: Vec3| {
                let inside = Vec3::new(random(&mut seed), random(&mut seed), random(&mut seed)) - 0.5;
                for origin in [center, center + 0.5 * inside * radii] {
                    let ray = Ray32::new(origin, target - origin);
                    assert!(bvh.occluded(&ray), "{ray:?}");
                    assert!(bvh.closest(&ray).is_some(), "{ray:?}");
                }
            };
            for &point in &points {
                check(point);
            }
            for triangle in &triangles {
                let [a, b, c] = triangle.map(|index| points[index as usize]);
                for target in [0.5 * (a + b), 0.5 * (b + c), 0.3 * a + 0.7 * c, (a + b + c) / 3.0] {
                    check(target);
                }
            }
        }
    }
}

/// A box of axis-parallel squares of unit size, each of two triangles.
fn cells(count: i16) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let size = f32::from(count);
    for axis in 0..3 {
        for side in [0.0, size] {
            for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
                let corner = |di: i16, dj: i16| {
                    let mut point = [0.0; 3];
                    point[axis] = side;
                    point[(axis + 1) % 3] = f32::from(i + di);
                    point[(axis + 2) % 3] = f32::from(j + dj);
                    Vec3::from_array(point)
                };
                let first = points.len() as u32;
                points.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
                triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
    }
    (points, triangles)
}

#[test]
fn axis_parallel_rays_on_edges_hit_both_walls() {
    let count = 6;
    let (points, triangles) = cells(count);
    for level in levels() {
        let bvh = build(&points, &triangles, level);
        for axis in 0..3 {
            for (i, j) in (0..=2 * count).flat_map(|i| (0..=2 * count).map(move |j| (i, j))) {
                let mut origin = [-1.0; 3];
                origin[(axis + 1) % 3] = 0.5 * f32::from(i);
                origin[(axis + 2) % 3] = 0.5 * f32::from(j);
                let direction = Vec3::AXES[axis];
                let ray = Ray32::new(Vec3::from_array(origin), direction);
                let hit = bvh.closest(&ray).unwrap();
                assert_eq!(hit.t, 1.0, "{ray:?}");
                let back = Ray32::new(ray.at(2.0 + f32::from(count)), -direction);
                assert_eq!(bvh.closest(&back).unwrap().t, 1.0, "{back:?}");
                let mut far = 0;
                bvh.all_hits(&ray, |hit| far += usize::from(hit.t == 1.0 + f32::from(count)));
                assert!(far > 0, "{ray:?}");
            }
        }
    }
}

#[test]
fn barycentric_weights_give_the_point_back() {
    let (points, triangles) = sphere(40, 20, Vec3::new(3.0, 2.0, 1.0), Vec3::new(1.0, 2.0, 3.0));
    let bvh = build(&points, &triangles, SimdLevel::new());
    let mut seed = 7;
    for _ in 0..2000 {
        let mut part = || 10.0 * (random(&mut seed) - 0.5);
        let origin = Vec3::new(part(), part(), part());
        let ray =
            Ray32::new(origin, Vec3::new(3.0, 2.0, 1.0) + 0.1 * Vec3::new(part(), part(), part()) - origin);
        let Some(hit) = bvh.closest(&ray) else { continue };
        let [a, b, c] = triangles[hit.triangle as usize].map(|index| points[index as usize]);
        let point = (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c;
        assert!(point.distance(ray.at(hit.t)) < 1e-4, "{hit:?}");
    }
}

#[test]
fn nothing_is_met_by_invalid_rays_or_in_empty_scenes() {
    let (points, triangles) = sphere(10, 5, Vec3::ZERO, Vec3::ONE);
    let full = build(&points, &triangles, SimdLevel::new());
    let empty = build(&[], &[], SimdLevel::new());
    assert!(empty.bounds().is_empty());
    let good = Ray32::new(Vec3::ZERO, Vec3::X);
    assert!(full.occluded(&good) && !empty.occluded(&good) && empty.closest(&good).is_none());
    for ray in [
        Ray32 { origin: Vec3::NAN, ..good },
        Ray32 { origin: Vec3::new(0.0, f32::INFINITY, 0.0), ..good },
        Ray32 { direction: Vec3::ZERO, ..good },
        Ray32 { direction: Vec3::NAN, ..good },
        Ray32 { direction: Vec3::INFINITY, ..good },
        Ray32 { t_min: f32::NAN, ..good },
        Ray32 { t_max: f32::NAN, ..good },
        Ray32 { t_min: 2.0, t_max: 1.0, ..good },
    ] {
        assert!(!ray.is_valid());
        assert!(full.closest(&ray).is_none() && !full.occluded(&ray), "{ray:?}");
        full.all_hits(&ray, |hit| panic!("{hit:?}"));
    }
}

#[test]
fn limits_are_open() {
    let bvh = build(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], SimdLevel::new());
    let ray = Ray32::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert_eq!(bvh.closest(&ray).unwrap().t, 1.0);
    assert!(!bvh.occluded(&Ray32 { t_max: 1.0, ..ray }));
    assert!(bvh.occluded(&Ray32 { t_max: 1.0f32.next_up(), ..ray }));
    assert!(!bvh.occluded(&Ray32 { t_min: 1.0, ..ray }));
    assert!(bvh.occluded(&Ray32 { t_min: 1.0f32.next_down(), ..ray }));
    let behind = Ray32 { direction: Vec3::Z, t_min: f32::NEG_INFINITY, ..ray };
    assert_eq!(bvh.closest(&behind).unwrap().t, -1.0);
}

#[test]
fn triangles_that_cannot_be_met_are_left_out() {
    let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN, Vec3::INFINITY, 2.0 * Vec3::X];
    let triangles = [[0, 1, 3], [0, 1, 4], [0, 1, 5], [0, 0, 1], [2, 2, 2], [0, 1, 2]];
    let bvh = build(&points, &triangles, SimdLevel::new());
    assert_eq!((bvh.bounds().min, bvh.bounds().max), (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
    let hit = bvh.closest(&Ray32::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z)).unwrap();
    assert_eq!(hit.triangle, 5);
}

#[test]
fn an_index_out_of_range_is_named() {
    let error = TriangleBvh::build(&[Vec3::ZERO; 3], &[[0, 1, 2], [0, 3, 9]], &BuildSettings::default());
    assert_eq!(error.unwrap_err(), BuildError::IndexOutOfRange { triangle: 1, index: 3, points: 3 });
}

#[test]
fn heaps_and_tails_of_triangles_are_bounded() {
    // Thousands in one place, and a tail of ever smaller ones that each split takes one off.
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    let mut add = |corner: Vec3, size: f32| {
        let first = points.len() as u32;
        points.extend([corner, corner + Vec3::X * size, corner + Vec3::Y * size]);
        triangles.push([first, first + 1, first + 2]);
    };
    for _ in 0..5000 {
        add(Vec3::ONE, 1.0);
    }
    for i in 0..1200 {
        let place = 0.9f32.powi(i);
        add(Vec3::new(place, 0.0, -place), 0.05 * place);
    }
    let brute = BruteForce { points: &points, triangles: &triangles };
    let bvh = build(&points, &triangles, SimdLevel::new());
    assert!(bvh.memory_bytes() < 300 * triangles.len());
    let ray = Ray32::new(Vec3::new(1.25, 1.25, 3.0), Vec3::NEG_Z);
    let hit = bvh.closest(&ray).unwrap();
    assert_eq!((hit.t, hit.triangle), (2.0, 0));
    let mut count = 0;
    bvh.all_hits(&ray, |_| count += 1);
    assert_eq!(count, 5000);
    for i in 0..1200 {
        let place = 0.9f32.powi(i);
        let ray = Ray32::new(Vec3::new(1.01 * place, 0.01 * place, 1.0), Vec3::NEG_Z);
        assert_eq!(bvh.closest(&ray), brute.closest(&ray));
    }
}

#[test]
fn the_same_tree_comes_from_any_number_of_threads() {
    let (points, triangles) = sphere(300, 100, Vec3::ZERO, Vec3::ONE);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(&points, &triangles, SimdLevel::new()))
    });
    let mut seed = 3;
    for _ in 0..500 {
        let mut part = || random(&mut seed) - 0.5;
        let ray = Ray32::new(3.0 * Vec3::new(part(), part(), part()), Vec3::new(part(), part(), part()));
        let (mut counts_one, mut counts_two) = (TraversalCounts::default(), TraversalCounts::default());
        assert_eq!(one.closest_counted(&ray, &mut counts_one), two.closest_counted(&ray, &mut counts_two));
        assert_eq!(counts_one, counts_two);
    }
}

#[test]
fn cost_grows_slower_than_the_number_of_triangles() {
    let cost = |columns: u32, rows: u32| {
        let (points, triangles) = sphere(columns, rows, Vec3::ZERO, Vec3::ONE);
        let bvh = build(&points, &triangles, SimdLevel::new());
        let mut counts = TraversalCounts::default();
        let mut seed = 5;
        for _ in 0..500 {
            let mut part = || random(&mut seed) - 0.5;
            let origin = 4.0 * Vec3::new(part(), part(), part()).normalize();
            bvh.closest_counted(
                &Ray32::new(origin, 0.5 * Vec3::new(part(), part(), part()) - origin),
                &mut counts,
            );
        }
        counts.nodes as f64 / 500.0
    };
    let (small, large) = (cost(32, 16), cost(320, 160));
    assert!(large < 2.5 * small, "{small} {large}");
}
