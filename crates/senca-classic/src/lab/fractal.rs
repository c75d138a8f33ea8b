//! Exercise 8: Mandelbrot and Julia sets.
//!
//! z is squared and c added again and again; the number of times until |z| reaches a bound tells how
//! fast a point diverges. [`literal_counts`] is the manual's loop; [`counts`] gives the same numbers
//! quickly; [`deep_counts`] goes on where the numbers of the processor end.

use senca_math::{Cancelled, Control};

use super::LabError;
use super::input::Input;

mod colors;
mod deep;
mod fast;
mod fixed;
mod wide;
mod zoom;

pub use colors::{Coloring, colored};
pub use deep::{DeepView, MAX_BOUND, brute_counts, deep_counts, deep_counts_one_by_one};
pub use fast::{counts, counts_into};
pub use fearless_simd::Level;
pub use fixed::{Fixed, FixedError};
pub use wide::Wide;
pub use zoom::{Picture, View, zoom_widths};

/// Longest side of a picture in pixels.
pub const MAX_SIDE: i64 = 32_768;

/// Greatest m.
pub const MAX_ITERATIONS: i64 = 100_000_000;

/// A complex number, real and imaginary part.
pub type Complex = [f64; 2];

/// Which set is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Family {
    /// c is the pixel, z begins with 0.
    #[default]
    Mandelbrot,
    /// c is fixed, z begins with the pixel. The set is connected if c lies in the Mandelbrot set.
    Julia {
        /// The constant.
        c: Complex,
    },
}

/// What the exercise reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Which set.
    pub family: Family,
    /// eps: z has left when |z| is not below it.
    pub bound: f64,
    /// m: so many times z is squared after the first time.
    pub iterations: u32,
    /// umin and umax.
    pub u: [f64; 2],
    /// vmin and vmax; vmin is at row 0, on top.
    pub v: [f64; 2],
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Whether the last column and row lie at umax and vmax: the formula then divides by the number of
    /// the last pixel, and not by the count of pixels. The manual leaves it open.
    pub reach_ends: bool,
}

impl Parameters {
    /// The manual's Mandelbrot set, 200 by 200 pixels.
    pub const MANDELBROT: Self = Self {
        family: Family::Mandelbrot,
        bound: 100.0,
        iterations: 16,
        u: [-1.5, 0.5],
        v: [-1.0, 1.0],
        size: [200, 200],
        reach_ends: false,
    };

    /// The manual's Julia set, 200 by 200 pixels; its area is not square.
    pub const JULIA: Self = Self {
        family: Family::Julia { c: [0.32, 0.043] },
        u: [-1.0, 1.0],
        v: [-1.2, 1.2],
        ..Self::MANDELBROT
    };

    /// Reads eps, m, umin, umax, vmin, vmax, the width and the height, and then, for a Julia set, the
    /// two parts of c.
    ///
    /// # Errors
    /// The text does not hold them, or they are out of range.
    pub fn read(input: &mut Input) -> Result<Self, LabError> {
        let bound = input.number("the bound eps")?;
        if bound <= 0.0 {
            return Err(input.wrong(format!("the bound eps is {bound}, but must be greater than 0")));
        }
        let iterations = input.whole("the number of iterations m", 0..=MAX_ITERATIONS)? as u32;
        let u = interval(input, "umin", "umax")?;
        let v = interval(input, "vmin", "vmax")?;
        let mut side = |what| input.whole(what, 1..=MAX_SIDE).map(|n| n as usize);
        let size = [side("the width")?, side("the height")?];
        let family = if input.left() > 0 {
            Family::Julia {
                c: [input.number("the real part of c")?, input.number("the imaginary part of c")?],
            }
        } else {
            Family::Mandelbrot
        };
        input.finish()?;
        Ok(Self { family, bound, iterations, u, v, size, reach_ends: false })
    }

    /// u of a column, v of a row (1).
    #[must_use]
    pub fn point(&self, x: usize, y: usize) -> Complex {
        let at = |[low, high]: [f64; 2], pixels: usize, i: usize| {
            let last = if self.reach_ends { pixels.saturating_sub(1).max(1) } else { pixels };
            (high - low) / last as f64 * i as f64 + low
        };
        [at(self.u, self.size[0], x), at(self.v, self.size[1], y)]
    }

