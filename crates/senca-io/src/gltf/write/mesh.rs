//! Meshes and their accessors.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use senca_scene::math::glam::Vec3;
use senca_scene::{
    Faces, Geometry, GeometryId, MaterialId, Mesh, Scene, Shape, TessellationSettings, tessellate,
    triangulated,
};

use super::{Output, Target, U16, WriteSettings, named, numbers, set};
use crate::WriteError;

/// Number in the file of a geometry whose surfaces fall back to a material. Geometries without
/// anything to draw have none.
pub(super) type MeshNumbers = BTreeMap<(GeometryId, Option<MaterialId>), usize>;

/// The material that nodes add to a geometry: none where the geometry names its own.
pub(super) fn node_material(geometry: &Geometry, material: Option<MaterialId>) -> Option<MaterialId> {
    if geometry.material.is_some() { None } else { material }
}

impl Output {
    /// Writes every geometry, once for each material that nodes add to it.
    pub(super) fn add_meshes(
        &mut self,
        scene: &Scene,
        settings: &WriteSettings,
    ) -> Result<MeshNumbers, WriteError> {
        let mut numbers = MeshNumbers::new();
        for (g, geometry) in scene.geometries.iter().enumerate() {
            let id = GeometryId(g as u32);
            let mesh = prepared(geometry, g, &settings.tessellation)?;
            let Some(parts) = self.add_parts(&mesh) else { continue };
            let placed = scene.nodes.iter().filter(|n| n.geometry == Some(id));
            let mut materials: Vec<_> = placed.map(|n| node_material(geometry, n.material)).collect();
            materials.sort();
            materials.dedup();
            if materials.is_empty() {
                materials.push(None);
            }
            for material in materials {
                let fallback = geometry.material.or(material);
                let json = mesh_json(geometry, &mesh, &parts, fallback, scene.materials.len());
                numbers.insert((id, material), self.push("meshes", json));
            }
        }
        Ok(numbers)
    }

    /// Writes the vertices and elements of `mesh`; `None` when it draws nothing.
    fn add_parts(&mut self, mesh: &Mesh) -> Option<Parts> {
        let mut elements = Vec::new();
        let count = mesh.vertices.point.len();
        for (surface, corners) in corners_by_surface(mesh) {
            elements.push((Some(surface), 4, self.add_indices(&corners, count)));
        }
        if !mesh.lines.is_empty() {
            elements.push((None, 1, self.add_indices(mesh.lines.as_flattened(), count)));
        }
        if !mesh.dots.is_empty() {
            elements.push((None, 0, self.add_indices(&mesh.dots, count)));
        }
        if elements.is_empty() {
            return None;
        }
        Some(Parts { attributes: self.add_vertices(mesh), targets: self.add_targets(mesh), elements })
    }

    fn add_vertices(&mut self, mesh: &Mesh) -> Value {
        let (v, all) = (&mesh.vertices, Target::Vertices);
        let mut attributes = Map::new();
        let places: Vec<[f32; 3]> = at_vertices(mesh, &mesh.points, |p| p.to_array());
        set(&mut attributes, "POSITION", json!(self.add_floats(&places, all, true)));
        if !v.normal.is_empty() {
            let normals: Vec<_> = v.normal.iter().map(|n| n.to_array()).collect();
            set(&mut attributes, "NORMAL", json!(self.add_floats(&normals, all, false)));
        }
        if !v.tangent.is_empty() && !v.normal.is_empty() {
            let tangents: Vec<_> = v.tangent.iter().map(|t| t.to_array()).collect();
            set(&mut attributes, "TANGENT", json!(self.add_floats(&tangents, all, false)));
        }
        for (name, texcoords) in [("TEXCOORD_0", &v.texcoord0), ("TEXCOORD_1", &v.texcoord1)] {
            if !texcoords.is_empty() {
                let texcoords: Vec<_> = texcoords.iter().map(|t| t.to_array()).collect();
                set(&mut attributes, name, json!(self.add_floats(&texcoords, all, false)));
            }
        }
        if !v.color.is_empty() {
            let colors: Vec<_> = v.color.iter().map(|c| c.to_array()).collect();
            set(&mut attributes, "COLOR_0", json!(self.add_floats(&colors, all, false)));
        }
        if !mesh.joints.is_empty() {
            let joints: Vec<[u16; 4]> = at_vertices(mesh, &mesh.joints, |j| j.joints);
            let weights: Vec<[f32; 4]> = at_vertices(mesh, &mesh.joints, |j| j.weights);
            set(&mut attributes, "JOINTS_0", json!(self.add_joints(&joints)));
            set(&mut attributes, "WEIGHTS_0", json!(self.add_floats(&weights, all, false)));
        }
        Value::Object(attributes)
    }

    fn add_joints(&mut self, joints: &[[u16; 4]]) -> usize {
        let bytes: Vec<u8> = joints.iter().flatten().flat_map(|j| j.to_le_bytes()).collect();
        let view = self.add_view(&bytes, Target::Vertices);
        let accessor =
            json!({"bufferView": view, "componentType": U16, "type": "VEC4", "count": joints.len()});
        self.push("accessors", accessor)
    }

