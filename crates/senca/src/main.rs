//! The `senca` command: reads the command line, runs one subcommand, turns its end into an exit
//! status. 0 is success, 1 bad input, 2 bad usage, 101 a fault of the program, 130 Ctrl-C.

mod cli;
mod commands;

use std::process::ExitCode;

use clap::Parser;

use cli::output::tell;

fn main() -> ExitCode {
    report_faults();
    let command = commands::Senca::parse();
    match commands::run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(message) = failure.message() {
                tell(&message);
            }
            failure.exit_code()
        }
    }
}

/// A panic is a fault of this program; its report says how to repeat it.
fn report_faults() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|l| format!(" at {}:{}", l.file(), l.line())).unwrap_or_default();
        let payload = panic.payload();
        let text = payload.downcast_ref::<&str>().copied();
        let what = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("unknown");
        tell(&format!(
            "senca: internal fault{place}: {what}\nsenca: this is a bug in senca; to repeat it:\n  {}",
            command_line()
        ));
    }));
}

/// The command line, quoted for a shell.
fn command_line() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+@%#".contains(c);
    let quote = |word: String| {
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    std::env::args_os().map(|word| quote(word.to_string_lossy().into_owned())).collect::<Vec<_>>().join(" ")
}
