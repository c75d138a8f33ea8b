//! The editable text file that describes a viewing operation.
//!
//! One quantity to a line, `key = numbers`, numbers separated by blanks or commas, `#` before a
//! comment; keys in any order and any case. `view` says which operation it is:
//!
//! ```text
//! # A camera by the general parameters
//! view   = B            # A, B, C, P, or one of the forms of 1991
//! VRP    = 0 0 0        # view reference point, world coordinates
//! VPN    = 0 0 1        # view plane normal, towards the eye
//! VUP    = 0 1 0        # up vector
//! PRP    = 0 0 5        # eye, in view reference coordinates
//! window = -1 1 -1 1    # umin umax vmin vmax
//! F      = 1            # front plane, along VPN from the view plane
//! B      = -5           # back plane
//! ```
//!
//! | view | operation | keys |
//! |---|---|---|
//! | `A` | central, by centre and normal | `P`, `n`, `f` |
//! | `P` | parallel, by point and normal | `P`, `n` |
//! | `B` | central | `VRP`, `VPN`, `VUP`, `PRP`, `window`, `F`, `B` |
//! | `C` | parallel | the same |
//! | `1991-perspective`, `1991-parallel`, `1991-gks` | the 1991 forms | the same |
//!
//! Every key must be there once. Because `f` and `F` are different quantities of different
//! operations, their case does not matter either. Without the `=` the line is read the same way.

mod parse;

use glam::{DMat4, DVec3};

use crate::view::{
    CentralByNormal, Normalization1991, ParallelByNormal, View1991, ViewError, ViewParameters, ViewSteps,
    ViewWindow, ViewingOperation,
};
use parse::{Entries, Place};

/// A viewing operation read from text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFile {
    /// The operation with its parameters.
    pub operation: ViewingOperation,
}

/// What is wrong with a view file. Lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}:{column}: {kind}")]
pub struct ViewFileError {
    /// Name of the file as given by the caller.
    pub file: String,
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
    /// What is wrong there.
    pub kind: ViewFileErrorKind,
}

