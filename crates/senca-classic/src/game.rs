//! The game library of 1995 and a street to fly through with it.

mod angle;
mod borders;
mod clip;
mod color_map;
mod exact_frame;
mod fill;
mod film;
mod fixed;
mod flight;
mod frame;
mod line;
mod matrix;
mod measure;
mod project;
mod reference;
mod rotate;
mod scene;
mod street;
mod texture;
mod volume;

pub use angle::{Angle, Angles, PARTS_PER_RADIAN, Tables};
pub use borders::{BORDER_BITS, Borders, Span};
pub use clip::{Bounds, ClippedLine, Search, clip_line, clip_line_to_screen, clip_polygon};
pub use color_map::{ColorMap, LARGEST_SIDE};
pub use exact_frame::{draw_frame_exactly, view_exact};
pub use fill::{SpanFill, fill_flat, fill_shaded};
pub use film::{FILM_DELAY, FilmError, FilmFormat, LONGEST_FILM, film, sheet};
pub use fixed::{Fixed, FixedFormat, ROTATION_BITS, positional_value};
pub use flight::{Flight, Moment, SCREEN, Show};
pub use frame::{Arithmetic, Counters, Stages, Surface, Viewer, draw_frame};
pub use line::{Bresenham, draw_line, draw_line_by_address, pixels_by_columns, pixels_by_longer_range};
pub use matrix::Matrix;
pub use measure::{
    ErrorStatistics, MEASURED_MAPPINGS, MEASURED_MOMENTS, Measures, Wobble, measure, wall_errors,
};
pub use project::{DepthKept, FARTHEST_PIXEL, Lens, Projection, view_angle};
pub use reference::{ExactPlane, clip_exact, for_each_pixel_within, project_corners};
pub use rotate::{Coefficient, Number, Rotation, SinCos, rotate_in_plane, scale, translate};
pub use scene::{Body, Face, FaceTexture, LightTable, World};
pub use street::street;
pub use texture::{
    CORNER_BITS, Mapping, TEXEL_BITS, Texture, TextureArithmetic, TextureMapping, TexturePlane,
    TexturedPolygon, fill_lit, fill_textured, for_each_textured_pixel,
};
pub use volume::{VolumeTest, test_volume};
