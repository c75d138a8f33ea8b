//! Planes in homogeneous form.
//!
//! A plane is `n = (nx, ny, nz, -rho)` with unit normal and signed distance rho of the plane from the
//! origin along it; `n . x` for a homogeneous point x is positive on the side the normal points to.
//! Planes that bound a volume point out of it. Source: course text, section 2.7.

use glam::{DMat4, DVec3, DVec4};

use crate::frame::unit;
use crate::ray::Ray;

/// A plane by its homogeneous coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// `(nx, ny, nz, -rho)`.
    pub coefficients: DVec4,
}

impl Plane {
    /// From a normal of any length but 0 and a point of the plane; `None` for a zero normal or
    /// coordinates that are not finite.
    #[must_use]
    pub fn from_normal_and_point(normal: DVec3, point: DVec3) -> Option<Self> {
        let normal = unit(normal)?;
        let coefficients = normal.extend(-normal.dot(point));
        coefficients.is_finite().then_some(Self { coefficients })
    }

    /// The plane through three points, its normal towards the side from which they run
    /// counter-clockwise; `None` when they lie on one line.
    #[must_use]
    pub fn through(a: DVec3, b: DVec3, c: DVec3) -> Option<Self> {
        Self::from_normal_and_point((b - a).cross(c - a), a)
    }

    /// The unit normal.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        self.coefficients.truncate()
    }

    /// rho, the signed distance of the plane from the origin along its normal.
    #[must_use]
    pub fn distance_from_origin(&self) -> f64 {
        -self.coefficients.w
    }

    /// Signed distance of a point: positive on the side the normal points to.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        self.side(point.extend(1.0))
    }

    /// `n . x` of a homogeneous point: for `w > 0` positive outside, 0 on the plane, negative inside
    /// (equation 2.16).
    #[must_use]
    pub fn side(&self, point: DVec4) -> f64 {
        self.coefficients.dot(point)
    }

    /// The parameter at which `(1 - t) a + t b` crosses the plane, for homogeneous points (equation
    /// 2.18); `None` when the line is parallel to the plane.
    #[must_use]
    pub fn crossing(&self, a: DVec4, b: DVec4) -> Option<f64> {
        let t = self.side(a) / self.coefficients.dot(a - b);
        t.is_finite().then_some(t)
    }

    /// The parameter at which a ray meets the plane, which may be negative; `None` when it is
    /// parallel to the plane.
    #[must_use]
    pub fn ray_parameter(&self, ray: &Ray) -> Option<f64> {
        let t = -self.signed_distance(ray.origin) / self.normal().dot(ray.direction);
        t.is_finite().then_some(t)
    }

    /// The foot of the perpendicular from a point.
    #[must_use]
    pub fn nearest_point(&self, point: DVec3) -> DVec3 {
        point - self.signed_distance(point) * self.normal()
    }

    /// The same plane with its sides exchanged.
    #[must_use]
    pub fn flipped(&self) -> Self {
        Self { coefficients: -self.coefficients }
    }

    /// The plane after a map given by its inverse, `source_from_target`; points keep their side.
    /// `None` when the result is the plane at infinity.
    #[must_use]
    pub fn transformed_by_inverse(&self, source_from_target: &DMat4) -> Option<Self> {
        let plane = source_from_target.transpose() * self.coefficients;
        let length = plane.truncate().length();
        (length > 0.0 && plane.is_finite()).then(|| Self { coefficients: plane / length })
    }
}

/// The six planes of the canonical volume of the viewing operations, in the text's order: x = 1,
/// x = -1, y = 1, y = -1, z = 0 (front), z = -1 (back), normals outwards.
pub const CANONICAL_VOLUME: [Plane; 6] = [
    plane(1.0, 0.0, 0.0, -1.0),
    plane(-1.0, 0.0, 0.0, -1.0),
    plane(0.0, 1.0, 0.0, -1.0),
    plane(0.0, -1.0, 0.0, -1.0),
    plane(0.0, 0.0, 1.0, 0.0),
    plane(0.0, 0.0, -1.0, -1.0),
];

