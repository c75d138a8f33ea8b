//! The off-screen picture: one byte a pixel, rows one after the other.

/// A picture of colour numbers (`G_buffer`).
///
/// The first byte is the pixel at the top left; x is to the right, y down, and pixel `(x, y)` is byte `y * width + x`.
/// (The text calls the first byte the rightmost one; its formula and figure have it on the left.)
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColorMap {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

/// Largest width and height of a picture.
pub const LARGEST_SIDE: usize = 1 << 14;

impl ColorMap {
    /// A picture of colour 0; sides above [`LARGEST_SIDE`] are cut to that.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let (width, height) = (width.min(LARGEST_SIDE), height.min(LARGEST_SIDE));
        Self { width, height, pixels: vec![0; width * height] }
    }

    /// Pixels in a row (`HW_SCREEN_X_SIZE`).
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows (`HW_SCREEN_Y_SIZE`).
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// All bytes.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// All bytes, to be written.
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The colour of a pixel; none outside.
    #[must_use]
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        self.address(x, y).map(|a| self.pixels[a])
    }

    /// Sets one pixel (`G_dot`); outside nothing happens.
    pub fn dot(&mut self, x: i32, y: i32, color: u8) {
        if let Some(address) = self.address(x, y) {
            self.pixels[address] = color;
        }
    }

    /// The byte of a pixel. Taken as unsigned, a negative coordinate is a large one: two comparisons in place of four.
    pub(crate) fn address(&self, x: i32, y: i32) -> Option<usize> {
        let (x, y) = (x.cast_unsigned() as usize, y.cast_unsigned() as usize);
        (x < self.width && y < self.height).then(|| y * self.width + x)
    }

    /// The pixels of a row from `start` to `end`, both included; nothing where they do not all lie in the picture.
    pub(crate) fn span(&mut self, y: i32, start: i32, end: i32) -> &mut [u8] {
        match (self.address(start, y), self.address(end, y)) {
            (Some(first), Some(last)) if first <= last => &mut self.pixels[first..=last],
            _ => &mut [],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_stay_in_the_picture() {
        let mut map = ColorMap::new(4, 3);
        for (x, y) in [(-1, 0), (4, 0), (0, -1), (0, 3), (i32::MIN, 1), (1, i32::MAX), (-4, 1)] {
            map.dot(x, y, 9);
            assert_eq!(map.get(x, y), None);
        }
        assert!(map.pixels().iter().all(|&p| p == 0));
        map.dot(3, 2, 9);
        assert_eq!(map.pixels()[2 * 4 + 3], 9);
        assert!(map.span(1, 2, 4).is_empty() && map.span(1, 3, 2).is_empty());
        assert_eq!(map.span(1, 0, 3).len(), 4);
    }
}
