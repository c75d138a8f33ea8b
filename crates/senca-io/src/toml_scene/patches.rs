//! Bézier patches and NURBS surfaces.

use senca_math::glam::DVec3;
use senca_scene::{BezierPatch, NurbsSurface, Shape};

use super::shapes::points3;
use super::source::{Result, Table};
use super::values::Value;

/// `points` (one patch of 16), or `patches`: each 16 points, or a table with `points` and `surface`.
pub(super) fn bezier(table: &mut Table<'_>) -> Result<Shape> {
    if let Some(value) = table.get("points") {
        if table.has("patches") {
            return Err(value.error("give either \"points\" of one patch, or \"patches\""));
        }
        return Ok(Shape::BezierPatches {
            patches: vec![BezierPatch { points: sixteen(value)?, surface: 0 }],
        });
    }
    let value = table.require("patches")?;
    let patches = value.list("a list of patches of 16 points each", patch)?;
    if patches.is_empty() {
        return Err(value.refuse("has no patch"));
    }
    Ok(Shape::BezierPatches { patches })
}

fn patch(value: Value<'_>) -> Result<BezierPatch> {
    if !value.is_table() {
        return Ok(BezierPatch { points: sixteen(value)?, surface: 0 });
    }
    let mut table = value.table("the patch")?;
    let points = sixteen(table.require("points")?)?;
    let surface = table.read_or("surface", 0, |value| value.whole(0, u32::MAX))?;
    table.finish()?;
    Ok(BezierPatch { points, surface })
}

/// 16 points in row order, or four rows of four.
fn sixteen(value: Value<'_>) -> Result<[DVec3; 16]> {
    let wanted = "16 points [x, y, z], or four rows of four";
    let rows = value.items(wanted)?;
    let points = match rows.len() {
        4 => {
            let rows = value.list(wanted, |row| row.array::<_, 4>(wanted, Value::vec3))?;
            rows.concat()
        }
        _ => points3(value, 0)?,
    };
    <[DVec3; 16]>::try_from(points)
        .map_err(|points| value.refuse(format_args!("should be {wanted}, but has {} points", points.len())))
}

/// Rows of control points along v, each along u, with degrees, knots and weights.
pub(super) fn nurbs(table: &mut Table<'_>) -> Result<Shape> {
    let value = table.require("points")?;
    let rows = value.list("a list of rows of points [x, y, z]", |row| points3(row, 2))?;
    let counts = [rows.first().map_or(0, Vec::len), rows.len()];
    if rows.len() < 2 || rows.iter().any(|row| row.len() != counts[0]) {
        return Err(value.refuse("needs at least two rows, all with the same number of points"));
    }
    let degree = degrees(table, counts)?;
    let knots =
        [knots(table, "knots_u", degree[0], counts[0])?, knots(table, "knots_v", degree[1], counts[1])?];
    let weights = weights(table, counts)?;
    Ok(Shape::Nurbs(NurbsSurface { degree, knots, counts, points: rows.concat(), weights }))
}

/// One degree for both directions or `[u, v]`; default 3, or less where there are too few points.
fn degrees(table: &mut Table<'_>, counts: [usize; 2]) -> Result<[usize; 2]> {
    let Some(value) = table.get("degree") else { return Ok(counts.map(|count| 3.min(count - 1))) };
    let degree = |value: Value<'_>| value.whole(1, 25).map(|degree| degree as usize);
    let degrees =
        if value.is_list() { value.array("one degree or two", degree)? } else { [degree(value)?; 2] };
    match degrees.iter().zip(counts).find(|(degree, count)| *degree >= count) {
        None => Ok(degrees),
        Some((degree, count)) => {
            Err(value.refuse(format_args!("of {degree} needs more than {count} points in that direction")))
        }
    }
}

/// Given knots, or evenly spaced ones with the ends repeated so that the surface reaches its corners.
fn knots(table: &mut Table<'_>, key: &'static str, degree: usize, count: usize) -> Result<Vec<f64>> {
    let Some(value) = table.get(key) else {
        let spans = count - degree;
        return Ok((0..count + degree + 1).map(|i| i.saturating_sub(degree).min(spans) as f64).collect());
    };
    let knots = value.list("a list of numbers", Value::number)?;
    let needed = count + degree + 1;
    if knots.len() != needed {
        let message = format!("needs {count} + {degree} + 1 = {needed} knots, but has {}", knots.len());
        return Err(value.refuse(message));
    }
    if knots.windows(2).any(|pair| pair[0] > pair[1]) {
        return Err(value.refuse("must not decrease"));
    }
    if knots[degree] >= knots[count] {
        return Err(value.refuse(format_args!(
            "leaves no range: knot {degree} must be below knot {count}, counted from 0"
        )));
    }
    Ok(knots)
}

/// Rows of weights like those of the points.
fn weights(table: &mut Table<'_>, counts: [usize; 2]) -> Result<Vec<f64>> {
    let Some(value) = table.get("weights") else { return Ok(Vec::new()) };
    let rows =
        value.list("a list of rows of weights", |row| row.list("a row of weights", Value::positive))?;
    if rows.len() != counts[1] || rows.iter().any(|row| row.len() != counts[0]) {
        let message = format!("must have {} rows of {} weights, as the points have", counts[1], counts[0]);
        return Err(value.refuse(message));
    }
    Ok(rows.concat())
}
