//! Nodes, scenes, cameras, lights, skins and animations.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{DMat4, DQuat, DVec3};
use senca_scene::{
    Attenuation, CameraId, ChannelValues, GeometryId, Interpolation, LightKind, NodeId, Projection,
    SpotFalloff, Transform,
};
use serde_json::json;

use super::{Builder, first_mesh, warnings};

#[test]
fn places_come_as_parts_or_matrix_and_instances_share_their_mesh() {
    let mut file = Builder::new();
    let position = file.square();
    file.show(json!({"attributes": {"POSITION": position}, "mode": 0}));
    file.json["nodes"] = json!([
        {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2], "scale": [2, 2, 2]},
        {"mesh": 0, "name": "m", "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1], "children": [0]},
    ]);
    let scene = file.read();
    assert_eq!(scene.roots, [NodeId(1)]);
    assert_eq!(scene.nodes[1].transform, Transform::Matrix(DMat4::from_translation(DVec3::new(4., 5., 6.))));
    let instances = scene.instances();
    assert_eq!(instances.len(), 2);
    assert!(instances.iter().all(|i| i.geometry == GeometryId(0)));
    let corner = instances[0].world_from_object.transform_point3(DVec3::X);
    assert!(corner.abs_diff_eq(DVec3::new(5., 9., 9.), 1e-12), "{corner}");
}

#[test]
fn the_default_scene_is_shown_and_other_nodes_are_kept() {
    let mut file = Builder::new();
    file.json["nodes"] = json!([{"children": [1]}, {}, {}]);
    file.json["scenes"] = json!([{"nodes": [0]}, {"name": "second", "nodes": [2, 2]}]);
    file.json["scene"] = json!(1);
    let scene = file.read();
    assert_eq!(
        (scene.roots.as_slice(), scene.nodes.len(), scene.name.as_str()),
        (&[NodeId(2)][..], 3, "second")
    );
    file.json["scene"] = json!(9);
    let scene = file.read();
    assert_eq!(scene.roots, [NodeId(0)]);
    assert!(warnings(&scene).contains("scene: names scene 9"));
}

#[test]
fn circles_and_second_parents_are_cut() {
    let mut file = Builder::new();
    file.json["nodes"] = json!([{"children": [1, 2]}, {"children": [2]}, {}, {"children": [4]}, {"children": [3]},
        {"children": [5]}, {"children": [99]}]);
    let scene = file.read();
    let said = warnings(&scene);
    assert!(said.contains("nodes[1].children: node 2 is already a child of node 0"), "{said}");
    assert!(said.contains("is its own ancestor") && said.contains("names node 99"), "{said}");
    let reached = scene.world_from_nodes().iter().filter(|w| w.is_some()).count();
    assert_eq!(reached, scene.nodes.len(), "all are still there");
    let children: usize = scene.nodes.iter().map(|n| n.children.len()).sum();
    assert_eq!(children + scene.roots.len(), scene.nodes.len(), "a forest");
}

#[test]
fn scenes_that_list_children_show_them_once() {
    let mut file = Builder::new();
    file.json["nodes"] = json!([{"children": [1]}, {"children": [2]}, {}, {"children": [4, 5]}, {}, {}]);
    file.json["scenes"] = json!([{"nodes": [2, 0, 4]}]);
    let scene = file.read();
    assert_eq!(scene.roots, [NodeId(0), NodeId(4)]);
    assert_eq!(scene.nodes[3].children, [NodeId(5)], "cut from a parent that is not shown");
    let said = warnings(&scene);
    assert!(said.contains("node 2 is a child of another") && said.contains("node 4 has a parent"), "{said}");
}

