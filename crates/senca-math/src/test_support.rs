//! Shared assertions of this crate's tests.

use glam::{DMat4, DVec3, DVec4};

pub(crate) fn vec3(x: i32, y: i32, z: i32) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}

#[track_caller]
pub(crate) fn assert_close3(got: DVec3, expected: DVec3, tolerance: f64) {
    assert!((got - expected).abs().max_element() <= tolerance, "got {got}, expected {expected}");
}

#[track_caller]
pub(crate) fn assert_close4(got: DVec4, expected: DVec4, tolerance: f64) {
    assert!((got - expected).abs().max_element() <= tolerance, "got {got}, expected {expected}");
}

/// Compares with rows in the books' layout (row vectors), which are the columns of `got`.
#[track_caller]
pub(crate) fn assert_matrix(got: &DMat4, book_rows: [[f64; 4]; 4], tolerance: f64) {
    let expected = DMat4::from_cols_array_2d(&book_rows);
    assert!(got.abs_diff_eq(expected, tolerance), "got rows {:?}", got.to_cols_array_2d());
}
