//! Depths of a picture, kept in blocks: where one or two triangles cover a block of 8 x 8 pixels, only
//! their planes are kept. A shadow map is large, drawn anew for each picture and read at few of its pixels, and
//! going through the memory is most of the work.
//!
//! A plane's depth at a pixel is found by the same operations in the same order as when it is drawn, so
//! nothing shows whether depths have been kept this way.
//!
//! Tiles may wait until somebody looks at them; see [`crate::later`].

use crate::api::LANES;
use crate::bin::TILE;
use crate::cover::{LANE_FX, LANE_FY};
use crate::later::Later;
use crate::target::{MAX_TARGET_SIDE, TargetError};
use crate::tile::{BLOCKS, Block, BlockPlane, blocks_of};
use crate::tiled::lock;
use fearless_simd::{Level, Simd, dispatch, f32x16, i32x16, mask32x16, prelude::*};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Blocks of a tile.
pub(crate) const COUNT: usize = BLOCKS * BLOCKS;
/// Planes that a tile keeps; blocks that need more are kept as values.
const PLANES: usize = 64;

/// Tiles over which bounds of depths are looked up at most.
const BOUNDED: usize = 16;

/// Numbers of a [`DepthForm`].
const FORM: usize = 7;

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

/// What a tile keeps of its depths besides values: which plane its pixels have. Whatever most lookups need comes
/// first, so that it is in few lines of the cache.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct TileForms {
    /// Blocks whose depths are values, bit by bit.
    pub(crate) valued: u64,
    /// Blocks that have an inner plane.
    cut: u64,
    count: usize,
    /// Number of the plane that a block's pixels have if they are not among the inner ones.
    outer: [u8; COUNT],
    planes: [DepthForm; PLANES],
    /// Number of the plane of the inner pixels.
    inner: [u8; COUNT],
    /// Which pixels have the inner plane, row by row; of blocks that are not cut, any.
    inner_pixels: [u64; COUNT],
    /// Depths of the blocks that are values, in their order.
    values: Vec<Block<f32>>,
}

impl Default for TileForms {
    fn default() -> Self {
        Self {
            valued: 0,
            cut: 0,
            count: 1,
            outer: [0; COUNT],
            planes: [DepthForm::level(0.0); PLANES],
            inner: [0; COUNT],
            inner_pixels: [0; COUNT],
            values: Vec::new(),
        }
    }
}

impl TileForms {
    /// One depth everywhere.
    pub(crate) fn clear(&mut self, depth: f32) {
        self.planes[0] = DepthForm::level(depth);
        (self.count, self.valued, self.cut) = (1, 0, 0);
        self.outer = [0; COUNT];
        self.values.clear();
    }

    /// Which of the values are those of a block.
    #[inline(always)]
    fn place_of(&self, block: usize) -> usize {
        (self.valued & ((1 << block) - 1)).count_ones() as usize
    }

    /// The depths of a block that is kept as values.
    #[inline(always)]
    pub(crate) fn values_of(&self, block: usize) -> &Block<f32> {
        self.values.get(self.place_of(block)).unwrap_or(&[[0.0; LANES]; 4])
    }

    /// Keeps the depths of some blocks as values.
    pub(crate) fn keep(&mut self, blocks: u64, depths: &BlockPlane<f32>) {
        if blocks == 0 {
            return;
        }
        let others = self.valued & !blocks;
        let before: Vec<Block<f32>> = blocks_of(others).map(|block| *self.values_of(block)).collect();
        let mut before = before.into_iter();
        self.valued |= blocks;
        self.values.clear();
        for block in blocks_of(self.valued) {
            let kept = if others >> block & 1 == 1 { before.next() } else { None };
            self.values.push(kept.unwrap_or_else(|| depths[block]));
        }
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
        self.outer[block % COUNT] = plane;
        self.cut &= !(1 << block);
    }

    /// Gives a plane to pixels of a block that have one depth without it, or to all the others. Tells what
    /// has become of it.
    #[inline(always)]
    pub(crate) fn cover_some(&mut self, block: usize, pixels: u64, plane: u8) -> Covered {
        let is_cut = self.cut >> block & 1 == 1;
        if !is_cut && pixels == u64::MAX {
            self.outer[block % COUNT] = plane;
            Covered::All
        } else if !is_cut {
            self.cut |= 1 << block;
            (self.inner_pixels[block % COUNT], self.inner[block % COUNT]) = (pixels, plane);
            Covered::Some
        } else if self.inner_pixels[block % COUNT] == !pixels {
            self.outer[block % COUNT] = plane;
            Covered::All
        } else {
            Covered::TooMuch
        }
    }

