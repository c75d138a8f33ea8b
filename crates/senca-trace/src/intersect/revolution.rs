//! Surfaces of revolution.
//!
//! The profile is a chain of pieces, straight or cubic, `(radius, y)` as polynomials in s. Let p be the
//! distance of the line from the axis, met at height c, and k the line's rise per length across the axis.
//! The line is at height y at a radius r with `r^2 - p^2 = ((y - c) / k)^2`. So the crossings with a piece
//! are the roots in [0, 1] of
//!
//! `H(s) = r(s)^2 - p^2 - ((y(s) - c) / k)^2`,
//!
//! of degree 2 for straight and 6 for cubic pieces, in Bernstein form. The value at the end of a piece
//! is computed from nothing but the ring there and the line; both neighbours get the same sign, and no
//! line slips through between them.
//!
//! Nearly level lines, k small, would lose their digits in H: there the piece is first cut to the stretches
//! whose heights the line reaches within the largest radius.

mod chart;
mod meet;
mod profile;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};
use senca_scene::ShapeError;

use super::analytic::Analytic;
use crate::{Crossing, Ray, SurfacePoint};
use meet::AxialRay;
use profile::Piece;

/// A profile turned around the y axis, from +x towards -z. The part of a crossing is the number of its
/// piece, `uv.y` the place along it.
#[derive(Clone, Debug)]
pub struct Revolution {
    pieces: Vec<Piece>,
    /// Length of the whole profile.
    length: f64,
    /// Angle swept, in (0, 2 pi].
    angle: f64,
    full_turn: bool,
    closed: bool,
    bounds: Aabb,
}

impl Revolution {
    /// A surface of revolution from points `(radius, y)`: corners of a polyline, or control points of
    /// chained cubic Bézier pieces (3 n + 1 points).
    ///
    /// # Errors
    /// [`ShapeError`] when a point is not finite or has a radius below 0, the angle is outside of (0, 2 pi],
    /// or the number of points is wrong.
    pub fn new(profile: &[DVec2], bezier: bool, angle: f64) -> Result<Self, ShapeError> {
        profile::check(profile, bezier, angle)?;
        let pieces = profile::pieces_of(profile, bezier);
        if pieces.is_empty() {
            return super::build::malformed("revolution", "the profile has no length");
        }
        let radius = profile.iter().map(|p| p.x).fold(0.0, f64::max);
        let (low, high) = profile.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.y), h.max(p.y)));
        let full_turn = angle >= std::f64::consts::TAU * (1.0 - 1e-12);
        let (first, last) = (profile[0], profile[profile.len() - 1]);
        let on_axis = |p: DVec2| p.x <= profile::ON_AXIS * radius;
        Ok(Self {
            length: pieces.iter().map(|piece| piece.length).sum(),
            pieces,
            angle,
            full_turn,
            closed: full_turn && (first == last || on_axis(first) && on_axis(last)),
            bounds: Aabb { min: DVec3::new(-radius, low, -radius), max: DVec3::new(radius, high, radius) },
        })
    }

    /// Whether the sweep reaches a place.
    fn sweeps(&self, place: DVec3) -> bool {
        self.full_turn || chart::angle_of(place) <= self.angle
    }
}

impl Analytic for Revolution {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let axial = AxialRay::new(ray, &self.bounds);
        for (part, piece) in self.pieces.iter().enumerate() {
            axial.each_crossing(piece, &mut |t, s| {
                if self.sweeps(ray.at(t)) {
                    meet(t, part as u32, DVec2::new(0.0, s));
                }
            });
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        chart::surface_point(self, ray.at(crossing.t), crossing)
    }

    fn is_closed(&self) -> bool {
        self.closed
    }
}
