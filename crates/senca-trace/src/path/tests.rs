//! Whole pictures with known answers.

use senca_math::glam::{DMat4, DVec3};
use senca_math::{LinearRgb, View};
use senca_scene::{
    AlphaMode, Attenuation, Background, Environment, Geometry, ImageData, ImageId, Light, LightKind,
    Material, MaterialId, Node, Phong, Reflection, Scene, Shape, SpotFalloff, TextureImage, Transform,
};

use super::{PathSettings, PathTracer, PathWork, cornell};
use crate::recursive::{Tracer, Work};
use crate::{Pattern, RecursiveSettings, SamplePlace, Sampler, World};

/// Mean and its standard error, per channel.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: [f64; 3],
    error: [f64; 3],
    alpha: f64,
}

/// What a tracer sees in a rectangle of a picture of `size` x `size` pixels: columns and rows from and
/// up to.
fn look(tracer: &PathTracer<'_>, columns: [u32; 2], rows: [u32; 2], samples: u32) -> Estimate {
    let (mut sum, mut squares, mut alpha, mut n) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
    let mut work = PathWork::default();
    for (x, y) in (rows[0]..rows[1]).flat_map(|y| (columns[0]..columns[1]).map(move |x| (x, y))) {
        for sample in 0..samples {
            let mut sampler = Sampler::new(Pattern::Sobol, 1, x, y, sample);
            let [u, v] = sampler.next_2d();
            let place = SamplePlace { x: f64::from(x) + u, y: f64::from(y) + v, row: y, sampler };
            let color = tracer.sample(&place, &mut work).map(f64::from);
            assert!(color.iter().all(|c| *c >= 0.0));
            for k in 0..3 {
                sum[k] += color[k];
                squares[k] += color[k] * color[k];
            }
            alpha += color[3];
            n += 1.0;
        }
    }
    assert_eq!(work.dropped, 0);
    let mean = sum.map(|s| s / n);
    let error = std::array::from_fn(|k| ((squares[k] / n - mean[k] * mean[k]).max(0.0) / n).sqrt());
    Estimate { mean, error, alpha: alpha / n }
}

fn one_bounce() -> PathSettings {
    PathSettings { max_bounces: 1, ..PathSettings::default() }
}

/// A view from `eye` to the origin, narrow enough for a single place.
fn narrow_view(eye: DVec3) -> View {
    let up = if eye.x == 0.0 && eye.z == 0.0 { DVec3::Z } else { DVec3::Y };
    let world_from_camera = View::look_at(eye, DVec3::ZERO, up).expect("a frame");
    View::perspective(&world_from_camera, 1e-4, 1.0, 0.1, Some(100.0)).expect("a view")
}

/// What is seen of the origin from `eye`.
fn look_at_origin(scene: &Scene, eye: DVec3, settings: &PathSettings, samples: u32) -> Estimate {
    let world = World::new(scene).expect("a world");
    let tracer = PathTracer::new(&world, &narrow_view(eye), [1; 2], scene.background, settings);
    look(&tracer, [0, 1], [0, 1], samples)
}

fn phong(diffuse: f32) -> Material {
    let diffuse = LinearRgb::splat(diffuse);
    Material {
        reflection: Reflection::Phong(Phong { ambient: diffuse, diffuse, ..Phong::default() }),
        double_sided: true,
        ..Material::default()
    }
}

fn add(scene: &mut Scene, shape: Shape, world_from_object: DMat4, material: Material) {
    let material: MaterialId = scene.add_material(material);
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: Some(material) });
    let transform = Transform::Matrix(world_from_object);
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

fn floor(diffuse: f32) -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, Shape::Plane { size: Some(40.0) }, DMat4::IDENTITY, phong(diffuse));
    scene
}

fn add_light(scene: &mut Scene, kind: LightKind, attenuation: Attenuation, world_from_light: DMat4) {
    let light = Light { name: String::new(), color: LinearRgb::WHITE, attenuation, kind };
    let light = scene.add_light(light);
    let transform = Transform::Matrix(world_from_light);
    let node = scene.add_node(Node { light: Some(light), transform, ..Node::default() });
    scene.roots.push(node);
}

