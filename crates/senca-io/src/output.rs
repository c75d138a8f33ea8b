//! Putting files in place at once or not at all.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::WriteError;

/// Bytes written between two looks at whether to go on.
const CHUNK: usize = 1 << 20;

/// Writes `bytes` to `path`: beside it first, then renamed, so that `path` never holds half a file.
/// `-` is standard output; devices and pipes are written to as they are, and a symbolic link stays
/// one.
///
/// # Errors
/// When the system refuses.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_file_while(path, bytes, &|| true)
}

/// As [`write_file`], as long as `go_on` says so; it is asked every megabyte.
///
/// # Errors
/// When the system refuses; [`ErrorKind::Interrupted`] when `go_on` said no, and then `path` is as it
/// was.
pub fn write_file_while(path: &Path, bytes: &[u8], go_on: &dyn Fn() -> bool) -> Result<(), WriteError> {
    let io = |source| WriteError::Io { path: path.to_owned(), source };
    if path == Path::new("-") {
        return write_chunks(&mut std::io::stdout().lock(), bytes, go_on).map_err(io);
    }
    match std::fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io(ErrorKind::IsADirectory.into())),
        Ok(found) if !found.is_file() => {
            let mut file = OpenOptions::new().write(true).open(path).map_err(io)?;
            write_chunks(&mut file, bytes, go_on).map_err(io)
        }
        Ok(_) => write_beside(&path.canonicalize().map_err(io)?, bytes, go_on).map_err(io),
        Err(_) => write_beside(path, bytes, go_on).map_err(io),
    }
}

/// Writes a file beside `path` and renames it when it is whole.
fn write_beside(path: &Path, bytes: &[u8], go_on: &dyn Fn() -> bool) -> std::io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut beside = tempfile::Builder::new();
    beside.prefix(".senca-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        beside.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = beside.tempfile_in(folder)?;
    write_chunks(&mut file, bytes, go_on)?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

fn write_chunks(out: &mut impl Write, bytes: &[u8], go_on: &dyn Fn() -> bool) -> std::io::Result<()> {
    for chunk in bytes.chunks(CHUNK) {
        if !go_on() {
            return Err(ErrorKind::Interrupted.into());
        }
        out.write_all(chunk)?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_write_leaves_the_old_file_alone() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let path = dir.path().join("a.txt");
        write_file(&path, b"one").expect("writes");
        write_file(&path, b"two").expect("replaces");
        assert_eq!(std::fs::read(&path).expect("reads"), b"two");
        let error = write_file(&dir.path().join("no/such/folder/a.txt"), b"x").expect_err("no folder");
        assert!(error.to_string().contains("no/such/folder"), "{error}");
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 1);
    }
    #[test]
    fn an_interrupted_write_leaves_nothing() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let asked = std::cell::Cell::new(0);
        let go_on = || asked.replace(asked.get() + 1) < 1;
        let bytes = vec![7; 2 * CHUNK];
        let error = write_file_while(&dir.path().join("a"), &bytes, &go_on).expect_err("interrupted");
        assert!(matches!(error, WriteError::Io { source, .. } if source.kind() == ErrorKind::Interrupted));
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 0);
        assert!(write_file(dir.path(), b"x").is_err(), "a folder is no file");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let (real, link) = (dir.path().join("real"), dir.path().join("link"));
        std::fs::write(&real, "old").expect("a file");
        std::os::unix::fs::symlink(&real, &link).expect("a link");
        write_file(&link, b"new").expect("writes through the link");
        assert!(link.is_symlink() && std::fs::read(&real).expect("reads") == b"new");
        write_file(Path::new("/dev/null"), b"gone").expect("a device takes anything");
        assert!(!std::fs::metadata("/dev/null").expect("is there").is_file());
    }
}
