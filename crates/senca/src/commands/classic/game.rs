//! `senca classic game`: the game library of 1995, and a street to fly through with it.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, ValueHint};
use senca::io::images::PictureFormat;
use senca_classic::game::{
    Arithmetic, ErrorStatistics, FilmError, FilmFormat, Flight, Mapping, Measures, Moment, Projection,
    Search, Show, Stages, Surface, TextureArithmetic, film, measure, sheet,
};
use serde_json::{Value, json};

use crate::cli::interactive::{self, InteractiveArguments, encoded};
use crate::cli::output::{self, check_writable, print};
use crate::cli::{Failure, Interrupt};

/// What the stages do, and what comes out.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Writes the flight as an animated picture, one picture a tick of the script: .png, .apng or .gif
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    film: Option<PathBuf>,

    /// Writes six pictures of the last moment: linear textures, the mapping asked for, and the exact reference; below,
    /// how far the first two are off, and how far whole numbers alone are
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    sheet: Option<PathBuf>,

    /// Prints how far textures are off in texels, and points in pixels, on the flight
    #[arg(long)]
    measure: bool,

    /// Prints the measures as JSON
    #[arg(long)]
    json: bool,

    /// What is shown
    #[arg(long, value_enum, default_value_t = ShowChoice::Library, help_heading = STAGES)]
    show: ShowChoice,

    /// How faces are drawn
    #[arg(long, value_enum, default_value_t = SurfaceChoice::Textured, help_heading = STAGES)]
    surface: SurfaceChoice,

    /// How textures are laid on: affine, linear all over a face; or a number N, exact every N pixels of a row and
    /// linear between; 1 is exact at every pixel
    #[arg(long, value_name = "affine|N", value_parser = mapping, default_value = "16", help_heading = STAGES)]
    mapping: Mapping,

    /// Numbers that points are rotated with
    #[arg(long, value_enum, default_value_t = ArithmeticChoice::Fixed10, help_heading = STAGES)]
    arithmetic: ArithmeticChoice,

    /// Calculates textures in 32 bits, as plain C did, with this many fraction bits: 8 are right, 16 overflow
    #[arg(long, value_name = "FRACTION", value_parser = clap::value_parser!(u32).range(0..=16), help_heading = STAGES)]
    texture_32_bits: Option<u32>,

    /// Cuts lines and polygons as it is printed, and leaves out the last column of textures
    #[arg(long, help_heading = STAGES)]
    as_printed: bool,

    /// Keeps polygons that are outside of the volume seen
    #[arg(long, help_heading = STAGES)]
    no_volume: bool,

    /// Leaves out polygons that cross the clipping plane, in place of cutting them
    #[arg(long, help_heading = STAGES)]
    no_plane_clipping: bool,

    /// Distance of the clipping plane, in units of some ten centimetres
    #[arg(long, value_name = "UNITS", value_parser = clap::value_parser!(i32).range(1..=10_000), default_value_t = 8, help_heading = STAGES)]
    plane: i32,

    /// Logarithm of the focus in pixels: 8 is 256 pixels and an angle of 64 degrees
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=12), default_value_t = 8, help_heading = STAGES)]
    log_focus: u32,

    /// Drops depth in place of dividing by it
    #[arg(long, help_heading = STAGES)]
    parallel: bool,

    #[command(flatten)]
    interactive: InteractiveArguments,
}

const STAGES: &str = "Stages";

const EXAMPLES: &str = "\
Keys:
  arrows       ahead, back, turn               page up, page down  rise, sink
  , .          aside                           a z, q e            pitch, roll
  t            textured, lit, shaded, flat, wire
  m            mapping of textures
  f            numbers of the rotation         b                   numbers of the textures
  c            how is cut                      v, n                volume, clipping plane on or off
  p, l         parallel; focus                 d                   exact, difference
  r            back to the start               escape              end

