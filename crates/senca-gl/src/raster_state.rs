//! What waits to be drawn, with the state it is drawn with.
//!
//! Primitives are gathered until something that matters for drawing changes or somebody looks at the buffers.
//! State that is baked into vertices - matrices, lights, colours - does not matter any more at this point.

use crate::state::{
    Cap, ColorBuffer, DepthBuffer, Enabled, Fog, Line, Multisample, Point, Polygon, PolygonStipple,
    StencilBuffer, TEXTURE_UNITS, TexEnv, TexTarget, Viewport,
};
use crate::texture::View;
use crate::vertex::{Layout, Processed};
use crate::{Context, Enum, gl};
use senca_math::glam::Vec4;

/// Largest size of a point, in pixels.
pub(crate) const MAX_POINT_SIZE: f32 = 2048.0;
/// Largest width of a line, in pixels.
pub(crate) const MAX_LINE_WIDTH: f32 = 2048.0;
/// Vertices after which what waits is drawn in any case.
const FULL: usize = 1 << 18;
/// Batches after which it is.
const MANY: usize = 64;
/// Spare batches that may hold memory for more than their share of vertices.
const LARGE_SPARES: usize = 8;

/// What the primitives of a batch are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Kind {
    #[default]
    Triangles,
    Lines,
    Points,
    /// Edges of polygons in mode LINE.
    PolygonLines,
    /// Corners of polygons in mode POINT.
    PolygonPoints,
}

/// A texture unit that is on, with a texture that is complete.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UnitState {
    pub(crate) unit: usize,
    pub(crate) env: TexEnv,
    pub(crate) target: TexTarget,
    pub(crate) view: View,
}

/// Everything drawing depends on, but for the buffers drawn to.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RasterState {
    /// Only the capabilities that matter here.
    pub(crate) enabled: Enabled,
    pub(crate) polygon: Polygon,
    pub(crate) polygon_stipple: PolygonStipple,
    pub(crate) line: Line,
    pub(crate) point: Point,
    pub(crate) fog: Fog,
    pub(crate) depth: DepthBuffer,
    pub(crate) stencil: StencilBuffer,
    pub(crate) color: ColorBuffer,
    pub(crate) viewport: Viewport,
    pub(crate) scissor: [i32; 4],
    pub(crate) multisample: Multisample,
    pub(crate) clip_origin: Enum,
    /// By unit number, rising.
    pub(crate) units: Vec<UnitState>,
    /// Secondary colours are added.
    pub(crate) color_sum: bool,
    /// Samples that pass are counted.
    pub(crate) counts: bool,
}

impl RasterState {
    fn new(context: &Context) -> Self {
        let s = &context.state;
        let lit = s.enabled.has(Cap::Lighting);
        let [r, g, b, a] = s.color.mask;
        let units = (0..TEXTURE_UNITS).filter_map(|unit| {
            let (target, view) = context.texture_view(unit)?;
            Some(UnitState { unit, env: s.texturing.units[unit].env, target, view })
        });
        Self {
            enabled: Enabled(s.enabled.0 & relevant()),
            polygon: s.polygon,
            polygon_stipple: s.polygon_stipple,
            line: s.line,
            point: s.point,
            fog: s.fog,
            depth: DepthBuffer { clear: 0.0, ..s.depth },
            stencil: StencilBuffer { clear: 0, ..s.stencil },
            color: ColorBuffer {
                clear_color: [0.0; 4],
                clear_index: 0.0,
                // What has no alpha keeps one of 1.
                mask: [r, g, b, a && context.framebuffers.draws_alpha()],
                ..s.color
            },
            viewport: s.viewport,
            scissor: s.scissor,
            multisample: s.multisample,
            clip_origin: s.transform.clip_origin,
            units: units.collect(),
            color_sum: if lit {
                s.lighting.color_control == gl::SEPARATE_SPECULAR_COLOR
            } else {
                s.enabled.has(Cap::ColorSum)
            },
            counts: context.queries.active(),
        }
    }

    pub(crate) fn has(&self, cap: Cap) -> bool {
        self.enabled.has(cap)
    }
}

/// Capabilities that matter for drawing.
fn relevant() -> u128 {
    [
        Cap::AlphaTest,
        Cap::Blend,
        Cap::ColorLogicOp,
        Cap::CullFace,
        Cap::DepthTest,
        Cap::Dither,
        Cap::Fog,
        Cap::FramebufferSrgb,
        Cap::LineSmooth,
        Cap::LineStipple,
        Cap::Multisample,
        Cap::PointSmooth,
        Cap::PolygonOffsetFill,
        Cap::PolygonOffsetLine,
        Cap::PolygonOffsetPoint,
        Cap::PolygonSmooth,
        Cap::PolygonStipple,
        Cap::SampleAlphaToCoverage,
        Cap::SampleAlphaToOne,
        Cap::SampleCoverage,
        Cap::ScissorTest,
        Cap::StencilTest,
        Cap::TextureCubeMapSeamless,
    ]
    .into_iter()
    .fold(0, |bits, cap| bits | 1 << cap as u8)
}

/// Primitives that wait to be drawn.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    pub(crate) kind: Kind,
    pub(crate) layout: Layout,
    pub(crate) state: RasterState,
    /// Clip space of the rasterizer: y down, z in [0, w].
    pub(crate) positions: Vec<Vec4>,
    /// [`Layout::stride`] for each vertex.
    pub(crate) varyings: Vec<f32>,
    /// Three vertex numbers per triangle, two per line, one per point.
    pub(crate) indices: Vec<u32>,
    /// Per line, whether its stipple goes on from the line before.
    pub(crate) continues: Vec<bool>,
    /// Per vertex, sizes of points that depend on the distance; else empty.
    pub(crate) sizes: Vec<f32>,
}

