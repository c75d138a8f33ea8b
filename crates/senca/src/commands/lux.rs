//! `senca lux`: illuminance in lux, for people who plan lighting.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueHint};
use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::math::glam::DVec3;
use senca::pipeline::Control;
use senca::radiosity::false_color::{FalseColors, round_up};
use senca::radiosity::{LuxGrid, LuxReport};
use senca::{LuxPlaces, Method, Scene, Settings, measure_lux};
use serde_json::json;

use crate::cli::input::read_scene;
use crate::cli::output::{self, check_writable, is_standard, print};
use crate::cli::values::{duration, positive, triple};
use crate::cli::{Failure, Interrupt, LightArguments, Progress, use_threads};

/// Where is measured, and how.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Scene or model, told by its content; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    scene: PathBuf,

    /// Height of the measured plane above the lowest point of the scene, in world units
    #[arg(long, value_name = "LENGTH", value_parser = positive, default_value = "0.75")]
    height: f64,

    /// Distance of measured places from each other, in world units [default: 1/20 of the longer side]
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    spacing: Option<f64>,

    /// Corner of the measured area, as seen from above [default: that of the scene]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "to")]
    from: Option<DVec3>,

    /// Opposite corner of the measured area
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "from")]
    to: Option<DVec3>,

    /// Measures on the largest flat face of the object of this name, such as a desk or a wall
    #[arg(long, value_name = "NAME", conflicts_with_all = ["from", "corner"])]
    object: Option<String>,

    /// Direction that the face of the object looks in [default: any]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "object")]
    facing: Option<DVec3>,

    /// Measures on a rectangle anywhere, with this corner
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "edges",
          conflicts_with = "from")]
    corner: Option<DVec3>,

    /// Its edges from there; measured is the side from which the second follows the first counter-clockwise
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, requires = "corner",
          num_args = 2)]
    edges: Option<Vec<DVec3>>,

    /// Luminance that a shown 1 stands for, in candela per square metre
    #[arg(long, value_name = "CD/M2", value_parser = positive, default_value = "1")]
    luminance_of_one: f64,

    /// Writes a line x,y,z,lux for each place; - is standard output
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Writes a picture of the plane from above in false colours, with their scale
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    picture: Option<PathBuf>,

    /// Upper end of the scale of the picture, in lux [default: the largest value, rounded up]
    #[arg(long, value_name = "LUX", value_parser = positive, requires = "picture")]
    scale_max: Option<f64>,

    /// Equal steps of colour are equal factors
    #[arg(long, requires = "picture")]
    log_scale: bool,

    /// Prints the summary as one JSON object
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    light: LightArguments,

    /// Takes the best light after this time: 30s, 5m, 1h
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    time_limit: Option<Duration>,

    /// Threads to work with; the numbers are the same with any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// No progress bar and no warnings
    #[arg(long, short)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  senca lux office.toml
  senca lux office.toml --height 0.85 --spacing 0.25 -o desk.csv --picture desk.png
  senca lux office.toml --object desk --spacing 0.1 --picture desk.png
  senca lux office.toml --corner 0,1,0 --edges 3,0,0 0,1.5,0 -o wall.csv
  senca lux hall.glb --luminance-of-one 1000 --from -4,0,-2 --to 4,0,2";

/// Longer side of the picture of the plane, in pixels, without its scale.
const PICTURE: u32 = 480;

/// Places along the longer side where no spacing is given.
const PLACES_ALONG: f64 = 20.0;

