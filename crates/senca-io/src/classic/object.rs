//! Object files.

use std::fmt::Write;

use senca_scene::{Mesh, Scene, Shape, Surface, Warning};

use super::{index_below, next_line, running_number, surface_number, vector};
use crate::text::Cursor;
use crate::{Files, ReadError, WriteError};

/// No vertex yet.
const NONE: u32 = u32::MAX;

/// Reads an object file. Other files are never asked for.
///
/// # Errors
/// With line and column where the file breaks the format.
pub fn read_object(name: &str, bytes: &[u8], _files: &dyn Files) -> Result<Scene, ReadError> {
    let (mesh, warnings) = mesh(name, bytes)?;
    let mut scene = Scene::of_shape(&crate::stem(name), Shape::Mesh(mesh));
    scene.warnings = warnings;
    Ok(scene)
}

/// The mesh in an object file, and what was odd.
pub(super) fn mesh(name: &str, bytes: &[u8]) -> Result<(Mesh, Vec<Warning>), ReadError> {
    let mut cursor = Cursor::new(name, bytes);
    let [vertices, polygons, surfaces] = header(&mut cursor)?;
    let mut mesh = Mesh::default();
    mesh.points.reserve(vertices.min(bytes.len() / 8));
    for vertex in 0..vertices {
        next_line(&mut cursor, &format!("vertex {vertex}"))?;
        running_number(&mut cursor, vertex, "vertex")?;
        let start = cursor.pos;
        let place = vector(&mut cursor, ["x of a vertex", "y of a vertex", "z of a vertex"])?.as_vec3();
        if !place.is_finite() {
            return Err(cursor.malformed(start, "the vertex is too far away for 32-bit floats"));
        }
        mesh.points.push(place);
        cursor.next_line();
    }
    let mut builder =
        Builder { vertex_of_point: vec![NONE; mesh.points.len()], surface: None, corners: Vec::new() };
    for polygon in 0..polygons {
        next_line(&mut cursor, &format!("polygon {polygon}"))?;
        running_number(&mut cursor, polygon, "polygon")?;
        builder.polygon(&mut cursor, &mut mesh)?;
        cursor.next_line();
    }
    Ok(finish(name, mesh, builder.surface, surfaces))
}

/// Numbers of vertices, polygons and surfaces.
fn header(cursor: &mut Cursor<'_>) -> Result<[usize; 3], ReadError> {
    next_line(cursor, "the number of vertices")?;
    let start = cursor.pos;
    let counts = [
        cursor.count("the number of vertices")?,
        cursor.count("the number of polygons")?,
        cursor.count("the number of surfaces")?,
    ];
    if counts[0] >= NONE as usize {
        return Err(cursor.malformed(start, "more vertices than a mesh can hold"));
    }
    cursor.next_line();
    Ok(counts)
}

/// Makes vertices per surface.
struct Builder {
    /// The current surface's vertex of each point; older surfaces' vertices are recognized by being
    /// below the first of the current one.
    vertex_of_point: Vec<u32>,
    surface: Option<(u32, u32)>,
    corners: Vec<u32>,
}

impl Builder {
    fn polygon(&mut self, cursor: &mut Cursor<'_>, mesh: &mut Mesh) -> Result<(), ReadError> {
        let before = self.surface.map(|(surface, _)| surface);
        let surface = surface_number(cursor, before, "polygon")?;
        if before != Some(surface) {
            self.surface = Some((surface, mesh.vertices.point.len() as u32));
        }
        cursor.skip_blanks();
        let start = cursor.pos;
        let count = cursor.count("the number of corners")?;
        if count < 3 {
            return Err(cursor.malformed(start, format!("a polygon has at least 3 corners, not {count}")));
        }
        self.corners.clear();
        for _ in 0..count {
            let point = index_below(cursor, mesh.points.len(), "vertex")?;
            let vertex = self.vertex(point, mesh);
            self.corners.push(vertex);
        }
        mesh.faces.push(&self.corners, surface);
        Ok(())
    }

    fn vertex(&mut self, point: u32, mesh: &mut Mesh) -> u32 {
        let first = self.surface.map_or(0, |(_, first)| first);
        let known = self.vertex_of_point[point as usize];
        if known != NONE && known >= first {
            return known;
        }
        mesh.vertices.point.push(point);
        let vertex = mesh.vertices.point.len() as u32 - 1;
        self.vertex_of_point[point as usize] = vertex;
        vertex
    }
}

fn finish(name: &str, mut mesh: Mesh, last: Option<(u32, u32)>, surfaces: usize) -> (Mesh, Vec<Warning>) {
    let count = last.map_or(0, |(surface, _)| surface as usize + 1);
    mesh.surfaces = vec![Surface::default(); count];
    let mut warnings = Vec::new();
    if count != surfaces {
        let text = format!("{name}: the header says {surfaces} surfaces, but the polygons are on {count}");
        warnings.push(Warning(text));
    }
    if mesh.faces.is_empty() {
        mesh.vertices.point = (0..mesh.points.len() as u32).collect();
        mesh.dots = mesh.vertices.point.clone();
    }
    (mesh, warnings)
}

/// Writes an object file with six decimals. Polygons are grouped by surface, which keeps their order
/// within a surface; surfaces without polygons are left out. A flat surface becomes one surface per
/// polygon.
///
/// # Errors
/// When the mesh has lines or dots but no polygons, which the format cannot hold.
pub fn write_object(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    if mesh.faces.is_empty() && !(mesh.lines.is_empty() && mesh.dots.is_empty()) {
        let message = "a 1991 object file holds polygons only; PLY and OBJ hold lines and dots".to_owned();
        return Err(WriteError::Unsupported { message });
    }
    let mut order: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    order.sort_by_key(|&face| mesh.faces.surface_of(face as usize));
    let mut text = String::new();
    let mut written = None;
    let mut number = 0u32;
    for (polygon, &face) in order.iter().enumerate() {
        let surface = mesh.faces.surface_of(face as usize);
        let flat = mesh.surfaces.get(surface as usize).is_some_and(|surface| !surface.smooth);
        if written.is_some_and(|written| written != surface || flat) {
            number += 1;
        }
        written = Some(surface);
        let corners = mesh.faces.corners_of(face as usize);
        let _ = write!(text, "{polygon} {number} {}", corners.len());
        for &corner in corners {
            let _ = write!(text, " {}", mesh.vertices.point[corner as usize]);
        }
        text.push('\n');
    }
    let surfaces = if order.is_empty() { 0 } else { number + 1 };
    let mut all = format!("{} {} {surfaces}\n", mesh.points.len(), order.len());
    for (index, point) in mesh.points.iter().enumerate() {
        let [x, y, z] = point.to_array().map(|v| decimals(f64::from(v)));
        let _ = writeln!(all, "{index} {x} {y} {z}");
    }
    all.push_str(&text);
    Ok(all.into_bytes())
}

/// Six decimals, without a sign before zero.
fn decimals(value: f64) -> String {
    let text = format!("{value:.6}");
    if text == "-0.000000" { "0.000000".to_owned() } else { text }
}
