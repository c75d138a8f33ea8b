//! What of an element is open, where bodies stand on it or enter it.
//!
//! A floor goes on below the block that stands on it, and the block's walls may go on below the floor.
//! Light is constant over an element, so the mean of what lies open and what lies in the dark would be
//! seen as a dark rim around the block. What lies in the dark is seen by nobody: only the open part of
//! an element counts, in its light, in what it sends, and where places on it are looked at.
//!
//! 1. A polygon is in contact with another where it meets its plane and rises from it: along a segment.
//! 2. Elements that such segments cross are cut along them (where there are many, into equal cells).
//! 3. A piece lies in the dark if from a place on it there is no front of a surface to be seen in any
//!    direction, and no lamp lights it. Elements without contacts are wholly as their piece is.
//!
//! Cutting meshes along contacts is due to Lischinski, Tampieri and Greenberg 1992 ("Discontinuity meshing
//! for accurate radiosity": discontinuities of degree 0); here the elements stay whole, and their pieces
//! are kept beside them, so that nothing else has to know of odd shapes.

use std::collections::HashMap;

use rayon::prelude::*;
use senca_math::glam::{DVec2, DVec3};
use senca_math::{Aabb, LinearRgb};
use smallvec::SmallVec;

use crate::gather::Frame;
use crate::hierarchy::cluster::Clusters;
use crate::hierarchy::facet::lambert_share;
use crate::{ElementMesh, NONE, Occluders, PatchPolygon};

/// Directions in which a place looks for fronts.
const LOOKS: u32 = 16;

/// Gaps of less than this share of the diagonal of the scene are none.
const GAP: f64 = 1e-5;

/// Segments that an element is cut along at most; where there are more, it is cut in equal cells.
const MOST_CUTS: usize = 6;

/// Pieces that are looked at one by one at most.
const FEW: usize = 12;

/// Cells along each edge.
const CELLS: u32 = 8;

/// Pieces of less than this share of their element are dropped.
const SPLINTER: f64 = 1e-9;

type Segment = [DVec3; 2];
type Piece = SmallVec<[DVec3; 6]>;

/// The open part of an element.
#[derive(Clone, Debug)]
pub(crate) struct OpenPart {
    pieces: Vec<Piece>,
    /// Triangles of the pieces, each with the share of the part that ends with it.
    triangles: Vec<([DVec3; 3], f64)>,
    /// Its shape, where that is a convex polygon of up to four corners.
    pub(crate) shape: Option<PatchPolygon>,
}

/// The open parts of all elements that are not wholly open.
#[derive(Clone, Debug, Default)]
pub(crate) struct OpenParts {
    /// World units.
    gap: f64,
    /// Elements that have been looked at.
    known: usize,
    /// Where other polygons are in contact with an element.
    contacts: HashMap<u32, Vec<Segment>>,
    parts: Vec<OpenPart>,
    /// Of each element, the number of its part, or [`NONE`].
    part_of: Vec<u32>,
}

/// What is asked of the surroundings.
pub(crate) struct Surroundings<'a> {
    pub(crate) clusters: &'a Clusters,
    pub(crate) occluders: &'a Occluders,
    /// Whether any lamp lights a place on a surface with this normal.
    pub(crate) is_lit: &'a (dyn Fn(DVec3, DVec3) -> bool + Sync),
}

/// What was found of an element.
#[derive(Default)]
struct Found {
    contacts: Vec<Segment>,
    open: f32,
    part: Option<OpenPart>,
}

impl OpenParts {
    pub(crate) fn new(mesh: &ElementMesh) -> Self {
        Self { gap: GAP * mesh.bounds().diagonal(), ..Self::default() }
    }

    /// The open part of an element, if that is neither all nor nothing of it.
    pub(crate) fn get(&self, mesh: &ElementMesh, element: u32) -> Option<&OpenPart> {
        let is_cut = mesh.elements()[element as usize].open < 1.0;
        let number = if is_cut { *self.part_of.get(element as usize)? } else { NONE };
        self.parts.get(number as usize)
    }

    /// A place on the open part of an element, evenly by area.
    pub(crate) fn place(&self, mesh: &ElementMesh, element: u32, u: f64, v: f64) -> DVec3 {
        match self.get(mesh, element) {
            Some(part) => part.place(u, v),
            None => mesh.shape(element).place(u, v),
        }
    }

