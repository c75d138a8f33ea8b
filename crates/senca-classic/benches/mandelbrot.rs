//! The quick Mandelbrot loop beside one in C that is vectorized by hand, in turn, in one run.
//!
//! ```text
//! cargo bench -p senca-classic --bench mandelbrot [-- SIZE ROUNDS]
//! cargo bench -p senca-classic --bench mandelbrot -- deep [WIDTH ROUNDS]
//! ```
//!
//! Builds `mandelbrot.c` with `cc`. Each round runs every program twice, the second time into the memory of
//! the first; the shortest time counts, and the sums of all counts must be the same for those that round
//! the same way. "New memory" is the first time alone, in which the system also finds the pages.
//!
//! `deep` measures deep zooms by perturbation, sixteen pixels together beside one after the other.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use senca_classic::lab::fractal::{
    Counts, DeepView, Level, Parameters, View, counts_into, deep_counts, deep_counts_one_by_one,
};
use senca_math::Control;

const THREADS: usize = 2;

/// Values of m that are measured.
const ITERATIONS: [u32; 3] = [16, 256, 1000];

/// Names and options of the C programs, and how often each runs.
const PROGRAMS: [(&str, &[&str], usize); 4] = [
    ("C", &[], 2),
    ("C, fused operations", &["-DFUSED"], 2),
    ("C, AVX2", &["-DNARROW"], 2),
    ("C, new memory", &[], 1),
];

/// Real part, imaginary part, width and m of deep views: a copy of the set 29 powers of ten deep, and a
/// dendrite beyond the exponents of the processor.
const DEEP: [(&str, &str, &str, u32); 2] = [
    (
        "-0.7746801319835207707515791989543337898602796034199812713724925884",
        "-0.1374164012961857927162591905894840107238690621541539991172377345",
        "4e-28",
        8_000,
    ),
    ("0", "1", "1e-400", 3_000),
];

fn main() {
    if std::env::args().any(|a| a == "deep") {
        return measure_deep();
    }
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let size = numbers.first().copied().unwrap_or(4096);
    let rounds = numbers.get(1).copied().unwrap_or(5);
    let folder = std::env::temp_dir().join(format!("senca-mandelbrot-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the C programs");
    let programs: Vec<PathBuf> = (0..PROGRAMS.len()).map(|i| built(i, &folder)).collect();
    println!("{size} x {size} pixels, {THREADS} threads, shortest of {} runs\n", 2 * rounds);
    for iterations in ITERATIONS {
        let mut best = [f64::INFINITY; PROGRAMS.len() + 2];
        let mut sums = [0; PROGRAMS.len() + 2];
        for _ in 0..rounds {
            for (i, program) in programs.iter().enumerate() {
                let (seconds, sum) = run(program, size, iterations, PROGRAMS[i].2);
                (best[i], sums[i]) = (best[i].min(seconds), sum);
            }
            for (i, (seconds, sum)) in ours(size, iterations).into_iter().enumerate() {
                let i = PROGRAMS.len() + i;
                (best[i], sums[i]) = (best[i].min(seconds), sum);
            }
        }
        report(iterations, &best, &sums);
    }
    drop(std::fs::remove_dir_all(&folder));
}

fn measure_deep() {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let width = numbers.first().copied().unwrap_or(640);
    let rounds = numbers.get(1).copied().unwrap_or(5);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().expect("threads");
    for (re, im, depth, iterations) in DEEP {
        let View { center, width: depth } = View::parse(re, im, depth).expect("a view");
        let size = [width, width * 3 / 4];
        let view = DeepView { center, width: depth, julia: None, bound: 100.0, iterations, size };
        let mut best = [f64::INFINITY; 2];
        let mut sums = [0; 2];
        for _ in 0..rounds {
            for i in 0..2 {
                let start = Instant::now();
                let control = Control::default();
                let found = pool.install(|| match i {
                    0 => deep_counts_one_by_one(&view, &control),
                    _ => deep_counts(&view, Level::new(), &control),
                });
                best[i] = best[i].min(start.elapsed().as_secs_f64());
                sums[i] = found.expect("nobody stops it").sum();
            }
        }
        println!("width {}, {} x {} pixels, m = {iterations}", view.width.to_decimal(2), size[0], size[1]);
        println!("  one by one {:>9.1} ms", 1e3 * best[0]);
        println!("  together   {:>9.1} ms, {:.2} times as fast", 1e3 * best[1], best[0] / best[1]);
        assert_eq!(sums[0], sums[1], "the same counts");
    }
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

fn run(program: &Path, size: usize, iterations: u32, repeats: usize) -> (f64, u64) {
    let numbers = [size, iterations as usize, THREADS, repeats].map(|n| n.to_string());
    let done = Command::new(program).args(numbers).output().expect("the C program runs");
    let text = String::from_utf8(done.stdout).expect("numbers");
    let mut words = text.split_whitespace();
    let seconds = words.next().and_then(|w| w.parse().ok()).expect("a time");
    (seconds, words.next().and_then(|w| w.parse().ok()).expect("a sum"))
}

/// Time and sum with new memory, and with memory that was used before.
fn ours(size: usize, iterations: u32) -> [(f64, u64); 2] {
    let parameters = Parameters { size: [size, size], iterations, ..Parameters::MANDELBROT };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().expect("threads");
    let mut counts = Counts::default();
    let mut once = || {
        let start = Instant::now();
        let level = Level::new();
        pool.install(|| counts_into(&parameters, false, level, &Control::default(), &mut counts))
            .expect("nobody stops it");
        (start.elapsed().as_secs_f64(), counts.sum())
    };
    [once(), once()]
}

fn report(iterations: u32, best: &[f64], sums: &[u64]) {
    println!("m = {iterations}");
    let names = PROGRAMS.iter().map(|p| p.0).chain(["Senca, new memory", "Senca"]);
    for ((name, seconds), sum) in names.zip(best).zip(sums) {
        println!("  {name:<20} {:>9.1} ms  {:>5.2} of C  sum {sum}", 1e3 * seconds, seconds / best[0]);
    }
    assert!(sums[3..].iter().all(|&sum| sum == sums[0]), "the same counts");
}
