//! Polygons as text: a vertex a line, `x y z b`; a line with nothing on it ends a polygon; remarks in
//! braces or behind `#`.

use std::fmt::Write;

use senca_io::{Location, ReadError};

use super::ScreenVertex;

/// Largest x and y either way: an edge is walked row by row.
const LARGEST_PLACE: i32 = 1 << 15;
/// Largest depth and intensity either way.
const LARGEST_VALUE: i32 = 1 << 20;

/// Reads polygons.
///
/// # Errors
/// With line and column for what is no whole number, or too large, and for polygons of fewer
/// than three vertices.
pub fn parse_polygons(name: &str, text: &str) -> Result<Vec<Vec<ScreenVertex>>, ReadError> {
    let mut polygons = Vec::new();
    let mut open: Vec<ScreenVertex> = Vec::new();
    let mut last = 1;
    for (line, number) in text.lines().zip(1u32..) {
        let content = line.split(['{', '#']).next().unwrap_or_default();
        if !content.trim().is_empty() {
            open.push(vertex(name, number, content)?);
            last = number;
        } else if line.trim().is_empty() {
            close(name, last, &mut open, &mut polygons)?;
        }
    }
    close(name, last, &mut open, &mut polygons)?;
    Ok(polygons)
}

fn close(
    name: &str,
    line: u32,
    open: &mut Vec<ScreenVertex>,
    polygons: &mut Vec<Vec<ScreenVertex>>,
) -> Result<(), ReadError> {
    match open.len() {
        0 => Ok(()),
        1 | 2 => {
            let message = format!("a polygon has at least 3 vertices, not {}", open.len());
            Err(ReadError::malformed(Location::text(name, line, 1), message))
        }
        _ => {
            polygons.push(std::mem::take(open));
            Ok(())
        }
    }
}

fn vertex(name: &str, line: u32, content: &str) -> Result<ScreenVertex, ReadError> {
    let column = |word: &str| {
        let before = word.as_ptr() as usize - content.as_ptr() as usize;
        content[..before].chars().count() as u32 + 1
    };
    let refuse =
        |column: u32, message: String| Err(ReadError::malformed(Location::text(name, line, column), message));
    let mut words = content.split_whitespace();
    let mut numbers = [0; 4];
    let parts = [("x", LARGEST_PLACE), ("y", LARGEST_PLACE), ("z", LARGEST_VALUE), ("b", LARGEST_VALUE)];
    for (number, (what, largest)) in numbers.iter_mut().zip(parts) {
        let Some(word) = words.next() else {
            let end = content.trim_end().chars().count() as u32 + 1;
            return refuse(end, format!("expected {what}, found the end of the line"));
        };
        match word.parse::<i32>() {
            Ok(value) if value.unsigned_abs() <= largest as u32 => *number = value,
            _ => {
                let expected = format!("expected {what}, a whole number up to {largest}, found \"{word}\"");
                return refuse(column(word), expected);
            }
        }
    }
    if let Some(word) = words.next() {
        return refuse(column(word), format!("expected the end of the line, found \"{word}\""));
    }
    let [x, y, z, b] = numbers;
    Ok(ScreenVertex { x, y, z, b })
}

/// Writes polygons as they are read.
#[must_use]
pub fn polygons_text(polygons: &[Vec<ScreenVertex>]) -> String {
    let mut text = String::new();
    for (number, polygon) in polygons.iter().enumerate() {
        if number > 0 {
            text.push('\n');
        }
        for ScreenVertex { x, y, z, b } in polygon {
            let _ = writeln!(text, "{x} {y} {z} {b}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_survive_writing() {
        let text = "# x y z b\n1 2 3 4 {first}\n5 6 7 8\n-9 10 11 12\n\n\n0 0 0 0\n{a remark only}\n1 0 0 0\n0 1 0 0\n";
        let polygons = parse_polygons("p", text).expect("reads");
        assert_eq!(polygons.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
        assert_eq!(polygons[0][2], ScreenVertex::new(-9, 10, 11, 12));
        assert_eq!(parse_polygons("p", &polygons_text(&polygons)).expect("reads"), polygons);
        assert!(parse_polygons("p", "").expect("reads").is_empty());
    }

    #[test]
    fn errors_say_where() {
        for (text, expected) in [
            ("1 2 3", "p:1:6: expected b, found the end of the line"),
            ("1 2 3 4\n 1 a 3 4", "p:2:4: expected y, a whole number up to 32768, found \"a\""),
            ("1 2 3 4 5", "p:1:9: expected the end of the line, found \"5\""),
            ("1 2 3.5 4", "p:1:5: expected z, a whole number up to 1048576, found \"3.5\""),
            ("1 2 -9999999 4", "p:1:5: expected z, a whole number up to 1048576, found \"-9999999\""),
            ("40000 2 3 4", "p:1:1: expected x, a whole number up to 32768, found \"40000\""),
            ("1 2 -2147483648 4", "p:1:5: expected z, a whole number up to 1048576, found \"-2147483648\""),
            ("1 2 3 4\n1 2 3 4\n\n", "p:2:1: a polygon has at least 3 vertices, not 2"),
        ] {
            assert_eq!(parse_polygons("p", text).expect_err(text).to_string(), expected);
        }
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "([ \\n\\n{}#é]|[0-9-]{1,4} ){0,60}") {
            match parse_polygons("p", &text) {
                Ok(polygons) => {
                    let again = parse_polygons("p", &polygons_text(&polygons)).expect("reads");
                    proptest::prop_assert_eq!(again, polygons);
                }
                Err(error) => proptest::prop_assert!(error.to_string().starts_with("p:")),
            }
        }
    }
}
