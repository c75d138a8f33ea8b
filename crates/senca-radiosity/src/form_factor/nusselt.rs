//! Nusselt's analogy (course text, section 4.2): what a point sees of a polygon, projected on the
//! hemisphere over the point and then straight down, is the form factor as a share of the disc.

use std::f64::consts::PI;

use senca_math::glam::{DVec2, DVec3};
use senca_math::newell_normal;
use senca_math::polygon::{flattened, winding_number};

use super::clip::part_above;

/// The outline of `corners` after both projections, on the unit disc round `point` with the frame
/// `axes` (two unit tangents and the normal): each edge, which becomes the arc of an ellipse, by
/// `steps` chords. To be drawn, or measured.
#[must_use]
pub fn nusselt_outline(point: DVec3, axes: [DVec3; 3], corners: &[DVec3], steps: usize) -> Vec<DVec2> {
    let seen = part_above(corners, 0.0, |p| axes[2].dot(p - point));
    let direction = |p: DVec3| (p - point).normalize_or_zero();
    let steps = steps.max(1);
    let chord = |k: usize| {
        let (a, b) = (direction(seen[k]), direction(seen[(k + 1) % seen.len()]));
        (0..steps).map(move |m| {
            let on_hemisphere = along_arc(a, b, m as f64 / steps as f64);
            DVec2::new(on_hemisphere.dot(axes[0]), on_hemisphere.dot(axes[1]))
        })
    };
    (0..seen.len()).flat_map(chord).collect()
}

/// The direction at `share` of the way from `a` to `b` along the great circle, by equal angles.
fn along_arc(a: DVec3, b: DVec3, share: f64) -> DVec3 {
    let angle = a.cross(b).length().atan2(a.dot(b));
    let beside = (b - a * a.dot(b)).normalize_or_zero();
    let (sin, cos) = (angle * share).sin_cos();
    a * cos + beside * sin
}

/// Form factor from a point with unit `normal` to a plane polygon as the area of
/// [`nusselt_outline`] over that of the disc. The chords leave out a share that falls with the square
/// of `steps`; conventions as in [`super::point_to_polygon`].
#[must_use]
pub fn nusselt_area(point: DVec3, normal: DVec3, corners: &[DVec3], steps: usize) -> f64 {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let outline = nusselt_outline(point, [tangent, bitangent, normal], corners, steps);
    let next = outline.iter().cycle().skip(1);
    // Seen from the point a front runs clockwise.
    let area = -0.5 * outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>();
    if area > 0.0 { (area / PI).min(1.0) } else { 0.0 }
}

/// Directions at the middles of the cells of an `n` x `n` grid on the square round the unit disc,
/// those inside the disc lifted to the hemisphere over `normal`: each stands for an equal share of what
/// a patch radiates.
pub fn nusselt_directions(normal: DVec3, n: usize) -> impl Iterator<Item = DVec3> {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let at = move |k: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
    (0..n * n).filter_map(move |k| {
        let (x, y) = (at(k % n), at(k / n));
        let rest = 1.0 - x * x - y * y;
        (rest > 0.0).then(|| tangent * x + bitangent * y + normal * rest.sqrt())
    })
}

/// Form factor from a point with unit `normal` to a plane polygon as the share of
/// [`nusselt_directions`] in which the polygon's front is seen.
#[must_use]
pub fn nusselt_count(point: DVec3, normal: DVec3, corners: &[DVec3], n: usize) -> f64 {
    let polygon_normal = newell_normal(corners);
    let to: Vec<DVec3> = corners.iter().map(|&p| p - point).collect();
    let height = to.first().map_or(0.0, |p| polygon_normal.dot(*p));
    // A point that is not before the front sees nothing of it.
    if height.is_nan() || height >= 0.0 {
        return 0.0;
    }
    let outline = flattened(&to, polygon_normal);
    let (mut all, mut seen) = (0_u64, 0_u64);
    for direction in nusselt_directions(normal, n) {
        all += 1;
        let towards = polygon_normal.dot(direction);
        if towards < 0.0 {
            let place = flattened(&[direction * (height / towards)], polygon_normal);
            seen += u64::from(winding_number(&outline, place[0]) > 0);
        }
    }
    if all > 0 { seen as f64 / all as f64 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;

    fn ceiling() -> [DVec3; 4] {
        [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]].map(|[x, y]| DVec3::new(x, y, 1.0))
    }

    fn disc(radius: f64, height: f64) -> Vec<DVec3> {
        let at = |k: i32| -f64::from(k) * PI / 180.0;
        (0..360).map(|k| DVec3::new(radius * at(k).cos(), radius * at(k).sin(), height)).collect()
    }

    #[test]
    fn the_projected_square_has_the_area_of_its_factor() {
        let area = nusselt_area(DVec3::ZERO, DVec3::Z, &ceiling(), 1000);
        assert!((area - 0.239_456_470_5).abs() < 1e-7, "{area}");
        let count = nusselt_count(DVec3::ZERO, DVec3::Z, &ceiling(), 1000);
        assert!((count - 0.239_456_470_5).abs() < 1e-4, "{count}");
    }

    #[test]
    fn discs_have_their_known_factors() {
        for (radius, height, expected) in [(1.0, 1.0, 0.5), (1.0, 2.0, 0.2)] {
            let area = nusselt_area(DVec3::ZERO, DVec3::Z, &disc(radius, height), 4);
            assert!((area - expected).abs() < 1e-4, "{area}");
            let count = nusselt_count(DVec3::ZERO, DVec3::Z, &disc(radius, height), 500);
            assert!((count - expected).abs() < 1e-3, "{count}");
        }
    }

    #[test]
    fn any_view_agrees_with_lambert() {
        for k in 0..20 {
            let k = f64::from(k);
            let point = DVec3::new((k * 1.3).sin(), (k * 0.7).cos(), 0.3 * (k * 2.1).sin());
            let normal = DVec3::new((k * 0.9).cos(), (k * 1.7).sin(), 0.5).normalize();
            let exact = point_to_polygon(point, normal, &ceiling());
            assert!((nusselt_area(point, normal, &ceiling(), 500) - exact).abs() < 1e-5);
            assert!((nusselt_count(point, normal, &ceiling(), 300) - exact).abs() < 2e-3);
        }
    }

    #[test]
    fn nothing_is_seen_of_backs_and_of_nothing() {
        let mut back = ceiling();
        back.reverse();
        assert_eq!(nusselt_area(DVec3::ZERO, DVec3::Z, &back, 10), 0.0);
        assert_eq!(nusselt_count(DVec3::ZERO, DVec3::Z, &back, 10), 0.0);
        assert_eq!(nusselt_area(DVec3::ZERO, DVec3::Z, &[], 10), 0.0);
        assert_eq!(nusselt_count(DVec3::ZERO, DVec3::Z, &[], 0), 0.0);
        assert_eq!(nusselt_area(DVec3::NAN, DVec3::Z, &ceiling(), 10), 0.0);
    }
}
