//! The plain twin: every ray against every triangle.

use senca_math::glam::Vec3;

use crate::prepared::PreparedRay;
use crate::triangle_bvh::can_be_met;
use crate::watertight::intersect;
use crate::{Ray32, TriangleHit};

/// Answers the questions of [`crate::TriangleBvh`] by trying all triangles. Triangles whose indices are
/// out of range are never met.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce<'a> {
    /// Corners.
    pub points: &'a [Vec3],
    /// Indices into `points`.
    pub triangles: &'a [[u32; 3]],
}

impl BruteForce<'_> {
    /// The hit with the smallest t, of equal ones that of the lowest index.
    #[must_use]
    pub fn closest(&self, ray: &Ray32) -> Option<TriangleHit> {
        self.closest_where(ray, |_| true)
    }

    /// The hit with the smallest t of those that `accept` agrees to.
    pub fn closest_where(
        &self,
        ray: &Ray32,
        mut accept: impl FnMut(&TriangleHit) -> bool,
    ) -> Option<TriangleHit> {
        let hits = self.exact_hits(ray).filter(|hit| accept(&hit.1));
        hits.reduce(|best, hit| if hit.0 < best.0 { hit } else { best }).map(|hit| hit.1)
    }

    /// Whether the ray meets any triangle.
    #[must_use]
    pub fn occluded(&self, ray: &Ray32) -> bool {
        self.hits(ray).next().is_some()
    }

    /// All triangles that the ray meets, by index.
    pub fn hits(&self, ray: &Ray32) -> impl Iterator<Item = TriangleHit> {
        self.exact_hits(ray).map(|hit| hit.1)
    }

    /// Hits with t in the unit of the prepared ray, in which very long or short directions lose nothing.
    fn exact_hits(&self, ray: &Ray32) -> impl Iterator<Item = (f32, TriangleHit)> {
        let halves = match ray.halves() {
            Some([behind, ahead]) => [PreparedRay::new(&behind), PreparedRay::new(&ahead)],
            None => [None, PreparedRay::new(ray)],
        };
        (0..self.triangles.len()).flat_map(move |triangle| {
            let [behind, ahead] = halves.map(|half| half.and_then(|half| self.hit(&half, triangle)));
            behind.map(|(_, hit)| (hit.reversed().t, hit.reversed())).into_iter().chain(ahead)
        })
    }

    fn hit(&self, ray: &PreparedRay, triangle: usize) -> Option<(f32, TriangleHit)> {
        let [a, b, c] = self.triangles[triangle].map(|index| self.points.get(index as usize).copied());
        let corners = [a?, b?, c?];
        let (t, u, v) = intersect(ray, corners).filter(|hit| can_be_met(corners) && hit.0 < ray.t_max)?;
        let hit = TriangleHit { t: t * ray.t_unit, u, v, triangle: triangle as u32 };
        hit.t.is_finite().then_some((t, hit))
    }
}
