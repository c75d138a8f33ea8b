//! The commands that `docs/opengl.md` shows for the example `opengl` work.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The example, which is built now if it is not up to date.
fn example() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let mut build = Command::new(env!("CARGO"));
        // With all of the workspace, so that what the tests of it have built need not be built again for other features.
        build.args(["build", "--quiet", "--workspace", "--lib", "--example", "opengl"]);
        let release = !cfg!(debug_assertions);
        if release {
            build.arg("--release");
        }
        assert!(build.status().unwrap().success(), "the example builds");
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        target.join(if release { "release" } else { "debug" }).join("examples/opengl")
    })
}

/// Arguments of a command of the document; what stands in quotes is one.
fn arguments(command: &str) -> Vec<String> {
    let pieces = command.split('"').enumerate();
    pieces
        .flat_map(|(k, piece)| match k % 2 {
            1 => vec![piece.to_owned()],
            _ => piece.split_whitespace().map(str::to_owned).collect(),
        })
        .collect()
}

#[test]
fn the_documents_commands_draw_pictures() {
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/opengl.md");
    let text = std::fs::read_to_string(document).unwrap();
    let start = "cargo run --release -p senca-gl --example opengl -- ";
    let commands: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(start)).collect();
    assert!(commands.len() >= 3, "{commands:?}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    for command in commands {
        let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let in_repository = |argument: String| match argument.strip_prefix("crates/") {
            Some(_) => repository.join(&argument).display().to_string(),
            None => argument,
        };
        let arguments: Vec<String> = arguments(command).into_iter().map(in_repository).collect();
        let run = Command::new(example()).args(&arguments).current_dir(folder).output().unwrap();
        assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
        let picture = std::fs::read(folder.join(arguments.last().unwrap())).unwrap();
        assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"));
    }
}

#[test]
fn wrong_arguments_are_told() {
    for wrong in
        [&["surface"][..], &["nothing", "--out", "x.png"], &["first", "--size", "0x3", "--out", "x.png"]]
    {
        let mut command = Command::new(example());
        // A window is no answer here: there is no display.
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        let run = command.args(wrong).output().unwrap();
        assert!(!run.status.success() && !run.stderr.is_empty(), "{wrong:?}");
    }
}

/// Pixels of a PNG of three bytes each, and its width.
fn picture(path: &Path) -> (usize, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    (reader.info().width as usize, pixels)
}

#[test]
fn sessions_are_replayed() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (script, first, last) =
        (folder.join("session.script"), folder.join("first.png"), folder.join("last.png"));
    let text = format!(
        "drag 10 100 90 100\nclick 10 20\nclick 90 20\nsave {}\nclick right 50 100\nsize 120 110\n",
        first.display()
    );
    std::fs::write(&script, text).unwrap();
    let mut run = Command::new(example());
    run.args(["editor", "--size", "100x110", "--script"]).arg(&script).arg("--out").arg(&last);
    let run = run.output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let lit = |(width, pixels): &(usize, Vec<u8>), x: usize, y: usize| pixels[3 * (y * width + x)] > 0;
    let [first, last] = [first, last].map(|path| picture(&path));
    assert_eq!((first.0, last.0), (100, 120));
    assert!(lit(&first, 50, 100) && lit(&first, 50, 20), "both lines");
    assert!(!lit(&last, 50, 100) && lit(&last, 50, 20), "the lower one is deleted");
}
