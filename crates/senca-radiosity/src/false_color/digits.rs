//! Letters of five by seven dots, as far as numbers and units need them.

use senca_math::{Image, LinearRgb};

/// Height of a letter in dots.
pub const GLYPH_HEIGHT: u32 = 7;

/// Width of a letter in dots, and of the gap behind it.
const GLYPH_WIDTH: u32 = 5;
const GAP: u32 = 1;

/// Rows of a letter from the top, a bit for each dot, the leftmost the highest.
fn glyph(letter: char) -> [u8; 7] {
    match letter {
        '0' => [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111],
        '3' => [0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        '.' => [0, 0, 0, 0, 0, 0b01100, 0b01100],
        '-' => [0, 0, 0, 0b11111, 0, 0, 0],
        '/' => [0b00001, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b10000],
        '%' => [0b11001, 0b11001, 0b00010, 0b00100, 0b01000, 0b10011, 0b10011],
        'c' => [0, 0, 0b01110, 0b10000, 0b10000, 0b10001, 0b01110],
        'd' => [0b00001, 0b00001, 0b01101, 0b10011, 0b10001, 0b10001, 0b01111],
        'e' => [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110],
        'l' => [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        'm' => [0, 0, 0b11010, 0b10101, 0b10101, 0b10001, 0b10001],
        'u' => [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101],
        'x' => [0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001],
        '²' => [0b01100, 0b10010, 0b00100, 0b01000, 0b11110, 0, 0],
        _ => [0; 7],
    }
}

/// Width of a text in dots.
#[must_use]
pub fn text_width(text: &str) -> u32 {
    text.chars().count() as u32 * (GLYPH_WIDTH + GAP)
}

/// Draws `text` with its upper left corner at `at`, dots of `zoom` pixels. What lies outside of the
/// picture is left out, and so are letters that numbers and units do not need.
pub fn draw_text(image: &mut Image, [left, top]: [u32; 2], text: &str, zoom: u32, color: LinearRgb) {
    let LinearRgb { r, g, b } = color;
    for (number, letter) in (0..).zip(text.chars()) {
        for (row, bits) in (0..).zip(glyph(letter)) {
            for column in (0..GLYPH_WIDTH).filter(|column| bits >> (GLYPH_WIDTH - 1 - column) & 1 == 1) {
                let x = left + zoom * (number * (GLYPH_WIDTH + GAP) + column);
                let y = top + zoom * row;
                fill(image, [x, y], zoom, [r, g, b, 1.0]);
            }
        }
    }
}

fn fill(image: &mut Image, [left, top]: [u32; 2], side: u32, pixel: [f32; 4]) {
    for y in top..(top + side).min(image.height()) {
        for x in left..(left + side).min(image.width()) {
            image.set_pixel(x, y, pixel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_letters_of_numbers_and_units_are_there_and_differ() {
        let letters: Vec<char> = "0123456789.-/%cdelmux²".chars().collect();
        for (i, a) in letters.iter().enumerate() {
            assert_ne!(glyph(*a), [0; 7], "{a}");
            assert!(letters[..i].iter().all(|b| glyph(*a) != glyph(*b)), "{a}");
        }
    }

    #[test]
    fn text_stays_inside_the_picture() {
        let mut image = Image::new(9, 6, [0.0; 4]);
        draw_text(&mut image, [0, 0], "81", 1, LinearRgb::WHITE);
        draw_text(&mut image, [100, 100], "8", 3, LinearRgb::WHITE);
        assert_eq!(image.pixel(1, 0), [1.0; 4]);
        assert_eq!(image.pixel(0, 0), [0.0; 4]);
        assert_eq!(text_width("81"), 12);
    }
}
