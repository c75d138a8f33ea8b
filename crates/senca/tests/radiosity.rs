//! Light by the command: computed, saved, shown, baked, measured.

mod common;

use std::path::Path;
use std::process::{Command, Stdio};

use common::{run_in, sample, senca_in, told};
use senca::io::Limits;
use senca::io::images::decode_picture;

/// A room of one box with a lamp in it, and a block.
const ROOM: &str = r#"
[camera]
eye = [0, 0, 2.9]
target = [0, 0, 0]
fov = 50

[[light]]
kind = "point"
position = [0, 1.5, 0]
color = [1, 1, 1]
attenuation = "inverse-square"

[material.wall]
color = [0.7, 0.7, 0.7]
double_sided = true

[[object]]
name = "room"
shape = "box"
size = [6, 4, 6]
material = "wall"

[[object]]
name = "block"
shape = "box"
size = 1
translate = [0, -1.5, 0]
material = "wall"
"#;

/// Options that make light quick and coarse.
const COARSE: [&str; 2] = ["--link-error", "0.01"];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("room.toml"), ROOM).expect("written");
    folder
}

fn run(folder: &Path, command: &str) -> std::process::Output {
    run_in(folder, &command.split_whitespace().collect::<Vec<_>>())
}

fn succeeds(folder: &Path, command: &str) -> String {
    let output = run(folder, command);
    assert!(output.status.success(), "{command}: {}", told(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn light_is_computed_once_and_shown_twice() {
    let folder = folder();
    let folder = folder.path();
    let render = "render room.toml --method radiosity --size 24x24";
    let coarse = COARSE.join(" ");
    succeeds(folder, &format!("{render} {coarse} -o a.pfm --save-solution room.light --stats a.json"));
    let stats = std::fs::read_to_string(folder.join("a.json")).expect("figures");
    let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
    assert!(stats["patches"].as_u64().is_some_and(|n| n > 10), "{stats}");
    assert!(stats["energy_error"].as_f64().is_some_and(|error| error < 1e-3), "{stats}");
    succeeds(folder, &format!("{render} -o b.pfm --solution room.light"));
    let read = |name: &str| std::fs::read(folder.join(name)).expect("a picture");
    assert!(read("a.pfm") == read("b.pfm"), "the same light gives the same picture");
    succeeds(folder, &format!("{render} -o c.png --solution room.light --eye 1,1,2 --show false-color"));
    let picture = decode_picture("c.png", &read("c.png"), &Limits::default()).expect("a picture");
    assert!(picture.width() > 24, "with a scale");
}

#[test]
fn light_of_other_scenes_and_other_files_is_refused() {
    let folder = folder();
    let folder = folder.path();
    let coarse = COARSE.join(" ");
    succeeds(
        folder,
        &format!(
            "render room.toml --method radiosity --size 8x8 {coarse} --save-solution room.light -o a.png"
        ),
    );
    std::fs::write(folder.join("other.toml"), ROOM.replace("size = 1\n", "size = 2\n")).expect("written");
    let refused = run(folder, "render other.toml --method radiosity --solution room.light -o b.png");
    assert_eq!(refused.status.code(), Some(1));
    assert!(told(&refused).contains("room.light: belongs to another scene"), "{}", told(&refused));
    std::fs::write(folder.join("bad.light"), b"SENCALIT and nothing else").expect("written");
    let refused = run(folder, "render room.toml --method radiosity --solution bad.light -o b.png");
    assert_eq!(refused.status.code(), Some(1));
    assert!(!folder.join("b.png").exists());
    let usage = run(folder, "render room.toml --method trace --solution room.light -o b.png");
    assert_eq!(usage.status.code(), Some(2), "{}", told(&usage));
}

#[test]
fn baked_models_can_be_read_and_drawn() {
    let folder = folder();
    let folder = folder.path();
    let coarse = COARSE.join(" ");
    succeeds(folder, &format!("bake room.toml -o colors.glb {coarse} --vertex-colors"));
    succeeds(folder, &format!("bake room.toml -o encoded.glb {coarse} --vertex-colors srgb"));
    succeeds(folder, &format!("bake room.toml -o map.glb {coarse} --lightmap 64"));
    let bright = run(folder, &format!("bake room.toml -o auto.glb {coarse} --exposure 6"));
    assert!(bright.status.success() && told(&bright).contains("brighter than white"), "{}", told(&bright));
    let light = format!("bake room.toml -o lit.glb {coarse} --lightmap 64 --light-picture");
    let told_scale = told(&run(folder, &format!("{light} light.png --light-scale 0.25")));
    assert!(told_scale.contains("light.png: 8 bits, sRGB of light / 0.25"), "{told_scale}");
    assert!(told_scale.contains("is cut off"), "{told_scale}");
    let told_whole = told(&run(folder, &format!("{light} light.png")));
    assert!(told_whole.contains("sRGB of light / ") && !told_whole.contains("up to"), "{told_whole}");
    succeeds(folder, &format!("{light} light.exr"));
    let refused = run(folder, &format!("{light} light.txt"));
    assert_eq!(refused.status.code(), Some(2), "{}", told(&refused));
    for name in ["colors.glb", "encoded.glb", "map.glb", "auto.glb", "lit.glb"] {
        let info = succeeds(folder, &format!("info {name} --json"));
        let info: serde_json::Value = serde_json::from_str(&info).expect("JSON");
        assert!(info["triangles"].as_u64().is_some_and(|n| n >= 24), "{name}: {info}");
        succeeds(folder, &format!("render {name} --size 16x16 -o {name}.png"));
    }
    let usage = run(folder, "bake room.toml -o room.obj");
    assert_eq!(usage.status.code(), Some(2));
}

/// A lamp of intensity 1 at height 3.5 above the floor: pi lux over the square of the distance below it,
/// and more from the walls.
#[test]
fn lux_is_measured_on_a_plane() {
    let folder = folder();
    let folder = folder.path();
    let coarse = COARSE.join(" ");
    let command =
        format!("lux room.toml {coarse} --height 1.5 --spacing 2 -o plane.csv --picture plane.png --json");
    let summary: serde_json::Value = serde_json::from_str(&succeeds(folder, &command)).expect("JSON");
    let direct = std::f64::consts::PI / 4.0;
    assert_eq!((summary["columns"].as_u64(), summary["rows"].as_u64()), (Some(3), Some(3)));
    let most = summary["most"].as_f64().expect("a number");
    assert!(most > direct && most < 4.0 * direct, "{summary}");
    let csv = std::fs::read_to_string(folder.join("plane.csv")).expect("numbers");
    assert_eq!(csv.lines().count(), 10);
    assert!(folder.join("plane.png").exists());
    let bad = run(folder, "lux room.toml --spacing 0.0000001");
    assert_eq!(bad.status.code(), Some(2), "{}", told(&bad));
}

#[test]
fn lux_leaves_bodies_out_and_measures_on_objects() {
    let folder = folder();
    let folder = folder.path();
    let json = |options: &str| -> serde_json::Value {
        let command = format!("lux room.toml {} --json {options}", COARSE.join(" "));
        serde_json::from_str(&succeeds(folder, &command)).expect("JSON")
    };
    // The place in the middle is in the block.
    let low = json("--height 0.5 --spacing 2 -o low.csv");
    assert_eq!(low["left_out"], 1, "{low}");
    assert!(low["uniformity"].as_f64().is_some_and(|share| share > 0.1), "{low}");
    let csv = std::fs::read_to_string(folder.join("low.csv")).expect("numbers");
    assert_eq!(csv.lines().filter(|line| line.ends_with(',')).count(), 1, "{csv}");
    // The plane of the block's top: all counts, and what is below the lamp is at least its light.
    assert_eq!(json("--height 1 --spacing 2")["left_out"], 0);
    let top = json("--object block --spacing 0.25");
    assert_eq!((&top["columns"], &top["normal"][1], &top["left_out"]), (&4.into(), &1.0.into(), &0.into()));
    let direct = std::f64::consts::PI / (2.5 * 2.5);
    assert!(top["most"].as_f64().is_some_and(|lux| lux > direct && lux < 4.0 * direct), "{top}");
    let side = json("--object block --facing 1,0,0 --spacing 0.5");
    assert!(side["normal"][0] == 1.0 && side["most"].as_f64() < top["least"].as_f64(), "{side}");
    let wall = json("--corner -2.9,-1,-3 --edges 1,0,0 0,1,0 --spacing 0.5");
    assert_eq!((&wall["normal"][2], &wall["rows"]), (&1.0.into(), &2.into()));
    let unknown = run(folder, &format!("lux room.toml {} --object desk", COARSE.join(" ")));
    assert_eq!(unknown.status.code(), Some(2));
    assert!(told(&unknown).contains("\"room\", \"block\""), "{}", told(&unknown));
}

/// Below the middle of a square of 1 at the height 1 the form factor is 0.2394564705 in closed form.
#[test]
fn lux_below_a_square_is_its_closed_form() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = r#"
[material.black]
color = [0, 0, 0]

[material.glow]
color = [0, 0, 0]
emission = [1, 1, 1]

[[object]]
name = "floor"
shape = "polygon"
points = [[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]]
material = "black"

[[object]]
name = "lamp"
shape = "polygon"
points = [[-0.5, 1, -0.5], [0.5, 1, -0.5], [0.5, 1, 0.5], [-0.5, 1, 0.5]]
material = "glow"
"#;
    std::fs::write(folder.path().join("square.toml"), scene).expect("written");
    let text =
        succeeds(folder.path(), "lux square.toml --object floor --spacing 4 --luminance-of-one 100 --json");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let expected = 100.0 * std::f64::consts::PI * 0.239_456_470_5;
    let found = summary["mean"].as_f64().expect("a number");
    assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
}

#[test]
fn the_sample_of_the_cornell_box_can_be_shown_by_radiosity() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cornell = sample("cornell.toml");
    let command = format!(
        "render {} --method radiosity --link-error 0.01 --size 16x16 --samples 1 --tone-map reinhard -o a.png",
        cornell.display()
    );
    succeeds(folder.path(), &command);
}

#[test]
fn shooting_tells_what_is_unsent_and_shows_early_pictures() {
    let folder = folder();
    let folder = folder.path();
    let render = "render room.toml --method radiosity --solver shooting --patch-size 1.5 --size 16x16";
    let stats = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(folder.join(name)).expect("figures");
        serde_json::from_str(&text).expect("JSON")
    };
    succeeds(folder, &format!("{render} -o a.pfm --preview 0.001s --stats a.json"));
    let all = stats("a.json");
    assert_eq!(all["converged"], true, "{all}");
    assert!(all["unsent"].as_f64().is_some_and(|left| left > 0.0 && left <= 1e-4), "{all}");
    let early = run(folder, &format!("{render} --steps 3 -o b.pfm --stats b.json"));
    assert!(early.status.success() && told(&early).contains("after 3 steps"), "{}", told(&early));
    let few = stats("b.json");
    assert!(few["iterations"] == 3 && few["converged"] == false, "{few}");
    assert!(few["unsent"].as_f64().is_some_and(|left| left > 0.1), "{few}");
    let mean = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).expect("a picture");
        let picture = decode_picture(name, &bytes, &Limits::default()).expect("a picture");
        picture.pixels().iter().map(|pixel| pixel[1]).sum::<f32>()
    };
    let ratio = mean("b.pfm") / mean("a.pfm");
    assert!((ratio - 1.0).abs() < 0.2, "the estimate is near: {ratio}");
    succeeds(folder, "lux room.toml --solver shooting --patch-size 1.5 --spacing 3 --time-limit 60s");
    let usage = run(folder, "render room.toml --method radiosity --steps 3");
    assert!(usage.status.code() == Some(2) && told(&usage).contains("--solver shooting"), "{}", told(&usage));
    let usage = run(folder, &format!("{render} --preview 1s -o - --format png"));
    assert_eq!(usage.status.code(), Some(2));
}