impl Batch {
    pub(crate) fn extend(&mut self, p: &Processed) {
        self.positions.extend_from_slice(&p.positions);
        self.varyings.extend_from_slice(&p.varyings);
        self.sizes.extend_from_slice(&p.sizes);
    }

    /// Does what [`Self::extend`] does, but leaves the vertices behind only if it must copy them.
    pub(crate) fn take(&mut self, p: &mut Processed) {
        if !self.positions.is_empty() {
            return self.extend(p);
        }
        std::mem::swap(&mut self.positions, &mut p.positions);
        std::mem::swap(&mut self.varyings, &mut p.varyings);
        std::mem::swap(&mut self.sizes, &mut p.sizes);
    }

    /// Whether the next batch can be drawn together with this one.
    fn goes_along(&self, next: &Self) -> bool {
        let of_triangles =
            |batch: &Self| batch.kind == Kind::Triangles && !batch.state.has(Cap::PolygonSmooth);
        let multisample = |batch: &Self| batch.state.has(Cap::Multisample);
        of_triangles(self) && of_triangles(next) && multisample(self) == multisample(next)
    }

    fn clear(&mut self) {
        self.positions.clear();
        self.varyings.clear();
        self.indices.clear();
        self.continues.clear();
        self.sizes.clear();
    }
}

impl Context {
    /// Makes sure that primitives of a kind can be put into the batch; returns the number of the next vertex.
    pub(crate) fn begin_batch(&mut self, kind: Kind, layout: Layout) -> u32 {
        if self.raster_changed {
            self.raster_changed = false;
            let state = RasterState::new(self);
            if state != self.batch.state {
                self.set_aside();
                self.batch.state = state;
            }
        }
        if self.batch.kind != kind || self.batch.layout != layout || self.batch.positions.len() >= FULL {
            self.set_aside();
            (self.batch.kind, self.batch.layout) = (kind, layout);
        }
        self.batch.positions.len() as u32
    }

    /// Makes sure that fragments of pixels and bitmaps can be put into the batch, as points; returns the number of
    /// the next. They are drawn to the whole framebuffer, whose size is given, and nothing of points applies to
    /// them; depths are those of the window.
    pub(crate) fn begin_pixel_batch(&mut self, layout: Layout, [width, height]: [i32; 2]) -> u32 {
        let mut state = RasterState::new(self);
        state.viewport = Viewport { rect: [0, 0, width, height], near: 0.0, far: 1.0 };
        state.point = Point::default();
        state.clip_origin = gl::LOWER_LEFT;
        state.enabled.set(Cap::PointSmooth, 0, false);
        state.enabled.set(Cap::Multisample, 0, false);
        // What is drawn next has a state of its own again.
        self.raster_changed = true;
        if state != self.batch.state {
            self.set_aside();
            self.batch.state = state;
        }
        if self.batch.kind != Kind::Points
            || self.batch.layout != layout
            || self.batch.positions.len() >= FULL
        {
            self.set_aside();
            (self.batch.kind, self.batch.layout) = (Kind::Points, layout);
        }
        self.batch.positions.len() as u32
    }

    /// Draws what waits.
    pub(crate) fn flush_batch(&mut self) {
        self.draw_gathered();
        self.settle_clear();
    }

    /// Draws what waits to be drawn to the framebuffer that is drawn to now.
    pub(crate) fn flush_bound(&mut self) {
        self.draw_bound();
        self.settle_clear();
    }

    /// Draws all primitives that wait. A clear goes on waiting if there are none.
    pub(crate) fn draw_gathered(&mut self) {
        self.draw_parked();
        self.draw_bound();
    }

    /// The same of the framebuffer that is drawn to now.
    fn draw_bound(&mut self) {
        self.set_aside();
        self.draw_waiting();
        self.reuse_memory();
    }

    /// Puts what has been gathered to what waits to be drawn, and begins anew with the same state. Batches that
    /// are drawn together pass through the framebuffer's memory once.
    pub(crate) fn set_aside(&mut self) {
        if self.batch.indices.is_empty() {
            self.batch.clear();
            return;
        }
        let mut next = Batch { kind: self.batch.kind, layout: self.batch.layout, ..Batch::default() };
        next.state.clone_from(&self.batch.state);
        self.waiting.push(std::mem::replace(&mut self.batch, next));
        let vertices: usize = self.waiting.iter().map(|batch| batch.positions.len()).sum();
        if vertices >= FULL || self.waiting.len() >= MANY {
            self.draw_waiting();
        }
        self.reuse_memory();
    }

    /// Gives a batch that has none yet the memory of one that has been drawn.
    fn reuse_memory(&mut self) {
        if self.batch.positions.capacity() > 0 {
            return;
        }
        if let Some(mut spare) = self.spare_batches.pop() {
            (spare.kind, spare.layout) = (self.batch.kind, self.batch.layout);
            std::mem::swap(&mut spare.state, &mut self.batch.state);
            self.batch = spare;
        }
    }

    /// Draws the batches that wait. A clear goes on waiting if there are none.
    pub(crate) fn draw_waiting(&mut self) {
        let mut batches = std::mem::take(&mut self.waiting);
        for group in batches.chunk_by(Batch::goes_along) {
            let passed = self.draw_batches(group);
            self.queries.add(passed);
        }
        // The first one will be the first to be used again, by what is probably the same in the next frame.
        for mut batch in batches.drain(..).rev() {
            batch.clear();
            batch.state.units.clear();
            if self.spare_batches.len() < LARGE_SPARES || batch.positions.capacity() <= FULL / MANY {
                self.spare_batches.push(batch);
            }
        }
        self.waiting = batches;
    }
}
