use senca_math::glam::{Mat3, Vec3};

use super::*;
use crate::{
    AnimationId, CameraId, ChannelTarget, Faces, Fog, Geometry, GeometryId, ImageId, LightId, MaterialId,
    Mesh, MetallicRoughness, Phong, Skin, SkinId, Surface, Texture, TextureId, TextureImage, Vertices,
};

/// A scene with one of everything, all in order.
fn whole() -> Scene {
    let mesh = Mesh {
        points: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vertices: Vertices { point: vec![0, 1, 2], ..Vertices::default() },
        faces: Faces { corners: vec![0, 1, 2], ..Faces::default() },
        surfaces: vec![Surface { material: Some(MaterialId(0)), ..Surface::default() }],
        ..Mesh::default()
    };
    let mut scene = Scene::default();
    scene.add_geometry(Geometry {
        name: "tri".to_owned(),
        shape: Shape::Mesh(mesh),
        material: Some(MaterialId(1)),
    });
    let texture = Some(TextureRef::new(TextureId(0)));
    let phong = Reflection::Phong(Phong { texture, ..Phong::default() });
    scene.add_material(Material { reflection: phong, ..Material::default() });
    let metal = Reflection::MetallicRoughness(MetallicRoughness::default());
    scene.add_material(Material { reflection: metal, normal_texture: texture, ..Material::default() });
    let data = ImageData::Rgba8 { width: 1, height: 2, texels: vec![[0; 4]; 2] };
    scene.images.push(TextureImage { name: String::new(), data });
    scene.textures.push(Texture {
        name: String::new(),
        image: ImageId(0),
        wrap_u: crate::Wrap::Repeat,
        wrap_v: crate::Wrap::Repeat,
        filter: crate::Filter::Nearest,
    });
    scene.add_light(Light {
        name: String::new(),
        color: LinearRgb::WHITE,
        attenuation: Attenuation::Polynomial { constant: 1.0, linear: 0.0, quadratic: 0.0 },
        kind: LightKind::Spot(SpotFalloff::Smooth { inner: 0.1, outer: 0.2 }),
    });
    let projection = Projection::Perspective { yfov: 1.0, aspect: None, near: Some(1.0), far: Some(2.0) };
    scene.add_camera(Camera::new("", projection));
    scene.skins.push(Skin {
        name: String::new(),
        joints: vec![NodeId(1)],
        inverse_bind_matrices: vec![DMat4::IDENTITY],
    });
    let root = scene.add_node(Node {
        name: "root".to_owned(),
        geometry: Some(GeometryId(0)),
        material: Some(MaterialId(0)),
        light: Some(LightId(0)),
        camera: Some(CameraId(0)),
        skin: Some(SkinId(0)),
        morph_weights: vec![0.5],
        children: vec![NodeId(1)],
        ..Node::default()
    });
    scene.add_node(Node::default());
    scene.roots.push(root);
    scene.animations.push(Animation {
        name: String::new(),
        channels: vec![Channel {
            target: ChannelTarget { node: NodeId(1) },
            times: vec![0.0, 1.0],
            values: ChannelValues::Translation(vec![DVec3::ZERO, DVec3::X]),
            interpolation: Interpolation::Linear,
        }],
    });
    let falloff = FogFalloff::Linear { start: 0.0, end: 1.0, min_share: 0.1 };
    scene.fog = Some(Fog { color: LinearRgb::WHITE, falloff });
    scene
}

fn error(change: impl FnOnce(&mut Scene)) -> String {
    let mut scene = whole();
    assert_eq!(scene.validate(), Ok(()));
    change(&mut scene);
    let message = scene.validate().expect_err("the scene was broken").to_string();
    // What readers live with can be mended, or was not theirs to mend; it never gets worse.
    scene.sanitize();
    scene.sanitize();
    message
}

fn channel(scene: &mut Scene) -> &mut Channel {
    &mut scene.animations[0].channels[0]
}

