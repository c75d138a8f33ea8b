//! The double area integral as a plain sum.

use senca_math::glam::DVec3;
use senca_math::newell_normal;

use super::cells::cells;
use super::{Visibility, differential};

/// Form factor of two plane convex polygons by equation 4.9 of the course text as it stands: both are
/// cut in `n` x `n` small parts (see below), 1 or more, and the mean over the parts of one of the sum over
/// the parts of the other of equation 4.7 is taken, a line of sight for each pair.
///
/// The midpoint rule: its error falls by four when `n` doubles while polygons are apart, and slower
/// where they touch; it needs `n^4` rays. A triangle gets `n^2` parts too; a polygon of more than four corners is
/// cut in triangles first.
#[must_use]
pub fn double_area(from: &[DVec3], to: &[DVec3], n: usize, visibility: &(impl Visibility + ?Sized)) -> f64 {
    let normals = [from, to].map(|c| newell_normal(c).normalize_or_zero());
    let (parts_from, parts_to) = (cells(from, n), cells(to, n));
    let (mut sum, mut area) = (0.0, 0.0);
    for i in &parts_from {
        area += i.area;
        for j in &parts_to {
            let factor = differential(i.point, normals[0], j.point, normals[1], j.area);
            if factor > 0.0 && visibility.visible(i.point, j.point) {
                sum += i.area * factor;
            }
        }
    }
    if sum > 0.0 { sum / area } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::Unoccluded;

    #[test]
    fn squares_at_distance_one_have_the_sums_of_the_midpoint_rule() {
        let low = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let mut high = low.map(|p| p + DVec3::Z);
        high.reverse();
        let known =
            [(1, std::f64::consts::FRAC_1_PI), (2, 0.21680), (4, 0.20369), (8, 0.20077), (16, 0.20006)];
        for (n, expected) in known {
            let sum = double_area(&low, &high, n, &Unoccluded);
            assert!((sum - expected).abs() < 5e-6, "{n}: {sum}");
        }
        assert_eq!(double_area(&low, &high, 2, &|_: DVec3, _: DVec3| false), 0.0);
        assert_eq!(double_area(&low, &[DVec3::Z; 3], 2, &Unoccluded), 0.0);
        assert_eq!(double_area(&[], &low, 0, &Unoccluded), 0.0);
        let half = double_area(&low, &high, 8, &|_: DVec3, to: DVec3| to.x < 0.5);
        assert!((half - 0.20077 / 2.0).abs() < 5e-6, "{half}");
    }
}
