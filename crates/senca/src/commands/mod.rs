//! The subcommands, one file each.

mod bake;
mod bench;
mod classic;
mod compare;
mod convert;
mod form_factor;
mod info;
mod lab;
mod lux;
mod render;
mod view_matrix;

use clap::{Parser, Subcommand};

use crate::cli::Failure;

/// Draws 3-D scenes and models without a GPU.
#[derive(Debug, Parser)]
#[command(name = "senca", version, propagate_version = true, max_term_width = 100)]
pub(crate) struct Senca {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Draws a scene or a model into a picture
    Render(Box<render::Arguments>),
    /// Tells what is in a scene or a model
    Info(info::Arguments),
    /// Writes a model, or a picture, in another format
    Convert(convert::Arguments),
    /// Tells how far a picture is from another one
    Compare(compare::Arguments),
    /// Prints the partial matrices of a viewing operation and their product
    ViewMatrix(view_matrix::Arguments),
    /// Bakes the light of a scene into a model that other programs show
    Bake(Box<bake::Arguments>),
    /// Measures illuminance in lux on a plane
    Lux(Box<lux::Arguments>),
    /// Compares the methods for form factors on a known pair, or on a scene's patches
    FormFactor(form_factor::Arguments),
    /// Runs the programs of the books
    Classic(Box<classic::Arguments>),
    /// Does the laboratory exercises
    Lab(Box<lab::Arguments>),
    /// Measures this program on data it makes itself
    Bench(bench::Arguments),
}

/// Runs the subcommand.
pub(crate) fn run(senca: Senca) -> Result<(), Failure> {
    match senca.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::ViewMatrix(arguments) => view_matrix::run(&arguments),
        Command::Bake(arguments) => bake::run(&arguments),
        Command::Lux(arguments) => lux::run(&arguments),
        Command::FormFactor(arguments) => form_factor::run(&arguments),
        Command::Classic(arguments) => classic::run(&arguments),
        Command::Lab(arguments) => lab::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
    }
}
