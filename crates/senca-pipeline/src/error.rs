//! Why a picture could not be drawn.

use senca_math::Cancelled;
use senca_scene::ShapeError;

use crate::settings::Crop;

/// Why [`crate::render`] gave no picture. Variants come in the order input, parameter, limit, caller.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// A shape of the scene has no mesh.
    #[error("geometry {geometry} ({name:?}): {source}")]
    Shape {
        /// Number of the geometry.
        geometry: u32,
        /// Its name.
        name: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// The scene names an entry that it does not have.
    #[error("the scene names {kind} {index}, but there are only {count}")]
    IndexOutOfRange {
        /// Kind of the entry.
        kind: &'static str,
        /// Number named.
        index: u32,
        /// Number of entries.
        count: usize,
    },
    /// The picture has no pixels.
    #[error("a picture of {width} x {height} pixels cannot be drawn: both sides must be at least 1")]
    EmptyImage {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// The picture is too large for a rasterizer.
    #[error("a picture of {width} x {height} pixels is too large: a side may have {most} pixels at most")]
    ImageTooLarge {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// Longest side that is possible.
        most: u32,
    },
    /// The crop is empty or leaves the picture.
    #[error(
        "the crop of {width} x {height} pixels at ({x}, {y}) is not inside the picture of {image_width} x {image_height}"
    )]
    Crop {
        /// First column.
        x: u32,
        /// First row.
        y: u32,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Width of the picture.
        image_width: u32,
        /// Height of the picture.
        image_height: u32,
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
    /// A texture cannot be used.
    #[error("image {image} ({name:?}): {reason}")]
    Texture {
        /// Number of the picture.
        image: u32,
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// More triangles than identifiers.
    #[error("the scene has {count} triangles; at most {most} can be drawn", most = u32::MAX - 1)]
    TooManyTriangles {
        /// Triangles of all instances.
        count: u64,
    },
    /// Threads could not be started.
    #[error("{count} threads could not be started: {reason}")]
    Threads {
        /// Threads asked for.
        count: usize,
        /// What the system said.
        reason: String,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for RenderError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl RenderError {
    /// `Ok` when a picture of this size can be drawn.
    pub(crate) fn check_size([width, height]: [u32; 2]) -> Result<(), Self> {
        let most = senca_raster::MAX_TARGET_SIDE - 4;
        match () {
            () if width == 0 || height == 0 => Err(Self::EmptyImage { width, height }),
            () if width.max(height) > most => Err(Self::ImageTooLarge { width, height, most }),
            () => Ok(()),
        }
    }

    /// That an area is too large for a rasterizer.
    pub(crate) fn area_too_large(area: &Crop) -> Self {
        let most = senca_raster::MAX_TARGET_SIDE;
        Self::ImageTooLarge { width: area.width, height: area.height, most }
    }
}
