//! What exact surfaces have in common.
//!
//! An [`Analytic`] surface names all crossings of a whole line at once, which is what its equation
//! gives; choosing the nearest, sorting and limiting are the same for all and done here.

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3, Vec4};

use super::Form;
use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

/// A surface whose crossings with a line follow from its equation.
///
/// Conventions of all of them: a line that only touches a surface misses it; a closed surface has an
/// even number of crossings with every line.
pub(crate) trait Analytic: Send + Sync + std::fmt::Debug {
    /// See [`Intersect::bounds`].
    fn bounds(&self) -> Aabb;

    /// Calls `meet` with parameter, part and place of the crossings, in any order. Those that the ray
    /// does not admit may be named or not. The ray is valid.
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2));

    /// The nearest crossing that the valid ray admits.
    #[inline]
    fn nearest(&self, ray: &Ray) -> Option<Crossing> {
        nearest_of_all(self, ray)
    }

    /// See [`Intersect::surface_point`].
    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint;

    /// See [`Intersect::is_closed`].
    fn is_closed(&self) -> bool;

    /// See [`Intersect::form`].
    fn form(&self) -> Form {
        Form::Other
    }
}

/// The nearest of all crossings that the ray admits.
#[inline]
pub(crate) fn nearest_of_all<S: Analytic + ?Sized>(surface: &S, ray: &Ray) -> Option<Crossing> {
    let mut nearest = None;
    let mut limit = ray.t_max;
    surface.each_crossing(ray, &mut |t, part, uv| {
        if t > ray.t_min && t < limit {
            limit = t;
            nearest = Some(Crossing { t, part, uv });
        }
    });
    nearest
}

impl<S: Analytic> Intersect for S {
    fn bounds(&self) -> Aabb {
        Analytic::bounds(self)
    }

    #[inline]
    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        counters.tests += 1;
        if ray.is_valid() { self.nearest(ray) } else { None }
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        counters.tests += 1;
        let first = out.len();
        if ray.is_valid() {
            self.each_crossing(ray, &mut |t, part, uv| {
                if ray.admits(t) {
                    out.push(Crossing { t, part, uv });
                }
            });
        }
        out[first..].sort_by(|a, b| a.t.total_cmp(&b.t));
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        Analytic::surface_point(self, ray, crossing)
    }

    fn is_closed(&self) -> bool {
        Analytic::is_closed(self)
    }

    fn form(&self) -> Form {
        Analytic::form(self)
    }
}

/// The place where a texture is laid on a surface, with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chart {
    /// Texture coordinates.
    pub uv: DVec2,
    /// Derivative of the place along u.
    pub along_u: DVec3,
    /// Derivative of the place along v, or any direction of increasing v on the same side of it.
    pub along_v: DVec3,
}

impl Chart {
    /// A surface point with this chart and the same normal for shading.
    pub(crate) fn at(self, point: DVec3, normal: DVec3, surface: u32) -> SurfacePoint {
        // The bitangent points up the picture, along decreasing v.
        let handedness = if normal.cross(self.along_u).dot(self.along_v) > 0.0 { -1.0 } else { 1.0 };
        SurfacePoint {
            point,
            normal,
            shading_normal: normal,
            texcoords: [self.uv, DVec2::ZERO],
            tangent: self.along_u,
            handedness,
            color: Vec4::ONE,
            surface,
        }
    }
}

/// Share of a full turn around the y axis, from +x towards -z, at which a place lies; in [0, 1).
#[inline]
pub(crate) fn turn_from_x(x: f64, z: f64) -> f64 {
    let turn = (-z).atan2(x) / std::f64::consts::TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    // Just below zero it rounds to 1.
    if turn >= 1.0 { 0.0 } else { turn }
}

/// The same from -z towards -x, where the pictures on round shapes begin: their seam is at the back.
#[inline]
pub(crate) fn turn_from_back(x: f64, z: f64) -> f64 {
    turn_from_x(-z, x)
}

/// The disc of `radius` seen from its front, which faces +y or, for a `bottom`, -y: places in the
/// picture laid over it.
pub(crate) fn disc_chart(point: DVec3, radius: f64, bottom: bool) -> Chart {
    let up = if bottom { 1.0 } else { -1.0 };
    Chart {
        uv: DVec2::new(0.5 + 0.5 * point.x / radius, 0.5 - 0.5 * up * point.z / radius),
        along_u: DVec3::X * (2.0 * radius),
        along_v: DVec3::Z * (-2.0 * up * radius),
    }
}

/// The stretch of the line along which `low <= coordinate < high`; empty (first >= second) when the
/// line runs beside. Nearby slabs that share a face so share no line.
#[inline]
pub(crate) fn slab(origin: f64, direction: f64, low: f64, high: f64) -> (f64, f64) {
    if direction == 0.0 {
        let inside = low <= origin && origin < high;
        return if inside { (f64::NEG_INFINITY, f64::INFINITY) } else { (0.0, 0.0) };
    }
    let (t1, t2) = ((low - origin) / direction, (high - origin) / direction);
    if direction > 0.0 { (t1, t2) } else { (t2, t1) }
}
