//! What is written reads back the same.

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{DMat4, DQuat, DVec3, Mat3, Vec2, Vec3, Vec4};
use senca_scene::{
    AlphaMode, Animation, Attenuation, Background, Camera, CameraId, Channel, ChannelTarget, ChannelValues,
    Filter, Fog, FogFalloff, Geometry, GeometryId, ImageData, ImageId, Interpolation, JointInfluence, Light,
    LightId, LightKind, Material, MaterialId, Mesh, MetallicRoughness, MorphTarget, Node, NodeId, Phong,
    Projection, Reflection, Scene, Shape, Skin, SkinId, SpotFalloff, Surface, Texture, TextureId,
    TextureImage, TextureRef, Transform, Vertices, Warning, Wrap,
};

use super::{first_mesh, warnings};
use crate::NoFiles;
use crate::gltf::{WriteSettings, read, write_glb, write_gltf};

fn written(scene: &Scene) -> (Vec<u8>, Vec<Warning>) {
    let mut warnings = Vec::new();
    let bytes = write_glb(scene, &WriteSettings::default(), &mut warnings).expect("a sound scene");
    (bytes, warnings)
}

fn read_back(scene: &Scene) -> Scene {
    read("written.glb", &written(scene).0, &NoFiles).expect("what was written is sound")
}

/// Two triangles with everything a mesh can have, lines and dots.
fn full_mesh() -> Mesh {
    let influence = JointInfluence { joints: [1, 0, 0, 0], weights: [0.75, 0.25, 0.0, 0.0] };
    Mesh {
        points: vec![Vec3::ZERO, Vec3::X, Vec3::new(1., 1., 0.), Vec3::Y],
        vertices: Vertices {
            point: vec![0, 1, 2, 3],
            normal: vec![Vec3::Z; 4],
            texcoord0: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            texcoord1: vec![Vec2::splat(0.1); 4],
            color: vec![Vec4::new(0.1, 0.2, 0.3, 0.4); 4],
            tangent: vec![Vec4::new(1., 0., 0., -1.); 4],
        },
        faces: senca_scene::Faces {
            corners: vec![0, 1, 2, 0, 2, 3],
            starts: Vec::new(),
            surface: vec![0, 1],
        },
        surfaces: vec![
            Surface { material: Some(MaterialId(0)), ..Surface::default() },
            Surface { material: Some(MaterialId(1)), ..Surface::default() },
        ],
        lines: vec![[0, 1], [3, 2]],
        dots: vec![2],
        morph_targets: vec![
            MorphTarget {
                name: "a".into(),
                points: vec![Vec3::splat(0.5); 4],
                normals: vec![Vec3::X; 4],
                tangents: vec![Vec3::Y; 4],
            },
            MorphTarget { name: "b".into(), points: vec![Vec3::splat(-0.5); 4], ..MorphTarget::default() },
        ],
        joints: vec![influence; 4],
    }
}

fn materials() -> Vec<Material> {
    let turned = Mat3::from_translation(Vec2::new(0.5, 0.25)) * Mat3::from_scale(Vec2::new(2.0, -3.0));
    let texture = TextureRef { texcoord: 1, uv_transform: turned, ..TextureRef::new(TextureId(0)) };
    let data = TextureRef { strength: 0.5, ..TextureRef::new(TextureId(1)) };
    let full = Material {
        name: "full".into(),
        reflection: Reflection::MetallicRoughness(MetallicRoughness {
            base_color: LinearRgb::new(0.1, 0.2, 0.5),
            alpha: 0.3,
            metallic: 0.25,
            roughness: 0.7,
            base_color_texture: Some(texture),
            metallic_roughness_texture: Some(TextureRef::new(TextureId(1))),
        }),
        emission: LinearRgb::new(7.3, 0.1, 0.0),
        emission_texture: Some(texture),
        normal_texture: Some(data),
        occlusion_texture: Some(data),
        alpha_mode: AlphaMode::Mask { cutoff: 0.4 },
        double_sided: true,
        unlit: true,
        ior: 1.33,
        ..Material::default()
    };
    let reflection = Reflection::MetallicRoughness(MetallicRoughness::default());
    let plain = Material { reflection, alpha_mode: AlphaMode::Blend, ..Material::default() };
    vec![full, plain]
}

