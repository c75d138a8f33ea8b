//! What is drawn into: views of colour, depth, stencil and identifier planes, and an owner of them.

use crate::api::Rect;
use crate::block_depths::BlockDepths;
use crate::setup::Bounds;
use senca_math::Image;
use senca_math::conventions::{DEPTH_FAR, NO_ID};
use std::ops::Range;

/// Largest width or height of a target, in pixels. Leaves a rim inside the fixed-point range of
/// +-2^15 pixels about the middle.
pub const MAX_TARGET_SIDE: u32 = 65_408;

/// Why planes do not make a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TargetError {
    /// A side is longer than [`MAX_TARGET_SIDE`].
    #[error(
        "a target of {width} x {height} pixels is too large: a side may have {MAX_TARGET_SIDE} pixels at most"
    )]
    TooLarge {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// A plane does not have one element per pixel.
    #[error("a plane of {found} elements does not fit a target of {expected} pixels")]
    PlaneSize {
        /// Pixels of the target.
        expected: usize,
        /// Elements of the plane.
        found: usize,
    },
}

/// The colour plane of a [`Target`], row 0 on top.
#[derive(Debug)]
pub enum ColorPlane<'a> {
    /// Red, green, blue, alpha as they are; the layout of [`Image`].
    Rgba32F(&'a mut [[f32; 4]]),
    /// Red, green, blue, alpha, each clamped to [0, 1] and rounded to 8 bits; no encoding is applied.
    Rgba8(&'a mut [[u8; 4]]),
}

impl ColorPlane<'_> {
    /// Pieces of `pixels` pixels, the last with what is left.
    fn strips(&mut self, pixels: usize) -> Vec<ColorPlane<'_>> {
        match self {
            Self::Rgba32F(plane) => plane.chunks_mut(pixels).map(ColorPlane::Rgba32F).collect(),
            Self::Rgba8(plane) => plane.chunks_mut(pixels).map(ColorPlane::Rgba8).collect(),
        }
    }

    /// Fills some components of a range of pixels.
    fn fill_components(&mut self, range: Range<usize>, rgba: [f32; 4], components: [bool; 4]) {
        match self {
            Self::Rgba32F(plane) => fill_some(&mut plane[range], rgba, components),
            Self::Rgba8(plane) => fill_some(&mut plane[range], rgba8_from_rgba(rgba), components),
        }
    }
}

fn fill_some<T: Copy>(pixels: &mut [[T; 4]], rgba: [T; 4], components: [bool; 4]) {
    for pixel in pixels {
        for k in (0..4).filter(|&k| components[k]) {
            pixel[k] = rgba[k];
        }
    }
}

/// What a draw writes to: any combination of colour, depth, stencil and identifiers, of one size.
#[derive(Debug)]
pub struct Target<'a> {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) color: Option<ColorPlane<'a>>,
    pub(crate) depth: Option<&'a mut [f32]>,
    /// Depths kept in blocks, instead; only where [`crate::TiledRasterizer::draw_depths`] put them.
    pub(crate) blocks: Option<&'a mut BlockDepths>,
    pub(crate) stencil: Option<&'a mut [u8]>,
    pub(crate) ids: Option<&'a mut [u32]>,
}

/// The values of an empty target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clear {
    /// Colour; `None` leaves the plane. Default: transparent black.
    pub color: Option<[f32; 4]>,
    /// Depth; `None` leaves the plane. Default: 1, the far plane.
    pub depth: Option<f32>,
    /// Identifier; `None` leaves the plane. Default: [`NO_ID`].
    pub id: Option<u32>,
    /// Stencil value; `None` leaves the plane. Default: 0.
    pub stencil: Option<u8>,
}

impl Default for Clear {
    fn default() -> Self {
        Self { color: Some([0.0; 4]), depth: Some(DEPTH_FAR), id: Some(NO_ID), stencil: Some(0) }
    }
}

impl<'a> Target<'a> {
    /// A target without planes. Draws to it only count.
    ///
    /// # Errors
    /// [`TargetError::TooLarge`].
    pub fn new(width: u32, height: u32) -> Result<Self, TargetError> {
        if width.max(height) > MAX_TARGET_SIDE {
            return Err(TargetError::TooLarge { width, height });
        }
        Ok(Self { width, height, color: None, depth: None, blocks: None, stencil: None, ids: None })
    }

