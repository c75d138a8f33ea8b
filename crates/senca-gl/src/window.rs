//! The window as those see it who show it.

use crate::framebuffer::Window;
use crate::pixel::unorm8_from_f32;
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
    /// All pixels have one colour of 8 bits a component.
    SameBytes([u8; 4]),
    /// All pixels have one colour of floating point.
    SameFloats([f32; 4]),
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
            // These buffers are not new.
            self.waiting_clear = self.waiting_clear.filter(|_| self.framebuffers.draw != 0);
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

    /// Draws what is waiting, as [`Context::finish_window`], but where all of a window of one buffer has been cleared
    /// and nothing drawn since, the clear may go on waiting for what will be drawn: only
    /// [`Context::window_colors`] knows of it.
    pub fn finish_for_show(&mut self) {
        if !self.immediate.active() {
            self.draw_gathered();
            if self.clears_shown() {
                self.settle_new_planes();
            } else {
                self.settle_clear();
            }
        }
    }

    /// `glFlush` and `glFinish` for who shows the window: as [`Context::finish_for_show`], but an error between
    /// `begin` and `end`.
    pub fn flush_for_show(&mut self) {
        self.outside(Self::finish_for_show);
    }

    /// The rows in which pixels of the window may have changed since this was last asked, the lowest being 0. What
    /// waits to be drawn does not count yet.
    pub fn take_changed_rows(&mut self) -> std::ops::Range<usize> {
        let rows = self.framebuffers.window.take_changed();
        rows.start as usize..rows.end as usize
    }

    /// The colours that the window shows, of as many pixels as it has; rows without space between. A clear that
    /// [`Context::finish_for_show`] has left waiting counts as done.
    #[must_use]
    pub fn window_colors(&self) -> Colors<'_> {
        match (self.shown_clear(), self.window_floats()) {
            (Some(color), []) => Colors::SameBytes(color.map(unorm8_from_f32)),
            (Some(color), _) => Colors::SameFloats(color),
            (None, []) => Colors::Bytes(self.window_pixels()),
            (None, floats) => Colors::Floats(floats),
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
    fn a_clear_that_waits_is_shown_and_done_once_somebody_looks() {
        use super::Colors;
        let mut c = Context::new(Config::default());
        assert!(c.resize(9, 3));
        c.finish_for_show();
        assert!(matches!(c.window_colors(), Colors::SameBytes([0, 0, 0, 0])));
        assert_eq!((c.take_changed_rows(), c.take_changed_rows()), (0..3, 0..0));
        c.clear_color([1.0, 0.0, 0.2, 1.0]);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.flush_for_show();
        assert!(matches!(c.window_colors(), Colors::SameBytes([255, 0, 51, 255])));
        assert_eq!(c.take_changed_rows(), 0..3);
        // The clear goes on waiting, and is there for what is drawn then and for who looks at the buffers.
        c.begin(gl::POINTS);
        c.vertex([0.0, 0.0]);
        c.end();
        c.finish_for_show();
        let Colors::Bytes(pixels) = c.window_colors() else { panic!("drawn to") };
        assert_eq!((pixels[0], pixels[9 + 4]), ([255, 0, 51, 255], [255; 4]));
        assert_eq!(c.window_depths(), [1.0; 27]);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.finish();
        assert!(matches!(c.window_colors(), Colors::Bytes(_)));
        assert_eq!(c.window_pixels(), [[255, 0, 51, 255]; 27]);
    }

    #[test]
    fn drawing_depths_alone_leaves_new_colors_black() {
        let mut c = Context::new(Config::default());
        assert!(c.resize(2, 2));
        c.enable(gl::DEPTH_TEST);
        c.color_mask([false; 4]);
        c.begin(gl::TRIANGLES);
        [[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]].into_iter().for_each(|v| c.vertex(v));
        c.end();
        c.finish();
        assert_eq!((c.window_pixels(), c.window_depths()), (&[[0; 4]; 4][..], &[0.5; 4][..]));
    }

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
