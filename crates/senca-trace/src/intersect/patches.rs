//! Bicubic Bézier patches and NURBS surfaces, met by rays as they are, without triangles.
//!
//! A [`PatchSurface`] is made once:
//!
//! 1. A NURBS surface is cut at its knots into rational Bézier patches. All control points are moved
//!    and scaled so that they lie within the unit ball.
//! 2. Every patch is divided into cells, rectangles of its parameters, until each is nearly flat; bounds
//!    from the control points say how flat ([`cells`]). Boxes around the control points of the cells
//!    form a hierarchy eight wide ([`hierarchy`]).
//!
//! A ray then goes through the boxes, nearest first. In a cell it meets, one plane decides: the bounds
//! show that there is no hit, or at most one and about where, and Newton's method on the patch itself, in
//! double precision, has it in two or three steps. Where they show nothing, because the ray runs along the
//! surface or a derivative vanishes, the piece is divided as the plain way does it ([`roots`]). So no hit
//! is missed, silhouettes are exact at any zoom, and what is computed for a hit is good to about 14
//! digits of the size of the surface.
//!
//! Many rays that are near each other go through the boxes together, and through Newton's method eight at a
//! time ([`together`]).
//!
//! At the border of a patch or cell a hit counts on both sides, within what rounding can do, so nothing
//! slips through between patches with a common edge; [`Intersect::crossings`] then takes the two for one.
//! A ray that touches the surface, to within rounding, passes by; so does one that runs within a flat
//! patch.
//!
//! Sources: Kajiya 1982 and Toth 1985 on meeting patches by Newton's method with bounds; Krawczyk 1969;
//! Nishita, Sederberg and Kakimoto 1990.

mod block;
mod border;
mod cells;
mod divide;
mod grazing;
mod hierarchy;
mod net;
mod patch;
mod roots;
mod search;
mod together;

use std::collections::BTreeSet;
use std::ops::Range;

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use senca_math::glam::{DVec2, DVec3, DVec4, Vec4};
use senca_math::{Aabb, BicubicPatch, NurbsSurface as Evaluator};
use senca_scene::{BezierPatch, NurbsSurface, ShapeError};

use super::{Crossing, Crossings, Intersect, SurfacePoint};
use crate::{Counters, Ray};
pub(crate) use block::{BLOCK, RayBlock};
use cells::Cell;
use divide::BinaryTree;
use hierarchy::{Hierarchy, Link};
use net::Net;
use patch::{Patch, PatchJet};
use roots::Domain;
use search::{All, Any, Hit, LocalRay, Nearest, Search, Wanted};

/// Bézier patches or a NURBS surface that rays can meet.
///
/// A part is a patch: of Bézier patches the one with its index in the list; of a NURBS surface the piece
/// between two knots in each direction, u being the fast index. `uv` of a crossing runs from 0 to 1 over
/// the patch.
pub struct PatchSurface {
    /// Where the origin of normalized space is, and its unit.
    center: DVec3,
    scale: f64,
    bounds: Aabb,
    patches: Vec<Patch>,
    cells: Vec<Cell>,
    hierarchy: Hierarchy,
    root: Link,
    /// Where each patch begins in the hierarchy, its box, and its cells.
    parts: Vec<(Link, Aabb, Range<u32>)>,
    kind: Kind,
    is_closed: bool,
    level: Level,
}

/// What the patches come from.
#[derive(Debug)]
enum Kind {
    /// Surface of each patch.
    Bezier(Vec<u32>),
    /// The whole, and the parameters where each patch begins and ends in it.
    Nurbs(Box<Evaluator>, Vec<Domain>),
}

/// Most cells of one surface.
const MOST_CELLS: usize = 1 << 20;

/// Most patches of one surface: a gigabyte.
const MOST_PATCHES: usize = 1 << 20;

/// Largest coordinate of a control point.
const LARGEST: f64 = 1e100;

