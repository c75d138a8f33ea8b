//! Form factors by each method: F_i->j is the share of the light leaving patch i that lands on
//! patch j (course text, section 4.2).
//!
//! | method | what it gives | obstacles |
//! |---|---|---|
//! | [`differential`] | two small patches, equation 4.7 | one ray |
//! | [`point_to_polygon`] | a small patch and a polygon, equation 4.8, in closed form | no |
//! | [`polygon_to_polygon`] | two polygons, equation 4.9, in closed form | no |
//!
//! A patch has one front, where its corners run counter-clockwise; only fronts give and take. A sheet
//! with two sides is two patches, one the reverse of the other.

mod cells;
mod clip;
pub mod closed_form;
mod cost;
mod dilogarithm;
mod double_area;
mod edge_pair;
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
pub use hemicube::{CellFactor, Hemicube, HemicubeView};
pub use lambert::point_to_polygon;
pub use matrix::{FormFactors, RowSums};
pub use method::{Method, MethodSettings};
pub use monte_carlo::{MonteCarloRow, MonteCarloSettings, monte_carlo};
pub use nusselt::{nusselt_area, nusselt_count, nusselt_directions, nusselt_outline};
pub use patch_scene::{FirstHit, PatchScene};
pub use polygon_pair::{differential, exchange, polygon_to_polygon, polygon_to_polygon_by_contours};
pub use ray_cast::{RayCastSettings, ray_cast, ray_cast_exchange, visible_share};
pub use visibility::{Unoccluded, Visibility};
