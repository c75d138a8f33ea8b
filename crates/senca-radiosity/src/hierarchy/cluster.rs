//! A hierarchy over the polygons, so that many small ones send and receive light as one.
//!
//! A cluster holds polygons and smaller clusters. Polygons that are large for the box they are in stay
//! near the top; the others are split where the surface area heuristic says. The polygons below a
//! cluster follow each other in one list, with sums of their areas, so that a place on the surfaces of
//! a cluster is found by bisection.

use senca_math::Aabb;
use senca_math::glam::DVec3;

use super::node::Node;
use crate::{ElementMesh, NONE};

/// Polygons and smaller clusters that a cluster holds at most, apart from those below the smaller ones.
const CHILDREN: usize = 8;

/// Polygons in a cluster that is not split any more.
const LEAF: usize = 4;

/// Polygons with a diagonal of more than this share of their cluster's are its children.
const LARGE: f64 = 0.5;

/// Bins per axis that splits are chosen from.
const BINS: usize = 16;

/// Below this depth clusters are halved by number, so that no input makes the hierarchy deep.
const DEPTH: usize = 48;

/// A group of polygons.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    pub(crate) bounds: Aabb,
    /// Half of the diagonal of the box.
    pub(super) radius: f64,
    /// Sum over the polygons, in square world units.
    pub(super) area: f64,
    /// Cluster that holds it, or [`NONE`].
    pub(super) parent: u32,
    /// Range of [`Clusters::children`].
    pub(super) children: std::ops::Range<u32>,
    /// Range of [`Clusters::order`].
    pub(super) polygons: std::ops::Range<u32>,
}

/// All clusters; the first holds everything, and each comes before those it holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clusters {
    clusters: Vec<Cluster>,
    children: Vec<Node>,
    /// Numbers of polygons.
    order: Vec<u32>,
    /// Sums of areas along `order`, one more entry than polygons.
    area_before: Vec<f64>,
    /// The cluster that holds a polygon directly.
    cluster_of: Vec<u32>,
}

/// What is to become a cluster.
struct Task {
    polygons: std::ops::Range<usize>,
    parent: u32,
    depth: usize,
}

impl Clusters {
    /// Clusters of all polygons of `mesh`.
    pub(crate) fn new(mesh: &ElementMesh) -> Self {
        let count = mesh.polygons().len();
        let boxes: Vec<Aabb> = (0..count as u32)
            .map(|polygon| Aabb::of_points(mesh.shape(polygon).corners().iter().copied()))
            .collect();
        let mut built =
            Self { order: (0..count as u32).collect(), cluster_of: vec![NONE; count], ..Self::default() };
        if count > 0 {
            built.build(&boxes);
        }
        built.sum_areas(mesh);
        built
    }

    pub(crate) fn len(&self) -> usize {
        self.clusters.len()
    }

    pub(crate) fn get(&self, cluster: u32) -> &Cluster {
        &self.clusters[cluster as usize]
    }

    pub(crate) fn children(&self, cluster: u32) -> &[Node] {
        let range = &self.clusters[cluster as usize].children;
        &self.children[range.start as usize..range.end as usize]
    }

    /// All polygons below a cluster.
    pub(super) fn polygons(&self, cluster: u32) -> &[u32] {
        let range = &self.clusters[cluster as usize].polygons;
        &self.order[range.start as usize..range.end as usize]
    }

    /// The cluster that holds a polygon directly.
    pub(super) fn cluster_of(&self, polygon: u32) -> u32 {
        self.cluster_of[polygon as usize]
    }

    /// The polygon at `share` in [0, 1) of the area of a cluster.
    pub(super) fn polygon_at(&self, cluster: u32, share: f64) -> u32 {
        let range = &self.clusters[cluster as usize].polygons;
        let (first, last) = (range.start as usize, range.end as usize);
        let sums = &self.area_before[first..=last];
        let wanted = sums[0] + share * (sums[sums.len() - 1] - sums[0]);
        let after = sums.partition_point(|&sum| sum <= wanted);
        self.order[first + after.saturating_sub(1).min(last - first - 1)]
    }

