//! Drawing what has been gathered: the state of OpenGL into the rasterizer's terms.

use crate::raster_state::{Batch, Kind, RasterState};
use crate::state::Cap;
use crate::{Context, Enum, gl};
use senca_raster::{
    ColorSource, Compare, Cull, DepthBias, Ids, Primitives, Rasterizer, Rect, Shading, State, Viewport,
};

/// The smallest step of a depth buffer of 24 bits.
const DEPTH_UNIT: f32 = 1.0 / (1 << 24) as f32;

impl Context {
    /// Draws a batch; returns how many samples passed.
    pub(crate) fn draw_batch(&mut self, batch: &Batch) -> u64 {
        let Some(mut target) = self.framebuffers.target() else { return 0 };
        let state = raster_state(batch);
        let primitives = Primitives {
            positions: &batch.positions,
            varyings: &batch.varyings,
            stride: usize::from(batch.layout.stride),
            indices: &batch.indices,
            ids: Ids::Same(0),
        };
        let shading = Shading::Fixed { color: ColorSource::Rgba { first: 0 }, texture: None };
        let rasterizer = &mut self.rasterizer;
        let counters = match batch.kind {
            Kind::Triangles => rasterizer.draw(&mut target, &primitives, &state, &shading),
            Kind::Lines | Kind::PolygonLines => {
                rasterizer.draw_lines(&mut target, &primitives, &state, &shading)
            }
            Kind::Points | Kind::PolygonPoints => {
                rasterizer.draw_points(&mut target, &primitives, &state, &shading)
            }
        };
        counters.passed
    }
}

fn raster_state(batch: &Batch) -> State {
    let s = &batch.state;
    let [x, y, width, height] = s.viewport.rect.map(|v| v as f32);
    State {
        viewport: Some(Viewport { x, y, width, height }),
        scissor: s.has(Cap::ScissorTest).then(|| rect(s.scissor)),
        cull: if batch.kind == Kind::Triangles { cull(s) } else { Cull::None },
        depth_test: if s.has(Cap::DepthTest) { compare(s.depth.func) } else { Compare::Always },
        depth_write: s.has(Cap::DepthTest) && s.depth.mask,
        depth_range: [s.viewport.near as f32, s.viewport.far as f32],
        depth_bias: depth_bias(s, batch.kind),
        line_width: s.line.width,
        point_size: s.point.size,
        ..State::default()
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
