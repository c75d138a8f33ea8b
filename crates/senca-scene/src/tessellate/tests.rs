use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use senca_math::glam::{DMat4, DVec2, DVec3, DVec4, Vec3};

use super::*;
use crate::test_support::teapot;
use crate::{BezierPatch, NurbsSurface, Topology};

fn on_patch(points: &[DVec3; 16], uv: DVec2) -> DVec3 {
    senca_math::BicubicPatch::from_list(*points).at(uv.x, uv.y)
}

fn with(tolerance: Tolerance) -> TessellationSettings {
    TessellationSettings { tolerance, ..TessellationSettings::default() }
}

fn mesh_at(shape: &Shape, tolerance: Tolerance) -> Mesh {
    let mesh = tessellate(shape, &with(tolerance)).unwrap().into_owned();
    assert_eq!(mesh.check(), Ok(()));
    assert_eq!(mesh.check_finite(), Ok(()));
    assert_eq!(mesh.vertices.normal.len(), mesh.vertices.point.len());
    assert!(mesh.vertices.normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    mesh
}

fn assert_closed(mesh: &Mesh, euler: i64, what: &str) {
    let topology = Topology::new(mesh);
    assert!(topology.is_closed(), "{what}: {:?}", topology.edge_counts());
    assert!(topology.is_oriented() && topology.is_manifold(), "{what}: {:?}", topology.edge_counts());
    assert_eq!(topology.euler_characteristic(mesh), euler, "{what}");
}

/// Vertex normals must lie on the front of every face they belong to.
fn assert_normals_fit(mesh: &Mesh, what: &str) {
    for corners in mesh.faces.iter() {
        let face = crate::newell_vector(corners.iter().map(|&v| mesh.position(v)));
        for &v in corners {
            let cos = mesh.vertices.normal[v as usize].dot(face) / face.length();
            assert!(face.length() < 1e-6 || cos > 0.0, "{what}: {cos}");
        }
    }
}

fn closed_shapes() -> Vec<(&'static str, Shape, i64, f64)> {
    let square = vec![
        DVec2::new(0.0, 0.0),
        DVec2::new(2.0, 0.0),
        DVec2::new(2.0, 2.0),
        DVec2::new(1.0, 0.5),
        DVec2::new(0.0, 2.0),
    ];
    let ring = [(2.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 1.0), (2.0, 0.0)].map(|(x, y)| DVec2::new(x, y));
    let k = 4.0 / 3.0 * (2f64.sqrt() - 1.0);
    let ball = [(0.0, -1.0), (k, -1.0), (1.0, -k), (1.0, 0.0), (1.0, k), (k, 1.0), (0.0, 1.0)]
        .map(|(x, y)| DVec2::new(x, y));
    let diamond = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
    let revolved = |profile: &[DVec2], bezier| Shape::Revolution {
        profile: profile.to_vec(),
        bezier,
        angle: TAU,
        capped: true,
    };
    vec![
        ("sphere", Shape::Sphere { radius: 2.0 }, 2, 32.0 / 3.0 * PI),
        ("ellipsoid", Shape::Ellipsoid { radii: DVec3::new(1.0, 2.0, 3.0) }, 2, 8.0 * PI),
        ("box", Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) }, 2, 6.0),
        ("cylinder", Shape::Cylinder { radius: 1.0, height: 2.0, capped: true }, 2, TAU),
        ("cone", Shape::Cone { radius: 1.0, top_radius: 0.0, height: 3.0, capped: true }, 2, PI),
        ("tip down", Shape::Cone { radius: 0.0, top_radius: 1.0, height: 3.0, capped: true }, 2, PI),
        ("frustum", Shape::Cone { radius: 2.0, top_radius: 1.0, height: 3.0, capped: true }, 2, 7.0 * PI),
        ("torus", Shape::Torus { major_radius: 2.0, minor_radius: 0.5 }, 0, TAU * 2.0 * PI * 0.25),
        ("prism", Shape::Prism { base: square, height: 3.0, capped: true }, 2, 3.0 * 2.5),
        ("ring", revolved(&ring, false), 0, 5.0 * PI),
        ("Bézier ball", revolved(&ball, true), 2, 4.0 / 3.0 * PI),
        ("diamond", revolved(&diamond, false), 2, 2.0 / 3.0 * PI),
    ]
}

