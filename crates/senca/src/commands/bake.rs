//! `senca bake`: the light of a scene into a model that other programs show.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueEnum, ValueHint};
use senca::io::gltf::{WriteSettings, write_glb};
use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::math::Image;
use senca::pipeline::Control;
use senca::radiosity::Solution;
use senca::scene::{ImageData, Scene};
use senca::{Baking, ColorEncoding, Method, Settings, bake_light, bake_light_picture, beyond_white};

use crate::cli::input::read_scene;
use crate::cli::output::{self, check_writable, tell};
use crate::cli::values::{duration, positive, stops};
use crate::cli::{Failure, Interrupt, LightArguments, Progress, use_threads};

/// From what to what, and how.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Scene or model, told by its content; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    scene: PathBuf,

    /// Model with its light, .glb; - is standard output
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: PathBuf,

    /// Texels a side of the picture that holds the light [default: what the light asks for]
    #[arg(long, value_name = "SIDE", value_parser = clap::value_parser!(u32).range(16..=16_384))]
    lightmap: Option<u32>,

    /// Bakes colours of vertices in place of a picture: numbers are light, as glTF has it, or srgb for
    /// programs that take them for that, such as F3D and ParaView
    #[arg(long, value_enum, value_name = "NUMBERS", num_args = 0..=1, default_missing_value = "linear",
          conflicts_with = "lightmap")]
    vertex_colors: Option<EncodingChoice>,

    /// Writes the light alone as a picture on the model's coordinates, what a white surface would show, for
    /// programs that multiply colours by it: .png with 8 bits, as sRGB of the light over a scale that is
    /// told, .exr and .pfm with the numbers themselves
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "vertex_colors")]
    light_picture: Option<PathBuf>,

    /// Light that white stands for in a picture of 8 bits [default: the most there is]
    #[arg(long, value_name = "LIGHT", value_parser = positive, requires = "light_picture")]
    light_scale: Option<f64>,

    /// Makes all light stronger or weaker: each stop up doubles it, each stop down halves it
    #[arg(long, value_name = "STOPS", value_parser = stops, default_value = "0", allow_hyphen_values = true)]
    exposure: f64,

    #[command(flatten)]
    light: LightArguments,

    /// Shows the best light after this time: 30s, 5m, 1h
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    time_limit: Option<Duration>,

    /// Threads to work with [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// No progress bar and no warnings
    #[arg(long, short)]
    quiet: bool,
}

/// What numbers stand for colours of vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EncodingChoice {
    /// Light
    Linear,
    /// sRGB
    Srgb,
}

const EXAMPLES: &str = "\
Examples:
  senca bake room.toml -o room.glb
  senca bake room.toml -o room.glb --lightmap 1024 --exposure 1
  senca bake room.toml -o room.glb --light-picture light.png --light-scale 2
  senca bake room.toml -o room.glb --vertex-colors";

/// Share of the progress bar that computing takes.
const COMPUTING: f32 = 0.9;

/// Share of the area that may be brighter than white before that is told.
const BURNT_OUT: f64 = 0.002;

impl Arguments {
    fn baking(&self) -> Baking {
        match self.vertex_colors {
            None => Baking::Lightmap(self.lightmap),
            Some(EncodingChoice::Linear) => Baking::VertexColors(ColorEncoding::Linear),
            Some(EncodingChoice::Srgb) => Baking::VertexColors(ColorEncoding::Srgb),
        }
    }
}

/// Says what of the light is cut off, and what would keep it.
fn tell_brightness(arguments: &Arguments, scene: &Scene, solution: &Solution) {
    let beyond = beyond_white(scene, solution, arguments.exposure.exp2() as f32);
    let warn = |what: String| tell(&format!("senca: {}: warning: {what}", arguments.output.display()));
    if beyond.share > BURNT_OUT {
        let percent = 100.0 * beyond.share;
        let keeps = (10.0 * (arguments.exposure - beyond.stops)).floor() / 10.0;
        let digits = usize::from(percent < 1.0);
        warn(format!(
            "{percent:.digits$} % of the area is brighter than white and cut off; --exposure {keeps:.1} keeps it"
        ));
    }
    if beyond.emitters > 1.0 {
        warn(format!(
            "what gives off light shows up to {:.1} times white and is cut off there; what it lights is as it is",
            beyond.emitters
        ));
    }
}

