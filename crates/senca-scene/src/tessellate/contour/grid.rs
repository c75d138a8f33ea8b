//! The grid of cubic cells, and which of them the surface may pass through.

use senca_math::Aabb;
use senca_math::glam::{DVec3, IVec3};

use super::field::Body;

/// Cubic cells around a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    origin: DVec3,
    pub(super) step: f64,
    pub(super) cells: IVec3,
}

impl Grid {
    /// About `along` cells on the longest side of `bounds`, with a margin all around. The margins are
    /// odd shares of a cell, so that flat sides seldom lie in a layer of corners.
    pub(super) fn around(bounds: &Aabb, along: u32) -> Self {
        let size = bounds.size();
        let step = size.max_element() / f64::from(along);
        let margin = DVec3::new(0.6137, 0.5711, 0.5393);
        let cells = (size / step + margin + 0.7).ceil().as_ivec3();
        Self { origin: bounds.min - step * margin, step, cells }
    }

    /// A place in units of cells from the first corner.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        self.origin + self.step * at
    }

    pub(super) fn corner(&self, corner: IVec3) -> DVec3 {
        self.place(corner.as_dvec3())
    }

    /// The box of `size` cells a side from the cell `first` on.
    pub(super) fn bounds(&self, first: IVec3, size: i32) -> Aabb {
        Aabb { min: self.corner(first), max: self.corner(first + size) }
    }

    /// Cells through which the surface may pass, from an octree whose nodes are left out when interval
    /// arithmetic shows that they are all inside or all outside.
    pub(super) fn mixed_cells(&self, body: &Body) -> Vec<IVec3> {
        let size = self.cells.max_element().max(1) as u32;
        let mut open = vec![(IVec3::ZERO, size.next_power_of_two() as i32)];
        let mut mixed = Vec::new();
        while let Some((first, size)) = open.pop() {
            if first.cmpge(self.cells).any() || body.classify(&self.bounds(first, size)).is_some() {
                continue;
            }
            if size == 1 {
                mixed.push(first);
                continue;
            }
            let half = size / 2;
            open.extend((0..8).rev().map(|i| (first + half * IVec3::new(i & 1, i >> 1 & 1, i >> 2), half)));
        }
        mixed
    }
}
