//! `senca lab 2`: Bresenham's line beside the built-in one.

use clap::Args;
use senca_classic::lab::Input;
use senca_classic::lab::LabError;
use senca_classic::lab::line::{MAX_COORDINATE, Pixel, bresenham, integer_line, line_through, literal_line};
use senca_classic::lab::programs::LineProgram;
use serde_json::json;

use super::{Failure, Shown, Source, row};

/// The ends of the line, and which procedure.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// full: at any angle, with both ends; integer: the manual's procedure in whole numbers, for lines
    /// that climb at 0 to 45 degrees, without the last pixel; literal: the same in floating point
    #[arg(long, value_name = "NAME", value_parser = ["full", "integer", "literal"], default_value = "full")]
    procedure: String,

    #[command(flatten)]
    shown: Shown,
}

fn read_line(input: &mut Input<'_>) -> Result<[Pixel; 2], LabError> {
    let mut line = [[0; 2]; 2];
    for (pixel, end) in line.iter_mut().zip(["start", "end"]) {
        for (v, axis) in pixel.iter_mut().zip(["x", "y"]) {
            let what = format!("{axis} of the {end}");
            *v = input.whole(&what, -MAX_COORDINATE..=MAX_COORDINATE)? as i32;
        }
    }
    Ok(line)
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.source.is_empty() && arguments.shown.is_driven() {
        return arguments.shown.present(&mut LineProgram::new(), "lab-2");
    }
    let wanted = "x and y of the start, x and y of the end";
    let [start, end] = arguments.source.read(wanted, "2 1 9 6", read_line)?;
    let pixels = match arguments.procedure.as_str() {
        "literal" => literal_line(start, end),
        "integer" => integer_line(start, end),
        _ => bresenham(start, end),
    };
    let point = |[x, y]: Pixel| [f64::from(x), f64::from(y), 1.0];
    let coefficients = line_through(point(start), point(end));
    let mut text = format!("a b c  {}\n", row(&coefficients));
    for chunk in pixels.chunks(16) {
        let line: Vec<_> = chunk.iter().map(|[x, y]| format!("{x},{y}")).collect();
        text += &(line.join(" ") + "\n");
    }
    arguments.shown.print(&text, &json!({ "line": coefficients, "pixels": pixels }))?;
    arguments.shown.present(&mut LineProgram::with_line([start, end]), "lab-2")
}
