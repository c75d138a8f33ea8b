//! Nodes, scenes, cameras, lights and skins (glTF 2.0, sections 3.5, 3.7.3, 3.10; KHR_lights_punctual).

use std::collections::BTreeSet;

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{DMat4, DQuat, DVec3};
use senca_scene::{
    Attenuation, Camera, CameraId, GeometryId, Light, LightId, LightKind, Node, NodeId, Projection, Scene,
    Skin, SkinId, SpotFalloff, Transform,
};

use super::accessor::Accessor;
use super::document::Document;
use super::json;
use super::mesh::{ReadMesh, finite_or_zero};
use crate::ReadError;

/// Translations and scales from here on leave single precision.
const LARGEST: f64 = 1e30;

/// Reads everything that nodes name except meshes, and the nodes themselves.
pub(super) fn read_all(
    document: &Document<'_>,
    meshes: &[ReadMesh],
    scene: &mut Scene,
) -> Result<(), ReadError> {
    let root = &document.root;
    scene.cameras = root.cameras.iter().enumerate().map(|(i, c)| camera(document, i, c)).collect();
    let lights = root.extensions.lights.iter().flat_map(|l| &l.lights);
    scene.lights = lights.enumerate().map(|(i, l)| light(document, i, l)).collect();
    for (i, json) in root.skins.iter().enumerate() {
        scene.skins.push(skin(document, i, json)?);
    }
    for (i, json) in root.nodes.iter().enumerate() {
        let node = node(document, i, json, meshes, scene)?;
        scene.nodes.push(node);
    }
    let parents = settle_tree(document, scene);
    scene.roots = roots(document, scene, &parents);
    for (i, json) in root.nodes.iter().enumerate() {
        if let Some(instancing) = json.extensions.as_ref().and_then(|e| e.instancing.as_ref()) {
            add_instances(document, i, instancing, scene)?;
        }
    }
    Ok(())
}

fn node(
    document: &Document<'_>,
    i: usize,
    json: &json::Node,
    meshes: &[ReadMesh],
    scene: &Scene,
) -> Result<Node, ReadError> {
    let named = |field: &str, index: Option<json::Whole>, kind: &str, count: usize| {
        index.and_then(|index| document.index_or_warn(format_args!("nodes[{i}].{field}"), index, kind, count))
    };
    let nodes = document.root.nodes.len();
    let children = json.children.iter();
    let children = children.filter_map(|&child| named("children", Some(child), "node", nodes));
    let geometry = named("mesh", json.mesh, "mesh", meshes.len());
    let mesh = geometry.and_then(|g| meshes.get(g as usize));
    let light = json.extensions.as_ref().and_then(|e| e.light.as_ref()).map(|l| l.light);
    Ok(Node {
        name: json.name.clone(),
        transform: transform(document, i, json),
        children: children.map(NodeId).collect(),
        geometry: geometry.map(GeometryId),
        material: None,
        light: named("extensions.KHR_lights_punctual.light", light, "light", scene.lights.len()).map(LightId),
        camera: named("camera", json.camera, "camera", scene.cameras.len()).map(CameraId),
        skin: fitting_skin(document, i, json, mesh, scene),
        morph_weights: morph_weights(document, i, json, mesh)?,
    })
}

/// The node's own weights, or its mesh's; every node that shows a mesh gets its own copy.
fn morph_weights(
    document: &Document<'_>,
    i: usize,
    json: &json::Node,
    mesh: Option<&ReadMesh>,
) -> Result<Vec<f32>, ReadError> {
    let Some(mesh) = mesh else { return Ok(Vec::new()) };
    document.charge(&format_args!("nodes[{i}].weights"), mesh.weights.len() as u64)?;
    let Some(own) = &json.weights else { return Ok(mesh.weights.clone()) };
    Ok(own.iter().take(mesh.targets).map(|&w| finite_or_zero(w as f32)).collect())
}

/// The node's skin when it has all the joints that the mesh names.
fn fitting_skin(
    document: &Document<'_>,
    i: usize,
    json: &json::Node,
    mesh: Option<&ReadMesh>,
    scene: &Scene,
) -> Option<SkinId> {
    let place = format_args!("nodes[{i}].skin");
    let skin = document.index_or_warn(place, json.skin?, "skin", scene.skins.len())?;
    let joints = scene.skins[skin as usize].joints.len();
    let largest = mesh?.largest_joint.map_or(0, usize::from);
    if largest < joints {
        return Some(SkinId(skin));
    }
    document.warn(format!("{place}: the mesh names joint {largest}, but there are only {joints}; left out"));
    None
}

