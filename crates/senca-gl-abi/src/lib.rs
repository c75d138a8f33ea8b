//! OpenGL 1.x for C programs: the `gl*` functions, which `libOSMesa.so.8` and `libGL.so.1` have in common.
//!
//! Everything is done by [`senca_gl::Context`]. What is here:
//!
//! 1. [`current`]: which context a thread has, and that nothing goes wrong without one.
//! 2. [`memory`]: reading and writing the program's memory; nearly all unsafe code is there.
//! 3. `commands`: tables of the `gl*` functions, each a line that hands over to a method of the context. A
//!    library for C that depends on this crate exports them all.
//!
//! A command without a current context does nothing and answers 0. So does one that is given NULL where it
//! needs numbers. A panic of the library ends in the command, which then is an `INVALID_OPERATION`.

#[macro_use]
mod table;

mod commands;
pub mod current;
pub mod memory;
mod pool;

#[cfg(test)]
mod tests;

pub use commands::find;
pub use table::{Answer, Entry};