#[test]
fn places_too_far_away_are_left_out() {
    let mut file = Builder::new();
    file.json["nodes"] = json!([{"translation": [1e300, 0, 0], "scale": [2, 2, 2]}, {"rotation": [0, 0, 0, 0]},
        {"matrix": [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]);
    let scene = file.read();
    let parts = |t| Transform::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: t };
    assert_eq!(scene.nodes[0].transform, parts(DVec3::splat(2.0)));
    assert_eq!((scene.nodes[1].transform, scene.nodes[2].transform), (parts(DVec3::ONE), parts(DVec3::ONE)));
    assert_eq!(scene.warnings.len(), 3);
}

#[test]
fn a_chain_of_100_000_nodes_is_no_problem() {
    let mut file = Builder::new();
    let nodes: Vec<_> =
        (1..=100_000).map(|i| json!({"children": if i < 100_000 { vec![i] } else { vec![] }})).collect();
    file.json["nodes"] = json!(nodes);
    assert_eq!(file.read().world_from_nodes().len(), 100_000);
}

#[test]
fn gpu_instances_become_children() {
    let mut file = Builder::new();
    let position = file.square();
    file.show(json!({"attributes": {"POSITION": position}, "mode": 0}));
    let translation = file.floats("VEC3", 3, &[1., 0., 0., 2., 0., 0.]);
    let attributes = json!({"TRANSLATION": translation});
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = file.read();
    assert_eq!(scene.nodes[0].children, [NodeId(1), NodeId(2)]);
    let places: Vec<f64> = scene.instances().iter().map(|i| i.world_from_object.w_axis.x).collect();
    assert_eq!(places, [1.0, 2.0]);
}

#[test]
fn cameras_of_both_kinds() {
    let mut file = Builder::new();
    file.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 1.5}},
        {"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 2, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0, "znear": 0.1}},
    ]);
    file.json["nodes"] = json!([{"camera": 1}]);
    let scene = file.read();
    let infinite = Projection::Perspective { yfov: 0.5, aspect: Some(1.5), near: Some(0.1), far: None };
    assert_eq!(scene.cameras[0].projection, infinite);
    let parallel =
        Projection::Orthographic { height: 4.0, aspect: Some(2.0), near: Some(0.0), far: Some(9.0) };
    assert_eq!(scene.cameras[1].projection, parallel);
    assert_eq!(scene.nodes[0].camera, Some(CameraId(1)));
    assert!(warnings(&scene).contains("cameras[2]"));
}

#[test]
fn lights_of_all_kinds() {
    let mut file = Builder::new();
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0], "intensity": 4.0 * std::f64::consts::PI},
        {"type": "point", "range": 7},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}},
        {"type": "spot", "spot": {"innerConeAngle": 0.0, "outerConeAngle": 1.570_796_4}},
    ]}});
    file.json["nodes"] = json!([{"extensions": {"KHR_lights_punctual": {"light": 2}}}]);
    let scene = file.read();
    assert_eq!(scene.lights[0].kind, LightKind::Parallel);
    assert_eq!(scene.lights[0].color, LinearRgb::new(4.0, 2.0, 0.0));
    assert_eq!(scene.lights[0].attenuation, Attenuation::None);
    assert_eq!(scene.lights[1].attenuation, Attenuation::InverseSquare { range: Some(7.0) });
    assert_eq!(scene.lights[2].kind, LightKind::Spot(SpotFalloff::Smooth { inner: 0.1, outer: 0.2 }));
    assert_eq!(scene.lights[3].kind, LightKind::Spot(SpotFalloff::Smooth { inner: 0.0, outer: FRAC_PI_2 }));
    assert_eq!(scene.nodes[0].light.map(|l| l.0), Some(2));
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
}

#[test]
fn skins_name_joints_and_matrices_and_must_cover_the_mesh() {
    let mut file = Builder::new();
    let position = file.floats("VEC3", 3, &[0.; 9]);
    let joints = file.accessor(&[1, 0, 0, 0].repeat(3), 5121, "VEC4", 3);
    let weights = file.floats("VEC4", 4, &[1., 0., 0., 0.].repeat(3));
    let matrices =
        file.floats("MAT4", 16, &DMat4::from_translation(DVec3::X).as_mat4().to_cols_array().repeat(2));
    file.show(json!({"attributes": {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights}}));
    file.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2]}, {}, {"mesh": 0, "skin": 1}]);
    file.json["skins"] =
        json!([{"joints": [1, 2], "inverseBindMatrices": matrices, "name": "bones"}, {"joints": [1]}]);
    let scene = file.read();
    assert_eq!(scene.skins[0].joints, [NodeId(1), NodeId(2)]);
    assert_eq!(scene.skins[0].inverse_bind_matrices, [DMat4::from_translation(DVec3::X); 2]);
    assert!(scene.nodes[0].skin.is_some() && scene.nodes[3].skin.is_none());
    assert!(warnings(&scene).contains("nodes[3].skin: the mesh names joint 1, but there are only 1"));
}