impl PatchSurface {
    /// The surface of bicubic patches. Without any, nothing is met.
    ///
    /// Surfaces are numbered from 0 in the order of the patches' surface numbers, as in the mesh that
    /// [`senca_scene::tessellate`] makes.
    ///
    /// # Errors
    /// A control point that is not finite or above 1e100; more than 2^20 patches.
    pub fn from_bezier(patches: &[BezierPatch]) -> Result<Self, ShapeError> {
        let shape = "Bézier patches";
        at_most(shape, patches.len())?;
        if let Some(bad) = patches.iter().position(|patch| !patch.points.iter().all(is_possible)) {
            let reason = format!("patch {bad} has a control point that is not finite or too large");
            return Err(ShapeError::Malformed { shape, reason });
        }
        let numbers: BTreeSet<u32> = patches.iter().map(|patch| patch.surface).collect();
        let surface = |patch: &BezierPatch| numbers.range(..patch.surface).count() as u32;
        let kind = Kind::Bezier(patches.iter().map(surface).collect());
        let nets = patches.iter().map(|patch| Net::new(4, patch.points.map(|p| p.extend(1.0))));
        let is_closed = border::is_closed(patches);
        Ok(Self::new(nets.collect(), kind, is_closed))
    }

    /// The surface itself; it has one surface number, 0.
    ///
    /// # Errors
    /// Numbers that do not make a surface, a control point above 1e100, more than 2^20 control points.
    pub fn from_nurbs(surface: &NurbsSurface) -> Result<Self, ShapeError> {
        let shape = "NURBS surface";
        at_most(shape, surface.points.len())?;
        let evaluator = surface.evaluator()?;
        if !surface.points.iter().all(is_possible) {
            return Err(ShapeError::Malformed { shape, reason: "a control point is too large".to_owned() });
        }
        let pieces = evaluator.bezier_patches();
        let domain = |p: &senca_math::RationalPatch| Domain { u: p.interval_u, v: p.interval_v };
        let domains = pieces.iter().map(domain).collect();
        let nets: Vec<_> = pieces.into_iter().map(|p| Net::new(p.degree_u + 1, p.points)).collect();
        let is_closed = border::is_closed_grid(
            &nets,
            evaluator.knots_u().bezier_pieces(&vec![0.0; surface.counts[0]]).len(),
        );
        Ok(Self::new(nets, Kind::Nurbs(Box::new(evaluator), domains), is_closed))
    }

    fn new(nets: Vec<Net<DVec4>>, kind: Kind, is_closed: bool) -> Self {
        let hull = |net: &Net<DVec4>| Aabb::of_points(net.points().iter().map(|p| p.truncate() / p.w));
        let bounds = nets.iter().map(hull).fold(Aabb::EMPTY, Aabb::union);
        let center = bounds.center();
        let scale = if bounds.diagonal() > 0.0 { 0.5 * bounds.diagonal() } else { 1.0 };
        let normalized = |p: &DVec4| ((p.truncate() - center * p.w) / scale).extend(p.w);
        let patches: Vec<Patch> = nets.iter().map(|net| Patch::new(net.map(normalized))).collect();
        let mut surface = Self {
            center,
            scale,
            bounds,
            patches,
            cells: Vec::new(),
            hierarchy: Hierarchy::default(),
            root: Link::NONE,
            parts: Vec::new(),
            kind,
            is_closed,
            level: Level::new(),
        };
        surface.build();
        surface
    }

    /// Makes cells and hierarchy.
    fn build(&mut self) {
        let most = (MOST_CELLS / self.patches.len().max(1)).clamp(1, divide::MOST_CELLS);
        let divided: Vec<(Vec<Cell>, BinaryTree)> = self
            .patches
            .par_iter()
            .enumerate()
            .map(|(i, patch)| divide::divide(i as u32, patch, most))
            .collect();
        let mut boxes = Vec::new();
        for (cells, tree) in divided {
            let first = self.cells.len() as u32;
            let root = self.hierarchy.add(&tree, &|leaf| Link::cell(first + leaf));
            self.cells.extend(cells);
            let whole = &tree.nodes[0];
            let place = |p: senca_math::glam::Vec3| self.center + self.scale * p.as_dvec3();
            self.parts.push((
                root,
                Aabb { min: place(whole.low), max: place(whole.high) },
                first..self.cells.len() as u32,
            ));
            boxes.push(whole.clone());
        }
        let top = divide::tree_over(boxes);
        let roots: Vec<Link> = self.parts.iter().map(|part| part.0).collect();
        self.root = self.hierarchy.add(&top, &|patch| roots[patch as usize]);
        let tight = self.parts.iter().fold(Aabb::EMPTY, |all, part| all.union(part.1));
        self.bounds.min = self.bounds.min.max(tight.min);
        self.bounds.max = self.bounds.max.min(tight.max);
    }

