//! What is between two places: the polygons of a mesh in a hierarchy that rays are sent through.
//!
//! The polygons are those of the mesh and not the exact shapes, as the chords between places on a
//! covered ball lie inside the ball itself.
//!
//! # What blocks
//!
//! 1. A polygon blocks from both sides, and the two sides of one surface are one polygon.
//! 2. A polygon in whose plane one of the two places lies does not block: the way between them meets
//!    that plane there and nowhere else. So neither the polygons on which the places are block, nor
//!    those that continue, coincide with or touch them in their plane, and no way has to be shortened
//!    at its ends. A wall that stands on a floor blocks however near to it a place on the floor is.
//! 3. "In the plane" means within [`Occluders::tolerance`], which is what rounding to single precision
//!    asks for in a scene of this extent.
//! 4. Blended, masked and transmitting surfaces let the share of light pass that their surface says
//!    ([`crate::RadiantSurface::transmittance`]), unbent; along one way the shares of all are
//!    multiplied. Whether a way is open ([`Occluders::visible`]) asks for any light to pass at all.

use std::collections::HashMap;

use senca_bvh::{BuildError, BuildSettings, Ray32, TraversalCounts, TriangleBvh, TriangleHit};
use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use smallvec::SmallVec;

use crate::{ElementMesh, NONE, RadiosityError};

/// Rounding of a coordinate to single precision and of the products with it, relative to the extent
/// of the scene. Four units in the last place.
const ROUNDING: f64 = 4.0 * (1.0 / 16_777_216.0);

/// The polygons of a mesh, ready to block rays. Dividing elements changes nothing here.
#[derive(Clone, Debug)]
pub struct Occluders {
    bvh: TriangleBvh,
    /// Coordinates in the hierarchy are relative to this.
    center: DVec3,
    /// Of a ball about the center with everything in it.
    radius: f64,
    tolerance: f64,
    /// The blocker of each triangle.
    blocker_of: Vec<u32>,
    blockers: Vec<Blocker>,
    /// Whether every blocker lets nothing pass.
    all_opaque: bool,
}

#[derive(Clone, Copy, Debug)]
struct Blocker {
    /// Unit normal and distance from the center along it.
    normal: DVec3,
    offset: f64,
    /// Places nearer to the plane than this are in it.
    tolerance: f64,
    /// The polygon and the one on its other side, or [`NONE`].
    polygon: u32,
    back: u32,
    transmittance: LinearRgb,
}

/// The first polygon along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonHit {
    /// In multiples of the ray's direction.
    pub t: f64,
    /// The polygon; where both sides take part, the one that faces the origin.
    pub polygon: u32,
    /// Whether it shows its front.
    pub front: bool,
}

impl Occluders {
    /// The polygons of `mesh`.
    ///
    /// # Errors
    /// [`RadiosityError::TooManyElements`] for more than 2^28 triangles.
    pub fn new(mesh: &ElementMesh) -> Result<Self, RadiosityError> {
        let bounds = mesh.bounds();
        let center = bounds.center();
        let tolerance = ROUNDING * 0.5 * bounds.size().max_element();
        let blockers = blockers(mesh, center, tolerance);
        let (mut points, mut triangles, mut blocker_of) = (Vec::new(), Vec::new(), Vec::new());
        for (number, blocker) in (0..).zip(&blockers) {
            let first = points.len() as u32;
            let shape = mesh.shape(blocker.polygon);
            points.extend(shape.corners().iter().map(|&p| (p - center).as_vec3()));
            for second in 1..shape.corners().len() as u32 - 1 {
                triangles.push([first, first + second, first + second + 1]);
                blocker_of.push(number);
            }
        }
        let bvh = TriangleBvh::build(&points, &triangles, &BuildSettings::default()).map_err(too_many)?;
        let all_opaque = blockers.iter().all(|blocker| blocker.transmittance == LinearRgb::BLACK);
        Ok(Self {
            bvh,
            center,
            radius: 0.5 * bounds.diagonal().max(f64::MIN_POSITIVE),
            tolerance,
            blocker_of,
            blockers,
            all_opaque,
        })
    }

