//! The shape of a patch.

use senca_math::glam::DVec3;
use senca_math::polygon::newell_normal;

/// A triangle or a plane convex quadrilateral in world space, counter-clockwise seen from its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchPolygon {
    corners: [DVec3; 4],
    count: u8,
}

impl PatchPolygon {
    /// A triangle.
    #[must_use]
    pub const fn triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { corners: [a, b, c, c], count: 3 }
    }

    /// A quadrilateral, plane and convex.
    #[must_use]
    pub const fn quad(corners: [DVec3; 4]) -> Self {
        Self { corners, count: 4 }
    }

    /// Corners, 3 or 4.
    #[must_use]
    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..usize::from(self.count)]
    }

    /// Unit normal of the front with the area, both from the sum over the edges; the normal is zero
    /// where there is no area.
    #[must_use]
    pub fn normal_and_area(&self) -> (DVec3, f64) {
        let scaled = newell_normal(self.corners());
        (scaled.normalize_or_zero(), scaled.length())
    }

    /// Centroid.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        let [a, b, c, d] = self.corners;
        if self.count == 3 {
            return (a + b + c) / 3.0;
        }
        let halves = [[a, b, c], [a, c, d]];
        let [first, second] = halves.map(|[p, q, r]| (q - p).cross(r - p).length());
        if first + second <= 0.0 {
            return (a + b + c + d) / 4.0;
        }
        ((a + b + c) * first + (a + c + d) * second) / (3.0 * (first + second))
    }

    /// The polygon in four at the middles of its edges.
    #[must_use]
    pub fn quarters(&self) -> [Self; 4] {
        let [a, b, c, d] = self.corners;
        let middle = |p: DVec3, q: DVec3| 0.5 * (p + q);
        let (ab, bc) = (middle(a, b), middle(b, c));
        if self.count == 3 {
            let ca = middle(c, a);
            return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(Self::triangle);
        }
        let (cd, da) = (middle(c, d), middle(d, a));
        let inner = middle(ab, cd);
        [[a, ab, inner, da], [ab, b, bc, inner], [inner, bc, c, cd], [da, inner, cd, d]].map(Self::quad)
    }

    /// The place at (u, v) in the unit square: bilinear between the corners of a quadrilateral, where
    /// corner 0 is at (0, 0), corner 1 at (1, 0) and corner 2 at (1, 1). Of a triangle evenly, by the
    /// map that keeps shares of area.
    #[must_use]
    pub fn place(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c, d] = self.corners;
        if self.count == 3 {
            let s = u.sqrt();
            return a * (1.0 - s) + b * (s * (1.0 - v)) + c * (s * v);
        }
        a.lerp(b, u).lerp(d.lerp(c, u), v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];

    #[test]
    fn a_square_has_its_normal_area_and_center() {
        let square = PatchPolygon::quad(SQUARE);
        assert_eq!(square.normal_and_area(), (DVec3::Z, 1.0));
        assert!(square.center().distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-15);
        assert_eq!(square.place(0.25, 0.5), DVec3::new(0.25, 0.5, 0.0));
    }

    #[test]
    fn the_center_of_a_trapezium_weighs_by_area() {
        let corners = [[0.0, 0.0], [4.0, 0.0], [2.0, 3.0], [0.0, 3.0]];
        let trapezium = PatchPolygon::quad(corners.map(|[x, y]| DVec3::new(x, y, 0.0)));
        // Height of the centroid above the long side: h (a + 2b) / 3 (a + b).
        assert!((trapezium.center().y - 3.0 * (4.0 + 2.0 * 2.0) / (3.0 * 6.0)).abs() < 1e-14);
    }

    #[test]
    fn quarters_add_up() {
        let trapezium = [[0.0, 0.0], [4.0, 0.0], [2.0, 3.0], [0.0, 3.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let shapes =
            [PatchPolygon::quad(trapezium), PatchPolygon::triangle([DVec3::ZERO, DVec3::X, DVec3::Y])];
        for shape in shapes {
            let sum: DVec3 = shape.quarters().iter().map(|q| q.center() * q.normal_and_area().1).sum();
            let (normal, area) = shape.normal_and_area();
            assert!((sum / area).distance(shape.center()) < 1e-14);
            assert!(shape.quarters().iter().all(|q| q.normal_and_area().0.distance(normal) < 1e-14));
        }
    }

    #[test]
    fn a_triangle_is_filled_evenly() {
        let triangle = PatchPolygon::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let n = 64;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let near = (0..n * n).filter(|i| triangle.place(at(i / n), at(i % n)).x < 0.25).count();
        // The part with x < 1/4 has 1 - (3/4)^2 of the area.
        assert!((near as f64 / (n * n) as f64 - 0.4375).abs() < 0.01, "{near}");
    }
}
