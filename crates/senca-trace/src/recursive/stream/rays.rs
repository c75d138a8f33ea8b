//! Rays side by side.

use fearless_simd::{Simd, prelude::*};
use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use crate::Ray;
use crate::lanes::{F, LANES, M, V, first_lanes};

/// Rays of one level of the trees of a batch: a row of numbers for each property. Directions are unit
/// vectors, and rays have no end.
#[derive(Debug, Default)]
pub(super) struct Rays {
    len: usize,
    rows: [Vec<f64>; ROWS],
}

const ROWS: usize = 12;

/// Eight rays.
#[derive(Clone, Copy)]
pub(super) struct Packet<S: Simd> {
    pub(super) origin: V<S>,
    pub(super) direction: V<S>,
    pub(super) t_min: F<S>,
    /// Product of the coefficients on the way.
    pub(super) weight: [F<S>; 3],
    /// Length of the way from the eye to the origin.
    pub(super) distance: F<S>,
    /// Number of the sample in the batch.
    pub(super) slot: F<S>,
}

impl Rays {
    /// Without rays, with room for `most` of them.
    pub(super) fn clear(&mut self, most: usize) {
        self.len = 0;
        for row in &mut self.rows {
            if row.len() < most + LANES {
                row.resize(most + LANES, 0.0);
            }
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Appends the rays of the lanes in `mask`.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, mask: M<S>, packet: &Packet<S>) {
        let Packet { origin: o, direction: d, t_min, weight: [r, g, b], distance, slot } = *packet;
        let values = [o.x, o.y, o.z, d.x, d.y, d.z, t_min, r, g, b, distance, slot];
        let count = mask.to_bitmask().count_ones() as usize;
        for (row, value) in self.rows.iter_mut().zip(&values) {
            value.compress(mask).store_slice(&mut row[self.len..][..LANES]);
        }
        self.len += count;
    }

    /// The same where there may be no room left.
    #[inline(always)]
    pub(super) fn push_more<S: Simd>(&mut self, mask: M<S>, packet: &Packet<S>) {
        if self.rows[0].len() < self.len + 2 * LANES {
            let more = 2 * self.rows[0].len() + LANES;
            for row in &mut self.rows {
                row.resize(more, 0.0);
            }
        }
        self.push(mask, packet);
    }

    /// Appends a ray of others, from t on.
    pub(super) fn push_again(&mut self, others: &Self, number: usize, t: f64) {
        for (row, of_others) in self.rows.iter_mut().zip(&others.rows) {
            row[self.len] = of_others[number];
        }
        self.rows[6][self.len] = t;
        self.len += 1;
    }

    /// Eight rays from number `first` on, and which of them there are.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, first: usize) -> (Packet<S>, M<S>) {
        let eight = packet(
            #[inline(always)]
            |k| F::from_slice(simd, &self.rows[k][first..][..LANES]),
        );
        (eight, first_lanes(simd, self.len - first))
    }

    /// The rays of these numbers, which ascend.
    #[inline(always)]
    pub(super) fn gather<S: Simd>(&self, simd: S, numbers: &[u32; LANES]) -> Packet<S> {
        if follow_each_other(numbers) {
            return self.load(simd, numbers[0] as usize).0;
        }
        packet(
            #[inline(always)]
            |k| gather(simd, &self.rows[k], numbers),
        )
    }

    /// One ray.
    pub(super) fn ray(&self, number: usize) -> Ray {
        let at = |k: usize| self.rows[k][number];
        Ray {
            origin: DVec3::new(at(0), at(1), at(2)),
            direction: DVec3::new(at(3), at(4), at(5)),
            t_min: at(6),
            t_max: f64::INFINITY,
        }
    }

    /// One ray towards a light: of these, t_min is where they end.
    pub(super) fn shadow_ray(&self, number: usize) -> Ray {
        let ray = self.ray(number);
        Ray { t_min: 0.0, t_max: ray.t_min, ..ray }
    }

    /// Number of the sample, the product of the coefficients, and the direction of a ray.
    #[inline(always)]
    pub(super) fn leaving(&self, number: usize) -> (usize, LinearRgb, DVec3) {
        let [_, _, _, dx, dy, dz, _, r, g, b, _, slot] = &self.rows;
        let weight = LinearRgb::new(r[number] as f32, g[number] as f32, b[number] as f32);
        (slot[number] as usize, weight, DVec3::new(dx[number], dy[number], dz[number]))
    }

    pub(super) fn distance(&self, number: usize) -> f64 {
        self.rows[10][number]
    }
}

#[inline(always)]
fn packet<S: Simd>(row: impl Fn(usize) -> F<S>) -> Packet<S> {
    Packet {
        origin: V { x: row(0), y: row(1), z: row(2) },
        direction: V { x: row(3), y: row(4), z: row(5) },
        t_min: row(6),
        weight: [row(7), row(8), row(9)],
        distance: row(10),
        slot: row(11),
    }
}

/// Whether ascending numbers follow each other without gaps.
#[inline(always)]
fn follow_each_other(numbers: &[u32; LANES]) -> bool {
    numbers[LANES - 1] == numbers[0] + LANES as u32 - 1
}

/// The numbers at these places of a row, which ascend.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, row: &[f64], numbers: &[u32; LANES]) -> F<S> {
    if follow_each_other(numbers) {
        return F::from_slice(simd, &row[numbers[0] as usize..][..LANES]);
    }
    F::from_fn(
        simd,
        #[inline(always)]
        |lane| row[numbers[lane] as usize],
    )
}
