//! The exercises as programs that are driven by mouse and keys.
//!
//! Each gets what its exercise reads, and can be run in a window or replayed from a script. Their
//! titles tell what is to be done next and what has been found out.

mod curve;
mod fractal;
mod line;
mod polygon;
mod shading;
mod solid;
mod system;
mod triangle;
mod vectors;
mod view;

pub use curve::CurveProgram;
pub use fractal::FractalProgram;
pub use line::LineProgram;
pub use polygon::PolygonProgram;
pub use shading::ShadingProgram;
pub use solid::SolidProgram;
pub use system::SystemProgram;
pub use triangle::TriangleProgram;
pub use vectors::VectorsProgram;
pub use view::ViewProgram;

use super::vectors::Row3;

/// By how much a key moves a coordinate.
const STEP: f64 = 0.25;

/// Moves the coordinate that a key names: x, y, z down, X, Y, Z up. Whether it is such a key.
fn move_by_key(point: &mut Row3, key: char) -> bool {
    let Some(axis) = ['x', 'y', 'z'].into_iter().position(|c| c == key.to_ascii_lowercase()) else {
        return false;
    };
    point[axis] += if key.is_ascii_uppercase() { STEP } else { -STEP };
    true
}

/// A point for titles.
fn told([x, y, z]: Row3) -> String {
    format!("({x:.2}, {y:.2}, {z:.2})")
}

#[cfg(test)]
mod tests;
