//! Single triangles.

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::analytic::{Analytic, Chart};
use crate::{Crossing, Ray, SurfacePoint};

/// Where a line meets a triangle: parameter, and the weights of the second and third corner.
///
/// Watertight: a line that passes between triangles which share a side or a corner meets one of them at
/// least; sides belong to both. Both faces are met; triangles seen edge-on are not. The line is turned
/// into the z axis by a shear after which the three signed areas are the same, to the last digit, for
/// both neighbours of a side. Source: Woop, Benthin and Wald 2013.
#[must_use]
#[inline]
pub fn ray_triangle(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, DVec2)> {
    // The axis along which the direction is longest becomes z; the others keep the orientation.
    let size = ray.direction.abs();
    let z = if size.x > size.y {
        if size.x > size.z { 0 } else { 2 }
    } else if size.y > size.z {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let shear = ray.direction / ray.direction[z];
    let sheared = |p: DVec3| {
        let from_origin = p - ray.origin;
        DVec3::new(
            from_origin[x] - shear[x] * from_origin[z],
            from_origin[y] - shear[y] * from_origin[z],
            from_origin[z] / ray.direction[z],
        )
    };
    let (a, b, c) = (sheared(a), sheared(b), sheared(c));

    // Twice the signed areas opposite to each corner.
    let opposite = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
    if opposite.iter().any(|w| *w < 0.0) && opposite.iter().any(|w| *w > 0.0) {
        return None;
    }
    let sum = opposite[0] + opposite[1] + opposite[2];
    let [u, v, w] = opposite.map(|area| area / sum);
    let t = u * a.z + v * b.z + w * c.z;
    t.is_finite().then_some((t, DVec2::new(v, w)))
}

/// One flat triangle, counter-clockwise seen from its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    corners: [DVec3; 3],
}

impl Triangle {
    /// A triangle of finite corners. One without an area is never met.
    #[must_use]
    pub fn new(corners: [DVec3; 3]) -> Self {
        Self { corners }
    }
}

impl Analytic for Triangle {
    fn bounds(&self) -> Aabb {
        Aabb::of_points(self.corners)
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        if let Some((t, uv)) = ray_triangle(ray, self.corners) {
            meet(t, 0, uv);
        }
    }

    /// Texture coordinates are the weights of the second and third corner.
    fn surface_point(&self, _: &Ray, crossing: &Crossing) -> SurfacePoint {
        let [a, b, c] = self.corners;
        let point = a + crossing.uv.x * (b - a) + crossing.uv.y * (c - a);
        let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
        Chart { uv: crossing.uv, along_u: b - a, along_v: c - a }.at(point, normal, 0)
    }

    fn is_closed(&self) -> bool {
        false
    }
}
