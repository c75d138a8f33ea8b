//! The division of [`super::roots`] for bicubic pieces, four control points at a time.
//!
//! Rays that run along a surface end here: the cells near a silhouette are divided for each of them, so
//! this decides how long pictures of curved things take. It is the same algorithm with the same bounds as
//! [`roots`](super::roots::roots), its plain twin, which takes nets of any degrees.
//!
//! A piece is held by its columns, the distances of four control points from both planes in each; a piece
//! *turned* by its rows. So it is halved along one axis without moving numbers about.

use fearless_simd::{Simd, prelude::*};
use senca_math::glam::{DMat2, DVec2, DVec3, DVec4};
use smallvec::SmallVec;

use super::net::Axis;
use super::roots::{
    Domain, IsRegular, MOST_PIECES, POINT, ROUNDING, Root, RootList, TOUCHING, add, drop_halves,
};
use crate::lanes::{F, LANES, channels, larger};

/// Distances of the control points of a bicubic piece from two planes, beside each other: lines along the
/// second axis, one for each control point along the first.
#[derive(Clone, Copy)]
pub(super) struct Pair<S: Simd> {
    lines: [F<S>; 4],
    /// Whether v is the first axis.
    is_turned: bool,
}

/// What is known of a piece; to divide it is along its first axis or not.
enum Verdict {
    None,
    Root(Root),
    Touched,
    Divide { first: bool },
}

impl<S: Simd> Pair<S> {
    /// For homogeneous control points, u being the fast index, and planes through `origin` across unit
    /// vectors.
    #[inline(always)]
    pub(super) fn new(simd: S, points: &[DVec4; 16], origin: DVec3, planes: [DVec3; 2]) -> Self {
        let mut lines = [[0.0; LANES]; 4];
        for (k, point) in points.iter().enumerate() {
            let offset = point.truncate() - origin * point.w;
            let line = &mut lines[k % 4];
            line[k / 4 * 2] = planes[0].dot(offset);
            line[k / 4 * 2 + 1] = planes[1].dot(offset);
        }
        let lines = four(
            #[inline(always)]
            |i| F::load_array(simd, lines[i]),
        );
        Self { lines, is_turned: false }
    }

    /// The part over a domain.
    #[inline(always)]
    pub(super) fn restricted(self, domain: &Domain) -> Self {
        let along_u = self.between(domain.u);
        along_u.turned().between(domain.v)
    }

    /// The other axis first.
    #[inline(always)]
    fn turned(self) -> Self {
        let simd = self.lines[0].token();
        let [a, b, c, d] = four(
            #[inline(always)]
            |i| self.lines[i].to_array(),
        );
        let lines = four(
            #[inline(always)]
            |j| {
                let (f, g) = (2 * j, 2 * j + 1);
                F::load_array(simd, [a[f], a[g], b[f], b[g], c[f], c[g], d[f], d[g]])
            },
        );
        Self { lines, is_turned: !self.is_turned }
    }

    /// The part from `low` to `high` along the first axis.
    #[inline(always)]
    fn between(self, [low, high]: [f64; 2]) -> Self {
        let upper = if low > 0.0 { self.cut(low)[1] } else { self };
        if high < 1.0 { upper.cut((high - low) / (1.0 - low))[0] } else { upper }
    }

    /// The parts below and above `t` along the first axis.
    #[inline(always)]
    fn cut(self, t: f64) -> [Self; 2] {
        let simd = self.lines[0].token();
        let (s, t) = (F::splat(simd, 1.0 - t), F::splat(simd, t));
        let [a, b, c, d] = self.lines;
        let (ab, bc, cd) = (a * s + b * t, b * s + c * t, c * s + d * t);
        let (abc, bcd) = (ab * s + bc * t, bc * s + cd * t);
        let middle = abc * s + bcd * t;
        let part = |lines| Self { lines, ..self };
        [part([a, ab, abc, middle]), part([middle, bcd, cd, d])]
    }

    /// The axis of the parameters that is the first.
    fn first_axis(&self) -> Axis {
        if self.is_turned { Axis::V } else { Axis::U }
    }

    /// Value and derivatives along the first and the second axis at a place.
    #[inline(always)]
    fn at(&self, place: DVec2) -> [DVec2; 3] {
        let simd = self.lines[0].token();
        let (s, t) = (F::splat(simd, 1.0 - place.x), F::splat(simd, place.x));
        let [a, b, c, d] = self.lines;
        let (ab, bc, cd) = (a * s + b * t, b * s + c * t, c * s + d * t);
        let (abc, bcd) = (ab * s + bc * t, bc * s + cd * t);
        let slope = (bcd - abc) * F::splat(simd, 3.0);
        let (value, along_second) = curve_at(points(abc * s + bcd * t), place.y);
        [value, curve_at(points(slope), place.y).0, along_second]
    }

