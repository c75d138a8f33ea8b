//! Errors of commands.

use crate::{Context, Enum, gl};

/// What is wrong with a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// A name that the command does not take.
    #[error("a name that the command does not take")]
    InvalidEnum,
    /// A number out of range.
    #[error("a number out of range")]
    InvalidValue,
    /// Not allowed in the present state.
    #[error("not allowed in the present state")]
    InvalidOperation,
    /// Not enough memory.
    #[error("not enough memory")]
    OutOfMemory,
    /// The framebuffer is not complete.
    #[error("the framebuffer is not complete")]
    InvalidFramebufferOperation,
}

impl Error {
    /// The code that `get_error` gives.
    #[must_use]
    pub fn code(self) -> Enum {
        match self {
            Self::InvalidEnum => gl::INVALID_ENUM,
            Self::InvalidValue => gl::INVALID_VALUE,
            Self::InvalidOperation => gl::INVALID_OPERATION,
            Self::OutOfMemory => gl::OUT_OF_MEMORY,
            Self::InvalidFramebufferOperation => gl::INVALID_FRAMEBUFFER_OPERATION,
        }
    }
}

impl Context {
    /// Notes the error of a command that failed; what it gave if it did not.
    pub(crate) fn check<R>(&mut self, result: Result<R, Error>) -> Option<R> {
        result.map_err(|error| self.error(error.code())).ok()
    }
}
