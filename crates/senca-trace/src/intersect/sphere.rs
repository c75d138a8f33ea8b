//! Spheres and ellipsoids.

use std::f64::consts::{PI, TAU};

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};

use super::Form;
use super::analytic::{Analytic, Chart, turn_from_back};
use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

/// A sphere around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    radius: f64,
    radius_squared: f64,
}

impl Sphere {
    /// A sphere of `radius` > 0.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        Self { radius, radius_squared: radius * radius }
    }

    /// Both parameters of a line, ascending; `None` when it misses or only touches, and for rays that
    /// are not valid, whose discriminant is 0 or no number.
    ///
    /// The discriminant is taken from the point of the line that is nearest to the centre, which keeps
    /// its digits for a small sphere far away. Source: Haines, Günther and Akenine-Möller 2019.
    #[inline]
    fn both(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (o, d) = (ray.origin, ray.direction);
        let length_squared = d.length_squared();
        let middle = -o.dot(d) / length_squared;
        let nearest = o + middle * d;
        let half_squared = (self.radius_squared - nearest.length_squared()) / length_squared;
        if half_squared > 0.0 {
            let half = half_squared.sqrt();
            return Some([middle - half, middle + half]);
        }
        None
    }
}

impl Intersect for Sphere {
    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::splat(-self.radius), max: DVec3::splat(self.radius) }
    }

    #[inline]
    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        counters.tests += 1;
        let t = self.both(ray)?.into_iter().find(|t| *t > ray.t_min)?;
        (t < ray.t_max).then_some(Crossing { t, part: 0, uv: DVec2::ZERO })
    }

    #[inline]
    fn occludes(&self, ray: &Ray, counters: &mut Counters) -> bool {
        counters.tests += 1;
        self.both(ray).is_some_and(|both| both.into_iter().any(|t| ray.admits(t)))
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        counters.tests += 1;
        let admitted = self.both(ray).into_iter().flatten().filter(|t| ray.admits(*t));
        out.extend(admitted.map(|t| Crossing { t, part: 0, uv: DVec2::ZERO }));
    }

    #[inline]
    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let normal = ray.at(crossing.t).normalize_or(DVec3::Y);
        globe_chart(normal, DVec3::splat(self.radius)).at(normal * self.radius, normal, 0)
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn form(&self) -> Form {
        Form::Sphere { radius: self.radius }
    }
}

/// The picture once around the unit sphere's place `unit`, stretched by `radii`: u from the back over
/// the left, v from the pole at +y.
#[inline]
pub(super) fn globe_chart(unit: DVec3, radii: DVec3) -> Chart {
    let across = unit.x.hypot(unit.z);
    let down = DVec3::new(unit.x * unit.y, -across * across, unit.z * unit.y);
    Chart {
        uv: DVec2::new(turn_from_back(unit.x, unit.z), 0.5 - unit.y.atan2(across) / PI),
        along_u: TAU * radii * DVec3::new(unit.z, 0.0, -unit.x),
        along_v: radii * down,
    }
}

/// A sphere around the origin, stretched along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    radii: DVec3,
}

impl Ellipsoid {
    /// An ellipsoid of half axes `radii`, each > 0.
    #[must_use]
    pub fn new(radii: DVec3) -> Self {
        Self { radii }
    }
}

impl Analytic for Ellipsoid {
    fn bounds(&self) -> Aabb {
        Aabb { min: -self.radii, max: self.radii }
    }

    #[inline]
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let unit = Ray { origin: ray.origin / self.radii, direction: ray.direction / self.radii, ..*ray };
        for t in Sphere::new(1.0).both(&unit).into_iter().flatten() {
            meet(t, 0, DVec2::ZERO);
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let unit = (ray.at(crossing.t) / self.radii).normalize_or(DVec3::Y);
        let stretched = self.radii.max_element() / self.radii;
        let normal = (unit * stretched).normalize_or(DVec3::Y);
        globe_chart(unit, self.radii).at(unit * self.radii, normal, 0)
    }

    fn is_closed(&self) -> bool {
        true
    }
}
