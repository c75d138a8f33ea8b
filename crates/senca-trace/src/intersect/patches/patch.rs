//! One patch, ready to be evaluated and to be met by a ray.

use fearless_simd::{Simd, f64x4, prelude::*};
use senca_math::glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;

use super::net::{Axis, Jet, Net};
use crate::lanes::{F, V, channels};

/// A patch in the normalized space of its surface, in which all of it lies about within the unit ball.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Homogeneous control points; the largest weight is 1.
    pub net: Net<DVec4>,
    /// Whether weights differ.
    pub is_rational: bool,
    /// The same as powers of `u - 1/2`, `v - 1/2`, when no degree is above 3: `power[4 * j + i]` belongs
    /// to `u^i v^j`.
    power: Option<Box<[[f64; 4]; 16]>>,
    /// Largest length of control points of the derivatives.
    usual: [f64; 2],
}

/// Point and derivatives.
pub(super) type PatchJet = Jet<DVec3>;

impl Patch {
    pub(super) fn new(net: Net<DVec4>) -> Self {
        let largest = net.points().iter().map(|p| p.w).fold(f64::MIN_POSITIVE, f64::max);
        let net = net.map(|p| *p / largest);
        let is_rational = net.points().iter().any(|p| (p.w - 1.0).abs() > 1e-14);
        let net = if is_rational { net } else { net.map(|p| p.truncate().extend(1.0)) };
        let power = power_form(&net).map(Box::new);
        let usual = [Axis::U, Axis::V]
            .map(|axis| net.derivative(axis).map(|d| d.truncate().length()).fold(0.0, f64::max));
        Self { net, is_rational, power, usual }
    }

    /// Point and derivatives at `(u, v)`, which may lie somewhat outside of [0, 1].
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, simd: S, uv: DVec2) -> PatchJet {
        let jet = match &self.power {
            Some(power) => cubic_at(simd, power, uv),
            None => self.net.at(uv.x, uv.y),
        };
        if self.is_rational { quotient(&jet) } else { truncated(&jet) }
    }

    /// The homogeneous control points where both degrees are 3, u being the fast index.
    pub(super) fn bicubic(&self) -> Option<&[DVec4; 16]> {
        if self.net.size() == [4, 4] { self.net.points().try_into().ok() } else { None }
    }

    /// Whether no degree is above 3, so that eight places are evaluated at once.
    pub(super) fn is_cubic(&self) -> bool {
        self.power.is_some()
    }

    /// Point and derivatives at eight places; `None` when a degree is above 3.
    #[inline(always)]
    pub(super) fn at_eight<S: Simd>(&self, simd: S, u: F<S>, v: F<S>) -> Option<Jet<V<S>>> {
        let power = self.power.as_ref()?;
        let half = F::splat(simd, 0.5);
        let (u, v) = (u - half, v - half);
        let [x, y, z] = channels!(k => cubic_at_eight(simd, power, k, u, v));
        let jet = Jet {
            value: V { x: x[0], y: y[0], z: z[0] },
            du: V { x: x[1], y: y[1], z: z[1] },
            dv: V { x: x[2], y: y[2], z: z[2] },
        };
        if !self.is_rational {
            return Some(jet);
        }
        let [w, w_u, w_v] = cubic_at_eight(simd, power, 3, u, v);
        let inverse = F::splat(simd, 1.0) / w;
        let value = jet.value.times(inverse);
        Some(Jet {
            value,
            du: jet.du.sub(value.times(w_u)).times(inverse),
            dv: jet.dv.sub(value.times(w_v)).times(inverse),
        })
    }

    /// Whether both derivatives are there and independent.
    pub(super) fn is_regular(&self, uv: DVec2) -> bool {
        let jet = quotient(&self.net.at(uv.x, uv.y));
        let (du, dv) = (jet.du.length(), jet.dv.length());
        let [usual_du, usual_dv] = self.usual;
        du > 1e-5 * usual_du && dv > 1e-5 * usual_dv && jet.du.cross(jet.dv).length() > 1e-6 * du * dv
    }
}

fn truncated(jet: &Jet<DVec4>) -> PatchJet {
    Jet { value: jet.value.truncate(), du: jet.du.truncate(), dv: jet.dv.truncate() }
}

/// Point and derivatives from the homogeneous ones.
pub(super) fn quotient(jet: &Jet<DVec4>) -> PatchJet {
    let inverse = 1.0 / jet.value.w;
    let value = jet.value.truncate() * inverse;
    Jet {
        value,
        du: (jet.du.truncate() - value * jet.du.w) * inverse,
        dv: (jet.dv.truncate() - value * jet.dv.w) * inverse,
    }
}

