use proptest::prelude::{ProptestConfig, prop_assert_eq, proptest};

use super::*;
use crate::lab::polygon::Position;

const CUBE: &str = "# the cube of figure 4.1
v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\nv 1 1 1\nv 0 1 0\nv 0 1 1
f 1 3 2\nf 3 4 2\nf 3 5 4\nf 5 6 4\nf 5 7 6\nf 7 8 6\nf 7 1 8\nf 1 2 8\nf 1 5 3\nf 1 7 5\nf 2 4 6\nf 2 6 8\n";

/// The cube of the manual, in the coordinates of its file.
pub(crate) fn cube() -> Solid {
    Solid::read("cube.obj", CUBE.as_bytes()).expect("a cube")
}

/// The cube, scaled to [-1, 1].
pub(crate) fn normalized_cube() -> Solid {
    cube().normalized().expect("has a size")
}

/// The columns P of the manual's table, from 0.
const P: [[usize; 3]; 12] = [
    [0, 1, 2],
    [2, 1, 3],
    [2, 3, 4],
    [4, 3, 5],
    [4, 5, 6],
    [6, 5, 7],
    [6, 7, 0],
    [0, 7, 1],
    [0, 2, 4],
    [0, 4, 7],
    [1, 5, 3],
    [1, 7, 5],
];

#[test]
fn the_planes_of_the_cube() {
    let expected = [
        [0.0, -1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, -1.0],
        [0.0, 1.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0, -1.0],
    ];
    let planes = cube().planes();
    assert_eq!(planes.len(), 12);
    for (i, plane) in planes.iter().enumerate() {
        assert_eq!(*plane, expected[i / 2], "face {}", i + 1);
    }
    let normalized = normalized_cube();
    assert!(normalized.vertices.iter().all(|v| v.iter().all(|c| c.abs() == 1.0)));
    for (plane, original) in normalized.planes().iter().zip(planes) {
        let [a, b, c, _] = original;
        assert_eq!(*plane, [4.0 * a, 4.0 * b, 4.0 * c, -4.0]);
    }
}

#[test]
fn the_cube_is_closed_and_its_normals_point_outwards() {
    let cube = cube();
    assert_eq!((cube.faces.len(), cube.edges().len(), cube.directed_edge_count()), (12, 18, 36));
    assert!(cube.is_closed() && cube.is_convex());
    assert_eq!(cube.six_volumes(), 6.0);
}

#[test]
fn the_other_column_of_the_table_is_turned_over_and_has_a_slip() {
    let with = |faces: [[usize; 3]; 12]| Solid { faces: faces.map(|f| f.to_vec()).to_vec(), ..cube() };
    let printed = with(P);
    assert!(!printed.is_closed());
    assert_eq!(printed.directed_edge_count(), 35);
    assert_eq!(printed.planes()[9], [1.0, -1.0, 1.0, 0.0]);
    assert_eq!(printed.six_volumes(), -6.0, "volume alone misses the slip");
    let mut counts: Vec<usize> = printed.directed_edges().values().copied().collect();
    counts.extend(printed.edges().iter().map(|&[a, b]| {
        let uses = printed.directed_edges();
        uses.get(&(a, b)).unwrap_or(&0) + uses.get(&(b, a)).unwrap_or(&0)
    }));
    assert_eq!((counts.iter().min(), counts.iter().max()), (Some(&1), Some(&3)));
    let mut mended = P;
    mended[9] = [0, 4, 6];
    let mended = with(mended);
    assert!(mended.is_closed());
    assert_eq!(mended.six_volumes(), -6.0);
    for (f, p) in cube().planes().iter().zip(mended.planes()) {
        assert_eq!(*f, p.map(|v| 0.0 - v), "reversed");
    }
}

#[test]
fn points_and_the_cube() {
    let cube = cube();
    let at = |x, y, z| cube.position([x, y, z]);
    let middle = at(0.5, 0.5, 0.5);
    assert_eq!((middle.position, middle.method), (Position::Inside, Method::Planes));
    assert_eq!(middle.values, [-0.5; 12]);
    let corner = at(0.9, 0.9, 0.9);
    assert_eq!(corner.position, Position::Inside);
    assert!(corner.values.iter().all(|v| (v + 0.9).abs() < 1e-15 || (v + 0.1).abs() < 1e-15));
    let on_face = at(0.5, 0.5, 0.0);
    assert_eq!(on_face.position, Position::Boundary);
    assert_eq!((&on_face.values[..8], &on_face.values[8..]), (&[-0.5; 8][..], &[0.0, 0.0, -1.0, -1.0][..]));
    let on_corner = at(0.0, 0.0, 0.0);
    assert_eq!(on_corner.position, Position::Boundary);
    assert_eq!(on_corner.values.iter().filter(|&&v| v == 0.0).count(), 6);
    let beside = at(2.0, 0.5, 0.5);
    assert_eq!(beside.position, Position::Outside);
    assert_eq!(
        (beside.values[2], beside.values[3], beside.values[6], beside.values[7]),
        (1.0, 1.0, -2.0, -2.0)
    );
    let below = at(0.5, 0.5, -0.1);
    assert_eq!((below.position, below.values[8], below.values[9]), (Position::Outside, 0.1, 0.1));
}

