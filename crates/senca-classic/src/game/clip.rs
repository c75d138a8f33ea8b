//! Clipping lines and polygons in any number of dimensions, by halving.
//!
//! A line is cut where one coordinate reaches an edge. The midpoint of the line is calculated, in all dimensions, by
//! additions and shifts alone; the half that still crosses the edge is halved again, until the midpoint lies on the edge.
//! All that a vertex carries, its intensity or its place in a texture, is found on the way.
//!
//! As printed, the search works in whole numbers and stops at the first midpoint whose coordinate is that of the edge,
//! which on a steep line may be far from where the line crosses; and a vertex that lies on the lower edge already is
//! searched for again. [`Search::AsPrinted`] does exactly that, [`Search::Precise`] halves with 30 fraction bits and
//! leaves alone what lies on the edge. [`Search::SimilarTriangles`] is the text's other way, by a multiplication
//! and a division.
//!
//! Source: Savchenko 1995, chapter "2-D clipping"; "View plane clipping".

/// How the place is found where a line crosses an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Search {
    /// Halving in whole numbers, with the slips of the listing.
    AsPrinted,
    /// Halving with fraction bits.
    #[default]
    Precise,
    /// `ym = y2 - (y2 - y1) (x2 - xm) / (x2 - x1)`, to the nearest integer.
    SimilarTriangles,
}

/// What is kept: the places where one coordinate lies from `min` to `max`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// The coordinate: 0 for x, 1 for y, 2 for z. At least one below the dimension.
    pub axis: usize,
    /// The lower edge (`C_X_CLIPPING_MIN`, `C_Y_CLIPPING_MIN`, `C_plane`).
    pub min: i32,
    /// The upper edge (`C_X_CLIPPING_MAX`, `C_Y_CLIPPING_MAX`).
    pub max: i32,
}

impl Bounds {
    /// The columns of a screen.
    #[must_use]
    pub fn columns(width: usize) -> Self {
        Self { axis: 0, min: 0, max: last(width) }
    }

    /// The rows of a screen.
    #[must_use]
    pub fn rows(height: usize) -> Self {
        Self { axis: 1, min: 0, max: last(height) }
    }

    /// All from the clipping plane away from the viewer.
    #[must_use]
    pub fn beyond(plane: i32) -> Self {
        Self { axis: 2, min: plane, max: i32::MAX }
    }
}

fn last(count: usize) -> i32 {
    i32::try_from(count).unwrap_or(i32::MAX) - 1
}

/// What is left of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClippedLine<const N: usize> {
    /// The first vertex.
    pub start: [i32; N],
    /// The second vertex.
    pub end: [i32; N],
    /// Whether the first vertex was searched for (`C_2D_clipping`): then a polygon takes both, otherwise only the second.
    pub first_clipped: bool,
}

/// Clips a line; `None` when nothing of it is left (`C_line_x_clipping`, `C_line_y_clipping`).
#[must_use]
pub fn clip_line<const N: usize>(
    line: [[i32; N]; 2],
    bounds: Bounds,
    search: Search,
) -> Option<ClippedLine<N>> {
    let Bounds { axis, min, max } = bounds;
    // The lower end first, so that a line and its reverse are cut at the same place.
    let swapped = line[0][axis] >= line[1][axis];
    let [mut low, mut high] = if swapped { [line[1], line[0]] } else { line };
    if low[axis] > max || high[axis] < min || min > max {
        return None;
    }
    let is_printed = search == Search::AsPrinted;
    let mut first_clipped = false;
    if low[axis] < min || (is_printed && low[axis] == min) {
        low = match search {
            Search::AsPrinted => halve_as_printed(low, high, Side::Low, axis, min).0,
            _ => crossing(low, high, axis, min, search),
        };
        first_clipped |= !swapped;
    }
    if high[axis] > max {
        high = match search {
            Search::AsPrinted => halve_as_printed(low, high, Side::High, axis, max).0,
            _ => crossing(low, high, axis, max, search),
        };
        first_clipped |= swapped;
    }
    let [start, end] = if swapped { [high, low] } else { [low, high] };
    Some(ClippedLine { start, end, first_clipped })
}

