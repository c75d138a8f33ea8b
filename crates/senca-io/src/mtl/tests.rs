use std::collections::HashMap;

use senca_scene::math::glam::Vec3;
use senca_scene::math::{Image, LinearRgb};
use senca_scene::{AlphaMode, ImageData, Material, MetallicRoughness, Phong, Reflection, Scene, Wrap};

use crate::images::{PictureFormat, PictureOptions, encode};
use crate::{Files, Location, ReadError, obj};

/// Files in memory.
struct Memory(HashMap<&'static str, Vec<u8>>);

impl Files for Memory {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let missing = || ReadError::malformed(Location::file(uri), "is not there");
        self.0.get(uri).cloned().ok_or_else(missing)
    }
}

/// A PNG whose pixel `(x, y)` is `color(x, y)`.
fn png(width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 4]) -> Vec<u8> {
    let pixels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
    let image = Image::from_pixels(width, height, pixels).expect("pixels");
    encode(&image, PictureFormat::Png, &PictureOptions::default()).expect("encodes")
}

fn read(library: &str, pictures: Vec<(&'static str, Vec<u8>)>) -> Result<Scene, ReadError> {
    let mut files: HashMap<&'static str, Vec<u8>> = pictures.into_iter().collect();
    files.insert("a.mtl", library.as_bytes().to_vec());
    let text = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    obj::read("a.obj", text, &Memory(files))
}

fn material(library: &str) -> Material {
    let scene = read(library, Vec::new()).expect(library);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene.materials[0].clone()
}

fn phong(material: &Material) -> &Phong {
    match &material.reflection {
        Reflection::Phong(phong) => phong,
        other => panic!("not Phong: {other:?}"),
    }
}

fn physical(material: &Material) -> &MetallicRoughness {
    match &material.reflection {
        Reflection::MetallicRoughness(reflection) => reflection,
        other => panic!("not metallic-roughness: {other:?}"),
    }
}

#[test]
fn coefficients_are_taken_over() {
    let m = material(
        "newmtl m\nKa 0.1 0.2 0.3\nKd 0.4 0.5 0.6\nKs 0.7\nKe 2 0 0\nNs 96.5\nd 0.25\nNi 1.33\nillum 2\n",
    );
    let p = phong(&m);
    assert_eq!((m.name.as_str(), p.ambient), ("m", LinearRgb::new(0.1, 0.2, 0.3)));
    assert_eq!((p.diffuse, p.specular), (LinearRgb::new(0.4, 0.5, 0.6), LinearRgb::splat(0.7)));
    assert_eq!((p.exponent, p.alpha, m.ior), (96.5, 0.25, 1.33));
    assert_eq!((m.emission, m.alpha_mode), (LinearRgb::new(2.0, 0.0, 0.0), AlphaMode::Blend));
    assert_eq!((m.mirror, m.transmission, m.unlit), (LinearRgb::BLACK, LinearRgb::BLACK, false));
}

#[test]
fn missing_coefficients_have_defaults() {
    let m = material("newmtl m\n");
    assert_eq!(m, Material { name: "m".to_owned(), double_sided: true, ..Material::default() });
    assert_eq!(phong(&material("newmtl m\nKd 0.5 0 0\n")).ambient, LinearRgb::new(0.5, 0.0, 0.0));
    assert_eq!(phong(&material("newmtl m\nTr 0.75\n")).alpha, 0.25);
    assert_eq!(phong(&material("newmtl m\nd 1\nTr 1\n")).alpha, 1.0);
    let white = phong(&material("newmtl m\nKd xyz 0.950456 1 1.089058\n")).diffuse;
    assert!(
        (white.r - 1.0).abs() < 1e-4 && (white.g - 1.0).abs() < 1e-4 && (white.b - 1.0).abs() < 1e-4,
        "{white:?}"
    );
}

#[test]
fn illumination_models_choose_what_takes_part() {
    let of =
        |illum: i64| material(&format!("newmtl m\nKs 0.5 0.5 0.5\nTf 0.9 0.8 0.7\nd 0.5\nillum {illum}\n"));
    assert!(of(0).unlit);
    assert_eq!(phong(&of(1)).specular, LinearRgb::BLACK);
    assert_eq!((of(3).mirror, of(3).transmission), (LinearRgb::splat(0.5), LinearRgb::BLACK));
    assert_eq!((of(7).mirror, of(7).transmission), (LinearRgb::splat(0.5), LinearRgb::new(0.9, 0.8, 0.7)));
    assert_eq!(of(8).mirror, LinearRgb::BLACK);
    assert_eq!(material("newmtl m\nd 0.25\nillum 6\n").transmission, LinearRgb::splat(0.75));
}

#[test]
fn physical_statements_make_physical_materials() {
    let m = material("newmtl m\nKd 0.5 0.5 0.5\nPr 0.25\nPm 1\n");
    let p = physical(&m);
    assert_eq!((p.base_color, p.roughness, p.metallic), (LinearRgb::splat(0.5), 0.25, 1.0));
}

#[test]
fn textures_are_read_with_their_options() {
    let picture = png(2, 1, |x, _| [x as f32, 0.0, 0.0, 1.0]);
    let library = "newmtl m\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on -bm 2 with blank.png\n";
    let scene = read(library, vec![("with blank.png", picture)]).expect("reads");
    let p = phong(&scene.materials[0]);
    let reference = p.texture.expect("a texture");
    assert_eq!(p.diffuse, LinearRgb::WHITE);
    assert_eq!(scene.textures[0].wrap_u, Wrap::Clamp);
    // Bottom left of the picture, scaled and moved: u 0 2 + 0.5, v (from the bottom) 0 3 + 0.25.
    let uv = reference.uv_transform * Vec3::new(0.0, 1.0, 1.0);
    assert_eq!(uv, Vec3::new(0.5, 0.75, 1.0));
    let ImageData::Rgba8 { texels, .. } = &scene.images[0].data else { panic!("not 8 bits") };
    assert_eq!(texels[..], [[0, 0, 0, 255], [255, 0, 0, 255]]);
}

#[test]
fn an_alpha_picture_goes_into_the_diffuse_one() {
    let color = png(1, 1, |_, _| [1.0, 0.0, 0.0, 1.0]);
    let mask = png(2, 1, |x, _| [x as f32, x as f32, x as f32, 1.0]);
    let library = "newmtl m\nmap_Kd c.png\nmap_d a.png\n";
    let scene = read(library, vec![("c.png", color), ("a.png", mask)]).expect("reads");
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
    let texture = phong(&scene.materials[0]).texture.expect("a texture").texture;
    let image = scene.textures[texture.index()].image;
    let ImageData::Rgba8 { texels, .. } = &scene.images[image.index()].data else { panic!("not 8 bits") };
    assert_eq!(texels[..], [[255, 0, 0, 0], [255, 0, 0, 255]]);
}

#[test]
fn roughness_and_metalness_share_a_picture() {
    let rough = png(1, 1, |_, _| [1.0, 1.0, 1.0, 1.0]);
    let metal = png(1, 1, |_, _| [0.0, 0.0, 0.0, 1.0]);
    let library = "newmtl m\nmap_Pr r.png\nmap_Pm m.png\n";
    let scene = read(library, vec![("r.png", rough), ("m.png", metal)]).expect("reads");
    let p = physical(&scene.materials[0]);
    let texture = p.metallic_roughness_texture.expect("a texture").texture;
    let image = scene.textures[texture.index()].image;
    let ImageData::Rgba8 { texels, .. } = &scene.images[image.index()].data else { panic!("not 8 bits") };
    assert_eq!((texels[0], p.roughness, p.metallic), ([255, 255, 0, 255], 1.0, 1.0));
}

#[test]
fn bumps_become_normals_unless_they_are_normals() {
    let ramp = png(4, 4, |x, _| [if x == 1 { 1.0 } else { 0.0 }; 4].map(|v: f32| v.max(0.0)));
    let flat = png(1, 1, |_, _| [0.214_041_14, 0.214_041_14, 1.0, 1.0]);
    let scene = read("newmtl m\nbump -bm 0.5 b.png\n", vec![("b.png", ramp)]).expect("reads");
    let reference = scene.materials[0].normal_texture.expect("a normal map");
    assert_eq!((reference.strength, scene.images.len()), (0.5, 2));
    let ImageData::Rgba8 { texels, .. } = &scene.images[1].data else { panic!("not 8 bits") };
    // The height rises to the right before texel 1: the normal leans left there.
    assert!(texels[0][0] < 128 && texels[2][0] > 128, "{texels:?}");
    assert_eq!(texels[1], [128, 128, 255, 255]);
    let scene = read("newmtl m\nmap_Bump n.png\n", vec![("n.png", flat)]).expect("reads");
    assert!(scene.materials[0].normal_texture.is_some());
    assert_eq!(scene.images.len(), 1);
}

#[test]
fn missing_pictures_are_warned_of_once() {
    let scene =
        read("newmtl m\nmap_Kd no.png\nnewmtl n\nmap_Kd no.png\nrefl -type sphere x.png\n", Vec::new())
            .expect("reads");
    let warnings: Vec<&str> = scene.warnings.iter().map(|w| w.0.as_str()).collect();
    assert_eq!(warnings, ["a.mtl:5:1: \"refl\" is passed over", "texture left out: no.png: is not there"]);
}

#[test]
fn malformed_libraries_are_refused_where_they_err() {
    for (library, expected) in [
        ("Kd 1 1 1\n", "a.mtl:1:1: a material begins with \"newmtl\""),
        ("newmtl m\nKd 1 x 1\n", "a.mtl:2:6: expected a colour's second part, found \"x\""),
        ("newmtl m\nKd 1 1\n", "a.mtl:2:7: expected a colour's third part, found the end of the line"),
        ("newmtl m\nNs nan\n", "a.mtl:2:4: expected the exponent, found \"nan\""),
        ("newmtl m\nillum x\n", "a.mtl:2:7: expected the number of an illumination model, found \"x\""),
        (
            "newmtl m\nmap_Kd -s 1 1 1\n",
            "a.mtl:2:16: expected the name of a picture, found the end of the line",
        ),
    ] {
        assert_eq!(read(library, Vec::new()).expect_err(library).to_string(), expected);
    }
}