    /// The inner pixels of a block.
    #[inline(always)]
    fn inner_pixels(&self, block: usize) -> u64 {
        if self.cut >> block & 1 == 1 { self.inner_pixels[block % COUNT] } else { 0 }
    }

    /// The outer plane of a block, and the inner one; if there is none, any.
    #[inline(always)]
    fn planes_of(&self, block: usize) -> [&DepthForm; 2] {
        let numbers = [self.outer[block % COUNT], self.inner[block % COUNT]];
        numbers.map(|number| &self.planes[usize::from(number) % PLANES])
    }

    /// Number of the plane of a block's pixel, unless the block is kept as values.
    #[inline(always)]
    fn number(&self, block: usize, pixel: usize) -> Option<usize> {
        if self.valued >> block & 1 == 1 {
            return None;
        }
        let is_inner = self.inner_pixels(block) >> pixel & 1 == 1;
        Some(usize::from(if is_inner { self.inner[block % COUNT] } else { self.outer[block % COUNT] }))
    }

    /// Depths of a block that has planes.
    #[inline(always)]
    pub(crate) fn values<S: Simd>(&self, simd: S, block: usize, to: &mut Block<f32>) {
        let inner_pixels = self.inner_pixels(block);
        let [outer, inner] = self.planes_of(block);
        for (pair, to) in to.iter_mut().enumerate() {
            let pixels = inner_pixels >> (LANES * pair) & 0xffff;
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
        let [outer, inner] = self.planes_of(block).map(|plane| plane.farthest(block, reversed));
        if self.inner_pixels(block) == 0 { outer } else { outer.max(inner) }
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

/// Memory of tiles that is used again: boxes, as they come from tiles and go to tiles.
type Spares = Mutex<Vec<Box<TileForms>>>;

/// Depths of a picture in blocks; see [`crate::TiledRasterizer::draw_depths`]. Row 0 on top.
#[derive(Debug)]
pub struct BlockDepths {
    width: usize,
    height: usize,
    /// Tiles in a row.
    columns: usize,
    /// Those that are not there yet are what `later` draws.
    tiles: Vec<OnceLock<Box<TileForms>>>,
    later: Later,
    /// Whether `later` is all that has been drawn.
    is_later_all: bool,
    spares: Spares,
}

impl Clone for BlockDepths {
    /// All tiles of the copy are there.
    fn clone(&self) -> Self {
        let tiles = (0..self.tiles.len()).filter_map(|k| self.tile(k));
        let tiles = tiles.map(|tile| OnceLock::from(Box::new(tile.clone())));
        Self {
            tiles: tiles.collect(),
            later: Later::level(0.0),
            is_later_all: false,
            spares: Mutex::default(),
            ..*self
        }
    }
}

impl BlockDepths {
    /// A picture that has one depth everywhere.
    ///
    /// # Errors
    /// [`TargetError::TooLarge`].
    pub fn new(width: u32, height: u32, depth: f32) -> Result<Self, TargetError> {
        if width.max(height) > MAX_TARGET_SIDE {
            return Err(TargetError::TooLarge { width, height });
        }
        let (width, height) = (width as usize, height as usize);
        let columns = width.div_ceil(TILE);
        let mut tiles = Vec::new();
        tiles.resize_with(columns * height.div_ceil(TILE), OnceLock::new);
        let later = Later::level(depth);
        Ok(Self { width, height, columns, tiles, later, is_later_all: true, spares: Mutex::default() })
    }

    /// What the tiles that are not there yet are drawn from, to be changed. All are such from now on.
    pub(crate) fn begin_later(&mut self) -> &mut Later {
        let spares = self.spares.get_mut().unwrap_or_else(PoisonError::into_inner);
        spares.extend(self.tiles.iter_mut().filter_map(OnceLock::take));
        self.is_later_all = true;
        &mut self.later
    }

    /// A tile; drawn now if it has not been yet.
    #[inline(always)]
    fn tile(&self, k: usize) -> Option<&TileForms> {
        let tile = self.tiles.get(k)?;
        match tile.get() {
            Some(forms) => Some(forms),
            None => Some(self.draw_tile(k, tile)),
        }
    }

    #[cold]
    #[inline(never)]
    fn draw_tile<'a>(&'a self, k: usize, tile: &'a OnceLock<Box<TileForms>>) -> &'a TileForms {
        let spare = lock(&self.spares).pop();
        let drawn = self.later.draw_tile(k, spare.unwrap_or_default());
        // Another thread may have drawn the same meanwhile: waiting for it would take longer.
        tile.get_or_init(|| drawn)
    }

    /// A depth that none in a rectangle of pixels (first and last, which are in the picture) is greater than, or,
    /// unless `greatest`, less than, if that is known without drawing them.
    #[inline(always)]
    pub(crate) fn bound(&self, columns: [i32; 2], rows: [i32; 2], greatest: bool) -> Option<f32> {
        if !self.is_later_all || columns[1] < columns[0] || rows[1] < rows[0] {
            return None;
        }
        let [[x0, x1], [y0, y1]] = [columns, rows].map(|ends| ends.map(|v| v as u32 as usize / TILE));
        if (x1 - x0 + 1) * (y1 - y0 + 1) > BOUNDED {
            return None;
        }
        let mut bound = if greatest { 0.0f32 } else { 1.0 };
        for y in y0..=y1 {
            for x in x0..=x1 {
                let [low, high] = self.later.bounds(y * self.columns + x);
                bound = if greatest { bound.max(high) } else { bound.min(low) };
            }
        }
        Some(bound)
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
    /// and row, that at the second column, then those of the second row, or as many of them as `to` has room for.
    /// Only squares whose bit is set in `mask` are looked at; their columns and rows must be within the picture, or
    /// any depth is given.
    #[inline(always)]
    pub fn gather<S: Simd>(
        &self,
        simd: S,
        mask: u16,
        columns: [&[i32; LANES]; 2],
        rows: [&[i32; LANES]; 2],
        to: &mut [[f32; LANES]],
    ) {
        let mut planes = [[0.0; LANES]; FORM];
        let planar = self.gather_planes(mask, columns, rows, &mut planes, to);
        if planar == 0 {
            return;
        }
        let keep = mask32x16::from_bitmask(simd, u64::from(planar));
        let [value, dx, dy, x, y, low, high] = [0, 1, 2, 3, 4, 5, 6].map(
            #[inline(always)]
            |k| f32x16::load_array_ref(simd, &planes[k]),
        );
        let within = |numbers: &[i32; LANES]| {
            (i32x16::load_array_ref(simd, numbers) & i32x16::splat(simd, TILE as i32 - 1))
                .to_float::<f32x16<S>>()
        };
        for (corner, to) in to.iter_mut().enumerate().take(4) {
            // As DepthForm::at.
            let row = value + dy * (y + within(rows[corner / 2]));
            let z = (row + dx * (x + within(columns[corner % 2]))).max(low).min(high);
            keep.select(z, f32x16::load_array_ref(simd, to)).store_array(to);
        }
    }

    /// The planes of squares that lie in one plane, number by number, and which these are; of others the depths.
    // Not to be inlined into vector code, which would take each number out of its register.
    #[inline(never)]
    fn gather_planes(
        &self,
        mask: u16,
        [x0, x1]: [&[i32; LANES]; 2],
        [y0, y1]: [&[i32; LANES]; 2],
        planes: &mut [[f32; LANES]; FORM],
        to: &mut [[f32; LANES]],
    ) -> u16 {
        let mut planar = 0;
        let mut left = mask;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let [x0, x1, y0, y1] = [x0[lane], x1[lane], y0[lane], y1[lane]].map(|v| v as u32 as usize);
            let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)];
            let one_block = ((x0 ^ x1) | (y0 ^ y1)) < 8;
            let form = if one_block { self.form_of_square(corners) } else { self.form_of_all(corners) };
            if let Some(form) = form {
                planar |= 1 << lane;
                let ([value, dx, dy], [x, y], [low, high]) = (form.plane, form.offset, form.range);
                for (plane, v) in planes.iter_mut().zip([value, dx, dy, x, y, low, high]) {
                    plane[lane] = v;
                }
            } else {
                for (to, (x, y)) in to.iter_mut().zip(corners) {
                    to[lane] = self.at(x, y);
                }
            }
        }
        planar
    }

    /// The plane of the corners of a square, all of which are in one block, if they have the same.
    #[inline(always)]
    fn form_of_square(&self, corners: [(usize, usize); 4]) -> Option<&DepthForm> {
        let [tile, block, _] = self.place(corners[0]);
        let forms = self.tile(tile)?;
        if forms.valued >> block & 1 == 1 {
            return None;
        }
        let mut number = forms.outer[block % COUNT];
        if forms.cut >> block & 1 == 1 {
            let square = corners.iter().fold(0u64, |bits, &(x, y)| bits | 1 << (y % 8 * 8 + x % 8));
            let inner = forms.inner_pixels[block % COUNT] & square;
            if inner != 0 && inner != square {
                return None;
            }
            number = if inner == 0 { number } else { forms.inner[block % COUNT] };
        }
        Some(&forms.planes[usize::from(number) % PLANES])
    }

    /// The plane of pixels of one tile, if they have the same.
    #[inline(always)]
    fn form_of_all(&self, corners: [(usize, usize); 4]) -> Option<&DepthForm> {
        let [tile, ..] = self.place(corners[0]);
        let forms = self.tile(tile)?;
        let number = |corner| {
            let [of, block, pixel] = self.place(corner);
            (of == tile).then(|| forms.number(block, pixel)).flatten()
        };
        let first = number(corners[0])?;
        let same = corners[1..].iter().all(|&corner| number(corner) == Some(first));
        same.then(|| &forms.planes[first % PLANES])
    }

    /// Tile, block of the tile and pixel of the block.
    #[inline(always)]
    fn place(&self, (x, y): (usize, usize)) -> [usize; 3] {
        [y / TILE * self.columns + x / TILE, y % TILE / 8 * BLOCKS + x % TILE / 8, y % 8 * 8 + x % 8]
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
        let [tile, block, pixel] = self.place((x, y));
        let Some(forms) = self.tile(tile) else { return 0.0 };
        match forms.number(block, pixel) {
            Some(number) => forms.planes[number % PLANES].at((x % TILE) as f32, (y % TILE) as f32),
            None => forms.values_of(block).as_flattened()[pixel],
        }
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, tile: usize, block: usize, to: &mut Block<f32>) {
        let Some(forms) = self.tile(tile) else { return };
        if forms.valued >> block & 1 == 1 {
            *to = *forms.values_of(block);
        } else {
            forms.values(simd, block, to);
        }
    }

    /// The rows of tiles. What is drawn to them is not drawn by `later`.
    pub(crate) fn bands(&mut self) -> impl Iterator<Item = BandDepths<'_>> {
        self.is_later_all = false;
        let (columns, later, spares) = (self.columns.max(1), &self.later, &self.spares);
        let rows = self.tiles.chunks_mut(columns).enumerate();
        rows.map(move |(row, tiles)| BandDepths { first: row * columns, tiles, later, spares })
    }

