use senca_math::glam::DMat3;

use super::*;

type Quad = [DVec3; 4];

fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Quad {
    let [o, u, v] = [origin, u, v].map(DVec3::from_array);
    [o, o + u, o + u + v, o + v]
}

/// The walls of a box, seen from inside.
fn room([x, y, z]: [f64; 3]) -> [Quad; 6] {
    [
        quad([0.0; 3], [0.0, y, 0.0], [0.0, 0.0, z]),
        quad([x, 0.0, 0.0], [0.0, 0.0, z], [0.0, y, 0.0]),
        quad([0.0; 3], [0.0, 0.0, z], [x, 0.0, 0.0]),
        quad([0.0, y, 0.0], [x, 0.0, 0.0], [0.0, 0.0, z]),
        quad([0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0]),
        quad([0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0]),
    ]
}

/// The same seen from outside, moved and turned about the vertical.
fn block(origin: [f64; 3], size: [f64; 3], angle: f64) -> [Quad; 6] {
    let turn = DMat3::from_rotation_y(angle);
    room(size).map(|[a, b, c, d]| [d, c, b, a].map(|p| turn * p + DVec3::from_array(origin)))
}

fn mesh_of(quads: &[Quad]) -> ElementMesh {
    let polygons: Vec<_> = quads.iter().map(|q| (&q[..], LinearRgb::splat(0.5), LinearRgb::BLACK)).collect();
    ElementMesh::of_polygons(&polygons)
}

fn follow(mesh: &mut ElementMesh, open: &mut OpenParts) {
    let occluders = Occluders::new(mesh).expect("few");
    let clusters = Clusters::new(mesh);
    let around = Surroundings { clusters: &clusters, occluders: &occluders, is_lit: &|_, _| false };
    open.follow(mesh, &around);
}

/// The open area of a polygon, as its leaves have it.
fn open_area(mesh: &ElementMesh, polygon: u32) -> f64 {
    let elements = mesh.leaves().map(|leaf| &mesh.elements()[leaf as usize]);
    elements.filter(|element| element.polygon == polygon).map(crate::Element::open_area).sum()
}

const FLOOR: u32 = 2;

#[test]
fn what_lies_below_a_block_is_cut_out_of_the_floor() {
    for angle in [0.0, 0.3, 1.1] {
        let mut quads = room([2.0, 1.0, 2.0]).to_vec();
        quads.extend(block([0.7, 0.0, 0.9], [0.4, 0.5, 0.3], angle));
        let mut mesh = mesh_of(&quads);
        let mut open = OpenParts::new(&mesh);
        for level in 0..6 {
            follow(&mut mesh, &mut open);
            let area = open_area(&mesh, FLOOR);
            assert!((area - (4.0 - 0.12)).abs() < 1e-5, "{angle}, level {level}: {area}");
            for other in (0..12).filter(|&other| other != FLOOR) {
                let [found, all] = [open_area(&mesh, other), mesh.elements()[other as usize].area];
                assert!((found - all).abs() < 1e-6, "{other}: {found} {all}");
            }
            let leaves: Vec<u32> = mesh.leaves().collect();
            leaves.iter().for_each(|&leaf| {
                mesh.divide(leaf);
            });
        }
    }
}

