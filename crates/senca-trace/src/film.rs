//! The film: what gathers samples into a picture.
//!
//! Pixels are taken tile by tile, tiles by all threads, samples of a pixel always in the same order,
//! so the picture is the same for any number of threads. A film may be exposed in several goes
//! ([`Film::expose`] with more and more samples): it keeps sums, and the sum of two goes is that of
//! one. It can be written to a file in between and read again.

mod adaptive;
mod saved;
#[cfg(test)]
mod tests;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use senca_math::glam::DVec2;
use senca_math::{Control, Image};

use crate::antialias::{Antialiasing, Places, SquareCache};
use crate::{Pattern, Sampler, TraceCounts, TraceError};

pub use saved::{Fingerprint, SavedFilmError};

/// Side of a tile in pixels.
const TILE: u32 = 32;

/// Where a sample lies.
#[derive(Clone, Copy, Debug)]
pub struct SamplePlace {
    /// Pixels from the left edge of the picture.
    pub x: f64,
    /// Pixels from its upper edge.
    pub y: f64,
    /// Row of the pixel it belongs to.
    pub row: u32,
    /// Where its random numbers come from. The first dimension is the place in the pixel.
    pub sampler: Sampler,
}

/// What finds the light at places of the picture. Shared by all threads.
pub trait Integrator: Sync {
    /// What a thread keeps from one sample to the next.
    type Work: Default + Send;

    /// Red, green and blue times the share of the place that is covered, and that share.
    fn sample(&self, place: &SamplePlace, work: &mut Self::Work) -> [f32; 4];

    /// [`Integrator::sample`] for many places: `out` gets one result more for each, in their order.
    fn sample_many(&self, places: &[SamplePlace], work: &mut Self::Work, out: &mut Vec<[f32; 4]>) {
        out.extend(places.iter().map(|place| self.sample(place, work)));
    }

    /// What was done with `work` so far.
    fn counts(work: &Self::Work) -> TraceCounts;
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// First column.
    pub x: u32,
    /// First row from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Area {
    fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Tiles that cover it, row by row.
    fn tiles(&self) -> Vec<Self> {
        let starts = |length: u32| (0..length.div_ceil(TILE)).map(|i| i * TILE);
        let tile = |x: u32, y: u32| Self {
            x: self.x + x,
            y: self.y + y,
            width: TILE.min(self.width - x),
            height: TILE.min(self.height - y),
        };
        starts(self.height).flat_map(|y| starts(self.width).map(move |x| tile(x, y))).collect()
    }

    /// Columns and rows of the pixels of a tile, so that those that follow each other are near each other
    /// both ways: square by square (Morton 1966).
    fn places_in_squares(self) -> impl Iterator<Item = (u32, u32)> {
        let inside = IN_SQUARES.iter().filter(move |place| self.has(**place));
        inside.map(move |&[x, y]| (self.x + u32::from(x), self.y + u32::from(y)))
    }

    /// Whether a tile has a pixel in this column and row of itself.
    fn has(&self, [x, y]: [u8; 2]) -> bool {
        u32::from(x) < self.width && u32::from(y) < self.height
    }

    /// Number of a pixel of this area.
    fn index(&self, x: u32, y: u32) -> usize {
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }
}

/// Columns and rows of a tile's pixels, square by square.
const IN_SQUARES: [[u8; 2]; (TILE * TILE) as usize] = {
    let mut places = [[0; 2]; (TILE * TILE) as usize];
    let mut i = 0;
    while i < TILE * TILE {
        places[i as usize] = [every_second_bit(i) as u8, every_second_bit(i >> 1) as u8];
        i += 1;
    }
    places
};

const _: () = assert!(TILE.is_power_of_two() && TILE <= 256);

/// The number that bits 0, 2, 4, ... make.
const fn every_second_bit(i: u32) -> u32 {
    let i = i & 0x5555_5555;
    let i = (i | (i >> 1)) & 0x3333_3333;
    let i = (i | (i >> 2)) & 0x0f0f_0f0f;
    let i = (i | (i >> 4)) & 0x00ff_00ff;
    (i | (i >> 8)) & 0xffff
}

