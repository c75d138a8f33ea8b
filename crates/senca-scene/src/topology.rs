//! Who neighbours whom in a mesh, made on demand.
//!
//! Connectivity is that of *points*: a crease or a texture seam splits vertices but does not open the
//! mesh. Faces with corners at one point twice in a row (collapsed quadrilaterals) count without the
//! collapsed side. Building takes time linear in the number of corners, without hashing: half-edges
//! are sorted by counting into buckets of their lower point.

use crate::{Faces, Mesh};

/// Says "no partner" in [`Topology`]'s lists.
const NONE: u32 = u32::MAX;

/// Two-way connectivity of a mesh: polygon to points is in the mesh, this is the way back and across
/// (1991 thesis, section 9).
#[derive(Clone, Debug)]
pub struct Topology {
    /// Where each point's entries begin in `point_corners`, with one more for the end.
    point_starts: Vec<u32>,
    /// Corners (positions in `Faces::corners`) by point.
    point_corners: Vec<u32>,
    /// Face of every corner.
    corner_faces: Vec<u32>,
    /// For the side that begins at a corner, the corner at which the same side begins in the
    /// neighbouring face; `NONE` at borders, collapsed sides and sides of more than two faces.
    opposite: Vec<u32>,
    counts: EdgeCounts,
}

/// Counts of undirected edges by the number and direction of the faces at them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EdgeCounts {
    /// All edges between two different points.
    pub edges: usize,
    /// Edges of one face only.
    pub border: usize,
    /// Edges of two faces that run through it in the same direction, which means that the two are
    /// oriented differently.
    pub disagreeing: usize,
    /// Edges of more than two faces.
    pub crowded: usize,
}

/// A directed side of a face: from its corner's point to the next corner's.
#[derive(Clone, Copy)]
struct Side {
    high: u32,
    corner: u32,
    /// Whether it runs from the lower to the higher point.
    rising: bool,
}

impl Topology {
    /// Finds the connectivity of `mesh`.
    ///
    /// # Panics
    /// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let points: Vec<u32> = mesh.faces.corners.iter().map(|&v| mesh.vertices.point[v as usize]).collect();
        let corner_faces = corner_faces(&mesh.faces);
        let (point_starts, point_corners) = bucket(mesh.points.len(), &points);
        let mut topology = Self {
            point_starts,
            point_corners,
            corner_faces,
            opposite: vec![NONE; points.len()],
            counts: EdgeCounts::default(),
        };
        topology.pair_sides(mesh, &points);
        topology
    }

    /// Pairs the sides of faces that are one edge.
    fn pair_sides(&mut self, mesh: &Mesh, points: &[u32]) {
        let (starts, mut sides) = sides_by_lower_point(&mesh.faces, points, mesh.points.len());
        for range in starts.windows(2) {
            let bucket = &mut sides[range[0] as usize..range[1] as usize];
            bucket.sort_unstable_by_key(|side| (side.high, side.corner));
            for edge in bucket.chunk_by(|a, b| a.high == b.high) {
                self.enter_edge(edge);
            }
        }
    }

    fn enter_edge(&mut self, sides: &[Side]) {
        self.counts.edges += 1;
        match sides {
            [_] => self.counts.border += 1,
            [a, b] => {
                self.opposite[a.corner as usize] = b.corner;
                self.opposite[b.corner as usize] = a.corner;
                self.counts.disagreeing += usize::from(a.rising == b.rising);
            }
            _ => self.counts.crowded += 1,
        }
    }

    /// Counts of edges by the faces at them.
    #[must_use]
    pub fn edge_counts(&self) -> EdgeCounts {
        self.counts
    }

    /// Corners (positions in `Faces::corners`) at `point`.
    ///
    /// # Panics
    /// When `point` is out of range.
    #[must_use]
    pub fn corners_at(&self, point: u32) -> &[u32] {
        let range =
            self.point_starts[point as usize] as usize..self.point_starts[point as usize + 1] as usize;
        &self.point_corners[range]
    }

    /// Faces at `point`, in ascending order; a face that comes by twice is listed twice.
    ///
    /// # Panics
    /// When `point` is out of range.
    pub fn faces_at(&self, point: u32) -> impl Iterator<Item = u32> {
        self.corners_at(point).iter().map(|&corner| self.corner_faces[corner as usize])
    }

    /// Face of a corner.
    ///
    /// # Panics
    /// When `corner` is out of range.
    #[must_use]
    pub fn face_of(&self, corner: u32) -> u32 {
        self.corner_faces[corner as usize]
    }

    /// The corner at which the side that begins at `corner` begins in the neighbouring face, or
    /// `None` at a border and where more than two faces meet.
    ///
    /// # Panics
    /// When `corner` is out of range.
    #[must_use]
    pub fn opposite(&self, corner: u32) -> Option<u32> {
        Some(self.opposite[corner as usize]).filter(|&o| o != NONE)
    }

    /// Whether there are faces and no edge is a border: the mesh bounds a body.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.counts.edges > 0 && self.counts.border == 0 && self.counts.crowded == 0
    }

    /// Whether no edge has more than two faces.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.counts.crowded == 0
    }

    /// Whether all neighbours agree on which side is the front.
    #[must_use]
    pub fn is_oriented(&self) -> bool {
        self.counts.disagreeing == 0
    }

    /// Points in use minus edges plus faces: 2 for each sphere-like closed part, 0 for each ring.
    /// Faces that have collapsed to a line or a point do not count.
    #[must_use]
    pub fn euler_characteristic(&self, mesh: &Mesh) -> i64 {
        let points = self.point_starts.windows(2).filter(|range| range[0] != range[1]).count();
        let faces = mesh.faces.iter().filter(|corners| !is_collapsed(mesh, corners)).count();
        points as i64 - self.counts.edges as i64 + faces as i64
    }

    /// Number of parts that hang together through common points.
    #[must_use]
    pub fn parts(&self, mesh: &Mesh) -> usize {
        let mut up: Vec<u32> = (0..mesh.points.len() as u32).collect();
        for corners in mesh.faces.iter() {
            let mut points = corners.iter().map(|&v| mesh.vertices.point[v as usize]);
            let Some(first) = points.next() else { continue };
            for point in points {
                let (a, b) = (top(&mut up, first), top(&mut up, point));
                up[a.max(b) as usize] = a.min(b);
            }
        }
        let used = |&point: &u32| !self.corners_at(point).is_empty();
        (0..mesh.points.len() as u32).filter(used).filter(|&p| up[p as usize] == p).count()
    }
}

