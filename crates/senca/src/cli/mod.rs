//! What all subcommands share: values of options, output, progress, figures, and how to end.

mod failure;
mod indexed;
pub(crate) mod input;
pub(crate) mod interactive;
mod interrupt;
mod light;
pub(crate) mod output;
mod progress;
mod stats;
mod threads;
pub(crate) mod values;

pub(crate) use failure::Failure;
pub(crate) use interrupt::Interrupt;
pub(crate) use light::{Light, LightArguments, LightFiles};
pub(crate) use progress::Progress;
pub(crate) use stats::{
    RadiosityStats, Seconds, Stages, Stats, Stopwatch, TracingStats, Triangles, peak_bytes,
};
pub(crate) use threads::use_threads;
