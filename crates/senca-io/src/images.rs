//! Pictures: decoding textures, and encoding what a renderer has drawn.
//!
//! What a file is, is told by its content; its name is only used in messages, and for TGA, which has
//! no mark of its own. Readable are PNG, JPEG, BMP, PBM/PGM/PPM/PAM, TGA, GIF (first frame), WebP,
//! OpenEXR, Radiance HDR and PFM. Colour profiles, gamma chunks and orientation tags are passed
//! over: 8-bit colour is sRGB.
//!
//! Writing follows three rules. A component that is NaN is written as 0, in every format. In 8-bit
//! formats light outside [0, 1] is clamped; float formats keep it. Formats without alpha show the
//! picture over black.

mod decode;
mod encode;
mod pfm;

pub use decode::{decode, decode_as, decode_picture};
pub use encode::{PictureFormat, PictureOptions, PngCompression, encode};

#[cfg(test)]
mod tests;
