//! Line drawings as SVG 1.1, to be scaled, edited and printed.
//!
//! One user unit is one pixel of the picture that the drawing stands for, y downwards. Lines of one
//! colour are one path of few long polylines, so that corners are joined, a plotter seldom lifts its
//! pen, and files are small. Coordinates are written to a thousandth of a pixel, and lines
//! whose ends are then the same are joined; the same lines in the same order give the same text.

use std::collections::HashMap;
use std::fmt::Write;

use senca_math::{LinearRgb, Srgb8};

/// A line drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Upper left corner of what is shown, in pixels.
    pub corner: [f64; 2],
    /// Width and height of what is shown, in pixels, each > 0.
    pub size: [f64; 2],
    /// Colour of the paper; `None` leaves it transparent.
    pub background: Option<LinearRgb>,
    /// Width of lines in pixels, > 0.
    pub line_width: f64,
    /// The lines, drawn in this order within each colour.
    pub lines: Vec<Line>,
}

/// A straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Start and end in pixels.
    pub ends: [[f64; 2]; 2],
    /// Its colour.
    pub color: LinearRgb,
}

/// The text of an SVG file. Lines with an end that is no finite number are left out.
#[must_use]
pub fn encode(drawing: &Drawing) -> String {
    let ([x, y], [w, h]) = (drawing.corner.map(decimal), drawing.size.map(decimal));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\">\n"
    );
    if let Some(color) = drawing.background {
        svg += &format!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n", hex(color));
    }
    let width = decimal(drawing.line_width);
    svg += &format!(
        "<g fill=\"none\" stroke-width=\"{width}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
    );
    for (color, path) in paths(&drawing.lines) {
        svg += &format!("<path stroke=\"{color}\" d=\"{path}\"/>\n");
    }
    svg + "</g>\n</svg>\n"
}

/// A point in thousandths of a pixel, as it is written.
type Point = [i64; 2];

/// The lines of each colour as path data, colours in the order of their first line.
fn paths(lines: &[Line]) -> Vec<(String, String)> {
    let mut index = HashMap::new();
    let mut colors: Vec<(String, Vec<[Point; 2]>)> = Vec::new();
    for line in lines.iter().filter(|l| l.ends.iter().flatten().all(|v| v.is_finite())) {
        let color = hex(line.color);
        let i = *index.entry(color.clone()).or_insert_with(|| {
            colors.push((color, Vec::new()));
            colors.len() - 1
        });
        colors[i].1.push(line.ends.map(|end| end.map(thousandths)));
    }
    colors.into_iter().map(|(color, lines)| (color, path_data(&lines))).collect()
}

/// The lines as few long polylines: from each point where an odd number of lines meets, and then from
/// what is left, the pen goes on as long as there is a line not drawn yet.
fn path_data(lines: &[[Point; 2]]) -> String {
    let mut pen = Pen::new(lines);
    let mut data = String::new();
    for only_odd in [true, false] {
        for (i, ends) in lines.iter().enumerate() {
            for start in *ends {
                if !pen.drawn[i] && (!only_odd || pen.lines_at[&start].len() % 2 == 1) {
                    write_polyline(&mut data, &pen.polyline(start));
                }
            }
        }
    }
    data
}

/// Walks along lines that have not been drawn.
struct Pen<'l> {
    lines: &'l [[Point; 2]],
    /// Lines at each point, a line of no length twice.
    lines_at: HashMap<Point, Vec<usize>>,
    /// How many of them have been looked at.
    seen_at: HashMap<Point, usize>,
    drawn: Vec<bool>,
}

impl<'l> Pen<'l> {
    fn new(lines: &'l [[Point; 2]]) -> Self {
        let mut lines_at: HashMap<Point, Vec<usize>> = HashMap::new();
        for (i, ends) in lines.iter().enumerate() {
            ends.iter().for_each(|&end| lines_at.entry(end).or_default().push(i));
        }
        Self { lines, lines_at, seen_at: HashMap::new(), drawn: vec![false; lines.len()] }
    }

    /// The first line at a point that is not drawn yet.
    fn next_line(&mut self, at: Point) -> Option<usize> {
        let lines = self.lines_at.get(&at)?;
        let seen = self.seen_at.entry(at).or_insert(0);
        while lines.get(*seen).is_some_and(|&line| self.drawn[line]) {
            *seen += 1;
        }
        lines.get(*seen).copied()
    }

    /// Draws from `start` until there is no way on.
    fn polyline(&mut self, start: Point) -> Vec<Point> {
        let mut points = vec![start];
        let mut at = start;
        while let Some(line) = self.next_line(at) {
            self.drawn[line] = true;
            let [from, to] = self.lines[line];
            at = if from == at { to } else { from };
            points.push(at);
        }
        points
    }
}

/// Appends a polyline; one that ends where it begins is closed.
fn write_polyline(data: &mut String, points: &[Point]) {
    let closed = points.len() > 3 && points.first() == points.last();
    let points = &points[..points.len() - usize::from(closed)];
    for (i, &[x, y]) in points.iter().enumerate() {
        let command = ["M", "L", " "][i.min(2)];
        // Writing to a string cannot fail.
        let _ = write!(data, "{command}{} {}", number(x), number(y));
    }
    if closed {
        data.push('Z');
    }
}

