//! From a scene to an OBJ file with its material library.

use std::fmt::Write;

use senca_scene::math::LinearRgb;
use senca_scene::math::color::srgb_from_linear;
use senca_scene::math::glam::Vec4;
use senca_scene::{Mesh, Scene, Surface, TessellationSettings, Warning};

use crate::flatten::{Placed, placed_meshes};
use crate::{WriteError, mtl};

/// Files that stand for a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjOutput {
    /// The OBJ file.
    pub obj: Vec<u8>,
    /// The material library `STEM.mtl`, if the scene has materials.
    pub mtl: Option<Vec<u8>>,
    /// Pictures that the library names, with their file names.
    pub pictures: Vec<(String, Vec<u8>)>,
    /// What the format cannot hold.
    pub warnings: Vec<Warning>,
}

/// Writes `scene` as OBJ. The material library is named `stem` with the extension `mtl`.
///
/// Every node with a geometry becomes an object in world coordinates; shapes other than meshes are
/// tessellated by `settings`. Surfaces become groups with smoothing groups of their own. Numbers read
/// back the same. Lights and cameras have no place in the format.
///
/// # Errors
/// When a shape or mesh is not sound, or a picture cannot be encoded.
pub fn write(scene: &Scene, stem: &str, settings: &TessellationSettings) -> Result<ObjOutput, WriteError> {
    let mut output = ObjOutput::default();
    let mut text = String::new();
    let names = mtl::unique_names(&scene.materials);
    if !scene.materials.is_empty() {
        let _ = writeln!(text, "mtllib {stem}.mtl");
        let (library, pictures) = mtl::write(scene, &names, stem)?;
        output.mtl = Some(library);
        output.pictures = pictures;
    }
    let mut written = Written { text, ..Written::default() };
    for placed in placed_meshes(scene, settings)? {
        written.object(&placed, &names);
    }
    for (lost, what) in [(!scene.lights.is_empty(), "lights"), (!scene.cameras.is_empty(), "cameras")] {
        if lost {
            output.warnings.push(Warning(format!("OBJ has no place for {what}; they are left out")));
        }
    }
    output.obj = written.text.into_bytes();
    Ok(output)
}

/// What has been written, with the numbers of positions, texture coordinates, normals and smoothing
/// groups so far.
#[derive(Default)]
struct Written {
    text: String,
    points: usize,
    texcoords: usize,
    normals: usize,
    smoothing: usize,
}

impl Written {
    fn object(&mut self, placed: &Placed<'_>, names: &[String]) {
        let mesh = &*placed.mesh;
        let name = one_line(placed.name);
        let _ = writeln!(self.text, "o {}", if name.is_empty() { "object" } else { &name });
        let by_vertex = colors_differ_at_a_point(mesh);
        self.positions(mesh, by_vertex);
        for uv in &mesh.vertices.texcoord0 {
            let _ = writeln!(self.text, "vt {} {}", uv.x, 1.0 - uv.y);
        }
        for n in &mesh.vertices.normal {
            let _ = writeln!(self.text, "vn {} {} {}", n.x, n.y, n.z);
        }
        self.faces(placed, names, by_vertex);
        for line in &mesh.lines {
            self.text.push('l');
            line.iter().for_each(|&vertex| self.corner(mesh, vertex, by_vertex, false));
            self.text.push('\n');
        }
        for &dot in &mesh.dots {
            self.text.push('p');
            self.corner(mesh, dot, by_vertex, false);
            self.text.push('\n');
        }
        self.points += if by_vertex { mesh.vertices.point.len() } else { mesh.points.len() };
        self.texcoords += mesh.vertices.texcoord0.len();
        self.normals += mesh.vertices.normal.len();
        self.smoothing += mesh.surfaces.len();
    }

