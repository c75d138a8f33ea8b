//! The test for highlights: which polygons want Phong, and which do with Gouraud (1991 thesis, section 7.3;
//! the "H-test" of Watt 1989).
//!
//! Gouraud loses a highlight that lies between vertices. So a polygon is shaded after Phong when some pixel
//! of it may have a cosine of the highlight, and after Gouraud, which is cheaper, when none can. Phong's
//! normals are weighted means of the vertices': they lie in the cone that these span, and the largest cosine
//! with the light in there is found exactly.

use senca_math::glam::DVec3;

/// Corners above which a polygon is taken to have a highlight, as all triples of them would be too many.
const MOST_CORNERS: usize = 12;

/// Whether a normal between those of the vertices can have a cosine of at least `least` with the light, a
/// unit vector.
pub(super) fn may_have_highlight(normals: &[DVec3], light: DVec3, least: f64) -> bool {
    normals.len() > MOST_CORNERS || greatest_cosine(normals, light) >= least
}

/// The largest cosine with the light of any mean of the normals with weights from 0 up.
fn greatest_cosine(normals: &[DVec3], light: DVec3) -> f64 {
    let mut greatest = -1.0_f64;
    for (i, &a) in normals.iter().enumerate() {
        greatest = greatest.max(a.normalize_or_zero().dot(light));
        for (j, &b) in normals.iter().enumerate().skip(i + 1) {
            greatest = greatest.max(on_arc(a, b, light));
            if normals.iter().skip(j + 1).any(|&c| is_within(light, [a, b, c])) {
                return 1.0;
            }
        }
    }
    greatest
}

/// The largest cosine between two normals, where it is not at one of them.
fn on_arc(a: DVec3, b: DVec3, light: DVec3) -> f64 {
    // The direction in the plane of both that is nearest to the light; it counts if it lies between them.
    let upright = a.cross(b);
    let nearest = light - upright * (light.dot(upright) / upright.length_squared().max(f64::MIN_POSITIVE));
    let is_between = a.cross(nearest).dot(upright) >= 0.0 && nearest.cross(b).dot(upright) >= 0.0;
    if is_between && nearest.dot(a + b) > 0.0 { nearest.normalize_or_zero().dot(light) } else { -1.0 }
}

/// Whether a direction is a mean of three others with weights from 0 up.
fn is_within(direction: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let volume = a.dot(b.cross(c));
    let weights = [direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b))];
    volume != 0.0 && weights.iter().all(|weight| weight / volume >= 0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_highlight_between_vertices_is_found() {
        let normal = |x: f64, y: f64| DVec3::new(x, y, 1.0).normalize();
        let around = [normal(1.0, 0.0), normal(-0.5, 0.8), normal(-0.5, -0.8)];
        assert!(around.iter().all(|n| n.z < 0.75), "no vertex has it");
        assert!(may_have_highlight(&around, DVec3::Z, 0.999));
        assert!(!may_have_highlight(&around, -DVec3::Z, 0.0));
        let edge = [normal(1.0, 0.3), normal(-1.0, 0.3), normal(0.0, 2.0)];
        let greatest = greatest_cosine(&edge, DVec3::Z);
        assert!((greatest - normal(0.0, 0.3).z).abs() < 1e-12, "on the edge: {greatest}");
        assert_eq!(greatest_cosine(&[DVec3::Z; 4], DVec3::Y), 0.0);
        assert!(may_have_highlight(&[DVec3::Y; 13], DVec3::Z, 0.9));
    }

    proptest! {
        #[test]
        fn no_interpolated_normal_is_above_the_greatest(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 3..6),
            weights in prop::collection::vec(0.0..1.0f64, 6),
            towards in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let unit = |v: [f64; 3]| DVec3::from(v).normalize_or(DVec3::X);
            let normals: Vec<_> = places.into_iter().map(unit).collect();
            let light = unit(towards);
            let mean: DVec3 = normals.iter().zip(&weights).map(|(&n, &w)| n * w).sum();
            prop_assume!(mean.length() > 1e-3);
            prop_assert!(mean.normalize().dot(light) <= greatest_cosine(&normals, light) + 1e-9);
        }
    }
}
