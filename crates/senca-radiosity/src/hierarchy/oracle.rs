//! Which links are good enough, and what to divide of the others.
//!
//! The error of a link is bounded by what it would carry, in power: the radiosity of the source, times
//! the area of the receiver, times how uncertain the form factor is (Hanrahan, Salzman and Aupperle
//! 1991). A form factor is uncertain
//!
//! 1. by how much it varies over the receiver,
//! 2. where light is blocked in part; by a little also where a few rays found it free or blocked,
//! 3. by how much the radiosity varies over the source,
//! 4. where clusters take part, by how large they are for their distance (Smits, Arvo and Greenberg
//!    1994): of the source in the second power, as what is nearer and what is farther makes up for each
//!    other.

use std::f64::consts::PI;

use senca_math::glam::DVec3;

use super::exchange::Parts;
use super::facet::{Facet, Share};
use super::link::Link;
use super::node::Node;
use super::sight::Sight;
use super::state::{State, brightness, way};

/// What is to happen to a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// No light can ever go along it.
    Drop,
    Keep,
    SplitReceiver,
    SplitSource,
    /// A cluster with itself: all pairs of its children.
    SplitBoth,
}

/// Rays of weak, fair and strong links, and of those that cannot be divided although they should.
const RAYS: [u16; 4] = [4, 8, 16, 48];

/// What parts of a source may differ by, as a share of the light at a receiver, however small that is.
const BLUR: f64 = 0.05;

/// How far from its corners, as a share of the way to its middle, an element is looked at there.
const INSET: f64 = 0.1;

/// Links that carry less than this share of the threshold are weak.
const WEAK: f64 = 0.1;

/// Links that carry more than this many thresholds are strong.
const STRONG: f64 = 10.0;

/// Where all rays agree, what is still uncertain is this share of a ray.
const UNSEEN: f64 = 0.25;

/// Where light is blocked in part, so many times more is at stake: a link shares what passes out over
/// the whole receiver, and many such links behind a wall add up.
const SHADOW: f64 = 8.0;

/// Where light is blocked in part, the source is divided if it is this many times larger.
const RELUCTANCE: f64 = 4.0;

/// Clusters nearer than this many sums of their radii may overlap.
const NEAR: f64 = 1.0;

/// Decides on links.
#[derive(Clone, Copy, Debug)]
pub(super) struct Oracle<'a> {
    pub(super) sight: Sight<'a>,
    pub(super) state: &'a State,
    /// Power that a link may be wrong by, largest channel.
    pub(super) threshold: f64,
    /// The same for light that comes straight from emitters and lamps.
    pub(super) direct_threshold: f64,
    /// Elements of less area are not divided, in square world units.
    pub(super) smallest_area: f64,
}

