//! Lines and points, one fragment after another.
//!
//! A line is cut by the view volume in homogeneous coordinates, then walked along the axis it runs
//! along more: one pixel (or, if wide, one row or column of pixels across) for each pixel centre from
//! its start up to, but without, its end. The other coordinate is exact in integers, carried from step
//! to step as Bresenham's algorithm (1965) does for corners on a raster of 1/256 pixel. A point is the
//! square of pixels whose centres lie within it.
//!
//! The rules of OpenGL ([`StrokeRule::OpenGl`]; specification of version 1.5, sections 3.3 and 3.4)
//! differ at the ends: a line owns the pixels whose diamonds it leaves, and on ties everything lies a
//! little lower and to the left.
//!
//! Several threads draw strips of rows, each all primitives in order as far as they lie in its strip:
//! every pixel meets its fragments in the same order as with one strip that is the whole picture.

use crate::api::{
    Counters, Interpolation, LANES, LineStipple, Primitives, Shading, State, StippleJoins, StrokeRule,
};
use crate::assemble::{varyings_of, vertex_count};
use crate::blend::pack;
use crate::clip::{VIEW_VOLUME, clip_line, wholly_outside};
use crate::setup::{HALF, SUB, ScreenMap, ScreenVertex, ceil_div};
use crate::shade::source_color;
use crate::sink::Sink;
use crate::smooth;
use crate::target::{Target, rgba8_from_rgba};
use fearless_simd::{Level, Simd, dispatch, f32x16, i32x16, prelude::*, u32x16};
use rayon::prelude::*;
use senca_math::glam::Vec4;
use std::ops::Range;

/// Widest line and largest point, in pixels.
const MAX_SIZE: f32 = 4096.0;

/// Primitives made ready at once: so few that they stay in the processor's cache while strip after strip is drawn.
const RUN: usize = 1 << 13;

/// Fewer primitives than this are not worth a second thread.
const WORTH_SHARING: usize = 128;

/// Strips for each thread, so that one with little in it does not leave a thread idle.
const STRIPS_PER_THREAD: usize = 4;

/// Draws lines on a number of threads, with the vector instructions of a level.
pub(crate) fn draw_lines(
    target: &mut Target<'_>,
    lines: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    (threads, level): (usize, Level),
) -> Counters {
    draw::<2, Line>(target, lines, state, shading, (threads, level))
}

/// Draws points likewise.
pub(crate) fn draw_points(
    target: &mut Target<'_>,
    points: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    (threads, level): (usize, Level),
) -> Counters {
    draw::<1, Square>(target, points, state, shading, (threads, level))
}

/// What strokes are made with.
pub(crate) struct Pen<'a> {
    pub(crate) map: &'a ScreenMap,
    pub(crate) state: &'a State,
}

