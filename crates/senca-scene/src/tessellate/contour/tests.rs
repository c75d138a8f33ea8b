use std::f64::consts::PI;

use senca_math::Expression;
use senca_math::glam::{DMat4, DVec2, DVec3};

use crate::{Csg, CsgNode, ImplicitSurface, MaterialId, Mesh, Shape, Topology, Transform};
use crate::{TessellationSettings, Tolerance, tessellate};

fn mesh_of(shape: &Shape, tolerance: f64) -> Mesh {
    let settings = TessellationSettings { tolerance: Tolerance::World(tolerance), ..Default::default() };
    tessellate(shape, &settings).expect("a mesh").into_owned()
}

/// The mesh of a closed body, with what always has to hold.
fn body(shape: &Shape, tolerance: f64) -> Mesh {
    let mesh = mesh_of(shape, tolerance);
    assert_eq!(mesh.check(), Ok(()));
    assert_eq!(mesh.check_finite(), Ok(()));
    let topology = Topology::new(&mesh);
    assert!(topology.is_closed() && topology.is_oriented(), "{:?}", topology.edge_counts());
    mesh
}

fn implicit(text: &str, size: f64) -> Shape {
    let expression = Expression::parse(text).expect("a formula");
    let bounds = senca_math::Aabb { min: DVec3::splat(-size), max: DVec3::splat(size) };
    Shape::Implicit(ImplicitSurface { bounds, ..ImplicitSurface::new(expression) })
}

fn at(shape: Shape, place: DVec3) -> CsgNode {
    CsgNode::leaf(shape, Transform::Matrix(DMat4::from_translation(place)), None)
}

fn csg(root: CsgNode) -> Shape {
    Shape::Csg(Csg { root })
}

fn cube(size: f64) -> CsgNode {
    at(Shape::Box { size: DVec3::splat(size) }, DVec3::ZERO)
}

fn ball(radius: f64, x: f64) -> CsgNode {
    at(Shape::Sphere { radius }, DVec3::X * x)
}

fn close(value: f64, expected: f64, share: f64) -> bool {
    (value - expected).abs() <= share * expected.abs()
}

#[test]
fn a_ball_has_its_volume_its_points_on_it_and_its_normals() {
    let mesh = body(&implicit("x^2 + y^2 + z^2 - 1", 1.1), 0.002);
    assert!(close(mesh.signed_volume(), 4.0 / 3.0 * PI, 0.006), "{}", mesh.signed_volume());
    assert!(mesh.points.iter().all(|p| (p.length() - 1.0).abs() < 1e-5));
    let normals = mesh.vertices.normal.iter().zip(&mesh.vertices.point);
    assert!(normals.into_iter().all(|(n, &p)| n.distance(mesh.points[p as usize]) < 1e-4));
    assert_eq!(Topology::new(&mesh).euler_characteristic(&mesh), 2);
}

#[test]
fn tighter_tolerances_are_met() {
    for tolerance in [0.05, 0.005] {
        let mesh = body(&implicit("x^2 + y^2 + z^2 - 1", 1.1), tolerance);
        let middle =
            |f: &[u32]| f.iter().map(|&v| mesh.position(v).as_dvec3()).sum::<DVec3>() / f.len() as f64;
        let most = mesh.faces.iter().map(|f| (middle(f).length() - 1.0).abs()).fold(0.0, f64::max);
        assert!(most <= 1.5 * tolerance, "{most} {tolerance}");
    }
}

#[test]
fn surfaces_end_at_their_box() {
    // A plane through a cube: half of it, or a square.
    let shape = implicit("z", 1.0);
    let half = body(&shape, 0.1);
    assert!(close(half.signed_volume(), 4.0, 1e-5) && close(half.area(), 16.0, 1e-5));
    let Shape::Implicit(surface) = shape else { panic!("implicit") };
    let open = mesh_of(&Shape::Implicit(ImplicitSurface { capped: false, ..surface }), 0.1);
    assert!(close(open.area(), 4.0, 1e-5));
    assert!(!Topology::new(&open).is_closed());
    assert!(mesh_of(&implicit("x^2 + 1", 1.0), 0.1).faces.is_empty());
    assert!(close(body(&implicit("-1", 1.0), 0.1).signed_volume(), 8.0, 1e-5));
}

#[test]
fn differences_keep_their_creases_sharp() {
    // A cube with a sixth of a ball bitten out of it by a ball on a side.
    let shape = csg(CsgNode::Difference(vec![cube(2.0), ball(0.5, 1.0)]));
    let mesh = body(&shape, 0.002);
    let expected = 8.0 - 2.0 / 3.0 * PI * 0.125;
    assert!(close(mesh.signed_volume(), expected, 0.002), "{}", mesh.signed_volume());
    // All corners of the cube are there.
    let corner = senca_math::glam::Vec3::ONE;
    assert!(mesh.points.iter().any(|p| p.abs().distance(corner) < 1e-4));
    // Normals of flat sides are exact.
    let flat = mesh.vertices.normal.iter().filter(|n| n.abs().max_element() > 0.9999).count();
    assert!(flat > 100);
}

#[test]
fn unions_and_intersections_have_the_volumes_of_lenses() {
    // Two unit balls one apart have a lens of two caps of height 1/2 in common.
    let lens = 2.0 * PI * 0.25 * (3.0 - 0.5) / 3.0;
    let both = body(&csg(CsgNode::Intersection(vec![ball(1.0, 0.0), ball(1.0, 1.0)])), 0.002);
    assert!(close(both.signed_volume(), lens, 0.01), "{} {lens}", both.signed_volume());
    let either = body(&csg(CsgNode::Union(vec![ball(1.0, 0.0), ball(1.0, 1.0)])), 0.002);
    assert!(close(either.signed_volume(), 8.0 / 3.0 * PI - lens, 0.006));
}

