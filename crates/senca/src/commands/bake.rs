//! `senca bake`: the light of a scene into a model that other programs show.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum, ValueHint};
use senca::io::gltf::{WriteSettings, write_glb};
use senca::pipeline::Control;
use senca::radiosity::Solution;
use senca::{Baking, ColorEncoding, Method, Settings, bake_light, beyond_white};

use crate::cli::input::read_scene;
use crate::cli::output::{self, check_writable, tell};
use crate::cli::values::{duration, stops};
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
  senca bake room.toml -o room.glb --vertex-colors";

/// Share of the progress bar that computing takes.
const COMPUTING: f32 = 0.9;

/// Share of the area that may be brighter than white before that is told.
const BURNT_OUT: f64 = 0.05;

impl Arguments {
    fn baking(&self) -> Baking {
        match self.vertex_colors {
            None => Baking::Lightmap(self.lightmap),
            Some(EncodingChoice::Linear) => Baking::VertexColors(ColorEncoding::Linear),
            Some(EncodingChoice::Srgb) => Baking::VertexColors(ColorEncoding::Srgb),
        }
    }
}

/// Says that much of the light is cut off, and what would keep it.
fn tell_brightness(arguments: &Arguments, solution: &Solution) {
    let (share, stops) = beyond_white(solution, arguments.exposure.exp2() as f32);
    if share > BURNT_OUT {
        tell(&format!(
            "senca: {}: warning: {:.0} % of the area is brighter than white and cut off; --exposure {:.1} keeps it",
            arguments.output.display(),
            100.0 * share,
            arguments.exposure - stops
        ));
    }
}

/// Bakes the light and writes the model.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = &arguments.scene;
    if arguments.output.extension().is_some_and(|extension| !extension.eq_ignore_ascii_case("glb")) {
        return Err(Failure::usage("light is baked into a binary glTF file: end the name in .glb"));
    }
    check_writable(&arguments.output)?;
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
        tell_brightness(arguments, &light.solution);
    }
    output::write(&arguments.output, &bytes, &interrupt)?;
    for warning in warnings.iter().filter(|_| !arguments.quiet) {
        tell(&format!("senca: {}: warning: {}", arguments.output.display(), warning.0));
    }
    Ok(())
}
