//! Deep zoom by perturbation.
//!
//! One orbit, the *reference*, is iterated with as many digits as the depth asks for. All pixels are
//! iterated by what they differ from it: with z = Z + d, the next difference is
//! (2 Z + d) d + (difference of c), in which the small numbers stand alone and keep their precision
//! (K. I. Martin, "Superfractalthing maths", 2013).
//!
//! When z comes nearer to 0 than to the reference, the difference is no longer small and digits would
//! be lost: the cause of the "glitches" of the method. There z itself is taken as the difference to the
//! beginning of the orbit of 0 (rebasing; Zhuoran, fractalforums.org, 2021). The same is done when the
//! reference has left. So one reference serves the whole picture and no pixel has to be mended.
//!
//! Differences too small for the processor's numbers have an exponent of their own until they have
//! grown.
//!
//! [`deep_counts`] lets sixteen pixels go together, [`deep_counts_one_by_one`] is the same for one after
//! the other, and [`brute_counts`] knows nothing of all this.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use senca_math::{Cancelled, Control};

use super::fixed::Fixed;
use super::wide::{Wide, WideComplex};
use super::{Complex, Counts, modulus, stays};

mod together;

/// Greatest bound of |z|: squares then fit before the point of [`Fixed`].
pub const MAX_BOUND: f64 = 1e9;

/// Power of two below which differences are computed with an exponent of their own.
const SMALL: i64 = -480;

/// Power of two above which they are computed with the processor's numbers again.
const GROWN: i64 = -440;

/// Power of two below which numbers of the reference are also kept with an exponent of their own.
const TINY: i64 = -900;

/// Square above which numbers of the reference are much larger than small differences.
const LARGE: f64 = 1e-180;

/// A view of any depth.
#[derive(Clone, Debug, PartialEq)]
pub struct DeepView {
    /// The point in the middle.
    pub center: [Fixed; 2],
    /// Width of the picture; the height follows from the size, with square pixels.
    pub width: Wide,
    /// The constant of a Julia set; `None` for the Mandelbrot set.
    pub julia: Option<[Fixed; 2]>,
    /// eps, at most 1e9.
    pub bound: f64,
    /// m.
    pub iterations: u32,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

impl DeepView {
    /// Limbs behind the point that a picture of this width and number of pixels asks for: a thousandth
    /// of a millionth of a millionth of a pixel, about.
    #[must_use]
    pub fn limbs_for(width: Wide, pixels: usize) -> usize {
        let bits = (pixels.max(1) as f64).log2() - width.log2() + 64.0;
        (bits.max(64.0) / 64.0).ceil() as usize
    }

    /// Difference of a pixel from the middle.
    fn offset(&self, x: usize, y: usize) -> [Wide; 2] {
        let [w, h] = self.size.map(|n| n as f64);
        [(x as f64 - 0.5 * w) / w, (y as f64 - 0.5 * h) / w].map(|share| self.width.times_f64(share))
    }

    /// The same, with an exponent of its own.
    fn difference(&self, x: usize, y: usize) -> WideComplex {
        let [re, im] = self.offset(x, y);
        WideComplex::new(re, im)
    }

    fn limbs(&self) -> usize {
        let parts = self.center.iter().chain(self.julia.iter().flatten());
        parts.map(Fixed::fraction).max().unwrap_or(1).max(Self::limbs_for(self.width, self.size[0]))
    }

    fn with_limbs(&self, number: &[Fixed; 2]) -> [Fixed; 2] {
        let limbs = self.limbs();
        number.clone().map(|part| part.with_fraction(limbs))
    }
}

/// z^2 + c with many digits.
fn next_fixed([x, y]: &[Fixed; 2], [cx, cy]: &[Fixed; 2]) -> [Fixed; 2] {
    [x.multiply(x).subtract(&y.multiply(y)).add(cx), x.multiply(y).doubled().add(cy)]
}

/// Orbits with many digits, rounded to the processor's numbers, that pixels differ from.
struct References {
    /// Z of the orbit that differences begin at, then Z of the orbit of 0, if that is another one: each from
    /// its beginning to the first that has left or the last that can be needed.
    z: Vec<Complex>,
    /// Those that are too small for the processor's numbers.
    tiny: HashMap<usize, WideComplex>,
    /// Where the orbit of 0 begins.
    critical: usize,
    /// Whether pixels begin with different z, and not with different c.
    is_julia: bool,
}

/// Where a pixel's orbit is: beside `n` of the references, after `k` iterations within the bound.
#[derive(Clone, Copy, Default)]
struct Place {
    n: usize,
    k: u32,
}

/// How the iteration of a pixel goes on.
enum Pause {
    Left(Complex),
    /// The difference has become large, or small.
    Changed,
}

impl References {
    fn new(view: &DeepView, control: &Control<'_>) -> Result<Self, Cancelled> {
        let center = view.with_limbs(&view.center);
        let zero = [Fixed::zero(view.limbs()), Fixed::zero(view.limbs())];
        let is_julia = view.julia.is_some();
        let mut references = Self { z: Vec::new(), tiny: HashMap::new(), critical: 0, is_julia };
        match &view.julia {
            None => references.add(view, zero, &center, control)?,
            Some(c) => {
                let c = view.with_limbs(c);
                references.add(view, center, &c, control)?;
                references.critical = references.z.len();
                references.add(view, zero, &c, control)?;
            }
        }
        Ok(references)
    }

