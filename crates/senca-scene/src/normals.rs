//! Normals of polygons and vertices, for meshes that come without.
//!
//! A vertex normal is the weighted mean of the normals of the faces around the vertex's *point* that
//! belong to the vertex's surface, so texture seams do not show (1991 thesis, sections 7.1 and 9).
//! Weights are a choice: the thesis adds unit polygon normals; the angle at the corner, the default
//! here, makes the result independent of how polygons are split (Thürmer and Wüthrich 1998). With a
//! crease angle, faces that meet at a sharper edge do not share a normal there; surfaces with
//! `smooth = false` do not share any.
//!
//! Work is linear in the number of corners. Only points that need it (several surfaces, flat ones, or
//! faces apart by more than half the crease angle from their mean) are looked at corner by corner.

mod groups;

use senca_math::glam::Vec3;
use senca_math::newell_normal_of;

use crate::Mesh;

/// How vertex normals are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalSettings {
    /// What a face's normal counts for at a corner. Default [`NormalWeight::Angle`].
    pub weight: NormalWeight,
    /// How a polygon's own normal is found. Default [`PolygonNormal::Newell`].
    pub polygon: PolygonNormal,
    /// Faces whose normals differ by more than this many radians across an edge do not share normals
    /// there; `None` keeps every surface smooth throughout. Default 50 degrees: a cylinder of eight
    /// sides is round, a hexagonal nut is not.
    pub crease_angle: Option<f32>,
    /// Whether a dense mesh with hardly an edge sharper than that is smooth throughout all the same:
    /// what is sharp in a scan is noise, and shows as ragged spots. Default true. A mesh counts as
    /// dense with 5000 faces, and edges as few when they are less than 1 %; an edge is a crease even
    /// then when a face beside it reaches over 2 % of the mesh's diagonal, as the cap of a finely
    /// divided cylinder does.
    pub smooth_scans: bool,
}

/// What a face's normal counts for at one of its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalWeight {
    /// 1 for every face (1991 thesis, section 7.1).
    Equal,
    /// The area of the face.
    Area,
    /// The angle of the face at the corner.
    #[default]
    Angle,
}

/// How a polygon's own normal is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolygonNormal {
    /// From the first three consecutive corners that span one (1991 thesis, section 7.1).
    SlidingTriple,
    /// From all corners, by the projected areas (Newell's method).
    #[default]
    Newell,
}

impl Default for NormalSettings {
    fn default() -> Self {
        let crease_angle = Some(50f32.to_radians());
        Self { weight: NormalWeight::Angle, polygon: PolygonNormal::Newell, crease_angle, smooth_scans: true }
    }
}

impl NormalSettings {
    /// The rules of the 1991 thesis: unit polygon normals of the sliding triple, averaged per surface.
    pub const THESIS_1991: Self = Self {
        weight: NormalWeight::Equal,
        polygon: PolygonNormal::SlidingTriple,
        crease_angle: None,
        smooth_scans: false,
    };

    /// Angle weights, smooth throughout each surface.
    pub const SMOOTH: Self = Self {
        weight: NormalWeight::Angle,
        polygon: PolygonNormal::Newell,
        crease_angle: None,
        smooth_scans: false,
    };
}

/// A polygon no three consecutive corners of which span a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("polygon {face} has no normal: no three consecutive corners span a plane")]
pub struct DegeneratePolygon {
    /// Index of the face.
    pub face: usize,
}

/// Smallest `|x| + |y| + |z|` of a cross product that the sliding triple accepts.
const TRIPLE_LIMIT: f32 = 1e-5;

/// Unit normal of a polygon by the rule of the 1991 thesis, section 7.1: for consecutive corners p1,
/// p2, p3 the product `(p2 - p1) x (p3 - p2)`, taken from the first triple for which the sum of its
/// absolute components exceeds 1e-5. `None` when no triple does. The limit is in object units.
#[must_use]
pub fn polygon_normal_1991(corners: impl IntoIterator<Item = Vec3>) -> Option<Vec3> {
    let mut corners = corners.into_iter();
    let (mut p1, mut p2) = (corners.next()?, corners.next()?);
    for p3 in corners {
        let normal = (p2 - p1).cross(p3 - p2);
        if normal.abs().element_sum() > TRIPLE_LIMIT {
            return Some(normal.normalize());
        }
        (p1, p2) = (p2, p3);
    }
    None
}

