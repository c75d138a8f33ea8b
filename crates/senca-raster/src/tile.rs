//! The part of a target that fits the cache: one tile, its blocks brought in when first touched and
//! taken back when the tile is done.
//!
//! A tile is 8 x 8 blocks of 8 x 8 pixels. The pixels of a block are stored together, row by row, so
//! that 16 in a row are two rows of 8: one vector.

use crate::api::LANES;
use crate::bin::TILE;
use crate::block_depths::{BandDepths, TileForms};
use crate::cover::Pass;
use crate::multisample;
use crate::setup::Bounds;
use crate::target::{Clear, ColorPlane, Target, rgba8_from_rgba};

use fearless_simd::{Level, Simd, dispatch};

/// Blocks up to which a tile is stored block by block instead of row by row.
const FEW_BLOCKS: u32 = 8;

/// Blocks along a side of a tile.
pub(crate) const BLOCKS: usize = TILE / 8;
/// Blocks of a tile.
const COUNT: usize = BLOCKS * BLOCKS;

/// A quantity of the pixels of a block: four vectors, each two rows of 8 pixels.
pub(crate) type Block<T> = [[T; LANES]; 4];
/// A quantity of every pixel of a tile, block after block.
pub(crate) type BlockPlane<T> = Box<[Block<T>; BLOCKS * BLOCKS]>;

fn block_plane<T: Copy + std::fmt::Debug>(value: T) -> BlockPlane<T> {
    let blocks = vec![[[value; LANES]; 4]; BLOCKS * BLOCKS].into_boxed_slice();
    blocks.try_into().unwrap_or_else(|_| unreachable!("made with that many blocks"))
}

/// The rows of a target that one row of tiles covers.
pub(crate) struct Band<'a> {
    /// Number of the row of tiles.
    pub(crate) row: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) color: Option<ColorPlane<'a>>,
    pub(crate) depth: Option<&'a mut [f32]>,
    /// Whether depths are kept in blocks, instead. That of the tile being drawn is in its [`TileBuffer`].
    pub(crate) in_blocks: bool,
    /// The tiles of such.
    pub(crate) blocks: Option<BandDepths<'a>>,
    pub(crate) stencil: Option<&'a mut [u8]>,
    pub(crate) ids: Option<&'a mut [u32]>,
}

/// Splits a target into its rows of tiles.
pub(crate) fn bands<'a>(target: &'a mut Target<'_>) -> Vec<Band<'a>> {
    let (width, height) = (target.width as usize, target.height as usize);
    let step = (width * TILE).max(1);
    let mut colors: Vec<_> = match &mut target.color {
        Some(ColorPlane::Rgba32F(p)) => p.chunks_mut(step).map(|c| Some(ColorPlane::Rgba32F(c))).collect(),
        Some(ColorPlane::Rgba8(p)) => p.chunks_mut(step).map(|c| Some(ColorPlane::Rgba8(c))).collect(),
        None => Vec::new(),
    };
    let mut depths = target.depth.as_deref_mut().map(|p| p.chunks_mut(step));
    let in_blocks = target.blocks.is_some();
    let mut blocks = target.blocks.as_deref_mut().map(|p| p.bands());
    let mut stencils = target.stencil.as_deref_mut().map(|p| p.chunks_mut(step));
    let mut ids = target.ids.as_deref_mut().map(|p| p.chunks_mut(step));
    (0..height.div_ceil(TILE))
        .map(|row| Band {
            row,
            width,
            height: TILE.min(height - row * TILE),
            color: colors.get_mut(row).and_then(Option::take),
            depth: depths.as_mut().and_then(Iterator::next),
            in_blocks,
            blocks: blocks.as_mut().and_then(Iterator::next),
            stencil: stencils.as_mut().and_then(Iterator::next),
            ids: ids.as_mut().and_then(Iterator::next),
        })
        .collect()
}

