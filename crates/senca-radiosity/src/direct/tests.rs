use senca_math::glam::DMat4;
use senca_scene::{Background, ImageData, ImageId, Light, Node, SpotFalloff, TextureImage, Transform};
use std::f64::consts::{FRAC_PI_2, PI};

use super::*;

const GREY: LinearRgb = LinearRgb::splat(0.5);

fn rectangle(x: [f64; 2], y: f64, z: [f64; 2]) -> [DVec3; 4] {
    // Faces up.
    [[x[0], z[1]], [x[1], z[1]], [x[1], z[0]], [x[0], z[0]]].map(|[x, z]| DVec3::new(x, y, z))
}

fn mesh(quads: &[[DVec3; 4]]) -> ElementMesh {
    let polygons: Vec<_> = quads.iter().map(|q| (&q[..], GREY, LinearRgb::BLACK)).collect();
    ElementMesh::of_polygons(&polygons)
}

/// A scene of one lamp of intensity 1 at height 2 that shines down.
fn lit_by(kind: LightKind, attenuation: Attenuation) -> Scene {
    let mut scene = Scene::default();
    scene.lights.push(Light { name: String::new(), color: LinearRgb::WHITE, attenuation, kind });
    let down = DMat4::from_translation(DVec3::Y * 2.0) * DMat4::from_rotation_x(-FRAC_PI_2);
    let light = Some(senca_scene::LightId(0));
    let node = Node { light, transform: Transform::Matrix(down), ..Node::default() };
    let id = scene.add_node(node);
    scene.roots.push(id);
    scene
}

fn light_of(scene: &Scene) -> DirectLight {
    DirectLight::of_scene(scene, &DirectSettings::default()).expect("in range")
}

fn on_first(scene: &Scene, quads: &[[DVec3; 4]], settings: DirectSettings) -> DirectSample {
    let mesh = mesh(quads);
    let occluders = Occluders::new(&mesh).expect("few");
    let light = DirectLight::of_scene(scene, &settings).expect("in range");
    light.on_element(&occluders, &mesh, 0)
}

#[test]
fn every_kind_of_lamp_of_intensity_1_makes_white_show_1() {
    let quads = [rectangle([-0.001, 0.001], 0.0, [-0.001, 0.001])];
    let spots = [SpotFalloff::Sharp { angle: 0.5 }, SpotFalloff::Cosine { exponent: 5.0 }];
    let prism = LightKind::BoxSpot { min: [-1.0; 2], max: [1.0; 2], depth: 3.0 };
    let small = LightKind::Area { size: [1e-3, 1e-3], visible: true };
    let kinds = [LightKind::Point, LightKind::Parallel, prism, small].into_iter();
    for kind in kinds.chain(spots.map(LightKind::Spot)) {
        let scene = lit_by(kind, Attenuation::None);
        let found = on_first(&scene, &quads, DirectSettings::default()).mean.g;
        assert!((found - 1.0).abs() < 1e-4, "{kind:?}: {found}");
        let fading = lit_by(kind, Attenuation::Polynomial { constant: 0.0, linear: 1.0, quadratic: 0.0 });
        let found = on_first(&fading, &quads, DirectSettings::default()).mean.g;
        assert!((found - 0.5).abs() < 1e-4, "{kind:?}: {found}");
    }
    let ambient = lit_by(LightKind::Ambient, Attenuation::None);
    assert!(light_of(&ambient).is_empty());
}

#[test]
fn an_element_shows_the_mean_over_its_area() {
    // A point light of power 4 pi per unit: the light on a large square below is its solid angle.
    let scene = lit_by(LightKind::Point, Attenuation::InverseSquare { range: None });
    let (a, h) = (3.0f64, 2.0f64);
    let solid_angle = 4.0 * (a * a / (h * (2.0 * a * a + h * h).sqrt())).atan();
    let settings = DirectSettings { depth: 6, tolerance: 0.02, ..DirectSettings::default() };
    let found = on_first(&scene, &[rectangle([-a, a], 0.0, [-a, a])], settings).mean.r;
    let expected = (solid_angle / (4.0 * a * a)) as f32;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found}, not {expected}");
}

#[test]
fn half_an_element_in_shadow_is_half_as_bright() {
    let scene = lit_by(LightKind::Parallel, Attenuation::None);
    let floor = rectangle([-1.0, 1.0], 0.0, [-1.0, 1.0]);
    for (edge, expected) in [(0.0, 0.5), (0.25, 0.375), (0.6, 0.2), (-1.5, 1.0), (1.5, 0.0)] {
        let blocker = rectangle([-3.0, edge], 1.0, [-2.0, 2.0]);
        let found = on_first(&scene, &[floor, blocker], DirectSettings::default());
        assert!((found.mean.r - expected).abs() < 0.07, "{edge}: {} not {expected}", found.mean.r);
        let mixed = expected > 0.0 && expected < 1.0;
        assert_eq!(found.spread() > 0.5, mixed, "{edge}");
    }
}