    /// A target that draws into a picture.
    ///
    /// # Errors
    /// [`TargetError::TooLarge`].
    pub fn of_image(image: &'a mut Image) -> Result<Self, TargetError> {
        Self::new(image.width(), image.height())?.with_color(ColorPlane::Rgba32F(image.pixels_mut()))
    }

    /// With a colour plane.
    ///
    /// # Errors
    /// [`TargetError::PlaneSize`].
    pub fn with_color(mut self, color: ColorPlane<'a>) -> Result<Self, TargetError> {
        self.check(match &color {
            ColorPlane::Rgba32F(p) => p.len(),
            ColorPlane::Rgba8(p) => p.len(),
        })?;
        self.color = Some(color);
        Ok(self)
    }

    /// With a depth plane; depths are 0 near to 1 far.
    ///
    /// # Errors
    /// [`TargetError::PlaneSize`].
    pub fn with_depth(mut self, depth: &'a mut [f32]) -> Result<Self, TargetError> {
        self.check(depth.len())?;
        self.depth = Some(depth);
        Ok(self)
    }

    /// With a stencil plane, which [`crate::FragmentStage`]s read and write.
    ///
    /// # Errors
    /// [`TargetError::PlaneSize`].
    pub fn with_stencil(mut self, stencil: &'a mut [u8]) -> Result<Self, TargetError> {
        self.check(stencil.len())?;
        self.stencil = Some(stencil);
        Ok(self)
    }

    /// With an identifier plane.
    ///
    /// # Errors
    /// [`TargetError::PlaneSize`].
    pub fn with_ids(mut self, ids: &'a mut [u32]) -> Result<Self, TargetError> {
        self.check(ids.len())?;
        self.ids = Some(ids);
        Ok(self)
    }

    /// Strips of `rows` rows, > 0, from top to bottom; the last has what is left.
    pub(crate) fn strips(&mut self, rows: usize) -> Vec<Target<'_>> {
        let (width, height) = (self.width, self.height as usize);
        let pixels = (rows * width as usize).max(1);
        let mut color = self.color.as_mut().map(|plane| plane.strips(pixels).into_iter());
        let mut depth = self.depth.as_mut().map(|plane| plane.chunks_mut(pixels));
        let mut stencil = self.stencil.as_mut().map(|plane| plane.chunks_mut(pixels));
        let mut ids = self.ids.as_mut().map(|plane| plane.chunks_mut(pixels));
        let strip = |i: usize| Target {
            width,
            height: rows.min(height - i * rows) as u32,
            color: color.as_mut().and_then(Iterator::next),
            depth: depth.as_mut().and_then(Iterator::next),
            blocks: None,
            stencil: stencil.as_mut().and_then(Iterator::next),
            ids: ids.as_mut().and_then(Iterator::next),
        };
        (0..height.div_ceil(rows)).map(strip).collect()
    }

    /// All pixels.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds { x0: 0, y0: 0, x1: self.width as i32, y1: self.height as i32 }
    }

    fn check(&self, found: usize) -> Result<(), TargetError> {
        let expected = self.width as usize * self.height as usize;
        if found == expected { Ok(()) } else { Err(TargetError::PlaneSize { expected, found }) }
    }

    /// Whether there is a depth plane.
    #[must_use]
    pub fn has_depth(&self) -> bool {
        self.depth.is_some() || self.blocks.is_some()
    }

    /// Whether there is a stencil plane.
    #[must_use]
    pub fn has_stencil(&self) -> bool {
        self.stencil.is_some()
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Fills the planes that are there.
    pub fn clear(&mut self, clear: &Clear) {
        if let (Some(plane), Some(rgba)) = (&mut self.color, clear.color) {
            match plane {
                ColorPlane::Rgba32F(p) => p.fill(rgba),
                ColorPlane::Rgba8(p) => p.fill(rgba8_from_rgba(rgba)),
            }
        }
        if let (Some(plane), Some(depth)) = (&mut self.depth, clear.depth) {
            plane.fill(depth);
        }
        if let (Some(plane), Some(stencil)) = (&mut self.stencil, clear.stencil) {
            plane.fill(stencil);
        }
        if let (Some(plane), Some(id)) = (&mut self.ids, clear.id) {
            plane.fill(id);
        }
    }

    /// Fills the planes inside a rectangle: of colours the components in `masks.color`, of stencil
    /// values the bits in `masks.stencil`.
    pub fn clear_masked(&mut self, clear: &Clear, area: Rect, masks: &ClearMasks) {
        let b = self.bounds().intersect(Bounds::of_rect(area));
        if b.is_empty() {
            return;
        }
        let partial = masks.color != [true; 4];
        for y in b.y0..b.y1 {
            let first = y as usize * self.width as usize;
            let row = first + b.x0 as usize..first + b.x1 as usize;
            if let (Some(plane), Some(rgba)) = (&mut self.color, clear.color.filter(|_| partial)) {
                plane.fill_components(row.clone(), rgba, masks.color);
            }
            if let (Some(plane), Some(value)) = (&mut self.stencil, clear.stencil) {
                let keep = !masks.stencil;
                plane[row.clone()].iter_mut().for_each(|v| *v = *v & keep | value & masks.stencil);
            }
            let color = clear.color.filter(|_| !partial);
            crate::pixel::clear_range(self, row, &Clear { color, stencil: None, ..*clear });
        }
    }
}

