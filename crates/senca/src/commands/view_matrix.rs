//! `senca view-matrix`: the partial matrices of a viewing operation, as the books print them.
//!
//! The operation is read from a text file that is made to be edited; `docs/command-line.md` shows
//! one of each kind. Points are rows in the books, so every matrix is transposed on its way out.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::math::glam::DMat4;
use senca::math::{ViewFile, ViewSteps, ViewingOperation, aligned_text, json_rows};

use crate::cli::input::read_text;
use crate::cli::{Failure, output};

/// Which file, and how it is printed.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Text file with a viewing operation; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,

    /// Prints JSON: "T1", "T2" ... and "T", each a list of rows
    #[arg(long)]
    json: bool,
}

/// Prints the matrices.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (name, text) = read_text(&arguments.file)?;
    let ViewFile { operation } = ViewFile::parse(&name, &text).map_err(Failure::input)?;
    let steps = operation.steps().map_err(|e| Failure::input(format!("{name}: {e}")))?;
    output::print(&if arguments.json { json(&steps) } else { table(&operation, &steps) })
}

fn json(steps: &ViewSteps) -> String {
    let mut members = steps.partial_matrices();
    members.push(("T".to_owned(), steps.product()));
    let member = |(name, matrix): &(String, DMat4)| format!("  \"{name}\": {}", json_rows(matrix));
    format!("{{\n{}\n}}\n", members.iter().map(member).collect::<Vec<_>>().join(",\n"))
}

fn table(operation: &ViewingOperation, steps: &ViewSteps) -> String {
    let mut text = format!("{}, for points as rows\n", title(operation));
    for step in steps.steps() {
        push_matrix(&mut text, step.name, step.meaning, &step.forward);
    }
    let names: Vec<_> = steps.steps().iter().map(|s| s.name).collect();
    push_matrix(&mut text, "T", &format!("= {}", names.join(" ")), &steps.product());
    text
}

fn title(operation: &ViewingOperation) -> &'static str {
    match operation {
        ViewingOperation::CentralByNormal(_) => {
            "Operation A: central projection by centre, normal and distance"
        }
        ViewingOperation::ParallelByNormal(_) => "Parallel projection by point and normal",
        ViewingOperation::Central(_) => "Operation B: central projection",
        ViewingOperation::Parallel(_) => "Operation C: parallel projection",
        ViewingOperation::View1991(_) => "Normalising transform of 1991",
    }
}

fn push_matrix(text: &mut String, name: &str, meaning: &str, matrix: &DMat4) {
    let rows = aligned_text(matrix, 6);
    let rows: Vec<_> = rows.lines().map(|row| format!("  {row}\n")).collect();
    *text += &format!("\n{name}  {meaning}\n{}", rows.concat());
}
