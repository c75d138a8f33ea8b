//! Pictures of line drawings.

use rayon::prelude::*;
use senca_math::Control;
use senca_math::View;
use senca_math::glam::Vec4;
use senca_raster::{
    ColorPlane, ColorSource, Counters, FixedShading, Ids, Primitives, Shading as RasterShading, State, Target,
};
use senca_scene::Scene;

use super::{Segment, segments};
use crate::RenderError;
use crate::canvas::Canvas;
use crate::render::{Paper, bands, put_sample, rasterizer, sample_position};
use crate::report::{Report, timed};
use crate::settings::{Crop, Settings, Shading};
use crate::visibility::Window;

/// Draws the edges of `scene` into `area` of the picture.
pub(crate) fn draw(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    canvas: &mut Canvas<'_>,
    area: &Crop,
    control: &Control<'_>,
) -> Result<Report, RenderError> {
    let mut report = Report::default();
    let size = canvas.size;
    let hidden = settings.shading == Shading::HiddenLine;
    let lines =
        timed(&mut report.seconds.vertices, || segments(scene, view, settings, size, hidden, control))?;
    report.lines_drawn = lines.len() as u64;
    control.report(0.5);
    let mut seconds = 0.0;
    timed(&mut seconds, || {
        draw_segments(&lines, &Paper::new(scene, settings, view, size), settings, canvas, area, control)
    })?;
    report.seconds.raster = seconds;
    report.bands = bands(area, 0).len() as u32;
    Ok(report)
}

fn draw_segments(
    lines: &[Segment],
    paper: &Paper<'_>,
    settings: &Settings,
    canvas: &mut Canvas<'_>,
    area: &Crop,
    control: &Control<'_>,
) -> Result<Counters, RenderError> {
    let size = canvas.size;
    let mut counters = Counters::default();
    for band in bands(area, 0) {
        for s in 0..settings.samples {
            control.check()?;
            let window = Window { size, area: band, sample: sample_position(s, settings.samples) };
            let mut color = vec![[0.0; 4]; window.pixels()];
            counters += draw_sample(lines, settings, &window, paper, &mut color)?;
            resolve(canvas, &window, &color, 1.0 / settings.samples as f32, s == 0);
        }
        paper.finish(canvas, &band);
    }
    Ok(counters)
}

/// One sample of a band: paper, then lines.
fn draw_sample(
    lines: &[Segment],
    settings: &Settings,
    window: &Window,
    paper: &Paper<'_>,
    color: &mut [[f32; 4]],
) -> Result<Counters, RenderError> {
    let area = window.area;
    for (y, row) in color.chunks_mut(area.width as usize).enumerate() {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = paper.at(area.y + y as u32, || window.place(x, y).map(f64::from));
        }
    }
    let too_large = |_| RenderError::area_too_large(&area);
    let target = Target::new(area.width, area.height).and_then(|t| t.with_color(ColorPlane::Rgba32F(color)));
    let (positions, varyings) = vertices(lines, window);
    let indices: Vec<u32> = (0..positions.len() as u32).collect();
    let primitives = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 3,
        indices: &indices,
        ids: Ids::Same(0),
    };
    let state =
        State { viewport: Some(window.viewport()), line_width: settings.wire.width, ..State::default() };
    let shading = RasterShading::Fixed(FixedShading::new(ColorSource::Rgb { first: 0 }));
    Ok(rasterizer(settings).draw_lines(&mut target.map_err(too_large)?, &primitives, &state, &shading))
}

/// Clip-space ends of the lines, with their colours.
fn vertices(lines: &[Segment], window: &Window) -> (Vec<Vec4>, Vec<f32>) {
    let padded_from_clip = window.padded_from_clip();
    let scale = window.size.map(|s| 2.0 / f64::from(s));
    let mut positions = Vec::with_capacity(2 * lines.len());
    let mut varyings = Vec::with_capacity(6 * lines.len());
    for line in lines {
        for k in 0..2 {
            let [x, y] = line.ends[k];
            // Depth does not matter here; the middle is safe from the near and the far plane.
            let clip = senca_math::glam::DVec4::new(x * scale[0] - 1.0, 1.0 - y * scale[1], 0.5, 1.0);
            positions.push((padded_from_clip * clip).as_vec4());
            varyings.extend(line.colors[k].to_array());
        }
    }
    (positions, varyings)
}

/// Adds a sample to the picture.
fn resolve(canvas: &mut Canvas<'_>, window: &Window, color: &[[f32; 4]], weight: f32, first: bool) {
    let from = color.par_chunks(window.area.width as usize);
    let (rows, stride, columns) = canvas.rows(&window.area);
    rows.par_chunks_mut(stride).zip(from).for_each(|(row, from)| {
        let row = &mut row[columns.clone()];
        row.iter_mut().zip(from).for_each(|(pixel, &rgba)| put_sample(pixel, rgba, weight, first));
    });
}
