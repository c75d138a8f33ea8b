//! Boxes.

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::analytic::{Analytic, Chart, slab};
use crate::{Crossing, Ray, SurfacePoint};

/// A box centred on the origin, its sides parallel to the axes. The part of a crossing is the number
/// of its side: front +z, right +x, back -z, left -x, top +y, bottom -y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    half: DVec3,
}

/// Number of the side towards the negative and positive end of each axis.
const SIDES: [[u32; 2]; 3] = [[3, 1], [5, 4], [2, 0]];

/// Outward normal and direction to the right of each side, seen from outside.
const FRAMES: [(DVec3, DVec3); 6] = [
    (DVec3::Z, DVec3::X),
    (DVec3::X, DVec3::NEG_Z),
    (DVec3::NEG_Z, DVec3::NEG_X),
    (DVec3::NEG_X, DVec3::Z),
    (DVec3::Y, DVec3::X),
    (DVec3::NEG_Y, DVec3::X),
];

impl Cuboid {
    /// A box with edges of length `size`, each > 0.
    #[must_use]
    pub fn new(size: DVec3) -> Self {
        Self { half: 0.5 * size }
    }
}

/// Where a line enters and leaves a box, and through which sides.
///
/// A line in the plane of a side counts as inside on the negative sides only, so that of boxes that share
/// a side exactly one is met.
#[inline]
pub(super) fn box_ends(min: DVec3, max: DVec3, ray: &Ray) -> Option<[(f64, u32); 2]> {
    let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for (axis, sides) in SIDES.iter().enumerate() {
        let direction = ray.direction[axis];
        let (near, far) = slab(ray.origin[axis], direction, min[axis], max[axis]);
        let forward = usize::from(direction > 0.0);
        if near > enter.0 {
            enter = (near, sides[1 - forward]);
        }
        if far < leave.0 {
            leave = (far, sides[forward]);
        }
    }
    (enter.0 < leave.0).then_some([enter, leave])
}

/// Outward normal of a side and the direction to the right, seen from outside.
pub(super) fn side_frame(side: u32) -> (DVec3, DVec3) {
    FRAMES[side as usize % FRAMES.len()]
}

impl Analytic for Cuboid {
    fn bounds(&self) -> Aabb {
        Aabb { min: -self.half, max: self.half }
    }

    #[inline]
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        for (t, side) in box_ends(-self.half, self.half, ray).into_iter().flatten() {
            meet(t, side, DVec2::ZERO);
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let (normal, right) = side_frame(crossing.part);
        let up = normal.cross(right);
        let inside = ray.at(crossing.t).clamp(-self.half, self.half);
        let point = inside - normal * normal.dot(inside) + normal * self.half;
        let share = point / self.half;
        let chart = Chart {
            uv: DVec2::new(0.5 + 0.5 * right.dot(share), 0.5 - 0.5 * up.dot(share)),
            along_u: 2.0 * right * self.half,
            along_v: -2.0 * up * self.half,
        };
        chart.at(point, normal, crossing.part)
    }

    fn is_closed(&self) -> bool {
        true
    }
}
