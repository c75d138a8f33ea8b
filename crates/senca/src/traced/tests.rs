//! Traced pictures against those of the pipeline, and what only a tracer does.

use senca_math::LinearRgb;
use senca_math::glam::{DQuat, DVec3};
use senca_scene::{
    Animation, Channel, ChannelTarget, ChannelValues, Geometry, Interpolation, Light, LightId, LightKind,
    Material, MetallicRoughness, Node, NodeId, Phong, Reflection, Shape, Transform,
};
use senca_trace::antialias::{AdaptiveSettings, Antialiasing, PixelFilter};

use super::*;
use crate::{LookAt, Tracing, Viewpoint, render};

fn at(translation: [f64; 3]) -> Transform {
    Transform::Parts { translation: translation.into(), rotation: DQuat::IDENTITY, scale: DVec3::ONE }
}

fn add(scene: &mut Scene, shape: Shape, place: [f64; 3], material: Material) -> NodeId {
    let material = Some(scene.add_material(material));
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material });
    let node = scene.add_node(Node { geometry: Some(geometry), transform: at(place), ..Node::default() });
    scene.roots.push(node);
    node
}

fn colored(r: f32, g: f32, b: f32) -> Reflection {
    let diffuse = LinearRgb::new(r, g, b);
    Reflection::Phong(Phong {
        ambient: diffuse,
        diffuse,
        specular: LinearRgb::splat(0.4),
        ..Phong::default()
    })
}

/// Solids of all materials on a floor under two lamps.
fn scene() -> Scene {
    let mut scene = Scene { ambient: LinearRgb::splat(0.15), ..Scene::default() };
    let of = |reflection| Material { reflection, ..Material::default() };
    let metal = MetallicRoughness {
        base_color: LinearRgb::new(0.9, 0.6, 0.3),
        roughness: 0.4,
        ..MetallicRoughness::default()
    };
    let plastic = MetallicRoughness { metallic: 0.0, roughness: 0.5, ..metal.clone() };
    add(&mut scene, Shape::Plane { size: Some(8.0) }, [0.0; 3], of(colored(0.7, 0.7, 0.7)));
    add(&mut scene, Shape::Box { size: DVec3::ONE }, [-1.5, 0.5, 0.0], of(colored(0.8, 0.2, 0.1)));
    add(&mut scene, Shape::Sphere { radius: 0.6 }, [0.0, 0.6, 0.3], of(Reflection::MetallicRoughness(metal)));
    let cylinder = Shape::Cylinder { radius: 0.5, height: 1.0, capped: true };
    add(&mut scene, cylinder, [1.5, 0.0, 0.0], of(Reflection::MetallicRoughness(plastic)));
    let unlit = Material { unlit: true, ..of(colored(0.2, 0.4, 0.9)) };
    add(&mut scene, Shape::Box { size: DVec3::splat(0.4) }, [0.6, 0.2, 1.6], unlit);
    for (color, place) in [([1.0, 0.9, 0.8], [3.0, 5.0, 3.0]), ([0.2, 0.3, 0.4], [-4.0, 3.0, 2.0])] {
        scene.lights.push(Light {
            name: String::new(),
            color: LinearRgb::from_array(color),
            attenuation: senca_scene::Attenuation::None,
            kind: LightKind::Point,
        });
        let light = Some(LightId(scene.lights.len() as u32 - 1));
        let node = scene.add_node(Node { light, transform: at(place), ..Node::default() });
        scene.roots.push(node);
    }
    scene
}

fn settings(method: Method) -> Settings {
    let eye =
        LookAt { eye: Some(DVec3::new(1.0, 2.5, 6.0)), target: Some(DVec3::new(0.0, 0.4, 0.0)), up: None };
    Settings { size: Some([96, 72]), viewpoint: Viewpoint::LookAt(eye), method, ..Settings::default() }
}

fn picture(scene: &Scene, settings: &Settings) -> Image {
    render(scene, settings).expect("a picture").0
}

/// Share of pixels that differ by more than `tolerance` in some channel.
fn differing(a: &Image, b: &Image, tolerance: f32) -> f64 {
    let differs = |(a, b): &(&[f32; 4], &[f32; 4])| (0..4).any(|k| (a[k] - b[k]).abs() > tolerance);
    let count = a.pixels().iter().zip(b.pixels()).filter(differs).count();
    count as f64 / a.pixels().len() as f64
}

#[test]
fn without_shadows_and_but_for_edges_it_is_the_pipelines_picture() {
    let scene = scene();
    for shading in [Shading::Phong, Shading::Material] {
        let mut raster = settings(Method::Raster);
        raster.drawing.shading = shading;
        raster.drawing.tolerance_px = 0.02;
        let mut trace = settings(Method::Trace);
        trace.drawing.shading = shading;
        trace.tracing.recursive.shadows = false;
        let (raster, trace) = (picture(&scene, &raster), picture(&scene, &trace));
        let share = differing(&raster, &trace, 0.02);
        assert!(share < 0.02, "{shading:?}: {share} of the pixels differ");
    }
}

#[test]
fn every_pixel_sees_the_same_object_as_the_rasterizer() {
    let mut scene = scene();
    for (i, material) in scene.materials.iter_mut().enumerate() {
        let code = |bit: usize| if (i + 1) >> bit & 1 == 1 { 1.0 } else { 0.25 };
        material.reflection = colored(code(0), code(1), code(2));
        material.unlit = true;
    }
    let mut raster = settings(Method::Raster);
    raster.drawing.tolerance_px = 0.02;
    let share = differing(&picture(&scene, &raster), &picture(&scene, &settings(Method::Trace)), 1e-6);
    // The outlines are some hundred pixels long; hardly one falls between the two.
    assert!(share < 0.004, "{share} of the pixels see another object");
}

