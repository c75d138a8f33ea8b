//! What is drawn to and read from: the window's buffers and framebuffer objects.
//!
//! 1. A [`Plane`] is a rectangle of pixels of one kind, wherever it is kept: in the window, a renderbuffer or a
//!    texture.
//! 2. [`Framebuffers`] knows the window, the framebuffer objects and which are bound.
//! 3. To be drawn to, planes are taken out of where they are kept ([`DrawPlanes`]) and put back afterwards; to be
//!    read, their memory is shared.
//!
//! Row 0 is the lowest. A multisample plane has twice as many rows and columns.
//!
//! Source: "The OpenGL Graphics System", version 1.5, chapter 4; ARB_framebuffer_object.

mod accum;
mod attach;
mod blit;
mod buffers;
mod clear;
mod commands;
mod draw;
mod fill;
mod object;
mod plane;
mod window;

#[cfg(test)]
mod tests;

pub(crate) use blit::Aspect;
pub(crate) use clear::WaitingClear;
pub(crate) use draw::{DrawPlanes, Use, Uses};
pub(crate) use object::{Framebuffers, MAX_COLOR_ATTACHMENTS, Renderbuffers, SavedBuffers};
pub(crate) use plane::{Area, Plane, SAMPLES};
pub(crate) use window::Window;

/// Largest side of a renderbuffer.
pub(crate) const MAX_RENDERBUFFER_SIZE: u32 = 8192;