    /// Looks at the elements that are new since the last time, and tells the mesh what share of them is open.
    pub(crate) fn follow(&mut self, mesh: &mut ElementMesh, around: &Surroundings<'_>) {
        while self.known < mesh.elements().len() {
            let first = self.known;
            let depends = |element: &usize| {
                let parent = mesh.elements()[*element].parent;
                parent != NONE && parent as usize >= first
            };
            let end = (first..mesh.elements().len()).find(depends).unwrap_or(mesh.elements().len());
            let look = |element: usize| self.look_at(mesh, element as u32, around);
            let found: Vec<Found> = (first..end).into_par_iter().with_min_len(64).map(look).collect();
            for (element, found) in (first as u32..).zip(found) {
                mesh.set_open(element, found.open);
                if !found.contacts.is_empty() {
                    self.contacts.insert(element, found.contacts);
                }
                self.part_of.push(if found.part.is_some() { self.parts.len() as u32 } else { NONE });
                self.parts.extend(found.part);
            }
            self.known = end;
        }
    }

    fn look_at(&self, mesh: &ElementMesh, element: u32, around: &Surroundings<'_>) -> Found {
        let stored = &mesh.elements()[element as usize];
        let shape = mesh.shape(element);
        let contacts = match stored.parent {
            NONE => self.contacts_of(mesh, element, around.clusters),
            parent => match self.contacts.get(&parent) {
                Some(of_parent) => crossing(of_parent, shape.corners(), mesh.normal(element), self.gap),
                None => Vec::new(),
            },
        };
        if contacts.is_empty() {
            return Found { open: self.whole(mesh, element, around), ..Found::default() };
        }
        let normal = mesh.normal(element);
        let pieces = match contacts.len() {
            0..=MOST_CUTS => cut(shape.corners(), normal, &contacts, self.gap),
            _ => cells(&shape),
        };
        let least = SPLINTER * stored.area;
        let is_open = |piece: &Piece| {
            let [center, area] = [center_of(piece), DVec3::splat(area_of(piece, normal))];
            (area.x > least).then(|| (area.x, self.is_open(mesh, center, normal, around)))
        };
        let judged: Vec<(f64, bool)> = pieces.iter().map(|p| is_open(p).unwrap_or_default()).collect();
        let all: f64 = judged.iter().map(|(area, _)| area).sum();
        let open: f64 = judged.iter().filter(|(_, open)| *open).map(|(area, _)| area).sum();
        if judged.iter().all(|(area, open)| *open || *area <= 0.0) {
            return Found { contacts, open: 1.0, part: None };
        }
        if open <= 0.0 {
            return Found { contacts, open: 0.0, part: None };
        }
        let kept: Vec<&Piece> =
            pieces.iter().zip(&judged).filter(|(_, (_, open))| *open).map(|(p, _)| p).collect();
        let part = OpenPart::new(&kept, normal, open);
        Found { contacts, open: (open / all) as f32, part: Some(part) }
    }

    /// Share of an element without contacts: all or nothing.
    fn whole(&self, mesh: &ElementMesh, element: u32, around: &Surroundings<'_>) -> f32 {
        let stored = &mesh.elements()[element as usize];
        if stored.parent == NONE {
            return 1.0;
        }
        let above = mesh.elements()[stored.parent as usize].open;
        if above >= 1.0 || !self.contacts.contains_key(&stored.parent) {
            return above;
        }
        f32::from(u8::from(self.is_open(mesh, stored.center, mesh.normal(element), around)))
    }

    /// Whether a place has something to see or is lit.
    fn is_open(&self, mesh: &ElementMesh, place: DVec3, normal: DVec3, around: &Surroundings<'_>) -> bool {
        has_sight(mesh, around.occluders, place, normal) || (around.is_lit)(place, normal)
    }

    /// Segments in which other polygons rise from a polygon.
    fn contacts_of(&self, mesh: &ElementMesh, polygon: u32, clusters: &Clusters) -> Vec<Segment> {
        let mut found = Vec::new();
        if clusters.len() == 0 {
            return found;
        }
        let (shape, normal) = (mesh.shape(polygon), mesh.normal(polygon));
        let bounds = Aabb::of_points(shape.corners().iter().copied());
        let (low, high) = (bounds.min - self.gap, bounds.max + self.gap);
        let mut open = vec![0];
        while let Some(cluster) = open.pop() {
            let around = &clusters.get(cluster).bounds;
            if !(around.min.cmple(high).all() && around.max.cmpge(low).all()) {
                continue;
            }
            for child in clusters.children(cluster) {
                match child.as_cluster() {
                    Some(inner) => open.push(inner),
                    None if child.index() as u32 == polygon => {}
                    None => found.extend(self.contact(mesh, &shape, normal, child.index() as u32)),
                }
            }
        }
        // In an order that does not depend on how clusters are walked through.
        crossing(&found, shape.corners(), normal, self.gap)
    }

