//! Surfaces made of patches, which the rays of a list meet many at a time.

use fearless_simd::{Simd, prelude::*};
use senca_math::glam::{DMat4, DVec3};

use super::forms::{Other, reciprocal};
use super::rays::Rays;
use super::{Desk, PATCHES, Pass, Stream, shade};
use crate::intersect::{BLOCK, RayBlock};
use crate::lanes::{F, LANES, M, V, bits_of, eight, lanes_of};
use crate::recursive::Tracer;
use crate::{Counters, Hit, Object, Ray};

/// Eights of a block.
const EIGHTS: usize = BLOCK / LANES;

impl Tracer<'_> {
    /// What the rays of a pass meet among patches before what they meet else.
    #[inline(always)]
    pub(super) fn find_patches<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let Desk { rays, t, rank, hits, block, .. } = &mut *pass.desk;
        let counters = &mut pass.counts.work;
        for other in &stream.forms.patched {
            let object = &self.world.objects()[other.object as usize];
            let Some(patches) = object.surface.patches() else { continue };
            for first in (0..rays.len()).step_by(BLOCK) {
                let alone = fill(simd, object, other, rays, first, t, counters, block);
                if block.live() != 0 {
                    patches.closest_of_block(simd, block, counters);
                    for lane in bits_of(block.hits()) {
                        let number = first + lane;
                        let crossing = block.crossing(lane);
                        let own = other.rank as i64;
                        let ties = crossing.t == t[number] && own < rank[number];
                        if crossing.t < t[number] || ties {
                            (t[number], rank[number]) = (crossing.t, own);
                            hits[number] = Hit { object: other.object, crossing };
                        }
                    }
                }
                for lane in bits_of(alone) {
                    let number = first + lane;
                    let ray = Ray { t_max: t[number], ..rays.ray(number) };
                    if let Some(crossing) = object.closest(&ray, counters) {
                        (t[number], rank[number]) = (crossing.t, other.rank as i64);
                        hits[number] = Hit { object: other.object, crossing };
                    }
                }
            }
        }
    }

    /// Which of the shadow rays `clear`, of the 64 from number `first` on, patches block. Their t_min is
    /// where they end.
    #[inline(always)]
    pub(super) fn blocked_by_patches<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        rays: &Rays,
        first: usize,
        mut clear: u64,
        (block, counters): (&mut RayBlock, &mut Counters),
    ) -> u64 {
        for other in &stream.forms.patched {
            let object = &self.world.objects()[other.object as usize];
            let Some(patches) = object.surface.patches().filter(|_| object.opaque) else { continue };
            let alone = fill_shadows(simd, object, other, rays, first, clear, counters, block);
            if block.live() != 0 {
                clear &= !patches.blocked_of_block(simd, block, counters);
            }
            for lane in bits_of(alone & clear) {
                let ray = rays.shadow_ray(first + lane);
                clear &= !(u64::from(object.blocks(other.object, &ray, counters, &|_| true)) << lane);
            }
        }
        clear
    }

    /// Rays that meet patches of one material.
    #[inline(always)]
    pub(super) fn patches<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let list = std::mem::take(&mut pass.desk.lists[PATCHES]);
        for eight in list[..pass.desk.lengths[PATCHES]].chunks(LANES) {
            let (rays, live, t, ranks) = shade::meeting(simd, pass, eight);
            let looks = shade::looks_of(simd, stream, &ranks);
            let hits: [Hit; LANES] =
                eight!(lane => pass.desk.hits[eight[lane.min(eight.len() - 1)] as usize]);
            let [point, normal] = self.points(simd, &hits);
            let error = F::load_array(
                simd,
                eight!(lane => {
                    self.world.objects()[hits[lane].object as usize].error_at(DVec3::ZERO)
                }),
            );
            let error = error + shade::rounding(simd, &rays, point);
            self.flat_places(simd, stream, pass, rays, live, t, point, normal, error, looks);
        }
        pass.desk.lists[PATCHES] = list;
    }

    /// Places and unit normals in the world.
    #[inline(always)]
    fn points<S: Simd>(&self, simd: S, hits: &[Hit; LANES]) -> [V<S>; 2] {
        let u = F::load_array(simd, eight!(lane => hits[lane].crossing.uv.x));
        let v = F::load_array(simd, eight!(lane => hits[lane].crossing.uv.y));
        let zero = V::splat(simd, DVec3::ZERO);
        let mut found = [zero; 2];
        let mut left = 0xffu64;
        while left != 0 {
            // All that are on the same patch.
            let first = &hits[left.trailing_zeros() as usize % LANES];
            let same: [bool; LANES] = eight!(lane => {
                hits[lane].object == first.object && hits[lane].crossing.part == first.crossing.part
            });
            let mut bits = 0;
            for (lane, same) in same.iter().enumerate() {
                bits |= u64::from(*same) << lane;
            }
            left &= !bits;
            let of_part = M::from_bitmask(simd, bits);
            let object = &self.world.objects()[first.object as usize];
            let patches = object.surface.patches();
            let points = patches.and_then(
                #[inline(always)]
                |patches| patches.points_of_eight(simd, first.crossing.part, [u, v], of_part),
            );
            let [point, normal] = match points {
                Some([point, normal]) => to_world(simd, object, point, normal),
                None => self.points_one_by_one(simd, hits, bits),
            };
            found[0] = V::select(of_part, point, found[0]);
            found[1] = V::select(of_part, normal, found[1]);
        }
        found
    }

    #[inline(always)]
    fn points_one_by_one<S: Simd>(&self, simd: S, hits: &[Hit; LANES], which: u64) -> [V<S>; 2] {
        let mut points = [DVec3::ZERO; LANES];
        let mut normals = points;
        for lane in lanes_of(which) {
            let nowhere = Ray::new(DVec3::ZERO, DVec3::X);
            let at = self.world.interaction(&nowhere, &hits[lane]);
            (points[lane], normals[lane]) = (at.point, at.normal);
        }
        [shade::lanes_from(simd, &points), shade::lanes_from(simd, &normals)]
    }
}

