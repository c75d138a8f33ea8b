//! Where results go: a file, or standard output.

use std::io::Write;
use std::path::{Path, PathBuf};

use senca::io::{WriteError, write_file_while};

use super::{Failure, Interrupt};

/// The path that stands for standard input or output.
pub(crate) const STANDARD: &str = "-";

/// Whether `path` stands for standard input or output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// Finds out before the work whether `path` can be written after it.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    if is_standard(path) {
        return Ok(());
    }
    let refuse = |why: &dyn std::fmt::Display| Err(Failure::input(format!("{}: {why}", path.display())));
    match std::fs::metadata(path) {
        Ok(found) if found.is_dir() => return refuse(&"is a folder; a file name is needed"),
        Ok(found) if !found.is_file() => return Ok(()),
        Ok(found) if found.permissions().readonly() => return refuse(&"is write-protected"),
        _ => {}
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return refuse(&format!("there is no folder {}", folder.display()));
    }
    match tempfile::Builder::new().prefix(".senca-").tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => refuse(&format!("cannot write into the folder: {}", plain(&error))),
    }
}

/// What the system said, without the path that is told anyway.
fn plain(error: &std::io::Error) -> String {
    error
        .raw_os_error()
        .map_or_else(|| error.kind().to_string(), |code| std::io::Error::from_raw_os_error(code).to_string())
}

/// Writes `bytes` to `path` at once or, after Ctrl-C, not at all.
pub(crate) fn write(path: &Path, bytes: &[u8], interrupt: &Interrupt) -> Result<(), Failure> {
    let go_on = || !interrupt.is_raised();
    interrupt.while_writing(|| {
        // Asked before a file is begun: the process may be about to end.
        if !go_on() {
            return Err(Failure::Interrupted);
        }
        write_file_while(path, bytes, &go_on).map_err(|error| match error {
            WriteError::Io { path, source } if is_standard(&path) => {
                Failure::from_io(source.kind(), format!("standard output: {source}"))
            }
            other => other.into(),
        })
    })
}

/// Prints `text` on standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|e| Failure::from_io(e.kind(), format!("standard output: {e}")))
}

/// Prints `text` and a line end on standard error; nobody can be told when that fails.
pub(crate) fn tell(text: &str) {
    drop(writeln!(std::io::stderr().lock(), "{text}"));
}

/// `stem.extension` in the current folder, for a scene read from `scene`.
pub(crate) fn default_name(scene: &Path, extension: &str) -> PathBuf {
    let stem = if is_standard(scene) { None } else { scene.file_stem() };
    let mut name = stem.unwrap_or("picture".as_ref()).to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_name_is_the_scenes() {
        assert_eq!(default_name(Path::new("a/b.c/teapot.toml"), "png"), Path::new("teapot.png"));
        assert_eq!(default_name(Path::new("-"), "svg"), Path::new("picture.svg"));
    }

    #[test]
    fn places_that_cannot_be_written_are_found_out() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(check_writable(Path::new("-")), Ok(()));
        assert_eq!(check_writable(&dir.path().join("new.png")), Ok(()));
        let folder = check_writable(dir.path()).expect_err("a folder");
        assert!(folder.message().is_some_and(|m| m.contains("is a folder")));
        let missing = check_writable(&dir.path().join("no/new.png")).expect_err("no folder");
        assert!(missing.message().is_some_and(|m| m.contains("there is no folder")));
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 0);
    }
}
