//! The shapes given by a few lengths, and the choice by kind of shape.

use std::f64::consts::{FRAC_PI_2, TAU};

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::build::Builder;
use super::lathe::{Lathe, Run, Sample, Wrapping};
use super::tolerance::{bounded_steps, steps_around};
use super::{
    MAX_FACES, ShapeError, TessellationSettings, Tolerance, contour, not_negative, nurbs, patches, polygon,
    positive, revolution,
};
use crate::{Mesh, Shape};

/// Most steps around a circle.
pub(super) const MAX_AROUND: u32 = 4096;

/// Fewest steps around a full circle chosen from a tolerance.
pub(super) const MIN_AROUND: u32 = 12;

/// The mesh of any shape but a mesh.
pub(super) fn mesh_of(shape: &Shape, settings: &TessellationSettings) -> Result<Mesh, ShapeError> {
    let mut builder = Builder::new(settings.polygons);
    let b = &mut builder;
    match shape {
        Shape::Mesh(mesh) => return Ok(mesh.clone()),
        Shape::Sphere { radius } => {
            positive("sphere", "radius", *radius)?;
            ellipsoid(DVec3::splat(*radius), settings, b);
        }
        Shape::Ellipsoid { radii } => {
            radii.to_array().iter().try_for_each(|&r| positive("ellipsoid", "half axis", r))?;
            ellipsoid(*radii, settings, b);
        }
        Shape::Box { size } => {
            size.to_array().iter().try_for_each(|&s| positive("box", "edge length", s))?;
            cuboid(*size, b);
        }
        Shape::Cylinder { radius, height, capped } => {
            positive("cylinder", "radius", *radius)?;
            positive("cylinder", "height", *height)?;
            frustum([*radius, *radius], *height, *capped, settings, b);
        }
        Shape::Cone { radius, top_radius, height, capped } => {
            not_negative("cone", "radius", *radius)?;
            not_negative("cone", "top_radius", *top_radius)?;
            positive("cone", "the larger radius", radius.max(*top_radius))?;
            positive("cone", "height", *height)?;
            frustum([*radius, *top_radius], *height, *capped, settings, b);
        }
        Shape::Torus { major_radius, minor_radius } => {
            positive("torus", "major_radius", *major_radius)?;
            positive("torus", "minor_radius", *minor_radius)?;
            torus(*major_radius, *minor_radius, settings, b);
        }
        Shape::Disc { radius, inner_radius } => disc(*radius, *inner_radius, settings, b)?,
        Shape::Plane { size } => plane(*size, settings, b)?,
        Shape::Polygon { outline, holes } => polygon::polygon(outline, holes, b)?,
        Shape::Prism { base, height, capped } => polygon::prism(base, *height, *capped, b)?,
        Shape::Revolution { profile, bezier, angle, capped } => {
            revolution::revolution(profile, *bezier, *angle, *capped, settings, b)?;
        }
        Shape::BezierPatches { patches } => patches::bezier_patches(patches, settings, b)?,
        Shape::Nurbs(surface) => nurbs::nurbs(surface, settings, b)?,
        Shape::Implicit(surface) => return contour::implicit(surface, settings),
        Shape::Csg(csg) => return contour::csg(csg, settings),
    }
    Ok(builder.mesh)
}

/// Steps around the y axis for a shape that reaches `bounds` with chords of circles of `radius`.
pub(super) fn around(settings: &TessellationSettings, radius: f64, bounds: &Aabb, share: f64) -> u32 {
    match (settings.tolerance, settings.tolerance.over_box(bounds)) {
        (Tolerance::Steps(around, _), _) => around.clamp(3, MAX_AROUND),
        (_, Some(tolerance)) => steps_around(radius, share * tolerance, MIN_AROUND, MAX_AROUND),
        (_, None) => MIN_AROUND,
    }
}

/// Steps along a profile for the second number of fixed steps, else `chosen`.
pub(super) fn along(settings: &TessellationSettings, chosen: u32) -> u32 {
    match settings.tolerance {
        Tolerance::Steps(_, along) => along.clamp(1, MAX_AROUND),
        _ => chosen,
    }
}

/// Fewer steps in both directions when there would be more than [`MAX_FACES`] faces.
pub(super) fn within_budget(around: u32, along: u32, least: (u32, u32)) -> (u32, u32) {
    let faces = 2.0 * f64::from(around) * f64::from(along);
    let shrink = (MAX_FACES as f64 / faces).sqrt();
    if shrink >= 1.0 {
        return (around, along);
    }
    let shrunk = |n: u32, least: u32| ((f64::from(n) * shrink) as u32).max(least);
    (shrunk(around, least.0), shrunk(along, least.1))
}

