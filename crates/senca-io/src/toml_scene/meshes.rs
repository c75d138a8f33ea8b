//! Meshes written in the file: points and faces, polygons, strips, fans, grids of quads.

use std::collections::HashMap;

use senca_math::glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use senca_scene::{Faces, MaterialId, Mesh, MorphTarget, Shape, Surface, Vertices};

use super::shapes::{ReadShape, points3};
use super::source::{Result, Table};
use super::values::Value;

/// Finds the material that a value names or describes.
pub(super) type FindMaterial<'f, 'a> = dyn FnMut(Value<'a>) -> Result<MaterialId> + 'f;

/// Most corners of one face.
const MOST_CORNERS: usize = 1 << 16;

/// Attributes given once per point.
struct PointAttributes {
    normals: Vec<Vec3>,
    uv: Vec<Vec2>,
    uv1: Vec<Vec2>,
    colors: Vec<Vec4>,
}

/// A mesh with faces over numbered points, in one or more surfaces.
pub(super) fn read<'a>(table: &mut Table<'a>, material: &mut FindMaterial<'_, 'a>) -> Result<Shape> {
    let points_value = table.require("points")?;
    let points = points3(points_value, 1)?;
    let attributes = point_attributes(table, points.len())?;
    let smooth = table.read_or("smooth", false, Value::boolean)?;
    let mut builder = MeshBuilder::new(&points, attributes);
    if let Some(faces) = table.get("faces") {
        let face_uv = table.get("face_uv");
        builder.surfaces.push(Surface { smooth, ..Surface::default() });
        builder.add_faces(faces, face_uv)?;
    }
    for mut part in table.tables("surface")? {
        let name = part.read_or("name", "", Value::string)?.to_owned();
        part.set_what(format!("surface \"{name}\""));
        let material = part.read("material", &mut *material)?;
        let smooth = part.read_or("smooth", smooth, Value::boolean)?;
        builder.surfaces.push(Surface { name, material, smooth, ..Surface::default() });
        let faces = part.require("faces")?;
        let face_uv = part.get("face_uv");
        builder.add_faces(faces, face_uv)?;
        part.finish()?;
    }
    builder.add_lines_and_dots(table)?;
    if builder.mesh.vertices.point.is_empty() {
        return Err(table.error("a mesh needs \"faces\", \"lines\" or \"dots\""));
    }
    let morph_targets = table.tables("morph")?;
    let morph_targets =
        morph_targets.into_iter().map(|morph| morph_target(morph, points.len())).collect::<Result<_>>()?;
    let mut mesh = builder.finish();
    mesh.morph_targets = morph_targets;
    Ok(Shape::Mesh(mesh))
}

fn morph_target(mut table: Table<'_>, count: usize) -> Result<MorphTarget> {
    let name = table.read_or("name", "", Value::string)?.to_owned();
    let value = table.require("points")?;
    let points = per_point(value, points3(value, 0)?, count, "offset")?;
    table.finish()?;
    Ok(MorphTarget { name, points: single(&points), ..MorphTarget::default() })
}

fn single(points: &[DVec3]) -> Vec<Vec3> {
    points.iter().map(|p| p.as_vec3()).collect()
}

/// Passes a list on that has an entry for each point.
fn per_point<T>(value: Value<'_>, list: Vec<T>, count: usize, what: &str) -> Result<Vec<T>> {
    if list.len() == count {
        return Ok(list);
    }
    Err(value.refuse(format_args!("needs one {what} for each of the {count} points, but has {}", list.len())))
}

fn point_attributes(table: &mut Table<'_>, count: usize) -> Result<PointAttributes> {
    let normals = table.read_or("normals", Vec::new(), |value| {
        let normals = value.list("a list of directions [x, y, z]", |v| v.direction().map(|n| n.as_vec3()))?;
        per_point(value, normals, count, "normal")
    })?;
    let uv = |value: Value<'_>| {
        let uv = value.list("a list of texture coordinates [u, v]", |v| v.vec2().map(|uv| uv.as_vec2()))?;
        per_point(value, uv, count, "pair of texture coordinates")
    };
    let colors = table.read_or("colors", Vec::new(), |value| {
        per_point(value, value.list("a list of colours", vertex_color)?, count, "colour")
    })?;
    Ok(PointAttributes {
        normals,
        uv: table.read_or("uv", Vec::new(), uv)?,
        uv1: table.read_or("uv1", Vec::new(), uv)?,
        colors,
    })
}

/// A colour, or `[r, g, b, a]`.
fn vertex_color(value: Value<'_>) -> Result<Vec4> {
    if value.is_list() && value.items("a colour")?.len() == 4 {
        let rgba: [f64; 4] = value.array("a colour", Value::not_negative)?;
        return Ok(Vec4::from_array(rgba.map(|v| v as f32)));
    }
    let color = value.color()?;
    Ok(Vec4::new(color.r, color.g, color.b, 1.0))
}