#[test]
fn rays_count_faces() {
    let cube = cube();
    assert_eq!(
        ray_crossings(&cube, [0.5; 3], [1.0, 0.0, 0.0]),
        None,
        "through the diagonal of two triangles"
    );
    let found = ray_crossings(&cube, [0.5; 3], [4.0, 1.0, 2.0]).expect("through the middle of a face");
    assert_eq!(found, [Crossing { face: 3, t: 0.125 }]);
    let from_outside = ray_crossings(&cube, [-1.0, 0.25, 0.375], [1.0, 0.0, 0.0]).expect("through faces");
    assert_eq!(from_outside, [Crossing { face: 7, t: 1.0 }, Crossing { face: 2, t: 2.0 }]);
    assert_eq!(cube.position_by_ray([0.5; 3]).position, Position::Inside);
    assert_eq!(cube.position_by_ray([-1.0, 0.25, 0.375]).position, Position::Outside);
    assert_eq!(cube.position_by_ray([1.0, 0.25, 0.375]).position, Position::Boundary);
}

#[test]
fn planes_by_each_formula() {
    let [v1, v2, v3] = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    let plane = plane_through(v1, v2, v3);
    assert_eq!(plane, [6.0, 3.0, 2.0, -6.0]);
    assert_eq!(plane_of(&[v1, v2, v3]), plane);
    assert_eq!(plane_by_inversion(v1, v2, v3, -6.0), Some(plane));
    let printed = plane.map(|v| v / 36.0);
    assert_eq!(printed, [1.0 / 6.0, 1.0 / 12.0, 1.0 / 18.0, -1.0 / 6.0]);
    for (point, expected) in [([0.0; 3], -6.0), ([1.0; 3], 5.0)] {
        assert_eq!(value(plane, point), expected);
    }
    assert!(value(plane, [1.0 / 3.0, 2.0 / 3.0, 1.0]).abs() < 1e-15);
    assert_eq!(line_meets_plane([0.0; 3], [1.0; 3], plane), Some(6.0 / 11.0));
    assert_eq!(line_meets_plane([0.0; 3], [1.0, -2.0, 0.0], plane), None);
    // Every plane through the origin, not only the coordinate planes.
    assert_eq!(plane_by_inversion([1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0], 0.0), None);
    assert_eq!(plane_through([1.0; 3], [2.0; 3], [3.0; 3]), [0.0; 4], "a line has no plane");
    let k = parametric_plane(v1, v2, v3);
    assert_eq!(k.0, [subtract(v2, v1), subtract(v3, v1), v1]);
    assert_eq!(k.transform([0.0, 1.0, 1.0]), v3);
}

#[test]
fn a_quadrilateral_that_is_not_flat() {
    let quad = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]];
    let [a, b, c, d] = plane_of(&quad);
    assert_eq!([a, b, c], [-0.1, -0.1, 2.0]);
    for (corner, expected) in quad.iter().zip([0.0, 0.1, 0.0, 0.1]) {
        assert!((-dot([a, b, c], *corner) - expected).abs() < 1e-15);
    }
    assert!((d - 0.05).abs() < 1e-15, "the mean of the corners' own");
}

#[test]
fn normalisation() {
    let solid = Solid {
        vertices: vec![[2.0, 0.0, -1.0], [6.0, 1.0, 3.0], [4.0, 3.0, 0.0]],
        faces: vec![vec![0, 1, 2]],
    };
    assert_eq!(solid.bounds(), ([2.0, 0.0, -1.0], [6.0, 3.0, 3.0]));
    let map = solid.normalization().expect("has a size");
    assert_eq!(map, Normalization { center: [4.0, 1.5, 1.0], scale: 0.5 });
    let expected = [[-1.0, -0.75, -1.0], [1.0, -0.25, 1.0], [0.0, 0.75, -0.5]];
    assert_eq!(solid.normalized().expect("has a size").vertices, expected);
    let flat = Solid { vertices: vec![[1.0; 3]; 3], faces: vec![vec![0, 1, 2]] };
    assert!(flat.normalized().is_err());
}

/// A cube with a pyramid cut into its top.
fn dented() -> Solid {
    let text = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 0 0 4\nv 4 0 4\nv 4 4 4\nv 0 4 4\nv 2 2 1\n\
                f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";
    Solid::read("dented.obj", text.as_bytes()).expect("a solid")
}

#[test]
fn concave_solids_are_tested_by_rays() {
    let solid = dented();
    assert!(solid.is_closed() && !solid.is_convex());
    for (point, expected) in [
        ([2.0, 2.0, 3.0], Position::Outside),
        ([2.0, 2.0, 0.5], Position::Inside),
        ([0.5, 0.5, 3.0], Position::Inside),
        ([2.0, 2.0, 1.0], Position::Boundary),
        ([4.0, 1.0, 2.0], Position::Boundary),
        ([2.0, 2.0, 4.0], Position::Outside),
        ([9.0, 2.0, 2.0], Position::Outside),
    ] {
        let found = solid.position(point);
        assert_eq!((found.position, found.method), (expected, Method::Ray), "{point:?}");
    }
}

#[test]
fn bad_models_are_told_with_their_place() {
    let told = |text: &str| Solid::read("a.obj", text.as_bytes()).expect_err(text).to_string();
    assert!(
        told("v 0 0 0\nv 1 0 0\nf 1 2 9\n").starts_with("a.obj:3:"),
        "{}",
        told("v 0 0 0\nv 1 0 0\nf 1 2 9\n")
    );
    assert!(told("v 0 x 0\nf 1 1 1\n").starts_with("a.obj:1:5"), "{}", told("v 0 x 0\nf 1 1 1\n"));
    assert!(told("v 0 0 0\n").starts_with("a.obj"), "{}", told("v 0 0 0\n"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn both_rules_agree_about_convex_solids(x in -0.5f64..1.5, y in -0.5f64..1.5, z in -0.5f64..1.5) {
        let cube = cube();
        prop_assert_eq!(cube.position_by_planes([x, y, z]).position, cube.position_by_ray([x, y, z]).position);
    }
}
