//! The inside of closed meshes, and their normals.
//!
//! Triangles are sorted into columns along x by their place in the yz plane. A point is inside when a
//! line from it along +x crosses the mesh an odd number of times. Whether it crosses a triangle is
//! decided side by side, each side looked at from its lower end, so that neighbours never both claim a
//! line through their common side, and never both leave it.

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use crate::tessellate::{ShapeError, TessellationSettings, Tolerance, tessellate};
use crate::{Mesh, Shape, triangulated};

/// Most columns along y and z.
const MOST_COLUMNS: usize = 512;

struct Triangle {
    places: [DVec3; 3],
    normals: [DVec3; 3],
    normal: DVec3,
}

/// A closed mesh, ready for questions about points.
pub(super) struct MeshSolid {
    triangles: Vec<Triangle>,
    bounds: Aabb,
    /// Columns along y and z.
    counts: [usize; 2],
    /// Triangles of each column, one list after the other.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl MeshSolid {
    /// The solid of a shape that [`Shape::check_closed`] accepts.
    pub(super) fn of_shape(shape: &Shape) -> Result<Self, ShapeError> {
        let extent = shape.bounds().diagonal();
        let tolerance = Tolerance::World((1e-3 * extent).max(f64::MIN_POSITIVE));
        let mesh = tessellate(shape, &TessellationSettings { tolerance, ..Default::default() })?;
        Ok(Self::new(&mesh))
    }

    fn new(mesh: &Mesh) -> Self {
        let triangles: Vec<Triangle> =
            triangulated(mesh).iter().filter_map(|face| triangle(mesh, face)).collect();
        let bounds = Aabb::of_points(triangles.iter().flat_map(|t| t.places));
        let side = (triangles.len() as f64).sqrt().ceil().clamp(1.0, MOST_COLUMNS as f64) as usize;
        let mut solid =
            Self { triangles, bounds, counts: [side; 2], starts: Vec::new(), entries: Vec::new() };
        solid.sort();
        solid
    }

    /// Puts the triangles into their columns.
    fn sort(&mut self) {
        let mut lists = vec![Vec::new(); self.counts[0] * self.counts[1]];
        for (i, t) in self.triangles.iter().enumerate() {
            for column in self.columns(&Aabb::of_points(t.places)) {
                lists[column].push(i as u32);
            }
        }
        self.starts = vec![0];
        for list in lists {
            self.entries.extend(list);
            self.starts.push(self.entries.len() as u32);
        }
    }

    /// Column along one axis, 0 for y and 1 for z; those beyond count as the last.
    fn column(&self, axis: usize, at: f64) -> usize {
        let (low, high) = (self.bounds.min[axis + 1], self.bounds.max[axis + 1]);
        let share = (at - low) / (high - low).max(f64::MIN_POSITIVE);
        ((share * self.counts[axis] as f64).max(0.0) as usize).min(self.counts[axis] - 1)
    }

    /// Columns that a box reaches into.
    fn columns(&self, bounds: &Aabb) -> impl Iterator<Item = usize> + use<> {
        let range =
            |axis: usize| self.column(axis, bounds.min[axis + 1])..=self.column(axis, bounds.max[axis + 1]);
        let (rows, columns, across) = (range(1), range(0), self.counts[0]);
        rows.flat_map(move |row| columns.clone().map(move |column| row * across + column))
    }

    fn in_column(&self, column: usize) -> impl Iterator<Item = &Triangle> {
        let range = self.starts[column] as usize..self.starts[column + 1] as usize;
        self.entries[range].iter().map(|&i| &self.triangles[i as usize])
    }

