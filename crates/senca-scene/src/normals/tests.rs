use senca_math::glam::{Vec2, Vec3};

use super::*;
use crate::test_support::{house, octagonal_cylinder};
use crate::{Faces, Surface, Vertices};

fn near(a: Vec3, b: [f32; 3]) {
    assert!((a - Vec3::from(b)).abs().max_element() < 6e-5, "{a} instead of {b:?}");
}

/// Normals of all vertices at `point`, by surface of the faces that use them.
fn normals_at(mesh: &Mesh, point: u32) -> Vec<(u32, Vec3)> {
    let mut found = Vec::new();
    for (f, corners) in mesh.faces.iter().enumerate() {
        for &v in corners.iter().filter(|&&v| mesh.vertices.point[v as usize] == point) {
            found.push((mesh.faces.surface_of(f), mesh.vertices.normal[v as usize]));
        }
    }
    found.sort_by_key(|n| n.0);
    found.dedup();
    found
}

#[test]
fn the_octagonal_cylinder_is_smooth_around_and_creased_at_its_caps() {
    let mut mesh = octagonal_cylinder();
    let polygons = polygon_normals_1991(&mesh).unwrap();
    let d = std::f32::consts::FRAC_1_SQRT_2;
    let expected = [
        [-d, -d, 0.0],
        [0.0, -1.0, 0.0],
        [d, -d, 0.0],
        [1.0, 0.0, 0.0],
        [d, d, 0.0],
        [0.0, 1.0, 0.0],
        [-d, d, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 1.0],
    ];
    polygons.iter().zip(expected).for_each(|(&n, e)| near(n, e));
    compute_normals(&mut mesh, &NormalSettings::THESIS_1991);
    assert_eq!(mesh.check(), Ok(()));
    assert_eq!(mesh.points.len(), 16);
    let at = normals_at(&mesh, 0);
    assert_eq!(at.len(), 2);
    near(at[0].1, [-0.9239, -0.3827, 0.0]);
    near(at[1].1, [0.0, 0.0, -1.0]);
    near(normals_at(&mesh, 1)[0].1, [-0.3827, -0.9239, 0.0]);
    let at = normals_at(&mesh, 9);
    near(at[0].1, [-0.3827, -0.9239, 0.0]);
    near(at[1].1, [0.0, 0.0, 1.0]);
}