/// One row of tiles of a target.
pub(crate) fn band<'a>(target: &'a mut Target<'_>, row: usize) -> Band<'a> {
    let (width, height) = (target.width as usize, target.height as usize);
    let rows = TILE.min(height - row * TILE);
    let range = row * TILE * width..(row * TILE + rows) * width;
    Band {
        row,
        width,
        height: rows,
        color: target.color.as_mut().map(|plane| match plane {
            ColorPlane::Rgba32F(p) => ColorPlane::Rgba32F(&mut p[range.clone()]),
            ColorPlane::Rgba8(p) => ColorPlane::Rgba8(&mut p[range.clone()]),
        }),
        depth: target.depth.as_deref_mut().map(|p| &mut p[range.clone()]),
        in_blocks: target.blocks.is_some(),
        blocks: target.blocks.as_deref_mut().map(|p| p.band(row)),
        stencil: target.stencil.as_deref_mut().map(|p| &mut p[range.clone()]),
        ids: target.ids.as_deref_mut().map(|p| &mut p[range]),
    }
}

/// How a target stores colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColorFormat {
    None,
    Rgba8,
    Rgba32F,
}

/// What a target has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes {
    pub(crate) format: ColorFormat,
    pub(crate) has_depth: bool,
    pub(crate) has_stencil: bool,
    pub(crate) has_ids: bool,
}

impl Planes {
    /// Depths alone.
    pub(crate) const DEPTHS: Self =
        Self { format: ColorFormat::None, has_depth: true, has_stencil: false, has_ids: false };

    pub(crate) fn of(target: &Target<'_>) -> Self {
        Self {
            format: ColorFormat::of(target),
            has_depth: target.has_depth(),
            has_stencil: target.stencil.is_some(),
            has_ids: target.ids.is_some(),
        }
    }
}

impl ColorFormat {
    pub(crate) fn of(target: &Target<'_>) -> Self {
        match target.color {
            None => Self::None,
            Some(ColorPlane::Rgba8(_)) => Self::Rgba8,
            Some(ColorPlane::Rgba32F(_)) => Self::Rgba32F,
        }
    }
}

/// What a draw does with a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touches {
    /// Values the target is cleared to first.
    pub(crate) clear: Option<Clear>,
    /// Pixels that are cleared, whole blocks of them; `None`: all.
    pub(crate) clear_area: Option<Bounds>,
    /// Whether colours are read or written.
    pub(crate) color: bool,
    /// Whether depths are written.
    pub(crate) depth: bool,
    /// Whether depths are read or written.
    pub(crate) reads_depth: bool,
    /// Whether stencil values are read or written.
    pub(crate) stencil: bool,
    /// Whether the depth test passes only what is farther.
    pub(crate) reversed: bool,
    /// Whether blocks are kept sample by sample; see [`crate::multisample`].
    pub(crate) samples: bool,
    /// Whether depths stay planes where that is possible; see [`crate::block_depths`].
    pub(crate) keeps_forms: bool,
}

impl Touches {
    /// The blocks that are cleared, of the tile whose first pixel is at `x`, `y`.
    pub(crate) fn cleared(&self, x: usize, y: usize) -> u64 {
        match (self.clear, self.clear_area) {
            (None, _) => 0,
            (_, None) => u64::MAX,
            (_, Some(area)) => {
                let within = |block: &usize| {
                    let (x, y) = ((x + block % BLOCKS * 8) as i32, (y + block / BLOCKS * 8) as i32);
                    (area.x0..area.x1).contains(&x) && (area.y0..area.y1).contains(&y)
                };
                (0..BLOCKS * BLOCKS).filter(within).fold(0, |bits, block| bits | 1 << block)
            }
        }
    }
}

/// The tile being drawn.
#[derive(Debug)]
pub(crate) struct TileBuffer {
    /// Colour packed, red in the low byte.
    pub(crate) rgba8: BlockPlane<u32>,
    /// Colour as four planes.
    pub(crate) rgba: [BlockPlane<f32>; 4],
    pub(crate) depth: BlockPlane<f32>,
    pub(crate) stencil: BlockPlane<u8>,
    pub(crate) ids: BlockPlane<u32>,
    /// Per block, no stored depth is greater; where the depth test is reversed, no negated one.
    pub(crate) farthest: [f32; BLOCKS * BLOCKS],
    /// Blocks that are cleared when they are brought in, or at the end, bit by bit.
    pub(crate) cleared: u64,
    /// Blocks that have been brought in.
    pub(crate) present: u64,
    /// Those of them in which something may have been written.
    pub(crate) written: u64,
    /// Those of them whose depths were cleared: unless written, all are [`Self::farthest`].
    pub(crate) level: u64,
    /// Those of them whose depths are to be found in `forms`.
    pub(crate) formed: u64,
    /// Where the target keeps depths in blocks: this tile of them.
    pub(crate) forms: Box<TileForms>,
}

