//! What can be wrong with what an exercise is given.

use senca_io::{Location, ReadError};

/// Why an exercise cannot be done with what it was given.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// A text breaks the rules of its exercise.
    #[error("{at}: {message}")]
    Text {
        /// File, line and column.
        at: Location,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// The numbers are read well, but nothing follows from them: a triangle that is a line, an eye
    /// in what it looks at.
    #[error("{0}")]
    Degenerate(String),
    /// A model cannot be read.
    #[error(transparent)]
    Model(#[from] ReadError),
}

impl LabError {
    /// Nothing follows from the numbers, because of `message`.
    pub(crate) fn degenerate(message: impl Into<String>) -> Self {
        Self::Degenerate(message.into())
    }
}
