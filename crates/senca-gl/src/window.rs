//! The window as those see it who show it.

use crate::{Context, Enum};

/// Longest side of a window.
#[must_use]
pub fn max_window_side() -> u32 {
    16_384
}

/// Colours of the window, the lowest row first.
#[derive(Clone, Copy, Debug)]
pub enum Colors<'a> {
    /// 8 bits a component.
    Bytes(&'a [[u8; 4]]),
    /// Floating point.
    Floats(&'a [[f32; 4]]),
}

impl Context {
    /// Draws what is waiting, as [`Context::finish`], but also between `begin` and `end`, where it is no error.
    pub fn finish_window(&mut self) {
        if !self.immediate.active() {
            self.flush_batch();
        }
    }

    /// The colours that the window shows, of as many pixels as it has; rows without space between.
    #[must_use]
    pub fn window_colors(&self) -> Colors<'_> {
        match self.window_floats() {
            [] => Colors::Bytes(self.window_pixels()),
            floats => Colors::Floats(floats),
        }
    }

    /// Whether colours of the window are kept as floating point.
    #[must_use]
    pub fn has_float_color(&self) -> bool {
        self.config.float_color
    }

    /// Keeps colours of the window as floating point or in 8 bits from the next [`Context::resize`] on.
    pub fn set_float_color(&mut self, float: bool) {
        self.config.float_color = float;
        self.framebuffers.config.float_color = float;
    }

    /// Notes an error found by whoever hands commands over, unless one is waiting to be asked for.
    pub fn raise(&mut self, code: Enum) {
        self.error(code);
    }
}
