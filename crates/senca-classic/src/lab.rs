//! The eight laboratory exercises of "Interactive computer graphics: laboratory exercises"
//! (Ž. Mihajlović, FER Zagreb, 2020), step by step as the manual gives them.
//!
//! 1. [`vectors`]: vectors and matrices, the system of three equations, barycentric coordinates.
//! 2. [`mod@line`]: Bresenham's line beside the built-in one.
//! 3. [`polygon`]: a convex polygon, its orientation, the point test, filling.
//! 4. [`solid`]: plane equations of a solid, and whether a point lies in it.
//! 5. [`view`]: the view transform both ways, and perspective.
//! 6. [`bezier`]: curves of any degree by both forms, and an eye that moves along one.
//! 7. [`shading`]: back faces, the lighting model, constant and Gouraud shading.
//! 8. [`fractal`]: Mandelbrot and Julia sets, quickly and deep.
//!
//! The manual writes points as *rows* that are multiplied by matrices from the right, and lines and
//! planes as columns; so does this module, unlike the rest of the house. Where a printed formula is
//! wrong, the right one is used and the slip is told beside it. y points up in all numbers and
//! pictures of exercises 1 and 3 to 7; exercises 2 and 8 count pixels, with y downwards.

pub mod bezier;
pub mod draw;
mod error;
pub mod fractal;
mod input;
pub mod line;
pub mod polygon;
pub mod programs;
pub mod shading;
pub mod solid;
mod space;
pub mod vectors;
pub mod view;

pub use error::LabError;
pub use input::Input;