fn down_from(place: DVec3) -> DMat4 {
    DMat4::from_translation(place) * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2)
}

/// Means of 4 x 4 equal parts of the picture, from Mitsuba 3.9.1 (`path`, depth 8, box filter) with
/// 4096 samples a pixel of 128 x 128; standard error at most 0.15 %, on average 0.05 %.
const BLOCKS: [[[f64; 3]; 4]; 4] = [
    [
        [0.11405, 0.01897, 0.00743],
        [1.01843, 0.70693, 0.33547],
        [0.98402, 0.70751, 0.33307],
        [0.04956, 0.04077, 0.00775],
    ],
    [
        [0.19316, 0.01934, 0.00857],
        [0.29373, 0.13167, 0.05616],
        [0.29165, 0.15943, 0.06414],
        [0.05396, 0.08220, 0.01128],
    ],
    [
        [0.11956, 0.01080, 0.00474],
        [0.11949, 0.04460, 0.01787],
        [0.18796, 0.10430, 0.04123],
        [0.04316, 0.06419, 0.00887],
    ],
    [
        [0.11611, 0.03308, 0.01455],
        [0.17453, 0.07498, 0.03275],
        [0.03092, 0.01212, 0.00468],
        [0.05249, 0.04726, 0.01118],
    ],
];

/// The same with a mirror ball and a glass ball, 8192 samples; standard error at most 0.42 %, on
/// average 0.13 %.
const BALLS: [[[f64; 3]; 4]; 4] = [
    [
        [0.09211, 0.01534, 0.00578],
        [0.97809, 0.69262, 0.32940],
        [0.96454, 0.69943, 0.33018],
        [0.04485, 0.03704, 0.00708],
    ],
    [
        [0.17750, 0.01871, 0.00824],
        [0.29769, 0.14221, 0.06142],
        [0.27151, 0.15095, 0.06165],
        [0.05145, 0.07886, 0.01093],
    ],
    [
        [0.15112, 0.01526, 0.00674],
        [0.27886, 0.15110, 0.06567],
        [0.24211, 0.13710, 0.05496],
        [0.05209, 0.06885, 0.01100],
    ],
    [
        [0.14127, 0.04162, 0.01821],
        [0.19901, 0.09726, 0.04122],
        [0.21532, 0.12388, 0.04993],
        [0.07478, 0.05726, 0.01534],
    ],
];

/// Looks at the 16 parts of a box's picture, 8 x 8 pixels each.
fn compare(scene: &Scene, reference: &[[[f64; 3]; 4]; 4], reference_error: f64, samples: u32) {
    let world = World::new(scene).expect("a world");
    let settings = PathSettings { max_bounces: 7, ..PathSettings::default() };
    let tracer = PathTracer::new(&world, &cornell::view(), [32; 2], Background::None, &settings);
    let (mut squares, mut worst) = (0.0, 0.0f64);
    for (row, means) in (0u32..).zip(reference) {
        for (column, mean) in (0u32..).zip(means) {
            let part = |i: u32| [8 * i, 8 * i + 8];
            let found = look(&tracer, part(column), part(row), samples);
            for (k, mean) in mean.iter().enumerate() {
                let error = found.error[k].hypot(reference_error * mean);
                let z = (found.mean[k] - mean) / error;
                squares += z * z / 48.0;
                worst = worst.max(z.abs());
            }
        }
    }
    // Even samples err less than chance would, so these are generous.
    assert!(worst < 4.0, "{worst} standard errors");
    assert!(squares < 1.5, "{squares}");
}

#[test]
fn matt_blocks_are_those_of_mitsuba() {
    compare(&cornell::with_blocks(), &BLOCKS, 0.0015, 32);
}

#[test]
fn mirror_and_glass_balls_are_those_of_mitsuba() {
    // Few paths find the lamp through the glass, so errors guessed from few samples are too small.
    compare(&cornell::with_balls(), &BALLS, 0.06, 64);
}

