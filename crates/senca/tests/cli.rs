//! The command as its users script it: exit statuses, messages, figures, files.

mod common;

use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use common::{run_in, sample, senca_in, told};
use serde_json::Value;

const CUBE_OBJ: &str = "\
o cube
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1
v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
";

/// A new folder with a cube in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("cube.obj"), CUBE_OBJ).expect("a file");
    folder
}

/// Names of the files in `folder`, sorted.
fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[track_caller]
fn assert_exit(output: &Output, status: i32, part: &str) {
    let message = told(output);
    assert_eq!(output.status.code(), Some(status), "{message}");
    assert!(message.contains(part), "\"{part}\" is not in: {message}");
}

fn size_of_png(bytes: &[u8]) -> (u32, u32) {
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20))
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(bytes)))
}

#[test]
fn a_model_gives_a_picture_named_after_it() {
    let folder = folder();
    let done = run_in(folder.path(), &["render", "cube.obj", "--size", "60x40"]);
    assert_exit(&done, 0, "");
    let png = std::fs::read(folder.path().join("cube.png")).expect("a picture");
    assert_eq!(size_of_png(&png), (60, 40));
    assert!(done.stdout.is_empty() && done.stderr.is_empty(), "{}", told(&done));
}

#[test]
fn every_picture_format_is_written_and_told_by_its_extension() {
    let folder = folder();
    for (name, start) in [
        ("a.png", &b"\x89PNG"[..]),
        ("a.exr", b"\x76\x2f\x31\x01"),
        ("a.pfm", b"PF\n"),
        ("a.ppm", b"P6\n"),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.BMP", b"BM"),
    ] {
        let done = run_in(folder.path(), &["render", "cube.obj", "-o", name, "--size", "16x9"]);
        assert_exit(&done, 0, "");
        let bytes = std::fs::read(folder.path().join(name)).expect("a picture");
        assert!(bytes.starts_with(start), "{name} begins with {:?}", &bytes[..8]);
    }
}

#[test]
fn line_drawings_are_written_as_svg_and_others_are_not() {
    let folder = folder();
    for shading in ["wire", "hidden-line"] {
        let arguments = ["render", "cube.obj", "-o", "a.svg", "--shading", shading];
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        let text = std::fs::read_to_string(folder.path().join("a.svg")).expect("a drawing");
        assert!(text.contains("<svg") && text.trim_end().ends_with("</svg>"), "{text}");
    }
    let done = run_in(folder.path(), &["render", "cube.obj", "-o", "b.svg", "--shading", "phong"]);
    assert_exit(&done, 2, "svg");
    assert_eq!(files_in(folder.path()), ["a.svg", "cube.obj"]);
}

#[test]
fn bad_usage_exits_with_2_and_says_what_would_be_right() {
    let folder = folder();
    for (arguments, part) in [
        (&["render"][..], "SCENE"),
        (&["render", "cube.obj", "--size", "0x5"], "width is 0"),
        (&["render", "cube.obj", "--size", "5"], "WxH"),
        (&["render", "cube.obj", "--size", "100000x5"], "at most"),
        (&["render", "cube.obj", "--max-depth", "3"], "--max-depth belongs to"),
        (&["render", "cube.obj", "--method", "trace", "--shading", "wire"], "rays are shaded by"),
        (&["render", "cube.obj", "--method", "trace", "--raster", "scanline"], "--raster belongs to"),
        (&["render", "cube.obj", "--method", "trace", "-o", "cube.svg"], "svg holds line drawings"),
        (&["render", "cube.obj", "--method", "path", "--no-shadows"], "--no-shadows belongs to"),
        (&["render", "cube.obj", "--method", "trace", "--accel", "kd"], "there is no accelerator"),
        (&["render", "cube.obj", "--method", "trace", "--aa", "super", "--samples", "5"], "n x n samples"),
        (&["render", "cube.obj", "--method", "trace", "--filter", "sinc"], "there is no filter"),
        (&["render", "cube.obj", "--aa", "adaptive"], "--method trace"),
        (&["render", "cube.obj", "--method", "trace", "--pixel", "3,4"], "--explain"),
        (&["render", "cube.obj", "--method", "trace", "--pixel", "3,4", "--explain", "x.png"], ".svg"),
        (&["render", "cube.obj", "--method", "hope"], "the methods are"),
        (&["render", "cube.obj", "--method", "trace", "--show", "mesh"], "--method radiosity"),
        (&["render", "cube.obj", "--method", "radiosity", "--form-factors", "hemicube"], "gauss-seidel"),
        (&["render", "cube.obj", "--shading", "pink"], "gouraud"),
        (&["render", "cube.obj", "-o", "a.gif"], "png"),
        (&["render", "cube.obj", "-o", "a"], "png"),
        (&["render", "cube.obj", "--crop", "0,0,2000,10"], "1024"),
        (&["render", "cube.obj", "--samples", "0"], "1..="),
        (&["render", "cube.obj", "--threads", "0"], "1..="),
        (&["render", "cube.obj", "--eye", "1,2"], "X,Y,Z"),
        (&["render", "cube.obj", "--fov", "180"], "between 0 and 180"),
        (&["render", "cube.obj", "--aa", "none", "--samples", "4"], "--aa none"),
        (&["convert", "cube.obj", "a.xyz"], "obj"),
        (&["bench", "nonsense"], "fill"),
        (&["paint"], "unrecognized subcommand"),
    ] {
        assert_exit(&run_in(folder.path(), arguments), 2, part);
    }
    assert_eq!(files_in(folder.path()), ["cube.obj"]);
}