#[test]
fn indices_that_name_nothing_are_found() {
    type Break = fn(&mut Scene);
    let cases: Vec<(&str, Break)> = vec![
        ("geometry 7", |s| s.nodes[0].geometry = Some(GeometryId(7))),
        ("material 7", |s| s.nodes[0].material = Some(MaterialId(7))),
        ("light 7", |s| s.nodes[0].light = Some(LightId(7))),
        ("camera 7", |s| s.nodes[0].camera = Some(CameraId(7))),
        ("skin 7", |s| s.nodes[0].skin = Some(SkinId(7))),
        ("node 7", |s| s.nodes[0].children.push(NodeId(7))),
        ("node 8", |s| s.roots.push(NodeId(8))),
        ("material 9", |s| s.geometries[0].material = Some(MaterialId(9))),
        ("texture 9", |s| s.materials[0].emission_texture = Some(TextureRef::new(TextureId(9)))),
        ("image 9", |s| s.textures[0].image = ImageId(9)),
        ("node 9", |s| s.skins[0].joints[0] = NodeId(9)),
        ("node 6", |s| channel(s).target.node = NodeId(6)),
    ];
    for (expected, change) in cases {
        let message = error(change);
        assert!(message.contains(expected) && message.contains("only"), "{message}");
    }
    let in_surface = |s: &mut Scene| {
        let Shape::Mesh(mesh) = &mut s.geometries[0].shape else { return };
        mesh.surfaces[0].material = Some(MaterialId(5));
    };
    assert!(error(in_surface).contains("material 5"));
}

#[test]
fn nodes_must_form_trees() {
    assert!(error(|s| s.nodes[1].children.push(NodeId(0))).contains("trees"), "circle through a root");
    assert!(error(|s| s.roots.push(NodeId(1))).contains("trees"), "a root with a parent");
    assert!(error(|s| s.roots.push(NodeId(0))).contains("trees"), "a root twice");
    let apart = |s: &mut Scene| {
        let a = s.add_node(Node::default());
        let b = s.add_node(Node { children: vec![a], ..Node::default() });
        s.nodes[a.index()].children = vec![b];
    };
    assert!(error(apart).contains("trees"), "a circle that no root reaches");
    let mut loose = whole();
    loose.add_node(Node::default());
    assert_eq!(loose.validate(), Ok(()), "nodes that no root reaches are fine");
}

#[test]
fn numbers_out_of_range_are_found() {
    let nan = f64::NAN;
    let broken_transform =
        move |s: &mut Scene| s.nodes[1].transform = Transform::Matrix(DMat4::IDENTITY * nan);
    assert!(error(broken_transform).contains("transform"));
    assert!(error(|s| s.nodes[0].morph_weights[0] = f32::NAN).contains("morph"));
    assert!(error(|s| s.materials[0].emission.g = -1.0).contains("colour"));
    assert!(error(|s| s.materials[0].ior = 0.0).contains("index of refraction"));
    let exponent = |s: &mut Scene| {
        s.materials[0].reflection = Reflection::Phong(Phong { exponent: -1.0, ..Phong::default() })
    };
    assert!(error(exponent).contains("exponent is -1"));
    let rough = |s: &mut Scene| {
        s.materials[1].reflection =
            Reflection::MetallicRoughness(MetallicRoughness { roughness: 2.0, ..Default::default() });
    };
    assert!(error(rough).contains("roughness is 2"));
    assert!(
        error(|s| s.materials[0].normal_texture =
            Some(TextureRef { texcoord: 2, ..TextureRef::new(TextureId(0)) }))
        .contains("set 2")
    );
    let skewed = TextureRef { uv_transform: Mat3::NAN, ..TextureRef::new(TextureId(0)) };
    assert!(error(move |s| s.materials[0].normal_texture = Some(skewed)).contains("transform"));
    assert!(
        error(|s| s.images[0].data = ImageData::Rgba8 { width: 2, height: 2, texels: vec![] })
            .contains("texels")
    );
    assert!(error(|s| s.lights[0].color.r = f32::INFINITY).contains("colour"));
    assert!(
        error(|s| s.lights[0].attenuation = Attenuation::InverseSquare { range: Some(0.0) })
            .contains("range")
    );
    assert!(
        error(|s| s.lights[0].attenuation =
            Attenuation::Polynomial { constant: -1.0, linear: 0.0, quadratic: 0.0 })
        .contains("attenuation")
    );
    for kind in [
        LightKind::Spot(SpotFalloff::Sharp { angle: 4.0 }),
        LightKind::Spot(SpotFalloff::Cosine { exponent: nan }),
        LightKind::Spot(SpotFalloff::Smooth { inner: 0.3, outer: 0.2 }),
        LightKind::BoxSpot { min: [0.0; 2], max: [0.0; 2], depth: 1.0 },
        LightKind::Area { size: [1.0, 0.0], visible: true },
    ] {
        assert!(error(move |s| s.lights[0].kind = kind).contains("light 0"));
    }
    for projection in
        [
            Projection::Perspective { yfov: 4.0, aspect: None, near: None, far: None },
            Projection::Perspective { yfov: 1.0, aspect: Some(0.0), near: None, far: None },
            Projection::Perspective { yfov: 1.0, aspect: None, near: Some(2.0), far: Some(1.0) },
            Projection::Orthographic { height: 0.0, aspect: None, near: None, far: None },
            Projection::Orthographic { height: 1.0, aspect: None, near: Some(nan), far: None },
            Projection::Operation(senca_math::ViewingOperation::CentralByNormal(
                senca_math::CentralByNormal { center: DVec3::ZERO, normal: DVec3::Z, focal: 0.0 },
            )),
        ]
    {
        assert!(error(move |s| s.cameras[0].projection = projection).contains("camera 0"));
    }
    assert!(error(|s| s.ambient.b = f32::NAN).contains("ambient"));
    assert!(error(|s| s.background = Background::Color(LinearRgb::splat(f32::NAN))).contains("background"));
    let backwards = FogFalloff::Linear { start: 2.0, end: 1.0, min_share: 0.0 };
    assert!(
        error(move |s| s.fog = Some(Fog { color: LinearRgb::WHITE, falloff: backwards })).contains("fog")
    );
    let rising = FogFalloff::Exponential { density: -1.0 };
    assert!(error(move |s| s.fog = Some(Fog { color: LinearRgb::WHITE, falloff: rising })).contains("fog"));
}

