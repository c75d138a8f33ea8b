//! Showing a solution.
//!
//! Light was computed for elements. A picture takes it between their nodes (see
//! [`NodeTransfer`](crate::NodeTransfer)):
//!
//! - [`shown_scene`] is a scene of unlit polygons with colours at the vertices, for the standard pipeline
//!   (interpolation in the picture) and for other programs;
//! - [`LightField`] tells the light at any place of a surface, for rays (interpolation in the scene).
//!
//! Source: course text, section 4.1 and tasks 4.2, 4.3 and 4.9.

mod field;
mod finder;
mod shown_scene;
mod surface_light;
#[cfg(test)]
mod tests;

pub use field::LightField;
pub use finder::{ElementFinder, Place};
pub(crate) use shown_scene::add_cameras;
pub use shown_scene::{ShownColors, shown_scene};
pub(crate) use surface_light::matt_share;
pub use surface_light::{Look, MeshLines, SeenPlaces, ShownLight};

/// What is taken for the light between the nodes of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// That of the element, everywhere the same.
    Flat,
    /// Between the values of its nodes.
    #[default]
    Smooth,
}
