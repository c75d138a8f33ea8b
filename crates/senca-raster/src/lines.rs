//! Lines and points, one fragment after another.
//!
//! A line is cut by the view volume in homogeneous coordinates, then walked along the axis it runs
//! along more: one pixel (or, if wide, one row or column of pixels across) for each pixel centre from
//! its start up to, but without, its end. The other coordinate is exact in integers: what Bresenham's
//! algorithm (1965) gives for corners on a raster of 1/256 pixel. A point is the square of pixels whose
//! centres lie within it.

use crate::api::{
    Counters, Fragments, Interpolation, LANES, MAX_VARYINGS, Primitives, Shaded, Shading, State,
};
use crate::assemble::{TriangleVaryings, varyings_of, vertex_count};
use crate::clip::{VIEW_VOLUME, clip_line, wholly_outside};
use crate::setup::{HALF, SUB, ScreenMap, ScreenVertex, Setup, SetupState, ceil_div};
use crate::shade::shade_plain;
use crate::target::Target;
use senca_math::glam::Vec4;

/// Widest line and largest point, in pixels.
const MAX_SIZE: f32 = 4096.0;

pub(crate) fn draw_lines(
    target: &mut Target<'_>,
    lines: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
) -> Counters {
    draw_each(target, lines, state, shading, |sink, clip: [Vec4; 2], ends| {
        let Some([t0, t1]) = clip_line(clip[0], clip[1], &VIEW_VOLUME) else { return false };
        sink.counters.clipped += u64::from(t0 > 0.0 || t1 < 1.0);
        let values = ends.map(|i| varyings_of(lines, i));
        let line = Line::new(sink.map, clip, [t0, t1], state);
        line.walk(state.line_width, |x, y, depth, t| {
            sink.values.count = lines.stride;
            for (k, terms) in sink.values.terms.iter_mut().enumerate().take(lines.stride) {
                *terms = match state.interpolation {
                    Interpolation::FlatFirst => [values[0][k], 0.0, 0.0],
                    Interpolation::FlatLast => [values[1][k], 0.0, 0.0],
                    _ => [values[0][k] + t * (values[1][k] - values[0][k]), 0.0, 0.0],
                };
            }
            sink.fragment(x, y, depth);
        });
        true
    })
}

pub(crate) fn draw_points(
    target: &mut Target<'_>,
    points: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
) -> Counters {
    draw_each(target, points, state, shading, |sink, [clip]: [Vec4; 1], [index]| {
        if wholly_outside(&[clip], &VIEW_VOLUME) || clip.w <= 0.0 {
            return false;
        }
        let values = varyings_of(points, index);
        sink.values.count = values.len();
        for (terms, &value) in sink.values.terms.iter_mut().zip(values) {
            *terms = [value, 0.0, 0.0];
        }
        sink.square(sink.map.project_clipped(clip), state.point_size);
        true
    })
}

/// Clears, then calls `draw` with the corners of each primitive, of which there are `N`, and their
/// numbers; it returns whether any of the primitive is in the view volume.
fn draw_each<const N: usize>(
    target: &mut Target<'_>,
    primitives: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    mut draw: impl FnMut(&mut Sink<'_, '_>, [Vec4; N], [u32; N]) -> bool,
) -> Counters {
    crate::pixel::clear_in_scissor(target, state);
    let map = ScreenMap::new(target.width, target.height, state);
    let mut sink = Sink::new(target, state, shading, &map);
    let vertices = vertex_count(primitives);
    for (n, &indices) in primitives.indices.as_chunks::<N>().0.iter().enumerate() {
        sink.counters.primitives += 1;
        sink.id = primitives.ids.of(n);
        match corners(primitives, indices, vertices) {
            None => sink.counters.invalid += 1,
            Some(clip) if draw(&mut sink, clip, indices) => sink.counters.drawn += 1,
            Some(_) => sink.counters.outside += 1,
        }
    }
    sink.counters
}

/// Clip-space corners; `None` when one is out of range or not finite.
fn corners<const N: usize>(p: &Primitives<'_>, indices: [u32; N], vertices: usize) -> Option<[Vec4; N]> {
    let valid = indices.iter().all(|&i| (i as usize) < vertices && p.positions[i as usize].is_finite());
    valid.then(|| indices.map(|i| p.positions[i as usize]))
}

/// Whole pixels of a width or size: rounded, at least 1.
fn whole_size(size: f32) -> i64 {
    (size.clamp(1.0, MAX_SIZE) + 0.5) as i64
}

/// A line on screen.
struct Line {
    start: ScreenVertex,
    end: ScreenVertex,
    /// The part of the submitted line that is left, in its own parameter.
    part: [f32; 2],
    screen_space: bool,
    origin: [i64; 2],
}

impl Line {
    fn new(map: &ScreenMap, clip: [Vec4; 2], part: [f32; 2], state: &State) -> Self {
        let at = |t: f32| match t {
            0.0 => clip[0],
            1.0 => clip[1],
            _ => clip[0] * (1.0 - t) + clip[1] * t,
        };
        Self {
            start: map.project_clipped(at(part[0])),
            end: map.project_clipped(at(part[1])),
            part,
            screen_space: state.interpolation == Interpolation::Screen,
            origin: map.origin.map(i64::from),
        }
    }

