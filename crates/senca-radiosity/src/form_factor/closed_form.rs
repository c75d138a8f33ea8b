//! Pairs whose form factor has a formula of its own, to check others by. All without obstacles; all
//! lengths in any one unit. What is negative or not a number gives 0.
//!
//! The formulas are those of the radiative heat transfer literature; catalogued by Howell, *A Catalog
//! of Radiation Heat Transfer Configuration Factors* (1982 and later), from the sources named at each.

use std::f64::consts::PI;

use super::quadrature::adaptive;

/// Two rectangles of `width` x `height`, opposite each other at `distance`: from either to the other
/// (Hottel 1931; Hamilton and Morgan 1952).
#[must_use]
pub fn parallel_rectangles(width: f64, height: f64, distance: f64) -> f64 {
    let (x, y) = (width / distance, height / distance);
    let (x1, y1) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let logarithm = 0.5 * (x * x * y * y / (1.0 + x * x + y * y)).ln_1p();
    let sum = logarithm + x * y1 * (x / y1).atan() + y * x1 * (y / x1).atan() - x * x.atan() - y * y.atan();
    let (far, all) = (x.max(y), 2.0 * sum / (PI * x * y));
    // Far away the terms cancel: the first terms of the expansion in the distance are more exact.
    let square = x * x + y * y;
    known(if far < 1e-2 { x * y / PI * (1.0 - square / 3.0) } else { all })
}

/// From a rectangle `width` x `height_1` to one `width` x `height_2` that stands on it at a right angle
/// along the edge `width` (Hottel 1931; Hamilton and Morgan 1952).
#[must_use]
pub fn perpendicular_rectangles(width: f64, height_1: f64, height_2: f64) -> f64 {
    let (w, h) = (height_1 / width, height_2 / width);
    let (w2, h2) = (w * w, h * h);
    let diagonal = (w2 + h2).sqrt();
    let angles = w * (1.0 / w).atan() + h * (1.0 / h).atan() - diagonal * (1.0 / diagonal).atan();
    let all = 1.0 + w2 + h2;
    let logarithms = ((1.0 + w2) * (1.0 + h2) / all).ln()
        + w2 * (w2 * all / ((1.0 + w2) * (w2 + h2))).ln()
        + h2 * (h2 * all / ((1.0 + h2) * (w2 + h2))).ln();
    known((angles + 0.25 * logarithms) / (PI * w))
}

