//! The hierarchy over triangles.

use fearless_simd::{Level, Simd, dispatch, prelude::*};
use rayon::prelude::*;
use senca_math::glam::Vec3;

use crate::block::{Block, LANES};
use crate::build::{Item, build};
use crate::memory::{list_in_large_pages, prefetch};
use crate::node::{Child, Node};
use crate::prepared::PreparedRay;
use crate::traverse::{LaneRay, Visitor, walk};
use crate::watertight::intersect;
use crate::{Aabb32, BuildError, Ray32, TraversalCounts, TriangleHit};

/// Blocks of which a hierarchy has more than fits into the caches near a core: with its nodes, about 16 MiB.
const LARGE: usize = 1 << 15;

/// How a hierarchy is built. None of it changes an answer.
///
/// The build uses the threads of the current rayon pool.
#[derive(Clone, Copy, Debug)]
pub struct BuildSettings {
    /// Vector instructions used by rays. Default: the best of this machine.
    pub level: Level,
}

impl Default for BuildSettings {
    fn default() -> Self {
        Self { level: Level::new() }
    }
}

/// A hierarchy over triangles.
///
/// Answers are facts of the ray and the triangles: the hit with the smallest t, of equal ones that of the
/// lowest index. They do not depend on the threads of the build or on the vector instructions, and are
/// those of [`crate::BruteForce`], byte for byte.
///
/// Triangles are met from both sides. Rays through a shared edge or corner meet at least one of the
/// triangles there. Triangles with a NaN or infinite coordinate or without area are never met. Neither is
/// anything by rays that are not valid ([`Ray32::is_valid`]).
#[derive(Clone, Debug)]
pub struct TriangleBvh {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    bounds: Aabb32,
    level: Level,
}

impl TriangleBvh {
    /// Builds the hierarchy over `triangles`, which hold three indices into `points` each.
    ///
    /// # Errors
    /// [`BuildError::IndexOutOfRange`] when an index is not that of a point; [`BuildError::TooMany`] for
    /// more than 2^28 triangles.
    pub fn build(
        points: &[Vec3],
        triangles: &[[u32; 3]],
        settings: &BuildSettings,
    ) -> Result<Self, BuildError> {
        if triangles.len() > Child::MAX_LEAVES {
            return Err(BuildError::TooMany { count: triangles.len(), limit: Child::MAX_LEAVES });
        }
        let tree = build(items(points, triangles)?, LANES, settings.level);
        let corners = |triangle: u32| triangles[triangle as usize].map(|index| points[index as usize]);
        let block = |&(start, count): &(u32, u32)| {
            let mut block = Block::EMPTY;
            let items = &tree.items[start as usize..][..count as usize];
            for (lane, &triangle) in items.iter().enumerate() {
                block.set(lane, triangle, corners(triangle));
            }
            block
        };
        let mut blocks = list_in_large_pages(tree.leaves.len());
        blocks.par_extend(tree.leaves.par_iter().with_min_len(1024).map(block));
        let is_wall = |leaf: Child| blocks[leaf.leaf_index()].is_wall(leaf.leaf_count() as usize);
        let node = |node: &Node| Node { walls: node.leaf_slots(is_wall), ..node.clone() };
        let mut nodes = list_in_large_pages(tree.nodes.len());
        nodes.par_extend(tree.nodes.par_iter().with_min_len(1024).map(node));
        Ok(Self { nodes, blocks, bounds: tree.extent.as_box(), level: settings.level })
    }

