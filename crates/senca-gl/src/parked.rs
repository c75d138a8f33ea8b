//! What waits to be drawn to a framebuffer while another one is drawn to.
//!
//! A program that draws a shadow map in the middle of a scene turns to the map's framebuffer and back. What it has drawn of the
//! scene before then goes on waiting, and is drawn together with what comes after: each tile passes through the
//! memory once, not twice. This is so where neither framebuffer knows anything of the other: the first has no textures
//! attached, the second nothing else, and what waits does not read them.

use crate::framebuffer::WaitingClear;
use crate::raster_state::Batch;
use crate::{Context, gl};
use std::sync::Arc;

/// What waits, and for which framebuffer.
#[derive(Debug)]
pub(crate) struct Parked {
    draw: u32,
    waiting: Vec<Batch>,
    clear: Option<WaitingClear>,
}

impl Context {
    /// Binds a framebuffer to be drawn to. What waits to be drawn to the one before goes on waiting if it may.
    pub(crate) fn turn_to_framebuffer(&mut self, name: u32) {
        let before = self.framebuffers.draw;
        if name == before {
            return;
        }
        if self.parked.as_ref().is_some_and(|parked| parked.draw == name) {
            // What has been drawn meanwhile may be read from now on.
            self.flush_bound();
            self.framebuffers.draw = name;
            return self.unpark();
        }
        self.set_aside();
        if self.may_park(name) {
            let (waiting, clear) = (std::mem::take(&mut self.waiting), self.waiting_clear.take());
            self.parked = Some(Parked { draw: before, waiting, clear });
        } else {
            self.flush_batch();
        }
        self.framebuffers.draw = name;
    }

    /// Draws what waits for another framebuffer than the one that is drawn to.
    pub(crate) fn draw_parked(&mut self) {
        let Some(parked) = &self.parked else { return };
        let bound = std::mem::replace(&mut self.framebuffers.draw, parked.draw);
        let (waiting, clear) = (std::mem::take(&mut self.waiting), self.waiting_clear.take());
        self.unpark();
        self.draw_waiting();
        self.settle_clear();
        self.framebuffers.draw = bound;
        (self.waiting, self.waiting_clear) = (waiting, clear);
    }

    fn unpark(&mut self) {
        if let Some(parked) = self.parked.take() {
            (self.waiting, self.waiting_clear) = (parked.waiting, parked.clear);
        }
    }

    /// Whether what waits can be drawn after what will be drawn to the framebuffer `name`.
    fn may_park(&self, name: u32) -> bool {
        let (now, f) = (self.framebuffers.draw_object(), &self.framebuffers);
        let Some(next) = f.objects.get_ref(name) else { return false };
        let apart = now.is_none_or(|object| object.attachments().all(|a| !a.is_texture()))
            && next.attachments().all(|a| a.is_texture());
        apart
            && self.parked.is_none()
            && !self.waiting.is_empty()
            && f.draw_status() == gl::FRAMEBUFFER_COMPLETE
            && !next.attachments().filter_map(|a| a.plane()).any(|plane| self.reads(&plane.texels))
    }

    /// Whether something that waits reads these texels.
    fn reads(&self, texels: &Arc<crate::texture::Texels>) -> bool {
        let units = self.waiting.iter().flat_map(|batch| &batch.state.units);
        let mut images = units.flat_map(|unit| unit.view.levels.iter().flatten());
        images.any(|image| Arc::ptr_eq(&image.texels, texels))
    }
}
