//! The Cornell box (Goral et al. 1984) in the proportions and colours that Mitsuba 3 gives it, for
//! tests and measurements.

use senca_math::glam::{DMat4, DQuat, DVec3};
use senca_math::{LinearRgb, View};
use senca_scene::{
    Background, Geometry, Material, MaterialId, MetallicRoughness, Node, Phong, Reflection, Scene, Shape,
    Transform,
};

/// The camera of all boxes, for square pictures.
pub(crate) fn view() -> View {
    let world_from_camera = DMat4::from_translation(DVec3::Z * 3.9);
    let yfov = 39.3077f64.to_radians();
    View::perspective(&world_from_camera, yfov, 1.0, 0.1, Some(100.0)).expect("a view")
}

/// Walls and lamp.
fn room() -> Scene {
    let mut scene = Scene { background: Background::Color(LinearRgb::BLACK), ..Scene::default() };
    let white = [0.885_809, 0.698_859, 0.666_422];
    let white_wall = matt(&mut scene, white, [0.0; 3]);
    let red = matt(&mut scene, [0.570_068, 0.043_013_5, 0.044_370_6], [0.0; 3]);
    let green = matt(&mut scene, [0.105_421, 0.377_98, 0.076_425], [0.0; 3]);
    let lamp = matt(&mut scene, white, [18.387, 13.9873, 6.75357]);
    let quad = |scene: &mut Scene, corners: [[f64; 3]; 4], material| {
        let outline = corners.map(DVec3::from_array).to_vec();
        place(scene, Shape::Polygon { outline, holes: Vec::new() }, DMat4::IDENTITY, material);
    };
    quad(&mut scene, [[-1., -1., 1.], [1., -1., 1.], [1., -1., -1.], [-1., -1., -1.]], white_wall);
    quad(&mut scene, [[-1., 1., -1.], [1., 1., -1.], [1., 1., 1.], [-1., 1., 1.]], white_wall);
    quad(&mut scene, [[-1., -1., -1.], [1., -1., -1.], [1., 1., -1.], [-1., 1., -1.]], white_wall);
    quad(&mut scene, [[-1., -1., 1.], [-1., -1., -1.], [-1., 1., -1.], [-1., 1., 1.]], red);
    quad(&mut scene, [[1., -1., -1.], [1., -1., 1.], [1., 1., 1.], [1., 1., -1.]], green);
    let (x, y) = (0.23, 0.99);
    quad(&mut scene, [[-x, y, -0.18], [x, y, -0.18], [x, y, 0.2], [-x, y, 0.2]], lamp);
    scene
}

/// The box with two matt blocks.
pub(crate) fn with_blocks() -> Scene {
    let mut scene = room();
    let white = MaterialId(0);
    for (half, degrees, at) in
        [([0.3, 0.3, 0.3], -17.0f64, [0.335, -0.7, 0.38]), ([0.3, 0.61, 0.3], 18.25, [-0.33, -0.4, -0.28])]
    {
        let turn = DQuat::from_rotation_y(degrees.to_radians());
        let world_from_object = DMat4::from_rotation_translation(turn, DVec3::from_array(at));
        let shape = Shape::Box { size: 2.0 * DVec3::from_array(half) };
        place(&mut scene, shape, world_from_object, white);
    }
    scene
}

/// The box with a mirror ball and a glass ball.
pub(crate) fn with_balls() -> Scene {
    let mut scene = room();
    let black = Reflection::Phong(Phong { diffuse: LinearRgb::BLACK, ..Phong::default() });
    let mirror = Material { reflection: black, mirror: LinearRgb::WHITE, ..Material::default() };
    let polished = MetallicRoughness { metallic: 0.0, roughness: 0.0, ..MetallicRoughness::default() };
    let glass = Material {
        reflection: Reflection::MetallicRoughness(polished),
        transmission: LinearRgb::WHITE,
        ..Material::default()
    };
    let (mirror, glass) = (scene.add_material(mirror), scene.add_material(glass));
    for (radius, at, material) in [(0.4, [-0.4, -0.6, -0.35], mirror), (0.35, [0.42, -0.65, 0.35], glass)] {
        let world_from_object = DMat4::from_translation(DVec3::from_array(at));
        place(&mut scene, Shape::Sphere { radius }, world_from_object, material);
    }
    scene
}

fn matt(scene: &mut Scene, color: [f32; 3], emission: [f32; 3]) -> MaterialId {
    let color = LinearRgb::from_array(color);
    let reflection = Reflection::Phong(Phong { ambient: color, diffuse: color, ..Phong::default() });
    scene.add_material(Material {
        reflection,
        emission: LinearRgb::from_array(emission),
        ..Material::default()
    })
}

fn place(scene: &mut Scene, shape: Shape, world_from_object: DMat4, material: MaterialId) {
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: Some(material) });
    let transform = Transform::Matrix(world_from_object);
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}
