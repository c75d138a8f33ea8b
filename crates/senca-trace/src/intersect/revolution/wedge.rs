//! The wedge that a partial turn sweeps.

use std::f64::consts::PI;

use senca_math::glam::DVec2;
use smallvec::SmallVec;

use crate::Ray;

/// The places around the y axis from the half-plane through +x on, towards -z, up to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wedge {
    /// Directions `(x, z)` of both half-planes, away from the axis.
    pub along: [DVec2; 2],
    /// Directions across them, into the sweep.
    inwards: [DVec2; 2],
    /// Whether the sweep is more than half a turn.
    wide: bool,
}

impl Wedge {
    pub(super) fn new(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            along: [DVec2::X, DVec2::new(cos, -sin)],
            inwards: [DVec2::NEG_Y, DVec2::new(sin, cos)],
            wide: angle > PI,
        }
    }

    /// Whether the line is in the wedge at first, and the parameters where it changes that, ascending, each
    /// with its half-plane. Where the line passes the axis so near that rounding contradicts its ends,
    /// the half-plane that it passes nearest to the axis is met, or not, as the ends ask for.
    pub(super) fn crossings(&self, ray: &Ray) -> (bool, SmallVec<[(f64, u32); 2]>) {
        let (o, d) = (DVec2::new(ray.origin.x, ray.origin.z), DVec2::new(ray.direction.x, ray.direction.z));
        // Parameter, half-plane, distance from the axis (negative: on the other side of it).
        let met = |k: usize| {
            let t = -self.inwards[k].dot(o) / self.inwards[k].dot(d);
            t.is_finite().then(|| (t, k as u32, self.along[k].dot(o + t * d)))
        };
        let mut planes: SmallVec<[(f64, u32, f64); 2]> = [0, 1].into_iter().filter_map(met).collect();
        let [first, last] = [-d, d].map(|end| self.holds_end(o, end));
        let odd = planes.iter().filter(|plane| plane.2 > 0.0).count() % 2 == 1;
        if odd != (first != last) {
            let nearest = planes.iter_mut().min_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
            nearest.into_iter().for_each(|plane| plane.2 = if plane.2 > 0.0 { -1.0 } else { 1.0 });
        }
        planes.sort_by(|a, b| a.0.total_cmp(&b.0));
        (first, planes.into_iter().filter(|plane| plane.2 > 0.0).map(|plane| (plane.0, plane.1)).collect())
    }

    /// Whether the far end of a line lies in the wedge.
    fn holds_end(&self, o: DVec2, direction: DVec2) -> bool {
        let holds = self.inwards.map(|inwards| {
            let side = inwards.dot(direction);
            if side == 0.0 { inwards.dot(o) > 0.0 } else { side > 0.0 }
        });
        if self.wide { holds[0] || holds[1] } else { holds[0] && holds[1] }
    }
}