    /// The box around all triangles that can be met; empty if there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb32 {
        self.bounds
    }

    /// Bytes of the hierarchy, with its own copy of the triangles' corners.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.blocks.capacity() * size_of::<Block>()
    }

    /// The hit with the smallest t.
    #[must_use]
    pub fn closest(&self, ray: &Ray32) -> Option<TriangleHit> {
        if ray.t_min < 0.0 {
            return self.closest_where(ray, |_| true);
        }
        self.closest_ahead(ray, |_: &TriangleHit| true, Uncounted)
    }

    /// The hit with the smallest t of those that `accept` agrees to. It may be asked about hits that
    /// turn out not to be the closest.
    pub fn closest_where(
        &self,
        ray: &Ray32,
        mut accept: impl FnMut(&TriangleHit) -> bool,
    ) -> Option<TriangleHit> {
        self.find_closest(ray, &mut accept, &mut TraversalCounts::default())
    }

    /// As [`TriangleBvh::closest`], adding what it cost to `counts`.
    pub fn closest_counted(&self, ray: &Ray32, counts: &mut TraversalCounts) -> Option<TriangleHit> {
        self.find_closest(ray, &mut |_| true, counts)
    }

    /// As [`TriangleBvh::closest_where`], adding what it cost to `counts`.
    pub fn closest_where_counted(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        mut accept: impl FnMut(&TriangleHit) -> bool,
    ) -> Option<TriangleHit> {
        self.find_closest(ray, &mut accept, counts)
    }

    /// Whether the ray meets any triangle.
    #[must_use]
    pub fn occluded(&self, ray: &Ray32) -> bool {
        if ray.t_min < 0.0 {
            return self.occluded_where(ray, |_| true);
        }
        self.any_ahead(ray, |_: &TriangleHit| true, Uncounted)
    }

    /// Whether the ray meets any triangle at a place that `accept` agrees to.
    pub fn occluded_where(&self, ray: &Ray32, mut accept: impl FnMut(&TriangleHit) -> bool) -> bool {
        self.find_any(ray, &mut accept, &mut TraversalCounts::default())
    }

    /// As [`TriangleBvh::occluded`], adding what it cost to `counts`.
    pub fn occluded_counted(&self, ray: &Ray32, counts: &mut TraversalCounts) -> bool {
        self.find_any(ray, &mut |_| true, counts)
    }

    /// As [`TriangleBvh::occluded_where`], adding what it cost to `counts`.
    pub fn occluded_where_counted(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        mut accept: impl FnMut(&TriangleHit) -> bool,
    ) -> bool {
        self.find_any(ray, &mut accept, counts)
    }

    /// Shows `visit` every triangle that the ray meets, once each, in no particular order.
    pub fn all_hits(&self, ray: &Ray32, mut visit: impl FnMut(&TriangleHit)) {
        let mut accept = |hit: &TriangleHit| {
            visit(hit);
            false
        };
        self.find_any(ray, &mut accept, &mut TraversalCounts::default());
    }

    // What callers give is called through a pointer: hits are few, and the walk is compiled once.
    fn find_closest(
        &self,
        ray: &Ray32,
        accept: &mut Accept<'_>,
        counts: &mut TraversalCounts,
    ) -> Option<TriangleHit> {
        match ray.halves() {
            None => self.closest_ahead(ray, accept, counts),
            Some([behind, ahead]) => self
                .farthest(&behind, &mut |hit| accept(&hit.reversed()), counts)
                .map(|hit| hit.reversed())
                .or_else(|| self.closest_ahead(&ahead, accept, counts)),
        }
    }

    fn find_any(&self, ray: &Ray32, accept: &mut Accept<'_>, counts: &mut TraversalCounts) -> bool {
        match ray.halves() {
            None => self.any_ahead(ray, accept, counts),
            Some([behind, ahead]) => {
                let turned: &mut Accept<'_> = &mut |hit: &TriangleHit| accept(&hit.reversed());
                self.any_ahead(&behind, turned, &mut *counts) || self.any_ahead(&ahead, accept, counts)
            }
        }
    }

    /// The hit with the largest t, of equal ones that of the lowest index.
    fn farthest(
        &self,
        ray: &Ray32,
        accept: &mut Accept<'_>,
        counts: &mut TraversalCounts,
    ) -> Option<TriangleHit> {
        let mut best: Option<TriangleHit> = None;
        let keep: &mut Accept<'_> = &mut |hit: &TriangleHit| {
            let better = best.is_none_or(|b| hit.t > b.t || (hit.t == b.t && hit.triangle < b.triangle));
            if better && accept(hit) {
                best = Some(*hit);
            }
            false
        };
        self.any_ahead(ray, keep, counts);
        best
    }

    /// The closest hit of a ray whose t is nowhere negative.
    fn closest_ahead<A: FnMut(&TriangleHit) -> bool, C: Count>(
        &self,
        ray: &Ray32,
        accept: A,
        count: C,
    ) -> Option<TriangleHit> {
        self.search(ray, Closest { best: None, accept }, count).best
    }

    /// Whether a ray whose t is nowhere negative meets anything.
    fn any_ahead<A: FnMut(&TriangleHit) -> bool, C: Count>(&self, ray: &Ray32, accept: A, count: C) -> bool {
        self.search(ray, Any { found: false, accept }, count).found
    }

    #[inline(always)]
    fn search<F: Found, C: Count>(&self, ray: &Ray32, found: F, count: C) -> F {
        if self.blocks.len() > LARGE {
            self.search_in::<F, C, true>(ray, found, count)
        } else {
            self.search_in::<F, C, false>(ray, found, count)
        }
    }

    #[inline(always)]
    fn search_in<F: Found, C: Count, const IS_LARGE: bool>(&self, ray: &Ray32, found: F, count: C) -> F {
        let mut search = Search::<F, C, IS_LARGE> { blocks: &self.blocks, found, count };
        self.walk(ray, &mut search);
        search.found
    }

    #[inline]
    fn walk<V: Visitor>(&self, ray: &Ray32, visitor: &mut V) {
        if let Some(prepared) = PreparedRay::new(ray) {
            dispatch!(self.level, simd => walk(simd, &self.nodes, &prepared, visitor));
        }
    }
}

