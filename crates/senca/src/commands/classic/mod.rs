//! `senca classic`: the books' own programs.

mod bezcnv;
mod dialogue;

use clap::{Args, Subcommand};

use crate::cli::Failure;

/// Which program.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    program: Program,
}

#[derive(Debug, Subcommand)]
enum Program {
    /// The patch converter of 1991: Bézier patches to polygons
    Bezcnv(bezcnv::Arguments),
}

/// Runs the program.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.program {
        Program::Bezcnv(arguments) => bezcnv::run(arguments),
    }
}
