//! Putting files in place at once or not at all.

use std::io::Write;
use std::path::Path;

use crate::WriteError;

/// Writes `bytes` to `path`: beside it first, then renamed, so that `path` never holds half a file.
/// `-` is standard output.
///
/// # Errors
/// When the system refuses.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let io = |source| WriteError::Io { path: path.to_owned(), source };
    if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        return out.write_all(bytes).and_then(|()| out.flush()).map_err(io);
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut beside = tempfile::Builder::new();
    beside.prefix(".senca-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        beside.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = beside.tempfile_in(folder).map_err(io)?;
    file.write_all(bytes).map_err(io)?;
    file.persist(path).map_err(|e| io(e.error))?;
    Ok(())
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
}
