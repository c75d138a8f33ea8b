//! Edges of a polygon to points on scan lines (1991 thesis, section 7.3).
//!
//! 1. Edges that end on the row they begin on are passed over.
//! 2. An edge is walked from its lower to its upper row number, whichever way the polygon runs.
//! 3. Its last row is left out, and so is the last pixel of a run: polygons that share an edge share
//!    no pixel and leave none out.
//! 4. x, depth and attribute begin with the vertex' own and grow by a step per row, the step being the
//!    difference over the difference of y before it was cut off to rows.
//!
//! The text rounds x to a pixel, the listing cuts it off.

use std::ops::Range;

use senca_math::glam::DVec3;

use super::clip::Attribute;

/// A point of an edge on a scan line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgePoint<A> {
    /// x in pixels.
    pub(super) x: f64,
    /// Depth.
    pub(super) z: f64,
    /// Intensity or normal.
    pub(super) attribute: A,
}

/// An edge, from its lower to its higher row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge<A> {
    rows: [i64; 2],
    start: EdgePoint<A>,
    step: EdgePoint<A>,
}

impl<A: Attribute> Edge<A> {
    /// The edge between two places in device coordinates; `None` when it covers no row, or is not
    /// finite.
    #[must_use]
    pub(super) fn new(a: (DVec3, A), b: (DVec3, A)) -> Option<Self> {
        let (from, to) = if (a.0.y as i64) < b.0.y as i64 { (a, b) } else { (b, a) };
        let rows = [from.0.y as i64, to.0.y as i64];
        if rows[0] == rows[1] || !from.0.is_finite() || !to.0.is_finite() {
            return None;
        }
        let per_row = 1.0 / (to.0.y - from.0.y);
        let along = (to.0 - from.0) * per_row;
        Some(Self {
            rows,
            start: EdgePoint { x: from.0.x, z: from.0.z, attribute: from.1 },
            step: EdgePoint { x: along.x, z: along.z, attribute: (to.1 - from.1) * per_row },
        })
    }

    /// Rows that the edge has a point on, those outside of `0..height` passed over.
    #[must_use]
    pub(super) fn rows(&self, height: i64) -> Range<i64> {
        self.rows[0].max(0)..self.rows[1].min(height)
    }

    /// The point on a row.
    #[must_use]
    pub(super) fn at(&self, row: i64) -> EdgePoint<A> {
        let steps = (row - self.rows[0]) as f64;
        EdgePoint {
            x: self.start.x + self.step.x * steps,
            z: self.start.z + self.step.z * steps,
            attribute: self.start.attribute + self.step.attribute * steps,
        }
    }
}

/// Points of a polygon's edges, a list for each scan line.
#[derive(Clone, Debug)]
pub(super) struct EdgeTable<A> {
    lists: Vec<Vec<EdgePoint<A>>>,
    rows: Range<usize>,
}

impl<A: Attribute> EdgeTable<A> {
    /// A table for a raster of this height.
    pub(super) fn new(height: u32) -> Self {
        Self { lists: vec![Vec::new(); height as usize], rows: 0..0 }
    }

    /// Enters the edges of a polygon in the place of the one before.
    pub(super) fn enter(&mut self, polygon: &[(DVec3, A)]) {
        self.lists[self.rows.clone()].iter_mut().for_each(Vec::clear);
        self.rows = self.lists.len()..0;
        let height = self.lists.len() as i64;
        for (i, &corner) in polygon.iter().enumerate() {
            let Some(edge) = Edge::new(corner, polygon[(i + 1) % polygon.len()]) else { continue };
            for row in edge.rows(height) {
                self.lists[row as usize].push(edge.at(row));
                self.rows = self.rows.start.min(row as usize)..self.rows.end.max(row as usize + 1);
            }
        }
        self.rows.start = self.rows.start.min(self.rows.end);
    }

    /// Runs between pairs of points, from left to right, row by row. The listing knows the two newest
    /// points of a row only, so polygons that are not convex break.
    pub(super) fn runs(
        &mut self,
        as_printed: bool,
    ) -> impl Iterator<Item = (usize, EdgePoint<A>, EdgePoint<A>)> + '_ {
        for list in &mut self.lists[self.rows.clone()] {
            if as_printed {
                list.drain(..list.len().saturating_sub(2));
            }
            list.sort_by(|a, b| a.x.total_cmp(&b.x));
        }
        let lists = &self.lists;
        let run = move |row: usize| lists[row].chunks_exact(2).map(move |pair| (row, pair[0], pair[1]));
        self.rows.clone().flat_map(run)
    }
}

