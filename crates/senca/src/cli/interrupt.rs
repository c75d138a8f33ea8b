//! Ctrl-C: stop within a second, leave no broken file.
//!
//! The first Ctrl-C raises a flag that drawing and writing look at. Stages that cannot look (a
//! parser, an encoder) are ended with the process after a moment of grace, as they have nothing on
//! disk yet; only while a file is being written does the process wait for the writer, which
//! removes its unfinished file and gives up, and while something is computed that is to be kept as far
//! as it has come. Then a second Ctrl-C ends it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::output::tell;

/// How long drawing is given to stop by itself.
const GRACE: Duration = Duration::from_millis(500);

/// The exit status after Ctrl-C: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Says whether the user pressed Ctrl-C.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt {
    raised: Arc<AtomicBool>,
    writing: Arc<AtomicBool>,
    keeping: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens for Ctrl-C from now on. Where the system gives no signal, none ever comes.
    pub(crate) fn listen() -> Self {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        let listening = ctrlc::set_handler(move || heard.raise_and_end());
        debug_assert!(listening.is_ok(), "one listener per process");
        interrupt
    }

    fn raise_and_end(&self) {
        let first = !self.raised.swap(true, Ordering::SeqCst);
        if first {
            std::thread::sleep(GRACE);
        }
        let kept = first && self.keeping.load(Ordering::SeqCst);
        if kept {
            tell("senca: saving what there is; Ctrl-C again ends without it");
        } else if !self.writing.load(Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
    }

    /// Whether Ctrl-C was pressed.
    pub(crate) fn is_raised(&self) -> bool {
        self.raised.load(Ordering::Relaxed)
    }

    /// The flag itself, for those who look at it while they work.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.raised
    }

    /// Runs `work`, whose result is kept after Ctrl-C, too: it is asked to stop, and waited for.
    pub(crate) fn while_keeping<T>(&self, work: impl FnOnce() -> T) -> T {
        self.keeping.store(true, Ordering::SeqCst);
        let result = work();
        self.keeping.store(false, Ordering::SeqCst);
        result
    }

    /// Runs `write`, during which the process is not ended from outside.
    pub(crate) fn while_writing<T>(&self, write: impl FnOnce() -> T) -> T {
        self.writing.store(true, Ordering::SeqCst);
        let result = write();
        self.writing.store(false, Ordering::SeqCst);
        result
    }
}
