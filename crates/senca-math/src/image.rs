//! The picture that renderers fill.

use crate::LinearRgb;

/// A picture in linear light with coverage, row 0 on top, pixels in row order.
///
/// Each pixel is `[r, g, b, a]` in linear sRGB primaries with alpha *not* multiplied in; alpha 1 is
/// opaque. Encoding for a display happens when the picture is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 4]>,
}

impl Image {
    /// Largest width or height, in pixels: 2^16, so that a pixel count always fits `u64` and a
    /// coordinate fits the rasterizers' fixed point.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// A picture of one colour. A side of 0 gives an empty picture.
    #[must_use]
    pub fn new(width: u32, height: u32, fill: [f32; 4]) -> Self {
        Self { width, height, pixels: vec![fill; width as usize * height as usize] }
    }

    /// A picture from its pixels in row order; `None` when the count is not `width * height`.
    #[must_use]
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 4]>) -> Option<Self> {
        (pixels.len() == width as usize * height as usize).then_some(Self { width, height, pixels })
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

    /// All pixels, row 0 (the top) first.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// All pixels, to be written.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 4]] {
        &mut self.pixels
    }

    /// Row `y` from the top.
    ///
    /// # Panics
    /// When `y` is not below the height.
    #[must_use]
    pub fn row(&self, y: u32) -> &[[f32; 4]] {
        let w = self.width as usize;
        &self.pixels[y as usize * w..][..w]
    }

    /// Pixel at column `x`, row `y` from the top.
    ///
    /// # Panics
    /// When the position is outside.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 4] {
        self.row(y)[x as usize]
    }

    /// Colour at column `x`, row `y`, without its alpha.
    ///
    /// # Panics
    /// When the position is outside.
    #[must_use]
    pub fn color(&self, x: u32, y: u32) -> LinearRgb {
        let [r, g, b, _] = self.pixel(x, y);
        LinearRgb::new(r, g, b)
    }

    /// Writes one pixel.
    ///
    /// # Panics
    /// When the position is outside.
    pub fn set_pixel(&mut self, x: u32, y: u32, pixel: [f32; 4]) {
        let w = self.width as usize;
        assert!((x as usize) < w, "column {x} of a picture {w} wide");
        self.pixels[y as usize * w + x as usize] = pixel;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_run_from_the_top() {
        let mut image = Image::new(3, 2, [0.0; 4]);
        image.set_pixel(2, 1, [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(image.row(1)[2], [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(image.pixels()[5], image.pixel(2, 1));
        assert_eq!(image.color(2, 1), LinearRgb::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn pixel_count_must_fit() {
        assert!(Image::from_pixels(2, 2, vec![[0.0; 4]; 3]).is_none());
    }
}
