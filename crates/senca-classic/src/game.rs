//! The game library of 1995 and a street to fly through with it.

mod angle;
mod clip;
mod fixed;
mod matrix;
mod project;
mod rotate;
mod volume;

pub use angle::{Angle, Angles, PARTS_PER_RADIAN, Tables};
pub use clip::{Bounds, ClippedLine, Search, clip_line, clip_line_to_screen, clip_polygon};
pub use fixed::{Fixed, FixedFormat, ROTATION_BITS, positional_value};
pub use matrix::Matrix;
pub use project::{DepthKept, FARTHEST_PIXEL, Lens, Projection, view_angle};
pub use rotate::{Coefficient, Number, Rotation, SinCos, rotate_in_plane, scale, translate};
pub use volume::{VolumeTest, test_volume};
