//! Drawing what has been gathered: the state of OpenGL into the rasterizer's terms.

mod shading;

use crate::fragment::Program;
use crate::framebuffer::{Area, DrawPlanes, Use, Uses, WaitingClear};
use crate::raster_state::{Batch, Kind, RasterState};
use crate::state::Cap;
use crate::{Context, Enum, gl};
use senca_math::glam::Vec4;
use senca_raster::{
    Clear, Compare, Counters, Cull, DepthBias, Draw, Ids, LineStipple, Primitives, Rasterizer, Rect, Shading,
    SimdLevel, State, StippleJoins, StrokeRule, Target, TiledRasterizer, Viewport,
};
use shading::{SimpleShading, SimpleUnits, constant_color, simple_shading};

/// A step of depth that is never lost: two of the smallest of 24 bits.
const DEPTH_UNIT: f32 = 1.0 / (1 << 23) as f32;

impl Context {
    /// Draws batches that go together; returns how many samples passed.
    pub(crate) fn draw_batches(&mut self, batches: &[Batch]) -> u64 {
        let Some(first) = batches.first() else { return 0 };
        let clear = self.waiting_clear.filter(|clear| clear.is_worth_waiting() && clears_along(clear, first));
        // What is not cleared is left alone by what is drawn.
        let clear = clear.filter(|clear| clear.is_whole || clear.area.contains(area_of_all(batches)));
        let draws_colors = batches.iter().any(|batch| batch.state.color.mask != [false; 4]);
        let clear = clear.map(|clear| clear.for_draw(draws_colors));
        match clear {
            Some(_) => self.waiting_clear = None,
            None => self.settle_clear(),
        }
        let rows = if clear.is_some() { 0..u32::MAX } else { rows_of_all(batches) };
        let mut planes = self.framebuffers.take_planes_for(rows);
        let counts = self.queries.active();
        let (rasterizer, multisample) = (&mut self.rasterizer, first.state.has(Cap::Multisample));
        if let Some(passed) = draw_depths(rasterizer, &mut planes, batches, clear.as_ref(), counts) {
            self.framebuffers.put_back(planes);
            return passed;
        }
        let uses = uses(batches, clear.map(|clear| clear.values).as_ref());
        let area = clear.map_or_else(|| area_of_all(batches), |clear| clear.area);
        let passed = planes.draw(multisample, &uses, area, |mut target, side| {
            draw(rasterizer, &mut target, batches, side, clear.as_ref()).passed
        });
        self.framebuffers.put_back(planes);
        passed
    }
}

/// What batches and a clear before them do to colours, depths and stencil values.
fn uses(batches: &[Batch], clear: Option<&Clear>) -> Uses {
    let of = |cleared: bool, used: &dyn Fn(&RasterState) -> bool| match cleared {
        true => Use::Cleared,
        false if batches.iter().any(|batch| used(&batch.state)) => Use::Changed,
        false => Use::Kept,
    };
    Uses([
        of(clear.is_some_and(|c| c.color.is_some()), &|s| s.color.mask != [false; 4]),
        // Stencil tests look at depths, too, but change them only by their own test.
        of(clear.is_some_and(|c| c.depth.is_some()), &|s| s.has(Cap::DepthTest)),
        of(clear.is_some_and(|c| c.stencil.is_some()), &|s| s.has(Cap::StencilTest)),
    ])
}

/// Vertices up to which it is worth while to find out where they are.
const FEW_VERTICES: usize = 64;

/// Whether the rasterizer can do a clear when it draws a batch.
fn clears_along(clear: &WaitingClear, batch: &Batch) -> bool {
    let s = &batch.state;
    let all_culled = s.has(Cap::CullFace) && s.polygon.cull_face == gl::FRONT_AND_BACK;
    batch.kind == Kind::Triangles
        && !all_culled
        && !s.has(Cap::PolygonSmooth)
        && (!s.has(Cap::ScissorTest) || Area::of(s.scissor).contains(clear.area))
}

/// Whether a rectangle covers all pixels of a target.
fn covers(r: Rect, [width, height]: [u32; 2]) -> bool {
    let end = |start: i32, size: u32| i64::from(start) + i64::from(size);
    r.x <= 0 && r.y <= 0 && end(r.x, r.width) >= i64::from(width) && end(r.y, r.height) >= i64::from(height)
}

/// The rows batches have pixels in, or more.
fn rows_of_all(batches: &[Batch]) -> std::ops::Range<u32> {
    let join = |a: std::ops::Range<u32>, b: std::ops::Range<u32>| a.start.min(b.start)..a.end.max(b.end);
    batches.iter().map(rows_of).reduce(join).unwrap_or(0..0)
}

