//! OpenGL 1.x in windows of X for C programs: `libGL.so.1`.
//!
//! The `gl*` functions are those of [`senca_gl_abi`]. What is here:
//!
//! 1. `glx`: the `glX*` functions, which the program calls with its own connection to the server.
//! 2. `config`: which kinds of buffers there are, and which of them a program asks for.
//! 3. `drawable`: windows, pixmaps and off-screen buffers, and the one that a context draws to.
//! 4. `image`: what was drawn, as the server takes it, by shared memory where that is possible.
//! 5. `server`: the functions of Xlib, found when they are first needed; `font` makes lists of X's fonts.
//!
//! Everything happens in the program: the server needs no GLX extension, and gets finished pictures.

#![cfg(unix)]

mod config;
mod drawable;
mod font;
mod glx;
mod image;
mod server;