/// Kinds of mistakes in a view file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewFileErrorKind {
    /// A line without any key.
    #[error("expected a key and its value, such as \"VRP = 0 0 0\", but found {0:?}")]
    NoKey(String),
    /// A key that no viewing operation has.
    #[error("unknown key {0:?}; the keys are view, P, n, f, VRP, VPN, VUP, PRP, window, F, B")]
    UnknownKey(String),
    /// A key that this operation does not use.
    #[error("view {view} has no key {key:?}; its keys are {expected}")]
    KeyOfOtherView {
        /// The key as written.
        key: String,
        /// The operation.
        view: &'static str,
        /// What it uses.
        expected: &'static str,
    },
    /// A key that is there twice.
    #[error("the key {key:?} was already given on line {first_line}")]
    Duplicate {
        /// The key as written.
        key: String,
        /// Where it was first.
        first_line: usize,
    },
    /// A key that is not there; reported at the end of the file.
    #[error("the key \"{0}\" is missing")]
    Missing(&'static str),
    /// A key with too few or too many numbers.
    #[error("\"{key}\" needs {expected} number{}, but has {found}", if *expected == 1 { "" } else { "s" })]
    Count {
        /// The key as written.
        key: String,
        /// How many it needs.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// Something that is no finite number.
    #[error("{0:?} is not a finite number")]
    Number(String),
    /// An operation that does not exist.
    #[error("unknown view {0:?}; use A, B, C, P, 1991-perspective, 1991-parallel or 1991-gks")]
    UnknownView(String),
    /// Numbers that give no view; reported at the `view` line.
    #[error("{0}")]
    View(#[from] ViewError),
}

impl ViewFile {
    /// Reads a view file and tests that its numbers give a view. `name` stands for the file in error
    /// messages. A byte order mark and both kinds of line end are fine.
    ///
    /// # Errors
    /// [`ViewFileError`] with the place of the mistake.
    pub fn parse(name: &str, text: &str) -> Result<Self, ViewFileError> {
        parse_operation(text).map(|operation| Self { operation }).map_err(|(Place { line, column }, kind)| {
            ViewFileError { file: name.to_owned(), line, column, kind }
        })
    }

    /// The named partial matrices in the order of application.
    ///
    /// # Errors
    /// None for a file that [`Self::parse`] accepted; [`ViewError`] for an operation put in by hand.
    pub fn steps(&self) -> Result<ViewSteps, ViewError> {
        self.operation.steps()
    }

    /// Names and partial matrices in the order of application, and at last their product, `"T"`.
    ///
    /// # Errors
    /// Those of [`Self::steps`].
    pub fn matrices(&self) -> Result<Vec<(String, DMat4)>, ViewError> {
        let steps = self.steps()?;
        let mut all = steps.partial_matrices();
        all.push(("T".to_owned(), steps.product()));
        Ok(all)
    }
}

type Located<T> = Result<T, (Place, ViewFileErrorKind)>;

const GENERAL_KEYS: &str = "VRP, VPN, VUP, PRP, window, F, B";

fn parse_operation(text: &str) -> Located<ViewingOperation> {
    let entries = Entries::read(text)?;
    let (place, name) = entries.word("view")?;
    let operation = match name.to_ascii_lowercase().as_str() {
        "a" => central_by_normal(&entries)?,
        "p" => parallel_by_normal(&entries)?,
        "b" => ViewingOperation::Central(general(&entries, "B")?),
        "c" => ViewingOperation::Parallel(general(&entries, "C")?),
        "1991-perspective" => view_1991(&entries, "1991-perspective", Normalization1991::Perspective)?,
        "1991-parallel" => view_1991(&entries, "1991-parallel", Normalization1991::Parallel)?,
        "1991-gks" => view_1991(&entries, "1991-gks", Normalization1991::ParallelGks)?,
        _ => return Err((place, ViewFileErrorKind::UnknownView(name.to_owned()))),
    };
    operation.steps().map_err(|error| (place, error.into()))?;
    Ok(operation)
}

fn central_by_normal(entries: &Entries<'_>) -> Located<ViewingOperation> {
    entries.only(&["p", "n", "f"], "A", "P, n, f")?;
    Ok(ViewingOperation::CentralByNormal(CentralByNormal {
        center: vector(entries, "P")?,
        normal: vector(entries, "n")?,
        focal: number(entries, "f")?,
    }))
}

fn parallel_by_normal(entries: &Entries<'_>) -> Located<ViewingOperation> {
    entries.only(&["p", "n"], "P", "P, n")?;
    let (point, normal) = (vector(entries, "P")?, vector(entries, "n")?);
    Ok(ViewingOperation::ParallelByNormal(ParallelByNormal { point, normal }))
}

fn view_1991(
    entries: &Entries<'_>,
    name: &'static str,
    normalization: Normalization1991,
) -> Located<ViewingOperation> {
    let parameters = general(entries, name)?;
    Ok(ViewingOperation::View1991(View1991 { parameters, normalization }))
}

fn general(entries: &Entries<'_>, view: &'static str) -> Located<ViewParameters> {
    entries.only(&["vrp", "vpn", "vup", "prp", "window", "f", "b"], view, GENERAL_KEYS)?;
    Ok(ViewParameters {
        vrp: vector(entries, "VRP")?,
        vpn: vector(entries, "VPN")?,
        vup: vector(entries, "VUP")?,
        prp: vector(entries, "PRP")?,
        window: {
            let [umin, umax, vmin, vmax] = entries.numbers("window")?;
            ViewWindow::new(umin, umax, vmin, vmax)
        },
        front: number(entries, "F")?,
        back: number(entries, "B")?,
    })
}

fn vector(entries: &Entries<'_>, key: &'static str) -> Located<DVec3> {
    entries.numbers::<3>(key).map(DVec3::from)
}

fn number(entries: &Entries<'_>, key: &'static str) -> Located<f64> {
    entries.numbers::<1>(key).map(|[value]| value)
}

#[cfg(test)]
mod tests;
