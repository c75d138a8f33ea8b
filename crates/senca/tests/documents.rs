//! Every command that a document shows is run, and every picture of the gallery is made again.
//!
//! Commands are the lines of `sh` blocks. Those of one document run one after the other in a copy of
//! the repository's samples and documents, so a document may use what it made before.

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{copy_folder, repository, senca_folder};

/// Commands that are not run here, because they build or measure: the builds run in `.ci/run`, the
/// measurements in `cli.rs`, with less patience.
const CHECKED_ELSEWHERE: &[&str] = &[
    ".ci/run",
    "cargo test --workspace",
    "REPLACE=1 cargo test --workspace",
    "cargo build --release -p senca",
    "cargo install --path crates/senca",
    "cargo doc --workspace --no-deps --open",
    "cargo fmt",
    "cargo clippy --workspace --all-targets",
    "cargo bench --workspace",
    "cargo +nightly fuzz run",
    "senca bench",
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
