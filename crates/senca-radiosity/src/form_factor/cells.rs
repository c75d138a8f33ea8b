//! Places spread over a polygon.

use senca_math::glam::DVec3;
use senca_math::newell_normal;

/// A small part of a polygon: its middle, and its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) point: DVec3,
    pub(crate) area: f64,
}

/// A plane convex polygon as about `n` x `n` parts with the polygon's area as their sum: a quadrilateral
/// by even steps along its sides, a triangle by strips, others by the triangles round their middle.
pub(crate) fn cells(corners: &[DVec3], n: usize) -> Vec<Cell> {
    let n = n.max(1);
    match *corners {
        [a, b, c] => triangle_cells([a, b, c], n),
        [a, b, c, d] => quad_cells([a, b, c, d], n),
        _ => fan_cells(corners, n),
    }
}

fn quad_cells([a, b, c, d]: [DVec3; 4], n: usize) -> Vec<Cell> {
    let step = 1.0 / n as f64;
    let at = |u: f64, v: f64| a.lerp(b, u).lerp(d.lerp(c, u), v);
    let cell = |i: usize, j: usize| {
        let (u, v) = (i as f64 * step, j as f64 * step);
        let border = [at(u, v), at(u + step, v), at(u + step, v + step), at(u, v + step)];
        Cell { point: at(u + 0.5 * step, v + 0.5 * step), area: newell_normal(&border).length() }
    };
    (0..n * n).map(|k| cell(k % n, k / n)).collect()
}

/// n strips parallel to the side opposite corner 0, of 1, 3, 5 ... equal triangles.
fn triangle_cells([a, b, c]: [DVec3; 3], n: usize) -> Vec<Cell> {
    let area = newell_normal(&[a, b, c]).length() / (n * n) as f64;
    let (to_b, to_c) = ((b - a) / n as f64, (c - a) / n as f64);
    let strip = |k: usize| {
        (0..=2 * k).map(move |m| {
            // Triangles with their tip up and down take turns.
            let third = if m % 2 == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
            let v = (m / 2) as f64 + third;
            let u = (k - m / 2) as f64 + if m % 2 == 0 { 1.0 / 3.0 } else { -1.0 / 3.0 };
            Cell { point: a + to_b * u + to_c * v, area }
        })
    };
    (0..n).flat_map(strip).collect()
}

fn fan_cells(corners: &[DVec3], n: usize) -> Vec<Cell> {
    let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
    let each = (n as f64 / (corners.len().max(1) as f64).sqrt()).round() as usize;
    let next = |k: usize| corners[(k + 1) % corners.len()];
    (0..corners.len()).flat_map(|k| triangle_cells([middle, corners[k], next(k)], each.max(1))).collect()
}

/// The place at (u, v) of the unit square, so that equal shares of the square are equal shares of a
/// plane convex polygon of 3 or 4 corners.
pub(crate) fn even_place(corners: &[DVec3], u: f64, v: f64) -> DVec3 {
    let on = |a: DVec3, b: DVec3, c: DVec3, u: f64| {
        let s = u.sqrt();
        a * (1.0 - s) + b * (s * (1.0 - v)) + c * (s * v)
    };
    match *corners {
        [a, b, c] => on(a, b, c, u),
        [a, b, c, d] if a + c == b + d => a + (b - a) * u + (d - a) * v,
        [a, b, c, d] => {
            let halves = [[a, b, c], [a, c, d]].map(|t| newell_normal(&t).length());
            let share = halves[0] / (halves[0] + halves[1]);
            if u < share { on(a, b, c, u / share) } else { on(a, c, d, (u - share) / (1.0 - share)) }
        }
        _ => corners.first().copied().unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn parts_have_the_area_and_the_centroid_of_the_whole() {
        let triangle = polygon(&[[0.0, 0.0], [3.0, 0.0], [0.0, 6.0]]);
        let square = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        let hexagon: Vec<_> =
            (0..6).map(|k| f64::from(k).to_radians() * 60.0).map(|a| [a.cos(), a.sin()]).collect();
        let known = [(triangle, 9.0, [1.0, 2.0]), (square, 4.0, [1.0, 1.0])];
        for (corners, area, middle) in known {
            for n in [1, 2, 5] {
                let cells = cells(&corners, n);
                assert_eq!(cells.len(), n * n);
                let sum: f64 = cells.iter().map(|c| c.area).sum();
                let mean = cells.iter().map(|c| c.point * c.area).sum::<DVec3>() / sum;
                assert!((sum - area).abs() < 1e-12 && mean.truncate().distance(middle.into()) < 1e-12);
            }
        }
        let sum: f64 = cells(&polygon(&hexagon), 4).iter().map(|c| c.area).sum();
        assert!((sum - 1.5 * 3.0_f64.sqrt()).abs() < 1e-12);
        assert!(cells(&[], 4).is_empty());
    }

    #[test]
    fn places_are_even() {
        let trapezium = polygon(&[[0.0, 0.0], [4.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        let n = 100;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let places = (0..n * n).map(|k| even_place(&trapezium, at(k % n), at(k / n)));
        // Of the area 6, the part with y > 1 is 2.5.
        let share = places.filter(|p| p.y > 1.0).count() as f64 / (n * n) as f64;
        assert!((share - 2.5 / 6.0).abs() < 0.005, "{share}");
    }
}
