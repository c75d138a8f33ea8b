//! A rectangle of pixels of one kind, wherever it is kept.

use std::sync::Arc;

use crate::texture::{InternalFormat, Texels};

/// Samples of a pixel in a multisample buffer: a square of 2 x 2, kept as planes of twice the size.
pub(crate) const SAMPLES: u32 = 4;

/// Pixels of the window, of a renderbuffer or of a texture's image.
#[derive(Clone, Debug)]
pub(crate) struct Plane {
    /// What is kept; more than this plane if it is a slice of a volume.
    pub(crate) texels: Arc<Texels>,
    /// First texel of the plane.
    pub(crate) first: usize,
    /// Pixels in x.
    pub(crate) width: u32,
    /// Pixels in y.
    pub(crate) height: u32,
    /// 0 for one sample without multisampling, else [`SAMPLES`].
    pub(crate) samples: u32,
    pub(crate) format: InternalFormat,
}

impl Plane {
    /// A plane of its own; `None` if memory does not suffice.
    pub(crate) fn new(format: InternalFormat, width: u32, height: u32, samples: u32) -> Option<Self> {
        let side = side(samples);
        let count = (width as usize * side).checked_mul(height as usize * side)?;
        let texels = Arc::new(Texels::new(format, count)?);
        Some(Self { texels, first: 0, width, height, samples, format })
    }

    /// Samples along an axis of a pixel: 1 or 2.
    pub(crate) fn side(&self) -> usize {
        side(self.samples)
    }

    /// Texels of a row.
    pub(crate) fn stride(&self) -> usize {
        self.width as usize * self.side()
    }

    /// Rows of texels.
    pub(crate) fn rows(&self) -> usize {
        self.height as usize * self.side()
    }

    /// Number of the texel at column `x`, row `y`, both in texels.
    pub(crate) fn at(&self, x: usize, y: usize) -> usize {
        self.first + y * self.stride() + x
    }

    /// Texels of the plane.
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.stride() * self.rows()
    }

    /// Whether the texels are here.
    pub(crate) fn is_present(&self) -> bool {
        self.texels.len() >= self.range().end
    }

    /// The texels to be written; a copy is made first if somebody else holds on to them.
    pub(crate) fn texels_mut(&mut self) -> &mut Texels {
        Arc::make_mut(&mut self.texels)
    }
}

/// Samples along an axis of a pixel.
pub(crate) fn side(samples: u32) -> usize {
    if samples > 1 { 2 } else { 1 }
}

/// A rectangle of pixels: corners, the upper ones just outside. Empty if they do not rise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) x0: i32,
    pub(crate) y0: i32,
    pub(crate) x1: i32,
    pub(crate) y1: i32,
}

impl Area {
    /// From a corner and a size; beyond the range of numbers it is cut.
    pub(crate) fn of([x, y, width, height]: [i32; 4]) -> Self {
        Self { x0: x, y0: y, x1: x.saturating_add(width.max(0)), y1: y.saturating_add(height.max(0)) }
    }

    pub(crate) fn intersect(self, other: Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }

    /// Whether all of another one is in this.
    pub(crate) fn contains(self, other: Self) -> bool {
        self.intersect(other) == other
    }

    pub(crate) fn is_empty(self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// Columns, in units of `side` texels per pixel. The area must not be negative.
    pub(crate) fn columns(self, side: usize) -> std::ops::Range<usize> {
        self.x0 as usize * side..self.x1 as usize * side
    }

    /// Rows, likewise.
    pub(crate) fn lines(self, side: usize) -> std::ops::Range<usize> {
        self.y0 as usize * side..self.y1 as usize * side
    }
}

impl Plane {
    /// All of it.
    pub(crate) fn area(&self) -> Area {
        Area::of([0, 0, self.width as i32, self.height as i32])
    }
}