/// What a film is made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The part of it on this film; it lies inside.
    pub area: Area,
    /// How pixels are sampled.
    pub antialiasing: Antialiasing,
    /// Seed of random numbers.
    pub seed: u64,
}

/// Sums of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    settings: FilmSettings,
    /// Sum of colours times alpha, and of alpha, per pixel of the area.
    sums: Vec<[f32; 4]>,
    /// Weight and number of the samples of each pixel. Empty where all pixels have the same, of weight 1.
    tallies: Vec<Tally>,
    /// Samples that every pixel has, or passes of adaptive supersampling.
    samples: u32,
}

/// Sum of weights, and number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tally {
    weight: f32,
    count: u32,
}

/// What a pixel has gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Exposure {
    sum: [f32; 4],
    tally: Tally,
}

impl Tally {
    /// One more pass of adaptive supersampling, which has added one mean of weight 1.
    fn add_pass(&mut self, pass: Self) {
        self.weight += pass.weight;
        self.count = self.count.saturating_add(pass.count);
    }

    /// What sums are divided by; `None` without samples.
    fn divisor(self) -> Option<f32> {
        // With a filter that is negative in places, few samples may cancel.
        let weight = if self.weight.abs() < 0.25 { self.count as f32 } else { self.weight };
        (self.count > 0).then_some(weight)
    }
}

/// The caller's hold on an exposure, beyond [`Control`].
#[derive(Default)]
pub struct Watch<'a> {
    /// Time after which no further pass is begun. One pass is always made. Default: none, and all
    /// samples are taken in one pass.
    pub time_limit: Option<Duration>,
    /// Called between passes, at most every [`Watch::SAVE_EVERY`], and at the end.
    pub save: Option<&'a mut dyn FnMut(&Film)>,
}

impl Watch<'_> {
    /// Time between two calls of [`Watch::save`].
    pub const SAVE_EVERY: Duration = Duration::from_secs(10);
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("time_limit", &self.time_limit).finish_non_exhaustive()
    }
}

/// What an exposure took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmReport {
    /// Rays and tests of this exposure.
    pub counts: TraceCounts,
    /// Samples of this exposure, over all pixels.
    pub samples: u64,
    /// Samples of each pixel on the film; of adaptive supersampling, the mean, rounded.
    pub samples_per_pixel: u32,
    /// Seconds.
    pub seconds: f64,
}

impl Film {
    /// An unexposed film.
    ///
    /// # Errors
    /// [`TraceError::Setting`] when the way of sampling is out of its range.
    pub fn new(settings: &FilmSettings) -> Result<Self, TraceError> {
        settings.antialiasing.check()?;
        let pixels = settings.area.pixels();
        let is_uneven =
            matches!(settings.antialiasing, Antialiasing::Adaptive(_) | Antialiasing::Filtered { .. });
        let tallies = vec![Tally::default(); if is_uneven { pixels } else { 0 }];
        // Written and not only reserved: the system hands the pages over now, and not to threads that trace.
        let mut sums = Vec::with_capacity(pixels);
        sums.resize_with(pixels, || [0.0; 4]);
        Ok(Self { settings: *settings, sums, tallies, samples: 0 })
    }

    /// Weight and number of the samples of a pixel.
    fn tally(&self, pixel: usize) -> Tally {
        let same = Tally { weight: self.samples as f32, count: self.samples };
        self.tallies.get(pixel).copied().unwrap_or(same)
    }

    /// What it is made for.
    #[must_use]
    pub fn settings(&self) -> &FilmSettings {
        &self.settings
    }

    /// Samples that every pixel has so far; of adaptive supersampling, its passes so far.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Takes samples until every pixel has those that the settings ask for, or time is up.
    ///
    /// # Errors
    /// [`TraceError::Cancelled`]; the film then holds the passes that were finished.
    pub fn expose<I: Integrator>(
        &mut self,
        integrator: &I,
        watch: &mut Watch<'_>,
        control: &Control<'_>,
    ) -> Result<FilmReport, TraceError> {
        self.expose_up_to(u32::MAX, integrator, watch, control)
    }