    /// Calls `emit` with pixel, depth, and the parameter of the submitted line.
    fn walk(&self, width: f32, mut emit: impl FnMut(i64, i64, f32, f32)) {
        let (dx, dy) = (i64::from(self.end.x - self.start.x), i64::from(self.end.y - self.start.y));
        let (along_x, width) = (dx.abs() >= dy.abs(), whole_size(width));
        // (a, b): along and across the line.
        let (a0, b0, da, db) = if along_x {
            (i64::from(self.start.x), i64::from(self.start.y), dx, dy)
        } else {
            (i64::from(self.start.y), i64::from(self.start.x), dy, dx)
        };
        let (sub, half) = (i64::from(SUB), i64::from(HALF));
        // Pixel centres from a0, included, to a0 + da, not included, whichever way it runs.
        let sign = da.signum();
        let first = sign * ceil_div(sign * (a0 - half), sub);
        let count = ceil_div(sign * (a0 + da - half), sub) - sign * first;
        for step in 0..count.max(0) {
            let a = first + sign * step;
            let run = a * sub + half - a0;
            let across = b0 * da.abs() + sign * run * db - (width - 1) * half * da.abs();
            let b = across.div_euclid(sub * da.abs());
            let t = run as f32 / da as f32;
            for k in 0..width {
                let (x, y) = if along_x { (a, b + k) } else { (b + k, a) };
                emit(x + self.origin[0], y + self.origin[1], self.depth(t), self.parameter(t));
            }
        }
    }

    fn depth(&self, t: f32) -> f32 {
        (self.start.z + t * (self.end.z - self.start.z)).clamp(0.0, 1.0)
    }

    fn parameter(&self, t: f32) -> f32 {
        let [t0, t1] = self.part;
        let (q0, q1) = (self.start.inv_w, self.end.inv_w);
        let s = if self.screen_space { t } else { t * q1 / (q0 + t * (q1 - q0)) };
        t0 + s * (t1 - t0)
    }
}

/// Where single fragments go.
struct Sink<'a, 't> {
    target: &'a mut Target<'t>,
    state: &'a State,
    shading: &'a Shading<'a>,
    map: &'a ScreenMap,
    setup: Setup,
    values: TriangleVaryings,
    id: u32,
    counters: Counters,
}

impl<'a, 't> Sink<'a, 't> {
    fn new(
        target: &'a mut Target<'t>,
        state: &'a State,
        shading: &'a Shading<'a>,
        map: &'a ScreenMap,
    ) -> Self {
        // A triangle whose weights do not change: varyings have their base value everywhere.
        let setup = Setup::new([ScreenVertex::default(); 3], 1, &SetupState::new(&State::default()));
        let values = TriangleVaryings::default();
        Self { target, state, shading, map, setup, values, id: 0, counters: Counters::default() }
    }

    fn square(&mut self, at: ScreenVertex, size: f32) {
        let side = whole_size(size);
        let first = |c: i32, origin: i32| {
            let corner = i64::from(c) - side * i64::from(HALF) - i64::from(HALF);
            ceil_div(corner, i64::from(SUB)) + i64::from(origin)
        };
        let (x, y) = (first(at.x, self.map.origin[0]), first(at.y, self.map.origin[1]));
        let b = self.map.bounds;
        for row in y.max(i64::from(b.y0))..(y + side).min(i64::from(b.y1)) {
            for column in x.max(i64::from(b.x0))..(x + side).min(i64::from(b.x1)) {
                self.fragment(column, row, at.z);
            }
        }
    }

    fn fragment(&mut self, x: i64, y: i64, depth: f32) {
        let b = self.map.bounds;
        let inside =
            x >= i64::from(b.x0) && x < i64::from(b.x1) && y >= i64::from(b.y0) && y < i64::from(b.y1);
        if !inside {
            return;
        }
        let (x, y) = (x as i32, y as i32);
        self.counters.tested += 1;
        if !crate::pixel::depth_passes(self.target, self.state, x, y, depth) {
            return;
        }
        self.counters.passed += 1;
        let Some(rgba) = self.shade(x, y, depth) else { return };
        let rgba = Some(rgba).filter(|_| !matches!(self.shading, Shading::None));
        crate::pixel::write(self.target, self.state, x, y, depth, self.id, rgba);
    }

    /// Colour of the pixel; `None` when it is discarded.
    fn shade(&mut self, x: i32, y: i32, depth: f32) -> Option<[f32; 4]> {
        let lane = ((y & 1) * 8 + (x & 7)) as usize;
        let mut varyings = [[0.0; LANES]; MAX_VARYINGS];
        for (plane, terms) in varyings.iter_mut().zip(&self.values.terms).take(self.values.count) {
            *plane = [terms[0]; LANES];
        }
        let fragments = Fragments {
            x: (x & !7) as u32,
            y: (y & !1) as u32,
            mask: 1 << lane,
            depth: [depth; LANES],
            varyings: &varyings[..self.values.count],
            id: self.id,
            front: true,
        };
        let mut shaded = Shaded::default();
        shade_plain(self.shading, &self.setup, &self.values, [0.0; 2], &fragments, &mut shaded);
        self.counters.shaded += u64::from(!matches!(self.shading, Shading::None));
        (shaded.keep >> lane & 1 == 1).then(|| shaded.rgba.map(|plane| plane[lane]))
    }
}
