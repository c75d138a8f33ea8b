//! The buffers that are drawn to: the window's.

use crate::{Config, Context, Enum, gl};
use senca_raster::{ColorPlane, Target};

/// Renderbuffers of all contexts that share.
#[derive(Debug, Default)]
pub(crate) struct Renderbuffers {}

/// Draw and read buffer, for the stack of attributes.
#[derive(Debug)]
pub(crate) struct SavedBuffers {}

/// What is drawn to and read from.
#[derive(Debug)]
pub(crate) struct Framebuffers {
    width: u32,
    height: u32,
    color: Vec<[u8; 4]>,
    depth: Vec<f32>,
}

impl Framebuffers {
    pub(crate) fn new(_config: Config) -> Self {
        Self { width: 0, height: 0, color: Vec::new(), depth: Vec::new() }
    }

    pub(crate) fn has_window(&self) -> bool {
        self.width > 0
    }

    /// Gives the window's buffers a size; `false` when there is no memory.
    pub(crate) fn resize_window(&mut self, width: u32, height: u32) -> bool {
        let pixels = width as usize * height as usize;
        let mut color = Vec::new();
        let mut depth = Vec::new();
        if color.try_reserve_exact(pixels).is_err() || depth.try_reserve_exact(pixels).is_err() {
            return false;
        }
        color.resize(pixels, [0; 4]);
        depth.resize(pixels, 1.0);
        *self = Self { width, height, color, depth };
        true
    }

    pub(crate) fn window_depths(&self) -> &[f32] {
        &self.depth
    }

    pub(crate) fn save_buffers(&self) -> SavedBuffers {
        SavedBuffers {}
    }

    pub(crate) fn restore_buffers(&mut self, _saved: SavedBuffers, _draw: bool, _read: bool) {}

    /// The planes that are drawn to.
    pub(crate) fn target(&mut self) -> Option<Target<'_>> {
        let target = Target::new(self.width, self.height).ok()?;
        target.with_color(ColorPlane::Rgba8(&mut self.color)).ok()?.with_depth(&mut self.depth).ok()
    }
}

impl Context {
    /// Whether there is something complete to draw to; else notes the error.
    pub(crate) fn may_draw(&mut self) -> bool {
        true
    }

    /// `glClear`.
    pub fn clear(&mut self, mask: Enum) {
        self.submit(move |c| {
            c.flush_batch();
            let state = &c.state;
            let clear = senca_raster::Clear {
                color: (mask & gl::COLOR_BUFFER_BIT != 0).then_some(state.color.clear_color),
                depth: (mask & gl::DEPTH_BUFFER_BIT != 0).then_some(state.depth.clear as f32),
                id: None,
                stencil: None,
            };
            if let Some(mut target) = c.framebuffers.target() {
                target.clear(&clear);
            }
        });
    }

    /// The window's colours, the lowest row first.
    #[must_use]
    pub fn window_pixels(&self) -> &[[u8; 4]] {
        &self.framebuffers.color
    }
}
