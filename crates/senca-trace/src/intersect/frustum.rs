//! Cylinders, cones and frusta.

use std::f64::consts::TAU;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::analytic::{Analytic, Chart, disc_chart, slab, turn_from_back};
use crate::{Crossing, Ray, SurfacePoint};

/// Parts, which are the surfaces of a closed frustum whose ends both have an area.
const SIDE: u32 = 0;
const BOTTOM: u32 = 1;
const TOP: u32 = 2;

/// A right circular frustum from y = 0 to y = `height`: a cylinder where both radii are the same, a
/// cone where one is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    bottom: f64,
    top: f64,
    height: f64,
    /// Growth of the radius per unit of height.
    slope: f64,
    capped: bool,
}

impl Frustum {
    /// A frustum with these radii, each >= 0 and not both 0, and height > 0. `capped`: ends with a
    /// radius are closed by discs.
    #[must_use]
    pub fn new(bottom: f64, top: f64, height: f64, capped: bool) -> Self {
        Self { bottom, top, height, slope: (top - bottom) / height, capped }
    }

    fn radius_at(&self, y: f64) -> f64 {
        self.bottom + self.slope * y
    }

    /// Stretches of the line inside the endless (double) cone, as one or two intervals, of which
    /// either may be empty.
    ///
    /// With w the line's part across the axis and k the radius, the inside is where
    /// `|o_w + t d_w|^2 - (k + t q)^2 < 0`, a quadratic `a t^2 + 2 b t + c`. Its discriminant is
    /// `|k d_w - q o_w|^2 - (o_w x d_w)^2`, in which nothing large cancels.
    #[inline]
    fn inside(&self, ray: &Ray) -> [(f64, f64); 2] {
        const EMPTY: (f64, f64) = (0.0, 0.0);
        const INFINITY: f64 = f64::INFINITY;
        let (o, d) = (DVec2::new(ray.origin.x, ray.origin.z), DVec2::new(ray.direction.x, ray.direction.z));
        let (k, q) = (self.radius_at(ray.origin.y), self.slope * ray.direction.y);
        let a = d.length_squared() - q * q;
        let b = o.dot(d) - k * q;
        let c = o.length_squared() - k * k;
        let cross = o.perp_dot(d);
        let discriminant = (k * d - q * o).length_squared() - cross * cross;
        if a == 0.0 && b == 0.0 || discriminant <= 0.0 {
            // Along the axis of a cylinder, or, within both halves of a double cone, through its tip.
            let all = if a == 0.0 { c < 0.0 } else { a < 0.0 };
            return [if all { (-INFINITY, INFINITY) } else { EMPTY }, EMPTY];
        }
        let sum = -(b + b.signum() * discriminant.sqrt());
        let (t1, t2) = (sum / a, c / sum);
        if a == 0.0 {
            // Parallel to a line of the cone: one crossing.
            return [if b > 0.0 { (-INFINITY, t2) } else { (t2, INFINITY) }, EMPTY];
        }
        let (first, second) = (t1.min(t2), t1.max(t2));
        if a > 0.0 { [(first, second), EMPTY] } else { [(-INFINITY, first), (second, INFINITY)] }
    }

    /// The part at one end of a stretch, `None` where an open end lets the line through.
    fn part(&self, on_side: bool, at_top: bool) -> Option<u32> {
        let radius = if at_top { self.top } else { self.bottom };
        match (on_side || radius == 0.0, at_top) {
            (true, _) => Some(SIDE),
            (false, _) if !self.capped => None,
            (false, false) => Some(BOTTOM),
            (false, true) => Some(TOP),
        }
    }

    /// A point of the side and its normal. At a tip the normal is the axis.
    fn side_point(&self, near: DVec3) -> SurfacePoint {
        let y = near.y.clamp(0.0, self.height);
        let across = near.x.hypot(near.z);
        let radial = if across > 0.0 { DVec3::new(near.x, 0.0, near.z) / across } else { DVec3::ZERO };
        let point = radial * self.radius_at(y) + DVec3::Y * y;
        let normal = (radial - DVec3::Y * self.slope).normalize_or(DVec3::Y);
        let chart = Chart {
            uv: DVec2::new(turn_from_back(near.x, near.z), 1.0 - y / self.height),
            along_u: TAU * DVec3::new(point.z, 0.0, -point.x),
            along_v: -self.height * (radial * self.slope + DVec3::Y),
        };
        chart.at(point, normal, SIDE)
    }
}

impl Analytic for Frustum {
    fn bounds(&self) -> Aabb {
        let radius = self.bottom.max(self.top);
        Aabb { min: DVec3::new(-radius, 0.0, -radius), max: DVec3::new(radius, self.height, radius) }
    }

    #[inline]
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let (low, high) = slab(ray.origin.y, ray.direction.y, 0.0, self.height);
        if low >= high {
            return;
        }
        let upwards = ray.direction.y > 0.0;
        for (start, end) in self.inside(ray) {
            let (enter, leave) = (start.max(low), end.min(high));
            if enter >= leave {
                continue;
            }
            if let Some(part) = self.part(start > low, !upwards) {
                meet(enter, part, DVec2::ZERO);
            }
            if let Some(part) = self.part(end < high, upwards) {
                meet(leave, part, DVec2::ZERO);
            }
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let near = ray.at(crossing.t);
        let (radius, y, normal) = match crossing.part {
            BOTTOM => (self.bottom, 0.0, DVec3::NEG_Y),
            TOP => (self.top, self.height, DVec3::Y),
            _ => return self.side_point(near),
        };
        let point = DVec3::new(near.x, y, near.z);
        // A cone that stands on its tip has no bottom: its top is surface 1.
        let surface = if self.bottom > 0.0 { crossing.part } else { 1 };
        disc_chart(point, radius, normal.y < 0.0).at(point, normal, surface)
    }

    fn is_closed(&self) -> bool {
        self.capped
    }
}
