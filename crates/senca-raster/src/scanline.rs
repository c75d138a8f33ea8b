//! The scan-line rasterizer: the form of the books, to be read in one sitting.
//!
//! 1. The corners are sorted by row, which leaves one long edge and two short ones.
//! 2. Each edge is walked from row to row by adding its slope; the division is done once, the
//!    remainder carried along in integers, so no edge drifts (course text, section 2.9, equation 2.19;
//!    1991 thesis, section 7.3; Bresenham 1965).
//! 3. A row is filled from the left edge up to, but without, the right edge; the top row belongs to
//!    the triangle, the bottom one does not. So triangles that share an edge share no pixel and leave
//!    none out (1991 thesis, section 7.3, rules 3 and 4).
//! 4. Depth is compared per pixel; what is hidden gets no colour (course text, section 2.9).
//!
//! The books round corners to whole pixels or edges to the nearest one, both ends included;
//! [`book_spans`] is that rule. Here corners lie on a raster of 1/256 pixel and a pixel belongs to the
//! triangle that has its centre: the rule of [`crate::TiledRasterizer`], which covers the same pixels.

use crate::api::{Counters, Fragments, LANES, MAX_VARYINGS, Primitives, Rasterizer, Shaded, Shading, State};
use crate::assemble::{TriangleVaryings, for_each_triangle};
use crate::multisample::{SAMPLES, place_of, sample_of};
use crate::setup::{HALF, SUB, ScreenMap, ScreenVertex, Setup, ceil_div};
use crate::shade::{self, interpolate, shade_plain};
use crate::stage::{run_stage, run_stage_on_samples, stage_of};
use crate::target::Target;

/// Draws triangle after triangle, row after row, on one thread. The oracle of
/// [`crate::TiledRasterizer`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ScanlineRasterizer;

impl Rasterizer for ScanlineRasterizer {
    fn draw(
        &mut self,
        target: &mut Target<'_>,
        triangles: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        if state.antialias {
            return crate::smooth::draw_triangles(target, triangles, state, shading);
        }
        crate::pixel::clear_in_scissor(target, state);
        let map = ScreenMap::new(target.width, target.height, state);
        let mut counters = Counters::default();
        let untested = stage_of(shading).is_some_and(|stage| stage.tests_depth());
        for_each_triangle(triangles, &map, state, &mut counters, |setup, varyings, id, counters| {
            let mut row =
                RowFiller { target, state, shading, map: &map, setup, varyings, id, untested, counters };
            for_each_span(&setup.v, &map, |y, columns| row.fill(y, columns));
        });
        counters
    }
}

/// An edge on its way down: the first column whose centre is on or right of it, row after row.
struct Edge {
    column: i64,
    /// How far beyond the edge that column's centre is, in units of `1 / run`; at least 0, less than
    /// `run`.
    beyond: i64,
    step: i64,
    step_beyond: i64,
    run: i64,
}

impl Edge {
    /// The edge from `top` to `bottom`, which lies lower, at pixel row `row`.
    fn new(top: &ScreenVertex, bottom: &ScreenVertex, row: i64) -> Self {
        let (sub, half) = (i64::from(SUB), i64::from(HALF));
        let dy = i64::from(bottom.y) - i64::from(top.y);
        let dx = i64::from(bottom.x) - i64::from(top.x);
        let down = row * sub + half - i64::from(top.y);
        // Column centre c * 256 + 128 against x = top.x + down * dx / dy, both times dy.
        let run = sub * dy;
        let wanted = (i64::from(top.x) - half) * dy + down * dx;
        let column = ceil_div(wanted, run);
        let step = ceil_div(sub * dx, run);
        Self { column, beyond: column * run - wanted, step, step_beyond: step * run - sub * dx, run }
    }

    fn advance(&mut self) {
        self.column += self.step;
        self.beyond += self.step_beyond;
        if self.beyond >= self.run {
            self.beyond -= self.run;
            self.column -= 1;
        }
    }
}

/// First pixel row whose centre is on or below `y`.
fn first_row(y: i32) -> i64 {
    ceil_div(i64::from(y) - i64::from(HALF), i64::from(SUB))
}