/// The rows a batch has pixels in, or more.
fn rows_of(batch: &Batch) -> std::ops::Range<u32> {
    let all = 0..u32::MAX;
    if batch.positions.len() > FEW_VERTICES || !batch.sizes.is_empty() {
        return all;
    }
    let [_, y, _, height] = batch.state.viewport.rect.map(|v| v as f32);
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for p in &batch.positions {
        let row = y + 0.5 * height - 0.5 * height * p.y / p.w;
        // Behind the eye, or nearly.
        if p.w < 1e-6 || !row.is_finite() {
            return all;
        }
        (low, high) = (low.min(row), high.max(row));
    }
    let rim = batch.state.line.width.max(batch.state.point.size).max(1.0) + 2.0;
    (low - rim).max(0.0) as u32..(high + rim).max(0.0) as u32
}

/// An area that has all pixels batches may change.
fn area_of_all(batches: &[Batch]) -> Area {
    let all = Area::of([0, 0, i32::MAX, i32::MAX]);
    let join = |a: Area, b: Area| match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => Area { x0: a.x0.min(b.x0), y0: a.y0.min(b.y0), x1: a.x1.max(b.x1), y1: a.y1.max(b.y1) },
    };
    let of = |batch: &Batch| {
        let s = &batch.state;
        let view = if batch.kind == Kind::Triangles { Area::of(s.viewport.rect) } else { all };
        let view = view.intersect(all);
        if s.has(Cap::ScissorTest) { view.intersect(Area::of(s.scissor)) } else { view }
    };
    batches.iter().map(of).reduce(join).unwrap_or(all)
}

/// Draws batches into a target that has a square of `side` samples along each side of a pixel.
fn draw(
    rasterizer: &mut TiledRasterizer,
    target: &mut Target<'_>,
    batches: &[Batch],
    side: u32,
    clear: Option<&WaitingClear>,
) -> Counters {
    let level = rasterizer.settings().level;
    let ready = batches.iter().enumerate().filter(|(_, batch)| !is_culled(batch)).map(|(k, batch)| {
        let clear = clear.filter(|_| k == 0);
        Ready::new(batch, target, side, clear, level)
    });
    let ready: Vec<Ready<'_>> = ready.collect();
    let draws: Vec<Draw<'_>> = ready.iter().map(Ready::draw).collect();
    let kind = batches.first().map_or(Kind::Triangles, |batch| batch.kind);
    if kind == Kind::Triangles {
        return rasterizer.draw_all(target, &draws);
    }
    let mut counters = Counters::default();
    for Draw { triangles: strokes, state, shading } in &draws {
        counters += match kind {
            Kind::Points | Kind::PolygonPoints => rasterizer.draw_points(target, strokes, state, shading),
            _ => rasterizer.draw_lines(target, strokes, state, shading),
        };
    }
    counters
}

/// Draws batches that write depths alone into planes that keep depths in blocks, or may from now on, because
/// all of them are cleared; returns how many pixels passed, if somebody `counts` them. `None`, with nothing done, if
/// that is not so.
fn draw_depths(
    rasterizer: &mut TiledRasterizer,
    planes: &mut DrawPlanes,
    batches: &[Batch],
    waiting: Option<&WaitingClear>,
    counts: bool,
) -> Option<u64> {
    let clear = waiting.filter(|waiting| waiting.is_whole).map(|waiting| waiting.values);
    let (has_stencil, has_colors) = (planes.stencil().is_some(), planes.color_count() > 0);
    let depths_alone = |batch: &Batch| {
        let s = &batch.state;
        let stencil = has_stencil && s.has(Cap::StencilTest);
        let left_out = s.has(Cap::AlphaTest) || s.has(Cap::PolygonStipple) || s.has(Cap::PolygonSmooth);
        let colors = has_colors && s.color.mask != [false; 4];
        batch.kind == Kind::Triangles && !colors && !stencil && !left_out
    };
    let clears_others =
        waiting.is_some_and(|w| !w.is_whole || w.values.color.is_some() || w.values.stencil.is_some());
    if clears_others || !batches.iter().all(depths_alone) {
        return None;
    }
    let blocks = planes.depth_blocks(clear.is_some_and(|c| c.depth.is_some()))?;
    let size = [blocks.width(), blocks.height()];
    let mut draws: Vec<(Primitives<'_>, State)> = Vec::with_capacity(batches.len());
    for batch in batches.iter().filter(|batch| !is_culled(batch)) {
        let mut state = State { clear: clear.filter(|_| draws.is_empty()), ..raster_state(batch) };
        state.scissor = state.scissor.filter(|scissor| !covers(*scissor, size));
        let triangles = Primitives {
            positions: &batch.positions,
            varyings: &[],
            stride: 0,
            indices: &batch.indices,
            ids: Ids::Same(0),
        };
        draws.push((triangles, state));
    }
    if counts {
        return Some(rasterizer.draw_depths(blocks, &draws).passed);
    }
    rasterizer.draw_depths_when_read(blocks, &draws);
    Some(0)
}

/// Whether nothing of a batch is to be seen.
fn is_culled(batch: &Batch) -> bool {
    let s = &batch.state;
    let both = s.has(Cap::CullFace) && s.polygon.cull_face == gl::FRONT_AND_BACK;
    both && batch.kind == Kind::Triangles
}

/// A batch in the rasterizer's terms.
struct Ready<'a> {
    batch: &'a Batch,
    state: State,
    /// Varyings with sizes of points behind them, where they have such.
    sized: Option<Vec<f32>>,
    joins: Vec<u32>,
    lifted: Option<Vec<Vec4>>,
    work: Work,
}