    /// Number of nearly flat pieces.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Bytes taken by cells, hierarchy and patches.
    #[must_use]
    pub fn memory(&self) -> usize {
        let hulls = self.cells.iter().filter(|cell| cell.hull.is_some()).count();
        size_of_val(self.cells.as_slice())
            + hulls * size_of::<[[f32; 16]; 3]>()
            + self.hierarchy.memory()
            + self.patches.len() * (size_of::<Patch>() + size_of::<[f64; 64]>())
    }

    /// Looks for hits below `root`.
    fn search<W: Wanted>(&self, root: Link, ray: &Ray, wanted: W, counters: &mut Counters) -> W {
        let Some(local) = LocalRay::new(ray, self.center, self.scale) else { return wanted };
        let mut search = Search { surface: self, ray, local, wanted, tests: 0 };
        let hierarchy = &self.hierarchy;
        counters.nodes +=
            dispatch!(self.level, simd => hierarchy.visit(simd, root, &local.single, &mut search));
        counters.tests += search.tests;
        search.wanted
    }

    /// All crossings, found without cells and boxes by dividing every patch: the plain twin of
    /// [`Intersect::crossings`], a hundred times slower.
    pub fn crossings_by_division(&self, ray: &Ray, out: &mut Crossings) {
        let Some(local) = LocalRay::new(ray, self.center, self.scale) else { return };
        let mut search = Search { surface: self, ray, local, wanted: All::default(), tests: 0 };
        for part in 0..self.patches.len() as u32 {
            search.by_division(part, Domain::WHOLE);
        }
        append(search.wanted, out);
    }

    /// Place and derivatives on a patch, in normalized space.
    fn jet(&self, part: u32, uv: DVec2) -> PatchJet {
        let patch = &self.patches[part as usize];
        dispatch!(self.level, simd => patch.at(simd, uv))
    }

    /// Unit normal at a place of a patch, also where derivatives vanish; +y where there is none.
    fn unit_normal(&self, part: u32, uv: DVec2, jet: &PatchJet) -> DVec3 {
        let cross = jet.du.cross(jet.dv);
        let size = jet.du.length_squared().max(jet.dv.length_squared());
        if cross.length_squared() > SINGULAR * size * size {
            return cross.normalize();
        }
        self.limit_normal(part, uv).unwrap_or(DVec3::Y)
    }

    /// What normals tend to where derivatives vanish.
    #[cold]
    fn limit_normal(&self, part: u32, uv: DVec2) -> Option<DVec3> {
        match &self.kind {
            Kind::Bezier(_) => {
                let net = &self.patches[part as usize].net;
                let points = std::array::from_fn(|i| net.points()[i].truncate());
                BicubicPatch::from_list(points).normal(uv.x, uv.y)
            }
            Kind::Nurbs(whole, domains) => {
                let at = within(&domains[part as usize], uv);
                whole.normal(at.x, at.y)
            }
        }
    }

    /// Texture coordinates at a place of a patch, and their growth per u and v.
    fn texture(&self, part: u32, uv: DVec2) -> (DVec2, DVec2) {
        let Kind::Nurbs(whole, domains) = &self.kind else { return (uv, DVec2::ONE) };
        let ([u0, u1], [v0, v1]) = (whole.knots_u().domain(), whole.knots_v().domain());
        let (low, size) = (DVec2::new(u0, v0), DVec2::new(u1 - u0, v1 - v0));
        let domain = &domains[part as usize];
        ((within(domain, uv) - low) / size, 2.0 * domain.half() / size)
    }
}

/// Share of the square of the larger derivative's below which the square of their product says nothing of the
/// normal.
const SINGULAR: f64 = 1e-12;

/// Refuses more patches than can be held.
fn at_most(shape: &'static str, patches: usize) -> Result<(), ShapeError> {
    if patches <= MOST_PATCHES {
        return Ok(());
    }
    let reason = format!("{patches} patches or control points are too many; there can be {MOST_PATCHES}");
    Err(ShapeError::Malformed { shape, reason })
}

/// Whether a control point can be computed with.
fn is_possible(p: &DVec3) -> bool {
    p.is_finite() && p.abs().max_element() <= LARGEST
}

