//! Line drawings.

use senca_math::{Image, View};
use senca_scene::Scene;

use crate::RenderError;
use crate::report::{Control, Report};
use crate::settings::{Crop, Settings};

pub(crate) fn draw(
    _scene: &Scene,
    _view: &View,
    _settings: &Settings,
    _image: &mut Image,
    _area: &Crop,
    _control: &Control<'_>,
) -> Result<Report, RenderError> {
    Ok(Report::default())
}
