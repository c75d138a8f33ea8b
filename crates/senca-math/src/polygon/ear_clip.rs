//! Triangles of a polygon by cutting off ears.
//!
//! 1. An ear is a convex corner whose triangle holds no other corner. Corners wait in a queue; one
//!    that is an ear is cut, and its neighbours join the end of the queue, which spreads the cuts and
//!    avoids slivers.
//! 2. Only corners that turn inwards can lie in an ear; they are kept in a grid of cells, so that a
//!    polygon of n corners takes about n steps and not n^2.
//! 3. A hole is first joined to the outside by a bridge of two coincident edges, which makes one loop
//!    of both (after Eberly).
//! 4. Coincident corners and spikes go first. A loop that crosses itself runs out of ears; then any
//!    convex corner is cut, whatever it holds, and at last any corner. So the work always ends.
//!
//! Source: Meisters 1975; Eberly, Triangulation by Ear Clipping.

use std::collections::VecDeque;

use glam::DVec2;

use super::signed_area;

/// Corner visits after which the search for proper ears is given up, so that hostile loops end.
const VISIT_BUDGET: u64 = 100_000_000;

/// Triangles of a polygon, as indices into its corners, with the polygon's orientation.
///
/// A simple polygon of n corners gives n - 2 triangles that cover it exactly, every corner being used.
/// Fewer than three corners, a loop without area and coordinates that are not finite give none. A
/// self-crossing loop gives some cover of what it encloses.
#[must_use]
pub fn triangulate(corners: &[DVec2]) -> Vec<[u32; 3]> {
    match *corners {
        [a, b, c, d] => quad_triangles([a, b, c, d]),
        _ => None,
    }
    .unwrap_or_else(|| triangulate_with_holes(corners, &[]))
}

/// The common case of four corners: one diagonal, from the first corner or from the one that turns
/// inwards. `None` for a quad that crosses itself or has a corner without area.
fn quad_triangles(p: [DVec2; 4]) -> Option<Vec<[u32; 3]>> {
    let area = signed_area(&p);
    let turns: [f64; 4] = std::array::from_fn(|i| area * cross(p[(i + 3) % 4], p[i], p[(i + 1) % 4]));
    let inwards: u32 = turns.iter().map(|t| u32::from(*t < 0.0)).sum();
    if inwards > 1 || !turns.iter().all(|t| t.is_finite() && *t != 0.0) {
        return None;
    }
    let from = turns.iter().position(|t| *t < 0.0).unwrap_or(0) as u32;
    let corner = |k: u32| (from + k) % 4;
    Some(vec![[from, corner(1), corner(2)], [from, corner(2), corner(3)]])
}