    /// Breadth first, so that clusters come before those they hold.
    fn build(&mut self, boxes: &[Aabb]) {
        let mut tasks = std::collections::VecDeque::new();
        tasks.push_back(Task { polygons: 0..boxes.len(), parent: NONE, depth: 0 });
        let mut held: Vec<(u32, Node)> = Vec::new();
        while let Some(task) = tasks.pop_front() {
            let number = self.clusters.len() as u32;
            let items = &mut self.order[task.polygons.clone()];
            let bounds = items.iter().fold(Aabb::EMPTY, |all, &p| all.union(boxes[p as usize]));
            if task.parent != NONE {
                held.push((task.parent, Node::cluster(number)));
            }
            self.clusters.push(Cluster {
                bounds,
                radius: 0.5 * bounds.diagonal(),
                area: 0.0,
                parent: task.parent,
                children: 0..0,
                polygons: task.polygons.start as u32..task.polygons.end as u32,
            });
            let parts = split(items, boxes, &bounds, task.depth);
            let start = task.polygons.start;
            for &polygon in &self.order[start..start + parts.own] {
                held.push((number, Node::element(polygon)));
                self.cluster_of[polygon as usize] = number;
            }
            let mut from = start + parts.own;
            for end in parts.ends.iter().map(|end| start + end) {
                tasks.push_back(Task { polygons: from..end, parent: number, depth: task.depth + 1 });
                from = end;
            }
        }
        self.list_children(held);
    }

    fn list_children(&mut self, mut held: Vec<(u32, Node)>) {
        held.sort_by_key(|&(parent, _)| parent);
        for (place, &(parent, child)) in held.iter().enumerate() {
            let range = &mut self.clusters[parent as usize].children;
            if range.start == range.end {
                *range = place as u32..place as u32;
            }
            range.end += 1;
            self.children.push(child);
        }
    }

    fn sum_areas(&mut self, mesh: &ElementMesh) {
        let mut sum = 0.0;
        self.area_before.push(sum);
        for &polygon in &self.order {
            sum += mesh.elements()[polygon as usize].area;
            self.area_before.push(sum);
        }
        for cluster in &mut self.clusters {
            let [first, last] = [cluster.polygons.start, cluster.polygons.end].map(|i| i as usize);
            cluster.area = self.area_before[last] - self.area_before[first];
        }
    }
}

/// How the items of a cluster are shared out: its own come first.
struct Parts {
    own: usize,
    /// Where the smaller clusters end; none if all are its own.
    ends: Vec<usize>,
}

/// Puts the items of a cluster in order.
fn split(items: &mut [u32], boxes: &[Aabb], bounds: &Aabb, depth: usize) -> Parts {
    let count = items.len();
    if count <= LEAF {
        return Parts { own: count, ends: Vec::new() };
    }
    // The largest ones stay, if they are few.
    let limit = LARGE * bounds.diagonal();
    let size = |p: u32| boxes[p as usize].diagonal();
    items.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
    let large = items.partition_point(|&p| size(p) > limit);
    if count <= CHILDREN && large == count {
        return Parts { own: count, ends: Vec::new() };
    }
    let own = large.min(CHILDREN - 2);
    let rest = &mut items[own..];
    if rest.len() <= 2 || depth >= DEPTH {
        let middle = rest.len() / 2;
        return Parts { own, ends: if middle > 0 { vec![own + middle, count] } else { vec![count] } };
    }
    let middle = partition(rest, boxes);
    Parts { own, ends: vec![own + middle, count] }
}

/// Parts items at the best of the planes between bins, or in the middle where there is none.
fn partition(items: &mut [u32], boxes: &[Aabb]) -> usize {
    let center = |p: u32| boxes[p as usize].center();
    let centers = Aabb::of_points(items.iter().map(|&p| center(p)));
    let extent = centers.size();
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let bin = |p: u32| bin_of(center(p)[axis], centers.min[axis], extent[axis]);
        for (plane, cost) in plane_costs(items, boxes, bin) {
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, plane));
            }
        }
    }
    let Some((_, axis, plane)) = best else {
        return items.len() / 2;
    };
    let below = |p: u32| bin_of(center(p)[axis], centers.min[axis], extent[axis]) <= plane;
    items.sort_by_key(|&p| !below(p));
    items.partition_point(|&p| below(p))
}

