//! From rows to a mesh.

use senca_scene::math::color::linear_from_srgb;
use senca_scene::math::glam::{Vec2, Vec3, Vec4};
use senca_scene::{Mesh, Surface, Vertices};

use super::body::Body;
use super::header::{Element, Header};
use crate::ReadError;
use crate::normals::{fill_missing_normals, join_doubled_points, unit};
use crate::weld::Welder;

const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Where the parts of a colour stand among an element's properties.
#[derive(Clone, Copy)]
struct ColorColumns {
    rgb: [usize; 3],
    alpha: Option<usize>,
    /// Full intensity of whole numbers; `None` for floats.
    scale: Option<f64>,
}

impl ColorColumns {
    fn of(element: &Element) -> Option<Self> {
        let find = |names: &[&str]| element.find(names, false);
        let rgb = [
            find(&["red", "r", "diffuse_red"])?,
            find(&["green", "g", "diffuse_green"])?,
            find(&["blue", "b", "diffuse_blue"])?,
        ];
        let alpha = find(&["alpha", "a", "diffuse_alpha"]);
        Some(Self { rgb, alpha, scale: element.properties[rgb[0]].kind.color_scale() })
    }

    /// The colour in `row`, decoded.
    fn color(&self, row: &[f64]) -> Vec4 {
        let part = |column: usize| match self.scale {
            Some(scale) => linear_from_srgb((row[column] / scale) as f32),
            None => row[column] as f32,
        };
        let alpha = self.alpha.map_or(1.0, |column| row[column] / self.scale.unwrap_or(1.0));
        Vec4::new(part(self.rgb[0]), part(self.rgb[1]), part(self.rgb[2]), alpha as f32)
    }
}

/// What is read of the faces before the vertices are split.
#[derive(Default)]
struct Corners {
    vertex: Vec<u32>,
    /// Texture coordinate per corner, or empty.
    texcoord: Vec<Vec2>,
    /// Colour per corner, or empty.
    color: Vec<Vec4>,
    /// Number of corners per face.
    lengths: Vec<u32>,
}

struct Reader<'a, 'b> {
    body: &'b mut Body<'a>,
    /// Rows of the vertex element, as the header says.
    vertex_count: u64,
    mesh: Mesh,
    corners: Corners,
    small_faces: u64,
    row: Vec<f64>,
    list: Vec<f64>,
    texcoords: Vec<f64>,
}

/// Reads all elements; the second part of the result is what was odd.
pub(super) fn read(header: &Header, body: &mut Body<'_>) -> Result<(Mesh, Vec<String>), ReadError> {
    let vertex_count = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    let mut reader = Reader {
        body,
        vertex_count,
        mesh: Mesh::default(),
        corners: Corners::default(),
        small_faces: 0,
        row: Vec::new(),
        list: Vec::new(),
        texcoords: Vec::new(),
    };
    let mut seen_vertices = false;
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        reader.body.check_promise(element)?;
        match element.name.as_str() {
            "vertex" if !seen_vertices => {
                seen_vertices = true;
                reader.vertices(element)?;
            }
            "face" if element.find(&INDICES, true).is_some() => reader.faces(element)?,
            "tristrips" if element.find(&INDICES, true).is_some() => reader.strips(element)?,
            "edge" if element.find(&["vertex1"], false).is_some() => reader.edges(element)?,
            _ => reader.skip(element)?,
        }
    }
    Ok(reader.finish())
}

impl Reader<'_, '_> {
    /// Reads a row's single numbers into `row`, and the list in column `wanted` into `list`.
    fn row(
        &mut self,
        element: &Element,
        wanted: Option<usize>,
        texcoord: Option<usize>,
    ) -> Result<(), ReadError> {
        self.body.start_row(element)?;
        for (column, property) in element.properties.iter().enumerate() {
            match property.list {
                None => self.row[column] = self.body.number(property.kind, &property.name)?,
                Some(list) if Some(column) == wanted || Some(column) == texcoord => {
                    let numbers = if Some(column) == wanted { &mut self.list } else { &mut self.texcoords };
                    numbers.clear();
                    for _ in 0..self.body.length(list, &property.name)? {
                        numbers.push(self.body.number(property.kind, &property.name)?);
                    }
                }
                Some(_) => self.body.skip(property.kind, property.list, &property.name)?,
            }
        }
        self.body.end_row()
    }

    fn prepare(&mut self, element: &Element) -> usize {
        self.row.clear();
        self.row.resize(element.properties.len(), 0.0);
        element.count.min(self.body.rows_at_most(element)) as usize
    }

