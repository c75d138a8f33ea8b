//! Flat polygons, prisms over them, and meshes that need to be triangulated or given normals.

use std::borrow::Cow;

use senca_math::glam::{DVec2, DVec3};
use senca_math::polygon::{is_convex, signed_area};
use senca_math::{newell_normal, triangulate, triangulate_with_holes};

use super::build::Builder;
use super::{ShapeError, TessellationSettings, positive};
use crate::{Faces, Mesh, compute_normals, newell_vector, split_quad};

/// A mesh as the renderers want it: with normals and, unless polygons are wanted, in triangles.
pub(super) fn finished_mesh<'a>(
    mesh: &'a Mesh,
    settings: &TessellationSettings,
) -> Result<Cow<'a, Mesh>, ShapeError> {
    mesh.check().map_err(|error| ShapeError::Malformed { shape: "mesh", reason: error.to_string() })?;
    let mut mesh = Cow::Borrowed(mesh);
    if mesh.vertices.normal.is_empty() && !mesh.vertices.point.is_empty() {
        compute_normals(mesh.to_mut(), &settings.normals);
    }
    if !settings.polygons && !mesh.faces.starts.is_empty() {
        let faces = triangulated(&mesh);
        mesh.to_mut().faces = faces;
    }
    Ok(mesh)
}

/// The faces of `mesh` split into triangles, each on its face's surface: quadrilaterals as
/// [`split_quad`] says, larger polygons, convex or not, in the plane of their mean normal.
///
/// # Panics
/// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
#[must_use]
pub fn triangulated(mesh: &Mesh) -> Faces {
    let mut triangles =
        Faces { corners: Vec::with_capacity(3 * mesh.faces.triangle_count()), ..Faces::default() };
    for (f, corners) in mesh.faces.iter().enumerate() {
        let surface = mesh.faces.surface_of(f);
        match corners {
            [] | [_] | [_, _] => {}
            &[a, b, c] => triangles.push(&[a, b, c], surface),
            &[a, b, c, d] => {
                let corners = [a, b, c, d];
                let halves = split_quad(corners.map(|v| mesh.position(v)));
                halves.iter().for_each(|half| triangles.push(&half.map(|i| corners[i]), surface));
            }
            _ => split_polygon(mesh, corners, surface, &mut triangles),
        }
    }
    triangles
}

fn split_polygon(mesh: &Mesh, corners: &[u32], surface: u32, triangles: &mut Faces) {
    let normal = newell_vector(corners.iter().map(|&v| mesh.position(v))).as_dvec3();
    let (x_axis, y_axis) = axes_in_plane(normal.normalize_or(DVec3::Z));
    let flat = corners.iter().map(|&v| mesh.position(v).as_dvec3());
    let flat: Vec<DVec2> = flat.map(|p| DVec2::new(p.dot(x_axis), p.dot(y_axis))).collect();
    if is_convex(&flat) {
        let fan = (2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]);
        return fan.for_each(|triangle| triangles.push(&triangle, surface));
    }
    for triangle in triangulate(&flat) {
        triangles.push(&triangle.map(|i| corners[i as usize]), surface);
    }
}

/// Two unit vectors that make a right-handed frame with `normal`; the first is horizontal where there
/// is a choice, so pictures on walls stand upright.
fn axes_in_plane(normal: DVec3) -> (DVec3, DVec3) {
    let x_axis = DVec3::Y.cross(normal);
    let x_axis = if x_axis.length() > 1e-6 { x_axis.normalize() } else { DVec3::X };
    (x_axis, normal.cross(x_axis).normalize_or(DVec3::Y))
}

fn malformed<T>(shape: &'static str, reason: &str) -> Result<T, ShapeError> {
    Err(ShapeError::Malformed { shape, reason: reason.to_owned() })
}

/// Appends a flat polygon with holes. The picture is laid over its bounding rectangle.
pub(super) fn polygon(outline: &[DVec3], holes: &[Vec<DVec3>], b: &mut Builder) -> Result<(), ShapeError> {
    let mut all = outline.iter().chain(holes.iter().flatten());
    if !all.all(|p| p.is_finite()) {
        return malformed("polygon", "every corner must be finite");
    }
    if outline.len() < 3 || holes.iter().any(|hole| hole.len() < 3) {
        return malformed("polygon", "an outline and a hole have at least three corners each");
    }
    let normal = newell_of(outline);
    if normal == DVec3::ZERO {
        return malformed("polygon", "the corners lie on one line");
    }
    let (x_axis, y_axis) = axes_in_plane(normal);
    let origin = outline[0];
    let flat = |p: &DVec3| DVec2::new((*p - origin).dot(x_axis), (*p - origin).dot(y_axis));
    let rings: Vec<Vec<DVec2>> = std::iter::once(outline)
        .chain(holes.iter().map(Vec::as_slice))
        .map(|ring| ring.iter().map(flat).collect())
        .collect();
    let surface = b.surface("");
    let fit = fitting(&rings[0]);
    let first = b.mesh.vertices.point.len() as u32;
    for (place, flat) in outline.iter().chain(holes.iter().flatten()).zip(rings.iter().flatten()) {
        let point = b.point(*place);
        b.vertex(point, normal, fit(*flat));
    }
    add_flat(&rings, first, false, surface, b);
    Ok(())
}

