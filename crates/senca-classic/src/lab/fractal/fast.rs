//! The loop of [`literal_counts`](super::literal_counts) on many pixels at once.
//!
//! Sixteen pixels of a row go together, as two vectors of eight whose operations fill each other's
//! waiting times. Nothing is contracted to fused operations and each lane is computed by itself, so
//! the counts depend neither on the vector instructions nor on the number of threads.
//!
//! Points that never leave are found early without a guess: z^2 + c has only so many values, and when
//! z is exactly where it was before, it will go round forever.

use fearless_simd::{Level, Simd, dispatch, f64x8, mask64x8, prelude::*};
use rayon::prelude::*;
use senca_math::{Cancelled, Control};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{Counts, Family, Parameters, modulus, next};

/// Pixels that go together.
const TOGETHER: usize = 16;

/// Iterations between two looks at whether all have left.
const UNLOOKED: u32 = 4;

/// Rounds after which orbits are remembered for the first time, to see whether they come back.
const FIRST_MARK: u32 = 8;

/// Rounds between two looks at whether the caller wants to stop.
const UNSTOPPED: u32 = 1 << 16;

/// k of all pixels, and |z| of those that leave if `moduli` is asked for; the same as by
/// [`literal_counts`](super::literal_counts), to the last bit.
///
/// # Errors
/// The caller asked to stop.
pub fn counts(
    parameters: &Parameters,
    moduli: bool,
    level: Level,
    control: &Control<'_>,
) -> Result<Counts, Cancelled> {
    let mut counts = Counts::default();
    counts_into(parameters, moduli, level, control, &mut counts)?;
    Ok(counts)
}

/// The same into counts that have been there before, whose memory is used again: where m is small, new
/// memory takes longer than the iterations.
///
/// # Errors
/// The caller asked to stop. What is in `counts` is not to be relied on then.
pub fn counts_into(
    parameters: &Parameters,
    moduli: bool,
    level: Level,
    control: &Control<'_>,
    counts: &mut Counts,
) -> Result<(), Cancelled> {
    let [width, height] = parameters.size;
    (counts.size, counts.iterations) = (parameters.size, parameters.iterations);
    counts.bound = parameters.bound;
    resize(&mut counts.k, width * height);
    resize(&mut counts.moduli, if moduli { width * height } else { 0 });
    let columns: Vec<f64> = (0..width).map(|x| parameters.point(x, 0)[0]).collect();
    let limit = square_limit(parameters.bound);
    let (done, left_at_last) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let row = |y: usize, k: &mut [u32]| {
        control.check()?;
        let v = parameters.point(0, y)[1];
        let left = dispatch!(level, simd => counts_of_row(simd, parameters, limit, &columns, v, k, control));
        control.check()?;
        left_at_last.fetch_add(left, Ordering::Relaxed);
        control.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
        Ok(())
    };
    if moduli {
        let rows = counts.k.par_chunks_mut(width).zip(counts.moduli.par_chunks_mut(width)).enumerate();
        rows.try_for_each(|(y, (k, moduli))| {
            row(y, k)?;
            for (x, (modulus, &k)) in moduli.iter_mut().zip(&*k).enumerate() {
                let left = k < parameters.iterations;
                *modulus = if left { modulus_after(parameters, x, y, k) } else { 0.0 };
            }
            Ok(())
        })?;
    } else {
        counts.k.par_chunks_mut(width).enumerate().try_for_each(|(y, k)| row(y, k))?;
    }
    counts.left_at_last = left_at_last.into_inner();
    Ok(())
}

/// Makes it so long; what it holds is written over later. New memory comes from the system with zeros in
/// it, and is not touched here.
fn resize<T: Clone + Default>(numbers: &mut Vec<T>, length: usize) {
    if numbers.capacity() < length {
        *numbers = vec![T::default(); length];
    } else {
        numbers.resize(length, T::default());
    }
}

/// |z| after iteration `k`.
fn modulus_after(parameters: &Parameters, x: usize, y: usize, k: u32) -> f64 {
    let (mut z, c) = parameters.start(x, y);
    for _ in 0..=k {
        z = next(z, c);
    }
    modulus(z)
}

/// The least s whose square root is not below `bound`: then s < limit says the same as sqrt(s) < bound,
/// with all rounding.
pub(super) fn square_limit(bound: f64) -> f64 {
    let mut limit = bound * bound;
    while limit.sqrt() >= bound && limit > 0.0 {
        limit = limit.next_down();
    }
    while limit.sqrt() < bound {
        limit = limit.next_up();
    }
    limit
}

/// Fills in k of a row of pixels; returns how many left with the very last iteration.
#[inline(always)]
fn counts_of_row<S: Simd>(
    simd: S,
    parameters: &Parameters,
    limit: f64,
    columns: &[f64],
    v: f64,
    k: &mut [u32],
    control: &Control<'_>,
) -> usize {
    let mut found = [0.0; TOGETHER];
    let mut left_at_last = 0;
    let (whole, rest) = columns.as_chunks::<TOGETHER>();
    let (whole_k, rest_k) = k.as_chunks_mut::<TOGETHER>();
    for (columns, k) in whole.iter().zip(whole_k) {
        left_at_last +=
            counts_together(simd, parameters, limit, columns, v, &mut found, control).count_ones();
        *k = found.map(whole_number);
    }
    if let Some(&last) = rest.last() {
        // The part at the end of the row goes with copies of its last pixel.
        let starts = std::array::from_fn(|i| rest.get(i).copied().unwrap_or(last));
        let left = counts_together(simd, parameters, limit, &starts, v, &mut found, control);
        left_at_last += (left & ((1 << rest.len()) - 1)).count_ones();
        rest_k.iter_mut().zip(found).for_each(|(k, found)| *k = whole_number(found));
    }
    left_at_last as usize
}

