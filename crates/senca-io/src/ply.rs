//! PLY, the polygon file format (Turk 1994), text and binary in both byte orders.
//!
//! 1. Elements and properties may come in any order and type; unknown ones are skipped.
//! 2. Vertices: `x y z`, normals `nx ny nz`, texture coordinates (`s t`, `u v`, `texture_u
//!    texture_v`, `texcoord_u texcoord_v`; v counts from the bottom), colours `red green blue alpha`
//!    (also `r g b a` and `diffuse_` ones): whole numbers are sRGB, floats are linear.
//! 3. Faces: `vertex_indices` or `vertex_index`, with a colour of their own or a list `texcoord` of
//!    two numbers a corner if the file has them. `tristrips` become triangles, `edge`s lines.
//! 4. A file without faces and edges is a cloud of dots.
//! 5. Counts in the header are promises: nothing is allocated that the file's bytes do not bear out.

mod body;
mod header;
mod mesh;
#[cfg(test)]
mod tests;
mod write;

pub use write::{PlyEncoding, write};

use senca_scene::{Scene, Shape, Warning};

use crate::{Files, ReadError};

/// Reads a PLY file. Other files are never asked for.
///
/// # Errors
/// With line and column (header and text) or byte (binary) where the file breaks the format.
pub fn read(name: &str, bytes: &[u8], _files: &dyn Files) -> Result<Scene, ReadError> {
    let header = header::read(name, bytes)?;
    let mut body = body::Body::new(name, bytes, &header);
    let (mesh, warnings) = mesh::read(&header, &mut body)?;
    let mut scene = Scene::of_shape(&crate::stem(name), Shape::Mesh(mesh));
    scene.warnings = warnings.into_iter().map(Warning).collect();
    Ok(scene)
}
