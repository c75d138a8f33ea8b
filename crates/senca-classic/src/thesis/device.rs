//! The one thing that the renderer wants of a device.

use senca_io::classic::IndexBitmap;

/// Sets pixels to colour indices. x counts from the left, y from the top; outside of the device
/// nothing happens. Source: 1991 thesis, section 1.
pub trait SetPixel {
    /// Gives a pixel a colour index.
    fn set_pixel(&mut self, x: i32, y: i32, index: u32);
}

impl SetPixel for IndexBitmap {
    fn set_pixel(&mut self, x: i32, y: i32, index: u32) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
        if x < self.width && y < self.height {
            let place = x as usize * self.height as usize + y as usize;
            if let Some(pixel) = self.indices.get_mut(place) {
                *pixel = index;
            }
        }
    }
}

/// A bitmap of background.
pub(super) fn empty_bitmap(width: u32, height: u32) -> IndexBitmap {
    IndexBitmap { width, height, indices: vec![0; width as usize * height as usize] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_go_column_by_column_and_stay_inside() {
        let mut bitmap = empty_bitmap(2, 3);
        bitmap.set_pixel(1, 2, 9);
        for (x, y) in [(-1, 0), (2, 0), (0, 3), (0, -1), (i32::MAX, i32::MIN)] {
            bitmap.set_pixel(x, y, 7);
        }
        assert_eq!(bitmap.indices, [0, 0, 0, 0, 0, 9]);
    }
}