/// A sphere stretched along the axes. Equatorial faces curve by the same step both ways, so half of
/// the tolerance is spent in each direction.
fn ellipsoid(radii: DVec3, settings: &TessellationSettings, b: &mut Builder) {
    let bounds = Aabb { min: -radii, max: radii };
    let steps = around(settings, radii.max_element(), &bounds, 0.5);
    let (steps, rows) = within_budget(steps, along(settings, steps.div_ceil(2)).max(2), (3, 2));
    let mut rings = Vec::with_capacity(rows as usize + 1);
    let mut samples = Vec::with_capacity(rows as usize + 1);
    for i in 0..=rows {
        let t = f64::from(i) / f64::from(rows);
        let pole = i == 0 || i == rows;
        let (sin, cos) = (FRAC_PI_2 * (2.0 * t - 1.0)).sin_cos();
        rings.push(DVec2::new(if pole { 0.0 } else { cos }, sin));
        samples.push(Sample { ring: i as usize, normal: DVec2::new(cos, sin), v: 1.0 - t });
    }
    let run = Run { name: "", samples, wrapping: Wrapping::Around };
    Lathe { rings, runs: vec![run], start: FRAC_PI_2, sweep: TAU, steps }.build(b);
    let radii_f32 = radii.as_vec3();
    b.mesh.points.iter_mut().for_each(|p| *p *= radii_f32);
    let stretched = radii.max_element() / radii;
    for normal in &mut b.mesh.vertices.normal {
        *normal = (normal.as_dvec3() * stretched).normalize_or(DVec3::Y).as_vec3();
    }
}

/// Cylinder, cone or frustum; creases at the rims.
fn frustum(
    [bottom, top]: [f64; 2],
    height: f64,
    capped: bool,
    settings: &TessellationSettings,
    b: &mut Builder,
) {
    let radius = bottom.max(top);
    let bounds = Aabb { min: DVec3::new(-radius, 0.0, -radius), max: DVec3::new(radius, height, radius) };
    let (steps, rows) = within_budget(around(settings, radius, &bounds, 1.0), along(settings, 1), (3, 1));
    let normal = DVec2::new(height, bottom - top).normalize_or(DVec2::X);
    let mut rings = Vec::new();
    let mut side = Vec::new();
    for i in 0..=rows {
        let t = f64::from(i) / f64::from(rows);
        side.push(Sample { ring: rings.len(), normal, v: 1.0 - t });
        rings.push(DVec2::new(if i == rows { top } else { bottom + t * (top - bottom) }, height * t));
    }
    let rims = [(0, bottom, DVec2::NEG_Y), (rings.len() - 1, top, DVec2::Y)];
    let mut runs = vec![Run { name: "side", samples: side, wrapping: Wrapping::Around }];
    for (rim, radius, normal) in rims.into_iter().filter(|rim| capped && rim.1 > 0.0) {
        let center = Sample { ring: rings.len(), normal, v: 0.0 };
        rings.push(DVec2::new(0.0, rings[rim].y));
        let rim = Sample { ring: rim, normal, v: 0.0 };
        let (name, samples) =
            if normal.y < 0.0 { ("bottom", vec![center, rim]) } else { ("top", vec![rim, center]) };
        runs.push(Run { name, samples, wrapping: Wrapping::Disc(radius) });
    }
    Lathe { rings, runs, start: FRAC_PI_2, sweep: TAU, steps }.build(b);
}

