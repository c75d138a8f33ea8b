//! Choosing buffers, looking at the window, and copying between framebuffers.

use super::blit::{Aspect, BlitRects, blit};
use super::plane::Plane;
use crate::texture::Texels;
use crate::{Context, Enum, Error, gl};

impl Context {
    /// `glDrawBuffer`.
    pub fn draw_buffer(&mut self, buffer: Enum) {
        self.submit(move |c| {
            if c.framebuffers.draw_buffer() == buffer {
                return;
            }
            c.flush_bound();
            let result = c.framebuffers.set_draw_buffer(buffer);
            c.check(result);
            c.touch_raster();
        });
    }

    /// `glReadBuffer`.
    pub fn read_buffer(&mut self, buffer: Enum) {
        self.submit(move |c| {
            let result = c.framebuffers.set_read_buffer(buffer);
            c.check(result);
        });
    }

    /// The window's colours, the lowest row first, of the front buffer, or the only one. Empty if they are floats.
    /// What waits to be drawn, and a clear before it, is there after [`finish`](Self::finish).
    #[must_use]
    pub fn window_pixels(&self) -> &[[u8; 4]] {
        match self.framebuffers.window.front().map(|texels| &**texels) {
            Some(Texels::Rgba8(colors)) => colors,
            _ => &[],
        }
    }

    /// As [`window_pixels`](Self::window_pixels) for a window of floats; empty if they are bytes.
    #[must_use]
    pub fn window_floats(&self) -> &[[f32; 4]] {
        match self.framebuffers.window.front().map(|texels| &**texels) {
            Some(Texels::Rgba32F(colors)) => colors,
            _ => &[],
        }
    }

    /// The window's depths, the lowest row first, 0 near to 1 far; empty if there are none.
    #[must_use]
    pub fn window_depths(&self) -> &[f32] {
        let plane = self.framebuffers.window.depth_stencil.as_ref();
        plane.and_then(|plane| plane.texels.depths()).unwrap_or_default()
    }

    /// Width and height of the window.
    #[must_use]
    pub fn window_size(&self) -> [u32; 2] {
        [self.framebuffers.window.width, self.framebuffers.window.height]
    }

    /// Shows what was drawn to the back buffer, if there is one; that buffer then holds what was shown before.
    pub fn swap_buffers(&mut self) {
        self.outside(|c| {
            c.flush_batch();
            c.framebuffers.window.swap();
        });
    }

    /// Pixels that commands read, shared: of the read buffer, or depths or stencil values.
    ///
    /// # Errors
    /// [`Error::InvalidFramebufferOperation`] if the framebuffer is not complete, [`Error::InvalidOperation`] if
    /// it has no such pixels or several samples of each.
    pub(crate) fn read_plane(&mut self, aspect: Aspect) -> Result<Plane, Error> {
        self.flush_batch();
        let f = &self.framebuffers;
        if f.read != 0 && f.read_status() != gl::FRAMEBUFFER_COMPLETE {
            return Err(Error::InvalidFramebufferOperation);
        }
        let plane = match aspect {
            Aspect::Color => f.read_color(),
            Aspect::Depth => f.read_depth_or_stencil(true),
            Aspect::Stencil => f.read_depth_or_stencil(false),
        };
        plane.filter(|plane| plane.samples == 0).ok_or(Error::InvalidOperation)
    }

    /// `glBlitFramebuffer`: corners x0, y0, x1, y1 of the rectangles.
    pub fn blit_framebuffer(&mut self, source: [i32; 4], destination: [i32; 4], mask: Enum, filter: Enum) {
        self.submit(move |c| {
            let result = c.blit(BlitRects { source, destination }, mask, filter);
            c.check(result);
        });
    }

    fn blit(&mut self, rects: BlitRects, mask: Enum, filter: Enum) -> Result<(), Error> {
        const ALL: Enum = gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT;
        if mask & !ALL != 0 {
            return Err(Error::InvalidValue);
        }
        if !matches!(filter, gl::NEAREST | gl::LINEAR) {
            return Err(Error::InvalidEnum);
        }
        if mask & !gl::COLOR_BUFFER_BIT != 0 && filter != gl::NEAREST {
            return Err(Error::InvalidOperation);
        }
        let f = &self.framebuffers;
        let complete = |status| matches!(status, gl::FRAMEBUFFER_COMPLETE);
        if !complete(f.read_status()) || !complete(f.draw_status()) {
            return Err(Error::InvalidFramebufferOperation);
        }
        self.check_samples(&rects)?;
        self.check_formats(mask)?;
        self.settle_planes();
        self.blit_planes(&rects, mask, filter == gl::LINEAR);
        Ok(())
    }

    fn check_samples(&self, rects: &BlitRects) -> Result<(), Error> {
        let (from, to) = (self.framebuffers.read_samples(), self.framebuffers.draw_samples());
        let both = from > 0 && to > 0;
        if both && from != to || (from > 0 || to > 0) && !rects.keeps_size() {
            return Err(Error::InvalidOperation);
        }
        Ok(())
    }

    /// Depth and stencil formats must be the same on both sides.
    fn check_formats(&self, mask: Enum) -> Result<(), Error> {
        let f = &self.framebuffers;
        for (bit, depth) in [(gl::DEPTH_BUFFER_BIT, true), (gl::STENCIL_BUFFER_BIT, false)] {
            let to = match f.draw_object() {
                Some(object) if depth => object.depth.plane(),
                Some(object) => object.stencil.plane(),
                None => f.window.depth_stencil.clone(),
            };
            if let (true, Some(from), Some(to)) = (mask & bit != 0, f.read_depth_or_stencil(depth), to) {
                let same = if depth {
                    let bits =
                        |plane: &Plane| (plane.format.bits(gl::TEXTURE_DEPTH_SIZE), plane.format.is_float());
                    bits(&from) == bits(&to)
                } else {
                    from.format.base().has_stencil() == to.format.base().has_stencil()
                };
                if !same {
                    return Err(Error::InvalidOperation);
                }
            }
        }
        Ok(())
    }

    fn blit_planes(&mut self, rects: &BlitRects, mask: Enum, linear: bool) {
        let has = |bit| mask & bit != 0;
        let f = &mut self.framebuffers;
        let color = f.read_color().filter(|_| has(gl::COLOR_BUFFER_BIT));
        let depth = f.read_depth_or_stencil(true).filter(|_| has(gl::DEPTH_BUFFER_BIT));
        let stencil = f.read_depth_or_stencil(false).filter(|_| has(gl::STENCIL_BUFFER_BIT));
        let mut planes = f.take_planes();
        let clip = self.scissored(planes.area());
        if let Some(source) = color {
            planes.colors_mut().for_each(|plane| blit(&source, plane, rects, clip, Aspect::Color, linear));
        }
        if let (Some(source), Some(plane)) = (depth, planes.depth()) {
            blit(&source, plane, rects, clip, Aspect::Depth, false);
        }
        if let (Some(source), Some(plane)) = (stencil, planes.stencil()) {
            blit(&source, plane, rects, clip, Aspect::Stencil, false);
        }
        self.framebuffers.put_back(planes);
    }
}
