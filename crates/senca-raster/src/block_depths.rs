//! Depths of a picture, kept in blocks: where one or two triangles cover a block of 8 x 8 pixels, only
//! their planes are kept. A shadow map is large, drawn anew for each picture and read at few of its pixels, and
//! going through the memory is most of the work.
//!
//! A plane's depth at a pixel is found by the same operations in the same order as when it is drawn, so
//! nothing shows whether depths have been kept this way.

use crate::api::LANES;
use crate::bin::TILE;
use crate::cover::{LANE_FX, LANE_FY};
use crate::target::{MAX_TARGET_SIDE, TargetError};
use crate::tile::{BLOCKS, Block};
use fearless_simd::{Level, Simd, dispatch, f32x16, mask32x16, prelude::*};
use rayon::prelude::*;
use std::ops::Range;

/// Blocks of a tile.
pub(crate) const COUNT: usize = BLOCKS * BLOCKS;
/// Planes that a tile keeps; blocks that need more are kept as values.
const PLANES: usize = 64;

/// The depths of a triangle: a plane over the pixels of a tile, clamped to the triangle's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthForm {
    /// Value, and steps in x and y.
    pub(crate) plane: [f32; 3],
    /// The first pixel of the tile, counted from where the plane has its value; whole numbers.
    pub(crate) offset: [f32; 2],
    pub(crate) range: [f32; 2],
}

impl DepthForm {
    /// One depth everywhere.
    fn level(depth: f32) -> Self {
        Self { plane: [depth, 0.0, 0.0], offset: [0.0; 2], range: [depth; 2] }
    }

    /// The depth at a pixel of the tile.
    #[inline(always)]
    fn at(&self, x: f32, y: f32) -> f32 {
        let row = self.plane[0] + self.plane[2] * (self.offset[1] + y);
        let z = row + self.plane[1] * (self.offset[0] + x);
        let [low, high] = self.range;
        z.max(low).min(high)
    }

    /// The depths of two rows of a block.
    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, block: usize, pair: usize) -> f32x16<S> {
        let splat = |v: f32| f32x16::splat(simd, v);
        let (x, y) = corner(block);
        let fx = f32x16::load_array(simd, LANE_FX) + splat(self.offset[0] + x);
        let fy = f32x16::load_array(simd, LANE_FY) + splat(self.offset[1] + y + (2 * pair) as f32);
        let row = splat(self.plane[0]) + splat(self.plane[2]) * fy;
        let z = row + splat(self.plane[1]) * fx;
        z.max(splat(self.range[0])).min(splat(self.range[1]))
    }

    /// The greatest depth over a block, the greatest negated one if `reversed`.
    fn farthest(&self, block: usize, reversed: bool) -> f32 {
        let (x, y) = corner(block);
        let corners = [self.at(x, y), self.at(x + 7.0, y), self.at(x, y + 7.0), self.at(x + 7.0, y + 7.0)];
        corners.into_iter().map(|z| if reversed { -z } else { z }).fold(f32::NEG_INFINITY, f32::max)
    }
}

/// First pixel of a block within its tile.
#[inline(always)]
fn corner(block: usize) -> (f32, f32) {
    ((block % BLOCKS * 8) as f32, (block / BLOCKS * 8) as f32)
}

/// The planes of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BlockForm {
    /// Pixels, row by row, that have the inner plane; the others have the outer one.
    inner_pixels: u64,
    outer: u8,
    inner: u8,
}

/// What a tile keeps of its depths besides values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TileForms {
    planes: [DepthForm; PLANES],
    count: usize,
    blocks: [BlockForm; COUNT],
    /// Blocks whose depths are values, bit by bit.
    pub(crate) valued: u64,
}

impl Default for TileForms {
    fn default() -> Self {
        Self {
            planes: [DepthForm::level(0.0); PLANES],
            count: 1,
            blocks: [BlockForm::default(); COUNT],
            valued: 0,
        }
    }
}

impl TileForms {
    /// One depth everywhere.
    pub(crate) fn clear(&mut self, depth: f32) {
        self.planes[0] = DepthForm::level(depth);
        (self.count, self.valued) = (1, 0);
        self.blocks = [BlockForm::default(); COUNT];
    }

