//! Bitmaps.

use crate::framebuffer::Area;
use crate::pixel::{PixelLayout, PixelSource, unorm8_from_f32};
use crate::texture::Texels;
use crate::{Context, Error, gl};

/// What the transformation of a raster position may lose, in pixels.
const ROUNDING: f32 = 1e-4;

impl Context {
    /// `glBitmap`: draws the set bits of an image in the colour of the raster position, with the bit at `origin` at
    /// that position; then moves the raster position by `advance` pixels. No bytes: only moves. Bits lie as the
    /// unpack state says.
    pub fn bitmap(
        &mut self,
        [width, height]: [i32; 2],
        origin: [f32; 2],
        advance: [f32; 2],
        bits: Option<&[u8]>,
    ) {
        let size = [width.max(0) as u32, height.max(0) as u32, 1];
        let store = self.pixels.store.unpack;
        let pixels = match bits {
            Some(bits) => PixelSource::new(bits, &store, PixelLayout::BITMAP, size, false)
                .map(Some)
                .ok_or(Error::InvalidOperation),
            None => Ok(None),
        };
        self.submit_pixels(pixels, move |c, pixels| {
            let checked = if width < 0 || height < 0 { Err(Error::InvalidValue) } else { Ok(()) };
            let result = checked.and(pixels);
            if let Some(source) = c.check(result) {
                c.put_bitmap(source, origin, advance);
            }
        });
    }

    fn put_bitmap(&mut self, source: Option<PixelSource<'_>>, origin: [f32; 2], advance: [f32; 2]) {
        if !self.state.current.raster.valid {
            return;
        }
        if self.may_draw_raster(gl::BITMAP_TOKEN)
            && let Some(source) = source
        {
            self.draw_bits(&source, origin);
        }
        let position = &mut self.state.current.raster.position;
        position[0] += advance[0];
        position[1] += advance[1];
    }

    fn draw_bits(&mut self, source: &PixelSource<'_>, origin: [f32; 2]) {
        let [x, y, ..] = self.state.current.raster.position;
        // A raster position that should be a whole number may come out a little less.
        let corner = [x - origin[0], y - origin[1]].map(|place| (place + ROUNDING).floor() as i32);
        let [width, height, _] = source.size();
        let covered = Area::of([corner[0], corner[1], width as i32, height as i32]);
        let clip = self.scissored(self.draw_area());
        let area = covered.intersect(clip);
        if area.is_empty() {
            return;
        }
        let skipped = (i64::from(area.x0) - i64::from(corner[0])) as usize;
        let rows = (area.y0..area.y1).map(|row| (row, (i64::from(row) - i64::from(corner[1])) as usize));
        let mut bits = vec![0; (area.x1 - area.x0) as usize];
        if self.draws_plainly() {
            return self.write_bits(source, area, skipped, rows);
        }
        for (row, y) in rows {
            source.indices(0, y, skipped, &mut bits);
            self.draw_row([area.x0, row], bits.len(), None, None, |i| bits[i] != 0);
        }
    }

    /// Writes the colour where nothing can happen to it on the way.
    fn write_bits(
        &mut self,
        source: &PixelSource<'_>,
        area: Area,
        skipped: usize,
        rows: impl Iterator<Item = (i32, usize)> + Clone,
    ) {
        self.settle_planes();
        let color = self.state.current.raster.color;
        let mut bits = vec![0; (area.x1 - area.x0) as usize];
        let mut planes = self.framebuffers.take_planes();
        let mut count = 0;
        for plane in planes.colors_mut().filter(|plane| plane.is_present()) {
            let color = plane.format.base().stored(color, 1.0);
            for (row, y) in rows.clone() {
                source.indices(0, y, skipped, &mut bits);
                let at = plane.at(area.x0 as usize, row as usize);
                let set = (at..).zip(&bits).filter(|(_, bit)| **bit != 0).map(|(at, _)| at);
                count += bits.iter().filter(|bit| **bit != 0).count() as u64;
                match plane.texels_mut() {
                    Texels::Rgba8(colors) => set.for_each(|at| colors[at] = color.map(unorm8_from_f32)),
                    Texels::Rgba32F(colors) => set.for_each(|at| colors[at] = color),
                    _ => {}
                }
            }
        }
        let planes_drawn = planes.color_count().max(1) as u64;
        self.framebuffers.put_back(planes);
        self.queries.add(count / planes_drawn);
    }
}