/// Unit mean normal of a polygon, 0 when it has none.
fn newell_of(outline: &[DVec3]) -> DVec3 {
    let sum = newell_normal(outline);
    let size = outline.iter().map(|p| p.distance_squared(outline[0])).fold(0.0, f64::max);
    if sum.length() > 1e-12 * size { sum.normalize_or_zero() } else { DVec3::ZERO }
}

/// Texture coordinates that lay the picture over the bounding rectangle of `ring`.
fn fitting(ring: &[DVec2]) -> impl Fn(DVec2) -> DVec2 + use<> {
    let low = ring.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let size = ring.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) - low;
    let size = size.max(DVec2::splat(f64::MIN_POSITIVE));
    move |p| {
        let t = (p - low) / size;
        DVec2::new(t.x, 1.0 - t.y)
    }
}

/// Adds the faces of a flat region whose vertices begin at `first`, turned over if `back`.
pub(super) fn add_flat(rings: &[Vec<DVec2>], first: u32, back: bool, surface: u32, b: &mut Builder) {
    let turned = |mut corners: Vec<u32>| {
        if back {
            corners.reverse();
        }
        corners
    };
    if b.polygons && rings.len() == 1 {
        let mut corners: Vec<u32> = (first..first + rings[0].len() as u32).collect();
        if signed_area(&rings[0]) < 0.0 {
            corners.reverse();
        }
        return b.mesh.faces.push(&turned(corners), surface);
    }
    let starts = rings[..rings.len() - 1].iter().scan(0, |start, ring| {
        *start += ring.len();
        Some(*start)
    });
    for triangle in triangulate_with_holes(&rings.concat(), &starts.collect::<Vec<_>>()) {
        b.mesh.faces.push(&turned(triangle.map(|i| first + i).to_vec()), surface);
    }
}

/// Appends a prism: sides on one surface that is not smooth, bottom and top on one each.
pub(super) fn prism(base: &[DVec2], height: f64, capped: bool, b: &mut Builder) -> Result<(), ShapeError> {
    positive("prism", "height", height)?;
    if base.len() < 3 || !base.iter().all(|p| p.is_finite()) {
        return malformed("prism", "the base needs at least three finite corners");
    }
    // Seen from above, x to the right and z down: (x, -z) is right-handed there.
    let mut seen: Vec<DVec2> = base.iter().map(|p| DVec2::new(p.x, -p.y)).collect();
    let area = signed_area(&seen);
    if area == 0.0 {
        return malformed("prism", "the base has no area");
    }
    if area < 0.0 {
        seen.reverse();
    }
    let count = seen.len() as u32;
    let place = |p: &DVec2, y: f64| DVec3::new(p.x, y, -p.y);
    let bottom = b.mesh.points.len() as u32;
    [0.0, height].iter().for_each(|&y| {
        seen.iter().for_each(|p| {
            b.point(place(p, y));
        });
    });
    add_sides(&seen, bottom, b);
    if capped {
        let fit = fitting(&seen);
        for (name, row, normal) in [("bottom", bottom, DVec3::NEG_Y), ("top", bottom + count, DVec3::Y)] {
            let surface = b.surface(name);
            let first = b.mesh.vertices.point.len() as u32;
            for (i, p) in seen.iter().enumerate() {
                b.vertex(row + i as u32, normal, fit(*p));
            }
            add_flat(std::slice::from_ref(&seen), first, normal.y < 0.0, surface, b);
        }
    }
    Ok(())
}

/// The walls of a prism; the picture goes around once, in proportion to length.
fn add_sides(seen: &[DVec2], bottom: u32, b: &mut Builder) {
    let surface = b.surface("side");
    b.mesh.surfaces[surface as usize].smooth = false;
    let n = seen.len();
    let length = |i: usize| seen[i].distance(seen[(i + 1) % n]);
    let around: f64 = (0..n).map(length).sum();
    let mut gone = 0.0;
    for i in 0..n {
        let next = (i + 1) % n;
        let along = seen[next] - seen[i];
        if along == DVec2::ZERO {
            continue;
        }
        let normal = DVec3::new(along.y, 0.0, along.x).normalize_or(DVec3::X);
        let (u0, u1) = (gone / around, (gone + length(i)) / around);
        gone += length(i);
        let corners = [(i, 0, u0), (next, 0, u1), (next, n, u1), (i, n, u0)].map(|(corner, row, u)| {
            b.vertex(bottom + (corner + row) as u32, normal, DVec2::new(u, if row == 0 { 1.0 } else { 0.0 }))
        });
        b.quad(corners, surface);
    }
}