    /// Takes what another has.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.planes[..other.count].copy_from_slice(&other.planes[..other.count]);
        (self.count, self.valued, self.blocks) = (other.count, other.valued, other.blocks);
    }

    /// Adds a plane; `None` if there are too many.
    #[inline(always)]
    pub(crate) fn add(&mut self, form: DepthForm) -> Option<u8> {
        let place = self.planes.get_mut(self.count)?;
        *place = form;
        self.count += 1;
        Some((self.count - 1) as u8)
    }

    /// Gives all of a block a plane.
    #[inline(always)]
    pub(crate) fn cover(&mut self, block: usize, plane: u8) {
        self.blocks[block % COUNT] = BlockForm { inner_pixels: 0, outer: plane, inner: 0 };
    }

    /// Gives a plane to pixels of a block that have one depth without it, or to all the others. Tells what
    /// has become of it.
    #[inline(always)]
    pub(crate) fn cover_some(&mut self, block: usize, pixels: u64, plane: u8) -> Covered {
        let form = &mut self.blocks[block % COUNT];
        if form.inner_pixels == 0 && pixels == u64::MAX {
            *form = BlockForm { inner_pixels: 0, outer: plane, inner: 0 };
            Covered::All
        } else if form.inner_pixels == 0 {
            (form.inner_pixels, form.inner) = (pixels, plane);
            Covered::Some
        } else if form.inner_pixels == !pixels {
            form.outer = plane;
            Covered::All
        } else {
            Covered::TooMuch
        }
    }

    /// Depths of a block that has planes.
    #[inline(always)]
    pub(crate) fn values<S: Simd>(&self, simd: S, block: usize, to: &mut Block<f32>) {
        let form = &self.blocks[block % COUNT];
        let outer = &self.planes[usize::from(form.outer) % PLANES];
        let inner = &self.planes[usize::from(form.inner) % PLANES];
        for (pair, to) in to.iter_mut().enumerate() {
            let pixels = form.inner_pixels >> (LANES * pair) & 0xffff;
            let depths = outer.along(simd, block, pair);
            if pixels == 0 {
                depths.store_array(to);
            } else {
                let inside = mask32x16::from_bitmask(simd, pixels);
                inside.select(inner.along(simd, block, pair), depths).store_array(to);
            }
        }
    }

    /// The greatest depth of a block that has planes, or more; negated ones if `reversed`.
    pub(crate) fn farthest(&self, block: usize, reversed: bool) -> f32 {
        let form = &self.blocks[block % COUNT];
        let of = |plane: u8| self.planes[usize::from(plane) % PLANES].farthest(block, reversed);
        if form.inner_pixels == 0 { of(form.outer) } else { of(form.outer).max(of(form.inner)) }
    }
}

/// What has become of a block, some pixels of which were given a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Covered {
    /// Other pixels still have the depth that all had before.
    Some,
    /// All pixels have planes of triangles.
    All,
    /// The block cannot be kept this way; nothing has changed.
    TooMuch,
}

/// Depths of a picture in blocks; see [`crate::TiledRasterizer::draw_depths`]. Row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockDepths {
    width: usize,
    height: usize,
    /// Tiles in a row.
    columns: usize,
    tiles: Vec<TileForms>,
    /// Depths of the blocks that are kept as values, block after block, tile after tile.
    values: Vec<f32>,
}

impl BlockDepths {
    /// A picture that has one depth everywhere. Memory for values is not touched before it is needed.
    ///
    /// # Errors
    /// [`TargetError::TooLarge`].
    pub fn new(width: u32, height: u32, depth: f32) -> Result<Self, TargetError> {
        if width.max(height) > MAX_TARGET_SIDE {
            return Err(TargetError::TooLarge { width, height });
        }
        let (width, height) = (width as usize, height as usize);
        let columns = width.div_ceil(TILE);
        let tiles = columns * height.div_ceil(TILE);
        let mut tile = TileForms::default();
        tile.clear(depth);
        Ok(Self { width, height, columns, tiles: vec![tile; tiles], values: vec![0.0; tiles * TILE * TILE] })
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width as u32
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height as u32
    }

    /// The depth of a pixel; 0 outside the picture.
    #[must_use]
    #[inline]
    pub fn get(&self, x: u32, y: u32) -> f32 {
        let (x, y) = (x as usize, y as usize);
        if x >= self.width || y >= self.height {
            return 0.0;
        }
        self.at(x, y)
    }