#[test]
fn a_white_ball_in_a_white_furnace_cannot_be_seen() {
    let mut scene = Scene { background: Background::Color(LinearRgb::splat(0.5)), ..Scene::default() };
    add(&mut scene, Shape::Sphere { radius: 1.0 }, DMat4::IDENTITY, phong(1.0));
    let seen = look_at_origin(&scene, DVec3::new(1.0, 2.0, 3.0), &PathSettings::default(), 64);
    assert!((seen.mean[0] - 0.5).abs() < 1e-4 && seen.error[0] < 1e-5, "{seen:?}");
}

#[test]
fn a_closed_shining_room_adds_up_its_series() {
    // Everywhere L = E + rho L.
    let mut scene = Scene::default();
    let wall = Material { emission: LinearRgb::splat(0.5), ..phong(0.5) };
    add(&mut scene, Shape::Box { size: DVec3::splat(4.0) }, DMat4::IDENTITY, wall);
    let seen = look_at_origin(&scene, DVec3::new(0.3, 0.2, 1.0), &PathSettings::default(), 4096);
    assert!((seen.mean[0] - 1.0).abs() < 4.0 * seen.error[0] && seen.error[0] < 0.02, "{seen:?}");
}

#[test]
fn lamps_light_as_in_the_recursive_tracer() {
    let mut scene = floor(0.8);
    let far = Attenuation::InverseSquare { range: Some(20.0) };
    let linear = Attenuation::Polynomial { constant: 0.2, linear: 0.3, quadratic: 0.0 };
    add(
        &mut scene,
        Shape::Sphere { radius: 0.5 },
        DMat4::from_translation(DVec3::new(0.8, 0.6, 0.3)),
        phong(0.5),
    );
    add_light(&mut scene, LightKind::Point, far, DMat4::from_translation(DVec3::new(1.0, 3.0, 0.5)));
    add_light(&mut scene, LightKind::Parallel, Attenuation::None, down_from(DVec3::ZERO));
    let spot = LightKind::Spot(SpotFalloff::Smooth { inner: 0.2, outer: 0.6 });
    add_light(&mut scene, spot, linear, down_from(DVec3::new(-0.7, 2.0, 0.1)));
    let prism = LightKind::BoxSpot { min: [-1.0, -1.0], max: [0.5, 0.5], depth: 9.0 };
    add_light(&mut scene, prism, Attenuation::None, down_from(DVec3::new(0.3, 2.0, 0.0)));
    let world_from_camera = View::look_at(DVec3::new(1.0, 4.0, 5.0), DVec3::ZERO, DVec3::Y).expect("a frame");
    let view = View::perspective(&world_from_camera, 0.6, 1.0, 0.1, Some(100.0)).expect("a view");
    let world = World::new(&scene).expect("a world");
    let path = PathTracer::new(&world, &view, [9; 2], Background::None, &one_bounce());
    let tree = Tracer::new(&world, &view, [9; 2], Background::None, &RecursiveSettings::default());
    let (mut work, mut path_work) = (Work::default(), PathWork::default());
    for (x, y) in (0..81).map(|i| (i % 9, i / 9)) {
        let place = |sample| SamplePlace {
            x: f64::from(x) + 0.5,
            y: f64::from(y) + 0.5,
            row: y,
            sampler: Sampler::new(Pattern::Sobol, 0, x, y, sample),
        };
        let expected = tree.sample(&place(0), &mut work)[0];
        let n = 1024;
        let sum: f32 = (0..n).map(|i| path.sample(&place(i), &mut path_work)[0]).sum();
        let found = sum / n as f32;
        assert!((found - expected).abs() < 0.01 * (expected + 0.1), "{x}, {y}: {found}, not {expected}");
    }
}

