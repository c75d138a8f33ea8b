//! From a scene to a picture in one call.

use std::borrow::Cow;
use std::time::Instant;

use senca_math::Image;
use senca_pipeline::Control;
use senca_scene::{Background, Scene};

use crate::prepare::{Prepared, default_background, prepare};
use crate::{Error, Settings};

/// Counters and times of one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Seconds for pose, camera and light.
    pub prepare_seconds: f64,
    /// What the pipeline tells.
    pub drawing: senca_pipeline::Report,
}

/// Draws `scene` into a new picture.
///
/// A scene without a camera is framed whole, one without light gets some, one without a background
/// is seen before a quiet grey (before white in line drawings).
///
/// # Errors
/// See [`Error`].
pub fn render(scene: &Scene, settings: &Settings) -> Result<(Image, Report), Error> {
    render_with(Cow::Borrowed(scene), settings, &Control::default())
}

/// [`render`] with progress and cancellation. A scene that is given away is not copied where it has
/// to be changed.
///
/// # Errors
/// See [`Error`]; [`RenderError::Cancelled`](senca_pipeline::RenderError::Cancelled) when the control
/// says so.
pub fn render_with(
    scene: Cow<'_, Scene>,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<(Image, Report), Error> {
    let start = Instant::now();
    let prepared = prepare(scene, settings)?;
    let prepare_seconds = start.elapsed().as_secs_f64();
    let drawing = drawing_settings(&prepared, settings);
    let [width, height] = prepared.size;
    let mut image = Image::new(width, height, [0.0; 4]);
    let report = senca_pipeline::render_with(&prepared.scene, &prepared.view, &drawing, &mut image, control)?;
    let image = match &settings.crop {
        Some(crop) => cut_out(&image, crop),
        None => image,
    };
    Ok((image, Report { prepare_seconds, drawing: report }))
}

/// The pipeline's settings, with the crop and a background for a scene that has none.
pub(crate) fn drawing_settings(prepared: &Prepared<'_>, settings: &Settings) -> senca_pipeline::Settings {
    let mut drawing = senca_pipeline::Settings { crop: settings.crop, ..settings.drawing };
    if drawing.background.is_none() && prepared.scene.background == Background::None {
        drawing.background = Some(default_background(drawing.shading.is_lines()));
    }
    drawing
}

/// The part of `image` that `crop` names, which lies inside.
fn cut_out(image: &Image, crop: &senca_pipeline::Crop) -> Image {
    let mut part = Image::new(crop.width, crop.height, [0.0; 4]);
    let columns = crop.x as usize..(crop.x + crop.width) as usize;
    for (y, row) in part.pixels_mut().chunks_exact_mut(columns.len().max(1)).enumerate() {
        row.copy_from_slice(&image.row(crop.y + y as u32)[columns.clone()]);
    }
    part
}
