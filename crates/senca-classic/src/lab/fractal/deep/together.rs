//! The loop of perturbation on sixteen pixels of a row at once.
//!
//! Pixels go on together until one of them leaves, comes nearer to 0 than to its reference, or comes to the
//! end of either its reference or m: then it is looked at by itself, and another one takes its lane when it
//! is done. Pixels stand beside different places of the references after a while; as long as all stand at
//! the same one its Z is loaded once. Each lane is computed by itself with the operations of the loop for
//! one pixel, so that not a bit is different.

use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};
use senca_math::{Cancelled, Control};

use super::super::fast::square_limit;
use super::{DeepView, Found, GROWN, Pause, Place, References, small_square, square};
use crate::lab::fractal::Complex;
use crate::lab::fractal::wide::WideComplex;

/// Pixels that go together.
const LANES: usize = 16;

/// Most iterations between two looks at whether the caller wants to stop.
const LONGEST: usize = 65_536;

/// Sixteen pixels on their way.
struct Lanes {
    /// Differences of z, real and imaginary parts.
    d: [[f64; LANES]; 2],
    /// Differences of c.
    c: [[f64; LANES]; 2],
    place: [Place; LANES],
    /// Which pixel of the row is here.
    pixel: [Option<usize>; LANES],
}

/// What stays the same for a row.
struct Row<'a> {
    references: &'a References,
    view: &'a DeepView,
    y: usize,
    /// Greatest |z|^2 within the bound, not included.
    limit: f64,
}

/// k of the pixels of a row, and their z after the last iteration.
#[inline(always)]
pub(super) fn leave_row<S: Simd>(
    simd: S,
    references: &References,
    view: &DeepView,
    y: usize,
    found: &mut [Found],
    control: &Control<'_>,
) -> Result<(), Cancelled> {
    let row = Row { references, view, y, limit: square_limit(view.bound) };
    let nothing = [[0.0; LANES]; 2];
    let mut lanes = Lanes { d: nothing, c: nothing, place: [Place::default(); LANES], pixel: [None; LANES] };
    let mut next = 0;
    for lane in 0..LANES {
        row.begin(&mut lanes, lane, &mut next, found);
    }
    while let Some(live) = lanes.pixel.iter().position(Option::is_some) {
        control.check()?;
        lanes.park_empty_lanes(live);
        // The last iteration that all can do without a look at any counter.
        let steps = (0..LANES).filter(|&i| lanes.pixel[i].is_some()).map(|i| row.steps(lanes.place[i]));
        let steps = steps.min().unwrap_or(1).min(LONGEST);
        let small = lanes.small_square(&row);
        let (done, events) = if lanes.place.iter().all(|p| p.n == lanes.place[live].n) {
            burst::<S, true>(simd, &row, &mut lanes, steps, small)
        } else {
            burst::<S, false>(simd, &row, &mut lanes, steps, small)
        };
        for lane in 0..LANES {
            lanes.place[lane].n += done;
            lanes.place[lane].k += done as u32 - 1;
            let place = lanes.place[lane];
            let at_end = place.k == view.iterations || place.n == references.last(place.n);
            if events >> lane & 1 == 0 && !at_end {
                lanes.place[lane].k += 1;
            } else if let Some(x) = lanes.pixel[lane] {
                row.settle(&mut lanes, lane, x, &mut next, found);
            }
        }
    }
    Ok(())
}

impl Lanes {
    fn set(&mut self, lane: usize, d: Complex) {
        (self.d[0][lane], self.d[1][lane]) = (d[0], d[1]);
    }

    /// Lets lanes without a pixel stand where a live one does, at the reference itself.
    fn park_empty_lanes(&mut self, live: usize) {
        for lane in 0..LANES {
            if self.pixel[lane].is_none() {
                self.set(lane, [0.0; 2]);
                (self.c[0][lane], self.c[1][lane]) = (0.0, 0.0);
                self.place[lane] = Place { k: 0, ..self.place[live] };
            }
        }
    }

    /// The largest square of a difference that is small for one of the pixels.
    fn small_square(&self, row: &Row<'_>) -> f64 {
        let of = |x: &usize| small_square(row.dc(*x));
        self.pixel.iter().flatten().map(of).fold(0.0, f64::max)
    }
}

