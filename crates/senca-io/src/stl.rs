//! STL, text and binary (3D Systems, StereoLithography interface specification, 1989).
//!
//! 1. A file is binary when its length is the one its count of facets asks for, whatever its first
//!    word; a file that is not and begins with `solid` is text.
//! 2. Equal corners are welded into one point, so that the mesh is closed where the solid is.
//! 3. Facet normals are kept; facets whose normal is zero or no number get the one of their corners.
//!    Where no facet has a normal the mesh has none, and its surfaces are flat.
//! 4. The two spare bytes of a binary facet may hold a colour, as VisCAM and SolidView or as Magics
//!    (whose header says `COLOR=`) write it.

#[cfg(test)]
mod tests;
mod write;

pub use write::{StlEncoding, write};

use senca_scene::math::Srgb8;
use senca_scene::math::glam::{Vec3, Vec4};
use senca_scene::{Mesh, Scene, Shape, Surface, Warning};

use crate::normals::unit;
use crate::text::Cursor;
use crate::weld::{Welder, point_key};
use crate::{Files, Location, ReadError};

/// Bytes before the facets of a binary file: 80 of header, 4 of count.
const HEAD: usize = 84;
/// Bytes of a binary facet.
const FACET: usize = 50;

/// Reads an STL file. Other files are never asked for.
///
/// # Errors
/// With line and column (text) or byte (binary) where the file breaks the format.
pub fn read(name: &str, bytes: &[u8], _files: &dyn Files) -> Result<Scene, ReadError> {
    if bytes.len() as u64 > FACET as u64 * (u64::from(u32::MAX) / 3) {
        return Err(ReadError::limit(Location::file(name), "has more facets than a mesh can hold"));
    }
    let mut facets = if is_text(bytes) { read_text(name, bytes)? } else { read_binary(name, bytes)? };
    let warnings = std::mem::take(&mut facets.warnings);
    let title = facets.title();
    let mut scene = Scene::of_shape(&title, Shape::Mesh(facets.into_mesh()));
    scene.warnings = warnings.into_iter().map(Warning).collect();
    Ok(scene)
}

/// Whether these bytes are a text file, if they are an STL file at all.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let solid = head.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    solid && !is_binary(bytes) && !bytes[..bytes.len().min(512)].contains(&0)
}

/// Whether the length is the one that the count of a binary file asks for.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| bytes.len() as u64 == HEAD as u64 + FACET as u64 * u64::from(count))
}

fn count(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(80..)?.first_chunk()?))
}

/// Facets as they are read.
#[derive(Default)]
struct Facets {
    corners: Vec<[Vec3; 3]>,
    /// Zero where the file gives none.
    normals: Vec<Vec3>,
    /// Empty or one per facet; `None` is uncoloured.
    colors: Vec<Option<Srgb8>>,
    /// Names of the solids, and the facet each begins with.
    solids: Vec<(String, u32)>,
    warnings: Vec<String>,
    file: String,
}

fn read_binary(name: &str, bytes: &[u8]) -> Result<Facets, ReadError> {
    let mut facets = Facets { file: name.to_owned(), ..Facets::default() };
    let Some(count) = count(bytes) else {
        let message = format!("a binary STL file has at least {HEAD} bytes, this has {}", bytes.len());
        return Err(ReadError::malformed(Location::byte(name, bytes.len() as u64), message));
    };
    let body = &bytes[HEAD..];
    let there = (body.len() / FACET) as u64;
    if there < u64::from(count) {
        let message = format!("says {count} facets, but ends within facet {there} (from 0)");
        return Err(ReadError::malformed(Location::byte(name, bytes.len() as u64), message));
    }
    if body.len() > FACET * count as usize {
        let extra = body.len() - FACET * count as usize;
        facets
            .warnings
            .push(format!("{name}: {extra} bytes behind the last of {count} facets are passed over"));
    }
    let magics = Magics::of_header(&bytes[..80]);
    let mut colored = magics.is_some();
    for (i, facet) in body.chunks_exact(FACET).take(count as usize).enumerate() {
        let vector = |k: usize| -> Vec3 {
            let float =
                |j: usize| f32::from_le_bytes(*facet[12 * k + 4 * j..].first_chunk().unwrap_or(&[0; 4]));
            Vec3::new(float(0), float(1), float(2))
        };
        let corners = [vector(1), vector(2), vector(3)];
        if let Some(k) = corners.iter().position(|corner| !corner.is_finite()) {
            let at = Location::byte(name, (HEAD + FACET * i + 12 * (k + 1)) as u64);
            return Err(ReadError::malformed(at, format!("corner {k} of facet {i} is not a finite place")));
        }
        facets.push(corners, vector(0));
        let word = u16::from_le_bytes([facet[48], facet[49]]);
        let color = magics.as_ref().map_or_else(|| viscam_color(word), |magics| Some(magics.color(word)));
        colored |= color.is_some();
        facets.colors.push(color);
    }
    if !colored {
        facets.colors.clear();
    }
    Ok(facets)
}

