//! Numbers that stand for chance: the same for the same pixel, sample and dimension, whatever thread
//! asks and in whatever order.
//!
//! A sample of a pixel is a point of a unit cube of many dimensions: where in the pixel, where on the
//! lens, when, which light, which way on. [`Sampler`] hands out its coordinates one after the other,
//! each in [0, 1). Over the samples of one pixel every coordinate, and every pair that is asked for
//! together, is spread evenly:
//!
//! 1. A pair comes from the first two dimensions of the sequence of Sobol' 1967: of any aligned block
//!    of 2^k samples each cell of each division of the square into 2^k equal boxes with sides of
//!    powers of two gets exactly one.
//! 2. Its digits are scrambled as Owen 1995 has it, which keeps (1), makes every single number uniform
//!    (so that means have no bias) and lets errors fall faster than chance would: by hashing (Laine and
//!    Karras 2011; constants of Vegdahl 2021), so nothing is stored.
//! 3. Pairs know nothing of each other: the order of the samples is shuffled for every pair by the
//!    same scrambling (Burley 2020), within aligned blocks, so the first 2^k samples stay even.
//!
//! The second coordinate is the binary Pascal triangle times the sample's number. The triangle is a
//! tensor power, so five shifts do what a table of 32 direction numbers does (Ahmed 2024).

/// How the samples of a pixel are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pattern {
    /// Scrambled Sobol' points: even, and without a visible order.
    #[default]
    Sobol,
    /// Each number by itself, as dice would have it: the plain twin.
    Independent,
}

/// The coordinates of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    pattern: Pattern,
    /// Hash of the seed, plus the number of the pixel.
    key: u64,
    sample: u32,
    dimension: u32,
}

/// An odd constant whose multiples spread evenly: 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// 2^-32.
const UNIT: f64 = 1.0 / 4_294_967_296.0;

impl Sampler {
    /// Sample number `sample` of the pixel in column `x` and row `y`, at dimension 0. Samples may be
    /// taken in any order; numbers 0 to 2^k - 1 are even among themselves.
    #[must_use]
    #[inline]
    pub fn new(pattern: Pattern, seed: u64, x: u32, y: u32, sample: u32) -> Self {
        Self::of_seed(pattern, seed).in_pixel(x, y, sample)
    }

    /// Sample 0 of the pixel in the upper left corner, from which [`Sampler::in_pixel`] makes the others.
    pub(crate) fn of_seed(pattern: Pattern, seed: u64) -> Self {
        Self { pattern, key: mix(seed.wrapping_add(GOLDEN)), sample: 0, dimension: 0 }
    }

    /// Sample number `sample` of another pixel. This is an addition: the numbers of a pixel are stirred when the
    /// first is asked for, since most pictures need none.
    #[inline]
    pub(crate) fn in_pixel(self, x: u32, y: u32, sample: u32) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        Self { key: self.key.wrapping_add(pixel), sample, dimension: 0, ..self }
    }

    /// Goes to a dimension, so that what follows does not depend on how many numbers were asked for
    /// before it.
    #[inline]
    pub fn set_dimension(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// The next number, in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f64 {
        let (seeds, _) = self.seeds();
        let index = match self.pattern {
            Pattern::Sobol => self.shuffled(seeds as u32),
            Pattern::Independent => return f64::from(seeds as u32) * UNIT,
        };
        unit(scramble_reversed(index, (seeds >> 32) as u32))
    }

    /// The next two numbers, each in [0, 1), spread evenly over the square.
    #[inline]
    pub fn next_2d(&mut self) -> [f64; 2] {
        let (seeds, more) = self.seeds();
        if self.pattern == Pattern::Independent {
            return [f64::from(seeds as u32) * UNIT, f64::from((seeds >> 32) as u32) * UNIT];
        }
        let index = self.shuffled(seeds as u32);
        let first = scramble_reversed(index, (seeds >> 32) as u32);
        let second = scramble_reversed(pascal(index), more);
        [unit(first), unit(second)]
    }

    /// Three seeds of the next dimension. Without a pattern they depend on the sample too.
    #[inline]
    fn seeds(&mut self) -> (u64, u32) {
        let own = match self.pattern {
            Pattern::Sobol => 0,
            Pattern::Independent => u64::from(self.sample) << 32,
        };
        let first = mix(mix(self.key) ^ mix(GOLDEN.wrapping_mul(u64::from(self.dimension) + 1) ^ own));
        self.dimension = self.dimension.wrapping_add(1);
        (first, (mix(first ^ GOLDEN) >> 32) as u32)
    }

    /// Number of this sample in the shuffled order.
    #[inline]
    fn shuffled(&self, seed: u32) -> u32 {
        scramble_reversed(self.sample.reverse_bits(), seed).reverse_bits()
    }
}

/// A fraction in [0, 1) from its binary digits, the first in bit 0.
#[inline]
fn unit(reversed_digits: u32) -> f64 {
    f64::from(reversed_digits.reverse_bits()) * UNIT
}

