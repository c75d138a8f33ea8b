//! What is written reads back the same.

use senca_io::ply::PlyEncoding;
use senca_io::stl::StlEncoding;
use senca_io::{Files, Location, NoFiles, ReadError, obj, ply, stl};
use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{DMat4, DVec3, Mat3, Vec2, Vec3, Vec4};
use senca_scene::{
    Geometry, ImageData, ImageId, Material, Mesh, Node, Phong, Reflection, Scene, Shape, Surface,
    TessellationSettings, Texture, TextureId, TextureImage, TextureRef, Transform, Wrap,
};

/// Output files as input files.
struct Output(obj::ObjOutput);

impl Files for Output {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let picture = self.0.pictures.iter().find(|(name, _)| name == uri).map(|(_, bytes)| bytes.clone());
        let found = if uri == "t.mtl" { self.0.mtl.clone() } else { picture };
        found.ok_or_else(|| ReadError::malformed(Location::file(uri), "is not there"))
    }
}

/// A quad and a triangle on two surfaces with a crease, and a line.
fn mesh() -> Mesh {
    let corners = [[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0 / 3.0]];
    let mut mesh = Mesh { points: corners.map(Vec3::from).to_vec(), ..Mesh::default() };
    mesh.vertices.point = vec![0, 1, 2, 3, 0, 1, 4];
    mesh.faces.push(&[0, 1, 2, 3], 0);
    mesh.faces.push(&[4, 5, 6], 1);
    mesh.surfaces = vec![Surface { name: "base".to_owned(), ..Surface::default() }, Surface::default()];
    mesh.surfaces[1].name = "side".to_owned();
    // The numbers that the reader gives to the groups "s 1" and "s 2".
    (mesh.surfaces[0].smoothing_group, mesh.surfaces[1].smoothing_group) = (2, 3);
    mesh.lines = vec![[0, 2]];
    mesh
}

fn only_mesh(scene: &Scene) -> &Mesh {
    match &scene.geometries[..] {
        [Geometry { shape: Shape::Mesh(mesh), .. }] => mesh,
        other => panic!("not one mesh: {other:?}"),
    }
}

fn through_obj(scene: &Scene) -> Scene {
    let output = obj::write(scene, "t", &TessellationSettings::default()).expect("writes");
    let text = output.obj.clone();
    let back = obj::read("t.obj", &text, &Output(output)).expect("reads");
    assert!(back.warnings.is_empty(), "{:?}", back.warnings);
    back
}

#[test]
fn obj_keeps_polygons_surfaces_lines_and_creases() {
    let scene = Scene::of_shape("thing", Shape::Mesh(mesh()));
    let back = through_obj(&scene);
    assert_eq!(only_mesh(&back), &mesh());
    assert_eq!(back.nodes[0].name, "thing");
}

#[test]
fn obj_keeps_surfaces_smooth_together() {
    let mut mesh = mesh();
    for (surface, material) in mesh.surfaces.iter_mut().zip(0..) {
        (surface.smoothing_group, surface.material) = (7, Some(senca_scene::MaterialId(material)));
    }
    let mut scene = Scene::of_shape("thing", Shape::Mesh(mesh));
    for name in ["red", "blue"] {
        scene.add_material(Material { name: name.to_owned(), ..Material::default() });
    }
    let back = through_obj(&scene);
    let groups: Vec<u32> = only_mesh(&back).surfaces.iter().map(|s| s.smoothing_group).collect();
    assert!(groups.len() == 2 && groups[0] == groups[1] && groups[0] != 0, "{groups:?}");
}

#[test]
fn obj_keeps_attributes() {
    let mut mesh = mesh();
    mesh.lines.clear();
    mesh.vertices.normal = vec![Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X, Vec3::X, Vec3::X];
    mesh.vertices.texcoord0 = (0..7).map(|i| Vec2::new(0.125 * i as f32, 0.25)).collect();
    let scene = Scene::of_shape("thing", Shape::Mesh(mesh.clone()));
    assert_eq!(only_mesh(&through_obj(&scene)), &mesh);
    mesh.vertices.color =
        vec![Vec4::ONE, Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::ONE, Vec4::ONE, Vec4::ONE, Vec4::ONE, Vec4::ONE];
    let back = through_obj(&Scene::of_shape("thing", Shape::Mesh(mesh.clone())));
    // Vertices 1 and 5 are one point with two colours: positions are written per vertex.
    assert_eq!(only_mesh(&back).points.len(), 7);
    assert_eq!(only_mesh(&back).vertices.color, mesh.vertices.color);
}

#[test]
fn obj_keeps_materials_and_pictures() {
    let mut scene = Scene::of_shape("thing", Shape::Mesh(mesh()));
    let texels = vec![[1, 2, 3, 255], [4, 5, 6, 128]];
    scene
        .images
        .push(TextureImage { name: String::new(), data: ImageData::Rgba8 { width: 2, height: 1, texels } });
    let (wrap, image) = (Wrap::Clamp, ImageId(0));
    scene.textures.push(Texture {
        name: String::new(),
        image,
        wrap_u: wrap,
        wrap_v: wrap,
        filter: Default::default(),
    });
    let uv_transform =
        Mat3::from_cols(Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0), Vec3::new(0.5, -3.25, 1.0));
    let texture = TextureRef { uv_transform, ..TextureRef::new(TextureId(0)) };
    let phong = Phong {
        ambient: LinearRgb::splat(0.1),
        diffuse: LinearRgb::new(0.2, 0.3, 0.4),
        specular: LinearRgb::splat(0.5),
        exponent: 33.0,
        texture: Some(texture),
        ..Phong::default()
    };
    let reflection = Reflection::Phong(phong.clone());
    scene.add_material(Material {
        name: "dark red".to_owned(),
        reflection,
        ior: 1.33,
        ..Material::default()
    });
    scene.geometries[0].material = Some(senca_scene::MaterialId(0));
    let back = through_obj(&scene);
    let material = &back.materials[0];
    assert_eq!((material.name.as_str(), material.ior), ("dark_red", 1.33));
    assert_eq!(material.reflection, Reflection::Phong(phong));
    assert_eq!(back.images[0].data, scene.images[0].data);
    assert_eq!(back.textures[0].wrap_u, Wrap::Clamp);
}

