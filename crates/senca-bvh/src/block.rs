//! Leaves of the triangle hierarchy: up to eight triangles side by side.

use fearless_simd::{Simd, f32x8, prelude::*};
use senca_math::glam::Vec3;

use crate::traverse::{LaneRay, max_or, min_or};
use crate::watertight::SMALLEST_DETERMINANT;

/// Triangles of a block.
pub(crate) const LANES: usize = 8;

/// Share of a box that the triangles of a wall cover.
const WALL: f32 = 0.9;

/// Corners of up to eight triangles.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// By corner, axis, triangle.
    corners: [[[f32; LANES]; 3]; 3],
    /// Indices in the caller's list.
    pub(crate) triangles: [u32; LANES],
}

/// Where a ray meets the triangles of a block.
pub(crate) struct BlockHits<S: Simd> {
    /// Bit per triangle that is met between `t_min` and the limit given, which is still admitted.
    pub(crate) mask: u32,
    /// Bit per triangle that has to be tested by [`crate::watertight::intersect`].
    pub(crate) unsure: u32,
    pub(crate) t: f32x8<S>,
    pub(crate) u: f32x8<S>,
    pub(crate) v: f32x8<S>,
}

impl Block {
    pub(crate) const EMPTY: Self = Self { corners: [[[0.0; LANES]; 3]; 3], triangles: [u32::MAX; LANES] };

    pub(crate) fn set(&mut self, lane: usize, triangle: u32, corners: [Vec3; 3]) {
        for (rows, corner) in self.corners.iter_mut().zip(corners) {
            for axis in 0..3 {
                rows[axis][lane] = corner[axis];
            }
        }
        self.triangles[lane] = triangle;
    }

    pub(crate) fn corners(&self, lane: usize) -> [Vec3; 3] {
        self.corners.map(|rows| Vec3::from_array(rows.map(|row| row[lane])))
    }

    /// Whether few rays get through the box of the first `count` triangles without meeting one: as if they
    /// came from everywhere, by what the triangles cover of the box's sides, seen along the axes.
    pub(crate) fn is_wall(&self, count: usize) -> bool {
        let (mut low, mut high, mut covered) = (Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::ZERO);
        for [a, b, c] in (0..count.min(LANES)).map(|lane| self.corners(lane)) {
            low = low.min(a).min(b).min(c);
            high = high.max(a).max(b).max(c);
            covered += 0.5 * (b - a).cross(c - a).abs();
        }
        let size = high - low;
        let sides = Vec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
        covered.min(sides).element_sum() > WALL * sides.element_sum()
    }

    /// The same decisions and bytes as [`crate::watertight::intersect`], for `count` triangles at once.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<'_, S>,
        count: u32,
        t_max: f32,
    ) -> BlockHits<S> {
        let zero = f32x8::splat(simd, 0.0);
        let shear_x = f32x8::splat(simd, ray.prepared.shear[0]);
        let shear_y = f32x8::splat(simd, ray.prepared.shear[1]);

        // 1. Corners in the space where the ray is the z axis.
        let [kx, ky, kz] = ray.prepared.axes;
        let (az, bz, cz) =
            (self.row(simd, ray, 0, kz), self.row(simd, ray, 1, kz), self.row(simd, ray, 2, kz));
        let (ax, ay) = (self.row(simd, ray, 0, kx) - shear_x * az, self.row(simd, ray, 0, ky) - shear_y * az);
        let (bx, by) = (self.row(simd, ray, 1, kx) - shear_x * bz, self.row(simd, ray, 1, ky) - shear_y * bz);
        let (cx, cy) = (self.row(simd, ray, 2, kx) - shear_x * cz, self.row(simd, ray, 2, ky) - shear_y * cz);

        // 2. Edge functions. All have the same sign, or are 0, where the ray passes inside.
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let det = u + v + w;
        let low = min_or(u, min_or(v, w));
        let high = max_or(u, max_or(v, w));
        let outside = low.simd_lt(zero) & high.simd_gt(zero);
        let candidates = !(outside.to_bitmask() as u32) & (255 >> (8 - count));
        if candidates == 0 {
            return BlockHits { mask: 0, unsure: 0, t: zero, u: zero, v: zero };
        }

        // 3. Which of them need double precision.
        let size = det.abs();
        let safe = (low.simd_gt(zero) | high.simd_lt(zero))
            & size.simd_ge(f32x8::splat(simd, SMALLEST_DETERMINANT))
            & size.simd_lt(f32x8::splat(simd, f32::INFINITY));
        let safe = safe.to_bitmask() as u32 & candidates;

        // 4. The distance, within the triangle's box.
        let shear_z = f32x8::splat(simd, ray.prepared.shear[2]);
        let t = (u * (shear_z * az) + v * (shear_z * bz) + w * (shear_z * cz)) / det;
        let mut enter = f32x8::splat(simd, f32::NEG_INFINITY);
        let mut leave = f32x8::splat(simd, f32::INFINITY);
        for axis in 0..3 {
            let a = self.row(simd, ray, 0, axis);
            let b = self.row(simd, ray, 1, axis);
            let c = self.row(simd, ray, 2, axis);
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let (near, far) = if ray.prepared.downward[axis] { (max, min) } else { (min, max) };
            enter = max_or(near * ray.near_reciprocal[axis], enter);
            leave = min_or(far * ray.far_reciprocal[axis], leave);
        }
        let t = max_or(min_or(t, leave), enter);
        let met = enter.simd_le(leave) & t.simd_gt(ray.t_min) & t.simd_le(f32x8::splat(simd, t_max));
        let mask = met.to_bitmask() as u32 & safe;
        BlockHits { mask, unsure: candidates & !safe, t, u: v / det, v: w / det }
    }

    /// One coordinate of one corner, from the ray's origin.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, ray: &LaneRay<'_, S>, corner: usize, axis: usize) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.corners[corner][axis])
            - f32x8::splat(simd, ray.prepared.origin[axis])
    }
}
