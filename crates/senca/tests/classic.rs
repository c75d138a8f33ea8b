//! The books' programs on the command line: numbers, files, and what is told of bad input.

mod common;

use std::path::Path;
use std::process::{Command, Output, Stdio};

use common::{copy_folder, repository, senca_folder};

/// A folder with the samples of 1991.
fn folder() -> tempfile::TempDir {
    let copy = tempfile::tempdir().expect("a temporary folder");
    copy_folder(&repository().join("samples/classic"), copy.path());
    copy
}

/// Runs `senca classic` with these words, and this on standard input.
fn classic(folder: &Path, words: &str, input: &str) -> Output {
    use std::io::Write;
    let mut command = Command::new(senca_folder().join("senca"));
    command.arg("classic").args(words.split_whitespace()).current_dir(folder);
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().expect("the command");
    // A command that ends early does not read what it is told.
    drop(child.stdin.take().expect("an input").write_all(input.as_bytes()));
    child.wait_with_output().expect("an end")
}

fn json(folder: &Path, words: &str) -> serde_json::Value {
    let output = classic(folder, words, "");
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn the_house_fills_its_picture_with_one_index() {
    let folder = folder();
    for more in ["", "--as-printed", "--operation gouraud", "--build tables --bits 16"] {
        let report = json(folder.path(), &format!("render --json {more}"));
        assert_eq!(report["pixels_of_index"][10], 22_500, "{more}");
        assert_eq!((&report["width"], &report["height"]), (&150.into(), &150.into()));
    }
    let report = json(folder.path(), "render --json");
    assert_eq!((&report["vertices"], &report["polygons"]), (&546.into(), &525.into()));
    assert_eq!(report["bitmap_bytes"], 90_008);
    // Four bits a pixel, eleven on the line for a byte.
    let seconds = report["transfer_seconds"].as_f64().expect("a number");
    assert!((seconds - 22_500.0 / 2.0 * 11.0 / 19_200.0).abs() < 1e-9);
}

#[test]
fn the_bitmap_has_the_name_of_the_scene_file() {
    let folder = folder();
    let output = classic(folder.path(), "render", "");
    assert!(output.status.success(), "{output:?}");
    assert_eq!(std::fs::metadata(folder.path().join("phong.btm")).expect("a bitmap").len(), 90_008);
    let output = classic(folder.path(), "render --bits 16 --bitmap small.btm", "");
    assert!(output.status.success(), "{output:?}");
    assert_eq!(std::fs::metadata(folder.path().join("small.btm")).expect("a bitmap").len(), 45_004);
    let scene = std::fs::read_to_string(folder.path().join("scene1.dat")).expect("a scene");
    let outside = scene.replace("phong.btm", "../phong.btm");
    std::fs::write(folder.path().join("outside.dat"), outside).expect("writes");
    let output = classic(folder.path(), "render outside.dat", "");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("is in another folder; give --bitmap"));
}

#[test]
fn saved_scenes_give_the_same_picture() {
    let folder = folder();
    for words in [
        "render teapot1.dat --save saved",
        "render teapot1.dat --bitmap a.btm",
        "render saved/scene1.dat --bitmap b.btm",
    ] {
        assert!(classic(folder.path(), words, "").status.success(), "{words}");
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a bitmap");
    assert!(read("a.btm") == read("b.btm"));
    let dump = classic(folder.path(), "render saved/scene1.dat --dump", "");
    let text = String::from_utf8_lossy(&dump.stdout).into_owned();
    assert!(text.starts_with("object 0 object0.dat: 529 vertices, 512 polygons, 5 surfaces,"), "{text}");
}

#[test]
fn ranges_of_indices_have_profiles_of_their_own() {
    let folder = folder();
    let run = |words: &str| {
        let output = classic(folder.path(), words, "");
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    };
    let profiles = "--colors 127 --profile green.lut --profile clay.lut";
    run(&format!("render patches.dat --ranges objects {profiles} -o direct.png"));
    run("render patches.dat --ranges objects --colors 127 --bitmap two.btm");
    run(&format!("lut two.btm {profiles} -o painted.png"));
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    assert_eq!(bytes("direct.png"), bytes("painted.png"));
    for (words, part) in [
        ("render house.dat --ranges surfaces", "house.dat:"),
        ("render patches.dat --ranges objects --colors 4 --json", "4 colours are too few for 2 ranges"),
        ("lut two.btm --profile green.lut --profile clay.lut", "the editor has one profile"),
        ("render patches.dat --highlight 2 --json", "a cosine lies between -1 and 1"),
        ("render patches.dat --highlight nan --json", "a cosine lies between -1 and 1"),
    ] {
        let output = classic(folder.path(), words, "");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && told.contains(part), "{words}: {told}");
    }
}

