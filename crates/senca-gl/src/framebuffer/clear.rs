//! Clearing and accumulating.

use super::draw::DrawPlanes;
use super::fill::{fill_color, fill_depth, fill_stencil};
use super::plane::{Area, side};
use crate::state::Cap;
use crate::texture::Texels;
use crate::{Context, Enum, Error, gl};
use senca_raster::Clear;

/// A clear of all pixels, or of a part that the rasterizer can clear, which waits for what is drawn after it: the
/// rasterizer clears tile by tile as it goes, which saves going through the memory once more. Whoever looks at the
/// buffers does it before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaitingClear {
    /// What is cleared, and to which values.
    pub(crate) values: Clear,
    /// Which pixels.
    pub(crate) area: Area,
    /// Whether these are all of what is drawn to.
    pub(crate) is_whole: bool,
    /// Whether the planes are new: colours that are to be 0 need not be set.
    is_fresh: bool,
    /// Whether the window has not been shown yet.
    is_new: bool,
    /// Whether the program has asked for it.
    is_asked: bool,
}

impl WaitingClear {
    /// Adds what another one of the same area clears.
    fn join(&mut self, later: &Self) {
        let (to, from) = (&mut self.values, later.values);
        to.color = from.color.or(to.color);
        to.depth = from.depth.or(to.depth);
        to.stencil = from.stencil.or(to.stencil);
        self.is_asked |= later.is_asked;
    }

    /// Whether it is worth while to do it along with what is drawn: what nobody has asked for is next to nothing.
    pub(crate) fn is_worth_waiting(&self) -> bool {
        self.is_asked
    }

    /// What of it is to be done along with what is drawn. New colours are 0 already, and stay untouched if nobody
    /// draws to them.
    pub(crate) fn for_draw(mut self, draws_colors: bool) -> Self {
        self.values.color = self.values.color.filter(|color| draws_colors || !self.keeps(*color));
        self
    }

    /// Whether colours are this one already.
    fn keeps(&self, color: [f32; 4]) -> bool {
        self.is_fresh && color == [0.0; 4]
    }

    /// Whether another one clears none of the buffers that this one does.
    fn is_apart(&self, other: &Self) -> bool {
        let (a, b) = (self.values, other.values);
        let both = [
            a.color.is_some() && b.color.is_some(),
            a.depth.is_some() && b.depth.is_some(),
            a.stencil.is_some() && b.stencil.is_some(),
        ];
        both == [false; 3]
    }
}

