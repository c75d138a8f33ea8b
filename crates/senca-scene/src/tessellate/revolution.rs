//! Surfaces of revolution from a profile.
//!
//! The profile is cut into pieces (segments of a polyline, cubic Bézier pieces). Where it turns by
//! more than [`CREASE`] from one piece to the next, or touches the axis, a new surface begins; else
//! both sides share the mean normal. So a polyline of many points looks smooth, and a cup keeps its rim.
//!
//! Less than a full turn of a profile that encloses an area, alone or with the axis, can be closed by a flat
//! side at either end.

use std::f64::consts::TAU;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3};
use senca_math::polygon::signed_area;

use super::build::Builder;
use super::lathe::{Lathe, Run, Sample, Wrapping};
use super::polygon::add_flat;
use super::solids::{MAX_AROUND, along, around, chord_steps, within_budget};
use super::{MAX_FACES, ShapeError, TessellationSettings, positive};

/// Largest turn of a profile, in radians, that is still smooth: 30 degrees.
pub const CREASE: f64 = std::f64::consts::PI / 6.0;

/// A stretch of the profile with its unit tangents.
struct Piece {
    samples: Vec<(DVec2, DVec2)>,
}

/// Appends a profile turned around the y axis by `angle`, from +x towards -z.
pub(super) fn revolution(
    profile: &[DVec2],
    bezier: bool,
    angle: f64,
    capped: bool,
    settings: &TessellationSettings,
    b: &mut Builder,
) -> Result<(), ShapeError> {
    check(profile, bezier, angle)?;
    let radius = profile.iter().map(|p| p.x).fold(0.0, f64::max);
    positive("revolution", "the largest radius", radius)?;
    let (low, high) = profile.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.y), h.max(p.y)));
    let bounds = Aabb { min: DVec3::new(-radius, low, -radius), max: DVec3::new(radius, high, radius) };
    let tolerance = settings.tolerance.over_box(&bounds);
    let most = (MAX_AROUND / profile.len().min(1024) as u32).max(2);
    let pieces = if bezier {
        bezier_pieces(profile, |bend| {
            along(settings, chord_steps(12.0 * bend, tolerance.unwrap_or(f64::INFINITY), most))
        })
    } else {
        polyline_pieces(profile, along(settings, 1).min(most))
    };
    let full = around(settings, radius, &bounds, if bezier { 0.5 } else { 1.0 });
    let steps = ((f64::from(full) * angle / TAU).ceil() as u32).max(if angle < TAU { 1 } else { 3 });
    let (rings, runs) = rings_and_runs(&pieces, 1e-12 * radius);
    if runs.is_empty() {
        let reason = "the profile has no length".to_owned();
        return Err(ShapeError::Malformed { shape: "revolution", reason });
    }
    let rows = (rings.len() as u64).min(MAX_FACES) as u32;
    let (steps, _) = within_budget(steps, rows, (3, 1));
    let encloses = rings_close(&pieces, &rings);
    let lathe = Lathe { rings, runs, start: 0.0, sweep: angle.min(TAU), steps };
    let first_points = lathe.build(b);
    if capped && encloses && !lathe.is_closed() {
        add_ends(&lathe, &first_points, &bounds, b);
    }
    Ok(())
}

/// Whether the profile's last point is its first, or both are on the axis.
fn rings_close(pieces: &[Piece], rings: &[DVec2]) -> bool {
    let sample = |piece: Option<&Piece>, last: bool| {
        piece.and_then(|p| if last { p.samples.last() } else { p.samples.first() }).map(|s| s.0)
    };
    let on_axis = |ring: Option<&DVec2>| ring.is_some_and(|p| p.x == 0.0);
    sample(pieces.first(), false) == sample(pieces.last(), true)
        || on_axis(rings.first()) && on_axis(rings.last())
}