/// Twice the vector area of a polygon, by Newell's method relative to the first corner: its direction
/// is the mean normal, its length twice the area of the polygon's projection along it.
#[must_use]
pub fn newell_vector(corners: impl IntoIterator<Item = Vec3>) -> Vec3 {
    (2.0 * newell_normal_of(corners.into_iter().map(|c| c.as_dvec3()))).as_vec3()
}

/// Normals of all polygons of `mesh` by the rule of the 1991 thesis.
///
/// # Errors
/// [`DegeneratePolygon`] for the first polygon that has none.
///
/// # Panics
/// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
pub fn polygon_normals_1991(mesh: &Mesh) -> Result<Vec<Vec3>, DegeneratePolygon> {
    let normal = |(face, corners): (usize, &[u32])| {
        polygon_normal_1991(corners.iter().map(|&v| mesh.position(v))).ok_or(DegeneratePolygon { face })
    };
    mesh.faces.iter().enumerate().map(normal).collect()
}

/// Arc cosine to within 7e-5 rad (Abramowitz and Stegun 1964, eq. 4.4.45): enough for a weight, and
/// the same on every machine.
fn approximate_acos(x: f32) -> f32 {
    let a = x.abs().min(1.0);
    let half = (1.0 - a).sqrt() * (1.570_728_8 + a * (-0.212_114_4 + a * (0.074_261 - a * 0.018_729_3)));
    if x < 0.0 { std::f32::consts::PI - half } else { half }
}

/// What a face knows about itself: its unit normal (0 when degenerate) and area.
#[derive(Clone, Copy)]
struct FaceInfo {
    normal: Vec3,
    area: f32,
}

/// What one corner adds to the normal at its point.
fn corner_share(mesh: &Mesh, corners: &[u32], i: usize, face: FaceInfo, weight: NormalWeight) -> Vec3 {
    let weight = match weight {
        NormalWeight::Equal => 1.0,
        NormalWeight::Area => face.area,
        NormalWeight::Angle => corner_angle(mesh, corners, i),
    };
    face.normal * weight
}

/// Angle of a polygon at corner `i`.
fn corner_angle(mesh: &Mesh, corners: &[u32], i: usize) -> f32 {
    let n = corners.len();
    let at = mesh.position(corners[i]);
    let a = mesh.position(corners[if i + 1 == n { 0 } else { i + 1 }]) - at;
    let b = mesh.position(corners[if i == 0 { n - 1 } else { i - 1 }]) - at;
    angle_between(a, b)
}

/// Angle between two vectors, 0 when one is 0.
fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let lengths = (a.length_squared() * b.length_squared()).sqrt();
    if lengths > 0.0 { approximate_acos(a.dot(b) / lengths) } else { 0.0 }
}

fn face_infos(mesh: &Mesh, rule: PolygonNormal) -> Vec<FaceInfo> {
    let info = |corners: &[u32]| {
        let places = corners.iter().map(|&v| mesh.position(v));
        let vector = newell_vector(places.clone());
        let normal = match rule {
            PolygonNormal::Newell => safe_unit(vector),
            PolygonNormal::SlidingTriple => polygon_normal_1991(places).unwrap_or(Vec3::ZERO),
        };
        FaceInfo { normal, area: 0.5 * vector.length() }
    };
    mesh.faces.iter().map(info).collect()
}

/// Unit vector, or 0 for 0 and what is not finite; also for lengths whose square leaves `f32`.
fn safe_unit(v: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize_or_zero() } else { Vec3::ZERO }
}

