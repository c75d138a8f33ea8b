//! The tiled rasterizer: project, bin, then draw tile by tile on as many threads as wanted.

use crate::api::{Compare, Counters, Primitives, Rasterizer, Shading, State};
use crate::assemble::{TriangleVaryings, varyings_of, vertex_count};
use crate::bin::{BinInput, RUN, Reference, Run, TILE};
use crate::cover::{ColorPath, FragmentCounts, Pass, TileDraw};
use crate::setup::{Bounds, ScreenMap, ScreenVertex, SetupState, double_area};
use crate::target::{Clear, Target};
use crate::tile::{Band, ColorFormat, TileBuffer, bands};
use fearless_simd::{Level, Simd, dispatch};
use std::sync::Mutex;

/// How a [`TiledRasterizer`] works. None of it changes a picture.
#[derive(Clone, Copy, Debug)]
pub struct TiledSettings {
    /// Parts the work is divided into; they run on the current rayon pool. 0, the default: as many as
    /// the pool has threads. 1: all on the calling thread.
    pub threads: usize,
    /// Vector instructions used. Default: the best of this machine.
    pub level: Level,
}

impl Default for TiledSettings {
    fn default() -> Self {
        Self { threads: 0, level: Level::new() }
    }
}

/// The fast rasterizer. Keep one and draw with it often: its scratch memory is reused.
#[derive(Debug, Default)]
pub struct TiledRasterizer {
    settings: TiledSettings,
    vertices: Vec<ScreenVertex>,
    runs: Vec<Run>,
    buffers: Vec<TileBuffer>,
}

impl TiledRasterizer {
    /// A rasterizer with settings.
    #[must_use]
    pub fn new(settings: TiledSettings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> TiledSettings {
        self.settings
    }

    fn threads(&self) -> usize {
        match self.settings.threads {
            0 => rayon::current_num_threads(),
            n => n,
        }
    }
}

impl Rasterizer for TiledRasterizer {
    fn draw(
        &mut self,
        target: &mut Target<'_>,
        triangles: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        let map = ScreenMap::new(target.width, target.height, state);
        let mut clear = state.clear;
        if state.scissor.is_some() {
            crate::pixel::clear_in_scissor(target, state);
            clear = None;
        }
        let threads = self.threads();
        let tiles = [target.width as usize, target.height as usize].map(|n| n.div_ceil(TILE));
        let first_vertex = self.project(triangles, &map, threads);
        let input = BinInput {
            primitives: triangles,
            vertices: &self.vertices,
            first_vertex,
            map: &map,
            cull: state.cull,
            interpolation: state.interpolation,
            tiles,
        };
        let count = triangles.indices.len() / 3;
        let runs = count.div_ceil(RUN);
        if self.runs.len() < runs {
            self.runs.resize_with(runs, Run::default);
        }
        let jobs = self.runs[..runs].iter_mut().enumerate();
        let filled = share(threads, jobs.collect(), |(k, run): (usize, &mut Run)| {
            run.fill(&input, k * RUN..((k + 1) * RUN).min(count));
            run.counters
        });
        let mut counters = Counters::default();
        filled.into_iter().for_each(|c| counters += c);
        let pass = Pass {
            map: &map,
            state,
            setup: SetupState::new(state),
            shading,
            clear,
            format: ColorFormat::of(target),
            has_depth: target.depth.is_some(),
            has_ids: target.ids.is_some(),
            writes_depth: target.depth.is_some() && state.depth_write,
            hides_farther: target.depth.is_some()
                && matches!(state.depth_test, Compare::Less | Compare::LessEqual),
            color: ColorPath::of(shading, ColorFormat::of(target), triangles.stride),
            interpolation: state.interpolation,
        };
        let frame = Frame { input: &input, runs: &self.runs[..runs], pass: &pass };
        for c in frame.draw(target, threads, &mut self.buffers, self.settings.level) {
            counters.tested += c.tested;
            counters.passed += c.passed;
            counters.shaded += c.shaded;
        }
        counters
    }

    fn draw_lines(
        &mut self,
        target: &mut Target<'_>,
        lines: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        crate::lines::draw_lines(target, lines, state, shading)
    }

    fn draw_points(
        &mut self,
        target: &mut Target<'_>,
        points: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        crate::lines::draw_points(target, points, state, shading)
    }
}

impl TiledRasterizer {
    /// Projects the vertices the indices refer to; returns the number of the first.
    fn project(&mut self, p: &Primitives<'_>, map: &ScreenMap, threads: usize) -> usize {
        let count = vertex_count(p);
        let (first, last) = p.indices.iter().fold((u32::MAX, 0), |(a, b), &i| (a.min(i), b.max(i)));
        let end = (last as usize + 1).min(count);
        let first = (first as usize).min(end);
        let positions = &p.positions[first..end];
        self.vertices.clear();
        self.vertices.resize(positions.len(), ScreenVertex::default());
        let jobs = positions.chunks(RUN).zip(self.vertices.chunks_mut(RUN)).collect();
        share(threads, jobs, |(from, to): (&[_], &mut [ScreenVertex])| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = map.project(*from);
            }
        });
        first
    }
}