    fn add(
        &mut self,
        view: &DeepView,
        mut z: [Fixed; 2],
        c: &[Fixed; 2],
        control: &Control<'_>,
    ) -> Result<(), Cancelled> {
        for n in 0..=u64::from(view.iterations) + 1 {
            if n % 64 == 0 {
                control.check()?;
            }
            let wide = WideComplex::new(z[0].to_wide(), z[1].to_wide());
            if wide.exponent() < TINY {
                self.tiny.insert(self.z.len(), wide);
            }
            let rounded = wide.to_f64();
            self.z.push(rounded);
            if n > 0 && !stays(modulus(rounded), view.bound) {
                break;
            }
            z = next_fixed(&z, c);
        }
        Ok(())
    }

    /// The last of the orbit that `n` belongs to.
    fn last(&self, n: usize) -> usize {
        if n < self.critical { self.critical - 1 } else { self.z.len() - 1 }
    }

    fn wide(&self, n: usize) -> WideComplex {
        self.tiny.get(&n).copied().unwrap_or_else(|| WideComplex::from_f64(self.z[n]))
    }

    /// Differences of z and of c that a pixel begins with.
    fn begin(&self, offset: WideComplex) -> (WideComplex, WideComplex) {
        if self.is_julia { (offset, WideComplex::ZERO) } else { (WideComplex::ZERO, offset) }
    }

    /// k of a pixel, and z after the last iteration.
    fn leave(&self, view: &DeepView, offset: WideComplex) -> (u32, Complex) {
        let mut place = Place::default();
        let (mut d, dc) = self.begin(offset);
        loop {
            let small = d.exponent().max(dc.exponent()) < GROWN;
            let (pause, next) = if small {
                self.iterate_small(view, &mut place, d, dc)
            } else {
                self.iterate(view, &mut place, d.to_f64(), dc)
            };
            match pause {
                Pause::Left(z) => return (place.k, z),
                Pause::Changed => d = next,
            }
        }
    }

    /// Iterates with the processor's numbers.
    fn iterate(
        &self,
        view: &DeepView,
        place: &mut Place,
        mut d: Complex,
        dc: WideComplex,
    ) -> (Pause, WideComplex) {
        let small = small_square(dc);
        let dc = dc.to_f64();
        loop {
            let [zx, zy] = self.z[place.n];
            let (sx, sy) = (2.0 * zx + d[0], 2.0 * zy + d[1]);
            d = [sx * d[0] - sy * d[1] + dc[0], sx * d[1] + sy * d[0] + dc[1]];
            place.n += 1;
            let [zx, zy] = self.z[place.n];
            let z = [zx + d[0], zy + d[1]];
            if !(stays(modulus(z), view.bound) && place.k < view.iterations) {
                return (Pause::Left(z), WideComplex::ZERO);
            }
            place.k += 1;
            if square(z) < square(d) || place.n == self.last(place.n) {
                (d, place.n) = (z, self.critical);
            }
            if square(d) < small {
                return (Pause::Changed, WideComplex::from_f64(d));
            }
        }
    }

    /// Iterates with exponents, until the difference has grown.
    fn iterate_small(
        &self,
        view: &DeepView,
        place: &mut Place,
        mut d: WideComplex,
        dc: WideComplex,
    ) -> (Pause, WideComplex) {
        while d.exponent() < GROWN {
            d = self.wide(place.n).doubled().add(d).times(d).add(dc);
            place.n += 1;
            let z = self.wide(place.n).add(d);
            let rounded = z.to_f64();
            if !(stays(modulus(rounded), view.bound) && place.k < view.iterations) {
                return (Pause::Left(rounded), d);
            }
            place.k += 1;
            if z.is_below(d) || place.n == self.last(place.n) {
                (d, place.n) = (z, self.critical);
            }
            d = self.iterate_beside_large(view, place, d, dc);
        }
        (Pause::Changed, d)
    }

