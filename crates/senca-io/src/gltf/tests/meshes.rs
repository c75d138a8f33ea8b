//! Primitives, attributes and accessors.

use senca_scene::math::glam::{Vec2, Vec3, Vec4};
use senca_scene::{JointInfluence, MaterialId};
use serde_json::json;

use super::{Builder, first_mesh, warnings};

#[test]
fn a_quad_of_two_triangles_keeps_its_vertices_and_is_flat_without_normals() {
    let mut file = Builder::new();
    let (position, indices) = (file.square(), file.indices(&[0, 1, 2, 0, 2, 3]));
    file.show(json!({"attributes": {"POSITION": position}, "indices": indices}));
    let scene = file.read();
    let mesh = first_mesh(&scene);
    assert_eq!(mesh.points, [Vec3::ZERO, Vec3::X, Vec3::new(1., 1., 0.), Vec3::Y]);
    assert_eq!(mesh.vertices.point, [0, 1, 2, 3]);
    assert_eq!(mesh.faces.corners, [0, 1, 2, 0, 2, 3]);
    assert!(mesh.vertices.normal.is_empty() && mesh.faces.starts.is_empty() && mesh.faces.surface.is_empty());
    assert_eq!(mesh.surfaces.len(), 1);
    assert!(!mesh.surfaces[0].smooth);
    assert_eq!(scene.roots.len(), 1);
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
}

#[test]
fn every_mode_gives_its_elements() {
    let counts =
        [(0, 0, 0, 4), (1, 0, 2, 0), (2, 0, 4, 0), (3, 0, 3, 0), (4, 1, 0, 0), (5, 2, 0, 0), (6, 2, 0, 0)];
    for (mode, triangles, lines, dots) in counts {
        let mut file = Builder::new();
        let position = file.square();
        file.show(json!({"attributes": {"POSITION": position}, "mode": mode}));
        let scene = file.read();
        let mesh = first_mesh(&scene);
        assert_eq!(
            (mesh.faces.len(), mesh.lines.len(), mesh.dots.len()),
            (triangles, lines, dots),
            "mode {mode}"
        );
    }
}

#[test]
fn all_attributes_arrive() {
    let mut file = Builder::new();
    let position = file.square();
    let normal = file.floats("VEC3", 3, &[0., 0., 1., 0., 0., 2., 0., 0., 0., 0., 0., 1.]);
    let tangent = file.floats("VEC4", 4, &[1., 0., 0., -1.].repeat(4));
    let uv0 = file.floats("VEC2", 2, &[0., 0., 1., 0., 1., 1., 0., 1.]);
    let uv1 = file.accessor(&[0, 255, 255, 0, 51, 102, 0, 0], 5121, "VEC2", 4);
    file.json["accessors"][uv1]["normalized"] = json!(true);
    let color = file.floats("VEC3", 3, &[0.5, 0.25, 1.0].repeat(4));
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    file.show(json!({"indices": indices, "attributes": {"POSITION": position, "NORMAL": normal,
        "TANGENT": tangent, "TEXCOORD_0": uv0, "TEXCOORD_1": uv1, "COLOR_0": color}}));
    let scene = file.read();
    let vertices = &first_mesh(&scene).vertices;
    assert_eq!(vertices.normal, [Vec3::Z; 4], "made unit, and the missing one from its faces");
    assert_eq!(vertices.tangent, [Vec4::new(1., 0., 0., -1.); 4]);
    assert_eq!(vertices.texcoord0[2], Vec2::ONE);
    assert_eq!(vertices.texcoord1, [Vec2::Y, Vec2::X, Vec2::new(0.2, 0.4), Vec2::ZERO]);
    assert_eq!(vertices.color, [Vec4::new(0.5, 0.25, 1.0, 1.0); 4]);
    assert!(first_mesh(&scene).surfaces[0].smooth);
}

