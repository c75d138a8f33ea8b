//! The polygon shading exercise: intensities at vertices, on edges, inside; nearer pixels hide others.
//!
//! A vertex has whole x and y on the screen (y down), a depth z, smaller in front, and an intensity b
//! typed by hand; there is no light and no normal. Edges give two sets, left and right, with one point
//! for each row, walked by an integer line algorithm; rows are filled between the two. z and b are
//! interpolated by the ratio of distances, on edges and across rows, and cut off to whole numbers.
//!
//! The text's procedures have slips, each of which [`Slips`] can bring back; [`Slips::MENDED`] is
//! what the command draws. Source: "Polygon shading" (laboratory exercise, A. Galinović), sections
//! 1 to 4.

mod applet;
mod edges;
mod file;
mod fill;

pub use applet::PolygonApplet;
pub use edges::{EdgeRow, EdgeSets, gouraud};
pub use file::{parse_polygons, polygons_text};
pub use fill::{PolygonPicture, WriteCounts};

/// A vertex on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScreenVertex {
    /// Column.
    pub x: i32,
    /// Row, down.
    pub y: i32,
    /// Depth, smaller in front.
    pub z: i32,
    /// Intensity; 0 to 255 are black to white.
    pub b: i32,
}

impl ScreenVertex {
    /// A vertex from its four numbers.
    #[must_use]
    pub const fn new(x: i32, y: i32, z: i32, b: i32) -> Self {
        Self { x, y, z, b }
    }
}

/// Which slips of the text are kept. Each is a fault that was mended where it is false.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slips {
    /// The loop over a shallow edge's rows runs once too often, and writes a point beyond the edge's
    /// end with depth and intensity continued.
    pub extra_pass: bool,
    /// Horizontal edges go into the left set, where they may replace what belongs there.
    pub horizontal_edges: bool,
    /// The edge that is written last has the row, so the picture depends on the vertex that a polygon
    /// begins with. Mended: the left set keeps the leftmost point of a row, the right set the
    /// rightmost.
    pub last_edge_wins: bool,
    /// Polygons that run counter-clockwise on the screen have their sets exchanged, and next to nothing
    /// is drawn of them. Mended: they are turned around.
    pub one_orientation: bool,
    /// Rows of one pixel divide 0 by 0, which makes their depth and intensity 0.
    pub single_pixels: bool,
    /// Both ends of a row are the left one, as the text has it: every division is by 0, and everything
    /// becomes 0.
    pub same_end_twice: bool,
    /// Whole parts are taken of what rounding errors have left just below a whole number.
    pub lost_units: bool,
}

impl Slips {
    /// None.
    pub const MENDED: Self = Self {
        extra_pass: false,
        horizontal_edges: false,
        last_edge_wins: false,
        one_orientation: false,
        single_pixels: false,
        same_end_twice: false,
        lost_units: false,
    };

    /// The text to the letter.
    pub const AS_PRINTED: Self = Self {
        extra_pass: true,
        horizontal_edges: true,
        last_edge_wins: true,
        one_orientation: true,
        single_pixels: true,
        same_end_twice: true,
        lost_units: true,
    };

    /// The edges to the letter, rows as the text must mean them.
    pub const EDGES_AS_PRINTED: Self =
        Self { single_pixels: false, same_end_twice: false, ..Self::AS_PRINTED };
}

#[cfg(test)]
mod tests;