/// A ring around the y axis; half of the tolerance is spent in each direction.
fn torus(major: f64, minor: f64, settings: &TessellationSettings, b: &mut Builder) {
    let reach = DVec3::new(major + minor, minor, major + minor);
    let bounds = Aabb { min: -reach, max: reach };
    let tube = match settings.tolerance.over_box(&bounds) {
        Some(tolerance) => steps_around(minor, 0.5 * tolerance, 8, MAX_AROUND),
        None => along(settings, 8).max(3),
    };
    let (steps, rows) = within_budget(around(settings, major + minor, &bounds, 0.5), tube, (3, 3));
    let mut rings = Vec::new();
    let mut samples = Vec::new();
    for i in 0..=rows {
        // From the inner equator over the bottom, outside and top: the picture's seam is inside.
        let t = f64::from(i) / f64::from(rows);
        let (sin, cos) = (TAU * (t - 0.5)).sin_cos();
        if i < rows {
            let radius = major + minor * cos;
            // A radius of exactly 0 would make a pole of a ring that has none.
            rings.push(DVec2::new(if radius == 0.0 { f64::MIN_POSITIVE } else { radius }, minor * sin));
        }
        samples.push(Sample { ring: (i % rows) as usize, normal: DVec2::new(cos, sin), v: 1.0 - t });
    }
    let run = Run { name: "", samples, wrapping: Wrapping::Around };
    Lathe { rings, runs: vec![run], start: FRAC_PI_2, sweep: TAU, steps }.build(b);
}

fn disc(radius: f64, inner: f64, settings: &TessellationSettings, b: &mut Builder) -> Result<(), ShapeError> {
    positive("disc", "radius", radius)?;
    not_negative("disc", "inner_radius", inner)?;
    if inner >= radius {
        let (parameter, expected) = ("inner_radius", "below the outer radius");
        return Err(ShapeError::Parameter { shape: "disc", parameter, value: inner, expected });
    }
    let reach = DVec3::new(radius, 0.0, radius);
    let steps = around(settings, radius, &Aabb { min: -reach, max: reach }, 1.0);
    let (steps, rows) = within_budget(steps, along(settings, 1), (3, 1));
    let ring = |i: u32| radius + (inner - radius) * f64::from(i) / f64::from(rows);
    let rings = (0..=rows).map(|i| DVec2::new(if i == rows { inner } else { ring(i) }, 0.0)).collect();
    let samples = (0..=rows as usize).map(|ring| Sample { ring, normal: DVec2::Y, v: 0.0 }).collect();
    let run = Run { name: "", samples, wrapping: Wrapping::Disc(radius) };
    Lathe { rings, runs: vec![run], start: FRAC_PI_2, sweep: TAU, steps }.build(b);
    Ok(())
}

/// The plane y = 0. A bounded one shows its picture once, upright seen from above with -z up; an
/// endless one once per world unit.
fn plane(size: Option<f64>, settings: &TessellationSettings, b: &mut Builder) -> Result<(), ShapeError> {
    let edge = size.unwrap_or(settings.plane_extent);
    positive("plane", "size", edge)?;
    let surface = b.surface("");
    let corners = [(-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)].map(|(x, z)| {
        let place = DVec3::new(x, 0.0, z) * edge;
        let point = b.point(place);
        let centered = DVec2::new(x, z);
        let texcoord = if size.is_some() { centered + 0.5 } else { centered * edge };
        b.vertex(point, DVec3::Y, texcoord)
    });
    b.quad(corners, surface);
    Ok(())
}

/// Sides of a cuboid: name, outward normal, and the direction to the right as seen from outside.
const SIDES: [(&str, DVec3, DVec3); 6] = [
    ("front", DVec3::Z, DVec3::X),
    ("right", DVec3::X, DVec3::NEG_Z),
    ("back", DVec3::NEG_Z, DVec3::NEG_X),
    ("left", DVec3::NEG_X, DVec3::Z),
    ("top", DVec3::Y, DVec3::X),
    ("bottom", DVec3::NEG_Y, DVec3::X),
];

/// Eight points, six surfaces; each side shows the whole picture.
fn cuboid(size: DVec3, b: &mut Builder) {
    let bounds = Aabb { min: -0.5 * size, max: 0.5 * size };
    for corner in bounds.corners() {
        b.point(corner);
    }
    for (name, normal, right) in SIDES {
        let surface = b.surface(name);
        let up = normal.cross(right);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let toward = normal + right * x + up * y;
            let bit = |positive: bool, bit: u32| if positive { bit } else { 0 };
            let point = bit(toward.x > 0.0, 1) | bit(toward.y > 0.0, 2) | bit(toward.z > 0.0, 4);
            b.vertex(point, normal, DVec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y))
        });
        b.quad(corners, surface);
    }
}

/// Steps along a parameter with second derivative up to `second` over a unit interval, so that
/// chords stay within `tolerance`: `second / (8 n^2) <= tolerance`.
pub(super) fn chord_steps(second: f64, tolerance: f64, most: u32) -> u32 {
    bounded_steps((second / (8.0 * tolerance)).sqrt(), 1, most)
}