impl Default for TileBuffer {
    fn default() -> Self {
        Self {
            rgba8: block_plane(0),
            rgba: [block_plane(0.0), block_plane(0.0), block_plane(0.0), block_plane(0.0)],
            depth: block_plane(0.0),
            stencil: block_plane(0),
            ids: block_plane(0),
            farthest: [f32::INFINITY; BLOCKS * BLOCKS],
            cleared: 0,
            present: 0,
            written: 0,
            level: 0,
            formed: 0,
            forms: Box::default(),
        }
    }
}

/// The blocks whose bits are set.
pub(crate) fn blocks_of(bits: u64) -> impl Iterator<Item = usize> {
    (0..BLOCKS * BLOCKS).filter(move |block| bits >> block & 1 == 1)
}

/// A row of 8 pixels of block (`bx`, `by`) within a band; fewer at the right rim.
fn row_range(width: usize, tile_x: usize, block: usize, y: usize) -> std::ops::Range<usize> {
    let x = tile_x + (block % BLOCKS) * 8;
    let start = y * width + x.min(width);
    start..y * width + (x + 8).min(width)
}

impl TileBuffer {
    /// Memory of its planes.
    pub(crate) const BYTES: usize = (7 * 4 + 1) * TILE * TILE;

    /// Brings a block in, from the target or freshly cleared.
    #[cold]
    #[inline(never)]
    pub(crate) fn fetch<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        tile_x: usize,
        block: usize,
        touches: &Touches,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.fetch_block(band, tile_x, block, touches),
        );
    }

    #[inline(always)]
    fn fetch_block(&mut self, band: &Band<'_>, tile_x: usize, block: usize, touches: &Touches) {
        let clear = touches.clear.filter(|_| self.cleared >> block & 1 == 1);
        if band.in_blocks && self.present == 0 {
            self.open_forms(touches);
        }
        if self.present >> block & 1 == 1 {
            return;
        }
        self.present |= 1 << block;
        self.farthest[block] = f32::INFINITY;
        match clear.and_then(|c| c.color) {
            Some(rgba) => self.clear_color(block, rgba, band),
            None if touches.color => self.fetch_color(band, tile_x, block),
            None => {}
        }
        let cleared_depth = clear.and_then(|c| c.depth);
        if let Some(plane) = band.depth.as_ref().filter(|_| touches.reads_depth || cleared_depth.is_some()) {
            match cleared_depth {
                Some(depth) => fill(&mut self.depth[block], depth),
                None => fetch_plane(&mut self.depth[block], plane, band, tile_x, block),
            }
            self.level |= u64::from(cleared_depth.is_some()) << block;
            self.farthest[block] = match cleared_depth {
                Some(depth) if touches.reversed => -depth,
                Some(depth) => depth,
                None => farthest_of(&self.depth[block], touches.reversed),
            };
        }
        if band.in_blocks {
            self.depth[block] = *self.forms.values_of(block);
            self.farthest[block] = farthest_of(&self.depth[block], touches.reversed);
        }
        if let Some(plane) = &band.stencil {
            match clear.and_then(|c| c.stencil) {
                Some(value) => fill(&mut self.stencil[block], value),
                None if touches.stencil => {
                    fetch_plane(&mut self.stencil[block], plane, band, tile_x, block);
                }
                None => {}
            }
        }
        if let Some(plane) = &band.ids {
            match clear.and_then(|c| c.id) {
                Some(id) => fill(&mut self.ids[block], id),
                None => fetch_plane(&mut self.ids[block], plane, band, tile_x, block),
            }
        }
        if touches.samples {
            self.turn(band, block, touches, true);
        }
    }

    /// Where the target keeps depths in blocks: brings in all blocks of a tile but those that are kept as values.
    fn open_forms(&mut self, touches: &Touches) {
        match touches.clear.and_then(|clear| clear.depth) {
            Some(depth) => {
                self.forms.clear(depth);
                self.farthest = [if touches.reversed { -depth } else { depth }; BLOCKS * BLOCKS];
                (self.present, self.level) = (u64::MAX, u64::MAX);
            }
            None => {
                self.present = !self.forms.valued;
                for block in blocks_of(self.present) {
                    self.farthest[block] = self.forms.farthest(block, touches.reversed);
                }
            }
        }
        self.formed = self.present;
        if !touches.keeps_forms {
            let simd = Level::baseline();
            for block in blocks_of(self.present) {
                dispatch!(simd, simd => self.unfold(simd, block));
            }
        }
    }

    /// Finds the depths of a block that is kept as planes.
    #[inline(always)]
    pub(crate) fn unfold<S: Simd>(&mut self, simd: S, block: usize) {
        self.forms.values(simd, block, &mut self.depth[block % (BLOCKS * BLOCKS)]);
        self.formed &= !(1 << block);
    }

    /// Does `turn` to every plane of a block that is there.
    fn turn(&mut self, band: &Band<'_>, block: usize, touches: &Touches, to_samples: bool) {
        fn turn<T: Copy>(block: &mut Block<T>, to_samples: bool) {
            if to_samples { multisample::to_samples(block) } else { multisample::to_rows(block) }
        }
        match band.color {
            Some(ColorPlane::Rgba8(_)) if touches.color => turn(&mut self.rgba8[block], to_samples),
            Some(ColorPlane::Rgba32F(_)) if touches.color => {
                self.rgba.iter_mut().for_each(|plane| turn(&mut plane[block], to_samples));
            }
            _ => {}
        }
        if band.depth.is_some() {
            turn(&mut self.depth[block], to_samples);
        }
        if band.stencil.is_some() && touches.stencil {
            turn(&mut self.stencil[block], to_samples);
        }
        if band.ids.is_some() {
            turn(&mut self.ids[block], to_samples);
        }
    }

    /// Between two draws in the same tile: blocks are kept as the next one wants them, and what is known
    /// of their depths is found anew.
    #[inline(always)]
    pub(crate) fn pass_on(&mut self, band: &Band<'_>, before: &Pass<'_>, next: &Pass<'_>) {
        if before.touches.samples != next.touches.samples {
            blocks_of(self.present)
                .for_each(|block| self.turn(band, block, &next.touches, next.touches.samples));
        }
        let changed = match (before.reversed == next.reversed, next.hides_farther) {
            (false, _) => self.present,
            (true, true) => self.written,
            (true, false) => 0,
        };
        for block in blocks_of(changed) {
            self.farthest[block] = match self.formed >> block & 1 == 1 {
                true => self.forms.farthest(block, next.reversed),
                false => farthest_of(&self.depth[block], next.reversed),
            };
        }
        // What was nearer than the level may be farther now.
        self.level &= if before.reversed == next.reversed { u64::MAX } else { 0 };
    }

    #[inline(always)]
    fn clear_color(&mut self, block: usize, rgba: [f32; 4], band: &Band<'_>) {
        match band.color {
            Some(ColorPlane::Rgba8(_)) => {
                fill(&mut self.rgba8[block], u32::from_le_bytes(rgba8_from_rgba(rgba)))
            }
            Some(ColorPlane::Rgba32F(_)) => {
                for (plane, v) in self.rgba.iter_mut().zip(rgba) {
                    fill(&mut plane[block], v);
                }
            }
            None => {}
        }
    }

    #[inline(always)]
    fn fetch_color(&mut self, band: &Band<'_>, tile_x: usize, block: usize) {
        if let Some(ColorPlane::Rgba8(p)) = &band.color
            && let Some(rows) = whole_rows(p, band, tile_x, block)
        {
            let to = self.rgba8[block].as_flattened_mut().as_chunks_mut::<8>().0;
            to.iter_mut().zip(rows).for_each(|(to, row)| *to = row.map(u32::from_le_bytes));
            return;
        }
        for (y, row) in block_rows(band, block) {
            let range = row_range(band.width, tile_x, block, y);
            match &band.color {
                Some(ColorPlane::Rgba8(p)) => {
                    for (to, from) in
                        self.rgba8[block].as_flattened_mut()[row * 8..].iter_mut().zip(&p[range])
                    {
                        *to = u32::from_le_bytes(*from);
                    }
                }
                Some(ColorPlane::Rgba32F(p)) => {
                    for (x, from) in p[range].iter().enumerate() {
                        for (plane, v) in self.rgba.iter_mut().zip(from) {
                            plane[block].as_flattened_mut()[row * 8 + x] = *v;
                        }
                    }
                }
                None => {}
            }
        }
    }

    /// Takes the blocks that have been written back to the target. With `clear`, the others are cleared.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, simd: S, band: &mut Band<'_>, tile_x: usize, touches: &Touches) {
        simd.vectorize(
            #[inline(always)]
            || self.store_blocks(band, tile_x, touches),
        );
    }

    #[inline(always)]
    fn store_blocks(&mut self, band: &mut Band<'_>, tile_x: usize, touches: &Touches) {
        let cleared = self.cleared;
        let clear = touches.clear.filter(|_| cleared != 0);
        let (width, height) = (band.width, band.height);
        let (seen, formed) = (self.present, self.formed);
        (self.present, self.level, self.formed) = (0, 0, 0);
        let present = std::mem::take(&mut self.written);
        if present == 0 && clear.is_none() {
            return;
        }
        if touches.samples {
            blocks_of(present).for_each(|block| self.turn(band, block, touches, false));
        }
        let rows = Rows { width, height, tile_x, present, cleared };
        let color = clear.and_then(|c| c.color);
        match (band.color.as_mut().filter(|_| touches.color || color.is_some()), color) {
            (Some(ColorPlane::Rgba8(p)), clear) => {
                let clear = clear.map(rgba8_from_rgba);
                rows.store(p, clear, |block, row| eight(&self.rgba8[block % COUNT], row, u32::to_le_bytes));
            }
            (Some(ColorPlane::Rgba32F(p)), clear) => rows.store(p, clear, |block, row| {
                let at = |k: usize, x: usize| self.rgba[k][block].as_flattened()[row + x];
                std::array::from_fn(|x| [at(0, x), at(1, x), at(2, x), at(3, x)])
            }),
            (None, _) => {}
        }
        let depth = clear.and_then(|c| c.depth);
        if let Some(p) = band.depth.as_mut().filter(|_| touches.depth || depth.is_some()) {
            rows.store(p, depth, |block, row| eight(&self.depth[block % COUNT], row, |v| v));
        }
        if band.in_blocks {
            match depth.filter(|_| seen == 0) {
                Some(depth) => self.forms.clear(depth),
                None => self.forms.keep(present & !formed, &self.depth),
            }
        }
        let stencil = clear.and_then(|c| c.stencil);
        if let Some(p) = band.stencil.as_mut().filter(|_| touches.stencil || stencil.is_some()) {
            rows.store(p, stencil, |block, row| eight(&self.stencil[block % COUNT], row, |v| v));
        }
        if let Some(p) = &mut band.ids {
            rows.store(p, clear.and_then(|c| c.id), |block, row| eight(&self.ids[block % COUNT], row, |v| v));
        }
    }
}

