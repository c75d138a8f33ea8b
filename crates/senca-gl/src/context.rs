//! The context: all state of one OpenGL, and how commands reach it.

use crate::framebuffer::Framebuffers;
use crate::immediate::Immediate;
use crate::list::{Compiling, Lists};
use crate::raster_state::Batch;
use crate::select::RenderMode;
use crate::state::{MatrixStack, State, TEXTURE_UNITS};
use crate::{Enum, arrays, attrib, gl, query, texture};
use senca_raster::TiledRasterizer;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Depth of the modelview stack.
pub(crate) const MODELVIEW_DEPTH: usize = 32;
/// Depth of the projection stack.
pub(crate) const PROJECTION_DEPTH: usize = 32;
/// Depth of each texture stack.
pub(crate) const TEXTURE_DEPTH: usize = 10;

/// What a context is made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Whether colour is kept as 32-bit floating point instead of 8 bits a component.
    pub float_color: bool,
    /// Whether there are a front and a back buffer.
    pub double_buffered: bool,
    /// Bits of the depth buffer: 0 for none, else 24 are had.
    pub depth_bits: u32,
    /// Bits of the stencil buffer: 0 for none, else 8 are had.
    pub stencil_bits: u32,
    /// Bits of a component of the accumulation buffer: 0 for none, else 32-bit floating point is had.
    pub accum_bits: u32,
}

impl Default for Config {
    /// 8-bit colour, single buffer, depth, stencil, accumulation.
    fn default() -> Self {
        Self { float_color: false, double_buffered: false, depth_bits: 24, stencil_bits: 8, accum_bits: 16 }
    }
}

/// Objects that contexts can share: display lists, textures, buffers, renderbuffers.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    pub(crate) lists: Lists,
    pub(crate) textures: texture::Textures,
    pub(crate) buffers: arrays::Buffers,
    pub(crate) renderbuffers: crate::framebuffer::Renderbuffers,
}

/// What contexts share that were made with the same group.
#[derive(Clone, Debug, Default)]
pub struct ShareGroup(Arc<Mutex<Shared>>);

/// An OpenGL 1.5 of its own.
///
/// Commands are methods with the names of the specification in Rust's spelling; numbers of all types
/// come in arrays (`context.vertex([2i16, 3])`, `context.color([255u8, 0, 0])`). A command that is in
/// error does nothing but set [`Context::get_error`].
///
/// The picture is in the window's buffers, of which row 0 is the lowest.
#[derive(Debug)]
pub struct Context {
    pub(crate) config: Config,
    pub(crate) state: State,
    pub(crate) modelview: MatrixStack,
    pub(crate) projection: MatrixStack,
    pub(crate) texture_matrices: [MatrixStack; TEXTURE_UNITS],
    pub(crate) attrib_stack: Vec<attrib::Saved>,
    pub(crate) client_stack: Vec<attrib::SavedClient>,
    pub(crate) client: arrays::ClientState,
    pub(crate) pixels: crate::pixel_state::PixelState,
    pub(crate) bindings: texture::Bindings,
    pub(crate) framebuffers: Framebuffers,
    pub(crate) immediate: Immediate,
    pub(crate) compiling: Option<Compiling>,
    /// How deep lists call lists at present.
    pub(crate) list_depth: usize,
    pub(crate) render_mode: RenderMode,
    pub(crate) queries: query::Occlusion,
    pub(crate) debug: crate::debug::Debug,
    pub(crate) batch: Batch,
    /// Batches that come before it and wait to be drawn.
    pub(crate) waiting: Vec<Batch>,
    /// Memory of batches that have been drawn.
    pub(crate) spare_batches: Vec<Batch>,
    /// To be done before the batches.
    pub(crate) waiting_clear: Option<crate::framebuffer::WaitingClear>,
    /// What waits to be drawn to another framebuffer than the one that is drawn to.
    pub(crate) parked: Option<crate::parked::Parked>,
    /// State that drawing depends on may differ from that of the batch.
    pub(crate) raster_changed: bool,
    /// The state that vertices depend on may have changed since [`crate::vertex::Plan`] was made.
    pub(crate) vertex_changed: bool,
    pub(crate) rasterizer: TiledRasterizer,
    pub(crate) shared: Arc<Mutex<Shared>>,
    error: Enum,
}

impl Context {
    /// A context without a window yet, see [`Context::resize`].
    #[must_use]
    pub fn new(config: Config) -> Self {
        Self::with_shared(config, Arc::default())
    }

    /// A context that shares display lists, textures, buffers and renderbuffers with `other`.
    #[must_use]
    pub fn sharing(config: Config, other: &Self) -> Self {
        Self::with_shared(config, Arc::clone(&other.shared))
    }

    /// A context that shares those with all contexts of a group.
    #[must_use]
    pub fn in_group(config: Config, group: &ShareGroup) -> Self {
        Self::with_shared(config, Arc::clone(&group.0))
    }

