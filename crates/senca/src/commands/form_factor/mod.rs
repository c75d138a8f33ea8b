//! `senca form-factor`: how much of the light leaving one surface lands on another, by each method.

mod pair;
mod scene;

use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;
use clap::builder::PossibleValuesParser;
use clap::builder::TypedValueParser;
use senca::radiosity::form_factor::{
    CellFactor, GroupFactor, Method, MethodSettings, MonteCarloSettings, RayCastSettings, group_factor,
};
use serde::Serialize;

use crate::cli::{Failure, output, use_threads};
use pair::{Kind, Pair};

/// What is compared, by which methods, and how finely.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// A pair with its numbers, or a scene
    ///
    /// parallel W H D: two rectangles W x H facing at distance D;
    /// perpendicular W H1 H2: W x H1 and W x H2 sharing the edge W at a right angle;
    /// tilted W H1 H2 DEGREES: the same at another angle;
    /// disc R1 R2 D: two discs facing on one axis;
    /// patch-sphere R D DEGREES: a small patch and a sphere, so far from its normal;
    /// disc-sphere R1 R2 D: a disc and a sphere on its axis;
    /// spheres R1 R2 D: two spheres;
    /// SCENE: all patches of a scene or model; - is standard input
    #[arg(value_name = "PAIR|SCENE", required = true, num_args = 1.., allow_negative_numbers = true)]
    what: Vec<String>,

    /// One method instead of all
    #[arg(long, value_name = "NAME", value_parser = method_parser())]
    pub(crate) method: Option<Method>,

    /// Prints JSON
    #[arg(long)]
    pub(crate) json: bool,

    /// Cells along an edge of the half cube, and directions across the disc of Nusselt
    #[arg(long, value_name = "N", default_value_t = 100)]
    resolution: u32,

    /// What a cell of the half cube counts: its exact factor, or that of its middle as in the text
    #[arg(long, value_name = "WHAT", value_parser = ["exact", "middle"], default_value = "exact")]
    cells: String,

    /// Parts each way of a patch that sees, for half cube and Nusselt; twice as many of both patches
    /// for the double sum; left out: 8 for a pair, 2 for a scene
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=64))]
    parts: Option<u16>,

    /// Lines of sight between two patches for ray casting
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    lines: u32,

    /// Rays of a patch for the method of chance
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    rays: u32,

    /// Changes all chance
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Longest edge of the patches that a scene is divided in; left out: its polygons as they are
    #[arg(long, value_name = "LENGTH")]
    pub(crate) patch_size: Option<f64>,

    /// Makes the rows of a scene's matrix add up to 1
    #[arg(long)]
    pub(crate) normalize: bool,

    /// Threads; all cores when left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,

    /// No progress bar
    #[arg(long)]
    pub(crate) quiet: bool,
}

fn method_parser() -> impl TypedValueParser<Value = Method> {
    let by_name = |name: String| Method::ALL.into_iter().find(|m| m.name() == name).ok_or("unknown method");
    PossibleValuesParser::new(Method::ALL.map(Method::name)).try_map(by_name)
}

/// What one method says of a pair.
#[derive(Debug, Serialize)]
struct Row {
    method: &'static str,
    value: f64,
    relative_error: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<f64>,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    pair: String,
    exact: f64,
    methods: Vec<Row>,
}

/// Prints the table.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    use_threads(arguments.threads)?;
    let Some((what, numbers)) = arguments.what.split_first() else { return Ok(()) };
    let Some(kind) = Kind::ALL.into_iter().find(|kind| kind.name() == what) else {
        return run_scene(what, numbers, arguments, &settings(arguments, 2));
    };
    let settings = settings(arguments, 8);
    let pair = kind.pair(numbers)?;
    if arguments.patch_size.is_some() || arguments.normalize {
        return Err(Failure::usage("--patch-size and --normalize are for scenes"));
    }
    let methods = arguments.method.map_or_else(|| Method::ALL.to_vec(), |method| vec![method]);
    let rows = methods.into_iter().map(|method| row(&pair, method, &settings));
    let report =
        Report { pair: pair.title.clone(), exact: pair.exact, methods: rows.collect::<Result<_, _>>()? };
    output::print(&if arguments.json { json(&report)? } else { table(&report) })
}

fn run_scene(
    what: &str,
    numbers: &[String],
    arguments: &Arguments,
    settings: &MethodSettings,
) -> Result<(), Failure> {
    let path = Path::new(what);
    if !numbers.is_empty() || (what != "-" && !path.exists()) {
        let known: Vec<_> =
            Kind::ALL.iter().map(|k| format!("{} {}", k.name(), k.numbers().join(" "))).collect();
        return Err(Failure::usage(format!(
            "'{what}' is neither a pair nor a file; pairs are: {}",
            known.join(", ")
        )));
    }
    scene::run(path, arguments, settings)
}

fn settings(arguments: &Arguments, parts: u16) -> MethodSettings {
    let (rays, seed) = (arguments.rays, arguments.seed);
    let parts = usize::from(arguments.parts.unwrap_or(parts));
    MethodSettings {
        parts,
        double_area_parts: 2 * parts,
        directions: arguments.resolution.min(4096) as usize,
        resolution: arguments.resolution,
        cell_factor: if arguments.cells == "middle" { CellFactor::Middle } else { CellFactor::Exact },
        ray_cast: RayCastSettings { rays: arguments.lines, seed, ..RayCastSettings::default() },
        monte_carlo: MonteCarloSettings { rays, seed, ..MonteCarloSettings::default() },
    }
}

/// A method that takes less than this is run again, and its shortest time told.
const PATIENCE: Duration = Duration::from_millis(20);

fn row(pair: &Pair, method: Method, settings: &MethodSettings) -> Result<Row, Failure> {
    // A disc is in small parts already.
    let whole = pair.from.len() == 1;
    let settings =
        if whole { *settings } else { MethodSettings { parts: 1, double_area_parts: 1, ..*settings } };
    let start = Instant::now();
    let mut seconds = f64::INFINITY;
    let mut found: Option<GroupFactor> = None;
    while found.is_none() || start.elapsed() < PATIENCE {
        let once = Instant::now();
        found = Some(group_factor(&pair.from, &pair.to, method, &settings).map_err(Failure::usage)?);
        seconds = seconds.min(once.elapsed().as_secs_f64());
    }
    let factor = found.unwrap_or(GroupFactor { value: 0.0, standard_error: None });
    let relative_error = factor.value / pair.exact - 1.0;
    Ok(Row {
        method: method.name(),
        value: factor.value,
        relative_error,
        standard_error: factor.standard_error,
        seconds,
    })
}

fn json(report: &Report) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(report).map_err(Failure::input)? + "\n")
}

fn table(report: &Report) -> String {
    let mut text = format!("{}\n\n", report.pair);
    text +=
        &format!("{:<12} {:>16} {:>16} {:>15} {:>12}\n", "method", "value", "exact", "relative error", "us");
    for row in &report.methods {
        let chance = row.standard_error.map_or_else(String::new, |e| format!("  +- {e:.1e}"));
        text += &format!(
            "{:<12} {:>16.12} {:>16.12} {:>15.1e} {:>12.2}{chance}\n",
            row.method,
            row.value,
            report.exact,
            row.relative_error,
            1e6 * row.seconds
        );
    }
    text
}
