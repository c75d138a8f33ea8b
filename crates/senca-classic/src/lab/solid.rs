//! Exercise 4: the planes of a solid, and whether a point lies in it.
//!
//! Faces are listed counter-clockwise as seen from outside. Then normals point outwards, and every
//! point inside a convex solid has a negative value for each plane (A B C D).

use std::collections::HashMap;

use senca_io::{NoFiles, ReadError};
use senca_scene::TessellationSettings;

use super::LabError;
use super::vectors::{Matrix, Row3, Row4, cross, dot, length, normalized, scale, subtract};

mod position;

pub use position::{Crossing, Method, SolidPosition, line_meets_plane, ray_crossings};

/// A solid of polygons over shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Places of the vertices.
    pub vertices: Vec<Row3>,
    /// The vertices of each face, from 0, counter-clockwise as seen from outside.
    pub faces: Vec<Vec<usize>>,
}

/// The plane (A B C D) through three points (4.1), (4.4): its normal is (V2-V1) x (V3-V1).
#[must_use]
pub fn plane_through(v1: Row3, v2: Row3, v3: Row3) -> Row4 {
    let [a, b, c] = cross(subtract(v2, v1), subtract(v3, v1));
    [a, b, c, -v1[0] * a - v1[1] * b - v1[2] * c]
}

/// The plane of a polygon of any number of corners that may not quite lie in one plane (4.2). D is
/// that of the corners' mean; the manual takes one corner, and then D depends on which.
///
/// The manual's condition for the last edge, i != n, should be i != n-1.
#[must_use]
pub fn plane_of(corners: &[Row3]) -> Row4 {
    let mut normal = [0.0; 3];
    for (i, v) in corners.iter().enumerate() {
        let w = corners[(i + 1) % corners.len()];
        normal[0] += (v[1] - w[1]) * (v[2] + w[2]);
        normal[1] += (v[2] - w[2]) * (v[0] + w[0]);
        normal[2] += (v[0] - w[0]) * (v[1] + w[1]);
    }
    let sum: f64 = corners.iter().map(|&v| dot(normal, v)).sum();
    [normal[0], normal[1], normal[2], -sum / corners.len().max(1) as f64]
}

/// The plane through three points by inversion of [V1; V2; V3; 0 0 0 1] (4.3), with a given D.
///
/// It fixes neither size nor direction of the normal, and there is none (`None`) for planes through
/// the origin. As printed, 1 and D have changed places; with D in the matrix and 1 on the right side
/// the result is the same plane divided by D^2.
#[must_use]
pub fn plane_by_inversion(v1: Row3, v2: Row3, v3: Row3, d: f64) -> Option<Row4> {
    let row = |v: Row3| [v[0], v[1], v[2], 1.0];
    let matrix = Matrix([row(v1), row(v2), row(v3), [0.0, 0.0, 0.0, 1.0]]);
    // V_i . R = 0 and the last row gives R's D, so R = matrix^-1 (0 0 0 D)^T.
    Some(matrix.inverse()?.transpose().transform([0.0, 0.0, 0.0, d]))
}

/// The matrix K of a plane given by parameters, V = [u w 1] K, with V1 at (0, 0), V2 at (1, 0) and V3
/// at (0, 1) (4.8): its rows are V2-V1, V3-V1 and V1.
#[must_use]
pub fn parametric_plane(v1: Row3, v2: Row3, v3: Row3) -> Matrix<3> {
    let places = Matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    let inverse = places.inverse().unwrap_or(Matrix::IDENTITY);
    inverse.multiply(&Matrix([v1, v2, v3]))
}

/// Value of a plane at a point (4.9): positive above, 0 in it, negative below.
#[must_use]
pub fn value(plane: Row4, point: Row3) -> f64 {
    plane[0] * point[0] + plane[1] * point[1] + plane[2] * point[2] + plane[3]
}

