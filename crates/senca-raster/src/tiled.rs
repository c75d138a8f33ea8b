//! The tiled rasterizer: project, bin, then draw tile by tile on as many threads as wanted.

use crate::api::{
    Compare, Counters, FixedShading, Interpolation, LANES, MAX_VARYINGS, Primitives, Rasterizer, Shading,
    State,
};
use crate::assemble::{varyings_of, vertex_count};
use crate::batch::Batch;
use crate::bin::{BinInput, RUN, Reference, Run, TILE, run_length};
use crate::block_depths::BlockDepths;
use crate::cover::{ColorPath, FragmentCounts, Pass, TileDraw, of_shadow, of_texture, slots};
use crate::filled::is_color_only;
use crate::pixel::{clear_bounds, clear_in_scissor};
use crate::setup::{Bounds, ScreenMap, ScreenVertex, SetupState};
use crate::stage::{StageNeeds, stage_of};
use crate::target::{Clear, Target};
use crate::textured::TextureQueue;
use crate::tile::{Band, ColorFormat, Planes, TileBuffer, Touches, band, bands};
use fearless_simd::{Level, Simd, dispatch};
use std::sync::Mutex;

/// Triangles for which a second thread is worth its while before they are drawn.
const WORTH_SHARING: usize = 512;
/// Triangles, counted once per tile they meet, up to which a draw is done at once on its thread.
const SMALL_REFERENCES: usize = 24;

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

/// One of several draws; see [`TiledRasterizer::draw_all`].
#[derive(Clone, Copy)]
pub struct Draw<'a> {
    /// What is drawn.
    pub triangles: Primitives<'a>,
    /// How.
    pub state: State,
    /// In which colours.
    pub shading: Shading<'a>,
}

/// Triangles of a draw, projected and sorted into tiles. Memory that is used again.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    vertices: Vec<ScreenVertex>,
    /// Number of the first of them.
    first_vertex: usize,
    runs: Vec<Run>,
    /// Runs that belong to the draw.
    count: usize,
}

/// The fast rasterizer. Keep one and draw with it often: its scratch memory is reused.
#[derive(Debug, Default)]
pub struct TiledRasterizer {
    settings: TiledSettings,
    sorted: Vec<Sorted>,
    scratch: Vec<Scratch>,
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

    /// Bytes of scratch memory held: for the largest draw so far, below 100 per triangle with its share
    /// of the vertices, and about 150 000 per thread.
    #[must_use]
    pub fn scratch_bytes(&self) -> usize {
        let per_thread =
            size_of::<Scratch>() + TileBuffer::BYTES + Batch::BOXED_BYTES + TextureQueue::BOXED_BYTES;
        self.sorted.iter().map(Sorted::bytes).sum::<usize>() + self.scratch.len() * per_thread
    }

