//! Every command that a document shows is run, and every picture of the gallery is made again.
//!
//! Commands are the lines of `sh` blocks. Those of one document run one after the other in a copy of
//! the repository's samples and documents, so a document may use what it made before.

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{copy_folder, repository, senca_folder};
use senca::Image;
use senca::io::Limits;
use senca::io::images::decode_picture;
use senca::math::{LinearRgb, Srgb8};

/// Commands that are not run here, because they build or measure, or run in the tests of `senca-gl` and
/// `senca-osmesa`: the builds run in `.ci/run`, the measurements in `cli.rs`, with less patience.
const CHECKED_ELSEWHERE: &[&str] = &[
    ".ci/run",
    "cargo test --workspace",
    "REPLACE=1 cargo test --workspace",
    "cargo build --release -p senca",
    "cargo run --release -p senca-gl --example ",
    "cc -o picture ",
    "cc -O2 -o speed crates/senca-osmesa/benches/speed.c ",
    "./speed ",
    "LD_LIBRARY_PATH=target/release ./picture",
    "cargo install --path crates/senca",
    "cargo doc --workspace --no-deps --open",
    "cargo fmt",
    "cargo clippy --workspace --all-targets",
    "cargo bench --workspace",
    "cargo +nightly fuzz run",
    "senca bench",
    "cargo bench",
];

/// What stands before a command of ours when it is built on the spot.
const CARGO_RUN: &str = "cargo run --release -p senca -- ";

/// All markdown files of the repository, from its root.
fn documents() -> Vec<PathBuf> {
    let mut open = vec![repository()];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").path()) {
            let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if entry.is_dir() && !name.starts_with('.') && name != "target" && name != "fuzz" {
                open.push(entry);
            } else if name.ends_with(".md") {
                found.push(entry);
            }
        }
    }
    found.sort();
    found
}

/// Commands in the `sh` blocks of a text; a line that ends in a backslash goes on in the next.
fn commands(text: &str) -> Vec<String> {
    let mut commands: Vec<String> = Vec::new();
    let (mut inside, mut goes_on) = (false, false);
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            inside = !inside && line.trim() == "```sh";
            continue;
        }
        let line = line.trim();
        if !inside || line.is_empty() || line.starts_with('#') {
            continue;
        }
        let part = line.strip_suffix('\\').unwrap_or(line).trim_end();
        match commands.last_mut() {
            Some(last) if goes_on => *last = format!("{last} {part}"),
            _ => commands.push(part.to_owned()),
        }
        goes_on = line.ends_with('\\');
    }
    commands
}

/// The command as it is run here, or `None` when it is checked elsewhere.
fn runnable(command: &str) -> Option<String> {
    if let Some(arguments) = command.strip_prefix(CARGO_RUN) {
        return Some(format!("senca {arguments}"));
    }
    let elsewhere = CHECKED_ELSEWHERE.iter().any(|known| command.starts_with(known));
    if elsewhere {
        return None;
    }
    assert!(command.starts_with("senca "), "a document shows a command that nothing checks: {command}");
    Some(command.to_owned())
}

/// A copy of what commands in documents read.
fn copy_of_repository() -> tempfile::TempDir {
    let copy = tempfile::tempdir().expect("a temporary folder");
    for folder in ["samples", "docs"] {
        copy_folder(&repository().join(folder), &copy.path().join(folder));
    }
    copy
}

/// Runs `command` by the shell in `folder` and demands success.
fn run(command: &str, folder: &Path) {
    let old_path = std::env::var_os("PATH").unwrap_or_default();
    let mut paths = vec![senca_folder()];
    paths.extend(std::env::split_paths(&old_path));
    let path = std::env::join_paths(paths).expect("folders without colons");
    let done = Command::new("sh").arg("-c").arg(command).current_dir(folder).env("PATH", path).output();
    let done = done.expect("a shell");
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success(), "{command}\nended with {}: {told}", done.status);
}

#[test]
fn every_command_of_every_document_works() {
    let documents = documents();
    assert!(documents.iter().any(|d| d.ends_with("README.md")), "the documents are found");
    for document in documents.iter().filter(|d| !d.ends_with("docs/gallery/README.md")) {
        let text = std::fs::read_to_string(document).expect("a text");
        let commands: Vec<_> = commands(&text).iter().filter_map(|c| runnable(c)).collect();
        if !commands.is_empty() {
            let folder = copy_of_repository();
            commands.iter().for_each(|c| run(c, folder.path()));
        }
    }
}

/// How far apart two pictures are: the mean difference of a component, and the share of pixels that
/// differ visibly, both in units of the display's range. `None` when their sizes differ.
fn difference(a: &Image, b: &Image) -> Option<(f64, f64)> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return None;
    }
    let encoded = |image: &Image, i: usize| {
        let [r, g, b, _] = image.pixels()[i];
        let Srgb8 { r, g, b } = LinearRgb::new(r, g, b).to_srgb8();
        [r, g, b]
    };
    let (mut sum, mut visible) = (0.0, 0.0);
    for i in 0..a.pixels().len() {
        let apart =
            encoded(a, i).iter().zip(encoded(b, i)).map(|(x, y)| f64::from(x.abs_diff(y))).sum::<f64>();
        sum += apart / (3.0 * 255.0);
        visible += f64::from(u8::from(apart > 24.0));
    }
    let pixels = a.pixels().len() as f64;
    Some((sum / pixels, visible / pixels))
}

fn picture(path: &Path) -> Image {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    decode_picture(&path.display().to_string(), &bytes, &Limits::default()).expect("a picture")
}

#[test]
fn the_gallery_is_made_by_its_commands() {
    let gallery = repository().join("docs/gallery");
    let text = std::fs::read_to_string(gallery.join("README.md")).expect("a text");
    let folder = copy_of_repository();
    commands(&text).iter().filter_map(|c| runnable(c)).for_each(|c| run(&c, folder.path()));
    let mut made: Vec<PathBuf> = text
        .split_whitespace()
        .filter_map(|word| word.strip_prefix("docs/gallery/"))
        .map(|name| Path::new("docs/gallery").join(name))
        .collect();
    made.sort();
    assert!(made.len() > 30, "only {} pictures", made.len());
    for path in made {
        let (fresh, shown) = (folder.path().join(&path), repository().join(&path));
        if std::env::var_os("REPLACE").is_some() {
            std::fs::copy(&fresh, &shown).expect("a copy");
        } else if path.extension().is_some_and(|e| e == "png") {
            let difference = difference(&picture(&fresh), &picture(&shown));
            let alike = difference.is_some_and(|(mean, visible)| mean < 0.002 && visible < 0.005);
            assert!(alike, "{} differs from the one shown: {difference:?} (mean, share)", path.display());
        }
        let bytes = std::fs::metadata(&shown).expect("a picture").len();
        assert!(bytes <= 61_440, "{} has {bytes} bytes; 60 KiB are the limit", path.display());
    }
}

#[test]
fn links_between_documents_lead_somewhere() {
    for document in documents() {
        let text = std::fs::read_to_string(&document).expect("a text");
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap_or_default();
            let is_local =
                !file.is_empty() && !target.contains("://") && !target.contains(char::is_whitespace);
            let there = document.parent().expect("a folder").join(file);
            assert!(!is_local || there.exists(), "{} links to {target}", document.display());
        }
    }
}

#[test]
fn commands_are_read_from_shell_blocks_only() {
    let text = "```sh\n# a remark\nsenca render a \\\n  -o b\nsenca info c\n```\ntext\n```\nsenca no\n```\n";
    assert_eq!(commands(text), ["senca render a -o b", "senca info c"]);
}
