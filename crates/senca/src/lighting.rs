//! Pictures by radiosity: light computed once, shown from anywhere.

mod face;
mod measure;
mod settings;
mod show;
mod solve;
#[cfg(test)]
mod tests;

pub use face::LuxPlaces;
pub use measure::{
    Baking, BeyondWhite, ColorEncoding, bake_light, bake_light_picture, beyond_white, measure_lux,
};
pub use settings::{Display, RadiositySettings, Show, Solver};
pub use show::show_light;
pub use solve::{ComputedLight, OnRound, compute_light, scene_light_fingerprint};
