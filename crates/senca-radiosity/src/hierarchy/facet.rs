//! What elements see of each other where nothing is between: estimates with bounds.

use std::f64::consts::{PI, TAU};

use senca_math::glam::DVec3;
use smallvec::SmallVec;

use crate::open_parts::{OpenPart, OpenParts};
use crate::{ElementMesh, PatchPolygon};

/// From this many radii on a polygon counts as small: the share of what is seen of it is off by less
/// than one hundredth of itself.
const FAR: f64 = 10.0;

/// Up to this many times the sum of their radii two elements are near each other.
const NEAR: f64 = 1.5;

/// Places of the rule of Gauss with two points per axis, in the unit square.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// The differences between places inside stand for those up to the border by this factor: the square
/// root of three for a quadrilateral's.
const TO_THE_BORDER: f64 = 1.732_050_807_568_877_2;

/// An element's shape with what is asked of it often.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) shape: PatchPolygon,
    pub(crate) normal: DVec3,
    /// Of what of it is open.
    pub(crate) area: f64,
    pub(crate) center: DVec3,
    /// Distance of the farthest corner from the center.
    pub(crate) radius: f64,
    /// Share of the shape that is open.
    open: f64,
}

/// Mean share of the hemisphere and how far single places are from each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Share {
    pub(super) mean: f64,
    /// Largest less smallest share among places of the receiver, up to the border.
    pub(super) spread: f64,
}

impl Facet {
    pub(crate) fn of(mesh: &ElementMesh, element: u32) -> Self {
        let stored = &mesh.elements()[element as usize];
        Self::new(mesh.shape(element), mesh.normal(element), stored.area, stored.center)
    }

    /// The open part of an element: its own shape where that is simple, else that of the element, of which
    /// only a share counts.
    pub(super) fn of_open(mesh: &ElementMesh, parts: &OpenParts, element: u32) -> Self {
        match parts.get(mesh, element).and_then(|part| part.shape) {
            Some(shape) => Self::of_polygon(shape),
            None => Self::of_share(mesh, element),
        }
    }

    /// The shape of an element, of which only the open share counts.
    pub(super) fn of_share(mesh: &ElementMesh, element: u32) -> Self {
        let whole = Self::of(mesh, element);
        let open = f64::from(mesh.elements()[element as usize].open);
        Self { area: whole.area * open, open, ..whole }
    }

    pub(crate) fn of_polygon(shape: PatchPolygon) -> Self {
        let (normal, area) = shape.normal_and_area();
        Self::new(shape, normal, area, shape.center())
    }

    fn new(shape: PatchPolygon, normal: DVec3, area: f64, center: DVec3) -> Self {
        let squared = shape.corners().iter().map(|p| p.distance_squared(center)).fold(0.0, f64::max);
        Self { shape, normal, area, center, radius: squared.sqrt(), open: 1.0 }
    }

    /// Whether some of it is in front of the other, and some of the other in front of it.
    pub(super) fn can_see(&self, other: &Self) -> bool {
        self.has_in_front(other.shape.corners()) && other.has_in_front(self.shape.corners())
    }

    /// Whether the two are near each other for their size, or touch.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        self.center.distance(other.center) < NEAR * (self.radius + other.radius)
    }

    /// Whether any of the places is in front.
    pub(super) fn has_in_front(&self, places: &[DVec3]) -> bool {
        let limit = 1e-9 * self.radius;
        places.iter().any(|&place| (place - self.center).dot(self.normal) > limit)
    }

    /// Places that stand for all of it, with equal weights.
    pub(super) fn places(&self) -> SmallVec<[DVec3; 4]> {
        match *self.shape.corners() {
            [a, b, c] => {
                let at = |p: DVec3, q: DVec3, r: DVec3| (4.0 * p + q + r) / 6.0;
                SmallVec::from_slice(&[at(a, b, c), at(b, c, a), at(c, a, b)])
            }
            _ => {
                let [low, high] = GAUSS;
                [[low, low], [high, low], [high, high], [low, high]]
                    .map(|[u, v]| self.shape.place(u, v))
                    .into_iter()
                    .collect()
            }
        }
    }

    /// Share of the hemisphere of a point that this takes up, weighted by the cosine at the point:
    /// the form factor of the point to this (course text, section 4.2, equation 4.8).
    pub(crate) fn share_at(&self, point: DVec3, normal: DVec3) -> f64 {
        self.share_by(point, normal, || self.open * lambert_share(point, normal, self.shape.corners()))
    }

    /// The same with `part` for what of it is open.
    pub(super) fn share_of_part_at(&self, part: Option<&OpenPart>, point: DVec3, normal: DVec3) -> f64 {
        match part {
            Some(part) if self.open < 1.0 && part.is_simple() => {
                self.share_by(point, normal, || part.share_at(point, normal))
            }
            _ => self.share_at(point, normal),
        }
    }

    fn share_by(&self, point: DVec3, normal: DVec3, near: impl FnOnce() -> f64) -> f64 {
        let way = self.center - point;
        let squared = way.length_squared();
        if squared > (FAR * self.radius).powi(2) {
            let cosines = normal.dot(way).max(0.0) * self.normal.dot(-way).max(0.0);
            return cosines * self.area / (PI * squared * squared);
        }
        if self.normal.dot(way) >= 0.0 { 0.0 } else { near() }
    }

    /// Mean over this of the share that `source` takes up, with how much it varies.
    #[cfg(test)]
    pub(super) fn share_of(&self, source: &Self) -> Share {
        self.share_at_all(&self.places(), |place| source.share_at(place, self.normal))
    }

    /// Mean over this of `share_at` at `places`, which have equal weight, with how much it varies.
    pub(super) fn share_at_all(&self, places: &[DVec3], share_at: impl Fn(DVec3) -> f64) -> Share {
        // The middle tells apart what is the same at all places for the sake of symmetry.
        let middle = share_at(self.center);
        let (mut sum, mut least, mut most) = (0.0, middle, middle);
        for &place in places {
            let share = share_at(place);
            (sum, least, most) = (sum + share, least.min(share), most.max(share));
        }
        Share { mean: sum / places.len() as f64, spread: TO_THE_BORDER * (most - least) }
    }
}