/// A whole number below 2^32 as an integer: with 2^52 added its digits are the last ones of the mantissa.
/// That makes vectors of integers out of vectors of numbers, without a look at each.
#[inline(always)]
fn whole_number(k: f64) -> u32 {
    const SHIFT: f64 = (1_u64 << 52) as f64;
    (k + SHIFT).to_bits() as u32
}

/// Eight orbits.
#[derive(Clone, Copy)]
struct Orbits<S: Simd> {
    x: f64x8<S>,
    y: f64x8<S>,
    cx: f64x8<S>,
    cy: f64x8<S>,
    /// Iterations after which z was within the bound.
    k: f64x8<S>,
    /// Orbits that have not left.
    inside: mask64x8<S>,
    /// An earlier z, to see whether an orbit comes back to it.
    old_x: f64x8<S>,
    old_y: f64x8<S>,
}

impl<S: Simd> Orbits<S> {
    #[inline(always)]
    fn new(simd: S, family: Family, u: &[f64], v: f64) -> Self {
        let splat = |value: f64| f64x8::splat(simd, value);
        let (u, v) = (f64x8::from_slice(simd, u), splat(v));
        let (x, y, cx, cy) = match family {
            Family::Mandelbrot => (splat(0.0), splat(0.0), u, v),
            Family::Julia { c: [cx, cy] } => (u, v, splat(cx), splat(cy)),
        };
        let inside = splat(0.0).simd_lt(splat(1.0));
        let nowhere = splat(f64::NAN);
        Self { x, y, cx, cy, k: splat(0.0), inside, old_x: nowhere, old_y: nowhere }
    }

    /// One iteration.
    #[inline(always)]
    fn step(&mut self, limit: f64x8<S>, one: f64x8<S>, zero: f64x8<S>) {
        let xy = self.x * self.y;
        let x = self.x * self.x - self.y * self.y + self.cx;
        let y = (xy + xy) + self.cy;
        (self.x, self.y) = (x, y);
        self.inside &= (x * x + y * y).simd_lt(limit);
        self.k += self.inside.select(one, zero);
    }

    /// Takes out orbits that are where they were before: they never leave.
    #[inline(always)]
    fn take_out_returned(&mut self, iterations: f64x8<S>) {
        let returned = self.inside & self.x.simd_eq(self.old_x) & self.y.simd_eq(self.old_y);
        if returned.any_true() {
            self.k = returned.select(iterations, self.k);
            self.inside &= !returned;
        }
    }
}

/// k of some pixels. Returned are, as bits, those that left with the very last iteration. None of
/// it is right when the caller has asked to stop.
#[inline(always)]
fn counts_together<S: Simd>(
    simd: S,
    parameters: &Parameters,
    limit: f64,
    u: &[f64; TOGETHER],
    v: f64,
    found: &mut [f64; TOGETHER],
    control: &Control<'_>,
) -> u32 {
    let splat = |value: f64| f64x8::splat(simd, value);
    let (limit, one, zero) = (splat(limit), splat(1.0), splat(0.0));
    let iterations = splat(f64::from(parameters.iterations));
    let mut a = Orbits::new(simd, parameters.family, &u[..8], v);
    let mut b = Orbits::new(simd, parameters.family, &u[8..], v);

    // k only grows while it is below m, so m iterations tell it.
    let rounds = parameters.iterations / UNLOOKED;
    let mut next_mark = FIRST_MARK;
    for round in 1..=rounds {
        for _ in 0..UNLOOKED {
            a.step(limit, one, zero);
            b.step(limit, one, zero);
        }
        if !(a.inside | b.inside).any_true() {
            break;
        }
        if round % 4 == 0 && round >= FIRST_MARK {
            a.take_out_returned(iterations);
            b.take_out_returned(iterations);
            if round % UNSTOPPED == 0 && control.is_cancelled() {
                break;
            }
            // Marks twice as far apart each time find cycles of any length.
            if round >= next_mark {
                (a.old_x, a.old_y, b.old_x, b.old_y) = (a.x, a.y, b.x, b.y);
                next_mark *= 2;
            }
        }
    }
    for _ in 0..parameters.iterations % UNLOOKED {
        a.step(limit, one, zero);
        b.step(limit, one, zero);
    }
    a.k.store_slice(&mut found[..8]);
    b.k.store_slice(&mut found[8..]);
    if !(a.inside | b.inside).any_true() {
        return 0;
    }
    // The loop's last iteration tells who has left after all.
    let [a, b] = [a, b].map(|orbits| {
        let mut last = orbits;
        last.step(limit, one, zero);
        (orbits.inside & !last.inside).to_bitmask() as u32
    });
    a | b << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_of_squares_is_exact() {
        for bound in [2.0, 100.0, 1e-3, 0.1, 3.7, 1e150, 12345.678] {
            let limit = square_limit(bound);
            assert!(limit.sqrt() >= bound && limit.next_down().sqrt() < bound, "{bound}");
        }
    }
}