/// Calls `span(row, columns)` for each row of the target the triangle covers, `columns` half open.
fn for_each_span(
    corners: &[ScreenVertex; 3],
    map: &ScreenMap,
    mut span: impl FnMut(i32, std::ops::Range<i32>),
) {
    let mut v = *corners;
    v.sort_by_key(|c| c.y);
    let [ox, oy] = map.origin.map(i64::from);
    let (top, bottom) = (i64::from(map.bounds.y0) - oy, i64::from(map.bounds.y1) - oy);
    let (left, right) = (i64::from(map.bounds.x0), i64::from(map.bounds.x1));
    for (a, b) in [(0, 1), (1, 2)] {
        let (from, to) = (first_row(v[a].y).max(top), first_row(v[b].y).min(bottom));
        if from >= to {
            continue;
        }
        let mut long = Edge::new(&v[0], &v[2], from);
        let mut short = Edge::new(&v[a], &v[b], from);
        for row in from..to {
            let (x0, x1) = (long.column.min(short.column) + ox, long.column.max(short.column) + ox);
            let columns = x0.max(left) as i32..x1.min(right) as i32;
            if !columns.is_empty() {
                span((row + oy) as i32, columns);
            }
            long.advance();
            short.advance();
        }
    }
}

/// Fills rows of one triangle.
struct RowFiller<'a, 't> {
    target: &'a mut Target<'t>,
    state: &'a State,
    shading: &'a Shading<'a>,
    map: &'a ScreenMap,
    setup: &'a Setup,
    varyings: &'a TriangleVaryings,
    id: u32,
    /// Depth is tested by the stage.
    untested: bool,
    counters: &'a mut Counters,
}

impl RowFiller<'_, '_> {
    /// Pixels from the triangle's reference pixel, as planes count them.
    fn offset(&self, x: i32, y: i32) -> [f32; 2] {
        let [ox, oy] = self.map.origin;
        let [rx, ry] = self.setup.reference;
        [(x - ox - rx) as f32, (y - oy - ry) as f32]
    }

    /// One row of the triangle, in groups of 8 columns, which are what a shader is given.
    fn fill(&mut self, y: i32, columns: std::ops::Range<i32>) {
        let mut x = columns.start;
        while x < columns.end {
            let end = ((x & !7) + 8).min(columns.end);
            self.fill_group(y, x..end);
            x = end;
        }
    }

    fn fill_group(&mut self, y: i32, columns: std::ops::Range<i32>) {
        if self.state.multisample && self.shading.colors_pixels() {
            return self.fill_samples(y, columns);
        }
        let first_lane = 8 * (y & 1) as usize;
        let mut batch = Batch { x: columns.start & !7, y: y & !1, mask: 0, depth: [0.0; LANES] };
        for x in columns {
            let [fx, fy] = self.offset(x, y);
            let depth = self.setup.depth(fx, fy);
            if self.passes(x, y, depth) {
                let lane = first_lane + (x & 7) as usize;
                batch.mask |= 1 << lane;
                batch.depth[lane] = depth;
            }
        }
        if batch.mask == 0 {
            return;
        }
        match stage_of(self.shading) {
            Some(stage) => {
                self.with_fragments(&batch, |row, fragments, _| {
                    row.counters.shaded += u64::from(batch.mask.count_ones());
                    let passed = run_stage(stage, row.target, 0, row.state, fragments);
                    row.counters.passed += u64::from(passed.count_ones());
                });
            }
            None => {
                self.counters.passed += u64::from(batch.mask.count_ones());
                self.write(&batch);
            }
        }
    }

    /// One row of samples of four pixels.
    fn fill_samples(&mut self, y: i32, columns: std::ops::Range<i32>) {
        let (mut masks, mut depths) = ([0u16; SAMPLES], [[0.0; LANES]; SAMPLES]);
        let corner = [columns.start & !7, y & !7];
        for x in columns {
            let [fx, fy] = self.offset(x, y);
            let depth = self.setup.depth(fx, fy);
            if self.passes(x, y, depth) {
                let (sample, lane) = sample_of((x & 7) as usize, (y & 7) as usize);
                masks[sample] |= 1 << lane;
                depths[sample][lane] = depth;
            }
        }
        let mask = masks.iter().fold(0, |any, mask| any | mask);
        if mask == 0 {
            return;
        }
        let mut values = [[0.0; LANES]; MAX_VARYINGS];
        let values = &mut values[..self.varyings.count];
        let [fx, fy] = self.offset(corner[0], corner[1]);
        let mut depth = [0.0; LANES];
        for lane in 0..LANES {
            let at = shade::place_of(4, [fx, fy], lane);
            let weights = self.setup.weights(at[0], at[1]);
            depth[lane] = self.setup.depth(at[0], at[1]);
            for (k, plane) in values.iter_mut().enumerate() {
                plane[lane] = self.varyings.at(k, self.setup.affine, at, weights);
            }
        }
        let fragments = Fragments {
            x: corner[0] as u32 / 2,
            y: corner[1] as u32 / 2,
            columns: 4,
            sample: 0,
            mask,
            depth,
            varyings: values,
            id: self.id,
            front: self.setup.swapped,
            coverage: None,
        };
        self.counters.shaded += u64::from(mask.count_ones());
        self.counters.passed += match stage_of(self.shading) {
            Some(stage) => {
                run_stage_on_samples(stage, self.target, 0, self.state, &fragments, &masks, &depths)
            }
            None => {
                let mut shaded = Shaded::default();
                shade_plain(self.shading, self.setup, self.varyings, [fx, fy], &fragments, &mut shaded);
                self.write_samples(corner, &shaded, &masks, &depths)
            }
        };
    }