#[test]
fn closed_shapes_are_watertight_at_every_tolerance_and_fill_their_volume() {
    for (name, shape, euler, volume) in closed_shapes() {
        for exponent in 0..3 {
            let tolerance = 0.3 * 10f64.powi(-exponent);
            let mesh = mesh_at(&shape, Tolerance::World(tolerance));
            assert_closed(&mesh, euler, name);
            assert_normals_fit(&mesh, name);
            let error = (mesh.signed_volume() / volume - 1.0).abs();
            assert!(error < (4.0 * tolerance).max(1e-3), "{name} at {tolerance}: {error}");
        }
        for steps in [(3, 1), (4, 2), (7, 5), (64, 3)] {
            let mesh = mesh_at(&shape, Tolerance::Steps(steps.0, steps.1));
            assert_closed(&mesh, euler, name);
            assert_normals_fit(&mesh, name);
        }
    }
}

#[test]
fn polygons_are_kept_where_wanted() {
    let settings = TessellationSettings { polygons: true, ..TessellationSettings::default() };
    let sides = |shape: Shape| tessellate(&shape, &settings).unwrap().faces.len();
    assert_eq!(sides(Shape::Box { size: DVec3::ONE }), 6);
    let base = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
    assert_eq!(sides(Shape::Prism { base, height: 1.0, capped: true }), 6);
    assert_eq!(sides(Shape::Plane { size: Some(3.0) }), 1);
    for (name, shape, euler, _) in closed_shapes() {
        assert_closed(&tessellate(&shape, &settings).unwrap(), euler, name);
    }
}

