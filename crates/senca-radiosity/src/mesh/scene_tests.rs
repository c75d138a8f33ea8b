//! What scenes become: paint, insides, odd input.

use senca_math::glam::{DMat4, Vec2, Vec3, Vec4};
use senca_scene::{
    AlphaMode, Attenuation, Camera, CameraId, Filter, ImageData, ImageId, Light, LightId, LightKind,
    Material, MetallicRoughness, Node, Phong, Projection, Reflection, Scene, Shape, Surface, Texture,
    TextureId, TextureImage, TextureRef, Transform, Wrap,
};

use super::*;

fn mesh_of(scene: &Scene) -> ElementMesh {
    ElementMesh::of_scene(scene, &MeshSettings::default()).expect("a mesh")
}

fn phong(diffuse: f32) -> Reflection {
    Reflection::Phong(Phong { diffuse: LinearRgb::splat(diffuse), ..Phong::default() })
}

fn two_sided() -> Material {
    Material { double_sided: true, ..Material::default() }
}

fn place(scene: &mut Scene, node: Node, at: DVec3) {
    let transform = Transform::Matrix(DMat4::from_translation(at));
    let id = scene.add_node(Node { transform, ..node });
    scene.roots.push(id);
}

/// A cube of two sides.
fn cube() -> Scene {
    let mut scene = Scene::of_shape("cube", Shape::Box { size: DVec3::ONE });
    scene.geometries[0].material = Some(scene.add_material(two_sided()));
    scene
}

/// A strip of unit squares along x with texture coordinates that run along it.
fn strip(squares: u32) -> senca_scene::Mesh {
    let mut mesh = senca_scene::Mesh { surfaces: vec![Surface::default()], ..Default::default() };
    for i in 0..=squares {
        for y in 0..2 {
            mesh.points.push(Vec3::new(i as f32, y as f32, 0.0));
            mesh.vertices.point.push(2 * i + y);
            mesh.vertices.normal.push(Vec3::Z);
            mesh.vertices.texcoord0.push(Vec2::new(i as f32 / squares as f32, y as f32));
        }
    }
    for i in 0..squares {
        mesh.faces.push(&[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1], 0);
    }
    mesh
}

/// A strip with a picture of these grey levels, side by side.
fn pictured(squares: u32, texels: &[f32], material: impl FnOnce(TextureRef) -> Material) -> Scene {
    let mut scene = Scene::of_shape("strip", Shape::Mesh(strip(squares)));
    let texels: Vec<[f32; 4]> = texels.iter().map(|&v| [v, v, v, 1.0]).collect();
    let data = ImageData::RgbaF32 { width: texels.len() as u32, height: 1, texels };
    scene.images.push(TextureImage { name: String::new(), data });
    scene.textures.push(Texture {
        name: String::new(),
        image: ImageId(0),
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        filter: Filter::Nearest,
    });
    scene.geometries[0].material = Some(scene.add_material(material(TextureRef::new(TextureId(0)))));
    scene
}

fn textured(texture: TextureRef) -> Material {
    let phong = Phong { diffuse: LinearRgb::splat(0.8), texture: Some(texture), ..Phong::default() };
    Material { reflection: Reflection::Phong(phong), ..Material::default() }
}

#[test]
fn polygons_have_the_mean_of_their_part_of_a_picture() {
    let mesh = mesh_of(&pictured(2, &[1.0, 0.5, 0.25, 0.0], textured));
    let found = [0, 1].map(|polygon| mesh.surface(polygon).reflectance.g);
    assert!((found[0] - 0.6).abs() < 1e-6 && (found[1] - 0.1).abs() < 1e-6, "{found:?}");
    let mesh = mesh_of(&pictured(1, &[1.0, 0.5, 0.25, 0.0], textured));
    assert!((mesh.surface(0).reflectance.r - 0.35).abs() < 1e-6);
}

#[test]
fn pictures_of_own_light_count_too() {
    let shining = |texture| Material {
        emission: LinearRgb::splat(8.0),
        emission_texture: Some(texture),
        ..Material::default()
    };
    let mesh = mesh_of(&pictured(2, &[1.0, 0.0], shining));
    assert_eq!([0, 1].map(|polygon| mesh.surface(polygon).emission.b), [8.0, 0.0]);
}

