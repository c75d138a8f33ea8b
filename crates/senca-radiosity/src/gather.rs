//! Light at a single place, for pictures that are to stand beside those of a path tracer.
//!
//! Elements are too coarse for the borders of shadows. So the light that comes straight from emitters
//! and lamps is found anew at each place ([`DirectGather`]): the share of the hemisphere that an
//! emitter takes up by Lambert's formula, and how much of the emitter is seen by rays. Rays to its
//! corners and its middle tell whether all of it is seen, or none; only in half-shadows more are sent,
//! spread over cells of the emitter. The rest of the light is smooth: it is taken from the solution,
//! between nodes ([`IndirectField`]), or more exactly by rays that end on the solution
//! ([`ReflectedGather`]).
//!
//! Source: the second pass of Smits, Arvo and Greenberg 1994, section 5, called local pass or final
//! gather by others.

mod cache;

use rayon::prelude::*;
use senca_math::glam::DVec3;
use senca_math::{Cancelled, Control, LinearRgb};
use smallvec::SmallVec;

use crate::hierarchy::facet::Facet;
use crate::{DirectLight, ElementMesh, Extrapolation, Occluders, Solution};

pub use cache::{CacheSettings, ReflectedGather};

/// How light is found at single places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GatherSettings {
    /// Rays to each emitter that is seen in part are the square of this, 1 to 64. Default 8.
    pub cells: u32,
    /// Emitters that are looked at one by one, at most; of the others a few are, and stand for the rest.
    /// Default 16.
    pub emitters: usize,
}

impl Default for GatherSettings {
    fn default() -> Self {
        Self { cells: 8, emitters: 16 }
    }
}

/// Of the emitters that are not looked at one by one, so many are.
const STANDING_FOR_THE_REST: usize = 4;

/// How far from the corners, as a share of the way to the middle, emitters are looked at there.
const INSET: f64 = 0.01;

/// Light that comes straight from emitters, lamps and the sky, at any place.
#[derive(Clone, Debug)]
pub struct DirectGather<'a> {
    occluders: &'a Occluders,
    emitters: Vec<(Facet, LinearRgb)>,
    others: DirectLight,
    settings: GatherSettings,
}

/// An emitter as seen from a place.
#[derive(Clone, Copy, Debug)]
struct Seen {
    emitter: usize,
    /// Form factor of the place to it.
    share: f64,
    /// That times what it shows; the largest channel.
    strength: f64,
}

impl<'a> DirectGather<'a> {
    /// For the emitters of `mesh` and for `light`.
    #[must_use]
    pub fn new(
        mesh: &ElementMesh,
        light: &DirectLight,
        occluders: &'a Occluders,
        settings: &GatherSettings,
    ) -> Self {
        let mut others = light.clone();
        let rectangles = others.take_plain_areas();
        let shine =
            (0..mesh.polygons().len() as u32).filter(|&p| mesh.surface(p).emission != LinearRgb::BLACK);
        let own = shine.map(|polygon| (Facet::of(mesh, polygon), mesh.surface(polygon).emission));
        let lamps = rectangles.into_iter().map(|(shape, shows)| (Facet::of_polygon(shape), shows));
        let settings = GatherSettings { cells: settings.cells.clamp(1, 64), ..*settings };
        Self { occluders, emitters: own.chain(lamps).collect(), others, settings }
    }

    /// Light that arrives at a place on a surface with this unit normal: what a white matt surface
    /// would show there. `key` says where in the cells of emitters rays end; pixels and samples should
    /// differ in it.
    #[must_use]
    pub fn at(&self, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let mut seen: Vec<Seen> = Vec::new();
        for (emitter, (facet, shows)) in self.emitters.iter().enumerate() {
            let share = facet.share_at(place, normal);
            if share > 0.0 {
                let strength = share * f64::from(shows.max_component());
                seen.push(Seen { emitter, share, strength });
            }
        }
        if seen.len() > self.settings.emitters {
            seen.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        }
        let (strong, weak) = seen.split_at(self.settings.emitters.min(seen.len()));
        let one_by_one = strong.iter().map(|seen| self.light_of(seen, place, normal, key));
        let sum = one_by_one.fold(LinearRgb::BLACK, |sum, light| sum + light);
        sum + self.rest(weak, place, normal, key) + self.others.at(self.occluders, place, normal)
    }