/// Distance of a point from the unit sphere, over corners, side middles and centres of all faces.
fn sphere_error(mesh: &Mesh, radius: f64) -> f64 {
    let error = |p: Vec3| (p.as_dvec3().length() - radius).abs();
    let mut worst: f64 = 0.0;
    for corners in mesh.faces.iter() {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(|v| mesh.position(v));
        let normal = (b - a).cross(c - a).as_dvec3().normalize_or_zero();
        worst = worst.max((normal.dot(a.as_dvec3()) - radius).abs());
        for p in [a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0] {
            worst = worst.max(error(p));
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn spheres_stay_within_the_tolerance(radius in 0.1f64..50.0, share in 0.0005f64..0.2) {
        let tolerance = share * radius;
        let mesh = mesh_at(&Shape::Sphere { radius }, Tolerance::World(tolerance));
        let error = sphere_error(&mesh, radius);
        prop_assert!(error <= tolerance * 1.001 + 1e-6 * radius, "{error} > {tolerance}");
        // Not wastefully fine either: the fewest triangles within t are about 4 pi r / (1.3 t).
        prop_assert!(mesh.faces.len() as f64 <= 30.0 / share + 300.0);
    }

    #[test]
    fn tori_are_closed_rings(major in 0.1f64..9.0, minor in 0.01f64..9.0, tolerance in 0.001f64..1.0) {
        let mesh = mesh_at(&Shape::Torus { major_radius: major, minor_radius: minor }, Tolerance::World(tolerance));
        assert_closed(&mesh, 0, "torus");
    }

    #[test]
    fn no_numbers_make_a_shape_panic(a in any::<f64>(), b in any::<f64>(), c in any::<f64>(), tolerance in any::<f64>(), u in any::<u32>()) {
        let profile = vec![DVec2::new(a, b), DVec2::new(b, c), DVec2::new(c, a)];
        let shapes = [
            Shape::Sphere { radius: a },
            Shape::Ellipsoid { radii: DVec3::new(a, b, c) },
            Shape::Box { size: DVec3::new(a, b, c) },
            Shape::Cylinder { radius: a, height: b, capped: true },
            Shape::Cone { radius: a, top_radius: b, height: c, capped: true },
            Shape::Torus { major_radius: a, minor_radius: b },
            Shape::Disc { radius: a, inner_radius: b },
            Shape::Plane { size: Some(a) },
            Shape::Polygon { outline: vec![DVec3::new(a, b, c), DVec3::new(b, c, a), DVec3::new(c, a, b)], holes: vec![] },
            Shape::Prism { base: profile.clone(), height: a, capped: true },
            Shape::Revolution { profile, bezier: false, angle: b, capped: true },
        ];
        let size = a.abs().max(b.abs()).max(c.abs());
        let coarse =
            if tolerance.abs() > 0.01 * size { Tolerance::World(tolerance) } else { Tolerance::Steps(u % 9, 3) };
        for shape in shapes {
            if let Ok(mesh) = tessellate(&shape, &with(coarse)) {
                prop_assert_eq!(mesh.check(), Ok(()));
            }
        }
    }
}

#[test]
fn normals_are_those_of_the_shape() {
    let radii = DVec3::new(1.0, 2.0, 3.0);
    let mesh = mesh_at(&Shape::Ellipsoid { radii }, Tolerance::World(0.01));
    for (v, normal) in mesh.vertices.normal.iter().enumerate() {
        let p = mesh.position(v as u32).as_dvec3();
        let exact = (p / (radii * radii)).normalize();
        assert!(normal.as_dvec3().dot(exact) > 0.999_99);
    }
    let cone = mesh_at(
        &Shape::Cone { radius: 3.0, top_radius: 0.0, height: 4.0, capped: false },
        Tolerance::Steps(16, 1),
    );
    assert!(cone.vertices.normal.iter().all(|n| (n.y - 0.6).abs() < 1e-6));
    let tip = cone.points.iter().position(|p| p.y == 4.0).unwrap() as u32;
    assert_eq!(
        cone.vertices.point.iter().filter(|&&p| p == tip).count(),
        16,
        "the tip has a normal per side"
    );
}

#[test]
fn creases_are_borders_of_surfaces() {
    let mesh = mesh_at(&Shape::Cylinder { radius: 1.0, height: 1.0, capped: true }, Tolerance::World(0.01));
    assert_eq!(mesh.surfaces.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["side", "bottom", "top"]);
    let cube = mesh_at(&Shape::Box { size: DVec3::ONE }, Tolerance::World(0.1));
    assert_eq!((cube.points.len(), cube.vertices.point.len(), cube.surfaces.len()), (8, 24, 6));
    let cup = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.05, 2.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
    let cup = mesh_at(
        &Shape::Revolution { profile: cup, bezier: false, angle: TAU, capped: true },
        Tolerance::World(0.01),
    );
    assert_eq!(cup.surfaces.len(), 2, "a crease at the foot, none at the slight turn");
}

#[test]
fn textures_stand_upright() {
    let sphere = mesh_at(&Shape::Sphere { radius: 1.0 }, Tolerance::Steps(8, 4));
    for (v, uv) in sphere.vertices.texcoord0.iter().enumerate() {
        let y = sphere.position(v as u32).y;
        assert!(((1.0 - 2.0 * uv.y).mul_add(std::f32::consts::FRAC_PI_2, 0.0).sin() - y).abs() < 1e-5);
        if (uv.x - 0.5).abs() < 1e-6 && y.abs() < 0.5 {
            assert!(sphere.position(v as u32).z > 0.0, "the picture's middle looks along +z");
        }
    }
    let cube = mesh_at(&Shape::Box { size: DVec3::splat(2.0) }, Tolerance::World(0.1));
    for (v, uv) in cube.vertices.texcoord0.iter().enumerate().take(4) {
        assert_eq!(
            cube.position(v as u32).truncate(),
            senca_math::glam::Vec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y)
        );
    }
}

#[test]
fn partial_turns_sweep_from_x_towards_minus_z() {
    let profile = vec![DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0)];
    let quarter = Shape::Revolution { profile, bezier: false, angle: PI / 2.0, capped: true };
    let mesh = mesh_at(&quarter, Tolerance::World(1e-3));
    assert!((mesh.area() - PI / 2.0).abs() < 3e-3);
    assert!(mesh.points.iter().all(|p| p.x > -1e-6 && p.z < 1e-6));
    assert_normals_fit(&mesh, "quarter");
}

