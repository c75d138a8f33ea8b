//! Line drawings as SVG 1.1, to be scaled, edited and printed.
//!
//! One user unit is one pixel of the picture that the drawing stands for, y downwards. Lines of one
//! colour are one path; where a line begins at the end of the one before, the path goes on, so that
//! corners are joined.

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
    let ([x, y], [w, h]) = (drawing.corner.map(number), drawing.size.map(number));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\">\n"
    );
    if let Some(color) = drawing.background {
        svg += &format!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n", hex(color));
    }
    let width = number(drawing.line_width);
    svg += &format!(
        "<g fill=\"none\" stroke-width=\"{width}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
    );
    for (color, path) in paths(&drawing.lines) {
        svg += &format!("<path stroke=\"{color}\" d=\"{path}\"/>\n");
    }
    svg + "</g>\n</svg>\n"
}

/// The lines of each colour as path data, colours in the order of their first line.
fn paths(lines: &[Line]) -> Vec<(String, String)> {
    let mut index = HashMap::new();
    let mut paths: Vec<(String, String)> = Vec::new();
    let mut last_end = Vec::new();
    for line in lines.iter().filter(|l| l.ends.iter().flatten().all(|v| v.is_finite())) {
        let color = hex(line.color);
        let i = *index.entry(color.clone()).or_insert_with(|| {
            paths.push((color, String::new()));
            last_end.push(String::new());
            paths.len() - 1
        });
        let [start, end] = line.ends.map(|[x, y]| format!("{} {}", number(x), number(y)));
        if last_end[i] == start {
            // Writing to a string cannot fail.
            let _ = write!(paths[i].1, "L{end}");
        } else {
            let _ = write!(paths[i].1, "M{start}L{end}");
        }
        last_end[i] = end;
    }
    paths
}

/// Up to three digits after the point, without trailing zeros.
fn number(v: f64) -> String {
    let text = format!("{v:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
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
             <path stroke=\"#000000\" d=\"M0 0L1 2L3.25 0\"/>\n\
             <path stroke=\"#ff0000\" d=\"M5 5L6 6\"/>\n</g>\n</svg>\n"
        );
    }
}
