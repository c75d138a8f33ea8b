//! The pieces of a profile: their form, their smooth runs, their lengths.

use std::f64::consts::TAU;

use senca_math::glam::DVec2;
use senca_math::polygon::signed_area;
use senca_scene::{MAX_FACES, REVOLUTION_CREASE, ShapeError};

use crate::intersect::build::{malformed, positive};

/// Share of the largest radius up to which a radius counts as 0.
pub(super) const ON_AXIS: f64 = 1e-12;

/// Equal steps of the parameter between which arc lengths are kept.
const LENGTH_STEPS: usize = 16;

/// One piece of a profile.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Bézier control points `(radius, y)`; of a straight piece the first and last count.
    pub points: [DVec2; 4],
    /// Whether the piece is a straight line.
    pub straight: bool,
    /// Smallest and largest y of the control points, and their largest radius.
    pub heights: [f64; 2],
    pub reach: f64,
    /// Number of the smooth run, which is the surface.
    pub run: u32,
    /// Normals `(radial, y)` to shade with at both ends of a straight piece: those of the corners
    /// where the profile is smooth there.
    pub end_normals: [DVec2; 2],
    /// Length of the profile before this piece, and of this piece.
    pub before: f64,
    pub length: f64,
    /// Length from the start of the piece to each of the equal steps of a curved one.
    lengths: [f64; LENGTH_STEPS + 1],
}

impl Piece {
    fn new(points: [DVec2; 4], straight: bool) -> Self {
        let all = if straight { vec![points[0], points[3]] } else { points.to_vec() };
        let mut piece = Self {
            points,
            straight,
            heights: all.iter().fold([f64::MAX, f64::MIN], |[l, h], p| [l.min(p.y), h.max(p.y)]),
            reach: all.iter().map(|p| p.x).fold(0.0, f64::max),
            run: 0,
            end_normals: [DVec2::ZERO; 2],
            before: 0.0,
            length: points[0].distance(points[3]),
            lengths: [0.0; LENGTH_STEPS + 1],
        };
        if !straight {
            for i in 0..LENGTH_STEPS {
                let (a, b) = (i as f64 / LENGTH_STEPS as f64, (i + 1) as f64 / LENGTH_STEPS as f64);
                piece.lengths[i + 1] = piece.lengths[i] + piece.length_between(a, b);
            }
            piece.length = piece.lengths[LENGTH_STEPS];
        }
        piece
    }

    /// The place `(radius, y)` at s.
    pub(super) fn at(&self, s: f64) -> DVec2 {
        let [a, b, c, d] = self.points;
        if self.straight {
            return a.lerp(d, s);
        }
        let (ab, bc, cd) = (a.lerp(b, s), b.lerp(c, s), c.lerp(d, s));
        ab.lerp(bc, s).lerp(bc.lerp(cd, s), s)
    }

    /// The derivative at s.
    pub(super) fn slope(&self, s: f64) -> DVec2 {
        let [a, b, c, d] = self.points;
        if self.straight {
            return d - a;
        }
        3.0 * (b - a).lerp(c - b, s).lerp((c - b).lerp(d - c, s), s)
    }

    /// Unit tangent; where the derivative vanishes, the direction from inside.
    pub(super) fn tangent(&self, s: f64) -> DVec2 {
        let size = self.points.iter().map(|p| p.distance(self.points[0])).fold(0.0, f64::max);
        let inward = [0.0, 1e-6, 1e-3, 0.1].map(|step| self.slope(s + step * (0.5 - s)));
        let tangent = inward.into_iter().find(|d| d.length() > 1e-9 * size);
        tangent.unwrap_or(self.points[3] - self.points[0]).normalize_or(DVec2::Y)
    }

    /// Unit normal `(radial, y)` on the outside.
    pub(super) fn normal(&self, s: f64) -> DVec2 {
        let tangent = self.tangent(s);
        DVec2::new(tangent.y, -tangent.x)
    }

    /// Length of the piece up to s.
    pub(super) fn length_to(&self, s: f64) -> f64 {
        if self.straight {
            return s * self.length;
        }
        let step = ((s * LENGTH_STEPS as f64) as usize).min(LENGTH_STEPS - 1);
        self.lengths[step] + self.length_between(step as f64 / LENGTH_STEPS as f64, s)
    }

