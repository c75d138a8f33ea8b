//! What is computed once per ray.

use senca_math::glam::Vec3;

use crate::Ray32;

/// Relative widening of the distances to the two planes of a slab. Their own rounding, of a difference,
/// a reciprocal, its widening and a product, is below 2^-22; the rounding of the sheared corners of a
/// triangle, whose edges may lie in the planes, below 2^-22 again.
const WIDENING: f32 = 1.0 / (1 << 20) as f32;

/// A ray with what boxes and triangles need to know of it. Its t is that of the ray divided by `t_unit`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRay {
    pub(crate) origin: [f32; 3],
    /// 1 / direction, of smaller absolute value; infinite where the direction is zero.
    pub(crate) near_reciprocal: [f32; 3],
    /// 1 / direction, of larger absolute value.
    pub(crate) far_reciprocal: [f32; 3],
    /// Per axis, whether the ray goes towards smaller coordinates.
    pub(crate) downward: [bool; 3],
    /// The axes of the sheared space: z is the one with the largest part of the direction.
    pub(crate) axes: [usize; 3],
    /// Shears that turn the direction into z, and the scale that makes z its unit.
    pub(crate) shear: [f32; 3],
    pub(crate) t_min: f32,
    pub(crate) t_max: f32,
    /// A power of two.
    pub(crate) t_unit: f32,
}

/// What turns a distance to a plane into one product and one difference, `plane * reciprocal - offset`.
///
/// The difference may lose all digits when the origin is far away, of which the offsets take account; what
/// is left is covered by reciprocals that are widened twice as much. So no box is entered later, or left
/// earlier, than [`PreparedRay::interval`] says, whether product and difference are fused or not.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Products {
    pub(crate) near_reciprocal: [f32; 3],
    pub(crate) near_offset: [f32; 3],
    pub(crate) far_reciprocal: [f32; 3],
    pub(crate) far_offset: [f32; 3],
}

/// Share of an offset that it is widened by: 2^-24 is lost in it, and as much in a product with a plane
/// that is not fused.
const OFFSET_WIDENING: f32 = 1.0 / (1 << 22) as f32;

/// Offsets and reciprocals above are not computed with: neither is infinite then, nor anything near it.
const LARGEST_PRODUCT: f32 = 1e18;

impl PreparedRay {
    /// None where they could be infinite: for rays along an axis, or far from everything.
    #[inline(always)]
    pub(crate) fn products(&self) -> Option<Products> {
        let [mut near_reciprocal, mut near_offset] = [[0.0; 3]; 2];
        let [mut far_reciprocal, mut far_offset] = [[0.0; 3]; 2];
        let mut is_small = true;
        for axis in 0..3 {
            near_reciprocal[axis] = self.near_reciprocal[axis] * (1.0 - WIDENING);
            far_reciprocal[axis] = self.far_reciprocal[axis] * (1.0 + WIDENING);
            let near = self.origin[axis] * near_reciprocal[axis];
            let far = self.origin[axis] * far_reciprocal[axis];
            near_offset[axis] = near + near.abs() * OFFSET_WIDENING;
            far_offset[axis] = far - far.abs() * OFFSET_WIDENING;
            is_small &= far_reciprocal[axis].abs() < LARGEST_PRODUCT && far.abs() < LARGEST_PRODUCT;
        }
        is_small.then_some(Products { near_reciprocal, near_offset, far_reciprocal, far_offset })
    }

    /// None when the ray is not valid.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray32) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let largest = ray.direction.abs().max_element();
        if (1e-9..1e9).contains(&largest) {
            Some(Self::of(ray, 1.0))
        } else {
            Some(Self::rescaled(ray, largest))
        }
    }

    /// Directions too short or too long for reciprocals and shears are multiplied by a power of two.
    #[cold]
    fn rescaled(ray: &Ray32, largest: f32) -> Self {
        let exponent = (f64::from(largest).to_bits() >> 52) as i32 - 1023;
        let unit = 2f64.powi(-exponent);
        let direction = (ray.direction.as_dvec3() * unit).as_vec3();
        let [t_min, t_max] = [ray.t_min, ray.t_max].map(|t| (f64::from(t) / unit) as f32);
        Self::of(&Ray32 { direction, t_min, t_max, ..*ray }, unit as f32)
    }

    #[inline(always)]
    fn of(ray: &Ray32, t_unit: f32) -> Self {
        let direction = ray.direction.to_array();
        let reciprocal = direction.map(|d| 1.0 / d);
        let size = ray.direction.abs();
        let z = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        Self {
            origin: ray.origin.to_array(),
            near_reciprocal: reciprocal.map(|r| r * (1.0 - WIDENING)),
            far_reciprocal: reciprocal.map(|r| r * (1.0 + WIDENING)),
            downward: reciprocal.map(|r| r < 0.0),
            axes,
            shear: [direction[axes[0]] * reciprocal[z], direction[axes[1]] * reciprocal[z], reciprocal[z]],
            t_min: ray.t_min,
            t_max: ray.t_max,
            t_unit,
        }
    }

    /// Where the ray is within the box, from the last plane it enters to the first it leaves, or anywhere
    /// from infinity to infinity. Monotonic: what holds a box holds its interval, rounding included.
    pub(crate) fn interval(&self, min: Vec3, max: Vec3) -> (f32, f32) {
        let (mut enter, mut leave) = (f32::NEG_INFINITY, f32::INFINITY);
        for axis in 0..3 {
            let (near, far) =
                if self.downward[axis] { (max[axis], min[axis]) } else { (min[axis], max[axis]) };
            // A ray within the plane of a side makes 0 * infinity: the side says nothing.
            let near = (near - self.origin[axis]) * self.near_reciprocal[axis];
            let far = (far - self.origin[axis]) * self.far_reciprocal[axis];
            enter = if near > enter { near } else { enter };
            leave = if far < leave { far } else { leave };
        }
        (enter, leave)
    }
}