/// A vertex is one point seen from one surface with one pair of texture coordinates.
type VertexKey = (u32, u32, Option<[u32; 2]>);

struct MeshBuilder {
    mesh: Mesh,
    attributes: PointAttributes,
    surfaces: Vec<Surface>,
    vertex_of: HashMap<VertexKey, u32>,
    /// Texture coordinates given by face corner, where there are any.
    corner_uv: Vec<Option<Vec2>>,
}

impl MeshBuilder {
    fn new(points: &[DVec3], attributes: PointAttributes) -> Self {
        let mesh = Mesh { points: single(points), ..Mesh::default() };
        Self { mesh, attributes, surfaces: Vec::new(), vertex_of: HashMap::new(), corner_uv: Vec::new() }
    }

    fn vertex(&mut self, point: u32, uv: Option<Vec2>) -> u32 {
        let surface = self.surfaces.len() as u32;
        let key = (point, surface, uv.map(|uv| uv.to_array().map(f32::to_bits)));
        let next = self.mesh.vertices.point.len() as u32;
        *self.vertex_of.entry(key).or_insert_with(|| {
            self.mesh.vertices.point.push(point);
            self.corner_uv.push(uv);
            next
        })
    }

    /// Adds faces to the last surface.
    fn add_faces(&mut self, faces: Value<'_>, face_uv: Option<Value<'_>>) -> Result<()> {
        let wanted = "a list of faces such as [0, 1, 2]";
        let count = faces.items(wanted)?.len();
        let mut uv_faces = face_uv.map(|value| value.items("a list of faces")).transpose()?;
        if let (Some(value), Some(uv)) = (face_uv, &uv_faces)
            && uv.len() != count
        {
            return Err(value
                .refuse(format_args!("needs an entry for each of the {count} faces, but has {}", uv.len())));
        }
        for face in faces.items(wanted)? {
            let uv = uv_faces.as_mut().and_then(Iterator::next);
            self.add_face(face, uv)?;
        }
        Ok(())
    }

    fn add_face(&mut self, face: Value<'_>, uv: Option<Value<'_>>) -> Result<()> {
        let corners = face.list("a list of point numbers", |v| v.index(self.mesh.points.len(), "point"))?;
        if corners.len() < 3 || corners.len() > MOST_CORNERS {
            return Err(face.refuse(format_args!(
                "has a face with {} corners; 3 to {MOST_CORNERS} are needed",
                corners.len()
            )));
        }
        let uv = uv.map(|value| {
            let uv = value.list("a list of texture coordinates [u, v]", Value::vec2)?;
            if uv.len() == corners.len() {
                Ok(uv)
            } else {
                let message = format!("has {} pairs for a face with {} corners", uv.len(), corners.len());
                Err(value.refuse(message))
            }
        });
        let uv = uv.transpose()?;
        let corner = |i: usize| uv.as_ref().map(|uv| uv[i].as_vec2());
        let vertices: Vec<u32> =
            corners.iter().enumerate().map(|(i, &point)| self.vertex(point, corner(i))).collect();
        self.mesh.faces.push(&vertices, self.surfaces.len() as u32 - 1);
        Ok(())
    }

    fn add_lines_and_dots(&mut self, table: &mut Table<'_>) -> Result<()> {
        let count = self.mesh.points.len();
        let lines = table.read_or("lines", Vec::new(), |value| {
            value.list("a list of pairs of point numbers", |pair| {
                pair.array::<u32, 2>("two point numbers", |v| v.index(count, "point"))
            })
        })?;
        let dots = table.read_or("dots", Vec::new(), |value| {
            value.list("a list of point numbers", |v| v.index(count, "point"))
        })?;
        self.mesh.lines = lines.into_iter().map(|pair| pair.map(|point| self.vertex(point, None))).collect();
        self.mesh.dots = dots.into_iter().map(|point| self.vertex(point, None)).collect();
        Ok(())
    }

    /// Spreads what is given by point over the vertices.
    fn finish(mut self) -> Mesh {
        let points = &self.mesh.vertices.point;
        let spread2 = |list: &[Vec2]| -> Vec<Vec2> {
            if list.is_empty() { Vec::new() } else { points.iter().map(|&p| list[p as usize]).collect() }
        };
        let attributes = &self.attributes;
        let mut vertices = Vertices { point: points.clone(), ..Vertices::default() };
        if !attributes.normals.is_empty() {
            vertices.normal = points.iter().map(|&p| attributes.normals[p as usize]).collect();
        }
        if !attributes.colors.is_empty() {
            vertices.color = points.iter().map(|&p| attributes.colors[p as usize]).collect();
        }
        vertices.texcoord0 = spread2(&attributes.uv);
        vertices.texcoord1 = spread2(&attributes.uv1);
        if self.corner_uv.iter().any(Option::is_some) {
            let by_point = |vertex: usize| vertices.texcoord0.get(vertex).copied().unwrap_or(Vec2::ZERO);
            let uv = self.corner_uv.iter().enumerate();
            vertices.texcoord0 = uv.map(|(vertex, uv)| uv.unwrap_or_else(|| by_point(vertex))).collect();
        }
        self.mesh.vertices = vertices;
        self.mesh.surfaces = self.surfaces;
        self.mesh
    }
}