/// A primitive of `N` corners on screen.
pub(crate) trait Stroke<const N: usize>: Sized + Send + Sync {
    /// From corners in clip space and their varyings, with whether it was cut; `None` when none of it
    /// is in the view volume.
    fn new(pen: &Pen<'_>, clip: [Vec4; N], values: [&[f32]; N]) -> Option<(Self, bool)>;

    /// Rows of the target it has pixels in, or more.
    fn rows(&self) -> Range<i64>;

    /// Fragments along it, which is how far a stipple pattern advances.
    fn length(&self) -> u64 {
        0
    }

    /// Hands those of its fragments to `sink` that are in the sink's rows. `values` are the varyings of
    /// its corners, `stipple` how far the pattern is at its start.
    fn draw<S: Simd>(&self, simd: S, sink: &mut Sink<'_, '_>, values: [&[f32]; N], stipple: u64);
}

/// What became of a primitive.
enum Prepared<S> {
    Invalid,
    Outside,
    Ready { stroke: S, cut: bool },
}

pub(crate) fn draw<const N: usize, S: Stroke<N>>(
    target: &mut Target<'_>,
    primitives: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
    (threads, level): (usize, Level),
) -> Counters {
    crate::pixel::clear_in_scissor(target, state);
    let map = ScreenMap::new(target.width, target.height, state);
    let pen = Pen { map: &map, state };
    let count = vertex_count(primitives);
    let prepare = |vertices: &[u32; N]| match corners(primitives, *vertices, count) {
        None => Prepared::Invalid,
        Some(clip) => match S::new(&pen, clip, vertices.map(|i| varyings_of(primitives, i))) {
            None => Prepared::Outside,
            Some((stroke, cut)) => Prepared::Ready { stroke, cut },
        },
    };
    let mut counters = Counters::default();
    let mut pattern = Pattern::default();
    for (r, run) in primitives.indices.as_chunks::<N>().0.chunks(RUN).enumerate() {
        let threads = if run.len() < WORTH_SHARING { 1 } else { threads };
        let prepared: Vec<Prepared<S>> = match threads {
            1 => run.iter().map(prepare).collect(),
            _ => run.par_iter().with_min_len(WORTH_SHARING).map(prepare).collect(),
        };
        prepared.iter().for_each(|p| p.count(&mut counters));
        let starts = state.stipple.map(|stipple| {
            pattern.starts(run, &prepared, |n| match stipple.joins {
                StippleJoins::ByIndex => None,
                StippleJoins::ByOddId => Some(primitives.ids.of(r * RUN + n) & 1 == 1),
            })
        });
        let starts = starts.unwrap_or_default();
        let rows: Vec<[i32; 2]> = prepared.iter().map(|p| p.rows(map.bounds.y1)).collect();
        counters += in_strips(target, threads, |strip, first_row| {
            let mut sink = Sink::new(strip, first_row, state, shading, &map);
            let strip =
                Strip { primitives, run, first: r * RUN, prepared: &prepared, rows: &rows, starts: &starts };
            dispatch!(level, simd => strip.draw(simd, &mut sink));
            sink.counters
        });
    }
    counters
}

/// What is drawn into one strip: a run of primitives.
struct Strip<'a, const N: usize, S> {
    primitives: &'a Primitives<'a>,
    run: &'a [[u32; N]],
    /// Number of the first of them.
    first: usize,
    prepared: &'a [Prepared<S>],
    rows: &'a [[i32; 2]],
    /// How far the stipple pattern is; empty without one.
    starts: &'a [u64],
}

impl<const N: usize, S: Stroke<N>> Strip<'_, N, S> {
    #[inline(always)]
    fn draw<L: Simd>(&self, simd: L, sink: &mut Sink<'_, '_>) {
        let [top, bottom] = [sink.bounds.y0, sink.bounds.y1];
        for (n, &[first, end]) in self.rows.iter().enumerate() {
            if first >= bottom || end <= top {
                continue;
            }
            if let Prepared::Ready { stroke, .. } = &self.prepared[n] {
                sink.begin(self.primitives.ids.of(self.first + n), true, self.primitives.stride);
                let mut values = [[].as_slice(); N];
                for (values, i) in values.iter_mut().zip(&self.run[n]) {
                    *values = varyings_of(self.primitives, *i);
                }
                stroke.draw(simd, sink, values, self.starts.get(n).copied().unwrap_or(0));
            }
        }
    }
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

    /// Rows it has pixels in; none unless it is drawn.
    fn rows<const N: usize>(&self, end: i32) -> [i32; 2]
    where
        S: Stroke<N>,
    {
        let Self::Ready { stroke, .. } = self else { return [0, 0] };
        let rows = stroke.rows();
        [rows.start.clamp(0, i64::from(end)) as i32, rows.end.clamp(0, i64::from(end)) as i32]
    }
}

/// How far the stipple pattern is, from line to line.
#[derive(Default)]
struct Pattern {
    last: Option<u32>,
    advanced: u64,
}

impl Pattern {
    fn starts<const N: usize, S: Stroke<N>>(
        &mut self,
        run: &[[u32; N]],
        prepared: &[Prepared<S>],
        goes_on: impl Fn(usize) -> Option<bool>,
    ) -> Vec<u64> {
        let start = |(n, (vertices, prepared)): (usize, (&[u32; N], &Prepared<S>))| {
            if !goes_on(n).unwrap_or(self.last == vertices.first().copied()) {
                self.advanced = 0;
            }
            let start = self.advanced;
            self.last = vertices.last().copied();
            if let Prepared::Ready { stroke, .. } = prepared {
                self.advanced += stroke.length();
            }
            start
        };
        run.iter().zip(prepared).enumerate().map(start).collect()
    }
}