/// Measures and tells.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = &arguments.scene;
    let outputs = [&arguments.output, &arguments.picture];
    outputs.into_iter().flatten().try_for_each(|path| check_writable(path))?;
    let picture = arguments.picture.as_deref().map(picture_format).transpose()?;
    arguments.light.check()?;
    use_threads(arguments.threads)?;
    let interrupt = Interrupt::listen();
    let scene = read_scene(name)?;
    let files = arguments.light.files(arguments.time_limit)?;
    let radiosity = arguments.light.settings(0.0);
    let settings = Settings { method: Method::Radiosity, radiosity, ..Settings::default() };

    if scene.bounds().is_empty() {
        return Err(Failure::input(format!("{}: there is nothing in the scene", name.display())));
    }
    let plane = arguments.plane(&scene)?;

    let progress = Progress::new(arguments.quiet);
    let first = |done: f32| progress.report(0.8 * done);
    let second = |done: f32| progress.report(0.8 + 0.2 * done);
    let control = Control { progress: Some(&first), cancel: Some(interrupt.flag()) };
    let light = files.light(name, &scene, &settings, &control, &interrupt, &mut |_| {})?;
    let control = Control { progress: Some(&second), ..control };
    let places = match (&plane, &arguments.object) {
        (Some(grid), _) => Ok(LuxPlaces::from(*grid)),
        (None, object) => {
            let object = object.as_deref().unwrap_or_default();
            LuxPlaces::on_object(&scene, &light.solution, object, arguments.facing, arguments.spacing)
        }
    };
    let places = places.map_err(|error| Failure::of_scene(name, &error))?;
    let report =
        measure_lux(&scene, &light.solution, &settings, &places, arguments.luminance_of_one, &control);
    let report = report.map_err(|error| Failure::of_scene(name, &error))?;
    progress.finish();
    if !arguments.quiet {
        light.tell_warnings(name);
    }

    if let Some((path, format)) = arguments.picture.as_deref().zip(picture) {
        let most = arguments.scale_max.unwrap_or_else(|| round_up(report.most()));
        let colors = FalseColors { unit: 1.0, most, logarithmic: arguments.log_scale };
        let image = report.to_image(&colors, PICTURE);
        output::write(path, &encode(&image, format, &PictureOptions::default())?, &interrupt)?;
    }
    if let Some(path) = &arguments.output {
        output::write(path, report.to_csv().as_bytes(), &interrupt)?;
        if is_standard(path) {
            return Ok(());
        }
    }
    print(&summary(&report, arguments.json)?)
}

impl Arguments {
    /// The plane that is measured; `None` where it is that of an object.
    fn plane(&self, scene: &Scene) -> Result<Option<LuxGrid>, Failure> {
        if self.object.is_some() {
            return Ok(None);
        }
        if let (Some(corner), Some(&[across, along])) = (self.corner, self.edges.as_deref()) {
            let spacing = self.spacing.unwrap_or(across.length().max(along.length()) / PLACES_ALONG);
            return LuxGrid::rectangle(corner, [across, along], spacing).map(Some).map_err(Failure::usage);
        }
        let mut bounds = scene.bounds();
        let height = bounds.min.y + self.height;
        if let Some((from, to)) = self.from.zip(self.to) {
            (bounds.min, bounds.max) = (from.min(to), from.max(to));
        }
        let size = bounds.size();
        let spacing = self.spacing.unwrap_or(size.x.max(size.z) / PLACES_ALONG);
        LuxGrid::horizontal(&bounds, height, spacing).map(Some).map_err(Failure::usage)
    }
}

fn picture_format(path: &Path) -> Result<PictureFormat, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    PictureFormat::from_extension(&extension)
        .ok_or_else(|| Failure::usage(format!("{} names no picture format; take .png", path.display())))
}

/// The numbers that people who plan lighting ask for.
fn summary(report: &LuxReport, as_json: bool) -> Result<String, Failure> {
    let [columns, rows] = report.grid.size;
    let (mean, least, most) = (report.mean(), report.least(), report.most());
    let uniformity = report.uniformity();
    let (height, left_out) = (report.grid.origin.y, report.left_out());
    let normal = report.grid.normal.to_array();
    if as_json {
        let value = json!({
            "columns": columns, "rows": rows, "height": height, "normal": normal, "left_out": left_out,
            "mean": mean, "least": least, "most": most, "uniformity": uniformity, "unit": "lux",
        });
        let text = serde_json::to_string_pretty(&value).map_err(Failure::input)?;
        return Ok(text + "\n");
    }
    let place = match normal {
        [_, 1.0, _] => format!("at y = {height:.3}"),
        [x, y, z] => format!("looking to {x:.3}, {y:.3}, {z:.3}"),
    };
    let without = match left_out {
        0 => String::new(),
        1 => ", without 1 that is in a body or beside the face".to_owned(),
        n => format!(", without {n} that are in bodies or beside the face"),
    };
    Ok(format!(
        "{columns} x {rows} places {place}{without}\n\
         mean        {mean:>10.3} lux\n\
         least       {least:>10.3} lux\n\
         most        {most:>10.3} lux\n\
         uniformity  {uniformity:>10.3} (least / mean)\n"
    ))
}
