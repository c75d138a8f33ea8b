//! How much of an emitter a place sees, without sampling.
//!
//! Whatever lies in the pyramid between the place and the emitter may hide some of it. What one polygon
//! hides is the part of the emitter in the pyramid of the place over that polygon, beyond its plane; cut
//! out of the emitter for one after the other, what is left is seen, and Lambert's formula says what it
//! is worth. That is exact in half-shadows as in the open. Where much is in between, or anything that
//! lets light pass, there is no answer.
//!
//! Source: Nishita and Nakamae 1985, section 3.

use senca_math::Aabb;
use senca_math::glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::inside_by;
use crate::ElementMesh;
use crate::form_factor::clip::{Corners, part_above};
use crate::hierarchy::cluster::Clusters;
use crate::hierarchy::facet::{Facet, lambert_share};

/// Polygons in between that are cut out one by one at most.
const MOST_BLOCKERS: usize = 32;

/// Parts of an emitter that are kept at most.
const MOST_PARTS: usize = 64;

/// How far places stay off polygons that stand on their surface, in multiples of the tolerance.
const CLEARANCE: f64 = 8.0;

/// Cosine between normals from which on surfaces may go on with each other.
const ALIKE: f64 = 0.9;

/// Sine of the elevation of what goes on with a surface at most.
const FLAT: f64 = 0.01;

type Parts = SmallVec<[Corners; 4]>;

/// The polygons of a mesh, ready to be cut out of emitters.
#[derive(Clone, Debug)]
pub(super) struct Blockers<'a> {
    mesh: &'a ElementMesh,
    clusters: Clusters,
    /// Places nearer to a plane than this are in it, in world units.
    tolerance: f64,
}

/// A half-space: where `normal . p >= offset`.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    /// Through `at`; the normal need not be a unit vector.
    fn through(at: DVec3, normal: DVec3) -> Self {
        let normal = normal.normalize_or_zero();
        Self { normal, offset: normal.dot(at) }
    }

    fn height(&self, place: DVec3) -> f64 {
        self.normal.dot(place) - self.offset
    }

    /// The other way about where `place` is below.
    fn towards(self, place: DVec3) -> Self {
        if self.height(place) < 0.0 { Self { normal: -self.normal, offset: -self.offset } } else { self }
    }
}

/// Planes through `apex` and the edges of a convex polygon, which is on their upper sides.
fn sides(apex: DVec3, corners: &[DVec3]) -> SmallVec<[Plane; 8]> {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let next = corners.iter().cycle().skip(1);
    let side = |(&a, &b): (&DVec3, &DVec3)| Plane::through(apex, (a - apex).cross(b - apex)).towards(middle);
    corners.iter().zip(next).map(side).collect()
}

/// The place of a convex polygon with this unit normal that is nearest to `place`.
fn closest_place(corners: &[DVec3], normal: DVec3, place: DVec3) -> DVec3 {
    let foot = place - normal * normal.dot(place - corners[0]);
    if inside_by(corners, normal, foot) >= 0.0 {
        return foot;
    }
    let on_edge = |(&a, &b): (&DVec3, &DVec3)| {
        let edge = b - a;
        let along = (place - a).dot(edge) / edge.length_squared();
        a + edge * if along > 0.0 { along.min(1.0) } else { 0.0 }
    };
    let places = corners.iter().zip(corners.iter().cycle().skip(1)).map(on_edge);
    let nearer = |a: &DVec3, b: &DVec3| a.distance_squared(place).total_cmp(&b.distance_squared(place));
    places.min_by(nearer).unwrap_or(foot)
}

/// Between a place and a convex polygon.
struct Shaft {
    apex: DVec3,
    bounds: Aabb,
    planes: SmallVec<[Plane; 8]>,
    /// That of the polygon.
    end: Plane,
}

impl Shaft {
    fn new(apex: DVec3, corners: &[DVec3], normal: DVec3) -> Self {
        let end = Plane::through(corners[0], normal).towards(apex);
        let mut planes = sides(apex, corners);
        planes.push(end);
        Self { apex, bounds: Aabb::of_points(corners.iter().copied().chain([apex])), planes, end }
    }

    fn misses_box(&self, bounds: &Aabb, tolerance: f64) -> bool {
        let apart =
            bounds.max.cmplt(self.bounds.min - tolerance) | bounds.min.cmpgt(self.bounds.max + tolerance);
        let (middle, half) = (bounds.center(), 0.5 * bounds.size());
        apart.any() || self.planes.iter().any(|p| p.height(middle) + p.normal.abs().dot(half) < -tolerance)
    }

