//! Details of a surface that come from pictures: normals and occlusion.

use senca_math::glam::{Vec2, Vec3, Vec4};

/// `normal`, or its opposite where it points away from the observer: two-sided lighting.
#[must_use]
pub fn face_towards(normal: Vec3, to_viewer: Vec3) -> Vec3 {
    if normal.dot(to_viewer) < 0.0 { -normal } else { normal }
}

/// Unit normal from a tangent-space sample: `sample` holds the map's x, y, z, each in [-1, 1];
/// `strength` scales x and y. The frame is made orthogonal to `normal` (unit); `tangent.w` is the
/// sign of the bitangent. A tangent along the normal leaves it as it is.
/// Source: glTF 2.0, sections 3.7.2.1 and 3.9.3.
#[must_use]
pub fn perturb_normal(normal: Vec3, tangent: Vec4, sample: Vec3, strength: f32) -> Vec3 {
    let t = tangent.truncate();
    let Some(t) = (t - normal * normal.dot(t)).try_normalize() else { return normal };
    let b = normal.cross(t) * tangent.w;
    let n = t * (sample.x * strength) + b * (sample.y * strength) + normal * sample.z;
    n.try_normalize().unwrap_or(normal)
}

/// Tangent along increasing u and the sign of the bitangent (which points up the picture, along
/// decreasing v), of a triangle with `positions` and
/// texture coordinates `uvs`. `None` when either has no area.
#[must_use]
pub fn tangent_frame(positions: [Vec3; 3], uvs: [Vec2; 3]) -> Option<Vec4> {
    let (e1, e2) = (positions[1] - positions[0], positions[2] - positions[0]);
    let (d1, d2) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
    let area = d1.perp_dot(d2);
    let t = ((e1 * d2.y - e2 * d1.y) * area.signum()).try_normalize()?;
    // v runs down the picture, while the green of a normal map points up it: along -v.
    let up = (e1 * d2.x - e2 * d1.x) * area.signum();
    let sign = if e1.cross(e2).cross(t).dot(up) < 0.0 { -1.0 } else { 1.0 };
    (area != 0.0).then(|| t.extend(sign))
}

/// Share of ambient light after an occlusion map: `1 + strength (sample - 1)`.
/// Source: glTF 2.0, section 3.9.3.
#[must_use]
pub fn with_occlusion(sample: f32, strength: f32) -> f32 {
    1.0 + strength * (sample - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_sample_keeps_the_normal() {
        let n = perturb_normal(Vec3::Y, Vec4::new(1.0, 0.0, 0.0, 1.0), Vec3::Z, 1.0);
        assert!(n.abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn the_sample_leans_along_tangent_and_bitangent() {
        let s = Vec3::new(0.6, 0.0, 0.8);
        let n = perturb_normal(Vec3::Z, Vec4::new(1.0, 0.0, 0.5, 1.0), s, 1.0);
        assert!(n.abs_diff_eq(s, 1e-6), "{n}");
        let n = perturb_normal(Vec3::Z, Vec4::new(1.0, 0.0, 0.0, -1.0), Vec3::new(0.0, 0.6, 0.8), 1.0);
        assert!(n.abs_diff_eq(Vec3::new(0.0, -0.6, 0.8), 1e-6), "{n}");
        let flat = perturb_normal(Vec3::Z, Vec4::new(1.0, 0.0, 0.0, 1.0), s, 0.0);
        assert!(flat.abs_diff_eq(Vec3::Z, 1e-6));
    }

    #[test]
    fn a_tangent_along_the_normal_is_harmless() {
        assert_eq!(perturb_normal(Vec3::Z, Vec4::Z, Vec3::X, 1.0), Vec3::Z);
    }

    #[test]
    fn tangents_follow_u() {
        let p = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y];
        // The picture upright: v = 0 at its top, so v falls as y grows.
        let upright = tangent_frame(p, [Vec2::Y, Vec2::ONE, Vec2::ZERO]).expect("has area");
        assert!(upright.abs_diff_eq(Vec4::new(1.0, 0.0, 0.0, 1.0), 1e-6), "{upright}");
        let mirrored = tangent_frame(p, [Vec2::ONE, Vec2::Y, Vec2::X]).expect("has area");
        assert!(mirrored.abs_diff_eq(Vec4::new(-1.0, 0.0, 0.0, -1.0), 1e-6), "{mirrored}");
        assert!(tangent_frame(p, [Vec2::ZERO; 3]).is_none());
    }

    #[test]
    fn occlusion_fades_with_its_strength() {
        assert_eq!(with_occlusion(0.25, 1.0), 0.25);
        assert_eq!(with_occlusion(0.25, 0.0), 1.0);
    }

    #[test]
    fn backs_turn_to_the_observer() {
        assert_eq!(face_towards(Vec3::Z, -Vec3::Z), -Vec3::Z);
        assert_eq!(face_towards(Vec3::Z, Vec3::Z), Vec3::Z);
    }
}
