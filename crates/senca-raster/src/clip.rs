//! Clipping of convex polygons in homogeneous coordinates, before the division by w.
//!
//! Source: course text, section 2.7, equations 2.15 to 2.18; Sutherland, Hodgman 1974. Each plane is
//! a four-vector `n` with the outward normal: a point is outside when `n . x > 0`. A polygon is cut by
//! one plane after another. A vertex made by a cut carries the weights of the three original corners
//! in it, from which every varying follows; as they are linear in homogeneous space they are right
//! under perspective.
//!
//! A cut is always computed from the inner to the outer end of an edge, so two triangles that share
//! an edge get the same new vertex, to the last bit.

use senca_math::glam::Vec4;

/// Vertices of a polygon after any cut: three corners and one more per plane, for up to nine planes.
pub const MAX_POLYGON: usize = 12;

/// Planes of the view volume -w <= x, y <= w, 0 <= z <= w.
pub const VIEW_VOLUME: [Vec4; 6] = [
    Vec4::new(1.0, 0.0, 0.0, -1.0),
    Vec4::new(-1.0, 0.0, 0.0, -1.0),
    Vec4::new(0.0, 1.0, 0.0, -1.0),
    Vec4::new(0.0, -1.0, 0.0, -1.0),
    Vec4::new(0.0, 0.0, -1.0, 0.0),
    Vec4::new(0.0, 0.0, 1.0, -1.0),
];

/// Planes of the canonical volume of the viewing operations, -w <= x, y <= w, -w <= z <= 0.
/// Source: course text, section 2.7, table of planes.
pub const CANONICAL_VOLUME: [Vec4; 6] = [
    Vec4::new(1.0, 0.0, 0.0, -1.0),
    Vec4::new(-1.0, 0.0, 0.0, -1.0),
    Vec4::new(0.0, 1.0, 0.0, -1.0),
    Vec4::new(0.0, -1.0, 0.0, -1.0),
    Vec4::new(0.0, 0.0, 1.0, 0.0),
    Vec4::new(0.0, 0.0, -1.0, -1.0),
];

/// A corner of a polygon being clipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClipVertex {
    /// Homogeneous position.
    pub position: Vec4,
    /// Weights of the three original corners, of sum 1.
    pub weights: [f32; 3],
}

/// A convex polygon of at most [`MAX_POLYGON`] corners.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    vertices: [ClipVertex; MAX_POLYGON],
    len: usize,
}

impl Polygon {
    /// A triangle.
    #[must_use]
    pub fn triangle(corners: [Vec4; 3]) -> Self {
        let mut polygon = Self { vertices: [ClipVertex::default(); MAX_POLYGON], len: 0 };
        for (k, position) in corners.into_iter().enumerate() {
            let mut weights = [0.0; 3];
            weights[k] = 1.0;
            polygon.push(ClipVertex { position, weights });
        }
        polygon
    }

    /// The corners, in the order of the original triangle.
    #[must_use]
    pub fn vertices(&self) -> &[ClipVertex] {
        &self.vertices[..self.len]
    }

    /// Corner numbers of the triangles of the fan around corner 0.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        (2..self.len).map(|k| [0, k - 1, k])
    }

    fn push(&mut self, vertex: ClipVertex) {
        debug_assert!(self.len < MAX_POLYGON, "a convex polygon gains one corner per plane");
        if let Some(slot) = self.vertices.get_mut(self.len) {
            *slot = vertex;
            self.len += 1;
        }
    }

    /// The part of the polygon on the inner side of `plane`, its rim included; empty when there is
    /// none.
    #[must_use]
    pub fn clipped(&self, plane: Vec4) -> Self {
        let mut kept = Self { vertices: [ClipVertex::default(); MAX_POLYGON], len: 0 };
        let corners = self.vertices();
        for (k, a) in corners.iter().enumerate() {
            let b = &corners[(k + 1) % corners.len()];
            let (side_a, side_b) = (plane.dot(a.position), plane.dot(b.position));
            if side_a <= 0.0 {
                kept.push(*a);
            }
            match (side_a < 0.0 && side_b > 0.0, side_a > 0.0 && side_b < 0.0) {
                (true, _) => kept.push(cut(a, side_a, b, side_b)),
                (_, true) => kept.push(cut(b, side_b, a, side_a)),
                _ => {}
            }
        }
        kept
    }
}

/// Where the edge from `inner` to `outer` meets the plane their sides are measured from
/// (equations 2.17, 2.18).
fn cut(inner: &ClipVertex, side_inner: f32, outer: &ClipVertex, side_outer: f32) -> ClipVertex {
    let t = side_inner / (side_inner - side_outer);
    ClipVertex {
        position: inner.position * (1.0 - t) + outer.position * t,
        weights: std::array::from_fn(|k| inner.weights[k] * (1.0 - t) + outer.weights[k] * t),
    }
}

/// The part of a triangle inside all `planes` (at most nine).
#[must_use]
pub fn clip_triangle(corners: [Vec4; 3], planes: &[Vec4]) -> Polygon {
    planes.iter().fold(Polygon::triangle(corners), |polygon, &plane| polygon.clipped(plane))
}

/// Whether some plane has all of `corners` strictly outside.
#[must_use]
pub fn wholly_outside(corners: &[Vec4], planes: &[Vec4]) -> bool {
    planes.iter().any(|n| corners.iter().all(|c| n.dot(*c) > 0.0))
}