fn transform(document: &Document<'_>, i: usize, json: &json::Node) -> Transform {
    if let Some(matrix) = &json.matrix {
        let matrix = DMat4::from_cols_array(matrix);
        let affine = matrix.row(3).abs_diff_eq(DMat4::IDENTITY.row(3), 1e-6);
        if affine && matrix.to_cols_array().iter().all(|v| v.abs() < LARGEST) {
            return Transform::Matrix(matrix);
        }
        document.warn(format!("nodes[{i}].matrix: is not affine or too large; left out"));
        return Transform::default();
    }
    let rotation = json.rotation.as_deref().map_or(DQuat::IDENTITY, |r| DQuat::from_array(*r));
    let vector = |values: Option<&[f64; 3]>, default| match values.map(|v| DVec3::from_array(*v)) {
        Some(v) if v.abs().max_element() < LARGEST => v,
        Some(_) => {
            document.warn(format!("nodes[{i}]: a translation or scale is too large; left out"));
            default
        }
        None => default,
    };
    Transform::Parts {
        translation: vector(json.translation.as_deref(), DVec3::ZERO),
        rotation: unit_rotation(rotation).unwrap_or_else(|| {
            document.warn(format!("nodes[{i}].rotation: has no direction; left out"));
            DQuat::IDENTITY
        }),
        scale: vector(json.scale.as_deref(), DVec3::ONE),
    }
}

/// `q` at length 1; as it is when it is close to that.
pub(super) fn unit_rotation(q: DQuat) -> Option<DQuat> {
    let squared = q.length_squared();
    if (squared - 1.0).abs() < 1e-12 {
        return Some(q);
    }
    (squared.is_finite() && squared > 1e-30).then(|| q.normalize())
}

/// Takes away edges that would give a node two parents or make it its own ancestor, with a warning.
/// Returns the parent of every node.
fn settle_tree(document: &Document<'_>, scene: &mut Scene) -> Vec<Option<u32>> {
    let mut parents: Vec<Option<u32>> = vec![None; scene.nodes.len()];
    for (i, node) in scene.nodes.iter_mut().enumerate() {
        node.children.retain(|child| {
            let parent = &mut parents[child.index()];
            if let Some(first) = *parent {
                let child = child.0;
                document.warn(format!(
                    "nodes[{i}].children: node {child} is already a child of node {first}; left out"
                ));
                return false;
            }
            *parent = Some(i as u32);
            true
        });
    }
    // Climb from every node; meeting a node of the same climb again means a circle.
    let mut seen_by = vec![u32::MAX; scene.nodes.len()];
    for start in 0..scene.nodes.len() as u32 {
        let mut at = start;
        while seen_by[at as usize] == u32::MAX {
            seen_by[at as usize] = start;
            let Some(parent) = parents[at as usize] else { break };
            if seen_by[parent as usize] == start {
                document.warn(format!("nodes[{parent}].children: node {at} is its own ancestor; left out"));
                scene.nodes[parent as usize].children.retain(|c| c.0 != at);
                parents[at as usize] = None;
                break;
            }
            at = parent;
        }
    }
    parents
}

/// Nodes that the default scene shows: of `scene`, else of the first scene, else all without parent.
fn roots(document: &Document<'_>, scene: &mut Scene, parents: &[Option<u32>]) -> Vec<NodeId> {
    let scenes = &document.root.scenes;
    let named = document.root.scene.and_then(|s| document.index_or_warn("scene", s, "scene", scenes.len()));
    let chosen = named.unwrap_or(0) as usize;
    let Some(json) = scenes.get(chosen) else {
        return (0..parents.len() as u32).filter(|&n| parents[n as usize].is_none()).map(NodeId).collect();
    };
    scene.name.clone_from(&json.name);
    let place = format!("scenes[{chosen}].nodes");
    let mut listed = vec![false; parents.len()];
    let nodes = json.nodes.iter().filter_map(|&n| document.index_or_warn(&place, n, "node", parents.len()));
    let unique: Vec<u32> = nodes.filter(|&n| !std::mem::replace(&mut listed[n as usize], true)).collect();
    let shown = shown_by_ancestors(scene, parents, &listed);
    let mut cut = BTreeSet::new();
    let mut roots = Vec::new();
    for node in unique {
        if shown[node as usize] {
            document.warn(format!("{place}: node {node} is a child of another node of the scene"));
            continue;
        }
        roots.push(NodeId(node));
        if let Some(parent) = parents[node as usize] {
            document.warn(format!("{place}: node {node} has a parent that is not in the scene"));
            cut.insert((parent, node));
        }
    }
    for &parent in cut.iter().map(|(parent, _)| parent).collect::<BTreeSet<_>>() {
        scene.nodes[parent as usize].children.retain(|c| !cut.contains(&(parent, c.0)));
    }
    roots
}