    fn misses(&self, corners: &[DVec3], tolerance: f64) -> bool {
        self.planes.iter().any(|plane| corners.iter().all(|&corner| plane.height(corner) <= tolerance))
    }
}

impl<'a> Blockers<'a> {
    pub(super) fn new(mesh: &'a ElementMesh, tolerance: f64) -> Self {
        Self { mesh, clusters: Clusters::new(mesh), tolerance }
    }

    /// A place on a surface with this unit normal, a little off the polygons that stand on the surface
    /// there and end at the place, on their fronts. Where surfaces meet, light tends to what it is
    /// beside the edge; on the edge itself it would be chance which of them rays see.
    pub(super) fn clear_of(&self, place: DVec3, normal: DVec3) -> DVec3 {
        let near = 0.5 * CLEARANCE * self.tolerance;
        let mut clear = place;
        let mut open: SmallVec<[u32; 64]> = SmallVec::new();
        if self.clusters.len() > 0 {
            open.push(0);
        }
        while let Some(cluster) = open.pop() {
            let bounds = &self.clusters.get(cluster).bounds;
            if (place.cmplt(bounds.min - near) | place.cmpgt(bounds.max + near)).any() {
                continue;
            }
            for child in self.clusters.children(cluster) {
                match child.as_cluster() {
                    Some(inner) => open.push(inner),
                    None => clear = self.off(child.index() as u32, clear, normal, near),
                }
            }
        }
        clear
    }

    /// The place moved along its surface to the front of a polygon that it lies on.
    fn off(&self, polygon: u32, place: DVec3, normal: DVec3, near: f64) -> DVec3 {
        let up = self.mesh.normal(polygon);
        let along = up - normal * up.dot(normal);
        let shape = self.mesh.shape(polygon);
        let height = up.dot(place - shape.corners()[0]);
        let on = height.abs() <= near && along.length_squared() > 0.02;
        if !on || inside_by(shape.corners(), up, place) < -near {
            return place;
        }
        place + along * ((CLEARANCE * self.tolerance - height) / along.length_squared())
    }

    /// Distance from a place on a surface with this unit normal to the nearest polygon in front of it,
    /// infinite where there is none. Those that go on with the surface, bent a little, do not count.
    pub(super) fn nearest_above(&self, place: DVec3, normal: DVec3) -> f64 {
        let mut best = f64::INFINITY;
        let mut open: SmallVec<[u32; 64]> = SmallVec::new();
        if self.clusters.len() > 0 {
            open.push(0);
        }
        while let Some(cluster) = open.pop() {
            let bounds = &self.clusters.get(cluster).bounds;
            let apart = (bounds.min - place).max(place - bounds.max).max(DVec3::ZERO);
            if apart.length() >= best {
                continue;
            }
            for child in self.clusters.children(cluster) {
                match child.as_cluster() {
                    Some(inner) => open.push(inner),
                    None => best = best.min(self.distance_above(child.index() as u32, place, normal)),
                }
            }
        }
        best
    }

    fn distance_above(&self, polygon: u32, place: DVec3, normal: DVec3) -> f64 {
        let up = self.mesh.normal(polygon);
        let part = part_above(self.mesh.shape(polygon).corners(), self.tolerance, |p| normal.dot(p - place));
        if part.len() < 3 {
            return f64::INFINITY;
        }
        let way = closest_place(&part, up, place) - place;
        let distance = way.length();
        let goes_on = up.dot(normal) > ALIKE && normal.dot(way) < FLAT * distance;
        if goes_on { f64::INFINITY } else { distance }
    }

    /// Share of the light of an emitter that arrives at a place with this unit normal. `None` where that
    /// is not found in this way.
    pub(super) fn open_share(&self, emitter: &Facet, place: DVec3, normal: DVec3) -> Option<f64> {
        let above = |p: DVec3| normal.dot(p - place);
        let whole = part_above(emitter.shape.corners(), self.tolerance, above);
        if whole.len() < 3 {
            return Some(0.0);
        }
        let shaft = Shaft::new(place, &whole, emitter.normal);
        let found = self.within(&shaft)?;
        if found.is_empty() {
            return Some(1.0);
        }
        let all = lambert_share(place, normal, &whole);
        let mut parts: Parts = smallvec![whole];
        for polygon in found {
            self.cut_out(polygon, place, &mut parts);
            if parts.is_empty() {
                return Some(0.0);
            }
            if parts.len() > MOST_PARTS {
                return None;
            }
        }
        let seen: f64 = parts.iter().map(|part| lambert_share(place, normal, part)).sum();
        Some(if all > 0.0 { (seen / all).min(1.0) } else { 0.0 })
    }

