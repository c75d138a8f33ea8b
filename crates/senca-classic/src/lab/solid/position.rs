//! Whether a point lies in a solid.

use super::{Solid, value};
use crate::lab::polygon::Position;
use crate::lab::vectors::{Row3, Row4, add, cross, dot, length, normalized, scale, subtract};

/// By which rule a point is tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// For convex solids: by the signs of all planes (4.12), (4.13).
    Planes,
    /// For all closed solids: a ray from the point meets the surface an odd number of times from
    /// inside, an even number from outside.
    Ray,
}

/// Where a point lies, and how that was found out.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidPosition {
    /// Where.
    pub position: Position,
    /// By which rule.
    pub method: Method,
    /// Values of all planes at the point.
    pub values: Vec<f64>,
    /// Where the ray met the surface, when there was one.
    pub crossings: Vec<Crossing>,
}

/// A ray meets a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The face, from 0.
    pub face: usize,
    /// How far along the ray, in lengths of its direction.
    pub t: f64,
}

/// The parameter at which the line `start` + t `direction` meets a plane (section 4.5); `None` for a
/// line that is parallel to it.
#[must_use]
pub fn line_meets_plane(start: Row3, direction: Row3, plane: Row4) -> Option<f64> {
    let speed = dot([plane[0], plane[1], plane[2]], direction);
    (speed != 0.0).then(|| -value(plane, start) / speed)
}

/// Where a ray meets the triangles of a solid, nearest first; `None` when it goes through an edge or a
/// corner or lies in a face, where counting would go wrong, and another direction is to be taken.
#[must_use]
pub fn ray_crossings(solid: &Solid, start: Row3, direction: Row3) -> Option<Vec<Crossing>> {
    let mut crossings = Vec::new();
    for (face, corners) in solid.triangles() {
        let corners = corners.map(|i| subtract(solid.vertices[i], start));
        match meets_triangle(corners, direction) {
            Meeting::Misses => {}
            Meeting::Touches => return None,
            Meeting::At(t) => crossings.push(Crossing { face, t }),
        }
    }
    crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
    Some(crossings)
}

enum Meeting {
    Misses,
    /// Goes through an edge or a corner, or along the triangle.
    Touches,
    At(f64),
}

/// A ray from the origin and a triangle: on which side of the ray each edge goes by.
fn meets_triangle([a, b, c]: [Row3; 3], direction: Row3) -> Meeting {
    let room = 1e-12 * length(direction) * [a, b, c].iter().map(|&v| dot(v, v)).fold(0.0, f64::max);
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| dot(direction, cross(p, q)));
    let (positive, negative) = (sides.iter().any(|&s| s > room), sides.iter().any(|&s| s < -room));
    if positive && negative {
        return Meeting::Misses;
    }
    let normal = cross(subtract(b, a), subtract(c, a));
    if dot(normal, normal) == 0.0 {
        return Meeting::Misses;
    }
    let speed = dot(normal, direction);
    if sides.iter().any(|s| s.abs() <= room) {
        // An edge on the line of the ray matters only when it is not behind.
        let behind = [a, b, c].iter().all(|&v| dot(v, direction) < 0.0);
        return if behind { Meeting::Misses } else { Meeting::Touches };
    }
    let t = dot(normal, a) / speed;
    if t > 0.0 { Meeting::At(t) } else { Meeting::Misses }
}

/// The direction that the ray test takes first, and how many others it tries.
const FIRST_DIRECTION: Row3 = [4.0, 1.0, 2.0];
const DIRECTIONS: u32 = 64;

/// Directions that follow each other without a pattern: the first, then turned by golden angles.
fn direction(k: u32) -> Row3 {
    if k == 0 {
        return FIRST_DIRECTION;
    }
    let z = 1.0 - (2.0 * f64::from(k) - 1.0) / f64::from(DIRECTIONS);
    let (sin, cos) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    [r * cos, r * sin, z]
}

impl Solid {
    /// Where a point lies: by the planes for a convex solid, by a ray for any other closed one.
    #[must_use]
    pub fn position(&self, point: Row3) -> SolidPosition {
        if self.is_convex() { self.position_by_planes(point) } else { self.position_by_ray(point) }
    }

    /// Where a point lies with respect to a convex solid (4.12), (4.13). The boundary satisfies neither.
    #[must_use]
    pub fn position_by_planes(&self, point: Row3) -> SolidPosition {
        let values: Vec<f64> = self.planes().iter().map(|&plane| value(plane, point)).collect();
        let position = if values.iter().any(|&v| v > 0.0) {
            Position::Outside
        } else if values.iter().all(|&v| v < 0.0) {
            Position::Inside
        } else {
            Position::Boundary
        };
        SolidPosition { position, method: Method::Planes, values, crossings: Vec::new() }
    }

    /// Where a point lies with respect to a closed solid of any shape, by how often a ray from it meets
    /// the surface. A ray that goes through an edge or a corner is replaced by another one.
    #[must_use]
    pub fn position_by_ray(&self, point: Row3) -> SolidPosition {
        let values = self.planes().iter().map(|&plane| value(plane, point)).collect();
        if self.is_on_surface(point) {
            return SolidPosition {
                position: Position::Boundary,
                method: Method::Ray,
                values,
                crossings: Vec::new(),
            };
        }
        let counted = (0..DIRECTIONS).find_map(|k| ray_crossings(self, point, direction(k)));
        let crossings = counted.unwrap_or_default();
        let odd = !crossings.len().is_multiple_of(2);
        let position = if odd { Position::Inside } else { Position::Outside };
        SolidPosition { position, method: Method::Ray, values, crossings }
    }

    fn is_on_surface(&self, point: Row3) -> bool {
        let (low, high) = self.bounds();
        let room = 1e-9 * length(subtract(high, low));
        self.triangles().any(|(_, corners)| {
            let nearest = nearest_of_triangle(point, corners.map(|i| self.vertices[i]));
            length(subtract(point, nearest)) <= room
        })
    }
}

/// The point of a triangle that is nearest to `p`.
fn nearest_of_triangle(p: Row3, [a, b, c]: [Row3; 3]) -> Row3 {
    let on_edges = || {
        let candidates = [(a, b), (b, c), (c, a)].map(|(v, w)| nearest_of_edge(p, v, w));
        let distance = |v: &Row3| length(subtract(p, *v));
        candidates.into_iter().min_by(|v, w| distance(v).total_cmp(&distance(w))).unwrap_or(a)
    };
    let Some(normal) = normalized(cross(subtract(b, a), subtract(c, a))) else { return on_edges() };
    let foot = subtract(p, scale(normal, dot(normal, subtract(p, a))));
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(v, w)| dot(normal, cross(subtract(w, v), subtract(foot, v))) >= 0.0);
    if inside { foot } else { on_edges() }
}

fn nearest_of_edge(p: Row3, v: Row3, w: Row3) -> Row3 {
    let way = subtract(w, v);
    let square = dot(way, way);
    let t = if square > 0.0 { (dot(subtract(p, v), way) / square).clamp(0.0, 1.0) } else { 0.0 };
    add(v, scale(way, t))
}
