//! Tori.

use std::f64::consts::TAU;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};
use senca_math::roots::{bernstein_from_power, bernstein_roots, restrict_to};

use super::analytic::{Analytic, Chart, slab, turn_from_back};
use crate::{Crossing, Ray, SurfacePoint};

/// A ring around the y axis.
///
/// Where the tube is thicker than the ring is wide it overlaps itself around the axis; there, as with
/// any surface that runs through itself, the twice covered part counts as outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    major: f64,
    minor: f64,
}

impl Torus {
    /// A torus with the tube's centre at distance `major` of the axis and a tube of radius `minor`,
    /// both > 0.
    #[must_use]
    pub fn new(major: f64, minor: f64) -> Self {
        Self { major, minor }
    }

    /// Coefficients, lowest power first, of `(p^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2)` along the line
    /// `nearest + s unit`, where `nearest` is its point nearest to the origin: no cube then, and no
    /// digits lost to a far origin.
    fn quartic(&self, nearest: DVec3, unit: DVec3) -> [f64; 5] {
        let (major2, minor2) = (self.major * self.major, self.minor * self.minor);
        let k = nearest.length_squared() + (major2 - minor2);
        let across = DVec2::new(nearest.x, nearest.z);
        let along = DVec2::new(unit.x, unit.z);
        [
            k * k - 4.0 * major2 * across.length_squared(),
            -8.0 * major2 * across.dot(along),
            2.0 * k - 4.0 * major2 * along.length_squared(),
            0.0,
            1.0,
        ]
    }
}

impl Analytic for Torus {
    fn bounds(&self) -> Aabb {
        let reach = self.major + self.minor;
        let corner = DVec3::new(reach, self.minor, reach);
        Aabb { min: -corner, max: corner }
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        // To unit length and the foot of the perpendicular from the centre, lengths in outer radii.
        let size = self.major + self.minor;
        let unit_torus = Self { major: self.major / size, minor: self.minor / size };
        let length = ray.direction.length();
        let unit = ray.direction / length;
        let middle = -ray.origin.dot(unit);
        let nearest = (ray.origin + middle * unit) / size;

        // Only within the sphere and the slab around the ring, both slightly larger than the torus, so
        // that the ends lie outside of it.
        const SLACK: f64 = 1.0 + 1e-9;
        let half_squared = SLACK - nearest.length_squared();
        if half_squared <= 0.0 || half_squared.is_nan() {
            return;
        }
        let half = half_squared.sqrt();
        let (low, high) = slab(nearest.y, unit.y, -SLACK * unit_torus.minor, SLACK * unit_torus.minor);
        let (low, high) = (low.max(-half), high.min(half));
        if low >= high {
            return;
        }

        let mut quartic = unit_torus.quartic(nearest, unit);
        restrict_to(&mut quartic, low, high);
        bernstein_from_power(&mut quartic);
        bernstein_roots(&quartic, &mut |s| {
            let t = (middle + size * (low + s * (high - low))) / length;
            meet(t, 0, DVec2::ZERO);
        });
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let near = ray.at(crossing.t);
        let across = near.x.hypot(near.z);
        let radial = if across > 0.0 { DVec3::new(near.x, 0.0, near.z) / across } else { DVec3::X };

        // Beyond the axis, on the self-overlapping part, the tube is that of the opposite direction.
        let off = |across: f64| ((across - self.major).hypot(near.y) - self.minor).abs();
        let overlapping = off(-across) < off(across);
        let (radial, side) = if overlapping { (-radial, -across) } else { (radial, across) };
        let tube = DVec2::new(side - self.major, near.y).normalize_or(DVec2::X);

        let outward = radial * tube.x + DVec3::Y * tube.y;
        let point = radial * self.major + outward * self.minor;
        let v = 0.5 - tube.y.atan2(tube.x) / TAU;
        let chart = Chart {
            uv: DVec2::new(turn_from_back(radial.x, radial.z), v),
            along_u: TAU * DVec3::new(point.z, 0.0, -point.x),
            along_v: radial * tube.y - DVec3::Y * tube.x,
        };
        chart.at(point, if overlapping { -outward } else { outward }, 0)
    }

    fn is_closed(&self) -> bool {
        true
    }
}