#[test]
fn placed_shapes_are_written_where_they_stand() {
    let mut scene = Scene::of_shape("box", Shape::Box { size: DVec3::new(2.0, 2.0, 2.0) });
    scene.nodes[0].transform = Transform::Matrix(
        DMat4::from_translation(DVec3::new(10.0, 0.0, 0.0)) * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
    );
    let geometry = scene.nodes[0].geometry;
    let second = scene.add_node(Node { name: "twin".to_owned(), geometry, ..Node::default() });
    scene.roots.push(second);
    let back = through_obj(&scene);
    assert_eq!(back.geometries.len(), 2);
    let Shape::Mesh(moved) = &back.geometries[0].shape else { panic!("not a mesh") };
    assert_eq!((moved.bounds().min.x, moved.bounds().max.x), (9.0, 11.0));
    // The mirrored box still faces outwards.
    for face in moved.faces.iter() {
        let [a, b, c] = [0, 1, 2].map(|i| moved.position(face[i]));
        assert!((b - a).cross(c - a).dot(a - Vec3::new(10.0, 0.0, 0.0)) > 0.0);
    }
}

fn through_stl(scene: &Scene, encoding: StlEncoding) -> Mesh {
    let bytes = stl::write(scene, encoding, &TessellationSettings::default()).expect("writes");
    only_mesh(&stl::read("t.stl", &bytes, &NoFiles).expect("reads")).clone()
}

#[test]
fn stl_keeps_triangles_in_both_encodings() {
    let scene = Scene::of_shape("solid", Shape::Box { size: DVec3::new(1.0, 0.1, 1.0 / 3.0) });
    let binary = through_stl(&scene, StlEncoding::Binary);
    let text = through_stl(&scene, StlEncoding::Text);
    assert_eq!((binary.points.len(), binary.faces.len()), (8, 12));
    assert_eq!(
        (&binary.points, &binary.faces, &binary.vertices),
        (&text.points, &text.faces, &text.vertices)
    );
    assert_eq!(text.surfaces[0].name, "solid");
    let empty =
        stl::write(&Scene::default(), StlEncoding::Text, &TessellationSettings::default()).expect("writes");
    assert!(stl::read("t.stl", &empty, &NoFiles).is_ok());
}

fn through_ply(scene: &Scene, encoding: PlyEncoding) -> Mesh {
    let bytes = ply::write(scene, encoding, &TessellationSettings::default()).expect("writes");
    only_mesh(&ply::read("t.ply", &bytes, &NoFiles).expect("reads")).clone()
}

const ENCODINGS: [PlyEncoding; 3] = [PlyEncoding::LittleEndian, PlyEncoding::BigEndian, PlyEncoding::Text];

#[test]
fn ply_keeps_polygons_points_and_lines() {
    for encoding in ENCODINGS {
        let back = through_ply(&Scene::of_shape("thing", Shape::Mesh(mesh())), encoding);
        assert_eq!(back.points, mesh().points);
        assert_eq!(back.faces.corners, [0, 1, 2, 3, 0, 1, 4]);
        assert_eq!(back.faces.starts, [0, 4, 7]);
        assert_eq!(back.lines, [[0, 2]]);
    }
}

#[test]
fn ply_keeps_attributes() {
    let mut mesh = mesh();
    mesh.vertices.normal = vec![Vec3::Z; 7];
    mesh.vertices.texcoord0 = (0..7).map(|i| Vec2::new(0.125 * i as f32, 0.75)).collect();
    mesh.vertices.color = vec![Vec4::new(1.0, 0.0, 1.0, 1.0); 7];
    for bright in [1.0, 2.5] {
        mesh.vertices.color[3].x = bright;
        for encoding in ENCODINGS {
            let back = through_ply(&Scene::of_shape("thing", Shape::Mesh(mesh.clone())), encoding);
            assert_eq!(back.vertices.normal, mesh.vertices.normal);
            assert_eq!(back.vertices.texcoord0, mesh.vertices.texcoord0);
            assert_eq!(back.vertices.color, mesh.vertices.color);
        }
    }
}

#[test]
fn meshes_that_do_not_hold_together_are_not_written() {
    let mut broken = mesh();
    broken.faces.corners[0] = 99;
    let scene = Scene::of_shape("broken", Shape::Mesh(broken));
    let settings = TessellationSettings::default();
    assert!(obj::write(&scene, "t", &settings).is_err());
    assert!(stl::write(&scene, StlEncoding::Text, &settings).is_err());
    assert!(ply::write(&scene, PlyEncoding::Text, &settings).is_err());
}
