//! The methods by name, with what each may be told.

use super::{CellFactor, MonteCarloSettings, RayCastSettings};

/// A way to form factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`super::polygon_to_polygon`]: closed form, without obstacles.
    Exact,
    /// [`super::polygon_to_polygon_by_contours`]: its twin by quadrature, without obstacles.
    Contours,
    /// [`super::double_area`]: the double sum with a line of sight for each pair of parts.
    DoubleArea,
    /// Nusselt's analogy: from points of a patch, the share of the disc in which each other is seen.
    Nusselt,
    /// [`super::HemicubeView`]: half cubes.
    Hemicube,
    /// [`super::ray_cast`]: closed form times the visible share.
    RayCast,
    /// [`super::monte_carlo`]: rays by chance.
    MonteCarlo,
}

impl Method {
    /// All, in the order of the documents.
    pub const ALL: [Self; 7] = [
        Self::Exact,
        Self::Contours,
        Self::DoubleArea,
        Self::Nusselt,
        Self::Hemicube,
        Self::RayCast,
        Self::MonteCarlo,
    ];

    /// The name users know it by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Contours => "contour",
            Self::DoubleArea => "double-area",
            Self::Nusselt => "nusselt",
            Self::Hemicube => "hemicube",
            Self::RayCast => "ray-cast",
            Self::MonteCarlo => "monte-carlo",
        }
    }

    /// Whether it sees obstacles.
    #[must_use]
    pub const fn sees_obstacles(self) -> bool {
        !matches!(self, Self::Exact | Self::Contours)
    }
}

/// How fine the methods work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSettings {
    /// Patches are divided in so many parts each way, 1 or more: by [`Method::Nusselt`] and
    /// [`Method::Hemicube`] those that see. Default 4.
    pub parts: usize,
    /// Parts each way of both patches for [`Method::DoubleArea`], 1 or more. Default 8.
    pub double_area_parts: usize,
    /// Directions across the disc for [`Method::Nusselt`], 1 or more. Default 100.
    pub directions: usize,
    /// Cells along an edge for [`Method::Hemicube`], an even number from 2 to 4096. Default 100.
    pub resolution: u32,
    /// What cells count for [`Method::Hemicube`]. Default [`CellFactor::Exact`].
    pub cell_factor: CellFactor,
    /// For [`Method::RayCast`].
    pub ray_cast: RayCastSettings,
    /// For [`Method::MonteCarlo`].
    pub monte_carlo: MonteCarloSettings,
}

impl Default for MethodSettings {
    fn default() -> Self {
        Self {
            parts: 4,
            double_area_parts: 8,
            directions: 100,
            resolution: 100,
            cell_factor: CellFactor::default(),
            ray_cast: RayCastSettings::default(),
            monte_carlo: MonteCarloSettings::default(),
        }
    }
}
