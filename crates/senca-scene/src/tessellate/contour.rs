//! Meshes of implicit surfaces and of bodies put together from bodies, by dual contouring.
//!
//! Space around the body is divided into cubic cells by an octree from which interval arithmetic
//! removes what is certainly inside or outside, so that nothing is missed that corners of cells can
//! tell. Where an edge of the grid leaves the body, the place is found by bisection, with the normal
//! of the leaf that ends there. Each loop of the surface through a cell gets one vertex, where the
//! planes at its crossings meet best (Ju, Losasso, Schaefer, Warren 2002), so creases stay sharp; each
//! crossed edge gives a face of the four vertices around it. Cells with several loops (Nielson 2004)
//! and a vertex on the rare cell side through which two loops pass together keep the mesh closed with
//! two faces at every edge.
//!
//! The grid is refined until the middles of faces are within the tolerance of the surface, up to
//! [`MOST_ALONG`] cells along the longest side, or until a finer grid no longer helps, as at the tips
//! of cones.

mod cell;
mod field;
mod grid;
mod mesh_solid;

use std::collections::HashMap;

use senca_math::Aabb;
use senca_math::glam::{DMat4, DVec2, DVec3, IVec3};

use super::build::Builder;
use super::{MAX_FACES, ShapeError, TessellationSettings, Tolerance};
use crate::{Csg, ImplicitSurface, Mesh, Shape};
use cell::{Crossing, NONE};
use field::{Body, Tag};
use grid::Grid;

/// Most cells along the longest side.
const MOST_ALONG: u32 = 256;

/// Fewest cells along the longest side.
const LEAST_ALONG: u32 = 16;

/// Share of the error of a grid above which it does not pay to halve the step again. Where a surface is
/// smooth a quarter is left, at the tip of a cone a half, for ever.
const STUCK: f64 = 0.45;

/// Steps of bisection along an edge; what is left is a 65 536th of it.
const BISECTIONS: usize = 16;

/// Cells along the smallest leaf that are asked for at the start.
const ALONG_LEAF: f64 = 6.0;

/// The mesh of f = 0 in its box. Without caps, what the box's sides would close is left out.
pub(super) fn implicit(
    surface: &ImplicitSurface,
    settings: &TessellationSettings,
) -> Result<Mesh, ShapeError> {
    let body = Body::of_implicit(surface)?;
    let mesh = contoured(&body, &surface.bounds, surface.bounds.size().min_element(), settings);
    Ok(mesh.finish(surface.capped, settings))
}

/// The mesh of a tree of bodies.
pub(super) fn csg(csg: &Csg, settings: &TessellationSettings) -> Result<Mesh, ShapeError> {
    csg.check()?;
    let body = Body::of_csg(csg)?;
    let bounds = csg.bounds_in(&DMat4::IDENTITY);
    if bounds.is_empty() || bounds.size().max_element() <= 0.0 {
        return Ok(Mesh::default());
    }
    let extent = |leaf: &&crate::CsgLeaf| leaf.shape.bounds_in(&leaf.transform.matrix()).size().min_element();
    let endless = |leaf: &&crate::CsgLeaf| matches!(*leaf.shape, Shape::Plane { .. });
    let smallest = csg.leaves().iter().filter(|l| !endless(l)).map(extent).fold(f64::INFINITY, f64::min);
    Ok(contoured(&body, &bounds, smallest, settings).finish(true, settings))
}

/// Contours on ever finer grids until the tolerance is met.
fn contoured<'b>(
    body: &'b Body,
    bounds: &Aabb,
    smallest: f64,
    settings: &TessellationSettings,
) -> Contour<'b> {
    let longest = bounds.size().max_element();
    let (mut along, tolerance) = match (settings.tolerance, settings.tolerance.over_box(bounds)) {
        (Tolerance::Steps(around, rows), _) => (around.max(rows).clamp(4, MOST_ALONG), f64::INFINITY),
        (_, tolerance) => {
            let tolerance = tolerance.unwrap_or(f64::INFINITY);
            // A ball of half the size bends by the tolerance over a cell of this many to a side.
            let by_bend = (longest / (4.0 * tolerance)).sqrt();
            let by_leaf = ALONG_LEAF * longest / smallest.max(f64::MIN_POSITIVE);
            let along = by_bend.max(by_leaf).clamp(f64::from(LEAST_ALONG), f64::from(MOST_ALONG));
            (along as u32, tolerance)
        }
    };
    let mut best: Option<(Contour<'b>, f64)> = None;
    loop {
        let mut contour = Contour::new(body, bounds.center(), Grid::around(bounds, along));
        if !contour.run() {
            // Too many faces: the last grid that stayed within the limit is kept, or a coarser one tried.
            match best {
                Some((last, _)) => return last,
                None if along <= LEAST_ALONG => return contour,
                None => along /= 2,
            }
            continue;
        }
        let error = contour.error();
        let stuck = best.as_ref().is_some_and(|(_, before)| error > STUCK * before);
        if error <= tolerance || along == MOST_ALONG || stuck {
            return contour;
        }
        best = Some((contour, error));
        along = (2 * along).min(MOST_ALONG);
    }
}

