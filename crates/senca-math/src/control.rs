//! The caller's hold on long work.

use std::sync::atomic::{AtomicBool, Ordering};

/// The caller's hold on a running render. The default neither watches nor stops it.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Called now and then with the share done, 0 to 1, never falling.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// Set to true from anywhere to stop within milliseconds.
    pub cancel: Option<&'a AtomicBool>,
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}

/// The caller asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Control<'_> {
    /// Whether the caller asked to stop.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|c| c.load(Ordering::Relaxed))
    }

    /// An error when the caller asked to stop.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Tells the caller that `share` of the work is done.
    pub fn report(&self, share: f32) {
        if let Some(progress) = self.progress {
            progress(share.clamp(0.0, 1.0));
        }
    }
}
