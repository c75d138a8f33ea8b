//! Boxes as the build wants them.

use crate::Aabb32;
use senca_math::glam::Vec3;

/// A box as eight numbers of which the union takes the smaller: three smallest coordinates, something
/// else, three largest coordinates negated, something else.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Extent([f32; 8]);

impl Default for Extent {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Extent {
    pub(crate) const EMPTY: Self = Self([f32::INFINITY; 8]);

    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        let mut both = self.0;
        for (a, b) in both.iter_mut().zip(other.0) {
            *a = if b < *a { b } else { *a };
        }
        Self(both)
    }

    /// Half of the surface: infinite or NaN for boxes that are not finite.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.max(axis) - self.min(axis));
        x * (y + z) + y * z
    }

    #[inline(always)]
    pub(crate) fn min(&self, axis: usize) -> f32 {
        self.0[axis]
    }

    #[inline(always)]
    pub(crate) fn max(&self, axis: usize) -> f32 {
        -self.0[4 + axis]
    }

    /// Twice the centre, per axis. Boxes without end have theirs at the origin.
    #[inline(always)]
    pub(crate) fn center2(&self) -> [f32; 3] {
        let e = &self.0;
        [e[0] - e[4], e[1] - e[5], e[2] - e[6]].map(|c| if c.is_finite() { c } else { 0.0 })
    }

    pub(crate) fn as_box(&self) -> Aabb32 {
        let [x, y, z, _, nx, ny, nz, _] = self.0;
        Aabb32 { min: Vec3::new(x, y, z), max: Vec3::new(-nx, -ny, -nz) }
    }
}

/// Something with a box and an index of the caller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    /// The fourth number is the index, bit by bit.
    pub(crate) extent: Extent,
}

impl Item {
    #[inline(always)]
    pub(crate) fn new(index: u32, min: Vec3, max: Vec3) -> Self {
        Self { extent: Extent([min.x, min.y, min.z, f32::from_bits(index), -max.x, -max.y, -max.z, 0.0]) }
    }

    #[inline(always)]
    pub(crate) fn index(&self) -> u32 {
        self.extent.0[3].to_bits()
    }

    /// Twice the centre, as a box.
    #[inline(always)]
    pub(crate) fn center(&self) -> Extent {
        let [x, y, z] = self.extent.center2();
        Extent([x, y, z, 0.0, -x, -y, -z, 0.0])
    }
}