/// Powers around 1/2 of a curve with up to four control points.
fn curve_powers(points: &[DVec4]) -> [DVec4; 4] {
    let zero = DVec4::ZERO;
    match *points {
        [a, b] => [0.5 * (a + b), b - a, zero, zero],
        [a, b, c] => [0.25 * (a + 2.0 * b + c), c - a, a - 2.0 * b + c, zero],
        [a, b, c, d] => [
            0.125 * (a + 3.0 * b + 3.0 * c + d),
            0.75 * (d + c - b - a),
            1.5 * (a - b - c + d),
            d - 3.0 * c + 3.0 * b - a,
        ],
        _ => [zero; 4],
    }
}

fn power_form(net: &Net<DVec4>) -> Option<[[f64; 4]; 16]> {
    let [width, height] = net.size();
    if width > 4 || height > 4 {
        return None;
    }
    let rows: SmallVec<[[DVec4; 4]; 4]> = net.points().chunks(width).map(curve_powers).collect();
    let columns: [[DVec4; 4]; 4] = std::array::from_fn(|i| {
        curve_powers(&rows.iter().map(|row| row[i]).collect::<SmallVec<[DVec4; 4]>>())
    });
    Some(std::array::from_fn(|k| columns[k % 4][k / 4].to_array()))
}

/// Value and derivatives of a bicubic polynomial, by Horner's scheme in u, then in v. Products and sums
/// stay apart, so that machines with and without fused ones agree.
#[inline(always)]
fn cubic_at<S: Simd>(simd: S, power: &[[f64; 4]; 16], uv: DVec2) -> Jet<DVec4> {
    let (u, v) = (f64x4::splat(simd, uv.x - 0.5), f64x4::splat(simd, uv.y - 0.5));
    let (s0, d0) = row_at(simd, power, 0, u);
    let (s1, d1) = row_at(simd, power, 4, u);
    let (s2, d2) = row_at(simd, power, 8, u);
    let (s3, d3) = row_at(simd, power, 12, u);
    let p2 = s3 * v + s2;
    let p1 = p2 * v + s1;
    Jet {
        value: DVec4::from_array((p1 * v + s0).into()),
        du: DVec4::from_array((((d3 * v + d2) * v + d1) * v + d0).into()),
        dv: DVec4::from_array(((s3 * v + p2) * v + p1).into()),
    }
}

/// Component `k` at eight places, with the derivatives along u and v: see [`cubic_at`].
#[inline(always)]
fn cubic_at_eight<S: Simd>(simd: S, power: &[[f64; 4]; 16], k: usize, u: F<S>, v: F<S>) -> [F<S>; 3] {
    let ((s0, d0), (s1, d1), (s2, d2), (s3, d3)) = (
        row_at_eight(simd, power, 0, k, u),
        row_at_eight(simd, power, 4, k, u),
        row_at_eight(simd, power, 8, k, u),
        row_at_eight(simd, power, 12, k, u),
    );
    let p2 = s3 * v + s2;
    let p1 = p2 * v + s1;
    [p1 * v + s0, ((d3 * v + d2) * v + d1) * v + d0, (s3 * v + p2) * v + p1]
}

/// Component `k` of the four coefficients from `first` on, and its derivative along u.
#[inline(always)]
fn row_at_eight<S: Simd>(simd: S, power: &[[f64; 4]; 16], first: usize, k: usize, u: F<S>) -> (F<S>, F<S>) {
    let c0 = F::splat(simd, power[first][k]);
    let c1 = F::splat(simd, power[first + 1][k]);
    let c2 = F::splat(simd, power[first + 2][k]);
    let c3 = F::splat(simd, power[first + 3][k]);
    let p2 = c3 * u + c2;
    let p1 = p2 * u + c1;
    (p1 * u + c0, (c3 * u + p2) * u + p1)
}

/// Value and derivative along u of the four coefficients from `first` on.
#[inline(always)]
fn row_at<S: Simd>(simd: S, power: &[[f64; 4]; 16], first: usize, u: f64x4<S>) -> (f64x4<S>, f64x4<S>) {
    let c0 = f64x4::simd_from(simd, power[first]);
    let c1 = f64x4::simd_from(simd, power[first + 1]);
    let c2 = f64x4::simd_from(simd, power[first + 2]);
    let c3 = f64x4::simd_from(simd, power[first + 3]);
    let p2 = c3 * u + c2;
    let p1 = p2 * u + c1;
    (p1 * u + c0, (c3 * u + p2) * u + p1)
}
