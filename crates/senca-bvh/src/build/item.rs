//! Boxes as the build wants them.

use crate::Aabb32;
use fearless_simd::{Simd, f32x4, f32x8, prelude::*};
use senca_math::glam::Vec3;

/// A box as eight numbers of which the union takes the smaller: three smallest coordinates, something
/// finite, three largest coordinates negated, something finite.
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
    pub(crate) fn load<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.0)
    }

    #[inline(always)]
    pub(crate) fn store<S: Simd>(lanes: f32x8<S>) -> Self {
        Self(lanes.to_array())
    }

    /// Half of the surface: infinite or NaN for boxes that are not finite.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let e = &self.0;
        let (x, y, z) = (-e[4] - e[0], -e[5] - e[1], -e[6] - e[2]);
        x * (y + z) + y * z
    }

    /// Twice the centre along an axis.
    #[inline(always)]
    pub(crate) fn center2(&self, axis: usize) -> f32 {
        self.0[axis] - self.0[axis + 4]
    }

    pub(crate) fn as_box(&self) -> Aabb32 {
        let [x, y, z, _, nx, ny, nz, _] = self.0;
        Aabb32 { min: Vec3::new(x, y, z), max: Vec3::new(-nx, -ny, -nz) }
    }
}

/// Something with a box and an index of the caller, below 2^28.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    /// The index is in the two numbers that a box does not need.
    pub(crate) extent: Extent,
}

impl Item {
    #[inline(always)]
    pub(crate) fn new(index: u32, min: Vec3, max: Vec3) -> Self {
        let (low, high) = ((index & 0x3fff) as f32, (index >> 14) as f32);
        Self { extent: Extent([min.x, min.y, min.z, low, -max.x, -max.y, -max.z, high]) }
    }

    #[inline(always)]
    pub(crate) fn index(&self) -> u32 {
        self.extent.0[3] as u32 | (self.extent.0[7] as u32) << 14
    }

    /// Twice the centre, and something finite.
    #[inline(always)]
    pub(crate) fn center2<S: Simd>(&self, simd: S) -> f32x4<S> {
        let (min, negated_max) = self.extent.load(simd).split();
        min - negated_max
    }
}

/// The box of twice the centres of some items.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centers {
    pub(crate) min: [f32; 4],
    pub(crate) max: [f32; 4],
}

/// The boxes of some items and of their centres.
#[inline(always)]
pub(crate) fn bounds<S: Simd>(simd: S, items: &[Item]) -> (Extent, Centers) {
    let mut extent = Extent::EMPTY.load(simd);
    let mut min = f32x4::splat(simd, f32::INFINITY);
    let mut max = f32x4::splat(simd, f32::NEG_INFINITY);
    for item in items {
        let center2 = item.center2(simd);
        extent = extent.min(item.extent.load(simd));
        min = min.min(center2);
        max = max.max(center2);
    }
    (Extent::store(extent), Centers { min: min.to_array(), max: max.to_array() })
}

/// The boxes of both.
pub(crate) fn both(a: (Extent, Centers), b: (Extent, Centers)) -> (Extent, Centers) {
    let smaller = |a: f32, b: f32| if b < a { b } else { a };
    let larger = |a: f32, b: f32| if b > a { b } else { a };
    let extent = std::array::from_fn(|i| smaller(a.0.0[i], b.0.0[i]));
    let min = std::array::from_fn(|i| smaller(a.1.min[i], b.1.min[i]));
    let max = std::array::from_fn(|i| larger(a.1.max[i], b.1.max[i]));
    (Extent(extent), Centers { min, max })
}