    /// Where `other` rises from the plane of a polygon, if it lets no light pass.
    fn contact(
        &self,
        mesh: &ElementMesh,
        shape: &PatchPolygon,
        normal: DVec3,
        other: u32,
    ) -> Option<Segment> {
        if mesh.surface(other).transmittance != LinearRgb::BLACK {
            return None;
        }
        let origin = shape.corners()[0];
        let risen = mesh.shape(other);
        let heights: SmallVec<[f64; 4]> = risen.corners().iter().map(|&c| (c - origin).dot(normal)).collect();
        let rises = heights.iter().any(|&h| h > self.gap);
        if !rises || heights.iter().all(|&h| h > self.gap) {
            return None;
        }
        let mut met: SmallVec<[DVec3; 8]> = SmallVec::new();
        for (here, (&corner, &height)) in risen.corners().iter().zip(&heights).enumerate() {
            let next = (here + 1) % heights.len();
            if height.abs() <= self.gap {
                met.push(corner - height * normal);
            } else if heights[next].abs() > self.gap && (height > 0.0) != (heights[next] > 0.0) {
                met.push(corner.lerp(risen.corners()[next], height / (height - heights[next])));
            }
        }
        let pairs = met.iter().enumerate().flat_map(|(i, &p)| met[i + 1..].iter().map(move |&q| [p, q]));
        let longest = pairs.max_by(|[a, b], [c, d]| a.distance(*b).total_cmp(&c.distance(*d)))?;
        (longest[0].distance(longest[1]) > self.gap).then_some(longest)
    }
}

impl OpenPart {
    fn new(pieces: &[&Piece], normal: DVec3, area: f64) -> Self {
        let mut triangles = Vec::new();
        let mut sum = 0.0;
        for piece in pieces {
            for second in 1..piece.len() - 1 {
                let triangle = [piece[0], piece[second], piece[second + 1]];
                sum += area_of(&triangle, normal) / area;
                triangles.push((triangle, sum));
            }
        }
        let shape = outline(pieces, normal, area);
        Self { pieces: pieces.iter().map(|&piece| piece.clone()).collect(), triangles, shape }
    }

    /// Whether its pieces are few enough to look at one by one.
    pub(crate) fn is_simple(&self) -> bool {
        self.pieces.len() <= FEW
    }

    /// Share of the hemisphere of a point in front that this takes up, weighted by the cosine.
    pub(crate) fn share_at(&self, point: DVec3, normal: DVec3) -> f64 {
        self.pieces.iter().map(|piece| lambert_share(point, normal, piece)).sum()
    }

    /// A place, evenly by area.
    pub(crate) fn place(&self, u: f64, v: f64) -> DVec3 {
        let number = self.triangles.partition_point(|&(_, end)| end <= u).min(self.triangles.len() - 1);
        let (corners, end) = self.triangles[number];
        let start = if number > 0 { self.triangles[number - 1].1 } else { 0.0 };
        let along = ((u - start) / (end - start)).clamp(0.0, 1.0);
        PatchPolygon::triangle(corners).place(along, v)
    }

    /// Places that stand for all of it, with equal weights.
    pub(crate) fn places(&self) -> [DVec3; 4] {
        [[0.125, 0.3], [0.375, 0.7], [0.625, 0.3], [0.875, 0.7]].map(|[u, v]| self.place(u, v))
    }

    /// Triangles that make it up, each with its share of the area.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = (PatchPolygon, f64)> + '_ {
        let before = std::iter::once(0.0).chain(self.triangles.iter().map(|&(_, end)| end));
        let share = self.triangles.iter().zip(before);
        share.map(|(&(corners, end), start)| (PatchPolygon::triangle(corners), end - start))
    }
}

/// Whether a place sees the front of a surface in any of some directions, or something that lets light
/// pass.
pub(crate) fn has_sight(mesh: &ElementMesh, occluders: &Occluders, place: DVec3, normal: DVec3) -> bool {
    let frame = Frame::of(normal);
    let gap = GAP * 0.5 * occluders.beyond(occluders.center());
    (0..LOOKS).any(|look| {
        let [u, v] = [(f64::from(look) + 0.5) / f64::from(LOOKS), 0.618_033_988_749_895 * f64::from(look)];
        occluders.closest(place, frame.cosine_weighted(u, v)).is_some_and(|hit| {
            let passes = mesh.surface(hit.polygon).transmittance != LinearRgb::BLACK;
            passes || (hit.front && hit.t > gap)
        })
    })
}

