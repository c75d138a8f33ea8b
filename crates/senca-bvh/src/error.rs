//! What can be wrong with the input of a build.

/// Why a hierarchy could not be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A triangle names a point that is not there.
    #[error("triangle {triangle} uses point {index}, but there are {points} points")]
    IndexOutOfRange {
        /// The first such triangle.
        triangle: u32,
        /// The index it holds.
        index: u32,
        /// How many points there are.
        points: usize,
    },
    /// More triangles or boxes than the references of the hierarchy can count.
    #[error("{count} items are more than a hierarchy can hold, {limit}")]
    TooMany {
        /// How many were given.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
}
