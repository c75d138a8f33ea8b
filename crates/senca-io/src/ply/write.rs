//! From a scene to a PLY file.

use senca_scene::math::glam::{Vec2, Vec3, Vec4};
use senca_scene::math::{LinearRgb, Srgb8};
use senca_scene::{Scene, TessellationSettings};

use crate::WriteError;
use crate::flatten::{Placed, placed_meshes};

/// The kinds of PLY files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlyEncoding {
    /// Binary, lowest byte first.
    #[default]
    LittleEndian,
    /// Binary, highest byte first.
    BigEndian,
    /// Readable.
    Text,
}

/// Writes all meshes of `scene` in world coordinates as one. Shapes other than meshes are tessellated
/// by `settings`; polygons stay polygons, lines become edges. Normals, texture coordinates and colours
/// are written if any mesh has them; the vertices are then the meshes' vertices, else their points.
/// Colours are 8-bit sRGB, or linear floats where one is brighter than white. Numbers read back the
/// same.
///
/// # Errors
/// When a shape or mesh is not sound, or there are more vertices than 32 bits can number.
pub fn write(
    scene: &Scene,
    encoding: PlyEncoding,
    settings: &TessellationSettings,
) -> Result<Vec<u8>, WriteError> {
    let table = Table::of(&placed_meshes(scene, settings)?)?;
    let mut out = Out { bytes: table.header(encoding), encoding, first: true };
    for vertex in 0..table.points.len() {
        table.vertex(vertex, &mut out);
    }
    for face in &table.faces {
        match table.longest_face {
            0..=255 => out.byte(face.len() as u8),
            _ => out.word(face.len() as u32),
        }
        face.iter().for_each(|&corner| out.word(corner));
        out.end_row();
    }
    for line in table.lines.iter().flatten().collect::<Vec<_>>().chunks(2) {
        line.iter().for_each(|&&vertex| out.word(vertex));
        out.end_row();
    }
    Ok(out.bytes)
}

/// All meshes as one.
#[derive(Default)]
struct Table {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    texcoords: Vec<Vec2>,
    colors: Vec<Vec4>,
    /// Whether colours are written as floats.
    bright: bool,
    faces: Vec<Vec<u32>>,
    longest_face: usize,
    lines: Vec<[u32; 2]>,
}

