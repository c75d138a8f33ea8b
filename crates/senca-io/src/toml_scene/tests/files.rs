//! Files that a scene names.

use std::collections::HashMap;

use senca_scene::{
    Animation, Channel, ChannelTarget, ChannelValues, ImageData, Interpolation, Material, NodeId, Shape,
};

use super::super::*;
use crate::Files;
use crate::images::{PictureFormat, PictureOptions, encode};

/// Files in memory.
struct Memory(HashMap<&'static str, Vec<u8>>);

impl Memory {
    fn new(files: &[(&'static str, &str)]) -> Self {
        Self(files.iter().map(|(name, text)| (*name, text.as_bytes().to_vec())).collect())
    }
}

impl Files for Memory {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let missing = || ReadError::Io { path: uri.into(), source: std::io::ErrorKind::NotFound.into() };
        self.0.get(uri).cloned().ok_or_else(missing)
    }
}

/// A model of two nodes with a material and an animation.
fn model(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    if let Some(other) = bytes.strip_prefix(b"needs ") {
        files.read(str::from_utf8(other).expect("a name"))?;
    }
    let mut scene = Scene::of_shape(name, Shape::Sphere { radius: 1.0 });
    scene.geometries[0].material = Some(scene.add_material(Material::default()));
    let child = scene.add_node(scene.nodes[0].clone());
    scene.nodes[0].children = vec![child];
    let channel = Channel {
        target: ChannelTarget { node: NodeId(1) },
        times: vec![0.0],
        values: ChannelValues::Scale(vec![senca_math::glam::DVec3::ONE]),
        interpolation: Interpolation::Step,
    };
    scene.animations.push(Animation { name: "spin".into(), channels: vec![channel] });
    Ok(scene)
}

fn read_with(files: &Memory, text: &str) -> Result<SceneFile, ReadError> {
    read("folder/main.toml", text.as_bytes(), files, &model)
}

#[track_caller]
fn message(files: &Memory, text: &str) -> String {
    read_with(files, text).expect_err("an error").to_string()
}

#[test]
fn models_stand_in_place_of_objects() {
    let files = Memory::new(&[("a.obj", "x")]);
    let text = "[material.m]\n[[object]]\nfile = 'a.obj'\n[[object]]\nfile = 'a.obj'\ntranslate = [1,0,0]\nmaterial = 'm'";
    let scene = read_with(&files, text).expect("reads").scene;
    assert_eq!((scene.geometries.len(), scene.materials.len()), (1, 2), "the file is read once");
    assert_eq!(scene.geometries[0].material.map(|m| m.0), Some(1), "its material moved behind ours");
    assert_eq!(scene.instances().len(), 4);
    let targets: Vec<_> = scene.animations[0].channels.iter().map(|c| c.target.node.0).collect();
    assert_eq!(scene.nodes.len(), 6);
    assert_eq!(targets, [2, 5], "each placing has its own animation");
    let material = |i: usize| scene.nodes[i].material.map(|m| m.0);
    assert_eq!((material(1), material(4)), (None, Some(0)));
}

#[test]
fn names_in_an_included_file_are_relative_to_it() {
    let files = Memory::new(&[
        ("parts/wheel.toml", "[[object]]\nfile = 'rim.obj'\n[[object]]\nfile = '../bolt.obj'"),
        ("parts/rim.obj", "needs rim.mtl"),
        ("parts/rim.mtl", ""),
        ("bolt.obj", ""),
    ]);
    let scene = read_with(&files, "[[object]]\nfile = 'parts/wheel.toml'").expect("reads").scene;
    assert_eq!(scene.instances().len(), 4);
}

#[test]
fn errors_in_included_files_carry_their_name() {
    let files = Memory::new(&[("part.toml", "\n[[object]]\nshape = 'ball'")]);
    assert!(
        message(&files, "[[object]]\nfile = 'part.toml'")
            .starts_with("part.toml:3:9: \"shape\" cannot be \"ball\"")
    );
}

#[test]
fn missing_files_are_reported_where_they_are_named() {
    let files = Memory::new(&[]);
    let text = message(&files, "[[object]]\nfile = 'a.obj'");
    assert!(text.starts_with("folder/main.toml:2:8: cannot read \"a.obj\""), "{text}");
    let text = message(&files, "[texture.t]\nfile = 'a.png'");
    assert!(text.starts_with("folder/main.toml:2:8: cannot read \"a.png\""), "{text}");
    let nothing = super::error("[[object]]\nfile = 'a.obj'");
    assert!(nothing.starts_with("scene.toml:2:8: needs the file \"a.obj\""), "{nothing}");
}

#[test]
fn files_that_include_themselves_are_refused() {
    let files = Memory::new(&[
        ("main.toml", "[[object]]\nfile = 'main.toml'"),
        ("a.toml", "[[object]]\nfile = 'sub/../b.toml'"),
        ("b.toml", "[[object]]\nfile = './a.toml'"),
        ("c.toml", "[[object]]\nfile = 'main.toml'"),
        ("t.txt", "[[object]]\nfile = 't.txt'"),
        ("sub/d.toml", "[[object]]\nfile = '../sub/e.toml'"),
        ("sub/e.toml", "[[object]]\nfile = 'd.toml'"),
    ]);
    for file in ["main.toml", "a.toml", "b.toml", "c.toml", "sub/d.toml", "t.txt", "x/../main.toml"] {
        let text = message(&files, &format!("[[object]]\nfile = '{file}'"));
        assert!(text.contains("includes itself"), "{file}: {text}");
    }
}

#[test]
fn long_chains_of_files_are_limited() {
    struct Endless;
    impl Files for Endless {
        fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
            Ok(format!("[[object]]\nfile = 'x{}'", uri.rsplit('/').next().unwrap_or("")).into_bytes())
        }
    }
    let error = read("main.toml", b"[[object]]\nfile = 'x.toml'", &Endless, &model).expect_err("endless");
    assert!(matches!(error, ReadError::Limit { .. }) && error.to_string().contains("32 deep"), "{error}");
}

#[test]
fn textures_are_read_from_files_once() {
    let red = senca_math::Image::new(2, 1, [1.0, 0.0, 0.0, 1.0]);
    let png = encode(&red, PictureFormat::Png, &PictureOptions::default()).expect("encodes");
    let files = Memory(HashMap::from([("red.png", png)]));
    let text = "[texture.a]\nfile = 'red.png'\n[texture.b]\nfile = 'red.png'\nfilter = 'nearest'\n\
                [material.m]\ntexture = { file = 'red.png', wrap = 'clamp' }";
    let scene = read_with(&files, text).expect("reads").scene;
    assert_eq!((scene.images.len(), scene.textures.len()), (1, 3));
    let expected = ImageData::Rgba8 { width: 2, height: 1, texels: vec![[255, 0, 0, 255]; 2] };
    assert_eq!((&scene.images[0].data, scene.images[0].name.as_str()), (&expected, "red.png"));
}

#[test]
fn names_that_lead_outside_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("in")).expect("a folder");
    std::fs::write(folder.path().join("secret.obj"), "x").expect("a file");
    let files = crate::Directory::new(folder.path().join("in"));
    std::fs::write(folder.path().join("in/part.toml"), "[[object]]\nfile = '../secret.obj'").expect("a file");
    for file in ["../secret.obj", "/etc/passwd", "http://example.org/a.obj", "part.toml"] {
        let text = format!("[[object]]\nfile = '{file}'");
        let error = read("main.toml", text.as_bytes(), &files, &model).expect_err(file).to_string();
        assert!(error.contains("only files beside the model are read"), "{file}: {error}");
    }
}

#[test]
fn scene_files_are_known_by_their_first_line() {
    for text in ["[render]", "# x\n\n  name = \"a\"", "\u{feff}ambient=1", "[[object]]\n", "fog.color = 1"] {
        assert!(is_scene_file(text.as_bytes()), "{text}");
    }
    for text in
        ["", "# only a comment", "v 0 0 0", "solid a = b", "ply", "{\"a\": 1}", "= 3", "0\n1 2", "\0\0"]
    {
        assert!(!is_scene_file(text.as_bytes()), "{text}");
    }
}