    fn skip(&mut self, element: &Element) -> Result<(), ReadError> {
        for _ in 0..element.count {
            self.body.start_row(element)?;
            for property in &element.properties {
                self.body.skip(property.kind, property.list, &property.name)?;
            }
            self.body.end_row()?;
        }
        Ok(())
    }

    fn vertices(&mut self, element: &Element) -> Result<(), ReadError> {
        if element.count > u64::from(u32::MAX) - 1 {
            return Err(self.body.malformed(0, "has more vertices than a mesh can hold"));
        }
        let column = |names: &[&str]| element.find(names, false);
        let three = |x, y, z| Some([column(&[x])?, column(&[y])?, column(&[z])?]);
        let Some(place) = three("x", "y", "z") else {
            return Err(self.body.malformed(0, "the element \"vertex\" needs the properties x, y and z"));
        };
        let normal = three("nx", "ny", "nz");
        let u = column(&["s", "u", "texture_u", "texcoord_u", "texture_s"]);
        let v = column(&["t", "v", "texture_v", "texcoord_v", "texture_t"]);
        let texcoord = u.zip(v);
        let color = ColorColumns::of(element);
        let expected = self.prepare(element);
        self.mesh.points.reserve(expected);
        for _ in 0..element.count {
            self.row(element, None, None)?;
            let vector =
                |[x, y, z]: [usize; 3]| Vec3::new(self.row[x] as f32, self.row[y] as f32, self.row[z] as f32);
            let vertices = &mut self.mesh.vertices;
            self.mesh.points.push(vector(place));
            vertices.normal.extend(normal.map(|columns| unit(vector(columns)).unwrap_or(Vec3::NAN)));
            vertices.texcoord0.extend(texcoord.map(|(u, v)| texcoord_of(self.row[u], self.row[v])));
            vertices.color.extend(color.map(|columns| columns.color(&self.row)));
            if self.mesh.points.last().is_some_and(|p| !p.is_finite()) {
                let pos = self.body.pos();
                return Err(self.body.malformed(pos, "the vertex before is too far away for 32-bit floats"));
            }
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element) -> Result<(), ReadError> {
        let indices = element.find(&INDICES, true);
        let texcoord = element.find(&["texcoord"], true);
        let color = ColorColumns::of(element);
        let expected = self.prepare(element);
        self.corners.vertex.reserve(3 * expected.min(1 << 24));
        self.corners.lengths.reserve(expected.min(1 << 24));
        for _ in 0..element.count {
            let start = self.body.start_row(element)?;
            self.row(element, indices, texcoord)?;
            if self.list.len() < 3 {
                self.small_faces += 1;
                continue;
            }
            let first = self.corners.vertex.len();
            for i in 0..self.list.len() {
                let vertex = self.index(self.list[i], start)?;
                self.corners.vertex.push(vertex);
            }
            self.corners.lengths.push(self.list.len() as u32);
            self.corner_attributes(first, color);
            if self.corners.vertex.len() > i32::MAX as usize {
                return Err(self.body.malformed(start, "has more corners than a mesh can hold"));
            }
        }
        Ok(())
    }

    /// Texture coordinates and colour of the corners from `first` on.
    fn corner_attributes(&mut self, first: usize, color: Option<ColorColumns>) {
        let count = self.corners.vertex.len();
        if self.texcoords.len() == 2 * (count - first) {
            self.corners.texcoord.resize(first, Vec2::ZERO);
            self.corners.texcoord.extend(self.texcoords.chunks_exact(2).map(|uv| texcoord_of(uv[0], uv[1])));
        } else if !self.corners.texcoord.is_empty() {
            self.corners.texcoord.resize(count, Vec2::ZERO);
        }
        if let Some(columns) = color {
            self.corners.color.resize(first, Vec4::ONE);
            self.corners.color.resize(count, columns.color(&self.row));
        }
    }

    /// A vertex index that the header bears out.
    #[inline]
    fn index(&self, value: f64, pos: usize) -> Result<u32, ReadError> {
        if value < 0.0 || value >= self.vertex_count as f64 || value.fract() != 0.0 {
            let message = format!("vertex {value} is out of range: there are {}", self.vertex_count);
            return Err(self.body.malformed(pos, message));
        }
        Ok(value as u32)
    }

    /// Triangle strips; -1 ends one.
    fn strips(&mut self, element: &Element) -> Result<(), ReadError> {
        let indices = element.find(&INDICES, true);
        self.prepare(element);
        for _ in 0..element.count {
            let start = self.body.start_row(element)?;
            self.row(element, indices, None)?;
            let list = std::mem::take(&mut self.list);
            for strip in list.split(|&value| value == -1.0) {
                for (i, window) in strip.windows(3).enumerate() {
                    let [a, b, c] = [
                        self.index(window[0], start)?,
                        self.index(window[1], start)?,
                        self.index(window[2], start)?,
                    ];
                    if a == b || b == c || c == a {
                        continue;
                    }
                    self.corners.vertex.extend(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    self.corners.lengths.push(3);
                }
            }
            self.list = list;
        }
        Ok(())
    }

    fn edges(&mut self, element: &Element) -> Result<(), ReadError> {
        let (Some(from), Some(to)) = (element.find(&["vertex1"], false), element.find(&["vertex2"], false))
        else {
            return self.skip(element);
        };
        self.prepare(element);
        for _ in 0..element.count {
            let start = self.body.start_row(element)?;
            self.row(element, None, None)?;
            let line = [self.index(self.row[from], start)?, self.index(self.row[to], start)?];
            self.mesh.lines.push(line);
        }
        Ok(())
    }

    fn finish(mut self) -> (Mesh, Vec<String>) {
        let mut warnings = Vec::new();
        if self.small_faces > 0 {
            warnings.push(format!("{} faces with fewer than three corners are left out", self.small_faces));
        }
        let count = self.mesh.points.len() as u32;
        self.mesh.vertices.point = (0..count).collect();
        if self.corners.lengths.is_empty() && self.mesh.lines.is_empty() {
            self.mesh.dots = (0..count).collect();
        }
        self.corners.attach(&mut self.mesh);
        fill_missing_normals(&mut self.mesh);
        join_doubled_points(&mut self.mesh);
        (self.mesh, warnings)
    }
}

fn texcoord_of(u: f64, v: f64) -> Vec2 {
    Vec2::new(u as f32, (1.0 - v) as f32)
}

impl Corners {
    /// Makes the faces of `mesh`; vertices are split where corners have attributes of their own.
    fn attach(mut self, mesh: &mut Mesh) {
        let count = self.vertex.len();
        if !self.texcoord.is_empty() || !self.color.is_empty() {
            if !self.texcoord.is_empty() {
                self.texcoord.resize(count, Vec2::ZERO);
            }
            if !self.color.is_empty() {
                self.color.resize(count, Vec4::ONE);
            }
            self.split(mesh);
        }
        if self.lengths.iter().any(|&length| length != 3) {
            let mut end = 0;
            mesh.faces.starts.push(0);
            mesh.faces.starts.extend(self.lengths.iter().map(|&length| {
                end += length;
                end
            }));
        }
        mesh.faces.corners = self.vertex;
        if !mesh.faces.is_empty() {
            mesh.surfaces.push(Surface::default());
        }
    }

    /// Gives corners with different attributes different vertices.
    fn split(&mut self, mesh: &mut Mesh) {
        let old = std::mem::take(&mut mesh.vertices);
        let mut new = Vertices::default();
        let mut welder = Welder::with_capacity(old.point.len());
        // Lines and dots keep the vertices that they name.
        let loose = mesh.lines.iter().flatten().chain(&mesh.dots).copied();
        let unsplit = if mesh.lines.is_empty() && mesh.dots.is_empty() { 0 } else { old.point.len() as u32 };
        debug_assert!(loose.clone().all(|vertex| vertex < unsplit));
        let take = |new: &mut Vertices, vertex: usize, texcoord: Option<Vec2>, color: Option<Vec4>| {
            new.point.push(old.point[vertex]);
            new.normal.extend(old.normal.get(vertex));
            new.texcoord0.extend(texcoord.or_else(|| old.texcoord0.get(vertex).copied()));
            new.color.extend(color.or_else(|| old.color.get(vertex).copied()));
        };
        let (has_texcoord, has_color) = (!self.texcoord.is_empty(), !self.color.is_empty());
        for vertex in 0..unsplit {
            take(
                &mut new,
                vertex as usize,
                has_texcoord.then_some(Vec2::ZERO),
                has_color.then_some(Vec4::ONE),
            );
        }
        for (corner, vertex) in self.vertex.iter_mut().enumerate() {
            let texcoord = self.texcoord.get(corner).copied();
            let color = self.color.get(corner).copied();
            let key = [texcoord.map(|t| t.to_array().map(f32::to_bits))];
            let key = (*vertex, key, color.map(|c| c.to_array().map(f32::to_bits)));
            let (number, is_new) = welder.number(key);
            if is_new {
                take(&mut new, *vertex as usize, texcoord, color);
            }
            *vertex = unsplit + number;
        }
        mesh.vertices = new;
    }
}