impl LineStipple {
    /// Whether fragment `n` of a line is drawn.
    pub(crate) fn draws(&self, n: u64) -> bool {
        self.pattern >> (n / u64::from(self.factor.max(1)) % 16) & 1 == 1
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
    // Whole blocks, whose fragments go to stages together.
    let rows = (target.height as usize).div_ceil(threads * STRIPS_PER_THREAD).next_multiple_of(8).max(8);
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
    walk: Walk,
    /// The rectangle an antialiased line covers, in pixels of the target.
    outline: Option<[[f64; 2]; 4]>,
}

/// Steps of a line from pixel to pixel along the axis it runs along more.
struct Walk {
    /// Whether the steps go along x.
    along_x: bool,
    /// Pixels across.
    width: i64,
    /// Units of `start` and `way` in a pixel.
    sub: i64,
    /// First pixel along the axis, and its direction.
    first: i64,
    sign: i64,
    count: i64,
    /// Start in sub-pixels along and across, and the way to the end.
    start: [i64; 2],
    way: [i64; 2],
    /// First pixels across at the first step and at the last one.
    ends: [i64; 2],
}

impl Stroke<2> for Line {
    fn new(pen: &Pen<'_>, clip: [Vec4; 2], _: [&[f32]; 2]) -> Option<(Self, bool)> {
        let (map, state) = (pen.map, pen.state);
        let part @ [t0, t1] = clip_line(clip[0], clip[1], &VIEW_VOLUME)?;
        let at = |t: f32| match t {
            0.0 => clip[0],
            1.0 => clip[1],
            _ => clip[0] * (1.0 - t) + clip[1] * t,
        };
        let [start, end] = part.map(|t| map.project_clipped(at(t)));
        let walk = Walk::new(&start, &end, state.line_width, state.strokes);
        let outline = state.antialias.then(|| smooth::line_outline(map, [&start, &end], state.line_width));
        let line = Self { start, end, part, origin: map.origin.map(i64::from), walk, outline };
        Some((line, t0 > 0.0 || t1 < 1.0))
    }

    fn rows(&self) -> Range<i64> {
        if let Some(outline) = &self.outline {
            let [_, rows] = smooth::pixel_box(outline);
            return rows;
        }
        if self.walk.count == 0 {
            return 0..0;
        }
        let (first, last) = (self.walk.along(0), self.walk.along(self.walk.count - 1));
        let [a, b] = if self.walk.along_x { self.walk.ends } else { [first, last] };
        let high = if self.walk.along_x { self.walk.width } else { 1 };
        a.min(b) + self.origin[1]..a.max(b) + high + self.origin[1]
    }

    fn length(&self) -> u64 {
        self.walk.count as u64
    }