#[test]
fn colours_come_in_every_type() {
    let shorts: Vec<u8> = [65535u16, 0, 13107, 65535].iter().flat_map(|v| v.to_le_bytes()).collect();
    for (bytes, component) in [(shorts, 5123), (vec![255, 0, 51, 255], 5121)] {
        let mut file = Builder::new();
        let position = file.floats("VEC3", 3, &[0.; 9]);
        let color = file.accessor(&bytes.repeat(3), component, "VEC4", 3);
        file.json["accessors"][color]["normalized"] = json!(true);
        file.show(json!({"attributes": {"POSITION": position, "COLOR_0": color}}));
        assert_eq!(first_mesh(&file.read()).vertices.color[1], Vec4::new(1.0, 0.0, 0.2, 1.0));
    }
}

#[test]
fn quantised_positions_and_signed_normals_are_read_as_the_equations_say() {
    let mut file = Builder::new();
    let shorts: Vec<u8> =
        [0i16, -5, 7, 0, 100, 200, 300, 0, 1, 1, 1, 0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let view = file.view(&shorts);
    file.json["bufferViews"][view]["byteStride"] = json!(8);
    let position = file
        .push("accessors", json!({"bufferView": view, "componentType": 5122, "type": "VEC3", "count": 3}));
    let normal = file.accessor(&[0, 0, 127, 0, 0, 129, 0, 128, 0], 5120, "VEC3", 3);
    file.json["accessors"][normal]["normalized"] = json!(true);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    file.show(json!({"attributes": {"POSITION": position, "NORMAL": normal}}));
    let scene = file.read();
    let mesh = first_mesh(&scene);
    assert_eq!(mesh.points, [Vec3::new(0., -5., 7.), Vec3::new(100., 200., 300.), Vec3::ONE]);
    assert_eq!(mesh.vertices.normal, [Vec3::Z, -Vec3::Z, -Vec3::Y], "-128 is -1 too");
}

#[test]
fn sparse_values_replace_zeros_and_stored_ones() {
    let mut file = Builder::new();
    let position = file.square();
    let (at, values) = (file.view(&[1, 0, 3, 0]), file.view(&[9f32.to_le_bytes(); 6].concat()));
    let sparse = json!({"count": 2, "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}});
    file.json["accessors"][position]["sparse"] = sparse.clone();
    let zeros =
        file.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse}));
    file.show(json!({"attributes": {"POSITION": position}, "mode": 0, "targets": [{"POSITION": zeros}]}));
    let scene = file.read();
    let mesh = first_mesh(&scene);
    assert_eq!(mesh.points, [Vec3::ZERO, Vec3::splat(9.), Vec3::new(1., 1., 0.), Vec3::splat(9.)]);
    let offsets = [Vec3::ZERO, Vec3::splat(9.), Vec3::ZERO, Vec3::splat(9.)];
    assert_eq!(mesh.morph_targets[0].points, offsets);
}

#[test]
fn primitives_become_surfaces_that_share_equal_attributes() {
    let mut file = Builder::new();
    let (position, a, b) = (file.square(), file.indices(&[0, 1, 2]), file.indices(&[0, 2, 3]));
    file.json["materials"] = json!([{}, {}]);
    let attributes = json!({"POSITION": position});
    file.push(
        "meshes",
        json!({"primitives": [
            {"attributes": attributes, "indices": a, "material": 1},
            {"attributes": attributes, "indices": b, "material": 7},
        ]}),
    );
    let scene = file.read();
    let mesh = first_mesh(&scene);
    assert_eq!(mesh.points.len(), 4, "shared, not doubled");
    assert_eq!((mesh.faces.surface_of(0), mesh.faces.surface_of(1)), (0, 1));
    assert_eq!(mesh.surfaces[0].material, Some(MaterialId(1)));
    assert_eq!(mesh.surfaces[1].material, None);
    assert!(warnings(&scene).contains("meshes[0].primitives[1].material: names material 7"));
}

#[test]
fn vertices_that_no_element_uses_are_left_out() {
    let mut file = Builder::new();
    let (position, indices) = (file.square(), file.indices(&[3, 1, 2]));
    file.show(json!({"attributes": {"POSITION": position}, "indices": indices}));
    let scene = file.read();
    assert_eq!(first_mesh(&scene).points, [Vec3::X, Vec3::new(1., 1., 0.), Vec3::Y]);
    assert_eq!(first_mesh(&scene).faces.corners, [2, 0, 1]);
}