/// Colour of a facet after VisCAM and SolidView: bit 15 says that there is one, red on top.
fn viscam_color(word: u16) -> Option<Srgb8> {
    let part = |shift: u16| five_bits(word >> shift);
    (word & 0x8000 != 0).then(|| Srgb8 { r: part(10), g: part(5), b: part(0) })
}

fn five_bits(word: u16) -> u8 {
    ((word & 31) * 255 / 31) as u8
}

/// Materialise Magics' colours: one for the whole in the header, facets' own with bit 15 clear, red
/// at the bottom.
struct Magics {
    whole: Srgb8,
}

impl Magics {
    fn of_header(header: &[u8]) -> Option<Self> {
        let at = header.windows(6).position(|window| window == b"COLOR=")?;
        let [r, g, b] = *header[at + 6..].first_chunk()?;
        Some(Self { whole: Srgb8 { r, g, b } })
    }

    fn color(&self, word: u16) -> Srgb8 {
        let part = |shift: u16| five_bits(word >> shift);
        if word & 0x8000 == 0 { Srgb8 { r: part(0), g: part(5), b: part(10) } } else { self.whole }
    }
}

fn read_text(name: &str, bytes: &[u8]) -> Result<Facets, ReadError> {
    let mut reader = Text { cursor: Cursor::new(name, bytes), facets: Facets::default() };
    reader.facets.file = name.to_owned();
    while reader.cursor.start_line() {
        reader.solid()?;
    }
    Ok(reader.facets)
}

struct Text<'a> {
    cursor: Cursor<'a>,
    facets: Facets,
}

impl Text<'_> {
    /// Reads from `solid` to `endsolid`.
    fn solid(&mut self) -> Result<(), ReadError> {
        self.keyword("solid")?;
        let name = self.cursor.rest_of_line();
        self.facets.solids.push((name, self.facets.corners.len() as u32));
        while self.cursor.start_line() {
            if self.next_is("endsolid") {
                self.cursor.next_line();
                return Ok(());
            }
            self.facet()?;
        }
        Err(self.cursor.expected("\"facet\" or \"endsolid\""))
    }

    fn facet(&mut self) -> Result<(), ReadError> {
        if !self.next_is("facet") {
            return Err(self.cursor.expected("\"facet\" or \"endsolid\""));
        }
        self.keyword("facet")?;
        self.keyword("normal")?;
        let normal = self.normal()?;
        self.keyword("outer")?;
        self.keyword("loop")?;
        let mut corners = [Vec3::ZERO; 3];
        for corner in &mut corners {
            self.keyword("vertex")?;
            *corner = Vec3::new(
                self.cursor.f32("x of a vertex")?,
                self.cursor.f32("y of a vertex")?,
                self.cursor.f32("z of a vertex")?,
            );
        }
        self.keyword("endloop")?;
        self.keyword("endfacet")?;
        self.facets.push(corners, normal);
        Ok(())
    }

    /// Three numbers; some programs write `nan` or `-nan(ind)`, which is no normal.
    fn normal(&mut self) -> Result<Vec3, ReadError> {
        let mut normal = [0.0; 3];
        for part in &mut normal {
            self.cursor.skip_blanks();
            let start = self.cursor.pos;
            let word = self.cursor.word();
            let unsigned = word.strip_prefix(b"-").unwrap_or(word);
            if unsigned
                .get(..3)
                .is_some_and(|w| w.eq_ignore_ascii_case(b"nan") || w.eq_ignore_ascii_case(b"inf"))
            {
                *part = f32::NAN;
                continue;
            }
            self.cursor.pos = start;
            *part = self.cursor.f32("a part of a normal")?;
        }
        Ok(Vec3::from(normal))
    }

    fn next_is(&self, keyword: &str) -> bool {
        self.cursor
            .rest()
            .get(..keyword.len())
            .is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()))
    }

    fn keyword(&mut self, keyword: &str) -> Result<(), ReadError> {
        self.cursor.start_line();
        let start = self.cursor.pos;
        if self.cursor.word().eq_ignore_ascii_case(keyword.as_bytes()) {
            return Ok(());
        }
        self.cursor.pos = start;
        Err(self.cursor.expected(&format!("\"{keyword}\"")))
    }
}