    #[inline(always)]
    fn draw<S: Simd>(&self, simd: S, sink: &mut Sink<'_, '_>, values: [&[f32]; 2], stipple: u64) {
        let interpolation = sink.state.interpolation;
        let along = usize::from(!self.walk.along_x);
        let at = |x: i32, y: i32, out: &mut [f32]| {
            let t = self.walk.share(i64::from([x, y][along]) - self.origin[along]);
            let parameter = self.parameter(t, interpolation == Interpolation::Screen);
            for (k, out) in out.iter_mut().enumerate() {
                *out = match interpolation {
                    Interpolation::FlatFirst => values[0][k],
                    Interpolation::FlatLast => values[1][k],
                    _ => values[0][k] + parameter * (values[1][k] - values[0][k]),
                };
            }
        };
        match &self.outline {
            Some(outline) => self.draw_smooth(sink, outline, stipple, &at),
            None if self.draw_plain(simd, sink, values) => return,
            None => self.draw_steps(sink, stipple, &at),
        }
        sink.end(&at);
    }
}

impl Line {
    /// Draws a line one pixel wide, in plain colours and wholly within the bounds but for rows, as most
    /// are; whether it is one.
    #[inline(always)]
    fn draw_plain<S: Simd>(&self, simd: S, sink: &mut Sink<'_, '_>, values: [&[f32]; 2]) -> bool {
        let (walk, state, b) = (&self.walk, sink.state, sink.bounds);
        if walk.width != 1 || state.stipple.is_some() {
            return false;
        }
        let [ox, oy] = self.origin;
        let steps = walk.steps_in(&(i64::from(b.y0) - oy..i64::from(b.y1) - oy));
        if steps.is_empty() {
            return true;
        }
        let column = |step: i64| if walk.along_x { walk.along(step) + ox } else { walk.across(step) + ox };
        let inside = |x: i64| x >= i64::from(b.x0) && x < i64::from(b.x1);
        if !inside(column(steps.start)) || !inside(column(steps.end - 1)) {
            return false;
        }
        let Some(mut plain) = sink.plain() else { return false };
        let ends = match state.interpolation {
            Interpolation::FlatFirst => [values[0]; 2],
            Interpolation::FlatLast => [values[1]; 2],
            _ => values,
        };
        let [from, to] = [source_color(&plain.color, ends[0]), source_color(&plain.color, ends[1])];
        let screen_space = state.interpolation == Interpolation::Screen;
        // From pixel to pixel along, and from one to the next across.
        let (along, aside) = (walk.sign, plain.width as i64);
        let (along, aside) = if walk.along_x { (along, aside) } else { (along * aside, 1) };
        let mut across = Across::new(walk, steps.start);
        let mut step = steps.start;
        let (a, b) = (walk.along(step), across.pixel);
        let (x, y) = if walk.along_x { (a, b) } else { (b, a) };
        let mut pixel = (y + oy - plain.first_row as i64) * plain.width as i64 + x + ox;
        while step < steps.end {
            let count = (steps.end - step).min(LANES as i64) as usize;
            let mut at = [0usize; LANES];
            for at in &mut at[..count] {
                *at = pixel as usize;
                let before = across.pixel;
                across.advance();
                pixel += along + (across.pixel - before) * aside;
            }
            let shares = walk.shares(simd, walk.along(step));
            let mut colors = [0; LANES];
            self.plain_colors(simd, shares, screen_space, &from, &to).store_array(&mut colors);
            if plain.depth.is_none() {
                for (at, color) in at[..count].iter().zip(&colors) {
                    plain.put(*at, 0.0, state, color.to_le_bytes());
                }
            } else {
                let shares = shares.to_array();
                for (k, at) in at[..count].iter().enumerate() {
                    plain.put(*at, self.depth(shares[k]), state, colors[k].to_le_bytes());
                }
            }
            step += count as i64;
        }
        true
    }

    /// Colours at shares of the way, packed; `from` and `to` are those of the whole line. Shares become
    /// parameters as by [`Self::parameter`].
    #[inline(always)]
    fn plain_colors<S: Simd>(
        &self,
        simd: S,
        shares: f32x16<S>,
        screen_space: bool,
        from: &[f32; 4],
        to: &[f32; 4],
    ) -> u32x16<S> {
        let splat = |v: f32| f32x16::splat(simd, v);
        let ([t0, t1], q0, q1) = (self.part, self.start.inv_w, self.end.inv_w);
        let s = if screen_space || q0 == q1 {
            shares
        } else {
            shares * splat(q1) / (splat(q0) + shares * splat(q1 - q0))
        };
        let parameters = splat(t0) + s * splat(t1 - t0);
        let mut rgba = [splat(0.0); 4];
        for k in 0..4 {
            rgba[k] = splat(from[k]) + parameters * splat(to[k] - from[k]);
        }
        pack(simd, rgba)
    }