    /// One row of tiles; see [`Self::bands`].
    pub(crate) fn band(&mut self, row: usize) -> BandDepths<'_> {
        self.is_later_all = false;
        let tiles: Range<usize> = row * self.columns..(row + 1) * self.columns;
        let first = tiles.start;
        BandDepths { first, tiles: &mut self.tiles[tiles], later: &self.later, spares: &self.spares }
    }
}

/// Depths of a row of tiles.
pub(crate) struct BandDepths<'a> {
    /// Number of the first tile.
    first: usize,
    tiles: &'a mut [OnceLock<Box<TileForms>>],
    later: &'a Later,
    spares: &'a Spares,
}

impl BandDepths<'_> {
    /// Takes a tile out to be drawn to. What it held is of no account if it `is_cleared`.
    pub(crate) fn take(&mut self, column: usize, is_cleared: bool) -> Box<TileForms> {
        self.tiles[column].take().unwrap_or_else(|| {
            let spare = lock(self.spares).pop().unwrap_or_default();
            if is_cleared { spare } else { self.later.draw_tile(self.first + column, spare) }
        })
    }

    /// Puts a tile back.
    pub(crate) fn put(&mut self, column: usize, tile: Box<TileForms>) {
        self.tiles[column] = OnceLock::from(tile);
    }
}
