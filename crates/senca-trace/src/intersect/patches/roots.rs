//! All common roots of two polynomials over a rectangle: the plain way to meet a patch.
//!
//! A ray is where two planes meet. The distances of a patch from both planes are two polynomials in
//! u and v, in Bernstein form with the distances of the control points as coefficients; for rational
//! patches the homogeneous points give polynomials just as well. Where both vanish the ray meets the
//! patch. The rectangle is divided until each piece is decided:
//!
//! 1. The control points, seen in coordinates in which the map is the identity at the centre, keep to
//!    one side of an axis: there is no root.
//! 2. The derivatives differ so little from those at the centre that the map is one-to-one: there is at
//!    most one root, and Newton's method finds it or shows that it lies outside (Krawczyk 1969).
//! 3. The surface is regular, but folded as the ray sees it, and the fold is no deeper than what rounding
//!    can do: the ray touches the surface and counts as passing by. So does a ray within a flat patch.
//! 4. The piece is of no size any more: the surface is singular, as at the tip of a patch with a
//!    collapsed edge, and the ray passes through that very point.
//!
//! Source of the formulation: Nishita, Sederberg and Kakimoto 1990, who narrow the rectangle by
//! clipping instead; that converges as fast but does not show that a root is the only one.

use senca_math::glam::{DMat2, DVec2};
use smallvec::SmallVec;

use super::net::{Axis, Jet, Net};

/// A common root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Root {
    /// Where it is.
    pub uv: DVec2,
    /// Sign of the Jacobian determinant: which way the ray passes through; 0 at a singular place.
    pub sign: f64,
}

/// Roots found.
pub(super) type RootList = SmallVec<[Root; 4]>;

/// A rectangle of parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Domain {
    /// From and to, in u.
    pub u: [f64; 2],
    /// From and to, in v.
    pub v: [f64; 2],
}

impl Domain {
    /// All of a patch.
    pub(super) const WHOLE: Self = Self { u: [0.0, 1.0], v: [0.0, 1.0] };

    pub(super) fn center(&self) -> DVec2 {
        0.5 * DVec2::new(self.u[0] + self.u[1], self.v[0] + self.v[1])
    }

    pub(super) fn half(&self) -> DVec2 {
        0.5 * DVec2::new(self.u[1] - self.u[0], self.v[1] - self.v[0])
    }

    /// Whether a place lies in it, up to a tolerance.
    pub(super) fn holds(&self, uv: DVec2, tolerance: DVec2) -> bool {
        uv.x >= self.u[0] - tolerance.x
            && uv.x <= self.u[1] + tolerance.x
            && uv.y >= self.v[0] - tolerance.y
            && uv.y <= self.v[1] + tolerance.y
    }

    pub(super) fn split(&self, axis: Axis) -> [Self; 2] {
        let Self { u, v } = *self;
        let c = self.center();
        match axis {
            Axis::U => [Self { u: [u[0], c.x], v }, Self { u: [c.x, u[1]], v }],
            Axis::V => [Self { u, v: [v[0], c.y] }, Self { u, v: [c.y, v[1]] }],
        }
    }
}

/// Rounding of a distance, when the whole surface is about of size 1.
pub(super) const ROUNDING: f64 = 2e-15;

/// Depth up to which a ray only touches: a hundred times what rounding can do.
pub(super) const TOUCHING: f64 = 2.5e-13;

/// Size of a piece that is a point.
pub(super) const POINT: f64 = 1e-13;

/// Most pieces looked at. A root needs about fifty, a touching ray some hundreds; a ray along a line of
/// the surface would need endlessly many.
pub(super) const MOST_PIECES: usize = 3000;

/// What is known of a piece.
enum Verdict {
    None,
    Root(Root),
    Touched,
    Divide(Axis),
}

/// Appends the roots of `pair` over `domain`, of which it is the net. `is_regular` tells whether the
/// surface has two independent derivatives at a place.
pub(super) fn roots(pair: Net<DVec2>, domain: Domain, is_regular: IsRegular<'_>, out: &mut RootList) {
    let mut work: SmallVec<[(Net<DVec2>, Domain); 4]> = SmallVec::new();
    let mut touched: SmallVec<[Domain; 4]> = SmallVec::new();
    work.push((pair, domain));
    let mut looked_at = 0;
    while let Some((pair, domain)) = work.pop()
        && looked_at < MOST_PIECES
    {
        looked_at += 1;
        match judge(&pair, &domain, is_regular) {
            Verdict::None => {}
            Verdict::Root(root) => add(root, out),
            Verdict::Touched => touched.push(domain),
            Verdict::Divide(axis) => {
                let [low, high] = domain.split(axis);
                work.push((pair.clone().above(axis, 0.5), high));
                work.push((pair.below(axis, 0.5), low));
            }
        }
    }
    touched.iter().for_each(|domain| drop_halves(domain, out));
}

/// See [`roots`].
pub(super) type IsRegular<'a> = &'a dyn Fn(DVec2) -> bool;