/// What a caller says to a hit.
type Accept<'a> = dyn FnMut(&TriangleHit) -> bool + 'a;

/// Counts of a walk, kept or not.
trait Count {
    fn add(&mut self, nodes: u32, triangles: u32);
}

struct Uncounted;

impl Count for Uncounted {
    #[inline(always)]
    fn add(&mut self, _: u32, _: u32) {}
}

impl Count for &mut TraversalCounts {
    #[inline(always)]
    fn add(&mut self, nodes: u32, triangles: u32) {
        self.nodes += u64::from(nodes);
        self.triangles += u64::from(triangles);
    }
}

/// Looks for hits in leaves, of a large hierarchy or of one that fits into caches.
struct Search<'a, F, C, const IS_LARGE: bool> {
    blocks: &'a [Block],
    found: F,
    count: C,
}

/// What is done with hits.
trait Found {
    /// Whether any hit ends the search.
    const ANY: bool;

    /// Sees a hit with t at most `t_max`, which it may lower. True ends the search.
    fn hit(&mut self, t: f32, hit: TriangleHit, t_max: &mut f32) -> bool;
}

/// Keeps the closest hit.
struct Closest<A> {
    best: Option<TriangleHit>,
    accept: A,
}

impl<A: FnMut(&TriangleHit) -> bool> Found for Closest<A> {
    const ANY: bool = false;

    #[inline(always)]
    fn hit(&mut self, t: f32, hit: TriangleHit, t_max: &mut f32) -> bool {
        // Once there is a hit, `t_max` is its t.
        let better = t < *t_max || self.best.is_some_and(|best| hit.triangle < best.triangle);
        if better && hit.t < f32::INFINITY && (self.accept)(&hit) {
            self.best = Some(hit);
            *t_max = t;
        }
        false
    }
}

/// Ends at the first hit.
struct Any<A> {
    found: bool,
    accept: A,
}

impl<A: FnMut(&TriangleHit) -> bool> Found for Any<A> {
    const ANY: bool = true;

    #[inline(always)]
    fn hit(&mut self, t: f32, hit: TriangleHit, t_max: &mut f32) -> bool {
        self.found = t < *t_max && hit.t < f32::INFINITY && (self.accept)(&hit);
        self.found
    }
}

impl<F: Found, C: Count, const IS_LARGE: bool> Visitor for Search<'_, F, C, IS_LARGE> {
    const ANY: bool = F::ANY;
    const IS_LARGE: bool = IS_LARGE;

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, simd: S, ray: &LaneRay<'_, S>, leaf: Child, t_max: &mut f32) -> bool {
        self.count.add(0, leaf.leaf_count());
        let block = &self.blocks[leaf.leaf_index()];
        let hits = block.meet(simd, ray, leaf.leaf_count(), *t_max);
        let unit = ray.prepared.t_unit;
        if hits.mask != 0 {
            let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
            let mut mask = hits.mask;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize % LANES;
                mask &= mask - 1;
                let hit = TriangleHit {
                    t: t[lane] * unit,
                    u: u[lane],
                    v: v[lane],
                    triangle: block.triangles[lane],
                };
                if t[lane] <= *t_max && self.found.hit(t[lane], hit, t_max) {
                    return true;
                }
            }
        }
        if hits.unsure == 0 {
            return false;
        }
        let (end, t) = self.unsure(ray.prepared, block, hits.unsure, *t_max);
        *t_max = t;
        end
    }

    #[inline(always)]
    fn prefetch(&self, leaf: Child) {
        prefetch(self.blocks, leaf.leaf_index());
    }

    #[inline(always)]
    fn node(&mut self) {
        self.count.add(1, 0);
    }
}