    /// Polygons that reach into a shaft and block it, in ascending order.
    fn within(&self, shaft: &Shaft) -> Option<SmallVec<[u32; MOST_BLOCKERS]>> {
        let mut found = SmallVec::new();
        let mut open: SmallVec<[u32; 64]> = SmallVec::new();
        if self.clusters.len() > 0 {
            open.push(0);
        }
        while let Some(cluster) = open.pop() {
            if shaft.misses_box(&self.clusters.get(cluster).bounds, self.tolerance) {
                continue;
            }
            for child in self.clusters.children(cluster) {
                match child.as_cluster() {
                    Some(inner) => open.push(inner),
                    None => {
                        let polygon = child.index() as u32;
                        if !self.blocks(polygon, shaft) {
                            continue;
                        }
                        let opaque = self.mesh.surface(polygon).transmittance.max_component() <= 0.0;
                        if found.len() == MOST_BLOCKERS || !opaque {
                            return None;
                        }
                        found.push(polygon);
                    }
                }
            }
        }
        found.sort_unstable();
        Some(found)
    }

    /// Whether a polygon reaches into a shaft. One in whose plane the place or the emitter lies does not
    /// block.
    fn blocks(&self, polygon: u32, shaft: &Shaft) -> bool {
        let shape = self.mesh.shape(polygon);
        let corners = shape.corners();
        if shaft.misses(corners, self.tolerance) {
            return false;
        }
        let plane = Plane::through(corners[0], self.mesh.normal(polygon));
        let holds_place = plane.height(shaft.apex).abs() <= self.tolerance;
        let holds_end = corners.iter().all(|&corner| shaft.end.height(corner).abs() <= self.tolerance);
        !holds_place && !holds_end
    }

    /// Takes away what a polygon hides.
    fn cut_out(&self, polygon: u32, place: DVec3, parts: &mut Parts) {
        let shape = self.mesh.shape(polygon);
        let own = Plane::through(shape.corners()[0], self.mesh.normal(polygon)).towards(place);
        let mut planes = sides(place, shape.corners());
        planes.push(Plane { normal: -own.normal, offset: -own.offset });
        for part in std::mem::take(parts) {
            self.leave_outside(part, &planes, parts);
        }
    }

