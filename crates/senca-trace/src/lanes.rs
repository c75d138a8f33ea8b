//! Eight numbers, or eight vectors, at once.
//!
//! Nothing is contracted to fused operations, and each lane is computed by itself, so a ray's numbers
//! depend neither on the vector instructions nor on the rays beside it.

use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};
use senca_math::glam::DVec3;

/// Rays that are handled at once.
pub(crate) const LANES: usize = 8;

pub(crate) type F<S> = f64x8<S>;
pub(crate) type M<S> = mask64x8<S>;

// Written out, since the closures of array functions are compiled by themselves, without the vector
// instructions of where they are called.

/// The expression for k = 0, 1 and 2.
macro_rules! channels {
    ($k:ident => $value:expr) => {
        [
            {
                let $k = 0usize;
                $value
            },
            {
                let $k = 1usize;
                $value
            },
            {
                let $k = 2usize;
                $value
            },
        ]
    };
}
pub(crate) use channels;

/// The expression for every lane.
macro_rules! eight {
    ($lane:ident => $value:expr) => {
        [
            {
                let $lane = 0usize;
                $value
            },
            {
                let $lane = 1usize;
                $value
            },
            {
                let $lane = 2usize;
                $value
            },
            {
                let $lane = 3usize;
                $value
            },
            {
                let $lane = 4usize;
                $value
            },
            {
                let $lane = 5usize;
                $value
            },
            {
                let $lane = 6usize;
                $value
            },
            {
                let $lane = 7usize;
                $value
            },
        ]
    };
}
pub(crate) use eight;

/// Eight vectors of three components.
#[derive(Clone, Copy)]
pub(crate) struct V<S: Simd> {
    pub(crate) x: F<S>,
    pub(crate) y: F<S>,
    pub(crate) z: F<S>,
}

impl<S: Simd> V<S> {
    /// Eight times the same.
    #[inline(always)]
    pub(crate) fn splat(simd: S, v: DVec3) -> Self {
        Self { x: F::splat(simd, v.x), y: F::splat(simd, v.y), z: F::splat(simd, v.z) }
    }

    #[inline(always)]
    pub(crate) fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    #[inline(always)]
    pub(crate) fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub(crate) fn times(self, factor: F<S>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> F<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(crate) fn opposite(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }

    #[inline(always)]
    pub(crate) fn select(mask: M<S>, yes: Self, no: Self) -> Self {
        Self { x: mask.select(yes.x, no.x), y: mask.select(yes.y, no.y), z: mask.select(yes.z, no.z) }
    }

    /// The largest absolute component.
    #[inline(always)]
    pub(crate) fn largest(self) -> F<S> {
        larger(larger(self.x.abs(), self.y.abs()), self.z.abs())
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [DVec3; LANES] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        eight!(k => DVec3::new(x[k], y[k], z[k]))
    }
}

/// The larger one; `b` where either is no number.
#[inline(always)]
pub(crate) fn larger<S: Simd>(a: F<S>, b: F<S>) -> F<S> {
    a.simd_gt(b).select(a, b)
}

/// The lanes whose bits are set.
#[inline(always)]
pub(crate) fn lanes_of(mask: u64) -> impl Iterator<Item = usize> {
    bits_of(mask).map(
        #[inline(always)]
        |lane| lane % LANES,
    )
}

/// The bits that are set, from the lowest.
#[inline(always)]
pub(crate) fn bits_of(mask: u64) -> impl Iterator<Item = usize> {
    let mut left = mask;
    std::iter::from_fn(
        #[inline(always)]
        move || {
            if left == 0 {
                return None;
            }
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            Some(bit)
        },
    )
}

/// The first `count` lanes; all when there are more.
#[inline(always)]
pub(crate) fn first_lanes<S: Simd>(simd: S, count: usize) -> M<S> {
    M::from_bitmask(simd, if count >= LANES { 255 } else { (1 << count) - 1 })
}