#[test]
fn bad_input_is_told_with_its_place() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.lut"), "node 0 0 0 0\nnode 0 0 2 1\n").expect("writes");
    std::fs::write(folder.path().join("bad.txt"), "1 2 3 4\n1 2 x 4\n").expect("writes");
    for (words, status, message) in [
        ("render house.dat", 1, "house.dat:1:1: expected the projection type"),
        ("render no.dat", 1, "no.dat: "),
        ("render --screen 640x100 --json", 1, "scene1.dat:8:1: cannot get the desired screen resolution"),
        ("render --palette ega --colors 64 -o a.png", 2, "64 colours: this is not EGA or VGA"),
        ("render --colors 1 -o a.png", 2, "1 is not in"),
        ("render teapot3.dat --operation phong -o a.png", 2, "gives no light for faces"),
        ("render teapot3.dat", 2, "names no bitmap; give --output or --bitmap"),
        ("lut house.dat -o a.png", 1, "is no bitmap of colour indices"),
        ("lut --profile bad.lut -o a.png", 1, "bad.lut:2:10: expected B, a number from 0 to 1, found \"2\""),
        ("polygon bad.txt --json", 1, "bad.txt:2:5: expected z"),
        ("bezcnv house.dat a.dat", 1, "house.dat:19:5: a bicubic patch has 16 control points, not 5"),
        ("bezcnv patch.bez a.dat --steps 0,4", 2, "--steps"),
    ] {
        let output = classic(folder.path(), words, "");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{words}: {told}");
        assert!(told.contains(message), "{words}: {told}");
    }
}

#[test]
fn the_converter_asks_its_questions() {
    let folder = folder();
    let output = classic(folder.path(), "bezcnv", "patch.bez\n4\n4\n0.05\nmesh.dat\n");
    assert!(output.status.success(), "{output:?}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a text");
    assert_eq!(read("mesh.dat"), read("patch.dat"));
    assert!(
        String::from_utf8_lossy(&output.stdout)
            .starts_with("Source file [teapot.bez]: Number of steps in u [4]: ")
    );
    let counts = json(folder.path(), "bezcnv teapot.bez t.dat --as-printed --search backward --json");
    assert_eq!((&counts["vertices"], &counts["polygons"]), (&530.into(), &512.into()));
    assert_eq!(counts["polygons_of_surface"], serde_json::json!([192, 64, 64, 128, 64]));
}

#[test]
fn the_editor_recolours_on_the_terminal() {
    let folder = folder();
    assert!(classic(folder.path(), "render --bitmap a.btm", "").status.success());
    let output = classic(folder.path(), "lut a.btm", "r\nw\ngreen.txt\ns\na.png\nx\nr\n");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.starts_with("Number of colours: 16\nNodes: 2\n"), "{text}");
    let profile = std::fs::read_to_string(folder.path().join("green.txt")).expect("a profile");
    assert_eq!(profile, "background 1 1 1\nnode 0 0.1 0 0\nnode 0 1 0 1\n");
    assert!(folder.path().join("a.png").exists());
    let table = json(folder.path(), "lut --profile green.txt --json");
    assert_eq!(table["lut"][8][1], 0.55);
    assert_eq!(classic(folder.path(), "lut a.btm", "b\n").status.code(), Some(0), "an input that ends");
}

#[test]
fn polygons_are_counted_and_saved() {
    let folder = folder();
    let triangle = "5 0 10 250\n10 8 90 50\n0 5 40 150\n";
    std::fs::write(folder.path().join("t.txt"), triangle).expect("writes");
    let report = json(folder.path(), "polygon t.txt --slip lost-units --json");
    assert_eq!(
        (&report["pixels"], &report["sum_b"], &report["sum_z"]),
        (&39.into(), &5903.into(), &1774.into())
    );
    assert_eq!(report["polygons"][0]["rows"][5]["right"], serde_json::json!([8, 5, 59, 126]));
    let report = json(folder.path(), "polygon t.txt --as-printed --json");
    assert_eq!((&report["pixels"], &report["sum_b"]), (&39.into(), &0.into()));
    let words = "polygon --script polygon.script --size 240x210 -o s.png --save s.txt";
    assert!(classic(folder.path(), words, "").status.success());
    let saved = std::fs::read_to_string(folder.path().join("s.txt")).expect("polygons");
    assert!(saved.starts_with("40 30 100 255\n200 60 100 85\n90 190 100 28\n\n120 20 90 141\n"), "{saved}");
}

#[test]
fn the_flight_has_the_errors_of_the_document() {
    let output = classic(folder().path(), "game --script game-flight.keys --measure", "");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let measured = String::from_utf8(output.stdout).expect("a text");
    let document = std::fs::read_to_string(repository().join("docs/classic-game.md")).expect("a document");
    assert!(
        measured.lines().count() > 30 && document.contains(&measured),
        "not as in the document:\n{measured}"
    );
}