impl<F: Found, C, const IS_LARGE: bool> Search<'_, F, C, IS_LARGE> {
    /// Tests some triangles of a block one by one. Whether that ends the search, and the new `t_max`.
    #[cold]
    #[inline(never)]
    fn unsure(&mut self, ray: &PreparedRay, block: &Block, mut mask: u32, mut t_max: f32) -> (bool, f32) {
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % LANES;
            mask &= mask - 1;
            if let Some((t, u, v)) = intersect(ray, block.corners(lane)).filter(|hit| hit.0 <= t_max) {
                let hit = TriangleHit { t: t * ray.t_unit, u, v, triangle: block.triangles[lane] };
                if self.found.hit(t, hit, &mut t_max) {
                    return (true, t_max);
                }
            }
        }
        (false, t_max)
    }
}

/// The boxes of the triangles that can be met.
fn items(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<Item>, BuildError> {
    let wrong =
        triangles.par_iter().enumerate().with_min_len(1 << 14).find_map_first(|(triangle, indices)| {
            let index = indices.iter().copied().find(|&index| index as usize >= points.len())?;
            Some(BuildError::IndexOutOfRange { triangle: triangle as u32, index, points: points.len() })
        });
    if let Some(error) = wrong {
        return Err(error);
    }
    let met = |indices: &[u32; 3]| can_be_met(indices.map(|index| points[index as usize]));
    let item = |(triangle, indices): (usize, &[u32; 3])| {
        let [a, b, c] = indices.map(|index| points[index as usize]);
        Item::new(triangle as u32, a.min(b).min(c), a.max(b).max(c))
    };
    let numbered = triangles.par_iter().enumerate().with_min_len(1 << 12);
    if triangles.par_iter().with_min_len(1 << 12).all(met) {
        let mut items = list_in_large_pages(triangles.len());
        items.par_extend(numbered.map(item));
        Ok(items)
    } else {
        Ok(numbered.filter(|triangle| met(triangle.1)).map(item).collect())
    }
}

/// Whether a triangle is finite and has an area.
pub(crate) fn can_be_met([a, b, c]: [Vec3; 3]) -> bool {
    let normal = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
    a.is_finite() && b.is_finite() && c.is_finite() && normal != senca_math::glam::DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_asked_for_early_changes_no_answer() {
        let point = |i: u32| Vec3::new((i % 31) as f32, (i / 31) as f32, ((i * i) % 7) as f32 * 0.3);
        let points: Vec<Vec3> = (0..31 * 31).map(point).collect();
        let squares = (0..30 * 30).map(|i| i / 30 * 31 + i % 30);
        let triangles: Vec<[u32; 3]> =
            squares.flat_map(|i| [[i, i + 1, i + 31], [i + 1, i + 32, i + 31]]).collect();
        let bvh = TriangleBvh::build(&points, &triangles, &BuildSettings::default()).unwrap();
        let mut hits = 0;
        for i in 0..500 {
            let from =
                Vec3::new((i % 17) as f32 * 2.0 - 2.0, (i % 13) as f32 * 3.0 - 4.0, 3.0 - (i % 5) as f32);
            let ray = Ray32::new(from, point(2 * i % 961) + Vec3::splat(0.2) - from);
            let closest = || Closest { best: None, accept: |_: &TriangleHit| true };
            let plain = bvh.search_in::<_, _, false>(&ray, closest(), Uncounted).best;
            assert_eq!(bvh.search_in::<_, _, true>(&ray, closest(), Uncounted).best, plain);
            let any = || Any { found: false, accept: |_: &TriangleHit| true };
            assert_eq!(bvh.search_in::<_, _, true>(&ray, any(), Uncounted).found, plain.is_some());
            assert_eq!(bvh.search_in::<_, _, false>(&ray, any(), Uncounted).found, plain.is_some());
            hits += usize::from(plain.is_some());
        }
        assert!((100..500).contains(&hits), "{hits}");
    }
}