#[test]
fn colours_of_vertices_are_mixed() {
    let mut strip = strip(1);
    strip.vertices.color = [1.0, 1.0, 0.0, 0.0].map(|c| Vec4::new(c, 1.0, c, 1.0)).to_vec();
    let mut scene = Scene::of_shape("strip", Shape::Mesh(strip));
    scene.geometries[0].material = Some(scene.add_material(Material::default()));
    let found = mesh_of(&scene).surface(0).reflectance;
    assert!((found.r - 0.4).abs() < 1e-5 && (found.g - 0.8).abs() < 1e-5, "{found:?}");
}

#[test]
fn materials_keep_what_is_matt_of_them() {
    let of = |material: Material| {
        let mut scene = Scene::of_shape("square", Shape::Plane { size: Some(1.0) });
        scene.geometries[0].material = Some(scene.add_material(material));
        *mesh_of(&scene).surface(0)
    };
    let base = Material { reflection: phong(0.6), ..Material::default() };
    let rough = |metallic| MetallicRoughness {
        base_color: LinearRgb::splat(0.5),
        metallic,
        ..MetallicRoughness::default()
    };
    let with = |metallic| Material {
        reflection: Reflection::MetallicRoughness(rough(metallic)),
        ..Material::default()
    };
    assert_eq!(of(base.clone()).reflectance, LinearRgb::splat(0.6));
    assert!((of(with(0.0)).reflectance.r - 0.48).abs() < 1e-6);
    assert_eq!(of(with(1.0)).reflectance, LinearRgb::BLACK);
    // Twice 0.6 is more than all light.
    let shiny = Phong { diffuse: LinearRgb::splat(0.6), specular: LinearRgb::splat(0.6), ..Phong::default() };
    let shiny = of(Material { reflection: Reflection::Phong(shiny), ..Material::default() });
    assert!((shiny.reflectance.r - 0.5).abs() < 1e-6);
    let unlit = of(Material { unlit: true, ..base.clone() });
    assert_eq!((unlit.reflectance, unlit.emission), (LinearRgb::BLACK, LinearRgb::splat(0.6)));
    let veil = Phong { diffuse: LinearRgb::splat(0.6), alpha: 0.25, ..Phong::default() };
    let veil = Material { reflection: Reflection::Phong(veil), ..Material::default() };
    let blended = of(Material { alpha_mode: AlphaMode::Blend, ..veil.clone() });
    assert_eq!((blended.reflectance.r, blended.transmittance.r), (0.15, 0.75));
    let hole = of(Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..veil.clone() });
    assert_eq!((hole.reflectance.r, hole.transmittance.r), (0.0, 1.0));
    assert_eq!(of(veil).transmittance, LinearRgb::BLACK);
    let glass = of(Material { transmission: LinearRgb::splat(0.9), reflection: phong(0.0), ..base });
    assert_eq!((glass.reflectance.r, glass.transmittance.r), (0.0, 0.9));
}

#[test]
fn one_sided_light_shines_to_one_side() {
    let mut scene = Scene::of_shape("square", Shape::Plane { size: Some(1.0) });
    let material = Material { emission: LinearRgb::WHITE, ..Material::default() };
    scene.geometries[0].material = Some(scene.add_material(material));
    let settings = MeshSettings { sides: Sides::Both, ..MeshSettings::default() };
    let mesh = ElementMesh::of_scene(&scene, &settings).expect("a mesh");
    let shines = |polygon: u32| mesh.surface(polygon).emission.r;
    assert_eq!((mesh.surface(0).back, shines(0), mesh.surface(1).back, shines(1)), (false, 1.0, true, 0.0));
}

#[test]
fn the_inside_of_a_closed_body_takes_no_part() {
    assert_eq!(mesh_of(&cube()).polygons().len(), 6);
    let mut standing = cube();
    let floor = standing.add_geometry(senca_scene::Geometry {
        name: "floor".to_owned(),
        shape: Shape::Plane { size: Some(5.0) },
        material: Some(senca_scene::MaterialId(0)),
    });
    place(&mut standing, Node { geometry: Some(floor), ..Node::default() }, DVec3::Y * -0.5);
    assert_eq!(mesh_of(&standing).polygons().len(), 8, "the floor has two sides, the cube has one");
}

