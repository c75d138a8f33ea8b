//! Where the pixels of an image come to lie in the window.

use crate::framebuffer::Area;

/// The pixels of the window that an image covers, and which of its pixels each shows.
///
/// Pixel n of a row covers x + zoom n to x + zoom (n + 1), and shows in those pixels whose centres lie in there; on
/// the border between two the right one, for a positive zoom.
///
/// Source: OpenGL 1.5, section 3.6.4, "Conversion to Fragments".
#[derive(Clone, Debug)]
pub(super) struct Placement {
    /// Pixels of the window.
    pub(super) area: Area,
    /// Column of the image for each column of the area.
    pub(super) columns: Vec<usize>,
    /// Row of the image for each row of the area.
    pub(super) rows: Vec<usize>,
}

impl Placement {
    /// Places an image of `size` with a corner at (`x`, `y`). `None` if nothing of it lies within `clip`.
    pub(super) fn new(origin: [f32; 2], zoom: [f32; 2], size: [u32; 2], clip: Area) -> Option<Self> {
        if clip.is_empty() {
            return None;
        }
        let (x0, columns) = axis(origin[0], zoom[0], size[0], clip.x0, clip.x1)?;
        let (y0, rows) = axis(origin[1], zoom[1], size[1], clip.y0, clip.y1)?;
        let area = Area { x0, y0, x1: x0 + columns.len() as i32, y1: y0 + rows.len() as i32 };
        Some(Self { area, columns, rows })
    }

    /// Whether columns follow one another as in the image.
    pub(super) fn keeps_columns(&self) -> bool {
        self.columns.windows(2).all(|pair| pair[1] == pair[0] + 1)
    }
}

/// First pixel of the window and the pixels of the image for it and those behind.
fn axis(origin: f32, zoom: f32, count: u32, low: i32, high: i32) -> Option<(i32, Vec<usize>)> {
    let (origin, zoom) = (f64::from(origin), f64::from(zoom));
    if count == 0 || zoom == 0.0 || !zoom.is_finite() || !origin.is_finite() {
        return None;
    }
    let end = origin + zoom * f64::from(count);
    let first = (origin.min(end).floor() as i32).saturating_sub(1).max(low);
    let last = (origin.max(end).ceil() as i32).saturating_add(1).min(high);
    let source = |pixel: i32| {
        let n = ((f64::from(pixel) + 0.5 - origin) / zoom).floor();
        (n >= 0.0 && n < f64::from(count)).then_some(n as usize)
    };
    let begin = (first..last).find(|pixel| source(*pixel).is_some())?;
    Some((begin, (begin..last).map_while(source).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLIP: Area = Area { x0: 0, y0: 0, x1: 10, y1: 10 };

    fn columns(origin: f32, zoom: f32, count: u32) -> Option<(i32, Vec<usize>)> {
        axis(origin, zoom, count, CLIP.x0, CLIP.x1)
    }

    #[test]
    fn pixels_show_where_their_centres_are_covered() {
        assert_eq!(columns(2.0, 1.0, 3), Some((2, vec![0, 1, 2])));
        assert_eq!(columns(2.5, 1.0, 3), Some((2, vec![0, 1, 2])));
        assert_eq!(columns(2.6, 1.0, 3), Some((3, vec![0, 1, 2])));
        assert_eq!(columns(2.0, 2.0, 2), Some((2, vec![0, 0, 1, 1])));
        assert_eq!(columns(2.0, 0.5, 4), Some((2, vec![1, 3])));
        assert_eq!(columns(5.0, -1.0, 3), Some((2, vec![2, 1, 0])));
        assert_eq!(columns(5.0, -2.0, 2), Some((1, vec![1, 1, 0, 0])));
        assert_eq!(columns(-1.0, 1.0, 3), Some((0, vec![1, 2])));
        assert_eq!(columns(8.0, 1.0, 30), Some((8, vec![0, 1])));
        assert_eq!(columns(10.0, 1.0, 3), None);
        assert_eq!(columns(0.0, 0.0, 3), None);
        assert_eq!(columns(f32::NAN, 1.0, 3), None);
        assert_eq!(columns(1e30, 1e30, 3), None);
    }

    proptest::proptest! {
        /// Each pixel of the window whose centre an image covers shows the pixel that covers it.
        #[test]
        fn every_centre_is_found(origin in -12.0_f32..12.0, zoom in -3.0_f32..3.0, count in 1_u32..9) {
            let (begin, found) = columns(origin, zoom, count).unwrap_or((0, Vec::new()));
            for pixel in 0..10 {
                let centre = f64::from(pixel) + 0.5;
                let covers = |n: &u32| {
                    let edge = |n: u32| f64::from(origin) + f64::from(zoom) * f64::from(n);
                    let (a, b) = (edge(*n), edge(n + 1));
                    centre > a.min(b) && centre < a.max(b)
                };
                let shown = usize::try_from(pixel - begin).ok().and_then(|i| found.get(i)).copied();
                if let Some(n) = (0..count).find(covers) {
                    proptest::prop_assert_eq!(shown, Some(n as usize));
                }
            }
        }
    }
}
