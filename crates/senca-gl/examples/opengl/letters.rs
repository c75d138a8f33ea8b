//! A font of strokes: capital letters, one display list each, which moves on by one letter.

use senca_gl::{Context, gl};

/// Strokes of A to Z on a grid of 4 columns and 6 rows: two digits a point, strokes parted by spaces.
const STROKES: [&str; 26] = [
    "002640 1232",
    "00063645443303 3342413000",
    "461605011040",
    "00063645413000",
    "46060040 0333",
    "460600 0333",
    "4616050110404323",
    "0006 4046 0343",
    "1030 2026 1636",
    "4641301001",
    "0006 460340",
    "060040",
    "0006234640",
    "00064046",
    "100105163645413010",
    "00063645443303",
    "100105163645413010 2240",
    "00063645443303 2340",
    "46160504133342413000",
    "0646 2026",
    "060110304146",
    "062046",
    "0600234046",
    "0046 0640",
    "062346 2320",
    "06460040",
];

/// How many lists a font has: one for each character code.
pub(crate) const LISTS: i32 = 128;

/// Makes the lists; returns the list base that goes with character codes.
pub(crate) fn font(c: &mut Context) -> u32 {
    let base = c.gen_lists(LISTS);
    for (k, strokes) in STROKES.iter().enumerate() {
        c.new_list(base + u32::from(b'A') + k as u32, gl::COMPILE);
        for stroke in strokes.split(' ') {
            c.begin(gl::LINE_STRIP);
            for point in stroke.as_bytes().chunks_exact(2) {
                let number = |digit: u8| f64::from(digit - b'0');
                c.vertex([number(point[0]) / 6.0, number(point[1]) / 6.0]);
            }
            c.end();
        }
        c.translate([1.0, 0.0, 0.0]);
        c.end_list();
    }
    c.new_list(base + u32::from(b' '), gl::COMPILE);
    c.translate([0.6, 0.0, 0.0]);
    c.end_list();
    base
}

/// Writes capital letters and spaces from the origin to the right, each one unit wide.
pub(crate) fn write(c: &mut Context, base: u32, text: &str) {
    c.push_matrix();
    c.list_base(base);
    c.call_lists_of(text.len() as i32, gl::BYTE, text.as_bytes());
    c.pop_matrix();
}
