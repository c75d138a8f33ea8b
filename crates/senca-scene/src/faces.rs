//! Building faces: quadrilaterals, strips, fans and meshes of quadrilaterals.
//!
//! The groupings of the course text, section 2.3, save vertices: m by n quadrilaterals need
//! (m + 1)(n + 1) vertices instead of 6 m n, a strip of k triangles k + 2 instead of 3 k. They are
//! entered here by vertex index; the vertices stay shared.

use senca_math::glam::Vec3;

use crate::Mesh;

/// Share of a quadrilateral's size by which its fourth corner may leave the plane of the others and
/// still be called flat; a few steps of `f32` rounding.
const FLATNESS: f32 = 2e-6;

/// Whether four corners lie in one plane, up to rounding, and form a convex outline.
#[must_use]
pub fn is_flat_quad([a, b, c, d]: [Vec3; 4]) -> bool {
    let (ac, bd) = (c - a, d - b);
    let normal = ac.cross(bd);
    let size = ac.length().max(bd.length());
    let off_plane = normal.dot(b - a).abs();
    let turns = [(b - a, c - b), (c - b, d - c), (d - c, a - d), (a - d, b - a)];
    off_plane <= FLATNESS * size * normal.length()
        && turns.iter().all(|(u, v)| u.cross(*v).dot(normal) >= 0.0)
}

/// The two triangles of a quadrilateral, as indices of its corners. Of the two diagonals the one is
/// taken whose triangles both face the quadrilateral's mean normal; if both do, the shorter; if they
/// are equally long, the one from the first corner.
#[must_use]
pub fn split_quad([a, b, c, d]: [Vec3; 4]) -> [[usize; 3]; 2] {
    const FIRST: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
    const SECOND: [[usize; 3]; 2] = [[0, 1, 3], [1, 2, 3]];
    let normal = (c - a).cross(d - b);
    let faces = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - p).dot(normal) > 0.0;
    let first_fits = faces(a, b, c) && faces(a, c, d);
    let second_fits = faces(a, b, d) && faces(b, c, d);
    let second_is_shorter = d.distance_squared(b) < c.distance_squared(a);
    if second_fits && (second_is_shorter || !first_fits) { SECOND } else { FIRST }
}

impl Mesh {
    /// Appends a quadrilateral, whole when it is flat, else as two triangles (see [`split_quad`]).
    ///
    /// # Panics
    /// When a vertex is out of range.
    pub fn add_quad(&mut self, corners: [u32; 4], surface: u32) {
        let places = corners.map(|v| self.position(v));
        if is_flat_quad(places) {
            return self.faces.push(&corners, surface);
        }
        for triangle in split_quad(places) {
            self.faces.push(&triangle.map(|i| corners[i]), surface);
        }
    }

    /// Appends a strip of quadrilaterals: `strip` holds the vertices in pairs, one from each side, so
    /// that corners 0, 1, 3, 2 go around the first counter-clockwise. A last odd vertex is dropped.
    ///
    /// # Panics
    /// When a vertex is out of range.
    pub fn add_quad_strip(&mut self, strip: &[u32], surface: u32) {
        for i in (0..strip.len().saturating_sub(3)).step_by(2) {
            self.add_quad([strip[i], strip[i + 1], strip[i + 3], strip[i + 2]], surface);
        }
    }

    /// Appends a mesh of quadrilaterals over rows of `columns` vertices each, counter-clockwise when
    /// rows follow upwards. A last incomplete row is dropped.
    ///
    /// # Panics
    /// When a vertex is out of range.
    pub fn add_quad_mesh(&mut self, vertices: &[u32], columns: usize, surface: u32) {
        if columns < 2 {
            return;
        }
        let rows: Vec<&[u32]> = vertices.chunks_exact(columns).collect();
        for pair in rows.windows(2) {
            for i in 0..columns - 1 {
                self.add_quad([pair[0][i], pair[0][i + 1], pair[1][i + 1], pair[1][i]], surface);
            }
        }
    }

