//! OpenGL 1.x off screen for C programs: `libOSMesa.so.8`.
//!
//! The `gl*` functions are those of [`senca_gl_abi`]. What is here:
//!
//! 1. `osmesa`: the `OSMesa*` functions.
//! 2. `picture`: copies what was drawn to where the program wants it.
//! 3. `memory`: large blocks of memory are kept for the next who wants some.

#[cfg(target_os = "linux")]
mod memory;
mod osmesa;
mod picture;