impl Table {
    fn of(meshes: &[Placed<'_>]) -> Result<Self, WriteError> {
        let mut table = Self::default();
        let any = |has: &dyn Fn(&Placed<'_>) -> bool| meshes.iter().any(has);
        let with_normals = any(&|placed| !placed.mesh.vertices.normal.is_empty());
        let with_texcoords = any(&|placed| !placed.mesh.vertices.texcoord0.is_empty());
        let with_colors = any(&|placed| !placed.mesh.vertices.color.is_empty());
        let by_vertex = with_normals || with_texcoords || with_colors;
        for placed in meshes {
            let (mesh, vertices) = (&*placed.mesh, &placed.mesh.vertices);
            let count = if by_vertex { vertices.point.len() } else { mesh.points.len() };
            let Ok(base) = u32::try_from(table.points.len() + count).map(|end| end - count as u32) else {
                let message = "there are more vertices than a PLY file can number".to_owned();
                return Err(WriteError::Unsupported { message });
            };
            if by_vertex {
                table.points.extend(vertices.point.iter().map(|&point| mesh.points[point as usize]));
            } else {
                table.points.extend(&mesh.points);
            }
            let end = table.points.len();
            let index = |&v: &u32| base + if by_vertex { v } else { vertices.point[v as usize] };
            table.faces.extend(mesh.faces.iter().map(|face| face.iter().map(index).collect()));
            table.lines.extend(mesh.lines.iter().map(|line| [index(&line[0]), index(&line[1])]));
            if with_normals {
                table.normals.extend(&vertices.normal);
                table.normals.resize(end, Vec3::ZERO);
            }
            if with_texcoords {
                table.texcoords.extend(&vertices.texcoord0);
                table.texcoords.resize(end, Vec2::ZERO);
            }
            if with_colors {
                table.colors.extend(&vertices.color);
                table.colors.resize(end, Vec4::ONE);
            }
        }
        table.bright = table.colors.iter().any(|color| color.max_element() > 1.0);
        table.longest_face = table.faces.iter().map(Vec::len).max().unwrap_or(0);
        Ok(table)
    }

    fn header(&self, encoding: PlyEncoding) -> Vec<u8> {
        let format = match encoding {
            PlyEncoding::LittleEndian => "binary_little_endian",
            PlyEncoding::BigEndian => "binary_big_endian",
            PlyEncoding::Text => "ascii",
        };
        let mut lines = vec!["ply".to_owned(), format!("format {format} 1.0")];
        let properties = |kind: &str, names: &[&str]| {
            names.iter().map(|name| format!("property {kind} {name}")).collect::<Vec<_>>()
        };
        lines.push(format!("element vertex {}", self.points.len()));
        lines.extend(properties("float", &["x", "y", "z"]));
        if !self.normals.is_empty() {
            lines.extend(properties("float", &["nx", "ny", "nz"]));
        }
        if !self.texcoords.is_empty() {
            lines.extend(properties("float", &["s", "t"]));
        }
        if !self.colors.is_empty() {
            let kind = if self.bright { "float" } else { "uchar" };
            lines.extend(properties(kind, &["red", "green", "blue", "alpha"]));
        }
        if !self.faces.is_empty() {
            lines.push(format!("element face {}", self.faces.len()));
            let kind = if self.longest_face < 256 { "uchar" } else { "uint" };
            lines.extend(properties(&format!("list {kind} uint"), &["vertex_indices"]));
        }
        if !self.lines.is_empty() {
            lines.push(format!("element edge {}", self.lines.len()));
            lines.extend(properties("uint", &["vertex1", "vertex2"]));
        }
        lines.push("end_header\n".to_owned());
        lines.join("\n").into_bytes()
    }

    fn vertex(&self, vertex: usize, out: &mut Out) {
        self.points[vertex].to_array().iter().for_each(|&v| out.float(v));
        if let Some(normal) = self.normals.get(vertex) {
            normal.to_array().iter().for_each(|&v| out.float(v));
        }
        if let Some(uv) = self.texcoords.get(vertex) {
            out.float(uv.x);
            out.float(1.0 - uv.y);
        }
        match self.colors.get(vertex) {
            Some(color) if self.bright => color.to_array().iter().for_each(|&v| out.float(v)),
            Some(color) => {
                let Srgb8 { r, g, b } = LinearRgb::new(color.x, color.y, color.z).to_srgb8();
                let alpha = (color.w.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
                [r, g, b, alpha].iter().for_each(|&v| out.byte(v));
            }
            None => {}
        }
        out.end_row();
    }
}

/// Numbers in one of the encodings.
struct Out {
    bytes: Vec<u8>,
    encoding: PlyEncoding,
    /// Whether the row has no number yet.
    first: bool,
}

impl Out {
    fn put(&mut self, little: &[u8], text: impl std::fmt::Display) {
        match self.encoding {
            PlyEncoding::LittleEndian => self.bytes.extend(little),
            PlyEncoding::BigEndian => self.bytes.extend(little.iter().rev()),
            PlyEncoding::Text => {
                let blank = if self.first { "" } else { " " };
                self.bytes.extend(format!("{blank}{text}").into_bytes());
                self.first = false;
            }
        }
    }

    fn float(&mut self, value: f32) {
        self.put(&value.to_le_bytes(), value);
    }

    fn word(&mut self, value: u32) {
        self.put(&value.to_le_bytes(), value);
    }

    fn byte(&mut self, value: u8) {
        self.put(&[value], value);
    }

    fn end_row(&mut self) {
        if self.encoding == PlyEncoding::Text {
            self.bytes.push(b'\n');
            self.first = true;
        }
    }
}