    /// Adds to `parts` what of a polygon is not above all planes.
    fn leave_outside(&self, whole: Corners, planes: &[Plane], parts: &mut Parts) {
        let below = |plane: &Plane| whole.iter().all(|&corner| plane.height(corner) <= self.tolerance);
        if planes.iter().any(below) {
            parts.push(whole);
            return;
        }
        let (first, mut inside) = (parts.len(), whole.clone());
        for plane in planes {
            let outside = part_above(&inside, self.tolerance, |p| -plane.height(p));
            inside = part_above(&inside, self.tolerance, |p| plane.height(p));
            if inside.len() < 3 {
                // It was not touched after all.
                parts.truncate(first);
                parts.push(whole);
                return;
            }
            if outside.len() >= 3 {
                parts.push(outside);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PatchPolygon;
    use senca_math::LinearRgb;

    fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
        let [o, u, v] = [origin, u, v].map(DVec3::from_array);
        [o, o + u, o + u + v, o + v]
    }

    /// A floor, and plates above it.
    fn mesh(plates: &[[DVec3; 4]]) -> ElementMesh {
        let floor = quad([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]);
        let grey = LinearRgb::splat(0.5);
        let polygons: Vec<_> =
            [floor].iter().chain(plates).map(|c| (c.to_vec(), grey, LinearRgb::BLACK)).collect();
        let polygons: Vec<_> = polygons.iter().map(|(c, r, e)| (&c[..], *r, *e)).collect();
        ElementMesh::of_polygons(&polygons)
    }

    fn lamp() -> Facet {
        Facet::of_polygon(PatchPolygon::quad(quad([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])))
    }

    fn open(plates: &[[DVec3; 4]], place: DVec3) -> Option<f64> {
        let mesh = mesh(plates);
        Blockers::new(&mesh, 1e-7).open_share(&lamp(), place, DVec3::Y)
    }

    #[test]
    fn a_plate_that_ends_below_the_middle_hides_half() {
        let half = quad([0.0, 1.0, -3.0], [3.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        assert!((open(&[half], DVec3::ZERO).expect("few") - 0.5).abs() < 1e-12);
        assert_eq!(open(&[], DVec3::ZERO), Some(1.0));
        let all = quad([-3.0, 1.0, -3.0], [6.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        assert_eq!(open(&[all], DVec3::ZERO), Some(0.0));
        let above = quad([-3.0, 2.1, -3.0], [6.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        assert_eq!(open(&[above], DVec3::ZERO), Some(1.0));
    }

    #[test]
    fn plates_that_overlap_hide_their_union() {
        let left = quad([-3.0, 1.0, -3.0], [3.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        let near = quad([-3.0, 0.5, -3.0], [6.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
        assert!((open(&[left, near], DVec3::ZERO).expect("few") - 0.25).abs() < 1e-12);
        assert!((open(&[near, left, left], DVec3::ZERO).expect("few") - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_plate_through_the_lamp_hides_what_is_beyond_it() {
        // From below it hides nothing; from the side what stands behind it.
        let wall = quad([0.0, 1.5, -3.0], [0.0, 1.0, 0.0], [0.0, 0.0, 6.0]);
        assert_eq!(open(&[wall], DVec3::ZERO), Some(1.0));
        let seen = open(&[wall], DVec3::new(-4.0, 0.0, 0.0)).expect("few");
        assert!(seen > 0.4 && seen < 0.6, "{seen}");
    }

    #[test]
    fn cutting_agrees_with_many_rays() {
        let tilted = quad([-0.4, 0.7, -0.3], [0.5, 0.2, 0.1], [-0.1, 0.1, 0.6]);
        let other = quad([-0.1, 1.2, -0.5], [0.3, 0.0, 0.0], [0.0, 0.3, 0.5]);
        let mesh = mesh(&[tilted, other]);
        let blockers = Blockers::new(&mesh, 1e-7);
        let occluders = crate::Occluders::new(&mesh).expect("few");
        for place in [[0.0, 0.0, 0.0], [-0.5, 0.0, 0.2], [0.3, 0.0, -0.6], [-1.5, 0.0, -1.0]] {
            let place = DVec3::from_array(place);
            let exact = blockers.open_share(&lamp(), place, DVec3::Y).expect("few");
            let (mut all, mut seen, n) = (0.0, 0.0, 200);
            for i in 0..n * n {
                let [u, v] = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let at = lamp().shape.place(u, v);
                let weight = 1.0 / (at - place).length_squared().powi(2);
                all += weight;
                seen += if occluders.visible(place, at) { weight } else { 0.0 };
            }
            assert!((exact - seen / all).abs() < 2e-3, "{exact} {}", seen / all);
        }
    }

    #[test]
    fn the_nearest_polygon_in_front_is_found() {
        let wall = quad([1.0, 0.0, -3.0], [0.0, 1.0, 0.0], [0.0, 0.0, 6.0]);
        let plate = quad([-3.0, 0.25, -3.0], [2.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        let mesh = mesh(&[wall, plate]);
        let blockers = Blockers::new(&mesh, 1e-7);
        let nearest = |x: f64, y: f64, normal| blockers.nearest_above(DVec3::new(x, y, 0.2), normal);
        assert!((nearest(0.9, 0.0, DVec3::Y) - 0.1).abs() < 1e-9);
        assert!((nearest(-0.9, 0.0, DVec3::Y) - 0.1f64.hypot(0.25)).abs() < 1e-9);
        assert!((nearest(-2.0, 0.0, DVec3::Y) - 0.25).abs() < 1e-9);
        assert_eq!(nearest(0.0, 2.0, DVec3::Y), f64::INFINITY);
        assert!((nearest(0.0, 2.0, DVec3::X) - 1.0f64.hypot(1.0)).abs() < 1e-9);
    }

    #[test]
    fn what_lets_light_pass_and_what_is_too_much_is_left_to_rays() {
        let plate = quad([0.0, 1.0, -3.0], [3.0, 0.0, 0.0], [0.0, 0.0, 6.0]);
        let mut glass = mesh(&[plate]);
        glass.set_transmittance(1, LinearRgb::splat(0.5));
        assert_eq!(Blockers::new(&glass, 1e-7).open_share(&lamp(), DVec3::ZERO, DVec3::Y), None);
        let many: Vec<_> = (0..60)
            .map(|i| quad([0.01 * f64::from(i) - 0.3, 1.0, 0.0], [0.005, 0.0, 0.0], [0.0, 0.0, 0.2]))
            .collect();
        assert_eq!(open(&many, DVec3::ZERO), None);
    }
}