impl Solid {
    /// The solid in a model file of any format that can be read, as OBJ: `v x y z` and `f i j k`.
    ///
    /// # Errors
    /// The file cannot be read, or has no faces.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, LabError> {
        let scene = senca_io::load_bytes(name, bytes, &NoFiles)?;
        let settings = TessellationSettings::default();
        let mesh = senca_io::combined_mesh(&scene, &settings)
            .map_err(|e| LabError::degenerate(format!("{name}: {e}")))?;
        let vertices = mesh.points.iter().map(|p| p.as_dvec3().to_array()).collect();
        let point = |corner: &u32| mesh.vertices.point[*corner as usize] as usize;
        let faces: Vec<Vec<usize>> = mesh.faces.iter().map(|face| face.iter().map(point).collect()).collect();
        if faces.is_empty() {
            let at = senca_io::Location::file(name);
            return Err(ReadError::malformed(at, "has no faces, but a solid is needed").into());
        }
        Ok(Self { vertices, faces })
    }

    /// The corners of a face.
    #[must_use]
    pub fn corners(&self, face: &[usize]) -> Vec<Row3> {
        face.iter().map(|&i| self.vertices[i]).collect()
    }

    /// The plane of each face: of triangles by (4.1), of other polygons by (4.2).
    #[must_use]
    pub fn planes(&self) -> Vec<Row4> {
        let plane = |face: &Vec<usize>| match face[..] {
            [a, b, c] => plane_through(self.vertices[a], self.vertices[b], self.vertices[c]),
            _ => plane_of(&self.corners(face)),
        };
        self.faces.iter().map(plane).collect()
    }

    /// Unit normals of the faces; 0 for faces without area.
    #[must_use]
    pub fn normals(&self) -> Vec<Row3> {
        self.planes().iter().map(|&[a, b, c, _]| normalized([a, b, c]).unwrap_or([0.0; 3])).collect()
    }

    /// The faces cut into triangles from their first corner, each with the face it is of.
    pub fn triangles(&self) -> impl Iterator<Item = (usize, [usize; 3])> {
        let fan = |(i, face): (usize, &Vec<usize>)| {
            (2..face.len()).map(move |k| (i, [k - 1, k])).collect::<Vec<_>>()
        };
        self.faces
            .iter()
            .enumerate()
            .flat_map(fan)
            .map(|(i, [a, b])| (i, [self.faces[i][0], self.faces[i][a], self.faces[i][b]]))
    }

    /// Least and greatest x, y and z.
    #[must_use]
    pub fn bounds(&self) -> (Row3, Row3) {
        let bound = |k: usize, pick: fn(f64, f64) -> f64| {
            self.vertices.iter().map(|v| v[k]).reduce(pick).unwrap_or(0.0)
        };
        (std::array::from_fn(|k| bound(k, f64::min)), std::array::from_fn(|k| bound(k, f64::max)))
    }

    /// What moves this solid's centre to the origin and scales it to [-1, 1].
    ///
    /// # Errors
    /// The solid has no size.
    pub fn normalization(&self) -> Result<Normalization, LabError> {
        let (low, high) = self.bounds();
        let size = subtract(high, low);
        let largest = size[0].max(size[1]).max(size[2]);
        if !(largest > 0.0 && largest.is_finite()) {
            return Err(LabError::degenerate("the solid has no size, so it cannot be scaled to [-1, 1]"));
        }
        let center = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        Ok(Normalization { center, scale: 2.0 / largest })
    }

    /// The solid with its vertices mapped.
    #[must_use]
    pub fn mapped(&self, map: impl Fn(Row3) -> Row3) -> Self {
        Self { vertices: self.vertices.iter().map(|&v| map(v)).collect(), faces: self.faces.clone() }
    }

    /// The solid moved to the origin and scaled to [-1, 1].
    ///
    /// # Errors
    /// As [`Solid::normalization`].
    pub fn normalized(&self) -> Result<Self, LabError> {
        let map = self.normalization()?;
        Ok(self.mapped(|v| map.apply(v)))
    }

    /// How often each directed edge is used.
    fn directed_edges(&self) -> HashMap<(usize, usize), usize> {
        let mut uses = HashMap::new();
        for face in &self.faces {
            for (i, &v) in face.iter().enumerate() {
                *uses.entry((v, face[(i + 1) % face.len()])).or_insert(0) += 1;
            }
        }
        uses
    }

    /// Directed edges that differ from each other.
    #[must_use]
    pub fn directed_edge_count(&self) -> usize {
        self.directed_edges().len()
    }

    /// Edges, whatever their direction, each once, with the lower vertex first and in order.
    #[must_use]
    pub fn edges(&self) -> Vec<[usize; 2]> {
        let mut edges: Vec<_> = self.directed_edges().keys().map(|&(a, b)| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Whether every edge is used twice, once in each direction: then the surface is closed and all
    /// its faces agree about where outside is.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        let uses = self.directed_edges();
        uses.iter().all(|(&(a, b), &n)| n == 1 && uses.get(&(b, a)) == Some(&1))
    }

    /// Six times the volume, positive when normals point outwards.
    #[must_use]
    pub fn six_volumes(&self) -> f64 {
        let v = &self.vertices;
        self.triangles().map(|(_, [a, b, c])| dot(v[a], cross(v[b], v[c]))).sum()
    }

    /// Whether no vertex lies above the plane of a face, with room for rounding.
    #[must_use]
    pub fn is_convex(&self) -> bool {
        let (low, high) = self.bounds();
        let size = length(subtract(high, low));
        self.planes().iter().all(|&plane| {
            let room = 1e-6 * size * length([plane[0], plane[1], plane[2]]);
            self.vertices.iter().all(|&v| value(plane, v) <= room)
        })
    }

    /// Mean of a face's corners.
    #[must_use]
    pub fn center_of(&self, face: &[usize]) -> Row3 {
        let sum = face.iter().fold([0.0; 3], |s, &i| super::vectors::add(s, self.vertices[i]));
        scale(sum, 1.0 / face.len().max(1) as f64)
    }
}

/// Moves the centre of a solid to the origin and scales it to [-1, 1], the same in all directions
/// (section 7.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalization {
    /// Middle of the bounds.
    pub center: Row3,
    /// 2 / the largest side.
    pub scale: f64,
}

impl Normalization {
    /// The place of a point afterwards.
    #[must_use]
    pub fn apply(&self, point: Row3) -> Row3 {
        scale(subtract(point, self.center), self.scale)
    }
}

#[cfg(test)]
pub(crate) mod tests;
