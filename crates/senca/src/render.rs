//! From a scene to a picture in one call.

use std::borrow::Cow;
use std::time::Instant;

use senca_math::Image;
use senca_pipeline::Control;
use senca_scene::{Background, Scene};

use crate::lighting::{compute_light, show_light};
use crate::prepare::{Prepared, default_background, prepare};
use crate::traced::{TraceJob, trace_with};
use crate::{Error, Method, Settings};

/// Counters and times of one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Seconds for pose, camera and light.
    pub prepare_seconds: f64,
    /// What the pipeline tells.
    pub drawing: senca_pipeline::Report,
    /// What the tracer tells, where one drew.
    pub tracing: Option<senca_trace::FilmReport>,
    /// What the solver of radiosity tells, where one was at work.
    pub radiosity: Option<senca_radiosity::SolveReport>,
}

/// Draws `scene` into a new picture.
///
/// A scene without a camera is framed whole, one without light gets some, one without a background
/// is seen before a quiet grey; lines are drawn on white unless the settings say otherwise.
///
/// ```
/// use senca::scene::{Scene, Shape};
/// use senca::{Settings, render};
///
/// let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
/// let settings = Settings { size: Some([64, 48]), ..Settings::default() };
/// let (image, report) = render(&scene, &settings)?;
///
/// // The ball is lit in the middle; the corner shows the background, which is bluish.
/// let (middle, corner) = (image.color(32, 24), image.color(0, 0));
/// assert!(middle.r == middle.b && middle.r > 0.1);
/// assert!(corner.b > corner.r);
/// assert!(report.drawing.triangles_drawn > 0);
/// # Ok::<(), senca::Error>(())
/// ```
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
    if settings.method == Method::Radiosity {
        let light = compute_light(&scene, settings, control, &mut |_| {})?;
        return show_light(scene, &light.solution, settings, control);
    }
    if settings.method != Method::Raster {
        let traced = trace_with(scene, settings, control, &mut TraceJob::default())?;
        return Ok((traced.image, traced.report));
    }
    let start = Instant::now();
    let prepared = prepare(scene, settings)?;
    let prepare_seconds = start.elapsed().as_secs_f64();
    let drawing = drawing_settings(&prepared, settings);
    let (image, report) =
        senca_pipeline::render_part(&prepared.scene, &prepared.view, &drawing, prepared.size, control)?;
    Ok((image, Report { prepare_seconds, drawing: report, ..Report::default() }))
}

/// The pipeline's settings, with the crop and a background: the caller's, white paper for line
/// drawings, the scene's, or a quiet grey, in this order. What is seen changes, not the light that comes
/// from the scene's own background.
pub(crate) fn drawing_settings(prepared: &Prepared<'_>, settings: &Settings) -> senca_pipeline::Settings {
    let lines = settings.drawing.shading.is_lines();
    let background = match (settings.drawing.background, prepared.scene.background) {
        (Some(wish), _) => wish,
        (None, of_scene) if lines || of_scene == Background::None => default_background(lines),
        (None, of_scene) => of_scene,
    };
    senca_pipeline::Settings { crop: settings.crop, background: Some(background), ..settings.drawing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::LinearRgb;
    use senca_pipeline::{Crop, Shading};
    use senca_scene::Shape;

    const RED: LinearRgb = LinearRgb::new(1.0, 0.0, 0.0);

    fn ball() -> Scene {
        Scene::of_shape("ball", Shape::Sphere { radius: 1.0 })
    }

    fn settings(width: u32, height: u32) -> Settings {
        Settings { size: Some([width, height]), ..Settings::default() }
    }

    #[test]
    fn the_callers_background_goes_before_the_scenes() {
        let scene = Scene { background: Background::Color(LinearRgb::BLACK), ..ball() };
        let corner = |settings: &Settings| render(&scene, settings).expect("a picture").0.pixel(0, 0);
        let mut wish = settings(32, 32);
        assert_eq!(corner(&wish), [0.0, 0.0, 0.0, 1.0]);
        wish.drawing.background = Some(Background::Color(RED));
        assert_eq!(corner(&wish), [1.0, 0.0, 0.0, 1.0]);
        wish.drawing.background = Some(Background::None);
        assert_eq!(corner(&wish)[3], 0.0);
        wish.drawing.background = None;
        wish.drawing.shading = Shading::Wire;
        assert_eq!(corner(&wish), [1.0; 4], "lines are drawn on paper");
    }

    #[test]
    fn another_background_leaves_the_light_of_the_scenes() {
        let sky = senca_scene::TextureImage {
            name: String::new(),
            data: senca_scene::ImageData::RgbaF32 {
                width: 2,
                height: 1,
                texels: vec![[0.5, 0.5, 0.5, 1.0]; 2],
            },
        };
        let background =
            Background::Environment { image: senca_scene::ImageId(0), strength: 1.0, rotation: 0.0 };
        let scene = Scene { images: vec![sky], background, ..ball() };
        let with = |background| {
            let mut wish = settings(33, 33);
            wish.drawing.background = background;
            render(&scene, &wish).expect("a picture").0
        };
        let (plain, red) = (with(None), with(Some(Background::Color(RED))));
        assert!(plain.pixel(16, 16)[0] > 0.1);
        assert_eq!(plain.pixel(16, 16), red.pixel(16, 16));
        assert_eq!(red.pixel(0, 0), [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn paths_take_their_light_from_what_glows() {
        let mut scene = ball();
        let glow = senca_scene::Material { emission: LinearRgb::new(0.0, 2.0, 0.0), ..Default::default() };
        scene.geometries[0].material = Some(scene.add_material(glow));
        let mut wish = Settings { method: Method::Path, ..settings(9, 9) };
        wish.drawing.background = Some(Background::Color(LinearRgb::BLACK));
        let (image, _) = render(&scene, &wish).expect("a picture");
        assert_eq!(image.pixel(4, 4), [0.0, 2.0, 0.0, 1.0], "no lamp adds to it");
        wish.method = Method::Trace;
        let (image, _) = render(&scene, &wish).expect("a picture");
        assert!(image.pixel(4, 4)[0] > 0.1, "rays that find no glow need lamps");
    }

    #[test]
    fn a_cut_out_equals_that_part_of_the_whole() {
        let (whole, _) = render(&ball(), &settings(60, 40)).expect("a picture");
        let crop = Crop { x: 25, y: 11, width: 17, height: 9 };
        let wish = Settings { crop: Some(crop), ..settings(60, 40) };
        let (part, _) = render(&ball(), &wish).expect("a picture");
        assert_eq!((part.width(), part.height()), (17, 9));
        for y in 0..9 {
            assert_eq!(part.row(y), &whole.row(11 + y)[25..42], "row {y}");
        }
    }

    #[test]
    fn a_scene_without_camera_and_light_is_seen_whole_and_lit() {
        let (image, _) = render(&ball(), &settings(101, 101)).expect("a picture");
        let is_ball = |p: &[f32; 4]| p[0] == p[2];
        assert!(is_ball(&image.pixel(50, 50)) && image.pixel(50, 50)[0] > 0.1);
        let edges = (0..101).flat_map(|i| [(i, 0), (i, 100), (0, i), (100, i)]);
        assert!(edges.into_iter().all(|(x, y)| !is_ball(&image.pixel(x, y))), "the ball touches no side");
        let covered = image.pixels().iter().filter(|p| is_ball(p)).count();
        assert!(covered > 101 * 101 / 2, "{covered} pixels of {}", 101 * 101);
    }
}
