//! The stacks of attributes (OpenGL 1.5, section 6.1.14).

use crate::state::{CLIP_PLANES, Cap, LIGHTS, State};
use crate::{Context, Enum, arrays, eval, gl, pixel_state, texture};

/// Depth of the stack of attributes.
pub(crate) const MAX_ATTRIB_STACK_DEPTH: usize = 16;
/// Depth of the stack of client attributes.
pub(crate) const MAX_CLIENT_ATTRIB_STACK_DEPTH: usize = 16;

/// What `push_attrib` has saved.
#[derive(Debug)]
pub(crate) struct Saved {
    mask: Enum,
    state: Box<State>,
    transfer: Option<Box<pixel_state::TransferState>>,
    bindings: Option<texture::SavedBindings>,
    buffers: Option<crate::framebuffer::SavedBuffers>,
}

/// State of a context, for another one.
#[derive(Debug)]
pub struct SavedState(Saved);

/// What `push_client_attrib` has saved.
#[derive(Debug)]
pub(crate) struct SavedClient {
    mask: Enum,
    client: arrays::ClientState,
    store: pixel_state::StoreState,
}

/// Capabilities that belong to a group beside `ENABLE_BIT`.
fn caps_of(group: Enum) -> u128 {
    let row = |cap: Cap, n: usize| (0..n).fold(0u128, |bits, k| bits | 1 << (cap as usize + k));
    let one = |cap: Cap| row(cap, 1);
    match group {
        gl::POINT_BIT => one(Cap::PointSmooth),
        gl::LINE_BIT => one(Cap::LineSmooth) | one(Cap::LineStipple),
        gl::POLYGON_BIT => {
            one(Cap::CullFace)
                | one(Cap::PolygonSmooth)
                | one(Cap::PolygonStipple)
                | one(Cap::PolygonOffsetFill)
                | one(Cap::PolygonOffsetLine)
                | one(Cap::PolygonOffsetPoint)
        }
        gl::LIGHTING_BIT => one(Cap::Lighting) | one(Cap::ColorMaterial) | row(Cap::Light0, LIGHTS),
        gl::FOG_BIT => one(Cap::Fog) | one(Cap::ColorSum),
        gl::DEPTH_BUFFER_BIT => one(Cap::DepthTest),
        gl::STENCIL_BUFFER_BIT => one(Cap::StencilTest),
        gl::TRANSFORM_BIT => {
            row(Cap::ClipPlane0, CLIP_PLANES) | one(Cap::Normalize) | one(Cap::RescaleNormal)
        }
        gl::COLOR_BUFFER_BIT => {
            one(Cap::AlphaTest)
                | one(Cap::Blend)
                | one(Cap::Dither)
                | one(Cap::IndexLogicOp)
                | one(Cap::ColorLogicOp)
                | one(Cap::FramebufferSrgb)
        }
        gl::EVAL_BIT => {
            row(Cap::Map1Color4, eval::TARGETS) | row(Cap::Map2Color4, eval::TARGETS) | one(Cap::AutoNormal)
        }
        gl::SCISSOR_BIT => one(Cap::ScissorTest),
        gl::MULTISAMPLE_BIT => {
            one(Cap::Multisample)
                | one(Cap::SampleAlphaToCoverage)
                | one(Cap::SampleAlphaToOne)
                | one(Cap::SampleCoverage)
        }
        gl::ENABLE_BIT => !(one(Cap::DebugOutput) | one(Cap::DebugOutputSynchronous)),
        _ => 0,
    }
}

impl Context {
    /// `glPushAttrib`: saves the groups in `mask`.
    pub fn push_attrib(&mut self, mask: Enum) {
        self.submit(move |c| {
            if c.attrib_stack.len() >= MAX_ATTRIB_STACK_DEPTH {
                return c.error(gl::STACK_OVERFLOW);
            }
            let saved = c.saved(mask);
            c.attrib_stack.push(saved);
        });
    }

    fn saved(&mut self, mask: Enum) -> Saved {
        self.settle_color_material();
        let has = |bit| mask & bit != 0;
        let buffers = has(gl::COLOR_BUFFER_BIT) || has(gl::PIXEL_MODE_BIT);
        Saved {
            mask,
            state: Box::new(self.state.clone()),
            transfer: has(gl::PIXEL_MODE_BIT).then(|| Box::new(self.pixels.transfer.clone())),
            bindings: has(gl::TEXTURE_BIT).then(|| self.save_bindings()),
            buffers: buffers.then(|| self.framebuffers.save_buffers()),
        }
    }

    /// The groups of state in `mask`, as `glPushAttrib` names them, for another context.
    pub fn save_state(&mut self, mask: Enum) -> SavedState {
        let mut saved = self.saved(mask);
        saved.bindings = None;
        SavedState(saved)
    }

    /// Takes over state of another context. Which textures are bound stays as it is, as objects are not state.
    pub fn load_state(&mut self, state: SavedState) {
        self.finish_window();
        self.restore(state.0);
    }

    /// `glPopAttrib`: brings back what was saved last.
    pub fn pop_attrib(&mut self) {
        self.submit(|c| match c.attrib_stack.pop() {
            Some(saved) => c.restore(saved),
            None => c.error(gl::STACK_UNDERFLOW),
        });
    }

