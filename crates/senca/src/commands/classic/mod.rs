//! `senca classic`: the books' own programs.

mod bezcnv;
mod colors;
mod dialogue;
mod game;
mod lut;
mod polygon;
mod render;

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
    /// The renderer of 1991: scene and object files to bitmaps of colour indices
    Render(Box<render::Arguments>),
    /// The look-up table editor of 1991: other colours, light and highlights without rendering again
    Lut(Box<lut::Arguments>),
    /// The patch converter of 1991: Bézier patches to polygons
    Bezcnv(bezcnv::Arguments),
    /// The exercise in polygon shading: intensities at vertices, on edges, inside
    Polygon(Box<polygon::Arguments>),
    /// The game library of 1995: a street to fly through, each stage switchable and measured
    Game(Box<game::Arguments>),
}

/// Runs the program.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.program {
        Program::Render(arguments) => render::run(arguments),
        Program::Lut(arguments) => lut::run(arguments),
        Program::Bezcnv(arguments) => bezcnv::run(arguments),
        Program::Polygon(arguments) => polygon::run(arguments),
        Program::Game(arguments) => game::run(arguments),
    }
}
