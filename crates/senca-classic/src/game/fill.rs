//! Polygons of one colour and polygons with intensities.
//!
//! Source: Savchenko 1995, "Ambient polygons" and "Shaded polygons"; Gouraud 1971.

use super::borders::{BORDER_BITS, Borders};
use super::clip::Search;
use super::color_map::ColorMap;

/// How a row of one colour is written (`HW_set_char`): all write the same bytes.
///
/// The text weighs a loop in C against assembly and the C library's `memset`, one of which stores 16 bits at a time. Its
/// assembly and its call of `memset` write one byte too few, and the latter at the beginning of the screen's row;
/// here all write from the first to the last pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SpanFill {
    /// Byte by byte.
    Loop,
    /// Two bytes at a time and then the odd one.
    Words,
    /// The library's.
    #[default]
    Library,
}

impl SpanFill {
    /// Gives all bytes one colour.
    pub fn fill(self, span: &mut [u8], color: u8) {
        match self {
            Self::Loop => span.iter_mut().for_each(|pixel| *pixel = color),
            Self::Words => {
                let (words, odd) = span.as_chunks_mut::<2>();
                words.iter_mut().for_each(|word| *word = [color; 2]);
                odd.iter_mut().for_each(|pixel| *pixel = color);
            }
            Self::Library => span.fill(color),
        }
    }
}

/// Fills a polygon with one colour (`G_ambient_polygon`). Its corners are pixels; the last is joined to the first.
pub fn fill_flat(map: &mut ColorMap, corners: &[[i32; 2]], color: u8, search: Search, span_fill: SpanFill) {
    let borders = Borders::of_polygon(corners, map.size(), 0, search);
    for span in borders.spans() {
        span_fill.fill(map.span(span.y, span.start, span.end), color);
    }
}

/// Fills a polygon with intensities from corner to corner (`G_shaded_polygon`): x, y and the intensity, which is written
/// as the colour and wants a palette in which the shades of a colour follow each other.
///
/// More than three corners need not lie in one plane with their intensities; then the shading turns with the polygon, so
/// triangles are better. It is not right in perspective either, which shows little on smooth shades. The increment is the
/// difference by the number of pixels, so the last pixel of a row stays short of the intensity at its end.
pub fn fill_shaded(map: &mut ColorMap, corners: &[[i32; 3]], search: Search) {
    let borders = Borders::of_polygon(corners, map.size(), 1, search);
    for span in borders.spans() {
        let mut intensity = span.rest_start[0];
        let pixels = i64::from(span.end) - i64::from(span.start) + 1;
        let increment = (span.rest_end[0] - intensity) / pixels.max(1);
        for pixel in map.span(span.y, span.start, span.end) {
            *pixel = (intensity >> BORDER_BITS) as u8;
            intensity += increment;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn intensities_of_a_triangle() {
        let mut map = ColorMap::new(40, 40);
        fill_shaded(&mut map, &[[10, 10, 0], [20, 10, 100], [15, 20, 50]], Search::AsPrinted);
        let row = |y: i32, columns: std::ops::RangeInclusive<i32>| {
            columns.map(|x| map.get(x, y).expect("inside")).collect::<Vec<_>>()
        };
        assert_eq!(row(10, 10..=20), [0, 9, 18, 27, 36, 45, 54, 63, 72, 81, 90]);
        assert_eq!(row(14, 11..=19), [0, 20, 28, 37, 45, 54, 62, 71, 0]);
        assert_eq!(row(20, 14..=16), [0, 50, 0]);
    }

    #[test]
    fn polygons_fill_the_screen_and_nothing_else() {
        let corners = |[a, b]: [[i32; 2]; 2]| [a, [b[0], a[1]], b, [a[0], b[1]]];
        let cases = [
            ([[-20, -20], [340, 220]], 320 * 200),
            ([[0, 0], [319, 199]], 320 * 200),
            ([[0, 0], [9, 4]], 50),
            ([[310, 190], [319, 199]], 100),
            ([[-10, 50], [0, 59]], 10),
            ([[319, -5], [400, 0]], 1),
            ([[-20, 10], [-1, 50]], 0),
            ([[10, 200], [50, 300]], 0),
        ];
        for (rectangle, pixels) in cases {
            for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
                let mut map = ColorMap::new(320, 200);
                fill_flat(&mut map, &corners(rectangle), 7, search, SpanFill::default());
                let filled = map.pixels().iter().filter(|&&p| p == 7).count();
                assert_eq!(filled, pixels, "{rectangle:?} {search:?}");
            }
        }
        let mut map = ColorMap::new(8, 8);
        fill_flat(&mut map, &[], 7, Search::Precise, SpanFill::Loop);
        assert!(map.pixels().iter().all(|&p| p == 0));
    }

    proptest! {
        #[test]
        fn all_ways_to_fill_a_row_are_the_same(length in 0usize..40, color: u8) {
            let filled = |how: SpanFill| {
                let mut row = vec![0; length + 2];
                how.fill(&mut row[1..=length], color);
                row
            };
            prop_assert_eq!(filled(SpanFill::Loop), filled(SpanFill::Words));
            prop_assert_eq!(filled(SpanFill::Loop), filled(SpanFill::Library));
        }

        #[test]
        fn any_polygon_can_be_filled(corners in prop::collection::vec(any::<[i32; 3]>(), 0..6)) {
            for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
                let mut map = ColorMap::new(32, 20);
                fill_shaded(&mut map, &corners, search);
                let flat: Vec<_> = corners.iter().map(|c| [c[0], c[1]]).collect();
                fill_flat(&mut map, &flat, 3, search, SpanFill::Words);
            }
        }

        #[test]
        fn clipping_leaves_the_rest_of_a_polygon_as_it_is(
            corners in prop::collection::vec(prop::array::uniform2(5i32..60), 3..6)
        ) {
            // The same polygon in the middle of a screen and cut by one with room around it.
            let (mut whole, mut cut) = (ColorMap::new(64, 64), ColorMap::new(64, 64));
            fill_flat(&mut whole, &corners, 1, Search::Precise, SpanFill::Loop);
            fill_flat(&mut cut, &corners, 1, Search::SimilarTriangles, SpanFill::Library);
            prop_assert_eq!(whole, cut);
        }
    }
}