    /// [`Film::expose`], but to no more than `most` samples of every pixel, or adaptive passes: for scenes
    /// that move in between.
    ///
    /// # Errors
    /// As [`Film::expose`].
    pub fn expose_up_to<I: Integrator>(
        &mut self,
        most: u32,
        integrator: &I,
        watch: &mut Watch<'_>,
        control: &Control<'_>,
    ) -> Result<FilmReport, TraceError> {
        let start = Instant::now();
        let exposed = match Places::of(&self.settings.antialiasing) {
            Some(places) => self.expose_in_passes(most, integrator, &places, watch, control),
            None => self.expose_adaptively(most, integrator, watch, control),
        };
        // After a cancel, too: the passes that were finished are worth keeping.
        if let Some(save) = &mut watch.save {
            save(self);
        }
        let mut report = exposed?;
        let taken = match self.tallies.as_slice() {
            [] => u64::from(self.samples) * self.sums.len() as u64,
            tallies => tallies.iter().map(|tally| u64::from(tally.count)).sum(),
        };
        let pixels = self.sums.len().max(1) as u64;
        report.samples_per_pixel = ((taken + pixels / 2) / pixels) as u32;
        report.seconds = start.elapsed().as_secs_f64();
        control.report(1.0);
        Ok(report)
    }

    /// All samples at once, or one after the other where the caller wants to interrupt.
    fn expose_in_passes<I: Integrator>(
        &mut self,
        most: u32,
        integrator: &I,
        places: &Places,
        watch: &mut Watch<'_>,
        control: &Control<'_>,
    ) -> Result<FilmReport, TraceError> {
        let (start, mut saved) = (Instant::now(), Instant::now());
        let wanted = self.settings.antialiasing.samples().min(most);
        let first = self.samples;
        let step = if watch.time_limit.is_some() || watch.save.is_some() { 1 } else { wanted };
        let mut report = FilmReport::default();
        while self.samples < wanted {
            let range = self.samples..wanted.min(self.samples + step);
            let clock = watch.time_limit.map(|limit| (start, limit));
            let progress = Progress { control, from: first, to: wanted, range: range.clone(), clock };
            self.expose_pass(integrator, places, range, &progress, &mut report)?;
            if watch.time_limit.is_some_and(|limit| start.elapsed() >= limit) {
                break;
            }
            if let Some(save) = watch.save.as_mut().filter(|_| saved.elapsed() >= Watch::SAVE_EVERY) {
                save(self);
                saved = Instant::now();
            }
        }
        Ok(report)
    }

    /// The samples of one range of numbers, of all pixels.
    fn expose_pass<I: Integrator>(
        &mut self,
        integrator: &I,
        places: &Places,
        range: std::ops::Range<u32>,
        progress: &Progress<'_>,
        report: &mut FilmReport,
    ) -> Result<(), TraceError> {
        let area = self.settings.area;
        let is_fresh = self.samples == 0;
        let before = (!is_fresh).then(|| (self.sums.clone(), self.tallies.clone()));
        let sampler = Sampler::of_seed(Pattern::Sobol, self.settings.seed);
        let even: Vec<DVec2> = range.clone().map_while(|sample| places.even(sample)).collect();
        let samples = Samples { places, even: &even, range: range.clone(), sampler };
        let work_on = |bench: &mut Bench<I>, (tile, mut part): (Area, TilePart<'_>)| {
            let Bench { work, batch, plate, pixels, .. } = bench;
            let before = I::counts(work);
            part.load(is_fresh, plate);
            pixels.clear();
            if tile.width == TILE && tile.height == TILE {
                pixels.extend_from_slice(&IN_SQUARES);
            } else {
                pixels.extend(IN_SQUARES.iter().filter(|place| tile.has(**place)));
            }
            let at_once = (Batch::MOST / range.len().max(1)).max(1);
            for pixels in pixels.chunks(at_once) {
                let mut rest = samples.clone();
                while let Some(samples) = rest.next_part(Batch::MOST) {
                    batch.fill(tile, pixels, &samples);
                    batch.develop(integrator, work, progress.control)?;
                    batch.add_to(plate, tile, pixels);
                }
            }
            part.store(plate);
            Some(I::counts(work).since(&before))
        };
        let tiles = area.tiles();
        let parts = tile_parts(&area, tiles.len(), &mut self.sums, &mut self.tallies);
        let tiles: Vec<_> = tiles.into_iter().zip(parts).collect();
        let done = in_tiles::<I, _, _>(tiles, progress, work_on);
        if done.is_err() {
            self.undo(before);
        }
        for counts in done? {
            report.counts += counts;
        }
        report.samples += u64::from(range.end - range.start) * area.pixels() as u64;
        self.samples = range.end;
        Ok(())
    }

