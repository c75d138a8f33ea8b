//! Light goes along the links: gathered at nodes, pushed down to leaves, pulled up again.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;
use senca_math::glam::{DVec3, Vec3, Vec4};
use smallvec::SmallVec;

use super::cluster::Clusters;
use super::link::Link;
use super::node::Node;
use super::state::{State, way};
use crate::ElementMesh;
use crate::hierarchy::facet::Facet;

/// Nodes that one task of a thread takes at least.
const GRAIN: usize = 256;

/// Links in the order of their receivers.
#[derive(Clone, Debug, Default)]
pub(super) struct Network {
    /// What arrives at elements: source and weight.
    to_elements: Vec<(Node, f32)>,
    /// Where those of each element begin, and an end.
    element_start: Vec<u32>,
    to_clusters: Vec<(Node, f32)>,
    cluster_start: Vec<u32>,
}

/// Light on its way to the polygons of a cluster.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    /// Where it comes from; what comes from the cluster itself comes from all sides.
    from: Option<Vec3>,
    /// The least distance squared that counts.
    least: f32,
    /// What a surface gets that faces it, times the distance squared.
    light: Vec4,
}

/// What is solved with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts<'a> {
    pub(super) mesh: &'a ElementMesh,
    pub(super) clusters: &'a Clusters,
    pub(super) lamps: &'a [Facet],
}

impl Network {
    /// Links whose source `chosen` agrees to, of a mesh that is not divided any more.
    pub(super) fn new(links: &[Link], parts: &Parts<'_>, chosen: impl Fn(Node) -> bool) -> Self {
        let of_use = || links.iter().filter(|link| link.weight() > 0.0 && chosen(link.source));
        let to_element = |link: &&Link| link.receiver.as_cluster().is_none();
        let (to_elements, element_start) =
            by_receiver(|| of_use().filter(to_element), parts.mesh.elements().len());
        let (to_clusters, cluster_start) =
            by_receiver(|| of_use().filter(|link| !to_element(link)), parts.clusters.len());
        Self { to_elements, element_start, to_clusters, cluster_start }
    }

    pub(super) fn len(&self) -> usize {
        self.to_elements.len() + self.to_clusters.len()
    }

    /// Light that arrives at each element by all links to it and to what holds it. The values of
    /// divided elements are not of use. Elements that are newer than the network have what holds them.
    pub(super) fn gather(&self, parts: &Parts<'_>, state: &State) -> Vec<Vec4> {
        let arrivals = self.arrivals(parts, state);
        let polygons = parts.mesh.polygons().len();
        let own: Vec<Vec4> = (0..parts.mesh.elements().len())
            .into_par_iter()
            .with_min_len(GRAIN)
            .map(|element| {
                if element + 1 >= self.element_start.len() {
                    return Vec4::ZERO;
                }
                let own = self.at_element(element, parts, state);
                if element < polygons { own + self.at_polygon(element, parts, &arrivals) } else { own }
            })
            .collect();
        let elements = parts.mesh.elements();
        let with_above = |element: usize| {
            let mut path: SmallVec<[Vec4; 24]> = SmallVec::new();
            let mut at = element;
            while at >= polygons {
                path.push(own[at]);
                at = elements[at].parent as usize;
            }
            path.iter().rev().fold(own[at], |sum, &more| sum + more)
        };
        let light =
            |element: usize| if elements[element].is_leaf() { with_above(element) } else { own[element] };
        (0..own.len()).into_par_iter().with_min_len(GRAIN).map(light).collect()
    }

    fn at_element(&self, element: usize, parts: &Parts<'_>, state: &State) -> Vec4 {
        let mut sum = Vec4::ZERO;
        for &(source, weight) in &self.to_elements[range(&self.element_start, element)] {
            sum += weight
                * match source.as_cluster() {
                    Some(cluster) => {
                        let from = parts.clusters.get(cluster).bounds.center();
                        let (direction, _) = way(from, parts.mesh.elements()[element].center);
                        state.sent_by_cluster(cluster, direction, parts)
                    }
                    None => state.radiance(source),
                };
        }
        sum
    }

