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

mod clip;
mod dilogarithm;
mod edge_pair;
mod lambert;
mod polygon_pair;
mod quadrature;
mod visibility;

#[cfg(test)]
mod tests;

pub use lambert::point_to_polygon;
pub use polygon_pair::{differential, exchange, polygon_to_polygon, polygon_to_polygon_by_contours};
pub use visibility::{Unoccluded, Visibility};
