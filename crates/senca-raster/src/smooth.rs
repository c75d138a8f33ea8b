//! Antialiasing by coverage: the share of each pixel that a convex polygon covers.
//!
//! The polygon is cut by the four sides of the pixel (Sutherland, Hodgman 1974); what is left has its
//! area by the sum over its edges. Lines are rectangles, points regular polygons of the area of the
//! disc, triangles themselves.

use crate::api::{Counters, Primitives, Shading, State};
use crate::assemble::{TriangleVaryings, for_each_triangle};
use crate::setup::{Bounds, SUB, ScreenMap, ScreenVertex, Setup};
use crate::sink::Sink;
use crate::target::Target;
use std::ops::Range;

/// Corners of a polygon that stands for a disc.
const DISC_CORNERS: usize = 32;
/// Corners of a polygon while it is cut: those of the largest, and one more per side of the pixel.
const MAX_CORNERS: usize = DISC_CORNERS + 4;

/// A place on screen in pixels of the target.
pub(crate) fn pixel_place(map: &ScreenMap, v: &ScreenVertex) -> [f64; 2] {
    [0, 1].map(|k| f64::from([v.x, v.y][k]) / f64::from(SUB) + f64::from(map.origin[k]))
}

/// The rectangle of a line: as long as the line, as wide as told.
pub(crate) fn line_outline(map: &ScreenMap, ends: [&ScreenVertex; 2], width: f32) -> [[f64; 2]; 4] {
    let [a, b] = ends.map(|v| pixel_place(map, v));
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx.hypot(dy);
    let half = 0.5 * f64::from(width.max(0.0));
    let (nx, ny) = if length > 0.0 { (-dy / length * half, dx / length * half) } else { (0.0, 0.0) };
    [[a[0] - nx, a[1] - ny], [b[0] - nx, b[1] - ny], [b[0] + nx, b[1] + ny], [a[0] + nx, a[1] + ny]]
}

/// A polygon of the area of a disc.
pub(crate) fn disc(centre: [f64; 2], diameter: f64) -> [[f64; 2]; DISC_CORNERS] {
    let step = std::f64::consts::TAU / DISC_CORNERS as f64;
    // Area n/2 r^2 sin(step) is to be pi (d/2)^2.
    let radius = 0.5 * diameter * (step / step.sin()).sqrt();
    std::array::from_fn(|k| {
        let (sin, cos) = (step * k as f64).sin_cos();
        [centre[0] + radius * cos, centre[1] + radius * sin]
    })
}

/// Columns and rows of the pixels a polygon may touch.
pub(crate) fn pixel_box(polygon: &[[f64; 2]]) -> [Range<i64>; 2] {
    [0, 1].map(|k| {
        let low = polygon.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = polygon.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        low.floor() as i64..high.ceil() as i64
    })
}

/// Calls `pixel` with every pixel of `bounds` that the polygon covers a part of, and that part.
pub(crate) fn for_each_pixel(polygon: &[[f64; 2]], bounds: Bounds, mut pixel: impl FnMut([i64; 2], f32)) {
    let [columns, rows] = pixel_box(polygon);
    for y in rows.start.max(i64::from(bounds.y0))..rows.end.min(i64::from(bounds.y1)) {
        let row = Corners::of(polygon).cut(1, y as f64, 1.0).cut(1, (y + 1) as f64, -1.0);
        let [touched, _] = pixel_box(row.list());
        let (from, to) = (touched.start.max(columns.start), touched.end.min(columns.end));
        for x in from.max(i64::from(bounds.x0))..to.min(i64::from(bounds.x1)) {
            let coverage = row.cut(0, x as f64, 1.0).cut(0, (x + 1) as f64, -1.0).area();
            if coverage > 0.0 {
                pixel([x, y], coverage.min(1.0) as f32);
            }
        }
    }
}

/// A convex polygon being cut.
#[derive(Clone, Copy)]
struct Corners {
    at: [[f64; 2]; MAX_CORNERS],
    len: usize,
}

impl Corners {
    fn of(polygon: &[[f64; 2]]) -> Self {
        let mut corners = Self { at: [[0.0; 2]; MAX_CORNERS], len: 0 };
        polygon.iter().for_each(|p| corners.push(*p));
        corners
    }