impl Row<'_> {
    fn dc(&self, x: usize) -> WideComplex {
        self.references.begin(self.view.difference(x, self.y)).1
    }

    /// Iterations until a pixel comes to the end of its reference, or has done all.
    fn steps(&self, place: Place) -> usize {
        let to_end = self.references.last(place.n) - place.n;
        to_end.min((self.view.iterations - place.k) as usize + 1)
    }

    /// Puts the next pixels of the row into a lane, until one has not left while its difference was small.
    fn begin(&self, lanes: &mut Lanes, lane: usize, next: &mut usize, found: &mut [Found]) {
        lanes.pixel[lane] = None;
        while lanes.pixel[lane].is_none() && *next < found.len() {
            let x = *next;
            *next += 1;
            let (d, _) = self.references.begin(self.view.difference(x, self.y));
            lanes.place[lane] = Place::default();
            self.grow(lanes, lane, x, d, found);
        }
    }

    /// Puts a pixel into a lane, after its difference has grown if it is small. If it leaves before that the
    /// lane stays empty.
    fn grow(&self, lanes: &mut Lanes, lane: usize, x: usize, mut d: WideComplex, found: &mut [Found]) {
        let dc = self.dc(x);
        lanes.pixel[lane] = None;
        if d.exponent().max(dc.exponent()) < GROWN {
            match self.references.iterate_small(self.view, &mut lanes.place[lane], d, dc) {
                (Pause::Left(z), _) => {
                    found[x] = (lanes.place[lane].k, z);
                    return;
                }
                (Pause::Changed, grown) => d = grown,
            }
        }
        lanes.set(lane, d.to_f64());
        let dc = dc.to_f64();
        (lanes.c[0][lane], lanes.c[1][lane]) = (dc[0], dc[1]);
        lanes.pixel[lane] = Some(x);
    }

    /// Ends the iteration of a pixel with which something happens.
    fn settle(&self, lanes: &mut Lanes, lane: usize, x: usize, next: &mut usize, found: &mut [Found]) {
        let place = &mut lanes.place[lane];
        let mut d = [lanes.d[0][lane], lanes.d[1][lane]];
        let [zx, zy] = self.references.z[place.n];
        let z = [zx + d[0], zy + d[1]];
        let within = square(z) < self.limit;
        if !(within && place.k < self.view.iterations) {
            found[x] = (place.k, z);
            return self.begin(lanes, lane, next, found);
        }
        place.k += 1;
        if square(z) < square(d) || place.n == self.references.last(place.n) {
            (d, place.n) = (z, self.references.critical);
            lanes.set(lane, d);
        }
        if square(d) < small_square(self.dc(x)) {
            self.grow(lanes, lane, x, WideComplex::from_f64(d), found);
            if lanes.pixel[lane].is_none() {
                self.begin(lanes, lane, next, found);
            }
        }
    }
}

/// Iterates all lanes, at most `steps` times, until something happens with one of them. Returns how often,
/// and as bits which lanes something happens with: |z| has reached the bound, is below the difference, or the
/// difference is small.
#[inline(always)]
fn burst<S: Simd, const SAME: bool>(
    simd: S,
    row: &Row<'_>,
    lanes: &mut Lanes,
    steps: usize,
    small: f64,
) -> (usize, u64) {
    let from = |numbers: &[f64; LANES]| {
        [f64x8::from_slice(simd, &numbers[..8]), f64x8::from_slice(simd, &numbers[8..])]
    };
    let [mut dx, mut dy] = [from(&lanes.d[0]), from(&lanes.d[1])];
    let [cx, cy] = [from(&lanes.c[0]), from(&lanes.c[1])];
    let (limit, small) = (f64x8::splat(simd, row.limit), f64x8::splat(simd, small));
    let orbits: [&[Complex]; LANES] =
        std::array::from_fn(|i| &row.references.z[lanes.place[i].n..][..=steps]);
    let mut z = beside::<S, SAME>(simd, &orbits, 0);
    let mut events = 0;
    let mut done = 0;
    while done < steps && events == 0 {
        done += 1;
        let next = beside::<S, SAME>(simd, &orbits, done);
        let mut happens: [mask64x8<S>; 2] = [limit.simd_lt(limit); 2];
        for h in 0..2 {
            let [zx, zy] = z[h];
            let (sx, sy) = ((zx + zx) + dx[h], (zy + zy) + dy[h]);
            let x = sx * dx[h] - sy * dy[h] + cx[h];
            let y = sx * dy[h] + sy * dx[h] + cy[h];
            (dx[h], dy[h]) = (x, y);
            let [zx, zy] = [next[h][0] + x, next[h][1] + y];
            let (z_square, d_square) = (zx * zx + zy * zy, x * x + y * y);
            let goes_on = z_square.simd_lt(limit) & d_square.simd_le(z_square);
            happens[h] = !goes_on | d_square.simd_lt(small);
        }
        if (happens[0] | happens[1]).any_true() {
            events = happens[0].to_bitmask() | happens[1].to_bitmask() << 8;
        }
        z = next;
    }
    for (numbers, [low, high]) in lanes.d.iter_mut().zip([dx, dy]) {
        low.store_slice(&mut numbers[..8]);
        high.store_slice(&mut numbers[8..]);
    }
    (done, events)
}

/// Z that the lanes stand beside after `j` iterations.
#[inline(always)]
fn beside<S: Simd, const SAME: bool>(simd: S, orbits: &[&[Complex]; LANES], j: usize) -> [[f64x8<S>; 2]; 2] {
    if SAME {
        let z = orbits[0][j].map(|part| f64x8::splat(simd, part));
        return [z, z];
    }
    let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        [x[i], y[i]] = orbits[i][j];
    }
    let half = |from: usize| {
        [f64x8::from_slice(simd, &x[from..from + 8]), f64x8::from_slice(simd, &y[from..from + 8])]
    };
    [half(0), half(8)]
}