    /// Value and derivatives in the middle.
    #[inline(always)]
    fn at_middle(&self) -> [DVec2; 3] {
        let simd = self.lines[0].token();
        let [a, b, c, d] = self.lines;
        let value = (a + d + (b + c) * F::splat(simd, 3.0)) * F::splat(simd, 0.125);
        let slope = (d + c - (b + a)) * F::splat(simd, 0.75);
        let middle = |[a, b, c, d]: [DVec2; 4]| 0.125 * (a + d + 3.0 * (b + c));
        let line = points(value);
        let along_second = 0.75 * (line[3] + line[2] - (line[1] + line[0]));
        [middle(line), middle(points(slope)), along_second]
    }

    /// The distances in other coordinates.
    #[inline(always)]
    fn mapped(&self, map: &DMat2) -> Self {
        let simd = self.lines[0].token();
        let (x, y) = (map.x_axis, map.y_axis);
        let own = F::load_array(simd, [x.x, y.y, x.x, y.y, x.x, y.y, x.x, y.y]);
        let other = F::load_array(simd, [y.x, x.y, y.x, x.y, y.x, x.y, y.x, x.y]);
        let lines = four(
            #[inline(always)]
            |i| self.lines[i] * own + self.lines[i].slide_within_blocks::<1>(self.lines[i]) * other,
        );
        Self { lines, ..*self }
    }

    /// Smallest and largest distances.
    #[inline(always)]
    fn range(&self) -> [DVec2; 2] {
        let [a, b, c, d] = self.lines;
        let low = points(smaller(smaller(a, b), smaller(c, d)));
        let high = points(larger(larger(a, b), larger(c, d)));
        [low[0].min(low[1]).min(low[2].min(low[3])), high[0].max(high[1]).max(high[2].max(high[3]))]
    }

    /// Differences of neighbours along the first axis, and along the second, where the last pair is none.
    #[inline(always)]
    fn differences(&self) -> ([F<S>; 3], [F<S>; 4]) {
        let first = channels!(i => self.lines[i + 1] - self.lines[i]);
        let second = four(
            #[inline(always)]
            |i| self.lines[i].slide::<2>(self.lines[i]) - self.lines[i],
        );
        (first, second)
    }

