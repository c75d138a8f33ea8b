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

    /// The same seen from its other side.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [a, b, c, d] = self.corners;
        if self.count == 3 { Self::triangle([c, b, a]) } else { Self::quad([d, c, b, a]) }
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

    /// Weights of the corners at a place in the plane of the patch, or near it: bilinear in a
    /// quadrilateral, barycentric in a triangle, whose fourth weight is 0. Each is in [0, 1] and their sum
    /// is 1; places outside count as the nearest within, roughly.
    #[must_use]
    pub fn weights_at(&self, place: DVec3) -> [f64; 4] {
        let [u, v] = self.parameters_at(place);
        if self.count == 3 {
            return [1.0 - u - v, u, v, 0.0];
        }
        [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
    }

    /// Parameters of a place in the plane of the patch, or near it: (u, v) in the unit square of a
    /// quadrilateral, the inverse of [`PatchPolygon::place`]; in a triangle the weights of its second and
    /// third corner. Places outside are moved in.
    /// Source: course text, task 4.3.
    #[must_use]
    pub fn parameters_at(&self, place: DVec3) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        let normal = newell_normal(self.corners());
        if self.count == 3 {
            let twice = normal.length_squared() * 2.0;
            let share = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(normal) / twice;
            let [u, v] = [share(c, a), share(a, b)].map(|w| if w > 0.0 { w.min(1.0) } else { 0.0 });
            let sum = (u + v).max(1.0);
            return [u / sum, v / sum];
        }
        // place - a = u e + v f + u v g in the plane, in which a cross product is a number.
        let cross = |p: DVec3, q: DVec3| p.cross(q).dot(normal);
        let (h, e, f, g) = (place - a, b - a, d - a, (a - b) + (c - d));
        let (k2, k1, k0) = (cross(g, f), cross(e, f) + cross(h, g), cross(h, e));
        let v = root_in_unit(k2, k1, k0);
        let along = e + g * v;
        let u = (h - f * v).dot(along) / along.length_squared();
        [u, v].map(|w| if w > 0.0 { w.min(1.0) } else { 0.0 })
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

/// The root of `k2 x^2 + k1 x + k0` that is nearest to the unit interval.
fn root_in_unit(k2: f64, k1: f64, k0: f64) -> f64 {
    if k2.abs() <= 1e-12 * k1.abs() {
        return -k0 / k1;
    }
    let root = (k1 * k1 - 4.0 * k2 * k0).max(0.0).sqrt();
    let q = -0.5 * (k1 + root.copysign(k1));
    let outside = |x: f64| if x.is_nan() { f64::INFINITY } else { (x - 0.5).abs() };
    [q / k2, k0 / q].into_iter().min_by(|p, q| outside(*p).total_cmp(&outside(*q))).unwrap_or(0.5)
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

    /// Course text, task 4.3.
    #[test]
    fn values_within_a_quadrilateral_are_bilinear() {
        let corners = [[1.0, 1.0], [5.0, 2.0], [6.0, 5.0], [0.0, 4.0]];
        let quads =
            [PatchPolygon::quad(SQUARE), PatchPolygon::quad(corners.map(|[x, y]| DVec3::new(x, y, 2.0)))];
        // B00, B10, B11, B01.
        let values = [1.0, 2.0, 6.0, 3.0];
        let examples = [([0.5, 0.5], 3.0), ([0.25, 0.5], 2.5), ([1.0, 0.0], 2.0), ([0.0, 1.0], 3.0)];
        for quad in quads {
            for ([u, v], value) in examples {
                let weights = quad.weights_at(quad.place(u, v));
                let sum: f64 = weights.iter().zip(values).map(|(w, b)| w * b).sum();
                assert!((sum - value).abs() < 1e-12, "{sum} at {u}, {v}");
            }
        }
    }

    #[test]
    fn parameters_undo_places_and_stay_inside() {
        let corners = [[0.0, 0.0], [4.0, 0.0], [2.0, 3.0], [0.0, 3.0]];
        for turn in 0..4 {
            let mut corners = corners.map(|[x, y]| DVec3::new(x, 1.0, y));
            corners.rotate_left(turn);
            let quad = PatchPolygon::quad(corners);
            for i in 0..=10 {
                for j in 0..=10 {
                    let (u, v) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
                    let [p, q] = quad.parameters_at(quad.place(u, v));
                    assert!((p - u).abs() < 1e-9 && (q - v).abs() < 1e-9, "{u} {v} gives {p} {q}");
                }
            }
            let outside = quad.weights_at(DVec3::new(-50.0, 1.0, 80.0));
            assert!(outside.iter().all(|w| (0.0..=1.0).contains(w)), "{outside:?}");
        }
        let triangle = PatchPolygon::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let [a, b, c, d] = triangle.weights_at(DVec3::new(0.25, 0.5, 0.0));
        assert!((a - 0.25).abs() < 1e-15 && (b - 0.25).abs() < 1e-15 && (c - 0.5).abs() < 1e-15 && d == 0.0);
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
