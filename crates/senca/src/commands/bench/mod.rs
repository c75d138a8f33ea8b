//! `senca bench`: how fast this program is here, on data it makes itself.
//!
//! Every benchmark runs on one thread and on all of them, and where the fast form has a plain twin,
//! that runs too. The forms take turns, so that a change of the machine's mood meets all of them;
//! the median of the times is told, and ratios between them, which mean more than the times.

mod accel;
mod data;
mod list;
mod measure;

use std::fmt::Write;

use clap::Args;
use serde::Serialize;

use crate::cli::values::positive;
use crate::cli::{Failure, Interrupt, Progress, output};
use list::{ALL, Benchmark, Form};
use measure::{Runner, medians};

/// What is measured and for how long.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Benchmarks to run, or "accel" for a table of the ray tracer's accelerators [default: all but that]
    #[arg(value_name = "NAME")]
    names: Vec<String>,

    /// Numbers of spheres that "accel" compares on
    #[arg(long, value_name = "M,M,...", value_delimiter = ',', default_value = "10,100,1000",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    objects: Vec<u32>,

    /// Seconds for each measurement
    #[arg(long, value_name = "SECONDS", value_parser = positive, default_value = "0.5")]
    seconds: f64,

    /// Threads to compare with one [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Prints JSON instead of a table
    #[arg(long)]
    json: bool,

    /// No progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// What a benchmark showed. Times are medians in seconds.
#[derive(Debug, Serialize)]
struct Outcome {
    name: &'static str,
    about: &'static str,
    unit: &'static str,
    /// Units of work in one run.
    work: f64,
    threads: usize,
    seconds_one_thread: f64,
    seconds_all_threads: f64,
    /// Units of work per second on all threads.
    rate: f64,
    /// Time on one thread over time on all.
    speedup: f64,
    /// Time of the plain twin over time on all threads.
    #[serde(skip_serializing_if = "Option::is_none")]
    over_plain: Option<f64>,
}

/// Runs the benchmarks and prints what they showed.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.names == ["accel"] {
        return accel::run(&arguments.objects, arguments.json, arguments.quiet);
    }
    let chosen = chosen(&arguments.names)?;
    let interrupt = Interrupt::listen();
    let runner = Runner::new(arguments.threads.map(usize::from), arguments.seconds)?;
    let progress = Progress::new(arguments.quiet);
    let mut outcomes = Vec::new();
    for (done, benchmark) in chosen.iter().enumerate() {
        progress.report(done as f32 / chosen.len() as f32);
        if interrupt.is_raised() {
            return Err(Failure::Interrupted);
        }
        outcomes.push(outcome(benchmark, &runner)?);
    }
    progress.finish();
    output::print(&if arguments.json { json(&outcomes) } else { table(&outcomes) })
}

/// The benchmarks of these names, or all.
fn chosen(names: &[String]) -> Result<Vec<&'static Benchmark>, Failure> {
    if names.is_empty() {
        return Ok(ALL.iter().collect());
    }
    let known = || ALL.iter().map(|b| b.name).collect::<Vec<_>>().join(", ") + ", and alone accel";
    let find = |name: &String| {
        let found = ALL.iter().find(|b| b.name == name);
        found.ok_or_else(|| {
            Failure::usage(format!("there is no benchmark \"{name}\"; there are: {}", known()))
        })
    };
    names.iter().map(find).collect()
}

fn outcome(benchmark: &Benchmark, runner: &Runner) -> Result<Outcome, Failure> {
    let mut fast = (benchmark.prepare)(Form::Fast)?;
    let mut plain = if benchmark.has_plain_twin { Some((benchmark.prepare)(Form::Plain)?) } else { None };
    let [one, all, twin] = medians(runner, &mut *fast, plain.as_deref_mut());
    Ok(Outcome {
        name: benchmark.name,
        about: benchmark.about,
        unit: benchmark.unit,
        work: benchmark.work,
        threads: runner.threads(),
        seconds_one_thread: one,
        seconds_all_threads: all,
        rate: benchmark.work / all,
        speedup: one / all,
        over_plain: benchmark.has_plain_twin.then_some(twin / all),
    })
}

fn json(outcomes: &[Outcome]) -> String {
    let mut text = serde_json::to_string_pretty(outcomes).unwrap_or_default();
    text.push('\n');
    text
}

fn table(outcomes: &[Outcome]) -> String {
    let threads = outcomes.first().map_or(1, |o| o.threads);
    let mut text = format!(
        "{:<10} {:>12} {:>20} {:>14} {:>10}  {}\n",
        "",
        "time",
        "rate",
        format!("{threads} threads : 1"),
        "plain twin",
        "what"
    );
    for o in outcomes {
        let twin = o.over_plain.map_or_else(|| "-".to_owned(), |r| format!("{r:.1} x"));
        let rate = format!("{} {}/s", significant(o.rate), o.unit);
        let time = format!("{} ms", significant(1e3 * o.seconds_all_threads));
        let speedup = format!("{:.2} x", o.speedup);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<10} {time:>12} {rate:>20} {speedup:>14} {twin:>10}  {}", o.name, o.about);
    }
    text
}

/// Three significant digits.
fn significant(v: f64) -> String {
    let digits = 2 - v.abs().max(1e-9).log10().floor() as i32;
    format!("{v:.*}", digits.clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_with_three_digits() {
        assert_eq!(significant(1234.6), "1235");
        assert_eq!(significant(12.346), "12.3");
        assert_eq!(significant(0.012_346), "0.0123");
    }

    #[test]
    fn unknown_benchmarks_are_told_with_those_there_are() {
        let failure = chosen(&["nonsense".to_owned()]).expect_err("unknown");
        assert!(failure.message().is_some_and(|m| m.contains("fill")));
        assert_eq!(chosen(&[]).map_or(0, |all| all.len()), ALL.len());
    }
}
