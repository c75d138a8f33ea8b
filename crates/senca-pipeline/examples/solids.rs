//! Draws a few solids in one of the shadings and writes a PNG file.
//!
//! `cargo run --release -p senca-pipeline --example solids -- phong 640 480 out.png`

#![expect(clippy::print_stdout, reason = "an example tells what it did")]

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

use senca_math::glam::{DMat4, DVec2, DVec3, DVec4};
use senca_math::{Image, LinearRgb, View};
use senca_pipeline::{Settings, Shading, render};
use senca_scene::{
    AlphaMode, Attenuation, Background, Filter, Geometry, ImageData, ImageId, Light, LightId, LightKind,
    Material, MetallicRoughness, Node, Phong, Reflection, Scene, Shape, Texture, TextureId, TextureImage,
    TextureRef, Transform, Wrap,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or_else(|| default.to_owned());
    let shading = match argument(0, "material").as_str() {
        "wire" => Shading::Wire,
        "normals" => Shading::WireNormals,
        "hidden" => Shading::HiddenLine,
        "flat" => Shading::Flat,
        "gouraud" => Shading::Gouraud,
        "phong" => Shading::Phong,
        _ => Shading::Material,
    };
    let (width, height) = (argument(1, "640").parse()?, argument(2, "480").parse()?);
    let samples = argument(4, "1").parse()?;

    let scene = solids();
    let eye = DVec3::new(3.0, 4.0, 9.0);
    let world_from_camera = View::look_at(eye, DVec3::new(0.0, 0.7, 0.0), DVec3::Y)?;
    let aspect = f64::from(width) / f64::from(height);
    let view = View::perspective(&world_from_camera, 0.6, aspect, 1.0, Some(40.0))?;
    let settings = Settings { shading, samples, ..Settings::default() };
    let mut image = Image::new(width, height, [0.0; 4]);
    let report = render(&scene, &view, &settings, &mut image)?;
    write(&image, &argument(3, "out.png"))?;
    println!("{report:#?}");
    Ok(())
}

/// A red plastic sphere, a gold torus, a chequered box, a glass cone and a cylinder on a plane.
fn solids() -> Scene {
    let mut scene = Scene {
        ambient: LinearRgb::splat(0.15),
        background: Background::Gradient {
            bottom: LinearRgb::new(0.5, 0.5, 0.5),
            top: LinearRgb::new(0.1, 0.2, 0.5),
        },
        ..Scene::default()
    };
    chequers(&mut scene);
    let red =
        Phong { specular: LinearRgb::splat(0.6), exponent: 40.0, ..matte(LinearRgb::new(0.7, 0.05, 0.03)) };
    let glass = Phong { alpha: 0.35, specular: LinearRgb::WHITE, ..matte(LinearRgb::new(0.1, 0.4, 0.3)) };
    let chequered = Phong { texture: Some(TextureRef::new(TextureId(0))), ..matte(LinearRgb::splat(0.9)) };
    let gold = MetallicRoughness {
        base_color: LinearRgb::new(1.0, 0.7, 0.3),
        roughness: 0.35,
        ..MetallicRoughness::default()
    };
    add(&mut scene, Shape::Plane { size: Some(12.0) }, DVec3::ZERO, phong(chequered.clone()));
    add(&mut scene, Shape::Sphere { radius: 1.0 }, DVec3::new(-1.8, 1.0, 0.5), phong(red));
    let torus = Shape::Torus { major_radius: 0.9, minor_radius: 0.35 };
    let metal = Material { reflection: Reflection::MetallicRoughness(gold), ..Material::default() };
    add(&mut scene, torus, DVec3::new(0.8, 0.35, 1.2), metal);
    let size = DVec3::splat(1.4);
    add(&mut scene, Shape::Box { size }, DVec3::new(2.2, 0.7, -1.2), phong(chequered));
    let cone = Shape::Cone { radius: 0.8, top_radius: 0.0, height: 1.8, capped: true };
    let clear = Material { alpha_mode: AlphaMode::Blend, double_sided: true, ..phong(glass) };
    add(&mut scene, cone, DVec3::new(-0.4, 0.02, 3.0), clear);
    let cylinder = Shape::Cylinder { radius: 0.5, height: 2.0, capped: true };
    add(&mut scene, cylinder, DVec3::new(0.2, 0.0, -1.5), phong(matte(LinearRgb::new(0.1, 0.3, 0.7))));
    lamp(&mut scene, LightKind::Parallel, DVec3::new(4.0, 6.0, 5.0), 0.7);
    lamp(&mut scene, LightKind::Parallel, DVec3::new(-5.0, 3.0, 2.0), 0.3);
    scene
}

fn matte(color: LinearRgb) -> Phong {
    Phong { ambient: color, diffuse: color, ..Phong::default() }
}

fn phong(phong: Phong) -> Material {
    Material { reflection: Reflection::Phong(phong), ..Material::default() }
}

fn add(scene: &mut Scene, shape: Shape, place: DVec3, material: Material) {
    let material = scene.add_material(material);
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: Some(material) });
    let transform = Transform::Matrix(DMat4::from_translation(place));
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

/// A light at `from` that shines towards the origin.
fn lamp(scene: &mut Scene, kind: LightKind, from: DVec3, intensity: f32) {
    let z = from.normalize();
    let x = DVec3::Y.cross(z).normalize();
    let frame = DMat4::from_cols(x.extend(0.0), z.cross(x).extend(0.0), z.extend(0.0), DVec4::W);
    let transform = Transform::Matrix(DMat4::from_translation(from) * frame);
    let color = LinearRgb::splat(intensity);
    scene.lights.push(Light { name: String::new(), color, attenuation: Attenuation::None, kind });
    let light = Some(LightId(scene.lights.len() as u32 - 1));
    let node = scene.add_node(Node { light, transform, ..Node::default() });
    scene.roots.push(node);
}

/// A chequered texture of 8 x 8 fields.
fn chequers(scene: &mut Scene) {
    let size = 128;
    let texel = |i: u32| {
        let field = DVec2::new(f64::from(i % size), f64::from(i / size)) / 16.0;
        let dark = (field.x as u32 + field.y as u32).is_multiple_of(2);
        if dark { [90, 90, 100, 255] } else { [240, 240, 230, 255] }
    };
    let texels = (0..size * size).map(texel).collect();
    let data = ImageData::Rgba8 { width: size, height: size, texels };
    scene.images.push(TextureImage { name: "chequers".to_owned(), data });
    scene.textures.push(Texture {
        name: String::new(),
        image: ImageId(0),
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        filter: Filter::Trilinear,
    });
}

fn write(image: &Image, path: &str) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), image.width(), image.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let bytes: Vec<u8> = image
        .pixels()
        .iter()
        .flat_map(|&[r, g, b, a]| {
            let c = LinearRgb::new(r, g, b).to_srgb8();
            [c.r, c.g, c.b, (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
        })
        .collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
