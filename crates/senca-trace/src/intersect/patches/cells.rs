//! Pieces of a patch, so small that they are nearly flat, and what is certain about each.
//!
//! A cell is a rectangle of a patch's parameters, x in [-1, 1]^2. In its own frame, whose axes are the
//! derivatives at the centre and the normal there, the surface is nearly the square itself, and a ray
//! meets it nearly where it meets the plane of that square. How nearly is known: with `spread` and `tilt`,
//! bounds on how much the derivatives differ over the cell from those at the centre, a ray whose slopes in
//! the frame are s meets the cell at most once, and not farther than `spread + tilt |s|` from there, as
//! long as that is below 1 (Krawczyk 1969, applied to rays). So most cells are rejected, rightly, by
//! intersecting one plane, and in the others Newton's method starts next to the only root. The bounds are
//! taken over the cell and a margin around it: when Newton's method ends in the margin, then there is no
//! root in the cell.

use fearless_simd::{Simd, f32x16, prelude::*};
use senca_math::glam::{BVec3, DMat3, DVec3, DVec4, Mat3, Vec2, Vec3};

use super::net::{Axis, Net};
use super::patch::quotient;
use super::roots::Domain;
use crate::lanes::channels;

/// A nearly flat piece of a patch. What all rays ask that come near it fills the first of its two cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Cell {
    /// Cell frame from normalized space; zero for a cell without a frame.
    pub local_from_object: Mat3,
    /// Its point in the middle.
    pub center: Vec3,
    /// How much the derivatives differ from those at the centre over the cell and its margin, in the plane
    /// ...
    pub spread: Vec2,
    /// ... and out of it. Infinite when nothing is known.
    pub tilt: f32,
    /// Share of both that the cell itself reaches.
    pub inner: f32,
    /// Patch it belongs to.
    pub patch: u32,
    /// Middle and half size of its rectangle: multiples of powers of 1/2, and so exact.
    pub uv: [f32; 4],
    /// Box around the surface, in the frame: how far it gets from the centre.
    pub extent: [Vec3; 2],
    /// Points of which the cell lies within the hull, coordinate by coordinate, where they are sixteen.
    pub hull: Option<Box<[[f32; 16]; 3]>>,
}

/// The control points of a bicubic piece.
fn hull(net: &Net<DVec4>) -> Option<Box<[[f32; 16]; 3]>> {
    let points: &[DVec4; 16] = net.points().try_into().ok()?;
    let coordinate = |axis: usize| points.map(|p| (p[axis] / p.w) as f32);
    Some(Box::new([coordinate(0), coordinate(1), coordinate(2)]))
}

/// Half size of a cell with its margin; the cell's is 1.
const OUTER: f64 = 1.5;

/// Width of the margin, per half size of a cell, less what rounding takes.
pub(super) const MARGIN: f64 = OUTER - 1.001;

/// Error of a place in normalized space in single precision: coordinates and steps of up to 2.
const PLACE_ERROR: f64 = 1e-6;

/// Error of a distance along the ray within the unit ball, in single precision.
pub(super) const PLACE_SLACK: f32 = 4e-6;

/// What is found out about a piece while patches are divided.
pub(super) struct Survey {
    pub frame: Option<Frame>,
    /// Box around the piece in normalized space.
    pub low: DVec3,
    pub high: DVec3,
    /// Which direction to divide.
    pub axis: Axis,
    /// How far from flat; infinite without a frame.
    pub error: f64,
}

/// The frame of a regular piece.
pub(super) struct Frame {
    local_from_object: DMat3,
    center: DVec3,
    /// Bounds on the change of the derivatives, summed over both: x, y, z in the frame.
    change: DVec3,
    extent: [DVec3; 2],
    /// The piece in its frame, the centre at the origin, as a quotient q / w with w = 1 there.
    local: Net<DVec4>,
}

impl Frame {
    /// How far a hit may be from where a ray under 45 degrees meets the plane.
    fn error(&self) -> f64 {
        let lengths = self.local_from_object.inverse();
        let tilt = self.change.z * lengths.z_axis.length();
        let along = |change: f64, length: f64| change + tilt / length;
        along(self.change.x, lengths.x_axis.length()).max(along(self.change.y, lengths.y_axis.length()))
    }
}

/// Interval per coordinate.
#[derive(Clone, Copy)]
struct Range<T> {
    low: T,
    high: T,
}

impl Range<DVec4> {
    fn of(points: impl Iterator<Item = DVec4>) -> Self {
        let none = Self { low: DVec4::INFINITY, high: DVec4::NEG_INFINITY };
        points.fold(none, |r, p| Self { low: r.low.min(p), high: r.high.max(p) })
    }
}

