//! The sample programs and exercises of the course text, chapter 5, drawn without a window.
//!
//! `cargo run --release -p senca-gl --example opengl -- surface --out surface.png`

mod exercises;
mod letters;
mod samples;
mod solids;

use clap::{Parser, ValueEnum};
use senca_gl::{Config, Context, gl};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Draws a program of chapter 5 into a PNG.
#[derive(Parser)]
struct Arguments {
    /// What to draw.
    program: Name,
    /// The picture.
    #[arg(long)]
    out: PathBuf,
    /// Width and height in pixels, such as 400x300. Default: those of the text.
    #[arg(long, value_parser = size)]
    size: Option<[u32; 2]>,
    /// Moment of an animation, 0 to 1.
    #[arg(long, default_value_t = 0.5)]
    time: f64,
    /// Clicks of the line editor in pixels from the lower left corner: x,y,x,y draws a segment, x,y deletes one.
    #[arg(long, value_delimiter = ' ')]
    click: Vec<String>,
}

#[derive(Clone, Copy, ValueEnum)]
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

fn size(text: &str) -> Result<[u32; 2], String> {
    let (w, h) = text.split_once('x').ok_or("two numbers with an x between them, such as 400x300")?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=8192).contains(n)).ok_or("sides of 1 to 8192 pixels");
    Ok([side(w)?, side(h)?])
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let own = if matches!(arguments.program, Name::First) { 300 } else { 400 };
    let [width, height] = arguments.size.unwrap_or([own; 2]);
    let mut c = Context::new(Config::default());
    if !c.resize(width, height) {
        return Err(format!("no memory for a window of {width} x {height} pixels").into());
    }
    c.viewport(0, 0, width as i32, height as i32);
    c.clear_color([0.0, 0.0, 0.0, 1.0]);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    let aspect = f64::from(width) / f64::from(height);
    match arguments.program {
        Name::First => samples::first(&mut c, aspect),
        Name::Texture => samples::texture(&mut c, aspect),
        Name::Curve => samples::curve(&mut c, aspect),
        Name::Surface => samples::surface(&mut c, aspect),
        Name::Primitives => exercises::primitives(&mut c, aspect),
        Name::Waves => exercises::waves(&mut c, aspect),
        Name::Ellipses => exercises::ellipses(&mut c, aspect),
        Name::Bodies => exercises::bodies(&mut c, aspect, 1.0, None),
        Name::Approach => exercises::bodies(&mut c, aspect, arguments.time, None),
        Name::Textures => exercises::bodies(&mut c, aspect, 1.0, Some(gl::LINEAR)),
        Name::Mipmaps => exercises::bodies(&mut c, aspect, 1.0, Some(gl::LINEAR_MIPMAP_LINEAR)),
        Name::Patches => exercises::patches(&mut c, aspect),
        Name::Editor => exercises::editor(&mut c, [width, height], &clicks(&arguments.click)?),
    }
    c.finish();
    match c.get_error() {
        gl::NO_ERROR => write(&c, [width, height], &arguments.out),
        error => Err(format!("OpenGL error {error:#06x}").into()),
    }
}

fn clicks(texts: &[String]) -> Result<Vec<Vec<f64>>, String> {
    let numbers = |text: &String| -> Result<Vec<f64>, String> {
        let all: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
        all.ok().filter(|v| v.len() == 2 || v.len() == 4).ok_or(format!("not two or four numbers: {text}"))
    };
    texts.iter().map(numbers).collect()
}

/// Writes the window, whose lowest row comes first, as a PNG.
fn write(c: &Context, [width, height]: [u32; 2], path: &Path) -> Result<(), Box<dyn Error>> {
    let rows = c.window_pixels().chunks(width as usize).rev();
    let bytes: Vec<u8> = rows.flatten().flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(std::fs::File::create(path)?), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}
