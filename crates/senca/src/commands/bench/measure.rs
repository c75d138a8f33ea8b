//! Taking times in turns.

use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::cli::Failure;

/// One run of what is measured.
pub(super) type Run<'a> = dyn FnMut() + Send + 'a;

/// Fewest runs of each form.
const FEWEST_RUNS: usize = 3;

/// Runs work on one thread and on several.
pub(super) struct Runner {
    one: ThreadPool,
    all: ThreadPool,
    seconds: f64,
}

impl Runner {
    /// For `threads` threads (all cores when not said) and `seconds` for each form.
    pub(super) fn new(threads: Option<usize>, seconds: f64) -> Result<Self, Failure> {
        let pool = |n| ThreadPoolBuilder::new().num_threads(n).build();
        let all = pool(threads.unwrap_or(0)).map_err(Failure::input)?;
        Ok(Self { one: pool(1).map_err(Failure::input)?, all, seconds })
    }

    /// Threads of the larger pool.
    pub(super) fn threads(&self) -> usize {
        self.all.current_num_threads()
    }
}

/// Median seconds of `fast` on one thread, `fast` on all, and `plain` (NaN without one).
pub(super) fn medians(runner: &Runner, fast: &mut Run<'_>, mut plain: Option<&mut Run<'_>>) -> [f64; 3] {
    let mut times: [Vec<f64>; 3] = Default::default();
    let enough = |t: &[f64]| t.len() >= FEWEST_RUNS && t.iter().sum::<f64>() >= runner.seconds;
    // Not counted: fills caches, grows scratch memory.
    runner.all.install(&mut *fast);
    while !enough(&times[0]) || !enough(&times[1]) {
        times[0].push(timed(&runner.one, fast));
        times[1].push(timed(&runner.all, fast));
        if let Some(plain) = plain.as_deref_mut().filter(|_| !enough(&times[2])) {
            times[2].push(timed(&runner.one, plain));
        }
    }
    times.map(median)
}

fn timed(pool: &ThreadPool, run: &mut Run<'_>) -> f64 {
    pool.install(|| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    })
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_form_runs_and_medians_are_taken() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        let (mut fast, mut plain) = (0, 0);
        let runner = Runner::new(Some(2), 1e-9).expect("two pools");
        let times = medians(&runner, &mut || fast += 1, Some(&mut || plain += 1));
        assert!(times.iter().all(|t| *t >= 0.0));
        assert!(fast >= 2 * FEWEST_RUNS && plain >= FEWEST_RUNS);
    }
}