/// The greatest depth of a block; the greatest negated one if `reversed`.
#[inline(always)]
fn farthest_of(block: &Block<f32>, reversed: bool) -> f32 {
    let mut most = [f32::NEG_INFINITY; LANES];
    let sign = if reversed { -1.0 } else { 1.0 };
    for vector in block {
        for (most, depth) in most.iter_mut().zip(vector) {
            let depth = sign * depth;
            *most = if depth > *most { depth } else { *most };
        }
    }
    most.into_iter().fold(f32::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

/// Eight pixels of a block, from number `first` on, as they are stored.
#[inline(always)]
fn eight<T: Copy, U>(block: &Block<T>, first: usize, stored: impl Fn(T) -> U) -> [U; 8] {
    let pair = &block[first / LANES % 4];
    let half = first % LANES / 8 * 8;
    std::array::from_fn(|x| stored(pair[half + x]))
}

/// The rows of a tile within its band.
struct Rows {
    width: usize,
    height: usize,
    tile_x: usize,
    present: u64,
    cleared: u64,
}

impl Rows {
    /// Writes the blocks that are present, row by row of the target, and `clear` to the others that are cleared.
    /// `get` gives eight pixels of a block from one on.
    #[inline(always)]
    fn store<T: Copy>(&self, plane: &mut [T], clear: Option<T>, get: impl Fn(usize, usize) -> [T; 8]) {
        let end = (self.tile_x + TILE).min(self.width);
        if clear.is_none() && self.present.count_ones() <= FEW_BLOCKS {
            return self.store_few(plane, get);
        }
        for y in 0..self.height {
            let row = &mut plane[y * self.width + self.tile_x..y * self.width + end];
            let [present, cleared] = [self.present, self.cleared].map(|bits| bits >> (y / 8 * BLOCKS) & 255);
            let clear_at = |bx: usize| clear.filter(|_| cleared >> bx & 1 == 1);
            if present == 0 && (cleared == 255 || clear.is_none()) {
                clear.into_iter().for_each(|v| row.fill(v));
                continue;
            }
            let (whole, rest) = row.as_chunks_mut::<8>();
            if let (255, Some(whole)) = (present, whole.first_chunk_mut::<BLOCKS>()) {
                for (bx, to) in whole.iter_mut().enumerate() {
                    *to = get(y / 8 * BLOCKS + bx, y % 8 * 8);
                }
                continue;
            }
            let last = whole.len();
            for (bx, to) in whole.iter_mut().enumerate() {
                if present >> bx & 1 == 1 {
                    *to = get(y / 8 * BLOCKS + bx, y % 8 * 8);
                } else if let Some(v) = clear_at(bx) {
                    *to = [v; 8];
                }
            }
            if rest.is_empty() {
                continue;
            }
            if present >> last & 1 == 1 {
                let from = get(y / 8 * BLOCKS + last, y % 8 * 8);
                rest.copy_from_slice(&from[..rest.len()]);
            } else if let Some(v) = clear_at(last) {
                rest.fill(v);
            }
        }
    }
}

impl Rows {
    /// Writes the blocks that are present, one after another.
    #[inline(always)]
    fn store_few<T: Copy>(&self, plane: &mut [T], get: impl Fn(usize, usize) -> [T; 8]) {
        let mut left = self.present;
        while left != 0 {
            let block = left.trailing_zeros() as usize;
            left &= left - 1;
            let first = block / BLOCKS * 8;
            for y in first..(first + 8).min(self.height) {
                let to = &mut plane[row_range(self.width, self.tile_x, block, y)];
                let from = get(block, (y - first) * 8);
                match to.first_chunk_mut::<8>() {
                    Some(to) => *to = from,
                    None => to.copy_from_slice(&from[..to.len()]),
                }
            }
        }
    }
}

#[inline(always)]
fn fill<T: Copy>(block: &mut Block<T>, value: T) {
    block.as_flattened_mut().fill(value);
}

/// Rows of a block that are inside the band: row of the band, row of the block.
fn block_rows(band: &Band<'_>, block: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
    let first = (block / BLOCKS) * 8;
    (first..(first + 8).min(band.height)).zip(0..)
}

/// The eight rows of a block that lies wholly inside the band, of a plane.
#[inline(always)]
fn whole_rows<'p, T>(
    plane: &'p [T],
    band: &Band<'_>,
    tile_x: usize,
    block: usize,
) -> Option<[&'p [T; 8]; 8]> {
    let (x, y) = (tile_x + (block % BLOCKS) * 8, (block / BLOCKS) * 8);
    if x + 8 > band.width || y + 8 > band.height {
        return None;
    }
    let mut rows = [plane.first_chunk::<8>()?; 8];
    for (k, row) in rows.iter_mut().enumerate() {
        *row = plane.get((y + k) * band.width + x..)?.first_chunk::<8>()?;
    }
    Some(rows)
}

#[inline(always)]
fn fetch_plane<T: Copy>(to: &mut Block<T>, plane: &[T], band: &Band<'_>, tile_x: usize, block: usize) {
    if let Some(rows) = whole_rows(plane, band, tile_x, block) {
        for (to, row) in to.as_flattened_mut().as_chunks_mut::<8>().0.iter_mut().zip(rows) {
            *to = *row;
        }
        return;
    }
    for (y, row) in block_rows(band, block) {
        let from = &plane[row_range(band.width, tile_x, block, y)];
        to.as_flattened_mut()[row * 8..][..from.len()].copy_from_slice(from);
    }
}
