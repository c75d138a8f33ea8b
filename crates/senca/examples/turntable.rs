//! A model on a turntable: reads a file of any format and draws it from eight sides.
//!
//! `cargo run --release --example turntable -- samples/teapot.toml`

use std::error::Error;
use std::path::Path;

use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::io::{load, write_file};
use senca::math::glam::DVec3;
use senca::{LookAt, Settings, Viewpoint, render};

const SIDES: u32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("which model? give its file")?;
    let scene = load(Path::new(&path))?;

    let bounds = scene.bounds();
    let distance = 1.8 * bounds.diagonal().max(1e-6);
    let mut settings = Settings { size: Some([480, 360]), ..Settings::default() };
    settings.drawing.samples = 4;

    for side in 0..SIDES {
        let angle = std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
        let towards_eye = DVec3::new(angle.sin(), 0.4, angle.cos()).normalize();
        let eye = bounds.center() + distance * towards_eye;
        settings.viewpoint = Viewpoint::LookAt(LookAt { eye: Some(eye), ..LookAt::default() });
        let (image, _) = render(&scene, &settings)?;
        let png = encode(&image, PictureFormat::Png, &PictureOptions::default())?;
        write_file(Path::new(&format!("turntable-{side}.png")), &png)?;
    }
    Ok(())
}
