//! Rows between the two sets, behind a z-buffer (sections 2 and 4).

use senca_window::Canvas;

use super::edges::{EdgeRow, EdgeSets, gouraud};
use super::{ScreenVertex, Slips};

/// A pixel that nothing was drawn on yet.
const NOTHING: i32 = i32::MAX;

/// How often pixels were written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteCounts {
    /// Pixels that the polygon covers.
    pub covered: u64,
    /// Those of them that were nearer than what was there.
    pub written: u64,
}

/// Depth and intensity of each pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolygonPicture {
    width: u32,
    height: u32,
    depth: Vec<i32>,
    intensity: Vec<i32>,
}

impl PolygonPicture {
    /// A picture with nothing on it.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, depth: vec![NOTHING; pixels], intensity: vec![0; pixels] }
    }

    /// Draws a convex polygon. Of two points as near, the first drawn stays.
    pub fn draw(&mut self, polygon: &[ScreenVertex], slips: &Slips) -> WriteCounts {
        let mut counts = WriteCounts::default();
        let turned: Vec<ScreenVertex>;
        let mut corners = polygon;
        if !slips.one_orientation && doubled_area(polygon) < 0 {
            turned = polygon.iter().rev().copied().collect();
            corners = &turned;
        }
        for row in EdgeSets::of(corners, slips).rows() {
            self.draw_row(&row, slips, &mut counts);
        }
        counts
    }

    fn draw_row(&mut self, row: &EdgeRow, slips: &Slips, counts: &mut WriteCounts) {
        let Ok(y) = u32::try_from(row.y) else { return };
        let (left, right) = (row.left, row.right);
        if y >= self.height || right.x < left.x {
            return;
        }
        let (a, b) = ([left.x, left.y], [right.x, right.y]);
        let end = if slips.same_end_twice { a } else { b };
        let across = |x: i32, from: i32, to: i32| gouraud(a, end, [x, row.y], from, to, slips);
        let last = right.x.min(self.width.min(i32::MAX as u32) as i32 - 1);
        for x in left.x.max(0)..=last {
            let place = y as usize * self.width as usize + x as usize;
            counts.covered += 1;
            let z = across(x, left.z, right.z);
            if z < self.depth[place] {
                counts.written += 1;
                self.depth[place] = z;
                self.intensity[place] = across(x, left.b, right.b);
            }
        }
    }

    /// Depth and intensity of a pixel; none where nothing was drawn, and outside.
    #[must_use]
    pub fn get(&self, x: i32, y: i32) -> Option<(i32, i32)> {
        let (x, y) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        let place = y as usize * self.width as usize + x as usize;
        let inside = x < self.width && y < self.height && self.depth[place] != NOTHING;
        inside.then(|| (self.depth[place], self.intensity[place]))
    }

    /// Number of pixels drawn on, sum of their depths and sum of their intensities.
    #[must_use]
    pub fn sums(&self) -> (u64, i64, i64) {
        let drawn = self.depth.iter().zip(&self.intensity).filter(|(z, _)| **z != NOTHING);
        drawn.fold((0, 0, 0), |(n, z, b), pixel| (n + 1, z + i64::from(*pixel.0), b + i64::from(*pixel.1)))
    }

    /// The intensities as greys, `background` where nothing was drawn.
    #[must_use]
    pub fn greys(&self, background: u32) -> Canvas {
        self.canvas(background, |_, b| b)
    }

    /// The depths as greys: white in front, dark behind.
    #[must_use]
    pub fn depths(&self, background: u32) -> Canvas {
        let drawn = || self.depth.iter().copied().filter(|&z| z != NOTHING).map(i64::from);
        let (near, far) = (drawn().min().unwrap_or(0), drawn().max().unwrap_or(0));
        let grey = |z: i32| 255 - 191 * (i64::from(z) - near) / (far - near).max(1);
        self.canvas(background, |z, _| grey(z) as i32)
    }

    fn canvas(&self, background: u32, grey: impl Fn(i32, i32) -> i32) -> Canvas {
        let mut canvas = Canvas::new(self.width as usize, self.height as usize);
        let pixels = self.depth.iter().zip(&self.intensity);
        for (pixel, (&z, &b)) in canvas.pixels_mut().iter_mut().zip(pixels) {
            let level = grey(z, b).clamp(0, 255) as u32;
            *pixel = if z == NOTHING { background } else { level * 0x01_0101 };
        }
        canvas
    }
}

/// Twice the area; positive for polygons that run clockwise on the screen, y being down.
fn doubled_area(polygon: &[ScreenVertex]) -> i128 {
    let pairs = polygon.iter().zip(polygon.iter().cycle().skip(1));
    pairs.map(|(a, b)| i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y)).sum()
}