    /// All of what `weak` sends, times the mean visibility of some, taken at even steps of strength.
    fn rest(&self, weak: &[Seen], place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let whole = |seen: &Seen| self.emitters[seen.emitter].1 * seen.share as f32;
        let total: f64 = weak.iter().map(|seen| seen.strength).sum();
        if total <= 0.0 {
            return LinearRgb::BLACK;
        }
        let (mut open, mut passed, mut next) = (0.0, 0.0, unit_hash(key) / STANDING_FOR_THE_REST as f64);
        for seen in weak {
            passed += seen.strength / total;
            while next < passed {
                open += self.open_share(seen.emitter, place, normal, key);
                next += 1.0 / STANDING_FOR_THE_REST as f64;
            }
        }
        let all = weak.iter().map(whole).fold(LinearRgb::BLACK, |sum, light| sum + light);
        all * (open / STANDING_FOR_THE_REST as f64) as f32
    }

    fn light_of(&self, seen: &Seen, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let open = self.open_share(seen.emitter, place, normal, key);
        self.emitters[seen.emitter].1 * (seen.share * open) as f32
    }

    /// Share of an emitter's light that arrives.
    fn open_share(&self, emitter: usize, place: DVec3, normal: DVec3, key: u64) -> f64 {
        let facet = &self.emitters[emitter].0;
        let corners = facet.shape.corners().iter().map(|corner| corner.lerp(facet.center, INSET));
        let above = |at: &DVec3| normal.dot(*at - place) > 0.0;
        let probes = corners.chain([facet.center]).filter(above);
        let passing: SmallVec<[f64; 5]> = probes.map(|at| self.passing(place, at)).collect();
        match passing.first() {
            Some(&first) if passing.iter().all(|&p| p == first) && (first == 0.0 || first == 1.0) => first,
            _ => self.sampled_share(facet, place, normal, key ^ (emitter as u64) << 48),
        }
    }

    /// The same by one ray to each cell.
    fn sampled_share(&self, facet: &Facet, place: DVec3, normal: DVec3, key: u64) -> f64 {
        let cells = self.settings.cells;
        let (mut all, mut seen) = (0.0, 0.0);
        for cell in 0..cells * cells {
            let bits = mix(key.wrapping_add(u64::from(cell) << 40));
            let jitter = [bits, bits >> 32].map(|b| f64::from(b as u32) / 4_294_967_296.0);
            let [u, v] = [(cell % cells, jitter[0]), (cell / cells, jitter[1])]
                .map(|(i, within)| (f64::from(i) + within) / f64::from(cells));
            let at = facet.shape.place(u, v);
            let way = at - place;
            let squared = way.length_squared();
            let carried = normal.dot(way).max(0.0) * facet.normal.dot(-way).max(0.0) / (squared * squared);
            if carried > 0.0 && carried.is_finite() {
                all += carried;
                seen += carried * self.passing(place, at);
            }
        }
        if all > 0.0 { seen / all } else { 0.0 }
    }

    fn passing(&self, place: DVec3, at: DVec3) -> f64 {
        if self.occluders.all_opaque() {
            return if self.occluders.visible(place, at) { 1.0 } else { 0.0 };
        }
        let share = self.occluders.transmittance(place, at);
        f64::from(share.r + share.g + share.b) / 3.0
    }
}

/// Light that came by way of other surfaces, between the nodes of the elements.
#[derive(Clone, Debug)]
pub struct IndirectField<'a> {
    mesh: &'a ElementMesh,
    /// Of each vertex.
    light: Vec<LinearRgb>,
}

impl<'a> IndirectField<'a> {
    /// Of a solution.
    #[must_use]
    pub fn new(solution: &'a Solution) -> Self {
        let nodes = solution.node_values(Extrapolation::Clamped);
        let rest = |(&all, &direct): (&LinearRgb, &LinearRgb)| {
            LinearRgb::new(
                (all.r - direct.r).max(0.0),
                (all.g - direct.g).max(0.0),
                (all.b - direct.b).max(0.0),
            )
        };
        Self { mesh: &solution.mesh, light: nodes.incident.iter().zip(&nodes.direct).map(rest).collect() }
    }

    /// Light at a place of a polygon.
    #[must_use]
    pub fn at(&self, polygon: u32, place: DVec3) -> LinearRgb {
        let leaf = leaf_at(self.mesh, polygon, place);
        let shape = self.mesh.shape(leaf);
        let weights = corner_weights(shape.corners(), self.mesh.normal(leaf), place);
        let corners = self.mesh.elements()[leaf as usize].corners();
        let sum: f64 = weights.iter().sum();
        let shares = corners.iter().zip(&weights);
        shares.fold(LinearRgb::BLACK, |light, (&v, w)| light + self.light[v as usize] * (w / sum) as f32)
    }
}