    /// z before the first iteration, and c, for a pixel.
    #[must_use]
    pub fn start(&self, x: usize, y: usize) -> (Complex, Complex) {
        let point = self.point(x, y);
        match self.family {
            Family::Mandelbrot => ([0.0; 2], point),
            Family::Julia { c } => (point, c),
        }
    }
}

fn interval(input: &mut Input, low: &str, high: &str) -> Result<[f64; 2], LabError> {
    let ends = [input.number(low)?, input.number(high)?];
    if ends[0] >= ends[1] {
        return Err(
            input.wrong(format!("{high} is {}, but must be greater than {low}, {}", ends[1], ends[0]))
        );
    }
    Ok(ends)
}

/// z^2 + c. Every operation is rounded by itself, so that all forms of the loop get the same numbers.
#[inline(always)]
#[must_use]
pub fn next([x, y]: Complex, [cx, cy]: Complex) -> Complex {
    [x * x - y * y + cx, 2.0 * (x * y) + cy]
}

/// |z|.
#[must_use]
pub fn modulus([x, y]: Complex) -> f64 {
    (x * x + y * y).sqrt()
}

/// Whether z stays: |z| is below the bound. Where |z| is no number any more it does not.
fn stays(modulus: f64, bound: f64) -> bool {
    modulus < bound
}

/// How a point leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    /// k, 0 to m. At m the point has never left, or with the very last iteration.
    pub k: u32,
    /// |z| after the last iteration.
    pub modulus: f64,
}

/// The manual's loop for one pixel.
#[must_use]
pub fn leave(parameters: &Parameters, x: usize, y: usize) -> Leaving {
    let (mut z, c) = parameters.start(x, y);
    let mut k = 0;
    loop {
        z = next(z, c);
        let r = modulus(z);
        if !(stays(r, parameters.bound) && k < parameters.iterations) {
            return Leaving { k, modulus: r };
        }
        k += 1;
    }
}

/// |z| after each iteration, from k = 0 to the last.
#[must_use]
pub fn trace(parameters: &Parameters, mut z: Complex, c: Complex) -> Vec<f64> {
    let mut moduli = Vec::new();
    for _ in 0..=parameters.iterations {
        z = next(z, c);
        moduli.push(modulus(z));
        if moduli.last().is_none_or(|&r| !stays(r, parameters.bound)) {
            break;
        }
    }
    moduli
}

/// k of every pixel, row by row from the top. The default is a picture without pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counts {
    /// Width and height.
    pub size: [usize; 2],
    /// m.
    pub iterations: u32,
    /// eps.
    pub bound: f64,
    /// Pixels that left with the very last iteration, and have k = m like those that never leave.
    pub left_at_last: usize,
    /// k of each pixel.
    pub k: Vec<u32>,
    /// |z| of each pixel with k < m after its last iteration, and 0 of the others; empty when it was
    /// not asked for.
    pub moduli: Vec<f64>,
}

impl Counts {
    /// k of a pixel.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> u32 {
        self.k[y * self.size[0] + x]
    }

    /// How many pixels have each k, from 0 to m.
    #[must_use]
    pub fn histogram(&self) -> Vec<u64> {
        let mut counts = vec![0; self.k.iter().max().map_or(0, |&k| k as usize + 1)];
        self.k.iter().for_each(|&k| counts[k as usize] += 1);
        counts
    }

    /// Sum of all k.
    #[must_use]
    pub fn sum(&self) -> u64 {
        self.k.iter().map(|&k| u64::from(k)).sum()
    }
}

/// k and |z| of all pixels by the manual's loop, one after the other.
///
/// # Errors
/// The caller asked to stop.
pub fn literal_counts(parameters: &Parameters, control: &Control<'_>) -> Result<Counts, Cancelled> {
    let [width, height] = parameters.size;
    let mut counts = Counts {
        size: parameters.size,
        iterations: parameters.iterations,
        bound: parameters.bound,
        left_at_last: 0,
        k: Vec::with_capacity(width * height),
        moduli: Vec::with_capacity(width * height),
    };
    for y in 0..height {
        control.check()?;
        control.report(y as f32 / height as f32);
        for x in 0..width {
            let Leaving { k, modulus } = leave(parameters, x, y);
            let is_last = k == parameters.iterations;
            counts.left_at_last += usize::from(is_last && !stays(modulus, parameters.bound));
            counts.k.push(k);
            counts.moduli.push(if is_last { 0.0 } else { modulus });
        }
    }
    Ok(counts)
}

#[cfg(test)]
mod tests;
