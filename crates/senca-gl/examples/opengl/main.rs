//! The sample programs and exercises of the course text, chapter 5, in a window or without one.
//!
//! `cargo run --release -p senca-gl --example opengl -- surface`
//! `cargo run --release -p senca-gl --example opengl -- surface --out surface.png`
#![allow(clippy::print_stderr, reason = "a program tells what is wrong")]

mod editor;
mod exercises;
mod letters;
mod samples;
mod show;
mod solids;

use clap::{Parser, ValueEnum};
use senca_gl::gl;
use senca_window::{Canvas, Program, Script, Session, desktop};
use show::Show;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Shows a program of chapter 5 in a window, replays a session with it, or draws it into a PNG.
#[derive(Parser)]
#[command(after_help = KEYS)]
struct Arguments {
    /// Which program.
    program: Name,
    /// Writes the last picture: of the script, of the window, or the one the program begins with.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Opens a window, after the script if there is one. Default without --script and --out.
    #[arg(long)]
    window: bool,
    /// Replays a session without a display: a text with one command a line, such as `key left`, `drag 10 10 90 50`,
    /// `tick 0.1 20`, `size 640 480`, `save picture.png`.
    #[arg(long)]
    script: Option<PathBuf>,
    /// Width and height in pixels, such as 400x300. Default: those of the text.
    #[arg(long, value_parser = size)]
    size: Option<[u32; 2]>,
    /// Moment of the animation that a picture without a script shows, 0 to 1.
    #[arg(long, default_value_t = 0.5)]
    time: f64,
    /// Clicks of the line editor in pixels from the lower left corner: x,y,x,y draws a segment, x,y deletes one.
    #[arg(long, value_delimiter = ' ')]
    click: Vec<String>,
}

const KEYS: &str = "\
Arrow keys or dragging turn the eye, + - or the wheel move it, Home puts it back. f: filled, lines, points.
approach: space stops and starts. textures, mipmaps: m next filter, e next way to apply the texture.
editor: the left button draws a segment from press to release, or from click to click; the right one deletes.
Ctrl+S saves PROGRAM.png, q or Escape ends.";

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Sample: two segments (section 5.4).
    First,
    /// Sample: texture mapping (section 5.8).
    Texture,
    /// Sample: Bézier curve (section 5.9).
    Curve,
    /// Sample: Bézier surface (section 5.9).
    Surface,
    /// Exercise 5.3: each of the ten primitives.
    Primitives,
    /// Exercise 5.4: product of cosines, by strips of quadrilaterals.
    Waves,
    /// Exercise 5.5: ellipses by a display list, and text.
    Ellipses,
    /// Exercise 5.6: lit bodies.
    Bodies,
    /// Exercise 5.7: coming nearer to the bodies.
    Approach,
    /// Exercise 5.8: bodies with textures of one level.
    Textures,
    /// Exercise 5.8: the same with mipmaps.
    Mipmaps,
    /// Exercise 5.9: a surface of several patches.
    Patches,
    /// Exercise 5.10: a line editor, by selection.
    Editor,
}

impl Name {
    /// What the window is called.
    fn title(self) -> &'static str {
        match self {
            Self::First => "First program",
            Self::Texture => "Texture mapping",
            Self::Curve => "Bézier curve",
            Self::Surface => "Bézier surface",
            Self::Primitives => "Primitives",
            Self::Waves => "Waves",
            Self::Ellipses => "Ellipses",
            Self::Bodies => "Bodies",
            Self::Approach => "Approach",
            Self::Textures => "Textures",
            Self::Mipmaps => "Mipmaps",
            Self::Patches => "Patches",
            Self::Editor => "Line editor",
        }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let (w, h) = text.split_once('x').ok_or("two numbers with an x between them, such as 400x300")?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=8192).contains(n)).ok_or("sides of 1 to 8192 pixels");
    Ok([side(w)?, side(h)?])
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("opengl: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let mut show =
        Show::new(arguments.program, arguments.size).ok_or("no memory for a window of that size")?;
    for place in clicks(&arguments.click)? {
        match place[..] {
            [x0, y0, x1, y1] => show.editor.add([[x0, y0], [x1, y1]]),
            [x, y] => show.delete([x, y]),
            _ => {}
        }
    }
    let in_window = arguments.window || (arguments.script.is_none() && arguments.out.is_none());
    if !in_window && arguments.script.is_none() {
        (show.time, show.running) = (arguments.time, false);
    }
    match show.display() {
        gl::NO_ERROR => {}
        error => return Err(format!("OpenGL error {error:#06x}").into()),
    }
    let name = show.title().to_lowercase().replace(' ', "-") + ".png";
    let mut session = Session::new(&mut show);
    if let Some(path) = &arguments.script {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let script = Script::parse(&path.display().to_string(), &text)?;
        script.replay(&mut session, |file, canvas| write(canvas, Path::new(file)))?;
    }
    let picture = if in_window {
        desktop::go_on(session, |canvas| {
            if let Err(error) = write(canvas, Path::new(&name)) {
                eprintln!("{name}: {error}");
            }
        })?
    } else {
        session.finish()
    };
    arguments.out.map_or(Ok(()), |path| write(&picture, &path))
}

fn clicks(texts: &[String]) -> Result<Vec<Vec<f64>>, String> {
    let numbers = |text: &String| -> Result<Vec<f64>, String> {
        let all: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
        all.ok().filter(|v| v.len() == 2 || v.len() == 4).ok_or(format!("not two or four numbers: {text}"))
    };
    texts.iter().map(numbers).collect()
}

/// Writes a picture as a PNG.
fn write(canvas: &Canvas, path: &Path) -> Result<(), Box<dyn Error>> {
    let rgb = |pixel: &u32| pixel.to_be_bytes().into_iter().skip(1);
    let bytes: Vec<u8> = canvas.pixels().iter().flat_map(rgb).collect();
    let file = std::fs::File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let size = [canvas.width() as u32, canvas.height() as u32];
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}