    #[inline(never)]
    fn draw_steps(&self, sink: &mut Sink<'_, '_>, stipple: u64, values: &impl Fn(i32, i32, &mut [f32])) {
        let walk = &self.walk;
        let rows = i64::from(sink.bounds.y0) - self.origin[1]..i64::from(sink.bounds.y1) - self.origin[1];
        let pattern = sink.state.stipple;
        let steps = walk.steps_in(&rows);
        let mut across = Across::new(walk, steps.start);
        for step in steps {
            let (a, b) = (walk.first + walk.sign * step, across.pixel);
            across.advance();
            if pattern.is_some_and(|p| !p.draws(stipple + step as u64)) {
                continue;
            }
            let depth = self.depth(walk.share(a));
            for k in 0..walk.width {
                let (x, y) = if walk.along_x { (a, b + k) } else { (b + k, a) };
                sink.fragment([x + self.origin[0], y + self.origin[1]], depth, 1.0, values);
            }
        }
    }

    #[inline(never)]
    fn draw_smooth(
        &self,
        sink: &mut Sink<'_, '_>,
        outline: &[[f64; 2]; 4],
        stipple: u64,
        values: &impl Fn(i32, i32, &mut [f32]),
    ) {
        let along = usize::from(!self.walk.along_x);
        let pattern = sink.state.stipple;
        smooth::for_each_pixel(outline, sink.bounds, |pixel, coverage| {
            let a = pixel[along] - self.origin[along];
            let step = ((a - self.walk.first) * self.walk.sign).max(0) as u64;
            if pattern.is_none_or(|p| p.draws(stipple + step)) {
                sink.fragment(pixel, self.depth(self.walk.share(a)), coverage, values);
            }
        });
    }

    #[inline(always)]
    fn depth(&self, t: f32) -> f32 {
        (self.start.z + t * (self.end.z - self.start.z)).clamp(0.0, 1.0)
    }

    /// Parameter of the submitted line.
    #[inline(always)]
    fn parameter(&self, t: f32, screen_space: bool) -> f32 {
        let [t0, t1] = self.part;
        let (q0, q1) = (self.start.inv_w, self.end.inv_w);
        let s = if screen_space || q0 == q1 { t } else { t * q1 / (q0 + t * (q1 - q0)) };
        t0 + s * (t1 - t0)
    }
}

/// `a / b` rounded down, for positive `b`.
fn floor_div(a: i64, b: i64) -> i64 {
    a.div_euclid(b)
}

/// `a / 2^bits` rounded up.
fn shift_up(a: i64, bits: u32) -> i64 {
    (a + (1 << bits) - 1) >> bits
}

impl Walk {
    fn new(start: &ScreenVertex, end: &ScreenVertex, width: f32, rule: StrokeRule) -> Self {
        // A sub-pixel of OpenGL's rule is a quarter as long, so that "a little lower" can be said.
        let fine = rule == StrokeRule::OpenGl;
        let sub = if fine { 4 * i64::from(SUB) } else { i64::from(SUB) };
        let place =
            |v: &ScreenVertex| [v.x, v.y].map(|c| if fine { 4 * i64::from(c) - 1 } else { i64::from(c) });
        let (from, to) = (place(start), place(end));
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let along_x = dx.abs() >= dy.abs();
        let (start, way) = if along_x { (from, [dx, dy]) } else { ([from[1], from[0]], [dy, dx]) };
        let half = sub / 2;
        // Pixel centres from the start, included, to the end, not included, whichever way it runs.
        let sign = way[0].signum();
        let bits = sub.trailing_zeros();
        let first = sign * shift_up(sign * (start[0] - half), bits);
        let count = (shift_up(sign * (start[0] + way[0] - half), bits) - sign * first).max(0);
        let (width, ends) = (whole_size(width), [0; 2]);
        let mut walk = Self { along_x, width, sub, first, sign, count, start, way, ends };
        if fine && sign != 0 {
            walk.leave_diamonds();
        }
        if walk.count > 0 {
            walk.ends = [0, walk.count - 1].map(|step| walk.at(step).1);
        }
        walk
    }