#[test]
fn a_part_is_that_part_of_the_whole_and_threads_make_no_difference() {
    let scene = scene();
    let mut wish = settings(Method::Trace);
    wish.tracing.antialiasing = Antialiasing::Filtered { samples: 4, filter: PixelFilter::Box };
    let whole = picture(&scene, &wish);
    wish.drawing.threads = 3;
    wish.crop = Some(senca_pipeline::Crop { x: 20, y: 30, width: 33, height: 17 });
    let part = picture(&scene, &wish);
    for y in 0..17 {
        assert_eq!(part.row(y), &whole.row(30 + y)[20..53]);
    }
}

#[test]
fn explaining_a_pixel_gives_its_colour() {
    let scene = scene();
    let mut wish = settings(Method::Trace);
    for antialiasing in [Antialiasing::None, Antialiasing::Adaptive(AdaptiveSettings::default())] {
        wish.tracing.antialiasing = antialiasing;
        let image = picture(&scene, &wish);
        let explained = explain_pixel(Cow::Borrowed(&scene), &wish, [48, 40]).expect("an explanation");
        assert_eq!(explained.trees.color, image.pixel(48, 40));
        assert!(explained.svg.starts_with("<svg"));
    }
    let raster = settings(Method::Raster);
    assert!(matches!(explain_pixel(Cow::Borrowed(&scene), &raster, [0, 0]), Err(Error::Combination(_))));
}

#[test]
fn resuming_is_going_on() {
    let scene = scene();
    let with = |samples, time_limit| {
        let antialiasing = Antialiasing::Filtered { samples, filter: PixelFilter::Tent { radius: 1.0 } };
        let tracing = Tracing { antialiasing, time_limit, keeps_partial: true, ..Tracing::default() };
        Settings { size: Some([40, 30]), tracing, ..settings(Method::Trace) }
    };
    let traced = |settings: &Settings, resume: Option<&[u8]>| {
        let mut last = Vec::new();
        let mut save = |bytes: &[u8]| last = bytes.to_vec();
        let mut job = TraceJob { resume, save: Some(&mut save), samples_map: false };
        let picture = trace_with(Cow::Borrowed(&scene), settings, &Control::default(), &mut job);
        picture.map(|picture| (picture.image, last))
    };
    let (whole, _) = traced(&with(5, None), None).expect("a picture");
    let (_, partial) = traced(&with(5, Some(Duration::ZERO)), None).expect("a first sample");
    let (resumed, _) = traced(&with(5, None), Some(&partial)).expect("the rest");
    assert_eq!(resumed, whole);

    let mut other = with(5, None);
    other.tracing.recursive.max_depth = 3;
    let refused = traced(&other, Some(&partial)).expect_err("another picture");
    assert!(matches!(refused, Error::Partial(_)) && !refused.is_usage(), "{refused}");
}

#[test]
fn what_does_not_go_together_is_the_callers_fault() {
    let scene = scene();
    let mut wish = settings(Method::Trace);
    wish.drawing.shading = Shading::Wire;
    assert!(render(&scene, &wish).expect_err("no lines").is_usage());
    let mut wish = settings(Method::Trace);
    wish.tracing.recursive.adaptive_depth = 7.0;
    assert!(render(&scene, &wish).expect_err("out of range").is_usage());
    let mut wish = settings(Method::Trace);
    wish.crop = Some(senca_pipeline::Crop { x: 90, y: 0, width: 7, height: 1 });
    assert!(render(&scene, &wish).expect_err("outside").is_usage());
}

#[test]
fn paths_find_the_same_scene() {
    let scene = scene();
    let mut wish = settings(Method::Path);
    wish.tracing.antialiasing = Antialiasing::Filtered { samples: 4, filter: PixelFilter::Box };
    let (image, report) = render(&scene, &wish).expect("a picture");
    assert!(image.pixels().iter().all(|p| p.iter().all(|v| v.is_finite())));
    assert!(report.tracing.is_some_and(|t| t.counts.rays.bounce > 0));
}

#[test]
fn an_open_shutter_blurs_what_moves() {
    let mut scene = Scene::default();
    let glow = Material { emission: LinearRgb::WHITE, ..Material::default() };
    let node = add(&mut scene, Shape::Box { size: DVec3::splat(0.5) }, [0.0; 3], glow);
    let channel = Channel {
        target: ChannelTarget { node },
        times: vec![0.0, 1.0],
        values: ChannelValues::Translation(vec![DVec3::NEG_X, DVec3::X]),
        interpolation: Interpolation::Linear,
    };
    scene.animations.push(Animation { name: String::new(), channels: vec![channel] });
    let view = senca_math::world_from_look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y).expect("a frame");
    let projection = senca_scene::Projection::Perspective { yfov: 0.5, aspect: None, near: None, far: None };
    scene.cameras.push(Camera { shutter: Some([0.0, 1.0]), ..Camera::new("", projection) });
    let camera = Some(senca_scene::CameraId(0));
    let node = scene.add_node(Node { camera, transform: Transform::Matrix(view), ..Node::default() });
    scene.roots.push(node);
    let mut wish = Settings { size: Some([40, 30]), method: Method::Trace, ..Settings::default() };
    wish.tracing.antialiasing = Antialiasing::Filtered { samples: 16, filter: PixelFilter::Box };
    wish.drawing.background = Some(Background::Color(LinearRgb::BLACK));
    let image = picture(&scene, &wish);
    let middle = image.pixel(20, 15)[0];
    assert!(middle > 0.1 && middle < 0.6, "there for a quarter of the time: {middle}");
}
