//! Nodes, lights and skins.

use serde_json::{Map, Value, json};

use senca_scene::math::LinearRgb;
use senca_scene::{Attenuation, Light, LightKind, Node, Scene, Shape, Skin, SpotFalloff, Transform};

use super::camera::CameraPlace;
use super::mesh::{MeshNumbers, node_material};
use super::{Output, Target, named, numbers, set};

/// Intensity below which a cosine spot is taken to have ended.
const SPOT_END: f64 = 0.01;

impl Output {
    /// Writes everything that nodes name, the nodes, and the scene that shows them.
    pub(super) fn add_nodes(&mut self, scene: &Scene, meshes: &MeshNumbers) {
        let cameras: Vec<CameraPlace> = scene.cameras.iter().map(|camera| self.add_camera(camera)).collect();
        let lights: Vec<Option<usize>> = scene.lights.iter().map(|light| self.add_light(light)).collect();
        let skins: Vec<Option<usize>> = scene.skins.iter().map(|skin| self.add_skin(scene, skin)).collect();
        let mut camera_nodes = Vec::new();
        for node in &scene.nodes {
            let json = self.node_json(scene, node, meshes, &lights, &skins, &cameras, &mut camera_nodes);
            self.push("nodes", json);
        }
        for json in camera_nodes {
            self.push("nodes", json);
        }
        let mut json = named(&scene.name);
        let count = scene.nodes.len();
        let roots: Vec<u32> = scene.roots.iter().map(|r| r.0).filter(|&r| (r as usize) < count).collect();
        if !roots.is_empty() {
            set(&mut json, "nodes", json!(roots));
        }
        self.push("scenes", Value::Object(json));
    }

    fn node_json(
        &mut self,
        scene: &Scene,
        node: &Node,
        meshes: &MeshNumbers,
        lights: &[Option<usize>],
        skins: &[Option<usize>],
        cameras: &[CameraPlace],
        camera_nodes: &mut Vec<Value>,
    ) -> Value {
        let mut json = named(&node.name);
        self.set_transform(&mut json, node);
        let count = scene.nodes.len();
        let mut children: Vec<u32> =
            node.children.iter().map(|c| c.0).filter(|&c| (c as usize) < count).collect();
        match node.camera.and_then(|c| cameras.get(c.index())) {
            Some(CameraPlace::Here(camera)) => set(&mut json, "camera", json!(camera)),
            Some(CameraPlace::Moved(camera, node_from_camera)) => {
                children.push((count + camera_nodes.len()) as u32);
                let matrix = numbers(&node_from_camera.to_cols_array());
                camera_nodes.push(json!({"camera": camera, "matrix": matrix}));
            }
            Some(CameraPlace::LeftOut) | None => {}
        }
        if !children.is_empty() {
            set(&mut json, "children", json!(children));
        }
        set_mesh(&mut json, scene, node, meshes, skins);
        if let Some(light) = node.light.and_then(|l| *lights.get(l.index())?) {
            set(&mut json, "extensions", json!({"KHR_lights_punctual": {"light": light}}));
        }
        Value::Object(json)
    }

    fn set_transform(&mut self, json: &mut Map<String, Value>, node: &Node) {
        if node.transform == Transform::default() {
            return;
        }
        if !node.transform.matrix().is_finite() {
            self.warn(format!("node {:?}: its place is not finite; left out", node.name));
            return;
        }
        match node.transform {
            Transform::Matrix(matrix) => set(json, "matrix", numbers(&matrix.to_cols_array())),
            Transform::Parts { translation, rotation, scale } => {
                set(json, "translation", numbers(&translation.to_array()));
                set(json, "rotation", numbers(&rotation.to_array()));
                set(json, "scale", numbers(&scale.to_array()));
            }
        }
    }