/// Which components [`Target::clear_masked`] writes. Default: all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClearMasks {
    /// Red, green, blue, alpha.
    pub color: [bool; 4],
    /// Bits of stencil values.
    pub stencil: u8,
}

impl Default for ClearMasks {
    fn default() -> Self {
        Self { color: [true; 4], stencil: u8::MAX }
    }
}

/// Each component clamped to [0, 1] and rounded to 8 bits; NaN becomes 0.
#[must_use]
#[inline]
pub fn rgba8_from_rgba([r, g, b, a]: [f32; 4]) -> [u8; 4] {
    let byte = |v: f32| {
        let low = if v > 0.0 { v } else { 0.0 };
        let clamped = if low < 1.0 { low } else { 1.0 };
        (clamped * 255.0 + 0.5) as u8
    };
    [byte(r), byte(g), byte(b), byte(a)]
}

/// Owned planes: a picture, depths and, if asked for, identifiers.
#[derive(Clone, Debug)]
pub struct Buffers {
    /// Linear colour.
    pub color: Image,
    /// Depths, row 0 on top.
    pub depth: Vec<f32>,
    /// Identifiers, row 0 on top; may be empty.
    pub ids: Vec<u32>,
    /// Stencil values, row 0 on top; may be empty.
    pub stencil: Vec<u8>,
}

impl Buffers {
    /// Colour transparent black, depth far, no identifier plane.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            color: Image::new(width, height, [0.0; 4]),
            depth: vec![DEPTH_FAR; pixels],
            ids: Vec::new(),
            stencil: Vec::new(),
        }
    }

    /// As [`Buffers::new`], with stencil values, all 0.
    #[must_use]
    pub fn with_stencil(width: u32, height: u32) -> Self {
        let stencil = vec![0; width as usize * height as usize];
        Self { stencil, ..Self::new(width, height) }
    }

    /// As [`Buffers::new`], with identifiers, all [`NO_ID`].
    #[must_use]
    pub fn with_ids(width: u32, height: u32) -> Self {
        let ids = vec![NO_ID; width as usize * height as usize];
        Self { ids, ..Self::new(width, height) }
    }

    /// A view to draw into.
    ///
    /// # Errors
    /// Those of [`Target`]; a plane may have been resized by hand.
    pub fn target(&mut self) -> Result<Target<'_>, TargetError> {
        let mut target = Target::of_image(&mut self.color)?.with_depth(&mut self.depth)?;
        if !self.stencil.is_empty() {
            target = target.with_stencil(&mut self.stencil)?;
        }
        if self.ids.is_empty() { Ok(target) } else { target.with_ids(&mut self.ids) }
    }
}
