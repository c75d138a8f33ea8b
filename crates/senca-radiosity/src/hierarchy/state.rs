//! Light on nodes during a solution.

use senca_math::LinearRgb;
use senca_math::glam::{DVec3, Vec4};

use super::cluster::Clusters;
use super::exchange::Parts;
use super::facet::Facet;
use super::moments::Moments;
use super::node::Node;
use crate::ElementMesh;

/// Clusters of up to so many polygons send what each of these sends. Moments would let some light out
/// behind a wall.
const FEW: usize = 16;

/// Light on all nodes. Values have four channels: red, green, blue, and one that is lit evenly by all
/// surfaces, so that it counts the share of directions that links account for.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    /// Of each element, B; the fourth channel is 1.
    pub(super) radiosity: Vec<Vec4>,
    /// Of each element, H from surfaces.
    pub(super) incident: Vec<Vec4>,
    /// Of each element, H from lamps; of divided elements the mean.
    pub(super) lamp_light: Vec<Vec4>,
    /// Of each element, how far the radiosity of its leaves is from its own; the largest channel.
    pub(super) spread: Vec<f32>,
    /// Of each leaf, the share of its light that meets no front: that leaves the scene, or meets backs.
    pub(super) lost: Vec<f32>,
    /// Of each cluster.
    pub(super) moments: Vec<Moments>,
    /// Of each cluster, the power of the emission in it; the largest channel.
    pub(super) emitted: Vec<f32>,
    /// Of each lamp.
    pub(super) lamp_radiance: Vec<Vec4>,
}

pub(super) fn rgb1(color: LinearRgb, fourth: f32) -> Vec4 {
    Vec4::new(color.r, color.g, color.b, fourth)
}

pub(super) fn rgb(value: Vec4) -> LinearRgb {
    LinearRgb::new(value.x, value.y, value.z)
}

/// The largest of the channels of light.
pub(super) fn brightness(value: Vec4) -> f32 {
    value.x.max(value.y).max(value.z)
}

impl State {
    /// Everything dark but what emits.
    pub(super) fn new(mesh: &ElementMesh, clusters: &Clusters) -> Self {
        let mut state = Self {
            moments: vec![Moments::default(); clusters.len()],
            emitted: vec![0.0; clusters.len()],
            ..Self::default()
        };
        state.follow_mesh(mesh);
        state.gather_moments(mesh, clusters);
        state.emitted = state.moments.iter().map(|moments| brightness(moments.power)).collect();
        state
    }

    /// Gives new elements the values of what they are part of.
    pub(super) fn follow_mesh(&mut self, mesh: &ElementMesh) {
        for number in self.radiosity.len()..mesh.elements().len() {
            let parent = mesh.elements()[number].parent as usize;
            let known = parent < number;
            let emission = rgb1(mesh.surface(number as u32).emission, 1.0);
            self.radiosity.push(if known { self.radiosity[parent] } else { emission });
            for values in [&mut self.incident, &mut self.lamp_light] {
                let value = if known { values[parent] } else { Vec4::ZERO };
                values.push(value);
            }
            self.spread.push(0.0);
            let lost = f32::NAN;
            self.lost.push(lost);
        }
    }

    /// Gives elements for which it is not known yet the loss of what they are part of.
    pub(super) fn keep_lost(&mut self, mesh: &ElementMesh) {
        for number in 0..self.lost.len() {
            let parent = mesh.elements()[number].parent as usize;
            if self.lost[number].is_nan() && parent < number {
                self.lost[number] = self.lost[parent];
            }
        }
    }

    /// Sums what polygons send over the clusters that hold them.
    pub(super) fn gather_moments(&mut self, mesh: &ElementMesh, clusters: &Clusters) {
        self.moments.fill(Moments::default());
        for polygon in 0..mesh.polygons().len() {
            let power = self.radiosity[polygon] * mesh.elements()[polygon].area as f32;
            let cluster = clusters.cluster_of(polygon as u32) as usize;
            self.moments[cluster].add_polygon(power, mesh.polygons()[polygon].normal);
        }
        for cluster in (1..clusters.len()).rev() {
            let sum = self.moments[cluster];
            self.moments[clusters.get(cluster as u32).parent as usize].add(&sum);
        }
    }