/// Who colours a batch.
enum Work {
    /// The rasterizer by itself.
    Simple(SimpleShading),
    Program(Box<Program>),
}

impl<'a> Ready<'a> {
    fn new(
        batch: &'a Batch,
        target: &Target<'_>,
        side: u32,
        clear: Option<&WaitingClear>,
        level: SimdLevel,
    ) -> Self {
        let s = &batch.state;
        let clear_area = clear.filter(|clear| !clear.is_whole).map(|clear| {
            let Area { x0, y0, x1, y1 } = clear.area;
            rect([x0, y0, x1 - x0, y1 - y0])
        });
        let clear = clear.map(|clear| clear.values);
        let mut state = in_samples(State { clear, clear_area, ..raster_state(batch) }, side);
        state.scissor = state.scissor.filter(|scissor| !covers(*scissor, [target.width(), target.height()]));
        let joins: Vec<u32> = match state.stipple {
            Some(_) => batch.continues.iter().map(|goes_on| u32::from(*goes_on)).collect(),
            None => Vec::new(),
        };
        let lifted = lifted(batch, state.depth_bias.constant);
        let sized = with_sizes(batch, usize::from(batch.layout.stride));
        state.multisample = side > 1;
        let units = SimpleUnits::new(batch, side);
        let work = match simple_shading(s, batch.kind, target, units, constant_color(batch)) {
            Some(simple) => {
                (state.blend, state.stencil) = (simple.blend, simple.stencil);
                Work::Simple(simple)
            }
            None => {
                let buffers = [target.has_depth(), target.has_stencil()];
                let program = Program::new(s, batch.kind, &batch.layout, level, buffers);
                Work::Program(Box::new(program.with_samples(side > 1)))
            }
        };
        Self { batch, state, sized, joins, lifted, work }
    }

    fn draw(&self) -> Draw<'_> {
        let stride = usize::from(self.batch.layout.stride);
        let (varyings, stride) = match &self.sized {
            Some(sized) => (sized.as_slice(), stride + 1),
            None => (self.batch.varyings.as_slice(), stride),
        };
        let triangles = Primitives {
            positions: self.lifted.as_deref().unwrap_or(&self.batch.positions),
            varyings,
            stride,
            indices: &self.batch.indices,
            ids: if self.joins.is_empty() { Ids::Same(0) } else { Ids::Each(&self.joins) },
        };
        let shading = match &self.work {
            Work::Simple(simple) => simple.shading(),
            Work::Program(program) => Shading::Stage(&**program),
        };
        Draw { triangles, state: self.state, shading }
    }
}

/// Varyings with the size of points behind those of each vertex, where points have sizes of their own.
fn with_sizes(batch: &Batch, stride: usize) -> Option<Vec<f32>> {
    if batch.kind != Kind::Points || batch.sizes.is_empty() {
        return None;
    }
    let mut varyings = Vec::with_capacity(batch.positions.len() * (stride + 1));
    for (own, size) in batch.varyings.chunks_exact(stride).zip(&batch.sizes) {
        varyings.extend_from_slice(own);
        varyings.push(*size);
    }
    Some(varyings)
}

