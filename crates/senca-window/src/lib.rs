//! Interactive programs whose pictures the processor draws.
//!
//! A [`Program`] gets [`Event`]s and draws itself into a [`Canvas`]; whoever runs it decides where
//! the events come from and where the picture goes.

mod canvas;
mod event;

pub use canvas::Canvas;
pub use event::{Button, Event, Flow, Key, Program};
