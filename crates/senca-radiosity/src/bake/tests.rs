use senca_math::glam::DVec3;
use senca_scene::{Geometry, Node};

use super::*;
use crate::display::Interpolation;
use crate::{ElementMesh, MeshSettings};

/// A room corner: floor and wall, lit by a value for each element.
fn scene() -> Scene {
    let mut scene = Scene::of_shape("box", Shape::Box { size: DVec3::new(2.0, 1.0, 1.5) });
    let phong = Phong { diffuse: LinearRgb::new(0.5, 0.25, 0.125), ..Phong::default() };
    let material = Material { reflection: Reflection::Phong(phong), ..Material::default() };
    let material = scene.add_material(material);
    scene.geometries[0].material = Some(material);
    let glow = Material { emission: LinearRgb::splat(0.5), ..Material::default() };
    let glow = scene.add_material(glow);
    let shape = Shape::Disc { radius: 0.5, inner_radius: 0.0 };
    let geometry = scene.add_geometry(Geometry { name: "lamp".into(), shape, material: Some(glow) });
    let node = scene.add_node(Node { geometry: Some(geometry), ..Node::default() });
    scene.roots.push(node);
    scene
}

fn mesh(scene: &Scene) -> ElementMesh {
    let settings = MeshSettings { patch_size: Some(0.5), ..MeshSettings::default() };
    ElementMesh::of_scene(scene, &settings).expect("a mesh")
}

#[test]
fn colours_of_vertices_are_what_is_shown() {
    let scene = scene();
    let mesh = mesh(&scene);
    let light = vec![LinearRgb::splat(0.5); mesh.elements().len()];
    let field = LightField::new(&mesh, light, Interpolation::Smooth);
    let baked = bake_vertex_colors(&scene, &field);
    assert!(baked.validate().is_ok());
    let Shape::Mesh(shown) = &baked.geometries[0].shape else { panic!("a mesh") };
    let near = |color: &Vec4, rgb: [f32; 3]| (color.truncate() - glam(rgb)).length() < 1e-5;
    let (painted, glowing): (Vec<&Vec4>, Vec<&Vec4>) =
        shown.vertices.color.iter().partition(|color| near(color, [0.25, 0.125, 0.0625]));
    assert!(painted.len() > 20 && !glowing.is_empty());
    assert!(glowing.iter().all(|color| near(color, [0.9, 0.9, 0.9])), "0.5 + 0.8 * 0.5");
    assert!(baked.materials.iter().all(|material| material.unlit));
}

fn glam([x, y, z]: [f32; 3]) -> senca_math::glam::Vec3 {
    senca_math::glam::Vec3::new(x, y, z)
}

#[test]
fn a_lightmap_is_the_picture_of_what_is_shown() {
    let scene = scene();
    let mesh = mesh(&scene);
    let light = vec![LinearRgb::splat(0.5); mesh.elements().len()];
    let field = LightField::new(&mesh, light, Interpolation::Smooth);
    let finder = ElementFinder::new(&mesh).expect("a finder");
    let baked = bake_lightmap(&scene, &field, &finder, 64).expect("room");
    assert!(baked.validate().is_ok());
    let Shape::Mesh(shown) = &baked.geometries[0].shape else { panic!("a mesh") };
    let ImageData::Rgba8 { texels, .. } = &baked.images[0].data else { panic!("8 bits") };
    let known = [LinearRgb::new(0.25, 0.125, 0.0625), LinearRgb::splat(0.9)].map(LinearRgb::to_srgb8);
    for uv in &shown.vertices.texcoord0 {
        let [x, y] = [uv.x, uv.y].map(|v| (v * 64.0) as usize);
        let [r, g, b, _] = texels[y * 64 + x];
        assert!(known.contains(&Srgb8 { r, g, b }), "{r} {g} {b}");
    }
    for side in [0, 8, 1 << 20] {
        assert!(bake_lightmap(&scene, &field, &finder, side).is_err(), "{side}");
    }
}