/// Pixels of a run that lie in `0..width`, each with depth and attribute there. They grow from the
/// left end's own by a step per pixel.
pub(super) fn pixels<A: Attribute>(
    left: EdgePoint<A>,
    right: EdgePoint<A>,
    width: u32,
    as_printed: bool,
) -> impl Iterator<Item = (u32, f64, A)> {
    let column = |x: f64| if as_printed { x as i64 } else { x.round() as i64 };
    let (first, end) = (column(left.x), column(right.x));
    let per_pixel = 1.0 / (right.x - left.x);
    let (dz, da) = ((right.z - left.z) * per_pixel, (right.attribute - left.attribute) * per_pixel);
    let inside = first.max(0)..end.min(i64::from(width));
    inside.map(move |x| {
        let steps = (x - first) as f64;
        (x as u32, left.z + dz * steps, left.attribute + da * steps)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn corner(x: f64, y: f64) -> (DVec3, f64) {
        (DVec3::new(x, y, 0.0), 0.0)
    }

    #[test]
    fn the_worked_edge_has_four_points() {
        for ends in [[corner(2.7, 1.2), corner(6.3, 5.9)], [corner(6.3, 5.9), corner(2.7, 1.2)]] {
            let edge = Edge::new(ends[0], ends[1]).expect("an edge");
            assert_eq!(edge.rows(100), 1..5);
            for (row, x) in [(1, 2.7), (2, 3.466), (3, 4.232), (4, 4.998)] {
                assert!((edge.at(row).x - x).abs() < 5e-4, "row {row}: {}", edge.at(row).x);
            }
        }
    }

    #[test]
    fn rows_outside_are_passed_over_while_the_edge_goes_on() {
        let edge = Edge::new(corner(0.0, -10.0), corner(20.0, 10.0)).expect("an edge");
        assert_eq!(edge.rows(5), 0..5);
        assert_eq!(edge.at(0).x, 10.0);
        assert_eq!(Edge::new(corner(0.0, 3.1), corner(9.0, 3.9)), None);
        assert_eq!(Edge::new(corner(0.0, f64::NAN), corner(9.0, 3.9)), None);
        assert_eq!(Edge::new(corner(0.0, f64::INFINITY), corner(9.0, 3.9)), None);
    }

    #[test]
    fn the_last_pixel_of_a_run_is_left_out() {
        let at = |x: f64| EdgePoint { x, z: x, attribute: x };
        let columns = |l: f64, r: f64, as_printed| {
            pixels(at(l), at(r), 10, as_printed).map(|p| p.0).collect::<Vec<_>>()
        };
        assert_eq!(columns(2.0, 5.0, false), [2, 3, 4]);
        assert_eq!(columns(2.6, 5.6, false), [3, 4, 5]);
        assert_eq!(columns(2.6, 5.6, true), [2, 3, 4]);
        assert_eq!(columns(-5.0, 2.0, false), [0, 1]);
        assert_eq!(columns(8.0, 1e30, false), [8, 9]);
        assert!(columns(3.0, 3.0, false).is_empty());
        let first = pixels(at(-5.0), at(2.0), 10, false).next().expect("a pixel");
        assert_eq!(first, (0, 0.0, 0.0));
    }

    #[test]
    fn a_polygon_with_a_dent_is_filled_by_pairs() {
        let dented =
            [corner(0.0, 0.0), corner(4.0, 4.0), corner(8.0, 0.0), corner(8.0, 8.0), corner(0.0, 8.0)];
        let mut table = EdgeTable::new(10);
        table.enter(&dented);
        let on_row = |row: usize, table: &mut EdgeTable<f64>| {
            table.runs(false).filter(|run| run.0 == row).map(|run| (run.1.x, run.2.x)).collect::<Vec<_>>()
        };
        assert_eq!(on_row(1, &mut table), [(0.0, 1.0), (7.0, 8.0)]);
        assert_eq!(on_row(6, &mut table), [(0.0, 8.0)]);
        assert!(on_row(8, &mut table).is_empty());
    }

    proptest! {
        /// Triangles on both sides of a diagonal share no pixel and leave none of the polygon out.
        /// With whole numbers: where a vertex lies between rows, its edges begin with its own x.
        #[test]
        fn shared_edges_share_no_pixel(
            places in prop::array::uniform4((0..15i32, 0..15i32)),
            as_printed: bool,
        ) {
            let signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)];
            let around = |(p, s): (&(i32, i32), (i32, i32))| {
                corner(f64::from(15 + s.0 * p.0), f64::from(15 + s.1 * p.1))
            };
            let quad: Vec<_> = places.iter().zip(signs).map(around).collect();
            let fan = |corners: &[usize]| {
                let mut hits = vec![0u32; 900];
                for triangle in [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]] {
                    let mut table = EdgeTable::new(30);
                    table.enter(&triangle.map(|i| quad[i]));
                    for (row, l, r) in table.runs(as_printed) {
                        pixels(l, r, 30, as_printed).for_each(|p| hits[row * 30 + p.0 as usize] += 1);
                    }
                }
                hits
            };
            let cross = |a: usize, b: usize, c: usize| (quad[b].0 - quad[a].0).cross(quad[c].0 - quad[b].0).z;
            prop_assume!((0..4).all(|i| cross(i, (i + 1) % 4, (i + 2) % 4) > 1e-6));
            let mut whole = vec![0u32; 900];
            let mut table = EdgeTable::new(30);
            table.enter(&quad);
            for (row, l, r) in table.runs(false) {
                pixels(l, r, 30, as_printed).for_each(|p| whole[row * 30 + p.0 as usize] += 1);
            }
            for corners in [[0, 1, 2, 3], [1, 2, 3, 0]] {
                let hits = fan(&corners);
                prop_assert!(hits.iter().all(|&n| n <= 1));
                prop_assert_eq!(&hits, &whole);
            }
        }
    }
}
