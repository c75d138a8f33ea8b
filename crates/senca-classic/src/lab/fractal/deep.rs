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

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use senca_math::{Cancelled, Control};

use super::fixed::Fixed;
use super::wide::{Wide, WideComplex};
use super::{Complex, Counts, modulus, stays};

/// Greatest bound of |z|: squares then fit before the point of [`Fixed`].
pub const MAX_BOUND: f64 = 1e9;

/// Power of two below which differences are computed with an exponent of their own.
const SMALL: i64 = -480;

/// Power of two above which they are computed with the processor's numbers again.
const GROWN: i64 = -440;

/// Power of two below which numbers of the reference are also kept with an exponent of their own.
const TINY: i64 = -900;

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

/// An orbit with many digits, rounded to the processor's numbers.
struct Reference {
    /// Z from Z_0 on, to the first that has left or the last that can be needed.
    z: Vec<Complex>,
    /// Those that are too small for the processor's numbers.
    tiny: HashMap<usize, WideComplex>,
}

impl Reference {
    fn new(
        view: &DeepView,
        start: [Fixed; 2],
        c: &[Fixed; 2],
        control: &Control<'_>,
    ) -> Result<Self, Cancelled> {
        let mut reference = Self { z: Vec::new(), tiny: HashMap::new() };
        let mut z = start;
        for n in 0..=u64::from(view.iterations) + 1 {
            if n % 64 == 0 {
                control.check()?;
            }
            let wide = WideComplex::new(z[0].to_wide(), z[1].to_wide());
            if wide.exponent() < TINY {
                reference.tiny.insert(reference.z.len(), wide);
            }
            let rounded = wide.to_f64();
            reference.z.push(rounded);
            if n > 0 && !stays(modulus(rounded), view.bound) {
                break;
            }
            z = next_fixed(&z, c);
        }
        Ok(reference)
    }

    fn last(&self) -> usize {
        self.z.len() - 1
    }

    fn wide(&self, n: usize) -> WideComplex {
        self.tiny.get(&n).copied().unwrap_or_else(|| WideComplex::from_f64(self.z[n]))
    }
}

/// Where a pixel's orbit is: at index `n` of a reference.
struct Place<'a> {
    reference: &'a Reference,
    n: usize,
    k: u32,
}

