//! Edges to one point for each row, in a left and a right set (section 1).

use super::{ScreenVertex, Slips};

/// Rows that a polygon may span; more are cut off, far outside of any picture.
const MAX_ROWS: i64 = 1 << 20;

/// Interpolates by the ratio of distances: `(1 - u) start + u end` cut off to a whole number, u being
/// the distance of `at` from `a` over that of `b` from `a`. Where `a` and `b` are one place there is no
/// ratio: it gives `start`, or with the slip of single pixels what 0/0 was to the text's language, 0.
/// Source: section 3.
#[must_use]
pub fn gouraud(a: [i32; 2], b: [i32; 2], at: [i32; 2], start: i32, end: i32, slips: &Slips) -> i32 {
    let distance = |p: [i32; 2]| {
        let part = |i: usize| f64::from(a[i]) - f64::from(p[i]);
        (part(0) * part(0) + part(1) * part(1)).sqrt()
    };
    let whole = distance(b);
    if whole == 0.0 && !slips.single_pixels && !slips.same_end_twice {
        return start;
    }
    let u = distance(at) / whole;
    let value = (1.0 - u) * f64::from(start) + u * f64::from(end);
    // Conversion cuts off towards 0, saturates, and makes 0 of what is not a number.
    if slips.lost_units { value as i32 } else { (value + value.signum() * 1e-7) as i32 }
}

/// The left and the right point of each row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EdgeSets {
    first_row: i32,
    left: Vec<Option<ScreenVertex>>,
    right: Vec<Option<ScreenVertex>>,
}

/// The points of one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeRow {
    /// The row.
    pub y: i32,
    /// Left point.
    pub left: ScreenVertex,
    /// Right point.
    pub right: ScreenVertex,
}

impl EdgeSets {
    /// The sets of a polygon, over the rows from its highest to its lowest vertex.
    #[must_use]
    pub fn of(polygon: &[ScreenVertex], slips: &Slips) -> Self {
        let rows = polygon.iter().map(|vertex| vertex.y);
        let (Some(first), Some(last)) = (rows.clone().min(), rows.max()) else { return Self::default() };
        let count = (i64::from(last) - i64::from(first) + 1).clamp(1, MAX_ROWS) as usize;
        let mut sets = Self { first_row: first, left: vec![None; count], right: vec![None; count] };
        for (i, &start) in polygon.iter().enumerate() {
            sets.enter(start, polygon[(i + 1) % polygon.len()], slips);
        }
        sets
    }

    /// Rows that have a point in both sets, from above.
    pub fn rows(&self) -> impl Iterator<Item = EdgeRow> + '_ {
        let both = self.left.iter().zip(&self.right).zip(self.first_row..);
        both.filter_map(|((left, right), y)| Some(EdgeRow { y, left: (*left)?, right: (*right)? }))
    }

    /// Walks an edge and enters its points: into the left set if it does not run downwards.
    fn enter(&mut self, start: ScreenVertex, end: ScreenVertex, slips: &Slips) {
        if start.y == end.y && !slips.horizontal_edges {
            return;
        }
        let along = |x: i32, y: i32, from: i32, to: i32| {
            gouraud([start.x, start.y], [end.x, end.y], [x, y], from, to, slips)
        };
        let left = end.y <= start.y;
        for (x, y) in walk(start, end, slips.extra_pass) {
            let Ok(row) = usize::try_from(i64::from(y) - i64::from(self.first_row)) else { continue };
            let set = if left { &mut self.left } else { &mut self.right };
            let Some(place) = set.get_mut(row) else { continue };
            let outer = place.is_none_or(|old| if left { x < old.x } else { x > old.x });
            if outer || slips.last_edge_wins {
                let (z, b) = (along(x, y, start.z, end.z), along(x, y, start.b, end.b));
                *place = Some(ScreenVertex::new(x, y, z, b));
            }
        }
    }
}

/// The points of an edge alone, as `x y z b`.
#[cfg(test)]
pub(super) fn points_of_edge(start: ScreenVertex, end: ScreenVertex, slips: &Slips) -> Vec<[i32; 4]> {
    let along = |x: i32, y: i32, from: i32, to: i32| {
        gouraud([start.x, start.y], [end.x, end.y], [x, y], from, to, slips)
    };
    let point = |(x, y): (i32, i32)| [x, y, along(x, y, start.z, end.z), along(x, y, start.b, end.b)];
    walk(start, end, slips.extra_pass).into_iter().map(point).collect()
}