#[test]
fn the_house_has_a_normal_per_wall() {
    let mut mesh = house();
    let expected = [
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.6, 0.8, 0.0],
        [-0.6, 0.8, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    polygon_normals_1991(&mesh).unwrap().iter().zip(expected).for_each(|(&n, e)| near(n, e));
    compute_normals(&mut mesh, &NormalSettings::THESIS_1991);
    assert_eq!(normals_at(&mesh, 0).len(), 6);
    (5..10).for_each(|point| assert_eq!(normals_at(&mesh, point).len(), 3));
    for (f, corners) in mesh.faces.iter().enumerate() {
        corners.iter().for_each(|&v| near(mesh.vertices.normal[v as usize], expected[f]));
    }
}

#[test]
fn the_sliding_triple_passes_over_degenerate_corners() {
    let corners = [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(Vec3::from);
    assert_eq!(polygon_normal_1991(corners), Some(Vec3::Z));
    assert_eq!(polygon_normal_1991([[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]].map(Vec3::from)), None);
    assert_eq!(polygon_normal_1991([Vec3::X]), None);
    let mut mesh = house();
    mesh.points[1] = mesh.points[0];
    mesh.points[2] = mesh.points[0];
    mesh.points[3] = mesh.points[0];
    mesh.points[4] = mesh.points[0];
    assert_eq!(polygon_normals_1991(&mesh), Err(DegeneratePolygon { face: 0 }));
    assert_eq!(
        newell_vector([[0.0; 3], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.0]].map(Vec3::from)),
        Vec3::Z * 12.0
    );
}

#[test]
fn the_arc_cosine_is_good_enough() {
    for i in -1000..=1000 {
        let x = i as f32 / 1000.0;
        assert!((approximate_acos(x) - x.acos()).abs() < 1e-4);
    }
}

/// A cube of 12 triangles with 8 shared vertices on one surface.
fn cube() -> Mesh {
    let cube = crate::Shape::Box { size: senca_math::glam::DVec3::ONE };
    let built = crate::tessellate(&cube, &crate::TessellationSettings::default()).unwrap().into_owned();
    let corners = built.faces.corners.iter().map(|&v| built.vertices.point[v as usize]).collect();
    Mesh {
        points: built.points,
        vertices: Vertices { point: (0..8).collect(), ..Vertices::default() },
        faces: Faces { corners, ..Faces::default() },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    }
}

#[test]
fn angle_weights_do_not_see_how_sides_are_split() {
    let mut mesh = cube();
    compute_normals(&mut mesh, &NormalSettings::SMOOTH);
    assert_eq!(mesh.vertices.point.len(), 8);
    for (v, n) in mesh.vertices.normal.iter().enumerate() {
        assert!(n.dot(mesh.points[v].normalize()) > 0.999_999);
    }
    let equal = NormalSettings { weight: NormalWeight::Equal, ..NormalSettings::SMOOTH };
    compute_normals(&mut mesh, &equal);
    assert!(mesh.vertices.normal.iter().zip(&mesh.points).any(|(n, p)| n.dot(p.normalize()) < 0.99));
}

#[test]
fn creases_split_what_is_sharper_than_the_angle() {
    let mut mesh = cube();
    mesh.vertices.texcoord0 = (0..8).map(|i| Vec2::splat(i as f32)).collect();
    mesh.morph_targets
        .push(crate::MorphTarget { normals: vec![Vec3::X; 8], ..crate::MorphTarget::default() });
    let mut soft = mesh.clone();
    compute_normals(&mut mesh, &NormalSettings::default());
    assert_eq!(mesh.check(), Ok(()));
    assert_eq!((mesh.points.len(), mesh.vertices.point.len()), (8, 24));
    for corners in mesh.faces.iter() {
        let face = newell_vector(corners.iter().map(|&v| mesh.position(v))).normalize();
        for &v in corners {
            assert_eq!(mesh.vertices.normal[v as usize], face);
            assert_eq!(mesh.vertices.texcoord0[v as usize].x, mesh.vertices.point[v as usize] as f32);
        }
    }
    let settings = NormalSettings { crease_angle: Some(1.6), ..NormalSettings::default() };
    compute_normals(&mut soft, &settings);
    assert_eq!(soft.vertices.point.len(), 8, "90 degrees are below 1.6 rad");
}

#[test]
fn surfaces_of_one_group_are_smooth_across_their_border() {
    let torus = crate::Shape::Torus { major_radius: 2.0, minor_radius: 0.7 };
    let mut mesh = crate::tessellate(&torus, &crate::TessellationSettings::default()).unwrap().into_owned();
    compute_normals(&mut mesh, &NormalSettings::default());
    let whole = mesh.vertices.normal.clone();
    let halves = |group: u32| {
        let mut mesh = mesh.clone();
        mesh.surfaces = vec![Surface { smoothing_group: group, ..Surface::default() }; 2];
        mesh.faces.surface = (0..mesh.faces.len()).map(|f| (f % 2) as u32).collect();
        compute_normals(&mut mesh, &NormalSettings::default());
        mesh.vertices.normal
    };
    assert!(halves(0).len() > whole.len());
    let one_body = halves(7);
    assert_eq!(one_body.len(), whole.len());
    assert!(one_body.iter().zip(&whole).all(|(a, b)| a.distance(*b) < 1e-5));
}

/// A bumpy square of `n` x `n` cells, two of its bumps sharp.
fn scan(n: u32) -> Mesh {
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let height = |x: u32, y: u32| if (x, y) == (5, 5) || (x, y) == (n - 9, 7) { 2.0 } else { 0.0 };
    let points = (0..(n + 1) * (n + 1)).map(|i| (i % (n + 1), i / (n + 1)));
    let mut faces = Faces::default();
    for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
        faces.push(&[at(x, y), at(x + 1, y), at(x + 1, y + 1)], 0);
        faces.push(&[at(x, y), at(x + 1, y + 1), at(x, y + 1)], 0);
    }
    Mesh {
        points: points.map(|(x, y)| Vec3::new(x as f32, y as f32, height(x, y))).collect(),
        vertices: Vertices { point: (0..(n + 1) * (n + 1)).collect(), ..Vertices::default() },
        faces,
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    }
}

