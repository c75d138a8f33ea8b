//! Pixels between client memory and the framebuffer: drawing, reading and copying rectangles, and bitmaps.
//!
//! Source: "The OpenGL Graphics System", version 1.5, sections 3.6, 3.7 and 4.3.

mod bitmap;
mod draw;
mod maps;
mod place;
mod read;
mod rows;

#[cfg(test)]
mod tests;
