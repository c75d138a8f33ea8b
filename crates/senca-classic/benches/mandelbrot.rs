//! The quick Mandelbrot loop beside one in C that is vectorized by hand, in turn, in one run.
//!
//! ```text
//! cargo bench -p senca-classic --bench mandelbrot [-- SIZE ROUNDS]
//! ```
//!
//! Builds `mandelbrot.c` with `cc`. Each round runs every program twice; the shortest time counts, and
//! the sums of all counts must be the same for those that round the same way.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use senca_classic::lab::fractal::{Level, Parameters, counts};
use senca_math::Control;

const THREADS: usize = 2;

/// Values of m that are measured.
const ITERATIONS: [u32; 3] = [16, 256, 1000];

/// Names and options of the C programs.
const PROGRAMS: [(&str, &[&str]); 3] =
    [("C", &[]), ("C, fused operations", &["-DFUSED"]), ("C, AVX2", &["-DNARROW"])];

fn main() {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let size = numbers.first().copied().unwrap_or(4096);
    let rounds = numbers.get(1).copied().unwrap_or(5);
    let folder = std::env::temp_dir().join(format!("senca-mandelbrot-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the C programs");
    let programs: Vec<PathBuf> = (0..PROGRAMS.len()).map(|i| built(i, &folder)).collect();
    println!("{size} x {size} pixels, {THREADS} threads, shortest of {} runs\n", 2 * rounds);
    for iterations in ITERATIONS {
        let mut best = [f64::INFINITY; PROGRAMS.len() + 1];
        let mut sums = [0; PROGRAMS.len() + 1];
        for _ in 0..rounds {
            for (i, program) in programs.iter().enumerate() {
                let (seconds, sum) = run(program, size, iterations);
                (best[i], sums[i]) = (best[i].min(seconds), sum);
            }
            let (seconds, sum) = ours(size, iterations);
            let last = PROGRAMS.len();
            (best[last], sums[last]) = (best[last].min(seconds), sum);
        }
        report(iterations, &best, &sums);
    }
    drop(std::fs::remove_dir_all(&folder));
}

fn built(index: usize, folder: &Path) -> PathBuf {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/mandelbrot.c");
    let program = folder.join(index.to_string());
    let mut cc = Command::new("cc");
    cc.args(["-O3", "-march=native", "-ffp-contract=off", "-pthread"]).args(PROGRAMS[index].1);
    let done = cc.arg(source).arg("-o").arg(&program).status().expect("a C compiler");
    assert!(done.success(), "the C program is built");
    program
}

fn run(program: &Path, size: usize, iterations: u32) -> (f64, u64) {
    let numbers = [size, iterations as usize, THREADS, 2].map(|n| n.to_string());
    let done = Command::new(program).args(numbers).output().expect("the C program runs");
    let text = String::from_utf8(done.stdout).expect("numbers");
    let mut words = text.split_whitespace();
    let seconds = words.next().and_then(|w| w.parse().ok()).expect("a time");
    (seconds, words.next().and_then(|w| w.parse().ok()).expect("a sum"))
}

fn ours(size: usize, iterations: u32) -> (f64, u64) {
    let parameters = Parameters { size: [size, size], iterations, ..Parameters::MANDELBROT };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().expect("threads");
    let once = || {
        let start = Instant::now();
        let found = pool.install(|| counts(&parameters, false, Level::new(), &Control::default()));
        (start.elapsed().as_secs_f64(), found.expect("nobody stops it").sum())
    };
    let (first, second) = (once(), once());
    (first.0.min(second.0), second.1)
}

fn report(iterations: u32, best: &[f64], sums: &[u64]) {
    println!("m = {iterations}");
    let names = PROGRAMS.iter().map(|p| p.0).chain(["Senca"]);
    for ((name, seconds), sum) in names.zip(best).zip(sums) {
        println!("  {name:<20} {:>9.1} ms  {:>5.2} of C  sum {sum}", 1e3 * seconds, seconds / best[0]);
    }
    assert_eq!(sums[0], sums[PROGRAMS.len()], "the same counts");
}
