//! Printing matrices in the books' layout.
//!
//! The books multiply row vectors from the left, `y = x T`, so they print the transpose of the
//! matrices used here: the translation stands in the last row, perspective in the last column.

use std::fmt::Write;

use glam::DMat4;

/// The rows as the books print them.
#[must_use]
pub fn book_rows(m: &DMat4) -> [[f64; 4]; 4] {
    m.to_cols_array_2d()
}

/// A matrix from rows as the books print them.
#[must_use]
pub fn from_book_rows(rows: [[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&rows)
}

/// Four lines of text in the books' layout, each ended by a newline, columns aligned on the right,
/// with this many digits after the point. Numbers of 10^9 and above are written with an exponent.
#[must_use]
pub fn aligned_text(m: &DMat4, decimals: usize) -> String {
    let cells = book_rows(m).map(|row| row.map(|v| cell(v, decimals)));
    let widths: [usize; 4] =
        std::array::from_fn(|c| cells.iter().map(|row| row[c].len()).max().unwrap_or_default());
    let mut text = String::new();
    for row in &cells {
        let padded: Vec<_> = row.iter().zip(widths).map(|(v, width)| format!("{v:>width$}")).collect();
        text += &padded.join("  ");
        text.push('\n');
    }
    text
}

/// The rows as a JSON array of four arrays, in digits that read back the same values. What is not
/// finite becomes `null`.
#[must_use]
pub fn json_rows(m: &DMat4) -> String {
    let mut json = String::from("[");
    for (r, row) in book_rows(m).iter().enumerate() {
        json += if r == 0 { "[" } else { ", [" };
        for (c, v) in row.iter().enumerate() {
            json += if c == 0 { "" } else { ", " };
            // Writing to a string cannot fail.
            let _ = if v.is_finite() { write!(json, "{v:?}") } else { write!(json, "null") };
        }
        json.push(']');
    }
    json + "]"
}

/// Named matrices as text: each name on a line of its own, the matrix under it as by
/// [`aligned_text`], a blank line between.
#[must_use]
pub fn named_text(matrices: &[(String, DMat4)], decimals: usize) -> String {
    let blocks: Vec<_> =
        matrices.iter().map(|(name, m)| format!("{name}\n{}", aligned_text(m, decimals))).collect();
    blocks.join("\n")
}

/// Named matrices as a JSON object of [`json_rows`], in their order, a name to a line. Names must
/// need no escapes, as those of the viewing operations.
#[must_use]
pub fn named_json(matrices: &[(String, DMat4)]) -> String {
    let members: Vec<_> =
        matrices.iter().map(|(name, m)| format!("  \"{name}\": {}", json_rows(m))).collect();
    format!("{{\n{}\n}}\n", members.join(",\n"))
}

fn cell(v: f64, decimals: usize) -> String {
    if v.abs() >= 1e9 {
        return format!("{v:.decimals$e}");
    }
    let text = format!("{v:.decimals$}");
    // A zero has no sign, also when it comes from rounding.
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::transform::{central_projection_to_xy, translation};

    #[test]
    fn translation_stands_in_the_last_row() {
        let rows = book_rows(&translation(DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(rows[3], [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(book_rows(&central_projection_to_xy(2.0))[2], [0.0, 0.0, 1.0, -0.5]);
        assert_eq!(from_book_rows(rows), translation(DVec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn text_is_aligned_and_zero_has_no_sign() {
        let text = aligned_text(&translation(DVec3::new(-1.5, -0.0, -1e-9)), 3);
        let expected = [
            " 1.000  0.000  0.000  0.000",
            " 0.000  1.000  0.000  0.000",
            " 0.000  0.000  1.000  0.000",
            "-1.500  0.000  0.000  1.000",
        ];
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
        assert!(aligned_text(&translation(DVec3::X * 2e12), 2).contains("2.00e12"));
    }

    #[test]
    fn named_matrices_stand_one_under_the_other() {
        let both = [("T1".to_owned(), DMat4::IDENTITY), ("T".to_owned(), DMat4::IDENTITY)];
        let text = named_text(&both, 0);
        assert!(text.starts_with("T1\n1  0  0  0\n0  1  0  0\n") && text.contains("0  0  0  1\n\nT\n1  0"));
        let rows = "[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]";
        assert_eq!(named_json(&both), format!("{{\n  \"T1\": {rows},\n  \"T\": {rows}\n}}\n"));
    }

    #[test]
    fn json_reads_back_the_same_values() {
        let m = translation(DVec3::new(0.1 + 0.2, 1e-300, -1.0 / 3.0));
        let json = json_rows(&m);
        let read: Vec<f64> = json
            .split(|c: char| "[], ".contains(c))
            .filter(|part| !part.is_empty())
            .map(|part| part.parse().unwrap())
            .collect();
        assert_eq!(read, m.to_cols_array());
        assert!(json_rows(&translation(DVec3::NAN)).contains("null, null, null, 1.0]]"));
    }
}
