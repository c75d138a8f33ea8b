//! Form factors by each method: F_i->j is the share of the light leaving patch i that lands on
//! patch j (course text, section 4.2).
//!
//! | method | what it gives | obstacles |
//! |---|---|---|
//! | [`differential`] | two small patches, equation 4.7 | asked for apart |
//! | [`point_to_polygon`] | a small patch and a polygon, equation 4.8, in closed form | no |
//! | [`polygon_to_polygon`] | two polygons, equation 4.9, in closed form | no |
//! | [`double_area`] | two polygons, equation 4.9 as a sum | a ray for each pair of parts |
//! | [`nusselt_area`], [`nusselt_count`] | a small patch and a polygon, by projection | no |
//! | [`HemicubeView`] | a polygon and all patches, equations 4.10 to 4.13 | in item buffers |
//! | [`ray_cast`] | two patches: closed form times visible share | by rays |
//! | [`monte_carlo`] | a patch and all patches, with standard errors | by rays |
//! | [`closed_form`] | rectangles, discs, spheres: formulas to check by | no |
//!
//! [`FormFactors`] has all factors of a set of patches by any [`Method`], [`group_factor`] compares the
//! methods on one pair. [`Visibility`] is what they ask about obstacles; [`PatchScene`] and
//! [`crate::Occluders`] answer.
//!
//! A patch has one front, where its corners run counter-clockwise; only fronts give and take. A sheet
//! with two sides is two patches, one the reverse of the other.
//!
//! ```
//! use senca_math::glam::DVec3;
//! use senca_radiosity::form_factor::{closed_form, polygon_to_polygon};
//!
//! let floor = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
//! let wall = [DVec3::ZERO, DVec3::Y, DVec3::new(0.0, 1.0, 1.0), DVec3::Z];
//! let factor = polygon_to_polygon(&floor, &wall);
//! assert!((factor - closed_form::perpendicular_rectangles(1.0, 1.0, 1.0)).abs() < 1e-12);
//! ```

mod cells;
pub(crate) mod clip;
pub mod closed_form;
mod cost;
mod dilogarithm;
mod double_area;
mod edge_pair;
mod group;
mod hemicube;
mod lambert;
mod matrix;
mod method;
mod monte_carlo;
mod nusselt;
mod patch_scene;
mod polygon_pair;
mod quadrature;
mod ray_cast;
mod visibility;

#[cfg(test)]
mod tests;

pub use cost::Cost;
pub use double_area::double_area;
pub use group::{GroupFactor, group_factor};
pub use hemicube::{CellFactor, Hemicube, HemicubeView};
pub use lambert::point_to_polygon;
pub use matrix::{FormFactors, RowSums};
pub use method::{Method, MethodSettings};
pub use monte_carlo::{MonteCarloRow, MonteCarloSettings, monte_carlo};
pub use nusselt::{nusselt_area, nusselt_count, nusselt_directions, nusselt_outline};
pub use patch_scene::{FirstHit, PatchScene};
pub use polygon_pair::{differential, exchange, polygon_to_polygon, polygon_to_polygon_by_contours};
pub use ray_cast::{RayCastSettings, ray_cast, ray_cast_exchange, visible_share};
pub use visibility::{Unoccluded, Visibility, WorldVisibility};