/// Segments, as far as they run inside a convex polygon and not along its border.
fn crossing(segments: &[Segment], corners: &[DVec3], normal: DVec3, gap: f64) -> Vec<Segment> {
    segments.iter().filter_map(|&segment| inside(segment, corners, normal, gap)).collect()
}

/// The part of a segment inside a convex polygon, by more than `gap`.
fn inside([a, b]: Segment, corners: &[DVec3], normal: DVec3, gap: f64) -> Option<Segment> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (&p, &q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let inward = normal.cross(q - p).normalize_or_zero();
        let [at_a, at_b] = [a, b].map(|end| (end - p).dot(inward) - gap);
        if at_a <= 0.0 && at_b <= 0.0 {
            return None;
        }
        let at = at_a / (at_a - at_b);
        if at_a < 0.0 {
            from = from.max(at);
        } else if at_b < 0.0 {
            to = to.min(at);
        }
    }
    let kept = [from, to].map(|at| a.lerp(b, at));
    ((to - from) * a.distance(b) > gap).then_some(kept)
}

/// A convex polygon in pieces: each segment cuts those that it runs through, along its whole line.
fn cut(corners: &[DVec3], normal: DVec3, segments: &[Segment], gap: f64) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = vec![SmallVec::from_slice(corners)];
    for &[a, b] in segments {
        let side = normal.cross(b - a).normalize_or_zero();
        let mut cut = Vec::new();
        for piece in pieces {
            if inside([a, b], &piece, normal, gap).is_none() {
                cut.push(piece);
                continue;
            }
            let halves = [side, -side].map(|side| half(&piece, a, side));
            cut.extend(halves.into_iter().filter(|half| half.len() >= 3));
        }
        pieces = cut;
    }
    pieces
}

/// The part of a convex polygon on the side of a line that `side` points to.
fn half(piece: &[DVec3], on: DVec3, side: DVec3) -> Piece {
    let mut kept = Piece::new();
    for (&p, &q) in piece.iter().zip(piece.iter().cycle().skip(1)) {
        let [at_p, at_q] = [p, q].map(|corner| (corner - on).dot(side));
        if at_p >= 0.0 {
            kept.push(p);
        }
        if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
            kept.push(p.lerp(q, at_p / (at_p - at_q)));
        }
    }
    kept
}

/// Equal cells of a triangle or quadrilateral.
fn cells(shape: &PatchPolygon) -> Vec<Piece> {
    let mut cells = vec![*shape];
    for _ in 0..CELLS.ilog2() {
        cells = cells.iter().flat_map(PatchPolygon::quarters).collect();
    }
    cells.iter().map(|cell| SmallVec::from_slice(cell.corners())).collect()
}

fn center_of(piece: &[DVec3]) -> DVec3 {
    piece.iter().copied().sum::<DVec3>() / piece.len() as f64
}

fn area_of(piece: &[DVec3], normal: DVec3) -> f64 {
    let fan = (1..piece.len().max(2) - 1).map(|i| (piece[i] - piece[0]).cross(piece[i + 1] - piece[0]));
    0.5 * fan.sum::<DVec3>().dot(normal)
}

/// The pieces as one convex polygon of up to four corners, if that is what they are together.
fn outline(pieces: &[&Piece], normal: DVec3, area: f64) -> Option<PatchPolygon> {
    let (s, t) = normal.any_orthonormal_pair();
    let flat = |p: &DVec3| DVec2::new(p.dot(s), p.dot(t));
    let mut points: Vec<(DVec2, DVec3)> =
        pieces.iter().flat_map(|piece| piece.iter()).map(|p| (flat(p), *p)).collect();
    points.sort_by(|(p, _), (q, _)| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let straight = 1e-9 * area;
    let chain = |points: &mut dyn Iterator<Item = &(DVec2, DVec3)>| {
        let mut chain: Vec<(DVec2, DVec3)> = Vec::new();
        for &point in points {
            while let [.., p, q] = chain[..]
                && (q.0 - p.0).perp_dot(point.0 - q.0) <= straight
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    let corners: Piece = hull.iter().map(|&(_, p)| p).collect();
    let whole = area_of(&corners, normal).abs();
    if (whole - area).abs() > 1e-6 * area {
        return None;
    }
    let shape = match corners[..] {
        [a, b, c] => PatchPolygon::triangle([a, b, c]),
        [a, b, c, d] => PatchPolygon::quad([a, b, c, d]),
        _ => return None,
    };
    let turned = shape.normal_and_area().0.dot(normal) < 0.0;
    Some(if turned { shape.reversed() } else { shape })
}

#[cfg(test)]
mod tests;