/// The flat sides at both ends of less than a full turn, which face as the profile's direction says.
/// Pictures are upright seen from outside, from the axis to the largest radius of `bounds`.
fn add_ends(lathe: &Lathe, first_points: &[u32], bounds: &Aabb, b: &mut Builder) {
    let area = signed_area(&lathe.rings);
    let (radius, height) = (bounds.max.x, bounds.max.y - bounds.min.y);
    if area.abs() <= 1e-12 * radius * height {
        return;
    }
    let inside_out = area < 0.0;
    let mut corners: Vec<(DVec2, u32)> =
        lathe.rings.iter().copied().zip(first_points.iter().copied()).collect();
    if inside_out {
        corners.reverse();
    }
    let ring: Vec<DVec2> = corners.iter().map(|corner| corner.0).collect();
    for (name, is_end) in [("start", false), ("end", true)] {
        let surface = b.surface(name);
        let (sin, cos) = if is_end { lathe.sweep.sin_cos() } else { (0.0, 1.0) };
        let outward = if is_end == inside_out { 1.0 } else { -1.0 };
        let normal = outward * DVec3::new(sin, 0.0, cos);
        let first = b.mesh.vertices.point.len() as u32;
        for &(place, point) in &corners {
            let column = if is_end && place.x != 0.0 { lathe.steps } else { 0 };
            let share = place.x / radius;
            let u = if is_end { 1.0 - share } else { share };
            b.vertex(point + column, normal, DVec2::new(u, (bounds.max.y - place.y) / height));
        }
        add_flat(std::slice::from_ref(&ring), first, is_end != inside_out, surface, b);
    }
}

fn check(profile: &[DVec2], bezier: bool, angle: f64) -> Result<(), ShapeError> {
    let malformed = |reason: String| Err(ShapeError::Malformed { shape: "revolution", reason });
    positive("revolution", "angle", angle)?;
    if angle > TAU * (1.0 + 1e-9) {
        let expected = "at most a full turn, 2 pi";
        return Err(ShapeError::Parameter {
            shape: "revolution",
            parameter: "angle",
            value: angle,
            expected,
        });
    }
    if profile.len() < 2 || profile.len() as u64 > MAX_FACES / 8 {
        return malformed(format!(
            "the profile has {} points, but needs 2 to {}",
            profile.len(),
            MAX_FACES / 8
        ));
    }
    if bezier && profile.len() % 3 != 1 {
        return malformed(format!("a Bézier profile has 3 n + 1 points, not {}", profile.len()));
    }
    match profile.iter().position(|p| !(p.is_finite() && p.x >= 0.0)) {
        Some(i) => malformed(format!("profile point {i} must be finite with a radius of 0 or more")),
        None => Ok(()),
    }
}

/// Segments of a polyline, those without length left out.
fn polyline_pieces(profile: &[DVec2], steps: u32) -> Vec<Piece> {
    let segments = profile.windows(2).filter(|pair| pair[0] != pair[1]);
    segments
        .map(|pair| {
            let tangent = (pair[1] - pair[0]).normalize_or(DVec2::Y);
            let at = |i: u32| {
                if i == steps { pair[1] } else { pair[0].lerp(pair[1], f64::from(i) / f64::from(steps)) }
            };
            Piece { samples: (0..=steps).map(|i| (at(i), tangent)).collect() }
        })
        .collect()
}

/// Cubic pieces, each in the number of steps that `steps_for` gives for its largest second difference.
fn bezier_pieces(profile: &[DVec2], steps_for: impl Fn(f64) -> u32) -> Vec<Piece> {
    let pieces = (0..profile.len() - 1)
        .step_by(3)
        .map(|i| [profile[i], profile[i + 1], profile[i + 2], profile[i + 3]]);
    pieces
        .filter(|c| c.iter().any(|&p| p != c[0]))
        .map(|c| {
            let bend = |i: usize| (c[i] - 2.0 * c[i + 1] + c[i + 2]).length();
            let steps = steps_for(bend(0).max(bend(1)));
            let samples = (0..=steps).map(|i| on_profile(&c, f64::from(i) / f64::from(steps)));
            Piece { samples: samples.collect() }
        })
        .collect()
}

