//! What a point sees of a polygon: Lambert's formula.

use std::f64::consts::TAU;

use senca_math::glam::DVec3;

use super::clip::part_above;

/// Form factor F_di->j of a small patch at `point` with unit `normal` to a plane polygon, in [0, 1],
/// without obstacles: equation 4.8 of the course text in closed form (Lambert 1760). The polygon may
/// be concave and may reach below the horizon of the point; the part below does not count.
///
/// Only the front of the polygon receives, which is where its corners run counter-clockwise: 0 for a
/// point behind it or in its plane. What the back receives is the result for reversed corners. 0 for
/// polygons without area and for anything that is not a number.
#[must_use]
pub fn point_to_polygon(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let seen = part_above(corners, 0.0, |p| normal.dot(p - point));
    let share = signed_share(point, normal, &seen);
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}

/// Lambert's formula for a polygon wholly above the horizon, negative for one that shows its back:
/// the sum over the edges of the angle they subtend, times the cosine between the normal of the point
/// and that of the triangle they span with the point.
pub(crate) fn signed_share(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    normal.dot(flux_vector(point, corners))
}

/// The vector whose product with a normal is the form factor.
pub(crate) fn flux_vector(point: DVec3, corners: &[DVec3]) -> DVec3 {
    let Some(&last) = corners.last() else { return DVec3::ZERO };
    let mut sum = DVec3::ZERO;
    let mut from = last - point;
    let mut start = last;
    for &end in corners {
        let to = end - point;
        // The edge itself, not the difference of two directions, keeps digits when it is far away.
        let across = (end - start).cross(from);
        let sine = across.length();
        if sine > 0.0 {
            sum += across * (sine.atan2(from.dot(to)) / sine);
        }
        (from, start) = (to, end);
    }
    sum / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A unit square above the origin at distance 1, facing down.
    fn ceiling() -> [DVec3; 4] {
        [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]].map(|[x, y]| DVec3::new(x, y, 1.0))
    }

    #[test]
    fn a_square_above_has_the_known_factor() {
        assert!((point_to_polygon(DVec3::ZERO, DVec3::Z, &ceiling()) - 0.239_456_470_5).abs() < 1e-10);
    }

    #[test]
    fn backs_and_what_is_behind_count_nothing() {
        let mut back = ceiling();
        back.reverse();
        assert_eq!(point_to_polygon(DVec3::ZERO, DVec3::Z, &back), 0.0);
        assert_eq!(point_to_polygon(DVec3::ZERO, DVec3::NEG_Z, &ceiling()), 0.0);
        assert_eq!(point_to_polygon(DVec3::Z, DVec3::Z, &ceiling()), 0.0);
    }

    #[test]
    fn the_part_below_the_horizon_is_cut_off() {
        // A wall at x = 1 from z = -1 to 1 against the same wall from 0 to 1.
        let wall =
            |low: f64| [[-1.0, low], [-1.0, 1.0], [1.0, 1.0], [1.0, low]].map(|[y, z]| DVec3::new(1.0, y, z));
        let (whole, upper) = (wall(-1.0), wall(0.0));
        let of = |corners: &[DVec3]| point_to_polygon(DVec3::ZERO, DVec3::Z, corners);
        assert!((of(&whole) - of(&upper)).abs() < 1e-15);
        // A side of the half cube: its exact share.
        assert!((of(&upper) - 0.111_468_394_0).abs() < 1e-10);
    }

    #[test]
    fn the_top_of_the_half_cube_has_its_share() {
        let top = ceiling().map(|p| DVec3::new(2.0 * p.x, 2.0 * p.y, 1.0));
        assert!((point_to_polygon(DVec3::ZERO, DVec3::Z, &top) - 0.554_126_424_0).abs() < 1e-10);
    }

    #[test]
    fn what_is_no_polygon_counts_nothing() {
        let of = |corners: &[DVec3]| point_to_polygon(DVec3::ZERO, DVec3::Z, corners);
        assert_eq!(of(&[]), 0.0);
        assert_eq!(of(&[DVec3::Z]), 0.0);
        assert_eq!(of(&[DVec3::Z; 4]), 0.0);
        assert_eq!(of(&[DVec3::NAN; 4]), 0.0);
        assert_eq!(point_to_polygon(DVec3::NAN, DVec3::Z, &ceiling()), 0.0);
    }

    proptest! {
        #[test]
        fn parts_of_a_polygon_add_up(u in 0.0..1.0_f64, v in 0.0..1.0_f64, x in -3.0..3.0_f64, y in -3.0..3.0_f64) {
            let [a, b, c, d] = ceiling();
            let middle = a.lerp(b, u).lerp(d.lerp(c, u), v);
            let of = |corners: &[DVec3]| point_to_polygon(DVec3::new(x, y, 0.0), DVec3::new(0.6, 0.0, 0.8), corners);
            let parts = of(&[a, b, middle]) + of(&[b, c, middle]) + of(&[c, d, middle]) + of(&[d, a, middle]);
            prop_assert!((parts - of(&[a, b, c, d])).abs() < 1e-14);
        }
    }
}