    /// Light for a polygon by the links of the clusters that hold it.
    fn at_polygon(&self, polygon: usize, parts: &Parts<'_>, arrivals: &[Arrival]) -> Vec4 {
        let center = parts.mesh.elements()[polygon].center.as_vec3();
        let normal = parts.mesh.polygons()[polygon].normal.as_vec3();
        let mut sum = Vec4::ZERO;
        let mut cluster = parts.clusters.cluster_of(polygon as u32);
        while cluster != crate::NONE {
            for arrival in &arrivals[range(&self.cluster_start, cluster as usize)] {
                sum += arrival.at(center, normal);
            }
            cluster = parts.clusters.get(cluster).parent;
        }
        sum
    }

    /// What is on its way along the links to clusters.
    fn arrivals(&self, parts: &Parts<'_>, state: &State) -> Vec<Arrival> {
        let of_cluster = |cluster: usize| {
            let links = &self.to_clusters[range(&self.cluster_start, cluster)];
            let receiver = Node::cluster(cluster as u32);
            links.iter().map(move |&(source, weight)| arrival(receiver, source, weight, parts, state))
        };
        let all = (0..parts.clusters.len()).into_par_iter().with_min_len(GRAIN);
        all.flat_map_iter(of_cluster).collect()
    }
}

impl Arrival {
    #[inline]
    fn at(&self, center: Vec3, normal: Vec3) -> Vec4 {
        let Some(from) = self.from else {
            return self.light;
        };
        let way = from - center;
        let facing = normal.dot(way);
        if facing <= 0.0 {
            return Vec4::ZERO;
        }
        let squared = way.length_squared();
        self.light * (facing / (squared.sqrt() * squared.max(self.least)))
    }
}

fn arrival(receiver: Node, source: Node, weight: f32, parts: &Parts<'_>, state: &State) -> Arrival {
    let cluster = parts.clusters.get(receiver.index() as u32);
    if receiver == source {
        let light = state.moments[source.index()].power * weight;
        return Arrival { from: None, least: 0.0, light };
    }
    let facet = facet_of(source, parts);
    let (from, radius) = match (&facet, source.as_cluster()) {
        (None, Some(number)) => {
            let source = parts.clusters.get(number);
            (source.bounds.center(), source.radius)
        }
        (facet, _) => facet.map_or((DVec3::ZERO, 0.0), |facet| (facet.center, facet.radius)),
    };
    let (direction, distance) = way(from, cluster.bounds.center());
    let reach = distance.max(0.5 * (radius + cluster.radius));
    // The weight is for the middle of the receiver, and holds the visibility.
    let open = f64::from(weight) * PI * reach * reach;
    let sent = state.sent(source, facet.as_ref(), direction, parts);
    let least = (0.5 * radius).powi(2).max(1e-6 * reach * reach) as f32;
    Arrival { from: Some(from.as_vec3()), least, light: sent * (open / PI) as f32 }
}

fn facet_of(node: Node, parts: &Parts<'_>) -> Option<Facet> {
    match node.as_lamp() {
        Some(lamp) => Some(parts.lamps[lamp as usize]),
        None => node.as_element().map(|element| Facet::of_share(parts.mesh, element)),
    }
}

fn range(start: &[u32], node: usize) -> Range<usize> {
    start[node] as usize..start[node + 1] as usize
}

/// Sources and weights in the order of receivers, with where those of each receiver begin.
fn by_receiver<'l, I>(links: impl Fn() -> I, receivers: usize) -> (Vec<(Node, f32)>, Vec<u32>)
where
    I: Iterator<Item = &'l Link>,
{
    let mut start = vec![0u32; receivers + 1];
    for link in links() {
        start[link.receiver.index() + 1] += 1;
    }
    for receiver in 0..receivers {
        start[receiver + 1] += start[receiver];
    }
    let mut next = start.clone();
    let mut sorted = vec![(Node::element(0), 0.0); start[receivers] as usize];
    for link in links() {
        let place = &mut next[link.receiver.index()];
        sorted[*place as usize] = (link.source, link.weight());
        *place += 1;
    }
    (sorted, start)
}