/// Light that surfaces reflect to a place, by rays spread evenly over the hemisphere as the cosine
/// weighs them: what a white matt surface with this unit normal would show of it. Emission does not
/// count. `key` turns the directions.
#[must_use]
pub fn gather_reflected(
    solution: &Solution,
    occluders: &Occluders,
    place: DVec3,
    normal: DVec3,
    rays: u32,
    key: u64,
) -> LinearRgb {
    let frame = Frame::of(normal);
    let shift = [unit_hash(key), unit_hash(!key)];
    let light = |ray: u32| {
        let ring = (f64::from(ray) + shift[0]) / f64::from(rays);
        let part = (f64::from(ray) * 0.618_033_988_749_895 + shift[1]).fract();
        reflected_from(solution, occluders, place, frame.cosine_weighted(ring, part)).unwrap_or_default()
    };
    let sum = (0..rays).fold(LinearRgb::BLACK, |sum, ray| sum + light(ray));
    sum * (rays.max(1) as f32).recip()
}

/// Finds the reflected light on all leaves anew, by rays that end on the solution as it is: one more
/// exchange of light, in which what is hidden in part is hidden where it is. Links share that out over
/// whole elements where little light is at stake, which shows where surfaces touch. `rays` are sent
/// from each leaf, from places all over it; 64 is enough for most.
///
/// # Errors
/// [`Cancelled`]; the solution is as before then.
pub fn regather_reflected(
    solution: &mut Solution,
    occluders: &Occluders,
    rays: u32,
    control: &Control<'_>,
) -> Result<(), Cancelled> {
    let leaves: Vec<u32> = solution.mesh.leaves().collect();
    let on_leaf = |&leaf: &u32| {
        control.check()?;
        Ok(gather_on_leaf(solution, occluders, leaf, rays))
    };
    let found: Result<Vec<LinearRgb>, Cancelled> = leaves.par_iter().with_min_len(16).map(on_leaf).collect();
    for (&leaf, light) in leaves.iter().zip(found?) {
        solution.incident[leaf as usize] = solution.direct[leaf as usize] + light;
    }
    solution.pull();
    Ok(())
}

/// Mean of the reflected light over a leaf.
fn gather_on_leaf(solution: &Solution, occluders: &Occluders, leaf: u32, rays: u32) -> LinearRgb {
    let (shape, normal) = (solution.mesh.shape(leaf), solution.mesh.normal(leaf));
    let frame = Frame::of(normal);
    let key = u64::from(leaf) << 32;
    let light = |ray: u32| {
        let [a, b] = [mix(key | u64::from(ray)), mix(!(key | u64::from(ray)))];
        let unit = |bits: u64| f64::from(bits as u32) / 4_294_967_296.0;
        let ring = (f64::from(ray) + unit(b)) / f64::from(rays);
        let part = (f64::from(ray) * 0.618_033_988_749_895 + unit_hash(key)).fract();
        let place = shape.place(unit(a), unit(a >> 32));
        reflected_from(solution, occluders, place, frame.cosine_weighted(ring, part)).unwrap_or_default()
    };
    let sum = (0..rays).fold(LinearRgb::BLACK, |sum, ray| sum + light(ray));
    sum * (rays.max(1) as f32).recip()
}

/// Light that the surface which a ray meets reflects; `None` where it meets no front.
fn reflected_from(
    solution: &Solution,
    occluders: &Occluders,
    place: DVec3,
    direction: DVec3,
) -> Option<LinearRgb> {
    let hit = occluders.closest(place, direction).filter(|hit| hit.front)?;
    let leaf = leaf_at(&solution.mesh, hit.polygon, place + hit.t * direction);
    Some(solution.mesh.surface(leaf).reflectance * solution.incident[leaf as usize])
}

/// Directions around a normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    axes: [DVec3; 3],
}

impl Frame {
    /// Around a unit vector.
    pub(crate) fn of(normal: DVec3) -> Self {
        let [x, y] = [DVec3::X, DVec3::Y].map(|axis| axis.cross(normal));
        let x_axis = if x.length_squared() > y.length_squared() { x } else { y }.normalize_or_zero();
        Self { axes: [x_axis, normal.cross(x_axis), normal] }
    }

    /// The direction at right angles to the normal at this angle from the first axis.
    pub(crate) fn around(&self, angle: f64) -> DVec3 {
        angle.cos() * self.axes[0] + angle.sin() * self.axes[1]
    }

