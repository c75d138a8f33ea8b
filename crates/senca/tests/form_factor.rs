//! `senca form-factor` as its users run it.

mod common;

use common::{repository, run_in, sample, told};
use serde_json::Value;

fn json(arguments: &[&str]) -> Value {
    let output = run_in(&repository(), &[&["form-factor", "--json"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", told(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn text(arguments: &[&str]) -> String {
    let output = run_in(&repository(), &[&["form-factor"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", told(&output));
    String::from_utf8(output.stdout).expect("text")
}

/// Largest relative error that a method may have on the pairs below.
fn allowed(method: &str, touching: bool) -> f64 {
    match method {
        "exact" | "contour" | "ray-cast" => 1e-9,
        "hemicube" | "nusselt" | "double-area" if !touching => 0.01,
        "hemicube" | "nusselt" => 0.05,
        "double-area" => 0.2,
        _ => 0.1,
    }
}

#[test]
fn pairs_are_told_by_every_method_with_the_exact_value() {
    let pairs: [(&[&str], f64, bool); 4] = [
        (&["parallel", "1", "1", "1"], 0.199_824_895_698, false),
        (&["parallel", "2", "0.5", "1.5"], 0.0, false),
        (&["perpendicular", "1", "1", "1"], 0.200_043_776_075, true),
        (&["tilted", "1", "2", "0.7", "135"], 0.0, true),
    ];
    for (arguments, known, touching) in pairs {
        let report = json(arguments);
        let exact = report["exact"].as_f64().expect("a number");
        assert!(known == 0.0 || (exact - known).abs() < 1e-12, "{exact}");
        let methods = report["methods"].as_array().expect("a list");
        assert_eq!(methods.len(), 7);
        for row in methods {
            let (name, value) =
                (row["method"].as_str().expect("a name"), row["value"].as_f64().expect("a number"));
            let error = (value / exact - 1.0).abs();
            assert!(error < allowed(name, touching), "{arguments:?} {name}: {value} {exact}");
            assert!(row["seconds"].as_f64().expect("a time") > 0.0);
            assert_eq!(row["standard_error"].is_f64(), name == "monte-carlo");
        }
    }
}

#[test]
fn spheres_are_near_their_formulas() {
    // Of the point below a sphere's middle, (r / d)^2; of the disc by the share of the sphere's directions.
    for (arguments, known) in [
        (["patch-sphere", "1", "2", "0.0001"], 0.25),
        (["disc-sphere", "1", "0.5", "2"], 0.052_786_404_500),
        (["spheres", "1", "0.5", "2"], 0.017_147_165_006),
        (["patch-sphere", "1", "2", "100"], 0.0),
    ] {
        let report = json(&[&arguments[..], &["--method", "exact"]].concat());
        let exact = report["exact"].as_f64().expect("a number");
        assert!(known == 0.0 || (exact / known - 1.0).abs() < 1e-9, "{arguments:?}: {exact}");
        let error = report["methods"][0]["relative_error"].as_f64().expect("a number");
        assert!(error.abs() < 2e-2, "{arguments:?}: {error}");
    }
    let output = run_in(&repository(), &["form-factor", "spheres", "1", "1", "1.5"]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("one is in the other"), "{}", told(&output));
}

#[test]
fn discs_are_near_their_formula() {
    let report = json(&["disc", "1", "1", "1", "--method", "exact"]);
    let row = &report["methods"][0];
    // (3 - sqrt 5) / 2
    assert!((report["exact"].as_f64().expect("a number") - 0.381_966_011_250_105).abs() < 1e-14);
    assert!(row["relative_error"].as_f64().expect("a number").abs() < 1e-3);
    assert_eq!(report["methods"].as_array().map(Vec::len), Some(1));
}

#[test]
fn tables_have_a_line_for_each_method() {
    let table = text(&["parallel", "1", "1", "1", "--resolution", "20", "--cells", "middle", "--parts", "1"]);
    for name in ["exact", "contour", "double-area", "nusselt", "hemicube", "ray-cast", "monte-carlo"] {
        assert!(table.lines().any(|line| line.starts_with(name)), "{table}");
    }
    // The cells of the half cube over one point, as the text counts them.
    assert!(table.contains("0.239913272"), "{table}");
}

#[test]
fn the_matrix_of_a_scene_adds_up() {
    let cornell = sample("cornell.toml");
    let cornell = cornell.to_str().expect("a path");
    let report = json(&[cornell, "--method", "hemicube", "--resolution", "50", "--parts", "2"]);
    let patches = report["patches"].as_array().expect("a list");
    let matrix = &report["methods"][0];
    let factors = matrix["factors"].as_array().expect("rows");
    assert!(patches.len() > 10 && factors.len() == patches.len());
    assert!(matrix["greatest_row_sum"].as_f64().expect("a number") < 1.0 + 1e-9);
    let normalized =
        json(&[cornell, "--method", "hemicube", "--resolution", "50", "--parts", "2", "--normalize"]);
    let sum = |row: &Value| row.as_array().expect("a row").iter().filter_map(Value::as_f64).sum::<f64>();
    let rows = normalized["methods"][0]["factors"].as_array().expect("rows");
    assert!(rows.iter().map(sum).all(|s| s == 0.0 || (s - 1.0).abs() < 1e-12));
    let table = text(&[cornell, "--method", "ray-cast", "--lines", "4", "--patch-size", "2"]);
    assert!(table.contains("row sums") && table.contains("ray-cast"), "{table}");
}

#[test]
fn mistakes_are_told_in_one_message() {
    let cases: &[(&[&str], i32, &str)] = &[
        (&[], 2, "PAIR|SCENE"),
        (&["parallel", "1", "1"], 2, "'parallel' needs 3 numbers, W H D, but got 2"),
        (&["disc", "1", "1", "1", "1"], 2, "'disc' needs 3 numbers, R1 R2 D, but got 4"),
        (&["parallel", "1", "x", "1"], 2, "H is 'x', which is not a number"),
        (&["parallel", "1", "-2", "1"], 2, "H is -2, but must be greater than 0"),
        (&["parallel", "1", "nan", "1"], 2, "H is nan, but must be greater than 0"),
        (&["parallel", "inf", "1", "1"], 2, "W is inf, but must be greater than 0 and finite"),
        (&["tilted", "1", "1", "1", "180"], 2, "DEGREES is 180, but must be between 0 and 180"),
        (&["no-such-file"], 2, "'no-such-file' is neither a pair nor a file"),
        (&["samples", "1"], 2, "neither a pair nor a file"),
        (&["samples"], 1, "is a folder"),
        (&["README.md"], 1, "README.md"),
        (&["parallel", "1", "1", "1", "--resolution", "21"], 2, "an even number from 2 to 4096"),
        (&["parallel", "1", "1", "1", "--method", "radiance"], 2, "hemicube"),
        (&["parallel", "1", "1", "1", "--patch-size", "1"], 2, "for scenes"),
        (&["samples/cornell.toml", "--patch-size", "0"], 1, "patch size"),
        (&["samples/cornell.toml", "--patch-size", "0.001"], 1, "16384 elements"),
    ];
    for (arguments, status, part) in cases {
        let output = run_in(&repository(), &[&["form-factor"], *arguments].concat());
        assert_eq!(output.status.code(), Some(*status), "{arguments:?}: {}", told(&output));
        assert!(told(&output).contains(part), "{arguments:?}: {}", told(&output));
        assert!(output.stdout.is_empty());
    }
}
