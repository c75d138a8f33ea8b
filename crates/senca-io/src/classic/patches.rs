//! Patch files.

use std::collections::HashMap;
use std::fmt::Write;

use senca_scene::math::glam::DVec3;
use senca_scene::{BezierPatch, Scene, Shape, Warning};

use super::{index_below, running_number, surface_number};
use crate::text::Cursor;
use crate::{Files, ReadError, WriteError};

/// Reads a patch file. Other files are never asked for.
///
/// # Errors
/// With line and column where the file breaks the format.
pub fn read_patches(name: &str, bytes: &[u8], _files: &dyn Files) -> Result<Scene, ReadError> {
    let mut stream = Stream(Cursor::new(name, bytes));
    let counts = [stream.count("the number of points")?, stream.count("the number of patches")?];
    let surfaces = stream.count("the number of surfaces")?;
    let mut points = Vec::with_capacity(counts[0].min(bytes.len() / 8));
    for point in 0..counts[0] {
        points.push(stream.point(point)?);
    }
    let mut patches: Vec<BezierPatch> = Vec::with_capacity(counts[1].min(bytes.len() / 36));
    for patch in 0..counts[1] {
        let before = patches.last().map(|patch| patch.surface);
        patches.push(stream.patch(patch, before, &points)?);
    }
    let found = patches.last().map_or(0, |patch| patch.surface as usize + 1);
    let mut scene = Scene::of_shape(&crate::stem(name), Shape::BezierPatches { patches });
    if found != surfaces {
        let text = format!("{name}: the header says {surfaces} surfaces, but the patches are on {found}");
        scene.warnings.push(Warning(text));
    }
    Ok(scene)
}

/// Numbers over all lines, with remarks in braces.
struct Stream<'a>(Cursor<'a>);

impl<'a> Stream<'a> {
    /// The cursor at the next number.
    fn next(&mut self) -> Result<&mut Cursor<'a>, ReadError> {
        while self.0.start_line() && self.0.peek() == Some(b'{') {
            let start = self.0.pos;
            match memchr::memchr(b'}', self.0.rest()) {
                Some(length) => self.0.pos += length + 1,
                None => return Err(self.0.malformed(start, "the remark has no closing brace")),
            }
        }
        Ok(&mut self.0)
    }

    fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        self.next()?.count(what)
    }

    fn point(&mut self, number: usize) -> Result<DVec3, ReadError> {
        running_number(self.next()?, number, "point")?;
        let mut point = [0.0; 3];
        for (part, what) in point.iter_mut().zip(["x of a point", "y of a point", "z of a point"]) {
            *part = self.next()?.f64(what)?;
        }
        Ok(DVec3::from(point))
    }

    fn patch(
        &mut self,
        number: usize,
        before: Option<u32>,
        points: &[DVec3],
    ) -> Result<BezierPatch, ReadError> {
        running_number(self.next()?, number, "patch")?;
        let surface = surface_number(self.next()?, before, "patch")?;
        let cursor = self.next()?;
        let start = cursor.pos;
        let count = cursor.count("the number of control points")?;
        if count != 16 {
            return Err(
                cursor.malformed(start, format!("a bicubic patch has 16 control points, not {count}"))
            );
        }
        let mut corners = [DVec3::ZERO; 16];
        for corner in &mut corners {
            *corner = points[index_below(self.next()?, points.len(), "point")? as usize];
        }
        Ok(BezierPatch { points: corners, surface })
    }
}

/// Writes a patch file; equal control points are written once. Numbers read back the same.
///
/// # Errors
/// When the surface numbers do not count up from 0 in the order of the patches.
pub fn write_patches(patches: &[BezierPatch]) -> Result<Vec<u8>, WriteError> {
    let mut numbers = HashMap::new();
    let (mut points, mut rows) = (String::new(), String::new());
    let mut last = None;
    for (number, patch) in patches.iter().enumerate() {
        let allowed = last.map_or(0..=0, |last: u32| last..=last.saturating_add(1));
        if !allowed.contains(&patch.surface) {
            let message =
                format!("patch {number} is on surface {}; a patch file counts them up from 0", patch.surface);
            return Err(WriteError::Unsupported { message });
        }
        last = Some(patch.surface);
        let _ = write!(rows, "{number} {} 16", patch.surface);
        for &point in &patch.points {
            let next = numbers.len();
            let index = *numbers.entry((point + DVec3::ZERO).to_array().map(f64::to_bits)).or_insert(next);
            if index == next {
                let DVec3 { x, y, z } = point + DVec3::ZERO;
                let _ = writeln!(points, "{index} {x} {y} {z}");
            }
            let _ = write!(rows, " {index}");
        }
        rows.push('\n');
    }
    let surfaces = last.map_or(0, |last| last + 1);
    Ok(format!("{} {} {surfaces}\n{points}{rows}", numbers.len(), patches.len()).into_bytes())
}