#[test]
fn the_ends_of_partial_turns_close_what_can_be_closed() {
    let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| DVec2::new(x, y)).collect::<Vec<_>>();
    let ring = points(&[(1.0, 0.0), (2.0, 0.0), (2.0, 0.5), (1.5, 0.2), (1.0, 1.0), (1.0, 0.0)]);
    let spool = points(&[(0.0, 0.0), (1.0, 0.0), (0.3, 1.0), (1.0, 2.0), (0.0, 2.0)]);
    let cup = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
    let reversed = |profile: &[DVec2]| profile.iter().rev().copied().collect::<Vec<_>>();
    for angle in [0.5, PI, 4.0] {
        let turned = |profile: &[DVec2], capped| Shape::Revolution {
            profile: profile.to_vec(),
            bezier: false,
            angle,
            capped,
        };
        for profile in [&ring, &spool] {
            let mesh = mesh_at(&turned(profile, true), Tolerance::World(1e-4));
            assert_normals_fit(&mesh, "capped");
            let topology = crate::Topology::new(&mesh);
            assert!(topology.is_closed() && topology.is_oriented(), "{angle} {profile:?}");
            let full =
                Shape::Revolution { profile: profile.clone(), bezier: false, angle: TAU, capped: true };
            let whole = mesh_at(&full, Tolerance::World(1e-4)).signed_volume();
            let share = mesh.signed_volume() / whole;
            assert!((share - angle / TAU).abs() < 1e-3, "{share} of a turn by {angle}");
            assert!(turned(profile, true).check_closed().is_ok());
            assert!(turned(profile, false).check_closed().is_err());
            let inside_out = mesh_at(&turned(&reversed(profile), true), Tolerance::World(1e-4));
            assert!(crate::Topology::new(&inside_out).is_oriented());
            assert!((inside_out.signed_volume() + mesh.signed_volume()).abs() < 1e-3);
        }
        // The cup's wall has no inside: nothing to close.
        let [open, asked] =
            [false, true].map(|capped| mesh_at(&turned(&cup, capped), Tolerance::World(1e-2)));
        assert_eq!(open, asked);
    }
}

#[test]
fn a_concave_polygon_with_a_hole_keeps_its_area() {
    let outline = [(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (3.0, 3.5), (0.0, 6.0)]
        .map(|(x, z)| DVec3::new(x, 2.0, -z))
        .to_vec();
    let hole = |x: f64, y: f64| {
        [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)].map(|(x, z)| DVec3::new(x, 2.0, -z)).to_vec()
    };
    let holes = vec![hole(1.0, 1.0), hole(3.0, 0.5), hole(4.5, 2.0)];
    let mesh = mesh_at(&Shape::Polygon { outline, holes }, Tolerance::World(0.1));
    assert!((mesh.area() - (36.0 - 7.5 - 3.0)).abs() < 1e-4, "{}", mesh.area());
    assert!(mesh.vertices.normal.iter().all(|n| *n == Vec3::Y));
    assert_normals_fit(&mesh, "polygon");
}

#[test]
fn an_endless_plane_is_cut_at_the_extent() {
    let settings = TessellationSettings { plane_extent: 50.0, ..TessellationSettings::default() };
    let mesh = tessellate(&Shape::Plane { size: None }, &settings).unwrap().into_owned();
    assert_eq!((mesh.area(), mesh.vertices.normal[0]), (2500.0, Vec3::Y));
    assert_normals_fit(&mesh, "plane");
}

fn teapot_parts(range: std::ops::Range<usize>) -> Shape {
    Shape::BezierPatches { patches: teapot()[range].to_vec() }
}

#[test]
fn the_teapot_has_no_cracks() {
    for tolerance in [1.0, 0.1, 0.03, 0.01, 0.003, 0.001] {
        let body = mesh_at(&teapot_parts(0..12), Tolerance::World(tolerance));
        let topology = Topology::new(&body);
        // The body is open at its rim's inside and at its foot: two circles of borders.
        assert!(topology.is_manifold() && topology.is_oriented());
        assert_eq!(topology.euler_characteristic(&body), 0, "a tube at {tolerance}");
        let rim = topology.edge_counts().border;
        let with_bottom: Vec<BezierPatch> =
            teapot().into_iter().filter(|p| p.surface == 0 || p.surface == 4).collect();
        let closed = mesh_at(&Shape::BezierPatches { patches: with_bottom }, Tolerance::World(tolerance));
        let topology = Topology::new(&closed);
        assert!(topology.edge_counts().border < rim, "the foot is closed at {tolerance}");
        assert_eq!(topology.euler_characteristic(&closed), 1, "a bowl at {tolerance}");
        for part in [12..16, 16..20, 20..28] {
            let mesh = mesh_at(&teapot_parts(part.clone()), Tolerance::World(tolerance));
            let topology = Topology::new(&mesh);
            assert!(topology.is_manifold() && topology.is_oriented(), "{part:?} at {tolerance}");
        }
    }
}

