//! Exercise 3: a convex polygon is drawn and filled, and points are tested against it.
//!
//! Vertices are listed clockwise, with y upwards. Then every point inside has a negative value for
//! each edge (a b c), and edges that climb are on the left. A list that goes the other way round is
//! reversed, as the manual allows.

use super::LabError;
use super::input::Input;
use super::vectors::{Row3, cross, dot};

/// Largest coordinate that the exercise accepts, either way from 0.
pub const MAX_COORDINATE: f64 = 1e6;

/// Most vertices that the exercise accepts.
pub const MAX_VERTICES: i64 = 100_000;

/// A point of the plane.
pub type Point2 = [f64; 2];

/// Which way round the vertices are listed, with y upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orientation {
    /// Clockwise.
    Clockwise,
    /// Counter-clockwise.
    CounterClockwise,
    /// Neither: the polygon is not convex, or has no area.
    Neither,
}

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// All values are negative (3.4).
    Inside,
    /// None is positive, but some are 0. The manual's procedure counts it as inside.
    Boundary,
    /// Some value is positive (3.3).
    Outside,
}

impl Position {
    /// Whether the manual's procedure says that the point is inside.
    #[must_use]
    pub fn is_inside(self) -> bool {
        self != Self::Outside
    }
}

/// A row of a filled polygon, from x = `left` to `right` at height `y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The row.
    pub y: i32,
    /// Where it begins: the L of the manual.
    pub left: f64,
    /// Where it ends: the D of the manual.
    pub right: f64,
}

/// Which pixels of a span are drawn; the manual does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounding {
    /// Those that lie in it: from ceil(L) to floor(D).
    #[default]
    Within,
    /// Ends rounded to the nearest pixel.
    Nearest,
    /// Ends cut off to whole numbers.
    Truncate,
}

impl Span {
    /// First and last pixel; there is none when the last is before the first.
    #[must_use]
    pub fn pixels(&self, rounding: Rounding) -> std::ops::RangeInclusive<i32> {
        let (left, right) = match rounding {
            Rounding::Within => (self.left.ceil(), self.right.floor()),
            Rounding::Nearest => ((self.left + 0.5).floor(), (self.right + 0.5).floor()),
            Rounding::Truncate => (self.left.trunc(), self.right.trunc()),
        };
        left as i32..=right as i32
    }
}

/// A polygon with the coefficients of its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<Point2>,
    edges: Vec<Row3>,
}

impl Polygon {
    /// The polygon with these vertices, whatever their order.
    #[must_use]
    pub fn new(vertices: Vec<Point2>) -> Self {
        let next = |i: usize| vertices[(i + 1) % vertices.len()];
        let edge = |(i, v): (usize, &Point2)| edge_through(*v, next(i));
        let edges = vertices.iter().enumerate().map(edge).collect();
        Self { vertices, edges }
    }

    /// The polygon with its vertices listed clockwise.
    ///
    /// # Errors
    /// There are fewer than three vertices, or the polygon is not convex or has no area.
    pub fn clockwise(vertices: Vec<Point2>) -> Result<Self, LabError> {
        if vertices.len() < 3 {
            return Err(LabError::degenerate(format!(
                "a polygon has at least 3 vertices, but there are {}",
                vertices.len()
            )));
        }
        let polygon = Self::new(vertices);
        match polygon.orientation() {
            Orientation::Clockwise => Ok(polygon),
            Orientation::CounterClockwise => Ok(polygon.reversed()),
            Orientation::Neither => Err(LabError::degenerate(
                "the polygon is not convex, or three of its vertices that follow each other lie on a line",
            )),
        }
    }

    /// Reads the number of vertices and the vertices, two numbers each.
    ///
    /// # Errors
    /// The text does not hold them.
    pub fn read_vertices(input: &mut Input) -> Result<Vec<Point2>, LabError> {
        let n = input.whole("the number of vertices", 3..=MAX_VERTICES)?;
        (0..n).map(|i| read_point(input, &format!("vertex {i}"))).collect()
    }