    fn restore(&mut self, saved: Saved) {
        let Saved { mask, state: old, transfer, bindings, buffers } = saved;
        self.settle_color_material();
        let s = &mut self.state;
        let has = |bit| mask & bit != 0;
        let groups = (0..32).map(|k| 1 << k).filter(|bit| has(*bit));
        let caps = groups.fold(0, |caps, group| caps | caps_of(group));
        s.enabled.0 = s.enabled.0 & !caps | old.enabled.0 & caps;
        if has(gl::CURRENT_BIT) {
            s.current = old.current;
        }
        if has(gl::POINT_BIT) {
            s.point = old.point;
        }
        if has(gl::LINE_BIT) {
            s.line = old.line;
        }
        if has(gl::POLYGON_BIT) {
            s.polygon = old.polygon;
        }
        if has(gl::POLYGON_STIPPLE_BIT) {
            s.polygon_stipple = old.polygon_stipple;
        }
        if has(gl::LIGHTING_BIT) {
            s.lighting = old.lighting;
        }
        if has(gl::FOG_BIT) {
            s.fog = old.fog;
        }
        if has(gl::DEPTH_BUFFER_BIT) {
            s.depth = old.depth;
        }
        if has(gl::ACCUM_BUFFER_BIT) {
            s.accum = old.accum;
        }
        if has(gl::STENCIL_BUFFER_BIT) {
            s.stencil = old.stencil;
        }
        if has(gl::VIEWPORT_BIT) {
            s.viewport = old.viewport;
        }
        if has(gl::TRANSFORM_BIT) {
            s.transform = old.transform;
        }
        if has(gl::COLOR_BUFFER_BIT) {
            s.color = old.color;
        }
        if has(gl::HINT_BIT) {
            s.hints = old.hints;
        }
        if has(gl::EVAL_BIT) {
            s.eval = old.eval;
        }
        if has(gl::LIST_BIT) {
            s.list_base = old.list_base;
        }
        if has(gl::SCISSOR_BIT) {
            s.scissor = old.scissor;
        }
        if has(gl::MULTISAMPLE_BIT) {
            s.multisample = old.multisample;
        }
        if has(gl::TEXTURE_BIT) {
            s.texturing = old.texturing;
        } else if has(gl::ENABLE_BIT) {
            for (unit, old) in s.texturing.units.iter_mut().zip(&old.texturing.units) {
                unit.enabled = old.enabled;
                for (to, from) in unit.generation.iter_mut().zip(&old.generation) {
                    to.enabled = from.enabled;
                }
            }
        }
        if let Some(transfer) = transfer {
            self.pixels.transfer = *transfer;
        }
        if let Some(bindings) = bindings {
            self.restore_bindings(bindings);
        }
        if let Some(buffers) = buffers {
            self.flush_batch();
            self.framebuffers.restore_buffers(buffers, has(gl::COLOR_BUFFER_BIT), has(gl::PIXEL_MODE_BIT));
        }
        self.touch();
    }

    /// `glPushClientAttrib`: saves the groups in `mask`. Not recorded in lists.
    pub fn push_client_attrib(&mut self, mask: Enum) {
        self.outside(|c| {
            if c.client_stack.len() >= MAX_CLIENT_ATTRIB_STACK_DEPTH {
                return c.error(gl::STACK_OVERFLOW);
            }
            let saved = SavedClient { mask, client: c.client.clone(), store: c.pixels.store };
            c.client_stack.push(saved);
        });
    }

    /// `glPopClientAttrib`: brings back what was saved last. Not recorded in lists.
    pub fn pop_client_attrib(&mut self) {
        self.outside(|c| {
            let Some(saved) = c.client_stack.pop() else { return c.error(gl::STACK_UNDERFLOW) };
            if saved.mask & gl::CLIENT_VERTEX_ARRAY_BIT != 0 {
                c.client = saved.client;
            }
            if saved.mask & gl::CLIENT_PIXEL_STORE_BIT != 0 {
                c.pixels.store = saved.store;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn state_goes_from_one_context_to_another_by_groups() {
        let [mut from, mut to] = [(); 2].map(|()| Context::new(crate::Config::default()));
        from.line_width(3.0);
        from.enable(gl::FOG);
        from.point_size(5.0);
        let state = from.save_state(gl::LINE_BIT | gl::FOG_BIT);
        to.load_state(state);
        assert_eq!(to.get_float(gl::LINE_WIDTH)[..], [3.0]);
        assert_eq!(to.get_float(gl::POINT_SIZE)[..], [1.0]);
        assert!(to.is_enabled(gl::FOG));
    }

    #[test]
    fn groups_come_back_and_others_stay() {
        let mut c = Context::new(Config::default());
        c.push_attrib(gl::LINE_BIT | gl::DEPTH_BUFFER_BIT);
        c.line_width(3.0);
        c.enable(gl::LINE_STIPPLE);
        c.enable(gl::DEPTH_TEST);
        c.point_size(5.0);
        c.enable(gl::BLEND);
        c.pop_attrib();
        assert_eq!((c.state.line.width, c.state.point.size), (1.0, 5.0));
        assert!(!c.is_enabled(gl::LINE_STIPPLE) && !c.is_enabled(gl::DEPTH_TEST) && c.is_enabled(gl::BLEND));
        c.pop_attrib();
        assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
        (0..=MAX_ATTRIB_STACK_DEPTH).for_each(|_| c.push_attrib(gl::ALL_ATTRIB_BITS));
        assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
    }

    #[test]
    fn what_is_on_comes_back_with_the_enable_bit_alone() {
        let mut c = Context::new(Config::default());
        c.push_attrib(gl::ENABLE_BIT);
        c.enable(gl::TEXTURE_2D);
        c.enable(gl::TEXTURE_GEN_S);
        c.enable(gl::LIGHT3);
        c.line_width(2.0);
        c.pop_attrib();
        assert!(
            !c.is_enabled(gl::TEXTURE_2D) && !c.is_enabled(gl::TEXTURE_GEN_S) && !c.is_enabled(gl::LIGHT3)
        );
        assert_eq!(c.state.line.width, 2.0);
    }
}
