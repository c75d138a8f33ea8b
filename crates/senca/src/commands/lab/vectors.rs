//! `senca lab 1`: vectors and matrices, three equations, barycentric coordinates.

use clap::Args;
use senca_classic::lab::programs::{SystemProgram, TriangleProgram, VectorsProgram};
use senca_classic::lab::vectors::{FirstTask, Row3, Solution, barycentric, solve_system};
use serde_json::json;

use super::{Failure, Shown, Source, json_rows, row, rows};

/// Which task, and its numbers.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// vectors: the first task, with its constants; system: three equations, each with its three
    /// coefficients and its right side; barycentric: the points A, B, C and T
    #[arg(value_name = "TASK", value_parser = ["vectors", "system", "barycentric"], default_value = "vectors")]
    task: String,

    #[command(flatten)]
    source: Source,

    #[command(flatten)]
    shown: Shown,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.task == "barycentric" {
        return run_barycentric(arguments);
    }
    if arguments.task == "system" {
        return run_system(arguments);
    }
    if !arguments.source.is_empty() {
        return Err(Failure::usage("the task 'vectors' has constants and takes no numbers"));
    }
    run_vectors(&arguments.shown)
}

fn run_vectors(shown: &Shown) -> Result<(), Failure> {
    let FirstTask { v1, s, v2, v2_length, v3, v4, m1, m2, m3, v } = FirstTask::compute();
    let vectors =
        [("v1", &v1[..]), ("s", &[s]), ("v2", &v2), ("|v2|", &[v2_length]), ("v3", &v3), ("v4", &v4)];
    let mut text: String = vectors.iter().map(|(name, v)| format!("{name:<5}{}\n", row(v))).collect();
    for (name, m) in [("M1 = A + B", &m1), ("M2 = A B^T", &m2), ("M3 = A B^-1", &m3)] {
        text += &format!("{name}\n{}", rows(m));
    }
    text += &format!("V    {}\n", row(&v));
    let json = json!({
        "v1": v1, "s": s, "v2": v2, "v2_length": v2_length, "v3": v3, "v4": v4,
        "M1": json_rows(&m1), "M2": json_rows(&m2), "M3": json_rows(&m3), "V": v,
    });
    shown.print(&text, &json)?;
    shown.present(&mut VectorsProgram::new(), "lab-1")
}

fn run_system(arguments: &Arguments) -> Result<(), Failure> {
    let wanted = "Three equations, each: coefficients of x, y, z, and the right side";
    let equations = arguments.source.read(wanted, "1 1 1 6  -1 -2 1 -2  2 1 3 13", |input| {
        let mut equations = [[0.0; 4]; 3];
        for (i, equation) in equations.iter_mut().enumerate() {
            for (number, name) in equation.iter_mut().zip(["x", "y", "z", "the right side"]) {
                *number = input.number(&format!("{name} of equation {}", i + 1))?;
            }
        }
        Ok(equations)
    })?;
    let (text, kind, solution) = match solve_system(&equations) {
        Solution::One(solution) => (format!("[x y z] = [{}]\n", told(solution)), "point", Some(solution)),
        Solution::Line => ("all points of a line solve it\n".to_owned(), "line", None),
        Solution::Plane => ("all points of a plane solve it\n".to_owned(), "plane", None),
        Solution::Space => ("everything solves it\n".to_owned(), "space", None),
        Solution::None => {
            ("nothing solves it: the equations contradict each other\n".to_owned(), "none", None)
        }
    };
    arguments.shown.print(&text, &json!({ "solutions": kind, "solution": solution }))?;
    arguments.shown.present(&mut SystemProgram::new(&equations), "lab-1")
}

fn told(v: Row3) -> String {
    let number = |v: &f64| format!("{}", (v * 1e9).round() / 1e9 + 0.0);
    v.iter().map(number).collect::<Vec<_>>().join(" ")
}

fn run_barycentric(arguments: &Arguments) -> Result<(), Failure> {
    let wanted = "The points A, B, C and T, three coordinates each";
    let example = "1 0 1  5 0 2  3 3 4  2.5 0.75 2";
    let [a, b, c, t] = arguments.source.read(wanted, example, |input| {
        Ok([input.numbers("A")?, input.numbers("B")?, input.numbers("C")?, input.numbers("T")?])
    })?;
    let found = barycentric([a, b, c], t)?;
    let sum: f64 = found.coordinates.iter().sum();
    let mut text = format!("t    {}\nsum  {}\n", row(&found.coordinates), row(&[sum]));
    if let Some(i) = found.replaced_row {
        text += &format!("the system is singular; row {} was replaced by t1 + t2 + t3 = 1\n", i + 1);
    }
    text += match (found.inside, found.in_plane) {
        (true, _) => "T lies in the triangle\n",
        (_, true) => "T lies in the plane of the triangle, outside of it\n",
        _ => "T lies off the plane of the triangle\n",
    };
    let json = json!({
        "t": found.coordinates, "sum": sum, "replaced_row": found.replaced_row.map(|i| i + 1),
        "distance": found.distance, "in_plane": found.in_plane, "inside": found.inside,
    });
    arguments.shown.print(&text, &json)?;
    arguments.shown.present(&mut TriangleProgram::new([a, b, c], t)?, "lab-1")
}