    /// The direction of a point of the unit square, by a map that makes of an even spread one that the
    /// cosine weighs (Malley's).
    pub(crate) fn cosine_weighted(&self, u: f64, v: f64) -> DVec3 {
        u.sqrt() * self.around(std::f64::consts::TAU * v) + (1.0 - u).max(0.0).sqrt() * self.axes[2]
    }
}

/// The leaf of a polygon that holds a place, or comes nearest to it.
fn leaf_at(mesh: &ElementMesh, polygon: u32, place: DVec3) -> u32 {
    let mut element = polygon;
    loop {
        let whole = &mesh.elements()[element as usize];
        let inside = |&part: &u32| {
            if whole.corners().len() == 4 {
                // The nearest middle is the part's own, but for a little where sides are not parallel.
                return -mesh.elements()[part as usize].center.distance_squared(place);
            }
            inside_by(mesh.shape(part).corners(), mesh.normal(part), place)
        };
        let Some(best) = whole.part_numbers().max_by(|a, b| inside(a).total_cmp(&inside(b))) else {
            return element;
        };
        element = best;
    }
}

/// Distance from the nearest edge's line, negative outside.
fn inside_by(corners: &[DVec3], normal: DVec3, place: DVec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let from_edge = |(&a, &b): (&DVec3, &DVec3)| normal.dot((b - a).cross(place - a)) / (b - a).length();
    edges.map(from_edge).fold(f64::INFINITY, f64::min)
}

/// Weights of the corners of a convex polygon at a place in it, as areas of triangles (Wachspress 1975):
/// bilinear in a rectangle, barycentric in a triangle. Not normalized.
fn corner_weights(corners: &[DVec3], normal: DVec3, place: DVec3) -> SmallVec<[f64; 4]> {
    let count = corners.len();
    let at = |k: usize| corners[k % count];
    let area = |a: DVec3, b: DVec3, c: DVec3| normal.dot((b - a).cross(c - a));
    let scale = area(at(0), at(1), at(2)).abs().max(f64::MIN_POSITIVE);
    // On an edge the areas beside it vanish; a little of them keeps the weights finite.
    let of_edge = |k: usize| area(place, at(k), at(k + 1)).max(1e-9 * scale);
    (0..count)
        .map(|k| {
            let before = k + count - 1;
            area(at(before), at(k), at(k + 1)) / (of_edge(before) * of_edge(k)) * scale
        })
        .collect()
}

