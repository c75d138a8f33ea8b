//! Normals and texture coordinates of surfaces of revolution.

use std::f64::consts::TAU;

use senca_math::glam::{DVec2, DVec3};

use super::Revolution;
use crate::intersect::analytic::{Chart, turn_from_x};
use crate::{Crossing, SurfacePoint};

/// Angle around the y axis, from +x towards -z, in [0, 2 pi).
pub(super) fn angle_of(place: DVec3) -> f64 {
    TAU * turn_from_x(place.x, place.z)
}

/// The picture lies once over the swept angle, and from the profile's last point down to its first.
pub(super) fn surface_point(surface: &Revolution, near: DVec3, crossing: &Crossing) -> SurfacePoint {
    let piece = &surface.pieces[crossing.part as usize % surface.pieces.len()];
    let s = crossing.uv.y;
    let across = near.x.hypot(near.z);
    let radial = if across > 0.0 { DVec3::new(near.x, 0.0, near.z) / across } else { DVec3::X };
    let turned = |p: DVec2| radial * p.x + DVec3::Y * p.y;

    let point = turned(piece.at(s));
    let normal = turned(piece.normal(s)).normalize_or(DVec3::Y);
    let gone = piece.before + piece.length_to(s);
    let chart = Chart {
        uv: DVec2::new((angle_of(near) / surface.angle).min(1.0), 1.0 - gone / surface.length),
        along_u: surface.angle * DVec3::new(point.z, 0.0, -point.x),
        along_v: -turned(piece.tangent(s)),
    };
    let mut met = chart.at(point, normal, piece.run);
    if piece.straight {
        let [first, second] = piece.end_normals;
        met.shading_normal = turned(first.lerp(second, s)).normalize_or(normal);
    }
    met
}
