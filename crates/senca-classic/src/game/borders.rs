//! The scan converter: where a polygon begins and ends on each row, and with what values.
//!
//! Every pixel of every edge is visited by Bresenham's steps; the leftmost one of a row is its start, the rightmost its
//! end. So a row has one span, and polygons that need two on some row are drawn wrongly. (The text calls those it can draw
//! concave; it means convex.) Spans include both ends, also the lowest row and the rightmost column: neighbouring polygons
//! overlap by a pixel.
//!
//! Whatever else a vertex carries is interpolated along the edge in fixed point.
//!
//! Source: Savchenko 1995, "Ambient polygons".

use super::clip::{Bounds, Search, clip_line, clip_polygon};
use super::line::Bresenham;

/// Fraction bits of interpolated values (`G_P`, whose value the text does not give).
pub const BORDER_BITS: u32 = 16;

/// Columns of an edge are taken to lie within this of 0.
const FARTHEST_COLUMN: i32 = 1 << 15;

/// Start, end and values on each row (`G_start`, `G_end`, `G_rest_start`, `G_rest_end`, `G_miny`, `G_maxy`).
#[derive(Clone, Debug)]
pub struct Borders {
    extras: usize,
    start: Vec<i32>,
    end: Vec<i32>,
    rest_start: Vec<i64>,
    rest_end: Vec<i64>,
    rows: Option<[i32; 2]>,
}

/// One row of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span<'a> {
    /// The row.
    pub y: i32,
    /// First column.
    pub start: i32,
    /// Last column, drawn as well.
    pub end: i32,
    /// Values at the start, with [`BORDER_BITS`] fraction bits.
    pub rest_start: &'a [i64],
    /// Values at the end.
    pub rest_end: &'a [i64],
}

impl Borders {
    /// For a screen of so many rows, and vertices with so many values beside x and y (`GI_boarder_array_init`).
    #[must_use]
    pub fn new(height: usize, extras: usize) -> Self {
        Self {
            extras,
            start: vec![i32::MAX; height],
            end: vec![i32::MIN; height],
            rest_start: vec![0; height * extras],
            rest_end: vec![0; height * extras],
            rows: None,
        }
    }

    /// Takes in one edge (`GI_scan`), clipped by the screen's top and bottom. Values of the vertices beyond those asked
    /// for are left out; missing ones are 0. Columns farther than 32768 from 0 are taken as that.
    pub fn scan<const N: usize>(&mut self, a: [i32; N], b: [i32; N], search: Search) {
        const { assert!(N >= 2, "a vertex has x and y") }
        let Some(line) = clip_line([a, b], Bounds::rows(self.start.len()), search) else { return };
        let ends = [line.start, line.end].map(near);
        let [from, to] = ends.map(|v| [v[0], v[1]]);
        let [low, high] = self.rows.unwrap_or([i32::MAX, i32::MIN]);
        self.rows = Some([low.min(from[1]).min(to[1]), high.max(from[1]).max(to[1])]);
        let steps = i64::from(from[0].abs_diff(to[0]).max(from[1].abs_diff(to[1])));
        let value = |v: [i32; N], k: usize| v.get(2 + k).map_or(0, |&v| i64::from(v) << BORDER_BITS);
        let mut values: Vec<i64> = (0..self.extras).map(|k| value(ends[0], k)).collect();
        let increments: Vec<i64> =
            (0..self.extras).map(|k| (value(ends[1], k) - value(ends[0], k)) / steps.max(1)).collect();
        for [x, y] in Bresenham::new(from, to) {
            self.visit(x, y, &values);
            values.iter_mut().zip(&increments).for_each(|(v, i)| *v += i);
        }
    }

    /// The first pixel that reaches a column keeps it.
    fn visit(&mut self, x: i32, y: i32, values: &[i64]) {
        let row = y as usize;
        let rest = row * self.extras..(row + 1) * self.extras;
        if x < self.start[row] {
            self.start[row] = x;
            self.rest_start[rest.clone()].copy_from_slice(values);
        }
        if x > self.end[row] {
            self.end[row] = x;
            self.rest_end[rest].copy_from_slice(values);
        }
    }

