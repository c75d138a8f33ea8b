//! Cutting a polygon with a plane.

use senca_math::glam::DVec3;
use smallvec::SmallVec;

/// Corners of a polygon on the stack, unless they are many.
pub(crate) type Corners = SmallVec<[DVec3; 8]>;

/// The part of a polygon where `height` is positive, after Sutherland and Hodgman 1974; nothing where
/// no corner is higher than `tolerance`. Heights of at most `tolerance` count as 0. `height` has to be
/// an affine function.
///
/// Several parts of a concave polygon come out joined by edges on the plane that run to and fro: what
/// is summed along the border does not notice.
pub(crate) fn part_above(corners: &[DVec3], tolerance: f64, height: impl Fn(DVec3) -> f64) -> Corners {
    let snapped = |p: DVec3| {
        let h = height(p);
        if h.abs() <= tolerance { 0.0 } else { h }
    };
    let heights: SmallVec<[f64; 8]> = corners.iter().map(|&p| snapped(p)).collect();
    if !heights.iter().any(|&h| h > 0.0) {
        return Corners::new();
    }
    if !heights.iter().any(|&h| h < 0.0) {
        return Corners::from_slice(corners);
    }
    let mut part = Corners::new();
    for k in 0..corners.len() {
        let next = (k + 1) % corners.len();
        let (a, b) = (heights[k], heights[next]);
        if a >= 0.0 {
            part.push(corners[k]);
        }
        if a * b < 0.0 {
            // From the higher to the lower end, so that neighbours that share the edge get the same point.
            let (high, low, share) = if a > 0.0 { (k, next, a / (a - b)) } else { (next, k, b / (b - a)) };
            part.push(corners[high] + (corners[low] - corners[high]) * share);
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::newell_normal;

    const SQUARE: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];

    fn area(corners: &[DVec3]) -> f64 {
        newell_normal(corners).length()
    }

    #[test]
    fn a_square_is_cut_in_parts() {
        assert!((area(&part_above(&SQUARE, 0.0, |p| p.x - 0.25)) - 0.75).abs() < 1e-15);
        assert!((area(&part_above(&SQUARE, 0.0, |p| p.x + p.y - 1.5)) - 0.125).abs() < 1e-15);
        assert_eq!(part_above(&SQUARE, 0.0, |p| p.x + 1.0).as_slice(), SQUARE);
        assert!(part_above(&SQUARE, 0.0, |p| p.x - 1.0).is_empty());
        assert!(part_above(&SQUARE, 1e-9, |p| p.z + 1e-10).is_empty());
        assert!(part_above(&SQUARE, 0.0, |_| f64::NAN).is_empty());
    }

    #[test]
    fn a_concave_polygon_keeps_its_area_in_both_parts() {
        let w = [[0.0, 0.0], [1.0, 2.0], [2.0, 0.5], [3.0, 2.0], [4.0, 0.0], [2.0, -1.0]];
        let w = w.map(|[x, y]| DVec3::new(x, y, 0.0));
        let (above, below) = (part_above(&w, 0.0, |p| p.y - 1.0), part_above(&w, 0.0, |p| 1.0 - p.y));
        assert!((area(&above) + area(&below) - area(&w)).abs() < 1e-14);
        assert!(area(&above) > 0.5);
    }
}