/// Places and normals of an object in the world.
#[inline(always)]
fn to_world<S: Simd>(simd: S, object: &Object<'_>, point: V<S>, normal: V<S>) -> [V<S>; 2] {
    let point = transformed(simd, &object.world_from_object, point, 1.0);
    let m = object.world_from_object_normals;
    let normal = V {
        x: combined(simd, m.row(0), normal),
        y: combined(simd, m.row(1), normal),
        z: combined(simd, m.row(2), normal),
    };
    [point, normal.times(F::splat(simd, 1.0) / normal.dot(normal).sqrt())]
}

/// A row of a matrix times eight vectors.
#[inline(always)]
fn combined<S: Simd>(simd: S, row: DVec3, v: V<S>) -> F<S> {
    F::splat(simd, row.x) * v.x + F::splat(simd, row.y) * v.y + F::splat(simd, row.z) * v.z
}

/// Places (`w` = 1) or directions (`w` = 0) after an affine map.
#[inline(always)]
fn transformed<S: Simd>(simd: S, m: &DMat4, p: V<S>, w: f64) -> V<S> {
    let offset = m.w_axis.truncate() * w;
    let p = V {
        x: combined(simd, m.row(0).truncate(), p),
        y: combined(simd, m.row(1).truncate(), p),
        z: combined(simd, m.row(2).truncate(), p),
    };
    p.add(V::splat(simd, offset))
}

/// Puts those of the 64 rays from number `first` on into the block that meet the box of an object before
/// `t`. Those that start too far away are told: they go one by one.
#[inline(always)]
fn fill<S: Simd>(
    simd: S,
    object: &Object<'_>,
    other: &Other,
    rays: &Rays,
    first: usize,
    t: &[f64],
    counters: &mut Counters,
    block: &mut RayBlock,
) -> u64 {
    block.clear();
    let mut alone = 0;
    for number in 0..EIGHTS {
        let from = first + number * LANES;
        if from >= rays.len() {
            break;
        }
        let (packet, live) = rays.load(simd, from);
        let t_max = F::from_slice(simd, &t[from..][..LANES]);
        counters.nodes += u64::from(live.to_bitmask().count_ones());
        let limits = [packet.t_min, t_max];
        alone |= put(simd, object, other, block, number, [packet.origin, packet.direction], limits, live);
    }
    alone
}

/// The same of shadow rays.
#[inline(always)]
fn fill_shadows<S: Simd>(
    simd: S,
    object: &Object<'_>,
    other: &Other,
    rays: &Rays,
    first: usize,
    clear: u64,
    counters: &mut Counters,
    block: &mut RayBlock,
) -> u64 {
    block.clear();
    let mut alone = 0;
    for number in 0..EIGHTS {
        let lanes = clear >> (number * LANES) & 0xff;
        if lanes == 0 {
            continue;
        }
        let (packet, _) = rays.load(simd, first + number * LANES);
        counters.nodes += u64::from(lanes.count_ones());
        let limits = [F::splat(simd, 0.0), packet.t_min];
        let live = M::from_bitmask(simd, lanes);
        alone |= put(simd, object, other, block, number, [packet.origin, packet.direction], limits, live);
    }
    alone
}

/// Puts eight rays of the world into a block, those that meet the box.
#[inline(always)]
fn put<S: Simd>(
    simd: S,
    object: &Object<'_>,
    other: &Other,
    block: &mut RayBlock,
    number: usize,
    [origin, direction]: [V<S>; 2],
    [t_min, t_max]: [F<S>; 2],
    live: M<S>,
) -> u64 {
    let met = live & other.meet(simd, origin, reciprocal(simd, direction), t_min, t_max);
    if !met.any_true() {
        return 0;
    }
    let (center, far_squared) = object.far();
    let way = V::splat(simd, center).sub(origin);
    let far = met & way.dot(way).simd_gt(F::splat(simd, far_squared));
    // A hit at the same place counts, too, where its object comes first.
    let above = t_max + t_max.abs() * F::splat(simd, f64::EPSILON);
    let local = [
        transformed(simd, &object.object_from_world, origin, 1.0),
        transformed(simd, &object.object_from_world, direction, 0.0),
    ];
    block.put(number, local, [t_min, above], met & !far);
    far.to_bitmask() << (number * LANES)
}
