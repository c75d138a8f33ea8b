//! The smallest picture: one triangle, a colour at each corner.
//!
//! `cargo run --example triangle -- triangle.png`

use std::error::Error;

use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::math::glam::{Vec3, Vec4};
use senca::scene::{Faces, Material, Mesh, Scene, Shape, Surface, Vertices};
use senca::{Settings, render};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "triangle.png".into());

    // Three places, and one vertex on each with its colour.
    let mesh = Mesh {
        points: vec![Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.6, 0.0)],
        vertices: Vertices {
            point: vec![0, 1, 2],
            color: vec![
                Vec4::new(1.0, 0.0, 0.0, 1.0),
                Vec4::new(0.0, 1.0, 0.0, 1.0),
                Vec4::new(0.0, 0.0, 1.0, 1.0),
            ],
            ..Vertices::default()
        },
        faces: Faces { corners: vec![0, 1, 2], ..Faces::default() },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    };

    // The colours are shown as they are, without light.
    let mut scene = Scene::of_shape("triangle", Shape::Mesh(mesh));
    let material = scene.add_material(Material { unlit: true, double_sided: true, ..Material::default() });
    scene.geometries[0].material = Some(material);

    // No camera in the scene: it is framed whole.
    let settings = Settings { size: Some([320, 240]), ..Settings::default() };
    let (image, _) = render(&scene, &settings)?;
    let png = encode(&image, PictureFormat::Png, &PictureOptions::default())?;
    senca::io::write_file(path.as_ref(), &png)?;
    Ok(())
}