#[test]
fn animations_move_all_four_properties() {
    let mut file = Builder::new();
    let (position, offset) = (file.floats("VEC3", 3, &[0.; 9]), file.floats("VEC3", 3, &[1.; 9]));
    file.show(json!({"attributes": {"POSITION": position}, "targets": [{"POSITION": offset}, {"POSITION": offset}]}));
    let times = file.floats("SCALAR", 1, &[0.0, 1.5]);
    let vectors = file.floats("VEC3", 3, &[1., 2., 3., 4., 5., 6.]);
    let turns = file.accessor(&[0, 0, 0, 127, 127, 0, 0, 0], 5120, "VEC4", 2);
    file.json["accessors"][turns]["normalized"] = json!(true);
    let spline = file.floats("VEC3", 3, &(0..18).map(|v| v as f32).collect::<Vec<_>>());
    let weights = file.floats("SCALAR", 1, &[0., 0.25, 0.5, 1.]);
    file.json["animations"] = json!([{"name": "all",
        "samplers": [
            {"input": times, "output": vectors, "interpolation": "STEP"},
            {"input": times, "output": turns},
            {"input": times, "output": spline, "interpolation": "CUBICSPLINE"},
            {"input": times, "output": weights, "interpolation": "LINEAR"}],
        "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "translation"}},
            {"sampler": 1, "target": {"node": 0, "path": "rotation"}},
            {"sampler": 2, "target": {"node": 0, "path": "scale"}},
            {"sampler": 3, "target": {"node": 0, "path": "weights"}},
            {"sampler": 0, "target": {"path": "translation"}},
            {"sampler": 0, "target": {"node": 0, "path": "pointer"}},
            {"sampler": 3, "target": {"node": 0, "path": "scale"}}]}]);
    let scene = file.read();
    let channels = &scene.animations[0].channels;
    assert_eq!(channels.len(), 4);
    assert_eq!(
        (channels[0].times.as_slice(), channels[0].interpolation),
        (&[0.0, 1.5][..], Interpolation::Step)
    );
    let moved = vec![DVec3::new(1., 2., 3.), DVec3::new(4., 5., 6.)];
    assert_eq!(channels[0].values, ChannelValues::Translation(moved));
    assert_eq!(
        channels[1].values,
        ChannelValues::Rotation(vec![DQuat::IDENTITY, DQuat::from_xyzw(1., 0., 0., 0.)])
    );
    let ChannelValues::Scale(scales) = &channels[2].values else { panic!("scale") };
    assert_eq!((scales.len(), scales[4]), (6, DVec3::new(12., 13., 14.)));
    let weights = ChannelValues::Weights { count: 2, values: vec![0., 0.25, 0.5, 1.] };
    assert_eq!(channels[3].values, weights);
    let said = warnings(&scene);
    assert!(
        said.contains("\"pointer\" is not known") && said.contains("must hold 2 elements of 3"),
        "{said}"
    );
}

#[test]
fn key_times_that_do_not_rise_are_left_out() {
    let mut file = Builder::new();
    let times = file.floats("SCALAR", 1, &[0.0, 1.0, 1.0, f32::NAN, 2.0]);
    let vectors = file.floats("VEC3", 3, &(0..15).map(|v| v as f32).collect::<Vec<_>>());
    file.json["nodes"] = json!([{"matrix": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]}]);
    file.json["animations"] = json!([{"samplers": [{"input": times, "output": vectors}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]);
    let scene = file.read();
    let channel = &scene.animations[0].channels[0];
    assert_eq!(channel.times, [0.0, 1.0, 2.0]);
    let values = vec![DVec3::new(0., 1., 2.), DVec3::new(3., 4., 5.), DVec3::new(12., 13., 14.)];
    assert_eq!(channel.values, ChannelValues::Translation(values));
    assert!(
        matches!(scene.nodes[0].transform, Transform::Parts { scale, .. } if scale == DVec3::new(2., 1., 1.))
    );
    assert!(warnings(&scene).contains("2 times do not rise"));
    assert!(scene.geometries.is_empty());
}

#[test]
fn whole_numbers_may_be_written_with_a_point() {
    let mut file = Builder::new();
    let position = file.square();
    file.show(json!({"attributes": {"POSITION": position as f64}, "mode": 0.0}));
    assert_eq!(first_mesh(&file.read()).dots.len(), 4);
}
