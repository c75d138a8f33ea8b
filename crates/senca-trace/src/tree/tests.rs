//! What is written down is what happened.

use senca_math::glam::{DQuat, DVec3};
use senca_math::{LinearRgb, View, world_from_look_at};
use senca_scene::{
    Attenuation, Background, Geometry, Light, LightId, LightKind, Material, Node, Scene, Shape, Transform,
};

use super::*;
use crate::World;
use crate::antialias::{AdaptiveSettings, Antialiasing, PixelFilter};
use crate::recursive::RecursiveSettings;

fn place(scene: &mut Scene, node: Node) {
    let node = scene.add_node(node);
    scene.roots.push(node);
}

fn at(translation: [f64; 3]) -> Transform {
    Transform::Parts { translation: translation.into(), rotation: DQuat::IDENTITY, scale: DVec3::ONE }
}

fn add(scene: &mut Scene, name: &str, shape: Shape, where_to: [f64; 3], material: Material) {
    let material = Some(scene.add_material(material));
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material });
    let node =
        Node { name: name.into(), geometry: Some(geometry), transform: at(where_to), ..Node::default() };
    place(scene, node);
}

/// A mirror ball and a glass ball on a floor under a lamp.
fn scene() -> Scene {
    let sky = Background::Color(LinearRgb::new(0.1, 0.2, 0.3));
    let mut scene = Scene { background: sky, ambient: LinearRgb::splat(0.1), ..Scene::default() };
    add(&mut scene, "floor", Shape::Plane { size: Some(20.0) }, [0.0; 3], Material::default());
    let mirror = Material { name: "silver".into(), mirror: LinearRgb::splat(0.6), ..Material::default() };
    add(&mut scene, "ball", Shape::Sphere { radius: 1.0 }, [0.0, 1.0, 0.0], mirror);
    let glass = Material {
        transmission: LinearRgb::splat(0.9),
        mirror: LinearRgb::splat(0.1),
        ..Material::default()
    };
    add(&mut scene, "drop <1>", Shape::Sphere { radius: 0.5 }, [1.2, 0.5, 1.0], glass);
    scene.lights.push(Light {
        name: "lamp".into(),
        color: LinearRgb::WHITE,
        attenuation: Attenuation::None,
        kind: LightKind::Point,
    });
    place(&mut scene, Node { light: Some(LightId(0)), transform: at([2.0, 6.0, 3.0]), ..Node::default() });
    scene
}

const SIZE: [u32; 2] = [40, 30];