    /// Forgets a pass of which some tiles were finished; without a film `before` it was the first.
    fn undo(&mut self, before: Option<(Vec<[f32; 4]>, Vec<Tally>)>) {
        if let Some(before) = before {
            (self.sums, self.tallies) = before;
        } else {
            self.sums.fill([0.0; 4]);
            self.tallies.fill(Tally::default());
        }
    }

    /// The picture so far, of the size of the film's area. With `transparent`, colours are divided by
    /// alpha where something shows through, as [`Image`] wants them.
    #[must_use]
    pub fn develop(&self, transparent: bool) -> Image {
        self.clone().into_image(transparent)
    }

    /// [`Film::develop`] for a film that is needed no more, which becomes the picture.
    #[must_use]
    pub fn into_image(self, transparent: bool) -> Image {
        let same = self.tally(usize::MAX).divisor();
        let Area { width, height, .. } = self.settings.area;
        let mut pixels = self.sums;
        let is_done = self.tallies.is_empty() && same == Some(1.0) && !transparent;
        if !is_done {
            for (number, pixel) in pixels.iter_mut().enumerate() {
                let divisor = self.tallies.get(number).map_or(same, |tally| tally.divisor());
                let [r, g, b, a] = divisor.map_or([0.0; 4], |divisor| pixel.map(|v| v / divisor));
                let divides = transparent && a > 0.0 && a < 1.0;
                *pixel = if divides { [r / a, g / a, b / a, a] } else { [r, g, b, a] };
            }
        }
        // A film has as many sums as its area has pixels.
        Image::from_pixels(width, height, pixels).unwrap_or_else(|| Image::new(0, 0, [0.0; 4]))
    }

    /// How many samples each pixel has, as a picture: black for none, white for `most`.
    #[must_use]
    pub fn samples_map(&self) -> Image {
        let Area { width, height, .. } = self.settings.area;
        let count = |pixel: usize| self.tally(pixel).count;
        let most = (0..self.sums.len()).map(count).max().unwrap_or(0).max(1) as f32;
        let mut image = Image::new(width, height, [0.0; 4]);
        for (number, pixel) in image.pixels_mut().iter_mut().enumerate() {
            let share = count(number) as f32 / most;
            *pixel = [share, share, share, 1.0];
        }
        image
    }
}

/// What a thread keeps from tile to tile.
struct Bench<I: Integrator> {
    work: I::Work,
    batch: Batch,
    plate: Plate,
    /// Columns and rows of the pixels of the tile, square by square.
    pixels: Vec<[u8; 2]>,
    /// Of adaptive supersampling.
    caches: Vec<SquareCache>,
}

impl<I: Integrator> Default for Bench<I> {
    fn default() -> Self {
        Self {
            work: I::Work::default(),
            batch: Batch::default(),
            plate: Plate::default(),
            pixels: Vec::new(),
            caches: Vec::new(),
        }
    }
}

/// The part of a film that is a tile, row by row.
#[derive(Default)]
struct TilePart<'a> {
    sums: Vec<&'a mut [[f32; 4]]>,
    /// None where all pixels of the film have the same.
    tallies: Vec<&'a mut [Tally]>,
}

/// What the pixels of a tile have gathered.
#[derive(Default)]
struct Plate {
    sums: Vec<[f32; 4]>,
    /// Empty where all pixels of the film have the same.
    tallies: Vec<Tally>,
}