/// For each node whether one of its ancestors is listed.
fn shown_by_ancestors(scene: &Scene, parents: &[Option<u32>], listed: &[bool]) -> Vec<bool> {
    let mut shown = vec![false; parents.len()];
    let mut open: Vec<u32> = (0..parents.len() as u32).filter(|&n| parents[n as usize].is_none()).collect();
    while let Some(node) = open.pop() {
        let below = shown[node as usize] || listed[node as usize];
        for child in &scene.nodes[node as usize].children {
            shown[child.index()] = below;
            open.push(child.0);
        }
    }
    shown
}

/// A child for each instance (EXT_mesh_gpu_instancing); the node itself shows nothing then.
fn add_instances(
    document: &Document<'_>,
    i: usize,
    json: &json::Instancing,
    scene: &mut Scene,
) -> Result<(), ReadError> {
    let Some(geometry) = scene.nodes[i].geometry.take() else { return Ok(()) };
    let place = format!("nodes[{i}].extensions.EXT_mesh_gpu_instancing.attributes");
    let translations = instance_attribute::<3>(document, &place, json, "TRANSLATION")?;
    let rotations = instance_attribute::<4>(document, &place, json, "ROTATION")?;
    let scales = instance_attribute::<3>(document, &place, json, "SCALE")?;
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let count = counts.into_iter().flatten().min().unwrap_or(0);
    document.charge(&place, count as u64 * (1 + scene.nodes[i].morph_weights.len() as u64))?;
    for n in 0..count {
        let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |r| DQuat::from_array(r[n].map(f64::from)));
        let transform = Transform::Parts {
            translation: translations
                .as_ref()
                .map_or(DVec3::ZERO, |t| DVec3::from_array(t[n].map(f64::from))),
            rotation: unit_rotation(rotation).unwrap_or(DQuat::IDENTITY),
            scale: scales.as_ref().map_or(DVec3::ONE, |s| DVec3::from_array(s[n].map(f64::from))),
        };
        if !transform.matrix().is_finite() {
            document.warn(format!("{place}: an instance is not finite; left out"));
            continue;
        }
        let morph_weights = scene.nodes[i].morph_weights.clone();
        let child =
            scene.add_node(Node { transform, geometry: Some(geometry), morph_weights, ..Node::default() });
        scene.nodes[i].children.push(child);
    }
    Ok(())
}

fn instance_attribute<const N: usize>(
    document: &Document<'_>,
    place: &str,
    json: &json::Instancing,
    name: &str,
) -> Result<Option<Vec<[f32; N]>>, ReadError> {
    let Some(&index) = json.attributes.get(name) else { return Ok(None) };
    let place = format!("{place}.{name}");
    let accessor = Accessor::open(document, &place, index)?;
    if accessor.width() != N {
        return Err(document.malformed(format!("{place}: must have {N} components")));
    }
    Ok(Some(accessor.floats::<N>(document, None)?))
}

fn camera(document: &Document<'_>, i: usize, json: &json::Camera) -> Camera {
    let default =
        Projection::Perspective { yfov: std::f64::consts::FRAC_PI_4, aspect: None, near: None, far: None };
    let projection = match (&json.perspective, &json.orthographic) {
        (Some(json), _) if json.yfov > 0.0 && json.yfov < std::f64::consts::PI => {
            let near = Some(json.znear).filter(|&n| n > 0.0);
            Some(Projection::Perspective {
                yfov: json.yfov,
                aspect: json.aspect_ratio.filter(|&a| a > 0.0),
                near,
                far: json.zfar.filter(|&far| far > near.unwrap_or(0.0)),
            })
        }
        (None, Some(json)) if json.ymag != 0.0 => {
            let aspect = json.xmag / json.ymag;
            Some(Projection::Orthographic {
                height: 2.0 * json.ymag.abs(),
                aspect: Some(aspect.abs()).filter(|&a| a > 0.0 && a.is_finite()),
                near: Some(json.znear),
                far: Some(json.zfar).filter(|&far| far > json.znear),
            })
        }
        _ => None,
    };
    let projection = projection.unwrap_or_else(|| {
        document.warn(format!("cameras[{i}]: has no usable projection; a view angle of 45 degrees is used"));
        default
    });
    Camera::new(json.name.clone(), projection)
}

