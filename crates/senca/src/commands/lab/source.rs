//! Where an exercise gets its numbers from.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca_classic::lab::{Input, LabError};

use crate::cli::Failure;
use crate::cli::input::read_text;
use crate::cli::output::{is_standard, tell};

/// Numbers on the command line, or a text; flattened into the arguments of exercises.
#[derive(Args, Debug)]
pub(super) struct Source {
    /// The numbers, in the order of the exercise; without them and --input, those of the manual's
    /// example
    #[arg(value_name = "NUMBER", allow_negative_numbers = true)]
    numbers: Vec<String>,

    /// Text with the numbers; # begins a remark; - is standard input
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "numbers")]
    input: Option<PathBuf>,
}

impl Source {
    /// Whether there is neither.
    pub(super) fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.input.is_none()
    }

    /// Reads all of the text, or the `example`. Someone who types is told what is `wanted`.
    pub(super) fn read<T>(
        &self,
        wanted: &str,
        example: &str,
        read: impl FnOnce(&mut Input<'_>) -> Result<T, LabError>,
    ) -> Result<T, Failure> {
        let (name, text) = self.text(wanted, example)?;
        let mut input = Input::new(&name, &text);
        let found = read(&mut input)?;
        input.finish()?;
        Ok(found)
    }

    fn text(&self, wanted: &str, example: &str) -> Result<(String, String), Failure> {
        if let Some(path) = &self.input {
            if is_standard(path) && std::io::stdin().is_terminal() {
                tell(&format!("{wanted}; end with Ctrl-D:"));
            }
            return read_text(path);
        }
        if !self.numbers.is_empty() {
            return Ok(("command line".to_owned(), self.numbers.join(" ")));
        }
        Ok(("the manual's example".to_owned(), example.to_owned()))
    }
}