#[test]
fn help_lists_only_what_is_built_in() {
    let folder = folder();
    let help = run_in(folder.path(), &["render", "--help"]);
    let text = String::from_utf8_lossy(&help.stdout).into_owned();
    assert!(text.contains("hidden-line") && text.contains("--crop"));
    assert!(text.contains("trace") && text.contains("--accel"));
    assert!(text.contains("radiosity") && text.contains("--display"));
}

#[test]
fn bad_input_exits_with_1_and_leaves_no_file() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("a file");
    write("empty.obj", b"");
    write("noise.bin", &[0xfe, 0x01, 0x00, 0x80, 0x7f, 0x33, 0x10, 0x00]);
    write("cut.glb", b"glTF\x02\x00\x00\x00\xff\xff\x00\x00");
    write("cut.stl", &[&[0u8; 80][..], &[255, 255, 255, 255, 1, 2]].concat());
    write("cut.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n");
    write("range.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    std::fs::create_dir(folder.path().join("folder.obj")).expect("a folder");
    for (name, part) in [
        ("missing.obj", "missing.obj"),
        ("empty.obj", "empty"),
        ("folder.obj", "folder"),
        ("noise.bin", "noise.bin"),
        ("cut.glb", "cut.glb"),
        ("cut.stl", "cut.stl"),
        ("cut.ply", "cut.ply:"),
    ] {
        let done = run_in(folder.path(), &["render", name, "-o", "out.png", "--size", "8x8"]);
        assert_exit(&done, 1, part);
        let message = told(&done);
        assert!(message.starts_with("senca: ") && message.trim_end().lines().count() == 1, "{message}");
    }
    assert!(!folder.path().join("out.png").exists());
}

#[test]
fn mistakes_in_scenes_are_told_with_line_and_column() {
    let folder = folder();
    std::fs::write(folder.path().join("a.toml"), "[[node]]\nname = \"n\"\ncolour = 3\n").expect("a file");
    let done = run_in(folder.path(), &["render", "a.toml", "--size", "8x8"]);
    assert_exit(&done, 1, "senca: a.toml:");
    let place: Vec<_> = told(&done).split(':').skip(2).take(2).map(str::to_owned).collect();
    assert!(place.iter().all(|n| n.parse::<u32>().is_ok_and(|n| n > 0)), "{}", told(&done));
}

#[test]
fn places_that_cannot_be_written_are_found_before_drawing() {
    let folder = folder();
    for out in ["no/such/a.png", "cube.obj/a.png"] {
        // The scene is missing too, but the place is looked at first.
        let done = run_in(folder.path(), &["render", "missing.obj", "-o", out]);
        assert_exit(&done, 1, "there is no folder");
    }
    std::fs::create_dir(folder.path().join("a.png")).expect("a folder");
    assert_exit(&run_in(folder.path(), &["render", "cube.obj", "-o", "a.png"]), 1, "is a folder");
    let stats = ["render", "cube.obj", "--stats", "no/such/a.json"];
    assert_exit(&run_in(folder.path(), &stats), 1, "there is no folder");
    #[cfg(target_os = "linux")]
    assert_exit(&run_in(folder.path(), &["render", "cube.obj", "-o", "/proc/a.png"]), 1, "cannot write");
}