    /// Writes the samples of four by four pixels; returns how many.
    fn write_samples(
        &mut self,
        corner: [i32; 2],
        shaded: &Shaded,
        masks: &[u16; SAMPLES],
        depths: &[[f32; LANES]; SAMPLES],
    ) -> u64 {
        let colors = self.target.color.is_some();
        let masks = masks.map(|mask| mask & shaded.keep);
        for (sample, (mask, depths)) in masks.iter().zip(depths).enumerate() {
            for lane in (0..LANES).filter(|lane| mask >> lane & 1 == 1) {
                let (x, y) = place_of(sample, lane);
                let (x, y) = (corner[0] + x as i32, corner[1] + y as i32);
                let rgba = colors.then(|| shaded.rgba.map(|plane| plane[lane]));
                crate::pixel::write(self.target, self.state, x, y, depths[lane], self.id, rgba);
            }
        }
        masks.iter().map(|mask| u64::from(mask.count_ones())).sum()
    }

    /// Whether a fragment or sample passes the tests that are the rasterizer's business. Does what the stencil test
    /// does.
    fn passes(&mut self, x: i32, y: i32, depth: f32) -> bool {
        self.counters.tested += 1;
        match stage_of(self.shading) {
            Some(_) => self.untested || crate::pixel::depth_passes(self.target, self.state, x, y, depth),
            None => crate::pixel::passes(self.target, self.state, x, y, depth),
        }
    }

    /// Calls `with` with the fragments of a batch, and where its lane 0 is.
    fn with_fragments(&mut self, batch: &Batch, with: impl FnOnce(&mut Self, &Fragments<'_>, [f32; 2])) {
        let mut values = [[0.0; LANES]; MAX_VARYINGS];
        let values = &mut values[..self.varyings.count];
        let at = self.offset(batch.x, batch.y);
        interpolate(self.setup, self.varyings, at, values);
        let fragments = Fragments {
            x: batch.x as u32,
            y: batch.y as u32,
            columns: 8,
            sample: 0,
            mask: batch.mask,
            depth: batch.depth,
            varyings: values,
            id: self.id,
            front: self.setup.swapped,
            coverage: None,
        };
        with(self, &fragments, at);
    }

    fn write(&mut self, batch: &Batch) {
        let mut shaded = Shaded::default();
        let colors = self.target.color.is_some() && !matches!(self.shading, Shading::None);
        let tests_alpha = self.shading.alpha_test().is_some();
        if colors || tests_alpha || matches!(self.shading, Shading::Custom(_)) {
            self.with_fragments(batch, |row, fragments, at| {
                shade_plain(row.shading, row.setup, row.varyings, at, fragments, &mut shaded);
            });
            self.counters.shaded += u64::from(batch.mask.count_ones());
        }
        let mask = batch.mask & shaded.keep;
        if tests_alpha {
            self.counters.passed -= u64::from((batch.mask & !mask).count_ones());
        }
        for lane in (0..LANES).filter(|lane| mask >> lane & 1 == 1) {
            let (x, y) = (batch.x + (lane % 8) as i32, batch.y + (lane / 8) as i32);
            let rgba = colors.then(|| shaded.rgba.map(|plane| plane[lane]));
            crate::pixel::write(self.target, self.state, x, y, batch.depth[lane], self.id, rgba);
        }
    }
}

/// Pixels of one row that go to the shader together.
struct Batch {
    x: i32,
    y: i32,
    mask: u16,
    depth: [f32; LANES],
}

/// A row of the book's rule: where the long and the short edge meet it, and the pixels between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BookSpan {
    /// Row.
    pub y: i32,
    /// Where the long edge, from the first to the last corner by row, meets the row.
    pub x_long: f64,
    /// Where the short edge meets it.
    pub x_short: f64,
    /// The value on the long edge.
    pub value_long: f64,
    /// The value on the short edge.
    pub value_short: f64,
}

impl BookSpan {
    /// First and last column, both drawn. Halves round away from zero.
    #[must_use]
    pub fn columns(&self) -> [i32; 2] {
        let (a, b) = (self.x_long.min(self.x_short), self.x_long.max(self.x_short));
        [a.round() as i32, b.round() as i32]
    }

