//! Numbers the formulas of fragments are written for: one fragment's, or sixteen at a time.

use senca_raster::simd::{Simd, f32x16, prelude::*};
use std::ops::{Add, Mul, Sub};

/// A number, or sixteen. A formula written for it is its own plain twin.
pub(crate) trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The number `v`, as many times as `self` is numbers.
    fn like(self, v: f32) -> Self;
    fn least(self, other: Self) -> Self;
    fn greatest(self, other: Self) -> Self;

    #[inline(always)]
    fn one_minus(self) -> Self {
        self.like(1.0) - self
    }

    /// Within [0, 1].
    #[inline(always)]
    fn clamped(self) -> Self {
        self.greatest(self.like(0.0)).least(self.like(1.0))
    }

    /// From `self` at 0 to `end` at 1.
    #[inline(always)]
    fn towards(self, end: Self, share: Self) -> Self {
        self + (end - self) * share
    }
}

impl Real for f32 {
    #[inline(always)]
    fn like(self, v: f32) -> Self {
        v
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl<S: Simd> Real for f32x16<S> {
    #[inline(always)]
    fn like(self, v: f32) -> Self {
        Self::splat(self.token(), v)
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.min(other)
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        self.max(other)
    }
}

/// Red, green, blue, alpha.
pub(crate) type Color<R> = [R; 4];

#[inline(always)]
pub(crate) fn clamped<R: Real>(c: Color<R>) -> Color<R> {
    [c[0].clamped(), c[1].clamped(), c[2].clamped(), c[3].clamped()]
}

/// `c` as many times as `like` is numbers.
#[inline(always)]
pub(crate) fn constant<R: Real>(like: R, c: [f32; 4]) -> Color<R> {
    [like.like(c[0]), like.like(c[1]), like.like(c[2]), like.like(c[3])]
}

/// From `a` at 0 to `b` at 1.
#[inline(always)]
pub(crate) fn mixed<R: Real>(a: Color<R>, b: Color<R>, share: R) -> Color<R> {
    [
        a[0].towards(b[0], share),
        a[1].towards(b[1], share),
        a[2].towards(b[2], share),
        a[3].towards(b[3], share),
    ]
}
