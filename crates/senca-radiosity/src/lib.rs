//! Radiosity: the exchange of light between matt surfaces (course text, chapter 4), and what research
//! added to it.
//!
//! Light is counted in the unit of pictures: the radiosity B of a patch is what the patch shows, its
//! emission E what it shows by itself, so that `B = E + reflectance * H` where H is the mean of B over
//! what the patch sees, weighted by form factors. A point light of intensity 1 straight above a white
//! patch makes it show 1. In photometric units a shown 1 is 1 cd/m², and the illuminance π H lux.

mod bake;
pub mod book;
mod direct;
pub mod display;
mod error;
pub mod false_color;
pub mod form_factor;
mod gather;
mod hierarchy;
mod lux;
mod mesh;
mod nodes;
mod occluders;
mod open_parts;
mod patch_polygon;
mod saved;
mod solution;
pub mod system;

pub use bake::{bake_light_picture, bake_lightmap, bake_vertex_colors};
pub use direct::{DirectLight, DirectSample, DirectSettings};
pub use error::RadiosityError;
pub use gather::{Gather, GatherSettings, regather_reflected};
pub use hierarchy::{HierarchySettings, solve_hierarchy};
pub use lux::{LuxGrid, LuxReport, MOST_LUX_PLACES};
pub use mesh::{CornerAttributes, Element, ElementMesh, MeshSettings, NONE, Polygon, RadiantSurface, Sides};
pub use nodes::{Extrapolation, NodeTransfer, NodeValues};
pub use occluders::{Occluders, PolygonHit};
pub use patch_polygon::PatchPolygon;
pub use saved::{SavedSolutionError, light_fingerprint};
pub use solution::{Solution, SolveReport};
