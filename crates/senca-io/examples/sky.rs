//! Writes `sky.exr`, the surroundings of `samples/environment.toml`: 128 by 64 texels of sky, ground and
//! a sun, in linear light. Usage: `cargo run -p senca-io --example sky -- samples/sky.exr`

use std::f32::consts::{PI, TAU};

use senca_io::images::{PictureFormat, PictureOptions, encode};
use senca_math::Image;
use senca_math::LinearRgb;
use senca_math::glam::Vec3;

const WIDTH: u32 = 128;
const HEIGHT: u32 = 64;

/// Light from a unit direction.
fn light(d: Vec3) -> LinearRgb {
    let sun = Vec3::new(0.55, 0.6, 0.4).normalize();
    let (horizon, zenith) = (LinearRgb::new(0.75, 0.82, 0.92), LinearRgb::new(0.16, 0.32, 0.72));
    let ground = LinearRgb::new(0.2, 0.17, 0.13);
    let sky = if d.y > 0.0 { horizon.lerp(zenith, d.y.sqrt()) } else { ground };
    let glow = d.dot(sun).max(0.0).powi(60) * 1.5;
    let disc = if d.dot(sun) > 0.997 { 220.0 } else { 0.0 };
    sky + LinearRgb::new(1.0, 0.85, 0.6) * (glow + disc)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "sky.exr".to_owned());
    let mut image = Image::new(WIDTH, HEIGHT, [0.0, 0.0, 0.0, 1.0]);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let longitude = ((x as f32 + 0.5) / WIDTH as f32 - 0.5) * TAU;
            let polar = (y as f32 + 0.5) / HEIGHT as f32 * PI;
            let (sin, cos) = polar.sin_cos();
            let LinearRgb { r, g, b } = light(Vec3::new(sin * longitude.sin(), cos, -sin * longitude.cos()));
            image.set_pixel(x, y, [r, g, b, 1.0]);
        }
    }
    std::fs::write(path, encode(&image, PictureFormat::Exr, &PictureOptions::default())?)?;
    Ok(())
}