#[test]
fn all_of_the_teapot_faces_outwards_and_has_normals() {
    let mesh = mesh_at(&teapot_parts(0..32), Tolerance::World(0.005));
    assert_eq!(mesh.surfaces.len(), 5);
    let fits = |corners: &[u32]| {
        let face = crate::newell_vector(corners.iter().map(|&v| mesh.position(v)));
        corners.iter().all(|&v| mesh.vertices.normal[v as usize].dot(face) > -0.3 * face.length())
    };
    assert!(mesh.faces.iter().all(fits));
    let tip = mesh.points.iter().position(|p| p.z == 3.15 && p.x == 0.0 && p.y == 0.0).unwrap() as u32;
    let foot = mesh.points.iter().position(|p| *p == Vec3::ZERO).unwrap() as u32;
    for (point, z) in [(tip, 1.0), (foot, -1.0)] {
        let at: Vec<usize> =
            (0..mesh.vertices.point.len()).filter(|&v| mesh.vertices.point[v] == point).collect();
        assert!(
            !at.is_empty() && at.iter().all(|&v| mesh.vertices.normal[v].z * z > 0.999),
            "collapsed rows keep a normal"
        );
    }
}

#[test]
fn patches_stay_within_the_tolerance() {
    for tolerance in [0.05, 0.01, 0.002] {
        for patch in teapot().into_iter().step_by(3) {
            let mesh =
                mesh_at(&Shape::BezierPatches { patches: vec![patch.clone()] }, Tolerance::World(tolerance));
            for corners in mesh.faces.iter() {
                // The texture coordinates are the parameters: the middle of a face is near S(middle),
                // but for the faces at a collapsed edge, where u has no meaning.
                let uv = |v: u32| mesh.vertices.texcoord0[v as usize].as_dvec2();
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                let middle = (mesh.position(a) + mesh.position(b) + mesh.position(c)).as_dvec3() / 3.0;
                let exact = on_patch(&patch.points, (uv(a) + uv(b) + uv(c)) / 3.0);
                assert!(middle.distance(exact) <= tolerance, "{} > {tolerance}", middle.distance(exact));
            }
        }
    }
}

#[test]
fn fixed_steps_give_the_counts_of_a_merged_grid() {
    for n in [1, 2, 4, 8] {
        let mesh = mesh_at(&teapot_parts(0..32), Tolerance::Steps(n, n));
        assert_eq!(mesh.points.len() as u32, 32 * n * n + 4 * n + 1);
    }
    // Patches that meet with u along v take the larger number on the common edge.
    let a = teapot()[4].clone();
    let mut b = teapot()[5].clone();
    b.points = std::array::from_fn(|i| teapot()[5].points[4 * (3 - i % 4) + i / 4]);
    let mesh = mesh_at(&Shape::BezierPatches { patches: vec![a, b] }, Tolerance::Steps(2, 7));
    let topology = Topology::new(&mesh);
    assert_eq!((topology.euler_characteristic(&mesh), topology.parts(&mesh)), (1, 1));
}

/// A quarter turn of a cylinder with radius 1 as a rational quadratic, swept linearly in v.
fn nurbs_cylinder() -> NurbsSurface {
    let w = 0.5f64.sqrt();
    let circle = [
        (1.0, 0.0, 1.0),
        (1.0, 1.0, w),
        (0.0, 1.0, 1.0),
        (-1.0, 1.0, w),
        (-1.0, 0.0, 1.0),
        (-1.0, -1.0, w),
        (0.0, -1.0, 1.0),
        (1.0, -1.0, w),
        (1.0, 0.0, 1.0),
    ];
    let row = |z: f64| circle.map(|(x, y, _)| DVec3::new(x, y, z));
    NurbsSurface {
        degree: [2, 1],
        knots: [vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0], vec![0.0, 0.0, 1.0, 1.0]],
        counts: [9, 2],
        points: [row(0.0), row(2.0)].concat(),
        weights: [circle.map(|c| c.2), circle.map(|c| c.2)].concat(),
    }
}

#[test]
fn a_rational_circle_is_round_and_closes() {
    let mesh = mesh_at(&Shape::Nurbs(nurbs_cylinder()), Tolerance::World(1e-3));
    assert!(mesh.points.iter().all(|p| (p.truncate().length() - 1.0).abs() < 1e-6));
    assert!((mesh.area() - 2.0 * TAU).abs() < 0.02);
    for (v, n) in mesh.vertices.normal.iter().enumerate() {
        assert!(n.truncate().dot(mesh.position(v as u32).truncate()) > 0.999_99);
    }
    let topology = Topology::new(&mesh);
    assert_eq!(topology.euler_characteristic(&mesh), 0, "the seam is closed");
    assert_normals_fit(&mesh, "NURBS cylinder");
}