    /// Positions with colours if there are any.
    fn positions(&mut self, mesh: &Mesh, by_vertex: bool) {
        let mut colors = vec![Vec4::ONE; if mesh.vertices.color.is_empty() { 0 } else { mesh.points.len() }];
        for (&point, &color) in mesh.vertices.point.iter().zip(&mesh.vertices.color) {
            colors[point as usize] = color;
        }
        if by_vertex {
            for (vertex, &color) in mesh.vertices.color.iter().enumerate() {
                self.position(mesh.position(vertex as u32), Some(color));
            }
            return;
        }
        for (i, &point) in mesh.points.iter().enumerate() {
            self.position(point, colors.get(i).copied());
        }
    }

    fn position(&mut self, point: senca_scene::math::glam::Vec3, color: Option<Vec4>) {
        let _ = write!(self.text, "v {} {} {}", point.x, point.y, point.z);
        if let Some(color) = color {
            let LinearRgb { r, g, b } = LinearRgb::new(color.x, color.y, color.z)
                .map(|v| srgb_from_linear(v.clamp(0.0, 1.0)).min(1.0));
            let _ = write!(self.text, " {r} {g} {b}");
        }
        self.text.push('\n');
    }

    fn faces(&mut self, placed: &Placed<'_>, names: &[String], by_vertex: bool) {
        let mesh = &*placed.mesh;
        let mut current = None;
        for (face, corners) in mesh.faces.iter().enumerate() {
            let surface = mesh.faces.surface_of(face);
            if current != Some(surface) {
                current = Some(surface);
                self.surface(placed, surface, names);
            }
            self.text.push('f');
            corners.iter().for_each(|&vertex| self.corner(mesh, vertex, by_vertex, true));
            self.text.push('\n');
        }
    }

    fn surface(&mut self, placed: &Placed<'_>, surface: u32, names: &[String]) {
        let Some(own) = placed.mesh.surfaces.get(surface as usize) else { return };
        let name = one_line(&own.name);
        if placed.mesh.surfaces.len() > 1 || !name.is_empty() {
            let name = if name.is_empty() { format!("surface_{surface}") } else { name };
            let _ = writeln!(self.text, "g {name}");
        }
        // Surfaces of one smoothing group are written as the first of them.
        let of_group = |s: &Surface| own.smoothing_group != 0 && s.smoothing_group == own.smoothing_group;
        let first = placed.mesh.surfaces.iter().position(of_group).unwrap_or(surface as usize);
        match own.smooth {
            true => writeln!(self.text, "s {}", self.smoothing + first + 1),
            false => writeln!(self.text, "s off"),
        }
        .unwrap_or_default();
        let material = own.material.or(placed.material).and_then(|id| names.get(id.index()));
        if let Some(material) = material {
            let _ = writeln!(self.text, "usemtl {material}");
        }
    }

    /// A blank and the references of one corner.
    fn corner(&mut self, mesh: &Mesh, vertex: u32, by_vertex: bool, normals: bool) {
        let place = if by_vertex { vertex } else { mesh.vertices.point[vertex as usize] };
        let _ = write!(self.text, " {}", self.points + place as usize + 1);
        let texcoord = self.texcoords + vertex as usize + 1;
        let normal = self.normals + vertex as usize + 1;
        let _ = match (!mesh.vertices.texcoord0.is_empty(), normals && !mesh.vertices.normal.is_empty()) {
            (true, true) => write!(self.text, "/{texcoord}/{normal}"),
            (true, false) => write!(self.text, "/{texcoord}"),
            (false, true) => write!(self.text, "//{normal}"),
            (false, false) => Ok(()),
        };
    }
}

/// Whether vertices of one point have different colours, so that positions must be written per vertex.
fn colors_differ_at_a_point(mesh: &Mesh) -> bool {
    let mut color_of_point = vec![None; if mesh.vertices.color.is_empty() { 0 } else { mesh.points.len() }];
    mesh.vertices.point.iter().zip(&mesh.vertices.color).any(|(&point, &color)| {
        let before = color_of_point[point as usize].replace(color);
        before.is_some_and(|before| before != color)
    })
}

/// A name that fits on a line.
fn one_line(name: &str) -> String {
    name.split(|c: char| c.is_control())
        .map(str::trim)
        .collect::<Vec<_>>()
        .join(" ")
        .replace('\\', "/")
        .trim()
        .to_owned()
}
