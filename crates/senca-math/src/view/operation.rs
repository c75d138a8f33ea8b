//! Any of the viewing operations.

use super::{CentralByNormal, ParallelByNormal, View, View1991, ViewError, ViewParameters, ViewSteps};

/// A viewing operation with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewingOperation {
    /// A: central projection by centre, normal and distance.
    CentralByNormal(CentralByNormal),
    /// Parallel projection by point and normal.
    ParallelByNormal(ParallelByNormal),
    /// B: central projection by the general parameters.
    Central(ViewParameters),
    /// C: parallel projection by the general parameters.
    Parallel(ViewParameters),
    /// One of the forms of the 1991 text.
    View1991(View1991),
}

impl ViewingOperation {
    /// The named partial matrices, in the order of application.
    ///
    /// # Errors
    /// Everything that gives no view; see [`ViewError`].
    pub fn steps(&self) -> Result<ViewSteps, ViewError> {
        match self {
            Self::CentralByNormal(view) => view.steps(),
            Self::ParallelByNormal(view) => view.steps(),
            Self::Central(parameters) => parameters.central_steps(),
            Self::Parallel(parameters) => parameters.parallel_steps(),
            Self::View1991(view) => view.steps(),
        }
    }

    /// The view as renderers use it.
    ///
    /// # Errors
    /// Everything that gives no view; [`ViewError::NoVolume`] for the operations by normal, which are
    /// bounded by [`CentralByNormal::parameters`] and [`ParallelByNormal::parameters`].
    pub fn view(&self) -> Result<View, ViewError> {
        match self {
            Self::CentralByNormal(_) | Self::ParallelByNormal(_) => Err(ViewError::NoVolume),
            Self::Central(parameters) => parameters.central_view(),
            Self::Parallel(parameters) => parameters.parallel_view(),
            Self::View1991(view) => view.view(),
        }
    }
}
