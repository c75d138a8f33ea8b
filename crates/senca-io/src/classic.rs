//! The file formats of the 1991 thesis (sections 12.2 to 12.4): objects, patches, scenes, bitmaps.
//!
//! 1. Text, numbers apart by blanks. Object and scene files go by lines: what stands behind the
//!    numbers that a line needs is a remark. Patch files are a stream of numbers that may run over
//!    lines; remarks are in braces.
//! 2. Object files: a header of three numbers (vertices, polygons, surfaces; a fourth is passed
//!    over), then `index x y z` per vertex and `polygon surface count i1 .. in` per polygon. Indices
//!    and polygons count up from 0, and so do surfaces, each in one piece. Every surface is smooth in
//!    itself and creased against the others.
//! 3. Patch files: a header of points, patches, surfaces, then `index x y z` per control point and
//!    `patch surface 16 i1 .. i16` per patch, in row order.
//! 4. Scene files: see [`ClassicScene`].
//! 5. Bitmaps: see [`IndexBitmap`].

mod bitmap;
mod object;
mod patches;
mod scene;
#[cfg(test)]
mod tests;

pub use bitmap::{IndexBitmap, IntegerWidth};
pub use object::{read_object, write_object};
pub use patches::{read_patches, write_patches};
pub use scene::{ClassicObject, ClassicOperation, ClassicProjection, ClassicScene, read_scene};

use senca_scene::math::glam::DVec3;

use crate::ReadError;
use crate::text::Cursor;

/// Goes to the next line with something on it; the error names what should be there.
fn next_line(cursor: &mut Cursor<'_>, what: &str) -> Result<(), ReadError> {
    if cursor.start_line() { Ok(()) } else { Err(cursor.expected(what)) }
}

/// Three numbers; `names` in messages.
fn vector(cursor: &mut Cursor<'_>, names: [&str; 3]) -> Result<DVec3, ReadError> {
    Ok(DVec3::new(cursor.f64(names[0])?, cursor.f64(names[1])?, cursor.f64(names[2])?))
}

/// A number that must be `expected`.
fn running_number(cursor: &mut Cursor<'_>, expected: usize, what: &str) -> Result<(), ReadError> {
    cursor.skip_blanks();
    let start = cursor.pos;
    let found = cursor.integer(what)?;
    if i64::try_from(expected) == Ok(found) {
        return Ok(());
    }
    Err(cursor.malformed(start, format!("expected {what} {expected}, found {found}")))
}

/// An index below `count`.
fn index_below(cursor: &mut Cursor<'_>, count: usize, what: &str) -> Result<u32, ReadError> {
    cursor.skip_blanks();
    let start = cursor.pos;
    let index = cursor.integer(what)?;
    match u32::try_from(index) {
        Ok(index) if (index as usize) < count => Ok(index),
        _ => Err(cursor.malformed(start, format!("{what} {index} is out of range: there are {count}"))),
    }
}

/// The surface number of a polygon or patch: that of the one before, or the next.
fn surface_number(cursor: &mut Cursor<'_>, before: Option<u32>, what: &str) -> Result<u32, ReadError> {
    cursor.skip_blanks();
    let start = cursor.pos;
    let surface = cursor.integer("the surface number")?;
    let next = before.map_or(0, |before| before + 1);
    if surface == i64::from(next) || before.is_some_and(|before| surface == i64::from(before)) {
        return Ok(surface as u32);
    }
    let message = match before {
        None => format!("the first {what} must be on surface 0, not {surface}"),
        Some(before) if surface >= 0 && surface < i64::from(before) => {
            format!("returns to surface {surface}; the {what}s of a surface must stand together")
        }
        Some(before) => format!("expected surface {before} or {next}, found {surface}"),
    };
    Err(cursor.malformed(start, message))
}
