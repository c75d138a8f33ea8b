use senca_math::glam::Vec3;

use super::*;
use crate::test_support::{object, patches, teapot};
use crate::{NormalSettings, compute_normals, polygon_normals_1991};

fn converted(patches: &[BezierPatch], steps: [u32; 2], epsilon: f64, as_printed: bool) -> Mesh {
    let settings = PatchConversion { steps, epsilon, as_printed, ..PatchConversion::default() };
    patch_to_polygons(patches, &settings).unwrap()
}

fn sample() -> Vec<BezierPatch> {
    patches(include_str!("../../../../samples/classic/patch.bez"))
}

/// Header, points and polygons as the thesis writes an object file.
fn object_text(mesh: &Mesh) -> String {
    let mut text = format!("{} {} {}\n", mesh.points.len(), mesh.faces.len(), mesh.surfaces.len());
    for (i, p) in mesh.points.iter().enumerate() {
        text += &format!("{i} {:.6} {:.6} {:.6}\n", p.x, p.y, p.z);
    }
    for (f, corners) in mesh.faces.iter().enumerate() {
        let points: Vec<String> =
            corners.iter().map(|&v| mesh.vertices.point[v as usize].to_string()).collect();
        text += &format!("{f} {} {} {}\n", mesh.faces.surface_of(f), corners.len(), points.join(" "));
    }
    text
}

#[test]
fn the_sample_patch_gives_the_printed_mesh() {
    let printed = include_str!("../../../../samples/classic/patch.dat");
    for as_printed in [false, true] {
        assert_eq!(object_text(&converted(&sample(), [4, 4], 0.05, as_printed)), printed);
    }
    let read = object(printed);
    assert_eq!((read.points.len(), read.faces.len()), (25, 16));
}

#[test]
fn the_middle_of_the_sample_patch() {
    let middle = BicubicPatch::from_list(sample()[0].points).at(0.5, 0.5);
    assert!((middle - DVec3::new(1.5, 3.0, 1.6875)).length() < 1e-12);
}

#[test]
fn vertex_and_polygon_counts_of_the_teapot() {
    let teapot = teapot();
    let counts = |steps, epsilon| {
        let mesh = converted(&teapot, steps, epsilon, true);
        assert_eq!(mesh.surfaces.len(), 5);
        (mesh.points.len(), mesh.faces.len())
    };
    for (n, vertices) in [(1, 38), (2, 138), (4, 530), (8, 2082), (16, 8258), (32, 32_898), (64, 131_330)] {
        assert_eq!(counts([n, n], 0.05), (vertices, 32 * (n * n) as usize));
        let fixed = converted(&teapot, [n, n], 0.05, false).points.len();
        assert_eq!((fixed, fixed as u32), (vertices - 1, 32 * n * n + 4 * n + 1));
    }
    assert_eq!(counts([4, 8], 0.05), (1042, 1024));
    assert_eq!((counts([4, 4], 0.01).0, counts([4, 4], 0.001).0), (530, 530));
    assert_eq!((counts([4, 4], 0.0).0, counts([4, 4], 0.5).0, counts([4, 4], 1.0).0), (2048, 432, 303));
    let sample = sample();
    for (epsilon, vertices) in [(0.0, 64), (0.001, 25), (0.05, 25), (1.0, 25)] {
        assert_eq!(converted(&sample, [4, 4], epsilon, true).points.len(), vertices);
    }
}

#[test]
fn polygons_per_surface_and_degenerate_ones() {
    for n in [4, 8, 16u32] {
        let mesh = converted(&teapot(), [n, n], 0.05, true);
        let on =
            |surface| (0..mesh.faces.len()).filter(|&f| mesh.faces.surface_of(f) == surface).count() as u32;
        assert_eq!([0, 1, 2, 3, 4].map(on), [12, 4, 4, 8, 4].map(|k| k * n * n));
        let point = |v: u32| mesh.vertices.point[v as usize];
        let twice = mesh.faces.iter().filter(|c| point(c[0]) == point(c[1])).count() as u32;
        assert_eq!(twice, 8 * n);
        assert!(polygon_normals_1991(&mesh).is_ok(), "the sliding triple finds a normal for each");
    }
}

#[test]
fn extent_of_the_teapot() {
    let bounds = converted(&teapot(), [16, 16], 0.05, true).bounds();
    assert!((bounds.min - DVec3::new(-3.0, -2.0, 0.0)).abs().max_element() < 1e-6);
    assert!((bounds.max - DVec3::new(3.433_515, 2.0, 3.15)).abs().max_element() < 1e-6);
}

#[test]
fn normals_of_the_sample_patch() {
    let mut mesh = converted(&sample(), [4, 4], 0.05, true);
    let polygons = polygon_normals_1991(&mesh).unwrap();
    let near = |a: Vec3, b: [f32; 3]| assert!((a - Vec3::from(b)).abs().max_element() < 6e-5, "{a} {b:?}");
    near(polygons[0], [0.0, -0.5347, 0.8450]);
    near(polygons[3], [0.0, 0.0, 1.0]);
    compute_normals(&mut mesh, &NormalSettings::THESIS_1991);
    near(mesh.vertices.normal[12], [0.0032, -0.0065, 1.0]);
    near(mesh.vertices.normal[0], [0.0, -0.5347, 0.8450]);
    near(mesh.vertices.normal[2], [-0.3144, -0.4250, 0.8488]);
}

#[test]
fn common_edges_have_common_control_points() {
    let teapot = teapot();
    let column = |patch: usize, c: usize| [0, 1, 2, 3].map(|r| teapot[patch].points[4 * r + c]);
    assert_eq!(column(0, 3), column(1, 0));
}

#[test]
fn both_searches_find_the_same() {
    let teapot = teapot();
    for (steps, epsilon) in [([4, 4], 0.05), ([5, 3], 0.5), ([4, 4], 1.0), ([2, 2], 3.0), ([3, 3], 0.0)] {
        for as_printed in [false, true] {
            let run = |search| {
                patch_to_polygons(&teapot, &PatchConversion { steps, epsilon, as_printed, search }).unwrap()
            };
            assert_eq!(run(VertexSearch::Backward), run(VertexSearch::Grid));
        }
    }
}

#[test]
fn bad_settings_are_errors() {
    let patches = sample();
    let fails = |settings: PatchConversion| patch_to_polygons(&patches, &settings).is_err();
    let default = PatchConversion::default();
    assert!(fails(PatchConversion { steps: [0, 4], ..default }));
    assert!(fails(PatchConversion { steps: [u32::MAX, u32::MAX], ..default }));
    assert!(fails(PatchConversion { epsilon: f64::NAN, ..default }));
    assert!(fails(PatchConversion { epsilon: -1.0, ..default }));
    let mut bad = sample();
    bad[0].points[3].x = f64::NAN;
    assert!(patch_to_polygons(&bad, &default).is_err());
    bad = sample();
    bad[0].surface = u32::MAX;
    assert!(patch_to_polygons(&bad, &default).is_err());
}