/// The same for a polygon with holes. `corners` holds the outer loop and then the holes' loops, of
/// any orientation; `hole_starts` the index of each hole's first corner, ascending. Holes must lie
/// inside and apart from each other; one that does not is left out, or cut as well as it can be.
#[must_use]
pub fn triangulate_with_holes(corners: &[DVec2], hole_starts: &[usize]) -> Vec<[u32; 3]> {
    let outer_end = hole_starts.first().map_or(corners.len(), |&start| start.min(corners.len()));
    let outer = &corners[..outer_end];
    if outer.len() < 3 || corners.len() > u32::MAX as usize / 4 || !corners.iter().all(|p| p.is_finite()) {
        return Vec::new();
    }
    let clockwise = signed_area(outer) < 0.0;
    let mut ring = Ring::default();
    let start = ring.add_loop(corners, 0..outer_end, clockwise);
    for hole in hole_loops(corners, hole_starts) {
        let reversed = signed_area(&corners[hole.clone()]) > 0.0;
        let first = ring.add_loop(corners, hole, reversed);
        ring.join_hole(start, first);
    }
    let mut triangles = Clipper::new(ring, start).run(start);
    if clockwise {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    triangles
}

/// Index ranges of the holes, that with the rightmost corner first, as bridging asks.
fn hole_loops(corners: &[DVec2], starts: &[usize]) -> Vec<std::ops::Range<usize>> {
    let ends = starts.iter().skip(1).copied().chain([corners.len()]);
    let loops = starts.iter().zip(ends).map(|(&start, end)| start..end.min(corners.len()));
    let mut loops: Vec<_> = loops.filter(|range| range.len() >= 3).collect();
    let rightmost = |range: &std::ops::Range<usize>| {
        corners[range.clone()].iter().fold(f64::NEG_INFINITY, |x, p| x.max(p.x))
    };
    loops.sort_by(|a, b| rightmost(b).total_cmp(&rightmost(a)));
    loops
}

/// A corner of a loop under work; bridges put a corner of the polygon into several nodes.
#[derive(Clone, Copy)]
struct Node {
    at: DVec2,
    corner: u32,
    prev: u32,
    next: u32,
    cut: bool,
}

/// Doubly linked loops of nodes, interior on the left.
#[derive(Default)]
struct Ring {
    nodes: Vec<Node>,
}

impl Ring {
    fn node(&self, i: u32) -> &Node {
        &self.nodes[i as usize]
    }

    fn at(&self, i: u32) -> DVec2 {
        self.node(i).at
    }

    /// Adds a loop of its own and gives its first node.
    fn add_loop(&mut self, corners: &[DVec2], range: std::ops::Range<usize>, reversed: bool) -> u32 {
        let (first, count) = (self.nodes.len() as u32, range.len() as u32);
        for k in 0..count {
            let corner = if reversed { range.end as u32 - 1 - k } else { range.start as u32 + k };
            let (prev, next) = (first + (k + count - 1) % count, first + (k + 1) % count);
            self.nodes.push(Node { at: corners[corner as usize], corner, prev, next, cut: false });
        }
        first
    }

    fn link(&mut self, a: u32, b: u32) {
        self.nodes[a as usize].next = b;
        self.nodes[b as usize].prev = a;
    }

    fn remove(&mut self, i: u32) {
        let Node { prev, next, .. } = *self.node(i);
        self.link(prev, next);
        self.nodes[i as usize].cut = true;
    }

    fn loop_from(&self, start: u32) -> impl Iterator<Item = u32> + '_ {
        let mut next = Some(start);
        std::iter::from_fn(move || {
            let i = next?;
            next = Some(self.node(i).next).filter(|&n| n != start);
            Some(i)
        })
    }

    /// Twice the area of the triangle at a node: positive where the loop turns left.
    fn turn(&self, i: u32) -> f64 {
        let Node { prev, next, .. } = *self.node(i);
        cross(self.at(prev), self.at(i), self.at(next))
    }

    /// Joins the hole that contains node `hole` to the loop that contains node `outer`.
    fn join_hole(&mut self, outer: u32, hole: u32) {
        let Some(tip) = self.loop_from(hole).max_by(|&a, &b| self.at(a).x.total_cmp(&self.at(b).x)) else {
            return;
        };
        let Some(anchor) = self.visible_from(outer, self.at(tip)) else { return };
        // anchor -> tip ... around the hole ... tip' -> anchor' -> rest of the outer loop
        let (tip_again, anchor_again) = (self.copy(tip), self.copy(anchor));
        let (before_tip, after_anchor) = (self.node(tip).prev, self.node(anchor).next);
        self.link(before_tip, tip_again);
        self.link(tip_again, anchor_again);
        self.link(anchor_again, after_anchor);
        self.link(anchor, tip);
    }

    fn copy(&mut self, i: u32) -> u32 {
        self.nodes.push(*self.node(i));
        self.nodes.len() as u32 - 1
    }

    /// A node of the loop that can be joined to `tip`, a point inside, without crossing the loop.
    fn visible_from(&self, start: u32, tip: DVec2) -> Option<u32> {
        // The nearest edge to the right of the tip; it runs upwards, as the interior is on its left.
        let mut nearest: Option<(f64, u32)> = None;
        for i in self.loop_from(start) {
            let (a, b) = (self.at(i), self.at(self.node(i).next));
            if a.y > tip.y || b.y < tip.y || a.y == b.y {
                continue;
            }
            let x = a.x + (tip.y - a.y) / (b.y - a.y) * (b.x - a.x);
            if x >= tip.x && nearest.is_none_or(|(best, _)| x < best) {
                nearest = Some((x, i));
            }
        }
        let (x, edge) = nearest?;
        let next = self.node(edge).next;
        let end = if self.at(edge).x >= self.at(next).x { edge } else { next };
        // Any corner in the triangle tip, hit, end may hide the end; the one with the smallest slope
        // is seen.
        let hit = DVec2::new(x, tip.y);
        let slope = |i: u32| {
            let d = self.at(i) - tip;
            (d.y.abs() / d.x, d.length_squared())
        };
        self.loop_from(start)
            .filter(|&i| self.at(i).x >= tip.x && self.at(i) != tip)
            .filter(|&i| in_triangle(self.at(i), tip, hit, self.at(end)) && self.opens_towards(i, tip))
            .min_by(|&a, &b| {
                let (a, b) = (slope(a), slope(b));
                a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
            })
            .or(Some(end))
    }

    /// Whether the interior angle at a node opens towards a point.
    fn opens_towards(&self, i: u32, point: DVec2) -> bool {
        let Node { at, prev, next, .. } = *self.node(i);
        let left_of_in = cross(self.at(prev), at, point) >= 0.0;
        let left_of_out = cross(at, self.at(next), point) >= 0.0;
        if self.turn(i) >= 0.0 { left_of_in && left_of_out } else { left_of_in || left_of_out }
    }
}