fn raster_state(batch: &Batch) -> State {
    let s = &batch.state;
    let [x, y, width, height] = s.viewport.rect.map(|v| v as f32);
    let lines = matches!(batch.kind, Kind::Lines | Kind::PolygonLines);
    let smooth = match batch.kind {
        Kind::Triangles => Cap::PolygonSmooth,
        _ if lines => Cap::LineSmooth,
        _ => Cap::PointSmooth,
    };
    let sizes = batch.kind == Kind::Points && !batch.sizes.is_empty();
    State {
        viewport: Some(Viewport { x, y, width, height }),
        scissor: s.has(Cap::ScissorTest).then(|| rect(s.scissor)),
        cull: if batch.kind == Kind::Triangles { cull(s) } else { Cull::None },
        depth_test: if s.has(Cap::DepthTest) { compare(s.depth.func) } else { Compare::Always },
        depth_write: s.has(Cap::DepthTest) && s.depth.mask,
        depth_range: [s.viewport.near as f32, s.viewport.far as f32],
        depth_bias: depth_bias(s, batch.kind),
        line_width: s.line.width,
        point_size: s.point.size.clamp(s.point.min.min(s.point.max), s.point.max),
        point_sizes: sizes.then(|| usize::from(batch.layout.stride)),
        strokes: StrokeRule::OpenGl,
        stipple: (lines && s.has(Cap::LineStipple)).then_some(LineStipple {
            factor: s.line.stipple_factor,
            pattern: s.line.stipple_pattern,
            joins: StippleJoins::ByOddId,
        }),
        antialias: s.has(smooth),
        ..State::default()
    }
}

/// The state in units of samples instead of pixels, where there are several along each side of a pixel.
fn in_samples(state: State, side: u32) -> State {
    let factor = side as f32;
    let scaled = |v: Viewport| Viewport {
        x: v.x * factor,
        y: v.y * factor,
        width: v.width * factor,
        height: v.height * factor,
    };
    let rect = |r: Rect| Rect {
        x: r.x.saturating_mul(side as i32),
        y: r.y.saturating_mul(side as i32),
        width: r.width.saturating_mul(side),
        height: r.height.saturating_mul(side),
    };
    State {
        viewport: state.viewport.map(scaled),
        scissor: state.scissor.map(rect),
        clear_area: state.clear_area.map(rect),
        depth_bias: DepthBias { slope: state.depth_bias.slope * factor, ..state.depth_bias },
        line_width: state.line_width * factor,
        point_size: state.point_size * factor,
        ..state
    }
}

fn rect([x, y, width, height]: [i32; 4]) -> Rect {
    Rect { x, y, width: width.max(0) as u32, height: height.max(0) as u32 }
}

/// Faces left out, in the rasterizer's sense of rotation: its rows run the other way.
fn cull(s: &RasterState) -> Cull {
    if !s.has(Cap::CullFace) {
        return Cull::None;
    }
    let upper = s.clip_origin == gl::UPPER_LEFT;
    // Counter-clockwise here is clockwise there.
    let front_is_there = (s.polygon.front_face == gl::CW) != upper;
    match (s.polygon.cull_face, front_is_there) {
        (gl::BACK, true) | (gl::FRONT, false) => Cull::Back,
        _ => Cull::Front,
    }
}

/// Corners of polygons drawn as lines or points, with the constant part of their offset: the rasterizer offsets
/// triangles only.
fn lifted(batch: &Batch, constant: f32) -> Option<Vec<Vec4>> {
    let outlined = matches!(batch.kind, Kind::PolygonLines | Kind::PolygonPoints);
    let range = (batch.state.viewport.far - batch.state.viewport.near) as f32;
    (outlined && constant != 0.0 && range != 0.0).then(|| {
        let lift = Vec4::new(0.0, 0.0, constant / range, 0.0);
        batch.positions.iter().map(|p| *p + lift * p.w).collect()
    })
}

fn depth_bias(s: &RasterState, kind: Kind) -> DepthBias {
    let on = match kind {
        Kind::Triangles => s.has(Cap::PolygonOffsetFill),
        Kind::PolygonLines => s.has(Cap::PolygonOffsetLine),
        Kind::PolygonPoints => s.has(Cap::PolygonOffsetPoint),
        _ => false,
    };
    if !on {
        return DepthBias::default();
    }
    DepthBias { constant: s.polygon.offset_units * DEPTH_UNIT, slope: s.polygon.offset_factor }
}

fn compare(func: Enum) -> Compare {
    match func {
        gl::NEVER => Compare::Never,
        gl::LESS => Compare::Less,
        gl::EQUAL => Compare::Equal,
        gl::LEQUAL => Compare::LessEqual,
        gl::GREATER => Compare::Greater,
        gl::NOTEQUAL => Compare::NotEqual,
        gl::GEQUAL => Compare::GreaterEqual,
        _ => Compare::Always,
    }
}