#[test]
fn an_area_light_is_itself_however_it_is_found() {
    // Asked, met by chance, or both: one number.
    let mut scene = floor(1.0);
    let size = [1.5, 1.0];
    add_light(
        &mut scene,
        LightKind::Area { size, visible: true },
        Attenuation::InverseSquare { range: None },
        down_from(DVec3::Y),
    );
    let eye = DVec3::new(3.0, 2.0, 1.0);
    let lamp = look_at_origin(&scene, eye, &one_bounce(), 4096);
    // The same where it is not seen.
    for light in &mut scene.lights {
        light.kind = LightKind::Area { size, visible: false };
    }
    let hidden = look_at_origin(&scene, eye, &one_bounce(), 4096);
    // The same as a shining polygon.
    let mut scene = floor(1.0);
    let radiance = (std::f64::consts::PI / 1.5) as f32;
    let outline =
        [[-0.75, -0.5], [-0.75, 0.5], [0.75, 0.5], [0.75, -0.5]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let shape = Shape::Polygon { outline: outline.to_vec(), holes: Vec::new() };
    let emission = LinearRgb::splat(radiance);
    let shining = Material { emission, double_sided: false, ..phong(0.0) };
    add(&mut scene, shape, down_from(DVec3::Y), shining);
    let polygon = look_at_origin(&scene, eye, &one_bounce(), 4096);
    // Four times a corner (Siegel and Howell, configuration factor 4), over pi times the radiance.
    let (x, y) = (0.75f64, 0.5f64);
    let (sx, sy) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let factor = 4.0 / std::f64::consts::TAU * (x / sx * (y / sx).atan() + y / sy * (x / sy).atan());
    let expected = factor * f64::from(radiance);
    for found in [lamp, hidden, polygon] {
        assert!((found.mean[0] - expected).abs() < 4.0 * found.error[0] + 1e-3, "{found:?}, not {expected}");
        assert!(found.error[0] < 0.01 * expected);
    }
}

#[test]
fn balls_and_backgrounds_light_as_their_closed_forms_say() {
    let mut scene = floor(1.0);
    let shining = Material { emission: LinearRgb::splat(10.0), ..phong(0.0) };
    add(&mut scene, Shape::Sphere { radius: 0.5 }, DMat4::from_translation(DVec3::Y * 2.0), shining);
    let eye = DVec3::new(3.0, 2.0, 1.0);
    let seen = look_at_origin(&scene, eye, &one_bounce(), 1024);
    // Radiance times (r / d)^2.
    assert!((seen.mean[0] - 10.0 / 16.0).abs() < 4.0 * seen.error[0] + 1e-3, "{seen:?}");
    // A gradient that runs from 0 below to 1 above: the mean over the upper half, weighted by cosine.
    let mut scene = floor(1.0);
    scene.background = Background::Gradient { bottom: LinearRgb::BLACK, top: LinearRgb::WHITE };
    let seen = look_at_origin(&scene, eye, &one_bounce(), 1024);
    assert!((seen.mean[0] - 5.0 / 6.0).abs() < 4.0 * seen.error[0] + 1e-3, "{seen:?}");
}

#[test]
fn surroundings_light_by_their_mean_where_they_are_even_above() {
    // White above the horizon, and one very bright texel straight up.
    let (width, height) = (8, 8);
    let mut texels = vec![[1.0, 1.0, 1.0, 1.0]; 32];
    texels.extend([[0.0, 0.0, 0.0, 1.0]; 32]);
    texels[8 + 2] = [200.0, 200.0, 200.0, 1.0];
    let data = ImageData::RgbaF32 { width, height, texels };
    let mut scene = floor(1.0);
    scene.images.push(TextureImage { name: String::new(), data });
    scene.background = Background::Environment { image: ImageId(0), strength: 0.5, rotation: 0.3 };
    // By brute force: directions over the hemisphere.
    let sky = Environment::of_background(&scene, scene.background).expect("surroundings");
    let n = 1 << 16;
    let one = |i: u32| {
        let w = super::warp::cosine_hemisphere(Sampler::new(Pattern::Sobol, 4, 0, 0, i).next_2d());
        f64::from(sky.color(DVec3::new(w.x, w.z, w.y).as_vec3()).r)
    };
    let expected = (0..n).map(one).sum::<f64>() / f64::from(n);
    let seen = look_at_origin(&scene, DVec3::new(3.0, 2.0, 1.0), &one_bounce(), 1024);
    assert!((seen.mean[0] - expected).abs() < 4.0 * seen.error[0] + 5e-3 * expected, "{seen:?}, {expected}");
    assert!(seen.error[0] < 0.05 * expected, "{seen:?}");
}

#[test]
fn clear_bodies_swallow_light_by_the_way_through_them() {
    let mut scene = Scene { background: Background::Color(LinearRgb::WHITE), ..Scene::default() };
    let absorption = LinearRgb::new(0.5, 1.0, 0.0);
    let liquid = Material { transmission: LinearRgb::WHITE, ior: 1.0, absorption, ..phong(0.0) };
    add(&mut scene, Shape::Box { size: DVec3::splat(2.0) }, DMat4::IDENTITY, liquid);
    let seen = look_at_origin(&scene, DVec3::Y * 3.0, &PathSettings::default(), 4);
    let inside = look_at_origin(&scene, DVec3::Y * 0.5, &PathSettings::default(), 4);
    for (found, way) in [(seen, 2.0f64), (inside, 1.5)] {
        for (found, a) in found.mean.into_iter().zip([0.5, 1.0, 0.0]) {
            assert!((found - (-a * way).exp()).abs() < 1e-3, "{found} over {way}");
        }
    }
}

#[test]
fn surfaces_that_are_there_in_part_show_and_shade_in_part() {
    let blend = |alpha| {
        let mut pane = phong(0.0);
        pane.alpha_mode = AlphaMode::Blend;
        pane.reflection = Reflection::Phong(Phong { alpha, diffuse: LinearRgb::BLACK, ..Phong::default() });
        pane
    };
    // Two black panes of a quarter each, between eye and background.
    let mut scene = Scene { background: Background::Color(LinearRgb::WHITE), ..Scene::default() };
    for y in [0.1, 0.2] {
        let raised = DMat4::from_translation(DVec3::Y * y);
        add(&mut scene, Shape::Plane { size: Some(4.0) }, raised, blend(0.25));
    }
    let seen = look_at_origin(&scene, DVec3::Y * 3.0, &PathSettings::default(), 4096);
    assert!((seen.mean[0] - 0.5625).abs() < 0.01, "{seen:?}");
    // The same between a lamp and the floor.
    let mut scene = floor(1.0);
    for y in [2.0, 3.0] {
        let raised = DMat4::from_translation(DVec3::Y * y);
        add(&mut scene, Shape::Plane { size: Some(1.0) }, raised, blend(0.25));
    }
    add_light(&mut scene, LightKind::Parallel, Attenuation::None, down_from(DVec3::ZERO));
    let seen = look_at_origin(&scene, DVec3::new(3.0, 1.0, 0.0), &one_bounce(), 4096);
    assert!((seen.mean[0] - 0.5625).abs() < 4.0 * seen.error[0], "{seen:?}");
}

#[test]
fn nothing_is_seen_where_nothing_is() {
    let seen = look_at_origin(&Scene::default(), DVec3::Z, &PathSettings::default(), 4);
    assert_eq!((seen.mean, seen.alpha), ([0.0; 3], 0.0));
}

#[test]
fn a_room_of_mirrors_ends() {
    let mut scene = Scene::default();
    let mirror = Material { mirror: LinearRgb::WHITE, ..phong(0.0) };
    add(&mut scene, Shape::Box { size: DVec3::splat(4.0) }, DMat4::IDENTITY, mirror);
    let settings = PathSettings { max_bounces: u32::MAX, ..PathSettings::default() };
    let seen = look_at_origin(&scene, DVec3::new(0.3, 0.2, 1.0), &settings, 64);
    assert_eq!(seen.mean, [0.0; 3]);
}