/// A mesh whose vertices are its points, in one surface, from a grouping of faces.
fn grouped(table: &mut Table<'_>, points: &[DVec3], faces: Faces) -> Result<Shape> {
    let attributes = point_attributes(table, points.len())?;
    let smooth = table.read_or("smooth", true, Value::boolean)?;
    let vertices = Vertices {
        point: (0..points.len() as u32).collect(),
        normal: attributes.normals,
        texcoord0: attributes.uv,
        texcoord1: attributes.uv1,
        color: attributes.colors,
        tangent: Vec::new(),
    };
    let surfaces = vec![Surface { smooth, ..Surface::default() }];
    Ok(Shape::Mesh(Mesh { points: single(points), vertices, faces, surfaces, ..Mesh::default() }))
}

/// Triangle i has the corners i, i + 1, i + 2, every second one turned round.
pub(super) fn triangle_strip(table: &mut Table<'_>) -> Result<Shape> {
    let points = points3(table.require("points")?, 3)?;
    let mut faces = Faces::default();
    for i in 0..points.len() as u32 - 2 {
        let face = if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] };
        faces.push(&face, 0);
    }
    grouped(table, &points, faces)
}

/// Triangle i has the corners 0, i + 1, i + 2.
pub(super) fn triangle_fan(table: &mut Table<'_>) -> Result<Shape> {
    let points = points3(table.require("points")?, 3)?;
    let mut faces = Faces::default();
    for i in 1..points.len() as u32 - 1 {
        faces.push(&[0, i, i + 1], 0);
    }
    grouped(table, &points, faces)
}

/// Quad i has the corners 2 i, 2 i + 1, 2 i + 3, 2 i + 2.
pub(super) fn quad_strip(table: &mut Table<'_>) -> Result<Shape> {
    let value = table.require("points")?;
    let points = points3(value, 4)?;
    if points.len() % 2 != 0 {
        return Err(value.refuse(format_args!("needs an even number of points, but has {}", points.len())));
    }
    let mut faces = Faces::default();
    for i in (0..points.len() as u32 - 2).step_by(2) {
        faces.push(&[i, i + 1, i + 3, i + 2], 0);
    }
    grouped(table, &points, faces)
}

/// Rows of points, from top to bottom and each from left to right seen from the front.
pub(super) fn quad_mesh(table: &mut Table<'_>) -> Result<Shape> {
    let value = table.require("rows")?;
    let rows = value.list("a list of rows of points [x, y, z]", |row| points3(row, 2))?;
    let columns = rows.first().map_or(0, Vec::len);
    if rows.len() < 2 || rows.iter().any(|row| row.len() != columns) {
        return Err(value.refuse("needs at least two rows, all with the same number of points"));
    }
    let mut faces = Faces::default();
    for row in 0..rows.len() - 1 {
        for column in 0..columns - 1 {
            let at = |r: usize, c: usize| ((row + r) * columns + column + c) as u32;
            faces.push(&[at(0, 0), at(1, 0), at(1, 1), at(0, 1)], 0);
        }
    }
    grouped(table, &rows.concat(), faces)
}

/// A flat polygon: `points`, and `holes` or the alignment points `uv` of its corners.
pub(super) fn polygon(table: &mut Table<'_>) -> Result<ReadShape> {
    let value = table.require("points")?;
    let outline = points3(value, 3)?;
    let holes_value = table.get("holes");
    let holes = match holes_value {
        Some(holes) => holes.list("a list of holes, each a list of points", |hole| points3(hole, 3))?,
        None => Vec::new(),
    };
    let uv = table.read("uv", |uv| {
        let list: Vec<DVec2> = uv.list("a list of texture coordinates [u, v]", Value::vec2)?;
        per_point(uv, list, outline.len(), "alignment point [u, v]")
    })?;
    let Some(uv) = uv else { return Ok(Shape::Polygon { outline, holes }.into()) };
    if let Some(holes) = holes_value {
        return Err(holes.refuse("cannot stand beside \"uv\": a polygon with alignment points has no holes"));
    }
    if outline.len() > MOST_CORNERS {
        return Err(
            value.refuse(format_args!("has {} points; at most {MOST_CORNERS} make a face", outline.len()))
        );
    }
    let corners: Vec<u32> = (0..outline.len() as u32).collect();
    let mut faces = Faces::default();
    faces.push(&corners, 0);
    let texcoord0 = uv.iter().map(|uv| uv.as_vec2()).collect();
    let vertices = Vertices { point: corners, texcoord0, ..Vertices::default() };
    let surfaces = vec![Surface { smooth: false, ..Surface::default() }];
    Ok(Shape::Mesh(Mesh { points: single(&outline), vertices, faces, surfaces, ..Mesh::default() }).into())
}