    /// Draws one after another, as [`Rasterizer::draw`] does, but goes through the target only once:
    /// each tile takes its part of all draws while it is in the cache. Only the first draw of those
    /// that go together clears; a clear of a later one begins anew.
    pub fn draw_all(&mut self, target: &mut Target<'_>, draws: &[Draw<'_>]) -> Counters {
        let mut counters = Counters::default();
        let together =
            |a: &Draw<'_>, b: &Draw<'_>| !a.state.antialias && !b.state.antialias && b.state.clear.is_none();
        for group in draws.chunk_by(together) {
            counters += match group {
                [draw] if draw.state.antialias => {
                    crate::smooth::draw_triangles(target, &draw.triangles, &draw.state, &draw.shading)
                }
                _ => self.draw_group(target, group),
            };
        }
        counters
    }

    /// Does what [`Self::draw_depths`] does, but tile by tile when somebody looks at one, if the first draw and no
    /// other clears: much of a shadow map is never looked at, or need not be, as its bounds tell enough.
    ///
    /// Looking at depths takes its time then, on the threads that do. Memory is held for the triangles until depths are
    /// cleared again.
    pub fn draw_depths_when_read(&mut self, depths: &mut BlockDepths, draws: &[(Primitives<'_>, State)]) {
        let cleared = draws.first().and_then(|(_, state)| state.clear?.depth);
        let Some(clear) = cleared.filter(|_| draws[1..].iter().all(|(_, state)| state.clear.is_none()))
        else {
            self.draw_depths(depths, draws);
            return;
        };
        let size = [depths.width(), depths.height()];
        let tiles = size.map(|n| (n as usize).div_ceil(TILE));
        let draws = depths_alone(draws);
        let maps: Vec<_> = draws.iter().map(|draw| ScreenMap::new(size[0], size[1], &draw.state)).collect();
        let later = depths.begin_later();
        // Memory of the draws before is used again.
        self.sorted.splice(..0, later.take_sorted());
        self.sorted.resize_with(self.sorted.len().max(draws.len()), Sorted::default);
        self.sort(&draws, &maps, tiles, true);
        let states = draws.iter().map(|draw| draw.state);
        let drawn = states.zip(maps).zip(self.sorted.drain(..draws.len()));
        later.begin(
            self.settings.level,
            clear,
            size,
            drawn.map(|((state, map), sorted)| (state, map, sorted)),
        );
    }

    /// Draws triangles that write depths and nothing else into depths kept in blocks: shadow maps. Of the states
    /// only what concerns places and depths is heeded: not stencil tests, blending, antialiasing.
    /// Of those that go together only the first clears, as in [`Self::draw_all`]; a scissor does not confine it.
    pub fn draw_depths(&mut self, depths: &mut BlockDepths, draws: &[(Primitives<'_>, State)]) -> Counters {
        let (width, height) = (depths.width(), depths.height());
        let mut target = Target {
            width,
            height,
            color: None,
            depth: None,
            blocks: Some(depths),
            stencil: None,
            ids: None,
        };
        let mut counters = Counters::default();
        for group in depths_alone(draws).chunk_by(|_, b| b.state.clear.is_none()) {
            counters += self.draw_group(&mut target, group);
        }
        counters
    }

    fn draw_group(&mut self, target: &mut Target<'_>, draws: &[Draw<'_>]) -> Counters {
        let mut clear = draws.first().and_then(|draw| draw.state.clear);
        let mut clear_area = None;
        if let Some(Draw { state, .. }) = draws.first().filter(|_| clear.is_some() && target.blocks.is_none())
        {
            clear_area = Some(clear_bounds(target, state)).filter(|area| *area != target.bounds());
            if clear_area.is_some_and(|area| !has_whole_blocks(&area, target)) {
                clear_in_scissor(target, state);
                (clear, clear_area) = (None, None);
            }
        }
        let tiles = [target.width as usize, target.height as usize].map(|n| n.div_ceil(TILE));
        let map = |draw: &Draw<'_>| ScreenMap::new(target.width, target.height, &draw.state);
        let maps: Vec<ScreenMap> = draws.iter().map(map).collect();
        if self.sorted.len() < draws.len() {
            self.sorted.resize_with(draws.len(), Sorted::default);
        }
        let mut counters = self.sort(draws, &maps, tiles, false);
        let mut parts = Vec::with_capacity(draws.len());
        for ((draw, map), sorted) in draws.iter().zip(&maps).zip(&self.sorted) {
            let planes = Planes::of(target);
            let mut pass = pass(planes, &draw.triangles, &draw.state, &draw.shading, map, clear);
            pass.touches.clear_area = clear_area;
            parts.push(sorted.part(&draw.triangles, map, tiles, pass));
        }
        share_touches(&mut parts, target.blocks.is_some());
        let frame = Frame { tiles, clears: clear.is_some(), parts: &parts };
        let mut add = |c: FragmentCounts| {
            counters.tested += c.tested;
            counters.passed += c.passed;
            counters.shaded += c.shaded;
        };
        let threads = self.settings.threads();
        if frame.is_small() {
            add(frame.draw_small(target, &mut self.scratch, self.settings.level));
        } else {
            let drawn = frame.draw(target, threads, &mut self.scratch, self.settings.level);
            drawn.into_iter().for_each(add);
        }
        counters
    }

    /// Projects the triangles of all draws and sorts them into tiles; `wants_depths` as [`BinInput::wants_depths`].
    fn sort(
        &mut self,
        draws: &[Draw<'_>],
        maps: &[ScreenMap],
        tiles: [usize; 2],
        wants_depths: bool,
    ) -> Counters {
        let threads = self.settings.threads();
        let jobs = draws.iter().zip(maps).zip(&mut self.sorted);
        let triangles: usize = draws.iter().map(|draw| draw.triangles.indices.len() / 3).sum();
        let mut counters = Counters::default();
        if draws.len() > 1 && triangles >= WORTH_SHARING && triangles / draws.len() < RUN {
            // Several of middling size: each on one thread.
            let fill = |((draw, map), sorted): ((&Draw<'_>, &ScreenMap), &mut Sorted)| {
                sorted.fill(draw, map, tiles, wants_depths, 1)
            };
            share(threads, jobs.collect(), fill).into_iter().for_each(|c| counters += c);
        } else {
            jobs.for_each(|((draw, map), sorted)| {
                counters += sorted.fill(draw, map, tiles, wants_depths, threads)
            });
        }
        counters
    }
}

/// Draws of depths and nothing else.
fn depths_alone<'a>(draws: &[(Primitives<'a>, State)]) -> Vec<Draw<'a>> {
    let draw = |(triangles, state): &(Primitives<'a>, State)| Draw {
        triangles: *triangles,
        state: State {
            clear_area: None,
            stencil: None,
            blend: None,
            antialias: false,
            multisample: false,
            ..*state
        },
        shading: Shading::None,
    };
    draws.iter().map(draw).collect()
}