#[test]
fn half_spaces_cut() {
    let plane = at(Shape::Plane { size: None }, DVec3::ZERO);
    let half = body(&csg(CsgNode::Intersection(vec![ball(1.0, 0.0), plane])), 0.002);
    assert!(close(half.signed_volume(), 2.0 / 3.0 * PI, 0.006));
}

#[test]
fn every_leaf_with_a_formula_has_its_volume() {
    let turned =
        Transform::Matrix(DMat4::from_rotation_x(0.4) * DMat4::from_scale(DVec3::new(1.0, 1.5, 0.8)));
    let far = || ball(0.2, 5.0);
    let alone = 4.0 / 3.0 * PI * 0.008;
    for (shape, volume) in [
        (Shape::Cylinder { radius: 0.5, height: 2.0, capped: true }, 0.5 * PI),
        (Shape::Cone { radius: 1.0, top_radius: 0.5, height: 1.0, capped: true }, PI * 1.75 / 3.0),
        (Shape::Torus { major_radius: 1.0, minor_radius: 0.3 }, 2.0 * PI * PI * 0.09),
        (Shape::Ellipsoid { radii: DVec3::new(1.0, 0.5, 0.7) }, 4.0 / 3.0 * PI * 0.35),
    ] {
        let leaf = CsgNode::leaf(shape.clone(), turned, None);
        let mesh = body(&csg(CsgNode::Union(vec![leaf, far()])), 0.004);
        let expected = 1.2 * volume + alone;
        assert!(
            close(mesh.signed_volume(), expected, 0.02),
            "{shape:?}: {} {expected}",
            mesh.signed_volume()
        );
    }
}

#[test]
fn meshes_and_prisms_are_bodies_too() {
    let base = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
    let base = base.map(|(x, z)| DVec2::new(x, z)).to_vec();
    let prism = Shape::Prism { base, height: 1.0, capped: true };
    let bite = at(Shape::Sphere { radius: 0.5 }, DVec3::new(2.0, 0.5, 0.5));
    let cut = body(&csg(CsgNode::Difference(vec![at(prism, DVec3::ZERO), bite])), 0.01);
    let expected = 3.0 - 2.0 / 3.0 * PI * 0.125;
    assert!(close(cut.signed_volume(), expected, 0.01), "{} {expected}", cut.signed_volume());
    let mesh = Shape::Mesh(crate::test_support::octagonal_cylinder());
    let both = csg(CsgNode::Intersection(vec![
        at(mesh, DVec3::ZERO),
        at(Shape::Box { size: DVec3::splat(200.0) }, DVec3::ZERO),
    ]));
    assert!(close(body(&both, 0.5).signed_volume(), 70_000.0, 0.01));
}

#[test]
fn cut_faces_take_the_material_of_the_body_that_cuts() {
    let cutter = CsgNode::leaf(Shape::Sphere { radius: 1.2 }, Transform::default(), Some(MaterialId(7)));
    let mesh = body(&csg(CsgNode::Difference(vec![cube(2.0), cutter])), 0.02);
    let cut = |i: usize| mesh.surfaces[mesh.faces.surface_of(i) as usize].material == Some(MaterialId(7));
    let (mut inner, mut outer) = (0, 0);
    for (i, face) in mesh.faces.iter().enumerate() {
        let middle: DVec3 = face.iter().map(|&v| mesh.position(v).as_dvec3()).sum::<DVec3>() / 3.0;
        assert_eq!(cut(i), middle.abs().max_element() < 0.99, "{middle}");
        if cut(i) { inner += 1 } else { outer += 1 }
    }
    assert!(inner > 100 && outer > 100);
    // Its normals face the hollow.
    let into = (0..mesh.vertices.point.len()).filter(|&v| {
        let p = mesh.points[mesh.vertices.point[v] as usize];
        mesh.vertices.normal[v].dot(p) < 0.0
    });
    assert!(into.count() > 100);
}

#[test]
fn difficult_surfaces_stay_closed() {
    // Nodes, tunnels and many ambiguous cells.
    for (text, size) in [
        ("4*(x^2 + y^2 + z^2) + 16*x*y*z - 1", 1.0),
        ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8", 2.5),
        ("sin(3*x)*cos(3*y) + sin(3*y)*cos(3*z) + sin(3*z)*cos(3*x)", 2.0),
        ("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", 1.4),
        ("sin(9*x)*sin(9*y)*sin(9*z)", 1.0),
    ] {
        for steps in [12, 27] {
            let settings =
                TessellationSettings { tolerance: Tolerance::Steps(steps, steps), ..Default::default() };
            let mesh = tessellate(&implicit(text, size), &settings).expect("a mesh").into_owned();
            let topology = Topology::new(&mesh);
            assert!(!mesh.faces.is_empty());
            assert!(topology.is_closed() && topology.is_oriented(), "{text} {:?}", topology.edge_counts());
        }
    }
}

#[test]
fn the_same_body_gives_the_same_mesh() {
    let shape = csg(CsgNode::Difference(vec![cube(2.0), ball(1.2, 0.0)]));
    assert_eq!(mesh_of(&shape, 0.02), mesh_of(&shape, 0.02));
}
