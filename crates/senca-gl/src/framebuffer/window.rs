//! The buffers of the window.

use super::accum::Accumulation;
use super::plane::Plane;
use crate::texture::{InternalFormat, Texels};
use crate::{Config, gl};
use std::ops::Range;
use std::sync::Arc;

/// The window's buffers: a front and perhaps a back colour buffer, depth and stencil as configured.
#[derive(Debug)]
pub(crate) struct Window {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Front, then back if there are two.
    pub(crate) colors: Vec<Plane>,
    /// Depths, stencil values, or both.
    pub(crate) depth_stencil: Option<Plane>,
    pub(crate) accumulation: Option<Accumulation>,
    /// Rows in which pixels may have changed since somebody asked.
    changed: Range<u32>,
}

impl Window {
    pub(crate) const NONE: Self = Self {
        width: 0,
        height: 0,
        colors: Vec::new(),
        depth_stencil: None,
        accumulation: None,
        changed: 0..0,
    };

    /// Buffers of a size, all zeros; `None` if memory does not suffice.
    pub(crate) fn new(config: Config, width: u32, height: u32) -> Option<Self> {
        let color =
            InternalFormat::for_renderbuffer(if config.float_color { gl::RGBA16 } else { gl::RGBA8 })?;
        let count = if config.double_buffered { 2 } else { 1 };
        let colors = (0..count).map(|_| Plane::new(color, width, height, 0)).collect::<Option<_>>()?;
        let token = match (config.depth_bits > 0, config.stencil_bits > 0) {
            (true, true) => Some(gl::DEPTH24_STENCIL8),
            (true, false) => Some(gl::DEPTH_COMPONENT24),
            (false, true) => Some(gl::STENCIL_INDEX8),
            (false, false) => None,
        };
        let depth_stencil = match token.and_then(InternalFormat::for_renderbuffer) {
            Some(format) => Some(Plane::new(format, width, height, 0)?),
            None => None,
        };
        let accumulation = match config.accum_bits {
            0 => None,
            _ => Some(Accumulation::new(width, height)?),
        };
        Some(Self { width, height, colors, depth_stencil, accumulation, changed: 0..height })
    }

    /// Gives all pixels a depth.
    pub(crate) fn fill_depths(&mut self, depth: f32) {
        let plane = self.depth_stencil.as_mut();
        if let Some(depths) = plane.and_then(|plane| plane.texels_mut().depths_mut()) {
            depths.fill(depth);
        }
    }

    /// Exchanges front and back buffer, if there are two.
    pub(crate) fn swap(&mut self) {
        if let [front, back] = &mut self.colors[..] {
            std::mem::swap(front, back);
            self.changed = 0..self.height;
        }
    }

    /// Says that pixels of some rows may change.
    pub(crate) fn note_changed(&mut self, rows: Range<u32>) {
        let (start, end) = (rows.start.min(self.height), rows.end.min(self.height));
        if start < end {
            let all = if self.changed.is_empty() { start..end } else { self.changed.clone() };
            self.changed = all.start.min(start)..all.end.max(end);
        }
    }

    /// Rows in which pixels may have changed since this was last asked.
    pub(crate) fn take_changed(&mut self) -> Range<u32> {
        std::mem::replace(&mut self.changed, 0..0)
    }

    /// The colour buffer that the window shows.
    pub(crate) fn front(&self) -> Option<&Arc<Texels>> {
        self.colors.first().map(|plane| &plane.texels)
    }
}
