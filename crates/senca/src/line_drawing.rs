//! From a scene to a line drawing.

use std::borrow::Cow;
use std::time::Instant;

use senca_io::svg::{Drawing, Line, encode};
use senca_math::LinearRgb;
use senca_pipeline::{Control, RenderError, Segment, Shading, hidden_line_segments, wire_segments};
use senca_scene::{Background, Scene};

use crate::prepare::{default_background, prepare};
use crate::render::drawing_settings;
use crate::{Error, Report, Settings};

/// The scene's edges as the text of an SVG file, with its size in pixels. The settings' shading says
/// which edges; those that show faces count as [`Shading::Wire`].
///
/// # Errors
/// See [`Error`].
pub fn render_svg(
    scene: Cow<'_, Scene>,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<(String, [u32; 2], Report), Error> {
    let start = Instant::now();
    let prepared = prepare(scene, settings)?;
    let prepare_seconds = start.elapsed().as_secs_f64();
    let mut wish = settings.clone();
    if !wish.drawing.shading.is_lines() {
        wish.drawing.shading = Shading::Wire;
    }
    let drawing = drawing_settings(&prepared, &wish);
    let [width, height] = prepared.size;
    let find = if drawing.shading == Shading::HiddenLine { hidden_line_segments } else { wire_segments };
    let segments = find(&prepared.scene, &prepared.view, &drawing, width, height)?;
    if control.cancel.is_some_and(|c| c.load(std::sync::atomic::Ordering::Relaxed)) {
        return Err(RenderError::Cancelled.into());
    }
    let mut report = Report { prepare_seconds, ..Report::default() };
    report.drawing.lines_drawn = segments.len() as u64;
    let crop = settings.crop.unwrap_or(senca_pipeline::Crop { x: 0, y: 0, width, height });
    let svg = encode(&Drawing {
        corner: [crop.x, crop.y].map(f64::from),
        size: [crop.width, crop.height].map(f64::from),
        background: drawing.background.and_then(paper),
        line_width: f64::from(drawing.wire.width),
        lines: segments.iter().map(line).collect(),
    });
    Ok((svg, [crop.width, crop.height], report))
}

/// The colour of the paper. A drawing has one; a gradient or an environment becomes white.
fn paper(background: Background) -> Option<LinearRgb> {
    match background {
        Background::None => None,
        Background::Color(color) => Some(color),
        Background::Gradient { .. } | Background::Environment { .. } => match default_background(true) {
            Background::Color(color) => Some(color),
            _ => None,
        },
    }
}

/// A line of one colour: in fog the mean of its ends.
fn line(segment: &Segment) -> Line {
    Line { ends: segment.ends, color: segment.colors[0].lerp(segment.colors[1], 0.5) }
}
