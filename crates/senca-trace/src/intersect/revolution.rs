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

//!
//! Less than a full turn is what the whole body and a wedge between two half-planes at the axis have in
//! common. Along the line, both are entered and left in turn; a flat end is met where the wedge is
//! entered or left inside of the body. So crossings come in pairs whatever the rounding.

mod chart;
mod meet;
mod profile;
mod wedge;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};
use senca_scene::ShapeError;
use smallvec::SmallVec;

use super::analytic::Analytic;
use crate::{Crossing, Ray, SurfacePoint};
use meet::AxialRay;
use profile::Piece;
use wedge::Wedge;

/// A profile turned around the y axis, from +x towards -z. The part of a crossing is the number of its
/// piece, `uv.y` the place along it; the numbers after the last piece are the flat sides at the start and
/// at the end.
#[derive(Clone, Debug)]
pub struct Revolution {
    pieces: Vec<Piece>,
    /// Length of the whole profile.
    length: f64,
    /// Angle swept, in (0, 2 pi].
    angle: f64,
    full_turn: bool,
    /// Flat sides at both ends.
    ends: Option<Ends>,
    closed: bool,
    bounds: Aabb,
}

/// What closes less than a full turn.
#[derive(Clone, Copy, Debug)]
struct Ends {
    wedge: Wedge,
    /// Whether the profile runs around its area clockwise, and the normals face inwards.
    inside_out: bool,
}

impl Revolution {
    /// A surface of revolution from points `(radius, y)`: corners of a polyline, or control points of
    /// chained cubic Bézier pieces (3 n + 1 points). `capped`: flat sides close less than a full turn,
    /// where the profile encloses an area, alone or with the axis.
    ///
    /// # Errors
    /// [`ShapeError`] when a point is not finite or has a radius below 0, the angle is outside of (0, 2 pi],
    /// or the number of points is wrong.
    pub fn new(profile: &[DVec2], bezier: bool, angle: f64, capped: bool) -> Result<Self, ShapeError> {
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
        let encloses = first == last || on_axis(first) && on_axis(last);
        let area = profile::area(&pieces);
        let has_area = area.abs() > 1e-12 * radius * (high - low);
        let ends = Ends { wedge: Wedge::new(angle), inside_out: area < 0.0 };
        let ends = (capped && encloses && has_area && !full_turn).then_some(ends);
        Ok(Self {
            length: pieces.iter().map(|piece| piece.length).sum(),
            pieces,
            angle,
            full_turn,
            ends,
            closed: full_turn && encloses || ends.is_some(),
            bounds: Aabb { min: DVec3::new(-radius, low, -radius), max: DVec3::new(radius, high, radius) },
        })
    }

    /// The crossings of the closed body that the wedge cuts out of the full turn.
    fn each_crossing_within(&self, wedge: &Wedge, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let axial = AxialRay::new(ray, &self.bounds);
        let mut whole: SmallVec<[(f64, u32, f64); 8]> = SmallVec::new();
        for (part, piece) in self.pieces.iter().enumerate() {
            axial.each_crossing(piece, &mut |t, s| whole.push((t, part as u32, s)));
        }
        if whole.is_empty() {
            return;
        }
        whole.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut in_wedge, sides) = wedge.crossings(ray);
        let mut sides = sides.into_iter().peekable();
        let mut in_body = false;
        for (t, part, s) in whole {
            while let Some((t, side)) = sides.next_if(|side| side.0 < t) {
                in_wedge = !in_wedge;
                if in_body {
                    meet(t, self.pieces.len() as u32 + side, DVec2::ZERO);
                }
            }
            in_body = !in_body;
            if in_wedge {
                meet(t, part, DVec2::new(0.0, s));
            }
        }
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
        if let Some(ends) = &self.ends {
            return self.each_crossing_within(&ends.wedge, ray, meet);
        }
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