struct Clipper {
    ring: Ring,
    grid: Grid,
    /// Nodes to look at next. A cut puts its two neighbours in again.
    queue: VecDeque<u32>,
    /// Nodes not yet cut.
    left: usize,
    visits: u64,
    triangles: Vec<[u32; 3]>,
}

impl Clipper {
    fn new(ring: Ring, start: u32) -> Self {
        let queue: VecDeque<u32> = ring.loop_from(start).collect();
        let reflex: Vec<u32> = queue.iter().copied().filter(|&i| ring.turn(i) <= 0.0).collect();
        let grid = Grid::new(&ring, &reflex);
        let left = queue.len();
        Self { ring, grid, queue, left, visits: 0, triangles: Vec::new() }
    }

    fn run(mut self, start: u32) -> Vec<[u32; 3]> {
        let mut some_node = start;
        self.work_off(Self::is_spike);
        while self.left > 2 {
            while self.ring.node(some_node).cut {
                some_node = self.ring.node(some_node).next;
            }
            self.queue = self.ring.loop_from(some_node).collect();
            let before = self.left;
            self.work_off(|work, i| work.is_spike(i) || work.is_ear(i));
            if self.left == before {
                self.force(some_node);
            }
        }
        self.triangles
    }

    /// Looks at the queued nodes, and at the neighbours of those cut, until none is left.
    fn work_off(&mut self, may_cut: impl Fn(&mut Self, u32) -> bool) {
        while self.left > 2 {
            let Some(i) = self.queue.pop_front() else { return };
            self.visits += 1;
            if !self.ring.node(i).cut && may_cut(self, i) {
                self.cut(i);
                let Node { prev, next, .. } = *self.ring.node(i);
                self.queue.extend([prev, next]);
            }
        }
    }

    /// Cuts a corner of a loop that has no ear: the first convex one, or else the first.
    fn force(&mut self, start: u32) {
        let convex = self.ring.loop_from(start).find(|&i| self.ring.turn(i) > 0.0);
        self.cut(convex.unwrap_or(start));
    }

    /// Whether a corner has no area because it coincides with a neighbour or the loop turns back.
    fn is_spike(&mut self, i: u32) -> bool {
        let Node { at, prev, next, .. } = *self.ring.node(i);
        self.ring.turn(i) == 0.0 && (at - self.ring.at(prev)).dot(self.ring.at(next) - at) <= 0.0
    }

    /// Whether a corner is convex and its triangle empty. Beyond the budget every corner will do.
    fn is_ear(&mut self, i: u32) -> bool {
        self.visits > VISIT_BUDGET || (self.ring.turn(i) > 0.0 && self.is_empty_ear(i))
    }

    fn is_empty_ear(&mut self, i: u32) -> bool {
        let Node { at: b, prev, next, .. } = *self.ring.node(i);
        let (a, c) = (self.ring.at(prev), self.ring.at(next));
        let nodes = &self.ring.nodes;
        let blocks = |k: u32| {
            let p = nodes[k as usize].at;
            p != a && p != b && p != c && in_triangle(p, a, b, c)
        };
        let gone = |k: u32| nodes[k as usize].cut;
        let (visits, found) = self.grid.any([a, b, c], gone, blocks);
        self.visits += visits;
        !found
    }

    /// Cuts a corner off; its triangle is kept, turned the loop's way, unless it has no area.
    fn cut(&mut self, i: u32) {
        let Node { prev, next, corner, .. } = *self.ring.node(i);
        let (a, c) = (self.ring.node(prev).corner, self.ring.node(next).corner);
        match self.ring.turn(i) {
            turn if turn > 0.0 => self.triangles.push([a, corner, c]),
            turn if turn < 0.0 => self.triangles.push([a, c, corner]),
            _ => {}
        }
        self.ring.remove(i);
        self.left -= 1;
    }
}

