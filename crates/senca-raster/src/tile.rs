//! The part of a target that fits the cache: one tile, its blocks brought in when first touched and
//! taken back when the tile is done.
//!
//! A tile is 8 x 8 blocks of 8 x 8 pixels. The pixels of a block are stored together, row by row, so
//! that 16 in a row are two rows of 8: one vector.

use crate::api::LANES;
use crate::bin::TILE;
use crate::target::{Clear, ColorPlane, Target, rgba8_from_rgba};

/// Blocks along a side of a tile.
pub(crate) const BLOCKS: usize = TILE / 8;

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
    let mut ids = target.ids.as_deref_mut().map(|p| p.chunks_mut(step));
    (0..height.div_ceil(TILE))
        .map(|row| Band {
            row,
            width,
            height: TILE.min(height - row * TILE),
            color: colors.get_mut(row).and_then(Option::take),
            depth: depths.as_mut().and_then(Iterator::next),
            ids: ids.as_mut().and_then(Iterator::next),
        })
        .collect()
}

/// How a target stores colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColorFormat {
    None,
    Rgba8,
    Rgba32F,
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

/// The tile being drawn.
#[derive(Debug)]
pub(crate) struct TileBuffer {
    /// Colour packed, red in the low byte.
    pub(crate) rgba8: BlockPlane<u32>,
    /// Colour as four planes.
    pub(crate) rgba: [BlockPlane<f32>; 4],
    pub(crate) depth: BlockPlane<f32>,
    pub(crate) ids: BlockPlane<u32>,
    /// Per block, no stored depth is greater.
    pub(crate) farthest: [f32; BLOCKS * BLOCKS],
    /// Blocks that have been brought in, bit by bit.
    pub(crate) present: u64,
}

impl Default for TileBuffer {
    fn default() -> Self {
        Self {
            rgba8: block_plane(0),
            rgba: [block_plane(0.0), block_plane(0.0), block_plane(0.0), block_plane(0.0)],
            depth: block_plane(0.0),
            ids: block_plane(0),
            farthest: [f32::INFINITY; BLOCKS * BLOCKS],
            present: 0,
        }
    }
}

/// A row of 8 pixels of block (`bx`, `by`) within a band; fewer at the right rim.
fn row_range(width: usize, tile_x: usize, block: usize, y: usize) -> std::ops::Range<usize> {
    let x = tile_x + (block % BLOCKS) * 8;
    let start = y * width + x.min(width);
    start..y * width + (x + 8).min(width)
}

impl TileBuffer {
    /// Brings a block in, from the target or freshly cleared.
    #[cold]
    #[inline(never)]
    pub(crate) fn fetch(&mut self, band: &Band<'_>, tile_x: usize, block: usize, clear: Option<&Clear>) {
        self.present |= 1 << block;
        self.farthest[block] = f32::INFINITY;
        match clear.and_then(|c| c.color) {
            Some(rgba) => self.clear_color(block, rgba, band),
            None => self.fetch_color(band, tile_x, block),
        }
        if let Some(plane) = &band.depth {
            match clear.and_then(|c| c.depth) {
                Some(depth) => fill(&mut self.depth[block], depth),
                None => fetch_plane(&mut self.depth[block], plane, band, tile_x, block),
            }
            self.farthest[block] =
                self.depth[block].as_flattened().iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
        if let Some(plane) = &band.ids {
            match clear.and_then(|c| c.id) {
                Some(id) => fill(&mut self.ids[block], id),
                None => fetch_plane(&mut self.ids[block], plane, band, tile_x, block),
            }
        }
    }

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

    fn fetch_color(&mut self, band: &Band<'_>, tile_x: usize, block: usize) {
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

    /// Takes the tile back to the target. With `clear`, blocks that were never touched are cleared.
    pub(crate) fn store(
        &mut self,
        band: &mut Band<'_>,
        tile_x: usize,
        clear: Option<&Clear>,
        depth_written: bool,
    ) {
        for block in 0..BLOCKS * BLOCKS {
            let present = self.present >> block & 1 == 1;
            if present {
                self.store_block(band, tile_x, block, depth_written || clear.is_some());
            } else if let Some(clear) = clear {
                clear_block(band, tile_x, block, clear);
            }
        }
        self.present = 0;
    }

    fn store_block(&self, band: &mut Band<'_>, tile_x: usize, block: usize, depth_written: bool) {
        for (y, row) in block_rows(band, block) {
            let range = row_range(band.width, tile_x, block, y);
            match &mut band.color {
                Some(ColorPlane::Rgba8(p)) => {
                    for (to, from) in
                        p[range.clone()].iter_mut().zip(&self.rgba8[block].as_flattened()[row * 8..])
                    {
                        *to = from.to_le_bytes();
                    }
                }
                Some(ColorPlane::Rgba32F(p)) => {
                    for (x, to) in p[range.clone()].iter_mut().enumerate() {
                        *to = std::array::from_fn(|k| self.rgba[k][block].as_flattened()[row * 8 + x]);
                    }
                }
                None => {}
            }
            if let Some(p) = band.depth.as_mut().filter(|_| depth_written) {
                store_row(&mut p[range.clone()], &self.depth[block].as_flattened()[row * 8..]);
            }
            if let Some(p) = &mut band.ids {
                store_row(&mut p[range], &self.ids[block].as_flattened()[row * 8..]);
            }
        }
    }
}

fn fill<T: Copy>(block: &mut Block<T>, value: T) {
    block.as_flattened_mut().fill(value);
}

/// Rows of a block that are inside the band: row of the band, row of the block.
fn block_rows(band: &Band<'_>, block: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
    let first = (block / BLOCKS) * 8;
    (first..(first + 8).min(band.height)).zip(0..)
}

fn fetch_plane<T: Copy>(to: &mut Block<T>, plane: &[T], band: &Band<'_>, tile_x: usize, block: usize) {
    for (y, row) in block_rows(band, block) {
        let from = &plane[row_range(band.width, tile_x, block, y)];
        to.as_flattened_mut()[row * 8..][..from.len()].copy_from_slice(from);
    }
}

fn store_row<T: Copy>(to: &mut [T], from: &[T]) {
    match <&mut [T; 8]>::try_from(&mut *to) {
        Ok(whole) => whole.copy_from_slice(&from[..8]),
        Err(_) => to.copy_from_slice(&from[..to.len()]),
    }
}

fn clear_block(band: &mut Band<'_>, tile_x: usize, block: usize, clear: &Clear) {
    for (y, _) in block_rows(band, block) {
        let range = row_range(band.width, tile_x, block, y);
        match (&mut band.color, clear.color) {
            (Some(ColorPlane::Rgba8(p)), Some(rgba)) => p[range.clone()].fill(rgba8_from_rgba(rgba)),
            (Some(ColorPlane::Rgba32F(p)), Some(rgba)) => p[range.clone()].fill(rgba),
            _ => {}
        }
        if let (Some(p), Some(depth)) = (&mut band.depth, clear.depth) {
            p[range.clone()].fill(depth);
        }
        if let (Some(p), Some(id)) = (&mut band.ids, clear.id) {
            p[range].fill(id);
        }
    }
}
