//! Why a picture could not be traced.

use senca_math::Cancelled;
use senca_scene::ShapeError;

/// Why tracing gave no picture. Variants come in the order input, parameter, caller.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// A shape of the scene cannot be traced.
    #[error("geometry {geometry} ({name:?}): {source}")]
    Shape {
        /// Number of the geometry.
        geometry: u32,
        /// Its name.
        name: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// A setting is out of its range.
    #[error("{name} is {value}, but must be {expected}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for TraceError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
