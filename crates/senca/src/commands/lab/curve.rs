//! `senca lab 6`: a Bézier curve, and an eye that moves along it.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::math::glam::DVec3;
use senca_classic::lab::bezier::{
    STEPS, bernstein_weights, bezier_weights, parameters, point_by_bernstein, point_by_bezier,
    read_control_points, visible_faces,
};
use senca_classic::lab::programs::CurveProgram;
use senca_classic::lab::solid::Solid;
use senca_classic::lab::vectors::Row3;
use serde_json::{Value, json};

use super::{Failure, Shown, Source, read_solid, row};
use crate::cli::values::{share, triple};
use crate::cli::{Interrupt, interactive};

/// The curve and the solid.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// The solid that the eye looks at, as OBJ or another model [default: a cube]
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    solid: Option<PathBuf>,

    /// By which weights the points are computed
    #[arg(long, value_name = "NAME", value_parser = ["bernstein", "bezier"], default_value = "bernstein")]
    form: String,

    /// Tells the weights at this parameter, 0 to 1, and begins the picture there
    #[arg(short, value_name = "T", default_value = "0", value_parser = share)]
    t: f64,

    /// Direction up for the eye
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", allow_hyphen_values = true, value_parser = triple)]
    up: DVec3,

    /// Writes the pictures of all 101 parameters: OUT-000.png to OUT-100.png for -o OUT.png
    #[arg(long, requires = "output")]
    frames: bool,

    #[command(flatten)]
    shown: Shown,
}

/// A path around the cube.
const EXAMPLE: &str = "1 1 3  3 1 1  1 3 -1  -3 2 0  -1 1 4";

/// The cube of the manual.
const CUBE: &str = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\nv 1 1 1\nv 0 1 0\nv 0 1 1\n\
f 1 3 2\nf 3 4 2\nf 3 5 4\nf 5 6 4\nf 5 7 6\nf 7 8 6\nf 7 1 8\nf 1 2 8\nf 1 5 3\nf 1 7 5\nf 2 4 6\nf 2 6 8\n";

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let points = arguments.source.read("Control points, x y z each", EXAMPLE, read_control_points)?;
    let solid = match &arguments.solid {
        Some(path) => read_solid(path)?,
        None => Solid::read("cube", CUBE.as_bytes())?,
    };
    let (text, json) = report(arguments, &points, &solid.normalized()?);
    arguments.shown.print(&text, &json)?;
    let up = arguments.up.to_array();
    if arguments.frames {
        return write_frames(arguments, &points, &solid, up);
    }
    arguments.shown.present(&mut CurveProgram::new(points, &solid, up, arguments.t)?, "lab-6")
}

fn report(arguments: &Arguments, points: &[Row3], solid: &Solid) -> (String, Value) {
    let n = points.len() - 1;
    let by_bezier = arguments.form == "bezier";
    let at = |t: f64| if by_bezier { point_by_bezier(points, t) } else { point_by_bernstein(points, t) };
    let weights = if by_bezier { bezier_weights(n, arguments.t) } else { bernstein_weights(n, arguments.t) };
    let shown_weights: Vec<f64> = weights.iter().copied().take(12).collect();
    let mut text = format!("degree {n}; weights at t = {}: {}", arguments.t, row(&shown_weights));
    text += if weights.len() > 12 { " ...\n" } else { "\n" };
    text += "t; point; faces seen from it\n";
    let mut frames = Vec::new();
    for t in parameters() {
        let (point, seen) = (at(t), visible_faces(solid, at(t)));
        let seen: Vec<usize> = seen.iter().map(|i| i + 1).collect();
        let faces = if seen.len() > 12 { format!("{} faces", seen.len()) } else { format!("{seen:?}") };
        text += &format!("  {t:.2}  {}  {faces}\n", row(&point));
        frames.push(json!({ "t": t, "point": point, "visible": seen }));
    }
    (text, json!({ "degree": n, "t": arguments.t, "weights": weights, "frames": frames }))
}

fn write_frames(arguments: &Arguments, points: &[Row3], solid: &Solid, up: Row3) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let Some(output) = &arguments.shown.interactive.output else { return Ok(()) };
    for (i, t) in parameters().enumerate() {
        let mut program = CurveProgram::new(points.to_vec(), solid, up, t)?;
        let mut frame = arguments.shown.interactive.clone();
        frame.output = Some(super::fractal::numbered(output, i, STEPS + 1));
        interactive::run(&mut program, "lab-6", &frame, &interrupt)?;
    }
    Ok(())
}
