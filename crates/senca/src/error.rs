//! What can go wrong between a scene and its picture.

use senca_math::ViewError;
use senca_pipeline::RenderError;
use senca_radiosity::{RadiosityError, SavedSolutionError};
use senca_trace::{SavedFilmError, TraceError};

/// Why [`render`](crate::render) gave no picture. Variants come in the order caller, input.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene has no camera of that name.
    #[error("there is no camera \"{name}\"; {}", listed("camera", known))]
    UnknownCamera {
        /// What was asked for.
        name: String,
        /// The cameras there are.
        known: Vec<String>,
    },
    /// The scene has no animation of that name.
    #[error("there is no animation \"{name}\"; {}", listed("animation", known))]
    UnknownAnimation {
        /// What was asked for.
        name: String,
        /// The animations there are.
        known: Vec<String>,
    },
    /// The scene has no object of that name, or none with a flat face as asked for.
    #[error(
        "there is no object \"{name}\" with a flat face that looks as asked; {}",
        listed("object", known)
    )]
    UnknownObject {
        /// What was asked for.
        name: String,
        /// The objects there are.
        known: Vec<String>,
    },
    /// The camera gives no view.
    #[error("the camera gives no view: {0}")]
    View(#[from] ViewError),
    /// The pipeline gave no picture.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The tracer gave no picture.
    #[error(transparent)]
    Trace(TraceError),
    /// A partial picture cannot be gone on with.
    #[error("{0}")]
    Partial(SavedFilmError),
    /// Light could not be computed.
    #[error(transparent)]
    Radiosity(RadiosityError),
    /// A saved solution cannot be used.
    #[error("{0}")]
    SavedLight(#[from] SavedSolutionError),
    /// The settings contradict each other.
    #[error("{0}")]
    Combination(String),
}

impl From<TraceError> for Error {
    /// Whoever cancels need not know what was cancelled.
    fn from(error: TraceError) -> Self {
        match error {
            TraceError::Cancelled => Self::Render(RenderError::Cancelled),
            other => Self::Trace(other),
        }
    }
}

impl From<RadiosityError> for Error {
    /// Whoever cancels need not know what was cancelled.
    fn from(error: RadiosityError) -> Self {
        match error {
            RadiosityError::Cancelled => Self::Render(RenderError::Cancelled),
            other => Self::Radiosity(other),
        }
    }
}

impl From<SavedFilmError> for Error {
    /// Settings that are wrong are so with or without a partial picture.
    fn from(error: SavedFilmError) -> Self {
        match error {
            SavedFilmError::Settings(error) => Self::Trace(error),
            other => Self::Partial(other),
        }
    }
}

/// `the scene has: "a", "b"`, or that it has none, or none with a name.
fn listed(what: &str, known: &[String]) -> String {
    let quoted: Vec<_> =
        known.iter().filter(|name| !name.is_empty()).map(|name| format!("\"{name}\"")).collect();
    match (known.len(), quoted.is_empty()) {
        (0, _) => format!("the scene has no {what}"),
        (_, true) => format!("the scene has no {what} with a name"),
        _ => format!("the scene has: {}", quoted.join(", ")),
    }
}

impl Error {
    /// Whether the call was at fault, and not the scene.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        use RenderError::{Crop, EmptyImage, ImageTooLarge, Setting};
        match self {
            Self::UnknownCamera { .. } | Self::UnknownAnimation { .. } | Self::UnknownObject { .. } => true,
            Self::View(_) | Self::Partial(_) | Self::SavedLight(_) => false,
            Self::Radiosity(error) => {
                matches!(error, RadiosityError::Setting { .. } | RadiosityError::TooManyElements { .. })
            }
            Self::Trace(error) => matches!(error, TraceError::Setting { .. }),
            Self::Combination(_) => true,
            Self::Render(error) => {
                matches!(error, Crop { .. } | EmptyImage { .. } | ImageTooLarge { .. } | Setting { .. })
            }
        }
    }
}
