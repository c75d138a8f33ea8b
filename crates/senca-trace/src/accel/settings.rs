//! Which accelerator, and how it is built.

use std::fmt;
use std::str::FromStr;

use super::grid::MOST_CELLS;
use super::octree::DEEPEST;
use crate::TraceError;

/// The accelerators by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Accel {
    /// No acceleration.
    None,
    /// A sphere around every object.
    Spheres,
    /// A box around every object.
    Bounds,
    /// The scene's own tree as a hierarchy of boxes.
    Hierarchy,
    /// A uniform grid over all elements.
    Grid,
    /// An octree over all elements.
    Octree,
    /// A binary hierarchy of boxes over all elements.
    Sah,
    /// Wide hierarchies, one over the objects and one inside every mesh.
    #[default]
    Bvh,
}

impl Accel {
    /// All of them, from the simplest to the default.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Spheres,
        Self::Bounds,
        Self::Hierarchy,
        Self::Grid,
        Self::Octree,
        Self::Sah,
        Self::Bvh,
    ];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Spheres => "spheres",
            Self::Bounds => "bounds",
            Self::Hierarchy => "hierarchy",
            Self::Grid => "grid",
            Self::Octree => "octree",
            Self::Sah => "sah",
            Self::Bvh => "bvh",
        }
    }
}

impl fmt::Display for Accel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no accelerator of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no accelerator \"{0}\"; there are: {list}", list = Accel::ALL.map(Accel::name).join(", "))]
pub struct UnknownAccel(pub String);

impl FromStr for Accel {
    type Err = UnknownAccel;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|accel| accel.name() == name);
        found.ok_or_else(|| UnknownAccel(name.to_owned()))
    }
}

/// How an accelerator is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelSettings {
    /// Which one. Default [`Accel::Bvh`].
    pub kind: Accel,
    /// Cells of the grid along each axis, 1 to 256. Default `None`: about two cells for each element,
    /// more of them along the longer axes.
    pub grid_cells: Option<u32>,
    /// Levels of the octree below its root, 0 to 20. Default 12.
    pub octree_depth: u32,
    /// Elements that a leaf of the octree or of the binary hierarchy may hold without being divided,
    /// >= 1. Default 4.
    pub leaf_size: u32,
}

impl Default for AccelSettings {
    fn default() -> Self {
        Self { kind: Accel::default(), grid_cells: None, octree_depth: 12, leaf_size: 4 }
    }
}

impl From<Accel> for AccelSettings {
    fn from(kind: Accel) -> Self {
        Self { kind, ..Self::default() }
    }
}

impl AccelSettings {
    /// # Errors
    /// [`TraceError::Setting`] when a setting is out of its range.
    pub(super) fn check(&self) -> Result<(), TraceError> {
        let range = |name, value: u32, range: std::ops::RangeInclusive<u32>, expected| {
            let wrong = TraceError::Setting { name, value: f64::from(value), expected };
            if range.contains(&value) { Ok(()) } else { Err(wrong) }
        };
        range(
            "cells of the grid",
            self.grid_cells.unwrap_or(1),
            1..=MOST_CELLS,
            "from 1 to 256 along an axis",
        )?;
        range("depth of the octree", self.octree_depth, 0..=DEEPEST, "from 0 to 20")?;
        range("elements in a leaf", self.leaf_size, 1..=u32::MAX, "at least 1")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_others_are_told() {
        for accel in Accel::ALL {
            assert_eq!(accel.to_string().parse(), Ok(accel));
        }
        let error = "kd".parse::<Accel>().unwrap_err().to_string();
        assert!(error.contains("\"kd\"") && error.contains("bvh"), "{error}");
    }

    #[test]
    fn settings_out_of_range_are_told() {
        assert!(AccelSettings::default().check().is_ok());
        for wrong in [
            AccelSettings { grid_cells: Some(0), ..AccelSettings::default() },
            AccelSettings { octree_depth: 21, ..AccelSettings::default() },
            AccelSettings { leaf_size: 0, ..AccelSettings::default() },
        ] {
            assert!(matches!(wrong.check(), Err(TraceError::Setting { .. })), "{wrong:?}");
        }
    }
}