    /// Adds the first pixel if the line begins in its diamond beyond its centre, and takes away the
    /// last one if the line ends in its diamond.
    fn leave_diamonds(&mut self) {
        let half = self.sub / 2;
        // From the centre of its pixel.
        let off_centre = |c: i64| (c & (self.sub - 1)) - half;
        let in_diamond = |p: [i64; 2]| off_centre(p[0]).abs() + off_centre(p[1]).abs() < half;
        let beyond_centre = |c: i64| self.sign * off_centre(c) > 0;
        let end = [self.start[0] + self.way[0], self.start[1] + self.way[1]];
        let add = beyond_centre(self.start[0]) && in_diamond(self.start);
        let drop = beyond_centre(end[0]) && in_diamond(end);
        if add {
            self.first -= self.sign;
            self.count += 1;
        }
        self.count = (self.count - i64::from(drop)).max(0);
    }

    /// The share of the way to the end at pixel `a` along.
    #[inline(always)]
    fn share(&self, a: i64) -> f32 {
        self.share_of(self.run(a) as i32)
    }

    /// The way from the start to the centre of pixel `a` along, in sub-pixels; below 2^27.
    #[inline(always)]
    fn run(&self, a: i64) -> i64 {
        a * self.sub + self.sub / 2 - self.start[0]
    }

    /// The shares of the way to the end at 16 pixels from `a` on, of a line that has pixels; see
    /// [`Self::share_of`].
    #[inline(always)]
    fn shares<S: Simd>(&self, simd: S, a: i64) -> f32x16<S> {
        let mut runs = [0i32; LANES];
        for (k, run) in runs.iter_mut().enumerate() {
            *run = (self.run(a) as i32).wrapping_add(k as i32 * (self.sign * self.sub) as i32);
        }
        let runs: f32x16<S> = i32x16::load_array_ref(simd, &runs).to_float();
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let share = runs / f32x16::splat(simd, self.way[0] as f32);
        let low = share.simd_gt(zero).select(share, zero);
        low.simd_lt(one).select(low, one)
    }

    /// The share of the way to the end of a run.
    #[inline(always)]
    fn share_of(&self, run: i32) -> f32 {
        if self.way[0] == 0 {
            return 0.0;
        }
        let share = run as f32 / self.way[0] as f32;
        let low = if share > 0.0 { share } else { 0.0 };
        if low < 1.0 { low } else { 1.0 }
    }

    /// Where the lower side of the line is at pixel `a` along, times `self.sub * length`.
    fn offset(&self, a: i64) -> i64 {
        let [length, across] = self.way;
        let run = a * self.sub + self.sub / 2 - self.start[0];
        self.start[1] * length.abs() + self.sign * run * across
            - (self.width - 1) * (self.sub / 2) * length.abs()
    }

    /// Pixel along.
    #[inline(always)]
    fn along(&self, step: i64) -> i64 {
        self.first + self.sign * step
    }

    /// First pixel across, of a step of the line.
    #[inline(always)]
    fn across(&self, step: i64) -> i64 {
        match step {
            0 => self.ends[0],
            _ if step == self.count - 1 => self.ends[1],
            _ => self.at(step).1,
        }
    }

    /// Pixel along and first pixel across.
    fn at(&self, step: i64) -> (i64, i64) {
        let a = self.along(step);
        (a, self.offset(a).div_euclid((self.sub * self.way[0].abs()).max(1)))
    }