    /// Length between two parameters, by Gauss' rule of three nodes.
    //
    // As a sum of three terms instead of a loop this brings rustc 1.95 down in optimized builds with
    // thin LTO (SIGSEGV in LLVM's register coalescer).
    fn length_between(&self, a: f64, b: f64) -> f64 {
        const NODES: [(f64, f64); 3] =
            [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut sum = 0.0;
        for (node, weight) in NODES {
            sum += weight * self.slope(middle + half * node).length();
        }
        half * sum
    }
}

/// Refuses what is no profile.
pub(super) fn check(profile: &[DVec2], bezier: bool, angle: f64) -> Result<(), ShapeError> {
    positive("revolution", "angle", angle)?;
    if angle > TAU * (1.0 + 1e-9) {
        let (parameter, expected) = ("angle", "at most a full turn, 2 pi");
        return Err(ShapeError::Parameter { shape: "revolution", parameter, value: angle, expected });
    }
    let (count, most) = (profile.len(), MAX_FACES / 8);
    if count < 2 || count as u64 > most {
        return malformed("revolution", &format!("the profile has {count} points, but needs 2 to {most}"));
    }
    if bezier && count % 3 != 1 {
        return malformed("revolution", &format!("a Bézier profile has 3 n + 1 points, not {count}"));
    }
    if let Some(i) = profile.iter().position(|p| !(p.is_finite() && p.x >= 0.0)) {
        let reason = format!("profile point {i} must be finite with a radius of 0 or more");
        return malformed("revolution", &reason);
    }
    let radius = profile.iter().map(|p| p.x).fold(0.0, f64::max);
    positive("revolution", "the largest radius", radius).map(|_| ())
}

/// The pieces of a profile, those without length left out.
pub(super) fn pieces_of(profile: &[DVec2], bezier: bool) -> Vec<Piece> {
    let radius = profile.iter().map(|p| p.x).fold(0.0, f64::max);
    let snapped = |p: DVec2| DVec2::new(if p.x <= ON_AXIS * radius { 0.0 } else { p.x }, p.y);
    let mut pieces: Vec<Piece> = if bezier {
        let starts = (0..profile.len() - 1).step_by(3);
        let points = starts.map(|i| std::array::from_fn(|k| snapped(profile[i + k])));
        points.filter(|p: &[DVec2; 4]| p.iter().any(|q| *q != p[0])).map(|p| Piece::new(p, false)).collect()
    } else {
        let pairs = profile.windows(2).map(|pair| [snapped(pair[0]), snapped(pair[1])]);
        pairs.filter(|[a, b]| a != b).map(|[a, b]| Piece::new([a, a, b, b], true)).collect()
    };
    join(&mut pieces);
    pieces
}

/// Area that a closed profile runs around, negative when clockwise, as far as a polygon of steps tells.
pub(super) fn area(pieces: &[Piece]) -> f64 {
    let steps = |piece: &Piece| if piece.straight { 1 } else { LENGTH_STEPS };
    let points = |piece: &Piece| -> Vec<DVec2> {
        (0..steps(piece)).map(|i| piece.at(i as f64 / steps(piece) as f64)).collect()
    };
    let last = pieces.last().map(|piece| piece.points[3]);
    signed_area(&pieces.iter().flat_map(points).chain(last).collect::<Vec<_>>())
}

/// Numbers the smooth runs, shares normals within them, and adds up lengths. A new run begins where the
/// profile turns by more than [`REVOLUTION_CREASE`] or touches the axis.
fn join(pieces: &mut [Piece]) {
    let mut before = 0.0;
    for i in 0..pieces.len() {
        pieces[i].before = before;
        before += pieces[i].length;
        pieces[i].end_normals = [pieces[i].normal(0.0), pieces[i].normal(1.0)];
        if i == 0 {
            continue;
        }
        let smooth = pieces[i].points[0].x > 0.0 && is_smooth(&pieces[i - 1], &pieces[i]);
        pieces[i].run = pieces[i - 1].run + u32::from(!smooth);
        if smooth {
            share_normal(pieces, i - 1, i);
        }
    }
    let last = pieces.len().saturating_sub(1);
    // A profile that ends where it began, unless there and back.
    if last >= 2 && pieces[last].points[3] == pieces[0].points[0] && is_smooth(&pieces[last], &pieces[0]) {
        share_normal(pieces, last, 0);
    }
}

fn is_smooth(first: &Piece, second: &Piece) -> bool {
    first.tangent(1.0).angle_to(second.tangent(0.0)).abs() <= REVOLUTION_CREASE
}

fn share_normal(pieces: &mut [Piece], first: usize, second: usize) {
    let own = pieces[first].end_normals[1];
    let mean = (own + pieces[second].end_normals[0]).normalize_or(own);
    pieces[first].end_normals[1] = mean;
    pieces[second].end_normals[0] = mean;
}