    /// The depths of sixteen squares of two columns and two rows: of each the one at the first column
    /// and row, that at the second column, then those of the second row. Columns and rows must be within
    /// the picture; what is not gives any depth.
    // Not to be inlined into vector code, which would take each number out of its register.
    #[inline(never)]
    pub fn gather(&self, columns: [&[i32; LANES]; 2], rows: [&[i32; LANES]; 2], to: &mut [[f32; LANES]; 4]) {
        for (corner, to) in to.iter_mut().enumerate() {
            let (columns, rows) = (columns[corner % 2], rows[corner / 2]);
            for (to, (x, y)) in to.iter_mut().zip(columns.iter().zip(rows)) {
                *to = self.at(*x as u32 as usize, *y as u32 as usize);
            }
        }
    }

    /// All depths, row by row.
    #[must_use]
    pub fn to_rows(&self) -> Vec<f32> {
        let level = Level::new();
        let mut rows = vec![0.0; self.width * self.height];
        let columns = self.columns;
        let bands = rows.par_chunks_mut((self.width * TILE).max(1));
        bands.enumerate().for_each(|(row, band)| {
            let mut block = [[0.0; LANES]; 4];
            for column in 0..columns {
                for b in 0..COUNT {
                    let (left, top) = (column * TILE + b % BLOCKS * 8, b / BLOCKS * 8);
                    if left >= self.width || row * TILE + top >= self.height {
                        continue;
                    }
                    let tile = row * columns + column;
                    dispatch!(level, simd => self.block(simd, tile, b, &mut block));
                    let wide = (self.width - left).min(8);
                    let lines = band[top * self.width..].chunks_mut(self.width);
                    for (line, from) in lines.zip(block.as_flattened().as_chunks::<8>().0) {
                        line[left..left + wide].copy_from_slice(&from[..wide]);
                    }
                }
            }
        });
        rows
    }

    /// The depth of a pixel; any if it is outside the picture.
    #[inline(always)]
    fn at(&self, x: usize, y: usize) -> f32 {
        let tile = y / TILE * self.columns + x / TILE;
        let Some(forms) = self.tiles.get(tile) else { return 0.0 };
        let (block, pixel) = (y % TILE / 8 * BLOCKS + x % TILE / 8, y % 8 * 8 + x % 8);
        if forms.valued >> block & 1 == 1 {
            return self.values.get(tile * TILE * TILE + block * 64 + pixel).copied().unwrap_or_default();
        }
        // The plane is chosen without a branch: where blocks are cut is as good as random.
        let form = &forms.blocks[block % COUNT];
        let plane = if form.inner_pixels >> pixel & 1 == 1 { form.inner } else { form.outer };
        forms.planes[usize::from(plane) % PLANES].at((x % TILE) as f32, (y % TILE) as f32)
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, tile: usize, block: usize, to: &mut Block<f32>) {
        if self.tiles[tile].valued >> block & 1 == 1 {
            let from = &self.values[tile * TILE * TILE + block * 64..][..64];
            to.as_flattened_mut().copy_from_slice(from);
        } else {
            self.tiles[tile].values(simd, block, to);
        }
    }

    /// The rows of tiles.
    pub(crate) fn bands(&mut self) -> impl Iterator<Item = BandDepths<'_>> {
        let columns = self.columns.max(1);
        let values = self.values.chunks_mut(columns * TILE * TILE);
        self.tiles.chunks_mut(columns).zip(values).map(|(tiles, values)| BandDepths { tiles, values })
    }

    /// One row of tiles.
    pub(crate) fn band(&mut self, row: usize) -> BandDepths<'_> {
        let tiles: Range<usize> = row * self.columns..(row + 1) * self.columns;
        let values = tiles.start * TILE * TILE..tiles.end * TILE * TILE;
        BandDepths { tiles: &mut self.tiles[tiles], values: &mut self.values[values] }
    }
}

/// Depths of a row of tiles.
pub(crate) struct BandDepths<'a> {
    pub(crate) tiles: &'a mut [TileForms],
    values: &'a mut [f32],
}

impl BandDepths<'_> {
    /// Values of a block of a tile.
    pub(crate) fn values(&self, tile: usize, block: usize) -> &[f32; 64] {
        let values = &self.values[tile * TILE * TILE + block * 64..];
        values.first_chunk().unwrap_or(&[0.0; 64])
    }

    /// Keeps values of a block of a tile.
    pub(crate) fn set_values(&mut self, tile: usize, block: usize, from: &Block<f32>) {
        self.values[tile * TILE * TILE + block * 64..][..64].copy_from_slice(from.as_flattened());
    }
}
