use proptest::prelude::*;

use super::*;

fn f32_of(text: &str) -> Result<f32, ReadError> {
    Cursor::new("t", text.as_bytes()).f32("a number")
}

fn f64_of(text: &str) -> Result<f64, ReadError> {
    Cursor::new("t", text.as_bytes()).f64("a number")
}

#[test]
fn numbers_round_like_the_standard_library() {
    let halfway_between_floats = "1.00000005960464477539062500";
    for text in [
        "0",
        "-0",
        "+1.5",
        ".5",
        "5.",
        "-.25e2",
        "1e22",
        "1e23",
        "9007199254740993",
        "3.4028235e38",
        "1e-45",
        "1.17549435e-38",
        "0.1",
        "16777217",
        "8388609.5",
        "1.000000059604644775390625",
        halfway_between_floats,
        "123456789012345678901234567890",
        "0.000000000000000000000000000001",
        "1e-400",
    ] {
        assert_eq!(f64_of(text).expect(text).to_bits(), text.parse::<f64>().expect(text).to_bits(), "{text}");
        assert_eq!(f32_of(text).expect(text).to_bits(), text.parse::<f32>().expect(text).to_bits(), "{text}");
    }
}

proptest! {
    #[test]
    fn any_float_is_read_back(bits: u32) {
        let value = f32::from_bits(bits);
        prop_assume!(value.is_finite());
        for text in [format!("{value}"), format!("{value:e}"), format!("{value:.9}")] {
            prop_assert_eq!(f32_of(&text).expect("a float").to_bits(), text.parse::<f32>().expect("a float").to_bits());
        }
    }

    #[test]
    fn any_double_is_read_back(bits: u64) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        prop_assert_eq!(f64_of(&format!("{value:e}")).expect("a double").to_bits(), value.to_bits());
    }

    #[test]
    fn any_decimal_rounds_once(digits in "[0-9]{1,12}\\.[0-9]{0,12}", exponent in -30i32..26) {
        let text = format!("{digits}e{exponent}");
        prop_assert_eq!(f32_of(&text).expect("a float").to_bits(), text.parse::<f32>().expect("a float").to_bits());
    }
}

#[test]
fn what_is_no_number_is_refused_where_it_stands() {
    for text in ["", "x", "-", ".", "1e", "1e+", "nan", "inf", "1.2.3", "1x", "0x10", "--1"] {
        let error = f32_of(&format!("  {text}")).expect_err(text);
        assert!(error.to_string().starts_with("t:1:3: expected a number, found "), "{error}");
    }
    assert_eq!(f32_of("1e39").expect_err("large").to_string(), "t:1:1: the number \"1e39\" is too large");
}

#[test]
fn places_count_lines_of_every_kind_and_characters() {
    let text = "a\r\nb\rc\nčž x".as_bytes();
    let cursor = Cursor::new("t", text);
    let place = |pos| cursor.location(pos).to_string();
    assert_eq!(place(0), "t:1:1");
    assert_eq!(place(3), "t:2:1");
    assert_eq!(place(5), "t:3:1");
    assert_eq!(place(text.len() - 1), "t:4:4");
}

#[test]
fn a_backslash_joins_lines() {
    let mut cursor = Cursor::with_continuation("t", b"1 \\\n 2\\\r\n3 # x \\\n y\nz");
    for expected in [1, 2, 3] {
        assert_eq!(cursor.integer("a number").expect("a number"), expected);
    }
    cursor.next_line();
    assert_eq!(cursor.word(), b"z");
}

#[test]
fn names_keep_inner_blanks() {
    let mut cursor = Cursor::with_continuation("t", b"usemtl  dark red \t\r\nnext");
    assert_eq!(cursor.word(), b"usemtl");
    assert_eq!(cursor.rest_of_line(), "dark red");
    assert!(cursor.start_line());
    assert_eq!(cursor.word(), b"next");
}