/// The six planes of the clip volume that renderers use (z from 0 near to 1 far), in the same order:
/// right, left, top, bottom, near, far, normals outwards.
pub const CLIP_VOLUME: [Plane; 6] = [
    plane(1.0, 0.0, 0.0, -1.0),
    plane(-1.0, 0.0, 0.0, -1.0),
    plane(0.0, 1.0, 0.0, -1.0),
    plane(0.0, -1.0, 0.0, -1.0),
    plane(0.0, 0.0, -1.0, 0.0),
    plane(0.0, 0.0, 1.0, -1.0),
];

const fn plane(x: f64, y: f64, z: f64, w: f64) -> Plane {
    Plane { coefficients: DVec4::new(x, y, z, w) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{assert_close3, vec3};

    #[test]
    fn an_edge_meets_the_plane_as_in_example_2_1() {
        let (p1, p2) = (DVec4::new(1.0, 1.0, 0.0, 1.0), DVec4::new(3.0, 1.0, 2.0, 1.0));
        let plane = Plane::from_normal_and_point(DVec3::Z, DVec3::Z).unwrap();
        assert_eq!(plane.coefficients, DVec4::new(0.0, 0.0, 1.0, -1.0));
        assert_eq!((plane.side(p1), plane.coefficients.dot(p1 - p2)), (-1.0, -2.0));
        let t = plane.crossing(p1, p2).unwrap();
        assert_eq!((t, p1.lerp(p2, t)), (0.5, DVec4::new(2.0, 1.0, 1.0, 1.0)));
        assert!(plane.crossing(p1, p1 + DVec4::X).is_none());
    }

    #[test]
    fn three_points_give_a_plane_with_sides() {
        let plane = Plane::through(vec3(0, 0, 2), vec3(1, 0, 2), vec3(0, 1, 2)).unwrap();
        assert_eq!((plane.normal(), plane.distance_from_origin()), (DVec3::Z, 2.0));
        assert_eq!(plane.signed_distance(vec3(5, 5, 5)), 3.0);
        assert_eq!(plane.flipped().signed_distance(vec3(5, 5, 5)), -3.0);
        assert_eq!(plane.nearest_point(vec3(5, 5, 5)), vec3(5, 5, 2));
        assert!(Plane::through(vec3(0, 0, 0), vec3(1, 1, 1), vec3(2, 2, 2)).is_none());
        assert!(Plane::through(DVec3::NAN, vec3(1, 1, 1), vec3(2, 2, 2)).is_none());
        let ray = Ray { origin: vec3(0, 0, 6), direction: vec3(1, 0, -2) };
        assert_eq!(plane.ray_parameter(&ray), Some(2.0));
    }

    #[test]
    fn volumes_have_their_inside_on_the_negative_side() {
        let inside = |volume: &[Plane; 6], p: DVec4| volume.iter().all(|plane| plane.side(p) < 0.0);
        let middle = DVec4::new(0.0, 0.0, -1.0, 2.0);
        assert!(inside(&CANONICAL_VOLUME, middle) && !inside(&CLIP_VOLUME, middle));
        assert!(!inside(&CANONICAL_VOLUME, -middle));
        assert!(inside(&CLIP_VOLUME, DVec4::new(0.0, 0.0, 1.0, 2.0)));
    }

    #[test]
    fn a_plane_follows_its_points() {
        let points = [vec3(0, 0, 2), vec3(1, 0, 3), vec3(0, 2, 1)];
        let plane = Plane::through(points[0], points[1], points[2]).unwrap();
        let m = DMat4::from_scale(DVec3::new(2.0, -1.0, 3.0)) * DMat4::from_translation(vec3(1, 2, 3));
        let moved = plane.transformed_by_inverse(&m.inverse()).unwrap();
        for p in points {
            assert!(moved.signed_distance(m.transform_point3(p)).abs() < 1e-12);
        }
        let outside = plane.signed_distance(vec3(9, 9, 9));
        assert!(moved.signed_distance(m.transform_point3(vec3(9, 9, 9))) * outside > 0.0);
        let at_infinity = Plane { coefficients: DVec4::W };
        assert!(at_infinity.transformed_by_inverse(&DMat4::IDENTITY).is_none());
        assert_close3(moved.normal(), moved.normal().normalize(), 1e-15);
    }
}
