//! The stages between tessellation and rasterisation.

use senca_math::glam::{DMat4, DVec3, Vec4};
use senca_math::{DeviceMap, LinearRgb, View, ViewKind};
use senca_raster::clip::{CANONICAL_VOLUME, ClipVertex, clip_triangle};
use senca_shading::{LightRig, PhongConstants, ShadingPoint, phong};

use super::{Triangle, Vertex};

/// A step over the list of triangles.
pub trait Stage {
    /// Name for listings and timings.
    fn name(&self) -> &'static str;

    /// The list after the step.
    fn run(&self, list: Vec<Triangle>) -> Vec<Triangle>;
}

/// Runs `stages` one after the other.
#[must_use]
pub fn run(stages: &[Box<dyn Stage>], list: Vec<Triangle>) -> Vec<Triangle> {
    stages.iter().fold(list, |list, stage| stage.run(list))
}

/// Stages 2 to 7 with lighting at the vertices (course text, section 2.2).
#[must_use]
pub fn gouraud_stages(
    view: &View,
    map: DeviceMap,
    rig: LightRig,
    materials: Vec<PhongConstants>,
) -> Vec<Box<dyn Stage>> {
    let mut stages = phong_stages(view, map);
    stages.insert(1, Box::new(LightVertices { rig, materials, view: view.kind }));
    stages
}

/// Stages 2 to 7 without lighting (course text, section 2.10).
#[must_use]
pub fn phong_stages(view: &View, map: DeviceMap) -> Vec<Box<dyn Stage>> {
    vec![
        Box::new(RejectBacks { view: view.kind }),
        Box::new(Project { canonical_from_world: canonical_from_world(view) }),
        Box::new(ClipByVolume),
        Box::new(Divide),
        Box::new(ToDevice { map }),
    ]
}

/// World to the canonical volume of the book, z from 0 in front to -1 at the back.
#[must_use]
pub fn canonical_from_world(view: &View) -> DMat4 {
    senca_math::view::clip_from_canonical().1 * view.clip_from_world
}

/// Stage 2: trivial rejection of faces that show their back. Edge-on faces stay.
/// Source: course text, section 2.4, equation 2.1.
#[derive(Clone, Copy, Debug)]
pub struct RejectBacks {
    /// Centre or direction of projection.
    pub view: ViewKind,
}

impl Stage for RejectBacks {
    fn name(&self) -> &'static str {
        "reject backs"
    }

    fn run(&self, mut list: Vec<Triangle>) -> Vec<Triangle> {
        list.retain(|t| !self.view.sees_back_of(t.corners()[0], t.facet_normal()));
        list
    }
}

/// Stage 3: light at every vertex.
/// Source: course text, section 2.5, equation 2.2.
#[derive(Clone, Debug)]
pub struct LightVertices {
    /// The lights.
    pub rig: LightRig,
    /// Materials by number, the default material last.
    pub materials: Vec<PhongConstants>,
    /// Where the observer is.
    pub view: ViewKind,
}

impl LightVertices {
    fn light(&self, vertex: &Vertex, material: usize) -> LinearRgb {
        let position = vertex.position.truncate() / vertex.position.w;
        let to_viewer = self.view.towards_viewer(position).as_vec3();
        let point = ShadingPoint { position: position.as_vec3(), normal: vertex.normal, to_viewer };
        self.materials.get(material).map_or(LinearRgb::BLACK, |m| phong(&self.rig, &point, m, 1.0))
    }
}

impl Stage for LightVertices {
    fn name(&self) -> &'static str {
        "light vertices"
    }

    fn run(&self, mut list: Vec<Triangle>) -> Vec<Triangle> {
        for triangle in &mut list {
            for vertex in &mut triangle.vertices {
                vertex.light = self.light(vertex, triangle.material);
            }
        }
        list
    }
}

/// Stage 4: the view transform.
/// Source: course text, section 2.6.
#[derive(Clone, Copy, Debug)]
pub struct Project {
    /// The matrix T of a viewing operation, for column vectors.
    pub canonical_from_world: DMat4,
}

impl Stage for Project {
    fn name(&self) -> &'static str {
        "project"
    }

    fn run(&self, mut list: Vec<Triangle>) -> Vec<Triangle> {
        for vertex in list.iter_mut().flat_map(|t| &mut t.vertices) {
            vertex.position = self.canonical_from_world * vertex.position;
        }
        list
    }
}

/// Stage 5: clipping by the six planes of the canonical volume, before the division. What a cut
/// leaves is split into triangles again; new vertices get normals, light and alignment points
/// interpolated by the parameter of the cut.
/// Source: course text, section 2.7.
#[derive(Clone, Copy, Debug)]
pub struct ClipByVolume;

impl Stage for ClipByVolume {
    fn name(&self) -> &'static str {
        "clip by volume"
    }

    fn run(&self, list: Vec<Triangle>) -> Vec<Triangle> {
        list.iter().flat_map(|t| clip(t, &CANONICAL_VOLUME)).collect()
    }
}

/// The triangles that `planes` leave of `triangle`.
pub(crate) fn clip(triangle: &Triangle, planes: &[Vec4]) -> Vec<Triangle> {
    let polygon = clip_triangle(triangle.vertices.map(|v| v.position.as_vec4()), planes);
    let corners: Vec<Vertex> = polygon.vertices().iter().map(|c| blend(triangle, c)).collect();
    let piece =
        |[a, b, c]: [usize; 3]| Triangle { vertices: [corners[a], corners[b], corners[c]], ..*triangle };
    polygon.triangles().map(piece).collect()
}

/// A vertex from the weights of the three original ones.
fn blend(triangle: &Triangle, corner: &ClipVertex) -> Vertex {
    let mut sum = Vertex { position: senca_math::glam::DVec4::ZERO, ..Vertex::default() };
    for (v, &w) in triangle.vertices.iter().zip(&corner.weights) {
        sum.position += v.position * f64::from(w);
        sum.normal += v.normal * w;
        sum.light += v.light * w;
        sum.alignment += v.alignment * w;
    }
    sum
}

/// Stage 6: from homogeneous to affine coordinates.
/// Source: course text, section 2.8.
#[derive(Clone, Copy, Debug)]
pub struct Divide;

impl Stage for Divide {
    fn name(&self) -> &'static str {
        "divide"
    }

    fn run(&self, mut list: Vec<Triangle>) -> Vec<Triangle> {
        for vertex in list.iter_mut().flat_map(|t| &mut t.vertices) {
            vertex.position /= vertex.position.w;
        }
        list
    }
}

/// Stage 7: the device map. z stays.
/// Source: course text, sections 1.8 and 2.8.
#[derive(Clone, Copy, Debug)]
pub struct ToDevice {
    /// The map.
    pub map: DeviceMap,
}

impl Stage for ToDevice {
    fn name(&self) -> &'static str {
        "to device"
    }

    fn run(&self, mut list: Vec<Triangle>) -> Vec<Triangle> {
        for vertex in list.iter_mut().flat_map(|t| &mut t.vertices) {
            let place: DVec3 = self.map.device_from_normalized(vertex.position.truncate());
            vertex.position = place.extend(1.0);
        }
        list
    }
}