/// Control points and weights of a surface over two spans by one.
fn rough_nurbs() -> impl Strategy<Value = NurbsSurface> {
    let knots = |degree: usize, spans: usize| -> Vec<f64> {
        let end = |t: usize| std::iter::repeat_n(t as f64, degree + 1);
        end(0).chain((1..spans).map(|t| t as f64)).chain(end(spans)).collect()
    };
    let point = prop::array::uniform3(-1.0f64..1.0);
    let numbers = prop::collection::vec((point, 0.1f64..4.0), 30);
    (1usize..5, 1usize..5, numbers, any::<bool>()).prop_map(move |(pu, pv, numbers, rational)| {
        let counts = [pu + 2, pv + 1];
        let used = &numbers[..counts[0] * counts[1]];
        let place = |i: usize| DVec3::new((i % counts[0]) as f64, (i / counts[0]) as f64, 0.0);
        NurbsSurface {
            degree: [pu, pv],
            knots: [knots(pu, 2), knots(pv, 1)],
            counts,
            points: used.iter().enumerate().map(|(i, n)| place(i) + DVec3::from_array(n.0)).collect(),
            weights: if rational { used.iter().map(|n| n.1).collect() } else { Vec::new() },
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nurbs_stay_within_the_tolerance(surface in rough_nurbs(), tolerance in 0.02f64..0.3) {
        let evaluator = surface.evaluator().unwrap();
        let domain = DVec2::new(2.0, 1.0);
        let mesh = mesh_at(&Shape::Nurbs(surface), Tolerance::World(tolerance));
        let thinned = mesh.faces.len().div_ceil(3000).max(1);
        for corners in mesh.faces.iter().step_by(thinned) {
            for weights in [[1.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]] {
                let total: f64 = weights.iter().sum();
                let mut uv = DVec2::ZERO;
                let mut place = DVec3::ZERO;
                for (&v, weight) in corners.iter().zip(weights) {
                    uv += weight / total * mesh.vertices.texcoord0[v as usize].as_dvec2();
                    place += weight / total * mesh.position(v).as_dvec3();
                }
                let error = place.distance(evaluator.at(uv.x * domain.x, uv.y * domain.y));
                prop_assert!(error <= tolerance + 1e-5, "{error} > {tolerance}");
            }
        }
    }
}

#[test]
fn the_bound_of_a_rational_arc_is_not_wasteful() {
    let faces = |tolerance| mesh_at(&Shape::Nurbs(nurbs_cylinder()), Tolerance::World(tolerance)).faces.len();
    for tolerance in [1e-2, 1e-3, 1e-4] {
        // A polygon of n corners is 1 - cos(pi / n) inside its circle; half of the tolerance is for v.
        let fewest = PI / (1.0f64 - tolerance).acos();
        let steps = faces(tolerance) as f64 / 2.0;
        assert!(steps < 3.0 * fewest + 4.0, "{steps} instead of {fewest} at {tolerance}");
    }
}

#[test]
fn a_bicubic_patch_is_a_nurbs_surface_too() {
    let patch = teapot()[20].clone();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let surface = NurbsSurface {
        degree: [3, 3],
        knots: [knots.clone(), knots],
        counts: [4, 4],
        points: patch.points.to_vec(),
        weights: vec![],
    };
    let mesh = mesh_at(&Shape::Nurbs(surface), Tolerance::Steps(6, 6));
    for (v, uv) in mesh.vertices.texcoord0.iter().enumerate() {
        let exact = on_patch(&patch.points, uv.as_dvec2()).as_vec3();
        assert!(mesh.position(v as u32).distance(exact) < 1e-5);
    }
    let tip = mesh.points.iter().filter(|p| p.z == 3.15 && p.x == 0.0 && p.y == 0.0).count();
    assert_eq!(tip, 1, "the collapsed border is one point");
}

#[test]
fn bad_nurbs_say_what_is_wrong() {
    let bad = |change: fn(&mut NurbsSurface)| {
        let mut surface = nurbs_cylinder();
        change(&mut surface);
        tessellate(&Shape::Nurbs(surface), &TessellationSettings::default()).unwrap_err().to_string()
    };
    assert!(bad(|s| s.degree[0] = 0).contains("in u: the degree"));
    assert!(bad(|s| s.degree[1] = 99).contains("in v: the degree"));
    assert!(bad(|s| s.knots[0][3] = -1.0).contains("must not decrease"));
    assert!(bad(|s| s.knots[0][3] = f64::NAN).contains("not a finite number"));
    assert!(bad(|s| s.knots[1] = vec![0.0; 4]).starts_with("NURBS surface: in v: "));
    assert!(bad(|s| s.knots[1].push(2.0)).contains("in v: "));
    assert!(bad(|s| s.counts = [usize::MAX, 2]).starts_with("NURBS surface: "));
    assert!(bad(|s| s.weights[3] = 0.0).contains("weight 3 must be positive"));
    assert!(bad(|s| s.weights.truncate(2)).contains("as many weights"));
    assert!(bad(|s| s.points.truncate(2)).contains("need 18 control points"));
}

#[test]
fn bad_parameters_are_named() {
    let error = |shape: Shape| tessellate(&shape, &TessellationSettings::default()).unwrap_err().to_string();
    assert_eq!(
        error(Shape::Sphere { radius: f64::NAN }),
        "sphere: radius is NaN, but must be above 0 and finite"
    );
    assert!(error(Shape::Box { size: DVec3::new(1.0, 0.0, 1.0) }).starts_with("box: edge length is 0"));
    assert!(
        error(Shape::Cone { radius: 0.0, top_radius: 0.0, height: 1.0, capped: true }).starts_with("cone:")
    );
    assert!(error(Shape::Disc { radius: 1.0, inner_radius: 2.0 }).contains("below the outer radius"));
    let profile = vec![DVec2::ONE; 3];
    assert!(
        error(Shape::Revolution { profile: profile.clone(), bezier: true, angle: 1.0, capped: true })
            .contains("3 n + 1")
    );
    assert!(
        error(Shape::Revolution { profile, bezier: false, angle: 1.0, capped: true }).contains("no length")
    );
    assert!(error(Shape::Sphere { radius: 1e200 }).contains("too large"));
}

#[test]
fn absurd_tolerances_are_bounded() {
    let patches: Vec<BezierPatch> = teapot();
    let mesh = tessellate(&Shape::BezierPatches { patches }, &with(Tolerance::Steps(u32::MAX, 1)))
        .unwrap()
        .into_owned();
    assert!((mesh.faces.len() as u64) < 2 * MAX_FACES);
    let fine = mesh_at(&Shape::Cylinder { radius: 1.0, height: 1.0, capped: true }, Tolerance::World(0.0));
    assert!(fine.faces.len() <= 4 * 4096);
    let coarse = mesh_at(&Shape::Sphere { radius: 1.0 }, Tolerance::World(1e9));
    assert_closed(&coarse, 2, "coarse");
}

/// A central projection of one radian: x and y over w are the picture, w is the distance.
fn perspective() -> DMat4 {
    let tan = 0.5f64.tan();
    let rows = [DVec4::X / tan, DVec4::Y / tan, DVec4::Z, DVec4::NEG_Z];
    DMat4::from_rows(rows[0], rows[1], rows[2], rows[3])
}

#[test]
fn nearer_is_finer() {
    let view = |z: f64| {
        let projection = perspective();
        let clip_from_object = projection * DMat4::from_translation(DVec3::new(0.0, 0.0, -z));
        Tolerance::Pixels(PixelTolerance::new(&clip_from_object, 512.0, 512.0, 0.25, 0.1))
    };
    let faces = |z: f64| mesh_at(&Shape::Sphere { radius: 1.0 }, view(z)).faces.len();
    assert!(faces(3.0) > 2 * faces(10.0) && faces(10.0) > 2 * faces(50.0));
    let one_pixel = PixelTolerance::new(&perspective(), 512.0, 512.0, 1.0, 0.1);
    let exact = 2.0 * 10.0 * 0.5f64.tan() / 512.0;
    assert!((one_pixel.at(DVec3::new(3.0, 4.0, -10.0)) - exact).abs() < 1e-12);
    assert!(one_pixel.at(DVec3::Z) > 0.0);
}