/// Gives `mesh` new vertex normals, whatever it had. Vertices are split where one vertex would need
/// several normals. Vertices that no face uses, or only degenerate faces, get +z.
///
/// # Panics
/// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
pub fn compute_normals(mesh: &mut Mesh, settings: &NormalSettings) {
    let (faces, sums) = if mesh.faces.starts.is_empty() && settings.polygon == PolygonNormal::Newell {
        triangle_sums(mesh, settings.weight)
    } else {
        let faces = face_infos(mesh, settings.polygon);
        let sums = point_sums(mesh, &faces, settings.weight);
        (faces, sums)
    };
    let apart = points_apart(mesh, &faces, &sums, settings.crease_angle);
    let of_point = |&point: &u32| sums[point as usize].try_normalize().unwrap_or(Vec3::Z);
    mesh.vertices.normal = mesh.vertices.point.iter().map(of_point).collect();
    if apart.contains(&true) {
        groups::split(mesh, &faces, &apart, settings);
    }
}

/// Faces and weighted sums at points for triangles throughout: the same as [`face_infos`] and
/// [`point_sums`] up to rounding, in one pass.
fn triangle_sums(mesh: &Mesh, weight: NormalWeight) -> (Vec<FaceInfo>, Vec<Vec3>) {
    let mut sums = vec![Vec3::ZERO; mesh.points.len()];
    let info = |corners: &[u32]| {
        let at = [corners[0], corners[1], corners[2]].map(|v| mesh.vertices.point[v as usize] as usize);
        let [a, b, c] = at.map(|point| mesh.points[point]);
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let vector = ab.cross(ac);
        let normal = quick_unit(vector);
        let area = 0.5 * vector.length();
        let weights = match weight {
            NormalWeight::Equal => [1.0; 3],
            NormalWeight::Area => [area; 3],
            NormalWeight::Angle => {
                let (at_a, at_b) = (angle_between(ab, ac), angle_between(-ab, bc));
                [at_a, at_b, (std::f32::consts::PI - at_a - at_b).max(0.0)]
            }
        };
        at.iter().zip(weights).for_each(|(&point, weight)| sums[point] += normal * weight);
        FaceInfo { normal, area }
    };
    let faces = mesh.faces.corners.chunks_exact(3).map(info).collect();
    (faces, sums)
}

/// [`safe_unit`], without its precautions where the length is of an ordinary size.
fn quick_unit(v: Vec3) -> Vec3 {
    let squared = v.length_squared();
    if squared > 1e-30 && squared < 1e30 { v * squared.sqrt().recip() } else { safe_unit(v) }
}

/// Weighted sums of face normals at every point.
fn point_sums(mesh: &Mesh, faces: &[FaceInfo], weight: NormalWeight) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.points.len()];
    for (corners, &face) in mesh.faces.iter().zip(faces) {
        for i in 0..corners.len() {
            let point = mesh.vertices.point[corners[i] as usize];
            sums[point as usize] += corner_share(mesh, corners, i, face, weight);
        }
    }
    sums
}

/// Points whose corners may need different normals: several surfaces, a flat surface, or a face
/// farther than half the crease angle from the mean.
fn points_apart(mesh: &Mesh, faces: &[FaceInfo], sums: &[Vec3], crease: Option<f32>) -> Vec<bool> {
    const UNSEEN: u32 = u32::MAX;
    let mut apart = vec![false; mesh.points.len()];
    let mut surface_at = vec![UNSEEN; if mesh.faces.surface.is_empty() { 0 } else { mesh.points.len() }];
    // Square of the cosine of half the crease angle.
    let least = crease.map(|angle| (0.5 * angle).clamp(0.0, std::f32::consts::FRAC_PI_2).cos().powi(2));
    for (f, (corners, face)) in mesh.faces.iter().zip(faces).enumerate() {
        let surface = mesh.faces.surface_of(f);
        let flat = mesh.surfaces.get(surface as usize).is_some_and(|s| !s.smooth);
        for &corner in corners {
            let point = mesh.vertices.point[corner as usize] as usize;
            let sum = sums[point];
            let along = face.normal.dot(sum);
            let sharp =
                least.is_some_and(|least| along < 0.0 || along * along < least * sum.length_squared());
            let before = surface_at.get_mut(point).map_or(UNSEEN, |seen| std::mem::replace(seen, surface));
            let other_surface = before != UNSEEN && before != surface;
            apart[point] |= flat || sharp || other_surface;
        }
    }
    apart
}

#[cfg(test)]
mod tests;
