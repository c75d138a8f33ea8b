//! What the programs of 1991 share: colour indices, palettes, profiles, and the files behind them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, ValueHint};
use senca::classic::thesis::{EditorFiles, Lut, Profile};
use senca::io::classic::{IndexBitmap, IntegerWidth};
use senca::io::images::PictureFormat;
use senca_window::Canvas;

use crate::cli::input::{read_bytes, read_text};
use crate::cli::interactive::encoded;
use crate::cli::output::{self, is_standard};
use crate::cli::{Failure, Interrupt};

/// Colour indices and what they look like.
#[derive(Args, Clone, Debug)]
pub(super) struct ColorArguments {
    /// Number of colour indices: 16 on a PC of the time, 256 with eight bit planes [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65_536))]
    pub(super) colors: Option<u32>,

    /// The machine: 16 or 32 bits in depth and bitmap
    #[arg(long, value_enum, default_value = "32")]
    pub(super) bits: Bits,

    /// Colours without a profile [default: ega for 16 colours on 16 bits, otherwise greys]
    #[arg(long, value_enum)]
    pub(super) palette: Option<Palette>,

    /// Profile of the look-up table, from a file; several for ranges of indices, one after the other
    #[arg(long, value_name = "FILE", conflicts_with = "palette", value_hint = ValueHint::FilePath)]
    pub(super) profile: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Bits {
    /// A PC
    #[value(name = "16")]
    Pc16,
    /// A VAX
    #[value(name = "32")]
    Vax32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Palette {
    /// From black in equal steps, as on a VAX
    Greys,
    /// The 16 colours of EGA and VGA: black, blue, cyan, near white, and yellow and red as a highlight
    Ega,
}

impl ColorArguments {
    /// Number of colours.
    pub(super) fn count(&self) -> u32 {
        self.colors.unwrap_or(16)
    }

    /// Width of the machine's integers.
    pub(super) fn width(&self) -> IntegerWidth {
        match self.bits {
            Bits::Pc16 => IntegerWidth::Bits16,
            Bits::Vax32 => IntegerWidth::Bits32,
        }
    }

    /// The profiles.
    pub(super) fn profiles(&self) -> Result<Vec<Profile>, Failure> {
        let read = |path: &PathBuf| {
            let (name, text) = read_text(path)?;
            Ok(Profile::parse(&name, &text)?)
        };
        self.profile.iter().map(read).collect()
    }

    /// The profile that the editor begins with, if there is one.
    pub(super) fn profile(&self) -> Result<Option<Profile>, Failure> {
        let mut profiles = self.profiles()?;
        if profiles.len() > 1 {
            return Err(Failure::usage("the editor has one profile; several are for pictures with -o"));
        }
        Ok(profiles.pop())
    }

    /// The table for a picture with so many ranges of indices.
    pub(super) fn lut(&self, ranges: u32) -> Result<Lut, Failure> {
        let count = self.count();
        let profiles = self.profiles()?;
        if !profiles.is_empty() {
            return Ok(Lut::of_profiles(&profiles, ranges, count));
        }
        match self.palette {
            Some(Palette::Ega) => Lut::ega(count).map_err(Failure::usage),
            Some(Palette::Greys) => Lut::greys(count).map_err(Failure::usage),
            None if self.bits == Bits::Pc16 && count == 16 => Lut::ega(count).map_err(Failure::usage),
            None => Ok(Lut::mono(count)),
        }
    }
}

/// Writes a picture, whose format its name tells; to standard output as PNG.
pub(super) fn write_picture(path: &Path, canvas: &Canvas, interrupt: &Interrupt) -> Result<(), Failure> {
    let format = if is_standard(path) {
        PictureFormat::Png
    } else {
        PictureFormat::from_path(path)
            .ok_or_else(|| Failure::usage(format!("{} names no picture format; take .png", path.display())))?
    };
    output::write(path, &encoded(canvas, format)?, interrupt)
}

/// The bitmap in a file.
pub(super) fn read_bitmap(path: &Path) -> Result<IndexBitmap, Failure> {
    let (name, bytes) = read_bytes(path)?;
    Ok(IndexBitmap::read(&name, &bytes)?.0)
}

/// Files for the editor.
pub(super) struct DiskFiles {
    /// Heard while files are written.
    pub(super) interrupt: Interrupt,
}

impl EditorFiles for DiskFiles {
    fn load_bitmap(&mut self, name: &str) -> Result<IndexBitmap, String> {
        read_bitmap(Path::new(name)).map_err(told)
    }

    fn save_picture(&mut self, name: &str, picture: &Canvas) -> Result<(), String> {
        write_picture(Path::new(name), picture, &self.interrupt).map_err(told)
    }

    fn save_profile(&mut self, name: &str, text: &str) -> Result<(), String> {
        output::write(Path::new(name), text.as_bytes(), &self.interrupt).map_err(told)
    }
}

/// What a failure says, without the program's name.
fn told(failure: Failure) -> String {
    match failure {
        Failure::Usage(message) | Failure::Input(message) => message,
        Failure::Interrupted | Failure::ClosedPipe => "interrupted".to_owned(),
    }
}
