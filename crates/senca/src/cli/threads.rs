//! How many threads work.

use rayon::ThreadPoolBuilder;

use super::Failure;

/// From now on `threads` threads work, all cores when nothing is said. They start with the first
/// work that can be shared.
pub(crate) fn use_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .map_err(|e| Failure::input(format!("{threads} threads cannot be started: {e}")))
}