/// Nodes by the cell they lie in.
struct Grid {
    min: DVec2,
    max: DVec2,
    cells_per_unit: DVec2,
    side: usize,
    /// Where each cell's nodes start and end in `nodes`.
    ranges: Vec<(u32, u32)>,
    nodes: Vec<u32>,
}

impl Grid {
    fn new(ring: &Ring, members: &[u32]) -> Self {
        let points = || members.iter().map(|&i| ring.at(i));
        let (min, max) =
            points().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let side = ((members.len() as f64).sqrt() as usize).clamp(1, 2048);
        let per_unit = DVec2::splat(side as f64) / (max - min);
        let cells_per_unit = DVec2::select(per_unit.is_finite_mask(), per_unit, DVec2::ZERO);
        let mut grid =
            Self { min, max, cells_per_unit, side, ranges: vec![(0, 0); side * side], nodes: Vec::new() };
        grid.fill(members, points().map(|p| grid.cell_index(p)).collect());
        grid
    }

    /// A counting sort of the members by cell.
    fn fill(&mut self, members: &[u32], cells: Vec<usize>) {
        cells.iter().for_each(|&cell| self.ranges[cell].1 += 1);
        let mut start = 0;
        for range in &mut self.ranges {
            let count = range.1;
            *range = (start, start);
            start += count;
        }
        self.nodes = vec![0; members.len()];
        for (&cell, &member) in cells.iter().zip(members) {
            let end = &mut self.ranges[cell].1;
            self.nodes[*end as usize] = member;
            *end += 1;
        }
    }

    /// Whether some node in the cells under a triangle fulfils `test`, and how much was looked at.
    /// Nodes that are `gone` are dropped on the way.
    fn any(
        &mut self,
        triangle: [DVec2; 3],
        gone: impl Fn(u32) -> bool,
        test: impl Fn(u32) -> bool,
    ) -> (u64, bool) {
        let mut visits = 1;
        for row in self.rows(triangle) {
            let Some(columns) = self.columns(triangle, row) else { continue };
            visits += columns.clone().count() as u64;
            for column in columns {
                let (start, end) = &mut self.ranges[row * self.side + column];
                let mut k = *start;
                while k < *end {
                    visits += 1;
                    let node = self.nodes[k as usize];
                    if gone(node) {
                        *end -= 1;
                        self.nodes.swap(k as usize, *end as usize);
                    } else if test(node) {
                        return (visits, true);
                    } else {
                        k += 1;
                    }
                }
            }
        }
        (visits, false)
    }

    fn rows(&self, [a, b, c]: [DVec2; 3]) -> std::ops::RangeInclusive<usize> {
        self.cell(a.min(b).min(c)).1..=self.cell(a.max(b).max(c)).1
    }

    /// The columns that a triangle covers within a row, one more on each side against rounding. Long
    /// thin triangles cover far fewer cells than the box around them.
    fn columns(&self, [a, b, c]: [DVec2; 3], row: usize) -> Option<std::ops::RangeInclusive<usize>> {
        let height = (self.max.y - self.min.y) / self.side as f64;
        let low = self.min.y + height * row as f64;
        let high = (low + height).min(self.max.y);
        // A hair more, for nodes that rounding put in the neighbouring row.
        let (low, high) = (low - 1e-9 * height, high + 1e-9 * height);
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
            if q.y < low || p.y > high {
                continue;
            }
            let x_at = |y: f64| p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
            let ends = if q.y > p.y { [x_at(low.max(p.y)), x_at(high.min(q.y))] } else { [p.x, q.x] };
            left = left.min(ends[0]).min(ends[1]);
            right = right.max(ends[0]).max(ends[1]);
        }
        let column = |x: f64| self.cell(DVec2::new(x, low)).0;
        (left <= right).then(|| column(left).saturating_sub(1)..=(column(right) + 1).min(self.side - 1))
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let scaled =
            ((p - self.min) * self.cells_per_unit).clamp(DVec2::ZERO, DVec2::splat(self.side as f64 - 1.0));
        (scaled.x as usize, scaled.y as usize)
    }

    fn cell_index(&self, p: DVec2) -> usize {
        let (x, y) = self.cell(p);
        y * self.side + x
    }
}

fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

/// Whether a point lies in a triangle of either orientation, border included.
fn in_triangle(p: DVec2, a: DVec2, b: DVec2, c: DVec2) -> bool {
    let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}
