//! The commands that `docs/opengl.md` shows for the example `opengl` work.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The example, which is built now if it is not up to date.
fn example() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "--quiet", "-p", "senca-gl", "--example", "opengl"]);
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
        let arguments = arguments(command);
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
        let run = Command::new(example()).args(wrong).output().unwrap();
        assert!(!run.status.success() && !run.stderr.is_empty(), "{wrong:?}");
    }
}