#[test]
fn the_smallest_picture_has_one_pixel() {
    let folder = folder();
    for raster in ["tiled", "scanline"] {
        let arguments = ["render", "cube.obj", "-o", "a.png", "--size", "1x1", "--raster", raster];
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        let png = std::fs::read(folder.path().join("a.png")).expect("a picture");
        assert_eq!(size_of_png(&png), (1, 1));
    }
}

#[test]
fn an_unknown_camera_or_animation_is_told_with_those_there_are() {
    let folder = folder();
    let gltf = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
        "nodes":[{"camera":0,"translation":[0,0,5]},{"camera":1}],
        "cameras":[{"name":"Front","type":"perspective","perspective":{"yfov":0.7,"znear":0.1}},
                   {"name":"Top","type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}]}"#;
    std::fs::write(folder.path().join("a.gltf"), gltf).expect("a file");
    let done = run_in(folder.path(), &["render", "a.gltf", "--camera", "Side"]);
    assert_exit(&done, 2, "Side");
    assert!(told(&done).contains("Front") && told(&done).contains("Top"), "{}", told(&done));
    let done = run_in(folder.path(), &["render", "cube.obj", "--camera", "Side"]);
    assert_exit(&done, 2, "no camera");
    let done = run_in(folder.path(), &["render", "cube.obj", "--time", "1", "--animation", "walk"]);
    assert_exit(&done, 2, "no animation");
}

#[test]
fn standard_input_and_output_are_dashes() {
    let folder = folder();
    let mut command = senca_in(folder.path(), &["render", "-", "-o", "-", "--size", "20x10"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    child.stdin.take().expect("a pipe").write_all(CUBE_OBJ.as_bytes()).expect("the command reads");
    let done = child.wait_with_output().expect("the command ends");
    assert_exit(&done, 0, "");
    assert_eq!(size_of_png(&done.stdout), (20, 10));
    assert_eq!(files_in(folder.path()), ["cube.obj"]);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = folder();
    let mut command = senca_in(folder.path(), &["render", "cube.obj", "-o", "-", "--size", "900x900"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    drop(child.stdout.take());
    let done = child.wait_with_output().expect("the command ends");
    assert_exit(&done, 0, "");
    assert_eq!(told(&done), "");
}

#[test]
fn figures_have_the_documented_keys() {
    let folder = folder();
    let arguments = ["render", "cube.obj", "--size", "40x30", "--stats", "s.json", "--threads", "1"];
    assert_exit(&run_in(folder.path(), &arguments), 0, "");
    let stats = json(&std::fs::read(folder.path().join("s.json")).expect("figures"));
    let seconds = &stats["seconds"];
    let of = |key: &str| seconds[key].as_f64().unwrap_or_else(|| panic!("seconds.{key} in {stats}"));
    let sum: f64 = ["load", "prepare", "render", "write"].map(of).iter().sum();
    assert!(of("total") >= 0.999 * sum && ["load", "render"].map(of).iter().all(|&s| s >= 0.0), "{stats}");
    assert_eq!(stats["threads"], 1);
    assert_eq!(stats["size"], serde_json::json!([40, 30]));
    assert_eq!(stats["triangles"]["in"], 12);
    for key in ["culled", "clipped", "drawn"] {
        assert!(stats["triangles"][key].is_u64(), "{stats}");
    }
    #[cfg(target_os = "linux")]
    assert!(stats["peak_bytes"].as_u64().is_some_and(|b| b > 100_000), "{stats}");
}

#[test]
fn the_picture_does_not_depend_on_threads() {
    let folder = folder();
    let render = |threads: &str, name: &str| {
        let arguments = ["render", "cube.obj", "-o", name, "--size", "333x217", "--threads", threads];
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        std::fs::read(folder.path().join(name)).expect("a picture")
    };
    let one = render("1", "one.png");
    assert!(["2", "3", "8"].iter().all(|threads| render(threads, "many.png") == one));
    let exact = render("1", "one.exr");
    assert!(["2", "5"].iter().all(|threads| render(threads, "many.exr") == exact));
}

#[test]
fn depth_and_numbers_are_written_as_they_are_or_in_false_colours() {
    let folder = folder();
    let eye = ["render", "cube.obj", "--size", "9x9", "--eye", "0,0,5"];
    let middle = |channel: &str| {
        let done = run_in(folder.path(), &[&eye[..], &["-o", "c.pfm", "--channel", channel]].concat());
        assert_exit(&done, 0, "");
        let bytes = std::fs::read(folder.path().join("c.pfm")).expect("a picture");
        let rows = &bytes[bytes.len() - 9 * 9 * 12..];
        let at = (4 * 9 + 4) * 12;
        std::array::from_fn(|k| f32::from_le_bytes(rows[at + 4 * k..][..4].try_into().expect("four bytes")))
    };
    assert_eq!(middle("objects"), [1.0; 3]);
    assert_eq!(middle("normals"), [0.0, 0.0, 1.0]);
    assert!(middle("depth").iter().all(|d| (d - 4.0f32).abs() < 1e-4));
    assert!((1.0..=12.0).contains(&middle("triangles")[0]));

    let with = |more: &[&str]| run_in(folder.path(), &[&eye[..], &["--channel", "depth"], more].concat());
    assert_exit(&with(&["-o", "c.png"]), 0, "");
    assert_exit(&with(&["-o", "c.svg"]), 2, "svg holds line drawings only");
    assert_exit(&with(&["--samples", "4"]), 2, "one sample a pixel");
    assert_exit(&with(&["--method", "trace"]), 2, "belongs to the method raster");
    assert_exit(&with(&["--shading", "wire"]), 2, "nothing but color");
}

#[test]
fn an_eye_may_look_straight_down() {
    let folder = folder();
    for eye in ["0,6,0", "0,-6,0"] {
        let done = run_in(folder.path(), &["render", "cube.obj", "--size", "9x9", "--eye", eye]);
        assert_exit(&done, 0, "");
        assert!(done.stderr.is_empty(), "{}", told(&done));
    }
    let up = run_in(folder.path(), &["render", "cube.obj", "--eye", "0,6,0", "--up", "0,1,0"]);
    assert_exit(&up, 1, "parallel");
}

#[test]
fn a_picture_of_nothing_is_told() {
    let folder = folder();
    let away = run_in(
        folder.path(),
        &["render", "cube.obj", "--size", "9x9", "--eye", "0,0,5", "--target", "0,0,9"],
    );
    assert_exit(&away, 0, "nothing of the scene is in the picture");
    std::fs::write(folder.path().join("blank.glb"), " \n").expect("a file");
    assert_exit(&run_in(folder.path(), &["render", "blank.glb"]), 1, "blank.glb: is empty; readable are");
}

#[test]
fn a_cut_out_is_that_part_of_the_whole_picture() {
    let folder = folder();
    let render = |more: &[&str], name: &str| {
        let arguments = [&["render", "cube.obj", "--size", "80x60", "-o", name][..], more].concat();
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        std::fs::read(folder.path().join(name)).expect("a picture")
    };
    let whole = render(&[], "whole.pfm");
    let part = render(&["--crop", "30,20,25,13"], "part.pfm");
    let (whole, part) = (&whole[whole.len() - 80 * 60 * 12..], &part[part.len() - 25 * 13 * 12..]);
    // Rows of a PFM run from the bottom.
    for row in 0..13 {
        let whole_row = 60 - 1 - (20 + 12 - row);
        let expected = &whole[(whole_row * 80 + 30) * 12..][..25 * 12];
        assert_eq!(&part[row * 25 * 12..][..25 * 12], expected, "row {row} from the bottom");
    }
}

#[test]
fn info_tells_what_is_there() {
    let folder = folder();
    let done = run_in(folder.path(), &["info", "cube.obj", "--json"]);
    assert_exit(&done, 0, "");
    let info = json(&done.stdout);
    for (key, value) in [("meshes", 1), ("instances", 1), ("triangles", 12), ("vertices", 8)] {
        assert_eq!(info[key], value, "{key} in {info}");
    }
    assert_eq!(info["bounds"], serde_json::json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]));
    assert_eq!(info["cameras"], serde_json::json!([]));
    assert_eq!(info["closed"], true);
    for key in ["materials", "textures", "lights", "animations", "warnings"] {
        assert!(!info[key].is_null(), "{key} in {info}");
    }
    let done = run_in(folder.path(), &["info", "cube.obj"]);
    assert!(String::from_utf8_lossy(&done.stdout).contains("triangles"), "{done:?}");
    assert_exit(&run_in(folder.path(), &["info", "missing.obj"]), 1, "missing.obj");
}

#[test]
fn models_survive_conversion_between_all_formats() {
    let folder = folder();
    for name in ["a.obj", "a.stl", "a.ply", "a.glb", "a.dat"] {
        assert_exit(&run_in(folder.path(), &["convert", "cube.obj", name]), 0, "");
        for back in ["b.obj", "b.stl", "b.ply", "b.glb"] {
            assert_exit(&run_in(folder.path(), &["convert", name, back]), 0, "");
            let info = json(&run_in(folder.path(), &["info", back, "--json"]).stdout);
            assert_eq!(info["triangles"], 12, "{name} to {back}: {info}");
            assert_eq!(info["bounds"], serde_json::json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]));
        }
    }
}

#[test]
fn the_patch_of_1991_becomes_the_polygons_of_1991() {
    let folder = folder();
    let patch = sample("classic/patch.bez").display().to_string();
    let arguments = ["convert", &patch, "out.dat", "--steps", "4,4", "--epsilon", "0.05"];
    assert_exit(&run_in(folder.path(), &arguments), 0, "");
    let numbers = |path: &Path| -> Vec<f64> {
        let text = std::fs::read_to_string(path).expect("a text");
        text.split_whitespace().map(|w| w.parse().expect("a number")).collect()
    };
    assert_eq!(numbers(&folder.path().join("out.dat")), numbers(&sample("classic/patch.dat")));
    let teapot = sample("classic/teapot.bez").display().to_string();
    for (steps, more, header) in
        [("4", &[][..], "529 512 5"), ("4", &["--as-printed"], "530 512 5"), ("8", &[], "2081 2048 5")]
    {
        let arguments = [&["convert", &teapot, "t.dat", "--steps", steps], more].concat();
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        let text = std::fs::read_to_string(folder.path().join("t.dat")).expect("a text");
        assert_eq!(text.lines().next(), Some(header), "{steps} {more:?}");
    }
}

#[test]
fn patches_stay_patches_in_a_patch_file() {
    let folder = folder();
    let teapot = sample("classic/teapot.bez").display().to_string();
    assert_exit(&run_in(folder.path(), &["convert", &teapot, "a.bez"]), 0, "");
    assert_exit(&run_in(folder.path(), &["convert", "a.bez", "b.bez"]), 0, "");
    let [a, b] =
        ["a.bez", "b.bez"].map(|name| std::fs::read_to_string(folder.path().join(name)).expect("text"));
    assert!(a.starts_with("290 32 5\n") && a == b);
    assert_exit(&run_in(folder.path(), &["convert", "cube.obj", "c.bez"]), 2, "Bézier patches only");
}

#[test]
fn pictures_are_converted_too() {
    let folder = folder();
    assert_exit(&run_in(folder.path(), &["render", "cube.obj", "--size", "9x7"]), 0, "");
    assert_exit(&run_in(folder.path(), &["convert", "cube.png", "cube.bmp"]), 0, "");
    assert!(std::fs::read(folder.path().join("cube.bmp")).expect("a picture").starts_with(b"BM"));
    assert_exit(&run_in(folder.path(), &["convert", "cube.obj", "other.png"]), 1, "senca render");
    assert_exit(&run_in(folder.path(), &["render", "cube.png", "-o", "a.png"]), 1, "is a picture");
}

#[test]
fn view_matrices_are_those_of_the_book() {
    let folder = folder();
    let view = sample("views/b.view").display().to_string();
    let done = run_in(folder.path(), &["view-matrix", &view, "--json"]);
    assert_exit(&done, 0, "");
    let matrices = json(&done.stdout);
    let names: Vec<_> = matrices.as_object().expect("an object").keys().cloned().collect();
    assert_eq!(names, ["T", "T1", "T2", "T3", "T4", "T5", "T6"]);
    let expected = [
        [0.5, 0.0, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0],
        [0.0, 0.0, 1.0 / 6.0, -0.1],
        [0.0, 0.0, -1.0 / 6.0, 0.5],
    ];
    for (row, wanted) in expected.iter().enumerate() {
        for (column, wanted) in wanted.iter().enumerate() {
            let found = matrices["T"][row][column].as_f64().expect("a number");
            assert!((found - wanted).abs() < 1e-12, "{row}, {column}: {found}");
        }
    }
    let done = run_in(folder.path(), &["view-matrix", &view]);
    assert!(String::from_utf8_lossy(&done.stdout).contains("0.166667"), "{done:?}");
    std::fs::write(folder.path().join("bad.view"), "view = B\nVRP = 0 0\n").expect("a file");
    assert_exit(&run_in(folder.path(), &["view-matrix", "bad.view"]), 1, "senca: bad.view:2:");
}

#[test]
fn pictures_may_be_very_wide_or_high() {
    let folder = folder();
    for (size, expected) in [("16384x1", (16384, 1)), ("1x16384", (1, 16384)), ("65404x2", (65404, 2))] {
        let arguments = ["render", "cube.obj", "-o", "a.png", "--size", size];
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        assert_eq!(size_of_png(&std::fs::read(folder.path().join("a.png")).expect("a picture")), expected);
    }
}

#[test]
fn the_scenes_own_wishes_hold_unless_options_say_otherwise() {
    let folder = folder();
    let teapot = sample("teapot.toml").display().to_string();
    let size = |more: &[&str]| {
        let arguments = [&["render", &teapot, "-o", "a.png"], more].concat();
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        size_of_png(&std::fs::read(folder.path().join("a.png")).expect("a picture"))
    };
    assert_eq!(size(&[]), (800, 600));
    assert_eq!(size(&["--size", "30x20"]), (30, 20));
}

#[test]
fn time_moves_what_is_animated() {
    let folder = folder();
    let scene = sample("animation.toml").display().to_string();
    let at = |time: &str| {
        let arguments = ["render", &scene, "-o", "a.ppm", "--size", "48x36", "--time", time];
        assert_exit(&run_in(folder.path(), &arguments), 0, "");
        std::fs::read(folder.path().join("a.ppm")).expect("a picture")
    };
    assert_ne!(at("0"), at("1.5"));
    assert_eq!(at("1.5"), at("1.5"));
}

#[test]
fn warnings_are_told_unless_quiet_is_asked_for() {
    let folder = folder();
    let text = format!("mtllib missing.mtl\n{CUBE_OBJ}");
    std::fs::write(folder.path().join("warn.obj"), text).expect("a file");
    let arguments = ["render", "warn.obj", "--size", "8x8"];
    assert_exit(&run_in(folder.path(), &arguments), 0, "senca: warn.obj: warning: ");
    let done = run_in(folder.path(), &[&arguments[..], &["--quiet"]].concat());
    assert_exit(&done, 0, "");
    assert!(done.stderr.is_empty(), "{}", told(&done));
}

#[test]
fn numbers_that_are_none_give_a_picture_or_an_error_and_never_a_fault() {
    let folder = folder();
    for (i, points) in ["v nan 0 0", "v inf 0 0", "v 1e38 0 0", "v -1e-40 0 0", "v 0 0 0"].iter().enumerate()
    {
        let name = format!("odd{i}.obj");
        let text = format!("{points}\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 1\n");
        std::fs::write(folder.path().join(&name), text).expect("a file");
        for shading in ["material", "gouraud", "wire-normals", "hidden-line"] {
            let arguments = ["render", &name, "-o", "a.png", "--size", "20x20", "--shading", shading];
            let done = run_in(folder.path(), &arguments);
            assert!(matches!(done.status.code(), Some(0 | 1)), "{name} {shading}: {}", told(&done));
        }
    }
}

#[test]
fn benchmarks_print_a_table() {
    let folder = folder();
    let done = run_in(folder.path(), &["bench", "fill", "--seconds", "0.001"]);
    assert_exit(&done, 0, "");
    assert!(String::from_utf8_lossy(&done.stdout).contains("fill"), "{done:?}");
}

#[test]
fn accelerators_are_compared_in_a_table() {
    let folder = folder();
    let done = run_in(folder.path(), &["bench", "accel", "--objects", "10,20"]);
    assert_exit(&done, 0, "");
    let table = String::from_utf8_lossy(&done.stdout).into_owned();
    let rows = |name: &str| table.lines().filter(|line| line.split_whitespace().nth(1) == Some(name)).count();
    for name in ["none", "spheres", "bounds", "hierarchy", "grid", "octree", "sah", "bvh"] {
        assert_eq!(rows(name), 2, "{name} in {table}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_long_drawing_and_leaves_nothing() {
    let folder = folder();
    let arguments = ["render", "cube.obj", "-o", "big.png", "--size", "12000x12000", "--samples", "64"];
    let mut command = senca_in(folder.path(), &arguments);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().expect("the command starts");
    std::thread::sleep(std::time::Duration::from_millis(700));
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.expect("kill runs").success(), "the drawing was over too soon");
    let done = child.wait_with_output().expect("the command ends");
    assert_exit(&done, 130, "");
    assert_eq!(files_in(folder.path()), ["cube.obj"]);
}