/// Place and unit tangent of a cubic piece; where the derivative vanishes, the direction from inside.
fn on_profile(c: &[DVec2; 4], t: f64) -> (DVec2, DVec2) {
    let mut p = *c;
    for level in (1..4).rev() {
        for i in 0..level {
            p[i] = p[i].lerp(p[i + 1], t);
        }
    }
    let slope = |t: f64| {
        let (a, b) = ((c[1] - c[0]).lerp(c[2] - c[1], t), (c[2] - c[1]).lerp(c[3] - c[2], t));
        a.lerp(b, t)
    };
    let size = c.iter().map(|q| q.distance(c[0])).fold(0.0, f64::max);
    let inward = [0.0, 1e-6, 1e-3, 0.1].map(|s| slope(t + s * (0.5 - t)));
    let tangent = inward.into_iter().find(|d| d.length() > 1e-9 * size).unwrap_or(c[3] - c[0]);
    (DVec2::new(p[0].x.max(0.0), p[0].y), tangent.normalize_or(DVec2::Y))
}

/// Rings shared along the profile and the smooth runs over them. Radii up to `on_axis` are 0.
fn rings_and_runs(pieces: &[Piece], on_axis: f64) -> (Vec<DVec2>, Vec<Run>) {
    let snapped = |p: DVec2| DVec2::new(if p.x <= on_axis { 0.0 } else { p.x }, p.y);
    let length: f64 = pieces.iter().map(length_of).sum();
    let (mut rings, mut runs) = (Vec::<DVec2>::new(), Vec::<Run>::new());
    let mut before: Option<DVec2> = None;
    let mut gone = 0.0;
    for piece in pieces {
        let outward = |tangent: DVec2| DVec2::new(tangent.y, -tangent.x);
        let (start, tangent) = piece.samples[0];
        let v = |gone: f64| 1.0 - gone / length;
        let smooth = before.is_some_and(|b| b.angle_to(tangent).abs() <= CREASE) && snapped(start).x > 0.0;
        if rings.is_empty() {
            rings.push(snapped(start));
        }
        if smooth {
            let last = runs.last_mut().and_then(|run| run.samples.last_mut());
            last.into_iter().for_each(|s| s.normal = (s.normal + outward(tangent)).normalize_or(s.normal));
        } else {
            let first = Sample { ring: rings.len() - 1, normal: outward(tangent), v: v(gone) };
            runs.push(Run { name: "", samples: vec![first], wrapping: Wrapping::Around });
        }
        for pair in piece.samples.windows(2) {
            gone += pair[0].0.distance(pair[1].0);
            let sample = Sample { ring: rings.len(), normal: outward(pair[1].1), v: v(gone) };
            rings.push(snapped(pair[1].0));
            runs.last_mut().into_iter().for_each(|run| run.samples.push(sample));
        }
        before = piece.samples.last().map(|s| s.1);
    }
    close_profile(pieces, &mut rings, &mut runs);
    (rings, runs)
}

fn length_of(piece: &Piece) -> f64 {
    piece.samples.windows(2).map(|pair| pair[0].0.distance(pair[1].0)).sum()
}

/// A profile that ends where it began shares that ring, and its normal where it is smooth.
fn close_profile(pieces: &[Piece], rings: &mut Vec<DVec2>, runs: &mut [Run]) {
    if rings.len() < 4 || rings[0] != rings[rings.len() - 1] {
        return;
    }
    rings.pop();
    let ends = |piece: Option<&Piece>, last: bool| {
        piece.and_then(|p| if last { p.samples.last() } else { p.samples.first() }).map_or(DVec2::Y, |s| s.1)
    };
    let smooth = ends(pieces.last(), true).angle_to(ends(pieces.first(), false)).abs() <= CREASE;
    let Some(start) = runs.first().and_then(|run| run.samples.first()).map(|s| s.normal) else { return };
    let Some(last) = runs.last_mut().and_then(|run| run.samples.last_mut()) else { return };
    last.ring = 0;
    let mean = (last.normal + start).normalize_or(start);
    if smooth {
        last.normal = mean;
        runs[0].samples[0].normal = mean;
    }
}
