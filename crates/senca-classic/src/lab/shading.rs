//! Exercise 7: hidden faces, the lighting model, constant and Gouraud shading.
//!
//! Intensities go from 0 to 255, for one component of colour.

use super::solid::{Solid, value};
use super::vectors::{Row3, add, cosine, dot, normalized, scale, subtract};

mod picture;

pub use picture::{Camera, Mode, SolidPicture};

/// A light with the coefficients of the surface it falls on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is.
    pub position: Row3,
    /// Ia, intensity from all around, 0 to 255.
    pub ambient: f64,
    /// ka, share of it that the surface sends on, 0 to 1.
    pub ambient_share: f64,
    /// Ii, intensity of the light, 0 to 255.
    pub intensity: f64,
    /// kd, share of it that the surface scatters, 0 to 1.
    pub diffuse_share: f64,
}

impl Default for Light {
    /// A light at (2, 4, 6) with which no surface gets brighter than 210.
    fn default() -> Self {
        Self {
            position: [2.0, 4.0, 6.0],
            ambient: 100.0,
            ambient_share: 0.5,
            intensity: 200.0,
            diffuse_share: 0.8,
        }
    }
}

impl Light {
    /// Ambient and diffuse reflection (7.7) at a point with a unit normal. A light behind the surface
    /// does not count.
    #[must_use]
    pub fn reflected(&self, point: Row3, normal: Row3) -> f64 {
        let cosine = self.cosine(point, normal).max(0.0);
        self.ambient * self.ambient_share + self.intensity * self.diffuse_share * cosine
    }

    /// L . N, with the unit vector L from the point to the light; 0 at the light itself.
    #[must_use]
    pub fn cosine(&self, point: Row3, normal: Row3) -> f64 {
        normalized(subtract(self.position, point)).map_or(0.0, |to_light| dot(to_light, normal))
    }

    /// Intensity of each face, with its unit normal, at its centre: for constant shading.
    #[must_use]
    pub fn face_intensities(&self, solid: &Solid) -> Vec<f64> {
        let lit = |(face, normal): (&Vec<usize>, Row3)| self.reflected(solid.center_of(face), normal);
        solid.faces.iter().zip(solid.normals()).map(lit).collect()
    }

    /// Intensity at each vertex, with its own normal: for Gouraud shading.
    #[must_use]
    pub fn vertex_intensities(&self, solid: &Solid) -> Vec<f64> {
        let normals = vertex_normals(solid);
        solid.vertices.iter().zip(normals).map(|(&v, normal)| self.reflected(v, normal)).collect()
    }
}

/// Averages of the unit normals of the faces that meet at each vertex (7.4); 0 where none does.
///
/// The plain average of the manual depends on how a surface is cut into triangles: a corner of a cube
/// leans towards the side that has two triangles there.
#[must_use]
pub fn average_normals(solid: &Solid) -> Vec<Row3> {
    let mut sums = vec![([0.0; 3], 0u32); solid.vertices.len()];
    for (face, normal) in solid.faces.iter().zip(solid.normals()) {
        for &v in face {
            sums[v] = (add(sums[v].0, normal), sums[v].1 + 1);
        }
    }
    sums.into_iter().map(|(sum, n)| scale(sum, 1.0 / f64::from(n.max(1)))).collect()
}

/// The averages, normalized; 0 where they cancel.
#[must_use]
pub fn vertex_normals(solid: &Solid) -> Vec<Row3> {
    average_normals(solid).into_iter().map(|n| normalized(n).unwrap_or([0.0; 3])).collect()
}

/// The reflection model of Phong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongModel {
    /// Ia, intensity from all around.
    pub ambient: f64,
    /// ka.
    pub ambient_share: f64,
    /// Ii, intensity of the light.
    pub intensity: f64,
    /// kd.
    pub diffuse_share: f64,
    /// ks.
    pub specular_share: f64,
    /// n, greater than 0: the greater, the smaller the highlight. The manual calls it the index of
    /// roughness.
    pub exponent: f64,
}

impl PhongModel {
    /// Intensity (7.9) for unit vectors: the normal, to the light, to the viewer.
    #[must_use]
    pub fn reflected(&self, normal: Row3, to_light: Row3, to_viewer: Row3) -> f64 {
        self.ambient * self.ambient_share + self.light_share(normal, to_light, to_viewer)
    }

