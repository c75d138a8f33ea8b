//! The samples and the examples of the reference are read as they are.

use std::path::Path;

use senca_scene::{Shape, Transform};

use super::super::*;
use crate::{Directory, Files};

/// Every file that is asked for is there; its content does not matter to the readers below, except
/// that pictures are those of the samples.
struct AnyFile;

impl Files for AnyFile {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        if uri.ends_with(".exr") { Directory::new(root().join("samples")).read(uri) } else { Ok(Vec::new()) }
    }
}

/// Whether anything in a scene gives light, or is shown without any.
fn is_visible(scene: &Scene) -> bool {
    let shines = |m: &senca_scene::Material| m.unlit || m.emission.max_component() > 0.0;
    scene.is_lit() || scene.materials.iter().any(shines)
}

/// A model of one ball, whatever the file.
fn any_model(name: &str, _: &[u8], _: &dyn Files) -> Result<Scene, ReadError> {
    Ok(Scene::of_shape(name, Shape::Sphere { radius: 1.0 }))
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Names and texts of the samples, in the order of their names.
pub(super) fn samples() -> Vec<(String, String)> {
    let folder = std::fs::read_dir(root().join("samples")).expect("the folder of samples");
    let mut paths: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths
        .into_iter()
        .map(|path| (path.display().to_string(), std::fs::read_to_string(&path).expect("a sample")))
        .collect()
}

/// The TOML blocks of the reference with the lines they begin at.
pub(super) fn examples() -> Vec<(usize, String)> {
    let text = std::fs::read_to_string(root().join("docs/scene-format.md")).expect("the reference");
    let mut examples = Vec::new();
    let mut block: Option<(usize, String)> = None;
    for (number, line) in text.lines().enumerate() {
        match &mut block {
            None if line == "```toml" => block = Some((number + 2, String::new())),
            None => {}
            Some(_) if line == "```" => examples.extend(block.take()),
            Some((_, text)) => *text += &format!("{line}\n"),
        }
    }
    examples
}

#[test]
fn every_example_of_the_reference_is_a_file_that_works() {
    let examples = examples();
    assert!(examples.len() >= 19, "only {} examples found", examples.len());
    for (line, text) in examples {
        let file = read("example.toml", text.as_bytes(), &AnyFile, &any_model)
            .unwrap_or_else(|error| panic!("docs/scene-format.md, example at line {line}: {error}"));
        file.scene
            .cameras
            .iter()
            .for_each(|camera| assert!(!camera.name.is_empty() || text.contains("[camera]")));
    }
}

#[test]
fn every_sample_is_read() {
    let samples = samples();
    let names: Vec<&str> = samples.iter().map(|(name, _)| name.rsplit('/').next().unwrap_or(name)).collect();
    let expected = [
        "animation.toml",
        "cameras.toml",
        "caustic-limit.toml",
        "cornell-glass.toml",
        "cornell.toml",
        "csg.toml",
        "environment.toml",
        "fog.toml",
        "glass.toml",
        "house.toml",
        "jaggies.toml",
        "lens.toml",
        "lights.toml",
        "materials.toml",
        "mirrors.toml",
        "moire.toml",
        "motion.toml",
        "quartics.toml",
        "shadows.toml",
        "shapes.toml",
        "teapot-trace.toml",
        "teapot.toml",
        "texture.toml",
    ];
    for name in expected {
        assert!(names.contains(&name), "{name} is missing");
    }
    for (name, text) in samples {
        let file =
            read(&name, text.as_bytes(), &AnyFile, &any_model).unwrap_or_else(|error| panic!("{error}"));
        assert!(!file.scene.cameras.is_empty() && is_visible(&file.scene), "{name}");
        assert_eq!(file.scene.validate(), Ok(()), "{name}");
        assert!(!file.scene.instances().is_empty(), "{name}");
        assert!(is_scene_file(text.as_bytes()), "{name}");
    }
}

#[test]
fn the_samples_name_files_that_are_there() {
    for (name, text) in samples() {
        let files = Directory::new(root().join("samples"));
        let models = |uri: &str, bytes: &[u8], _: &dyn Files| {
            assert!(!bytes.is_empty(), "{uri}");
            Ok(Scene::of_shape(uri, Shape::Sphere { radius: 1.0 }))
        };
        // The teapot's data stands beside the samples in a folder of its own.
        if text.contains("classic/") && !root().join("samples/classic").exists() {
            continue;
        }
        read(&name, text.as_bytes(), &files, &models).unwrap_or_else(|error| panic!("{error}"));
    }
}

fn sample(name: &str) -> Scene {
    let (_, text) = samples().into_iter().find(|(path, _)| path.ends_with(name)).expect("the sample");
    read(name, text.as_bytes(), &AnyFile, &any_model).unwrap_or_else(|error| panic!("{error}")).scene
}

#[test]
fn the_material_sweeps_have_the_constants_of_the_figures() {
    let scene = sample("materials.toml");
    assert_eq!(scene.geometries.len(), 1, "one ball, twelve times");
    let phong = |i: usize| {
        let node = &scene.nodes[scene.roots[i].index()];
        let senca_scene::Reflection::Phong(phong) =
            &scene.materials[node.material.expect("a material").index()].reflection
        else {
            panic!("Phong");
        };
        phong.clone()
    };
    // The camera and the light are the first two roots.
    let constants: Vec<_> =
        (2..14).map(phong).map(|p| (p.ambient.r, p.diffuse.r, p.specular.r, p.exponent)).collect();
    let od = [0.4, 0.6, 0.8, 1.0];
    let os = [0.0, 0.2, 0.4, 0.6];
    let n = [1.0, 5.0, 20.0, 100.0];
    for i in 0..4 {
        assert_eq!(constants[i], (0.0, od[i], 0.0, 20.0));
        assert_eq!(constants[4 + i], (0.4, 0.4, os[i], 5.0));
        assert_eq!(constants[8 + i], (0.4, 0.4, 0.6, n[i]));
    }
    assert_eq!((scene.ambient.r, scene.lights[0].color.r), (0.1, 1.0));
}

#[test]
fn the_house_has_the_normals_of_the_text() {
    let scene = sample("house.toml");
    let Shape::Mesh(mesh) = &scene.geometries[0].shape else { panic!("a mesh") };
    assert_eq!((mesh.points.len(), mesh.faces.len()), (17, 13));
    let normals: Vec<_> = mesh
        .faces
        .iter()
        .map(|face| {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.position(face[i]).as_dvec3());
            (b - a).cross(c - a).normalize().to_array()
        })
        .collect();
    // 1991 thesis, section 9; walls, roof and block keep their order of the text within each group.
    let expected = [
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.6, 0.8, 0.0],
        [-0.6, 0.8, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    for (normal, expected) in normals.iter().zip(expected) {
        assert!((0..3).all(|i| (normal[i] - expected[i]).abs() < 1e-12), "{normal:?} {expected:?}");
    }
    assert!(mesh.surfaces.iter().all(|surface| !surface.smooth));
}

#[test]
fn every_camera_of_the_samples_gives_a_view() {
    let bounds = senca_math::Aabb { min: [-5.0; 3].into(), max: [5.0; 3].into() };
    for (name, text) in samples() {
        let scene = read(&name, text.as_bytes(), &AnyFile, &any_model)
            .unwrap_or_else(|error| panic!("{error}"))
            .scene;
        let world = scene.world_from_nodes();
        for (node, world_from_node) in scene.nodes.iter().zip(world) {
            let Some(camera) = node.camera else { continue };
            let camera = &scene.cameras[camera.index()];
            let world_from_node = world_from_node.unwrap_or_else(|| Transform::default().matrix());
            camera
                .view(&world_from_node, 4.0 / 3.0, &bounds)
                .unwrap_or_else(|error| panic!("{name}, {}: {error}", camera.name));
        }
    }
}
