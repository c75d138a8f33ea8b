//! `senca compare`: how far a picture is from another one.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};
use senca::Image;
use senca::io::Limits;
use senca::io::images::{PictureFormat, PictureOptions, decode_picture, encode};

use crate::cli::input::read_bytes;
use crate::cli::output::{self, check_writable};
use crate::cli::values::positive;
use crate::cli::{Failure, Interrupt};

/// Which pictures.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Picture: .exr and .pfm hold light itself, others what displays show of it; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    picture: PathBuf,

    /// Picture of the same size to compare it with
    #[arg(value_hint = ValueHint::FilePath)]
    reference: PathBuf,

    /// Writes a picture of the difference, without its sign, component by component
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Factor on the difference in that picture
    #[arg(long, value_name = "FACTOR", value_parser = positive, default_value = "1")]
    times: f64,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Figures of a difference, of red, green and blue as light.
struct Figures {
    /// Root of the mean square, as a share of the reference's mean.
    relative_rmse: f64,
    /// The picture's mean as a share of the reference's.
    mean_ratio: f64,
    /// Largest difference of a component, and the column and row of the pixel.
    largest: (f64, u32, u32),
}

/// Compares the pictures.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = arguments.output.as_deref();
    out.map_or(Ok(()), check_writable)?;
    let interrupt = Interrupt::listen();
    let [picture, reference] = [&arguments.picture, &arguments.reference].map(|path| read(path));
    let (picture, reference) = (picture?, reference?);
    let sizes = [&picture, &reference].map(|image| [image.width(), image.height()]);
    if sizes[0] != sizes[1] {
        let [[w, h], [x, y]] = sizes;
        return Err(Failure::input(format!(
            "{} has {w}x{h} pixels and {} has {x}x{y}; only pictures of one size are compared",
            arguments.picture.display(),
            arguments.reference.display()
        )));
    }
    if let Some(path) = out {
        let difference = difference(&picture, &reference, arguments.times as f32);
        output::write(path, &encode(&difference, format(path)?, &PictureOptions::default())?, &interrupt)?;
    }
    let figures = figures(&picture, &reference);
    output::print(&if arguments.json { json(&figures) } else { text(&figures) })
}

fn read(path: &Path) -> Result<Image, Failure> {
    let (name, bytes) = read_bytes(path)?;
    Ok(decode_picture(&name, &bytes, &Limits::default())?)
}

fn format(path: &Path) -> Result<PictureFormat, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    PictureFormat::from_extension(&extension).ok_or_else(|| {
        let known: Vec<_> = PictureFormat::ALL.iter().map(|f| f.extension()).collect();
        Failure::usage(format!("\"{extension}\" names no picture format; there are: {}", known.join(", ")))
    })
}

fn difference(picture: &Image, reference: &Image, times: f32) -> Image {
    let mut image = Image::new(picture.width(), picture.height(), [0.0, 0.0, 0.0, 1.0]);
    for y in 0..image.height() {
        for x in 0..image.width() {
            let (a, b) = (picture.pixel(x, y), reference.pixel(x, y));
            let [r, g, b] = [0, 1, 2].map(|k| times * (a[k] - b[k]).abs());
            image.set_pixel(x, y, [r, g, b, 1.0]);
        }
    }
    image
}

fn figures(picture: &Image, reference: &Image) -> Figures {
    let (mut squares, mut sum, mut all) = (0.0, 0.0, 0.0);
    let mut largest = (0.0, 0, 0);
    for y in 0..picture.height() {
        for x in 0..picture.width() {
            let (a, b) = (picture.pixel(x, y), reference.pixel(x, y));
            for (a, b) in a.iter().zip(&b).take(3).map(|(&a, &b)| (f64::from(a), f64::from(b))) {
                squares += (a - b) * (a - b);
                (sum, all) = (sum + a, all + b);
                if (a - b).abs() > largest.0 {
                    largest = ((a - b).abs(), x, y);
                }
            }
        }
    }
    let count = 3.0 * f64::from(picture.width()) * f64::from(picture.height());
    let mean = all / count;
    let share = |value: f64| if mean > 0.0 { value / mean } else { value };
    Figures {
        relative_rmse: share((squares / count).sqrt()),
        mean_ratio: if all == sum { 1.0 } else { share(sum / count) },
        largest,
    }
}

fn text(figures: &Figures) -> String {
    let (largest, x, y) = figures.largest;
    format!(
        "relative RMSE       {:.4} %\nmean to reference's {:.6}\nlargest difference  {largest:.6} at pixel {x},{y}\n",
        100.0 * figures.relative_rmse,
        figures.mean_ratio
    )
}

fn json(figures: &Figures) -> String {
    let (largest, x, y) = figures.largest;
    format!(
        "{{\"relative_rmse\": {:e}, \"mean_ratio\": {:e}, \"largest\": {largest:e}, \"pixel\": [{x}, {y}]}}\n",
        figures.relative_rmse, figures.mean_ratio
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_difference() {
        let reference = Image::new(2, 2, [1.0, 1.0, 1.0, 1.0]);
        let mut picture = reference.clone();
        picture.set_pixel(1, 0, [1.0, 4.0, 1.0, 1.0]);
        let found = figures(&picture, &reference);
        assert!((found.relative_rmse - (9.0f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!((found.mean_ratio - 1.25).abs() < 1e-12);
        assert_eq!(found.largest, (3.0, 1, 0));
        assert_eq!(difference(&picture, &reference, 0.5).pixel(1, 0), [0.0, 1.5, 0.0, 1.0]);
        assert_eq!(difference(&picture, &reference, 0.5).pixel(0, 1), [0.0, 0.0, 0.0, 1.0]);
    }
}
