//! A solution on disk: light computed once, to be shown from any number of cameras.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `SENCALIT` |
//! | 4 | version, 2 |
//! | 8 | fingerprint of the scene, see [`light_fingerprint`] |
//! | 4 x 6 | numbers of vertices, surfaces, polygons, polygons with attributes, divided elements, elements |
//! | 8 x 4, 4, 8 x 3, 1 | report: polygons, patches, elements, links; iterations; residual, energy error, unsent; converged |
//! | 48 per vertex | place and normal |
//! | 45 per surface | instance, material, back, reflectance, emission, transmittance |
//! | 20 per polygon | vertices, surface |
//! | 128 per polygon with attributes | texture coordinates and colour of 4 corners |
//! | 4 per divided element | its number, in the order of division |
//! | 24 per element | light that arrives, and the part of it that comes straight from lamps and emitters |
//! | 8 | checksum of all before |
//!
//! Numbers are little-endian. Elements are not stored: polygons and the order in which they were divided
//! decide them.

mod bytes;
mod fingerprint;
#[cfg(test)]
mod tests;

use senca_math::LinearRgb;

use crate::mesh::MeshSeed;
use crate::{CornerAttributes, ElementMesh, RadiantSurface, Solution, SolveReport};
use bytes::{Reader, Writer, checksum};

pub use fingerprint::light_fingerprint;

const MAGIC: &[u8; 8] = b"SENCALIT";
const VERSION: u32 = 3;
const CHECKSUM: usize = 8;
const VERTEX: usize = 48;
const SURFACE: usize = 45;
const POLYGON: usize = 20;
const ATTRIBUTES: usize = 128;
const OPEN: usize = 8;
const LIGHT: usize = 24;

/// Why a saved solution cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SavedSolutionError {
    /// The bytes are something else.
    #[error("is not a solution saved by this program")]
    NotASolution,
    /// Another version of the program wrote them.
    #[error("is a solution of version {0}; this program reads version {VERSION}")]
    Version(u32),
    /// Bytes are missing or changed.
    #[error("is damaged: {0}")]
    Damaged(&'static str),
    /// It is of another scene.
    #[error("belongs to another scene: shapes, materials or lights have changed since it was computed")]
    OtherScene,
}

const TOO_SHORT: SavedSolutionError = SavedSolutionError::Damaged("it ends too early");

impl Solution {
    /// The solution as bytes. `fingerprint` stands for the scene: see [`light_fingerprint`].
    #[must_use]
    pub fn save(&self, fingerprint: u64) -> Vec<u8> {
        let seed = self.mesh.seed();
        let elements = self.mesh.elements().len();
        let mut out = Writer::with_capacity(256 + VERTEX * seed.vertices.len() + (LIGHT + 4) * elements);
        out.bytes(MAGIC);
        out.u32(VERSION);
        out.u64(fingerprint);
        for count in [
            seed.vertices.len(),
            seed.surfaces.len(),
            seed.polygons.len(),
            seed.attributes.len(),
            seed.divided.len(),
            seed.open.len(),
            elements,
        ] {
            out.u32(count as u32);
        }
        write_report(&mut out, &self.report);
        seed.vertices.iter().flatten().for_each(|v| out.vector(*v));
        seed.surfaces.iter().for_each(|surface| write_surface(&mut out, surface));
        for (vertices, surface) in &seed.polygons {
            vertices.iter().chain([surface]).for_each(|&number| out.u32(number));
        }
        seed.attributes.iter().flatten().for_each(|corner| write_attributes(&mut out, corner));
        seed.divided.iter().for_each(|&element| out.u32(element));
        for &(element, share) in &seed.open {
            out.u32(element);
            out.bytes(&share.to_le_bytes());
        }
        let of = |values: &[LinearRgb], element: usize| values.get(element).copied().unwrap_or_default();
        for element in 0..elements {
            out.color(of(&self.incident, element));
            out.color(of(&self.direct, element));
        }
        out.finished()
    }

    /// A solution that was saved. With a `fingerprint` it has to be of that scene.
    ///
    /// # Errors
    /// [`SavedSolutionError`].
    pub fn load(bytes: &[u8], fingerprint: Option<u64>) -> Result<Self, SavedSolutionError> {
        if !bytes.starts_with(MAGIC) {
            return Err(SavedSolutionError::NotASolution);
        }
        let mut reader = Reader::new(&bytes[MAGIC.len()..]);
        let version = reader.u32().ok_or(TOO_SHORT)?;
        if version != VERSION {
            return Err(SavedSolutionError::Version(version));
        }
        let body = bytes.len().checked_sub(CHECKSUM).ok_or(TOO_SHORT)?;
        if checksum(&bytes[..body]).to_le_bytes() != bytes[body..] {
            return Err(SavedSolutionError::Damaged("its checksum is wrong"));
        }
        let scene = reader.u64().ok_or(TOO_SHORT)?;
        if fingerprint.is_some_and(|expected| expected != scene) {
            return Err(SavedSolutionError::OtherScene);
        }
        read_body(&mut reader)
    }
}