    /// Sets the values of divided elements to the means of their leaves, and all radiosities.
    pub(super) fn pull(&mut self, mesh: &ElementMesh) {
        for number in (0..mesh.elements().len()).rev() {
            let element = &mesh.elements()[number];
            if element.is_leaf() {
                let surface = mesh.surface(number as u32);
                let incident = self.incident[number] + self.lamp_light[number];
                let sent = rgb1(surface.emission, 1.0) + rgb1(surface.reflectance, 0.0) * incident;
                self.radiosity[number] = sent;
                self.spread[number] = 0.0;
                continue;
            }
            let parts = || element.part_numbers().map(|part| part as usize);
            let scale = 1.0 / parts().map(|part| mesh.elements()[part].area as f32).sum::<f32>();
            let scale = if scale.is_finite() { scale } else { 0.0 };
            for values in [&mut self.radiosity, &mut self.incident, &mut self.lamp_light] {
                let sum = parts().map(|part| values[part] * mesh.elements()[part].area as f32).sum::<Vec4>();
                values[number] = sum * scale;
            }
            self.radiosity[number].w = 1.0;
            let mean = self.radiosity[number];
            let off = |part: usize| brightness((self.radiosity[part] - mean).abs()) + self.spread[part];
            self.spread[number] = parts().map(off).fold(0.0, f32::max);
        }
    }

    /// What a node sends in a direction: radiosity times area times cosine. Four channels.
    pub(super) fn sent(
        &self,
        source: Node,
        facet: Option<&Facet>,
        direction: DVec3,
        parts: &Parts<'_>,
    ) -> Vec4 {
        match (source.as_cluster(), facet) {
            (Some(cluster), _) => self.sent_by_cluster(cluster, direction, parts),
            (None, Some(facet)) => {
                let cosine = facet.normal.dot(direction).max(0.0);
                self.radiance(source) * (facet.area * cosine) as f32
            }
            (None, None) => Vec4::ZERO,
        }
    }

    /// The sum over the polygons where they are few, else by moments.
    pub(super) fn sent_by_cluster(&self, cluster: u32, direction: DVec3, parts: &Parts<'_>) -> Vec4 {
        let polygons = parts.clusters.polygons(cluster);
        if polygons.len() > FEW {
            return self.moments[cluster as usize].towards(direction.as_vec3());
        }
        let by_polygon = |&polygon: &u32| {
            let cosine = parts.mesh.polygons()[polygon as usize].normal.dot(direction).max(0.0);
            let area = parts.mesh.elements()[polygon as usize].area;
            self.radiosity[polygon as usize] * (area * cosine) as f32
        };
        polygons.iter().map(by_polygon).sum()
    }

    /// What a node sends in all directions.
    pub(super) fn power(&self, source: Node, facet: Option<&Facet>) -> Vec4 {
        match (source.as_cluster(), facet) {
            (Some(cluster), _) => self.moments[cluster as usize].power,
            (None, Some(facet)) => self.radiance(source) * facet.area as f32,
            (None, None) => Vec4::ZERO,
        }
    }

    /// Radiosity of an element or a lamp.
    #[inline]
    pub(super) fn radiance(&self, source: Node) -> Vec4 {
        match source.as_lamp() {
            Some(lamp) => self.lamp_radiance[lamp as usize],
            None => self.radiosity[source.index()],
        }
    }
}

/// Unit vector and length; zero and zero where there is no way.
pub(super) fn way(from: DVec3, to: DVec3) -> (DVec3, f64) {
    let way = to - from;
    let length = way.length();
    if length > 0.0 { (way / length, length) } else { (DVec3::ZERO, 0.0) }
}
