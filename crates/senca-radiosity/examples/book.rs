//! Computes the light of a scene by the method of the book and tells what it costs.
//!
//! `book SCENE [--patch SIZE] [--rounds N] [--threads N] [--hemicube] [--repeat N]`

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use senca_math::Control;
use senca_radiosity::book::{BookSettings, FactorMethod, Solved, solve};

#[expect(clippy::print_stdout, reason = "a program tells on standard output")]
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1).map(String::as_str)
    };
    let path =
        arguments.first().ok_or("book SCENE [--patch SIZE] [--rounds N] [--threads N] [--hemicube]")?;
    let scene = senca_io::load(Path::new(path))?;
    let mut settings = BookSettings::default();
    settings.mesh.patch_size = value("--patch").map(str::parse).transpose()?;
    settings.rounds = value("--rounds").map_or(Ok(settings.rounds), str::parse)?;
    if arguments.iter().any(|argument| argument == "--hemicube") {
        settings.factors = FactorMethod::HEMICUBE;
    }
    let threads: usize = value("--threads").map_or(Ok(0), str::parse)?;
    let repeat: u32 = value("--repeat").map_or(Ok(1), str::parse)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let (mut best, mut solved) = (f64::INFINITY, Solved::default());
    for _ in 0..repeat.max(1) {
        let start = Instant::now();
        solved = pool.install(|| solve(&scene, &settings, &Control::default(), |_| ()))?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{best:.3} s on {} threads", pool.current_num_threads());
    println!("{:?}\n{:?}", solved.report, solved.solution.report);
    for warning in &solved.warnings {
        println!("{}", warning.0);
    }
    Ok(())
}