    /// Whether light passes from one place to the other.
    #[must_use]
    #[inline]
    pub fn visible(&self, from: DVec3, to: DVec3) -> bool {
        let ends = [from - self.center, to - self.center];
        !self.bvh.occluded_where(&ray_between(ends), |hit| self.blocks(hit, ends))
    }

    /// As [`Occluders::visible`], adding what it cost to `counts`.
    pub fn visible_counted(&self, from: DVec3, to: DVec3, counts: &mut TraversalCounts) -> bool {
        let ends = [from - self.center, to - self.center];
        !self.bvh.occluded_where_counted(&ray_between(ends), counts, |hit| self.blocks(hit, ends))
    }

    /// The share of light that passes from one place to the other, per channel in [0, 1].
    #[must_use]
    pub fn transmittance(&self, from: DVec3, to: DVec3) -> LinearRgb {
        if self.all_opaque {
            return if self.visible(from, to) { LinearRgb::WHITE } else { LinearRgb::BLACK };
        }
        let ends = [from - self.center, to - self.center];
        let mut passed: SmallVec<[u32; 8]> = SmallVec::new();
        let closed = self.bvh.occluded_where(&ray_between(ends), |hit| {
            let number = self.blocker_of[hit.triangle as usize];
            let blocker = &self.blockers[number as usize];
            if blocker.transmittance != LinearRgb::BLACK
                && !blocker.holds_any(ends)
                && !passed.contains(&number)
            {
                passed.push(number);
            }
            self.blocks(hit, ends)
        });
        if closed {
            return LinearRgb::BLACK;
        }
        // In ascending order, so that the product does not depend on the walk.
        passed.sort_unstable();
        let share = |number: &u32| self.blockers[*number as usize].transmittance;
        passed.iter().map(share).fold(LinearRgb::WHITE, |product, share| product * share)
    }

    /// The first polygon along the half-line from `from`, transparent or not; those in whose plane
    /// `from` lies are passed over.
    #[must_use]
    pub fn closest(&self, from: DVec3, direction: DVec3) -> Option<PolygonHit> {
        let start = from - self.center;
        let ray = Ray32::from_f64(start, direction, 0.0, f64::INFINITY);
        let hit = self.bvh.closest_where(&ray, |hit| !self.blocker(hit).holds(start))?;
        let blocker = self.blocker(&hit);
        let front = blocker.normal.dot(direction) < 0.0;
        let (polygon, front) =
            if front || blocker.back == NONE { (blocker.polygon, front) } else { (blocker.back, true) };
        Some(PolygonHit { t: f64::from(hit.t), polygon, front })
    }

    /// A distance from `place` beyond which there is no polygon, in world units.
    #[must_use]
    pub fn beyond(&self, place: DVec3) -> f64 {
        2.0 * (self.radius + place.distance(self.center))
    }

    /// The middle of all polygons' bounds.
    #[must_use]
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// How near to a plane a place counts as in it, in world units.
    #[must_use]
    pub const fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Whether no polygon lets any light pass.
    #[must_use]
    pub const fn all_opaque(&self) -> bool {
        self.all_opaque
    }

    /// Bytes of memory that this holds on to.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes() + size_of_val(&*self.blocker_of) + size_of_val(&*self.blockers)
    }

    #[inline]
    fn blocker(&self, hit: &TriangleHit) -> &Blocker {
        &self.blockers[self.blocker_of[hit.triangle as usize] as usize]
    }

    /// Whether nothing passes at a hit on the way between `ends`.
    #[inline]
    fn blocks(&self, hit: &TriangleHit, ends: [DVec3; 2]) -> bool {
        let blocker = self.blocker(hit);
        blocker.transmittance == LinearRgb::BLACK && !blocker.holds_any(ends)
    }
}

impl Blocker {
    #[inline]
    fn holds(&self, place: DVec3) -> bool {
        (self.normal.dot(place) - self.offset).abs() <= self.tolerance
    }

    #[inline]
    fn holds_any(&self, [from, to]: [DVec3; 2]) -> bool {
        self.holds(from) || self.holds(to)
    }
}