    /// The steps that have pixels in `rows`, counted from the origin.
    fn steps_in(&self, rows: &Range<i64>) -> Range<i64> {
        let first_row = |step: i64| if self.along_x { self.across(step) } else { self.along(step) };
        let high = if self.along_x { self.width } else { 1 };
        if self.count > 0 {
            let (a, b) = (first_row(0), first_row(self.count - 1));
            if a.min(b) >= rows.start && a.max(b) + high <= rows.end {
                return 0..self.count;
            }
        }
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

/// The first pixel across, from step to step.
struct Across {
    pixel: i64,
    rest: i64,
    step: i64,
    step_rest: i64,
    whole: i64,
}

impl Across {
    #[inline(always)]
    fn new(walk: &Walk, step: i64) -> Self {
        let [length, across] = walk.way;
        let whole = (walk.sub * length.abs()).max(1);
        let pixel = walk.across(step);
        let rest = walk.offset(walk.along(step)) - pixel * whole;
        // No more than one pixel across for each along.
        let change = walk.sub * across;
        let (step, step_rest) = match change {
            _ if change < 0 => (-1, change + whole),
            _ if change >= whole => (1, change - whole),
            _ => (0, change),
        };
        Self { pixel, rest, step, step_rest, whole }
    }

    #[inline(always)]
    fn advance(&mut self) {
        self.pixel += self.step;
        self.rest += self.step_rest;
        if self.rest >= self.whole {
            self.rest -= self.whole;
            self.pixel += 1;
        }
    }
}

/// A point on screen.
struct Square {
    depth: f32,
    /// First pixel and pixels along a side; for an antialiased point the box around it.
    first: [i64; 2],
    side: i64,
    /// Centre in pixels and diameter of an antialiased point.
    disc: Option<([f64; 2], f64)>,
}

impl Stroke<1> for Square {
    fn new(pen: &Pen<'_>, [clip]: [Vec4; 1], [values]: [&[f32]; 1]) -> Option<(Self, bool)> {
        let (map, state) = (pen.map, pen.state);
        let inside = !wholly_outside(&[clip], &VIEW_VOLUME) && clip.w > 0.0;
        if !inside {
            return None;
        }
        let at = map.project_clipped(clip);
        let varying = state.point_sizes.map(|k| values.get(k).copied().unwrap_or(1.0));
        let size = varying.unwrap_or(state.point_size);
        if state.antialias {
            let diameter = f64::from(size.clamp(0.0, MAX_SIZE));
            let centre = smooth::pixel_place(map, &at);
            let first = centre.map(|c| (c - 0.5 * diameter).floor() as i64);
            let disc = Some((centre, diameter));
            return Some((Self { depth: at.z, first, side: diameter.ceil() as i64 + 1, disc }, false));
        }
        let side = whole_size(size);
        let first = |c: i32, origin: i32| {
            let (c, sub) = (i64::from(c), i64::from(SUB));
            let first = match state.strokes {
                StrokeRule::Centres => ceil_div(c - side * i64::from(HALF) - i64::from(HALF), sub),
                StrokeRule::OpenGl => floor_div(c - (side - 1) * i64::from(HALF), sub),
            };
            first + i64::from(origin)
        };
        let first = [first(at.x, map.origin[0]), first(at.y, map.origin[1])];
        Some((Self { depth: at.z, first, side, disc: None }, false))
    }

    fn rows(&self) -> Range<i64> {
        self.first[1]..self.first[1] + self.side
    }

    #[inline(always)]
    fn draw<S: Simd>(&self, _: S, sink: &mut Sink<'_, '_>, [values]: [&[f32]; 1], _: u64) {
        let same = |_: i32, _: i32, out: &mut [f32]| out.copy_from_slice(&values[..out.len()]);
        if let Some((centre, diameter)) = self.disc {
            smooth::for_each_pixel(&smooth::disc(centre, diameter), sink.bounds, |pixel, coverage| {
                sink.fragment(pixel, self.depth, coverage, &same);
            });
            sink.end(&same);
            return;
        }
        let ([x, y], b) = (self.first, sink.bounds);
        let state = sink.state;
        if let Some(mut plain) = sink.plain() {
            let color = rgba8_from_rgba(source_color(&plain.color, values));
            for row in y.max(i64::from(b.y0))..(y + self.side).min(i64::from(b.y1)) {
                let columns = x.max(i64::from(b.x0))..(x + self.side).min(i64::from(b.x1));
                let first = (row as usize - plain.first_row) * plain.width;
                columns.for_each(|x| plain.put(first + x as usize, self.depth, state, color));
            }
            return;
        }
        for row in y.max(i64::from(b.y0))..(y + self.side).min(i64::from(b.y1)) {
            for column in x.max(i64::from(b.x0))..(x + self.side).min(i64::from(b.x1)) {
                sink.fragment([column, row], self.depth, 1.0, &same);
            }
        }
        sink.end(&same);
    }
}