#[test]
fn places_are_spread_evenly_over_what_is_open() {
    let mut quads = room([1.0; 3]).to_vec();
    quads.extend(block([0.4, 0.0, 0.3], [0.3, 0.3, 0.5], 0.0));
    let mut mesh = mesh_of(&quads);
    let mut open = OpenParts::new(&mesh);
    follow(&mut mesh, &mut open);
    let (n, mut beside) = (40, 0);
    for i in 0..n * n {
        let [u, v] = [i / n, i % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
        let place = open.place(&mesh, FLOOR, u, v);
        assert!(!((0.401..0.699).contains(&place.x) && (0.301..0.799).contains(&place.z)), "{place}");
        beside += i32::from(place.x < 0.4);
    }
    let share = f64::from(beside) / f64::from(n * n);
    assert!((share - 0.4 / 0.85).abs() < 0.02, "{share}");
    let part = open.get(&mesh, FLOOR).expect("in part");
    let sum: f64 = part
        .triangles()
        .map(|(triangle, share)| {
            assert!((triangle.normal_and_area().1 - 0.85 * share).abs() < 1e-9);
            share
        })
        .sum();
    assert!((sum - 1.0).abs() < 1e-12 && part.shape.is_none());
}

#[test]
fn a_wall_that_goes_on_below_the_floor_ends_there() {
    let mut quads = room([2.0, 1.0, 2.0]).to_vec();
    quads.extend(block([0.7, -0.1, 0.9], [0.4, 0.5, 0.3], 0.4));
    let mut mesh = mesh_of(&quads);
    let mut open = OpenParts::new(&mesh);
    follow(&mut mesh, &mut open);
    let walls = (6..12).filter(|&wall| mesh.normal(wall).y.abs() < 0.5);
    for wall in walls {
        assert!((mesh.elements()[wall as usize].open - 0.8).abs() < 1e-5);
        let shape = open.get(&mesh, wall).and_then(|part| part.shape).expect("a rectangle");
        assert!(shape.corners().iter().all(|corner| corner.y > -1e-9));
        assert!(shape.normal_and_area().0.dot(mesh.normal(wall)) > 0.999);
    }
}

#[test]
fn what_a_thin_wall_a_gap_or_glass_leaves_open_stays_open() {
    // A wall across the room, with light on neither side; a block above the floor; one of glass on it.
    let mut quads = room([2.0, 1.0, 2.0]).to_vec();
    quads.push(quad([1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]));
    quads.extend(block([0.3, 0.01, 0.3], [0.2; 3], 0.0));
    let mut mesh = mesh_of(&quads);
    let mut open = OpenParts::new(&mesh);
    follow(&mut mesh, &mut open);
    assert!((open_area(&mesh, FLOOR) - 4.0).abs() < 1e-9);

    let mut quads = room([2.0, 1.0, 2.0]).to_vec();
    quads.extend(block([0.3, 0.0, 0.3], [0.2; 3], 0.0));
    let mut mesh = mesh_of(&quads);
    (6..12).for_each(|side| mesh.set_transmittance(side, LinearRgb::splat(0.9)));
    let mut open = OpenParts::new(&mesh);
    follow(&mut mesh, &mut open);
    assert!((open_area(&mesh, FLOOR) - 4.0).abs() < 1e-9);
}

#[test]
fn many_contacts_are_counted_by_cells() {
    let mut quads = room([1.0; 3]).to_vec();
    for leg in 0..4 {
        let at = [0.1 + 0.2 * f64::from(leg), 0.0, 0.1 + 0.2 * f64::from(leg)];
        quads.extend(block(at, [0.1, 0.3, 0.1], 0.0));
    }
    let mut mesh = mesh_of(&quads);
    let mut open = OpenParts::new(&mesh);
    follow(&mut mesh, &mut open);
    let coarse = mesh.elements()[FLOOR as usize].open;
    assert!((coarse - 0.96).abs() < 0.03, "{coarse}");
    mesh.divide_to_size(0.2, 1 << 12).expect("few");
    follow(&mut mesh, &mut open);
    let fine = open_area(&mesh, FLOOR);
    assert!((fine - 0.96).abs() < 1e-5, "{fine}");
}

#[test]
fn pieces_join_to_what_they_were_cut_from() {
    let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let segments = [
        [DVec3::new(0.3, 0.0, 0.0), DVec3::new(0.6, 1.0, 0.0)],
        [DVec3::new(0.0, 0.2, 0.0), DVec3::new(1.0, 0.9, 0.0)],
    ];
    let pieces = cut(&square, DVec3::Z, &segments, 1e-9);
    assert_eq!(pieces.len(), 4);
    let sum: f64 = pieces.iter().map(|piece| area_of(piece, DVec3::Z)).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    let all: Vec<&Piece> = pieces.iter().collect();
    let shape = outline(&all, DVec3::Z, 1.0).expect("a square");
    assert!(shape.corners().len() == 4 && (shape.normal_and_area().1 - 1.0).abs() < 1e-12);
    assert_eq!(
        outline(
            &all[..3],
            DVec3::Z,
            area_of(&pieces[0], DVec3::Z) + area_of(&pieces[1], DVec3::Z) + area_of(&pieces[2], DVec3::Z)
        ),
        None
    );
}