/// Ctrl-C keeps the light as far as it has come where it was asked for, by every solver.
#[cfg(unix)]
#[test]
fn interrupted_light_can_be_shown() {
    let folder = folder();
    let folder = folder.path();
    for solver in
        ["hierarchical --link-error 1e-6", "gauss-seidel --patch-size 0.5", "shooting --patch-size 0.1"]
    {
        let command = format!(
            "render room.toml --method radiosity --solver {solver} --size 8x8 -o a.png --preview 1h --save-solution room.light"
        );
        let arguments: Vec<&str> = command.split_whitespace().collect();
        let child = senca_in(folder, &arguments).stderr(Stdio::piped()).spawn().expect("the command starts");
        // There is light when there is an early picture.
        let early = folder.join("a.png");
        for _ in 0..6000 {
            if early.exists() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(killed.expect("kill runs").success(), "{solver}: the light was computed too soon");
        let done = child.wait_with_output().expect("the command ends");
        assert_eq!(done.status.code(), Some(130), "{solver}: {}", told(&done));
        let shown =
            run(folder, "render room.toml --method radiosity --size 8x8 -o b.png --solution room.light");
        assert!(shown.status.success(), "{solver}: {}", told(&shown));
        std::fs::remove_file(folder.join("room.light")).expect("saved");
        std::fs::remove_file(early).expect("an early picture");
    }
}

#[test]
fn darkness_is_told() {
    let folder = folder();
    let without_lamp: Vec<_> = ROOM.split("\n\n").filter(|part| !part.starts_with("[[light]]")).collect();
    // A panel below the room that shines away from it.
    let panel = "[material.lamp]\nemission = [5, 5, 5]\n\n[[object]]\nshape = \"plane\"\nsize = 1\n\
                 material = \"lamp\"\nrotate = [180, 0, 0]\ntranslate = [0, -9, 0]\n";
    let text = format!("{}\n{panel}", without_lamp.join("\n\n"));
    std::fs::write(folder.path().join("away.toml"), text).expect("written");
    let output = run(folder.path(), "render away.toml --method radiosity --size 16x12 -o dark.png");
    assert!(output.status.success() && told(&output).contains("no light arrives"), "{}", told(&output));
}