/// Representative of a point's part.
fn top(up: &mut [u32], mut i: u32) -> u32 {
    while up[i as usize] != i {
        up[i as usize] = up[up[i as usize] as usize];
        i = up[i as usize];
    }
    i
}

/// Whether fewer than three different points are left when repetitions in a row are dropped.
fn is_collapsed(mesh: &Mesh, corners: &[u32]) -> bool {
    let point = |i: usize| mesh.vertices.point[corners[i % corners.len()] as usize];
    (0..corners.len()).filter(|&i| point(i) != point(i + 1)).count() < 3
}

fn corner_faces(faces: &Faces) -> Vec<u32> {
    let of = |(face, corners): (usize, &[u32])| std::iter::repeat_n(face as u32, corners.len());
    faces.iter().enumerate().flat_map(of).collect()
}

/// Indices of `keys` by key, ascending: starts of every key's list and the lists one after the other.
fn bucket(count: usize, keys: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; count + 1];
    keys.iter().for_each(|&key| starts[key as usize + 1] += 1);
    for i in 1..=count {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut lists = vec![0; keys.len()];
    for (i, &key) in keys.iter().enumerate() {
        lists[next[key as usize] as usize] = i as u32;
        next[key as usize] += 1;
    }
    (starts, lists)
}

/// All sides between different points, by their lower point.
fn sides_by_lower_point(faces: &Faces, points: &[u32], count: usize) -> (Vec<u32>, Vec<Side>) {
    let mut lows = Vec::with_capacity(points.len());
    let mut sides = Vec::with_capacity(points.len());
    let mut first = 0;
    for corners in faces.iter() {
        for i in 0..corners.len() {
            let (a, b) = (points[first + i], points[first + (i + 1) % corners.len()]);
            if a != b {
                lows.push(a.min(b));
                sides.push(Side { high: a.max(b), corner: (first + i) as u32, rising: a < b });
            }
        }
        first += corners.len();
    }
    let (starts, order) = bucket(count, &lows);
    (starts, order.iter().map(|&i| sides[i as usize]).collect())
}

#[cfg(test)]
mod tests;