    fn add_targets(&mut self, mesh: &Mesh) -> Vec<Value> {
        let mut targets = Vec::new();
        for target in &mesh.morph_targets {
            let mut json = Map::new();
            // A target must have something, even when it moves nothing.
            if !target.points.is_empty() || target.normals.is_empty() {
                let zeros = vec![Vec3::ZERO; mesh.points.len()];
                let points = if target.points.is_empty() { &zeros } else { &target.points };
                let points: Vec<[f32; 3]> = at_vertices(mesh, points, |p| p.to_array());
                set(&mut json, "POSITION", json!(self.add_floats(&points, Target::Vertices, true)));
            }
            let has_normals = !mesh.vertices.normal.is_empty();
            for (name, offsets) in [("NORMAL", &target.normals), ("TANGENT", &target.tangents)] {
                if !offsets.is_empty() && has_normals {
                    let offsets: Vec<_> = offsets.iter().map(|n| n.to_array()).collect();
                    set(&mut json, name, json!(self.add_floats(&offsets, Target::Vertices, false)));
                }
            }
            targets.push(Value::Object(json));
        }
        targets
    }
}

/// What is written of a mesh, whatever its materials.
struct Parts {
    attributes: Value,
    targets: Vec<Value>,
    /// Surface (or none), mode and indices of each primitive.
    elements: Vec<(Option<u32>, u32, usize)>,
}

fn mesh_json(
    geometry: &Geometry,
    mesh: &Mesh,
    parts: &Parts,
    fallback: Option<MaterialId>,
    materials: usize,
) -> Value {
    let primitive = |&(surface, mode, indices): &(Option<u32>, u32, usize)| {
        let mut json = json!({"attributes": parts.attributes, "indices": indices});
        if mode != 4 {
            json["mode"] = json!(mode);
        }
        let own = surface.and_then(|s| mesh.surfaces.get(s as usize)?.material);
        if let Some(material) = own.or(fallback).filter(|m| m.index() < materials) {
            json["material"] = json!(material.0);
        }
        if !parts.targets.is_empty() {
            json["targets"] = json!(parts.targets);
        }
        json
    };
    let mut json = named(&geometry.name);
    set(&mut json, "primitives", parts.elements.iter().map(primitive).collect());
    if mesh.morph_targets.iter().any(|t| !t.name.is_empty()) {
        let names: Vec<&str> = mesh.morph_targets.iter().map(|t| t.name.as_str()).collect();
        set(&mut json, "extras", json!({"targetNames": names}));
    }
    if !mesh.morph_targets.is_empty() {
        set(&mut json, "weights", numbers(&vec![0.0; mesh.morph_targets.len()]));
    }
    Value::Object(json)
}

/// Values of points, at the vertices.
fn at_vertices<T, U>(mesh: &Mesh, of_points: &[T], value: impl Fn(&T) -> U) -> Vec<U> {
    mesh.vertices.point.iter().map(|&p| value(&of_points[p as usize])).collect()
}

/// The triangles' corners, by surface.
fn corners_by_surface(mesh: &Mesh) -> BTreeMap<u32, Vec<u32>> {
    let mut surfaces: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    if mesh.faces.surface.is_empty() {
        if !mesh.faces.is_empty() {
            surfaces.insert(0, mesh.faces.corners.clone());
        }
        return surfaces;
    }
    for (f, corners) in mesh.faces.iter().enumerate() {
        surfaces.entry(mesh.faces.surface_of(f)).or_default().extend_from_slice(corners);
    }
    surfaces
}

/// The geometry as a sound mesh of triangles, with normals where they are not those of the faces.
fn prepared<'s>(
    geometry: &'s Geometry,
    index: usize,
    tessellation: &TessellationSettings,
) -> Result<Cow<'s, Mesh>, WriteError> {
    let broken = |why: String| WriteError::Unsupported {
        message: format!("geometry {index} {:?} cannot be written: {why}", geometry.name),
    };
    let settings = TessellationSettings { polygons: false, ..*tessellation };
    let Shape::Mesh(mesh) = &geometry.shape else {
        return tessellate(&geometry.shape, &settings).map_err(|error| broken(error.to_string()));
    };
    mesh.check().and_then(|()| mesh.check_finite()).map_err(|error| broken(error.to_string()))?;
    if !mesh.vertices.normal.is_empty() || mesh.surfaces.iter().all(|s| !s.smooth) {
        return Ok(in_triangles(mesh));
    }
    tessellate(&geometry.shape, &settings).map_err(|error| broken(error.to_string()))
}

fn in_triangles(mesh: &Mesh) -> Cow<'_, Mesh> {
    if mesh.faces.starts.is_empty() {
        return Cow::Borrowed(mesh);
    }
    let faces: Faces = triangulated(mesh);
    Cow::Owned(Mesh { faces, ..mesh.clone() })
}
