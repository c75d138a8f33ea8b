//! The threads that drawing is shared out to.

use rayon::ThreadPoolBuilder;
use std::num::NonZero;
use std::sync::Once;

/// Makes the calling thread one of the pool's, the first time; later calls do nothing.
///
/// A pool of its own has as many threads as there are processors, and the thread that calls OpenGL would be one
/// more: it works along where triangles are drawn, so that there was always one thread too many to run. The thread
/// that makes the first context is nearly always the one that draws.
///
/// Other threads of the program that draw leave work to the rest of the pool, which is why a pool of a single thread
/// is left as it is: it would have no rest.
pub(crate) fn join() {
    static JOINED: Once = Once::new();
    JOINED.call_once(|| {
        let threads = threads();
        if threads > 1 {
            // An error says that the pool exists, which is as good.
            let _ = ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
        }
    });
}

/// As many threads as `RAYON_NUM_THREADS` says, or else as there are processors for this process.
fn threads() -> usize {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    asked
        .filter(|&threads| threads > 0)
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
