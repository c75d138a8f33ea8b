//! How much of one node is seen from another: ways between places on both.

use senca_math::glam::{DVec3, DVec4};

use super::cluster::Clusters;
use super::facet::Facet;
use super::node::Node;
use crate::open_parts::{OpenPart, OpenParts};
use crate::{ElementMesh, Occluders};

/// Fractional parts of the multiples of these four spread evenly over the unit cube of four
/// dimensions: inverse powers of the root of x^5 = x + 1 (Roberts 2018).
const EVEN: DVec4 = DVec4::new(
    0.856_674_883_854_502_9,
    0.733_891_856_627_126,
    0.628_706_721_048_534_9,
    0.538_597_257_224_541_5,
);

/// Another place of a cluster is tried when one faces away, so many times.
const TRIES: u32 = 4;

/// Where rays between nodes start and end, and what stops them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'a> {
    pub(super) mesh: &'a ElementMesh,
    pub(super) clusters: &'a Clusters,
    pub(super) occluders: &'a Occluders,
    pub(super) lamps: &'a [Facet],
    pub(super) open: &'a OpenParts,
}

/// A place on a surface, with the surface's normal.
type Place = (DVec3, DVec3);

impl Sight<'_> {
    /// Share of the light from `source` that arrives at `receiver`, in [0, 1], by `rays` ways between
    /// places on both, each weighted by what it would carry. The places depend on the two alone.
    pub(super) fn visibility(&self, receiver: Node, source: Node, rays: u32) -> f64 {
        let shift = shift_of(receiver, source);
        let (mut all, mut seen) = (0.0, 0.0);
        for ray in 1..=rays {
            let at = (shift + EVEN * f64::from(ray)).fract_gl();
            let (to, receiving) = self.place(receiver, [at.x, at.y], self.middle(source));
            let (from, sending) = self.place(source, [at.z, at.w], to);
            let weight = carried((to, receiving), (from, sending));
            if weight > 0.0 {
                all += weight;
                seen += weight * self.passing(from, to);
            }
        }
        if all > 0.0 { seen / all } else { 0.0 }
    }

    /// The open part of an element that is cut.
    pub(super) fn part(&self, node: Node) -> Option<&OpenPart> {
        node.as_element().and_then(|element| self.open.get(self.mesh, element))
    }

    /// An element or a lamp.
    pub(super) fn facet(&self, node: Node) -> Option<Facet> {
        if let Some(lamp) = node.as_lamp() {
            return Some(self.lamps[lamp as usize]);
        }
        node.as_element().map(|element| Facet::of_open(self.mesh, self.open, element))
    }

    /// Mean over pairs of places on a cluster of cosines over squared distance and pi, where they see
    /// each other: what arrives per area, as a share of the power that is sent.
    pub(super) fn mean_exchange(&self, cluster: u32, rays: u32) -> f64 {
        let node = Node::cluster(cluster);
        let area = self.clusters.get(cluster).area;
        let shift = shift_of(node, node);
        let one = |ray: u32| {
            let at = (shift + EVEN * f64::from(ray)).fract_gl();
            let to = self.surface_place(cluster, [at.x, at.y]);
            let from = self.surface_place(cluster, [at.z, at.w]);
            // No more may arrive than is sent.
            let share = carried(to, from) * (from.0 - to.0).length_squared();
            let share =
                share.min(1.0) / (std::f64::consts::PI * (from.0 - to.0).length_squared().max(area / 8.0));
            if share > 0.0 { share * self.passing(from.0, to.0) } else { 0.0 }
        };
        let mean = (1..=rays).map(one).sum::<f64>() / f64::from(rays.max(1));
        if area > 0.0 { mean.min(1.0 / area) } else { 0.0 }
    }

    fn surface_place(&self, cluster: u32, [share, v]: [f64; 2]) -> Place {
        let polygon = self.clusters.polygon_at(cluster, share);
        // What is left of the digits that chose the polygon is spread evenly enough.
        let along = (share * 4096.0 + v * 0.618_033_988_749_895).fract();
        (self.open.place(self.mesh, polygon, along, v), self.mesh.normal(polygon))
    }

    /// Share of light that passes between two places.
    fn passing(&self, from: DVec3, to: DVec3) -> f64 {
        if self.occluders.all_opaque() {
            return if self.occluders.visible(from, to) { 1.0 } else { 0.0 };
        }
        let share = self.occluders.transmittance(from, to);
        f64::from(share.r + share.g + share.b) / 3.0
    }

    fn middle(&self, node: Node) -> DVec3 {
        if let Some(cluster) = node.as_cluster() {
            return self.clusters.get(cluster).bounds.center();
        }
        match node.as_lamp() {
            Some(lamp) => self.lamps[lamp as usize].center,
            None => self.mesh.elements()[node.index()].center,
        }
    }

    fn place(&self, node: Node, at: [f64; 2], towards: DVec3) -> Place {
        if let Some(cluster) = node.as_cluster() {
            return self.place_in_cluster(cluster, at, towards);
        }
        let [u, v] = at;
        match node.as_lamp() {
            Some(lamp) => {
                let lamp = &self.lamps[lamp as usize];
                (lamp.shape.place(u, v), lamp.normal)
            }
            None => {
                let element = node.index() as u32;
                (self.open.place(self.mesh, element, u, v), self.mesh.normal(element))
            }
        }
    }

    /// A place on the surfaces of a cluster, one that faces `towards` if that is found.
    fn place_in_cluster(&self, cluster: u32, [u, v]: [f64; 2], towards: DVec3) -> Place {
        let mut place = (DVec3::ZERO, DVec3::Z);
        for attempt in 0..TRIES {
            let share = (u + f64::from(attempt) * 0.381_966_011_250_105).fract();
            place = self.surface_place(cluster, [share, v]);
            if place.1.dot(towards - place.0) > 0.0 {
                break;
            }
        }
        place
    }
}

/// What a way between two places carries: cosines over squared distance.
fn carried((to, receiving): Place, (from, sending): Place) -> f64 {
    let way = from - to;
    let cosines = receiving.dot(way).max(0.0) * sending.dot(-way).max(0.0);
    let squared = way.length_squared();
    if squared > 0.0 { cosines / (squared * squared) } else { 0.0 }
}

/// Where in the unit cube the ways between two nodes begin.
fn shift_of(receiver: Node, source: Node) -> DVec4 {
    let first = mix(u64::from(receiver.key()) << 32 | u64::from(source.key()));
    let second = mix(first ^ 0x9e37_79b9_7f4a_7c15);
    let unit = |bits: u64| f64::from((bits & 0xffff_ffff) as u32) / 4_294_967_296.0;
    DVec4::new(unit(first), unit(first >> 32), unit(second), unit(second >> 32))
}

/// Stirs 64 bits so that each depends on all (the finalizer of SplitMix, Steele et al. 2014).
pub(super) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
