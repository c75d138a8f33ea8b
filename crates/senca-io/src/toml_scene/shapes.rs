//! Shapes by their natural keys.

use std::f64::consts::TAU;

use senca_math::glam::{DQuat, DVec2, DVec3};
use senca_math::{Aabb, Expression};
use senca_scene::{ImplicitSurface, Shape, Transform};

use super::source::{Result, Table};
use super::transforms::{rigid, translation, turn_y_to};
use super::values::Value;
use super::{meshes, patches};

/// What a shape's table gives: its form, and its place where keys such as `center` or `from` say so.
pub(super) struct ReadShape {
    pub(super) shape: Shape,
    pub(super) place: Transform,
}

impl From<Shape> for ReadShape {
    fn from(shape: Shape) -> Self {
        Self { shape, place: Transform::default() }
    }
}

/// The kinds of shapes.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Sphere,
    Ellipsoid,
    Box,
    Cylinder,
    Cone,
    Torus,
    Disc,
    Plane,
    Polygon,
    Prism,
    Revolution,
    Bezier,
    Nurbs,
    Mesh,
    TriangleStrip,
    TriangleFan,
    QuadStrip,
    QuadMesh,
    Implicit,
    Csg,
}

const KINDS: [(&str, Kind); 20] = [
    ("sphere", Kind::Sphere),
    ("ellipsoid", Kind::Ellipsoid),
    ("box", Kind::Box),
    ("cylinder", Kind::Cylinder),
    ("cone", Kind::Cone),
    ("torus", Kind::Torus),
    ("disc", Kind::Disc),
    ("plane", Kind::Plane),
    ("polygon", Kind::Polygon),
    ("prism", Kind::Prism),
    ("revolution", Kind::Revolution),
    ("bezier", Kind::Bezier),
    ("nurbs", Kind::Nurbs),
    ("mesh", Kind::Mesh),
    ("triangle-strip", Kind::TriangleStrip),
    ("triangle-fan", Kind::TriangleFan),
    ("quad-strip", Kind::QuadStrip),
    ("quad-mesh", Kind::QuadMesh),
    ("implicit", Kind::Implicit),
    ("csg", Kind::Csg),
];

/// The kind that the value of `shape` names.
pub(super) fn kind(value: Value<'_>) -> Result<Kind> {
    value.choice(&KINDS)
}

/// Reads the keys of a shape of this kind. Meshes and trees of bodies are read elsewhere, since their
/// parts name materials.
pub(super) fn read(table: &mut Table<'_>, kind: Kind) -> Result<ReadShape> {
    match kind {
        Kind::Sphere => sphere(table),
        Kind::Ellipsoid => ellipsoid(table),
        Kind::Box => cuboid(table),
        Kind::Cylinder => cylinder(table),
        Kind::Cone => cone(table),
        Kind::Torus => torus(table),
        Kind::Disc => disc(table),
        Kind::Plane => plane(table),
        Kind::Polygon => meshes::polygon(table),
        Kind::Prism => prism(table),
        Kind::Revolution => revolution(table),
        Kind::Bezier => patches::bezier(table).map(Into::into),
        Kind::Nurbs => patches::nurbs(table).map(Into::into),
        Kind::Mesh | Kind::Csg => Err(table.error("a shape with parts cannot stand here")),
        Kind::Implicit => implicit(table),
        Kind::TriangleStrip => meshes::triangle_strip(table).map(Into::into),
        Kind::TriangleFan => meshes::triangle_fan(table).map(Into::into),
        Kind::QuadStrip => meshes::quad_strip(table).map(Into::into),
        Kind::QuadMesh => meshes::quad_mesh(table).map(Into::into),
    }
}

fn at(table: &mut Table<'_>, key: &'static str) -> Result<Transform> {
    Ok(translation(table.read_or(key, DVec3::ZERO, Value::vec3)?))
}

fn sphere(table: &mut Table<'_>) -> Result<ReadShape> {
    let radius = table.read_or("radius", 1.0, Value::positive)?;
    Ok(ReadShape { shape: Shape::Sphere { radius }, place: at(table, "center")? })
}