impl Plate {
    #[inline]
    fn add(&mut self, pixel: usize, color: [f32; 4], weight: f32) {
        for (sum, component) in self.sums[pixel].iter_mut().zip(color) {
            *sum += weight * component;
        }
        if let Some(tally) = self.tallies.get_mut(pixel) {
            tally.weight += weight;
            tally.count += 1;
        }
    }
}

impl TilePart<'_> {
    /// What the pixels have; `is_fresh` where that is nothing.
    fn load(&self, is_fresh: bool, plate: &mut Plate) {
        plate.sums.clear();
        plate.tallies.clear();
        if is_fresh {
            plate.sums.resize(self.sums.iter().map(|row| row.len()).sum(), [0.0; 4]);
        } else {
            self.sums.iter().for_each(|row| plate.sums.extend_from_slice(row));
        }
        self.tallies.iter().for_each(|row| plate.tallies.extend_from_slice(row));
    }

    fn store(&mut self, plate: &Plate) {
        let (mut sums, mut tallies) = (plate.sums.as_slice(), plate.tallies.as_slice());
        for row in &mut self.sums {
            let (own, others) = sums.split_at(row.len());
            row.copy_from_slice(own);
            sums = others;
        }
        for row in &mut self.tallies {
            let (own, others) = tallies.split_at(row.len());
            row.copy_from_slice(own);
            tallies = others;
        }
    }
}

/// The parts of a film of `area` for each of its tiles.
fn tile_parts<'a>(
    area: &Area,
    tiles: usize,
    sums: &'a mut [[f32; 4]],
    tallies: &'a mut [Tally],
) -> Vec<TilePart<'a>> {
    let mut parts: Vec<TilePart<'a>> = Vec::new();
    let part = || TilePart { sums: Vec::with_capacity(TILE as usize), tallies: Vec::new() };
    parts.resize_with(tiles, part);
    let width = area.width.max(1) as usize;
    let columns = width.div_ceil(TILE as usize);
    let tile = |row: usize, column: usize| row / TILE as usize * columns + column;
    for (y, row) in sums.chunks_mut(width).enumerate() {
        for (column, part) in row.chunks_mut(TILE as usize).enumerate() {
            parts[tile(y, column)].sums.push(part);
        }
    }
    for (y, row) in tallies.chunks_mut(width).enumerate() {
        for (column, part) in row.chunks_mut(TILE as usize).enumerate() {
            parts[tile(y, column)].tallies.push(part);
        }
    }
    parts
}

/// Samples of each pixel.
#[derive(Clone)]
struct Samples<'a> {
    places: &'a Places,
    /// Place of each, where those are the same in all pixels; else nothing.
    even: &'a [DVec2],
    range: std::ops::Range<u32>,
    /// Of the seed.
    sampler: Sampler,
}

impl Samples<'_> {
    /// The next of them, at most `most`; `None` when there are no more.
    fn next_part(&mut self, most: usize) -> Option<Self> {
        if self.range.is_empty() {
            return None;
        }
        let count = most.min(self.range.len());
        let middle = self.range.start + count as u32;
        let (even, others) = self.even.split_at(count.min(self.even.len()));
        let part = Self { even, range: self.range.start..middle, ..*self };
        (self.even, self.range.start) = (others, middle);
        Some(part)
    }
}

/// Samples that are taken together: some of each of some pixels, pixel by pixel.
#[derive(Debug, Default)]
struct Batch {
    places: Vec<SamplePlace>,
    /// Where not all are 1.
    weights: Vec<f32>,
    colors: Vec<[f32; 4]>,
}

impl Batch {
    /// Samples at most.
    const MOST: usize = 1024;