/// Smallest and largest product of two intervals, per coordinate.
fn product(a: Range<DVec3>, low: f64, high: f64) -> Range<DVec3> {
    let all = [a.low * low, a.low * high, a.high * low, a.high * high];
    let none = Range { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
    all.iter().fold(none, |r, p| Range { low: r.low.min(*p), high: r.high.max(*p) })
}

/// Looks at a piece given by its net.
pub(super) fn survey(net: &Net<DVec4>, is_rational: bool) -> Survey {
    let places = net.points().iter().map(|p| p.truncate() / p.w);
    let (low, high) =
        places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let frame = frame(net, is_rational);
    let error = frame.as_ref().map_or(f64::INFINITY, Frame::error);
    Survey { frame, low, high, axis: longer_axis(net), error }
}

/// The axis along which the piece bends more; among flat ones, the longer.
fn longer_axis(net: &Net<DVec4>) -> Axis {
    let score = |axis: Axis| {
        let length = net.derivative(axis).map(|d| d.truncate().length()).fold(0.0, f64::max);
        let bend = net.bend(axis, |d| d.truncate().length().max(d.w.abs()));
        bend + 0.1 * length
    };
    if score(Axis::U) >= score(Axis::V) { Axis::U } else { Axis::V }
}

/// The frame at the centre, with its bounds; `None` where the derivatives are not independent.
fn frame(net: &Net<DVec4>, is_rational: bool) -> Option<Frame> {
    let homogeneous = net.at(0.5, 0.5);
    let jet = quotient(&homogeneous);
    let (du, dv) = (0.5 * jet.du, 0.5 * jet.dv);
    let normal = du.cross(dv);
    let area = du.length() * dv.length();
    let is_regular = normal.length() > 1e-4 * area;
    if !is_regular {
        return None;
    }
    let local_from_object = DMat3::from_cols(du, dv, normal / normal.length() * area.sqrt()).inverse();
    let entries = local_from_object.to_cols_array();
    if !entries.iter().all(|x| x.abs() < 1e12) {
        return None;
    }
    let weight = homogeneous.value.w;
    let local = net.map(|p| {
        let offset = p.truncate() - jet.value * p.w;
        (local_from_object * offset / weight).extend(p.w / weight)
    });
    let (change, extent) = bounds(&local, 1.0, is_rational);
    Some(Frame { local_from_object, center: jet.value, change, extent, local })
}

/// Change of the derivatives, per half cell, and box around a net that covers a square of half size `half`.
fn bounds(local: &Net<DVec4>, half: f64, is_rational: bool) -> (DVec3, [DVec3; 2]) {
    let place = Range::of(local.points().iter().map(|p| (p.truncate() / p.w).extend(p.w)));
    let change = change(local, Axis::U, 0.5 / half, DVec3::X, &place, is_rational)
        + change(local, Axis::V, 0.5 / half, DVec3::Y, &place, is_rational);
    (change, [place.low.truncate(), place.high.truncate()])
}

/// How much the derivative along an axis, per half cell, differs from `unit` at most.
///
/// For s = q / w it is (q' - s w') / w; each part keeps within the range of its control points.
fn change(
    local: &Net<DVec4>,
    axis: Axis,
    per_half: f64,
    unit: DVec3,
    place: &Range<DVec4>,
    is_rational: bool,
) -> DVec3 {
    let slope = Range::of(local.derivative(axis).map(|d| per_half * d));
    let (mut low, mut high) = (slope.low.truncate(), slope.high.truncate());
    if is_rational {
        let places = Range { low: place.low.truncate(), high: place.high.truncate() };
        let bent = product(places, slope.low.w, slope.high.w);
        let top = Range { low: low - bent.high, high: high - bent.low };
        let all = product(top, 1.0 / place.high.w, 1.0 / place.low.w);
        (low, high) = (all.low, all.high);
    }
    (low - unit).abs().max((high - unit).abs())
}

/// Change of the derivatives over a cell and its margin.
fn outer_change(local: &Net<DVec4>, is_rational: bool) -> DVec3 {
    let range = [0.5 - 0.5 * OUTER, 0.5 + 0.5 * OUTER];
    let net = local.clone().extended(Axis::U, range).extended(Axis::V, range);
    let has_weight = net.points().iter().all(|p| p.w > 0.0);
    if has_weight { bounds(&net, OUTER, is_rational).0 } else { DVec3::INFINITY }
}

impl Cell {
    /// The cell of a surveyed piece. Bounds are widened by what single precision loses.
    pub(super) fn new(
        patch: u32,
        (domain, net): (&Domain, &Net<DVec4>),
        survey: &Survey,
        is_rational: bool,
    ) -> Self {
        let (center, half) = (domain.center(), domain.half());
        let uv = [center.x, center.y, half.x, half.y].map(|x| x as f32);
        let Some(frame) = &survey.frame else {
            return Self {
                local_from_object: Mat3::ZERO,
                center: Vec3::ZERO,
                spread: Vec2::ZERO,
                tilt: f32::INFINITY,
                inner: 1.0,
                extent: [Vec3::NEG_INFINITY, Vec3::INFINITY],
                patch,
                uv,
                hull: hull(net),
            };
        };
        let rows = frame.local_from_object.transpose();
        let stretch = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.abs().element_sum());
        let loss = DVec3::from_array(stretch) * (2.0 * PLACE_ERROR) + 1e-5;
        let outer = outer_change(&frame.local, is_rational) + loss;
        // Nothing is certain where weights vanish in the margin.
        let outer = if outer.is_finite() { outer } else { DVec3::splat(1e9) };
        let change = outer.as_vec3();
        Self {
            local_from_object: frame.local_from_object.as_mat3(),
            center: frame.center.as_vec3(),
            spread: change.truncate(),
            tilt: change.z,
            inner: ((frame.change + loss) / outer).max_element().min(1.0) as f32,
            extent: [(frame.extent[0] - loss).as_vec3(), (frame.extent[1] + loss).as_vec3()],
            patch,
            uv,
            hull: hull(net),
        }
    }

    /// Along the normal at the centre; zero without a frame.
    pub(super) fn normal(&self) -> Vec3 {
        self.local_from_object.row(2)
    }

    /// Whether all of the cell is on one side of one of two planes through `origin` across unit vectors.
    #[inline(always)]
    pub(super) fn is_beside<S: Simd>(&self, simd: S, origin: DVec3, planes: [DVec3; 2]) -> bool {
        let Some(hull) = &self.hull else { return false };
        let hull = channels!(k => f32x16::simd_from(simd, hull[k]));
        is_beside(simd, &hull, origin, planes[0]) || is_beside(simd, &hull, origin, planes[1])
    }

    /// Its rectangle.
    pub(super) fn domain(&self) -> Domain {
        let [u, v, du, dv] = self.uv.map(f64::from);
        Domain { u: [u - du, u + du], v: [v - dv, v + dv] }
    }

    /// Where in its frame a ray, given in normalized space, meets its plane, if that shows that there is
    /// one place at most.
    #[inline(always)]
    pub(super) fn meets(&self, origin: Vec3, direction: Vec3) -> Meeting {
        let o = self.local_from_object * (origin - self.center);
        let d = self.local_from_object * direction;
        let slope = d.truncate() / d.z;
        let x = o.truncate() - o.z * slope;
        let reach = self.spread + self.tilt * slope.abs();
        // Not a number when the ray runs along the plane.
        let most = reach.max_element();
        let is_one_to_one = most < 0.95;
        if !is_one_to_one {
            return self.meets_steeply(o, d);
        }
        if (x.abs() - self.inner * reach).max_element() > 1.0 { Meeting::Never } else { Meeting::Once(x) }
    }

    /// Whether a ray along the surface can meet the cell at all: the box in its frame.
    #[cold]
    fn meets_steeply(&self, o: Vec3, d: Vec3) -> Meeting {
        if self.tilt == f32::INFINITY {
            return Meeting::Unknown;
        }
        // Interval of the line between each pair of sides; lines along a pair are inside or outside.
        let along = d.abs().cmple(Vec3::splat(1e-20));
        let [low, high] = self.extent;
        let (a, b) = ((low - o) / d, (high - o) / d);
        let outside = o.cmplt(low) | o.cmpgt(high);
        let enter = Vec3::select(along, Vec3::NEG_INFINITY, a.min(b));
        let leave = Vec3::select(along, Vec3::INFINITY, a.max(b));
        let misses =
            (along & outside) != BVec3::FALSE || enter.max_element() > leave.min_element() + PLACE_SLACK;
        if misses { Meeting::Never } else { Meeting::Unknown }
    }
}

/// Whether points are on one side of a plane.
#[inline(always)]
fn is_beside<S: Simd>(simd: S, points: &[f32x16<S>; 3], origin: DVec3, normal: DVec3) -> bool {
    let error = 2.0 * PLACE_ERROR as f32;
    let n = normal.as_vec3().to_array();
    let [x, y, z] = channels!(k => points[k] * f32x16::splat(simd, n[k]));
    let above = x + y + z - f32x16::splat(simd, normal.dot(origin) as f32);
    above.reduce_min() > error || above.reduce_max() < -error
}

/// What the plane of a cell tells about a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meeting {
    /// The ray does not meet the cell.
    Never,
    /// It meets the cell with its margin at most once, near here if at all in the cell.
    Once(Vec2),
    /// Anything may be.
    Unknown,
}

const _: () = assert!(size_of::<Cell>() == 128, "two lines");
