//! `senca lab` as its users run it.

mod common;

use std::io::Write;
use std::process::Stdio;

use common::{repository, run_in, senca_in, told};
use serde_json::{Value, json};

fn run(arguments: &[&str]) -> std::process::Output {
    run_in(&repository(), &[&["lab"], arguments].concat())
}

fn json_of(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", told(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn the_numbers_of_the_manual() {
    let first = json_of(&["1"]);
    assert_eq!(first["v2"], json!([38.0, -14.0, -12.0]));
    assert_eq!(first["V"], json!([3.0, 7.0, 6.0, 1.0]));
    assert_eq!(json_of(&["1", "system"])["solution"], json!([1.0, 2.0, 3.0]));
    let triangle = json_of(&["1", "barycentric", "--input", "samples/lab/triangle.txt"]);
    assert_eq!((&triangle["t"], &triangle["inside"]), (&json!([0.25, 0.25, 0.5]), &json!(true)));
    let line = json_of(&["2", "0", "0", "-3", "-8"]);
    assert_eq!(line["pixels"][4], json!([-1, -4]));
    let polygon = json_of(&["3"]);
    assert_eq!((&polygon["pixels"], &polygon["points"][0]["inside"]), (&json!(38_874), &json!(true)));
    let solid = json_of(&["4", "samples/lab/cube.obj", "--point", "2,.5,.5"]);
    assert_eq!((&solid["inside"], &solid["planes"][2]), (&json!(false), &json!([1.0, 0.0, 0.0, -1.0])));
    let view = json_of(&["5", "--solid", "samples/lab/cube.obj", "--method", "rotations"]);
    assert!((view["points"][3]["xp"].as_f64().expect("a number") + 1.944_544).abs() < 5e-7);
    let curve = json_of(&["6", "--input", "samples/lab/path.txt"]);
    assert_eq!(curve["frames"][25]["visible"], json!([3, 4, 5, 6, 11, 12]));
    let shading = json_of(&["7", "samples/lab/cube.obj"]);
    assert!((shading["face_intensities"][11].as_f64().expect("a number") - 170.7571).abs() < 5e-5);
    let mandelbrot = json_of(&["8", "--input", "samples/lab/mandelbrot.txt"]);
    assert_eq!((&mandelbrot["sum"], &mandelbrot["left_at_last"]), (&json!(451_704), &json!(295)));
    assert_eq!(json_of(&["8", "--set", "julia", "--reach-ends"])["sum"], json!(444_814));
}

#[test]
fn loops_agree() {
    let at = |method: &str| {
        json_of(&["8", "--center", "0,1", "--width", "1e-30", "-m", "400", "--size", "9x7", "--loop", method])
            ["counts"]
            .clone()
    };
    assert_eq!(at("auto"), at("digits"));
    let shallow = |method: &str| json_of(&["8", "--size", "50x50", "--loop", method])["counts"].clone();
    assert_eq!(shallow("auto"), shallow("literal"));
}

#[test]
fn input_comes_from_standard_input_too() {
    let mut command = senca_in(&repository(), &["lab", "2", "--input", "-"]);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("starts");
    child.stdin.take().expect("a pipe").write_all(b"0 0\n3 8\n").expect("writes");
    let output = child.wait_with_output().expect("ends");
    assert!(String::from_utf8_lossy(&output.stdout).contains("0,0 0,1 1,2 1,3 1,4 2,5 2,6 3,7 3,8"));
}

#[test]
fn bad_input_is_told_with_its_place() {
    for (arguments, status, part) in [
        (
            &["1", "system", "1", "2", "x"][..],
            1,
            "command line:1:5: z of equation 1 is to be a number, but is 'x'",
        ),
        (&["1", "barycentric", "1,1,1,2,2,2,3,3,3,0,0,0"], 1, "lie on a line"),
        (&["2", "0", "0", "1.5", "2"], 1, "command line:1:5: x of the end is to be a whole number"),
        (&["3", "2", "0", "0"], 1, "command line:1:1: the number of vertices"),
        (&["3", "5", "0,0,0,10,10,10,10,0,5,5"], 1, "not convex"),
        (&["4", "samples/lab/polygon.txt"], 1, "samples/lab/polygon.txt"),
        (&["5", "--eye", "0,0,0"], 1, "looks nowhere"),
        (&["5", "--method", "rotations", "--eye", "0,0,5"], 1, "along the z axis"),
        (&["6", "1", "2"], 1, "command line:1:4: the text ends, but z of control point 0 is to come"),
        (&["8", "100", "16", "1", "0"], 1, "command line:1:10: umax is 0, but must be greater than umin, 1"),
        (&["8", "--center", "0,1", "--width", "1e-99999"], 2, "out of range"),
        (&["8", "--center", "0", "--width", "1"], 2, "two numbers RE,IM"),
        (&["1", "vectors", "1", "2"], 2, "takes no numbers"),
        (&["9"], 2, "'9'"),
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {}", told(&output));
        assert!(told(&output).contains(part), "{arguments:?}: {}", told(&output));
    }
}
