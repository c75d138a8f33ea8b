use senca_math::glam::Vec3;

use super::*;
use crate::test_support::{house, octagonal_cylinder};
use crate::{Shape, Surface, TessellationSettings, Vertices, tessellate};

fn sphere() -> Mesh {
    tessellate(&Shape::Sphere { radius: 1.0 }, &TessellationSettings::default()).unwrap().into_owned()
}

#[test]
fn the_cylinder_is_a_closed_oriented_body() {
    let mesh = octagonal_cylinder();
    let topology = Topology::new(&mesh);
    assert!(topology.is_closed() && topology.is_oriented() && topology.is_manifold());
    assert_eq!((topology.euler_characteristic(&mesh), topology.parts(&mesh)), (2, 1));
    assert_eq!(topology.edge_counts(), EdgeCounts { edges: 24, border: 0, disagreeing: 0, crowded: 0 });
    assert_eq!(topology.faces_at(0).collect::<Vec<_>>(), [0, 7, 8]);
    assert_eq!(topology.corners_at(0).len(), 3);
}

#[test]
fn opposite_corners_begin_the_same_edge() {
    let mesh = sphere();
    let topology = Topology::new(&mesh);
    let point = |corner: u32| mesh.vertices.point[mesh.faces.corners[corner as usize] as usize];
    let next = |corner: u32| if corner % 3 == 2 { corner - 2 } else { corner + 1 };
    for corner in 0..mesh.faces.corners.len() as u32 {
        let opposite = topology.opposite(corner).unwrap();
        assert_eq!((point(corner), point(next(corner))), (point(next(opposite)), point(opposite)));
        assert_eq!(topology.opposite(opposite), Some(corner));
        assert_ne!(topology.face_of(corner), topology.face_of(opposite));
    }
}

#[test]
fn holes_and_turned_faces_are_seen() {
    let mut mesh = sphere();
    mesh.faces.corners.truncate(mesh.faces.corners.len() - 3);
    let topology = Topology::new(&mesh);
    assert!(!topology.is_closed() && topology.is_oriented());
    assert_eq!(topology.edge_counts().border, 3);
    let mut mesh = sphere();
    mesh.faces.corners.swap(0, 1);
    let topology = Topology::new(&mesh);
    assert!(topology.is_closed() && !topology.is_oriented());
    assert_eq!(topology.edge_counts().disagreeing, 3);
}

#[test]
fn three_faces_at_an_edge_are_no_surface() {
    let points = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y];
    let mut mesh = Mesh {
        points,
        vertices: Vertices { point: (0..5).collect(), ..Vertices::default() },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    };
    [[0, 1, 2], [0, 1, 3], [0, 1, 4]].iter().for_each(|face| mesh.faces.push(face, 0));
    let topology = Topology::new(&mesh);
    assert!(!topology.is_manifold() && !topology.is_closed());
    assert_eq!((topology.edge_counts().crowded, topology.opposite(0)), (1, None));
}

#[test]
fn the_house_is_two_bodies_that_touch() {
    let mesh = house();
    let topology = Topology::new(&mesh);
    assert_eq!(topology.parts(&mesh), 1, "they share point 0");
    assert!(topology.is_closed());
}

#[test]
fn collapsed_faces_do_not_open_a_mesh() {
    let teapot = crate::test_support::teapot();
    let settings = crate::PatchConversion { steps: [6, 6], ..Default::default() };
    let lid_and_more: Vec<_> = teapot.into_iter().filter(|p| p.surface == 3).collect();
    let mesh = crate::patch_to_polygons(&lid_and_more, &settings).unwrap();
    let topology = Topology::new(&mesh);
    assert!(topology.is_manifold() && topology.is_oriented());
    assert_eq!(topology.euler_characteristic(&mesh), 1, "the lid is a cap");
    assert_eq!(topology.edge_counts().border, 24);
}

#[test]
fn an_empty_mesh_is_nothing() {
    let mesh = Mesh::default();
    let topology = Topology::new(&mesh);
    assert!(!topology.is_closed() && topology.is_manifold());
    assert_eq!((topology.euler_characteristic(&mesh), topology.parts(&mesh)), (0, 0));
}
