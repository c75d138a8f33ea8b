//! How a command ends when it does not succeed.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use senca::Error;
use senca::io::{ReadError, WriteError};
use senca::pipeline::RenderError;

/// Why a command stopped.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// The command was given wrongly: exit status 2.
    Usage(String),
    /// The input is bad or the system refused: exit status 1.
    Input(String),
    /// The user pressed Ctrl-C: exit status 130.
    Interrupted,
    /// Whoever read the standard output has gone; nobody is left to tell, so exit status 0.
    ClosedPipe,
}

impl Failure {
    /// Bad usage, told as `message`.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// Bad input, told as `message`.
    pub(crate) fn input(message: impl Display) -> Self {
        Self::Input(message.to_string())
    }

    /// How a command ends for an error of the library about the scene read from `path`.
    pub(crate) fn of_scene(path: &Path, error: &Error) -> Self {
        match error {
            Error::Render(RenderError::Cancelled) => Self::Interrupted,
            error if error.is_usage() => Self::usage(error),
            error => Self::input(format!("{}: {error}", path.display())),
        }
    }

    /// What the user is told, if anything.
    pub(crate) fn message(&self) -> Option<String> {
        match self {
            Self::Usage(message) => {
                Some(format!("senca: {message}\nFor more information, try 'senca --help'."))
            }
            Self::Input(message) => Some(format!("senca: {message}")),
            Self::Interrupted => Some("senca: interrupted".to_owned()),
            Self::ClosedPipe => None,
        }
    }

    /// The exit status.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Usage(_) => 2,
            Self::Input(_) => 1,
            Self::Interrupted => 130,
            Self::ClosedPipe => 0,
        })
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::input(error)
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Io { source, .. } => Self::from_io(source.kind(), &error),
            WriteError::Unsupported { .. } => Self::usage(error),
            WriteError::Encode { .. } => Self::input(error),
        }
    }
}

impl Failure {
    /// A refusal of the system, told as `message`.
    pub(crate) fn from_io(kind: ErrorKind, message: impl Display) -> Self {
        match kind {
            ErrorKind::BrokenPipe => Self::ClosedPipe,
            ErrorKind::Interrupted => Self::Interrupted,
            _ => Self::input(message),
        }
    }
}