/// The light alone, encoded, and what its numbers mean.
fn light_picture(
    image: &Image,
    format: PictureFormat,
    scale: Option<f64>,
) -> Result<(Vec<u8>, String), Failure> {
    if matches!(format, PictureFormat::Exr | PictureFormat::Pfm) {
        let bytes = encode(image, format, &PictureOptions::default())?;
        return Ok((bytes, "numbers are light: 1 is what shows a white surface as white".to_owned()));
    }
    let most = image.pixels().iter().flat_map(|pixel| &pixel[..3]).fold(0.0f32, |most, &v| most.max(v));
    let scale = scale.unwrap_or(if most > 0.0 { f64::from(most) } else { 1.0 });
    let mut scaled = image.clone();
    for pixel in scaled.pixels_mut() {
        pixel[..3].iter_mut().for_each(|v| *v = (f64::from(*v) / scale) as f32);
    }
    let bytes = encode(&scaled, format, &PictureOptions::default())?;
    let cut =
        if f64::from(most) > scale { format!("; light up to {most:.4} is cut off") } else { String::new() };
    Ok((bytes, format!("8 bits, sRGB of light / {scale:.6}{cut}")))
}

/// Texels a side of the picture of a baked model.
fn lightmap_side(baked: &Scene) -> u32 {
    let sides = baked.images.iter().map(|image| match image.data {
        ImageData::Rgba8 { width, .. } => width,
        _ => 0,
    });
    sides.max().unwrap_or(0)
}

fn picture_format(path: &Path) -> Result<PictureFormat, Failure> {
    PictureFormat::from_path(path).ok_or_else(|| {
        Failure::usage(format!("{} names no picture format; take .png, .exr or .pfm", path.display()))
    })
}

/// Bakes the light and writes the model.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = &arguments.scene;
    if arguments.output.extension().is_some_and(|extension| !extension.eq_ignore_ascii_case("glb")) {
        return Err(Failure::usage("light is baked into a binary glTF file: end the name in .glb"));
    }
    check_writable(&arguments.output)?;
    let format = arguments.light_picture.as_deref().map(picture_format).transpose()?;
    if let Some(path) = &arguments.light_picture {
        check_writable(path)?;
    }
    arguments.light.check()?;
    use_threads(arguments.threads)?;
    let interrupt = Interrupt::listen();
    let scene = read_scene(name)?;
    let files = arguments.light.files(arguments.time_limit)?;
    let radiosity = arguments.light.settings(arguments.exposure);
    let settings = Settings { method: Method::Radiosity, radiosity, ..Settings::default() };

    let progress = Progress::new(arguments.quiet);
    let report = |done: f32| progress.report(COMPUTING * done);
    let control = Control { progress: Some(&report), cancel: Some(interrupt.flag()) };
    let light = files.light(name, &scene, &settings, &control, &interrupt, &mut |_| {})?;
    let baked = bake_light(&scene, &light.solution, &settings, arguments.baking())
        .map_err(|error| Failure::of_scene(name, &error))?;
    let mut warnings = Vec::new();
    let bytes = write_glb(&baked, &WriteSettings::default(), &mut warnings)?;
    progress.finish();
    if !arguments.quiet {
        light.tell_warnings(name);
        tell_brightness(arguments, &scene, &light.solution);
    }
    output::write(&arguments.output, &bytes, &interrupt)?;
    if let Some((path, format)) = arguments.light_picture.as_deref().zip(format) {
        let side = lightmap_side(&baked);
        let image = bake_light_picture(&light.solution, &settings, side)
            .map_err(|error| Failure::of_scene(name, &error))?;
        let (bytes, means) = light_picture(&image, format, arguments.light_scale)?;
        output::write(path, &bytes, &interrupt)?;
        if !arguments.quiet {
            tell(&format!("senca: {}: {means}", path.display()));
        }
    }
    for warning in warnings.iter().filter(|_| !arguments.quiet) {
        tell(&format!("senca: {}: warning: {}", arguments.output.display(), warning.0));
    }
    Ok(())
}