Examples:
  senca classic game --window
  senca classic game --mapping affine -o affine.png
  senca classic game --script samples/classic/game-flight.keys --film flight.gif
  senca classic game --script samples/classic/game-flight.keys --measure --json";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ShowChoice {
    /// What the library draws
    Library,
    /// The reference in double precision
    Exact,
    /// How far the two are apart, doubled
    Difference,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SurfaceChoice {
    /// Textures, and intensities where there are none
    Textured,
    /// Textures under light from corner to corner
    Lit,
    /// Intensities from corner to corner
    Shaded,
    /// One colour a face
    Flat,
    /// Lines
    Wire,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ArithmeticChoice {
    /// Tables in floating point
    Float,
    /// Fixed point with 14 fraction bits
    Fixed14,
    /// Fixed point with 10 fraction bits, as in the text
    Fixed10,
    /// Fixed point with 8 fraction bits
    Fixed8,
}

/// `affine`, or pixels from 1 to 1024.
fn mapping(text: &str) -> Result<Mapping, String> {
    match text.parse() {
        _ if text == "affine" => Ok(Mapping::Affine),
        Ok(n @ 1..=1024) => Ok(Mapping::Subdivided(n)),
        _ => Err("a mapping is affine, or a number of pixels from 1 to 1024".into()),
    }
}

impl Arguments {
    fn stages(&self) -> Stages {
        let fraction_bits = self.texture_32_bits;
        Stages {
            arithmetic: match self.arithmetic {
                ArithmeticChoice::Float => Arithmetic::Float,
                ArithmeticChoice::Fixed14 => Arithmetic::Fixed14,
                ArithmeticChoice::Fixed10 => Arithmetic::Fixed10,
                ArithmeticChoice::Fixed8 => Arithmetic::Fixed8,
            },
            surface: match self.surface {
                SurfaceChoice::Textured => Surface::Textured,
                SurfaceChoice::Lit => Surface::Lit,
                SurfaceChoice::Shaded => Surface::Shaded,
                SurfaceChoice::Flat => Surface::Flat,
                SurfaceChoice::Wire => Surface::Wire,
            },
            mapping: match self.mapping {
                Mapping::Subdivided(n) if self.as_printed => Mapping::SubdividedAsPrinted(n),
                mapping => mapping,
            },
            texture_arithmetic: fraction_bits.map_or_else(TextureArithmetic::default, |fraction_bits| {
                TextureArithmetic { fraction_bits, is_32_bit: true }
            }),
            search: if self.as_printed { Search::AsPrinted } else { Search::Precise },
            rejects_volume: !self.no_volume,
            cuts_at_plane: !self.no_plane_clipping,
            projection: if self.parallel {
                Projection::Parallel { log_depth: 9 }
            } else {
                Projection::Perspective
            },
            log_focus: self.log_focus,
            clip_plane: self.plane,
        }
    }

    fn show(&self) -> Show {
        match self.show {
            ShowChoice::Library => Show::Library,
            ShowChoice::Exact => Show::Exact,
            ShowChoice::Difference => Show::Difference,
        }
    }

    /// Whether something is asked for that needs no window.
    fn has_result(&self) -> bool {
        self.film.is_some() || self.sheet.is_some() || self.measure || self.json
    }
}

/// Runs the flight, and writes what is asked for.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let film_format = arguments.film.as_deref().map(film_format).transpose()?;
    let sheet_format = arguments.sheet.as_deref().map(picture_format).transpose()?;
    for path in [&arguments.film, &arguments.sheet].into_iter().flatten() {
        check_writable(path)?;
    }
    let interrupt = Interrupt::listen();
    let mut flight = Flight::new(arguments.stages(), arguments.show());
    let InteractiveArguments { window, script, output, .. } = &arguments.interactive;
    if *window || script.is_some() || output.is_some() || !arguments.has_result() {
        interactive::run(&mut flight, "game", &arguments.interactive, &interrupt)?;
    }
    let now = [flight.now()];
    let moments = if flight.moments().is_empty() { &now[..] } else { flight.moments() };
    if let (Some(path), Some(format)) = (&arguments.film, film_format) {
        write_film(&flight, moments, path, format, &interrupt)?;
    }
    if let (Some(path), Some(format)) = (&arguments.sheet, sheet_format) {
        let picture = sheet(flight.world(), &now[0]);
        output::write(path, &encoded(&picture, format)?, &interrupt)?;
    }
    if arguments.measure || arguments.json {
        let measures = measure(flight.world(), moments);
        print(&if arguments.json { as_json(&measures) } else { as_text(&measures) })?;
    }
    Ok(())
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default()
}

fn film_format(path: &Path) -> Result<FilmFormat, Failure> {
    FilmFormat::from_extension(&extension(path))
        .ok_or_else(|| Failure::usage(format!("{}: a film is .png, .apng or .gif", path.display())))
}

fn picture_format(path: &Path) -> Result<PictureFormat, Failure> {
    PictureFormat::from_extension(&extension(path))
        .ok_or_else(|| Failure::usage(format!("{} names no picture format; take .png", path.display())))
}

fn write_film(
    flight: &Flight,
    moments: &[Moment],
    path: &Path,
    format: FilmFormat,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let bytes =
        film(flight.world(), moments, format, &|| !interrupt.is_raised()).map_err(|error| match error {
            FilmError::Stopped => Failure::Interrupted,
            error => Failure::input(format!("{}: {error}", path.display())),
        })?;
    output::write(path, &bytes, interrupt)
}