/// Lambert's formula of 1760: the angles under which the edges are seen, times the cosines between the
/// planes through them and the horizon. The part below the horizon does not count.
pub(crate) fn lambert_share(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let ways: SmallVec<[DVec3; 6]> = corners.iter().map(|&corner| corner - point).collect();
    let heights: SmallVec<[f64; 6]> = ways.iter().map(|way| way.dot(normal)).collect();
    if heights.iter().all(|&height| height >= 0.0) {
        return sum_over_edges(&ways, normal);
    }
    let mut above: SmallVec<[DVec3; 6]> = SmallVec::new();
    for (here, &way) in ways.iter().enumerate() {
        let next = (here + 1) % ways.len();
        if heights[here] >= 0.0 {
            above.push(way);
        }
        if (heights[here] >= 0.0) != (heights[next] >= 0.0) {
            above.push(way.lerp(ways[next], heights[here] / (heights[here] - heights[next])));
        }
    }
    sum_over_edges(&above, normal)
}

fn sum_over_edges(ways: &[DVec3], normal: DVec3) -> f64 {
    let Some(&last) = ways.last() else {
        return 0.0;
    };
    let (mut sum, mut before) = (0.0, last);
    for &way in ways {
        let across = before.cross(way);
        let sine = across.length();
        if sine > 0.0 {
            sum += sine.atan2(before.dot(way)) / sine * across.dot(normal);
        }
        before = way;
    }
    (sum.abs() / TAU).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(height: f64) -> Facet {
        let corners = [[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]];
        Facet::of_polygon(PatchPolygon::quad(corners.map(|[x, y]| DVec3::new(x, y, height))))
    }

    #[test]
    fn a_square_overhead_takes_up_what_tables_say() {
        let above = square(1.0);
        assert!(above.normal.z < 0.0);
        assert!((above.share_at(DVec3::ZERO, DVec3::Z) - 0.239_456_470_5).abs() < 1e-9);
        assert_eq!(above.share_at(DVec3::ZERO, DVec3::NEG_Z), 0.0);
        assert_eq!(above.share_at(2.0 * DVec3::Z, DVec3::NEG_Z), 0.0, "from behind");
    }

    #[test]
    fn far_away_both_formulas_agree() {
        let above = square(1.0);
        for point in [DVec3::new(0.0, 0.0, -6.1), DVec3::new(5.0, 1.0, -5.0)] {
            let exact = lambert_share(point, DVec3::Z, above.shape.corners());
            let squared = (above.center - point).length_squared();
            let cosine = (above.center - point).z;
            let small = cosine * cosine / (PI * squared * squared);
            assert!((small / exact - 1.0).abs() < 0.01, "{small} {exact}");
        }
    }

    #[test]
    fn a_wall_that_reaches_below_the_horizon_counts_above_it() {
        // An endless wall that rises from the horizon takes up half of the hemisphere.
        let far = 1e6;
        let corners = [[-far, -far], [far, -far], [far, far], [-far, far]];
        let wall = PatchPolygon::quad(corners.map(|[y, z]| DVec3::new(-1.0, y, z)));
        assert!((lambert_share(DVec3::ZERO, DVec3::Z, wall.corners()) - 0.5).abs() < 1e-5);
    }

    #[test]
    fn the_mean_over_a_square_is_near_the_closed_form() {
        let turned = PatchPolygon::quad(
            [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]].map(|[x, y]| DVec3::new(x, y, 0.0)),
        );
        let share = Facet::of_polygon(turned).share_of(&square(1.0));
        // Four places leave an error below 1 %; their share is known in closed form too.
        assert!((share.mean - 0.199_824_895_7).abs() < 2e-3, "{share:?}");
        assert!((share.mean - 0.198_375_978_926_744_05).abs() < 1e-12, "{share:?}");
        assert!(share.spread > 0.0 && share.spread < 0.2);
    }
}
