//! Lines and points, one fragment after another.
//!
//! A line is cut by the view volume in homogeneous coordinates, then walked along the axis it runs
//! along more: one pixel (or, if wide, one row or column of pixels across) for each pixel centre from
//! its start up to, but without, its end. The other coordinate is exact in integers: what Bresenham's
//! algorithm (1965) gives for corners on a raster of 1/256 pixel. A point is the square of pixels whose
//! centres lie within it.
//!
//! Several threads draw strips of rows, each all primitives in order as far as they lie in its strip:
//! every pixel meets its fragments in the same order as with one strip that is the whole picture.

use crate::api::{
    Counters, Fragments, Interpolation, LANES, MAX_VARYINGS, Primitives, Shaded, Shading, State,
};
use crate::assemble::{TriangleVaryings, varyings_of, vertex_count};
use crate::clip::{VIEW_VOLUME, clip_line, wholly_outside};
use crate::setup::{Bounds, HALF, SUB, ScreenMap, ScreenVertex, Setup, SetupState, ceil_div};
use crate::shade::shade_plain;
use crate::stage::{FragmentStage, run_stage, stage_of};
use crate::target::Target;
use rayon::prelude::*;
use senca_math::glam::Vec4;
use std::ops::Range;

/// Widest line and largest point, in pixels.
const MAX_SIZE: f32 = 4096.0;

/// Primitives made ready at once, which bounds the memory for them.
const RUN: usize = 1 << 16;

/// Fewer primitives than this are not worth a second thread.
const WORTH_SHARING: usize = 128;

/// Strips for each thread, so that one with little in it does not leave a thread idle.
const STRIPS_PER_THREAD: usize = 4;

/// Draws lines on `threads` threads.
pub(crate) fn draw_lines(
    target: &mut Target<'_>,
    lines: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    threads: usize,
) -> Counters {
    draw::<2, Line>(target, lines, state, shading, threads)
}

/// Draws points on `threads` threads.
pub(crate) fn draw_points(
    target: &mut Target<'_>,
    points: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    threads: usize,
) -> Counters {
    draw::<1, Square>(target, points, state, shading, threads)
}

/// A primitive of `N` corners on screen.
trait Stroke<const N: usize>: Sized + Send + Sync {
    /// From corners in clip space, with whether it was cut; `None` when none of it is in the view volume.
    fn new(map: &ScreenMap, clip: [Vec4; N]) -> Option<(Self, bool)>;