/// From a rectangle `width` x `height_1` to one `width` x `height_2` that meets it along the edge `width`
/// at `angle`, in radians in (0, pi), between them (Hamilton and Morgan 1952, corrected by Feingold 1966). One integral
/// is left, which is taken by adaptive quadrature to 13 digits.
#[must_use]
pub fn tilted_rectangles(width: f64, height_1: f64, height_2: f64, angle: f64) -> f64 {
    if !(angle > 0.0 && angle < PI && width > 0.0 && height_1 > 0.0 && height_2 > 0.0) {
        return 0.0;
    }
    let (a, b) = (height_2 / width, height_1 / width);
    let (sin, cos) = angle.sin_cos();
    let (sin2, sin_double, cos_double) = (sin * sin, 2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
    let (a2, b2) = (a * a, b * b);
    let c = a2 + b2 - 2.0 * a * b * cos;
    let d = (1.0 + a2 * sin2).sqrt();

    let wedge = a * b * sin
        + (PI / 2.0 - angle) * (a2 + b2)
        + b2 * ((a - b * cos) / (b * sin)).atan()
        + a2 * ((b - a * cos) / (a * sin)).atan();
    let logarithms = (2.0 / sin2 - 1.0) * ((1.0 + a2) * (1.0 + b2) / (1.0 + c)).ln()
        + b2 * (b2 * (1.0 + c) / (c * (1.0 + b2))).ln()
        + a2 * (a2 * (1.0 + a2).powf(cos_double) / (c * (1.0 + c).powf(cos_double))).ln();
    let angles = b * (1.0 / b).atan() + a * (1.0 / a).atan() - c.sqrt() * (1.0 / c.sqrt()).atan();
    let slanted = 0.5 * sin * sin_double * a * d * ((a * cos / d).atan() + ((b - a * cos) / d).atan());
    let along = |x: f64| {
        let root = (1.0 + x * x * sin2).sqrt();
        root * ((x * cos / root).atan() + ((a - x * cos) / root).atan())
    };
    let integral = cos * adaptive(&along, 0.0, b, 1e-14 * b);
    let sum = -0.25 * sin_double * wedge + 0.25 * sin2 * logarithms + angles + slanted + integral;
    known(sum / (PI * b))
}

/// From a disc of `radius_1` to one of `radius_2`, parallel and on the same axis at `distance`
/// (Hottel 1931).
#[must_use]
pub fn coaxial_discs(radius_1: f64, radius_2: f64, distance: f64) -> f64 {
    let (r1, r2, d) = (radius_1 * radius_1, radius_2 * radius_2, distance * distance);
    let sum = d + r1 + r2;
    known(2.0 * r2 / (sum + (sum * sum - 4.0 * r1 * r2).max(0.0).sqrt()))
}

/// From a point to a disc of `radius` parallel to it at `distance`, whose centre is `offset` beside the
/// normal (Hamilton and Morgan 1952).
#[must_use]
pub fn point_to_parallel_disc(radius: f64, distance: f64, offset: f64) -> f64 {
    let (r, a) = (radius * radius, offset * offset);
    let z = distance * distance + a + r;
    let root = (z * z - 4.0 * a * r).max(0.0).sqrt();
    // 1 - (z - 2r) / root, without the difference of near numbers.
    let rest = z - 2.0 * r;
    let share = if rest > 0.0 {
        2.0 * r * distance * distance / (root * (root + rest))
    } else {
        0.5 * (1.0 - rest / root)
    };
    known(if radius > 0.0 && distance > 0.0 { share } else { 0.0 })
}

/// From a point whose normal is perpendicular to the axis of a disc of `radius`, and points at it: the disc is
/// at `distance` along its axis, and the axis passes `offset` from the point, more than `radius`
/// (Hamilton and Morgan 1952).
#[must_use]
pub fn point_to_perpendicular_disc(radius: f64, distance: f64, offset: f64) -> f64 {
    let (h, r) = (distance / offset, radius / offset);
    if !(h > 0.0 && r > 0.0 && r < 1.0) {
        return 0.0;
    }
    let z = 1.0 + h * h + r * r;
    let root = (z * z - 4.0 * r * r).max(0.0).sqrt();
    known(2.0 * h * r * r / (root * (z + root)))
}

/// From a point outside a sphere of `radius` to it, `distance` to the centre, with `angle` in radians
/// between the normal and the direction to the centre; the horizon may cut the sphere (Cunningham
/// 1961).
#[must_use]
pub fn point_to_sphere(radius: f64, distance: f64, angle: f64) -> f64 {
    let h = distance / radius;
    let half = (1.0 / h).asin();
    let (sin, cos) = angle.sin_cos();
    if !(radius > 0.0 && h >= 1.0 && angle >= 0.0) || angle >= PI / 2.0 + half {
        return 0.0;
    }
    if angle <= PI / 2.0 - half {
        return known(cos / (h * h));
    }
    let far = (h * h - 1.0).sqrt();
    let visible =
        cos * (-far * cos / sin).clamp(-1.0, 1.0).acos() - far * (1.0 - h * h * cos * cos).max(0.0).sqrt();
    known(0.5 - (far / (h * sin)).min(1.0).asin() / PI + visible / (PI * h * h))
}

/// From a sphere to a disc of `radius` on whose axis its centre is, at `distance`, outside the sphere: the
/// share of directions, whatever the size of the sphere (Feingold and Gupta 1970).
#[must_use]
pub fn sphere_to_disc(radius: f64, distance: f64) -> f64 {
    let slope = radius / distance;
    let root = (1.0 + slope * slope).sqrt();
    known(0.5 * slope * slope / (root * (root + 1.0)))
}

/// From a disc of `disc_radius` to a sphere of `sphere_radius` on its axis, `distance` between the
/// centres: [`sphere_to_disc`] by reciprocity.
#[must_use]
pub fn disc_to_sphere(disc_radius: f64, sphere_radius: f64, distance: f64) -> f64 {
    let areas = 4.0 * (sphere_radius / disc_radius).powi(2);
    known(if distance >= sphere_radius { areas * sphere_to_disc(disc_radius, distance) } else { 0.0 })
}

/// From a sphere of `radius_1` to one of `radius_2`, `distance` between the centres, which is no less than
/// both radii: the mean of [`point_to_sphere`] over the first sphere, one integral that is taken by
/// adaptive quadrature to 12 digits, apart where the horizon cuts the second sphere and where it does not
/// (Feingold and Gupta 1970).
#[must_use]
pub fn sphere_to_sphere(radius_1: f64, radius_2: f64, distance: f64) -> f64 {
    let (r1, r2, d) = (radius_1, radius_2, distance);
    if !(r1 > 0.0 && r2 > 0.0 && d.is_finite() && d >= (r1 + r2) * (1.0 - 1e-15)) {
        return 0.0;
    }
    // By the cosine between the axis and the radius to the point.
    let (whole, cut) = (((r1 + r2) / d).min(1.0), (r1 - r2) / d);
    let at = |c: f64| {
        let way = (r1 * r1 + d * d - 2.0 * r1 * d * c).max(r2 * r2).sqrt();
        point_to_sphere(r2, way, ((d * c - r1) / way).clamp(-1.0, 1.0).acos())
    };
    let part = |a: f64, b: f64| if b > a { adaptive(&at, a, b, 1e-13 * (b - a)) } else { 0.0 };
    known(0.5 * (part(cut, whole) + part(whole, 1.0)))
}

/// Inside a cube, from a face to the one opposite: 0.1998.
#[must_use]
pub fn cube_opposite() -> f64 {
    parallel_rectangles(1.0, 1.0, 1.0)
}

/// Inside a cube, from a face to each of the four beside it: 0.2000. `cube_opposite() + 4 cube_adjacent()`
/// is 1.
#[must_use]
pub fn cube_adjacent() -> f64 {
    perpendicular_rectangles(1.0, 1.0, 1.0)
}

/// A form factor, or 0 for what is none.
fn known(factor: f64) -> f64 {
    if factor > 0.0 { factor.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::{point_to_polygon, polygon_to_polygon};
    use senca_math::glam::DVec3;

    fn rectangle(u: DVec3, v: DVec3) -> [DVec3; 4] {
        [DVec3::ZERO, u, u + v, v]
    }

    fn agree(a: f64, b: f64, digits: f64) {
        assert!((a / b - 1.0).abs() < digits, "{a} {b}");
    }

    #[test]
    fn the_faces_of_a_cube_have_their_known_factors() {
        assert!((cube_opposite() - 0.199_824_895_7).abs() < 5e-11);
        assert!((cube_adjacent() - 0.200_043_776_1).abs() < 5e-11);
        assert!((cube_opposite() + 4.0 * cube_adjacent() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn rectangles_agree_with_the_polygons() {
        for (w, h, d) in [
            (1.0, 1.0, 1.0),
            (3.0, 0.2, 0.5),
            (0.01, 2.0, 1.0),
            (50.0, 40.0, 1.0),
            (1.0, 2.0, 30.0),
            (1.0, 1.0, 1e4),
        ] {
            let low = rectangle(DVec3::X * w, DVec3::Y * h);
            let high = rectangle(DVec3::Y * h, DVec3::X * w).map(|p| p + DVec3::Z * d);
            agree(polygon_to_polygon(&low, &high), parallel_rectangles(w, h, d), 1e-8);
        }
        for (w, h1, h2) in
            [(1.0, 1.0, 1.0), (3.0, 0.2, 0.5), (0.1, 2.0, 1.0), (20.0, 1.0, 1.0), (1.0, 5.0, 0.01)]
        {
            let floor = rectangle(DVec3::X * w, DVec3::Y * h1);
            let wall = rectangle(DVec3::Z * h2, DVec3::X * w);
            agree(polygon_to_polygon(&floor, &wall), perpendicular_rectangles(w, h1, h2), 1e-8);
        }
    }

    #[test]
    fn tilted_rectangles_agree_with_the_polygons_at_any_angle() {
        for degrees in [1.0_f64, 20.0, 45.0, 60.0, 90.0, 120.0, 150.0, 175.0] {
            for (w, h1, h2) in [(1.0, 1.0, 1.0), (2.0, 0.5, 3.0), (0.5, 2.0, 1.0)] {
                let angle = degrees.to_radians();
                let first = rectangle(DVec3::X * w, DVec3::Y * h1);
                let up = DVec3::new(0.0, angle.cos(), angle.sin());
                let second = rectangle(up * h2, DVec3::X * w);
                agree(polygon_to_polygon(&first, &second), tilted_rectangles(w, h1, h2, angle), 1e-7);
            }
        }
        agree(tilted_rectangles(1.0, 2.0, 3.0, PI / 2.0), perpendicular_rectangles(1.0, 2.0, 3.0), 1e-12);
    }

    fn disc(radius: f64, axes: [DVec3; 2], center: DVec3) -> Vec<DVec3> {
        let n = 720;
        let at = |k: i32| (f64::from(k) * 2.0 * PI / f64::from(n)).sin_cos();
        (0..n).map(at).map(|(sin, cos)| center + (axes[0] * cos + axes[1] * sin) * radius).collect()
    }

    #[test]
    fn discs_agree_with_many_corners() {
        assert_eq!(coaxial_discs(1.0, 1.0, 0.0), 1.0);
        agree(point_to_parallel_disc(1.0, 1.0, 0.0), 0.5, 1e-14);
        agree(point_to_parallel_disc(1.0, 2.0, 0.0), 0.2, 1e-14);
        agree(coaxial_discs(1e-6, 1.0, 2.0), 0.2, 1e-10);
        for (radius, distance, offset) in [(1.0, 1.0, 0.5), (0.5, 0.2, 2.0), (2.0, 0.1, 0.3), (0.1, 5.0, 1.0)]
        {
            let facing = disc(radius, [DVec3::Y, DVec3::X], DVec3::new(offset, 0.0, distance));
            let seen = point_to_polygon(DVec3::ZERO, DVec3::Z, &facing);
            agree(seen, point_to_parallel_disc(radius, distance, offset), 1e-4);
        }
        for (radius, distance, offset) in [(0.5, 1.0, 1.0), (0.9, 0.3, 1.0), (0.1, 3.0, 2.0)] {
            let facing = disc(radius, [DVec3::Y, DVec3::X], DVec3::new(offset, 0.0, distance));
            let seen = point_to_polygon(DVec3::ZERO, DVec3::X, &facing);
            agree(seen, point_to_perpendicular_disc(radius, distance, offset), 1e-4);
        }
    }

    /// The share of directions under which a sphere is seen.
    fn sphere_by_counting(radius: f64, distance: f64, angle: f64) -> f64 {
        let center = DVec3::new(angle.sin(), 0.0, angle.cos()) * distance;
        let directions: Vec<_> = crate::form_factor::nusselt_directions(DVec3::Z, 400).collect();
        let meets = |d: &&DVec3| d.dot(center) > 0.0 && d.cross(center).length() < radius;
        directions.iter().filter(meets).count() as f64 / directions.len() as f64
    }

    #[test]
    fn spheres_agree_with_counting() {
        for (radius, distance, degrees) in [
            (1.0, 2.0, 0.0),
            (1.0, 2.0, 50.0),
            (1.0, 2.0, 75.0),
            (1.0, 2.0, 100.0),
            (1.0, 1.2, 80.0),
            (0.3, 1.0, 90.0),
        ] {
            let angle = f64::to_radians(degrees);
            let (closed, counted) =
                (point_to_sphere(radius, distance, angle), sphere_by_counting(radius, distance, angle));
            assert!((closed - counted).abs() < 1e-3, "{degrees}: {closed} {counted}");
        }
        assert_eq!(point_to_sphere(1.0, 2.0, 3.0), 0.0);
        agree(point_to_sphere(1.0, 2.0, PI / 3.0 - 1e-9), point_to_sphere(1.0, 2.0, PI / 3.0 + 1e-9), 1e-7);
        // A disc seen from a sphere of any size, and back: small discs see as points do.
        agree(disc_to_sphere(1e-5, 1.0, 2.0), point_to_sphere(1.0, 2.0, 0.0), 1e-9);
        agree(sphere_to_disc(1.0, 1.0), 0.5 * (1.0 - 0.5_f64.sqrt()), 1e-14);
    }

    #[test]
    fn spheres_see_each_other_as_their_points_do() {
        // A small sphere sees the share of all directions; both ways have the same exchange.
        for (r1, r2, d) in [(1e-5_f64, 1.0_f64, 2.0_f64), (1e-6, 0.3, 0.31)] {
            let share = 0.5 * (1.0 - (1.0 - (r2 / d).powi(2)).sqrt());
            agree(sphere_to_sphere(r1, r2, d), share, 1e-4);
        }
        for (r1, r2, d) in
            [(1.0, 1.0, 2.0), (1.0, 1.0, 2.5), (0.3, 1.0, 4.0), (2.0, 0.1, 2.2), (1.0, 0.5, 50.0)]
        {
            let [there, back] = [sphere_to_sphere(r1, r2, d), sphere_to_sphere(r2, r1, d)];
            agree(r1 * r1 * there, r2 * r2 * back, 1e-9);
            // The mean over rings of equal area.
            let n = 20_000;
            let ring = |i: i32| {
                let c = (2.0 * f64::from(i) + 1.0) / f64::from(n) - 1.0;
                let way = (r1 * r1 + d * d - 2.0 * r1 * d * c).sqrt();
                point_to_sphere(r2, way, ((d * c - r1) / way).acos())
            };
            let mean = (0..n).map(ring).sum::<f64>() / f64::from(n);
            agree(there, mean, 1e-4);
        }
        assert_eq!(sphere_to_sphere(1.0, 1.0, 1.9), 0.0, "one in the other");
        assert_eq!(sphere_to_sphere(f64::NAN, 1.0, 3.0), 0.0);
    }

    #[test]
    fn what_makes_no_sense_has_no_factor() {
        for bad in [f64::NAN, -1.0, 0.0] {
            assert_eq!(perpendicular_rectangles(1.0, bad, 1.0), 0.0);
            assert_eq!(tilted_rectangles(1.0, 1.0, bad, 1.0), 0.0);
            assert_eq!(point_to_sphere(1.0, bad, 0.1), 0.0);
            assert_eq!(point_to_parallel_disc(bad, 1.0, 0.1), 0.0);
        }
        assert_eq!(parallel_rectangles(1.0, 1.0, f64::NAN), 0.0);
        assert_eq!(parallel_rectangles(f64::NAN, 1.0, 1.0), 0.0);
    }
}
