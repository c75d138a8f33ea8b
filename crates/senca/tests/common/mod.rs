//! What the tests of the command share.
#![allow(dead_code, reason = "each test program uses a part of it")]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The root of the repository.
pub(crate) fn repository() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.canonicalize().expect("the workspace is two folders up")
}

/// A file of `samples/`.
pub(crate) fn sample(name: &str) -> PathBuf {
    repository().join("samples").join(name)
}

/// The folder that holds the built command.
pub(crate) fn senca_folder() -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_senca"));
    program.parent().expect("a program lies in a folder").to_owned()
}

/// The command, to be run in `folder`.
pub(crate) fn senca_in<S: AsRef<OsStr>>(folder: &Path, arguments: &[S]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_senca"));
    command.args(arguments).current_dir(folder);
    command
}

/// Runs the command in `folder` to its end.
pub(crate) fn run_in<S: AsRef<OsStr>>(folder: &Path, arguments: &[S]) -> Output {
    senca_in(folder, arguments).output().expect("the command starts")
}

/// What a finished command wrote on standard error.
pub(crate) fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Copies a folder with all that is in it.
pub(crate) fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a new folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_folder(&path, &target);
        } else {
            std::fs::copy(&path, &target).expect("a copy");
        }
    }
}
