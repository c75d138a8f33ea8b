//! Light on nodes during a solution.

use rayon::prelude::*;
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

/// Elements that one task of a thread takes at least.
const GRAIN: usize = 2048;

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
    /// Divided elements by level, of a mesh of `levels_of` elements.
    levels: Vec<Vec<u32>>,
    levels_of: usize,
}

/// Values of a divided element.
struct Means {
    radiosity: Vec4,
    incident: Vec4,
    lamp_light: Vec4,
    spread: f32,
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
            let power = self.radiosity[polygon] * mesh.elements()[polygon].open_area() as f32;
            let cluster = clusters.cluster_of(polygon as u32) as usize;
            self.moments[cluster].add_polygon(power, mesh.polygons()[polygon].normal);
        }
        for cluster in (1..clusters.len()).rev() {
            let sum = self.moments[cluster];
            self.moments[clusters.get(cluster as u32).parent as usize].add(&sum);
        }
    }

    /// Sets the values of divided elements to the means of their leaves, and all radiosities. All elements
    /// of a level are means of those of the next, whatever thread computes them.
    pub(super) fn pull(&mut self, mesh: &ElementMesh) {
        self.light_leaves(mesh);
        self.know_levels(mesh);
        for level in self.levels.iter().rev() {
            let means =
                level.par_iter().with_min_len(GRAIN / 8).map(|&number| self.mean_of_parts(mesh, number));
            let means: Vec<Means> = means.collect();
            for (&number, means) in level.iter().zip(means) {
                let number = number as usize;
                self.radiosity[number] = means.radiosity;
                self.incident[number] = means.incident;
                self.lamp_light[number] = means.lamp_light;
                self.spread[number] = means.spread;
            }
        }
    }

    fn light_leaves(&mut self, mesh: &ElementMesh) {
        let light = self.incident.par_iter().zip(&self.lamp_light).with_min_len(GRAIN);
        let sent = self.radiosity.par_iter_mut().zip(&mut self.spread).zip(light).enumerate();
        sent.for_each(|(number, ((radiosity, spread), (&incident, &lamps)))| {
            if mesh.elements()[number].is_leaf() {
                let surface = mesh.surface(number as u32);
                let reflected = rgb1(surface.reflectance, 0.0) * (incident + lamps);
                (*radiosity, *spread) = (rgb1(surface.emission, 1.0) + reflected, 0.0);
            }
        });
    }

    /// Finds the divided elements by level, when there are new ones.
    fn know_levels(&mut self, mesh: &ElementMesh) {
        if self.levels_of == mesh.elements().len() {
            return;
        }
        self.levels_of = mesh.elements().len();
        self.levels.iter_mut().for_each(Vec::clear);
        for (number, element) in (0..).zip(mesh.elements()).filter(|(_, element)| !element.is_leaf()) {
            let level = usize::from(element.level);
            if self.levels.len() <= level {
                self.levels.resize(level + 1, Vec::new());
            }
            self.levels[level].push(number);
        }
    }

    fn mean_of_parts(&self, mesh: &ElementMesh, number: u32) -> Means {
        let parts = || mesh.elements()[number as usize].part_numbers().map(|part| part as usize);
        let area = |part: usize| mesh.elements()[part].open_area() as f32;
        let scale = 1.0 / parts().map(area).sum::<f32>();
        let scale = if scale.is_finite() { scale } else { 0.0 };
        let mean = |values: &[Vec4]| parts().map(|part| values[part] * area(part)).sum::<Vec4>() * scale;
        let radiosity = mean(&self.radiosity).with_w(1.0);
        let off = |part: usize| brightness((self.radiosity[part] - radiosity).abs()) + self.spread[part];
        let open = parts().filter(|&part| mesh.elements()[part].open > 0.0);
        let spread = open.map(off).fold(0.0, f32::max);
        Means { radiosity, incident: mean(&self.incident), lamp_light: mean(&self.lamp_light), spread }
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
            let area = parts.mesh.elements()[polygon as usize].open_area();
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
