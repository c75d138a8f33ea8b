//! A link: light goes from one node to another.

use super::node::Node;

/// Light goes from `source` to `receiver`, which may each be a polygon, a part of one, or a cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Link {
    pub(super) receiver: Node,
    pub(super) source: Node,
    /// What arrives, as a share of what the source sends, if nothing is between. Between elements the
    /// form factor. A cluster as source is counted by what it sends in this direction, a cluster as
    /// receiver by what a surface in it would get that faces the source.
    pub(super) factor: f32,
    /// How much the factor varies over the receiver.
    pub(super) spread: f32,
    /// Share of the light that is not blocked.
    pub(super) visibility: f32,
    /// Rays that the visibility rests on; 0 while it is not known.
    pub(super) rays: u16,
}

impl Link {
    pub(super) const fn new(receiver: Node, source: Node) -> Self {
        Self { receiver, source, factor: 0.0, spread: 0.0, visibility: 1.0, rays: 0 }
    }

    /// Share of what the source sends that arrives.
    #[inline]
    pub(super) fn weight(&self) -> f32 {
        self.factor * self.visibility
    }
}