/// The first pixel of an edge on each of its rows, in the direction of the edge; an edge of more rows
/// than columns has one per row anyway. At most [`MAX_ROWS`] rows.
fn walk(start: ScreenVertex, end: ScreenVertex, extra_pass: bool) -> Vec<(i32, i32)> {
    let apart = |a: i32, b: i32| i64::from(a.abs_diff(b)) + 1;
    let (columns, rows) = (apart(start.x, end.x), apart(start.y, end.y));
    let step_x = if start.x < end.x { 1 } else { -1 };
    let step_y = if start.y < end.y { 1 } else { -1 };
    let shallow = columns > rows;
    let passes = rows.min(MAX_ROWS) + i64::from(shallow && extra_pass);
    let (mut x, mut y) = (i64::from(start.x), i64::from(start.y));
    let mut error = if shallow { -rows } else { 0 };
    let mut points = Vec::with_capacity(passes as usize);
    for _ in 0..passes {
        points.push((x.clamp(i32::MIN.into(), i32::MAX.into()) as i32, y as i32));
        if shallow {
            x += step_x * (columns / rows);
            error += 2 * (columns % rows);
            if error >= 0 {
                x += step_x;
                error -= 2 * rows;
            }
        } else {
            error += columns;
            if error >= rows {
                error -= rows;
                x += step_x;
            }
        }
        y += step_y;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32) -> ScreenVertex {
        ScreenVertex::new(x, y, 0, 0)
    }

    #[test]
    fn edges_have_their_closed_form() {
        for dx in -25..=25i32 {
            for dy in -25..=25i32 {
                let (x0, y0) = (i64::from(dx.abs()) + 1, i64::from(dy.abs()) + 1);
                let sign = if dx > 0 { 1 } else { -1 };
                for (i, (x, y)) in (0i64..).zip(walk(point(0, 0), point(dx, dy), false)) {
                    let expected = if x0 > y0 {
                        i * (x0 / y0) + (2 * i * (x0 % y0) + y0).div_euclid(2 * y0)
                    } else {
                        (i * x0).div_euclid(y0)
                    };
                    assert_eq!(i64::from(x), sign * expected, "({dx}, {dy}) row {i}");
                    assert_eq!(i64::from(y.abs()), i);
                }
            }
        }
    }

    #[test]
    fn a_shallow_edge_does_not_reach_its_end() {
        let walked = walk(point(0, 0), point(9, 2), false);
        assert_eq!(walked.last(), Some(&(7, 2)));
    }

    #[test]
    fn units_are_lost_to_rounding_unless_mended() {
        let (printed, mended) = (Slips::EDGES_AS_PRINTED, Slips::MENDED);
        let diagonal = |slips| gouraud([0, 0], [4, 4], [3, 3], 0, 100, slips);
        assert_eq!((diagonal(&printed), diagonal(&mended)), (74, 75));
        let lost = |slips: &Slips| {
            let constant = |length: i32, x: i32| gouraud([0, 0], [length, 0], [x, 0], 100, 100, slips);
            let cases = (1..=99).flat_map(|length| (0..=length).map(move |x| (length, x)));
            cases.filter(|&(length, x)| constant(length, x) == 99).collect::<Vec<_>>()
        };
        let cases = lost(&printed);
        assert_eq!((cases.len(), cases[0]), (118, (12, 1)));
        assert!(lost(&mended).is_empty());
        assert_eq!((1..=99).map(|length| length + 1).sum::<i32>(), 5049);
    }

    #[test]
    fn whole_parts_are_cut_off_towards_zero_and_no_number_is_zero() {
        assert_eq!(gouraud([0, 0], [3, 0], [1, 0], -5, -1, &Slips::EDGES_AS_PRINTED), -3);
        assert_eq!(gouraud([0, 0], [3, 0], [1, 0], -5, -1, &Slips::MENDED), -3);
        for at in [[2, 2], [5, 2]] {
            assert_eq!(gouraud([2, 2], [2, 2], at, 7, 9, &Slips::AS_PRINTED), 0);
            assert_eq!(gouraud([2, 2], [2, 2], at, 7, 9, &Slips::MENDED), 7);
        }
    }

    #[test]
    fn enormous_edges_stay_within_bounds() {
        let far = [point(i32::MIN, i32::MIN), point(i32::MAX, i32::MAX), point(0, 5)];
        assert!(EdgeSets::of(&far, &Slips::MENDED).left.len() <= MAX_ROWS as usize);
        assert_eq!(EdgeSets::of(&[], &Slips::MENDED), EdgeSets::default());
    }
}
