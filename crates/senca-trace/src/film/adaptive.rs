//! Adaptive supersampling of a whole picture.

use senca_math::Control;

use super::{Area, Exposure, Film, FilmReport, Integrator, Progress, SamplePlace, in_tiles};
use crate::antialias::{AdaptiveSettings, Antialiasing, SquareCache, adaptive_pixel};
use crate::{Pattern, Sampler, TraceError};

/// Share of the progress that the corners of pixels are.
const CORNER_SHARE: u32 = 1;

/// Share of the progress that their inside is.
const INSIDE_SHARE: u32 = 3;

impl Film {
    /// First the corners of all pixels, (w + 1)(h + 1) rays, then what is needed between them.
    pub(super) fn expose_adaptively<I: Integrator>(
        &mut self,
        integrator: &I,
        control: &Control<'_>,
    ) -> Result<FilmReport, TraceError> {
        let mut report = FilmReport::default();
        let Antialiasing::Adaptive(settings) = self.settings.antialiasing else { return Ok(report) };
        if self.samples > 0 {
            return Ok(report);
        }
        let to = CORNER_SHARE + INSIDE_SHARE;
        let progress = Progress { control, from: 0, to, range: 0..CORNER_SHARE, clock: None };
        let corners = self.corners(integrator, &progress, &mut report)?;
        let progress = Progress { control, from: 0, to, range: CORNER_SHARE..to, clock: None };
        self.insides(integrator, &settings, &corners, &progress, &mut report)?;
        self.samples = 1;
        Ok(report)
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
        let done = in_tiles::<I, _>(&tiles, progress, |work, tile| {
            let before = I::counts(work);
            let mut colors = Vec::with_capacity(tile.pixels());
            for (x, y) in tile.places() {
                if progress.control.is_cancelled() {
                    return None;
                }
                colors.push(integrator.sample(&self.place([x, y], [0, 0], 1), work));
            }
            Some((colors, I::counts(work).since(&before)))
        })?;
        let mut corners = vec![[0.0; 4]; grid.pixels()];
        for (tile, (colors, counts)) in tiles.iter().zip(done) {
            for ((x, y), color) in tile.places().zip(colors) {
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
        // The same place has the same random numbers, whichever pixel asks.
        let [u, v] = [0, 1].map(|k| pixel[k].wrapping_mul(256) + at[k] * (256 / cells));
        let mut sampler = Sampler::new(Pattern::Sobol, self.settings.seed, u, v, 0);
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
        let done = in_tiles::<I, _>(&tiles, progress, |work, tile| {
            let before = I::counts(work);
            let mut cache = SquareCache::default();
            let mut exposures = Vec::with_capacity(tile.pixels());
            for (x, y) in tile.places() {
                if progress.control.is_cancelled() {
                    return None;
                }
                cache.begin(cells);
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    cache.set(dx * cells, dy * cells, corners[grid.index(x + dx, y + dy)]);
                }
                let mut count = 4;
                let sum = adaptive_pixel(settings, &mut cache, &mut |u, v| {
                    count += 1;
                    integrator.sample(&self.place([x, y], [u, v], cells), work)
                });
                exposures.push(Exposure { sum, weight: 1.0, count });
            }
            Some((exposures, I::counts(work).since(&before)))
        })?;
        for (tile, (exposures, counts)) in tiles.iter().zip(done) {
            for ((x, y), exposure) in tile.places().zip(exposures) {
                report.samples += u64::from(exposure.count - 4);
                self.sums[area.index(x, y)] = exposure;
            }
            report.counts += counts;
        }
        Ok(())
    }
}
