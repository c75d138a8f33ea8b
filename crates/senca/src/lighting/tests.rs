use std::borrow::Cow;

use senca_math::glam::{DQuat, DVec3};
use senca_math::{Control, LinearRgb};
use senca_radiosity::{HierarchySettings, MeshSettings, Solution};
use senca_scene::{
    Attenuation, Background, Geometry, Light, LightId, LightKind, Material, Node, Phong, Reflection, Scene,
    Shape, Transform,
};

use super::*;
use crate::{LookAt, Method, Settings, Viewpoint, render};

fn matt(color: LinearRgb) -> Material {
    let phong = Phong { diffuse: color, ambient: color, ..Phong::default() };
    Material { reflection: Reflection::Phong(phong), double_sided: true, ..Material::default() }
}

fn add(scene: &mut Scene, shape: Shape, place: [f64; 3], material: Material) {
    let material = Some(scene.add_material(material));
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material });
    let transform =
        Transform::Parts { translation: place.into(), rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

/// A closed room of 2 x 2 x 2 with a lamp in it.
fn room() -> Scene {
    let mut scene = Scene { background: Background::Color(LinearRgb::BLACK), ..Scene::default() };
    add(&mut scene, Shape::Box { size: DVec3::splat(2.0) }, [0.0; 3], matt(LinearRgb::splat(0.5)));
    let light = Light {
        name: "lamp".into(),
        color: LinearRgb::splat(0.5),
        attenuation: Attenuation::InverseSquare { range: None },
        kind: LightKind::Point,
    };
    scene.lights.push(light);
    let node = scene.add_node(Node { light: Some(LightId(0)), ..Node::default() });
    scene.roots.push(node);
    scene
}

fn settings() -> Settings {
    let eye = LookAt { eye: Some(DVec3::new(0.0, 0.0, 0.9)), ..LookAt::default() };
    Settings {
        size: Some([24, 24]),
        viewpoint: Viewpoint::LookAt(LookAt { target: Some(DVec3::ZERO), ..eye }),
        yfov: Some(1.0),
        method: Method::Radiosity,
        radiosity: RadiositySettings {
            mesh: MeshSettings { patch_size: Some(0.6), ..MeshSettings::default() },
            hierarchy: HierarchySettings { threshold: 1e-3, ..HierarchySettings::default() },
            ..RadiositySettings::default()
        },
        ..Settings::default()
    }
}

fn light(scene: &Scene, settings: &Settings) -> Solution {
    compute_light(scene, settings, &Control::default(), &mut |_| {}).expect("light").solution
}

fn mean(image: &senca_math::Image) -> f32 {
    let sum: f32 = image.pixels().iter().map(|p| p[0]).sum();
    sum / image.pixels().len() as f32
}

#[test]
fn all_displays_show_the_same_light() {
    let (scene, settings) = (room(), settings());
    let light = light(&scene, &settings);
    let shown = |display| {
        let settings =
            Settings { radiosity: RadiositySettings { display, ..settings.radiosity }, ..settings.clone() };
        let (image, _) =
            show_light(Cow::Borrowed(&scene), &light, &settings, &Control::default()).expect("a picture");
        mean(&image)
    };
    let bilinear = shown(Display::Bilinear);
    assert!(bilinear > 0.1, "{bilinear}");
    for display in [Display::Flat, Display::Gouraud, Display::Trace, Display::Gather] {
        let other = shown(display);
        assert!((other / bilinear - 1.0).abs() < 0.05, "{display:?}: {other}, not {bilinear}");
    }
}

#[test]
fn light_does_not_depend_on_the_camera_and_scales_with_exposure() {
    let (scene, settings) = (room(), settings());
    let first = compute_light(&scene, &settings, &Control::default(), &mut |_| {}).expect("light");
    let elsewhere = Settings { yfov: Some(0.3), size: Some([8, 8]), ..settings.clone() };
    let second = compute_light(&scene, &elsewhere, &Control::default(), &mut |_| {}).expect("light");
    assert!(first.solution == second.solution && first.fingerprint == second.fingerprint);
    let brighter =
        Settings { radiosity: RadiositySettings { exposure: 2.0, ..settings.radiosity }, ..settings.clone() };
    let show = |settings: &Settings| {
        let shown = show_light(Cow::Borrowed(&scene), &first.solution, settings, &Control::default());
        mean(&shown.expect("a picture").0)
    };
    assert!((show(&brighter) / show(&settings) - 2.0).abs() < 1e-3);
}

#[test]
fn both_solvers_agree_and_render_does_it_all() {
    let (scene, settings) = (room(), settings());
    let (image, report) = render(&scene, &settings).expect("a picture");
    assert!(report.radiosity.is_some_and(|light| light.converged && light.patches > 50));
    let book = Settings {
        radiosity: RadiositySettings { solver: Solver::GaussSeidel, ..settings.radiosity },
        ..settings
    };
    let (by_the_book, _) = render(&scene, &book).expect("a picture");
    assert!((mean(&image) / mean(&by_the_book) - 1.0).abs() < 0.05);
}

#[test]
fn false_colours_come_with_a_scale() {
    let (scene, mut settings) = (room(), settings());
    let light = light(&scene, &settings);
    settings.size = Some([32, 210]);
    settings.radiosity.show =
        Show::FalseColors { most: Some(2.0), luminance_of_one: 1.0, logarithmic: false, mesh: true };
    let shown = show_light(Cow::Borrowed(&scene), &light, &settings, &Control::default());
    let (image, _) = shown.expect("a picture");
    assert!(image.width() > 32 && image.height() == 210);
}
