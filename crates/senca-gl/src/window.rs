//! The window as those see it who show it.

use crate::framebuffer::Window;
use crate::texture::Texels;
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

/// The buffers of a window while no context draws into it.
#[derive(Debug)]
pub struct WindowBuffers(Window);

impl WindowBuffers {
    /// Exchanges front and back buffer, if there are two.
    pub fn swap(&mut self) {
        self.0.swap();
    }

    /// The colours that the window shows, as [`Context::window_pixels`].
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 4]] {
        match self.0.front().map(|texels| &**texels) {
            Some(Texels::Rgba8(colors)) => colors,
            _ => &[],
        }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.0.width, self.0.height]
    }
}

impl Context {
    /// Takes the window's buffers from the context, which then has a window of no pixels.
    pub fn take_window(&mut self) -> WindowBuffers {
        self.finish_window();
        WindowBuffers(self.exchange_window(Window::NONE))
    }

    /// Gives the context a window's buffers, which were taken from a context of the same configuration.
    pub fn put_window(&mut self, buffers: WindowBuffers) {
        let [width, height] = buffers.size();
        if !self.framebuffers.had_window {
            self.resize(width, height);
        }
        self.exchange_window(buffers.0);
    }

    fn exchange_window(&mut self, window: Window) -> Window {
        self.raster_changed = true;
        self.vertex_changed = true;
        std::mem::replace(&mut self.framebuffers.window, window)
    }

    /// Draws what is waiting, as [`Context::finish`], but also between `begin` and `end`, where it is no error.
    pub fn finish_window(&mut self) {
        if !self.immediate.active() {
            self.flush_batch();
        }
    }

    /// The rows in which pixels of the window may have changed since this was last asked, the lowest being 0. What
    /// waits to be drawn does not count yet.
    pub fn take_changed_rows(&mut self) -> std::ops::Range<usize> {
        let rows = self.framebuffers.window.take_changed();
        rows.start as usize..rows.end as usize
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

#[cfg(test)]
mod tests {
    use crate::{Config, Context, gl};

    #[test]
    fn a_window_goes_from_one_context_to_another() {
        let config = Config { double_buffered: true, ..Config::default() };
        let [mut a, mut b] = [config; 2].map(Context::new);
        assert!(a.resize(3, 2));
        a.clear_color([1.0, 0.0, 0.0, 1.0]);
        a.clear(gl::COLOR_BUFFER_BIT);
        let mut buffers = a.take_window();
        assert_eq!((a.window_size(), buffers.size()), ([0, 0], [3, 2]));
        a.clear(gl::COLOR_BUFFER_BIT);
        a.begin(gl::POINTS);
        a.vertex([0.0, 0.0]);
        a.end();
        a.finish();
        assert_eq!(buffers.pixels(), [[0; 4]; 6]);
        buffers.swap();
        b.put_window(buffers);
        assert_eq!(b.window_pixels(), [[255, 0, 0, 255]; 6]);
        assert_eq!(b.get_integer(gl::VIEWPORT)[..], [0, 0, 3, 2]);
        b.viewport(0, 0, 1, 1);
        let buffers = b.take_window();
        b.put_window(buffers);
        assert_eq!(b.get_integer(gl::VIEWPORT)[..], [0, 0, 1, 1]);
    }
}