/// Blocks that the rasterizer clears at once have this many samples along each side.
const BLOCK: i32 = 8;

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
        self.draw_parked();
        self.settle_bound_planes();
    }

    /// The same of the framebuffer that is drawn to now.
    fn settle_bound_planes(&mut self) {
        self.flush_bound();
        if self.framebuffers.draw != 0 {
            self.batch.state.units.clear();
            self.touch_raster();
        }
    }

    fn clear_buffers(&mut self, mask: Enum) {
        let nothing_waits = self.batch.indices.is_empty() && self.waiting.is_empty();
        if nothing_waits && self.waiting_clear.is_some() {
            // A clear of one buffer after that of another: both wait, or the first one goes on waiting.
            if let (Some(new), Some(old)) = (self.whole_clear(mask), self.waiting_clear.as_mut()) {
                if old.area == new.area {
                    return old.join(&new);
                }
                if old.is_apart(&new) {
                    return self.do_clear(&new);
                }
            }
        }
        self.settle_bound_planes();
        if let Some(clear) = self.whole_clear(mask) {
            self.waiting_clear = Some(clear);
            return;
        }
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

    /// What a clear sets, if it sets all of the pixels of planes that the rasterizer can clear as it draws.
    fn whole_clear(&mut self, mask: Enum) -> Option<WaitingClear> {
        if mask & gl::ACCUM_BUFFER_BIT != 0 {
            return None;
        }
        let mut planes = self.framebuffers.take_planes();
        let clear = self.whole_clear_of(&mut planes, mask);
        self.framebuffers.put_back(planes);
        clear
    }

    fn whole_clear_of(&self, planes: &mut DrawPlanes, mask: Enum) -> Option<WaitingClear> {
        let (s, whole) = (&self.state, planes.area());
        let area = self.scissored(whole);
        let side = side(planes.samples) as i32;
        let fits = |end: i32, rim: i32| end * side % BLOCK == 0 || end == rim;
        let in_blocks =
            fits(area.x0, 0) && fits(area.y0, 0) && fits(area.x1, whole.x1) && fits(area.y1, whole.y1);
        if area.is_empty() || !in_blocks || !planes.are_alike() || planes.color_count() > 1 {
            return None;
        }
        let mut values = Clear { color: None, depth: None, id: None, stencil: None };
        if let Some(plane) = planes.colors_mut().next().filter(|_| mask & gl::COLOR_BUFFER_BIT != 0) {
            let fits = matches!(*plane.texels, Texels::Rgba8(_) | Texels::Rgba32F(_));
            if !fits || s.color.mask != [true; 4] {
                return None;
            }
            let color = s.color.clear_color.map(|c| c.clamp(0.0, 1.0));
            values.color = Some(plane.format.base().stored(color, 1.0));
        }
        if planes.depth().is_some() && mask & gl::DEPTH_BUFFER_BIT != 0 && s.depth.mask {
            values.depth = Some(s.depth.clear as f32);
        }
        if planes.stencil().is_some() && mask & gl::STENCIL_BUFFER_BIT != 0 {
            if s.stencil.write_mask as u8 != u8::MAX {
                return None;
            }
            values.stencil = Some(s.stencil.clear as u8);
        }
        Some(WaitingClear {
            values,
            area,
            is_whole: area == whole,
            is_fresh: false,
            is_new: false,
            is_asked: true,
        })
    }

    /// Black and the farthest depth for the planes of a new window, which are zeros that nobody has touched yet: a
    /// clear that waits. Stencil values are 0 already.
    pub(crate) fn begin_window(&mut self) {
        let values = Clear { color: Some([0.0; 4]), depth: Some(1.0), id: None, stencil: None };
        if self.framebuffers.draw == 0 {
            let mut planes = self.framebuffers.take_planes();
            let values = Clear {
                color: values.color.filter(|_| planes.color_count() == 1),
                depth: values.depth.filter(|_| planes.depth().is_some()),
                ..values
            };
            let area = planes.area();
            self.framebuffers.put_back(planes);
            let clear =
                WaitingClear { values, area, is_whole: true, is_fresh: true, is_new: true, is_asked: false };
            self.waiting_clear = Some(clear);
        } else {
            self.framebuffers.window.fill_depths(1.0);
        }
    }

    /// Makes a new window ready that is shown for the first time: with its depths, and if the program has cleared
    /// it already, with all that it asked for.
    pub(crate) fn settle_new_planes(&mut self) {
        let Some(clear) = self.waiting_clear.as_mut().filter(|clear| clear.is_new) else { return };
        if clear.is_asked {
            return self.settle_clear();
        }
        let depths = Clear { color: None, depth: clear.values.depth.take(), id: None, stencil: None };
        clear.is_new = false;
        let depths = WaitingClear { values: depths, ..*clear };
        self.do_clear(&depths);
    }

    /// The colour that all pixels of the window that is shown are still to be set to.
    pub(crate) fn shown_clear(&self) -> Option<[f32; 4]> {
        let clear = self.waiting_clear.filter(|_| self.clears_shown());
        clear.and_then(|clear| clear.values.color)
    }

    /// Whether what is drawn to is a window of one colour buffer, all of which waits to be cleared.
    pub(crate) fn clears_shown(&self) -> bool {
        let is_shown = self.framebuffers.draw == 0 && !self.framebuffers.config.double_buffered;
        is_shown && self.waiting_clear.is_some_and(|clear| clear.is_whole)
    }

    /// Does the clear that waits.
    pub(crate) fn settle_clear(&mut self) {
        if let Some(clear) = self.waiting_clear.take() {
            self.do_clear(&clear);
        }
    }

    fn do_clear(&mut self, clear: &WaitingClear) {
        let WaitingClear { values, area, .. } = *clear;
        let mut planes = self.framebuffers.take_planes();
        if let Some(color) = values.color.filter(|color| !clear.keeps(*color)) {
            planes.colors_mut().for_each(|plane| fill_color(plane, area, color, [true; 4]));
        }
        if let (Some(plane), Some(depth)) = (planes.depth(), values.depth) {
            fill_depth(plane, area, depth);
        }
        if let (Some(plane), Some(stencil)) = (planes.stencil(), values.stencil) {
            fill_stencil(plane, area, stencil, u8::MAX);
        }
        self.framebuffers.put_back(planes);
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