    /// Goes to the samples of these pixels of a tile.
    fn fill(&mut self, tile: Area, pixels: &[[u8; 2]], samples: &Samples<'_>) {
        self.places.clear();
        self.weights.clear();
        let Samples { places, even, range, sampler } = samples;
        let pixels = pixels.iter().map(|&[x, y]| (tile.x + u32::from(x), tile.y + u32::from(y)));
        let place = |(x, y): (u32, u32), within: DVec2, sampler| SamplePlace {
            x: f64::from(x) + within.x,
            y: f64::from(y) + within.y,
            row: y,
            sampler,
        };
        if let [within] = even {
            // Written out, since most pictures are taken so: no sampler is asked, and none is kept in memory.
            let at = |(x, y)| place((x, y), *within, sampler.in_pixel(x, y, range.start));
            return self.places.extend(pixels.map(at));
        }
        for (x, y) in pixels {
            for (number, sample) in range.clone().enumerate() {
                let sampler = sampler.in_pixel(x, y, sample);
                if let Some(within) = even.get(number) {
                    self.places.push(place((x, y), *within, sampler));
                } else {
                    let mut sampler = sampler;
                    let (within, weight) = places.place(sample, &mut sampler);
                    self.places.push(place((x, y), within, sampler));
                    self.weights.push(weight);
                }
            }
        }
    }

    /// Takes the samples; `None` when the caller asked to stop.
    fn develop<I: Integrator>(
        &mut self,
        integrator: &I,
        work: &mut I::Work,
        control: &Control<'_>,
    ) -> Option<()> {
        if control.is_cancelled() {
            return None;
        }
        self.colors.clear();
        integrator.sample_many(&self.places, work, &mut self.colors);
        Some(())
    }

    /// Adds the samples to their pixels, in order.
    fn add_to(&self, plate: &mut Plate, tile: Area, pixels: &[[u8; 2]]) {
        let of_each = self.colors.len() / pixels.len().max(1);
        let mut weights = self.weights.iter();
        for (&[x, y], colors) in pixels.iter().zip(self.colors.chunks_exact(of_each.max(1))) {
            let pixel = usize::from(y) * tile.width as usize + usize::from(x);
            for &color in colors {
                plate.add(pixel, color, weights.next().copied().unwrap_or(1.0));
            }
        }
    }
}

/// Tells the caller how far the work has come.
struct Progress<'a> {
    control: &'a Control<'a>,
    /// Samples at the start and the end of all passes.
    from: u32,
    to: u32,
    /// Samples of this pass.
    range: std::ops::Range<u32>,
    /// When the exposure began, and how long it may take.
    clock: Option<(Instant, Duration)>,
}

impl Progress<'_> {
    /// A share of this pass is done.
    fn report(&self, share: f32) {
        let all = (self.to - self.from).max(1) as f32;
        let before = (self.range.start - self.from) as f32;
        let own = (self.range.end - self.range.start) as f32;
        let of_samples = (before + share * own) / all;
        let of_time = self.clock.map_or(0.0, |(start, limit)| {
            start.elapsed().as_secs_f32() / limit.as_secs_f32().max(f32::MIN_POSITIVE)
        });
        // What is used up first ends the exposure. Both only grow.
        self.control.report(of_samples.max(of_time.min(1.0)));
    }
}

/// Runs `work` for every tile on all threads; results are in the order of tiles.
fn in_tiles<I: Integrator, D: Send, T: Send>(
    tiles: Vec<D>,
    progress: &Progress<'_>,
    work: impl Fn(&mut Bench<I>, D) -> Option<T> + Sync,
) -> Result<Vec<T>, TraceError> {
    let count = tiles.len();
    // Benches are big: what allocates one for each tile waits for fresh memory more than it traces.
    let benches: Mutex<Vec<Box<Bench<I>>>> = Mutex::default();
    let done = Mutex::new(0usize);
    let results: Option<Vec<T>> = tiles
        .into_par_iter()
        .with_max_len(1)
        .map(|tile| {
            let free = locked(&benches).pop();
            let mut bench = free.unwrap_or_default();
            let result = work(&mut bench, tile)?;
            locked(&benches).push(bench);
            let mut done = locked(&done);
            *done += 1;
            progress.report(*done as f32 / count as f32);
            Some(result)
        })
        .collect();
    results.ok_or(TraceError::Cancelled)
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