/// A cell that the surface passes through.
struct Cell {
    loop_of: [u8; 12],
    /// Index of the first loop's point; the others follow.
    first_point: u32,
}

/// One contouring of a body on one grid.
struct Contour<'b> {
    body: &'b Body,
    /// Middle of the body's box, around which pictures are laid.
    center: DVec3,
    grid: Grid,
    inside: HashMap<IVec3, bool>,
    crossing_of: HashMap<(IVec3, usize), u32>,
    crossings: Vec<Crossing>,
    cells: HashMap<IVec3, Cell>,
    points: Vec<DVec3>,
    /// Cells still to be looked at.
    open: Vec<IVec3>,
}

impl<'b> Contour<'b> {
    fn new(body: &'b Body, center: DVec3, grid: Grid) -> Self {
        Self {
            body,
            center,
            grid,
            inside: HashMap::new(),
            crossing_of: HashMap::new(),
            crossings: Vec::new(),
            cells: HashMap::new(),
            points: Vec::new(),
            open: Vec::new(),
        }
    }

    /// Finds all crossings and vertices; `false` when there would be more faces than [`MAX_FACES`].
    fn run(&mut self) -> bool {
        self.open = self.grid.mixed_cells(self.body);
        self.open.reverse();
        while let Some(at) = self.open.pop() {
            if !self.cells.contains_key(&at) {
                self.enter(at);
            }
            if 2 * self.crossings.len() as u64 > MAX_FACES {
                return false;
            }
        }
        true
    }

    fn is_inside(&mut self, corner: IVec3) -> bool {
        let (body, grid) = (self.body, &self.grid);
        *self.inside.entry(corner).or_insert_with(|| body.value(grid.corner(corner)).0 < 0.0)
    }