fn ray_between([from, to]: [DVec3; 2]) -> Ray32 {
    Ray32::from_f64(from, to - from, 0.0, 1.0)
}

fn too_many(error: BuildError) -> RadiosityError {
    match error {
        BuildError::TooMany { limit, .. } => RadiosityError::TooManyElements { limit },
        // Triangles name only corners that were added with them.
        _ => RadiosityError::TooManyElements { limit: 1 << 28 },
    }
}

/// One blocker for each polygon, or for each pair of polygons with the same corners.
fn blockers(mesh: &ElementMesh, center: DVec3, tolerance: f64) -> Vec<Blocker> {
    let mut known: HashMap<SmallVec<[[u64; 3]; 4]>, u32> = HashMap::new();
    let mut blockers: Vec<Blocker> = Vec::new();
    for polygon in 0..mesh.polygons().len() as u32 {
        let shape = mesh.shape(polygon);
        let mut key: SmallVec<[[u64; 3]; 4]> =
            shape.corners().iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        key.sort_unstable();
        let number = *known.entry(key).or_insert(blockers.len() as u32);
        if let Some(blocker) = blockers.get_mut(number as usize) {
            let opposite = blocker.normal.dot(mesh.normal(polygon)) < 0.0;
            if opposite && blocker.back == NONE {
                blocker.back = polygon;
            }
            continue;
        }
        let normal = mesh.normal(polygon);
        let place = shape.center() - center;
        // Quadrilaterals that are nearly flat hold their own corners.
        let off = |p: &DVec3| (p - center - place).dot(normal).abs();
        let bent = shape.corners().iter().map(off).fold(0.0, f64::max);
        blockers.push(Blocker {
            normal,
            offset: normal.dot(place),
            tolerance: tolerance + 1.5 * bent,
            polygon,
            back: NONE,
            transmittance: mesh.surface(polygon).transmittance,
        });
    }
    blockers
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: LinearRgb = LinearRgb::splat(0.5);

    fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
        let [o, u, v] = [origin, u, v].map(DVec3::from_array);
        [o, o + u, o + u + v, o + v]
    }

    fn mesh(quads: &[[DVec3; 4]]) -> ElementMesh {
        let polygons: Vec<_> = quads.iter().map(|q| (&q[..], GREY, LinearRgb::BLACK)).collect();
        ElementMesh::of_polygons(&polygons)
    }

    fn of(quads: &[[DVec3; 4]]) -> Occluders {
        Occluders::new(&mesh(quads)).expect("few")
    }

    /// A floor of 10 x 10 with a wall across its middle, x = 0, of height 3.
    fn floor_and_wall() -> [[DVec3; 4]; 2] {
        let floor = quad([-5.0, 0.0, 5.0], [10.0, 0.0, 0.0], [0.0, 0.0, -10.0]);
        [floor, quad([0.0, 0.0, 5.0], [0.0, 0.0, -10.0], [0.0, 3.0, 0.0])]
    }

    #[test]
    fn a_wall_blocks_and_what_places_lie_on_does_not() {
        let occluders = of(&floor_and_wall());
        let [left, right] = [-2.0, 2.0].map(|x| DVec3::new(x, 0.0, 0.3));
        assert!(!occluders.visible(left + DVec3::Y, right + DVec3::Y));
        assert!(!occluders.visible(left, right + DVec3::Y));
        assert!(occluders.visible(left, left + DVec3::new(0.1, 1.0, 0.2)));
        assert!(occluders.visible(left, DVec3::new(0.0, 1.0, 0.0)), "onto the wall itself");
        assert!(occluders.visible(left + 9.0 * DVec3::Y, right), "over the wall");
        assert!(!occluders.visible(left - 0.1 * DVec3::Y, left + DVec3::Y), "through the floor");
    }

    #[test]
    fn nothing_leaks_where_a_wall_touches_the_floor() {
        for shift in [0.0, 1e3] {
            let quads = floor_and_wall().map(|q| q.map(|p| p + DVec3::new(shift, -shift, shift)));
            let occluders = of(&quads);
            for i in 1..=20 {
                let near = DVec3::new(shift - 1e-5 * f64::from(i), -shift, shift + 0.37);
                let beyond = DVec3::new(shift + 1.0, 0.5 - shift, shift);
                assert!(!occluders.visible(near, beyond), "{i}");
                let lamp = DVec3::new(shift - 1.0, 0.5 - shift, shift);
                assert!(occluders.visible(near, lamp), "{i}");
            }
        }
    }

    #[test]
    fn polygons_that_coincide_or_continue_do_not_block_each_other() {
        let [floor, _] = floor_and_wall();
        let beside = floor.map(|p| p + DVec3::X * 10.0);
        let mut turned = floor;
        turned.reverse();
        let occluders = of(&[floor, beside, turned, floor]);
        let place = DVec3::new(5.0, 0.0, 0.0);
        assert!(occluders.visible(place, DVec3::new(3.0, 4.0, 1.0)));
        assert!(occluders.visible(place - 1e-9 * DVec3::Y, DVec3::new(3.0, 4.0, 1.0)));
    }

    #[test]
    fn what_a_ray_meets_first_faces_it() {
        let [_, wall] = floor_and_wall();
        let mut turned = wall;
        turned.reverse();
        let from = DVec3::new(-1.0, 1.0, 0.0);
        let one = of(&[wall]).closest(from, 2.0 * DVec3::X).expect("a hit");
        assert_eq!((one.t, one.polygon, one.front), (0.5, 0, mesh(&[wall]).normal(0).x < 0.0));
        let both = of(&[wall, turned]);
        let [there, back] =
            [from, -from + 2.0 * DVec3::Y].map(|p| both.closest(p, -DVec3::X * p.x).expect("a hit"));
        assert!(there.front && back.front && there.polygon != back.polygon);
        assert_eq!(both.closest(from, DVec3::NEG_X), None);
    }

    #[test]
    fn shares_of_what_lets_light_pass_are_multiplied() {
        let panes = [0.0, 1.0, 2.0].map(|x| quad([x, 0.0, 5.0], [0.0, 0.0, -10.0], [0.0, 3.0, 0.0]));
        let mut mesh = mesh(&panes);
        mesh.set_transmittance(0, LinearRgb::new(0.5, 1.0, 0.25));
        mesh.set_transmittance(1, GREY);
        let occluders = Occluders::new(&mesh).expect("few");
        let at = |x: f64| DVec3::new(x, 1.0, 0.0);
        assert_eq!(occluders.transmittance(at(-1.0), at(0.5)), LinearRgb::new(0.5, 1.0, 0.25));
        assert_eq!(occluders.transmittance(at(-1.0), at(1.5)), LinearRgb::new(0.25, 0.5, 0.125));
        assert_eq!(occluders.transmittance(at(-1.0), at(2.5)), LinearRgb::BLACK);
        assert_eq!(occluders.transmittance(at(0.0), at(0.5)), LinearRgb::WHITE);
        assert!(occluders.visible(at(-1.0), at(1.5)) && !occluders.visible(at(-1.0), at(2.5)));
        assert!(!occluders.all_opaque());
    }

    #[test]
    fn the_inside_of_a_ball_sees_itself() {
        use senca_scene::{Scene, Shape};
        let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let settings = crate::MeshSettings { tolerance: Some(0.02), ..Default::default() };
        let mesh = ElementMesh::of_scene(&scene, &settings).expect("a mesh");
        let occluders = Occluders::new(&mesh).expect("few");
        let centers: Vec<DVec3> = mesh.elements().iter().map(|element| element.center).collect();
        let mut counts = TraversalCounts::default();
        for (i, &from) in centers.iter().enumerate().step_by(7) {
            for &to in centers.iter().skip(i + 1).step_by(11) {
                assert!(occluders.visible_counted(from, to, &mut counts), "{from} {to}");
            }
            assert!(!occluders.visible(from, -1.5 * from), "through the far side");
        }
        assert!(counts.triangles > 0);
    }
}