/// The references of a picture.
struct References {
    /// The orbit that differences begin at, when it is not that of 0.
    first: Option<Reference>,
    /// The orbit of 0.
    critical: Reference,
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
        let zero = || [Fixed::zero(view.limbs()), Fixed::zero(view.limbs())];
        let Some(c) = &view.julia else {
            return Ok(Self { first: None, critical: Reference::new(view, zero(), &center, control)? });
        };
        let c = view.with_limbs(c);
        let first = Some(Reference::new(view, center, &c, control)?);
        Ok(Self { first, critical: Reference::new(view, zero(), &c, control)? })
    }

    /// k of a pixel, and z after the last iteration.
    fn leave(&self, view: &DeepView, offset: WideComplex) -> (u32, Complex) {
        let mut place = Place { reference: self.first.as_ref().unwrap_or(&self.critical), n: 0, k: 0 };
        let (mut d, dc) = match self.first {
            Some(_) => (offset, WideComplex::ZERO),
            None => (WideComplex::ZERO, offset),
        };
        loop {
            let small = d.exponent().max(dc.exponent()) < GROWN;
            let (pause, next) = if small {
                self.iterate_small(view, &mut place, d, dc)
            } else {
                self.iterate(view, &mut place, d.to_f64(), dc.to_f64(), dc.exponent())
            };
            match pause {
                Pause::Left(z) => return (place.k, z),
                Pause::Changed => d = next,
            }
        }
    }

    /// Iterates with the processor's numbers.
    fn iterate<'a>(
        &'a self,
        view: &DeepView,
        place: &mut Place<'a>,
        mut d: Complex,
        dc: Complex,
        dc_exponent: i64,
    ) -> (Pause, WideComplex) {
        let limit = 2.0_f64.powi(2 * SMALL as i32);
        loop {
            let [zx, zy] = place.reference.z[place.n];
            let (sx, sy) = (2.0 * zx + d[0], 2.0 * zy + d[1]);
            d = [sx * d[0] - sy * d[1] + dc[0], sx * d[1] + sy * d[0] + dc[1]];
            place.n += 1;
            let [zx, zy] = place.reference.z[place.n];
            let z = [zx + d[0], zy + d[1]];
            let (z_square, d_square) = (z[0] * z[0] + z[1] * z[1], d[0] * d[0] + d[1] * d[1]);
            if !(stays(z_square.sqrt(), view.bound) && place.k < view.iterations) {
                return (Pause::Left(z), WideComplex::ZERO);
            }
            place.k += 1;
            if z_square < d_square || place.n == place.reference.last() {
                (d, place.n, place.reference) = (z, 0, &self.critical);
            }
            // Where differences of c are that small, they must not be lost beside a small d.
            if dc_exponent < SMALL && d[0] * d[0] + d[1] * d[1] < limit {
                return (Pause::Changed, WideComplex::from_f64(d));
            }
        }
    }

    /// Iterates with exponents, until the difference has grown.
    fn iterate_small<'a>(
        &'a self,
        view: &DeepView,
        place: &mut Place<'a>,
        mut d: WideComplex,
        dc: WideComplex,
    ) -> (Pause, WideComplex) {
        while d.exponent() < GROWN {
            d = place.reference.wide(place.n).doubled().add(d).times(d).add(dc);
            place.n += 1;
            let z = place.reference.wide(place.n).add(d);
            let rounded = z.to_f64();
            if !(stays(modulus(rounded), view.bound) && place.k < view.iterations) {
                return (Pause::Left(rounded), d);
            }
            place.k += 1;
            if z.is_below(d) || place.n == place.reference.last() {
                (d, place.n, place.reference) = (z, 0, &self.critical);
            }
        }
        (Pause::Changed, d)
    }
}

/// k of all pixels of a view of any depth, by perturbation.
///
/// # Errors
/// The caller asked to stop.
pub fn deep_counts(view: &DeepView, control: &Control<'_>) -> Result<Counts, Cancelled> {
    let references = References::new(view, control)?;
    let leave = |x: usize, y: usize| {
        let [re, im] = view.offset(x, y);
        references.leave(view, WideComplex::new(re, im))
    };
    all_pixels(view, control, leave)
}

/// The same by iterating every pixel with many digits: slow, and what [`deep_counts`] is tested against.
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
    all_pixels(view, control, leave)
}

fn all_pixels(
    view: &DeepView,
    control: &Control<'_>,
    leave: impl Fn(usize, usize) -> (u32, Complex) + Sync,
) -> Result<Counts, Cancelled> {
    let [width, height] = view.size;
    let done = AtomicUsize::new(0);
    let row = |y: usize| {
        let row: Result<Vec<(u32, Complex)>, Cancelled> =
            (0..width).map(|x| control.check().map(|()| leave(x, y))).collect();
        control.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
        row
    };
    let rows: Vec<Vec<(u32, Complex)>> = (0..height).into_par_iter().map(row).collect::<Result<_, _>>()?;
    let pixels = || rows.iter().flatten();
    let is_last = |k: u32| k == view.iterations;
    let left = |z: Complex| !stays(modulus(z), view.bound);
    Ok(Counts {
        size: view.size,
        iterations: view.iterations,
        bound: view.bound,
        left_at_last: pixels().filter(|&&(k, z)| is_last(k) && left(z)).count(),
        k: pixels().map(|p| p.0).collect(),
        moduli: pixels().map(|&(k, z)| if is_last(k) { 0.0 } else { modulus(z) }).collect(),
    })
}

#[cfg(test)]
mod tests;