    /// Hands those of its fragments to `sink` that are in the sink's rows. `vertices` are its corners.
    fn draw(&self, sink: &mut Sink<'_, '_>, primitives: &Primitives<'_>, vertices: [u32; N]);
}

/// What became of a primitive.
enum Prepared<S> {
    Invalid,
    Outside,
    Ready { stroke: S, cut: bool },
}

fn draw<const N: usize, S: Stroke<N>>(
    target: &mut Target<'_>,
    primitives: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    threads: usize,
) -> Counters {
    crate::pixel::clear_in_scissor(target, state);
    let map = ScreenMap::new(target.width, target.height, state);
    let count = vertex_count(primitives);
    let prepare = |vertices: &[u32; N]| match corners(primitives, *vertices, count) {
        None => Prepared::Invalid,
        Some(clip) => {
            S::new(&map, clip).map_or(Prepared::Outside, |(stroke, cut)| Prepared::Ready { stroke, cut })
        }
    };
    let mut counters = Counters::default();
    for (r, run) in primitives.indices.as_chunks::<N>().0.chunks(RUN).enumerate() {
        let threads = if run.len() < WORTH_SHARING { 1 } else { threads };
        let prepared: Vec<Prepared<S>> = match threads {
            1 => run.iter().map(prepare).collect(),
            _ => run.par_iter().with_min_len(WORTH_SHARING).map(prepare).collect(),
        };
        prepared.iter().for_each(|p| p.count(&mut counters));
        counters += in_strips(target, threads, |strip, first_row| {
            let mut sink = Sink::new(strip, first_row, state, shading, &map);
            for (n, (prepared, &vertices)) in prepared.iter().zip(run).enumerate() {
                if let Prepared::Ready { stroke, .. } = prepared {
                    sink.id = primitives.ids.of(r * RUN + n);
                    stroke.draw(&mut sink, primitives, vertices);
                }
            }
            sink.counters
        });
    }
    counters
}

impl<S> Prepared<S> {
    fn count(&self, counters: &mut Counters) {
        counters.primitives += 1;
        match self {
            Self::Invalid => counters.invalid += 1,
            Self::Outside => counters.outside += 1,
            Self::Ready { cut, .. } => {
                counters.drawn += 1;
                counters.clipped += u64::from(*cut);
            }
        }
    }
}

/// Calls `draw` with strips of the target and the row each begins at, on `threads` threads; with one
/// thread the only strip is all of the target.
fn in_strips(
    target: &mut Target<'_>,
    threads: usize,
    draw: impl Fn(&mut Target<'_>, i32) -> Counters + Sync,
) -> Counters {
    if threads <= 1 {
        return draw(target, 0);
    }
    let rows = (target.height as usize).div_ceil(threads * STRIPS_PER_THREAD).max(1);
    let strips = target.strips(rows).into_par_iter().enumerate();
    let counters: Vec<Counters> = strips.map(|(i, mut strip)| draw(&mut strip, (i * rows) as i32)).collect();
    let mut sum = Counters::default();
    counters.into_iter().for_each(|c| sum += c);
    sum
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
    origin: [i64; 2],
}

/// Steps of a line from pixel to pixel along the axis it runs along more.
struct Walk {
    /// Whether the steps go along x.
    along_x: bool,
    /// Pixels across.
    width: i64,
    /// First pixel along the axis, and its direction.
    first: i64,
    sign: i64,
    count: i64,
    /// Start in sub-pixels along and across, and the way to the end.
    start: [i64; 2],
    way: [i64; 2],
}

impl Stroke<2> for Line {
    fn new(map: &ScreenMap, clip: [Vec4; 2]) -> Option<(Self, bool)> {
        let part @ [t0, t1] = clip_line(clip[0], clip[1], &VIEW_VOLUME)?;
        let at = |t: f32| match t {
            0.0 => clip[0],
            1.0 => clip[1],
            _ => clip[0] * (1.0 - t) + clip[1] * t,
        };
        let [start, end] = part.map(|t| map.project_clipped(at(t)));
        let line = Self { start, end, part, origin: map.origin.map(i64::from) };
        Some((line, t0 > 0.0 || t1 < 1.0))
    }

    fn draw(&self, sink: &mut Sink<'_, '_>, lines: &Primitives<'_>, vertices: [u32; 2]) {
        let walk = Walk::new(self, sink.state.line_width);
        let values = vertices.map(|i| varyings_of(lines, i));
        let interpolation = sink.state.interpolation;
        let rows = i64::from(sink.bounds.y0) - self.origin[1]..i64::from(sink.bounds.y1) - self.origin[1];
        for step in walk.steps_in(&rows) {
            let (a, b, t) = walk.at(step);
            let parameter = self.parameter(t, interpolation == Interpolation::Screen);
            sink.values.count = lines.stride;
            for (k, terms) in sink.values.terms.iter_mut().enumerate().take(lines.stride) {
                *terms = match interpolation {
                    Interpolation::FlatFirst => [values[0][k], 0.0, 0.0],
                    Interpolation::FlatLast => [values[1][k], 0.0, 0.0],
                    _ => [values[0][k] + parameter * (values[1][k] - values[0][k]), 0.0, 0.0],
                };
            }
            for k in 0..walk.width {
                let (x, y) = if walk.along_x { (a, b + k) } else { (b + k, a) };
                sink.fragment(x + self.origin[0], y + self.origin[1], self.depth(t));
            }
        }
    }
}

impl Line {
    fn depth(&self, t: f32) -> f32 {
        (self.start.z + t * (self.end.z - self.start.z)).clamp(0.0, 1.0)
    }

    /// Parameter of the submitted line.
    fn parameter(&self, t: f32, screen_space: bool) -> f32 {
        let [t0, t1] = self.part;
        let (q0, q1) = (self.start.inv_w, self.end.inv_w);
        let s = if screen_space { t } else { t * q1 / (q0 + t * (q1 - q0)) };
        t0 + s * (t1 - t0)
    }
}

impl Walk {
    fn new(line: &Line, width: f32) -> Self {
        let from = [line.start.x, line.start.y].map(i64::from);
        let to = [line.end.x, line.end.y].map(i64::from);
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let along_x = dx.abs() >= dy.abs();
        let (start, way) = if along_x { (from, [dx, dy]) } else { ([from[1], from[0]], [dy, dx]) };
        let (sub, half) = (i64::from(SUB), i64::from(HALF));
        // Pixel centres from the start, included, to the end, not included, whichever way it runs.
        let sign = way[0].signum();
        let first = sign * ceil_div(sign * (start[0] - half), sub);
        let count = (ceil_div(sign * (start[0] + way[0] - half), sub) - sign * first).max(0);
        Self { along_x, width: whole_size(width), first, sign, count, start, way }
    }

    /// Pixel along, first pixel across, and the share of the way to the end.
    fn at(&self, step: i64) -> (i64, i64, f32) {
        let (sub, half) = (i64::from(SUB), i64::from(HALF));
        let [length, across] = self.way;
        let a = self.first + self.sign * step;
        let run = a * sub + half - self.start[0];
        let offset =
            self.start[1] * length.abs() + self.sign * run * across - (self.width - 1) * half * length.abs();
        (a, offset.div_euclid(sub * length.abs()), run as f32 / length as f32)
    }

    /// The steps that have pixels in `rows`, counted from the origin.
    fn steps_in(&self, rows: &Range<i64>) -> Range<i64> {
        let first_row = |step: i64| {
            let (a, b, _) = self.at(step);
            if self.along_x { b } else { a }
        };
        let high = if self.along_x { self.width } else { 1 };
        let falls = if self.along_x { self.way[1] < 0 } else { self.sign < 0 };
        let (begins_late, ends_early) =
            (|step| first_row(step) >= rows.end, |step| first_row(step) + high <= rows.start);
        if falls {
            self.first_step(|s| !begins_late(s))..self.first_step(ends_early)
        } else {
            self.first_step(|s| !ends_early(s))..self.first_step(begins_late)
        }
    }

    /// First step for which `holds`, which holds for all after it; the number of steps if none.
    fn first_step(&self, holds: impl Fn(i64) -> bool) -> i64 {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if holds(middle) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        low
    }
}

/// A point on screen.
struct Square {
    at: ScreenVertex,
}

impl Stroke<1> for Square {
    fn new(map: &ScreenMap, [clip]: [Vec4; 1]) -> Option<(Self, bool)> {
        let inside = !wholly_outside(&[clip], &VIEW_VOLUME) && clip.w > 0.0;
        inside.then(|| (Self { at: map.project_clipped(clip) }, false))
    }

    fn draw(&self, sink: &mut Sink<'_, '_>, points: &Primitives<'_>, [vertex]: [u32; 1]) {
        let values = varyings_of(points, vertex);
        sink.values.count = values.len();
        for (terms, &value) in sink.values.terms.iter_mut().zip(values) {
            *terms = [value, 0.0, 0.0];
        }
        let side = whole_size(sink.state.point_size);
        let first = |c: i32, origin: i32| {
            let corner = i64::from(c) - side * i64::from(HALF) - i64::from(HALF);
            ceil_div(corner, i64::from(SUB)) + i64::from(origin)
        };
        let (x, y) = (first(self.at.x, sink.map.origin[0]), first(self.at.y, sink.map.origin[1]));
        let b = sink.bounds;
        for row in y.max(i64::from(b.y0))..(y + side).min(i64::from(b.y1)) {
            for column in x.max(i64::from(b.x0))..(x + side).min(i64::from(b.x1)) {
                sink.fragment(column, row, self.at.z);
            }
        }
    }
}

/// Where single fragments go: a strip of the target.
struct Sink<'a, 't> {
    target: &'a mut Target<'t>,
    /// Row of the whole target at which the strip begins.
    first_row: i32,
    /// Pixels of the whole target that may be written.
    bounds: Bounds,
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
        first_row: i32,
        state: &'a State,
        shading: &'a Shading<'a>,
        map: &'a ScreenMap,
    ) -> Self {
        // A triangle whose weights do not change: varyings have their base value everywhere.
        let setup = Setup::new([ScreenVertex::default(); 3], 1, &SetupState::new(&State::default()));
        let strip =
            Bounds { x0: 0, y0: first_row, x1: target.width as i32, y1: first_row + target.height as i32 };
        let (bounds, values) = (strip.intersect(map.bounds), TriangleVaryings::default());
        let counters = Counters::default();
        Self { target, first_row, bounds, state, shading, map, setup, values, id: 0, counters }
    }

    fn fragment(&mut self, x: i64, y: i64, depth: f32) {
        let b = self.bounds;
        let inside =
            x >= i64::from(b.x0) && x < i64::from(b.x1) && y >= i64::from(b.y0) && y < i64::from(b.y1);
        if !inside {
            return;
        }
        let (x, y) = (x as i32, y as i32);
        let row = y - self.first_row;
        self.counters.tested += 1;
        let stage = stage_of(self.shading);
        let tests_here = stage.is_none_or(|stage| !stage.tests_depth());
        if tests_here && !crate::pixel::depth_passes(self.target, self.state, x, row, depth) {
            return;
        }
        if let Some(stage) = stage {
            return self.staged(stage, x, y, depth);
        }
        self.counters.passed += 1;
        let Some(rgba) = self.shade(x, y, depth) else { return };
        let rgba = Some(rgba).filter(|_| !matches!(self.shading, Shading::None));
        crate::pixel::write(self.target, self.state, x, row, depth, self.id, rgba);
    }

    /// Hands the fragment to the stage.
    fn staged(&mut self, stage: &dyn FragmentStage, x: i32, y: i32, depth: f32) {
        let mut varyings = [[0.0; LANES]; MAX_VARYINGS];
        let (fragments, _) = self.fragments(&mut varyings, x, y, depth);
        let passed = run_stage(stage, self.target, self.first_row, self.state, &fragments);
        self.counters.shaded += 1;
        self.counters.passed += u64::from(passed.count_ones());
    }

    /// A batch of one fragment, and its lane.
    fn fragments<'v>(
        &self,
        varyings: &'v mut [[f32; LANES]; MAX_VARYINGS],
        x: i32,
        y: i32,
        depth: f32,
    ) -> (Fragments<'v>, usize) {
        let lane = ((y & 1) * 8 + (x & 7)) as usize;
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
            coverage: None,
        };
        (fragments, lane)
    }

    /// Colour of the pixel; `None` when it is discarded.
    fn shade(&mut self, x: i32, y: i32, depth: f32) -> Option<[f32; 4]> {
        let mut varyings = [[0.0; LANES]; MAX_VARYINGS];
        let (fragments, lane) = self.fragments(&mut varyings, x, y, depth);
        let mut shaded = Shaded::default();
        shade_plain(self.shading, &self.setup, &self.values, [0.0; 2], &fragments, &mut shaded);
        self.counters.shaded += u64::from(!matches!(self.shading, Shading::None));
        (shaded.keep >> lane & 1 == 1).then(|| shaded.rgba.map(|plane| plane[lane]))
    }
}
