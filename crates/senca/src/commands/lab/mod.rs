//! `senca lab N`: the laboratory exercises. Each reads its input from arguments, a file or standard
//! input, prints its numbers, and draws its picture or opens a window.

mod curve;
mod fractal;
mod line;
mod polygon;
mod shading;
mod solid;
mod source;
mod vectors;
mod view;

use clap::{Args, Subcommand};
use senca_classic::lab::LabError;
use senca_classic::lab::shading::Camera;
use senca_classic::lab::solid::Solid;
use senca_classic::lab::vectors::{Matrix, Row3};
use senca_classic::lab::view::ViewMethod;
use senca_window::Program;
use serde_json::Value;

use crate::cli::input::read_bytes;
use crate::cli::interactive::{self, InteractiveArguments};
use crate::cli::output::{self, is_standard};
use crate::cli::{Failure, Interrupt};
use source::Source;

/// Which exercise.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    exercise: Exercise,
}

#[derive(Debug, Subcommand)]
enum Exercise {
    /// Vectors and matrices, three equations, barycentric coordinates
    #[command(name = "1")]
    Vectors(vectors::Arguments),
    /// Bresenham's line beside the built-in one
    #[command(name = "2")]
    Line(line::Arguments),
    /// A convex polygon: orientation, point test, filling
    #[command(name = "3")]
    Polygon(polygon::Arguments),
    /// The planes of a solid, and whether a point lies in it
    #[command(name = "4")]
    Solid(solid::Arguments),
    /// The view transform both ways, and perspective
    #[command(name = "5")]
    View(view::Arguments),
    /// A Bézier curve, and an eye that moves along it
    #[command(name = "6")]
    Curve(curve::Arguments),
    /// Wireframe, constant and Gouraud shading
    #[command(name = "7")]
    Shading(shading::Arguments),
    /// Mandelbrot and Julia sets, to any depth
    #[command(name = "8")]
    Fractal(Box<fractal::Arguments>),
}

/// Does the exercise.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.exercise {
        Exercise::Vectors(arguments) => vectors::run(arguments),
        Exercise::Line(arguments) => line::run(arguments),
        Exercise::Polygon(arguments) => polygon::run(arguments),
        Exercise::Solid(arguments) => solid::run(arguments),
        Exercise::View(arguments) => view::run(arguments),
        Exercise::Curve(arguments) => curve::run(arguments),
        Exercise::Shading(arguments) => shading::run(arguments),
        Exercise::Fractal(arguments) => fractal::run(arguments),
    }
}

/// How an exercise's results are shown; flattened into its arguments.
#[derive(Args, Debug)]
pub(super) struct Shown {
    /// Prints JSON
    #[arg(long)]
    pub(super) json: bool,

    #[command(flatten)]
    pub(super) interactive: InteractiveArguments,
}

impl Shown {
    /// Prints the numbers, unless a picture goes to standard output.
    pub(super) fn print(&self, text: &str, json: &Value) -> Result<(), Failure> {
        if self.interactive.output.as_deref().is_some_and(is_standard) {
            return Ok(());
        }
        if self.json {
            let json = serde_json::to_string_pretty(json).map_err(Failure::input)?;
            return output::print(&(json + "\n"));
        }
        output::print(text)
    }

    /// Whether a window or a picture is asked for.
    pub(super) fn is_drawn(&self) -> bool {
        self.is_driven() || self.interactive.output.is_some()
    }

    /// Whether the program is driven by someone or by a script.
    pub(super) fn is_driven(&self) -> bool {
        self.interactive.window || self.interactive.script.is_some()
    }

    /// Runs the program, if a window or a picture is asked for.
    pub(super) fn present(&self, program: &mut dyn Program, name: &str) -> Result<(), Failure> {
        if !self.is_drawn() {
            return Ok(());
        }
        interactive::run(program, name, &self.interactive, &Interrupt::listen())
    }
}

impl From<LabError> for Failure {
    fn from(error: LabError) -> Self {
        Self::input(error)
    }
}

/// The solid in a file; `-` is standard input.
fn read_solid(path: &std::path::Path) -> Result<Solid, Failure> {
    let (name, bytes) = read_bytes(path)?;
    Ok(Solid::read(&name, &bytes)?)
}

/// An eye and where it looks; flattened into the arguments of exercises.
#[derive(Args, Debug)]
pub(super) struct CameraArguments {
    /// The eye O
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = crate::cli::values::triple)]
    eye: Option<senca::math::glam::DVec3>,

    /// The point G that it looks at
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = crate::cli::values::triple)]
    target: Option<senca::math::glam::DVec3>,

    /// Direction up
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = crate::cli::values::triple)]
    up: Option<senca::math::glam::DVec3>,

    /// How the view transform is made: from axes, from axes with the manual's TZ that turns depth over,
    /// or by rotations, for which z is up
    #[arg(long, value_name = "NAME", value_parser = ["axes", "axes-flipped", "rotations"], default_value = "axes")]
    method: String,
}

impl CameraArguments {
    /// The camera, with what is not given as in `other`.
    fn camera(&self, other: Camera) -> Camera {
        let or = |given: Option<senca::math::glam::DVec3>, other: Row3| given.map_or(other, |v| v.to_array());
        let method = match self.method.as_str() {
            "rotations" => ViewMethod::Rotations,
            "axes-flipped" => ViewMethod::AxesWithFlip,
            _ => ViewMethod::Axes,
        };
        Camera {
            eye: or(self.eye, other.eye),
            target: or(self.target, other.target),
            up: or(self.up, other.up),
            method,
        }
    }
}

/// Numbers with six digits behind the point, in a row.
fn row(numbers: &[f64]) -> String {
    let number = |v: &f64| format!("{:>12.6}", v + 0.0);
    numbers.iter().map(number).collect::<String>().trim_start().to_owned()
}

/// The rows of a matrix, one a line, in columns.
fn rows<const N: usize>(matrix: &Matrix<N>) -> String {
    let line = |row: &[f64; N]| row.iter().map(|v| format!("{:>12.6}", v + 0.0)).collect::<String>() + "\n";
    matrix.0.iter().map(line).collect()
}

/// The rows of a matrix for JSON.
fn json_rows<const N: usize>(matrix: &Matrix<N>) -> Value {
    matrix.0.iter().map(|row| Value::from(row.to_vec())).collect()
}