    /// Finds the loops through a cell and their vertices.
    fn enter(&mut self, at: IVec3) {
        let mut links = Vec::new();
        for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
            let (corners, edges) = cell::face(axis, side);
            let inside = corners.map(|corner| self.is_inside(at + corner));
            let middle = || {
                let middle = (corners[0] + corners[2]).as_dvec3() * 0.5 + at.as_dvec3();
                self.body.value(self.grid.place(middle)).0 < 0.0
            };
            links.extend(cell::face_pairs(inside, edges, middle));
        }
        if links.is_empty() {
            return;
        }
        let (loop_of, count) = cell::loops(&links);
        let mut of_loop: Vec<Vec<Crossing>> = vec![Vec::new(); count as usize];
        for edge in (0..12).filter(|&edge| loop_of[edge] != NONE) {
            let crossing = self.crossing(at + cell::edge_start(edge), edge / 4);
            of_loop[loop_of[edge] as usize].push(self.crossings[crossing as usize]);
        }
        let first_point = self.points.len() as u32;
        let bounds = self.grid.bounds(at, 1);
        self.points.extend(of_loop.iter().map(|crossings| cell::vertex(self.body, crossings, &bounds)));
        self.cells.insert(at, Cell { loop_of, first_point });
    }

    /// The crossing of an edge; a new one opens the cells around it.
    fn crossing(&mut self, corner: IVec3, axis: usize) -> u32 {
        if let Some(&known) = self.crossing_of.get(&(corner, axis)) {
            return known;
        }
        let leaves = self.is_inside(corner);
        let (place, normal, tag) = self.find_crossing(corner, axis, leaves);
        let index = self.crossings.len() as u32;
        self.crossings.push(Crossing { corner, axis, leaves, place, normal, tag });
        self.crossing_of.insert((corner, axis), index);
        self.open.extend(around(corner, axis).into_iter().filter(|at| !self.cells.contains_key(at)));
        index
    }

    /// Place, outward normal and leaf of the crossing, by bisection.
    fn find_crossing(&self, corner: IVec3, axis: usize, leaves: bool) -> (DVec3, DVec3, Tag) {
        let ends = [self.grid.corner(corner), self.grid.corner(corner + cell::unit(axis))];
        let [mut inner, mut outer] = if leaves { ends } else { [ends[1], ends[0]] };
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inner + outer);
            if self.body.value(middle).0 < 0.0 {
                inner = middle;
            } else {
                outer = middle;
            }
        }
        let tag = self.body.value(outer).1;
        let place = 0.5 * (inner + outer);
        let along = if leaves { DVec3::AXES[axis] } else { -DVec3::AXES[axis] };
        (place, self.normal(tag, place, along).unwrap_or(along), tag)
    }

    /// Outward unit normal of the whole body on the surface of one leaf.
    fn normal(&self, tag: Tag, place: DVec3, towards: DVec3) -> Option<DVec3> {
        let leaf = &self.body.leaves[tag.leaf as usize];
        let sign = if tag.inverted { -1.0 } else { 1.0 };
        let normal = match leaf.distance(tag.part, place) {
            Some((_, normal)) => Some(normal),
            None => leaf.mesh_normal(place, sign * towards),
        };
        normal.map(|n| sign * n)
    }

    /// Points of the face around a crossing, counter-clockwise seen from outside.
    fn face(&self, crossing: &Crossing, extra: &mut Extra) -> Vec<u32> {
        let cells = around(crossing.corner, crossing.axis);
        let mut points = Vec::with_capacity(4);
        for i in 0..4 {
            let [Some(cell), Some(next)] = [cells[i], cells[(i + 1) % 4]].map(|at| self.cells.get(&at))
            else {
                return Vec::new();
            };
            let edge = |at: IVec3| {
                let start = crossing.corner - at;
                let (b, c) = ((crossing.axis + 1) % 3, (crossing.axis + 2) % 3);
                4 * crossing.axis + (start[b] + 2 * start[c]) as usize
            };
            let of_loop = cell.loop_of[edge(cells[i])];
            points.push(cell.first_point + u32::from(of_loop));
            let (axis, side) = ((crossing.axis + 1 + i % 2) % 3, (i / 2) as i32);
            points.extend(self.side_point(cells[i], [cell, next], axis, side, edge(cells[i]), extra));
        }
        if !crossing.leaves {
            points.reverse();
        }
        points
    }

    /// Where two parts of the surface pass through one side of a cell, and both belong to the same
    /// loops on either side of it, their common edge gets a point for each part.
    fn side_point(
        &self,
        at: IVec3,
        [cell, next]: [&Cell; 2],
        axis: usize,
        side: i32,
        edge: usize,
        extra: &mut Extra,
    ) -> Option<u32> {
        let (corners, edges) = cell::face(axis, side);
        let (_, opposite) = cell::face(axis, 1 - side);
        let same = |cell: &Cell, edges: [usize; 4]| {
            cell.loop_of[edges[0]] != NONE && edges.iter().all(|&e| cell.loop_of[e] == cell.loop_of[edges[0]])
        };
        if !same(cell, edges) || !same(next, opposite) {
            return None;
        }
        let inside = corners.map(|corner| self.inside.get(&(at + corner)).copied().unwrap_or(false));
        let middle = (corners[0] + corners[2]).as_dvec3() * 0.5 + at.as_dvec3();
        let pairs = cell::face_pairs(inside, edges, || self.body.value(self.grid.place(middle)).0 < 0.0);
        let pair = pairs.into_iter().find(|pair| pair.contains(&edge))?;
        let crossings = pair.map(|e| self.crossing_of.get(&(at + cell::edge_start(e), e / 4)).copied());
        let [Some(a), Some(b)] = crossings else { return None };
        let place = 0.5 * (self.crossings[a as usize].place + self.crossings[b as usize].place);
        Some(extra.point([a.min(b), a.max(b)], place))
    }

    /// Largest distance of the middle of a face from the surface it stands for.
    fn error(&self) -> f64 {
        let mut extra = Extra::new(self.points.len());
        let of = |crossing: &Crossing| {
            let points = self.face(crossing, &mut extra);
            let places = points.iter().filter_map(|&p| self.points.get(p as usize));
            let middle = places.sum::<DVec3>() / points.len().max(1) as f64;
            let leaf = &self.body.leaves[crossing.tag.leaf as usize];
            leaf.distance(crossing.tag.part, middle).map_or(0.0, |(d, _)| d.abs().min(self.grid.step))
        };
        self.crossings.iter().map(of).fold(0.0, f64::max)
    }

    /// The mesh, each part of each leaf a surface of its own.
    fn finish(&self, capped: bool, settings: &TessellationSettings) -> Mesh {
        let mut extra = Extra::new(self.points.len());
        let shown = |c: &&Crossing| capped || c.tag.part == 0;
        let faces: Vec<(&Crossing, Vec<u32>)> =
            self.crossings.iter().filter(shown).map(|c| (c, self.face(c, &mut extra))).collect();
        let places: Vec<DVec3> = self.points.iter().copied().chain(extra.places).collect();
        let mut output = Output::new(self, &places, settings.polygons);
        for (crossing, points) in &faces {
            output.face(crossing, points);
        }
        output.builder.mesh
    }
}

