//! Images that hold a picture, or the part of one that is wanted.

use std::ops::Range;

use senca_math::Image;

use crate::settings::Crop;

/// Where a picture is drawn.
pub(crate) struct Canvas<'i> {
    image: &'i mut Image,
    /// Size of the whole picture.
    pub(crate) size: [u32; 2],
    /// Column and row of the picture at which the image begins.
    origin: [u32; 2],
}

impl<'i> Canvas<'i> {
    /// All of a picture.
    pub(crate) fn whole(image: &'i mut Image) -> Self {
        Self { size: [image.width(), image.height()], origin: [0, 0], image }
    }

    /// The part `area` of a picture of `size`; the image is as large as that.
    pub(crate) fn part(image: &'i mut Image, size: [u32; 2], area: &Crop) -> Self {
        Self { size, origin: [area.x, area.y], image }
    }

    /// The image's rows that hold `area` of the picture, how many pixels each has, and which of these
    /// are the area's.
    pub(crate) fn rows(&mut self, area: &Crop) -> (&mut [[f32; 4]], usize, Range<usize>) {
        let stride = self.image.width() as usize;
        let (x, y) = ((area.x - self.origin[0]) as usize, (area.y - self.origin[1]) as usize);
        let rows = y * stride..(y + area.height as usize) * stride;
        (&mut self.image.pixels_mut()[rows], stride, x..x + area.width as usize)
    }
}
