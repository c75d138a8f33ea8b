//! Files that a file names: textures, buffers, material libraries.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::{Location, ReadError};

/// Bounds on what a reader may take in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest file, in bytes. Default 4 GiB.
    pub file_bytes: u64,
    /// Most texels of one picture. Default 2^28, a square of 16384.
    pub image_texels: u64,
    /// Most elements (vertices, faces, nodes) a reader makes of one file beyond what the file's own
    /// bytes bear out, such as the points of tessellated curves. Default 2^26.
    pub made_elements: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { file_bytes: 4 << 30, image_texels: 1 << 28, made_elements: 1 << 26 }
    }
}

/// Gives readers the files that the main file names.
pub trait Files {
    /// Content of the file named `uri`, relative to the main file.
    ///
    /// # Errors
    /// When the name leads outside, or the file is missing, unreadable or too large.
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError>;

    /// The bounds to keep.
    fn limits(&self) -> Limits {
        Limits::default()
    }
}

/// No files: a main file that names another one gets an error.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let message = format!("needs the file \"{uri}\", but there is no folder to look in");
        Err(ReadError::unsupported(Location::file("-"), message))
    }
}

/// Files in one folder and below.
#[derive(Clone, Debug)]
pub struct Directory {
    root: PathBuf,
    limits: Limits,
}

impl Directory {
    /// Files below `root`.
    #[must_use]
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into(), limits: Limits::default() }
    }

    /// Files beside `file`.
    #[must_use]
    pub fn beside(file: &Path) -> Self {
        Self::new(file.parent().unwrap_or(Path::new("")))
    }

    /// The path of `uri` below the root. Names that lead outside (an absolute path, `..` above the
    /// root, a scheme such as `http:`) are refused.
    fn resolve(&self, uri: &str) -> Result<PathBuf, ReadError> {
        let refuse = |why: &str| {
            Err(ReadError::malformed(
                Location::file(uri),
                format!("{why}; only files beside the model are read"),
            ))
        };
        if uri.contains("://") {
            return refuse("is a network address");
        }
        let mut depth = 0i32;
        let relative = PathBuf::from(uri.replace('\\', "/"));
        for component in relative.components() {
            match component {
                Component::Normal(_) => depth += 1,
                Component::CurDir => {}
                Component::ParentDir => depth -= 1,
                Component::RootDir | Component::Prefix(_) => return refuse("is an absolute path"),
            }
            if depth < 0 {
                return refuse("leads outside the model's folder");
            }
        }
        Ok(self.root.join(relative))
    }
}

impl Files for Directory {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        let path = self.resolve(uri)?;
        // Asked before it is opened: opening a pipe would wait for its writer.
        let is_file = std::fs::metadata(&path)
            .map_err(|source| ReadError::Io { path: path.clone(), source })?
            .is_file();
        if !is_file {
            return Err(ReadError::malformed(Location::file(uri), "is not a regular file"));
        }
        read_limited(&path, self.limits)
    }

    fn limits(&self) -> Limits {
        self.limits
    }
}

/// File name without folder and extension.
pub(crate) fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Content of `path`, as long as it keeps to the limits.
pub(crate) fn read_limited(path: &Path, limits: Limits) -> Result<Vec<u8>, ReadError> {
    let io = |source| ReadError::Io { path: path.to_owned(), source };
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let mut bytes = Vec::with_capacity(length.min(limits.file_bytes) as usize);
    file.take(limits.file_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > limits.file_bytes {
        let message = format!("is larger than the limit of {} bytes", limits.file_bytes);
        return Err(ReadError::limit(Location::file(&path.display().to_string()), message));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_outside_are_refused() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        std::fs::create_dir_all(dir.path().join("in/sub")).expect("folders");
        std::fs::write(dir.path().join("secret"), "x").expect("a file");
        std::fs::write(dir.path().join("in/a.txt"), "a").expect("a file");
        let files = Directory::new(dir.path().join("in"));
        assert_eq!(files.read("a.txt").expect("beside"), b"a");
        assert_eq!(files.read("sub/../a.txt").expect("beside"), b"a");
        for uri in ["../secret", "sub/../../secret", "/etc/passwd", "..\\secret", "http://x/a.txt"] {
            assert!(matches!(files.read(uri), Err(ReadError::Malformed { .. })), "{uri}");
        }
        assert!(matches!(files.read("missing"), Err(ReadError::Io { .. })));
    }

    #[test]
    fn files_above_the_limit_are_refused() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(dir.path().join("big"), [0; 100]).expect("a file");
        let mut files = Directory::new(dir.path());
        files.limits.file_bytes = 99;
        assert!(matches!(files.read("big"), Err(ReadError::Limit { .. })));
    }
}
