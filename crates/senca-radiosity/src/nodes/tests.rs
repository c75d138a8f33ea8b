use proptest::prelude::*;
use senca_math::glam::{DMat4, DQuat};
use senca_scene::{Scene, Shape};

use super::*;
use crate::MeshSettings;

fn square(size: f64) -> [DVec3; 4] {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(size * x, size * y, 0.0))
}

/// A square of side 4, divided in quarters so often.
fn grid(divisions: u32) -> ElementMesh {
    let mut mesh = ElementMesh::of_polygons(&[(&square(4.0), LinearRgb::WHITE, LinearRgb::BLACK)]);
    for _ in 0..divisions {
        for leaf in mesh.leaves().collect::<Vec<_>>() {
            mesh.divide(leaf);
        }
    }
    mesh
}

fn vertex_at(mesh: &ElementMesh, x: f64, y: f64) -> usize {
    let found = mesh.positions().iter().position(|p| p.distance(DVec3::new(x, y, 0.0)) < 1e-12);
    found.expect("a vertex")
}

fn values_by_center(mesh: &ElementMesh, value: impl Fn(DVec3) -> f64) -> Vec<LinearRgb> {
    mesh.elements().iter().map(|element| LinearRgb::splat(value(element.center) as f32)).collect()
}

/// Values of four patches: left below, right below, left above, right above.
fn transfer_of_four(patches: [f32; 4], extrapolation: Extrapolation) -> (ElementMesh, Vec<LinearRgb>) {
    let mesh = grid(1);
    let [a, b, c, d] = patches;
    let values = values_by_center(&mesh, |p| {
        f64::from(match (p.x < 2.0, p.y < 2.0) {
            (true, true) => a,
            (false, true) => b,
            (true, false) => c,
            (false, false) => d,
        })
    });
    let nodes = NodeTransfer::new(&mesh).apply(&values, extrapolation);
    (mesh, nodes)
}

#[test]
fn nodes_of_four_patches() {
    let (mesh, nodes) = transfer_of_four([1.0, 2.0, 3.0, 6.0], Extrapolation::Linear);
    let at = |x, y| nodes[vertex_at(&mesh, x, y)].r;
    assert_eq!(at(2.0, 2.0), 3.0);
    assert_eq!(at(4.0, 2.0), 5.0, "between b and d");
    assert_eq!(at(4.0, 0.0), 1.0, "the corner of b");
    assert_eq!(at(4.0, 4.0), 9.0, "the corner of d");
}

#[test]
fn the_mean_is_the_other_way() {
    let (mesh, nodes) = transfer_of_four([1.0, 2.0, 3.0, 6.0], Extrapolation::Mean);
    let at = |x, y| nodes[vertex_at(&mesh, x, y)].r;
    assert_eq!((at(2.0, 2.0), at(4.0, 2.0), at(4.0, 0.0)), (3.0, 4.0, 2.0));
}

#[test]
fn extrapolation_may_end_below_zero_and_is_held() {
    for (extrapolation, expected) in [(Extrapolation::Linear, -1.25), (Extrapolation::Clamped, 0.0)] {
        let (mesh, nodes) = transfer_of_four([4.0, 1.0, 4.0, 4.0], extrapolation);
        assert_eq!(nodes[vertex_at(&mesh, 4.0, 0.0)].g, expected);
    }
}

#[test]
fn six_patches_around_a_node_give_their_mean() {
    // A fan of six triangles as one smooth face.
    let corner = |i: u32| DVec3::new((f64::from(i) * 1.1).cos(), (f64::from(i) * 1.1).sin(), 0.0);
    let mut mesh = senca_scene::Mesh {
        points: (0..6).map(|i| corner(i).as_vec3()).chain([senca_math::glam::Vec3::ZERO]).collect(),
        surfaces: vec![senca_scene::Surface::default()],
        ..Default::default()
    };
    mesh.vertices.point = (0..7).collect();
    for i in 0..6 {
        mesh.faces.push(&[6, i, (i + 1) % 6], 0);
    }
    let mut scene = Scene::of_shape("fan", Shape::Mesh(mesh));
    let material = scene.add_material(senca_scene::Material::default());
    scene.geometries[0].material = Some(material);
    let mesh = ElementMesh::of_scene(&scene, &MeshSettings::default()).expect("a mesh");
    let values: Vec<LinearRgb> = (1..=6).map(|i| LinearRgb::splat(i as f32)).collect();
    let transfer = NodeTransfer::new(&mesh);
    let nodes = transfer.apply(&values, Extrapolation::Clamped);
    let hub = vertex_at(&mesh, 0.0, 0.0);
    assert_eq!(transfer.adjoining(hub as u32).len(), 6);
    assert_eq!((nodes[hub].r, transfer.is_on_border(hub as u32)), (3.5, false));
}

