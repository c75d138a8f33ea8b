//! The hierarchy over boxes with anything inside.

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;
use senca_math::glam::Vec3;

use crate::build::{Item, build};
use crate::node::{Child, Node};
use crate::prepared::PreparedRay;
use crate::traverse::{LaneRay, Visitor, walk};
use crate::{Aabb32, BuildError, BuildSettings, Ray32, TraversalCounts};

/// Coordinates beyond are taken as infinite, so that surfaces can be computed.
const END: f32 = 1e15;

/// A hierarchy over boxes, whose contents the caller tests: instances, spheres, patches.
///
/// The caller is asked about every item that could matter, in an order that does not depend on threads or
/// vector instructions: roughly from near to far. A box may be asked about although the ray passes it
/// narrowly.
#[derive(Clone, Debug)]
pub struct BoxBvh {
    nodes: Vec<Node>,
    /// Items by leaf.
    items: Vec<u32>,
    bounds: Aabb32,
    level: Level,
}

impl BoxBvh {
    /// Builds the hierarchy over `boxes`. Empty ones, and those with a NaN, are never met. Boxes may be
    /// infinite.
    ///
    /// # Errors
    /// [`BuildError::TooMany`] for more than 2^28 boxes.
    pub fn build(boxes: &[Aabb32], settings: &BuildSettings) -> Result<Self, BuildError> {
        if boxes.len() > Child::MAX_LEAVES {
            return Err(BuildError::TooMany { count: boxes.len(), limit: Child::MAX_LEAVES });
        }
        let items = boxes
            .par_iter()
            .enumerate()
            .with_min_len(1 << 12)
            .filter(|(_, bounds)| !bounds.is_empty())
            .map(|(index, bounds)| {
                Item::new(index as u32, bounds.min.max(Vec3::splat(-END)), bounds.max.min(Vec3::splat(END)))
            })
            .collect();
        let mut tree = build(items, 1, settings.level);
        tree.nodes.par_iter_mut().with_min_len(1 << 12).for_each(|node| node.open(END));
        let items = tree.leaves.iter().map(|leaf| tree.items[leaf.0 as usize]).collect();
        Ok(Self {
            nodes: tree.nodes,
            items,
            bounds: boxes
                .iter()
                .filter(|bounds| !bounds.is_empty())
                .fold(Aabb32::EMPTY, |all, bounds| all.union(*bounds)),
            level: settings.level,
        })
    }

    /// The box around all boxes; empty if there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb32 {
        self.bounds
    }

    /// Bytes of the hierarchy.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.items.capacity() * size_of::<u32>()
    }

    /// Finds the item with the smallest t. `test(item, t_max)` answers the t of the ray's first hit with
    /// the item if there is one with t at most `t_max`, which is `ray.t_max` or the smallest t answered so
    /// far. It keeps the rest of the hit itself, and decides between equal t.
    ///
    /// A ray with a negative `t_min` is asked about everything behind its origin first; an item may be
    /// offered twice then.
    pub fn closest(&self, ray: &Ray32, mut test: impl FnMut(u32, f32) -> Option<f32>) {
        self.find_closest(ray, &mut TraversalCounts::default(), &mut test);
    }

    /// As [`BoxBvh::closest`], adding what it cost to `counts`.
    pub fn closest_counted(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        mut test: impl FnMut(u32, f32) -> Option<f32>,
    ) {
        self.find_closest(ray, counts, &mut test);
    }

    /// Whether `test` says yes to any item whose box the ray meets.
    pub fn any(&self, ray: &Ray32, mut test: impl FnMut(u32) -> bool) -> bool {
        self.find_any(ray, &mut TraversalCounts::default(), &mut test)
    }

    /// As [`BoxBvh::any`], adding what it cost to `counts`.
    pub fn any_counted(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        mut test: impl FnMut(u32) -> bool,
    ) -> bool {
        self.find_any(ray, counts, &mut test)
    }

    // What callers give is called through a pointer, so that the walk is compiled once.
    fn find_closest(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        test: &mut dyn FnMut(u32, f32) -> Option<f32>,
    ) {
        let mut ahead = *ray;
        if let Some([behind, rest]) = ray.halves() {
            ahead = rest;
            let mut behind_test = |item| {
                ahead.t_max = test(item, ahead.t_max).map_or(ahead.t_max, |t| ahead.t_max.min(t));
                false
            };
            self.any_ahead(&behind, counts, &mut behind_test);
        }
        self.walk(&ahead, &mut Items { items: &self.items, test: Nearest(test), counts });
    }

    fn find_any(&self, ray: &Ray32, counts: &mut TraversalCounts, test: &mut dyn FnMut(u32) -> bool) -> bool {
        match ray.halves() {
            None => self.any_ahead(ray, counts, test),
            Some([behind, ahead]) => {
                self.any_ahead(&behind, counts, test) || self.any_ahead(&ahead, counts, test)
            }
        }
    }

    fn any_ahead(
        &self,
        ray: &Ray32,
        counts: &mut TraversalCounts,
        test: &mut dyn FnMut(u32) -> bool,
    ) -> bool {
        let mut items = Items { items: &self.items, test: Any { test, found: false }, counts };
        self.walk(ray, &mut items);
        items.test.found
    }

    fn walk<V: Visitor>(&self, ray: &Ray32, visitor: &mut V) {
        if let Some(prepared) = PreparedRay::new(ray) {
            dispatch!(self.level, simd => walk(simd, &self.nodes, &prepared, visitor));
        }
    }
}

/// What the caller says to an item.
trait Test {
    const ANY: bool;

    /// May lower `t_max`, whose unit is `t_unit`. True ends the walk.
    fn item(&mut self, item: u32, t_max: &mut f32, t_unit: f32) -> bool;
}

struct Nearest<F>(F);

impl<F: FnMut(u32, f32) -> Option<f32>> Test for Nearest<F> {
    const ANY: bool = false;

    #[inline(always)]
    fn item(&mut self, item: u32, t_max: &mut f32, t_unit: f32) -> bool {
        if let Some(t) = (self.0)(item, *t_max * t_unit) {
            *t_max = t_max.min(t / t_unit);
        }
        false
    }
}

struct Any<F> {
    test: F,
    found: bool,
}

impl<F: FnMut(u32) -> bool> Test for Any<F> {
    const ANY: bool = true;

    #[inline(always)]
    fn item(&mut self, item: u32, _: &mut f32, _: f32) -> bool {
        self.found = (self.test)(item);
        self.found
    }
}

struct Items<'a, T> {
    items: &'a [u32],
    test: T,
    counts: &'a mut TraversalCounts,
}

impl<T: Test> Visitor for Items<'_, T> {
    const ANY: bool = T::ANY;

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, _: S, ray: &LaneRay<'_, S>, leaf: Child, t_max: &mut f32) -> bool {
        self.counts.triangles += 1;
        self.test.item(self.items[leaf.leaf_index()], t_max, ray.prepared.t_unit)
    }

    #[inline(always)]
    fn node(&mut self) {
        self.counts.nodes += 1;
    }
}