/// Everything the tiles are drawn from.
struct Frame<'a> {
    input: &'a BinInput<'a>,
    runs: &'a [Run],
    pass: &'a Pass<'a>,
}

impl Frame<'_> {
    fn draw(
        &self,
        target: &mut Target<'_>,
        threads: usize,
        buffers: &mut Vec<TileBuffer>,
        level: Level,
    ) -> Vec<FragmentCounts> {
        let columns = self.input.tiles[0];
        let mut work: Vec<_> = bands(target)
            .into_iter()
            .map(|band| {
                let tiles = band.row * columns..(band.row + 1) * columns;
                (self.runs.iter().map(|r| r.work(tiles.clone())).sum::<u64>(), band)
            })
            .filter(|(references, _)| *references > 0 || self.pass.clear.is_some())
            .collect();
        work.sort_by_key(|w| std::cmp::Reverse(w.0));
        let spare = Mutex::new(std::mem::take(buffers));
        let counts = share(threads, work, |(_, mut band)| {
            let mut buffer = lock(&spare).pop().unwrap_or_default();
            let counts = dispatch!(level, simd => self.draw_band(simd, &mut band, &mut buffer));
            lock(&spare).push(buffer);
            counts
        });
        *buffers = spare.into_inner().unwrap_or_default();
        counts
    }

    #[inline(always)]
    fn draw_band<S: Simd>(&self, simd: S, band: &mut Band<'_>, buffer: &mut TileBuffer) -> FragmentCounts {
        let mut counts = FragmentCounts::default();
        let mut varyings = TriangleVaryings::default();
        let clear: Option<&Clear> = self.pass.clear.as_ref();
        for column in 0..self.input.tiles[0] {
            let tile = band.row * self.input.tiles[0] + column;
            let (x, y) = (column * TILE, band.row * TILE);
            let whole = Bounds { x0: x as i32, y0: y as i32, x1: (x + TILE) as i32, y1: (y + TILE) as i32 };
            let bounds = whole.intersect(self.pass.map.bounds);
            let mut draw = TileDraw {
                pass: self.pass,
                band,
                buffer,
                x: x as i32,
                y: y as i32,
                bounds,
                partial: bounds != whole,
                counts,
                varyings,
            };
            for run in self.runs {
                self.draw_run(simd, &mut draw, run, tile);
            }
            (counts, varyings) = (draw.counts, draw.varyings);
            buffer.store(band, x, clear, self.pass.writes_depth);
        }
        counts
    }

    #[inline(always)]
    fn draw_run<S: Simd>(&self, simd: S, draw: &mut TileDraw<'_, '_>, run: &Run, tile: usize) {
        let p = self.input.primitives;
        for reference in run.of_tile(tile) {
            let (v, corners, n) = match reference {
                Reference::Triangle(n) => {
                    let index = [p.indices[3 * n], p.indices[3 * n + 1], p.indices[3 * n + 2]];
                    let v = index.map(|i| self.input.vertex(i).unwrap_or_default());
                    (v, index.map(|i| varyings_of(p, i)), n)
                }
                Reference::Piece(k) => {
                    let piece = run.pieces[k];
                    let at =
                        |c: usize| &run.piece_varyings[piece.varyings as usize + c * p.stride..][..p.stride];
                    (piece.v, [at(0), at(1), at(2)], piece.triangle as usize)
                }
            };
            draw.triangle(simd, v, double_area(&v), corners, p.ids.of(n));
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Does all jobs, the first ones first, on `threads` threads; results in no particular order.
fn share<J: Send, R: Send>(threads: usize, jobs: Vec<J>, work: impl Fn(J) -> R + Sync) -> Vec<R> {
    let tasks = threads.min(jobs.len());
    if tasks <= 1 {
        return jobs.into_iter().map(work).collect();
    }
    let (queue, done) = (Mutex::new(jobs.into_iter()), Mutex::new(Vec::new()));
    let run = || {
        loop {
            let job = lock(&queue).next();
            let Some(job) = job else { break };
            let result = work(job);
            lock(&done).push(result);
        }
    };
    rayon::scope(|scope| {
        for _ in 0..tasks {
            scope.spawn(|_| run());
        }
    });
    done.into_inner().unwrap_or_default()
}