#[test]
fn a_real_edge_has_a_value_for_each_face() {
    let mut scene = Scene::of_shape("cube", Shape::Box { size: DVec3::ONE });
    let material = scene.add_material(senca_scene::Material::default());
    scene.geometries[0].material = Some(material);
    let settings = MeshSettings { patch_size: Some(0.6), ..MeshSettings::default() };
    let mesh = ElementMesh::of_scene(&scene, &settings).expect("a mesh");
    let values: Vec<LinearRgb> = (0..mesh.elements().len() as u32)
        .map(|e| LinearRgb::splat(1.0 + mesh.elements()[e as usize].polygon as f32))
        .collect();
    let nodes = NodeTransfer::new(&mesh).apply(&values, Extrapolation::Clamped);
    let corner = DVec3::splat(0.5);
    let mut there: Vec<f32> = mesh
        .positions()
        .iter()
        .zip(&nodes)
        .filter(|(p, _)| p.distance(corner) < 1e-12)
        .map(|(_, value)| value.r)
        .collect();
    there.sort_by(f32::total_cmp);
    assert_eq!(there.len(), 3);
    assert!(there.windows(2).all(|pair| pair[0] < pair[1]), "{there:?}");
}

#[test]
fn a_vertex_on_the_side_of_a_coarse_neighbour_counts_it() {
    let mut mesh = grid(1);
    let part = mesh.elements()[0].part_numbers().start;
    mesh.divide(part);
    let transfer = NodeTransfer::new(&mesh);
    // On the side between the divided part and its right neighbour.
    let hanging = vertex_at(&mesh, 2.0, 1.0) as u32;
    assert_eq!(transfer.adjoining(hanging).len(), 3);
    assert!(!transfer.is_on_border(hanging));
    let lower = vertex_at(&mesh, 1.0, 0.0) as u32;
    assert!(transfer.is_on_border(lower));
    assert_eq!(transfer.adjoining(lower).len(), 2);
}

#[test]
fn radiosity_at_corners_goes_by_the_element() {
    let mesh = grid(0);
    let incident = vec![LinearRgb::splat(0.25); 4];
    let nodes = NodeValues { direct: incident.clone(), incident };
    assert_eq!(nodes.radiosity(&mesh, 0, 2), LinearRgb::splat(0.25));
}

proptest! {
    /// On even grids of rectangles a linear function is met at every node but where it is held.
    #[test]
    fn linear_light_stays_linear(sx in -1.0f64..1.0, sy in -1.0f64..1.0, turn in 0.0f64..6.0) {
        let turned = DMat4::from_quat(DQuat::from_rotation_x(turn));
        let corners = square(4.0).map(|p| turned.transform_point3(p));
        let mut mesh = ElementMesh::of_polygons(&[(&corners, LinearRgb::WHITE, LinearRgb::BLACK)]);
        for _ in 0..3 {
            for leaf in mesh.leaves().collect::<Vec<_>>() {
                mesh.divide(leaf);
            }
        }
        let back = turned.inverse();
        let value = |p: DVec3| {
            let p = back.transform_point3(p);
            10.0 + sx * p.x + sy * p.y
        };
        let values = values_by_center(&mesh, value);
        let nodes = NodeTransfer::new(&mesh).apply(&values, Extrapolation::Clamped);
        for (place, found) in mesh.positions().iter().zip(&nodes) {
            prop_assert!((f64::from(found.r) - value(*place)).abs() < 1e-4);
        }
    }
}
