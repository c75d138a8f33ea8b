//! Reading pixels.

use crate::framebuffer::{Area, Aspect, Plane};
use crate::pixel::{PixelFormat, PixelLayout, PixelSink, RowSink, Transfer};
use crate::texture::Texels;
use crate::{Context, Enum, Error};

/// Pixels converted at a time.
const BATCH: usize = 128;

impl Context {
    /// `glReadPixels`: writes a rectangle of the framebuffer into client memory as the pack state says. What lies
    /// outside the framebuffer, and bytes between rows, stay as they are.
    pub fn read_pixels(
        &mut self,
        [x, y]: [i32; 2],
        size: [i32; 2],
        format: Enum,
        ty: Enum,
        bytes: &mut [u8],
    ) {
        self.ask(|c| {
            let result = c.read_into([x, y], size, format, ty, bytes);
            c.check(result);
        });
    }

    fn read_into(
        &mut self,
        [x, y]: [i32; 2],
        [width, height]: [i32; 2],
        format: Enum,
        ty: Enum,
        bytes: &mut [u8],
    ) -> Result<(), Error> {
        let layout = PixelLayout::new(format, ty)?;
        if width < 0 || height < 0 {
            return Err(Error::InvalidValue);
        }
        let planes = self.planes_to_read(layout.format())?;
        let size = [width as u32, height as u32, 1];
        let sink = PixelSink::new(bytes, &self.pixels.store.pack, layout, size, false);
        let mut sink = sink.ok_or(Error::InvalidOperation)?;
        let area = Area::of([x, y, width, height]).intersect(planes[0].area());
        if area.is_empty() || !planes.iter().all(Plane::is_present) {
            return Ok(());
        }
        let transfer = self.transfer();
        let below = |a: i32, b: i32| (i64::from(a) - i64::from(b)) as usize;
        let (first, count, column) = (below(area.y0, y), below(area.y1, area.y0), below(area.x0, x));
        sink.each_row(0, first..first + count, |row, sink| {
            let from = planes[0].at(area.x0 as usize, area.y0 as usize + row - first);
            let run = from..from + below(area.x1, area.x0);
            read_row(&planes, run, layout.format(), &transfer, column, sink);
        });
        Ok(())
    }

    /// Planes that pixels of a format come from.
    fn planes_to_read(&mut self, format: PixelFormat) -> Result<Vec<Plane>, Error> {
        let aspects: &[Aspect] = match format {
            // There are no colour indices in the framebuffer.
            PixelFormat::ColorIndex => return Err(Error::InvalidOperation),
            PixelFormat::StencilIndex => &[Aspect::Stencil],
            PixelFormat::DepthComponent => &[Aspect::Depth],
            PixelFormat::DepthStencil => &[Aspect::Depth, Aspect::Stencil],
            _ => &[Aspect::Color],
        };
        aspects.iter().map(|aspect| self.read_plane(*aspect)).collect()
    }
}

fn read_row(
    planes: &[Plane],
    run: std::ops::Range<usize>,
    format: PixelFormat,
    transfer: &Transfer<'_>,
    column: usize,
    mut sink: RowSink<'_>,
) {
    let texels = &*planes[0].texels;
    match (format, texels) {
        (PixelFormat::DepthStencil, _) => {
            let (Some(depths), Some(stencils)) = (texels.depths(), planes[1].texels.stencils()) else {
                return;
            };
            let mut depths = depths[run.clone()].to_vec();
            transfer.depths(&mut depths);
            let mut values: Vec<u32> = stencils[run].iter().map(|s| u32::from(*s)).collect();
            transfer.stencils(&mut values);
            let stencils: Vec<u8> = values.into_iter().map(|s| s as u8).collect();
            sink.put_depth_stencils(column, &depths, &stencils);
        }
        (PixelFormat::DepthComponent, _) => {
            let Some(depths) = texels.depths() else { return };
            if transfer.keeps_depths() {
                return sink.put_depths(column, &depths[run]);
            }
            let mut depths = depths[run].to_vec();
            transfer.depths(&mut depths);
            sink.put_depths(column, &depths);
        }
        (PixelFormat::StencilIndex, _) => {
            let Some(stencils) = texels.stencils() else { return };
            let mut values: Vec<u32> = stencils[run].iter().map(|s| u32::from(*s)).collect();
            transfer.stencils(&mut values);
            sink.put_indices(column, &values);
        }
        (_, Texels::Rgba8(colors)) if transfer.keeps_colors() => sink.put_colors8(column, &colors[run]),
        _ => {
            for (i, batch) in (run.start..).step_by(BATCH).take_while(|at| *at < run.end).enumerate() {
                let mut colors = [[0.0; 4]; BATCH];
                let colors = &mut colors[..BATCH.min(run.end - batch)];
                (batch..).zip(colors.iter_mut()).for_each(|(at, color)| *color = texels.color(at));
                transfer.colors(colors);
                sink.put_colors(column + i * BATCH, colors);
            }
        }
    }
}