#[test]
fn an_area_light_is_the_form_factor_it_has() {
    // Unit square 1 below a unit square, middle: 0.2394564705 of what the lamp gives off, which is
    // pi color / area over pi.
    let mut scene = lit_by(
        LightKind::Area { size: [1.0, 1.0], visible: true },
        Attenuation::InverseSquare { range: None },
    );
    let lamp = DMat4::from_translation(DVec3::Y) * DMat4::from_rotation_x(-FRAC_PI_2);
    scene.nodes[0].transform = Transform::Matrix(lamp);
    let quads = [rectangle([-0.5, 0.5], 0.0, [-0.5, 0.5])];
    let settings = DirectSettings::default();
    let mesh = mesh(&quads);
    let occluders = Occluders::new(&mesh).expect("few");
    let light = DirectLight::of_scene(&scene, &settings).expect("in range");
    let found = f64::from(light.at(&occluders, DVec3::ZERO, DVec3::Y).r);
    assert!((found - PI * 0.239_456_470_5).abs() < 1e-6, "{found}");
}

#[test]
fn plain_area_lights_can_be_emitters_instead() {
    let plain = lit_by(
        LightKind::Area { size: [2.0, 0.5], visible: true },
        Attenuation::InverseSquare { range: None },
    );
    let mut light = light_of(&plain);
    let areas = light.take_plain_areas();
    assert!(light.is_empty());
    let (shape, shows) = &areas[0];
    let (normal, area) = shape.normal_and_area();
    assert!(normal.distance(DVec3::NEG_Y) < 1e-12 && (area - 1.0).abs() < 1e-12);
    assert!((shows.r - std::f32::consts::PI).abs() < 1e-6);
    let even = lit_by(LightKind::Area { size: [2.0, 0.5], visible: true }, Attenuation::None);
    let mut light = light_of(&even);
    assert!(light.take_plain_areas().is_empty() && !light.is_empty());
}

#[test]
fn an_open_sky_shows_itself_and_a_wall_takes_half() {
    let white = LinearRgb::new(1.0, 0.5, 2.0);
    let scene = Scene { background: Background::Color(white), ..Scene::default() };
    let floor = rectangle([-1.0, 1.0], 0.0, [-1.0, 1.0]);
    let open = on_first(&scene, &[floor], DirectSettings::default()).mean;
    assert!((open - white).max_component().abs() < 1e-5);
    // A high and wide wall beside a narrow strip.
    let strip = rectangle([0.0, 0.01], 0.0, [-0.01, 0.01]);
    let h = 1e3;
    let wall = [[-h, 0.0], [h, 0.0], [h, h], [-h, h]].map(|[z, y]| DVec3::new(-0.005, y, z));
    let settings = DirectSettings { sky_directions: 1024, ..DirectSettings::default() };
    let half = on_first(&scene, &[strip, wall], settings).mean;
    assert!((half.r - 0.5).abs() < 0.01 && (half.b - 1.0).abs() < 0.02, "{half:?}");
}

#[test]
fn regions_of_surroundings_keep_their_light() {
    let mut texels = vec![[0.1, 0.2, 0.3, 1.0]; 32 * 16];
    texels[5 * 32 + 9] = [500.0, 400.0, 300.0, 1.0];
    let data = ImageData::RgbaF32 { width: 32, height: 16, texels };
    let background = Background::Environment { image: ImageId(0), strength: 2.0, rotation: 0.7 };
    let images = vec![TextureImage { name: String::new(), data }];
    let scene = Scene { images, background, ..Scene::default() };
    let environment = senca_scene::Environment::of(&scene).expect("an environment");
    let Some(Sky::Regions(regions)) = Sky::new(&scene, 100) else { panic!("regions") };
    assert_eq!(regions.len(), 100);
    let sum = regions.iter().fold(LinearRgb::BLACK, |sum, (_, light)| sum + *light);
    // Light of all regions is the mean over the sphere times 4 pi / pi.
    let expected = environment.mean() * 4.0;
    assert!((sum.r / expected.r - 1.0).abs() < 1e-4 && (sum.b / expected.b - 1.0).abs() < 1e-4);
    let brightest = regions.iter().max_by(|a, b| a.1.r.total_cmp(&b.1.r)).expect("some");
    let sun = environment.direction([9.5 / 32.0, 5.5 / 16.0]).as_dvec3();
    assert!(brightest.0.dot(sun) > 0.999);
}

#[test]
fn settings_out_of_range_are_refused() {
    let d = DirectSettings::default();
    for settings in [
        DirectSettings { tolerance: 0.0, ..d },
        DirectSettings { tolerance: f32::NAN, ..d },
        DirectSettings { depth: 7, ..d },
        DirectSettings { sky_directions: 0, ..d },
        DirectSettings { area_cells: 65, ..d },
    ] {
        assert!(DirectLight::of_scene(&Scene::default(), &settings).is_err(), "{settings:?}");
    }
}

#[test]
fn cancelling_ends_the_work() {
    let flag = std::sync::atomic::AtomicBool::new(true);
    let control = Control { cancel: Some(&flag), ..Control::default() };
    let mesh = mesh(&[rectangle([0.0, 1.0], 0.0, [0.0, 1.0])]);
    let occluders = Occluders::new(&mesh).expect("few");
    let light = light_of(&lit_by(LightKind::Point, Attenuation::None));
    assert_eq!(light.on_elements(&occluders, &mesh, &[0], &control), Err(RadiosityError::Cancelled));
    let done = light.on_elements(&occluders, &mesh, &[0], &Control::default()).expect("done");
    assert_eq!(done.len(), 1);
}