/// The parameters `t0 < t1` of the part of the line `a + t (b - a)`, 0 <= t <= 1, inside all
/// `planes`. `None` when nothing is. Source: Liang, Barsky 1984, in homogeneous coordinates.
#[must_use]
pub fn clip_line(a: Vec4, b: Vec4, planes: &[Vec4]) -> Option<[f32; 2]> {
    let (mut t0, mut t1) = (0f32, 1f32);
    for n in planes {
        let (side_a, side_b) = (n.dot(a), n.dot(b));
        if side_a > 0.0 && side_b > 0.0 {
            return None;
        }
        if side_a > 0.0 {
            t0 = t0.max(side_a / (side_a - side_b));
        } else if side_b > 0.0 {
            t1 = t1.min(side_a / (side_a - side_b));
        }
    }
    (t0 < t1).then_some([t0, t1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &[f32], b: &[f32]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() < 2e-6)
    }

    fn affine(v: &ClipVertex) -> [f32; 3] {
        (v.position / v.position.w).truncate().to_array()
    }

    #[test]
    fn edge_meets_plane_as_in_example_2_1() {
        // p1 = (1,1,0,1), p2 = (3,1,2,1), plane z = 1: n.p1 = -1, n.(p1-p2) = -2, lambda = 1/2.
        let plane = Vec4::new(0.0, 0.0, 1.0, -1.0);
        let (p1, p2) = (Vec4::new(1.0, 1.0, 0.0, 1.0), Vec4::new(3.0, 1.0, 2.0, 1.0));
        assert_eq!(plane.dot(p1), -1.0);
        assert_eq!(plane.dot(p1 - p2), -2.0);
        let at = |position| ClipVertex { position, weights: [0.0; 3] };
        let met = cut(&at(p1), plane.dot(p1), &at(p2), plane.dot(p2));
        assert_eq!(met.position, Vec4::new(2.0, 1.0, 1.0, 1.0));
    }

    #[test]
    fn triangle_cut_at_x_1_is_a_quadrilateral_with_interpolated_attributes() {
        let corners =
            [Vec4::new(0.0, 0.0, -0.5, 1.0), Vec4::new(2.0, 0.0, -0.5, 1.0), Vec4::new(0.0, 1.0, -0.5, 1.0)];
        let polygon = clip_triangle(corners, &CANONICAL_VOLUME[..1]);
        let found: Vec<_> = polygon.vertices().iter().map(|v| (affine(v), v.weights)).collect();
        let expected = [
            ([0.0, 0.0, -0.5], [1.0, 0.0, 0.0]),
            ([1.0, 0.0, -0.5], [0.5, 0.5, 0.0]),
            ([1.0, 0.5, -0.5], [0.0, 0.5, 0.5]),
            ([0.0, 1.0, -0.5], [0.0, 0.0, 1.0]),
        ];
        assert_eq!(found, expected);
        assert_eq!(polygon.triangles().collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn vertex_behind_the_eye_is_cut_before_the_division() {
        let corners = [
            Vec4::new(0.0, -0.25, 1.166_666_7, -0.3),
            Vec4::new(0.25, 0.25, -0.333_333_33, 0.6),
            Vec4::new(-0.25, 0.25, -0.333_333_33, 0.6),
        ];
        let polygon = clip_triangle(corners, &CANONICAL_VOLUME);
        let found: Vec<_> = polygon.vertices().iter().map(affine).collect();
        let expected = [
            [0.486_111, 0.347_222, 0.0],
            [0.416_667, 0.416_667, -0.555_556],
            [-0.416_667, 0.416_667, -0.555_556],
            [-0.486_111, 0.347_222, 0.0],
        ];
        assert_eq!(found.len(), 4);
        for e in expected {
            assert!(found.iter().any(|f| close(f, &e)), "{e:?} not in {found:?}");
        }
    }

    #[test]
    fn inside_stays_and_outside_goes() {
        let inside =
            [Vec4::new(0.0, 0.0, 0.5, 1.0), Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 1.0, 1.0)];
        let polygon = clip_triangle(inside, &VIEW_VOLUME);
        assert_eq!(polygon.vertices().iter().map(|v| v.position).collect::<Vec<_>>(), inside);
        let outside = inside.map(|c| c + Vec4::new(1.5, 0.0, 0.0, 0.0));
        assert!(clip_triangle(outside, &VIEW_VOLUME).vertices().is_empty());
        assert!(wholly_outside(&outside, &VIEW_VOLUME) && !wholly_outside(&inside, &VIEW_VOLUME));
    }

    #[test]
    fn shared_edges_are_cut_alike() {
        let (a, b) = (Vec4::new(0.1, 0.3, 0.2, 1.0), Vec4::new(3.7, -0.9, 0.4, 1.3));
        let one = clip_triangle([a, b, Vec4::new(0.0, 5.0, 0.0, 1.0)], &VIEW_VOLUME[..1]);
        let two = clip_triangle([b, a, Vec4::new(0.0, -5.0, 0.0, 1.0)], &VIEW_VOLUME[..1]);
        let shared =
            |p: &Polygon| p.vertices().iter().map(|v| v.position).find(|p| p.y.abs() < 1.0 && *p != a);
        assert_eq!(shared(&one), shared(&two));
    }

    #[test]
    fn lines_keep_their_inner_part() {
        let (a, b) = (Vec4::new(-2.0, 0.0, 0.5, 1.0), Vec4::new(2.0, 0.0, 0.5, 1.0));
        assert_eq!(clip_line(a, b, &VIEW_VOLUME), Some([0.25, 0.75]));
        assert_eq!(clip_line(a + Vec4::Y * 2.0, b + Vec4::Y * 2.0, &VIEW_VOLUME), None);
    }
}