/// A coordinate as it is written, in thousandths; what is too large for that becomes the largest.
fn thousandths(v: f64) -> i64 {
    (v * 1000.0).round() as i64
}

/// A number with up to three digits after the point.
fn decimal(v: f64) -> String {
    number(thousandths(v))
}

/// A number of thousandths as a decimal, without trailing zeros.
fn number(thousandths: i64) -> String {
    let sign = if thousandths < 0 { "-" } else { "" };
    let (whole, part) = (thousandths.unsigned_abs() / 1000, thousandths.unsigned_abs() % 1000);
    if part == 0 {
        return format!("{sign}{whole}");
    }
    format!("{sign}{whole}.{}", format!("{part:03}").trim_end_matches('0'))
}

fn hex(color: LinearRgb) -> String {
    let Srgb8 { r, g, b } = color.to_srgb8();
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_become_paths_by_colour_and_go_on_where_they_meet() {
        let black = |ends| Line { ends, color: LinearRgb::BLACK };
        let drawing = Drawing {
            corner: [0.0, 0.0],
            size: [10.0, 5.0],
            background: Some(LinearRgb::WHITE),
            line_width: 1.5,
            lines: vec![
                black([[0.0, 0.0], [1.0, 2.0]]),
                Line { ends: [[5.0, 5.0], [6.0, 6.0]], color: LinearRgb::new(1.0, 0.0, 0.0) },
                black([[1.0, 2.0], [3.25, -0.0001]]),
                black([[f64::NAN, 0.0], [1.0, 1.0]]),
            ],
        };
        assert_eq!(
            encode(&drawing),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"5\" viewBox=\"0 0 10 5\">\n\
             <rect x=\"0\" y=\"0\" width=\"10\" height=\"5\" fill=\"#ffffff\"/>\n\
             <g fill=\"none\" stroke-width=\"1.5\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
             <path stroke=\"#000000\" d=\"M0 0L1 2 3.25 0\"/>\n\
             <path stroke=\"#ff0000\" d=\"M5 5L6 6\"/>\n</g>\n</svg>\n"
        );
    }

    fn data(lines: &[[[i64; 2]; 2]]) -> String {
        path_data(&lines.iter().map(|ends| ends.map(|end| end.map(|v| v * 1000))).collect::<Vec<_>>())
    }

    #[test]
    fn polylines_run_through_even_points_and_close() {
        let square = [[[0, 0], [1, 0]], [[1, 1], [0, 1]], [[1, 1], [1, 0]], [[0, 0], [0, 1]]];
        assert_eq!(data(&square), "M0 0L1 0 1 1 0 1Z");
        let branch = [[[0, 0], [1, 0]], [[1, 0], [2, 0]], [[1, 0], [1, 5]]];
        assert_eq!(data(&branch), "M0 0L1 0 2 0M1 0L1 5");
        // An open chain begins at its end, whatever the order of its lines.
        let chain = [[[1, 0], [2, 0]], [[3, 0], [2, 0]], [[1, 0], [0, 0]]];
        assert_eq!(data(&chain), "M3 0L2 0 1 0 0 0");
        assert_eq!(data(&[[[4, 4], [4, 4]]]), "M4 4L4 4", "a dot");
    }

    #[test]
    fn every_line_is_drawn_once() {
        // A grid of 7 x 7 points with both diagonals, its lines in a scrambled order.
        let mut lines = Vec::new();
        for i in 0..7i64 {
            for j in 0..7 {
                for (di, dj) in [(1, 0), (0, 1), (1, 1), (1, -1)] {
                    if i + di < 7 && (0..7).contains(&(j + dj)) {
                        lines.push([[i, j], [i + di, j + dj]]);
                    }
                }
            }
        }
        lines.sort_by_key(|l| l.iter().flatten().fold(7, |h: i64, v| (h * 31 + v) * 17 % 1009));
        let text = data(&lines);
        let mut drawn = Vec::new();
        for polyline in text.split('M').skip(1) {
            let closed = polyline.ends_with('Z');
            let numbers: Vec<i64> = polyline
                .trim_end_matches('Z')
                .replace('L', " ")
                .split(' ')
                .map(|n| n.parse().expect("a number"))
                .collect();
            let mut points: Vec<[i64; 2]> = numbers.chunks(2).map(|p| [p[0], p[1]]).collect();
            if closed {
                points.push(points[0]);
            }
            drawn.extend(points.windows(2).map(|p| [p[0].min(p[1]), p[0].max(p[1])]));
        }
        let mut expected: Vec<_> = lines.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        drawn.sort_unstable();
        expected.sort_unstable();
        assert_eq!(drawn, expected);
        assert!(4 * text.matches('M').count() < lines.len(), "the pen is seldom lifted");
    }

    #[test]
    fn numbers_are_written_to_a_thousandth() {
        let written = [0.0, -0.0001, 1.5, -2.125, 1e300, 0.0996, 1234567.8912].map(decimal);
        assert_eq!(written, ["0", "0", "1.5", "-2.125", "9223372036854775.807", "0.1", "1234567.891"]);
    }
}
