//! Light that comes straight from emitters, lamps and the sky.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use smallvec::SmallVec;

use super::visible::Blockers;
use super::{GatherSettings, mix, unit_hash};
use crate::hierarchy::facet::Facet;
use crate::{DirectLight, ElementMesh, Occluders};

/// Of the emitters that are not looked at one by one, so many are.
const STANDING_FOR_THE_REST: usize = 4;

/// How far from the corners, as a share of the way to the middle, emitters are looked at there.
const INSET: f64 = 0.01;

/// Light that comes straight from emitters, lamps and the sky, at any place.
#[derive(Clone, Debug)]
pub(super) struct DirectGather<'a> {
    occluders: &'a Occluders,
    blockers: Blockers<'a>,
    emitters: Vec<(Facet, LinearRgb)>,
    others: DirectLight,
    /// Rays along each side of an emitter.
    cells: u32,
    /// Emitters that are looked at one by one.
    most: usize,
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
    pub(super) fn new(
        mesh: &'a ElementMesh,
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
        Self {
            occluders,
            blockers: Blockers::new(mesh, occluders.tolerance()),
            emitters: own.chain(lamps).collect(),
            others,
            cells: settings.cells,
            most: settings.emitters,
        }
    }

    /// What is in the way.
    pub(super) fn blockers(&self) -> &Blockers<'a> {
        &self.blockers
    }

    /// Light that arrives at a place on a surface with this unit normal: what a white matt surface
    /// would show there. `key` says where in the cells of emitters rays end; places should differ in it.
    pub(super) fn at(&self, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let mut seen: SmallVec<[Seen; 8]> = SmallVec::new();
        for (emitter, (facet, shows)) in self.emitters.iter().enumerate() {
            let share = facet.share_at(place, normal);
            if share > 0.0 {
                let strength = share * f64::from(shows.max_component());
                seen.push(Seen { emitter, share, strength });
            }
        }
        if seen.len() > self.most {
            seen.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        }
        let (strong, weak) = seen.split_at(self.most.min(seen.len()));
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
        let each = (STANDING_FOR_THE_REST as f64).recip();
        let (mut open, mut passed, mut next) = (LinearRgb::BLACK, 0.0, unit_hash(key) * each);
        for seen in weak {
            passed += seen.strength / total;
            while next < passed {
                open += self.open_share(seen.emitter, place, normal, key) * each as f32;
                next += each;
            }
        }
        weak.iter().map(whole).fold(LinearRgb::BLACK, |sum, light| sum + light) * open
    }

    fn light_of(&self, seen: &Seen, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let open = self.open_share(seen.emitter, place, normal, key);
        self.emitters[seen.emitter].1 * open * seen.share as f32
    }

    /// Share of an emitter's light that arrives: exactly where little is in between, else by rays.
    fn open_share(&self, emitter: usize, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let facet = &self.emitters[emitter].0;
        if let Some(share) = self.blockers.open_share(facet, place, normal) {
            return LinearRgb::splat(share as f32);
        }
        let corners = facet.shape.corners().iter().map(|corner| corner.lerp(facet.center, INSET));
        let above = |at: &DVec3| normal.dot(*at - place) > 0.0;
        let probes = corners.chain([facet.center]).filter(above);
        let passing: SmallVec<[LinearRgb; 5]> =
            probes.map(|at| self.occluders.transmittance(place, at)).collect();
        match passing.first() {
            Some(&first) if passing.iter().all(|&p| p == first) => first,
            _ => self.sampled_share(facet, place, normal, key ^ (emitter as u64) << 48),
        }
    }

    /// The same by one ray to each cell.
    fn sampled_share(&self, facet: &Facet, place: DVec3, normal: DVec3, key: u64) -> LinearRgb {
        let cells = self.cells;
        let (mut all, mut seen) = (0.0, LinearRgb::BLACK);
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
                seen += self.occluders.transmittance(place, at) * carried as f32;
            }
        }
        if all > 0.0 { seen * (1.0 / all) as f32 } else { LinearRgb::BLACK }
    }
}