    fn with_shared(config: Config, shared: Arc<Mutex<Shared>>) -> Self {
        Self {
            config,
            state: State::default(),
            modelview: MatrixStack::new(MODELVIEW_DEPTH),
            projection: MatrixStack::new(PROJECTION_DEPTH),
            texture_matrices: std::array::from_fn(|_| MatrixStack::new(TEXTURE_DEPTH)),
            attrib_stack: Vec::new(),
            client_stack: Vec::new(),
            client: arrays::ClientState::default(),
            pixels: crate::pixel_state::PixelState::default(),
            bindings: texture::Bindings::default(),
            framebuffers: Framebuffers::new(config),
            immediate: Immediate::default(),
            compiling: None,
            list_depth: 0,
            render_mode: RenderMode::default(),
            queries: query::Occlusion::default(),
            debug: crate::debug::Debug::default(),
            batch: Batch::default(),
            waiting: Vec::new(),
            spare_batches: Vec::new(),
            waiting_clear: None,
            parked: None,
            raster_changed: true,
            vertex_changed: true,
            rasterizer: TiledRasterizer::default(),
            shared,
            error: gl::NO_ERROR,
        }
    }

    /// What contexts share.
    pub(crate) fn shared(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives the window a size, in pixels; what it shows is undefined afterwards. The first time also sets
    /// viewport and scissor to the whole window.
    ///
    /// # Errors
    /// `false` when there is no memory for it; the window stays as it was.
    pub fn resize(&mut self, width: u32, height: u32) -> bool {
        self.flush_batch();
        let first = !self.framebuffers.had_window;
        if !self.framebuffers.resize_window(width, height) {
            return false;
        }
        if first {
            let rect = [0, 0, width as i32, height as i32];
            self.state.viewport.rect = rect;
            self.state.scissor = rect;
        }
        self.begin_window();
        self.raster_changed = true;
        self.vertex_changed = true;
        true
    }

    /// Notes an error, unless one is waiting to be asked for.
    pub(crate) fn error(&mut self, code: Enum) {
        if self.error == gl::NO_ERROR {
            self.error = code;
        }
        self.note_error(code);
    }

    /// `glGetError`: what went wrong first since it was last asked, and forgets it. `INVALID_OPERATION` between
    /// `begin` and `end`, where the answer is 0.
    pub fn get_error(&mut self) -> Enum {
        if self.immediate.active() {
            self.error(gl::INVALID_OPERATION);
            return gl::NO_ERROR;
        }
        std::mem::replace(&mut self.error, gl::NO_ERROR)
    }

    /// Does a command that display lists record: now, later, or both. Between `begin` and `end` it is an
    /// `INVALID_OPERATION`.
    #[inline]
    pub(crate) fn submit(&mut self, command: impl Fn(&mut Self) + Send + Sync + 'static) {
        let Some(list) = &mut self.compiling else {
            return self.outside(command);
        };
        if list.executes() {
            self.outside(&command);
        }
        if let Some(list) = &mut self.compiling {
            list.push_call(move |context: &mut Self| context.outside(&command));
        }
    }

    /// Does a command that lists record and that may stand between `begin` and `end`.
    #[inline]
    pub(crate) fn submit_anywhere(&mut self, command: impl Fn(&mut Self) + Send + Sync + 'static) {
        let Some(list) = &mut self.compiling else {
            return command(self);
        };
        if list.executes() {
            command(self);
        }
        if let Some(list) = &mut self.compiling {
            list.push_call(command);
        }
    }

    /// Does a command that must not stand between `begin` and `end`; lists do not record it.
    #[inline]
    pub(crate) fn outside(&mut self, command: impl FnOnce(&mut Self)) {
        if self.immediate.active() {
            self.error(gl::INVALID_OPERATION);
        } else {
            command(self);
        }
    }

    /// As [`Context::outside`], with an answer: the default one when it is an error.
    pub(crate) fn ask<R: Default>(&mut self, question: impl FnOnce(&mut Self) -> R) -> R {
        if self.immediate.active() {
            self.error(gl::INVALID_OPERATION);
            return R::default();
        }
        question(self)
    }

    /// `glFlush`: draws what is waiting.
    pub fn flush(&mut self) {
        self.outside(Self::flush_batch);
    }

    /// `glFinish`: draws what is waiting. Afterwards the buffers hold the picture.
    pub fn finish(&mut self) {
        self.outside(Self::flush_batch);
    }

    /// Says that drawing may depend on something new.
    #[inline]
    pub(crate) fn touch_raster(&mut self) {
        self.raster_changed = true;
    }

    /// Says that vertices may depend on something new.
    #[inline]
    pub(crate) fn touch_vertices(&mut self) {
        self.vertex_changed = true;
    }

    /// Says that both may.
    #[inline]
    pub(crate) fn touch(&mut self) {
        self.raster_changed = true;
        self.vertex_changed = true;
    }
}