    /// Whether `p` is inside.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        if self.triangles.is_empty() || !(p.cmpge(self.bounds.min).all() && p.cmple(self.bounds.max).all()) {
            return false;
        }
        let column = self.column(1, p.z) * self.counts[0] + self.column(0, p.y);
        self.in_column(column).filter(|t| t.is_crossed(p)).count() % 2 == 1
    }

    /// Whether all of a box is inside or outside; `None` where a triangle may be.
    pub(super) fn classify(&self, bounds: &Aabb) -> Option<bool> {
        let apart = |t: &Triangle| {
            let of = Aabb::of_points(t.places);
            of.min.cmpgt(bounds.max).any() || of.max.cmplt(bounds.min).any()
        };
        if bounds.min.cmpgt(self.bounds.max).any() || bounds.max.cmplt(self.bounds.min).any() {
            return Some(false);
        }
        let clear = self.columns(bounds).all(|column| self.in_column(column).all(apart));
        clear.then(|| self.contains(bounds.center()))
    }

    /// The normal at the nearest triangle that faces about as `towards` does; triangles within a
    /// column of `p` are looked at.
    pub(super) fn normal(&self, p: DVec3, towards: DVec3) -> Option<DVec3> {
        let reach = self.bounds.size() / DVec3::new(1.0, self.counts[0] as f64, self.counts[1] as f64);
        let near = Aabb { min: p - reach, max: p + reach };
        let mut best: Option<(f64, DVec3)> = None;
        for t in self.columns(&near).flat_map(|column| self.in_column(column)) {
            let (distance, normal) = t.nearest(p);
            // A triangle that faces elsewhere has to be much nearer to be the right one.
            let turned = 1.0 - t.normal.dot(towards.normalize_or_zero());
            let cost = distance + 0.1 * reach.y.max(reach.z) * turned;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, normal));
            }
        }
        best.map(|(_, normal)| normal)
    }
}

fn triangle(mesh: &Mesh, face: &[u32]) -> Option<Triangle> {
    let face: [u32; 3] = face.try_into().ok()?;
    let places = face.map(|v| mesh.position(v).as_dvec3());
    let normal = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
    let normals = face.map(|v| mesh.vertices.normal.get(v as usize).map_or(normal, |n| n.as_dvec3()));
    Some(Triangle { places, normals, normal })
}

impl Triangle {
    /// Whether the line from `p` along +x crosses.
    fn is_crossed(&self, p: DVec3) -> bool {
        let [a, b, c] = self.places.map(|q| DVec2::new(q.y, q.z));
        let at = DVec2::new(p.y, p.z);
        let inside = is_left_of(a, b, at) ^ is_left_of(b, c, at) ^ is_left_of(c, a, at);
        if !inside || self.normal.x == 0.0 {
            return false;
        }
        let from = self.places[0];
        from.x - ((p.y - from.y) * self.normal.y + (p.z - from.z) * self.normal.z) / self.normal.x > p.x
    }

    /// Distance of the nearest place of the triangle, and the normal interpolated there.
    fn nearest(&self, p: DVec3) -> (f64, DVec3) {
        let [a, b, c] = self.places;
        let weights = nearest_weights(b - a, c - a, p - a);
        let place = a + (b - a) * weights[0] + (c - a) * weights[1];
        let [na, nb, nc] = self.normals;
        let normal = na * (1.0 - weights[0] - weights[1]) + nb * weights[0] + nc * weights[1];
        (place.distance(p), normal.normalize_or(self.normal))
    }
}

/// Whether a line from `p` along the second coordinate crosses the side from `a` to `b`, in either
/// direction the same.
fn is_left_of(a: DVec2, b: DVec2, p: DVec2) -> bool {
    let (low, high) = if (a.x, a.y) <= (b.x, b.y) { (a, b) } else { (b, a) };
    if (low.x > p.x) == (high.x > p.x) {
        return false;
    }
    (high - low).perp_dot(p - low) < 0.0
}

/// Weights of the second and third corner at the place nearest to `p`, the first corner being the
/// origin and the others at `u` and `v`.
fn nearest_weights(u: DVec3, v: DVec3, p: DVec3) -> [f64; 2] {
    let (uu, uv, vv, up, vp) = (u.dot(u), u.dot(v), v.dot(v), u.dot(p), v.dot(p));
    let determinant = uu * vv - uv * uv;
    if determinant > 0.0 {
        let (s, t) = ((vv * up - uv * vp) / determinant, (uu * vp - uv * up) / determinant);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return [s, t];
        }
    }
    let along = |from: DVec3, side: DVec3| {
        let length = side.length_squared().max(f64::MIN_POSITIVE);
        ((p - from).dot(side) / length).clamp(0.0, 1.0)
    };
    let (s, t, w) = (along(DVec3::ZERO, u), along(DVec3::ZERO, v), along(u, v - u));
    let candidates = [[s, 0.0], [0.0, t], [1.0 - w, w]];
    let distance = |w: &[f64; 2]| (u * w[0] + v * w[1]).distance_squared(p);
    candidates.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or([0.0, 0.0])
}