#[test]
fn lists_that_do_not_fit_are_found() {
    assert!(
        error(|s| s.skins[0].inverse_bind_matrices.push(DMat4::IDENTITY))
            .contains("2 inverse bind matrices for 1")
    );
    assert!(error(|s| s.skins[0].inverse_bind_matrices[0] = DMat4::NAN).contains("not finite"));
    assert!(error(|s| channel(s).times.clear()).contains("no keys"));
    assert!(error(|s| channel(s).times[1] = 0.0).contains("increasing"));
    assert!(error(|s| channel(s).interpolation = Interpolation::CubicSpline).contains("need 6"));
    assert!(error(|s| channel(s).values = ChannelValues::Scale(vec![DVec3::NAN; 2])).contains("not finite"));
    let short =
        ChannelValues::Path { points: vec![DVec3::ZERO; 3], parameters: vec![0.0; 2], look_ahead: false };
    assert!(error(move |s| channel(s).values = short).contains("3 n + 1"));
    let mesh = |s: &mut Scene| {
        let Shape::Mesh(mesh) = &mut s.geometries[0].shape else { return };
        mesh.faces.corners[0] = 77;
    };
    let message = error(mesh);
    assert!(message.contains("geometry 0 (\"tri\")") && message.contains("77"), "{message}");
}

#[test]
fn sanitizing_mends_nodes_meshes_skins_and_animations() {
    let mut scene = whole();
    scene.nodes[0].geometry = Some(GeometryId(3));
    scene.nodes[0].light = Some(LightId(3));
    scene.nodes[1].transform = Transform::Matrix(DMat4::NAN);
    scene.nodes[1].children = vec![NodeId(0), NodeId(9)];
    scene.roots.push(NodeId(1));
    let a = scene.add_node(Node::default());
    scene.nodes[a.index()].children = vec![a];
    scene.skins[0].joints.push(NodeId(99));
    channel(&mut scene).times[1] = -1.0;
    if let Shape::Mesh(mesh) = &mut scene.geometries[0].shape {
        mesh.points[1].y = f32::NAN;
        mesh.surfaces[0].material = Some(MaterialId(77));
    }
    let warnings = scene.sanitize();
    assert_eq!(scene.validate(), Ok(()));
    assert_eq!(scene.warnings, warnings);
    assert!(warnings.len() >= 6, "{warnings:?}");
    assert!(scene.sanitize().is_empty(), "once is enough");
    assert!(scene.at_time(Some(AnimationId(0)), 0.5).validate().is_ok());
    assert_eq!(scene.nodes[0].children, [NodeId(1)], "the link that places the node is kept");
    let mut loose = whole();
    let child = loose.add_node(Node::default());
    loose.add_node(Node { children: vec![child], ..Node::default() });
    assert!(loose.sanitize().is_empty() && loose.nodes[3].children == [child], "loose trees stay");
    let mut broken = whole();
    if let Shape::Mesh(mesh) = &mut broken.geometries[0].shape {
        mesh.faces.corners.pop();
    }
    broken.sanitize();
    assert_eq!(broken.validate(), Ok(()));
    assert!(whole().sanitize().is_empty());
}