impl TiledSettings {
    fn threads(&self) -> usize {
        match self.threads {
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
        self.draw_all(target, &[Draw { triangles: *triangles, state: *state, shading: *shading }])
    }

    fn threads(&self) -> usize {
        self.settings.threads()
    }

    fn level(&self) -> Level {
        self.settings.level
    }
}

impl Sorted {
    fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<ScreenVertex>() + self.runs.iter().map(Run::bytes).sum::<usize>()
    }

    fn input<'a>(
        &'a self,
        primitives: &'a Primitives<'a>,
        state: &State,
        map: &'a ScreenMap,
        tiles: [usize; 2],
    ) -> BinInput<'a> {
        BinInput {
            primitives,
            vertices: &self.vertices,
            first_vertex: self.first_vertex,
            map,
            cull: state.cull,
            interpolation: state.interpolation,
            tiles,
            wants_depths: false,
        }
    }

    /// The draw, ready to be drawn tile by tile.
    pub(crate) fn part<'a>(
        &'a self,
        primitives: &'a Primitives<'a>,
        map: &'a ScreenMap,
        tiles: [usize; 2],
        pass: Pass<'a>,
    ) -> Part<'a> {
        Part { input: self.input(primitives, pass.state, map, tiles), runs: self.runs(), pass }
    }

    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs[..self.count]
    }

    /// Projects the triangles of a draw and sorts them into tiles, on `threads` threads.
    fn fill(
        &mut self,
        draw: &Draw<'_>,
        map: &ScreenMap,
        tiles: [usize; 2],
        wants_depths: bool,
        threads: usize,
    ) -> Counters {
        self.project(&draw.triangles, map, threads);
        let count = draw.triangles.indices.len() / 3;
        let length = run_length(tiles);
        self.count = count.div_ceil(length);
        let mut runs = std::mem::take(&mut self.runs);
        if runs.len() < self.count {
            runs.resize_with(self.count, Run::default);
        }
        let input = self.input(&draw.triangles, &draw.state, map, tiles);
        let input = BinInput { wants_depths, ..input };
        let jobs = runs[..self.count].iter_mut().enumerate();
        let filled = share(threads, jobs.collect(), |(k, run): (usize, &mut Run)| {
            run.fill(&input, k * length..((k + 1) * length).min(count));
            run.counters
        });
        self.runs = runs;
        let mut counters = Counters::default();
        filled.into_iter().for_each(|c| counters += c);
        counters
    }

    /// Projects the vertices the indices refer to.
    fn project(&mut self, p: &Primitives<'_>, map: &ScreenMap, threads: usize) {
        let count = vertex_count(p);
        let first = p.indices.iter().fold(u32::MAX, |a, &i| a.min(i));
        let last = p.indices.iter().fold(0, |a, &i| a.max(i));
        let end = (last as usize + 1).min(count);
        self.first_vertex = (first as usize).min(end);
        let positions = &p.positions[self.first_vertex..end];
        self.vertices.resize(positions.len(), ScreenVertex::default());
        if positions.len() <= RUN {
            for (to, from) in self.vertices.iter_mut().zip(positions) {
                *to = map.project(*from);
            }
            return;
        }
        let jobs = positions.chunks(RUN).zip(self.vertices.chunks_mut(RUN)).collect();
        share(threads, jobs, |(from, to): (&[_], &mut [ScreenVertex])| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = map.project(*from);
            }
        });
    }
}