fn full_scene() -> Scene {
    let texture = |name: &str, image| Texture {
        name: name.into(),
        image: ImageId(image),
        wrap_u: Wrap::Mirror,
        wrap_v: Wrap::Clamp,
        filter: Filter::Bilinear,
    };
    let picture = |texels: Vec<[u8; 4]>| ImageData::Rgba8 { width: 2, height: 1, texels };
    let times = vec![0.0, 0.5, 2.0];
    let channel = |node, values, interpolation| Channel {
        target: ChannelTarget { node: NodeId(node) },
        times: times.clone(),
        values,
        interpolation,
    };
    Scene {
        name: "all".into(),
        nodes: vec![
            Node {
                name: "root".into(),
                transform: Transform::Parts {
                    translation: DVec3::new(0.1, 0.2, 1.0 / 3.0),
                    rotation: DQuat::from_axis_angle(DVec3::Y, 0.3),
                    scale: DVec3::new(1.0, 2.0, 0.7),
                },
                children: vec![NodeId(1), NodeId(2)],
                ..Node::default()
            },
            Node {
                geometry: Some(GeometryId(0)),
                skin: Some(SkinId(0)),
                morph_weights: vec![0.25, 0.75],
                ..Node::default()
            },
            Node {
                transform: Transform::Matrix(DMat4::from_translation(DVec3::new(0.3, 0.7, -1e-7))),
                camera: Some(CameraId(1)),
                light: Some(LightId(2)),
                ..Node::default()
            },
            Node {
                name: "not shown".into(),
                geometry: Some(GeometryId(0)),
                morph_weights: vec![0.0; 2],
                ..Node::default()
            },
        ],
        roots: vec![NodeId(0)],
        geometries: vec![Geometry { name: "mesh".into(), shape: Shape::Mesh(full_mesh()), material: None }],
        materials: materials(),
        textures: vec![texture("first", 0), texture("second", 1)],
        images: vec![
            TextureImage { name: "colour".into(), data: picture(vec![[1, 2, 3, 4], [250, 0, 9, 255]]) },
            TextureImage { name: "data".into(), data: picture(vec![[128, 128, 255, 255]; 2]) },
        ],
        lights: lights(),
        cameras: cameras(),
        skins: vec![Skin {
            name: "bones".into(),
            joints: vec![NodeId(0), NodeId(2)],
            inverse_bind_matrices: vec![DMat4::IDENTITY, DMat4::from_translation(DVec3::new(1., 2., 3.))],
        }],
        animations: vec![Animation {
            name: "move".into(),
            channels: vec![
                channel(
                    0,
                    ChannelValues::Translation(vec![DVec3::X, DVec3::Y, DVec3::Z]),
                    Interpolation::Linear,
                ),
                channel(0, ChannelValues::Rotation(vec![DQuat::IDENTITY; 3]), Interpolation::Step),
                channel(0, ChannelValues::Scale(vec![DVec3::splat(0.5); 9]), Interpolation::CubicSpline),
                channel(1, ChannelValues::Weights { count: 2, values: vec![0.5; 6] }, Interpolation::Linear),
            ],
        }],
        ..Scene::default()
    }
}

fn lights() -> Vec<Light> {
    let color = LinearRgb::new(683.2, 41.7, 0.3);
    let light = |name: &str, kind, attenuation| Light { name: name.into(), color, attenuation, kind };
    let spot = LightKind::Spot(SpotFalloff::Smooth { inner: 0.1, outer: 0.3 });
    vec![
        light("sun", LightKind::Parallel, Attenuation::None),
        light("bulb", LightKind::Point, Attenuation::InverseSquare { range: None }),
        light("spot", spot, Attenuation::InverseSquare { range: Some(12.5) }),
    ]
}

fn cameras() -> Vec<Camera> {
    let perspective = Projection::Perspective { yfov: 0.7, aspect: Some(1.3), near: Some(0.1), far: None };
    let parallel =
        Projection::Orthographic { height: 3.0, aspect: Some(2.0), near: Some(0.5), far: Some(9.0) };
    vec![Camera::new("eye", perspective), Camera::new("", parallel)]
}