fn light(document: &Document<'_>, i: usize, json: &json::Light) -> Light {
    let place = format!("extensions.KHR_lights_punctual.lights[{i}]");
    let color = json.color.unwrap_or([1.0; 3]).map(|c| c.max(0.0));
    // In glTF a white matt surface under 1 lux shows 1/pi; here a light of 1 makes it show 1.
    let intensity = json.intensity.unwrap_or(1.0).max(0.0) / std::f64::consts::PI;
    let color = document.floats(&place, color.map(|c| c * intensity), [1.0; 3]);
    let kind = match json.r#type.as_str() {
        "directional" => LightKind::Parallel,
        "point" => LightKind::Point,
        "spot" => LightKind::Spot(spot(document, &place, json.spot.as_ref())),
        other => {
            document.warn(format!("{place}.type: {other:?} is not known; a point light is used"));
            LightKind::Point
        }
    };
    let range = json.range.filter(|&r| r > 0.0);
    let attenuation =
        if kind == LightKind::Parallel { Attenuation::None } else { Attenuation::InverseSquare { range } };
    Light { name: json.name.clone(), color: LinearRgb::from_array(color), attenuation, kind }
}

fn spot(document: &Document<'_>, place: &str, json: Option<&json::Spot>) -> SpotFalloff {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let inner = json.and_then(|s| s.inner_cone_angle).unwrap_or(0.0);
    let outer = json.and_then(|s| s.outer_cone_angle).unwrap_or(FRAC_PI_4);
    // Files round pi/2 up.
    let outer = if outer > FRAC_PI_2 && outer < FRAC_PI_2 + 1e-4 { FRAC_PI_2 } else { outer };
    if inner >= 0.0 && inner < outer && outer <= FRAC_PI_2 {
        return SpotFalloff::Smooth { inner, outer };
    }
    let fixed_outer = if outer > 0.0 { outer.min(FRAC_PI_2) } else { FRAC_PI_4 };
    let fixed_inner = inner.clamp(0.0, fixed_outer * 0.999);
    if inner != outer {
        document.warn(format!(
            "{place}.spot: angles {inner} and {outer} do not make a cone; {fixed_outer} is used"
        ));
    }
    SpotFalloff::Smooth { inner: fixed_inner, outer: fixed_outer }
}

fn skin(document: &Document<'_>, i: usize, json: &json::Skin) -> Result<Skin, ReadError> {
    let place = format!("skins[{i}]");
    let mut joints = Vec::with_capacity(json.joints.len());
    for &joint in &json.joints {
        let node = document.index(&format!("{place}.joints"), joint, "node", document.root.nodes.len())?;
        joints.push(NodeId(node as u32));
    }
    let mut inverse_bind_matrices = Vec::new();
    if let Some(index) = json.inverse_bind_matrices {
        let place = format!("{place}.inverseBindMatrices");
        let accessor = Accessor::open(document, &place, index)?;
        if accessor.width() != 16 || accessor.count < joints.len() {
            let message = format!("{place}: must hold a MAT4 for each of the {} joints", joints.len());
            return Err(document.malformed(message));
        }
        inverse_bind_matrices =
            accessor.floats::<16>(document, None)?.iter().map(|m| bind_matrix(document, &place, m)).collect();
        inverse_bind_matrices.truncate(joints.len());
    }
    Ok(Skin { name: json.name.clone(), joints, inverse_bind_matrices })
}

fn bind_matrix(document: &Document<'_>, place: &str, columns: &[f32; 16]) -> DMat4 {
    let mut matrix = DMat4::from_cols_array(&columns.map(f64::from));
    // The last row is fixed; quantised or rounded files miss it slightly.
    (matrix.x_axis.w, matrix.y_axis.w, matrix.z_axis.w, matrix.w_axis.w) = (0.0, 0.0, 0.0, 1.0);
    if matrix.is_finite() {
        return matrix;
    }
    document.warn(format!("{place}: a matrix is not finite; the identity is used"));
    DMat4::IDENTITY
}
