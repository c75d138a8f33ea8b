//! Partial pictures on disk: `--resume FILE`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use senca::pipeline::Control;
use senca::{Error, SavePartial, Scene, Settings, TraceJob, TracedPicture, trace_with};

use super::tracing::TracingArguments;
use crate::cli::output::{check_writable, is_standard};
use crate::cli::{Failure, Interrupt};

/// Where a partial picture is kept, and what is there.
#[derive(Debug, Default)]
pub(super) struct Partial {
    path: Option<PathBuf>,
    bytes: Option<Vec<u8>>,
    samples_map: bool,
    /// Why it could not be kept, if it could not.
    refused: Mutex<Option<Failure>>,
}

impl Partial {
    /// What the options name, read from disk where it is there.
    pub(super) fn of(arguments: &TracingArguments) -> Result<Self, Failure> {
        let samples_map = arguments.samples_map.is_some();
        let Some(path) = arguments.resume.clone() else { return Ok(Self { samples_map, ..Self::default() }) };
        if is_standard(&path) {
            return Err(Failure::usage("--resume needs the name of a file"));
        }
        check_writable(&path)?;
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => Some(bytes),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => return Err(Failure::input(format!("{}: {error}", path.display()))),
        };
        Ok(Self { path: Some(path), bytes, samples_map, refused: Mutex::default() })
    }

    /// Name for messages.
    pub(super) fn name(&self) -> String {
        self.path.as_ref().map_or_else(String::new, |path| path.display().to_string())
    }

    /// Traces the scene, going on from what is there and keeping what is done.
    pub(super) fn trace(
        &self,
        scene: Cow<'_, Scene>,
        settings: &Settings,
        control: &Control<'_>,
        interrupt: &Interrupt,
    ) -> Result<TracedPicture, Error> {
        let mut keep = |bytes: &[u8]| {
            let Some(path) = &self.path else { return };
            // Written after Ctrl-C, too: that is what it is for.
            let written = interrupt.while_writing(|| senca::io::write_file(path, bytes));
            if let Err(error) = written {
                self.refused.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error.into());
            }
        };
        let save: Option<&mut SavePartial<'_>> = if self.path.is_some() { Some(&mut keep) } else { None };
        let mut job = TraceJob { resume: self.bytes.as_deref(), save, samples_map: self.samples_map };
        trace_with(scene, settings, control, &mut job)
    }

    /// Why the partial picture could not be kept, if it could not.
    pub(super) fn outcome(&self) -> Result<(), Failure> {
        self.refused.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }
}