#[test]
fn noise_of_a_scan_makes_no_creases() {
    for (n, creases) in [(80, false), (20, true)] {
        let mut mesh = scan(n);
        let vertices = mesh.vertices.point.len();
        compute_normals(&mut mesh, &NormalSettings::default());
        assert_eq!(mesh.vertices.point.len() > vertices, creases, "{n}");
        let mut mesh = scan(n);
        compute_normals(&mut mesh, &NormalSettings { smooth_scans: false, ..NormalSettings::default() });
        assert!(mesh.vertices.point.len() > vertices);
    }
    // A dense mesh on a large wall: the wall reaches far, so its edge stays.
    let mut mesh = scan(80);
    let far = mesh.points.len() as u32;
    mesh.points.extend([Vec3::new(0.0, 0.0, -60.0), Vec3::new(80.0, 0.0, -60.0)]);
    mesh.vertices.point.extend([far, far + 1]);
    for x in 0..80 {
        mesh.faces.push(&[x + 1, x, far], 0);
    }
    mesh.faces.push(&[80, far, far + 1], 0);
    let vertices = mesh.vertices.point.len();
    compute_normals(&mut mesh, &NormalSettings::default());
    assert!(mesh.vertices.point.len() >= vertices + 79);
}

#[test]
fn flat_surfaces_do_not_share_normals() {
    let mut mesh = cube();
    mesh.surfaces[0].smooth = false;
    for settings in [NormalSettings::SMOOTH, NormalSettings::default()] {
        let mut mesh = mesh.clone();
        compute_normals(&mut mesh, &settings);
        assert_eq!(mesh.vertices.point.len(), 36);
        assert_eq!(mesh.check(), Ok(()));
    }
}

#[test]
fn texture_seams_do_not_show() {
    // Two triangles over one edge, the edge's points with two vertices each.
    let points =
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.3], [-1.0, 0.0, 0.3]].map(Vec3::from).to_vec();
    let mut mesh = Mesh {
        points,
        vertices: Vertices { point: vec![0, 2, 1, 0, 1, 3], ..Vertices::default() },
        faces: Faces { corners: vec![0, 1, 2, 3, 4, 5], ..Faces::default() },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    };
    compute_normals(&mut mesh, &NormalSettings::SMOOTH);
    let n = &mesh.vertices.normal;
    assert_eq!((n[0], n[2]), (n[3], n[4]));
}

#[test]
fn degenerate_and_unused_vertices_get_some_unit_normal() {
    let mut mesh = Mesh {
        points: vec![Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::X, Vec3::splat(1e-30), Vec3::splat(1e30)],
        vertices: Vertices { point: vec![0, 1, 2, 3, 4, 0], ..Vertices::default() },
        faces: Faces { corners: vec![0, 1, 2, 0, 0, 0, 2, 3, 4], ..Faces::default() },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    };
    for settings in [NormalSettings::default(), NormalSettings::SMOOTH, NormalSettings::THESIS_1991] {
        compute_normals(&mut mesh, &settings);
        assert!(
            mesh.vertices.normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-4),
            "{:?}",
            mesh.vertices.normal
        );
    }
}

#[test]
fn one_pass_over_triangles_is_the_general_way() {
    let torus = crate::Shape::Torus { major_radius: 2.0, minor_radius: 0.7 };
    let mut mesh = crate::tessellate(&torus, &crate::TessellationSettings::default()).unwrap().into_owned();
    mesh.points[7] = mesh.points[8];
    mesh.points[30] *= 1e-25;
    for weight in [NormalWeight::Equal, NormalWeight::Area, NormalWeight::Angle] {
        let (faces, sums) = triangle_sums(&mesh, weight);
        let general = face_infos(&mesh, PolygonNormal::Newell);
        let general_sums = point_sums(&mesh, &general, weight);
        for (a, b) in faces.iter().zip(&general) {
            assert!(a.normal.distance(b.normal) < 1e-5 && (a.area - b.area).abs() < 1e-6);
        }
        sums.iter().zip(&general_sums).for_each(|(a, b)| assert!(a.distance(*b) < 1e-3, "{a} {b}"));
    }
}
