//! The patch converter of the 1991 thesis: bicubic patches to a mesh of quadrilaterals.
//!
//! Each patch is divided into `u` times `v` quadrilaterals, u along the rows of control points; a new
//! vertex is taken to be an earlier one when it is nearer than `(1/u + 1/v) / 2 * epsilon`, the sum
//! of coordinate differences being the distance. The search runs from the newest vertex to the oldest
//! over all patches and surfaces (1991 thesis, sections 5 and 12.4).
//!
//! [`VertexSearch::Backward`] is that search as written, with time growing as the square of the
//! number of vertices; [`VertexSearch::Grid`] finds the same vertex in a hash grid. For a mesh without
//! cracks and with exact normals use [`crate::tessellate`].

use std::collections::HashMap;

use senca_math::BicubicPatch;
use senca_math::glam::DVec3;

use crate::{BezierPatch, MAX_FACES, Mesh, ShapeError, Surface};

/// Settings of the converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchConversion {
    /// Steps in u and v, each at least 1. Default 4 and 4.
    pub steps: [u32; 2],
    /// Largest distance between vertices that are one, as a share of the mean step; 0 keeps all apart.
    /// Default 0.05.
    pub epsilon: f64,
    /// Whether the very first vertex is never found again, as in the printed program. Default false.
    pub as_printed: bool,
    /// How equal vertices are looked for. Default [`VertexSearch::Grid`].
    pub search: VertexSearch,
}

/// How equal vertices are looked for. Both find the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexSearch {
    /// From the newest to the oldest, one by one.
    Backward,
    /// In a grid of cells as large as the tolerance.
    #[default]
    Grid,
}

impl Default for PatchConversion {
    fn default() -> Self {
        Self { steps: [4, 4], epsilon: 0.05, as_printed: false, search: VertexSearch::Grid }
    }
}

/// A distance this close to the tolerance, as a share of it, counts as equal to it and thus as too
/// far: exact arithmetic then gives the same vertices (the teapot has ties at epsilon 0.5).
const ROUNDING: f64 = 1e-12;

/// Vertices found so far.
struct Found {
    places: Vec<DVec3>,
    tolerance: f64,
    as_printed: bool,
    grid: Option<HashMap<[i64; 3], Vec<u32>>>,
}

impl Found {
    fn matches(&self, index: u32, place: DVec3) -> bool {
        let near =
            (self.places[index as usize] - place).abs().element_sum() < self.tolerance * (1.0 - ROUNDING);
        near && !(self.as_printed && index == 0)
    }

    /// The newest vertex within the tolerance.
    fn newest_near(&self, place: DVec3) -> Option<u32> {
        let Some(grid) = &self.grid else {
            return (0..self.places.len() as u32).rev().find(|&i| self.matches(i, place));
        };
        let [x, y, z] = self.cell(place);
        let mut newest = None;
        for i in 0..27 {
            let cell =
                [x.saturating_add(i % 3 - 1), y.saturating_add(i / 3 % 3 - 1), z.saturating_add(i / 9 - 1)];
            let candidates = grid.get(&cell).map_or(&[][..], Vec::as_slice);
            newest = newest.max(candidates.iter().copied().rev().find(|&i| self.matches(i, place)));
        }
        newest
    }

    fn cell(&self, place: DVec3) -> [i64; 3] {
        (place / self.tolerance).floor().to_array().map(|x| x as i64)
    }

    /// The vertex at `place`, an earlier one or a new one.
    fn enter(&mut self, place: DVec3) -> u32 {
        if let Some(earlier) = self.newest_near(place) {
            return earlier;
        }
        let new = self.places.len() as u32;
        let cell = self.cell(place);
        self.places.push(place);
        if let Some(grid) = &mut self.grid {
            grid.entry(cell).or_default().push(new);
        }
        new
    }
}

/// Divides patches into quadrilaterals. The mesh's points are the converter's vertices in the order in
/// which it finds them; there are as many surfaces as the last patch's surface number plus one.
/// Quadrilaterals at collapsed edges name a point twice. Normals are not computed.
///
/// # Errors
/// [`ShapeError`] when a step count is 0, a control point or epsilon is not finite, epsilon is
/// negative, or there would be more than [`MAX_FACES`] quadrilaterals or surfaces.
pub fn patch_to_polygons(patches: &[BezierPatch], settings: &PatchConversion) -> Result<Mesh, ShapeError> {
    check(patches, settings)?;
    let [us, vs] = settings.steps;
    let (du, dv) = (1.0 / f64::from(us), 1.0 / f64::from(vs));
    let tolerance = 0.5 * (du + dv) * settings.epsilon;
    let grid = (settings.search == VertexSearch::Grid && tolerance > 0.0).then(HashMap::new);
    let mut found = Found { places: Vec::new(), tolerance, as_printed: settings.as_printed, grid };
    let mut vertices = HashMap::new();
    let mut mesh = Mesh::default();
    for patch in patches {
        let form = BicubicPatch::from_list(patch.points);
        for n in 0..us * vs {
            let (u, v) = (f64::from(n % us) * du, f64::from(n / us) * dv);
            let around = [(u, v), (u + du, v), (u + du, v + dv), (u, v + dv)];
            let quad = around.map(|(u, v)| {
                let point = found.enter(form.at(u, v));
                *vertices.entry((point, patch.surface)).or_insert_with(|| {
                    mesh.vertices.point.push(point);
                    mesh.vertices.point.len() as u32 - 1
                })
            });
            mesh.faces.push(&quad, patch.surface);
        }
    }
    mesh.points = found.places.iter().map(|p| p.as_vec3()).collect();
    let surfaces = patches.iter().map(|patch| patch.surface + 1).max().unwrap_or(0);
    mesh.surfaces = vec![Surface::default(); surfaces as usize];
    Ok(mesh)
}

fn check(patches: &[BezierPatch], settings: &PatchConversion) -> Result<(), ShapeError> {
    const SHAPE: &str = "patch conversion";
    let malformed = |reason: String| Err(ShapeError::Malformed { shape: SHAPE, reason });
    let [us, vs] = settings.steps;
    if us == 0 || vs == 0 {
        return malformed("the numbers of steps must be 1 or more".to_owned());
    }
    let quads = u64::from(us).saturating_mul(u64::from(vs)).saturating_mul(patches.len() as u64);
    if quads > MAX_FACES {
        return malformed(format!("{us} by {vs} steps give {quads} polygons; at most {MAX_FACES} are made"));
    }
    if !(settings.epsilon >= 0.0 && settings.epsilon.is_finite()) {
        let (parameter, expected) = ("epsilon", "0 or more and finite");
        return Err(ShapeError::Parameter { shape: SHAPE, parameter, value: settings.epsilon, expected });
    }
    if let Some(bad) = patches.iter().position(|patch| !patch.points.iter().all(|p| p.is_finite())) {
        return malformed(format!("patch {bad} has a control point that is not finite"));
    }
    match patches.iter().find(|patch| u64::from(patch.surface) >= MAX_FACES) {
        Some(patch) => malformed(format!("surface number {} is not below {MAX_FACES}", patch.surface)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