/// Whether an area is made of blocks of 8 x 8 pixels, or what there is of them at the rims of the target.
fn has_whole_blocks(area: &Bounds, target: &Target<'_>) -> bool {
    let Bounds { x1, y1, .. } = target.bounds();
    let ends = |end: i32, rim: i32| end % 8 == 0 || end == rim;
    area.x0 % 8 == 0 && area.y0 % 8 == 0 && ends(area.x1, x1) && ends(area.y1, y1)
}

/// What the tiles need to know of a draw.
pub(crate) fn pass<'a>(
    Planes { format, has_depth, has_stencil, has_ids }: Planes,
    triangles: &Primitives<'_>,
    state: &'a State,
    shading: &'a Shading<'a>,
    map: &'a ScreenMap,
    clear: Option<Clear>,
) -> Pass<'a> {
    let color = ColorPath::of(shading, format);
    let stage = stage_of(shading);
    let needs = stage.map(StageNeeds::of).unwrap_or_default();
    let custom = color == ColorPath::Plain;
    // A test that all pass and that writes nothing needs no depths.
    let looks = state.depth_write || state.depth_test != Compare::Always || needs.tests_depth;
    let reads_depth = has_depth && looks;
    let tests_depth = reads_depth && !needs.tests_depth;
    let reversed = matches!(state.depth_test, Compare::Greater | Compare::GreaterEqual);
    let ordered = reversed || matches!(state.depth_test, Compare::Less | Compare::LessEqual);
    let stencil = state.stencil.filter(|_| stage.is_none() && has_stencil);
    let hides_farther = tests_depth && ordered && !stencil.is_some_and(|test| test.needs_failures());
    let alpha_test = shading.alpha_test();
    let drops =
        if stage.is_some() { needs.discards } else { custom || stencil.is_some() || alpha_test.is_some() };
    let slots = slots(shading, color, triangles.stride);
    let fixed = match shading {
        Shading::Fixed(fixed) if color != ColorPath::None => Some(fixed),
        _ => None,
    };
    // They come after the colour, the shadow map last.
    let second = slots.len() - fixed.and_then(of_shadow).map_or(0, |(_, count)| count);
    let first = second - fixed.and_then(of_texture).map_or(0, |(_, count)| count);
    let texture = fixed.and_then(|fixed| fixed.texture.as_ref()).map(|unit| (unit, first));
    let cube = fixed.and_then(|fixed| fixed.cube.as_ref()).filter(|_| texture.is_none());
    let cube = cube.map(|unit| (unit, first));
    let shadow = fixed.and_then(|fixed| fixed.shadow.as_ref()).map(|unit| (unit, second));
    let per_pixel = state.multisample && shading.colors_pixels() && fixed.is_some();
    let waits = per_pixel || fixed.is_some_and(FixedShading::has_more);
    let of_texture = texture.map(|(unit, _)| unit.texture.levels.iter().filter_map(|l| l.texels.rgba8()));
    let of_cube = cube.map(|(unit, _)| unit.texture.texels());
    let texels = of_texture.into_iter().flatten().chain(of_cube.into_iter().flatten());
    let mut pass = Pass {
        map,
        state,
        setup: SetupState::new(state),
        shading,
        touches: Touches {
            clear,
            clear_area: None,
            color: if stage.is_some() { needs.color } else { color != ColorPath::None },
            depth: has_depth && (state.depth_write || needs.tests_depth),
            reads_depth,
            stencil: needs.stencil || stencil.is_some(),
            reversed,
            samples: state.multisample && stage.is_some(),
            keeps_forms: false,
        },
        format,
        stage,
        needs,
        has_depth: tests_depth,
        has_ids,
        writes_depth: tests_depth && state.depth_write,
        stencil,
        hides_farther,
        reversed,
        lowers_farthest: hides_farther && state.depth_write && !drops,
        needs_depth: reads_depth || custom,
        depth_only: hides_farther
            && state.depth_write
            && stage.is_none()
            && color == ColorPath::None
            && stencil.is_none()
            && !has_ids,
        color,
        texture,
        cube,
        shadow,
        alpha_test,
        waits,
        waits_only: waits && alpha_test.is_none() && !reads_depth && stencil.is_none() && !has_ids,
        per_pixel,
        texels: texels.collect(),
        slots,
        color_only: false,
    };
    pass.color_only = is_color_only(&pass);
    pass
}

