//! Adaptive supersampling of a whole picture.

use std::time::{Duration, Instant};

use senca_math::Control;

use super::{
    Area, Bench, Exposure, Film, FilmReport, Integrator, Progress, SamplePlace, Tally, Watch, in_tiles,
};
use crate::antialias::{AdaptiveSettings, Antialiasing, SquareCache, adaptive_pixel_so_far, even_pixel};
use crate::{Pattern, Sampler, TraceError};

/// Entries of caches that are kept at once.
const CACHED: u32 = 1 << 17;

/// The corners of a pixel, from its place.
const CORNERS: [[u32; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

/// Of a pixel that has the four corners; its sum is the mean already.
const CORNERS_ONLY: Tally = Tally { weight: 1.0, count: 4 };

/// Share of the progress that the corners of pixels are.
const CORNER_SHARE: u32 = 1;

/// Share of the progress that their inside is.
const INSIDE_SHARE: u32 = 3;

impl Film {
    /// One pass after the other, which the caller may interrupt in between.
    pub(super) fn expose_adaptively<I: Integrator>(
        &mut self,
        most: u32,
        integrator: &I,
        watch: &mut Watch<'_>,
        control: &Control<'_>,
    ) -> Result<FilmReport, TraceError> {
        let mut report = FilmReport::default();
        let Antialiasing::Adaptive(settings) = self.settings.antialiasing else { return Ok(report) };
        let (start, mut saved) = (Instant::now(), Instant::now());
        let (first, wanted) = (self.samples, settings.passes.min(most));
        let clock = watch.time_limit.map(|limit| (start, limit));
        while self.samples < wanted {
            self.pass(integrator, &settings, [first, wanted], clock, control, &mut report)?;
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

    /// First the corners of all pixels, (w + 1)(h + 1) rays, then what is needed between them.
    fn pass<I: Integrator>(
        &mut self,
        integrator: &I,
        settings: &AdaptiveSettings,
        [first, wanted]: [u32; 2],
        clock: Option<(Instant, Duration)>,
        control: &Control<'_>,
        report: &mut FilmReport,
    ) -> Result<(), TraceError> {
        let share = |passes: u32| (CORNER_SHARE + INSIDE_SHARE) * passes;
        let (from, to, now) = (share(first), share(wanted), share(self.samples));
        let progress = Progress { control, from, to, range: now..now + CORNER_SHARE, clock };
        let corners = self.corners(integrator, &progress, report)?;
        let range = now + CORNER_SHARE..share(self.samples + 1);
        let progress = Progress { control, from, to, range, clock };
        self.insides(integrator, settings, &corners, &progress, report)?;
        self.samples += 1;
        Ok(())
    }

    /// Colours at the corners of pixels, row by row.
    fn corners<I: Integrator>(
        &self,
        integrator: &I,
        progress: &Progress<'_>,
        report: &mut FilmReport,
    ) -> Result<Vec<[f32; 4]>, TraceError> {
        let area = self.settings.area;
        let grid = Area { width: area.width + 1, height: area.height + 1, ..area };
        let tiles = grid.tiles();
        let done = in_tiles::<I, _, _>(tiles.clone(), progress, |Bench { work, .. }, tile| {
            let before = I::counts(work);
            if progress.control.is_cancelled() {
                return None;
            }
            let places: Vec<_> =
                tile.places_in_squares().map(|(x, y)| self.place([x, y], [0, 0], 1)).collect();
            let mut colors = Vec::with_capacity(places.len());
            integrator.sample_many(&places, work, &mut colors);
            Some((colors, I::counts(work).since(&before)))
        })?;
        let mut corners = vec![[0.0; 4]; grid.pixels()];
        for (tile, (colors, counts)) in tiles.iter().zip(done) {
            for ((x, y), color) in tile.places_in_squares().zip(colors) {
                corners[grid.index(x, y)] = color;
            }
            report.counts += counts;
        }
        report.samples += corners.len() as u64;
        Ok(corners)
    }

    /// The place `at` cells right of and below the corner of a pixel, of `cells` a side.
    fn place(&self, pixel: [u32; 2], at: [u32; 2], cells: u32) -> SamplePlace {
        let [x, y] = [0, 1].map(|k| f64::from(pixel[k]) + f64::from(at[k]) / f64::from(cells));
        let row = pixel[1].min(self.settings.size[1].saturating_sub(1));
        // The same place has the same random numbers in a pass, whichever pixel asks.
        let [u, v] = [0, 1].map(|k| pixel[k].wrapping_mul(256) + at[k] * (256 / cells));
        let mut sampler = Sampler::new(Pattern::Sobol, self.settings.seed, u, v, self.samples);
        sampler.set_dimension(1);
        SamplePlace { x, y, row, sampler }
    }

    /// The colours of all pixels.
    fn insides<I: Integrator>(
        &mut self,
        integrator: &I,
        settings: &AdaptiveSettings,
        corners: &[[f32; 4]],
        progress: &Progress<'_>,
        report: &mut FilmReport,
    ) -> Result<(), TraceError> {
        let area = self.settings.area;
        let grid = Area { width: area.width + 1, height: area.height + 1, ..area };
        let cells = settings.cells();
        let tiles = area.tiles();
        let done = in_tiles::<I, _, _>(tiles.clone(), progress, |Bench { work, caches, .. }, tile| {
            let before = I::counts(work);
            if progress.control.is_cancelled() {
                return None;
            }
            // Most pixels are even, and done with; the numbers and places of the others.
            let mut exposures = Vec::with_capacity(tile.pixels());
            let mut uneven: Vec<(usize, [u32; 2])> = Vec::new();
            for (number, (x, y)) in tile.places_in_squares().enumerate() {
                let corners = CORNERS.map(|[dx, dy]| corners[grid.index(x + dx, y + dy)]);
                let found = even_pixel(settings, &corners);
                if found.is_none() {
                    uneven.push((number, [x, y]));
                }
                exposures.push(Exposure { sum: found.unwrap_or_default(), tally: CORNERS_ONLY });
            }
            for uneven in uneven.chunks((CACHED / (cells + 1).pow(2)).max(1) as usize) {
                let pixels: Vec<[u32; 2]> = uneven.iter().map(|(_, pixel)| *pixel).collect();
                caches.resize(pixels.len().max(caches.len()), SquareCache::default());
                for (&[x, y], cache) in pixels.iter().zip(&mut *caches) {
                    cache.begin(cells);
                    for [dx, dy] in CORNERS {
                        cache.set(dx * cells, dy * cells, corners[grid.index(x + dx, y + dy)]);
                    }
                }
                let take = |places: &[SamplePlace], colors: &mut Vec<[f32; 4]>| {
                    integrator.sample_many(places, work, colors);
                    (!progress.control.is_cancelled()).then_some(())
                };
                let divided = self.divided(settings, &pixels, caches, take)?;
                for ((number, _), exposure) in uneven.iter().zip(divided) {
                    exposures[*number] = exposure;
                }
            }
            Some((exposures, I::counts(work).since(&before)))
        })?;
        for (tile, (exposures, counts)) in tiles.iter().zip(done) {
            for ((x, y), exposure) in tile.places_in_squares().zip(exposures) {
                report.samples += u64::from(exposure.tally.count - 4);
                let pixel = area.index(x, y);
                for (sum, component) in self.sums[pixel].iter_mut().zip(exposure.sum) {
                    *sum += component;
                }
                self.tallies[pixel].add_pass(exposure.tally);
            }
            report.counts += counts;
        }
        Ok(())
    }

    /// The colours of pixels whose corners are in `caches`. `take` takes samples, or nothing when the
    /// caller asked to stop. In every round all squares are divided that can be.
    fn divided(
        &self,
        settings: &AdaptiveSettings,
        pixels: &[[u32; 2]],
        caches: &mut [SquareCache],
        mut take: impl FnMut(&[SamplePlace], &mut Vec<[f32; 4]>) -> Option<()>,
    ) -> Option<Vec<Exposure>> {
        let mut exposures = vec![Exposure { tally: CORNERS_ONLY, ..Exposure::default() }; pixels.len()];
        let mut open: Vec<usize> = (0..pixels.len()).collect();
        let (mut wanted, mut owners) = (Vec::new(), Vec::new());
        let (mut places, mut colors) = (Vec::new(), Vec::new());
        loop {
            open.retain(|&number| {
                let found = adaptive_pixel_so_far(settings, &mut caches[number], &mut wanted);
                for at in wanted.drain(..) {
                    places.push(self.place(pixels[number], at, settings.cells()));
                    owners.push((number, at));
                }
                exposures[number].sum = found.unwrap_or_default();
                found.is_none()
            });
            if open.is_empty() {
                return Some(exposures);
            }
            colors.clear();
            take(&places, &mut colors)?;
            for ((number, [x, y]), &color) in owners.drain(..).zip(&colors) {
                caches[number].set(x, y, color);
                exposures[number].tally.count += 1;
            }
            places.clear();
        }
    }
}