    fn add_skin(&mut self, scene: &Scene, skin: &Skin) -> Option<usize> {
        let count = scene.nodes.len();
        if skin.joints.is_empty() || skin.joints.iter().any(|j| j.index() >= count) {
            self.warn(format!(
                "skin {:?}: names no joints, or nodes that are not there; left out",
                skin.name
            ));
            return None;
        }
        let mut json = named(&skin.name);
        set(&mut json, "joints", json!(skin.joints.iter().map(|j| j.0).collect::<Vec<_>>()));
        if skin.inverse_bind_matrices.len() >= skin.joints.len() {
            let matrices = skin.inverse_bind_matrices.iter().take(skin.joints.len());
            let matrices: Vec<[f32; 16]> = matrices.map(|m| m.as_mat4().to_cols_array()).collect();
            let accessor = self.add_floats(&matrices, Target::Other, false);
            set(&mut json, "inverseBindMatrices", json!(accessor));
        }
        Some(self.push("skins", Value::Object(json)))
    }

    fn add_light(&mut self, light: &Light) -> Option<usize> {
        let mut json = named(&light.name);
        let (kind, range) = match light.kind {
            LightKind::Parallel => ("directional", None),
            LightKind::Point => ("point", range(light)),
            LightKind::Spot(falloff) => {
                set(&mut json, "spot", spot_json(falloff));
                ("spot", range(light))
            }
            LightKind::Ambient | LightKind::BoxSpot { .. } | LightKind::Area { .. } => {
                self.warn(format!("light {:?}: glTF has no light of this kind; left out", light.name));
                return None;
            }
        };
        let fits = match light.attenuation {
            Attenuation::InverseSquare { .. } => kind != "directional",
            Attenuation::None | Attenuation::Polynomial { .. } => kind == "directional",
        };
        if !fits {
            self.warn(format!("light {:?}: is written with glTF's own fall-off with distance", light.name));
        }
        set(&mut json, "type", json!(kind));
        set_color(&mut json, light.color);
        if let Some(range) = range {
            set(&mut json, "range", json!(range));
        }
        self.lights.push(Value::Object(json));
        Some(self.lights.len() - 1)
    }
}

/// A colour whose largest component is 1, and the intensity that makes up for it, times pi for glTF's
/// units (see the reader). Read back in double precision they round to the same bits.
fn set_color(json: &mut Map<String, Value>, color: LinearRgb) {
    let color = color.to_array().map(|v| if v.is_finite() { f64::from(v.max(0.0)) } else { 0.0 });
    let largest = color.into_iter().fold(0.0, f64::max);
    let intensity = if largest > 0.0 { largest } else { 1.0 };
    set(json, "color", numbers(&color.map(|v| v / intensity)));
    set(json, "intensity", json!(intensity * std::f64::consts::PI));
}

fn range(light: &Light) -> Option<f64> {
    match light.attenuation {
        Attenuation::InverseSquare { range } => range.filter(|r| *r > 0.0 && r.is_finite()),
        _ => None,
    }
}

fn spot_json(falloff: SpotFalloff) -> Value {
    use std::f64::consts::FRAC_PI_2;
    let (inner, outer) = match falloff {
        SpotFalloff::Smooth { inner, outer } => (inner, outer),
        SpotFalloff::Sharp { angle } => (angle.min(FRAC_PI_2) * 0.999, angle.min(FRAC_PI_2)),
        SpotFalloff::Cosine { exponent } => {
            let end = SPOT_END.powf(1.0 / exponent.max(1e-3)).clamp(0.0, 1.0).acos();
            (0.0, end.clamp(1e-3, FRAC_PI_2))
        }
    };
    json!({"innerConeAngle": inner, "outerConeAngle": outer})
}

fn set_mesh(
    json: &mut Map<String, Value>,
    scene: &Scene,
    node: &Node,
    meshes: &MeshNumbers,
    skins: &[Option<usize>],
) {
    let Some(id) = node.geometry else { return };
    let Some(geometry) = scene.geometries.get(id.index()) else { return };
    let Some(mesh) = meshes.get(&(id, node_material(geometry, node.material))) else { return };
    set(json, "mesh", json!(mesh));
    let Shape::Mesh(shape) = &geometry.shape else { return };
    let targets = shape.morph_targets.len();
    if targets > 0 && !node.morph_weights.is_empty() {
        let mut weights = node.morph_weights.clone();
        weights.resize(targets, 0.0);
        set(json, "weights", numbers(&weights));
    }
    let skin = node.skin.and_then(|s| *skins.get(s.index())?);
    if let Some(skin) = skin.filter(|_| !shape.joints.is_empty()) {
        set(json, "skin", json!(skin));
    }
}