/// Where a fold as deep as rounding gave one of its two roots only, drops that one.
pub(super) fn drop_halves(touched: &Domain, out: &mut RootList) {
    let is_near = |root: &Root| touched.holds(root.uv, 16.0 * touched.half());
    let sum: f64 = out.iter().filter(|root| is_near(root)).map(|root| root.sign).sum();
    if sum != 0.0 {
        out.retain(|root| !(is_near(root) && root.sign == sum.signum()));
    }
}

/// Appends a root unless it is there already: found from both sides of a dividing line.
pub(super) fn add(root: Root, out: &mut RootList) {
    let same = |r: &Root| r.sign == root.sign && (r.uv - root.uv).abs().max_element() < 1e-8;
    if !out.iter().any(same) {
        out.push(root);
    }
}

fn judge(pair: &Net<DVec2>, domain: &Domain, is_regular: IsRegular<'_>) -> Verdict {
    // On one side of one of the planes?
    let (low, high) = range(pair.points().iter().copied());
    if low.max_element() > ROUNDING || high.min_element() < -ROUNDING {
        return Verdict::None;
    }
    let lengths =
        [Axis::U, Axis::V].map(|axis| pair.derivative(axis).map(|d| d.length_squared()).fold(0.0, f64::max));
    let longer = if lengths[0] >= lengths[1] { Axis::U } else { Axis::V };
    // Coordinates x in [-1, 1]^2 over the piece; y = J^-1 f is nearly x.
    let center = pair.at(0.5, 0.5);
    let jacobian = 0.5 * DMat2::from_cols(center.du, center.dv);
    let columns = jacobian.x_axis.length() * jacobian.y_axis.length();
    let is_invertible = jacobian.determinant().abs() > 1e-12 * columns;
    if !is_invertible {
        return undecided(pair, domain, longer, is_regular);
    }
    let inverse = jacobian.inverse();
    let rounding = ROUNDING * (inverse.x_axis.abs() + inverse.y_axis.abs());
    let straight = pair.map(|f| inverse * *f);
    let (low, high) = range(straight.points().iter().copied());
    if (low - rounding).max_element() > 0.0 || (high + rounding).min_element() < 0.0 {
        return Verdict::None;
    }
    let spread = deviation(&straight, Axis::U, DVec2::X) + deviation(&straight, Axis::V, DVec2::Y);
    let is_one_to_one = spread.max_element() < 0.9;
    if !is_one_to_one {
        return undecided(pair, domain, longer, is_regular);
    }
    let first = -(inverse * center.value);
    if (first.abs() - 1.0 - spread - rounding).max_element() > 0.0 {
        return Verdict::None;
    }
    let is_sure = spread.max_element() < 1.0 / 3.0;
    newton(pair, domain, first, is_sure).unwrap_or_else(|| undecided(pair, domain, longer, is_regular))
}

/// What to do with a piece that may have any number of roots.
fn undecided(pair: &Net<DVec2>, domain: &Domain, axis: Axis, is_regular: IsRegular<'_>) -> Verdict {
    let (length, width) = extent(pair);
    let uv = domain.center();
    if width > TOUCHING {
        Verdict::Divide(axis)
    } else if is_regular(uv) {
        Verdict::Touched
    } else if length < POINT {
        Verdict::Root(Root { uv, sign: 0.0 })
    } else {
        Verdict::Divide(axis)
    }
}

/// Farthest distance of the control points from the origin, and from a line through it.
fn extent(pair: &Net<DVec2>) -> (f64, f64) {
    let farther = |far: DVec2, p: &DVec2| if p.length_squared() > far.length_squared() { *p } else { far };
    let farthest = pair.points().iter().fold(DVec2::ZERO, farther);
    let across = farthest.normalize_or_zero().perp();
    (farthest.length(), pair.points().iter().map(|p| across.dot(*p).abs()).fold(0.0, f64::max))
}

/// Smallest and largest coordinates.
fn range(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// How far the derivatives along an axis, per half piece, get from `unit`.
fn deviation(straight: &Net<DVec2>, axis: Axis, unit: DVec2) -> DVec2 {
    straight.derivative(axis).map(|d| (0.5 * d - unit).abs()).fold(DVec2::ZERO, DVec2::max)
}

/// The root of a piece that has at most one; `None` when that is not settled yet.
fn newton(pair: &Net<DVec2>, domain: &Domain, first: DVec2, is_sure: bool) -> Option<Verdict> {
    let (center, half) = (domain.center(), domain.half());
    let mut x = first;
    for _ in 0..12 {
        let Jet { value, du, dv } = pair.at(0.5 + 0.5 * x.x, 0.5 + 0.5 * x.y);
        let jacobian = 0.5 * DMat2::from_cols(du, dv);
        let inverse = jacobian.inverse();
        let step = -(inverse * value);
        x += step;
        let is_near = x.abs().max_element() < 3.0;
        if !is_near {
            return None;
        }
        let rounding = 5.0 * ROUNDING * (inverse.x_axis.abs() + inverse.y_axis.abs());
        if step.abs().cmple(1e-7 + rounding).all() {
            let uv = center + half * x;
            if !domain.holds(uv, half * rounding + 1e-13) {
                return is_sure.then_some(Verdict::None);
            }
            let uv = uv.clamp(DVec2::ZERO, DVec2::ONE);
            return Some(Verdict::Root(Root { uv, sign: jacobian.determinant().signum() }));
        }
    }
    None
}
