//! Normals and texture coordinates of surfaces of revolution.

use std::f64::consts::TAU;

use senca_math::glam::{DVec2, DVec3};

use super::{Ends, Revolution};
use crate::intersect::analytic::{Chart, turn_from_x};
use crate::{Crossing, SurfacePoint};

/// Angle around the y axis, from +x towards -z, in [0, 2 pi).
pub(super) fn angle_of(place: DVec3) -> f64 {
    TAU * turn_from_x(place.x, place.z)
}

/// The picture lies once over the swept angle, and from the profile's last point down to its first.
pub(super) fn surface_point(surface: &Revolution, near: DVec3, crossing: &Crossing) -> SurfacePoint {
    let end = (crossing.part as usize).checked_sub(surface.pieces.len());
    if let (Some(end), Some(ends)) = (end, &surface.ends) {
        return end_point(surface, ends, end.min(1), near);
    }
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

/// A point of the flat side at the start (0) or end (1). The picture is upright seen from outside, from the
/// axis to the largest radius.
fn end_point(surface: &Revolution, ends: &Ends, end: usize, near: DVec3) -> SurfacePoint {
    let flat = ends.wedge.along[end];
    let along = DVec3::new(flat.x, 0.0, flat.y);
    let radius = along.dot(near).max(0.0);
    let point = along * radius + DVec3::Y * near.y;
    let outward = if (end == 1) == ends.inside_out { 1.0 } else { -1.0 };
    // The start faces +z, and the end the other way after its turn.
    let normal = outward * along.cross(DVec3::Y);
    let (largest, height) = (surface.bounds.max.x, surface.bounds.max.y - surface.bounds.min.y);
    let share = radius / largest;
    let chart = Chart {
        uv: DVec2::new(if end == 1 { 1.0 - share } else { share }, (surface.bounds.max.y - near.y) / height),
        along_u: along * if end == 1 { -largest } else { largest },
        along_v: DVec3::NEG_Y * height,
    };
    let runs = surface.pieces.last().map_or(0, |piece| piece.run + 1);
    chart.at(point, normal, runs + end as u32)
}