impl Oracle<'_> {
    /// Judges a link, and estimates what is not known of it.
    pub(super) fn judge(&self, link: &mut Link) -> Verdict {
        let clusters = [link.receiver, link.source].map(Node::as_cluster);
        match clusters {
            [None, None] => self.judge_facets(link),
            [Some(_), Some(_)] if link.receiver == link.source => self.judge_self(link),
            _ => self.judge_clusters(link),
        }
    }

    fn facet(&self, node: Node) -> Option<Facet> {
        self.sight.facet(node)
    }

    /// Two elements, or a lamp and an element.
    fn judge_facets(&self, link: &mut Link) -> Verdict {
        let (Some(receiver), Some(source)) = (self.facet(link.receiver), self.facet(link.source)) else {
            return Verdict::Drop;
        };
        let bright = f64::from(brightness(self.state.radiance(link.source)));
        let threshold = self.threshold_of(link.source);
        if link.rays == 0 {
            if receiver.area <= 0.0 || source.area <= 0.0 || !receiver.can_see(&source) {
                return Verdict::Drop;
            }
            let share = self.share_of(link, &receiver, &source);
            link.factor = share.mean as f32;
            // All places may be below a horizon that others are above of.
            let unseen = if share.mean > 0.0 { 0.0 } else { at_most(&receiver, &source) };
            link.spread = share.spread.max(unseen) as f32;
            let strength = bright * (share.mean + share.spread) * receiver.area;
            self.cast(link, rays_for(strength, threshold));
        }
        let [factor, spread, open] = [link.factor, link.spread, link.visibility].map(f64::from);
        let mut unsure = uncertainty(open, link.rays);
        if open > 0.0 && open < 1.0 {
            unsure *= SHADOW;
        }
        let by_receiver = bright * (spread * open.max(0.1) + factor * unsure);
        let by_source = self.variation(link.source) * factor * open.max(unsure);
        if receiver.area * (by_receiver + by_source) <= threshold {
            let mixed = bright * factor * open.min(1.0 - open);
            let blurred = by_source + mixed > BLUR * self.light_at(link.receiver);
            let has_parts = link
                .source
                .as_element()
                .is_some_and(|source| !self.sight.mesh.elements()[source as usize].is_leaf());
            return if blurred && has_parts { Verdict::SplitSource } else { Verdict::Keep };
        }
        // Parts of a source would share the error out to links that look good enough one by one.
        let shadow = factor * unsure > spread;
        let larger = source.radius > RELUCTANCE * receiver.radius;
        let source_first = by_source > by_receiver || (shadow && larger);
        let verdict = self.split(link, [receiver.area, source.area], source_first);
        if verdict == Verdict::Keep && open > 0.0 && open < 1.0 && link.rays < RAYS[3] {
            self.cast(link, RAYS[3]);
        }
        verdict
    }

    /// Light that is known to arrive at an element; endless while none is.
    fn light_at(&self, node: Node) -> f64 {
        let number = node.index();
        let light = f64::from(brightness(self.state.incident[number] + self.state.lamp_light[number]));
        if light > 0.0 { light } else { f64::INFINITY }
    }

    /// Mean over the open part of the receiver of the share that the source's takes up.
    fn share_of(&self, link: &Link, receiver: &Facet, source: &Facet) -> Share {
        let [to, from] = [link.receiver, link.source].map(|node| self.sight.part(node));
        let share_at = |place: DVec3| source.share_of_part_at(from, place, receiver.normal);
        let share = match to {
            Some(part) if part.shape.is_none() => receiver.share_at_all(&part.places(), share_at),
            _ => receiver.share_at_all(&receiver.places(), share_at),
        };
        if !receiver.is_near(source) {
            return share;
        }
        // Where the two touch, a corner may see much of what no place inside does.
        let corners = receiver.shape.corners().iter();
        let shares = corners.map(|corner| share_at(corner.lerp(receiver.center, INSET)));
        let most = shares.fold(0.0, f64::max);
        Share { spread: share.spread.max(most - share.mean), ..share }
    }

    /// A cluster with itself.
    fn judge_self(&self, link: &mut Link) -> Verdict {
        let Some(cluster) = link.receiver.as_cluster() else {
            return Verdict::Drop;
        };
        let power = f64::from(brightness(self.state.moments[cluster as usize].power));
        if link.rays == 0 {
            link.rays = RAYS[1];
            link.factor = self.sight.mean_exchange(cluster, RAYS[1].into()) as f32;
        }
        if power > self.threshold_of(link.source) { Verdict::SplitBoth } else { Verdict::Keep }
    }

    /// A cluster and something else.
    fn judge_clusters(&self, link: &mut Link) -> Verdict {
        let Sight { mesh, clusters, lamps, .. } = self.sight;
        let parts = Parts { mesh, clusters, lamps };
        let [from, to] = [self.extent(link.source), self.extent(link.receiver)];
        let facets = [self.facet(link.source), self.facet(link.receiver)];
        if link.rays == 0 && self.is_behind(link, &facets) {
            return Verdict::Drop;
        }
        let (direction, distance) = way(from.center, to.center);
        let reach = distance.max(0.5 * (from.radius + to.radius));
        let near = distance <= NEAR * (from.radius + to.radius);
        let sent = f64::from(brightness(self.state.sent(link.source, facets[0].as_ref(), direction, &parts)));
        let most = f64::from(brightness(self.state.power(link.source, facets[0].as_ref())));
        let cosine = facets[1].map_or(1.0, |facet| facet.normal.dot(-direction).max(0.0));
        let per_area = 1.0 / (PI * reach * reach);
        let carried = if near { most * per_area } else { sent * cosine * per_area } * to.area;
        let threshold = self.threshold_of(link.source);
        if near && carried > threshold {
            return self.split(link, [to.radius, from.radius], from.radius > to.radius);
        }
        if link.rays == 0 {
            link.factor = (per_area * cosine) as f32;
            self.cast(link, rays_for(carried, threshold));
        }
        let open = f64::from(link.visibility);
        let relative = (from.radius / reach).powi(2) + 0.5 * to.radius / reach;
        let unsure = relative.min(1.0) * open.max(0.1) + 0.5 * uncertainty(open, link.rays);
        if carried * unsure <= threshold {
            return Verdict::Keep;
        }
        self.split(link, [to.radius, from.radius], from.radius > to.radius)
    }

    /// Divides one of the two, the other where the first cannot be divided.
    fn split(&self, link: &Link, [receiver, source]: [f64; 2], source_first: bool) -> Verdict {
        let can = [link.source, link.receiver].map(|node| self.can_be_divided(node));
        match can {
            [true, _] if source_first => Verdict::SplitSource,
            [_, true] => Verdict::SplitReceiver,
            [true, false] if source > receiver => Verdict::SplitSource,
            _ => Verdict::Keep,
        }
    }

    fn can_be_divided(&self, node: Node) -> bool {
        if node.as_cluster().is_some() {
            return true;
        }
        let Some(element) = node.as_element() else {
            return false;
        };
        let element = &self.sight.mesh.elements()[element as usize];
        let small = element.area <= self.smallest_area || element.level >= crate::mesh::MAX_LEVEL;
        !element.is_leaf() || !small
    }

    /// The finer threshold where most of what the source sends is its own light.
    fn threshold_of(&self, source: Node) -> f64 {
        let own = match (source.as_cluster(), source.as_lamp()) {
            (Some(cluster), _) => {
                let all = brightness(self.state.moments[cluster as usize].power);
                self.state.emitted[cluster as usize] > 0.5 * all
            }
            (None, Some(_)) => true,
            (None, None) => {
                let element = source.index();
                let emission = self.sight.mesh.surface(element as u32).emission;
                emission.max_component() > 0.5 * brightness(self.state.radiosity[element])
            }
        };
        if own { self.direct_threshold } else { self.threshold }
    }

    /// How far parts of a source are from its mean.
    fn variation(&self, source: Node) -> f64 {
        source.as_element().map_or(0.0, |element| 0.5 * f64::from(self.state.spread[element as usize]))
    }

    fn cast(&self, link: &mut Link, rays: u16) {
        link.rays = rays;
        link.visibility = self.sight.visibility(link.receiver, link.source, rays.into()) as f32;
    }

    fn extent(&self, node: Node) -> Extent {
        if let Some(cluster) = node.as_cluster() {
            let cluster = self.sight.clusters.get(cluster);
            // About half of the surfaces face any one direction.
            return Extent {
                center: cluster.bounds.center(),
                radius: cluster.radius,
                area: 0.5 * cluster.area,
            };
        }
        self.facet(node).map_or(Extent::default(), |facet| Extent {
            center: facet.center,
            radius: facet.radius,
            area: facet.area,
        })
    }

    /// Whether a cluster is wholly behind the element that it is linked with.
    fn is_behind(&self, link: &Link, [source, receiver]: &[Option<Facet>; 2]) -> bool {
        let behind = |facet: &Option<Facet>, other: Node| {
            let (Some(facet), Some(cluster)) = (facet, other.as_cluster()) else {
                return false;
            };
            !facet.has_in_front(&self.sight.clusters.get(cluster).bounds.corners())
        };
        behind(source, link.receiver) || behind(receiver, link.source)
    }
}

/// Size and place of a node.
#[derive(Clone, Copy, Debug, Default)]
struct Extent {
    center: DVec3,
    radius: f64,
    area: f64,
}

/// Rays for a link that carries this much.
fn rays_for(carried: f64, threshold: f64) -> u16 {
    let [weak, fair, strong, _] = RAYS;
    if carried < WEAK * threshold {
        weak
    } else if carried < STRONG * threshold {
        fair
    } else {
        strong
    }
}

/// How far a visibility may be from what it is over parts.
fn uncertainty(open: f64, rays: u16) -> f64 {
    let mixed = open.min(1.0 - open);
    mixed.max(UNSEEN / (f64::from(rays) + 2.0))
}

/// A bound for the form factor of two facets, by their least distance.
fn at_most(receiver: &Facet, source: &Facet) -> f64 {
    let apart = (receiver.center.distance(source.center) - receiver.radius - source.radius).max(0.0);
    let squared = PI * apart * apart;
    if squared > source.area { source.area / squared } else { 1.0 }
}