/// Points beside those of cells.
struct Extra {
    first: u32,
    places: Vec<DVec3>,
    known: HashMap<[u32; 2], u32>,
}

impl Extra {
    fn new(first: usize) -> Self {
        Self { first: first as u32, places: Vec::new(), known: HashMap::new() }
    }

    fn point(&mut self, key: [u32; 2], place: DVec3) -> u32 {
        let next = self.first + self.places.len() as u32;
        *self.known.entry(key).or_insert_with(|| {
            self.places.push(place);
            next
        })
    }
}

/// The four cells around an edge, counter-clockwise seen against its axis.
fn around(corner: IVec3, axis: usize) -> [IVec3; 4] {
    let (b, c) = (cell::unit((axis + 1) % 3), cell::unit((axis + 2) % 3));
    [corner, corner - b, corner - b - c, corner - c]
}

/// The mesh as it grows.
struct Output<'c, 'b> {
    contour: &'c Contour<'b>,
    places: &'c [DVec3],
    builder: Builder,
    points: HashMap<u32, u32>,
    surfaces: HashMap<Tag, u32>,
    /// Vertices by point, surface, normal and u.
    vertices: HashMap<(u32, u32, [u32; 3], u64), u32>,
}

impl<'c, 'b> Output<'c, 'b> {
    fn new(contour: &'c Contour<'b>, places: &'c [DVec3], polygons: bool) -> Self {
        Self {
            contour,
            places,
            builder: Builder::new(polygons),
            points: HashMap::new(),
            surfaces: HashMap::new(),
            vertices: HashMap::new(),
        }
    }

    fn face(&mut self, crossing: &Crossing, points: &[u32]) {
        let surface = self.surface(crossing.tag);
        let middle = points.iter().map(|&p| self.places[p as usize] - self.contour.center).sum::<DVec3>();
        let u = texcoord(middle).x;
        let corners: Vec<u32> = points.iter().map(|&p| self.vertex(p, crossing, surface, u)).collect();
        match corners[..] {
            [a, b, c, d] => self.builder.quad([a, b, c, d], surface),
            _ => {
                for i in 2..corners.len() {
                    self.builder.triangle([corners[0], corners[i - 1], corners[i]], surface);
                }
            }
        }
    }

    fn surface(&mut self, tag: Tag) -> u32 {
        let leaf = &self.contour.body.leaves[tag.leaf as usize];
        let builder = &mut self.builder;
        *self.surfaces.entry(tag).or_insert_with(|| {
            let surface = builder.surface(&leaf.name);
            builder.mesh.surfaces[surface as usize].material = leaf.material;
            surface
        })
    }

    /// The vertex of a face with the middle at `u`: those beyond the picture's seam lie outside of it, and
    /// the poles under the face.
    fn vertex(&mut self, point: u32, crossing: &Crossing, surface: u32, u: f64) -> u32 {
        let place = self.places[point as usize];
        let builder = &mut self.builder;
        let stored = *self.points.entry(point).or_insert_with(|| builder.point(place));
        let found = self.contour.normal(crossing.tag, place, crossing.normal);
        let normal = found.unwrap_or(crossing.normal);
        let bits = normal.as_vec3().to_array().map(f32::to_bits);
        let from_center = place - self.contour.center;
        let mut texcoord = texcoord(from_center);
        let at_pole = from_center.x.hypot(from_center.z) <= 1e-6 * from_center.y.abs();
        texcoord.x = if at_pole { u } else { u + (texcoord.x - u) - (texcoord.x - u).round() };
        *self
            .vertices
            .entry((point, surface, bits, texcoord.x.to_bits()))
            .or_insert_with(|| builder.vertex(stored, normal, texcoord))
    }
}

/// Longitude and latitude of a direction, as a sphere has them.
fn texcoord(d: DVec3) -> DVec2 {
    use std::f64::consts::{PI, TAU};
    let d = d.normalize_or(DVec3::Y);
    DVec2::new(0.5 + d.x.atan2(d.z) / TAU, d.y.clamp(-1.0, 1.0).acos() / PI)
}

#[cfg(test)]
mod tests;