fn ellipsoid(table: &mut Table<'_>) -> Result<ReadShape> {
    let radii = table.require("radii")?.sizes()?;
    Ok(ReadShape { shape: Shape::Ellipsoid { radii }, place: at(table, "center")? })
}

/// By `size` and `center`, or by the corners `min` and `max`.
fn cuboid(table: &mut Table<'_>) -> Result<ReadShape> {
    if let Some(key) = table.first_of(&["min", "max"]) {
        let min = table.require("min")?.vec3()?;
        let max_value = table.require("max")?;
        let max = max_value.vec3()?;
        if table.has("size") || table.has("center") {
            let message = "give a box either \"min\" and \"max\", or \"size\" and \"center\"";
            return Err(table.get(key).map_or_else(|| table.error(message), |value| value.error(message)));
        }
        if !min.cmplt(max).all() {
            return Err(max_value.refuse("must be greater than \"min\" in every coordinate"));
        }
        return Ok(ReadShape {
            shape: Shape::Box { size: max - min },
            place: translation(0.5 * (min + max)),
        });
    }
    let size = table.read_or("size", DVec3::ONE, Value::sizes)?;
    Ok(ReadShape { shape: Shape::Box { size }, place: at(table, "center")? })
}

/// Height and place of a shape with an axis: by `from` and `to`, or by `height` and `base`.
fn axis(table: &mut Table<'_>) -> Result<(f64, Transform)> {
    if table.first_of(&["from", "to"]).is_none() {
        let height = table.read_or("height", 1.0, Value::positive)?;
        return Ok((height, at(table, "base")?));
    }
    let from = table.require("from")?.vec3()?;
    let to_value = table.require("to")?;
    let axis = to_value.vec3()? - from;
    if let Some(key) = table.first_of(&["height", "base"]) {
        let message = "give either \"from\" and \"to\", or \"base\" and \"height\"";
        return Err(table.get(key).map_or_else(|| table.error(message), |value| value.error(message)));
    }
    let height = axis.length();
    if height as f32 <= 0.0 {
        return Err(to_value.refuse("is the same place as \"from\""));
    }
    Ok((height, rigid(turn_y_to(axis / height), from)))
}

fn cylinder(table: &mut Table<'_>) -> Result<ReadShape> {
    let radius = table.read_or("radius", 1.0, Value::positive)?;
    let (height, place) = axis(table)?;
    let capped = table.read_or("capped", true, Value::boolean)?;
    Ok(ReadShape { shape: Shape::Cylinder { radius, height, capped }, place })
}

fn cone(table: &mut Table<'_>) -> Result<ReadShape> {
    let radius = table.read_or("radius", 1.0, Value::not_negative)?;
    let top_radius = table.read_or("top_radius", 0.0, Value::not_negative)?;
    if radius == 0.0 && top_radius == 0.0 {
        return Err(table.error("\"radius\" and \"top_radius\" of a cone must not both be 0"));
    }
    let (height, place) = axis(table)?;
    let capped = table.read_or("capped", true, Value::boolean)?;
    Ok(ReadShape { shape: Shape::Cone { radius, top_radius, height, capped }, place })
}

/// The place of a flat or ring shape around +y: `center` and the direction `normal`.
fn facing(table: &mut Table<'_>, center_key: &'static str) -> Result<Transform> {
    let center = table.read_or(center_key, DVec3::ZERO, Value::vec3)?;
    let turn = table.read("normal", Value::direction)?.map_or(DQuat::IDENTITY, turn_y_to);
    Ok(rigid(turn, center))
}

fn torus(table: &mut Table<'_>) -> Result<ReadShape> {
    let major_radius = table.read_or("major_radius", 1.0, Value::positive)?;
    let minor_radius = table.read_or("minor_radius", 0.25, Value::positive)?;
    Ok(ReadShape { shape: Shape::Torus { major_radius, minor_radius }, place: facing(table, "center")? })
}