/// Flips each bit depending on the bits below it and the seed: Owen's scrambling of digits of which
/// the first is in bit 0.
#[inline]
fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Pascal's triangle modulo 2 times the digits of `x`: bit i of the result is the parity of the bits
/// j of x for which the binomial coefficient (j over i) is odd.
#[inline]
fn pascal(mut x: u32) -> u32 {
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ (x >> 16)
}

/// Stirs 64 bits so that each depends on all (the finalizer of SplitMix, Steele et al. 2014).
#[inline]
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A number in [0, 1) that depends on all 64 bits.
#[inline]
pub(crate) fn unit_hash(bits: u64) -> f64 {
    f64::from((mix(bits.wrapping_add(GOLDEN)) >> 32) as u32) * UNIT
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(pattern: Pattern, seed: u64, dimension: u32, samples: std::ops::Range<u32>) -> Vec<[f64; 2]> {
        let pair = |sample| {
            let mut sampler = Sampler::new(pattern, seed, 3, 7, sample);
            sampler.set_dimension(dimension);
            sampler.next_2d()
        };
        samples.map(pair).collect()
    }

    #[test]
    fn every_aligned_block_of_pairs_fills_every_elementary_box_once() {
        for (k, block) in [(4u32, 0u32), (4, 5), (6, 0), (8, 0), (8, 3)] {
            let n = 1u32 << k;
            for dimension in [0, 1, 9] {
                let points = pairs(Pattern::Sobol, 42, dimension, n * block..n * (block + 1));
                for columns in (0..=k).map(|c| 1u32 << c) {
                    let rows = n / columns;
                    let mut seen = vec![false; n as usize];
                    for [u, v] in &points {
                        let cell = (u * f64::from(columns)) as u32 + columns * (v * f64::from(rows)) as u32;
                        assert!(!std::mem::replace(&mut seen[cell as usize], true), "{columns} x {rows}");
                    }
                }
            }
        }
    }

    #[test]
    fn single_numbers_are_stratified_too() {
        let mut seen = [false; 64];
        for sample in 0..64 {
            let u = Sampler::new(Pattern::Sobol, 1, 0, 0, sample).next_1d();
            assert!(!std::mem::replace(&mut seen[(u * 64.0) as usize], true));
        }
    }

    #[test]
    fn one_sample_over_many_pixels_is_uniform_and_pairs_do_not_correlate() {
        for pattern in [Pattern::Sobol, Pattern::Independent] {
            let (mut bins, mut mean, mut product) = ([0u32; 16], 0.0, 0.0);
            let n = 128;
            for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
                let mut sampler = Sampler::new(pattern, 5, x, y, 3);
                let (a, b) = (sampler.next_1d(), sampler.next_1d());
                bins[(16.0 * a) as usize] += 1;
                mean += a;
                product += (a - 0.5) * (b - 0.5);
            }
            let count = f64::from(n * n);
            let expected = count / 16.0;
            let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
            assert!(chi2 < 38.0, "{pattern:?}: {chi2}"); // 15 degrees of freedom, 0.1 %
            assert!((mean / count - 0.5).abs() < 4.0 * (1.0 / (12.0 * count)).sqrt());
            assert!((product / count).abs() < 4.0 / (12.0 * count.sqrt()));
        }
    }

    #[test]
    fn numbers_depend_on_everything_and_on_nothing_else() {
        let first = |seed, x, y, sample| Sampler::new(Pattern::Sobol, seed, x, y, sample).next_2d();
        let here = first(1, 2, 3, 4);
        assert_eq!(here, first(1, 2, 3, 4));
        for other in [first(2, 2, 3, 4), first(1, 3, 3, 4), first(1, 2, 4, 4), first(1, 2, 3, 5)] {
            assert_ne!(here, other);
        }
        let mut sampler = Sampler::new(Pattern::Sobol, 1, 2, 3, 4);
        sampler.next_1d();
        let later = sampler.next_2d();
        sampler.set_dimension(1);
        assert_eq!(later, sampler.next_2d());
    }

    #[test]
    fn the_mean_of_a_smooth_function_converges_faster_than_chance() {
        let error = |pattern, n: u32| {
            let of_seed = |seed| {
                let sum: f64 = pairs(pattern, seed, 0, 0..n).iter().map(|[u, v]| u * v).sum();
                (sum / f64::from(n) - 0.25).powi(2)
            };
            ((0..32).map(of_seed).sum::<f64>() / 32.0).sqrt()
        };
        assert!(error(Pattern::Sobol, 256) < 0.1 * error(Pattern::Independent, 256));
        assert!(error(Pattern::Sobol, 256) < 0.2 * error(Pattern::Sobol, 32));
    }

    #[test]
    fn the_triangle_is_pascals() {
        for j in 0..32u32 {
            let column = pascal(1 << j);
            // Lucas 1878: (j over i) is odd where the digits of i are among those of j.
            let expected = (0..32).filter(|i| i & !j == 0).fold(0u32, |bits, i| bits | 1 << i);
            assert_eq!(column, expected, "{j}");
        }
    }
}
