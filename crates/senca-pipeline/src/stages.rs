//! The textbook pipeline: every stage a step over a list.

mod texture_frame;

pub use texture_frame::{TextureFrame, texel_position};