    fn push(&mut self, p: [f64; 2]) {
        if let Some(slot) = self.at.get_mut(self.len) {
            *slot = p;
            self.len += 1;
        }
    }

    fn list(&self) -> &[[f64; 2]] {
        &self.at[..self.len]
    }

    /// The part where coordinate `k` is on the side of `limit` that `sign` says.
    fn cut(&self, k: usize, limit: f64, sign: f64) -> Self {
        let mut kept = Self { at: [[0.0; 2]; MAX_CORNERS], len: 0 };
        for (n, a) in self.list().iter().enumerate() {
            let b = self.at[(n + 1) % self.len];
            let (da, db) = (sign * (a[k] - limit), sign * (b[k] - limit));
            if da >= 0.0 {
                kept.push(*a);
            }
            if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
                let t = da / (da - db);
                let mut at = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                at[k] = limit;
                kept.push(at);
            }
        }
        kept
    }

    fn area(&self) -> f64 {
        let edge = |n: usize| {
            let (a, b) = (self.at[n], self.at[(n + 1) % self.len]);
            a[0] * b[1] - a[1] * b[0]
        };
        0.5 * (0..self.len).map(edge).sum::<f64>().abs()
    }
}

/// Draws triangles with the coverage of their pixels, one after another.
pub(crate) fn draw_triangles(
    target: &mut Target<'_>,
    triangles: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
) -> Counters {
    crate::pixel::clear_in_scissor(target, state);
    let map = ScreenMap::new(target.width, target.height, state);
    let mut counters = Counters::default();
    let mut sink = Sink::new(target, 0, state, shading, &map);
    for_each_triangle(triangles, &map, state, &mut counters, |setup, varyings, id, _| {
        sink.begin(id, setup.swapped, varyings.count);
        draw_triangle(&mut sink, setup, varyings, &map);
    });
    counters += sink.counters;
    counters
}

fn draw_triangle(sink: &mut Sink<'_, '_>, setup: &Setup, varyings: &TriangleVaryings, map: &ScreenMap) {
    let offset = |x: i32, y: i32| {
        let ([ox, oy], [rx, ry]) = (map.origin, setup.reference);
        [(x - ox - rx) as f32, (y - oy - ry) as f32]
    };
    let values = |x: i32, y: i32, out: &mut [f32]| {
        let at = offset(x, y);
        let weights = setup.weights(at[0], at[1]);
        for (k, out) in out.iter_mut().enumerate() {
            *out = varyings.at(k, setup.affine, at, weights);
        }
    };
    let outline = setup.v.map(|v| pixel_place(map, &v));
    let bounds = sink.bounds;
    for_each_pixel(&outline, bounds, |pixel, coverage| {
        let [fx, fy] = offset(pixel[0] as i32, pixel[1] as i32);
        sink.fragment(pixel, setup.depth(fx, fy), coverage, &values);
    });
    sink.end(&values);
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Bounds = Bounds { x0: -100, y0: -100, x1: 100, y1: 100 };

    fn covered(polygon: &[[f64; 2]]) -> Vec<([i64; 2], f32)> {
        let mut found = Vec::new();
        for_each_pixel(polygon, ALL, |pixel, coverage| found.push((pixel, coverage)));
        found
    }

    #[test]
    fn a_rectangle_covers_the_shares_its_sides_leave() {
        let found = covered(&[[0.25, 1.5], [2.0, 1.5], [2.0, 3.0], [0.25, 3.0]]);
        let expected = [([0, 1], 0.375), ([1, 1], 0.5), ([0, 2], 0.75), ([1, 2], 1.0)];
        assert_eq!(found, expected);
    }

    #[test]
    fn shares_add_up_to_the_area() {
        let sum = |polygon: &[[f64; 2]]| covered(polygon).iter().map(|p| f64::from(p.1)).sum::<f64>();
        assert!((sum(&[[-3.3, 1.2], [7.9, 2.4], [4.1, 9.7]]) - 43.16).abs() < 1e-4);
        let round = sum(&disc([3.3, -2.2], 7.0));
        assert!((round - std::f64::consts::PI * 12.25).abs() < 1e-4, "{round}");
    }
}