#[test]
fn a_scene_with_everything_reads_back_the_same() {
    let scene = full_scene();
    let back = read_back(&scene);
    assert!(back.warnings.is_empty(), "{}", warnings(&back));
    assert_eq!(first_mesh(&back), first_mesh(&scene));
    assert_eq!(back.materials, scene.materials);
    assert_eq!((&back.textures, &back.images), (&scene.textures, &scene.images));
    assert_eq!((&back.lights, &back.cameras), (&scene.lights, &scene.cameras));
    assert_eq!((&back.skins, &back.animations), (&scene.skins, &scene.animations));
    assert_eq!(back, scene);
    assert!(written(&scene).1.is_empty());
}

#[test]
fn the_text_form_holds_the_same_and_bytes_repeat() {
    let scene = full_scene();
    let mut warnings = Vec::new();
    let text = write_gltf(&scene, &WriteSettings::default(), &mut warnings).expect("a sound scene");
    assert!(text.starts_with(b"{\n"));
    assert_eq!(read("written.gltf", &text, &NoFiles).expect("sound"), scene);
    assert_eq!(written(&scene).0, written(&full_scene()).0);
}

#[test]
fn flat_meshes_stay_flat_and_quads_become_triangles() {
    let mut mesh = Mesh {
        points: vec![Vec3::ZERO, Vec3::X, Vec3::new(1., 1., 0.), Vec3::Y],
        vertices: Vertices { point: vec![0, 1, 2, 3], ..Vertices::default() },
        surfaces: vec![Surface { smooth: false, ..Surface::default() }],
        ..Mesh::default()
    };
    mesh.faces.push(&[0, 1, 2, 3], 0);
    let back = read_back(&Scene::of_shape("flat", Shape::Mesh(mesh.clone())));
    assert_eq!((first_mesh(&back).faces.len(), first_mesh(&back).points.len()), (2, 4));
    assert!(first_mesh(&back).vertices.normal.is_empty() && !first_mesh(&back).surfaces[0].smooth);
    mesh.surfaces[0].smooth = true;
    let back = read_back(&Scene::of_shape("smooth", Shape::Mesh(mesh)));
    assert_eq!(first_mesh(&back).vertices.normal, [Vec3::Z; 4]);
}

#[test]
fn shapes_are_tessellated() {
    let scene = Scene::of_shape("ball", Shape::Sphere { radius: 2.0 });
    let back = read_back(&scene);
    let mesh = first_mesh(&back);
    assert!(mesh.faces.len() > 100 && mesh.points.iter().all(|p| (p.length() - 2.0).abs() < 1e-5));
    let broken = Scene::of_shape("ball", Shape::Sphere { radius: -1.0 });
    let error = write_glb(&broken, &WriteSettings::default(), &mut Vec::new()).expect_err("a bad radius");
    assert!(error.to_string().contains("\"ball\"") && error.to_string().contains("radius"), "{error}");
}

#[test]
fn node_materials_make_copies_of_the_mesh() {
    let mut mesh = full_mesh();
    mesh.surfaces[1].material = None;
    let mut scene = Scene::of_shape("twice", Shape::Mesh(mesh));
    scene.materials = materials();
    scene.textures = full_scene().textures;
    scene.images = full_scene().images;
    for material in [Some(MaterialId(1)), Some(MaterialId(0)), Some(MaterialId(1))] {
        let node = scene.add_node(Node { geometry: Some(GeometryId(0)), material, ..Node::default() });
        scene.roots.push(node);
    }
    let back = read_back(&scene);
    assert_eq!(back.geometries.len(), 3);
    let geometries: Vec<_> = back.nodes.iter().map(|n| n.geometry.map(|g| g.0)).collect();
    assert_eq!(geometries, [Some(0), Some(2), Some(1), Some(2)]);
    let Shape::Mesh(copy) = &back.geometries[2].shape else { panic!("a mesh") };
    assert_eq!(copy.surfaces[0].material, Some(MaterialId(0)), "its own stays");
    assert_eq!(copy.surfaces[1].material, Some(MaterialId(1)));
}