/// All behind the fingerprint.
fn read_body(reader: &mut Reader<'_>) -> Result<Solution, SavedSolutionError> {
    let mut counts = [0; 7];
    for count in &mut counts {
        *count = reader.u32().ok_or(TOO_SHORT)? as usize;
    }
    let [vertices, surfaces, polygons, attributes, divided, open, elements] = counts;
    let report = read_report(reader).ok_or(TOO_SHORT)?;
    let needed = VERTEX * vertices
        + SURFACE * surfaces
        + POLYGON * polygons
        + ATTRIBUTES * attributes
        + 4 * divided
        + OPEN * open
        + LIGHT * elements
        + CHECKSUM;
    if reader.left() != needed {
        return Err(SavedSolutionError::Damaged("its length is wrong"));
    }
    // From here on there is room for what the counts promise, and memory follows the file's length.
    let seed = MeshSeed {
        vertices: read_many(vertices, || Some([reader.vector()?, reader.vector()?]))?,
        surfaces: read_many(surfaces, || read_surface(reader))?,
        polygons: read_many(polygons, || Some((reader.u32x4()?, reader.u32()?)))?,
        attributes: read_many(attributes, || read_attributes(reader))?,
        divided: read_many(divided, || reader.u32())?,
        open: read_many(open, || Some((reader.u32()?, reader.share()?)))?,
    };
    let mesh = ElementMesh::of_seed(&seed, elements).filter(|mesh| mesh.elements().len() == elements);
    let mesh = mesh.ok_or(SavedSolutionError::Damaged("its mesh does not hold together"))?;
    let light = read_many(elements, || Some([reader.light()?, reader.light()?]));
    let light = light.map_err(|_| SavedSolutionError::Damaged("its light is not a number"))?;
    let (incident, direct) = light.into_iter().map(|[incident, direct]| (incident, direct)).unzip();
    Ok(Solution { mesh, incident, direct, report })
}

fn read_many<T>(count: usize, mut read: impl FnMut() -> Option<T>) -> Result<Vec<T>, SavedSolutionError> {
    let values: Option<Vec<T>> = (0..count).map(|_| read()).collect();
    values.ok_or(SavedSolutionError::Damaged("a number is out of its range"))
}

fn write_surface(out: &mut Writer, surface: &RadiantSurface) {
    out.u32(surface.instance);
    out.u32(surface.material);
    out.bytes(&[u8::from(surface.back)]);
    out.color(surface.reflectance);
    out.color(surface.emission);
    out.color(surface.transmittance);
}

fn read_surface(reader: &mut Reader<'_>) -> Option<RadiantSurface> {
    Some(RadiantSurface {
        instance: reader.u32()?,
        material: reader.u32()?,
        back: reader.flag()?,
        reflectance: reader.light()?,
        emission: reader.light()?,
        transmittance: reader.light()?,
    })
}

fn write_attributes(out: &mut Writer, corner: &CornerAttributes) {
    let texcoords = corner.texcoords.iter().flat_map(|texcoord| texcoord.to_array());
    texcoords.chain(corner.color.to_array()).for_each(|number| out.bytes(&number.to_le_bytes()));
}

fn read_attributes(reader: &mut Reader<'_>) -> Option<[CornerAttributes; 4]> {
    let mut corners = [CornerAttributes::default(); 4];
    for corner in &mut corners {
        let mut numbers = [0.0; 8];
        for number in &mut numbers {
            *number = reader.f32()?;
        }
        let [u0, v0, u1, v1, r, g, b, a] = numbers;
        *corner =
            CornerAttributes { texcoords: [[u0, v0].into(), [u1, v1].into()], color: [r, g, b, a].into() };
    }
    Some(corners)
}

fn write_report(out: &mut Writer, report: &SolveReport) {
    for count in [report.polygons, report.patches, report.elements, report.links] {
        out.u64(count);
    }
    out.u32(report.iterations);
    out.f64(report.residual);
    out.f64(report.energy_error);
    out.f64(report.unsent);
    out.bytes(&[u8::from(report.converged)]);
}

fn read_report(reader: &mut Reader<'_>) -> Option<SolveReport> {
    Some(SolveReport {
        polygons: reader.u64()?,
        patches: reader.u64()?,
        elements: reader.u64()?,
        links: reader.u64()?,
        iterations: reader.u32()?,
        residual: reader.f64()?,
        energy_error: reader.f64()?,
        unsent: reader.f64()?,
        converged: reader.flag()?,
    })
}
