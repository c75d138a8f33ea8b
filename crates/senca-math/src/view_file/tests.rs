use proptest::prelude::*;

use super::*;
use crate::test_support::assert_matrix;

const SIMPLE_B: &str = "\
# The simple camera
view   = B
VRP    = 0 0 0
VPN    = 0, 0, 1   # towards the eye
VUP    0 1 0
PRP    = 0 0 5
window = -1 1 -1 1
F = 1
B = -5
";

fn message(text: &str) -> String {
    ViewFile::parse("cam.txt", text).expect_err("a mistake").to_string()
}

#[test]
fn operation_b_is_read_and_printed() {
    let file = ViewFile::parse("cam.txt", SIMPLE_B).unwrap();
    let matrices = file.matrices().unwrap();
    let names: Vec<_> = matrices.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["T1", "T2", "T3", "T4", "T5", "T6", "T"]);
    let sixth = 1.0 / 6.0;
    let rows = [[0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, sixth, -0.1], [0.0, 0.0, -sixth, 0.5]];
    assert_matrix(&matrices[6].1, rows, 1e-15);
}

#[test]
fn every_operation_has_its_form() {
    let a = ViewFile::parse("a", "\u{feff}view=A\r\nP=1 2 3\r\nn = 0.6667 0.3333 0.6667\r\nf=2\r\n").unwrap();
    assert!(matches!(a.operation, ViewingOperation::CentralByNormal(view) if view.focal == 2.0));
    assert_eq!(a.matrices().unwrap().len(), 5);
    let p = ViewFile::parse("p", "n 0 0 1\nP 1 2 3\nVIEW p").unwrap();
    assert_eq!(p.matrices().unwrap().len(), 3);
    let c = ViewFile::parse("c", &SIMPLE_B.replace("= B", "= c")).unwrap();
    assert!(matches!(c.operation, ViewingOperation::Parallel(_)));
    for (name, steps) in [("1991-perspective", 6), ("1991-parallel", 5), ("1991-gks", 5)] {
        let file = ViewFile::parse("t", &SIMPLE_B.replace("= B", &format!("= {name}"))).unwrap();
        assert_eq!(file.steps().unwrap().steps().len(), steps);
    }
}

#[test]
fn mistakes_are_told_with_their_place() {
    assert_eq!(message(""), "cam.txt:1:1: the key \"view\" is missing");
    assert_eq!(
        message("view = D"),
        "cam.txt:1:8: unknown view \"D\"; use A, B, C, P, 1991-perspective, 1991-parallel or 1991-gks"
    );
    assert!(message("view\n").starts_with("cam.txt:1:1: unknown view \"\""));
    assert!(message("  colour = 1").starts_with("cam.txt:1:3: unknown key \"colour\"; the keys are view, P"));
    assert!(message("= 1 2").starts_with("cam.txt:1:3: expected a key"));
    assert!(message("=").starts_with("cam.txt:1:1: expected a key"));
    let twice = message("view = A\nP = 1 2 3\n p = 1 2 3");
    assert_eq!(twice, "cam.txt:3:2: the key \"p\" was already given on line 2");
    assert_eq!(message("view = P\nP = 1 2 3"), "cam.txt:2:10: the key \"n\" is missing");
    assert_eq!(message("view = P\nP = 1 2\nn = 0 0 1"), "cam.txt:2:1: \"P\" needs 3 numbers, but has 2");
    assert_eq!(message("view = P\nP = 1 2 3 4\nn = 0 0 1"), "cam.txt:2:11: \"P\" needs 3 numbers, but has 4");
    assert_eq!(
        message("view = A\nP = 1 2 3\nn = 0 0 1\nf ="),
        "cam.txt:4:1: \"f\" needs 1 number, but has 0"
    );
    assert_eq!(message("view = P\nP = 1 é 3\nn = 0 0 1"), "cam.txt:2:7: \"é\" is not a finite number");
    assert_eq!(message("view = P\nP = 1 é nan"), "cam.txt:2:7: \"é\" is not a finite number");
    assert_eq!(message("view = P\nP = 1 1e999 3"), "cam.txt:2:7: \"1e999\" is not a finite number");
    assert_eq!(message("view = P\nf = 1"), "cam.txt:2:1: view P has no key \"f\"; its keys are P, n");
}

#[test]
fn numbers_that_give_no_view_are_told() {
    let text = SIMPLE_B.replace("B = -5", "B = 1");
    let told = message(&text);
    assert!(
        told.starts_with("cam.txt:2:10: the front plane F and the back plane B are the same, 1"),
        "{told}"
    );
    assert!(
        message(&SIMPLE_B.replace("VUP    0 1 0", "VUP 0 0 3")).contains("VUP, the up vector, is parallel")
    );
    assert!(
        message("view = A\nP = 0 0 0\nn = 0 0 2\nf = 1").contains("must have length 1, but its length is 2")
    );
}

proptest! {
    #[test]
    fn any_text_gives_a_view_or_one_message(text in "[a-zA-Z0-9=#,. \n\t-]{0,200}") {
        if let Err(error) = ViewFile::parse("x", &text) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }

    #[test]
    fn any_numbers_give_finite_matrices_or_an_error(values in prop::collection::vec(any::<f64>(), 18)) {
        let v: Vec<String> = values.iter().map(f64::to_string).collect();
        let text = format!(
            "view=B\nVRP={}\nVPN={}\nVUP={}\nPRP={}\nwindow={}\nF={}\nB={}",
            v[0..3].join(" "), v[3..6].join(" "), v[6..9].join(" "), v[9..12].join(" "), v[12..16].join(" "),
            v[16], v[17],
        );
        if let Ok(file) = ViewFile::parse("x", &text) {
            prop_assert!(file.matrices().unwrap().iter().all(|(_, m)| m.is_finite()));
        }
    }
}