#[test]
fn what_gltf_cannot_hold_is_told() {
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    scene.ambient = LinearRgb::WHITE;
    scene.background = Background::Color(LinearRgb::WHITE);
    scene.fog = Some(Fog { color: LinearRgb::WHITE, falloff: FogFalloff::Exponential { density: 1.0 } });
    scene.lights.push(Light {
        name: "lamp".into(),
        color: LinearRgb::WHITE,
        attenuation: Attenuation::None,
        kind: LightKind::Area { size: [1.0, 1.0], visible: true },
    });
    let phong = Phong { specular: LinearRgb::WHITE, exponent: 30.0, ..Phong::default() };
    scene.materials.push(Material {
        reflection: Reflection::Phong(phong),
        mirror: LinearRgb::splat(0.5),
        ..Material::default()
    });
    let (bytes, warnings) = written(&scene);
    let said: Vec<&str> = warnings.iter().map(|w| w.0.as_str()).collect();
    assert_eq!(said.len(), 5, "{said:?}");
    let back = read("b.glb", &bytes, &NoFiles).expect("sound");
    assert!(back.lights.is_empty());
    let nearest = Reflection::MetallicRoughness(scene.materials[0].to_metallic_roughness());
    assert_eq!(back.materials[0].reflection, nearest);
}

/// glTF's parallel cameras see nothing behind them, so the camera steps back in a node of its own.
#[test]
fn parallel_cameras_that_see_behind_themselves_step_back() {
    let mut scene = full_scene();
    scene.cameras[1].projection =
        Projection::Orthographic { height: 3.0, aspect: Some(2.0), near: Some(-1.0), far: Some(9.0) };
    let back = read_back(&scene);
    let expected =
        Projection::Orthographic { height: 3.0, aspect: Some(2.0), near: Some(0.0), far: Some(10.0) };
    assert_eq!(back.cameras[1].projection, expected);
    let (i, node) = back.nodes.iter().enumerate().find(|(_, n)| n.camera.is_some()).expect("a camera's node");
    assert_eq!(node.transform.matrix(), DMat4::from_translation(DVec3::Z));
    assert_eq!(back.nodes[2].children, [NodeId(i as u32)]);
}

#[test]
fn paths_are_written_as_places_along_them() {
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    let points = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, 3.0 * DVec3::X];
    let values = ChannelValues::Path { points, parameters: vec![0.0, 1.0], look_ahead: true };
    let target = ChannelTarget { node: NodeId(0) };
    let channel = Channel { target, times: vec![0.0, 4.0], values, interpolation: Interpolation::Linear };
    scene.animations.push(Animation { name: String::new(), channels: vec![channel] });
    let back = read_back(&scene);
    let [places, turns] = &back.animations[0].channels[..] else { panic!("two channels") };
    let ChannelValues::Translation(at) = &places.values else { panic!("places") };
    assert_eq!((at.len(), places.times[16], at[16]), (33, 2.0, DVec3::new(1.5, 0.0, 0.0)));
    let ChannelValues::Rotation(turns) = &turns.values else { panic!("turns") };
    assert!((turns[7] * DVec3::NEG_Z).abs_diff_eq(DVec3::X, 1e-6));
}

/// Scenes that name what is not there are written without it.
#[test]
fn scenes_that_do_not_hold_together_never_panic() {
    let mut scene = full_scene();
    scene.textures.truncate(1);
    scene.images.clear();
    scene.materials.truncate(1);
    scene.lights.clear();
    scene.cameras.clear();
    scene.nodes.truncate(2);
    scene.roots.push(NodeId(77));
    let _ = read("cut.glb", &written(&scene).0, &NoFiles);
    let Shape::Mesh(mesh) = &mut scene.geometries[0].shape else { panic!("a mesh") };
    mesh.faces.corners[0] = 99;
    assert!(write_glb(&scene, &WriteSettings::default(), &mut Vec::new()).is_err());
    assert!(written(&Scene::default()).0.len() > 20);
    assert_eq!(read_back(&Scene::default()), Scene::default());
}