    /// Appends a strip of triangles: each vertex after the second makes one with the two before it,
    /// every second one turned so that all face the same way. Triangles with a repeated vertex, which
    /// join strips, are dropped.
    pub fn add_triangle_strip(&mut self, strip: &[u32], surface: u32) {
        for (i, t) in strip.windows(3).enumerate() {
            let [a, b, c] = if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            if a != b && b != c && c != a {
                self.faces.push(&[a, b, c], surface);
            }
        }
    }

    /// Appends a fan of triangles around its first vertex.
    pub fn add_triangle_fan(&mut self, fan: &[u32], surface: u32) {
        let Some((&center, rim)) = fan.split_first() else { return };
        for pair in rim.windows(2) {
            self.faces.push(&[center, pair[0], pair[1]], surface);
        }
    }

    /// Appends a vertex with all attributes of `vertex`, and returns its index. Morph targets follow.
    ///
    /// # Panics
    /// When `vertex` is out of range.
    pub fn copy_vertex(&mut self, vertex: u32) -> u32 {
        fn copy<T: Copy>(list: &mut Vec<T>, i: usize) {
            if let Some(&value) = list.get(i) {
                list.push(value);
            }
        }
        let i = vertex as usize;
        let new = self.vertices.point.len() as u32;
        self.vertices.point.push(self.vertices.point[i]);
        copy(&mut self.vertices.normal, i);
        copy(&mut self.vertices.texcoord0, i);
        copy(&mut self.vertices.texcoord1, i);
        copy(&mut self.vertices.color, i);
        copy(&mut self.vertices.tangent, i);
        for target in &mut self.morph_targets {
            copy(&mut target.normals, i);
            copy(&mut target.tangents, i);
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vertices;

    fn mesh_of(points: &[[f32; 3]]) -> Mesh {
        let points: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
        let vertices = Vertices { point: (0..points.len() as u32).collect(), ..Vertices::default() };
        Mesh { points, vertices, ..Mesh::default() }
    }

    #[test]
    fn a_mesh_of_quads_shares_its_vertices() {
        let (m, n) = (5usize, 3usize);
        let points: Vec<[f32; 3]> =
            (0..=n).flat_map(|j| (0..=m).map(move |i| [i as f32, j as f32, 0.0])).collect();
        let mut mesh = mesh_of(&points);
        let all: Vec<u32> = (0..points.len() as u32).collect();
        mesh.add_quad_mesh(&all, m + 1, 0);
        assert_eq!((mesh.faces.len(), mesh.faces.triangle_count()), (m * n, 2 * m * n));
        assert_eq!(mesh.vertices.point.len(), (m + 1) * (n + 1));
        assert_eq!(mesh.faces.corners_of(0), [0, 1, 7, 6]);
    }

    #[test]
    fn strips_and_fans_turn_one_way() {
        let mut mesh =
            mesh_of(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]]);
        mesh.add_triangle_strip(&[1, 0, 3, 2, 2, 4], 0);
        assert_eq!(mesh.faces.corners, [1, 0, 3, 3, 0, 2]);
        mesh.faces = crate::Faces::default();
        mesh.add_triangle_fan(&[0, 2, 3, 1], 0);
        assert_eq!(mesh.faces.corners, [0, 2, 3, 0, 3, 1]);
        mesh.faces = crate::Faces::default();
        mesh.add_quad_strip(&[1, 0, 3, 2], 0);
        assert_eq!(mesh.faces.corners, [1, 0, 2, 3]);
    }

    #[test]
    fn quads_that_are_not_flat_or_not_convex_are_split_inside() {
        let dart = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]].map(Vec3::from);
        assert!(!is_flat_quad(dart));
        assert_eq!(split_quad(dart), [[0, 1, 2], [0, 2, 3]]);
        let turned = [dart[1], dart[2], dart[3], dart[0]];
        assert_eq!(split_quad(turned), [[0, 1, 3], [1, 2, 3]]);
        let saddle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]].map(Vec3::from);
        assert!(!is_flat_quad(saddle));
    }
}