/// Stirs 64 bits so that each depends on all (the finalizer of SplitMix, Steele et al. 2014).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn unit_hash(bits: u64) -> f64 {
    f64::from((mix(bits) >> 32) as u32) / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
        let [o, u, v] = [origin, u, v].map(DVec3::from_array);
        [o, o + u, o + u + v, o + v]
    }

    /// A floor, a lamp of 1 x 1 at height 2 that looks down, and a plate below half of it.
    fn scene() -> ElementMesh {
        let floor = quad([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]);
        let lamp = quad([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let plate = quad([0.0, 1.99, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]);
        let grey = LinearRgb::splat(0.5);
        let polygons = [(floor, 0.0), (lamp, 10.0), (plate, 0.0)];
        let polygons: Vec<_> = polygons.iter().map(|(c, e)| (&c[..], grey, LinearRgb::splat(*e))).collect();
        ElementMesh::of_polygons(&polygons)
    }

    #[test]
    fn a_half_hidden_lamp_gives_half_of_its_light() {
        let mesh = scene();
        let occluders = Occluders::new(&mesh).expect("few");
        let gather =
            DirectGather::new(&mesh, &DirectLight::default(), &occluders, &GatherSettings::default());
        let light = |x: f64| f64::from(gather.at(DVec3::new(x, 0.0, 0.0), DVec3::Y, 7).g);
        // The way to the lamp at height 2 passes the plate's edge at height 1.99 and x = 0.
        let seen = |x: f64| {
            let end = x - x / 0.995;
            let part =
                crate::PatchPolygon::quad(quad([-0.5, 2.0, -0.5], [0.5 + end, 0.0, 0.0], [0.0, 0.0, 1.0]));
            10.0 * Facet::of_polygon(part).share_at(DVec3::new(x, 0.0, 0.0), DVec3::Y)
        };
        for (x, bound) in [(0.0, 0.03), (-1.0, 0.06), (-4.0, 0.06)] {
            assert!((light(x) / seen(x) - 1.0).abs() < bound, "{} {}", light(x), seen(x));
        }
        assert_eq!(gather.at(DVec3::new(0.1, 3.0, 0.0), DVec3::Y, 7), LinearRgb::BLACK);
        // Below the plate nothing is seen of the lamp.
        assert!(gather.at(DVec3::new(0.4, 1.989, 0.0), DVec3::Y, 7).g < 1e-3);
    }

    #[test]
    fn weights_of_corners_are_bilinear_in_a_rectangle() {
        let corners = quad([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        for (x, y) in [(0.5, 0.25), (0.0, 0.5), (2.0, 1.0)] {
            let weights = corner_weights(&corners, DVec3::Z, DVec3::new(x, y, 0.0));
            let sum: f64 = weights.iter().sum();
            let u = x / 2.0;
            let expected = [(1.0 - u) * (1.0 - y), u * (1.0 - y), u * y, (1.0 - u) * y];
            for (weight, expected) in weights.iter().zip(expected) {
                assert!((weight / sum - expected).abs() < 1e-6, "{weights:?}");
            }
        }
    }

    /// A room of 2 x 2 x 2 with walls of different light.
    fn lit_room() -> Solution {
        let walls = [
            quad([-1.0; 3], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]),
            quad([1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]),
            quad([-1.0; 3], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]),
            quad([-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
            quad([-1.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
            quad([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
        ];
        let polygons: Vec<_> = walls.iter().map(|c| (&c[..], LinearRgb::WHITE, LinearRgb::BLACK)).collect();
        let mesh = ElementMesh::of_polygons(&polygons);
        let incident: Vec<LinearRgb> =
            [3.0, 0.5, 1.0, 0.2, 0.7, 0.1].map(|v| LinearRgb::new(v, 1.0, 0.5 * v)).to_vec();
        Solution { mesh, direct: vec![LinearRgb::BLACK; 6], incident, ..Solution::default() }
    }

    #[test]
    fn reflected_light_is_carried_along_its_gradient() {
        let solution = lit_room();
        let occluders = Occluders::new(&solution.mesh).expect("few");
        let settings = CacheSettings { rings: 24, reach: 0.3, least: None };
        let mut gather = ReflectedGather::new(&solution, &occluders, &settings).expect("in range");
        let exact = |place: DVec3| {
            let share = |wall: u32| Facet::of(&solution.mesh, wall).share_at(place, DVec3::Y);
            (0..6).map(|wall| share(wall) * f64::from(solution.incident[wall as usize].r)).sum::<f64>()
        };
        let start = DVec3::new(0.2, -1.0, -0.1);
        gather.prepare(&[(start, DVec3::Y)], &senca_math::Control::default()).expect("not cancelled");
        assert_eq!(gather.len(), 1);
        for way in [DVec3::ZERO, 0.1 * DVec3::X, -0.1 * DVec3::X, 0.1 * DVec3::Z, -0.1 * DVec3::Z] {
            let [carried, exact] = [f64::from(gather.at(start + way, DVec3::Y).r), exact(start + way)];
            assert!((carried / exact - 1.0).abs() < 0.015, "{way}: {carried} {exact}");
        }
        // All walls are equally bright in the second channel.
        assert!((gather.at(start, DVec3::Y).g - 1.0).abs() < 1e-6);
        // A normal that turns towards the bright wall sees more of it.
        let turned = DVec3::new(-0.05, 1.0, 0.0).normalize();
        assert!(gather.at(start, turned).r > gather.at(start, DVec3::Y).r);
    }

    #[test]
    fn found_light_does_not_depend_on_threads() {
        let solution = lit_room();
        let occluders = Occluders::new(&solution.mesh).expect("few");
        let places: Vec<(DVec3, DVec3)> = (0..900)
            .map(|i| {
                (DVec3::new(f64::from(i % 30) / 15.0 - 0.97, -1.0, f64::from(i / 30) / 15.0 - 0.97), DVec3::Y)
            })
            .collect();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let settings = CacheSettings { rings: 4, ..CacheSettings::default() };
                let mut gather = ReflectedGather::new(&solution, &occluders, &settings).expect("in range");
                gather.prepare(&places, &senca_math::Control::default()).expect("not cancelled");
                assert!(gather.len() < places.len());
                places.iter().map(|&(place, normal)| gather.at(place, normal)).collect::<Vec<_>>()
            })
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn places_find_their_leaves() {
        let mut mesh = scene();
        mesh.divide_to_size(0.7, 1 << 16).expect("few");
        for (x, z) in [(-4.9, 3.3), (0.1, 0.2), (4.99, -4.99)] {
            let place = DVec3::new(x, 0.0, z);
            let leaf = leaf_at(&mesh, 0, place);
            assert!(mesh.elements()[leaf as usize].is_leaf());
            assert!(inside_by(mesh.shape(leaf).corners(), DVec3::Y, place) >= 0.0);
        }
    }
}