/// What a mapping is called.
fn mapping_name(mapping: Mapping) -> String {
    match mapping {
        Mapping::Affine => "affine".to_owned(),
        Mapping::Subdivided(n) | Mapping::SubdividedAsPrinted(n) => n.to_string(),
    }
}

fn statistics(errors: &ErrorStatistics) -> Value {
    json!({
        "count": errors.count,
        "max": errors.max,
        "rms": errors.rms(),
        "share_above_1": errors.share_above_one(),
    })
}

fn as_json(measures: &Measures) -> String {
    let textures = |rows: &[(Mapping, ErrorStatistics)]| -> Value {
        rows.iter().map(|(mapping, errors)| (mapping_name(*mapping), statistics(errors))).collect()
    };
    let wobble: serde_json::Map<_, _> = measures
        .wobble
        .iter()
        .map(|wobble| {
            let value = json!({
                "pixels": statistics(&wobble.points),
                "whole_pixels": statistics(&wobble.whole_points),
                "texels": statistics(&wobble.texels),
            });
            (wobble.arithmetic.name().to_owned(), value)
        })
        .collect();
    let counters = &measures.counters;
    let value = json!({
        "moments": measures.moments,
        "faces": {
            "all": counters.faces,
            "turned_away": counters.turned_away,
            "outside": counters.outside,
            "crossing": counters.crossing,
            "drawn": counters.drawn,
        },
        "texture_error_texels": textures(&measures.texture),
        "wall_error_texels": textures(&measures.wall),
        "wobble": wobble,
    });
    format!("{value:#}\n")
}

fn as_text(measures: &Measures) -> String {
    let row = |name: &str, errors: &ErrorStatistics| {
        format!(
            "  {name:<10}{:>9.3}{:>9.3}{:>9.2} %{:>12}\n",
            errors.max,
            errors.rms(),
            100.0 * errors.share_above_one(),
            errors.count
        )
    };
    let mut text = format!("{} moments\n", measures.moments);
    let mut table = |title: &str, rows: Vec<(String, ErrorStatistics)>| {
        text += &format!("\n{title}\n  {:<10}{:>9}{:>9}{:>11}{:>12}\n", "", "max", "rms", "above 1", "count");
        rows.iter().for_each(|(name, errors)| text += &row(name, errors));
    };
    let named = |rows: &[(Mapping, ErrorStatistics)]| -> Vec<_> {
        rows.iter().map(|(mapping, errors)| (mapping_name(*mapping), *errors)).collect()
    };
    table(
        "Texture error on the flight, in texels, by pixels from one exact place to the next",
        named(&measures.texture),
    );
    table("The same on a wall whose depth grows fourfold over 160 pixels", named(&measures.wall));
    let of = |what: fn(&senca_classic::game::Wobble) -> ErrorStatistics| -> Vec<_> {
        measures.wobble.iter().map(|w| (w.arithmetic.name().to_owned(), what(w))).collect()
    };
    table("Wobble of points, in pixels, before they are set to whole ones", of(|w| w.points));
    table("The same after that", of(|w| w.whole_points));
    table("Wobble of textures, in texels", of(|w| w.texels));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mappings_are_affine_or_a_number() {
        assert_eq!(mapping("affine"), Ok(Mapping::Affine));
        assert_eq!(mapping("8"), Ok(Mapping::Subdivided(8)));
        for wrong in ["", "0", "1025", "-1", "exact", "8.5"] {
            assert!(mapping(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn formats_are_found_out_before() {
        assert_eq!(film_format(Path::new("a.gif")).ok(), Some(FilmFormat::Gif));
        for path in ["a", "a.jpg", "-"] {
            assert!(film_format(Path::new(path)).is_err());
        }
        assert!(picture_format(Path::new("sheet")).is_err());
    }

    #[test]
    fn measures_are_told_by_name() {
        let world = senca_classic::game::World {
            bodies: vec![],
            textures: vec![],
            palette: [0; 256],
            sky: 0,
            lights: senca_classic::game::LightTable::from_fn(|color, _| color),
        };
        let measures = measure(&world, &[]);
        let value: Value = serde_json::from_str(&as_json(&measures)).expect("JSON");
        let affine = value["wall_error_texels"]["affine"]["max"].as_f64().expect("a number");
        assert!((affine - 64.0 / 3.0).abs() < 0.01, "{affine}");
        assert_eq!(value["wobble"]["fixed10"]["pixels"]["count"], 0);
        let text = as_text(&measures);
        assert!(text.contains("  affine") && text.contains("  fixed8"), "{text}");
    }
}