/// Clips a line on the screen, by columns and then by rows.
#[must_use]
pub fn clip_line_to_screen<const N: usize>(
    line: [[i32; N]; 2],
    size: [usize; 2],
    search: Search,
) -> Option<[[i32; N]; 2]> {
    let within = clip_line(line, Bounds::columns(size[0]), search)?;
    let within = clip_line([within.start, within.end], Bounds::rows(size[1]), search)?;
    Some([within.start, within.end])
}

/// Which end of a line is cut.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Low,
    High,
}

/// The search as printed: the upper end is the first candidate, and each midpoint is the next. Returns the place
/// found, and after how many midpoints.
fn halve_as_printed<const N: usize>(
    low: [i32; N],
    high: [i32; N],
    side: Side,
    axis: usize,
    edge: i32,
) -> ([i32; N], u32) {
    let (mut left, mut right, mut middle) = (low, high, high);
    let mut midpoints = 0;
    while middle[axis] != edge {
        let is_left = match side {
            Side::Low => middle[axis] < edge,
            Side::High => middle[axis] <= edge,
        };
        if is_left {
            left = middle
        } else {
            right = middle
        }
        middle = std::array::from_fn(|k| midpoint(left[k], right[k]));
        midpoints += 1;
    }
    (middle, midpoints)
}

/// Half of the sum, rounded down: what `(a + b) >> 1` gives where the sum fits.
fn midpoint(a: i32, b: i32) -> i32 {
    ((i64::from(a) + i64::from(b)) >> 1) as i32
}

/// Where a line crosses an edge between its ends, `low` before it and `high` after it.
fn crossing<const N: usize>(
    low: [i32; N],
    high: [i32; N],
    axis: usize,
    edge: i32,
    search: Search,
) -> [i32; N] {
    let mut at = match search {
        Search::SimilarTriangles => by_similar_triangles(low, high, axis, edge),
        Search::AsPrinted | Search::Precise => halve_precisely(low, high, axis, edge),
    };
    at[axis] = edge;
    at
}

/// Fraction bits of the precise search: a 32-bit number with them fits into 62 bits, and the sum of two into 63.
const SEARCH_BITS: u32 = 30;

fn halve_precisely<const N: usize>(low: [i32; N], high: [i32; N], axis: usize, edge: i32) -> [i32; N] {
    let long = |v: i32| i64::from(v) << SEARCH_BITS;
    let (mut left, mut right) = (low.map(long), high.map(long));
    let edge = long(edge);
    let mut middle = left;
    while right[axis] - left[axis] > 1 {
        middle = std::array::from_fn(|k| (left[k] + right[k]) >> 1);
        if middle[axis] == edge {
            break;
        }
        if middle[axis] < edge { left = middle } else { right = middle }
    }
    middle.map(|v| ((v + (1 << (SEARCH_BITS - 1))) >> SEARCH_BITS) as i32)
}

fn by_similar_triangles<const N: usize>(low: [i32; N], high: [i32; N], axis: usize, edge: i32) -> [i32; N] {
    let wide = i128::from;
    let length = wide(high[axis]) - wide(low[axis]);
    let part = wide(high[axis]) - wide(edge);
    // To the nearest integer, halves up.
    let at = |k: usize| {
        wide(high[k]) - (2 * (wide(high[k]) - wide(low[k])) * part + length).div_euclid(2 * length.max(1))
    };
    std::array::from_fn(|k| at(k) as i32)
}

/// Clips a polygon, whose last corner is joined to its first (`C_polygon_x_clipping`). The result may have more corners or
/// fewer, and the same corner twice in a row; it is empty when nothing is left.
///
/// Edge by edge: if only the second corner was cut, or none, the second is taken; if the first or both were cut, both are;
/// an edge outside gives none.
#[must_use]
pub fn clip_polygon<const N: usize>(corners: &[[i32; N]], bounds: Bounds, search: Search) -> Vec<[i32; N]> {
    let mut clipped = Vec::with_capacity(2 * corners.len());
    for (i, &corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let Some(line) = clip_line([corner, next], bounds, search) else { continue };
        if line.first_clipped {
            clipped.push(line.start);
        }
        clipped.push(line.end);
    }
    clipped
}

#[cfg(test)]
#[path = "clip_tests.rs"]
mod tests;