    /// The rows, from the top.
    pub fn spans(&self) -> impl Iterator<Item = Span<'_>> {
        let [first, last] = self.rows.unwrap_or([0, -1]);
        (first..=last).map(|y| {
            let row = y as usize;
            let rest = row * self.extras..(row + 1) * self.extras;
            Span {
                y,
                start: self.start[row],
                end: self.end[row],
                rest_start: &self.rest_start[rest.clone()],
                rest_end: &self.rest_end[rest],
            }
        })
    }

    /// A whole polygon, clipped by the screen's sides as one and by its top and bottom edge by edge.
    #[must_use]
    pub fn of_polygon<const N: usize>(
        corners: &[[i32; N]],
        size: [usize; 2],
        extras: usize,
        search: Search,
    ) -> Self {
        let mut borders = Self::new(size[1], extras);
        let clipped = clip_polygon(corners, Bounds::columns(size[0]), search);
        for (i, &corner) in clipped.iter().enumerate() {
            borders.scan(corner, clipped[(i + 1) % clipped.len()], search);
        }
        borders
    }
}

fn near<const N: usize>(mut vertex: [i32; N]) -> [i32; N] {
    vertex[0] = vertex[0].clamp(-FARTHEST_COLUMN, FARTHEST_COLUMN);
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(corners: [[i32; 2]; 4], up: i32, search: Search) -> Vec<(i32, i32)> {
        let corners = corners.map(|[x, y]| [x + 20 * i32::from(up > 0), y + up]);
        let moved = 20 * i32::from(up > 0);
        let mut borders = Borders::new(60, 0);
        (0..4).for_each(|i| borders.scan(corners[i], corners[(i + 1) % 4], search));
        borders.spans().map(|s| (s.start - moved, s.end - moved)).collect()
    }

    #[test]
    fn the_polygon_of_figure_3_8() {
        let polygon = [[1, 0], [8, 1], [6, 4], [4, 4]];
        let mut reversed = polygon;
        reversed.reverse();
        for search in [Search::AsPrinted, Search::Precise] {
            assert_eq!(spans(polygon, 10, search), [(1, 4), (2, 8), (2, 7), (3, 7), (4, 6)]);
            assert_eq!(spans(reversed, 10, search), [(1, 4), (2, 8), (3, 7), (3, 7), (4, 6)]);
        }
        // On row 0 the slip in clipping makes the first row that of the figure.
        let figure = [(1, 5), (2, 8), (2, 7), (3, 7), (4, 6)];
        assert_eq!(spans(polygon, 0, Search::AsPrinted), figure);
        assert_eq!(spans(polygon, 0, Search::Precise)[0], (1, 4));
    }

    #[test]
    fn values_follow_the_edges() {
        let mut borders = Borders::new(20, 1);
        borders.scan([0, 0, 100, -7], [10, 10, 200, 3], Search::Precise);
        let at = |y: usize| borders.spans().nth(y).map(|s| (s.start, s.rest_start[0] >> BORDER_BITS));
        assert_eq!([at(0), at(5), at(10)], [Some((0, 100)), Some((5, 150)), Some((10, 200))]);
        assert_eq!(Borders::new(20, 3).spans().count(), 0);
        let mut missing = Borders::new(2, 1);
        missing.scan([0, 0], [1, 1], Search::Precise);
        assert_eq!(missing.spans().next().map(|s| s.rest_start[0]), Some(0));
    }

    #[test]
    fn edges_of_any_length_end() {
        let mut borders = Borders::new(8, 2);
        borders.scan([i32::MIN; 4], [i32::MAX; 4], Search::Precise);
        borders.scan([i32::MAX, 3, 0, 0], [i32::MIN, 4, 0, 0], Search::AsPrinted);
        assert_eq!(borders.spans().count(), 8);
    }
}