/// A place given from 0 to 1 over a domain.
fn within(domain: &Domain, uv: DVec2) -> DVec2 {
    DVec2::new(domain.u[0], domain.v[0]) + 2.0 * domain.half() * uv
}

/// Appends hits in order, those on common borders once.
fn append(mut all: All, out: &mut Crossings) {
    all.0.sort_by(|a, b| a.crossing.t.total_cmp(&b.crossing.t).then(a.crossing.part.cmp(&b.crossing.part)));
    let mut kept: smallvec::SmallVec<[Hit; 8]> = smallvec::SmallVec::new();
    for hit in all.0 {
        if !kept.iter().rev().take_while(|k| hit.distance - k.distance < SAME).any(|k| is_same(k, &hit)) {
            kept.push(hit);
        }
    }
    alternate(&mut kept);
    out.extend(kept.iter().map(|hit| hit.crossing));
}

/// Puts hits at the same place, as on an edge seen from the side, in such an order that the ray enters
/// before it leaves.
fn alternate(hits: &mut [Hit]) {
    let mut before = 1.0;
    for i in 1..hits.len() {
        let (a, b) = (hits[i - 1], hits[i]);
        if b.distance - a.distance < TURNED && a.sign == before && b.sign != before {
            hits.swap(i - 1, i);
            (hits[i - 1].crossing.t, hits[i].crossing.t) = (a.crossing.t, b.crossing.t);
        }
        before = hits[i - 1].sign;
    }
}

/// Distance, in normalized space, within which rounding may turn round the order of hits on an edge, of
/// which one side is seen nearly edge on.
const TURNED: f64 = 1e-10;

/// Distance, in normalized space, and difference of parameters, within which hits of the same direction
/// on a border are one.
const SAME: f64 = 1e-8;

/// Whether two hits at about the same distance are one place on a common border.
fn is_same(a: &Hit, b: &Hit) -> bool {
    if a.sign != b.sign {
        return false;
    }
    if a.crossing.part == b.crossing.part && (a.crossing.uv - b.crossing.uv).abs().max_element() < SAME {
        return true;
    }
    let on_border = |h: &Hit| {
        let to_border = h.crossing.uv.min(1.0 - h.crossing.uv);
        to_border.min_element() < SAME
    };
    on_border(a) && on_border(b)
}

impl std::fmt::Debug for PatchSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PatchSurface")
            .field("bounds", &self.bounds)
            .field("patches", &self.patches.len())
            .field("cells", &self.cells.len())
            .finish_non_exhaustive()
    }
}

impl Intersect for PatchSurface {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        self.search(self.root, ray, Nearest(None), counters).0.map(|hit| hit.crossing)
    }

    fn occludes(&self, ray: &Ray, counters: &mut Counters) -> bool {
        self.search(self.root, ray, Any(false), counters).0
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        append(self.search(self.root, ray, All::default(), counters), out);
    }

    fn surface_point(&self, _: &Ray, crossing: &Crossing) -> SurfacePoint {
        let Crossing { part, uv, .. } = *crossing;
        let jet = self.jet(part, uv);
        let normal = self.unit_normal(part, uv, &jet);
        let (texcoord, growth) = self.texture(part, uv);
        let surface = match &self.kind {
            Kind::Bezier(surfaces) => surfaces[part as usize],
            Kind::Nurbs(..) => 0,
        };
        SurfacePoint {
            point: self.center + self.scale * jet.value,
            normal,
            shading_normal: normal,
            texcoords: [texcoord; 2],
            tangent: self.scale * jet.du / growth.x,
            handedness: 1.0,
            color: Vec4::ONE,
            surface,
        }
    }

    fn patches(&self) -> Option<&PatchSurface> {
        Some(self)
    }

    fn memory_bytes(&self) -> usize {
        self.memory()
    }

    fn is_closed(&self) -> bool {
        self.is_closed
    }

    fn part_count(&self) -> u32 {
        self.patches.len() as u32
    }

    fn part_bounds(&self, part: u32) -> Aabb {
        self.parts[part as usize].1
    }

    fn closest_in_part(&self, part: u32, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let root = self.parts[part as usize].0;
        self.search(root, ray, Nearest(None), counters).0.map(|hit| hit.crossing)
    }
}

#[cfg(test)]
mod tests;