fn with<T>(settings: &RecursiveSettings, test: impl FnOnce(&Tracer<'_>) -> T) -> T {
    let scene = scene();
    let world = World::new(&scene).expect("a world");
    let eye = DVec3::new(1.0, 2.0, 7.0);
    let frame = world_from_look_at(eye, DVec3::new(0.3, 0.8, 0.0), DVec3::Y).expect("a frame");
    let view = View::perspective(&frame, 0.5, 4.0 / 3.0, 0.1, None).expect("a view");
    test(&Tracer::new(&world, &view, SIZE, scene.background, settings))
}

fn film(antialiasing: Antialiasing) -> FilmSettings {
    let area = Area { x: 0, y: 0, width: SIZE[0], height: SIZE[1] };
    FilmSettings { size: SIZE, area, antialiasing, seed: 3 }
}

#[test]
fn the_explained_colour_is_the_pictures() {
    with(&RecursiveSettings::default(), |tracer| {
        for antialiasing in [
            Antialiasing::None,
            Antialiasing::Jitter { amplitude: 1.0 },
            Antialiasing::Regular { per_side: 2 },
            Antialiasing::Adaptive(AdaptiveSettings::default()),
            Antialiasing::Filtered { samples: 4, filter: PixelFilter::Mitchell { radius: 2.0 } },
        ] {
            let settings = film(antialiasing);
            let mut whole = Film::new(&settings).expect("a film");
            whole.expose(tracer, &mut Watch::default(), &Control::default()).expect("a picture");
            let image = whole.develop(tracer.is_transparent());
            for (x, y) in [(20, 15), (12, 12), (28, 20), (0, 0), (39, 29)] {
                let explained = PixelTrees::trace(tracer, &settings, [x, y]).expect("trees");
                // The picture follows many rays at once, which rounds otherwise.
                let off = (0..4).map(|k| (explained.color[k] - image.pixel(x, y)[k]).abs());
                assert!(off.fold(0.0, f32::max) < 1e-5, "{x},{y} {antialiasing:?}");
                for tree in &explained.trees {
                    assert_eq!(tree.total().to_array(), tree.color[..3], "contributions add up");
                }
            }
        }
    });
}

#[test]
fn a_tree_tells_of_hits_lights_and_blockers() {
    with(&RecursiveSettings { max_depth: 3, ..RecursiveSettings::default() }, |tracer| {
        let explained = PixelTrees::trace(tracer, &film(Antialiasing::None), [18, 13]).expect("trees");
        let rays = &explained.trees[0].rays;
        assert_eq!((rays[0].kind, rays[0].nest, rays[0].parent), (RayKind::Primary, 0, None));
        let RayEnd::Met(ball) = &rays[0].end else { panic!("the ball is met") };
        assert_eq!((&*ball.object_name, &*ball.material_name), ("ball", "silver"));
        assert!((ball.point.distance(DVec3::Y) - 1.0).abs() < 1e-9 && ball.entering);
        assert!((ball.normal.length() - 1.0).abs() < 1e-6);
        assert_eq!(ball.shadows[0].light_name, "lamp");
        assert_eq!(ball.shadows[0].blocker, None);
        let reflected = &rays[1];
        assert_eq!((reflected.kind, reflected.nest, reflected.parent), (RayKind::Reflected, 1, Some(0)));
        assert_eq!(reflected.weight, LinearRgb::splat(0.6));
        assert_eq!(explained.trees[0].children(0).collect::<Vec<_>>(), [1]);
        assert_eq!(explained.counts.rays.primary, 1);
    });
    with(&RecursiveSettings::default(), |tracer| {
        // Somewhere on the floor the ball stands in the light.
        let blocked = (0..SIZE[0]).any(|x| {
            let explained = PixelTrees::trace(tracer, &film(Antialiasing::None), [x, 20]).expect("trees");
            let RayEnd::Met(m) = &explained.trees[0].rays[0].end else { return false };
            let by_ball = |s: &Shadow| s.blocker.as_ref().is_some_and(|(name, _)| name == "ball");
            m.object_name == "floor" && m.shadows.iter().any(by_ball)
        });
        assert!(blocked);
    });
}

#[test]
fn texts_and_drawings_name_what_was_met() {
    with(&RecursiveSettings::default(), |tracer| {
        let settings = film(Antialiasing::None);
        let all: Vec<_> =
            (0..SIZE[0]).map(|x| PixelTrees::trace(tracer, &settings, [x, 17]).expect("trees")).collect();
        let trees = all.iter().max_by_key(|trees| trees.trees[0].rays.len()).expect("a pixel");
        assert!(trees.trees[0].rays.len() > 4, "glass makes many rays");
        let text = trees.to_text();
        for part in ["primary ray", "reflected ray", "transmitted ray", "k_r =", "I_l =", "light lamp"] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        let dot = trees.to_dot();
        assert!(dot.starts_with("digraph") && dot.ends_with("}\n") && dot.contains("r0_0 -> r0_1"));
        let svg = trees.to_svg(tracer.world());
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("drop &lt;1&gt;") && !svg.contains("NaN"), "{svg}");
    });
}

#[test]
fn pixels_outside_are_refused() {
    with(&RecursiveSettings::default(), |tracer| {
        let error = PixelTrees::trace(tracer, &film(Antialiasing::None), [40, 0]).expect_err("outside");
        assert!(matches!(error, TraceError::Setting { name: "column of the pixel", .. }));
    });
}