    /// The value at column `x` (equation 2.20).
    #[must_use]
    pub fn value_at(&self, x: f64) -> f64 {
        if self.x_long == self.x_short {
            return self.value_long;
        }
        let t = (x - self.x_long) / (self.x_short - self.x_long);
        self.value_long + t * (self.value_short - self.value_long)
    }
}

/// The rows of a triangle as the book fills them: integer rows with both ends, `Round(xA)` to
/// `Round(xB)` with both ends, `corners` being (x, y, value) with pixel centres at integers.
///
/// Neighbours drawn so share the pixels of their common edge; the rasterizers here do not fill by
/// this rule. Source: course text, section 2.9, equations 2.19 and 2.20.
#[must_use]
pub fn book_spans(corners: [[f64; 3]; 3]) -> Vec<BookSpan> {
    let mut p = corners;
    p.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let along = |a: [f64; 3], b: [f64; 3], y: f64, k: usize| match b[1] - a[1] {
        0.0 => b[k],
        run => a[k] + (y - a[1]) / run * (b[k] - a[k]),
    };
    let span = |y: i32| {
        let row = f64::from(y);
        let (a, b) = if row <= p[1][1] { (p[0], p[1]) } else { (p[1], p[2]) };
        BookSpan {
            y,
            x_long: along(p[0], p[2], row, 0),
            x_short: along(a, b, row, 0),
            value_long: along(p[0], p[2], row, 2),
            value_short: along(a, b, row, 2),
        }
    };
    (p[0][1].ceil() as i32..=p[2][1].floor() as i32).map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_worked_triangle() {
        // P1 = (2,1), P2 = (8,3), P3 = (4,9), values 0, 1, 0.5.
        let spans = book_spans([[2.0, 1.0, 0.0], [8.0, 3.0, 1.0], [4.0, 9.0, 0.5]]);
        let expected = [
            (1, 2.0, 2.0),
            (2, 2.25, 5.0),
            (3, 2.5, 8.0),
            (4, 2.75, 7.333_333),
            (5, 3.0, 6.666_667),
            (6, 3.25, 6.0),
            (7, 3.5, 5.333_333),
            (8, 3.75, 4.666_667),
            (9, 4.0, 4.0),
        ];
        assert_eq!(spans.len(), expected.len());
        for (span, (y, long, short)) in spans.iter().zip(expected) {
            assert_eq!(span.y, y);
            assert!((span.x_long - long).abs() < 1e-6 && (span.x_short - short).abs() < 1e-6, "{span:?}");
        }
        // Halves round away from zero: rows 3 and 7 begin at 2.5 and 3.5.
        assert_eq!([spans[2].columns(), spans[6].columns()], [[3, 8], [4, 5]]);
        let values = [0.340_909, 0.363_636, 0.386_364, 0.409_091, 0.431_818, 0.454_545, 0.477_273];
        for (span, expected) in spans[1..8].iter().zip(values) {
            assert!((span.value_at(4.0) - expected).abs() < 1e-6, "{span:?}");
        }
    }

    #[test]
    fn flat_tops_and_points_have_their_rows() {
        let flat = book_spans([[1.0, 2.0, 0.0], [5.0, 2.0, 1.0], [3.0, 4.0, 0.5]]);
        assert_eq!(flat.iter().map(BookSpan::columns).collect::<Vec<_>>(), [[1, 5], [2, 4], [3, 3]]);
        assert_eq!(flat[0].value_at(3.0), 0.5);
        let point = book_spans([[3.0, 3.0, 0.7]; 3]);
        assert_eq!((point.len(), point[0].columns(), point[0].value_at(3.0)), (1, [3, 3], 0.7));
        assert!(book_spans([[0.0, 0.3, 0.0], [1.0, 0.4, 0.0], [2.0, 0.6, 0.0]]).is_empty());
    }

    #[test]
    fn an_edge_walked_by_steps_is_the_edge_divided_each_time() {
        let corner = |x: i32, y: i32| ScreenVertex { x, y, z: 0.0, inv_w: 1.0 };
        for (top, bottom) in [
            (corner(-700, -3000), corner(12_345, 8000)),
            (corner(9000, 17), corner(-40_000, 5001)),
            (corner(5, -100), corner(5, 9000)),
            (corner(-8_000_000, -8_000_000), corner(8_000_000, 8_000_000)),
        ] {
            let first = first_row(top.y);
            let mut walked = Edge::new(&top, &bottom, first);
            for row in first..first_row(bottom.y).min(first + 500) {
                assert_eq!(walked.column, Edge::new(&top, &bottom, row).column, "row {row}");
                walked.advance();
            }
        }
    }
}