fn disc(table: &mut Table<'_>) -> Result<ReadShape> {
    let radius = table.read_or("radius", 1.0, Value::positive)?;
    let inner_radius = match table.get("inner_radius") {
        None => 0.0,
        Some(value) => {
            let inner = value.not_negative()?;
            if inner >= radius {
                return Err(value.refuse(format_args!("must be below \"radius\", {radius}, but is {inner}")));
            }
            inner
        }
    };
    Ok(ReadShape { shape: Shape::Disc { radius, inner_radius }, place: facing(table, "center")? })
}

fn plane(table: &mut Table<'_>) -> Result<ReadShape> {
    let size = table.read("size", Value::positive)?;
    Ok(ReadShape { shape: Shape::Plane { size }, place: facing(table, "point")? })
}

fn prism(table: &mut Table<'_>) -> Result<ReadShape> {
    let base = points2(table, "points", 3)?;
    let height = table.read_or("height", 1.0, Value::positive)?;
    let capped = table.read_or("capped", true, Value::boolean)?;
    Ok(Shape::Prism { base, height, capped }.into())
}

fn revolution(table: &mut Table<'_>) -> Result<ReadShape> {
    let value = table.require("profile")?;
    let bezier = table.read_or("bezier", false, Value::boolean)?;
    let profile = value.list("a list of points [radius, y]", |point| {
        let p = point.vec2()?;
        if p.x >= 0.0 {
            Ok(p)
        } else {
            Err(point.refuse(format_args!("has a point with the negative radius {}", p.x)))
        }
    })?;
    if bezier && (profile.len() < 4 || profile.len() % 3 != 1) {
        let message = format!("must have 4, 7, 10, ... control points, but has {}", profile.len());
        return Err(value.refuse(message));
    }
    if profile.len() < 2 {
        return Err(value.refuse("needs at least two points"));
    }
    let angle = table.read_or("angle", TAU, |value| value.angle(0.0, 360.0))?;
    let capped = table.read_or("capped", true, Value::boolean)?;
    Ok(Shape::Revolution { profile, bezier, angle, capped }.into())
}

/// `expression` within the box from `min` to `max`.
fn implicit(table: &mut Table<'_>) -> Result<ReadShape> {
    let value = table.require("expression")?;
    let text = value.string()?;
    let expression = Expression::parse(text).map_err(|error| value.error_within(error.column(), &error))?;
    let corner = |value: Value<'_>| {
        if value.is_number() { value.number().map(DVec3::splat) } else { value.vec3() }
    };
    let min = table.read_or("min", -DVec3::ONE, corner)?;
    let max = table.read_or("max", DVec3::ONE, corner)?;
    if !min.cmplt(max).all() {
        let message = "\"max\" must be greater than \"min\" in every coordinate";
        return Err(table
            .first_of(&["max", "min"])
            .and_then(|key| table.get(key))
            .map_or_else(|| table.error(message), |value| value.error(message)));
    }
    let capped = table.read_or("capped", true, Value::boolean)?;
    let surface = ImplicitSurface { expression, bounds: Aabb { min, max }, capped };
    Ok(ReadShape { shape: Shape::Implicit(surface), place: at(table, "center")? })
}

/// A list of at least `least` points `[x, y]`.
fn points2(table: &mut Table<'_>, key: &'static str, least: usize) -> Result<Vec<DVec2>> {
    let value = table.require(key)?;
    let points = value.list("a list of points [x, y]", Value::vec2)?;
    if points.len() < least {
        return Err(value.refuse(format_args!("needs at least {least} points, but has {}", points.len())));
    }
    Ok(points)
}

/// A list of at least `least` points `[x, y, z]`.
pub(super) fn points3(value: Value<'_>, least: usize) -> Result<Vec<DVec3>> {
    let points = value.list("a list of points [x, y, z]", Value::vec3)?;
    if points.len() < least {
        return Err(value.refuse(format_args!("needs at least {least} points, but has {}", points.len())));
    }
    Ok(points)
}