    /// The same, listed the other way round.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self::new(self.vertices.iter().rev().copied().collect())
    }

    /// The vertices in order.
    #[must_use]
    pub fn vertices(&self) -> &[Point2] {
        &self.vertices
    }

    /// The coefficients (a b c) of each edge, from vertex i to i + 1 (3.1).
    #[must_use]
    pub fn edges(&self) -> &[Row3] {
        &self.edges
    }

    /// The values V(i+2) . b(i) that tell the orientation (3.2).
    #[must_use]
    pub fn orientation_values(&self) -> Vec<f64> {
        let n = self.vertices.len();
        (0..n).map(|i| value(self.edges[i], self.vertices[(i + 2) % n])).collect()
    }

    /// Which way round the vertices are listed.
    ///
    /// The values of (3.2) have one sign in a star that turns twice, too; so the polygon must also
    /// turn around once: x changes its direction at most twice.
    #[must_use]
    pub fn orientation(&self) -> Orientation {
        let values = self.orientation_values();
        if self.vertices.len() < 3 || self.changes_of_direction() > 2 {
            Orientation::Neither
        } else if values.iter().all(|&v| v < 0.0) {
            Orientation::Clockwise
        } else if values.iter().all(|&v| v > 0.0) {
            Orientation::CounterClockwise
        } else {
            Orientation::Neither
        }
    }

    fn changes_of_direction(&self) -> usize {
        let n = self.vertices.len();
        let way = |i: usize| self.vertices[(i + 1) % n][0] - self.vertices[i][0];
        let ways: Vec<bool> = (0..n).map(way).filter(|w| *w != 0.0).map(|w| w > 0.0).collect();
        (0..ways.len()).filter(|&i| ways[i] != ways[(i + 1) % ways.len()]).count()
    }

    /// The values A . b(i) of a point.
    #[must_use]
    pub fn values(&self, point: Point2) -> Vec<f64> {
        self.edges.iter().map(|&edge| value(edge, point)).collect()
    }

    /// Where a point lies with respect to a clockwise polygon.
    #[must_use]
    pub fn position(&self, point: Point2) -> Position {
        let values = self.values(point);
        if values.iter().any(|&v| v > 0.0) {
            Position::Outside
        } else if values.iter().all(|&v| v < 0.0) {
            Position::Inside
        } else {
            Position::Boundary
        }
    }

    /// Least x and y, greatest x and y.
    #[must_use]
    pub fn bounds(&self) -> (Point2, Point2) {
        let bound = |k: usize, pick: fn(f64, f64) -> f64| {
            self.vertices.iter().map(|v| v[k]).reduce(pick).unwrap_or(0.0)
        };
        ([bound(0, f64::min), bound(1, f64::min)], [bound(0, f64::max), bound(1, f64::max)])
    }

    /// L and D of each row of whole height within the polygon, for a clockwise list. Each row meets
    /// the infinite lines of all edges, so this holds for convex polygons.
    #[must_use]
    pub fn rows(&self) -> Vec<Span> {
        let ([xmin, ymin], [xmax, ymax]) = self.bounds();
        let row = |y: i32| {
            let y0 = f64::from(y);
            let (mut left, mut right) = (xmin, xmax);
            for (i, &[a, b, c]) in self.edges.iter().enumerate() {
                if a == 0.0 {
                    continue;
                }
                let x = (-b * y0 - c) / a;
                let climbs = self.vertices[i][1] < self.vertices[(i + 1) % self.vertices.len()][1];
                if climbs {
                    left = left.max(x);
                } else {
                    right = right.min(x);
                }
            }
            Span { y, left, right }
        };
        (ymin.ceil() as i32..=ymax.floor() as i32).map(row).collect()
    }

    /// The rows that are drawn: those with L < D. Rows where both are equal, such as a lowest or
    /// highest corner, are not.
    #[must_use]
    pub fn spans(&self) -> Vec<Span> {
        self.rows().into_iter().filter(|s| s.left < s.right).collect()
    }
}

/// Reads a point of the plane within reach.
///
/// # Errors
/// The text does not hold it.
pub fn read_point(input: &mut Input, what: &str) -> Result<Point2, LabError> {
    let point = input.numbers::<2>(what)?;
    if point.iter().any(|v| v.abs() > MAX_COORDINATE) {
        return Err(input.wrong(format!("{what} is farther out than {MAX_COORDINATE}")));
    }
    Ok(point)
}

/// The edge from `v` to `w`: the vector product of both as homogeneous points with h = 1.
fn edge_through(v: Point2, w: Point2) -> Row3 {
    cross([v[0], v[1], 1.0], [w[0], w[1], 1.0])
}

fn value(edge: Row3, point: Point2) -> f64 {
    dot(edge, [point[0], point[1], 1.0])
}

#[cfg(test)]
mod tests;
