//! What can go wrong, sorted by whose fault it is.

use std::fmt;
use std::path::PathBuf;

/// Place in a file, as exact as the format allows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// File name as the user gave it.
    pub file: String,
    /// Line, counted from 1, in text formats.
    pub line: Option<u32>,
    /// Column in characters, counted from 1, in text formats.
    pub column: Option<u32>,
    /// Byte, counted from 0, in binary formats.
    pub byte: Option<u64>,
}

impl Location {
    /// The file as a whole.
    #[must_use]
    pub fn file(file: &str) -> Self {
        Self { file: file.to_owned(), ..Self::default() }
    }

    /// A line and column of a text file, both from 1.
    #[must_use]
    pub fn text(file: &str, line: u32, column: u32) -> Self {
        Self { file: file.to_owned(), line: Some(line), column: Some(column), byte: None }
    }

    /// A byte of a binary file, from 0.
    #[must_use]
    pub fn byte(file: &str, byte: u64) -> Self {
        Self { file: file.to_owned(), byte: Some(byte), ..Self::default() }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ":{column}")?;
        }
        if let Some(byte) = self.byte {
            write!(f, ": byte {byte}")?;
        }
        Ok(())
    }
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system refused the file.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content breaks the rules of its format.
    #[error("{at}: {message}")]
    Malformed {
        /// Where.
        at: Location,
        /// What is wrong and what would be right.
        message: String,
    },
    /// The content is sound but uses what this reader does not know.
    #[error("{at}: {message}")]
    Unsupported {
        /// Where.
        at: Location,
        /// What is not known.
        message: String,
    },
    /// The content asks for more than the [`Limits`](crate::Limits) allow.
    #[error("{at}: {message}")]
    Limit {
        /// Where.
        at: Location,
        /// Which limit, and what was asked.
        message: String,
    },
}

impl ReadError {
    /// A breach of the format at `at`.
    pub fn malformed(at: Location, message: impl Into<String>) -> Self {
        Self::Malformed { at, message: message.into() }
    }

    /// A feature this reader does not know, at `at`.
    pub fn unsupported(at: Location, message: impl Into<String>) -> Self {
        Self::Unsupported { at, message: message.into() }
    }

    /// A demand above the limits, at `at`.
    pub fn limit(at: Location, message: impl Into<String>) -> Self {
        Self::Limit { at, message: message.into() }
    }
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The format cannot hold what was asked of it.
    #[error("{message}")]
    Unsupported {
        /// What it cannot hold, and which format can.
        message: String,
    },
    /// The encoder failed.
    #[error("{message}")]
    Encode {
        /// What it said.
        message: String,
    },
}
