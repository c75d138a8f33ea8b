//! Wavefront OBJ (Alias|Wavefront, Advanced Visualizer manual, appendix B1).
//!
//! 1. Each object (`o`) becomes a geometry with a node; each combination of material and smoothing
//!    group in it becomes a [`Surface`](senca_scene::Surface), which has the name of its group (`g`)
//!    if it is the only one there.
//! 2. Faces stay polygons, convex or not. Faces with fewer than three corners are left out with a
//!    warning.
//! 3. Normals that the file gives are normalized; missing ones stay missing. Faces of one smoothing
//!    group share vertices, so that normals computed later run smoothly across material borders;
//!    between groups there is a crease. `s off` makes flat faces; a file that never says `s` is
//!    smooth.
//! 4. Texture coordinates count from the bottom in the file and from the top in a mesh: v is
//!    turned over.
//! 5. Colours behind a position (`v x y z r g b`) are sRGB, as painting programs write them, either
//!    0 to 1 or 0 to 255 throughout.
//! 6. A file of nothing but positions is a cloud of dots.
//! 7. Free-form surfaces in Bézier and B-spline bases, rational or not, become patches and NURBS; other
//!    bases, curves and trims give a warning.
//! 8. Statements that only other renderers need are passed over; ones that change the form and are
//!    not known give a warning.

mod build;
mod freeform;
mod parse;
#[cfg(test)]
mod tests;
mod write;

pub use write::{ObjOutput, write};

use senca_scene::Scene;

use crate::{Files, Location, ReadError};

/// Reads an OBJ file with the material libraries it names.
///
/// # Errors
/// With line and column when a number is malformed, an index is out of range or no statement of the
/// format is there at all. A missing material library is a warning of the scene.
pub fn read(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    if u32::try_from(bytes.len()).is_err() {
        return Err(ReadError::limit(Location::file(name), "an OBJ file must be smaller than 4 GiB"));
    }
    let soup = parse::parse(name, bytes)?;
    build::build(name, soup, files)
}