/// A draw that tiles are drawn from.
pub(crate) struct Part<'a> {
    input: BinInput<'a>,
    runs: &'a [Run],
    pub(crate) pass: Pass<'a>,
}

/// Lets each part bring in and take back what any of them touches. Depths `in_blocks` stay planes if all parts
/// can do with that.
pub(crate) fn share_touches(parts: &mut [Part<'_>], in_blocks: bool) {
    let keeps_forms = in_blocks && parts.iter().all(|part| part.pass.depth_only);
    let any = |f: fn(&Touches) -> bool| parts.iter().any(|part| f(&part.pass.touches));
    // Around what is cleared blocks are kept as they are, and so must be brought in.
    let kept = parts.first().and_then(|part| part.pass.touches.clear_area.and(part.pass.touches.clear));
    let keeps = |f: fn(&Clear) -> bool| kept.as_ref().is_some_and(f);
    let (color, depth) = (any(|t| t.color) || keeps(|c| c.color.is_some()), any(|t| t.depth));
    let reads_depth = any(|t| t.reads_depth) || keeps(|c| c.depth.is_some());
    let stencil = any(|t| t.stencil) || keeps(|c| c.stencil.is_some());
    for part in parts {
        let touches = &mut part.pass.touches;
        *touches = Touches { color, depth, reads_depth, stencil, keeps_forms, ..*touches };
    }
}

/// Everything the tiles are drawn from.
pub(crate) struct Frame<'a> {
    /// Tiles in a row, and rows of tiles.
    pub(crate) tiles: [usize; 2],
    pub(crate) clears: bool,
    /// In order.
    pub(crate) parts: &'a [Part<'a>],
}

impl Frame<'_> {
    /// References in some tiles of a row.
    fn work(&self, tiles: std::ops::Range<usize>) -> u64 {
        self.runs().map(|run| run.work(tiles.clone())).sum()
    }

    fn runs(&self) -> impl Iterator<Item = &Run> {
        self.parts.iter().flat_map(|part| part.runs)
    }

    fn draw(
        &self,
        target: &mut Target<'_>,
        threads: usize,
        buffers: &mut Vec<Scratch>,
        level: Level,
    ) -> Vec<FragmentCounts> {
        let columns = self.tiles[0];
        let mut work: Vec<_> = bands(target)
            .into_iter()
            .map(|band| (self.work(band.row * columns..(band.row + 1) * columns), band))
            .filter(|(references, _)| *references > 0 || self.clears)
            .collect();
        work.sort_by_key(|w| std::cmp::Reverse(w.0));
        let spare = Mutex::new(std::mem::take(buffers));
        let counts = share(threads, work, |(_, mut band)| {
            let mut buffer: Scratch = lock(&spare).pop().unwrap_or_default();
            let counts = self.draw_band(level, &mut band, &mut buffer);
            lock(&spare).push(buffer);
            counts
        });
        *buffers = spare.into_inner().unwrap_or_default();
        counts
    }

    /// Whether all of it is little work: not worth a second thread, or looking at all tiles.
    fn is_small(&self) -> bool {
        !self.clears && self.runs().map(Run::references).sum::<usize>() <= SMALL_REFERENCES
    }

    /// Draws on the calling thread, only where there is something to draw.
    fn draw_small(
        &self,
        target: &mut Target<'_>,
        buffers: &mut Vec<Scratch>,
        level: Level,
    ) -> FragmentCounts {
        let mut counts = FragmentCounts::default();
        if buffers.is_empty() {
            buffers.push(Scratch::default());
        }
        let [columns, rows] = self.tiles;
        for row in 0..rows {
            if self.work(row * columns..(row + 1) * columns) > 0 {
                let c = self.draw_band(level, &mut band(target, row), &mut buffers[0]);
                counts.tested += c.tested;
                counts.passed += c.passed;
                counts.shaded += c.shaded;
            }
        }
        counts
    }

    /// Draws a row of tiles.
    fn draw_band(&self, level: Level, band: &mut Band<'_>, scratch: &mut Scratch) -> FragmentCounts {
        let mut counts = FragmentCounts::default();
        let clear = self.parts.first().and_then(|part| part.pass.touches.clear);
        let clears_depths = clear.is_some_and(|clear| clear.depth.is_some());
        for column in 0..self.tiles[0] {
            let Some(blocks) = &mut band.blocks else {
                counts = self.draw_tile(level, band, column, scratch, counts);
                continue;
            };
            if self.clears || self.parts_in(band.row * self.tiles[0] + column).next().is_some() {
                let spare = std::mem::replace(&mut scratch.tile.forms, blocks.take(column, clears_depths));
                counts = self.draw_tile(level, band, column, scratch, counts);
                let drawn = std::mem::replace(&mut scratch.tile.forms, spare);
                if let Some(blocks) = &mut band.blocks {
                    blocks.put(column, drawn);
                }
            }
        }
        counts
    }

    /// The draws that have something in a tile.
    fn parts_in(&self, tile: usize) -> impl Iterator<Item = &Part<'_>> {
        self.parts.iter().filter(move |part| part.runs.iter().any(|run| !run.of_tile(tile).is_empty()))
    }

    /// Draws the tile of a column.
    pub(crate) fn draw_tile(
        &self,
        level: Level,
        band: &mut Band<'_>,
        column: usize,
        scratch: &mut Scratch,
        mut counts: FragmentCounts,
    ) -> FragmentCounts {
        let tile = band.row * self.tiles[0] + column;
        let cleared =
            self.parts.first().map(|part| part.pass.touches.cleared(column * TILE, band.row * TILE));
        scratch.tile.cleared = cleared.unwrap_or_default();
        let mut before: Option<&Part<'_>> = None;
        for part in self.parts_in(tile) {
            if let Some(before) = before {
                dispatch!(level, _simd => scratch.tile.pass_on(band, &before.pass, &part.pass));
            }
            counts = part.draw(level, tile, band, scratch, counts);
            before = Some(part);
        }
        if let Some(last) = before.or(self.parts.first().filter(|_| self.clears)) {
            dispatch!(level, simd => scratch.tile.store(simd, band, column * TILE, &last.pass.touches));
        }
        counts
    }
}