impl Facets {
    fn push(&mut self, corners: [Vec3; 3], normal: Vec3) {
        self.corners.push(corners);
        self.normals.push(unit(normal).unwrap_or(Vec3::ZERO));
    }

    /// Name of the first solid that has one, else the file's.
    fn title(&self) -> String {
        let named = self.solids.iter().map(|solid| &solid.0).find(|name| !name.is_empty());
        named.cloned().unwrap_or_else(|| crate::stem(&self.file))
    }

    fn into_mesh(self) -> Mesh {
        let mut mesh = Mesh::default();
        let count = self.corners.len();
        let with_normals = self.normals.iter().any(|&normal| normal != Vec3::ZERO);
        let mut points = Welder::with_capacity(count / 2 + 3);
        let mut vertices = Welder::with_capacity(count);
        mesh.faces.corners.reserve(3 * count);
        for (facet, corners) in self.corners.iter().enumerate() {
            let normal = if with_normals { self.normal(facet) } else { Vec3::ZERO };
            let color = self.colors.get(facet).copied().flatten();
            for &corner in corners {
                let (point, new_point) = points.number(point_key(corner));
                if new_point {
                    mesh.points.push(corner);
                }
                let [x, y, z] = point_key(normal);
                let (vertex, new_vertex) = vertices.number([point, x, y, z, key_of(color)]);
                if new_vertex {
                    mesh.vertices.point.push(point);
                    if with_normals {
                        mesh.vertices.normal.push(normal);
                    }
                    if !self.colors.is_empty() {
                        mesh.vertices.color.push(color.map_or(Vec4::ONE, linear));
                    }
                }
                mesh.faces.corners.push(vertex);
            }
        }
        self.name_surfaces(&mut mesh, count);
        mesh
    }

    /// The facet's own normal, or that of its corners; (0, 0, 1) for a facet without area.
    fn normal(&self, facet: usize) -> Vec3 {
        let [a, b, c] = self.corners[facet].map(|corner| corner.as_dvec3());
        match self.normals[facet] {
            Vec3::ZERO => (b - a).cross(c - a).try_normalize().map_or(Vec3::Z, |n| n.as_vec3()),
            normal => normal,
        }
    }

    /// One surface per solid, flat.
    fn name_surfaces(&self, mesh: &mut Mesh, count: usize) {
        let surface = |name: &str| Surface { name: name.to_owned(), smooth: false, ..Surface::default() };
        mesh.surfaces = self.solids.iter().map(|(name, _)| surface(name)).collect();
        if mesh.surfaces.is_empty() {
            mesh.surfaces.push(surface(""));
        }
        if self.solids.len() > 1 {
            let ends = self.solids.iter().skip(1).map(|solid| solid.1 as usize).chain([count]);
            ends.enumerate().for_each(|(i, end)| mesh.faces.surface.resize(end, i as u32));
        }
    }
}

fn key_of(color: Option<Srgb8>) -> u32 {
    color.map_or(u32::MAX, |c| u32::from_be_bytes([0, c.r, c.g, c.b]))
}

fn linear(color: Srgb8) -> Vec4 {
    let linear = color.to_linear();
    Vec4::new(linear.r, linear.g, linear.b, 1.0)
}
