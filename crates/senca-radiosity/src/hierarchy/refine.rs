//! Dividing what links join until every link is good enough.
//!
//! In waves: all links are judged at once, each by itself, and what is to be divided is then divided
//! in the order of the links. So the result does not depend on how many threads judge.

use rayon::prelude::*;

use super::cluster::Clusters;
use super::link::Link;
use super::node::Node;
use super::oracle::{Oracle, Verdict};
use crate::ElementMesh;

/// Links that one task of a thread judges at least.
const GRAIN: usize = 64;

/// What refinement may use up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) elements: usize,
    pub(super) links: usize,
}

/// Verdicts on links, which are brought up to date.
pub(super) fn judge_all(oracle: &Oracle<'_>, links: &mut [Link]) -> Vec<Verdict> {
    links.par_iter_mut().with_min_len(GRAIN).map(|link| oracle.judge(link)).collect()
}

/// Carries verdicts out: links that stay go to `kept`, those that take the place of others are
/// returned. Tells by `limits` whether all that was asked for could be done.
pub(super) fn apply(
    mesh: &mut ElementMesh,
    clusters: &Clusters,
    judged: &[(Link, Verdict)],
    kept: &mut Vec<Link>,
    limits: &Limits,
) -> (Vec<Link>, bool) {
    let (mut next, mut within) = (Vec::new(), true);
    for &(link, verdict) in judged {
        let full = kept.len() + next.len() >= limits.links;
        match verdict {
            Verdict::Drop => {}
            Verdict::Keep => kept.push(link),
            _ if full => {
                within = false;
                kept.push(link);
            }
            Verdict::SplitBoth => {
                let children = clusters.children(link.receiver.index() as u32);
                let pairs = children.iter().flat_map(|&to| children.iter().map(move |&from| (to, from)));
                let of_use = pairs.filter(|(to, from)| to != from || to.as_cluster().is_some());
                next.extend(of_use.map(|(to, from)| Link::new(to, from)));
            }
            Verdict::SplitReceiver | Verdict::SplitSource => {
                let receiver = verdict == Verdict::SplitReceiver;
                let node = if receiver { link.receiver } else { link.source };
                let before = next.len();
                for_parts(mesh, clusters, node, limits, |part| {
                    next.push(if receiver {
                        Link::new(part, link.source)
                    } else {
                        Link::new(link.receiver, part)
                    });
                });
                if next.len() == before {
                    within = false;
                    kept.push(link);
                }
            }
        }
    }
    (next, within)
}

/// Calls `visit` with the parts of a node, which is divided if it is not yet; never where it cannot be.
fn for_parts(
    mesh: &mut ElementMesh,
    clusters: &Clusters,
    node: Node,
    limits: &Limits,
    mut visit: impl FnMut(Node),
) {
    if let Some(cluster) = node.as_cluster() {
        return clusters.children(cluster).iter().copied().for_each(visit);
    }
    let Some(element) = node.as_element() else {
        return;
    };
    if mesh.elements()[element as usize].is_leaf() && mesh.elements().len() + 4 <= limits.elements {
        mesh.divide(element);
    }
    mesh.elements()[element as usize].part_numbers().for_each(|part| visit(Node::element(part)));
}