#[test]
fn flat_primitives_beside_smooth_ones_get_their_faces_normals() {
    let mut file = Builder::new();
    let (position, normal) = (file.square(), file.floats("VEC3", 3, &[0., 1., 0.].repeat(4)));
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    file.push(
        "meshes",
        json!({"primitives": [
            {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices},
            {"attributes": {"POSITION": position}, "indices": indices},
        ]}),
    );
    let scene = file.read();
    let mesh = first_mesh(&scene);
    assert_eq!((mesh.points.len(), mesh.vertices.point.len()), (8, 10));
    assert_eq!(mesh.vertices.normal[..4], [Vec3::Y; 4]);
    assert_eq!(mesh.vertices.normal[4..], [Vec3::Z; 6]);
    assert_eq!(mesh.vertices.point[4..], [4, 5, 6, 4, 6, 7]);
    assert_eq!(mesh.faces.corners_of(3), [7, 8, 9]);
}

#[test]
fn missing_attributes_are_filled_where_another_primitive_has_them() {
    let mut file = Builder::new();
    let (position, color) = (file.square(), file.floats("VEC4", 4, &[0.5; 16]));
    file.push(
        "meshes",
        json!({"primitives": [
            {"attributes": {"POSITION": position}, "mode": 0},
            {"attributes": {"POSITION": position, "COLOR_0": color}, "mode": 0},
        ]}),
    );
    let scene = file.read();
    let colors = &first_mesh(&scene).vertices.color;
    assert_eq!((colors.len(), colors[0], colors[7]), (8, Vec4::ONE, Vec4::splat(0.5)));
}

#[test]
fn joints_and_weights_are_per_point_and_sum_to_one() {
    let mut file = Builder::new();
    let position = file.floats("VEC3", 3, &[0.; 9]);
    let joints = file.accessor(&[0, 1, 2, 3].repeat(3), 5121, "VEC4", 3);
    let weights = file.floats("VEC4", 4, &[1., 1., 2., 0.].repeat(3));
    let more = file.accessor(&[4, 5, 0, 0].repeat(3), 5121, "VEC4", 3);
    let more_weights = file.floats("VEC4", 4, &[3., 0.5, 0., 0.].repeat(3));
    let attributes = json!({"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights});
    file.show(json!({"attributes": attributes}));
    let mut both = attributes;
    both["JOINTS_1"] = json!(more);
    both["WEIGHTS_1"] = json!(more_weights);
    file.show(json!({"attributes": both}));
    let scene = file.read();
    let expected = JointInfluence { joints: [0, 1, 2, 0], weights: [0.25, 0.25, 0.5, 0.0] };
    assert_eq!(first_mesh(&scene).joints, [expected; 3]);
    let senca_scene::Shape::Mesh(strongest) = &scene.geometries[1].shape else { panic!("a mesh") };
    assert_eq!(strongest.joints[0].joints, [4, 2, 0, 1]);
    assert!((strongest.joints[0].weights[0] - 3.0 / 7.0).abs() < 1e-6);
    assert!(warnings(&scene).contains("more than 4 joints"));
}

#[test]
fn morph_targets_have_names_and_default_weights() {
    let mut file = Builder::new();
    let (position, offset) = (file.floats("VEC3", 3, &[0.; 9]), file.floats("VEC3", 3, &[1.; 9]));
    let target = json!({"POSITION": offset, "NORMAL": offset});
    file.show(json!({"attributes": {"POSITION": position, "NORMAL": offset}, "targets": [target, {}]}));
    file.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    file.json["meshes"][0]["extras"] = json!({"targetNames": ["smile", "frown"]});
    file.push("nodes", json!({"mesh": 0, "weights": [1.0]}));
    let scene = file.read();
    let targets = &first_mesh(&scene).morph_targets;
    assert_eq!((targets[0].name.as_str(), targets[1].name.as_str()), ("smile", "frown"));
    assert_eq!((targets[0].points.as_slice(), targets[0].normals.len()), (&[Vec3::ONE; 3][..], 3));
    assert!(targets[1].points.is_empty());
    assert_eq!(scene.nodes[0].morph_weights, [0.5, 0.25]);
    assert_eq!(scene.nodes[1].morph_weights, [1.0]);
}
