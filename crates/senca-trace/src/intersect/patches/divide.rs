//! Divides a patch into cells, the most curved piece first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use senca_math::glam::{DVec3, DVec4, Vec3};

use super::cells::{Cell, Survey, survey};
use super::net::Net;
use super::patch::Patch;
use super::roots::Domain;

/// Pieces are flat enough when hits are within this share of half their size of where a ray under 45
/// degrees meets their plane: Newton's method then needs two or three steps, and few rays run so much along
/// the surface that they need more than that.
const FLAT: f64 = 0.2;

/// Pieces smaller than this share of their patch are not divided further, however crooked they are.
const SMALLEST: f64 = 1.0 / 128.0;

/// Most cells of one patch.
pub(super) const MOST_CELLS: usize = 512;

/// A binary tree of boxes; the children of an inner node come after it.
#[derive(Clone, Debug, Default)]
pub(super) struct BinaryTree {
    pub nodes: Vec<BinaryNode>,
}

/// A box, and what is in it.
#[derive(Clone, Debug)]
pub(super) struct BinaryNode {
    pub low: Vec3,
    pub high: Vec3,
    pub kind: NodeKind,
}

/// What is in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// Two nodes.
    Inner([u32; 2]),
    /// A leaf with this number.
    Leaf(u32),
}

impl BinaryNode {
    /// Half the surface of the box.
    pub(super) fn area(&self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// Room around boxes for what single precision loses; see the slab test.
const MARGIN: f64 = 2e-6;

/// A piece that could be divided.
struct Piece {
    /// Error times size: what dividing it is worth.
    worth: f64,
    node: u32,
    net: Net<DVec4>,
    domain: Domain,
    survey: Survey,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.worth.total_cmp(&other.worth).then(other.node.cmp(&self.node))
    }
}

impl Piece {
    fn new(node: u32, net: Net<DVec4>, domain: Domain, is_rational: bool) -> Self {
        let survey = survey(&net, is_rational);
        let worth = survey.error.min(1e3) * survey.high.distance(survey.low);
        Self { worth, node, net, domain, survey }
    }

    fn box_node(&self, kind: NodeKind) -> BinaryNode {
        let margin = DVec3::splat(MARGIN);
        BinaryNode {
            low: (self.survey.low - margin).as_vec3(),
            high: (self.survey.high + margin).as_vec3(),
            kind,
        }
    }
}

/// The cells of a patch, at most `most`, and the tree over them.
pub(super) fn divide(number: u32, patch: &Patch, most: usize) -> (Vec<Cell>, BinaryTree) {
    let (mut cells, mut tree) = (Vec::new(), BinaryTree::default());
    let whole = Piece::new(0, patch.net.clone(), Domain::WHOLE, patch.is_rational);
    let smallest = SMALLEST * whole.survey.high.distance(whole.survey.low);
    tree.nodes.push(whole.box_node(NodeKind::Leaf(0)));
    let mut open = BinaryHeap::from([whole]);
    while let Some(piece) = open.pop() {
        let size = piece.survey.high.distance(piece.survey.low);
        let is_done = piece.survey.error <= FLAT || size <= smallest || cells.len() + open.len() + 2 > most;
        if is_done {
            tree.nodes[piece.node as usize].kind = NodeKind::Leaf(cells.len() as u32);
            let place = (&piece.domain, &piece.net);
            cells.push(Cell::new(number, place, &piece.survey, patch.is_rational));
            continue;
        }
        let axis = piece.survey.axis;
        let next = tree.nodes.len() as u32;
        tree.nodes[piece.node as usize].kind = NodeKind::Inner([next, next + 1]);
        let [below, above] = piece.domain.split(axis);
        let parts = [(piece.net.clone().below(axis, 0.5), below), (piece.net.above(axis, 0.5), above)];
        for (i, (net, domain)) in parts.into_iter().enumerate() {
            let part = Piece::new(next + i as u32, net, domain, patch.is_rational);
            tree.nodes.push(part.box_node(NodeKind::Leaf(0)));
            open.push(part);
        }
    }
    tighten(&mut tree);
    (cells, tree)
}

/// Shrinks the boxes of inner nodes to those of their children.
fn tighten(tree: &mut BinaryTree) {
    for i in (0..tree.nodes.len()).rev() {
        if let NodeKind::Inner([a, b]) = tree.nodes[i].kind {
            let (a, b) = (&tree.nodes[a as usize], &tree.nodes[b as usize]);
            let (low, high) = (a.low.min(b.low), a.high.max(b.high));
            (tree.nodes[i].low, tree.nodes[i].high) = (low, high);
        }
    }
}

/// A balanced tree over boxes, whose leaves are their indices: halves along the axis in which the centres
/// differ most.
pub(super) fn tree_over(boxes: Vec<BinaryNode>) -> BinaryTree {
    let mut tree = BinaryTree::default();
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut work = Vec::new();
    if !order.is_empty() {
        tree.nodes.push(BinaryNode { kind: NodeKind::Leaf(0), ..boxes[0].clone() });
        work.push((0, 0..order.len()));
    }
    let center = |i: u32| boxes[i as usize].low + boxes[i as usize].high;
    while let Some((node, range)) = work.pop() {
        let (start, end) = (range.start, range.end);
        if range.len() == 1 {
            tree.nodes[node] =
                BinaryNode { kind: NodeKind::Leaf(order[start]), ..boxes[order[start] as usize].clone() };
            continue;
        }
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = order[range.clone()]
            .iter()
            .fold(none, |(low, high), &i| (low.min(center(i)), high.max(center(i))));
        let axis = (high - low).max_position();
        order[range].sort_by(|&a, &b| center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(&b)));
        let middle = start + (end - start) / 2;
        let next = tree.nodes.len();
        tree.nodes[node].kind = NodeKind::Inner([next as u32, next as u32 + 1]);
        tree.nodes.extend([boxes[0].clone(), boxes[0].clone()]);
        work.extend([(next, start..middle), (next + 1, middle..end)]);
    }
    tighten(&mut tree);
    tree
}