    /// Intensity with the distance `r` of the viewer and a constant `k` (7.10). The manual takes the
    /// distance of the viewer, since its light is infinitely far away.
    #[must_use]
    pub fn reflected_at(&self, normal: Row3, to_light: Row3, to_viewer: Row3, r: f64, k: f64) -> f64 {
        self.ambient * self.ambient_share + self.light_share(normal, to_light, to_viewer) / (r + k)
    }

    fn light_share(&self, normal: Row3, to_light: Row3, to_viewer: Row3) -> f64 {
        let diffuse = dot(to_light, normal).max(0.0);
        // Without the clamp an even exponent would light the side that the mirrored ray does not reach.
        let specular = dot(mirrored(normal, to_light), to_viewer).max(0.0).powf(self.exponent);
        self.intensity * (self.diffuse_share * diffuse + self.specular_share * specular)
    }
}

/// The direction that light from `to_light` is mirrored in: R = 2 (N.L) N - L.
#[must_use]
pub fn mirrored(normal: Row3, to_light: Row3) -> Row3 {
    subtract(scale(normal, 2.0 * dot(normal, to_light)), to_light)
}

/// What is done with intensities above 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overflow {
    /// They are cut off.
    #[default]
    Clamp,
    /// All are scaled so that the greatest becomes 255; unfit for animation.
    ScaleToMaximum,
    /// All are mapped so that the least becomes 0 and the greatest 255.
    Stretch,
}

/// Brings intensities into 0 to 255.
#[must_use]
pub fn displayed(intensities: &[f64], overflow: Overflow) -> Vec<f64> {
    let least = intensities.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = intensities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let map = |v: f64| match overflow {
        Overflow::Clamp => v.clamp(0.0, 255.0),
        Overflow::ScaleToMaximum if greatest > 255.0 => v * 255.0 / greatest,
        Overflow::Stretch if greatest > least => (v - least) * 255.0 / (greatest - least),
        _ => v,
    };
    intensities.iter().map(|&v| map(v)).collect()
}

/// Angle in degrees between each face's normal and the vector from its centre to the eye (7.1): below
/// 90 it is seen from its front.
#[must_use]
pub fn view_angles(solid: &Solid, eye: Row3) -> Vec<f64> {
    let angle = |(face, normal): (&Vec<usize>, Row3)| {
        let to_eye = subtract(eye, solid.center_of(face));
        cosine(normal, to_eye).map_or(90.0, |c| c.acos().to_degrees())
    };
    solid.faces.iter().zip(solid.normals()).map(angle).collect()
}

/// Values of the faces' planes at the eye: positive for those that are seen from their front; 0 counts
/// as not seen.
#[must_use]
pub fn view_values(solid: &Solid, eye: Row3) -> Vec<f64> {
    solid.planes().iter().map(|&plane| value(plane, eye)).collect()
}

/// Whether a polygon of the picture, y upwards, is seen from its back (7.3): it has an edge Bi with
/// Bi . Vj <= 0 for all vertices Vj.
///
/// Exact for convex polygons; what has no area counts as a back. A concave polygon none of whose edges
/// lies on its convex hull is missed.
#[must_use]
pub fn is_back_in_picture(corners: &[[f64; 2]]) -> bool {
    let polygon = super::polygon::Polygon::new(corners.to_vec());
    // The ends of an edge lie on it, but for rounding.
    let room = |[a, b, c]: Row3, [x, y]: [f64; 2]| 1e-12 * ((a * x).abs() + (b * y).abs() + c.abs());
    let below = |edge: Row3, v: [f64; 2]| dot(edge, [v[0], v[1], 1.0]) <= room(edge, v);
    let on_one_side = |edge: &Row3| corners.iter().all(|&v| below(*edge, v));
    polygon.edges().iter().any(on_one_side)
}

/// Least and greatest coordinates of a thing in the picture: of a solid, a polygon or an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Least x and y.
    pub low: [f64; 2],
    /// Greatest x and y.
    pub high: [f64; 2],
}

impl Extent {
    /// Of some points; `None` without any.
    #[must_use]
    pub fn of(points: &[[f64; 2]]) -> Option<Self> {
        let &first = points.first()?;
        let grow = |e: Self, p: &[f64; 2]| Self {
            low: std::array::from_fn(|k| e.low[k].min(p[k])),
            high: std::array::from_fn(|k| e.high[k].max(p[k])),
        };
        Some(points.iter().fold(Self { low: first, high: first }, grow))
    }

    /// The minimax test: two things whose rectangles do not overlap cannot hide each other. Rectangles
    /// that only touch do not overlap.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] < other.high[k] && other.low[k] < self.high[k])
    }
}

#[cfg(test)]
mod tests;
