//! One ray against one triangle, the plain form.
//!
//! Sven Woop, Carsten Benthin, Ingo Wald: Watertight Ray/Triangle Intersection, Journal of Computer
//! Graphics Techniques 2(1), 2013. Space is sheared so that the ray becomes the z axis. A corner's place
//! there does not depend on the triangle it belongs to, and the signs of the edge functions are exact for
//! those places; so a ray near an edge hits at least one of the two triangles that share it.
//!
//! No operation is contracted to a fused one: the two sides of an edge would round differently.
//!
//! The distance is kept within the triangle's own box, where the true one is. That makes it a fact of the
//! ray and the triangle alone that no box around the triangle is farther than the hit, so the answer of a
//! hierarchy does not depend on its shape.

use crate::prepared::PreparedRay;
use senca_math::glam::Vec3;

/// Smallest determinant for which single precision is used; below, products of coordinates have lost
/// digits.
pub(crate) const SMALLEST_DETERMINANT: f32 = 1e-30;

/// t, u and v of the hit, with `t_min < t`; none when the ray misses.
pub(crate) fn intersect(ray: &PreparedRay, corners: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let origin = Vec3::from_array(ray.origin);
    let relative = corners.map(|corner| corner - origin);
    let sheared = relative.map(|r| {
        let z = r[ray.axes[2]];
        [r[ray.axes[0]] - ray.shear[0] * z, r[ray.axes[1]] - ray.shear[1] * z, ray.shear[2] * z]
    });
    let (t, u, v) = single(sheared).or_else(|| double(sheared))?;

    let min = corners[0].min(corners[1]).min(corners[2]);
    let max = corners[0].max(corners[1]).max(corners[2]);
    let (enter, leave) = ray.interval(min, max);
    let t = if t < leave { t } else { leave };
    let t = if t > enter { t } else { enter };
    (enter <= leave && t > ray.t_min).then_some((t, u, v))
}

/// In single precision, when it decides for a hit.
fn single([a, b, c]: [[f32; 3]; 3]) -> Option<(f32, f32, f32)> {
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    let det = u + v + w;
    let inside = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
    let safe = det.abs() >= SMALLEST_DETERMINANT && det.abs() < f32::INFINITY;
    let t = (u * a[2] + v * b[2] + w * c[2]) / det;
    (inside && safe).then_some((t, v / det, w / det))
}

/// In double precision, where the products are exact: rays through an edge or a corner, and tiny or huge
/// triangles.
fn double(sheared: [[f32; 3]; 3]) -> Option<(f32, f32, f32)> {
    let [a, b, c] = sheared.map(|corner| corner.map(f64::from));
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    let det = u + v + w;
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let t = (u * a[2] + v * b[2] + w * c[2]) / det;
    (inside && det != 0.0 && t.is_finite()).then_some((t as f32, (v / det) as f32, (w / det) as f32))
}