    /// Goes on while Z is so large that z is Z and d^2 is nothing: then the difference is 2 Z d + (difference
    /// of c), and both can be kept as multiples of the same power of two, in the processor's numbers.
    fn iterate_beside_large(
        &self,
        view: &DeepView,
        place: &mut Place,
        d: WideComplex,
        dc: WideComplex,
    ) -> WideComplex {
        let exponent = d.exponent().max(dc.exponent());
        // Neither the end of the reference nor m is reached.
        let steps = (self.last(place.n) - 1).saturating_sub(place.n);
        let steps = steps.min((view.iterations - place.k) as usize);
        if d.exponent() == i64::MIN || steps == 0 {
            return d;
        }
        let [[mut x, mut y], c] = [d, dc].map(|v| v.times_power(-exponent).to_f64());
        let grown = 2.0_f64.powi((2 * (GROWN - exponent)).clamp(0, 1000) as i32);
        let precise = 2.0_f64.powi(-900)..grown;
        let mut done = 0;
        for pair in self.z[place.n..=place.n + steps].windows(2) {
            let ([zx, zy], next) = (pair[0], pair[1]);
            if square(pair[0]).min(square(next)) < LARGE {
                break;
            }
            (x, y) = (2.0 * (zx * x - zy * y) + c[0], 2.0 * (zx * y + zy * x) + c[1]);
            done += 1;
            if !precise.contains(&square([x, y])) {
                break;
            }
        }
        place.n += done;
        place.k += done as u32;
        WideComplex::from_f64([x, y]).times_power(exponent)
    }
}

/// |z|^2.
fn square([x, y]: Complex) -> f64 {
    x * x + y * y
}

/// Square of the difference below which an exponent of its own is needed: where differences of c are that
/// small, they must not be lost beside a small d. 0 where they are not.
fn small_square(dc: WideComplex) -> f64 {
    if dc.exponent() < SMALL { 2.0_f64.powi(2 * SMALL as i32) } else { 0.0 }
}

/// k and |z| of all pixels of a view of any depth, by perturbation.
///
/// # Errors
/// The caller asked to stop.
pub fn deep_counts(view: &DeepView, level: Level, control: &Control<'_>) -> Result<Counts, Cancelled> {
    let references = References::new(view, control)?;
    all_pixels(
        view,
        control,
        |y, row| dispatch!(level, simd => together::leave_row(simd, &references, view, y, row, control)),
    )
}

/// The same for one pixel after the other, without vectors: to the last bit.
///
/// # Errors
/// The caller asked to stop.
pub fn deep_counts_one_by_one(view: &DeepView, control: &Control<'_>) -> Result<Counts, Cancelled> {
    let references = References::new(view, control)?;
    each_pixel(view, control, |x, y| references.leave(view, view.difference(x, y)))
}

/// k and |z| of all pixels by iterating each with many digits: slow, and what [`deep_counts`] is tested
/// against.
///
/// # Errors
/// The caller asked to stop.
pub fn brute_counts(view: &DeepView, control: &Control<'_>) -> Result<Counts, Cancelled> {
    let limbs = view.limbs();
    let center = view.with_limbs(&view.center);
    let leave = |x: usize, y: usize| {
        let offset = view.offset(x, y).map(|part| Fixed::from_wide(part, limbs));
        let point = [center[0].add(&offset[0]), center[1].add(&offset[1])];
        let (mut z, c) = match &view.julia {
            None => ([Fixed::zero(limbs), Fixed::zero(limbs)], point),
            Some(c) => (point, view.with_limbs(c)),
        };
        let mut k = 0;
        loop {
            z = next_fixed(&z, &c);
            let rounded = [z[0].to_f64(), z[1].to_f64()];
            if !(stays(modulus(rounded), view.bound) && k < view.iterations) {
                return (k, rounded);
            }
            k += 1;
        }
    };
    each_pixel(view, control, leave)
}

fn each_pixel(
    view: &DeepView,
    control: &Control<'_>,
    leave: impl Fn(usize, usize) -> (u32, Complex) + Sync,
) -> Result<Counts, Cancelled> {
    all_pixels(view, control, |y, row| {
        row.iter_mut().enumerate().try_for_each(|(x, pixel)| {
            *pixel = leave(x, y);
            control.check()
        })
    })
}

/// A pixel's k, and z after its last iteration.
type Found = (u32, Complex);

fn all_pixels(
    view: &DeepView,
    control: &Control<'_>,
    leave_row: impl Fn(usize, &mut [Found]) -> Result<(), Cancelled> + Sync,
) -> Result<Counts, Cancelled> {
    let [width, height] = view.size;
    let done = AtomicUsize::new(0);
    let mut pixels: Vec<Found> = vec![(0, [0.0; 2]); width * height];
    pixels.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
        control.check()?;
        leave_row(y, row)?;
        control.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
        Ok(())
    })?;
    let is_last = |k: u32| k == view.iterations;
    let left = |z: Complex| !stays(modulus(z), view.bound);
    Ok(Counts {
        size: view.size,
        iterations: view.iterations,
        bound: view.bound,
        left_at_last: pixels.iter().filter(|&&(k, z)| is_last(k) && left(z)).count(),
        k: pixels.iter().map(|p| p.0).collect(),
        moduli: pixels.iter().map(|&(k, z)| if is_last(k) { 0.0 } else { modulus(z) }).collect(),
    })
}

#[cfg(test)]
mod tests;