impl Part<'_> {
    /// Draws in a tile, with the vector instructions of a level.
    fn draw(
        &self,
        level: Level,
        tile: usize,
        band: &Band<'_>,
        scratch: &mut Scratch,
        counts: FragmentCounts,
    ) -> FragmentCounts {
        let pass = &self.pass;
        if pass.format == ColorFormat::Rgba8 && pass.state.blend.is_none() && !pass.has_ids {
            dispatch!(level, simd => self.draw_tile::<_, true>(simd, tile, band, scratch, counts))
        } else {
            dispatch!(level, simd => self.draw_tile::<_, false>(simd, tile, band, scratch, counts))
        }
    }

    #[inline(always)]
    fn draw_tile<S: Simd, const FAST: bool>(
        &self,
        simd: S,
        tile: usize,
        band: &Band<'_>,
        scratch: &mut Scratch,
        counts: FragmentCounts,
    ) -> FragmentCounts {
        let column = tile - band.row * self.input.tiles[0];
        let (x, y) = ((column * TILE) as i32, (band.row * TILE) as i32);
        let whole = Bounds { x0: x, y0: y, x1: x + TILE as i32, y1: y + TILE as i32 };
        let bounds = whole.intersect(self.pass.map.bounds);
        let mut draw = TileDraw::<FAST> {
            pass: &self.pass,
            band,
            buffer: &mut scratch.tile,
            batch: &mut scratch.batch,
            queue: &mut scratch.queue,
            tile: [x, y],
            bounds,
            partial: bounds != whole,
            form: None,
            counts,
        };
        let mut references = self.runs.iter().flat_map(|run| run.of_tile(tile).iter().map(move |r| (run, r)));
        while self.fill(draw.batch, &mut references) {
            draw.flush(simd);
        }
        draw.counts
    }

    /// Fills the batch; whether there was anything to fill it with.
    ///
    /// Corners of a tile's triangles are all over the memory: all are touched first, in a loop so short that the
    /// processor waits for all at once; then come the places, and then the varyings.
    #[inline(always)]
    fn fill<'r>(
        &self,
        batch: &mut Batch,
        references: &mut impl Iterator<Item = (&'r Run, &'r Reference)>,
    ) -> bool {
        let mut whole = [[u32::MAX; 3]; LANES];
        let (mut next, mut touched) = ([None; LANES], 0);
        for (next, (run, reference)) in next.iter_mut().skip(batch.len).zip(references) {
            touched ^= self.touch(reference);
            *next = Some((run, reference));
        }
        std::hint::black_box(touched);
        for (run, reference) in next.into_iter().flatten() {
            match reference.piece() {
                None => whole[self.fetch(batch, reference) % LANES] = reference.corners,
                Some(k) => self.fetch_piece(batch, run, k),
            }
        }
        if !self.pass.slots.is_empty() {
            for (lane, corners) in whole.iter().enumerate().take(batch.len) {
                if corners[0] != u32::MAX {
                    self.fetch_varyings(batch, lane, *corners);
                }
            }
        }
        batch.len > 0
    }

    /// Reads something of each corner, so that the rest is there when it is needed. What it returns means nothing.
    #[inline(always)]
    fn touch(&self, reference: &Reference) -> u32 {
        let p = self.input.primitives;
        let varying = |i: u32| p.varyings.get(i as usize * p.stride).map_or(0, |v| v.to_bits());
        let [a, b, c] = reference.corners;
        let place = |i: u32| self.input.vertex(i).map_or(0, |v| v.x) as u32;
        place(a) ^ place(b) ^ place(c) ^ varying(a) ^ varying(b) ^ varying(c)
    }

    /// Puts a triangle into the batch but for its varyings; returns its lane.
    #[inline(always)]
    fn fetch(&self, batch: &mut Batch, reference: &Reference) -> usize {
        let [a, b, c] = reference.corners;
        let v = [self.input.projected(a), self.input.projected(b), self.input.projected(c)];
        batch.push(&v, self.input.primitives.ids.of(reference.triangle()))
    }

    /// Puts the varyings of a triangle into a lane.
    #[inline(always)]
    fn fetch_varyings(&self, batch: &mut Batch, lane: usize, [a, b, c]: [u32; 3]) {
        let p = self.input.primitives;
        let from = match self.pass.state.interpolation {
            Interpolation::FlatFirst => [a; 3],
            Interpolation::FlatLast => [c; 3],
            _ => [a, b, c],
        };
        let values = from.map(|i| varyings_of(p, i));
        if let [r, _, _] = *self.pass.slots
            && let Some(values) = some_of::<3>(values, r)
        {
            return put(batch, lane, values);
        }
        if let [r, _, _, _] = *self.pass.slots
            && let Some(values) = some_of::<4>(values, r)
        {
            return put(batch, lane, values);
        }
        for (slot, &varying) in self.pass.slots.iter().enumerate() {
            let to = &mut batch.values[slot % MAX_VARYINGS];
            for k in 0..3 {
                to[k][lane] = values[k].get(varying).copied().unwrap_or(0.0);
            }
        }
    }

    /// Puts a piece of a clipped triangle into the batch.
    #[inline(never)]
    fn fetch_piece(&self, batch: &mut Batch, run: &Run, k: usize) {
        let (p, piece) = (self.input.primitives, run.pieces[k]);
        let lane = batch.push(&piece.v, p.ids.of(piece.triangle as usize));
        for c in 0..3 {
            let values = &run.piece_varyings[piece.varyings as usize + c * p.stride..][..p.stride];
            for (slot, &varying) in self.pass.slots.iter().enumerate() {
                batch.values[slot % MAX_VARYINGS][c][lane] = values.get(varying).copied().unwrap_or(0.0);
            }
        }
    }
}

/// `N` varyings from `first` on, of each corner: a colour, the usual case, with its lengths known.
#[inline(always)]
fn some_of<const N: usize>(values: [&[f32]; 3], first: usize) -> Option<[&[f32; N]; 3]> {
    let [a, b, c] = values;
    Some([a.get(first..)?.first_chunk()?, b.get(first..)?.first_chunk()?, c.get(first..)?.first_chunk()?])
}

#[inline(always)]
fn put<const N: usize>(batch: &mut Batch, lane: usize, values: [&[f32; N]; 3]) {
    for (slot, to) in batch.values.iter_mut().enumerate().take(N) {
        (to[0][lane], to[1][lane], to[2][lane]) = (values[0][slot], values[1][slot], values[2][slot]);
    }
}

/// Memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    pub(crate) tile: TileBuffer,
    batch: Batch,
    queue: TextureQueue,
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
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
    // This thread works, too, instead of waiting for another one to wake up.
    rayon::in_place_scope(|scope| {
        for _ in 1..tasks {
            scope.spawn(|_| run());
        }
        run();
    });
    done.into_inner().unwrap_or_default()
}
