//! Clearing and accumulating.

use super::fill::{fill_color, fill_depth, fill_stencil};
use super::plane::Area;
use crate::state::Cap;
use crate::{Context, Enum, Error, gl};

/// The buffers that `glClear` takes.
const CLEARABLE: Enum =
    gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT | gl::ACCUM_BUFFER_BIT;

impl Context {
    /// Whether there is something complete to draw to; else notes the error.
    pub(crate) fn may_draw(&mut self) -> bool {
        // Without a window drawing does nothing, and is no error.
        let complete =
            self.framebuffers.draw == 0 || self.framebuffers.draw_status() == gl::FRAMEBUFFER_COMPLETE;
        if !complete {
            self.error(gl::INVALID_FRAMEBUFFER_OPERATION);
        }
        complete
    }

    /// The pixels of an area that the scissor lets through.
    pub(crate) fn scissored(&self, area: Area) -> Area {
        if self.state.enabled.has(Cap::ScissorTest) {
            area.intersect(Area::of(self.state.scissor))
        } else {
            area
        }
    }

    /// `glClear`: sets the buffers in `mask`, within the scissor and through the masks, to their clear values.
    pub fn clear(&mut self, mask: Enum) {
        self.submit(move |c| {
            if mask & !CLEARABLE != 0 {
                return c.error(gl::INVALID_VALUE);
            }
            if c.may_draw() && c.render_mode.is_render() {
                c.clear_buffers(mask);
            }
        });
    }

    /// Draws what waits, and lets go of textures that may be written to because they are drawn to.
    pub(crate) fn settle_planes(&mut self) {
        if self.framebuffers.draw == 0 {
            self.flush_batch();
        } else {
            self.release_textures();
        }
    }

    fn clear_buffers(&mut self, mask: Enum) {
        self.settle_planes();
        let mut planes = self.framebuffers.take_planes();
        let area = self.scissored(planes.area());
        let state = &self.state;
        if mask & gl::COLOR_BUFFER_BIT != 0 && state.color.mask != [false; 4] {
            planes
                .colors_mut()
                .for_each(|plane| fill_color(plane, area, state.color.clear_color, state.color.mask));
        }
        if let Some(plane) = planes.depth().filter(|_| mask & gl::DEPTH_BUFFER_BIT != 0 && state.depth.mask) {
            fill_depth(plane, area, state.depth.clear as f32);
        }
        if let Some(plane) = planes.stencil().filter(|_| mask & gl::STENCIL_BUFFER_BIT != 0) {
            fill_stencil(plane, area, state.stencil.clear as u8, state.stencil.write_mask as u8);
        }
        self.framebuffers.put_back(planes);
        if mask & gl::ACCUM_BUFFER_BIT != 0 && self.framebuffers.draw == 0 {
            let area = self.scissored(self.window_area());
            let value = self.state.accum.clear;
            if let Some(accumulation) = &mut self.framebuffers.window.accumulation {
                accumulation.clear(area, value);
            }
        }
    }

    fn window_area(&self) -> Area {
        let window = &self.framebuffers.window;
        Area::of([0, 0, window.width as i32, window.height as i32])
    }

    /// `glAccum`: `ACCUM`, `LOAD`, `RETURN`, `MULT` or `ADD`.
    pub fn accum(&mut self, op: Enum, value: f32) {
        self.submit(move |c| {
            let result = c.accumulate(op, value);
            c.check(result);
        });
    }

    fn accumulate(&mut self, op: Enum, value: f32) -> Result<(), Error> {
        if !matches!(op, gl::ACCUM | gl::LOAD | gl::RETURN | gl::MULT | gl::ADD) {
            return Err(Error::InvalidEnum);
        }
        if self.framebuffers.draw != 0 || self.framebuffers.read != 0 || self.config.accum_bits == 0 {
            return Err(Error::InvalidOperation);
        }
        if !self.render_mode.is_render() {
            return Ok(());
        }
        self.flush_batch();
        let area = self.scissored(self.window_area());
        let source = self.framebuffers.read_color();
        let Some(mut accumulation) = self.framebuffers.window.accumulation.take() else { return Ok(()) };
        match op {
            gl::ACCUM | gl::LOAD => {
                if let Some(plane) = &source {
                    accumulation.take(area, op, value, plane);
                }
            }
            gl::RETURN => {
                drop(source);
                let mut planes = self.framebuffers.take_planes();
                let mask = self.state.color.mask;
                planes.colors_mut().for_each(|plane| accumulation.give(area, value, plane, mask));
                self.framebuffers.put_back(planes);
            }
            _ => accumulation.adjust(area, op, value),
        }
        self.framebuffers.window.accumulation = Some(accumulation);
        Ok(())
    }
}
