//! Why light could not be computed.

use senca_math::Cancelled;
use senca_scene::ShapeError;

/// Why there is no solution. Variants come in the order input, parameter, caller.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RadiosityError {
    /// A shape of the scene cannot be covered with patches.
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
    /// The mesh would have more elements than memory is allowed for.
    #[error("the mesh needs more than {limit} elements: allow larger ones")]
    TooManyElements {
        /// The limit.
        limit: usize,
    },
    /// A matrix of form factors would need more memory than is allowed.
    #[error("a matrix of {patches} x {patches} form factors is too large: {limit} patches are the most")]
    MatrixTooLarge {
        /// Patches given.
        patches: usize,
        /// The limit.
        limit: usize,
    },
    /// There would be more form factors than memory is allowed for.
    #[error(
        "the mesh needs more than {limit} form factors: allow larger patches, or use the hierarchical method"
    )]
    TooManyFactors {
        /// The limit.
        limit: u64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for RadiosityError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
