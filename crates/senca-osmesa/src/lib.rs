//! OpenGL 1.x off screen for C programs: `libOSMesa.so.8`.
//!
//! Everything is done by [`senca_gl::Context`]. What is here:
//!
//! 1. `current`: which context a thread has, and that nothing goes wrong without one.
//! 2. `memory`: reading and writing the program's memory; nearly all unsafe code is there.
//! 3. `commands`: tables of the `gl*` functions, each a line that hands over to a method of the context.
//! 4. `osmesa`: the `OSMesa*` functions; `picture` copies what was drawn to where the program wants it.
//!
//! A command without a current context does nothing and answers 0. So does one that is given NULL where it
//! needs numbers. A panic of the library ends in the command, which then is an `INVALID_OPERATION`.

#[macro_use]
mod table;

mod commands;
mod current;
mod memory;
mod osmesa;
mod picture;

#[cfg(test)]
mod tests;