    /// How far derivatives along both axes, per half piece, get from unit vectors, added up.
    #[inline(always)]
    fn deviation(&self) -> DVec2 {
        let simd = self.lines[0].token();
        let (first, second) = self.differences();
        let factor = F::splat(simd, 1.5);
        let unit_x = F::load_array(simd, [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
        let unit_y = F::load_array(simd, [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
        let [a, b, c] = channels!(i => (first[i] * factor - unit_x).abs());
        let [d, e, f, g] = four(
            #[inline(always)]
            |i| (second[i] * factor - unit_y).abs(),
        );
        let along_first = points(larger(larger(a, b), c));
        let along_second = points(larger(larger(d, e), larger(f, g)));
        let [a, b, c, d] = along_first;
        let [e, f, g, _] = along_second;
        a.max(b).max(c.max(d)) + e.max(f).max(g)
    }

    /// Whether the piece is longer along the first axis.
    #[inline(always)]
    fn is_longer_along_first(&self) -> bool {
        let (first, second) = self.differences();
        let [a, b, c] = channels!(i => squared_lengths(first[i]));
        let [d, e, f, g] = four(
            #[inline(always)]
            |i| squared_lengths(second[i]),
        );
        let along_first = larger(larger(a, b), c).to_array();
        let along_second = larger(larger(d, e), larger(f, g)).to_array();
        let along_first = along_first[0].max(along_first[2]).max(along_first[4].max(along_first[6]));
        let along_second = along_second[0].max(along_second[2]).max(along_second[4]);
        along_first > along_second || (along_first == along_second && !self.is_turned)
    }

    /// Whether the control points are certainly farther than `width` from every line through the origin, by
    /// the area that they and one of them span with it.
    #[inline(always)]
    fn is_wider_than(&self, width: f64) -> bool {
        let simd = self.lines[0].token();
        let [corner, ..] = points(self.lines[0]);
        let across = corner.perp();
        let across = F::load_array(
            simd,
            [across.x, across.y, across.x, across.y, across.x, across.y, across.x, across.y],
        );
        let areas = four(
            #[inline(always)]
            |i| {
                let products = self.lines[i] * across;
                (products + products.slide_within_blocks::<1>(products)).abs()
            },
        );
        let lengths = four(
            #[inline(always)]
            |i| self.lines[i].abs(),
        );
        let most = |[a, b, c, d]: [F<S>; 4]| {
            let [a, b, c, d] = points(larger(larger(a, b), larger(c, d)));
            a.max(b).max(c.max(d)).max_element()
        };
        // Along a line of that width two vectors of length l span less than 2 l width. Some room for rounding.
        most(areas) > 2.5 * width * (std::f64::consts::SQRT_2 * most(lengths))
    }

    /// Farthest distance of the control points from the origin, and from a line through it.
    #[inline(always)]
    fn extent(&self) -> (f64, f64) {
        let farther =
            |far: DVec2, p: &DVec2| if p.length_squared() > far.length_squared() { *p } else { far };
        let lines = four(
            #[inline(always)]
            |i| points(self.lines[i]),
        );
        let farthest = lines.as_flattened().iter().fold(DVec2::ZERO, farther);
        let across = farthest.normalize_or_zero().perp();
        let width = lines.as_flattened().iter().map(|p| across.dot(*p).abs()).fold(0.0, f64::max);
        (farthest.length(), width)
    }
}

/// The function for 0 to 3.
#[inline(always)]
fn four<T>(f: impl Fn(usize) -> T) -> [T; 4] {
    [f(0), f(1), f(2), f(3)]
}

#[inline(always)]
fn smaller<S: Simd>(a: F<S>, b: F<S>) -> F<S> {
    a.simd_lt(b).select(a, b)
}

/// Pairs of lanes.
#[inline(always)]
fn points<S: Simd>(line: F<S>) -> [DVec2; 4] {
    let [a, b, c, d, e, f, g, h] = line.to_array();
    [DVec2::new(a, b), DVec2::new(c, d), DVec2::new(e, f), DVec2::new(g, h)]
}

/// Of the vectors in pairs of lanes.
#[inline(always)]
fn squared_lengths<S: Simd>(line: F<S>) -> F<S> {
    let squares = line * line;
    squares + squares.slide_within_blocks::<1>(squares)
}

/// Value and derivative of a cubic curve.
#[inline(always)]
fn curve_at([a, b, c, d]: [DVec2; 4], t: f64) -> (DVec2, DVec2) {
    let s = 1.0 - t;
    let (ab, bc, cd) = (a * s + b * t, b * s + c * t, c * s + d * t);
    let (abc, bcd) = (ab * s + bc * t, bc * s + cd * t);
    (abc * s + bcd * t, (bcd - abc) * 3.0)
}

/// Appends the roots of `pair`, which is over `domain`: see [`roots`](super::roots::roots).
#[inline(always)]
pub(super) fn bicubic_roots<S: Simd>(
    pair: Pair<S>,
    domain: Domain,
    is_regular: IsRegular<'_>,
    out: &mut RootList,
) {
    let mut work: SmallVec<[(Pair<S>, Domain); 16]> = SmallVec::new();
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
            Verdict::Divide { first } => {
                let pair = if first { pair } else { pair.turned() };
                let [low, high] = domain.split(pair.first_axis());
                let [below, above] = pair.cut(0.5);
                work.push((above, high));
                work.push((below, low));
            }
        }
    }
    touched.iter().for_each(|domain| drop_halves(domain, out));
}

#[inline(always)]
fn judge<S: Simd>(pair: &Pair<S>, domain: &Domain, is_regular: IsRegular<'_>) -> Verdict {
    // On one side of one of the planes?
    let [low, high] = pair.range();
    if low.max_element() > ROUNDING || high.min_element() < -ROUNDING {
        return Verdict::None;
    }
    // Coordinates x in [-1, 1]^2 over the piece; y = J^-1 f is nearly x.
    let [value, along_first, along_second] = pair.at_middle();
    let jacobian = 0.5 * DMat2::from_cols(along_first, along_second);
    let columns = jacobian.x_axis.length() * jacobian.y_axis.length();
    let is_invertible = jacobian.determinant().abs() > 1e-12 * columns;
    if !is_invertible {
        return undecided(pair, domain, is_regular);
    }
    let inverse = jacobian.inverse();
    let rounding = ROUNDING * (inverse.x_axis.abs() + inverse.y_axis.abs());
    let straight = pair.mapped(&inverse);
    let [low, high] = straight.range();
    if (low - rounding).max_element() > 0.0 || (high + rounding).min_element() < 0.0 {
        return Verdict::None;
    }
    let spread = straight.deviation();
    let is_one_to_one = spread.max_element() < 0.9;
    if !is_one_to_one {
        return undecided(pair, domain, is_regular);
    }
    let first = -(inverse * value);
    if (first.abs() - 1.0 - spread - rounding).max_element() > 0.0 {
        return Verdict::None;
    }
    let is_sure = spread.max_element() < 1.0 / 3.0;
    newton(pair, domain, first, is_sure).unwrap_or_else(|| undecided(pair, domain, is_regular))
}

/// What to do with a piece that may have any number of roots.
#[inline(always)]
fn undecided<S: Simd>(pair: &Pair<S>, domain: &Domain, is_regular: IsRegular<'_>) -> Verdict {
    let divide = || Verdict::Divide { first: pair.is_longer_along_first() };
    if pair.is_wider_than(TOUCHING) {
        return divide();
    }
    let (length, width) = pair.extent();
    let uv = domain.center();
    if width > TOUCHING {
        divide()
    } else if is_regular(uv) {
        Verdict::Touched
    } else if length < POINT {
        Verdict::Root(Root { uv, sign: 0.0 })
    } else {
        divide()
    }
}

/// The root of a piece that has at most one; `None` when that is not settled yet.
#[inline(always)]
fn newton<S: Simd>(pair: &Pair<S>, domain: &Domain, first: DVec2, is_sure: bool) -> Option<Verdict> {
    let (center, half) = (domain.center(), domain.half());
    let turned = |x: DVec2| if pair.is_turned { DVec2::new(x.y, x.x) } else { x };
    let mut x = first;
    for _ in 0..12 {
        let [value, along_first, along_second] = pair.at(0.5 + 0.5 * x);
        let jacobian = 0.5 * DMat2::from_cols(along_first, along_second);
        let inverse = jacobian.inverse();
        let step = -(inverse * value);
        x += step;
        let is_near = x.abs().max_element() < 3.0;
        if !is_near {
            return None;
        }
        let rounding = 5.0 * ROUNDING * (inverse.x_axis.abs() + inverse.y_axis.abs());
        if step.abs().cmple(1e-7 + rounding).all() {
            let uv = center + half * turned(x);
            if !domain.holds(uv, half * turned(rounding) + 1e-13) {
                return is_sure.then_some(Verdict::None);
            }
            let uv = uv.clamp(DVec2::ZERO, DVec2::ONE);
            let sign = jacobian.determinant().signum();
            return Some(Verdict::Root(Root { uv, sign: if pair.is_turned { -sign } else { sign } }));
        }
    }
    None
}

const _: () = assert!(LANES == 8, "a line has four pairs");

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::*;
    use crate::intersect::patches::net::Net;
    use crate::intersect::patches::roots::roots;

    const DOMAIN: Domain = Domain { u: [0.25, 0.75], v: [0.5, 1.0] };

    /// The roots over the domain, in order.
    fn sorted(mut found: RootList) -> Vec<(f64, f64, f64)> {
        found.sort_by(|a, b| a.uv.x.total_cmp(&b.uv.x).then(a.uv.y.total_cmp(&b.uv.y)));
        found.iter().map(|root| (root.uv.x, root.uv.y, root.sign)).collect()
    }

    fn plain(points: &[DVec4; 16]) -> Vec<(f64, f64, f64)> {
        let net = Net::new(4, points.map(|p| p.truncate().truncate()));
        let net = net.restricted(Axis::U, DOMAIN.u).restricted(Axis::V, DOMAIN.v);
        let mut found = RootList::new();
        roots(net, DOMAIN, &|_| true, &mut found);
        sorted(found)
    }

    fn fast(points: &[DVec4; 16], level: Level) -> Vec<(f64, f64, f64)> {
        let mut found = RootList::new();
        dispatch!(level, simd => {
            let pair = Pair::new(simd, points, DVec3::ZERO, [DVec3::X, DVec3::Y]).restricted(&DOMAIN);
            bicubic_roots(pair, DOMAIN, &|_| true, &mut found);
        });
        sorted(found)
    }

    proptest! {
        #[test]
        fn finds_what_the_plain_way_finds(
            noise in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 16),
            (dx, dy) in (-0.6f64..0.6, -0.6f64..0.6),
            amount in 0.0f64..1.0,
        ) {
            let points: [DVec4; 16] = std::array::from_fn(|k| {
                let (x, y) = ((k % 4) as f64 / 1.5 - 1.0, (k / 4) as f64 / 1.5 - 1.0);
                DVec4::new(x + amount * noise[k].0 - dx, y + amount * noise[k].1 - dy, 0.0, 1.0)
            });
            let (plain, fast) = (plain(&points), fast(&points, Level::new()));
            prop_assert_eq!(&fast, &self::fast(&points, Level::baseline()));
            prop_assert_eq!(plain.len(), fast.len(), "{:?} {:?}", plain, fast);
            for (a, b) in plain.iter().zip(&fast) {
                prop_assert!((a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9 && a.2 == b.2);
            }
        }
    }
}