#[test]
fn an_inside_where_something_shines_or_looks_takes_part() {
    let light = Light {
        name: String::new(),
        color: LinearRgb::WHITE,
        attenuation: Attenuation::None,
        kind: LightKind::Point,
    };
    for (at, polygons) in [(DVec3::ZERO, 12), (DVec3::X, 6)] {
        let mut lit = cube();
        lit.lights.push(light.clone());
        place(&mut lit, Node { light: Some(LightId(0)), ..Node::default() }, at);
        assert_eq!(mesh_of(&lit).polygons().len(), polygons, "light at {at}");
        let mut watched = cube();
        watched.cameras.push(Camera::new(
            "",
            Projection::Perspective { yfov: 1.0, aspect: None, near: None, far: None },
        ));
        place(&mut watched, Node { camera: Some(CameraId(0)), ..Node::default() }, at);
        assert_eq!(mesh_of(&watched).polygons().len(), polygons, "camera at {at}");
        let mut furnished = cube();
        let thing = senca_scene::Geometry {
            name: "thing".to_owned(),
            shape: Shape::Box { size: DVec3::splat(0.1) },
            material: Some(senca_scene::MaterialId(0)),
        };
        let thing = furnished.add_geometry(thing);
        place(&mut furnished, Node { geometry: Some(thing), ..Node::default() }, at);
        assert_eq!(mesh_of(&furnished).polygons().len(), polygons + 6, "a thing at {at}");
    }
    let mut open = cube();
    open.geometries[0].shape = Shape::Cylinder { radius: 1.0, height: 1.0, capped: false };
    assert!(mesh_of(&open).surfaces().iter().any(|surface| surface.back));
    let mut glowing = cube();
    glowing.materials[0].emission = LinearRgb::WHITE;
    assert_eq!(mesh_of(&glowing).polygons().len(), 12);
}

#[test]
fn odd_polygons_are_left_out_with_a_warning() {
    let mut mesh = strip(2);
    mesh.points.extend([Vec3::new(9.0, 0.0, 0.0), Vec3::splat(f32::NAN)]);
    for point in [6, 7] {
        mesh.vertices.point.push(point);
        mesh.vertices.normal.push(Vec3::Z);
        mesh.vertices.texcoord0.push(Vec2::ZERO);
    }
    // On one line, not finite, there already, and the other way round.
    for face in [&[0, 2, 6][..], &[0, 2, 7], &[2, 3, 1, 0], &[1, 3, 2, 0]] {
        mesh.faces.push(face, 0);
    }
    let mut scene = Scene::of_shape("odd", Shape::Mesh(mesh));
    scene.geometries[0].material = Some(scene.add_material(Material::default()));
    let (mesh, warnings) =
        ElementMesh::of_scene_with_warnings(&scene, &MeshSettings::default()).expect("a mesh");
    assert_eq!(mesh.polygons().len(), 3);
    let text: Vec<&str> = warnings.iter().map(|warning| &*warning.0).collect();
    assert_eq!(
        text,
        [
            "2 polygons without area, or with corners that are not finite, are left out of the mesh",
            "1 polygons that coincide with others are left out of the mesh"
        ]
    );
}

#[test]
fn endless_planes_reach_beyond_the_scene() {
    let mut scene = cube();
    let plane = senca_scene::Geometry {
        name: "plane".to_owned(),
        shape: Shape::Plane { size: None },
        material: Some(senca_scene::MaterialId(0)),
    };
    let plane = scene.add_geometry(plane);
    place(&mut scene, Node { geometry: Some(plane), ..Node::default() }, DVec3::new(20.0, -0.5, 0.0));
    let bounds = mesh_of(&scene).bounds();
    assert!(bounds.min.x < -1.0 && bounds.max.x > 30.0 && bounds.diagonal() < 200.0, "{bounds:?}");
}

#[test]
fn sheets_with_three_faces_at_an_edge_are_fine() {
    let mut mesh = strip(1);
    mesh.points.push(Vec3::new(0.5, 0.5, 1.0));
    mesh.vertices.point.push(4);
    mesh.vertices.normal.push(Vec3::Z);
    mesh.vertices.texcoord0.push(Vec2::ZERO);
    mesh.faces.push(&[0, 2, 4], 0);
    mesh.faces.push(&[2, 0, 4], 0);
    let mut scene = Scene::of_shape("sheets", Shape::Mesh(mesh));
    scene.geometries[0].material = Some(scene.add_material(two_sided()));
    let mesh = mesh_of(&scene);
    assert_eq!(mesh.polygons().len(), 4, "the third sheet is the back of the second");
}
