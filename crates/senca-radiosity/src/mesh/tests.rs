use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec3};
use senca_scene::{Material, Scene, Shape, Transform};

use super::*;

const WHITE: LinearRgb = LinearRgb::WHITE;

fn one_sided(shape: Shape) -> Scene {
    let mut scene = Scene::of_shape("shape", shape);
    let material = scene.add_material(Material::default());
    scene.geometries[0].material = Some(material);
    scene
}

fn cube() -> Scene {
    one_sided(Shape::Box { size: DVec3::ONE })
}

fn of(scene: &Scene, settings: &MeshSettings) -> ElementMesh {
    ElementMesh::of_scene(scene, settings).expect("a mesh")
}

fn square(x: f64) -> [DVec3; 4] {
    [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0))
}

#[test]
fn a_cube_has_six_polygons_and_three_vertices_at_each_corner() {
    let mesh = of(&cube(), &MeshSettings::default());
    assert_eq!((mesh.polygons().len(), mesh.positions().len()), (6, 24));
    assert!((mesh.area() - 6.0).abs() < 1e-12);
    for element in 0..6 {
        let outwards = mesh.normal(element).dot(mesh.elements()[element as usize].center);
        assert!(outwards > 0.4, "element {element} faces outwards");
    }
}

#[test]
fn mirrored_placements_and_backs_face_the_right_way() {
    let mut scene = cube();
    scene.nodes[0].transform = Transform::Matrix(DMat4::from_scale(DVec3::new(-2.0, 1.0, 1.0)));
    let mesh = of(&scene, &MeshSettings { sides: Sides::Both, ..MeshSettings::default() });
    assert_eq!(mesh.polygons().len(), 12);
    for (number, element) in (0..).zip(mesh.elements()) {
        let outwards = mesh.normal(number).dot(element.center) > 0.0;
        assert_eq!(outwards, !mesh.surface(number).back, "element {number}");
        let vertex = element.vertices[0] as usize;
        assert!(mesh.vertex_normals()[vertex].dot(mesh.normal(number)) > 0.99);
    }
}

#[test]
fn division_to_a_size_keeps_the_area() {
    for size in [0.6, 0.3, 0.07] {
        let mesh = of(&cube(), &MeshSettings { patch_size: Some(size), ..MeshSettings::default() });
        let leaves: Vec<u32> = mesh.leaves().collect();
        let area: f64 = leaves.iter().map(|&leaf| mesh.elements()[leaf as usize].area).sum();
        assert!((area - 6.0).abs() < 1e-9);
        assert!(leaves.iter().all(|&leaf| mesh.longest_edge(leaf) <= size));
    }
}

#[test]
fn a_ball_is_smooth_and_its_parts_share_vertices() {
    let scene = one_sided(Shape::Sphere { radius: 1.0 });
    let mut mesh = of(&scene, &MeshSettings { tolerance: Some(0.05), ..MeshSettings::default() });
    let before = mesh.positions().len();
    let edges = mesh.elements().iter().map(|element| element.corners().len()).sum::<usize>() / 2;
    // Euler: vertices + faces = edges + 2 where all vertices are shared.
    assert_eq!(before + mesh.polygons().len(), edges + 2);
    let area = mesh.area();
    for element in 0..mesh.polygons().len() as u32 {
        assert!(mesh.divide(element));
    }
    let leaves = mesh.leaves().map(|leaf| mesh.elements()[leaf as usize].area).sum::<f64>();
    assert!((leaves - area).abs() < 1e-9 * area);
}

#[test]
fn neighbours_know_the_vertices_on_their_common_edge() {
    let [left, right] = [square(0.0), square(1.0)];
    let mut mesh = ElementMesh::of_polygons(&[(&left, WHITE, WHITE), (&right, WHITE, WHITE)]);
    assert!(mesh.divide(0) && !mesh.divide(0));
    let part = mesh.elements()[0].part_numbers().nth(1).expect("a part");
    assert!(mesh.divide(part));
    let [_, b, c, _] = mesh.elements()[0].vertices;
    let mut on_edge = Vec::new();
    mesh.vertices_on_edge(b, c, &mut on_edge);
    let heights: Vec<f64> = on_edge.iter().map(|&v| mesh.positions()[v as usize].y).collect();
    assert_eq!(heights, [0.0, 0.25, 0.5, 1.0]);
}

#[test]
fn long_shapes_are_halved_until_they_are_not_long() {
    let long = [[0.0, 0.0], [8.0, 0.0], [8.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let mut mesh = ElementMesh::of_polygons(&[(&long, WHITE, WHITE)]);
    mesh.divide_to_size(1.0, 1000).expect("enough");
    assert_eq!(mesh.leaves().count(), 8);
    assert_eq!(mesh.divide_to_size(0.01, 1000), Err(crate::RadiosityError::TooManyElements { limit: 1000 }));
}

#[test]
fn settings_out_of_range_are_refused() {
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = MeshSettings { patch_size: Some(size), ..MeshSettings::default() };
        assert!(ElementMesh::of_scene(&cube(), &settings).is_err(), "{size}");
    }
}