fn bin_of(at: f64, min: f64, extent: f64) -> usize {
    (((at - min) / extent * BINS as f64) as usize).min(BINS - 1)
}

/// Cost of each plane above a bin that has items on both sides.
fn plane_costs(items: &[u32], boxes: &[Aabb], bin: impl Fn(u32) -> usize) -> Vec<(usize, f64)> {
    let mut bins = [(Aabb::EMPTY, 0usize); BINS];
    for &item in items {
        let entry = &mut bins[bin(item)];
        *entry = (entry.0.union(boxes[item as usize]), entry.1 + 1);
    }
    let side = |range: std::ops::Range<usize>| {
        let join = |(all, n): (Aabb, usize), (one, m): &(Aabb, usize)| (all.union(*one), n + m);
        bins[range].iter().fold((Aabb::EMPTY, 0), join)
    };
    let cost = |(bounds, count): (Aabb, usize)| half_surface(&bounds) * count as f64;
    (0..BINS - 1)
        .map(|plane| (plane, side(0..plane + 1), side(plane + 1..BINS)))
        .filter(|(_, low, high)| low.1 > 0 && high.1 > 0)
        .map(|(plane, low, high)| (plane, cost(low) + cost(high)))
        .collect()
}

/// Half of the surface of a box.
pub(super) fn half_surface(bounds: &Aabb) -> f64 {
    let DVec3 { x, y, z } = bounds.size();
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::LinearRgb;

    fn squares(count: u32, place: impl Fn(u32) -> DVec3) -> ElementMesh {
        let corners: Vec<[DVec3; 4]> = (0..count)
            .map(|i| [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y].map(|p| p + place(i)))
            .collect();
        let grey = LinearRgb::splat(0.5);
        let polygons: Vec<_> = corners.iter().map(|c| (&c[..], grey, LinearRgb::BLACK)).collect();
        ElementMesh::of_polygons(&polygons)
    }

    fn check(mesh: &ElementMesh) {
        let clusters = Clusters::new(mesh);
        let mut seen = vec![0; mesh.polygons().len()];
        for number in 0..clusters.len() as u32 {
            let cluster = clusters.get(number);
            let mut below = 0;
            for &child in clusters.children(number) {
                match child.as_cluster() {
                    Some(child) => {
                        assert!(child > number && clusters.get(child).parent == number);
                        below += clusters.get(child).polygons.len();
                    }
                    None => {
                        seen[child.index()] += 1;
                        assert_eq!(clusters.cluster_of(child.index() as u32), number);
                        below += 1;
                    }
                }
            }
            assert_eq!(below, cluster.polygons.len());
            assert!(clusters.children(number).len() <= CHILDREN);
            for share in [0.0, 0.5, 0.999_999_999] {
                let polygon = clusters.polygon_at(number, share);
                let corner = mesh.shape(polygon).corners()[2];
                assert!(cluster.bounds.min.cmple(corner).all() && cluster.bounds.max.cmpge(corner).all());
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
        let total = clusters.get(0).area;
        assert!((total - mesh.area()).abs() < 1e-9 * total);
    }

    #[test]
    fn every_polygon_is_in_one_cluster() {
        for count in [1, 2, 4, 5, 9, 100, 1000] {
            check(&squares(count, |i| {
                let i = f64::from(i);
                DVec3::new((i * 7.3).sin() * 40.0, (i * 1.7).cos() * 20.0, i * 0.1)
            }));
        }
    }

    #[test]
    fn coincident_polygons_are_halved_by_number() {
        check(&squares(300, |_| DVec3::ONE));
    }

    #[test]
    fn nothing_makes_no_clusters() {
        assert_eq!(Clusters::new(&ElementMesh::default()).len(), 0);
    }
}
