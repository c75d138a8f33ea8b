//! `senca classic bezcnv`: the patch converter of 1991.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, ValueHint};
use senca::io::classic::{read_patches, write_object};
use senca::io::{Location, NoFiles, ReadError};
use senca::scene::{BezierPatch, Mesh, PatchConversion, Shape, VertexSearch, Warning, patch_to_polygons};
use serde_json::json;

use super::dialogue::ask;
use crate::cli::input::read_bytes;
use crate::cli::output::{self, check_writable, is_standard, print, tell};
use crate::cli::values::{not_negative, steps};
use crate::cli::{Failure, Interrupt};

/// What is converted, and how finely.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Patch file; - is standard input. Without it the program asks its questions
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath, requires = "output")]
    input: Option<PathBuf>,

    /// Object file; - is standard output
    #[arg(value_name = "OUT", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Steps that each patch is divided into [default: 4,4]
    #[arg(long, value_name = "U,V", value_parser = steps)]
    steps: Option<[u32; 2]>,

    /// Vertices nearer than this share of the mean step are one; 0 keeps all apart [default: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = not_negative)]
    epsilon: Option<f64>,

    /// How equal vertices are looked for: both find the same
    #[arg(long, value_enum, default_value_t = Search::Grid)]
    search: Search,

    /// The very first vertex is never compared, as in the printed program
    #[arg(long)]
    as_printed: bool,

    /// Shows a dot for each polygon
    #[arg(long)]
    dots: bool,

    /// Prints the counts and the polygons of each surface as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Search {
    /// From the newest to the oldest, one by one, as the program did
    Backward,
    /// In a grid of cells
    Grid,
}

/// The answers to the questions.
struct Task {
    input: PathBuf,
    output: PathBuf,
    steps: [u32; 2],
    epsilon: f64,
}

/// Converts the file.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let task = match (&arguments.input, &arguments.output) {
        (Some(input), Some(output)) => Task {
            input: input.clone(),
            output: output.clone(),
            steps: arguments.steps.unwrap_or(PatchConversion::default().steps),
            epsilon: arguments.epsilon.unwrap_or(PatchConversion::default().epsilon),
        },
        _ => dialogue(arguments, &mut std::io::stdin().lock())?,
    };
    if arguments.json && is_standard(&task.output) {
        return Err(Failure::usage("--json and the object file cannot both go to standard output"));
    }
    check_writable(&task.output)?;
    let interrupt = Interrupt::listen();
    let (patches, warnings) = patches(&task.input)?;
    let settings = PatchConversion {
        steps: task.steps,
        epsilon: task.epsilon,
        as_printed: arguments.as_printed,
        search: match arguments.search {
            Search::Backward => VertexSearch::Backward,
            Search::Grid => VertexSearch::Grid,
        },
    };
    let refuse = |error: &dyn std::fmt::Display| Failure::input(format!("{}: {error}", task.input.display()));
    let mesh = patch_to_polygons(&patches, &settings).map_err(|e| refuse(&e))?;
    output::write(&task.output, &write_object(&mesh)?, &interrupt)?;
    warnings.iter().for_each(|warning| tell(&format!("senca: warning: {}", warning.0)));
    if arguments.dots {
        tell(&".".repeat(mesh.faces.len()));
    }
    if arguments.json { print(&counts(&mesh)) } else { Ok(()) }
}

/// The program's questions, in its order.
fn dialogue(arguments: &Arguments, input: &mut dyn BufRead) -> Result<Task, Failure> {
    let file = ask(input, "Source file", "teapot.bez")?;
    let steps = match arguments.steps {
        Some(steps) => steps,
        None => [ask(input, "Number of steps in u", "4")?, ask(input, "Number of steps in v", "4")?],
    };
    let epsilon = match arguments.epsilon {
        Some(epsilon) => epsilon,
        None => ask(input, "Largest deviation of a neighbouring vertex, as a share of a step", "0.05")?,
    };
    Ok(Task { input: file, steps, epsilon, output: ask(input, "Target file", "bez.dat")? })
}

fn patches(path: &Path) -> Result<(Vec<BezierPatch>, Vec<Warning>), Failure> {
    let (name, bytes) = read_bytes(path)?;
    let mut scene = read_patches(&name, &bytes, &NoFiles)?;
    match scene.geometries.pop().map(|geometry| geometry.shape) {
        Some(Shape::BezierPatches { patches }) => Ok((patches, scene.warnings)),
        _ => Err(ReadError::malformed(Location::file(&name), "holds no patches").into()),
    }
}

fn counts(mesh: &Mesh) -> String {
    let on = |surface| (0..mesh.faces.len()).filter(|&face| mesh.faces.surface_of(face) == surface).count();
    let per_surface: Vec<usize> = (0..mesh.surfaces.len() as u32).map(on).collect();
    let object = json!({
        "vertices": mesh.points.len(),
        "polygons": mesh.faces.len(),
        "surfaces": mesh.surfaces.len(),
        "polygons_of_surface": per_surface,
    });
    format!("{object:#}\n")
}
