//! The picture of a program.

/// A picture of `width` x `height` pixels, row 0 on top, each pixel `0x00RRGGBB`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u32>,
}

impl Canvas {
    /// A black picture.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![0; width * height] }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// All pixels, to be written.
    pub fn pixels_mut(&mut self) -> &mut [u32] {
        &mut self.pixels
    }

    /// Gives every pixel one colour.
    pub fn fill(&mut self, color: u32) {
        self.pixels.fill(color);
    }

    /// The colour of a pixel; none outside of the picture.
    #[must_use]
    pub fn get(&self, x: i32, y: i32) -> Option<u32> {
        self.index(x, y).map(|i| self.pixels[i])
    }

    /// Colours a pixel; outside of the picture nothing happens.
    pub fn set(&mut self, x: i32, y: i32, color: u32) {
        if let Some(i) = self.index(x, y) {
            self.pixels[i] = color;
        }
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < self.width && y < self.height).then(|| y * self.width + x)
    }
}

#[cfg(test)]
mod tests {
    use super::Canvas;

    #[test]
    fn outside_of_the_picture_is_nothing() {
        let mut canvas = Canvas::new(3, 2);
        for (x, y) in [(-1, 0), (3, 0), (0, -1), (0, 2), (i32::MIN, i32::MAX)] {
            canvas.set(x, y, 0xff_ffff);
            assert_eq!(canvas.get(x, y), None);
        }
        assert!(canvas.pixels().iter().all(|&p| p == 0));
        canvas.set(2, 1, 7);
        assert_eq!(canvas.pixels(), [0, 0, 0, 0, 0, 7]);
    }
}
